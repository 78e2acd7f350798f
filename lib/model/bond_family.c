/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/bond.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
/* Below this a share of a cell is round-off. */
static const double smallest_weight = 1e-12;

double ph_bond_poisson(ph_kinematics kin)
{
    switch (kin) {
    case PH_PLANE_STRESS:
        return 1.0 / 3.0;
    case PH_PLANE_STRAIN:
    case PH_SPACE:
        return 0.25;
    default:
        return NAN;
    }
}

/* C1111 / E of the classical medium: 9/8 in plane stress, 6/5 else. */
static double classical_c1111(ph_kinematics kin)
{
    return kin == PH_PLANE_STRESS ? 9.0 / 8.0 : 6.0 / 5.0;
}

/* What `lattice` makes exact: the modulus along an axis under uniaxial stress, in the plane
 * where there are two axes. In plane strain that is E / (1 - nu^2). */
static double classical_modulus(ph_kinematics kin)
{
    return kin == PH_PLANE_STRAIN ? 16.0 / 15.0 : 1.0;
}

static double length(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

typedef struct recipe {
    const ph_grid *grid;
    double horizon, power, scale; /* k = scale g beta / r^3 */
    const ph_micromodulus *profile;
    const ph_volume_weight *weight;
    bool active[3]; /* directions of the space, whether fields vary along them or not */
    int dimension;
} recipe;

/* Share of the cell at xi in the ball. The rule is asked in one order of the axes, so that
 * a quadrature of its own leaves the lattice its symmetry to the last digit. */
static double share(const recipe *r, const double xi[3])
{
    double at[3] = {0, 0, 0}, h[3] = {1, 1, 1};
    for (int d = 0; d < r->dimension; d++) { /* insertion by width, then distance */
        double x = fabs(xi[d]), w = r->grid->h[d];
        int i = d;
        for (; i > 0 && (h[i - 1] > w || (h[i - 1] == w && at[i - 1] > x)); i--)
            at[i] = at[i - 1], h[i] = h[i - 1];
        at[i] = x, h[i] = w;
    }
    return r->weight->eval(at, h, r->active, r->horizon);
}

static double spring(const recipe *r, const double xi[3])
{
    double len = length(xi);
    if (len == 0.0) return 0.0;
    double beta = share(r, xi);
    if (beta < smallest_weight) return 0.0;
    return r->scale * beta * r->profile->eval(len / r->horizon, r->power) /
           (len * len * len);
}

/* Visit every offset in reach; with `fill`, store the bonds. Returns their number. */
static ptrdiff_t scan(const recipe *r, ph_family *f, bool fill)
{
    int most[3];
    ptrdiff_t count = 0;
    for (int d = 0; d < 3; d++)
        most[d] = r->active[d] ? (int)ceil(r->horizon / r->grid->h[d]) + 1 : 0;
    for (int i = -most[0]; i <= most[0]; i++)
        for (int j = -most[1]; j <= most[1]; j++)
            for (int k = -most[2]; k <= most[2]; k++) {
                int o[3] = {i, j, k};
                double xi[3];
                for (int d = 0; d < 3; d++)
                    xi[d] = r->active[d] ? o[d] * r->grid->h[d] : 0.0;
                double w = spring(r, xi);
                if (w == 0.0) continue;
                if (fill) {
                    memcpy(f->offset[count], o, sizeof o);
                    memcpy(f->xi[count], xi, sizeof xi);
                    f->w[count] = w;
                    for (int d = 0; d < 3; d++)
                        f->reach[d] = abs(o[d]) > f->reach[d] ? abs(o[d]) : f->reach[d];
                }
                count++;
            }
    return count;
}

/* C = 1/2 sum_b k_b (xi xi) (x) (xi xi), Mandel. */
static ph_sym4 lattice_stiffness(const ph_family *f, int ns)
{
    ph_sym4 c = {.n = ns};
    const double r2 = sqrt(2.0);
    for (ptrdiff_t b = 0; b < f->count; b++) {
        const double *x = f->xi[b];
        double six[6] = {x[0] * x[0],      x[1] * x[1],      x[2] * x[2],
                         r2 * x[1] * x[2], r2 * x[0] * x[2], r2 * x[0] * x[1]};
        double three[3] = {six[0], six[1], six[5]};
        const double *m = ns == 6 ? six : three;
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < ns; j++)
                c.m[i][j] += 0.5 * f->w[b] * m[i] * m[j];
    }
    return c;
}

/* Mean over the axes of the modulus under uniaxial stress, and of C1111. */
static ph_status axis_moduli(const ph_sym4 *c, int dims, double *E, double *C1111,
                             ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 s;
    st = ph_sym4_inverse(c, &s, NULL);
    PH_CHECK(st == PH_OK, PH_ESINGULAR,
             "the bonds of this horizon resist no shear: give a larger horizon");
    *E = *C1111 = 0.0;
    for (int d = 0; d < dims; d++) {
        *E += 1.0 / s.m[d][d] / dims;
        *C1111 += c->m[d][d] / dims;
    }
out:
    return st;
}

/* Poisson ratio of a three-dimensional material that would look like this. */
static double lattice_poisson(const ph_sym4 *c, ph_kinematics kin)
{
    double ratio = c->m[0][1] / c->m[0][0];
    return kin == PH_PLANE_STRESS ? ratio : ratio / (1.0 + ratio);
}

static ph_status calibrate(ph_family *f, const recipe *r, ph_calibration rule,
                           ph_bond_lattice *lattice, ph_error *err)
{
    ph_status st = PH_OK;
    ph_kinematics kin = r->grid->kinematics;
    ph_sym4 c = lattice_stiffness(f, ph_strains(kin));
    double E = 0.0, C1111 = 0.0, factor = 1.0;
    PH_TRY(axis_moduli(&c, r->dimension, &E, &C1111, err));
    if (rule == PH_CALIBRATE_LATTICE) factor = classical_modulus(kin) / E;
    if (rule == PH_CALIBRATE_GAMMA) factor = classical_c1111(kin) / C1111;
    for (ptrdiff_t b = 0; b < f->count; b++)
        f->w[b] *= factor;
    if (!lattice) return PH_OK;
    int shear = c.n - 1;
    lattice->factor = factor;
    lattice->nu = lattice_poisson(&c, kin);
    lattice->zener = c.m[shear][shear] / (c.m[0][0] - c.m[0][1]);
    lattice->C = ph_sym4_combine(factor, &c, 0.0, &c);
out:
    return st;
}

static ph_status check_recipe(const recipe *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_grid *g = r->grid;
    PH_CHECK_KEY(isfinite(r->horizon) && r->horizon > 0.0, PH_EINVAL, "model.horizon",
                 "horizon must be > 0, got %g", r->horizon);
    PH_CHECK_KEY(
        isfinite(ph_bond_poisson(g->kinematics)), PH_EINVAL, "microstructure.plane",
        "bonds do not do generalised plane strain: a bond that stays in the plane "
        "knows no strain along axis 3. Give plane: stress or strain, or model nosb");
    PH_CHECK_KEY(isfinite(r->power) && r->power < r->dimension + 1, PH_EINVAL,
                 "model.micromodulus",
                 "power must be below %d (the modulus is finite), got %g",
                 r->dimension + 1, r->power);
    for (int d = 0; d < r->dimension; d++) {
        PH_CHECK_KEY(r->horizon >= g->h[d] * (1.0 - 1e-9), PH_EINVAL, "model.horizon",
                     "horizon %g is too small for this grid: at least %g, one spacing",
                     r->horizon, g->h[d]);
        PH_CHECK_KEY(g->n[d] == 1 || r->horizon <= g->size[d] * (1.0 + 1e-9), PH_EINVAL,
                     "model.horizon",
                     "horizon %g is larger than the box along axis %d (size %g)",
                     r->horizon, d + 1, g->size[d]);
    }
out:
    return st;
}

ph_status ph_bond_family_new(const ph_grid *grid, double horizon,
                             const ph_micromodulus *profile, double power,
                             const ph_volume_weight *weight, ph_calibration calibration,
                             ph_family **out, ph_bond_lattice *lattice, ph_error *err)
{
    ph_status st = PH_OK;
    ph_family *f = NULL;
    PH_CHECK(grid && profile && weight && out, PH_EINVAL, "NULL argument");
    *out = NULL;
    int dim = grid->kinematics == PH_SPACE ? 3 : 2;
    recipe r = {.grid = grid,
                .horizon = horizon,
                .power = profile->eval == ph_micromoduli[3].eval ? power : 0.0,
                .profile = profile,
                .weight = weight,
                .active = {true, true, dim == 3},
                .dimension = dim};
    PH_TRY(check_recipe(&r, err));
    /* C1111 = 1/2 c A delta^(d+1) moment, A = integral of cos^4 over the directions. */
    double A = dim == 2 ? 3.0 * pi / 4.0 : 4.0 * pi / 5.0;
    double constant =
        2.0 * classical_c1111(grid->kinematics) / (A * profile->moment(dim, r.power));
    r.scale = constant / pow(horizon, dim + 1) * grid->h[0] * grid->h[1] *
              (dim == 3 ? grid->h[2] : 1.0);
    PH_ALLOC(f, 1, "a family");
    f->points = PH_POINTS_NODES;
    f->horizon = horizon;
    memcpy(f->active, r.active, sizeof f->active);
    f->count = scan(&r, f, false);
    PH_CHECK(f->count > 0, PH_ESINGULAR,
             "the family of horizon %g has no bond with micromodulus '%s'", horizon,
             profile->info.name);
    PH_ALLOC(f->offset, f->count, "bond offsets");
    PH_ALLOC(f->xi, f->count, "bonds");
    PH_ALLOC(f->w, f->count, "springs");
    scan(&r, f, true);
    PH_TRY(calibrate(f, &r, calibration, lattice, err));
    for (ptrdiff_t b = 0; b < f->count; b++)
        f->weight += f->w[b];
    if (lattice) lattice->constant = constant;
    *out = f;
    f = NULL;
out:
    ph_family_free(&f);
    return st;
}
