/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/step_control.h"

#include <math.h>
#include <string.h>

enum { CORRECTIONS = 40 };

ph_step_control ph_i_step_control(ph_stepper *s, unsigned stress)
{
    ph_step_control c = {.s = s, .stress = stress, .tolerance = 10.0 * s->tolerance};
    for (int i = 0; i < s->ns; i++)
        c.bends = c.bends || !ph_i_step_is_direct(&c, i);
    return c;
}

bool ph_i_step_is_direct(const ph_step_control *c, int i)
{
    return (c->stress >> i & 1) == (unsigned)ph_i_run_by_stress(c->s->run, i);
}

/* ---- one step of a given length ---------------------------------------------------------- */

/* Loads of the components that are prescribed by their responses: T_xx d = what is missing. */
static ph_status missing_load(const ph_step_control *c, const double *response,
                              double *dload, ph_error *err)
{
    ph_status st = PH_OK;
    double a[6][7];
    int x[6], n = 0;
    for (int i = 0; i < c->s->ns; i++)
        if (!ph_i_step_is_direct(c, i)) x[n++] = i;
    for (int p = 0; p < n; p++) {
        for (int q = 0; q < n; q++)
            a[p][q] = c->tangent.m[x[p]][x[q]];
        a[p][n] = c->target[x[p]] - response[x[p]];
    }
    for (int k = 0; k < n; k++) {
        int top = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[top][k])) top = i;
        PH_CHECK(fabs(a[top][k]) > 1e-14 * ph_sym4_norm(&c->tangent), PH_ESINGULAR,
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

static double miss(const ph_step_control *c, const double *response)
{
    double sum = 0.0;
    for (int i = 0; i < c->s->ns; i++) {
        double d = ph_i_step_is_direct(c, i) ? 0.0 : c->target[i] - response[i];
        sum += d * d;
    }
    return sqrt(sum);
}

/* What is missing is held against the largest of target and response; a stress, against all
 * stresses: those that should be zero need not be round-off. */
static double scale_of(const ph_step_control *c, const double *response,
                       const double *stress)
{
    double size = c->least;
    for (int i = 0; i < c->s->ns; i++) {
        if (ph_i_step_is_direct(c, i)) continue;
        size = fmax(size, fmax(fabs(c->target[i]), fabs(response[i])));
        for (int j = 0; c->stress >> i & 1 && j < c->s->ns; j++)
            size = fmax(size, fabs(stress[j]));
    }
    return size;
}

/* Take up the tangent of this dt; the step begins anew. */
static ph_status new_tangent(ph_step_control *c, double dt, const double *dload,
                             ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_stepper_tangent(c->s, dt, &c->tangent, NULL, err));
    PH_TRY(ph_i_stepper_begin(c->s, dt, err));
    PH_TRY(ph_i_stepper_solve(c->s, dload, err));
out:
    return st;
}

/* Correct the loads until the responses are what they should be. The tangent of another dt is
 * good enough as long as it helps. */
static ph_status control(ph_step_control *c, double dt, double *response, double *stress,
                         ph_error *err)
{
    ph_status st = PH_OK;
    double dload[6], total[6] = {0}, before = INFINITY,
                     largest = scale_of(c, response, stress);
    bool own = false;
    for (int i = 0; i < c->s->ns; i++)
        if (ph_i_step_is_direct(c, i)) total[i] = c->target[i];
    for (int k = 0; k < CORRECTIONS; k++) {
        double off = miss(c, response);
        largest = fmax(largest, scale_of(c, response, stress));
        if (off <= c->tolerance * largest) return PH_OK;
        if (c->tangent.n == 0 || (off > 0.3 * before && !own)) {
            for (int i = 0; i < c->s->ns; i++)
                total[i] = ph_i_run_by_stress(c->s->run, i) ? c->s->dtraction[i]
                                                            : c->s->dmacro[i];
            PH_TRY(new_tangent(c, dt, total, err));
            PH_TRY(ph_i_stepper_response(c->s, response, stress, err));
            own = true;
            off = miss(c, response);
        }
        PH_TRY(missing_load(c, response, dload, err));
        PH_TRY(ph_i_stepper_solve(c->s, dload, err));
        PH_TRY(ph_i_stepper_response(c->s, response, stress, err));
        before = off;
    }
    PH_CHECK(
        miss(c, response) <= c->tolerance * largest, PH_ENOCONV,
        "the macro stress was not reached in %d corrections: %.3g of %.3g is missing",
        CORRECTIONS, miss(c, response), largest);
out:
    return st;
}

ph_status ph_i_step_attempt(ph_step_control *c, double dt, double *stress, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stepper *s = c->s;
    double dload[6] = {0}, response[6];
    PH_TRY(ph_i_stepper_begin(c->s, dt, err));
    for (int i = 0; i < s->ns; i++) {
        double now = ph_i_run_by_stress(s->run, i) ? s->traction[i] : s->macro[i];
        if (ph_i_step_is_direct(c, i))
            dload[i] = c->target[i] - now;
        else if (*s->last_dt > 0.0 && !ph_i_run_by_stress(s->run, i))
            dload[i] = s->last_macro[i] * dt / *s->last_dt;
    }
    PH_TRY(ph_i_stepper_solve(c->s, dload, err));
    PH_TRY(ph_i_stepper_response(c->s, response, stress, err));
    if (c->bends) PH_TRY(control(c, dt, response, stress, err));
out:
    return st;
}
