/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The causes of error, one entry each. Factors: docs/theory/error-bars.md says how they were
 * found (on cases of their own) and what they cover (on others). */
#include "core/jacobi.h"
#include "effective/error_bar.h"

#include <math.h>
#include <string.h>

/* ---- discretisation: the same on a coarser grid ---- */

/* Share of the scatter of the whole tensor that one constant gets beside its own difference:
 * differences of one constant cross zero by chance, all at once do not. */
static const double share_of_tensor = 0.25;
/* Where cells have the phase of their centre, the two grids also place the interfaces anew. */
static const double share_by_centres = 0.5;
/* At times all do: shares of what grids are off on the mean of many cells, in the plane and in
 * space. It is not believed where the two grids agree to a thirtieth of it: layers are exact. */
static const double expected_plane = 0.7, expected_space = 0.35, most_expected = 30.0;
/* A crack is as long as its nodes, give or take this share of the spacing. */
static const double tip_off = 0.4;
/* Of the difference to voxels that were mixed, what is not the mixing. */
static const double not_mixing = 0.5;
/* Shear moduli are off more than others. */
static const double shears = 1.25;

/* Root mean square of the eigenvalues of A^-1/2 (A - B) A^-1/2: relative differences of the
 * energies of all strains. NaN where A is no stiffness. */
static double spread(const ph_sym4 *a, const ph_sym4 *b)
{
    ph_sym4 inverse, difference = ph_sym4_combine(1.0, a, -1.0, b);
    if (ph_sym4_inverse(a, &inverse, NULL) != PH_OK) return NAN;
    /* trace of (A^-1 D)^2 */
    ph_sym4 m = ph_sym4_product(&inverse, &difference);
    double sum = 0.0;
    for (int i = 0; i < a->n; i++)
        for (int j = 0; j < a->n; j++)
            sum += m.m[i][j] * m.m[j][i];
    return sqrt(fmax(sum, 0.0) / a->n);
}

/* Couplings with shears cross zero: nearer to the worst that they could do. */
static const double power = 0.5, power_of_couplings = 0.75, power_of_ratios = 0.4;

/* What a relative change of the tensor by one changes a constant by. Couplings move with the
 * entries beside them and Poisson ratios with the square root of a ratio of moduli, which is
 * the worst; their own size is the best. Between: a geometric mean. */
static double scale(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    const ph_sym4 *c = ph_i_error_tensor(e);
    ph_sym4 s;
    double worst = fabs(value), p = power;
    int a = ph_i_error_component(e, q->row), b = ph_i_error_component(e, q->column);
    if (q->name[0] == 'C') {
        worst = ph_i_error_beside(e, q);
        if (a != b && (q->row > 2 || q->column > 2)) p = power_of_couplings;
    } else if (strncmp(q->name, "nu", 2) == 0 && ph_sym4_inverse(c, &s, NULL) == PH_OK) {
        worst = sqrt(fabs(s.m[b][b] / s.m[a][a]));
        p = power_of_ratios;
    } else if (q->stress == 0) {
        worst = 1.0;
    }
    return pow(fabs(value), 1.0 - p) * pow(worst, p);
}

/* How far apart two tensors put a constant. */
static double apart(const ph_error_evidence *e, const ph_quantity *q, const ph_sym4 *a,
                    const ph_sym4 *b, double value)
{
    double x = ph_i_error_value(e, q, a), y = ph_i_error_value(e, q, b);
    double share = e->by_centres ? share_by_centres : share_of_tensor;
    return fabs(x - y) + share * spread(a, b) * scale(e, q, value);
}

static const char *no_coarse(const ph_error_evidence *e)
{
    if (e->coarse && e->ratio > 0.0 && e->ratio != 1.0) return NULL;
    return e->no_coarse ? e->no_coarse : "nothing was solved on a coarser grid";
}

/* What grids of so many nodes are off on the mean of many cells. */
static double of_law(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    bool space = e->result->grid.kinematics == PH_SPACE;
    double seen = spread(ph_i_error_tensor(e), e->coarse);
    return (space ? expected_space : expected_plane) *
           fmin(e->expected, most_expected * seen) * scale(e, q, value);
}

/* Dilute cracks take a^d from a constant, d axes: d/a of it for every length that a is off. */
static double of_tips(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    if (!e->uncracked || !(e->tips > 0.0)) return 0.0;
    double plain = ph_i_error_value(e, q, e->uncracked);
    double axes = e->result->grid.kinematics == PH_SPACE ? 3.0 : 2.0;
    return isnan(plain) ? 0.0 : axes * tip_off * e->tips * fabs(plain - value);
}

static bool is_shear(const ph_quantity *q)
{
    return q->name[0] == 'G' || (q->name[0] == 'C' && q->row == q->column && q->row > 2);
}

static double discretisation(const ph_error_evidence *e, const ph_quantity *q,
                             double value)
{
    double seen =
        apart(e, q, ph_i_error_tensor(e), e->coarse, value) / fabs(e->ratio - 1.0);
    if (e->mixed) seen *= not_mixing;
    seen = hypot(seen, hypot(of_law(e, q, value), of_tips(e, q, value)));
    return is_shear(q) ? shears * seen : seen;
}

/* ---- stabilisation: what of it is in the energy ---- */

/* Its share of the energy grows as a power p of its coefficient, between 1/2 (layers at
 * interfaces) and 1 (perturbation); from 0 to here it adds share / p. */
static const double one_over_power = 2.0;

static double share_of_energy(const ph_error_evidence *e)
{
    return e->stabilisation ? *e->stabilisation : e->result->stabilisation_energy;
}

static const char *no_share(const ph_error_evidence *e)
{
    return isfinite(share_of_energy(e))
               ? NULL
               : "the energy of the stabilisation was not computed";
}

static double stabilisation(const ph_error_evidence *e, const ph_quantity *q,
                            double value)
{
    return one_over_power * share_of_energy(e) * scale(e, q, value);
}

/* ---- geometry: the share of the fillers ---- */

static const char *no_geometry(const ph_error_evidence *e)
{
    return e->matrix ? NULL : "no fractions are asked for";
}

/* Slope of Mori and Tanaka's estimate for one rigid or void filler: (Q - Q_m) / (f (1 - f)). */
static double geometry(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    double f = e->share, plain = ph_i_error_value(e, q, e->matrix);
    if (e->share_off == 0.0) return 0.0;
    if (!(f > 0.0 && f < 1.0)) return NAN;
    if (isnan(plain)) plain = 0.0; /* fillers in a void */
    return fabs(value - plain) / (f * (1.0 - f)) * e->share_off;
}

/* ---- solver ---- */

/* Conjugate gradients need sqrt(k)/2 ln(2/t) iterations for a condition number k: what k is,
 * an iteration count tells. */
static double condition(int iterations, double residual)
{
    double digits = log(2.0 / fmin(fmax(residual, 1e-15), 0.5));
    double root = 2.0 * iterations / digits;
    return fmax(1.0, root * root);
}

/* Energy of the error of load a over that of its fluctuation: condition x residual^2. Residuals
 * are 2-norms, not those of the preconditioner: twice that. */
static const double safety = 2.0;
static double energy_left(const ph_result *r, int number)
{
    double t = r->residual[number];
    return safety * condition(r->iterations[number], t) * t * t;
}

/* The residual that floats leave beside the one that conjugate gradients are told, from above:
 * the field is not the best one of its iterations, and every entry is off by its first power.
 * Refined, the residual itself. Measured: docs/theory/solvers.md. */
static const double of_floats = 1e-6;
static double first_order(const ph_result *r, int number)
{
    double t = r->residual[number];
    if (!r->precision || strcmp(r->precision, "single") != 0) return 0.0;
    return sqrt(safety * condition(r->iterations[number], t)) * fmin(t, of_floats);
}

static const char *no_residual(const ph_error_evidence *e)
{
    const ph_result *r = e->result;
    if (r->nloads == 0) return NULL; /* analytic */
    for (int i = 0; i < r->nloads && i < 6; i++)
        if (!isfinite(r->residual[i])) return "the residuals are not known";
    return NULL;
}

/* |dC_ab|: diagonal entries are off by the energy of the error, the others, from averages of
 * stress, by the product of one error and one fluctuation, or of two errors. */
static void entry_errors(const ph_result *r, ph_sym4 *off)
{
    double error[6] = {0}, floats[6] = {0}, size[6] = {0};
    double worst = 0.0, worst_floats = 0.0; /* of a load that follows from another one */
    int number = 0;
    *off = (ph_sym4){.n = r->stiffness.n};
    for (int i = 0; i < r->nloads && i < 6; i++) {
        worst = fmax(worst, energy_left(r, i));
        worst_floats = fmax(worst_floats, first_order(r, i));
    }
    for (int a = 0; a < off->n; a++) {
        size[a] =
            sqrt(fmax(r->voigt.m[a][a] - r->stiffness.m[a][a], 1e-3 * r->voigt.m[a][a]));
        bool solved = r->solved >> a & 1u && number < r->nloads;
        floats[a] = (solved ? first_order(r, number) : worst_floats) * size[a];
        error[a] = sqrt(solved ? energy_left(r, number++) : worst) * size[a];
    }
    for (int a = 0; a < off->n; a++)
        for (int b = 0; b < off->n; b++)
            off->m[a][b] = r->second_order ? error[a] * error[b]
                           : a == b        ? error[a] * error[a] + floats[a] * size[a]
                                    : 0.5 * (error[a] * size[b] + error[b] * size[a]);
}

/* First-order propagation, every entry at its worst. */
static double solver(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    ph_sym4 off, moved;
    double sum = 0.0;
    entry_errors(e->result, &off);
    for (int a = 0; a < off.n; a++)
        for (int b = a; b < off.n; b++) {
            moved = *ph_i_error_tensor(e);
            double step = 1e-6 * sqrt(fabs(moved.m[a][a] * moved.m[b][b]));
            if (!(step > 0.0)) continue;
            moved.m[a][b] += step;
            if (a != b) moved.m[b][a] += step;
            sum += fabs(ph_i_error_value(e, q, &moved) - value) / step * off.m[a][b];
        }
    return sum + 1e-11 * fabs(value); /* and round-off */
}

/* ---- horizon, boundary, time: where there is something to compare ---- */

static const char *no_horizon(const ph_error_evidence *e)
{
    if (e->horizon && e->half_horizon) return NULL;
    return e->no_horizon ? e->no_horizon : "no other horizon was solved";
}

/* First order in the horizon: what the half does not show is as much again. */
static double horizon(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    return 2.0 * apart(e, q, e->horizon, e->half_horizon, value);
}

static const char *no_boundary(const ph_error_evidence *e)
{
    if (e->constraint && e->other_constraint) return NULL;
    return e->no_boundary ? e->no_boundary : "no other constraint was solved";
}

static double boundary(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    (void)value;
    return fabs(ph_i_error_value(e, q, e->constraint) -
                ph_i_error_value(e, q, e->other_constraint));
}

static const char *no_time(const ph_error_evidence *e)
{
    return isfinite(e->time) ? NULL
                             : "the route does not estimate the error of its basis";
}

static double basis(const ph_error_evidence *e, const ph_quantity *q, double value)
{
    return e->time * scale(e, q, value);
}

const ph_error_part ph_error_parts[] = {
    {.info = {"discretisation", "grid, and a horizon of as many spacings",
              "Richardson1911",
              "first order in the spacing: difference to a grid with half the nodes, and "
              "what grids are off on the mean"},
     .automatic = true,
     .needed = true,
     .refuses = no_coarse,
     .error = discretisation},
    {.info = {"stabilisation", "zero-energy modes, extrapolated to none", "",
              "twice its share of the energy"},
     .automatic = true,
     .refuses = no_share,
     .error = stabilisation},
    {.info = {"geometry", "fractions reached against fractions asked for", "Mori1973",
              "inclusions by node centre, random fillers"},
     .automatic = true,
     .refuses = no_geometry,
     .error = geometry},
    {.info = {"solver", "residual of the equations, quadratic in it", "Hestenes1952",
              "with the condition number that the iterations tell"},
     .automatic = true,
     .bound = true,
     .refuses = no_residual,
     .error = solver},
    {.info = {"horizon", "a horizon that stands for no physical length", "",
              "asked for, horizon {length: x}: half of it on the coarser grid"},
     .refuses = no_horizon,
     .error = horizon},
    {.info = {"boundary", "one constraint against another", "",
              "asked for; of one realisation, not the scatter between realisations"},
     .refuses = no_boundary,
     .error = boundary},
    {.info = {"time", "basis of the relaxation in time", "", "route reduced"},
     .automatic = true,
     .bound = true,
     .refuses = no_time,
     .error = basis},
};
const size_t ph_nerror_parts = sizeof ph_error_parts / sizeof *ph_error_parts;
_Static_assert(sizeof ph_error_parts / sizeof *ph_error_parts <= PH_MAX_ERROR_PARTS,
               "PH_MAX_ERROR_PARTS");

unsigned ph_error_parts_auto(void)
{
    unsigned bits = 0;
    for (size_t i = 0; i < ph_nerror_parts; i++)
        if (ph_error_parts[i].automatic) bits |= 1u << i;
    return bits;
}
