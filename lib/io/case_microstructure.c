/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"
#include "io/text.h"

#include <string.h>

static const char *const microstructure_keys[] = {
    "dimension", "plane",     "size", "nodes",   "matrix",      "inclusions",
    "voxels",    "interface", "seed", "fillers", "realisation", "drawn_on"};
static const char *const voxel_keys[] = {"file", "dataset", "materials", "type",
                                         "owners"};
static const char *const voxel_endings[] = {".h5", ".npy", ".png", ".raw"};

enum { MAX_NODES_PER_AXIS = 65536, MAX_VOXEL_VALUES = 256 };

static void read_plane(ph_i_reader *r, const ph_i_node *map)
{
    static const ph_kinematics plane[] = {PH_GENERALISED_STRAIN, PH_PLANE_STRAIN,
                                          PH_PLANE_STRESS};
    const ph_i_node *node = ph_i_get(map, "plane");
    if (r->dimension == 3) {
        r->c->kinematics = PH_SPACE;
        if (node) ph_i_complain(r, node, PH_EINVAL, "belongs to dimension 2 only");
        return;
    }
    node = ph_i_need(r, map, "plane",
                     "dimension 2 needs generalised_strain, strain or stress");
    int i = node ? ph_i_read_name(r, node, ph_i_plane_names) : -1;
    if (i >= 0) r->c->kinematics = plane[i];
}

static void read_size(ph_i_reader *r, const ph_i_node *map)
{
    const char *rule = r->dimension == 3 ? "must be a list of 3 lengths > 0"
                                         : "must be a list of 2 lengths > 0";
    const ph_i_node *node = ph_i_need(r, map, "size", rule);
    if (node) ph_i_read_numbers(r, node, (size_t)r->dimension, true, rule, r->c->size);
    if (r->dimension == 2) r->c->size[2] = 1;
}

/* An integer for every axis of the grid; false where there is a complaint. */
static bool read_grid(ph_i_reader *r, const ph_i_node *node, ptrdiff_t *nodes)
{
    const char *rule = r->dimension == 3 ? "must be a list of 3 integers from 1 to 65536"
                                         : "must be a list of 2 integers from 1 to 65536";
    if (!ph_i_read_list(r, node, (size_t)r->dimension, rule)) return false;
    int64_t total = 1;
    for (size_t a = 0; a < (size_t)r->dimension; a++) {
        int64_t n = 0;
        if (!ph_i_read_integer(r, node->child[a], 1, MAX_NODES_PER_AXIS,
                               "must be an integer from 1 to 65536", &n))
            return false;
        nodes[a] = (ptrdiff_t)n;
        total *= n; /* below 2^48 */
    }
    if (r->dimension == 2) nodes[2] = 1;
    if (total > (int64_t)1 << 40)
        ph_i_complain(r, node, PH_EINVAL, "%lld nodes: at most 2^40 are admissible",
                      (long long)total);
    return true;
}

/* A grid to begin with, its cells as cubic as the box allows. */
static void choose_nodes(ph_case *c, int dimension)
{
    enum { LONGEST = 16 };
    double longest = 0;
    for (int a = 0; a < dimension; a++)
        longest = c->size[a] > longest ? c->size[a] : longest;
    for (int a = 0; a < dimension && longest > 0; a++) {
        ptrdiff_t n = (ptrdiff_t)(LONGEST * c->size[a] / longest + 0.5);
        c->nodes[a] = n < 2 ? 2 : n;
    }
    if (dimension == 2) c->nodes[2] = 1;
}

static void read_nodes(ph_i_reader *r, const ph_i_node *map, bool voxels)
{
    const char *rule = r->dimension == 3 ? "must be a list of 3 integers from 1 to 65536"
                                         : "must be a list of 2 integers from 1 to 65536";
    const ph_i_node *node = voxels || r->automatic ? ph_i_get(map, "nodes")
                                                   : ph_i_need(r, map, "nodes", rule);
    const ph_i_node *drawn = ph_i_get(map, "drawn_on");
    if (node)
        read_grid(r, node, r->c->nodes);
    else if (r->automatic && !voxels)
        choose_nodes(r->c, r->dimension);
    if (drawn && !ph_i_is_null(drawn) && read_grid(r, drawn, r->c->drawn_on) &&
        !ph_i_get(map, "fillers"))
        ph_i_complain(r, drawn, PH_EINVAL, "belongs to fillers, and there are none");
}

static void read_voxel_value(ph_i_reader *r, const ph_i_node *node, int value)
{
    int material = ph_i_read_material(r, node);
    if (material < 0) return;
    r->c->voxels.materials[value] = material;
    if (value >= r->c->voxels.nmaterials) r->c->voxels.nmaterials = value + 1;
}

/* [name, name, ...] by voxel value, or {value: name}. */
static void read_voxel_materials(ph_i_reader *r, const ph_i_node *node)
{
    static const char rule[] =
        "must be a list of 1 to 256 materials, or a map from voxel values 0 to 255";
    if (node->kind == PH_I_SCALAR || node->count == 0 || node->count > MAX_VOXEL_VALUES) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
        return;
    }
    size_t nulls = 0;
    for (size_t i = 0; i < node->count; i++) {
        const ph_i_node *child = node->child[i];
        double value = (double)i;
        nulls += ph_i_is_null(child);
        if (ph_i_is_null(child)) continue;
        if (child->key && (!ph_i_text_to_number(child->key, &value) || !(value >= 0) ||
                           value >= MAX_VOXEL_VALUES || value != (int)value)) {
            ph_i_complain(r, child, PH_EINVAL,
                          "not a voxel value: they go from 0 to 255");
            continue;
        }
        read_voxel_value(r, child, (int)value);
    }
    if (nulls == node->count)
        ph_i_complain(r, node, PH_EINVAL, "no value has a material");
}

static const char *ending_of(const char *file)
{
    const char *dot = strrchr(file, '.');
    for (size_t i = 0; dot && i < sizeof voxel_endings / sizeof *voxel_endings; i++)
        if (strcmp(dot, voxel_endings[i]) == 0) return voxel_endings[i];
    return NULL;
}

/* Keys that only one kind of voxel file has. */
static void read_voxel_format(ph_i_reader *r, const ph_i_node *map, const char *ending)
{
    ph_voxels *v = &r->c->voxels;
    const ph_i_node *dataset = ph_i_get(map, "dataset"), *type = ph_i_get(map, "type"),
                    *owners = ph_i_get(map, "owners");
    if (strcmp(ending, ".h5") == 0) {
        snprintf(v->dataset, sizeof v->dataset, "/phase");
        if (dataset) ph_i_read_text(r, dataset, sizeof v->dataset, v->dataset);
        if (owners) ph_i_read_text(r, owners, sizeof v->owners, v->owners);
    } else if (dataset || owners) {
        ph_i_complain(r, dataset ? dataset : owners, PH_EINVAL,
                      "belongs to .h5 files only");
    }
    if (strcmp(ending, ".raw") == 0) {
        type = ph_i_need(r, map, "type", "a .raw file needs uint8, uint16 or int32");
        int i = type ? ph_i_read_name(r, type, ph_i_raw_type_names) : -1;
        if (i >= 0) snprintf(v->type, sizeof v->type, "%s", ph_i_raw_type_names.name[i]);
        if (r->dimension && !ph_i_get(map->parent, "nodes"))
            ph_i_missing(r, map->parent, "nodes",
                         "a .raw file does not say how many it has");
    } else if (type) {
        ph_i_complain(r, type, PH_EINVAL, "belongs to .raw files only");
    }
}

void ph_i_read_voxels(ph_i_reader *r, const ph_i_node *node)
{
    static const char file_rule[] = "must be the name of a .h5, .npy, .png or .raw file";
    ph_voxels *v = &r->c->voxels;
    if (!ph_i_read_map(r, node,
                       "must be a map such as {file: rve.h5, materials: [a, b]}"))
        return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(voxel_keys), "voxels");
    v->line = node->line;
    for (int i = 0; i < MAX_VOXEL_VALUES; i++)
        v->materials[i] = -1;
    const ph_i_node *file = ph_i_need(r, node, "file", file_rule);
    const ph_i_node *materials =
        ph_i_need(r, node, "materials", "must say which material each voxel value is");
    if (file && ph_i_read_text(r, file, sizeof v->file, v->file)) {
        const char *ending = ending_of(v->file);
        if (ending)
            read_voxel_format(r, node, ending);
        else
            ph_i_reject(r, file, PH_EINVAL, "%s", file_rule);
    }
    if (materials) read_voxel_materials(r, materials);
}

/* Matrix and inclusions, or voxels instead of both. */
static ph_status read_contents(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *voxels = ph_i_get(map, "voxels"), *matrix = ph_i_get(map, "matrix"),
                    *inclusions = ph_i_get(map, "inclusions"),
                    *fillers = ph_i_get(map, "fillers");
    if (voxels) {
        static const char both[] = "voxels are given too: they stand instead of matrix, "
                                   "inclusions and fillers";
        if (matrix) ph_i_complain(r, matrix, PH_EINVAL, "%s", both);
        if (inclusions) ph_i_complain(r, inclusions, PH_EINVAL, "%s", both);
        if (fillers) ph_i_complain(r, fillers, PH_EINVAL, "%s", both);
        ph_i_read_voxels(r, voxels);
    } else {
        matrix = ph_i_need(r, map, "matrix", "must be a material (or give voxels)");
        int i = matrix ? ph_i_read_material(r, matrix) : -1;
        if (i >= 0) r->c->matrix = i;
        if (inclusions) PH_TRY(ph_i_read_inclusions(r, inclusions, err));
        if (fillers) PH_TRY(ph_i_read_fillers(r, fillers, err));
    }
out:
    return st;
}

static void read_interface(ph_i_reader *r, const ph_i_node *map, bool voxels)
{
    const ph_i_node *node = ph_i_get(map, "interface");
    r->c->interface = voxels ? PH_INTERFACE_NODE_CENTRE : PH_INTERFACE_COMPOSITE;
    int i = node ? ph_i_read_name(r, node, ph_i_interface_names) : -1;
    if (i >= 0) r->c->interface = (ph_interface)i;
    if (voxels && r->c->interface == PH_INTERFACE_COMPOSITE)
        ph_i_reject(r, node, PH_EINVAL,
                    "voxels know no interface inside a cell: must be node_centre");
}

ph_status ph_i_read_microstructure(ph_i_reader *r, const ph_i_node *root, ph_error *err)
{
    static const char rule[] = "must be a map with dimension, size, nodes, ...";
    ph_status st = PH_OK;
    int64_t seed = 1, dimension = 0, realisation = 0;
    const ph_i_node *map = ph_i_need(r, root, "microstructure", rule);
    if (!map || !ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(microstructure_keys),
                    "microstructure");
    const ph_i_node *node = ph_i_need(r, map, "dimension", "must be 2 or 3");
    bool voxels = ph_i_get(map, "voxels") != NULL;
    if (node && ph_i_read_integer(r, node, 2, 3, "must be 2 or 3", &dimension)) {
        r->dimension = (int)dimension;
        read_plane(r, map);
        read_size(r, map);
        read_nodes(r, map, voxels);
    }
    PH_TRY(read_contents(r, map, err));
    read_interface(r, map, voxels);
    node = ph_i_get(map, "seed");
    if (node)
        ph_i_read_integer(r, node, 0, (int64_t)1 << 53,
                          "must be an integer from 0 to 2^53", &seed);
    r->c->seed = (uint64_t)seed;
    node = ph_i_get(map, "realisation");
    if (node)
        ph_i_read_integer(r, node, 0, (int64_t)1 << 53,
                          "must be an integer from 0 to 2^53", &realisation);
    r->c->realisation = (uint64_t)realisation;
out:
    return st;
}
