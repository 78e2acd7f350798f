/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/unit_load.h"

#include <math.h>
#include <string.h>

/* A pivot below this share of the first means: the direction has lost its stiffness. */
static const double nothing_left = 1e-5;

/* ---- making ------------------------------------------------------------------------------ */

static bool is_shear(int ns, int i)
{
    return i >= (ns == 3 ? 2 : 3);
}

static void add_column(ph_unit_load *unit, int component)
{
    ph_unit_column *c = &unit->column[unit->columns++];
    c->component = component;
    c->by_stress = component >= 0 && ph_i_run_by_stress(unit->run, component);
}

ph_status ph_i_unit_load_init(ph_unit_load *unit, ph_run *r, const double *strain,
                              unsigned free, ph_error *err)
{
    ph_status st = PH_OK;
    int ns = r->map->ns;
    bool together = false;
    *unit = (ph_unit_load){.run = r,
                           .size = (size_t)(r->op->layout.nd * r->op->layout.cells)};
    for (int i = 0; i < ns; i++) {
        bool is_free = free >> i & 1;
        if (!is_free)
            unit->direction[i] = strain[i] * (is_shear(ns, i) ? sqrt(0.5) : 1.0);
        if (!is_free && !ph_i_run_by_stress(r, i))
            together = together || unit->direction[i] != 0.0;
    }
    if (together) add_column(unit, -1);
    for (int i = 0; i < ns; i++)
        if ((free >> i & 1) != (unsigned)ph_i_run_by_stress(r, i)) add_column(unit, i);
    unit->single = together && unit->columns == 1;
    for (int c = 0; c < unit->columns; c++)
        PH_DOUBLES(unit->column[c].u, &r->meter, unit->size, "a column of the load");
    if (!unit->single)
        PH_DOUBLES(unit->field, &r->meter, unit->size, "the displacement of the load");
out:
    return st;
}

void ph_i_unit_load_clear(ph_unit_load *unit)
{
    for (int c = 0; c < unit->columns; c++)
        ph_i_doubles_free(&unit->run->meter, &unit->column[c].u, unit->size);
    if (unit->run) ph_i_doubles_free(&unit->run->meter, &unit->field, unit->size);
}

/* ---- solving ----------------------------------------------------------------------------- */

/* Uniform strain of a column, or nothing under a traction. */
static void strain_of(const ph_unit_load *unit, const ph_unit_column *c, double macro[6])
{
    memset(macro, 0, 6 * sizeof *macro);
    if (c->component < 0)
        for (int i = 0; i < unit->run->map->ns; i++)
            macro[i] = ph_i_run_by_stress(unit->run, i) ? 0.0 : unit->direction[i];
    else if (!c->by_stress)
        macro[c->component] = 1.0;
}

static ph_status solve_column(ph_unit_load *unit, ph_unit_column *c, double energy_most,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = unit->run;
    double macro[6], unit_stress[6] = {0}, cells = (double)r->setting.averaged;
    ph_cg_report report;
    ph_cell_energy not_wanted;
    strain_of(unit, c, macro);
    if (c->by_stress) unit_stress[c->component] = 1.0;
    PH_TRY(ph_i_run_solve(r, c->by_stress ? unit_stress : macro, c->by_stress,
                          unit->solved ? c->u : NULL, unit->single ? energy_most : 0.0,
                          &report, err));
    memcpy(c->u, r->u, unit->size * sizeof *c->u);
    unit->iterations += report.iterations;
    unit->residual = fmax(unit->residual, report.residual);
    if (unit->single) return PH_OK;
    PH_TRY(ph_i_operator_sums(r->op, c->u, c->by_stress ? NULL : macro, r->setting.region,
                              c->stress, c->strain, &not_wanted, err));
    for (int i = 0; i < r->map->ns; i++) {
        c->stress[i] /= cells;
        c->strain[i] = r->constraint->by_stress ? c->strain[i] / cells : macro[i];
    }
out:
    return st;
}

/* a x = b [n][n + 1] by complete pivoting; what has no pivot above `least` is zero. */
static void solve_small(int n, double a[6][7], double least, double *x)
{
    int row[6], column[6], rank = 0;
    bool used[6] = {false}, done[6] = {false};
    for (; rank < n; rank++) {
        int p = -1, q = -1;
        double best = least;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                if (!done[i] && !used[j] && fabs(a[i][j]) > best)
                    best = fabs(a[i][j]), p = i, q = j;
        if (p < 0) break;
        row[rank] = p, column[rank] = q;
        done[p] = used[q] = true;
        for (int i = 0; i < n; i++) {
            double f = a[i][q] / a[p][q];
            if (i == p) continue;
            for (int j = 0; j <= n; j++)
                a[i][j] -= f * a[p][j];
        }
    }
    memset(x, 0, (size_t)n * sizeof *x);
    for (int k = 0; k < rank; k++)
        x[column[k]] = a[row[k]][n] / a[row[k]][column[k]];
}

static double mean_of(const ph_unit_column *c, const ph_unit_column *asked)
{
    return (asked->by_stress ? c->strain : c->stress)[asked->component];
}

static void find_amplitudes(ph_unit_load *unit)
{
    double a[6][7] = {{0}}, most = 0.0, x[6];
    const ph_unit_column *c = unit->column;
    int first = c->component < 0, n = unit->columns - first;
    for (int i = 0; i < n; i++) {
        const ph_unit_column *asked = &c[first + i];
        for (int j = 0; j < n; j++) {
            a[i][j] = mean_of(&c[first + j], asked);
            most = fmax(most, fabs(a[i][j]));
        }
        a[i][n] = asked->by_stress ? unit->direction[asked->component] : 0.0;
        if (first) a[i][n] -= mean_of(c, asked);
    }
    if (!unit->solved) unit->scale = most;
    solve_small(n, a, nothing_left * unit->scale, x);
    unit->amplitude[0] = 1.0;
    memcpy(unit->amplitude + first, x, (size_t)n * sizeof *x);
}

/* u and macro from the columns and their amplitudes. */
static void put_together(ph_unit_load *unit)
{
    memset(unit->macro, 0, sizeof unit->macro);
    unit->u = unit->single ? unit->column[0].u : unit->field;
    if (!unit->single) memset(unit->field, 0, unit->size * sizeof *unit->field);
    for (int c = 0; c < unit->columns; c++) {
        double macro[6], t = unit->amplitude[c];
        const double *u = unit->column[c].u;
        strain_of(unit, &unit->column[c], macro);
        for (int i = 0; i < unit->run->map->ns; i++)
            unit->macro[i] += t * macro[i];
        for (size_t x = 0; !unit->single && x < unit->size; x++)
            unit->field[x] += t * u[x];
    }
}

static ph_status measure(ph_unit_load *unit, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = unit->run;
    double cells = (double)r->setting.averaged;
    ph_cell_energy e;
    PH_TRY(ph_i_operator_sums(r->op, unit->u, unit->macro, r->setting.region,
                              unit->stress, unit->strain, &e, err));
    unit->work = 0.0;
    for (int i = 0; i < r->map->ns; i++) {
        unit->stress[i] /= cells;
        /* of a cell with cracks the rest of the strain is in the gaps */
        unit->strain[i] =
            r->constraint->by_stress ? unit->strain[i] / cells : unit->macro[i];
        unit->work += unit->stress[i] * unit->strain[i];
    }
    unit->energy = (e.mean + e.modes + e.stabilisation) / cells;
out:
    return st;
}

/* Tractions on a piece that nothing holds have no answer: the strain that any stress needs
 * is without bounds, the stress of a strain is zero. */
static void come_apart(ph_unit_load *unit)
{
    unit->apart = true;
    memset(unit->stress, 0, sizeof unit->stress);
    memcpy(unit->strain, unit->direction, sizeof unit->strain);
    unit->work = unit->energy = 0.0;
}

ph_status ph_i_unit_load_measure(ph_unit_load *unit, ph_error *err)
{
    double work = unit->work, energy = unit->energy;
    ph_status st = measure(unit, err);
    unit->work = work;
    unit->energy = energy;
    return st;
}

ph_status ph_i_unit_load_solve(ph_unit_load *unit, double energy_most, ph_error *err)
{
    ph_status st = PH_OK;
    unit->iterations = 0;
    unit->residual = 0.0;
    for (int c = 0; c < unit->columns; c++) {
        st = solve_column(unit, &unit->column[c], energy_most, err);
        bool lost = st == PH_ENOCONV || st == PH_ESINGULAR;
        if (lost && unit->solved && unit->run->constraint->by_stress) {
            if (err) *err = (ph_error)PH_ERROR_INIT;
            come_apart(unit);
            return PH_OK;
        }
        if (st != PH_OK) goto out;
    }
    unit->amplitude[0] = 1.0;
    if (!unit->single) find_amplitudes(unit);
    put_together(unit);
    PH_TRY(measure(unit, err));
    unit->solved = true;
out:
    return st;
}
