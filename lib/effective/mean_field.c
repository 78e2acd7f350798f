/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/composite.h"

#include <math.h>

const char *ph_i_laminate_refuses(const ph_composite *composite)
{
    if (composite->shape != PH_SHAPE_LAMINATE) return "the phases are not layers";
    return ph_i_shape_refusal(composite);
}

/* Exact with any medium; the mean stiffness is one that is always positive. */
ph_status ph_i_laminate(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0;
    PH_TRY(ph_i_composite_check(composite, ph_i_laminate_refuses(composite), err));
    PH_TRY(ph_i_voigt(composite, &c0, err));
    PH_TRY(ph_i_mix(composite, &c0, out, err));
out:
    return st;
}

const char *ph_i_dilute_refuses(const ph_composite *composite)
{
    return ph_i_matrix_refusal(composite);
}

ph_status ph_i_dilute(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0, t;
    PH_TRY(ph_i_composite_check(composite, ph_i_dilute_refuses(composite), err));
    PH_TRY(ph_i_phase_stiffness(composite, 0, &c0, err));
    PH_TRY(ph_i_polarise(composite, &c0, &t, NULL, err));
    t = ph_sym4_combine(1.0, &c0, 1.0, &t);
    t = ph_i_symmetric(&t);
    PH_CHECK(ph_sym4_is_stiffness(&t), PH_EUNPHYSICAL,
             "not positive definite at this fraction: inclusions are not dilute");
    *out = t;
out:
    return st;
}

const char *ph_i_mori_tanaka_refuses(const ph_composite *composite)
{
    return ph_i_matrix_refusal(composite);
}

ph_status ph_i_mori_tanaka(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c0;
    PH_TRY(ph_i_composite_check(composite, ph_i_mori_tanaka_refuses(composite), err));
    PH_TRY(ph_i_phase_stiffness(composite, 0, &c0, err));
    PH_TRY(ph_i_mix(composite, &c0, out, err));
    /* only voids: nothing is left, and nothing is the answer */
    if (composite->fraction[0] == 0.0 && ph_sym4_norm(out) < 1e-12 * ph_sym4_norm(&c0))
        *out = (ph_sym4){.n = c0.n};
out:
    return st;
}

const char *ph_i_self_consistent_refuses(const ph_composite *composite)
{
    return ph_i_shape_refusal(composite);
}

/* C <- mix(C) falls from the Voigt bound, an upper bound at every step, to the largest fixed
 * point; slowly only where a phase is about to percolate. */
ph_status ph_i_self_consistent(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    const double tolerance = 1e-13,
                 enough = 1e-10; /* the latter where round-off stalls it */
    double change = 1.0, best = 1.0;
    int stalled = 0;
    ph_sym4 c, next, d;
    PH_TRY(ph_i_composite_check(composite, ph_i_self_consistent_refuses(composite), err));
    PH_TRY(ph_i_voigt(composite, &c, err));
    const double start = ph_sym4_norm(&c);
    for (int k = 0; k < 5000 && change > tolerance && stalled < 10; k++) {
        double lowest;
        ph_sym4_eigenvalues(&c, &lowest, NULL);
        PH_CHECK(lowest > 1e-9 * start, PH_ESINGULAR,
                 "no stiffness is left: the voids percolate at this fraction");
        PH_TRY(ph_i_mix(composite, &c, &next, err));
        d = ph_sym4_combine(1.0, &next, -1.0, &c);
        change = ph_sym4_norm(&d) / ph_sym4_norm(&next);
        if (change > 0.999 * best && change < enough) stalled++;
        best = fmin(best, change);
        c = next;
    }
    PH_CHECK(change <= enough, PH_ENOCONV,
             "self-consistent iteration stopped at a change of %.1g: a phase is about to "
             "percolate",
             change);
    *out = c;
out:
    return st;
}

const char *ph_i_differential_refuses(const ph_composite *composite)
{
    const char *matrix = ph_i_matrix_refusal(composite);
    if (matrix) return matrix;
    return composite->fraction[0] > 0.0 ? NULL : "no matrix is left";
}

/* dC/dtau = sum_i w_i (C_i - C) A_i(C), w_i the share of phase i among the inclusions. */
static ph_status slope(const ph_composite *inclusions, const ph_sym4 *c, ph_sym4 *rate,
                       ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_polarise(inclusions, c, rate, NULL, err));
    *rate = ph_i_symmetric(rate);
out:
    return st;
}

static ph_status runge_kutta_4(const ph_composite *inclusions, const ph_sym4 *c, double h,
                               ph_sym4 *end, ph_error *err)
{
    ph_status st = PH_OK;
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1, 2, 2, 1};
    ph_sym4 k = {.n = c->n}, y, sum = *c;
    for (int i = 0; i < 4; i++) {
        y = ph_sym4_combine(1.0, c, at[i] * h, &k);
        PH_TRY(slope(inclusions, &y, &k, err));
        sum = ph_sym4_combine(1.0, &sum, weight[i] * h / 6.0, &k);
    }
    *end = sum;
out:
    return st;
}

/* From tau = 0 to `to` with step doubling and Richardson's correction. */
static ph_status integrate(const ph_composite *inclusions, double to, ph_sym4 *c,
                           ph_error *err)
{
    ph_status st = PH_OK;
    const double tolerance = 1e-10; /* relative, of a step */
    double tau = 0.0, h = fmin(to, 0.05);
    ph_sym4 coarse, fine, d;
    for (int steps = 0; tau < to; steps++) {
        PH_CHECK(steps < 20000, PH_ENOCONV,
                 "differential scheme: steps became too small");
        h = fmin(h, to - tau);
        ph_status trial = runge_kutta_4(inclusions, c, h, &coarse, NULL);
        if (trial == PH_OK) trial = runge_kutta_4(inclusions, c, 0.5 * h, &fine, NULL);
        if (trial == PH_OK)
            trial = runge_kutta_4(inclusions, &fine, 0.5 * h, &fine, NULL);
        if (trial != PH_OK) { /* a stage left the positive tensors */
            PH_CHECK(h > 1e-12 * to, trial, "differential scheme: no stiffness is left");
            h *= 0.25;
            continue;
        }
        d = ph_sym4_combine(1.0 / 15.0, &fine, -1.0 / 15.0, &coarse);
        double error = ph_sym4_norm(&d) / (tolerance * ph_sym4_norm(&fine)) + 1e-10;
        if (error <= 1.0) {
            *c = ph_sym4_combine(1.0, &fine, 1.0, &d);
            tau = h < to - tau ? tau + h : to;
        }
        h *= fmin(4.0, fmax(0.2, 0.9 * pow(error, -0.2)));
    }
out:
    return st;
}

/* The inclusions enter in steps too small to see each other, each step replacing whatever is
 * there: with c their fraction so far, tau = -log(1 - c). */
ph_status ph_i_differential(const ph_composite *composite, ph_sym4 *out, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = composite->n;
    const double total = 1.0 - composite->fraction[0];
    double *share = NULL;
    ph_sym4 c;
    PH_TRY(ph_i_composite_check(composite, ph_i_differential_refuses(composite), err));
    PH_TRY(ph_i_phase_stiffness(composite, 0, &c, err));
    if (total > 0.0) {
        ph_composite inclusions = *composite;
        PH_ALLOC(share, n, "shares of the inclusions");
        for (int i = 1; i < n; i++)
            share[i] = composite->fraction[i] / total;
        inclusions.fraction = share;
        PH_TRY(integrate(&inclusions, -log(composite->fraction[0]), &c, err));
    }
    *out = c;
out:
    free(share);
    return st;
}
