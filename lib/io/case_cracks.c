/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cracks and sequence: prescribed damage. */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_POINTS = 100000, MAX_STEPS = 100000 };

static const char *const line_keys[] = {"from", "to", "points"};
static const char *const plane_kinds[] = {"disk", "ellipse", "polygon", "random"};
static const char *const disk_keys[] = {"centre", "normal", "radius"};
static const char *const ellipse_keys[] = {"centre", "normal", "axis", "semi_axes"};
static const char *const random_keys[] = {"density",     "count", "length",
                                          "orientation", "angle", "normal"};
static const char *const orientations[] = {"random", "aligned"};
static const char *const sequence_keys[] = {"crack_growth", "density"};
static const char *const growth_keys[] = {"crack", "tip", "lengths"};

void ph_i_cracks_free(ph_case *c)
{
    for (ptrdiff_t i = 0; i < c->ncracks; i++)
        free(c->cracks[i].point);
    free(c->cracks);
    free(c->sequence.value);
    free(c->sequence.which);
}

/* ---- points ------------------------------------------------------------------------------ */

static bool read_point(ph_i_reader *r, const ph_i_node *node, double out[3])
{
    out[2] = 0.0;
    return ph_i_read_numbers(r, node, (size_t)r->dimension, false,
                             r->dimension == 2 ? "must be a list of 2 coordinates"
                                               : "must be a list of 3 coordinates",
                             out);
}

static bool same_point(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static ph_status read_points(ph_i_reader *r, const ph_i_node *list, size_t least,
                             const char *rule, ph_crack_entry *k, ph_error *err)
{
    ph_status st = PH_OK;
    if (!ph_i_read_list(r, list, 0, rule)) return PH_OK;
    if (list->count < least || list->count > MAX_POINTS) {
        ph_i_reject(r, list, PH_EINVAL, "%s", rule);
        return PH_OK;
    }
    PH_ALLOC(k->point, list->count, "the points of a crack");
    k->npoints = (ptrdiff_t)list->count;
    for (size_t i = 0; i < list->count; i++) {
        if (!read_point(r, list->child[i], k->point[i])) return PH_OK;
        if (i > 0 && same_point(k->point[i], k->point[i - 1]))
            ph_i_complain(r, list->child[i], PH_EUNPHYSICAL,
                          "is the same as the point before");
    }
out:
    return st;
}

/* {from, to} or {points}, 2D. */
static ph_status read_line(ph_i_reader *r, const ph_i_node *map, ph_crack_entry *k,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *points = ph_i_get(map, "points");
    k->kind = PH_CRACKS_LINE;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(line_keys), "a crack line");
    if (points && (ph_i_get(map, "from") || ph_i_get(map, "to")))
        ph_i_complain(r, points, PH_EINVAL, "from and to are given too: one of both");
    if (points)
        return read_points(r, points, 2, "must be a list of 2 points or more", k, err);
    const ph_i_node *from = ph_i_need(r, map, "from", "must be a point"),
                    *to = ph_i_need(r, map, "to", "must be a point");
    PH_ALLOC(k->point, 2, "the points of a crack");
    k->npoints = 2;
    if (!from || !to || !read_point(r, from, k->point[0]) ||
        !read_point(r, to, k->point[1]))
        return PH_OK;
    if (same_point(k->point[0], k->point[1]))
        ph_i_reject(r, to, PH_EUNPHYSICAL, "must be another point than 'from'");
out:
    return st;
}

/* ---- plane cracks in 3D ------------------------------------------------------------------ */

static void read_ellipse(ph_i_reader *r, const ph_i_node *map, bool disk,
                         ph_crack_entry *k)
{
    static const char normal_rule[] = "must be a list of 3 numbers, not all zero";
    static const char size_rule[] = "must be a list of 2 lengths > 0";
    static const char radius_rule[] = "the radius must be > 0";
    static const char centre_rule[] = "must be a list of 3 coordinates";
    k->kind = PH_CRACKS_ELLIPSE;
    k->disk = disk;
    if (!ph_i_read_map(r, map, "must be a map such as {centre: [0.5, 0.5, 0.5], ...}"))
        return;
    if (disk)
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(disk_keys), "a disk crack");
    else
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(ellipse_keys), "an ellipse crack");
    const ph_i_node *centre = ph_i_need(r, map, "centre", centre_rule),
                    *normal = ph_i_need(r, map, "normal", normal_rule), *size, *axis;
    if (centre) ph_i_read_numbers(r, centre, 3, false, centre_rule, k->centre);
    bool good = normal && ph_i_read_direction(r, normal, normal_rule, k->normal);
    if (disk) {
        size = ph_i_need(r, map, "radius", radius_rule);
        if (size) ph_i_read_positive(r, size, radius_rule, &k->semi_axes[0]);
        k->semi_axes[1] = k->semi_axes[0];
        return;
    }
    size = ph_i_need(r, map, "semi_axes", size_rule);
    if (size) ph_i_read_numbers(r, size, 2, true, size_rule, k->semi_axes);
    axis = ph_i_need(r, map, "axis", "must be the direction of the first semi-axis");
    if (!axis || !ph_i_read_direction(r, axis, normal_rule, k->axis) || !good) return;
    double nn = 0.0, aa = 0.0, na = 0.0;
    for (int d = 0; d < 3; d++) {
        nn += k->normal[d] * k->normal[d];
        aa += k->axis[d] * k->axis[d];
        na += k->normal[d] * k->axis[d];
    }
    if (fabs(na) > 1e-6 * sqrt(nn * aa))
        ph_i_reject(r, axis, PH_EUNPHYSICAL, "must be at right angles to the normal");
}

static ph_status read_polygon(ph_i_reader *r, const ph_i_node *list, ph_crack_entry *k,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_cracks trial = {0};
    ph_error why = PH_ERROR_INIT;
    size_t before = r->invalid + r->unphysical;
    k->kind = PH_CRACKS_POLYGON;
    PH_TRY(read_points(r, list, 3, "must be a list of 3 corners or more", k, err));
    if (r->invalid + r->unphysical > before) goto out;
    st = ph_cracks_add_polygon(&trial, k->npoints, (const double(*)[3])k->point, &why);
    if (st == PH_EINVAL) {
        ph_i_complain(r, list, PH_EUNPHYSICAL, "%s", why.msg);
        st = PH_OK;
    } else if (st != PH_OK && err) {
        *err = why;
    }
out:
    ph_cracks_free(&trial);
    return st;
}

/* ---- random cracks ----------------------------------------------------------------------- */

static void read_random_amount(ph_i_reader *r, const ph_i_node *map, ph_crack_entry *k)
{
    static const char rule[] = "the crack density must be >= 0 and at most 10";
    const ph_i_node *density = ph_i_get(map, "density"), *count = ph_i_get(map, "count");
    int64_t n = -1;
    if (density && count)
        ph_i_complain(r, count, PH_EINVAL, "density is given too: one of both");
    else if (!density && !count)
        ph_i_missing(r, map, "density", "give density or count");
    else if (density)
        ph_i_read_number(r, density, -1e-300, nextafter(10, 11), rule, &k->density);
    else if (ph_i_read_integer(r, count, 0, 1000000, "must be an integer from 0 to 1e6",
                               &n))
        k->count = (ptrdiff_t)n;
}

/* The shortest crack must not be longer than the cell is. */
static void read_length(ph_i_reader *r, const ph_i_node *node, ph_crack_entry *k)
{
    const double *size = r->c->size;
    const double side = fmax(size[0], fmax(size[1], r->dimension == 3 ? size[2] : 0.0));
    size_t before = r->invalid + r->unphysical;
    ph_i_read_distribution(r, node, "crack length", 0, 1e60, true, &k->length);
    if (r->invalid + r->unphysical > before || !(side > 0.0)) return;
    if (ph_distribution_quantile(&k->length, 0.0) > side)
        ph_i_reject(r, node, PH_EUNPHYSICAL,
                    "the crack length must be at most the longest side of the cell, %g",
                    side);
}

static void read_random(ph_i_reader *r, const ph_i_node *map, ph_crack_entry *k)
{
    static const char normal_rule[] = "must be a list of 3 numbers, not all zero";
    bool two = r->dimension == 2;
    const ph_i_node *node;
    int i;
    k->kind = PH_CRACKS_RANDOM;
    if (!ph_i_read_map(r, map, "must be a map such as {density: 0.1, length: 0.05}"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(random_keys), "random cracks");
    read_random_amount(r, map, k);
    if ((node = ph_i_need(r, map, "length", "must be a length or a distribution")))
        read_length(r, node, k);
    if ((node = ph_i_get(map, "orientation")) &&
        (i = ph_i_read_name(r, node, (ph_i_names)PH_I_NAMES(orientations))) >= 0)
        k->aligned = i == 1;
    if ((node = ph_i_get(map, "angle"))) {
        if (!two || !k->aligned)
            ph_i_complain(r, node, PH_EINVAL, "belongs to aligned cracks in 2D");
        else
            ph_i_read_number(r, node, -1e6, 1e6, "must be an angle in degrees",
                             &k->angle);
    }
    if ((node = ph_i_get(map, "normal"))) {
        if (two || !k->aligned)
            ph_i_complain(r, node, PH_EINVAL, "belongs to aligned cracks in 3D");
        else
            ph_i_read_direction(r, node, normal_rule, k->normal);
    }
}

/* ---- cracks ------------------------------------------------------------------------------ */

static ph_status read_crack(ph_i_reader *r, const ph_i_node *map, ph_crack_entry *k,
                            ph_error *err)
{
    static const char rule2[] = "must be {from, to}, {points} or {random: {...}}";
    static const char rule3[] =
        "must be {disk: {...}}, {ellipse: {...}}, {polygon: [...]} or {random: {...}}";
    const char *rule = r->dimension == 2 ? rule2 : rule3;
    *k = (ph_crack_entry){.line = map->line,
                          .axis = {NAN, NAN, NAN},
                          .normal = {0, 0, 1},
                          .density = NAN,
                          .count = -1};
    if (!ph_i_read_map(r, map, rule)) return PH_OK;
    const ph_i_node *child = ph_i_get(map, "random");
    if (!child && r->dimension == 2) return read_line(r, map, k, err);
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(plane_kinds), "a crack");
    if (map->count != 1) {
        ph_i_complain(r, map, PH_EINVAL, "%s", rule);
        return PH_OK;
    }
    if (child)
        read_random(r, child, k);
    else if ((child = ph_i_get(map, "polygon")))
        return read_polygon(r, child, k, err);
    else if ((child = ph_i_get(map, "disk")))
        read_ellipse(r, child, true, k);
    else if ((child = ph_i_get(map, "ellipse")))
        read_ellipse(r, child, false, k);
    return PH_OK;
}

/* What has no bonds to cut. */
static void check_model(ph_i_reader *r, const ph_i_node *cracks)
{
    const ph_model_params *m = &r->c->model;
    const char *kind = r->c->constraint.kind;
    if (strcmp(m->kind, "local") == 0 || m->points == PH_POINTS_STRESS)
        ph_i_complain(r, cracks, PH_EINVAL,
                      "cracks cut bonds between nodes: take model nosb with points nodes "
                      "(or auto), or model bond");
    if (m->stabilisation == PH_STABILISE_SUBPOINT)
        ph_i_complain(r, cracks, PH_EINVAL,
                      "sub-points know nothing of broken bonds: take stabilisation auto "
                      "or {spectral: x}");
    if (strcmp(kind, "voigt") == 0 || strcmp(kind, "reuss") == 0)
        ph_i_complain(r, cracks, PH_EINVAL,
                      "constraint %s solves no equations and knows nothing of cracks",
                      kind);
}

/* ---- sequence ---------------------------------------------------------------------------- */

/* Steps from 0 to below `most`; the rule says so. */
static ph_status put_steps(ph_i_reader *r, const ph_i_node *list, double most,
                           const char *rule, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence_entry *q = &r->c->sequence;
    size_t n = list->kind == PH_I_LIST ? list->count : 0;
    if (n < 1 || n > MAX_STEPS) {
        ph_i_reject(r, list, PH_EINVAL, "%s", rule);
        return PH_OK;
    }
    PH_ALLOC(q->value, n, "the steps of the sequence");
    q->nsteps = (int)n;
    for (size_t i = 0; i < n; i++) {
        double least = i ? q->value[i - 1] : 0.0;
        if (!ph_i_read_number(r, list->child[i], -1e-300, most, rule, &q->value[i]))
            return PH_OK;
        if (q->value[i] < least)
            ph_i_reject(r, list->child[i], PH_EUNPHYSICAL,
                        "must not be less than the step before (%g): bonds do not heal",
                        least);
    }
out:
    return st;
}

/* [from, step, to]: the last step may be shorter. */
static ph_status put_range(ph_i_reader *r, const ph_i_node *list, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence_entry *q = &r->c->sequence;
    static const char rule[] =
        "must be [from, step, to] with 0 <= from <= to, step > 0 and at most 1e5 steps";
    double x[3];
    if (!ph_i_read_numbers(r, list, 3, false, rule, x)) return PH_OK;
    double steps = (x[2] - x[0]) / x[1];
    if (!(x[0] >= 0.0) || !(x[1] > 0.0) || !(x[2] >= x[0]) || !(steps < MAX_STEPS)) {
        ph_i_reject(r, list, PH_EUNPHYSICAL, "%s", rule);
        return PH_OK;
    }
    int n = (int)ceil(steps * (1.0 - 1e-9)) + 1;
    PH_ALLOC(q->value, n, "the steps of the sequence");
    q->nsteps = n;
    for (int i = 0; i < n; i++)
        q->value[i] = i == n - 1 ? x[2] : x[0] + i * x[1];
    memcpy(q->range, x, sizeof x);
out:
    return st;
}

static bool put_which(ph_i_reader *r, const ph_i_node *node)
{
    ph_sequence_entry *q = &r->c->sequence;
    char rule[80];
    int64_t i;
    snprintf(rule, sizeof rule, "must be the number of a crack, 0 to %td, or all",
             r->c->ncracks - 1);
    if (!ph_i_read_integer(r, node, 0, r->c->ncracks - 1, rule, &i)) return false;
    ph_crack_kind kind = r->c->cracks[i].kind;
    if (kind == PH_CRACKS_POLYGON || kind == PH_CRACKS_RANDOM) {
        ph_i_complain(r, node, PH_EINVAL,
                      "crack %d is %s: lines, disks and ellipses grow", (int)i,
                      kind == PH_CRACKS_POLYGON ? "a polygon" : "a random population");
        return false;
    }
    for (ptrdiff_t k = 0; k < q->nwhich; k++)
        if (q->which[k] == (int)i) {
            ph_i_complain(r, node, PH_EINVAL, "crack %d is named twice", (int)i);
            return false;
        }
    q->which[q->nwhich++] = (int)i;
    return true;
}

static ph_status read_which(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence_entry *q = &r->c->sequence;
    const ph_i_node *node = ph_i_get(map, "crack");
    bool all = !node || ph_i_is_word(node, "all");
    size_t n = node && node->kind == PH_I_LIST ? node->count : 1;
    if (all) {
        for (ptrdiff_t i = 0; i < r->c->ncracks; i++)
            if (r->c->cracks[i].kind > PH_CRACKS_ELLIPSE)
                ph_i_complain(r, node ? node : map, PH_EINVAL,
                              "crack %td cannot grow: name those that do (crack: [0])",
                              i);
        return PH_OK;
    }
    PH_ALLOC(q->which, n, "the cracks that grow");
    for (size_t i = 0; i < n; i++)
        if (!put_which(r, node->kind == PH_I_LIST ? node->child[i] : node)) return PH_OK;
out:
    return st;
}

static ph_status read_growth(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence_entry *q = &r->c->sequence;
    static const char rule[] = "must be [from, step, to]";
    const ph_i_node *node;
    int i;
    q->kind = PH_SEQUENCE_GROWTH;
    if (!ph_i_read_map(r, map, "must be a map such as {crack: 0, lengths: [0, 0.1, 1]}"))
        return PH_OK;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(growth_keys), "crack_growth");
    PH_TRY(read_which(r, map, err));
    if ((node = ph_i_get(map, "tip")) &&
        (i = ph_i_read_name(r, node, ph_i_tip_names)) >= 0)
        q->tip = (ph_crack_tip)i;
    node = ph_i_need(r, map, "lengths", rule);
    if (node && node->kind == PH_I_MAP) {
        static const char *const keys[] = {"list"};
        ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(keys), "lengths");
        node = ph_i_need(r, node, "list", "must be a list of lengths");
        if (node)
            PH_TRY(put_steps(r, node, 1e60,
                             "must be a list of 1 to 1e5 numbers that do not fall", err));
    } else if (node) {
        PH_TRY(put_range(r, node, err));
    }
out:
    return st;
}

static void check_density(ph_i_reader *r, const ph_i_node *node)
{
    ptrdiff_t random = 0;
    for (ptrdiff_t i = 0; i < r->c->ncracks; i++)
        random += r->c->cracks[i].kind == PH_CRACKS_RANDOM;
    if (random != 1)
        ph_i_complain(r, node, PH_EINVAL,
                      "a rising density wants one random population among the cracks, "
                      "there are %td",
                      random);
    else if (r->c->cracks[r->c->ncracks - 1].kind != PH_CRACKS_RANDOM)
        ph_i_complain(r, node, PH_EINVAL, "the random cracks must be the last entry");
}

static ph_status read_sequence(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sequence_entry *q = &r->c->sequence;
    static const char rule[] =
        "must be {crack_growth: {...}} or {density: [0.05, 0.1, ...]}";
    if (!map) return PH_OK;
    q->line = map->line;
    if (!ph_i_read_map(r, map, rule)) return PH_OK;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(sequence_keys), "a sequence");
    const ph_i_node *growth = ph_i_get(map, "crack_growth"),
                    *density = ph_i_get(map, "density");
    if ((growth != NULL) == (density != NULL)) {
        ph_i_complain(r, map, PH_EINVAL, "%s", rule);
    } else if (r->c->ncracks == 0) {
        ph_i_complain(r, map, PH_EINVAL, "there are no cracks");
    } else if (growth) {
        PH_TRY(read_growth(r, growth, err));
    } else {
        q->kind = PH_SEQUENCE_DENSITY;
        check_density(r, density);
        PH_TRY(put_steps(
            r, density, nextafter(10, 11),
            "must be a list of 1 to 1e5 numbers from 0 to 10 that do not fall", err));
    }
out:
    return st;
}

ph_status ph_i_read_cracks(ph_i_reader *r, const ph_i_node *root, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *list = ph_i_get(root, "cracks");
    r->c->sequence.range[0] = NAN;
    if (r->dimension == 0) return PH_OK; /* that complaint comes first */
    if (list && ph_i_read_list(r, list, 0, "must be a list of cracks")) {
        PH_ALLOC(r->c->cracks, list->count, "cracks");
        r->c->ncracks = (ptrdiff_t)list->count;
        for (size_t i = 0; i < list->count; i++)
            PH_TRY(read_crack(r, list->child[i], &r->c->cracks[i], err));
        if (list->count > 0) check_model(r, list);
    }
    const ph_i_node *model = ph_i_get(root, "model");
    bool tips = model && model->kind == PH_I_MAP && ph_i_get(model, "crack_tips");
    if (!list && tips)
        ph_i_complain(r, ph_i_get(model, "crack_tips"), PH_EINVAL,
                      "belongs to cracks, which are not there");
    if (!list || list->kind == PH_I_LIST)
        PH_TRY(read_sequence(r, ph_i_get(root, "sequence"), err));
out:
    return st;
}
