/* SPDX-License-Identifier: GPL-3.0-or-later */
/* With x = dt/tau and the strain straight over the step, q(s) = q0 exp(-s) + d eps
 * (1 - exp(-s))/x for s = t/tau from 0 to x, and
 *
 *   1/dt int q dt        = A q0 + B d eps,                A = (1 - exp(-x))/x, B = (1 - A)/x
 *   1/tau int q.C.q dt   = w00 q0.C.q0 + w01 q0.C.d eps + w11 d eps.C.d eps
 *   w00 = (1 - exp(-2x))/2, w01 = (1 - exp(-x))^2/x, w11 = (x - 2 (1 - exp(-x)) + w00)/x^2 */
#include "effective/stepper.h"

#include <math.h>

typedef struct weights {
    double A, B, w00, w01, w11;
} weights;

static weights weights_of(double x)
{
    double e = -expm1(-x), A = ph_i_step_ramp(x);
    if (x == 0.0) return (weights){1.0, 0.5, 0.0, 0.0, 0.0};
    if (isinf(x)) return (weights){0.0, 0.0, 0.5, 0.0, 0.0};
    weights w = {
        .A = A, .B = (1.0 - A) / x, .w00 = -0.5 * expm1(-2.0 * x), .w01 = e * e / x};
    w.w11 = (x - 2.0 * e + w.w00) / x / x;
    if (x < 1e-3) { /* differences of nearly equal numbers: series */
        w.B = 0.5 - x / 6.0 + x * x / 24.0;
        w.w11 = x / 3.0 - x * x / 4.0 + 7.0 * x * x * x / 60.0;
    }
    return w;
}

static double dot(ptrdiff_t n, const double *a, const double *b)
{
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* q0.C.d eps of a branch whose tensors are shown; `stress` is the sum of C d eps. */
static double mixed(ph_stepper *s, int m, const double *stress)
{
    ph_operator *op = s->run->op;
    const double *memory = s->memory + m * s->unknowns;
    double sum = dot(s->ns, s->macro_memory + 6 * m, stress);
    ph_i_operator_apply(op, s->du, op->f);
    sum += dot(s->unknowns, memory, op->f);
    ph_i_operator_load(op, s->dmacro, op->f); /* less B^T C macro */
    return sum - dot(s->unknowns, memory, op->f);
}

/* Increments of the mean strain. */
static ph_status strain_increment(ph_stepper *s, double d[6], ph_error *err)
{
    ph_status st = PH_OK;
    double response[6], stress[6];
    PH_TRY(ph_i_stepper_response(s, response, stress, err));
    for (int i = 0; i < s->ns; i++)
        d[i] = ph_i_run_by_stress(s->run, i) ? response[i] - s->strain[i] : s->dmacro[i];
out:
    return st;
}

ph_status ph_i_stepper_work(ph_stepper *s, ph_step_work *out, ph_error *err)
{
    ph_status st = PH_OK;
    const uint8_t *region = s->run->setting.region;
    const double n = (double)s->run->setting.averaged;
    double d[6], mean[6] = {0};
    *out = (ph_step_work){0};
    PH_CHECK(!s->cuts, PH_EINVAL, "the work of a step is not that of cut cells");
    PH_TRY(strain_increment(s, d, err));
    for (int m = 0; m <= s->ntimes; m++) {
        bool total = m == s->ntimes;
        double x = total ? 0.0 : s->dt / s->tau[m], stress[6], strain[6];
        weights w = weights_of(x);
        ph_cell_energy e;
        ph_i_stepper_show(s, m);
        PH_TRY(ph_i_operator_sums(s->run->op, s->du, s->dmacro, region, stress, strain,
                                  &e, err));
        for (int i = 0; i < s->ns; i++)
            mean[i] += w.A * s->part[6 * m + i] + w.B * stress[i] / n;
        if (total || x == 0.0) continue;
        out->viscous += w.w00 * s->held[m] + w.w01 * mixed(s, m, stress) +
                        w.w11 * (e.mean + e.modes + e.stabilisation);
    }
    out->viscous /= n;
    out->external = dot(s->ns, mean, d);
out:
    ph_i_stepper_show_tangent(s);
    return st;
}
