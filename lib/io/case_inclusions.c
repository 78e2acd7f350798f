/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

/* What a shape can have. */
enum {
    CENTRE = 1,
    RADIUS = 2,
    FRACTION = 4,
    SEMI_AXES = 8,
    SIZE = 16,
    ANGLE = 32,
    AXIS = 64,
    LENGTH = 128,
    NORMAL = 256,
    FROM = 512,
    TO = 1024
};

static const struct {
    const char *name;
    unsigned bit;
} key_bits[] = {{"centre", CENTRE},       {"radius", RADIUS}, {"fraction", FRACTION},
                {"semi_axes", SEMI_AXES}, {"size", SIZE},     {"angle", ANGLE},
                {"axis", AXIS},           {"length", LENGTH}, {"normal", NORMAL},
                {"from", FROM},           {"to", TO}};
enum { NKEYS = sizeof key_bits / sizeof key_bits[0] };

/* The shapes of the format: in which dimensions, what they need and may have. Radius and
 * fraction stand for each other. */
typedef struct shape_rule {
    const char *name;
    bool in2, in3;
    unsigned needs, may;
} shape_rule;

static const shape_rule shapes[] = {
    {"disk", true, false, CENTRE, RADIUS | FRACTION},
    {"ellipse", true, false, CENTRE | SEMI_AXES, ANGLE},
    {"box", true, true, CENTRE | SIZE, ANGLE},
    {"layer", true, true, NORMAL | FROM | TO, 0},
    {"sphere", false, true, CENTRE, RADIUS | FRACTION},
    {"ellipsoid", false, true, CENTRE | SEMI_AXES, AXIS},
    {"cylinder", false, true, CENTRE | RADIUS | LENGTH, AXIS},
};
enum { NSHAPES = sizeof shapes / sizeof shapes[0] };

static bool fits(const ph_i_reader *r, const shape_rule *shape)
{
    return r->dimension == 2 ? shape->in2 : shape->in3;
}

static const shape_rule *find_shape(const ph_i_node *node)
{
    for (size_t i = 0; node && i < NSHAPES; i++)
        if (ph_i_is_word(node, shapes[i].name)) return &shapes[i];
    return NULL;
}

/* Keys of the shape, or of any where the shape is unknown. */
static void check_keys(ph_i_reader *r, const ph_i_node *map, const shape_rule *shape)
{
    const char *known[NKEYS + 2] = {"shape", "material"};
    ph_i_names names = {known, 2};
    char what[40] = "an inclusion";
    for (size_t k = 0; k < NKEYS; k++)
        if (!shape || ((shape->needs | shape->may) & key_bits[k].bit))
            known[names.count++] = key_bits[k].name;
    if (shape)
        snprintf(what, sizeof what, "a%s %s", strchr("aeiou", shape->name[0]) ? "n" : "",
                 shape->name);
    ph_i_check_keys(r, map, names, what);
}

/* The shape of an inclusion, its keys checked; NULL after a complaint. */
static const shape_rule *read_shape(ph_i_reader *r, const ph_i_node *map)
{
    const char *names[NSHAPES];
    ph_i_names fitting = {names, 0};
    char list[120];
    const ph_i_node *node = ph_i_get(map, "shape");
    const shape_rule *shape = find_shape(node);
    check_keys(r, map, shape);
    if (shape && fits(r, shape)) return shape;
    for (size_t i = 0; i < NSHAPES; i++)
        if (fits(r, &shapes[i])) names[fitting.count++] = shapes[i].name;
    ph_i_join_names(fitting, " or ", list, sizeof list);
    if (!node)
        ph_i_missing(r, map, "shape", "must be %s", list);
    else if (shape)
        ph_i_reject(r, node, PH_EINVAL, "in dimension %d it must be %s", r->dimension,
                    list);
    else
        ph_i_read_name(r, node, fitting);
    return NULL;
}

/* The node of a key that this shape has; a complaint where it must be there and is not. */
static const ph_i_node *key_of(ph_i_reader *r, const ph_i_node *map,
                               const shape_rule *shape, unsigned bit, const char *name,
                               const char *rule)
{
    if (shape->needs & bit) return ph_i_need(r, map, name, rule);
    return shape->may & bit ? ph_i_get(map, name) : NULL;
}

static void read_vectors(ph_i_reader *r, const ph_i_node *map, const shape_rule *shape,
                         ph_inclusion *inc)
{
    bool two = r->dimension == 2;
    const char *centre_rule =
        two ? "must be a list of 2 coordinates" : "must be a list of 3 coordinates";
    const char *size_rule =
        two ? "must be a list of 2 lengths > 0" : "must be a list of 3 lengths > 0";
    static const char axis_rule[] = "must be a list of 3 numbers, not all zero";
    size_t n = (size_t)r->dimension;
    const ph_i_node *node = key_of(r, map, shape, CENTRE, "centre", centre_rule);
    if (node) ph_i_read_numbers(r, node, n, false, centre_rule, inc->centre);
    node = key_of(r, map, shape, SEMI_AXES, "semi_axes", size_rule);
    if (node) ph_i_read_numbers(r, node, n, true, size_rule, inc->semi_axes);
    node = key_of(r, map, shape, SIZE, "size", size_rule);
    if (node) ph_i_read_numbers(r, node, n, true, size_rule, inc->size);
    node = key_of(r, map, shape, AXIS, "axis", axis_rule);
    if (node) ph_i_read_direction(r, node, axis_rule, inc->axis);
}

static void read_scalars(ph_i_reader *r, const ph_i_node *map, const shape_rule *shape,
                         ph_inclusion *inc)
{
    static const char radius_rule[] = "the radius must be > 0";
    static const char length_rule[] = "the length must be > 0";
    static const char angle_rule[] = "must be an angle in degrees";
    const ph_i_node *node = key_of(r, map, shape, RADIUS, "radius", radius_rule);
    if (node) ph_i_read_positive(r, node, radius_rule, &inc->radius);
    node = key_of(r, map, shape, LENGTH, "length", length_rule);
    if (node) ph_i_read_positive(r, node, length_rule, &inc->length);
    node = key_of(r, map, shape, ANGLE, "angle", angle_rule);
    if (node) ph_i_read_number(r, node, -1e6, 1e6, angle_rule, &inc->angle);
}

/* Does the ball of this fraction reach its own periodic image? Then the union is less than
 * the fraction that was asked for. */
static void warn_of_overlap(ph_i_reader *r, const ph_i_node *node, double fraction)
{
    const double *L = r->c->size, pi = acos(-1.0);
    double radius = r->dimension == 2 ? sqrt(fraction * L[0] * L[1] / pi)
                                      : cbrt(fraction * L[0] * L[1] * L[2] * 0.75 / pi);
    for (int a = 0; a < r->dimension; a++) {
        if (!(L[a] > 0) || 2 * radius <= L[a]) continue;
        ph_i_complain(
            r, node, PH_OK,
            "its radius %.6g is more than half of the box (%.6g along axis %d): it "
            "overlaps its periodic image and covers less than this fraction",
            radius, L[a], a + 1);
        return;
    }
}

static void read_radius_or_fraction(ph_i_reader *r, const ph_i_node *map,
                                    ph_inclusion *inc)
{
    static const char rule[] = "the volume fraction must be > 0 and at most 1";
    const ph_i_node *radius = ph_i_get(map, "radius"),
                    *fraction = ph_i_get(map, "fraction");
    if (radius && fraction)
        ph_i_complain(
            r, fraction, PH_EINVAL,
            "radius is given too: one of both is admissible (null takes one away)");
    else if (!radius && !fraction)
        ph_i_missing(r, map, "radius", "give radius or fraction");
    else if (fraction &&
             ph_i_read_number(r, fraction, 0, nextafter(1, 2), rule, &inc->fraction))
        warn_of_overlap(r, fraction, inc->fraction);
}

static void read_layer(ph_i_reader *r, const ph_i_node *map, ph_inclusion *inc)
{
    const char *rule =
        r->dimension == 2 ? "must be axis 1 or 2" : "must be axis 1, 2 or 3";
    static const char bound_rule[] = "must be a coordinate along the normal";
    const ph_i_node *normal = ph_i_need(r, map, "normal", rule);
    const ph_i_node *from = ph_i_need(r, map, "from", bound_rule);
    const ph_i_node *to = ph_i_need(r, map, "to", bound_rule);
    int64_t axis = 0;
    bool good = normal && ph_i_read_integer(r, normal, 1, r->dimension, rule, &axis);
    good &= from && ph_i_read_number(r, from, -1e60, 1e60, bound_rule, &inc->from);
    good &= to && ph_i_read_number(r, to, -1e60, 1e60, bound_rule, &inc->to);
    inc->normal = (int)axis;
    if (!good) return;
    double size = r->c->size[axis - 1];
    if (inc->to <= inc->from)
        ph_i_reject(r, to, PH_EUNPHYSICAL, "must be larger than 'from' (%g)", inc->from);
    else if (size > 0 && inc->to - inc->from > size)
        ph_i_reject(r, to, PH_EUNPHYSICAL,
                    "the layer must not be thicker than the box (%g along axis %d)", size,
                    (int)axis);
}

static void read_inclusion(ph_i_reader *r, const ph_i_node *map, ph_inclusion *inc)
{
    *inc = (ph_inclusion){.line = map->line,
                          .centre = {NAN, NAN, NAN},
                          .radius = NAN,
                          .fraction = NAN,
                          .semi_axes = {NAN, NAN, NAN},
                          .size = {NAN, NAN, NAN},
                          .length = NAN,
                          .from = NAN,
                          .to = NAN};
    if (!ph_i_read_map(r, map, "must be a map such as {shape: disk, ...}")) return;
    const shape_rule *shape = read_shape(r, map);
    const ph_i_node *material = ph_i_need(r, map, "material", "must be a material");
    int i = material ? ph_i_read_material(r, material) : -1;
    if (i >= 0) inc->material = i;
    if (!shape) return;
    snprintf(inc->shape, sizeof inc->shape, "%s", shape->name);
    if (strcmp(shape->name, "ellipsoid") == 0) inc->axis[0] = 1;
    if (strcmp(shape->name, "cylinder") == 0) inc->axis[2] = 1;
    read_vectors(r, map, shape, inc);
    read_scalars(r, map, shape, inc);
    if (shape->may & FRACTION) read_radius_or_fraction(r, map, inc);
    if (shape->needs & NORMAL) read_layer(r, map, inc);
}

ph_status ph_i_read_inclusions(ph_i_reader *r, const ph_i_node *list, ph_error *err)
{
    ph_status st = PH_OK;
    if (r->dimension == 0) goto out; /* that complaint comes first */
    if (!ph_i_read_list(r, list, 0, "must be a list of shapes")) goto out;
    PH_ALLOC(r->c->inclusions, list->count, "inclusions");
    r->c->ninclusions = (int)list->count;
    for (size_t i = 0; i < list->count; i++)
        read_inclusion(r, list->child[i], &r->c->inclusions[i]);
out:
    return st;
}
