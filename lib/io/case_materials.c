/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_MATERIALS = 4096 };

static const char *const material_keys[] = {"E",     "nu",   "stiffness", "rotation",
                                            "euler", "void", "density",   "bulk",
                                            "shear", "shift"};
static const char *const rotation_keys[] = {"axis", "angle"};

static double radians(double degrees)
{
    return degrees * (acos(-1.0) / 180.0);
}

/* R = exp(angle [axis]x), Rodrigues; axis of any length > 0. */
static void rotation_about(const double axis[3], double angle, double R[9])
{
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double n[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    double c = cos(radians(angle)), s = sin(radians(angle));
    const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[3 * i + j] =
                (i == j ? c : 0) + (1 - c) * n[i] * n[j] + s * cross[3 * i + j];
}

static void product(const double a[9], const double b[9], double ab[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            ab[3 * i + j] =
                a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/* R = Rz(phi1) Rx(Phi) Rz(phi2): brings the sample axes onto the crystal's (Bunge's angles). */
static void rotation_euler(const double degrees[3], double R[9])
{
    static const double x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
    double first[9], second[9], third[9], both[9];
    rotation_about(z, degrees[0], first);
    rotation_about(x, degrees[1], second);
    rotation_about(z, degrees[2], third);
    product(first, second, both);
    product(both, third, R);
}

static bool read_axis_angle(ph_i_reader *r, const ph_i_node *node, double R[9])
{
    static const char rule[] = "must be {axis: [x, y, z], angle: degrees}";
    static const char axis_rule[] = "must be a list of 3 numbers, not all zero";
    double axis[3], angle;
    if (!ph_i_read_map(r, node, rule)) return false;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(rotation_keys), "rotation");
    const ph_i_node *a = ph_i_need(r, node, "axis", axis_rule);
    const ph_i_node *b = ph_i_need(r, node, "angle", "must be an angle in degrees");
    bool good = a && ph_i_read_direction(r, a, axis_rule, axis);
    good &= b && ph_i_read_number(r, b, -1e6, 1e6, "must be an angle in degrees", &angle);
    if (good) rotation_about(axis, angle, R);
    return good;
}

bool ph_i_read_rotation(ph_i_reader *r, const ph_i_node *map, double R[9], bool *good)
{
    const ph_i_node *rotation = ph_i_get(map, "rotation"),
                    *euler = ph_i_get(map, "euler");
    double degrees[3];
    *good = true;
    if (rotation && euler) {
        ph_i_complain(r, euler, PH_EINVAL,
                      "rotation is given too: one of both is admissible");
        *good = false;
    } else if (rotation) {
        *good = read_axis_angle(r, rotation, R);
    } else if (euler) {
        *good = ph_i_read_numbers(
            r, euler, 3, false, "must be 3 angles in degrees (phi1, Phi, phi2)", degrees);
        if (*good) rotation_euler(degrees, R);
    }
    return (rotation || euler) && *good;
}

bool ph_i_read_matrix(ph_i_reader *r, const ph_i_node *node, double voigt[36])
{
    static const char rule[] = "must be 6 rows of 6 numbers (Voigt, engineering shear)";
    if (!ph_i_read_list(r, node, 6, rule)) return false;
    bool good = true;
    for (size_t i = 0; i < 6; i++)
        good &= ph_i_read_numbers(r, node->child[i], 6, false, rule, &voigt[6 * i]);
    return good;
}

const char *ph_i_without_name(const ph_error *why, const char *name)
{
    size_t skip = strlen("material '': ") + strlen(name);
    return strncmp(why->msg, "material '", 10) == 0 && strlen(why->msg) > skip
               ? why->msg + skip
               : why->msg;
}

static void read_anisotropic(ph_i_reader *r, const ph_i_node *map, const ph_i_node *node,
                             ph_material *out)
{
    double voigt[36], R[9];
    bool good_rotation;
    ph_error why = PH_ERROR_INIT;
    bool rotated = ph_i_read_rotation(r, map, R, &good_rotation);
    if (!ph_i_read_matrix(r, node, voigt) || !good_rotation) return;
    if (ph_material_anisotropic(out->name, voigt, rotated ? R : NULL, out, &why) != PH_OK)
        ph_i_complain(r, node, PH_EUNPHYSICAL, "%s", ph_i_without_name(&why, out->name));
}

static void read_isotropic(ph_i_reader *r, const ph_i_node *map, ph_material *out)
{
    static const char E_rule[] = "Young's modulus must be a number > 0";
    static const char nu_rule[] = "Poisson's ratio must be > -1 and < 0.5";
    const ph_i_node *E_node = ph_i_need(r, map, "E", E_rule);
    const ph_i_node *nu_node = ph_i_need(r, map, "nu", nu_rule);
    double E, nu;
    ph_error why = PH_ERROR_INIT;
    bool good = E_node && ph_i_read_positive(r, E_node, E_rule, &E);
    good &= nu_node && ph_i_read_number(r, nu_node, -1, 0.5, nu_rule, &nu);
    if (good && ph_material_isotropic(out->name, E, nu, out, &why) != PH_OK)
        ph_i_complain(r, map, PH_EUNPHYSICAL, "%s", ph_i_without_name(&why, out->name));
}

void ph_i_refuse_others(ph_i_reader *r, const ph_i_node *map, const char *kind,
                        ph_i_names allowed)
{
    char list[100];
    ph_i_join_names(allowed, " and ", list, sizeof list);
    for (size_t i = 0; i < map->count; i++) {
        const ph_i_node *node = map->child[i];
        bool known = false;
        bool fits = strcmp(node->key, kind) == 0 || strcmp(node->key, "void") == 0;
        for (size_t k = 0; k < sizeof material_keys / sizeof *material_keys; k++)
            known |= strcmp(material_keys[k], node->key) == 0;
        for (size_t k = 0; k < allowed.count; k++)
            fits |= strcmp(allowed.name[k], node->key) == 0;
        if (known && !fits && !ph_i_is_null(node))
            ph_i_complain(r, node, PH_EINVAL, "does not go with %s, which %s%s", kind,
                          allowed.count ? "can have " : "stands alone", list);
    }
}

static void read_elastic(ph_i_reader *r, const ph_i_node *map, ph_material *out)
{

    static const char *const with_matrix[] = {"rotation", "euler", "density"};
    static const char *const with_E[] = {"nu", "density"};
    const ph_i_node *hole = ph_i_get(map, "void"), *matrix = ph_i_get(map, "stiffness");
    bool is_void = false;
    if (hole && !ph_i_read_flag(r, hole, &is_void)) return;
    if (is_void) {
        ph_i_refuse_others(r, map, "void", (ph_i_names){NULL, 0});
        *out = ph_material_void(out->name);
    } else if (matrix) {
        ph_i_refuse_others(r, map, "stiffness", (ph_i_names)PH_I_NAMES(with_matrix));
        read_anisotropic(r, map, matrix, out);
    } else if (!ph_i_get(map, "E") && !ph_i_get(map, "nu")) {
        ph_i_complain(r, map, PH_EINVAL,
                      "says nothing: must have E and nu, or stiffness, or void: true");
    } else {
        ph_i_refuse_others(r, map, "E", (ph_i_names)PH_I_NAMES(with_E));
        read_isotropic(r, map, out);
    }
}

static ph_status read_material(ph_i_reader *r, const ph_i_node *map, ph_material *out,
                               ph_case_relaxation *relaxation, ph_error *err)
{
    static const char rule[] = "must be a map such as {E: 70, nu: 0.3}";
    static const char density_rule[] = "the density must be a number > 0";
    ph_status st = PH_OK;
    double density = NAN;
    if (!ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(material_keys), "a material");
    const ph_i_node *rho = ph_i_get(map, "density");
    if (rho) ph_i_read_positive(r, rho, density_rule, &density);
    if (ph_i_is_relaxing(map))
        PH_TRY(ph_i_read_relaxation(r, map, out, relaxation, err));
    else
        read_elastic(r, map, out);
    out->density = density;
out:
    return st;
}

static void read_material_name(ph_i_reader *r, const ph_i_node *node, ph_material *out)
{
    ph_i_node name = {.kind = PH_I_SCALAR,
                      .text = node->key,
                      .line = node->line,
                      .from_set = node->from_set,
                      .parent = node->parent,
                      .key = node->key};
    if (!ph_i_read_text(r, &name, sizeof out->name, out->name)) return;
    if (node->key[0] == 0 || strpbrk(node->key, ".="))
        ph_i_reject(r, &name, PH_EINVAL,
                    "a name must not be empty nor contain '.' or '='");
}

ph_status ph_i_read_materials(ph_i_reader *r, const ph_i_node *root, ph_error *err)
{
    static const char rule[] = "must be a map of at least one material";
    ph_status st = PH_OK;
    const ph_i_node *map = ph_i_need(r, root, "materials", rule);
    if (!map) goto out;
    if (map->kind != PH_I_MAP || map->count == 0) {
        ph_i_reject(r, map, PH_EINVAL, "%s", rule);
        goto out;
    }
    if (map->count > MAX_MATERIALS) {
        ph_i_complain(r, map, PH_EINVAL, "%zu materials: at most %d are admissible",
                      map->count, MAX_MATERIALS);
        goto out;
    }
    PH_ALLOC(r->c->materials, map->count, "materials");
    PH_ALLOC(r->c->relaxation, map->count, "materials");
    PH_ALLOC(r->material_names, map->count, "materials");
    r->c->nmaterials = (int)map->count;
    bool solid = false;
    for (size_t i = 0; i < map->count; i++) {
        ph_material *m = &r->c->materials[i];
        m->density = NAN;
        read_material_name(r, map->child[i], m);
        PH_TRY(read_material(r, map->child[i], m, &r->c->relaxation[i], err));
        solid |= !m->is_void;
        r->material_names[i] = map->child[i]->key;
    }
    r->materials = (ph_i_names){r->material_names, map->count};
    if (!solid) ph_i_complain(r, map, PH_EUNPHYSICAL, "every material is void");
out:
    return st;
}
