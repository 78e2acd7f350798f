/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/stepping.h"

#include <math.h>
#include <string.h>

static const double default_tolerance = 1e-4;
/* A step may be off by (2.5 tolerance)^(3/2): errors of steps add up over the time that the
 * medium remembers, whose number of steps grows with the cube root of that error. Measured,
 * docs/theory/viscoelastic-routes.md: the sum is 0.2 of its power 2/3. */
static double error_of_step(double tolerance)
{
    return fmin(0.1, pow(2.5 * tolerance, 1.5));
}

/* Stress below this share of the largest so far need not be resolved relative to itself. */
static const double least_stress = 1e-3;
enum { CORRECTIONS = 40, DEFAULT_STEPS = 1000000 };

typedef struct march {
    ph_stepper *s;
    const ph_load_history *history;
    double tolerance, fixed, first, control;
    double dt; /* of the ladder */
    long most;
    unsigned bends;   /* components whose load is found, not given */
    ph_sym4 tangent;  /* d response / d load, of some step; n = 0: none yet */
    double largest;   /* stress so far */
    double target[6]; /* at the end of the step */
    ph_stepping_report *report;
} march;

static double norm(int n, const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

/* Is component i prescribed by its load, or by its response? */
static bool direct(const march *m, int i)
{
    return (m->history->stress >> i & 1) == (unsigned)ph_i_run_by_stress(m->s->run, i);
}

/* Value of the history at t, between points k - 1 and k. */
static double value_at(const march *m, int k, double t, int i)
{
    const ph_load_history *h = m->history;
    int ns = m->s->ns;
    if (k >= h->n) return h->value[(h->n - 1) * ns + i];
    double b = h->value[k * ns + i];
    if (k == 0 || t >= h->time[k]) return b;
    double a = h->value[(k - 1) * ns + i];
    double f = (t - h->time[k - 1]) / (h->time[k] - h->time[k - 1]);
    return a + f * (b - a);
}

/* ---- one step of a given length ---------------------------------------------------------- */

/* Loads of the components that are prescribed by their responses: T_xx d = what is missing. */
static ph_status missing_load(const march *m, const double *response, double *dload,
                              ph_error *err)
{
    ph_status st = PH_OK;
    double a[6][7];
    int x[6], n = 0;
    for (int i = 0; i < m->s->ns; i++)
        if (!direct(m, i)) x[n++] = i;
    for (int p = 0; p < n; p++) {
        for (int q = 0; q < n; q++)
            a[p][q] = m->tangent.m[x[p]][x[q]];
        a[p][n] = m->target[x[p]] - response[x[p]];
    }
    for (int k = 0; k < n; k++) {
        int top = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[top][k])) top = i;
        PH_CHECK(fabs(a[top][k]) > 1e-14 * ph_sym4_norm(&m->tangent), PH_ESINGULAR,
                 "the medium does not resist: the macro stress cannot be prescribed");
        for (int j = k; j <= n; j++) {
            double t = a[k][j];
            a[k][j] = a[top][j];
            a[top][j] = t;
        }
        for (int i = 0; i < n; i++) {
            if (i == k) continue;
            double f = a[i][k] / a[k][k];
            for (int j = k; j <= n; j++)
                a[i][j] -= f * a[k][j];
        }
    }
    memset(dload, 0, 6 * sizeof *dload);
    for (int p = 0; p < n; p++)
        dload[x[p]] = a[p][n] / a[p][p];
out:
    return st;
}

static double miss(const march *m, const double *response)
{
    double sum = 0.0;
    for (int i = 0; i < m->s->ns; i++) {
        double d = direct(m, i) ? 0.0 : m->target[i] - response[i];
        sum += d * d;
    }
    return sqrt(sum);
}

/* What is missing is held against the largest of target and response. */
static double scale_of(const march *m, const double *response)
{
    double size = 0.0;
    for (int i = 0; i < m->s->ns; i++)
        if (!direct(m, i)) size = fmax(size, fmax(fabs(m->target[i]), fabs(response[i])));
    return size;
}

/* Take up the tangent of this dt; the step begins anew. */
static ph_status new_tangent(march *m, double dt, const double *dload, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_stepper_tangent(m->s, dt, &m->tangent, NULL, err));
    PH_TRY(ph_i_stepper_begin(m->s, dt, err));
    PH_TRY(ph_i_stepper_solve(m->s, dload, err));
out:
    return st;
}

/* Correct the loads until the responses are what they should be. The tangent of another dt is
 * good enough as long as it helps. */
static ph_status control(march *m, double dt, double *response, double *stress,
                         ph_error *err)
{
    ph_status st = PH_OK;
    double dload[6], total[6] = {0}, before = INFINITY, largest = scale_of(m, response);
    bool own = false;
    for (int i = 0; i < m->s->ns; i++)
        if (direct(m, i)) total[i] = m->target[i];
    for (int k = 0; k < CORRECTIONS; k++) {
        double off = miss(m, response);
        largest = fmax(largest, scale_of(m, response));
        if (off <= m->control * largest) return PH_OK;
        if (m->tangent.n == 0 || (off > 0.3 * before && !own)) {
            for (int i = 0; i < m->s->ns; i++)
                total[i] = ph_i_run_by_stress(m->s->run, i) ? m->s->dtraction[i]
                                                            : m->s->dmacro[i];
            PH_TRY(new_tangent(m, dt, total, err));
            PH_TRY(ph_i_stepper_response(m->s, response, stress, err));
            own = true;
            off = miss(m, response);
        }
        PH_TRY(missing_load(m, response, dload, err));
        PH_TRY(ph_i_stepper_solve(m->s, dload, err));
        PH_TRY(ph_i_stepper_response(m->s, response, stress, err));
        before = off;
    }
    PH_CHECK(
        miss(m, response) <= m->control * largest, PH_ENOCONV,
        "the macro stress was not reached in %d corrections: %.3g of %.3g is missing",
        CORRECTIONS, miss(m, response), largest);
out:
    return st;
}

/* A step to the targets; not taken yet. */
static ph_status attempt(march *m, double dt, double *stress, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stepper *s = m->s;
    double dload[6] = {0}, response[6];
    PH_TRY(ph_i_stepper_begin(m->s, dt, err));
    for (int i = 0; i < s->ns; i++) {
        double now = ph_i_run_by_stress(s->run, i) ? s->traction[i] : s->macro[i];
        if (direct(m, i))
            dload[i] = m->target[i] - now;
        else if (*s->last_dt > 0.0 && !ph_i_run_by_stress(s->run, i))
            dload[i] = s->last_macro[i] * dt / *s->last_dt;
    }
    PH_TRY(ph_i_stepper_solve(m->s, dload, err));
    PH_TRY(ph_i_stepper_response(m->s, response, stress, err));
    if (m->bends) PH_TRY(control(m, dt, response, stress, err));
out:
    return st;
}

/* ---- many ------------------------------------------------------------------------------- */

static ph_status take(march *m, const double *stress, ph_error *err)
{
    m->largest = fmax(m->largest, norm(m->s->ns, stress));
    m->report->steps++;
    return ph_i_stepper_accept(m->s, err);
}

static ph_status jump(march *m, int k, ph_error *err)
{
    ph_status st = PH_OK;
    double stress[6];
    for (int i = 0; i < m->s->ns; i++)
        m->target[i] = value_at(m, k, m->history->time[k], i);
    PH_TRY(attempt(m, 0.0, stress, err));
    PH_TRY(take(m, stress, err));
    ph_i_stepper_corner(m->s);
    m->dt = m->first;
out:
    return st;
}

/* The next step on the way to `end`: of the ladder, or two halves of what is left. */
static double next_step(const march *m, double left)
{
    double dt = m->fixed > 0.0 ? m->fixed : m->dt;
    if (dt >= left * (1.0 - 1e-9)) return left;
    return 2.0 * dt > left && m->fixed == 0.0 ? 0.5 * left : dt;
}

/* From where the medium is to `end`, between points k - 1 and k of the history. */
static ph_status advance(march *m, int k, double end, ph_error *err)
{
    ph_status st = PH_OK;
    ph_stepper *s = m->s;
    const double start = *s->time;
    double done = 0.0, all = end - start; /* small steps far from 0 keep their digits */
    while (done < all) {
        double dt = next_step(m, all - done), stress[6], error = 0.0;
        PH_CHECK(m->report->steps < m->most, PH_ENOCONV,
                 "time %g is not reached in %ld steps", end, m->most);
        for (int i = 0; i < s->ns; i++)
            m->target[i] = value_at(m, k, start + done + dt, i);
        PH_TRY(attempt(m, dt, stress, err));
        if (m->fixed == 0.0) {
            PH_TRY(ph_i_stepper_error(s, m->bends, &error, err));
            double most =
                m->tolerance * (norm(s->ns, stress) + least_stress * m->largest);
            if (error > most) {
                m->report->rejected++;
                m->dt = 0.5 * dt;
                PH_CHECK(m->dt > 1e-14 * end, PH_ENOCONV,
                         "the step at time %g would have to be shorter than %g",
                         start + done, m->dt);
                continue;
            }
            if (8.0 * error < most && dt >= m->dt) m->dt *= 2.0;
        }
        PH_TRY(take(m, stress, err));
        done = dt >= all - done ? all : done + dt;
        *s->time = start + done;
    }
    *s->time = end;
out:
    return st;
}

static ph_status check_input(const ph_load_history *h, int ns, int noutput,
                             const double *output, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(h && h->n >= 1, PH_EINVAL, "the history has no points");
    for (int k = 0; k < h->n; k++) {
        PH_CHECK(isfinite(h->time[k]) && h->time[k] >= (k ? h->time[k - 1] : 0.0),
                 PH_EINVAL, "times of the history must not decrease: %g is point %d",
                 h->time[k], k + 1);
        for (int i = 0; i < ns; i++)
            PH_CHECK(isfinite(h->value[k * ns + i]), PH_EINVAL,
                     "value %d of the history at time %g is %g", i + 1, h->time[k],
                     h->value[k * ns + i]);
    }
    for (int k = 0; k < noutput; k++)
        PH_CHECK(isfinite(output[k]) && output[k] >= (k ? output[k - 1] : h->time[0]),
                 PH_EINVAL, "output times must not decrease: %g is number %d", output[k],
                 k + 1);
out:
    return st;
}

static ph_status begin(march *m, const ph_stepping_params *p, ph_error *err)
{
    ph_status st = PH_OK;
    static const ph_stepping_params defaults;
    if (!p) p = &defaults;
    PH_CHECK(p->tolerance >= 0.0 && p->tolerance < 1.0 && p->fixed >= 0.0 &&
                 isfinite(p->fixed) && p->shortest >= 0.0 && isfinite(p->shortest) &&
                 p->most_steps >= 0,
             PH_EINVAL, "stepping: tolerance %g, step %g, first step %g, %ld steps",
             p->tolerance, p->fixed, p->shortest, p->most_steps);
    m->tolerance = error_of_step(p->tolerance > 0.0 ? p->tolerance : default_tolerance);
    m->fixed = p->fixed;
    m->first = p->shortest > 0.0 ? p->shortest
               : m->s->ntimes    ? 0.05 * m->s->tau[0]
                                 : (double)INFINITY;
    m->most = p->most_steps > 0 ? p->most_steps : DEFAULT_STEPS;
    m->dt = m->first;
    m->control = 10.0 * m->s->tolerance;
    for (int i = 0; i < m->s->ns; i++)
        if (!direct(m, i)) m->bends |= 1u << i;
out:
    return st;
}

ph_status ph_i_stepping(ph_stepper *s, const ph_load_history *h, int noutput,
                        const double *output, const ph_stepping_params *params,
                        ph_step_state *state, ph_stepping_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    march m = {.s = s, .history = h, .report = report};
    long before = s->run->op->applications, solves = s->solves, its = s->iterations;
    memset(report, 0, sizeof *report);
    PH_TRY(check_input(h, s->ns, noutput, output, err));
    PH_TRY(begin(&m, params, err));
    ph_i_stepper_reset(s);
    *s->time = h->time[0];
    for (int k = 0, out = 0; k <= h->n; k++) {
        double end = k < h->n ? h->time[k] : (double)INFINITY;
        for (; out < noutput && output[out] < end; out++) {
            PH_TRY(advance(&m, k, output[out], err));
            PH_TRY(ph_i_stepper_state(s, &state[out], err));
        }
        if (k == h->n) break;
        PH_TRY(advance(&m, k, end, err));
        bool jumps = k == 0 || h->time[k] == h->time[k - 1];
        if (jumps) PH_TRY(jump(&m, k, err));
        if (!jumps) {
            ph_i_stepper_corner(s);
            m.dt = m.first;
        }
    }
out:
    report->solves = s->solves - solves;
    report->iterations = s->iterations - its;
    report->applications = s->run->op->applications - before;
    return st;
}
