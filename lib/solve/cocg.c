/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/cocg.h"

#include "core/complex.h"

#include <math.h>
#include <string.h>

/* x^T y */
static double complex bilinear(const ph_space *s, ph_complex_vector x,
                               ph_complex_vector y)
{
    double re = ph_i_dot(s, x.re, y.re) - ph_i_dot(s, x.im, y.im);
    double im = ph_i_dot(s, x.re, y.im) + ph_i_dot(s, x.im, y.re);
    return ph_i_complex(re, im);
}

static double square(const ph_space *s, ph_complex_vector x)
{
    return ph_i_dot(s, x.re, x.re) + ph_i_dot(s, x.im, x.im);
}

/* y += a x */
static void add(const ph_space *s, double complex a, ph_complex_vector x,
                ph_complex_vector y)
{
    const double re = creal(a), im = cimag(a);
    ptrdiff_t n = s->planes * s->plane;
#pragma omp parallel for simd num_threads(s->threads) schedule(static)
    for (ptrdiff_t k = 0; k < n; k++) {
        double u = x.re[k], v = x.im[k];
        y.re[k] += re * u - im * v;
        y.im[k] += im * u + re * v;
    }
}

/* p = z + b p */
static void direction(const ph_space *s, double complex b, ph_complex_vector z,
                      ph_complex_vector p)
{
    const double re = creal(b), im = cimag(b);
    ptrdiff_t n = s->planes * s->plane;
#pragma omp parallel for simd num_threads(s->threads) schedule(static)
    for (ptrdiff_t k = 0; k < n; k++) {
        double u = p.re[k], v = p.im[k];
        p.re[k] = z.re[k] + re * u - im * v;
        p.im[k] = z.im[k] + im * u + re * v;
    }
}

/* q = (S + i L) p */
static void apply(const ph_complex_linear *s, ph_complex_vector p, ph_complex_vector q,
                  double *t)
{
    ptrdiff_t n = s->space->planes * s->space->plane;
    s->apply(s->self, false, p.re, q.re);
    s->apply(s->self, true, p.im, t);
    for (ptrdiff_t k = 0; k < n; k++)
        q.re[k] -= t[k];
    s->apply(s->self, false, p.im, q.im);
    s->apply(s->self, true, p.re, t);
    for (ptrdiff_t k = 0; k < n; k++)
        q.im[k] += t[k];
}

ph_status ph_i_cocg(const ph_complex_linear *s, ph_complex_vector x, ph_complex_vector r,
                    ph_complex_vector p, ph_complex_vector q, double *t,
                    ph_cg_report *rep, ph_error *err)
{
    const ph_space *space = s->space;
    size_t bytes = ph_i_space_size(space) * sizeof(double);
    double b2 = square(space, r);
    double complex rz = 0.0;
    memset(x.re, 0, bytes);
    memset(x.im, 0, bytes);
    memset(p.re, 0, bytes);
    memset(p.im, 0, bytes);
    rep->iterations = 0;
    rep->residual = b2 > 0.0 ? 1.0 : 0.0;
    if (!isfinite(b2))
        return ph_i_give_up(PH_ESINGULAR, rep, "the load is not finite", err);
    while (rep->residual > rep->tolerance) {
        if (rep->iterations >= rep->max_iterations)
            return ph_i_give_up(PH_ENOCONV, rep, "not converged", err);
        s->precondition(s->self, r.re, q.re); /* z lives in q until A p is there */
        s->precondition(s->self, r.im, q.im);
        double complex rz_new = bilinear(space, r, q);
        direction(space, rep->iterations ? rz_new / rz : 0.0, q, p);
        rz = rz_new;
        apply(s, p, q, t);
        double complex pq = bilinear(space, p, q), alpha = rz / pq;
        if (!isfinite(cabs(alpha)) || cabs(rz) == 0.0)
            return ph_i_give_up(PH_ESINGULAR, rep, "the iteration broke down", err);
        add(space, alpha, p, x);
        add(space, -alpha, q, r);
        rep->iterations++;
        rep->residual = sqrt(square(space, r) / b2);
        if (!isfinite(rep->residual))
            return ph_i_give_up(PH_ESINGULAR, rep, "the iteration overflowed", err);
        if (ph_i_told_to_stop(rep))
            return ph_i_give_up(PH_ECANCELLED, rep, "interrupted", err);
    }
    return PH_OK;
}
