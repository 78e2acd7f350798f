/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stiffness, and rows of the compliance, that the columns of the loads make. */
#include "effective/run.h"

#include <math.h>

/* Columns of mixed loads -> stiffness. With X the components loaded by stress and M the
 * others, e_X = A s_X + B e_M and s_M = D s_X + F e_M. */
static ph_status from_mixed(const ph_run *r, ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns, x[6], nx = 0;
    ph_sym4 A = {.n = ns}, mixed = *c;
    for (int i = 0; i < ns; i++)
        if (ph_i_run_by_stress(r, i)) x[nx++] = i;
    for (int i = 0; i < ns; i++)
        A.m[i][i] = 1.0;
    for (int p = 0; p < nx; p++)
        for (int q = 0; q < nx; q++)
            A.m[x[p]][x[q]] = mixed.m[x[p]][x[q]];
    PH_TRY(ph_sym4_inverse(&A, &A, err));
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++) {
            bool xi = ph_i_run_by_stress(r, i), xj = ph_i_run_by_stress(r, j);
            double v = !xi && !xj ? mixed.m[i][j] : 0.0;
            for (int p = 0; p < nx; p++)
                for (int q = 0; q < nx; q++) {
                    double left = xi ? (double)(x[p] == i) : mixed.m[i][x[p]];
                    double right = xj ? (double)(x[q] == j) : -mixed.m[x[q]][j];
                    v += left * A.m[x[p]][x[q]] * right;
                }
            c->m[i][j] = v;
        }
out:
    return st;
}

/* The largest correction m_ab over sqrt(c_aa c_bb): a direction in which the composite is as
 * stiff as its fibres must not hide the others.
 * An isolated body in a void has c = 0: `least` is what counts as nothing. */
static double worst_correction(const ph_sym4 *m, const ph_sym4 *c, double least)
{
    double worst = 0.0;
    for (int a = 0; a < c->n; a++)
        for (int b = a; b < c->n; b++)
            if (isfinite(c->m[a][b]))
                worst = fmax(worst, fabs(m->m[a][b]) / sqrt(fmax(c->m[a][a], least)) /
                                        sqrt(fmax(c->m[b][b], least)));
    return worst;
}

/* Energies of the pairs of loads whose fields are kept; NaN: the others. */
static void take_pairs(const ph_run *r, double *const kept[6], const ph_sym4 *columns,
                       double sign, const ph_sym4 *second, ph_sym4 *c)
{
    for (int b = 0; b < c->n; b++)
        for (int a = 0; a <= b; a++)
            c->m[a][b] = c->m[b][a] = kept[a] && kept[b]
                                          ? columns->m[a][b] + sign * second->m[a][b]
                                          : (double)NAN;
    if (r->symmetry.count) ph_i_symmetry_average(&r->symmetry, c);
}

/* Cracks may leave nothing at all: what matters is small beside the whole cell. */
static double least_stiffness(const ph_run *r)
{
    return (r->broken ? 1e-3 : 1e-6) * r->map->softest;
}

/* Second-order entries. Where the correction is as large as the answer, its square is not
 * small either (measured: a tenth of the answer goes with an error of a percent). */
static ph_status refine(ph_run *r, ph_sym4 *c, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    double off = 0.0;
    res->second_order = true;
    if (res->solved) {
        take_pairs(r, r->kept, &r->columns, -1.0, &r->second, c);
        off = worst_correction(&r->second, c, least_stiffness(r));
    }
    if (res->solved_stresses) {
        ph_sym4 *s = &res->compliance;
        s->n = c->n;
        take_pairs(r, r->pulled, &r->compliance, 1.0, &r->second_compliance, s);
        double least = 1e-6 / ph_sym4_norm(&res->voigt);
        off = fmax(off, worst_correction(&r->second_compliance, s, least));
    }
    res->converged = off <= 0.1;
    res->stiffness = *c;
    PH_CHECK(res->converged, PH_ENOCONV,
             "the error of the stress averages is %.2g of the effective tensor: contrast "
             "%.2g asks for a lower solver.tolerance",
             off, r->map->contrast);
out:
    return st;
}

void ph_i_run_solved_columns(ph_run *r)
{
    ph_result *res = r->result;
    int ns = r->map->ns;
    if (r->constraint->by_stress) res->loads = 0; /* the inverse needs them all */
    for (int a = 0; a < ns; a++)
        for (int b = 0; b < ns; b++)
            res->stiffness.m[b][a] = (res->loads >> a) & 1 ? r->columns.m[b][a] : 0.0;
}

/* Of refined ones: those whose fields are kept. */
static bool has_all_columns(const ph_run *r)
{
    bool all = r->result->loads == ph_i_run_all_loads(r->result);
    for (int a = 0; ph_i_run_second_order(r) && a < r->map->ns; a++)
        all = all && r->kept[a];
    return all;
}

ph_status ph_i_run_stiffness(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    int ns = r->map->ns;
    ph_sym4 c = r->columns;
    res->compliance = r->compliance;
    if (r->constraint->by_stress) PH_TRY(from_mixed(r, &c, err));
    if (has_all_columns(r)) {
        double off = 0.0;
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < i; j++) {
                double d = c.m[i][j] - c.m[j][i];
                off += 2.0 * d * d;
                c.m[i][j] = c.m[j][i] = 0.5 * (c.m[i][j] + c.m[j][i]);
            }
        double size = fmax(ph_sym4_norm(&c), least_stiffness(r));
        res->asymmetry = size > 0.0 ? sqrt(off) / size : 0.0;
    }
    res->stiffness = c;
    if (ph_i_run_second_order(r)) PH_TRY(refine(r, &c, err));
out:
    return st;
}
