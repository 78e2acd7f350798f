/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/stepping.h"

#include "effective/step_control.h"

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
enum { DEFAULT_STEPS = 1000000 };

typedef struct march {
    ph_stepper *s;
    ph_step_control control;
    const ph_load_history *history;
    double tolerance, fixed, first;
    double dt; /* of the ladder */
    long most;
    unsigned bends; /* components whose load is found, not given */
    double largest; /* stress so far */
    ph_stepping_report *report;
} march;

static double norm(int n, const double *x)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
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
        m->control.target[i] = value_at(m, k, m->history->time[k], i);
    PH_TRY(ph_i_step_attempt(&m->control, 0.0, stress, err));
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
            m->control.target[i] = value_at(m, k, start + done + dt, i);
        PH_TRY(ph_i_step_attempt(&m->control, dt, stress, err));
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
    for (int i = 0; i < m->s->ns; i++)
        if (!ph_i_step_is_direct(&m->control, i)) m->bends |= 1u << i;
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
    m.control = ph_i_step_control(s, h->stress);
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
