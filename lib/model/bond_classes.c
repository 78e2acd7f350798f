/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/bond_classes.h"

#include <perihom/bond.h>

#include <math.h>

static const double nu_tolerance = 1e-3;

static ph_status check_material(const ph_material *m, ph_kinematics kin, ph_error *err)
{
    ph_status st = PH_OK;
    double nu = ph_bond_poisson(kin);
    const char *where = kin == PH_PLANE_STRESS   ? "plane stress"
                        : kin == PH_PLANE_STRAIN ? "plane strain"
                                                 : "three dimensions";
    if (m->is_void) return PH_OK;
    PH_CHECK(m->is_isotropic, PH_EUNPHYSICAL,
             "material '%s' is anisotropic, and central bonds are isotropic: take model "
             "nosb or local",
             m->name);
    PH_CHECK(
        fabs(m->nu - nu) <= nu_tolerance, PH_EUNPHYSICAL,
        "material '%s' has nu = %g, but bonds have nu = %.4g in %s (tolerance %g) "
        "whatever their stiffness: give nu = %.4g, or take model nosb or local, which "
        "have any",
        m->name, m->nu, nu, where, nu_tolerance, nu);
out:
    if (st != PH_OK)
        ph_error_about(err, m->is_isotropic ? "materials.%s.nu" : "materials.%s",
                       m->name);
    return st;
}

/* The solid material of most cells in no filler; ties: the first. */
static int find_matrix(const ph_microstructure *m, ptrdiff_t *count)
{
    int best = -1;
    for (ptrdiff_t x = 0; x < ph_grid_cells(&m->grid); x++)
        if (!m->owner || m->owner[x] <= 0) count[m->phase[x]]++;
    for (int i = 0; i < m->nmaterials; i++)
        if (!m->materials[i].is_void && count[i] > 0 &&
            (best < 0 || count[i] > count[best]))
            best = i;
    return best;
}

static double cook(const ph_bond_classes *c, ph_bond_recipe r)
{
    if (r.first < 0) return 0.0;
    double a = c->E[r.first], b = r.second < 0 ? a : c->E[r.second];
    return r.factor * (r.second < 0 ? a : 2.0 * a * b / (a + b));
}

static ph_bond_recipe interphase(const ph_bond_classes *c, double kappa, int a, int b)
{
    int ma = a / 2, mb = b / 2;
    double Ea = c->E[ma], Eb = c->E[mb];
    if (Ea == 0.0 || Eb == 0.0) return (ph_bond_recipe){-1, -1, 0.0};
    if (ma == mb) return (ph_bond_recipe){ma, -1, 1.0};
    if (!(kappa > 0.0)) return (ph_bond_recipe){ma, mb, 1.0};
    bool a_filler = a % 2, b_filler = b % 2;
    int matrix = a_filler == b_filler ? (Ea <= Eb ? ma : mb) : a_filler ? mb : ma;
    return (ph_bond_recipe){matrix, -1, kappa};
}

static ph_bond_recipe softer(const ph_bond_classes *c, ph_bond_recipe a, ph_bond_recipe b)
{
    return cook(c, a) <= cook(c, b) ? a : b;
}

/* Bonds of two fillers: no stiffer than the matrix, and than either one's interphase. */
static ph_bond_recipe agglomeration(const ph_bond_classes *c, double kappa, int a, int b)
{
    ph_bond_recipe ra = {a / 2, -1, 1.0}, rb = {b / 2, -1, 1.0};
    if (c->E[a / 2] == 0.0 || c->E[b / 2] == 0.0) return (ph_bond_recipe){-1, -1, 0.0};
    if (c->matrix < 0) return softer(c, softer(c, ra, rb), interphase(c, kappa, a, b));
    int m = 2 * c->matrix;
    ph_bond_recipe matrix = {c->matrix, -1, 1.0};
    ph_bond_recipe worse =
        softer(c, interphase(c, kappa, m, a), interphase(c, kappa, m, b));
    return softer(c, matrix, worse);
}

static void fill_tables(ph_bond_classes *c, double kappa)
{
    for (int a = 0; a < c->count; a++)
        for (int b = 0; b < c->count; b++) {
            int at = a * c->count + b, low = a < b ? a : b, high = a < b ? b : a;
            /* where two moduli are equal both ends of a bond take the same one */
            c->how[at] = interphase(c, kappa, low, high);
            c->how_apart[at] = agglomeration(c, kappa, low, high);
            c->pair[at] = cook(c, c->how[at]);
            c->apart[at] = cook(c, c->how_apart[at]);
        }
}

static void label(ph_bond_classes *c, const ph_microstructure *m, const ptrdiff_t *source)
{
    for (ptrdiff_t x = 0; x < c->cells; x++) {
        ptrdiff_t from = source ? source[x] : x;
        int owner = from >= 0 && m->owner && m->owner[from] > 0 ? m->owner[from] : 0;
        int material = from >= 0    ? m->phase[from]
                       : from == -1 ? c->materials
                                    : (int)(-2 - from);
        c->owner[x] = owner;
        c->class[x] = 2 * material + (owner > 0);
    }
}

ph_status ph_i_bond_classes_new(const ph_microstructure *m, double kappa,
                                const ptrdiff_t *source, ptrdiff_t cells,
                                ph_bond_classes **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_bond_classes *c = NULL;
    ptrdiff_t *counts = NULL;
    *out = NULL;
    PH_CHECK_KEY(isnan(kappa) || (isfinite(kappa) && kappa >= 0.0), PH_EINVAL,
                 "model.kappa", "kappa must be > 0, got %g", kappa);
    PH_ALLOC(c, 1, "bond classes");
    PH_ALLOC(counts, m->nmaterials, "cells of the materials");
    c->cells = cells;
    c->materials = m->nmaterials;
    c->count = 2 * (m->nmaterials + 1);
    PH_ALLOC(c->E, c->materials + 1, "moduli");
    PH_ALLOC(c->pair, c->count * c->count, "moduli of bonds");
    PH_ALLOC(c->apart, c->count * c->count, "moduli of bonds");
    PH_ALLOC(c->how, c->count * c->count, "moduli of bonds");
    PH_ALLOC(c->how_apart, c->count * c->count, "moduli of bonds");
    PH_ALLOC(c->class, cells, "bond classes");
    PH_ALLOC(c->owner, cells, "owners");
    label(c, m, source);
    bool *used = NULL;
    PH_ALLOC(used, c->materials + 1, "phase flags");
    for (ptrdiff_t x = 0; x < cells; x++)
        used[c->class[x] / 2] = true;
    for (int i = 0; i < m->nmaterials && st == PH_OK; i++) {
        if (used[i]) st = check_material(&m->materials[i], m->grid.kinematics, err);
        c->E[i] = m->materials[i].is_void ? 0.0 : m->materials[i].E;
    }
    free(used);
    if (st != PH_OK) goto out;
    c->matrix = find_matrix(m, counts);
    fill_tables(c, kappa);
    *out = c;
    c = NULL;
out:
    free(counts);
    ph_i_bond_classes_free(&c);
    return st;
}

void ph_i_bond_classes_free(ph_bond_classes **out)
{
    if (!out || !*out) return;
    ph_bond_classes *c = *out;
    free(c->E);
    free(c->pair);
    free(c->apart);
    free(c->how);
    free(c->how_apart);
    free(c->class);
    free(c->owner);
    free(c);
    *out = NULL;
}
