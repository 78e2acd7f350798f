/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/check.h"
#include "fillers.h"

#include <string.h>

static int dimensions_of(ph_kinematics kin)
{
    return kin == PH_SPACE ? 3 : 2;
}

static ph_status check_material(const ph_case *c, int material, const char *what,
                                ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(material >= 0 && material < c->nmaterials, PH_EINVAL,
             "%s: material %d is outside 0..%d", what, material, c->nmaterials - 1);
out:
    return st;
}

static ph_status paint_inclusion(ph_canvas *canvas, const ph_case *c, int i,
                                 ph_error *err)
{
    ph_status st = PH_OK;
    const ph_inclusion *inc = &c->inclusions[i];
    ph_solid solid;
    PH_TRY(check_material(c, inc->material, "material", err));
    PH_TRY(ph_shape_place(inc, &canvas->micro->grid, &solid, err));
    PH_TRY(ph_i_paint(canvas, &solid, inc->material, err));
out:
    if (st != PH_OK)
        ph_error_prefix(err, "%s:%d: microstructure.inclusions[%d]: ", c->path, inc->line,
                        i);
    return st;
}

/* Chains of nodes cover whole cells: there no cut may stay. */
static void drop_covered_cuts(ph_microstructure *m, const ph_packing *p)
{
    ptrdiff_t kept = 0;
    for (ptrdiff_t k = 0; k < m->ncuts; k++) {
        int32_t owner = m->owner[m->cuts[k].cell];
        bool node =
            owner > 0 && p->kind[p->filler[owner - 1].kind].counting == PH_COUNT_NODES;
        if (!node) m->cuts[kept++] = m->cuts[k];
    }
    m->ncuts = kept;
}

static ph_status build_fillers(const ph_case *c, ph_canvas *canvas,
                               const ph_packing *packing, ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *m = canvas->micro;
    for (int k = 0; k < c->nfillers; k++)
        PH_TRY(check_material(c, c->fillers[k].material, "fillers: material", err));
    PH_ALLOC(m->owner, ph_grid_cells(&m->grid), "the owners of the cells");
    PH_TRY(ph_i_paint_packing(c, packing, canvas, err));
out:
    return st;
}

static ph_status build_from_shapes(const ph_case *c, ph_microstructure *m,
                                   const ph_packing *packing, ph_error *err)
{
    ph_status st = PH_OK;
    ph_canvas canvas = {.micro = m,
                        .dimensions = dimensions_of(c->kinematics),
                        .cuts = c->interface == PH_INTERFACE_COMPOSITE};
    PH_TRY(check_material(c, c->matrix, "microstructure.matrix", err));
    ptrdiff_t cells = ph_grid_cells(&m->grid);
    for (ptrdiff_t i = 0; i < cells; i++)
        m->phase[i] = (uint16_t)c->matrix;
    for (int i = 0; i < c->ninclusions; i++)
        PH_TRY(paint_inclusion(&canvas, c, i, err));
    if (packing) PH_TRY(build_fillers(c, &canvas, packing, err));
    PH_TRY(ph_i_cut_cells(&canvas, err));
    if (packing) drop_covered_cuts(m, packing);
out:
    ph_i_canvas_clear(&canvas);
    return st;
}

/* Folder of the case and the file's name, unless that is absolute. */
static ph_status voxel_path(const ph_case *c, char **path, ph_error *err)
{
    ph_status st = PH_OK;
    const char *file = c->voxels.file;
    bool bare = file[0] == '/' || c->folder[0] == 0;
    size_t size = strlen(c->folder) + strlen(file) + 2;
    PH_ALLOC(*path, size, "a path");
    snprintf(*path, size, "%s%s%s", bare ? "" : c->folder, bare ? "" : "/", file);
out:
    return st;
}

/* Materials of the voxel values; says which value has none and where. */
static ph_status assign(const ph_case *c, ph_microstructure *m, const uint16_t *values,
                        ph_error *err)
{
    ph_status st = PH_OK;
    const ph_voxels *v = &c->voxels;
    const ptrdiff_t *n = m->grid.n;
    for (ptrdiff_t i = 0; i < ph_grid_cells(&m->grid); i++) {
        int material = values[i] < v->nmaterials ? v->materials[values[i]] : -1;
        PH_CHECK(material >= 0 && material < c->nmaterials, PH_EINVAL,
                 "voxel [%td, %td, %td] has value %d, for which no material is given",
                 i / n[2] / n[1], i / n[2] % n[1], i % n[2], values[i]);
        m->phase[i] = (uint16_t)material;
    }
out:
    return st;
}

static ph_status build_from_voxels(const ph_case *c, ph_microstructure **m, ph_error *err)
{
    ph_status st = PH_OK;
    char *path = NULL;
    uint16_t *values = NULL;
    ph_grid grid;
    ptrdiff_t n[3] = {c->nodes[0], c->nodes[1], c->nodes[2]};
    PH_CHECK(c->voxels.nmaterials >= 0 && c->voxels.nmaterials <= 256, PH_EINVAL,
             "microstructure.voxels: number of materials %d", c->voxels.nmaterials);
    PH_TRY(voxel_path(c, &path, err));
    PH_TRY(ph_rve_read_voxels(path, c->voxels.dataset, c->voxels.type,
                              dimensions_of(c->kinematics), n, &values, err));
    PH_TRY(ph_grid_init(&grid, c->kinematics, n, c->size, err));
    PH_TRY(ph_microstructure_new(&grid, c->nmaterials, c->materials, m, err));
    st = assign(c, *m, values, err);
    if (st != PH_OK) ph_error_prefix(err, "%s: ", path);
    PH_TRY(st);
    if (c->voxels.owners[0]) {
        PH_ALLOC((*m)->owner, ph_grid_cells(&grid), "the owners of the cells");
        PH_TRY(ph_rve_read_owners(path, c->voxels.owners, dimensions_of(c->kinematics), n,
                                  (*m)->owner, err));
    }
out:
    free(path);
    free(values);
    return st;
}

ph_status ph_rve_paint(const ph_case *c, const ph_packing *packing,
                       ph_microstructure **out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_status st = PH_OK;
    ph_microstructure *m = NULL;
    ph_grid grid;
    *out = NULL;
    PH_TRY(ph_grid_init(&grid, c->kinematics, c->nodes, c->size, err));
    PH_TRY(ph_microstructure_new(&grid, c->nmaterials, c->materials, &m, err));
    PH_TRY(build_from_shapes(c, m, packing, err));
    *out = m;
    m = NULL;
out:
    ph_microstructure_free(&m);
    return st;
}

ph_status ph_rve_generate(const ph_case *c, ph_microstructure **out, ph_packing **packing,
                          ph_error *err)
{
    PH_GIVEN(c && out && packing);
    ph_status st = PH_OK;
    ph_packing *p = NULL;
    *out = NULL;
    *packing = NULL;
    if (c->voxels.file[0]) {
        st = build_from_voxels(c, out, err);
        if (st != PH_OK)
            ph_error_prefix(err, "%s:%d: microstructure.voxels: ", c->path,
                            c->voxels.line);
        PH_TRY(st);
    } else {
        if (c->nfillers > 0) PH_TRY(ph_rve_place(c, &p, err));
        PH_TRY(ph_rve_paint(c, p, out, err));
    }
    *packing = p;
    p = NULL;
out:
    if (st != PH_OK) ph_microstructure_free(out);
    ph_packing_free(&p);
    return st;
}

ph_status ph_rve_build(const ph_case *c, ph_microstructure **out, ph_error *err)
{
    PH_GIVEN(c && out);
    ph_packing *packing = NULL;
    ph_status st = ph_rve_generate(c, out, &packing, err);
    ph_packing_free(&packing);
    return st;
}

ph_problem ph_rve_problem(const ph_case *c, const ph_microstructure *micro,
                          const ph_crack_plan *plan)
{
    if (!c) return (ph_problem){0};
    return (ph_problem){
        .micro = micro,
        .interface = c->interface,
        .model = c->model,
        .constraint = c->constraint,
        .solver = c->solver,
        .keep_fields = c->fields,
        .nconstants = c->nconstants,
        .constants = c->constants,
        .cracks = plan ? &plan->cracks : NULL,
        .sequence = plan ? &plan->sequence : NULL,
        .failure = c->failure.material ? &c->failure : NULL,
        .loading = c->loading.ntargets ? &c->loading : NULL,
    };
}
