/* SPDX-License-Identifier: GPL-3.0-or-later */
/* microstructure.fillers: populations of random fillers. */
#include "core/vec3.h"
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { PLATELET, FIBRE, PARTICLE };
enum { MAX_FILLERS = 256 };

static const char *const common_keys[] = {
    "shape",       "material",  "weight_fraction", "volume_fraction", "count",
    "orientation", "placement", "interphase",      "aspect_ratio",    "counting"};
static const char *const long_keys[] = {"thickness", "length", "curvature"};
static const char *const sheet_keys[] = {"width", "outline"};
static const char *const curvature_keys[] = {"arc_angle", "radius", "helix",
                                             "persistence_length"};
static const char *const helix_keys[] = {"radius", "pitch"};
static const char *const orientation_keys[] = {"aligned", "von_mises_fisher", "tensor"};
static const char *const aligned_keys[] = {"angle", "axis", "spread"};
static const char *const fisher_keys[] = {"angle", "axis", "concentration"};
static const char *const placement_keys[] = {"overlap", "gap", "clusters"};
static const char *const cluster_keys[] = {"count", "radius", "share"};
static const char *const interphase_keys[] = {"kappa", "thickness", "material"};
static const char *const outlines[] = {"rectangle", "disc"};

static const ph_distribution not_given = {.kind = -1};

/* ---- distributions ---- */

static bool read_table(ph_i_reader *r, const ph_i_node *map, ph_distribution *d)
{
    static const char rule[] = "must be a list of 1 to 32 numbers";
    const ph_i_node *values = ph_i_need(r, map, "values", rule),
                    *weights = ph_i_need(r, map, "weights", rule);
    if (!values || !weights) return false;
    double sum = 0;
    size_t n = values->kind == PH_I_LIST ? values->count : 0;
    if (n < 1 || n > PH_TABLE_MAX) {
        ph_i_reject(r, values, PH_EINVAL, "%s", rule);
        return false;
    }
    if (!ph_i_read_numbers(r, values, n, false, rule, d->value) ||
        !ph_i_read_numbers(r, weights, n, false, "must be as many numbers as values",
                           d->weight))
        return false;
    d->n = (int)n;
    for (size_t i = 0; i < n; i++) {
        if (d->weight[i] < 0 || (i > 0 && d->value[i] <= d->value[i - 1])) {
            ph_i_reject(r, map, PH_EUNPHYSICAL,
                        "values must ascend, weights must not be negative");
            return false;
        }
        sum += d->weight[i];
    }
    for (size_t i = 0; i < n; i++)
        d->weight[i] /= sum;
    if (!(sum > 0)) ph_i_reject(r, weights, PH_EUNPHYSICAL, "add up to nothing");
    return sum > 0;
}

/* The one key of the map that names a distribution; -1 after a complaint. */
static int read_kind(ph_i_reader *r, const ph_i_node *node, const char *what)
{
    const char *names[16];
    ph_i_names known = {names, ph_ndistributions};
    char list[200];
    for (size_t i = 0; i < ph_ndistributions; i++)
        names[i] = ph_distributions[i].info.name;
    ph_i_join_names(known, " or ", list, sizeof list);
    if (node->kind != PH_I_MAP || node->count != 1) {
        ph_i_reject(r, node, PH_EINVAL, "%s must be a number or one of {%s: {...}}", what,
                    list);
        return -1;
    }
    ph_i_check_keys(r, node, known, "a distribution");
    for (size_t i = 0; i < known.count; i++)
        if (strcmp(node->child[0]->key, names[i]) == 0) return (int)i;
    return -1;
}

static bool read_parameters(ph_i_reader *r, const ph_i_node *map, ph_distribution *d)
{
    const ph_distribution_kind *kind = &ph_distributions[d->kind];
    const char *names[PH_DISTRIBUTION_KEYS + 2];
    ph_i_names known = {names, 0};
    bool good = true;
    for (int i = 0; i < PH_DISTRIBUTION_KEYS && kind->keys[i]; i++)
        names[known.count++] = kind->keys[i];
    size_t needed = known.count;
    if (kind->truncates) {
        names[known.count++] = "min";
        names[known.count++] = "max";
    }
    if (!ph_i_read_map(r, map, "must be a map of its parameters")) return false;
    ph_i_check_keys(r, map, known, kind->info.name);
    if (strcmp(kind->info.name, "table") == 0) return read_table(r, map, d);
    for (size_t i = 0; i < known.count; i++) {
        static const char rule[] = "must be a number";
        double *to = i < needed ? &d->p[i] : i == needed ? &d->min : &d->max;
        const ph_i_node *x =
            i < needed ? ph_i_need(r, map, names[i], rule) : ph_i_get(map, names[i]);
        if (!x) good &= i >= needed;
        if (x) good &= ph_i_read_number(r, x, -1e60, 1e60, rule, to);
    }
    return good;
}

/* Every value must lie in [lo, hi] (above lo where `open`); a distribution that may leave
 * the interval is cut there if it can be cut, and refused if nothing is left. */
static void confine(ph_i_reader *r, const ph_i_node *node, const char *what, double lo,
                    double hi, bool open, ph_distribution *d)
{
    ph_error why = PH_ERROR_INIT;
    double from, to;
    if (ph_distribution_check(d, &why) != PH_OK) {
        ph_i_reject(r, node, PH_EUNPHYSICAL, "%s", why.msg);
        return;
    }
    if (ph_distributions[d->kind].truncates) {
        d->min = fmax(d->min, open ? 1e-30 : lo); /* open: lo is 0 */
        if (hi < 1e59) d->max = fmin(d->max, hi);
        if (d->min > d->max || ph_distribution_check(d, &why) != PH_OK)
            ph_i_reject(r, node, PH_EUNPHYSICAL, "it never gives an admissible %s%s",
                        what, open ? ", which is > 0" : "");
        return;
    }
    ph_distribution_range(d, &from, &to);
    if (from < lo || to > hi || (open && from <= lo))
        ph_i_reject(r, node, PH_EUNPHYSICAL, "every %s must be %s %g%s", what,
                    open ? ">" : "at least", lo, hi < 1e60 ? " and not above 360" : "");
}

void ph_i_read_distribution(ph_i_reader *r, const ph_i_node *node, const char *what,
                            double lo, double hi, bool open, ph_distribution *d)
{
    double x;
    *d = ph_distribution_constant(0);
    if (node->kind == PH_I_SCALAR) {
        char rule[120];
        snprintf(rule, sizeof rule, "the %s must be a number or a distribution", what);
        if (!ph_i_read_number(r, node, -INFINITY, INFINITY, rule, &x)) return;
        *d = ph_distribution_constant(x);
    } else {
        int kind = read_kind(r, node, what);
        if (kind < 0) return;
        d->kind = kind;
        if (!read_parameters(r, node->child[0], d)) {
            *d = ph_distribution_constant(lo + 1); /* that complaint is enough */
            return;
        }
    }
    confine(r, node, what, lo, hi, open, d);
}

/* A length or ratio > 0 under `key`; false where it is not given. */
static bool read_positive_key(ph_i_reader *r, const ph_i_node *map, const char *key,
                              ph_distribution *d)
{
    const ph_i_node *node = ph_i_get(map, key);
    if (node) ph_i_read_distribution(r, node, key, 0, 1e60, true, d);
    return node != NULL;
}

/* ---- the sections of a filler ---- */

static void read_amount(ph_i_reader *r, const ph_i_node *map, ph_filler *f)
{
    const ph_i_node *node = NULL;
    int given = 0;
    for (int i = 0; i < 3; i++) {
        const ph_i_node *x = ph_i_get(map, ph_i_amount_names.name[i]);
        if (!x) continue;
        given++;
        node = x;
        f->amount = (ph_amount)i;
    }
    if (given == 0)
        ph_i_missing(r, map, "volume_fraction",
                     "give weight_fraction, volume_fraction or count");
    else if (given > 1)
        ph_i_complain(r, node, PH_EINVAL,
                      "weight_fraction, volume_fraction and count exclude each other");
    else if (f->amount == PH_AMOUNT_COUNT) {
        int64_t n = 0;
        ph_i_read_integer(r, node, 0, 100000000, "must be an integer from 0 to 1e8", &n);
        f->amount_value = (double)n;
    } else {
        ph_i_read_number(r, node, -1e-300, 1, "must be a fraction >= 0 and < 1",
                         &f->amount_value);
    }
}

static void need_density(ph_i_reader *r, const ph_i_node *map, int material,
                         const char *role)
{
    const ph_material *m = &r->c->materials[material];
    const ph_i_node *node = ph_i_get(map, "weight_fraction");
    if (isfinite(m->density) || r->materials.count == 0) return;
    ph_i_complain(r, node ? node : map, PH_EINVAL,
                  "needs the densities: materials.%s.density (%s) is missing", m->name,
                  role);
}

static void read_extents(ph_i_reader *r, const ph_i_node *map, int shape, ph_filler *f)
{
    bool ratio = read_positive_key(r, map, "aspect_ratio", &f->aspect_ratio);
    if (shape == PARTICLE) {
        if (!read_positive_key(r, map, "size", &f->size))
            ph_i_missing(r, map, "size", "must be the diameter (> 0) or a distribution");
        return;
    }
    if (!read_positive_key(r, map, "thickness", &f->thickness))
        ph_i_missing(r, map, "thickness", "must be a length > 0 or a distribution");
    bool length = read_positive_key(r, map, "length", &f->length);
    if (ratio == length) {
        if (ratio)
            ph_i_complain(r, ph_i_get(map, "length"), PH_EINVAL,
                          "aspect_ratio is given too: one of both is admissible");
        else
            ph_i_missing(r, map, "aspect_ratio", "give aspect_ratio or length");
    }
    read_positive_key(r, map, "width", &f->width);
    const ph_i_node *outline = ph_i_get(map, "outline");
    if (outline)
        f->disc = ph_i_read_name(r, outline, (ph_i_names)PH_I_NAMES(outlines)) == 1;
}

static void read_helix(ph_i_reader *r, const ph_i_node *node, ph_filler *f)
{
    if (!ph_i_read_map(r, node, "must be {radius: x, pitch: y}")) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(helix_keys), "helix");
    if (!read_positive_key(r, node, "radius", &f->bend))
        ph_i_missing(r, node, "radius", "must be a length > 0");
    if (!read_positive_key(r, node, "pitch", &f->pitch))
        ph_i_missing(r, node, "pitch", "must be a length > 0");
}

static void read_curvature(ph_i_reader *r, const ph_i_node *node, int shape, ph_filler *f)
{
    static const char rule[] =
        "must have one of arc_angle, radius, helix or persistence_length";
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(curvature_keys), "curvature");
    const ph_i_node *child = NULL;
    for (size_t i = 0; i < 4; i++) {
        const ph_i_node *x = ph_i_get(node, curvature_keys[i]);
        if (!x) continue;
        if (child) {
            ph_i_complain(r, x, PH_EINVAL, "%s", rule);
            return;
        }
        child = x;
        f->curvature = (ph_curvature)(i + 1);
    }
    if (!child) {
        if (node->count == 0) ph_i_reject(r, node, PH_EINVAL, "%s", rule);
    } else if (f->curvature == PH_CURVATURE_ARC_ANGLE) {
        ph_i_read_distribution(r, child, "angle", 0, 360, false, &f->bend);
    } else if (f->curvature == PH_CURVATURE_RADIUS) {
        ph_i_read_distribution(r, child, "radius", 0, 1e60, true, &f->bend);
    } else if (shape == PLATELET) {
        ph_i_complain(r, child, PH_EINVAL, "belongs to fibres only");
    } else if (f->curvature == PH_CURVATURE_WORM) {
        ph_i_read_distribution(r, child, "persistence length", 0, 1e60, true, &f->bend);
    } else if (r->dimension == 2) {
        ph_i_complain(r, child, PH_EINVAL, "belongs to dimension 3 only");
    } else {
        read_helix(r, child, f);
    }
}

/* {angle: degrees} in 2D, {axis: [...]}. */
static void read_axis(ph_i_reader *r, const ph_i_node *map, ph_filler *f)
{
    static const char rule[] = "must be a direction: 2 or 3 numbers, not all zero";
    const ph_i_node *angle = ph_i_get(map, "angle"), *axis = ph_i_get(map, "axis");
    double degrees, v[3] = {0};
    if (r->dimension == 3 && angle) {
        ph_i_complain(r, angle, PH_EINVAL, "belongs to dimension 2: give axis");
    } else if ((angle != NULL) == (axis != NULL)) {
        ph_i_missing(r, map, "axis",
                     r->dimension == 2 ? "give angle or axis, one of both"
                                       : "must be a list of 3 numbers");
    } else if (angle) {
        if (!ph_i_read_number(r, angle, -1e6, 1e6, "must be an angle in degrees",
                              &degrees))
            return;
        f->axis[0] = cos(degrees * acos(-1.0) / 180);
        f->axis[1] = sin(degrees * acos(-1.0) / 180);
    } else if (ph_i_read_numbers(r, axis, (size_t)r->dimension, false, rule, v)) {
        if (v[0] == 0 && v[1] == 0 && v[2] == 0) {
            ph_i_reject(r, axis, PH_EUNPHYSICAL, "%s", rule);
            return;
        }
        memcpy(f->axis, v, sizeof v);
        ph_i_normalise3(f->axis);
    }
}

static void read_tensor(ph_i_reader *r, const ph_i_node *node, ph_filler *f)
{
    static const char rule[] = "must be symmetric, positive semidefinite, with trace 1";
    size_t n = (size_t)r->dimension;
    double *t = f->tensor, trace = 0;
    if (!ph_i_read_list(r, node, n, rule)) return;
    for (size_t i = 0; i < n; i++)
        if (!ph_i_read_numbers(r, node->child[i], n, false, rule, &t[3 * i])) return;
    bool good = true;
    for (size_t i = 0; i < n; i++) {
        trace += t[4 * i];
        good &= t[4 * i] >= 0;
        for (size_t j = 0; j < i; j++)
            good &= t[3 * i + j] == t[3 * j + i] &&
                    t[3 * i + j] * t[3 * i + j] <= t[4 * i] * t[4 * j] * (1 + 1e-9);
    }
    double det = t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) +
                 t[2] * (t[3] * t[7] - t[4] * t[6]);
    if (!good || fabs(trace - 1) > 1e-6 || det < -1e-9)
        ph_i_complain(r, node, PH_EUNPHYSICAL, "%s", rule);
}

static void read_orientation(ph_i_reader *r, const ph_i_node *node, ph_filler *f)
{
    static const char rule[] =
        "must be uniform, {aligned: {...}}, {von_mises_fisher: {...}} or {tensor: [...]}";
    if (ph_i_is_word(node, "uniform")) return;
    if (node->kind != PH_I_MAP || node->count != 1) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
        return;
    }
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(orientation_keys), "orientation");
    const ph_i_node *map, *x;
    if ((map = ph_i_get(node, "aligned"))) {
        f->orientation = PH_ORIENT_ALIGNED;
        if (!ph_i_read_map(r, map, "must be {angle or axis: ..., spread: degrees}"))
            return;
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(aligned_keys), "aligned");
        read_axis(r, map, f);
        if ((x = ph_i_get(map, "spread")))
            ph_i_read_number(r, x, -1e-300, 1e6, "must be an angle >= 0 in degrees",
                             &f->spread);
    } else if ((map = ph_i_get(node, "von_mises_fisher"))) {
        f->orientation = PH_ORIENT_VON_MISES;
        if (!ph_i_read_map(r, map, "must be {axis: ..., concentration: x}")) return;
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(fisher_keys), "von_mises_fisher");
        read_axis(r, map, f);
        x = ph_i_need(r, map, "concentration", "must be a number >= 0");
        if (x)
            ph_i_read_number(r, x, -1e-300, 1e6, "must be a number >= 0 and < 1e6",
                             &f->concentration);
    } else if ((map = ph_i_get(node, "tensor"))) {
        f->orientation = PH_ORIENT_TENSOR;
        read_tensor(r, map, f);
    }
}

static void read_clusters(ph_i_reader *r, const ph_i_node *map, ph_filler *f)
{
    int64_t n = 1;
    if (!ph_i_read_map(r, map, "must be {count: n, radius: x, share: y}")) return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(cluster_keys), "clusters");
    const ph_i_node *count = ph_i_need(r, map, "count", "must be an integer >= 1"),
                    *radius = ph_i_need(r, map, "radius", "must be a length > 0"),
                    *share = ph_i_need(r, map, "share", "must be >= 0 and <= 1");
    if (count) ph_i_read_integer(r, count, 1, 1000000, "must be an integer >= 1", &n);
    if (radius) ph_i_read_positive(r, radius, "must be a length > 0", &f->cluster_radius);
    if (share)
        ph_i_read_number(r, share, -1e-300, nextafter(1, 2), "must be >= 0 and <= 1",
                         &f->cluster_share);
    f->clusters = (int)n;
}

static void read_placement(ph_i_reader *r, const ph_i_node *node, ph_filler *f)
{
    bool overlap = false;
    if (!ph_i_read_map(r, node, "must be {overlap: true}, {gap: x} or {clusters: {...}}"))
        return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(placement_keys), "placement");
    const ph_i_node *o = ph_i_get(node, "overlap"), *gap = ph_i_get(node, "gap"),
                    *clusters = ph_i_get(node, "clusters");
    if (o && !ph_i_read_flag(r, o, &overlap)) return;
    if (overlap && gap)
        ph_i_complain(r, gap, PH_EINVAL,
                      "overlap: true is given too: one of both is admissible");
    else if (gap)
        ph_i_read_number(r, gap, -1e-300, 1e60, "must be a length >= 0", &f->gap);
    else if (o && !overlap)
        f->gap = 0;
    if (clusters) read_clusters(r, clusters, f);
}

static void read_interphase(ph_i_reader *r, const ph_i_node *node, ph_filler *f)
{
    static const char rule[] = "must be {kappa: x} or {thickness: x, material: name}";
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(interphase_keys), "interphase");
    const ph_i_node *kappa = ph_i_get(node, "kappa"),
                    *thickness = ph_i_get(node, "thickness"),
                    *material = ph_i_get(node, "material");
    if (kappa && (thickness || material)) {
        ph_i_complain(r, kappa, PH_EINVAL, "%s, not both", rule);
        return;
    }
    if (kappa) {
        ph_i_read_positive(r, kappa, "the interphase factor must be > 0",
                           &f->interphase_kappa);
        return;
    }
    thickness = ph_i_need(r, node, "thickness", "must be a length > 0");
    material = ph_i_need(r, node, "material", "must be a material");
    if (thickness)
        ph_i_read_positive(r, thickness, "must be a length > 0",
                           &f->interphase_thickness);
    int i = material ? ph_i_read_material(r, material) : -1;
    if (i >= 0) f->interphase_material = i;
}

static void check_filler_keys(ph_i_reader *r, const ph_i_node *map, int shape)
{
    const char *known[24];
    ph_i_names names = {known, 0};
    for (size_t i = 0; i < sizeof common_keys / sizeof *common_keys; i++)
        known[names.count++] = common_keys[i];
    for (size_t i = 0; shape != PARTICLE && i < 3; i++)
        known[names.count++] = long_keys[i];
    for (size_t i = 0; shape == PLATELET && r->dimension == 3 && i < 2; i++)
        known[names.count++] = sheet_keys[i];
    if (shape == PARTICLE) known[names.count++] = "size";
    ph_i_check_keys(r, map, names, ph_i_filler_names.name[shape]);
}

/* The largest extent against the box: what is surely longer is a slip. */
static void check_box(ph_i_reader *r, const ph_i_node *map, const ph_filler *f, int shape)
{
    double box = r->c->size[0], lo, hi, tlo = 1, thi = 1;
    const ph_distribution *d = shape == PARTICLE     ? &f->size
                               : f->length.kind >= 0 ? &f->length
                                                     : &f->aspect_ratio;
    for (int a = 1; a < r->dimension; a++)
        box = fmin(box, r->c->size[a]);
    if (d->kind < 0 || !(box > 0)) return;
    ph_distribution_range(d, &lo, &hi);
    if (d == &f->aspect_ratio && f->thickness.kind >= 0)
        ph_distribution_range(&f->thickness, &tlo, &thi);
    if (lo * tlo > box)
        ph_i_complain(r, map, PH_EUNPHYSICAL,
                      "its fillers are %g long at least, longer than the box (%g): "
                      "enlarge size or shorten them",
                      lo * tlo, box);
}

static void read_filler(ph_i_reader *r, const ph_i_node *map, ph_filler *f)
{
    const ph_i_node *x;
    *f = (ph_filler){.line = map->line,
                     .thickness = not_given,
                     .aspect_ratio = not_given,
                     .length = not_given,
                     .size = not_given,
                     .width = not_given,
                     .bend = not_given,
                     .pitch = not_given,
                     .axis = {1, 0, 0},
                     .gap = NAN};
    if (!ph_i_read_map(r, map, "must be a map such as {shape: platelet, ...}")) return;
    if (!(x = ph_i_need(r, map, "shape", "must be platelet, fibre or particle"))) return;
    int shape = ph_i_read_name(r, x, ph_i_filler_names), i;
    if (shape < 0) return;
    snprintf(f->shape, sizeof f->shape, "%s", ph_i_filler_names.name[shape]);
    check_filler_keys(r, map, shape);
    x = ph_i_need(r, map, "material", "must be a material");
    if (x && (i = ph_i_read_material(r, x)) >= 0) f->material = i;
    size_t before = r->issues->count;
    read_amount(r, map, f);
    if (f->amount == PH_AMOUNT_WEIGHT && ph_i_get(map, "weight_fraction")) {
        need_density(r, map, f->material, "the filler");
        need_density(r, map, r->c->matrix, "the matrix");
    }
    if ((x = ph_i_get(map, "counting")) &&
        (i = ph_i_read_name(r, x, ph_i_counting_names)) >= 0)
        f->counting = (ph_counting)i;
    read_extents(r, map, shape, f);
    if ((x = ph_i_get(map, "curvature")) && shape != PARTICLE)
        read_curvature(r, x, shape, f);
    if ((x = ph_i_get(map, "orientation"))) read_orientation(r, x, f);
    if ((x = ph_i_get(map, "placement"))) read_placement(r, x, f);
    if ((x = ph_i_get(map, "interphase"))) read_interphase(r, x, f);
    if (r->issues->count == before) check_box(r, map, f, shape);
}

ph_status ph_i_read_fillers(ph_i_reader *r, const ph_i_node *list, ph_error *err)
{
    ph_status st = PH_OK;
    double total = 0;
    if (r->dimension == 0) goto out; /* that complaint comes first */
    if (!ph_i_read_list(r, list, 0, "must be a list of fillers")) goto out;
    if (list->count > MAX_FILLERS) {
        ph_i_reject(r, list, PH_EINVAL, "must be at most %d kinds of filler",
                    MAX_FILLERS);
        goto out;
    }
    PH_ALLOC(r->c->fillers, list->count, "fillers");
    r->c->nfillers = (int)list->count;
    for (size_t i = 0; i < list->count; i++) {
        read_filler(r, list->child[i], &r->c->fillers[i]);
        const ph_filler *f = &r->c->fillers[i];
        if (f->amount != PH_AMOUNT_COUNT) total += f->amount_value;
    }
    if (total >= 1)
        ph_i_complain(r, list, PH_EUNPHYSICAL,
                      "the fractions add up to %g: there is no room for the matrix",
                      total);
out:
    return st;
}

void ph_i_take_kappa(ph_i_reader *r)
{
    ph_case *c = r->c;
    for (int i = 0; i < c->nfillers; i++) {
        double kappa = c->fillers[i].interphase_kappa;
        if (kappa == 0) continue;
        if (c->model.kappa != 0 && c->model.kappa != kappa)
            ph_i_complain_line(r, c->fillers[i].line,
                               "microstructure.fillers: one kappa for all fillers is "
                               "admissible, here are %g and %g",
                               c->model.kappa, kappa);
        c->model.kappa = kappa;
    }
}
