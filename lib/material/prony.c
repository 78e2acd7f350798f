/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/prony.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

/* Smallest eigenvalue of a positive semidefinite tensor that a file states with 9 digits,
 * relative to its largest. */
static const double rounding = 1e-9;
static const double shortest_time = 1e-300, longest_time = 1e300;

static ph_status check_tensor(const ph_sym4 *c, int n, const char *what, ph_error *err)
{
    ph_status st = PH_OK;
    double lo, hi, norm = ph_sym4_norm(c), skew = 0;
    PH_CHECK(c->n == n, PH_EINVAL, "%s is %d x %d, the series %d x %d", what, c->n, c->n,
             n, n);
    PH_CHECK(isfinite(norm), PH_EUNPHYSICAL, "%s: every entry must be a finite number",
             what);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            skew = fmax(skew, fabs(c->m[i][j] - c->m[j][i]));
    PH_CHECK(skew <= 1e-6 * norm, PH_EUNPHYSICAL, "%s must be symmetric", what);
    ph_sym4_eigenvalues(c, &lo, &hi);
    PH_CHECK(lo >= -rounding * fmax(hi, 0), PH_EUNPHYSICAL,
             "%s must be positive semidefinite, its eigenvalues are %g to %g (Mandel)",
             what, lo, hi);
out:
    return st;
}

ph_status ph_prony_validate(const ph_prony *p, ph_error *err)
{
    PH_GIVEN(p);
    ph_status st = PH_OK;
    const int n = p->equilibrium.n;
    PH_CHECK(n == 3 || n == 6, PH_EINVAL, "a series of tensors has n = 3 or 6, got %d",
             n);
    PH_TRY(check_tensor(&p->equilibrium, n, "the equilibrium tensor", err));
    for (int m = 0; m < p->nterms; m++) {
        char what[64];
        double time = p->term[m].time;
        snprintf(what, sizeof what, "the term of time %g", time);
        PH_CHECK(time >= shortest_time && time <= longest_time, PH_EUNPHYSICAL,
                 "a relaxation time must be > 0 (1e-300 to 1e300), got %g", time);
        PH_CHECK(m == 0 || time != p->term[m - 1].time, PH_EUNPHYSICAL,
                 "relaxation times must be distinct, got %.17g twice", time);
        PH_CHECK(m == 0 || time > p->term[m - 1].time, PH_EINVAL,
                 "the terms must be sorted by time: %g comes after %g", time,
                 p->term[m - 1].time);
        PH_TRY(check_tensor(&p->term[m].stiffness, n, what, err));
    }
out:
    return st;
}

static int by_time(const void *a, const void *b)
{
    double s = ((const ph_prony_term *)a)->time, t = ((const ph_prony_term *)b)->time;
    return (s > t) - (s < t);
}

static ph_status duplicate(const ph_sym4 *equilibrium, int nterms,
                           const ph_prony_term *term, ph_prony **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_prony *p = NULL;
    PH_ALLOC(p, 1, "a Prony series");
    p->equilibrium = *equilibrium;
    p->nterms = nterms;
    PH_ALLOC(p->term, nterms, "the terms of a Prony series");
    if (nterms > 0) memcpy(p->term, term, (size_t)nterms * sizeof *term);
    *out = p;
    p = NULL;
out:
    ph_prony_free(&p);
    return st;
}

ph_status ph_prony_new(const ph_sym4 *equilibrium, int nterms, const ph_prony_term *term,
                       ph_prony **out, ph_error *err)
{
    PH_GIVEN(equilibrium && out && (term || nterms == 0));
    ph_status st = PH_OK;
    ph_prony *p = NULL;
    *out = NULL;
    PH_CHECK(nterms >= 0, PH_EINVAL, "number of terms must be >= 0, got %d", nterms);
    PH_TRY(duplicate(equilibrium, nterms, term, &p, err));
    /* NaN first: it has no place in an order */
    for (int m = 0; m < nterms; m++)
        PH_CHECK(p->term[m].time > 0, PH_EUNPHYSICAL,
                 "a relaxation time must be > 0 (1e-300 to 1e300), got %g",
                 p->term[m].time);
    qsort(p->term, (size_t)nterms, sizeof *p->term, by_time);
    PH_TRY(ph_prony_validate(p, err));
    *out = p;
    p = NULL;
out:
    ph_prony_free(&p);
    return st;
}

ph_status ph_prony_copy(const ph_prony *p, ph_prony **out, ph_error *err)
{
    PH_GIVEN(out);
    *out = NULL;
    return p ? duplicate(&p->equilibrium, p->nterms, p->term, out, err) : PH_OK;
}

void ph_prony_free(ph_prony **p)
{
    if (!p || !*p) return;
    free((*p)->term);
    free(*p);
    *p = NULL;
}

static void add(ph_sym4 *sum, double factor, const ph_sym4 *c)
{
    for (int i = 0; i < sum->n; i++)
        for (int j = 0; j < sum->n; j++)
            sum->m[i][j] += factor * c->m[i][j];
}

ph_sym4 ph_prony_at_time(const ph_prony *p, double t)
{
    if (!p) return (ph_sym4){0};
    ph_sym4 c = p->equilibrium;
    for (int m = 0; m < p->nterms; m++)
        add(&c, exp(-t / p->term[m].time), &p->term[m].stiffness);
    return c;
}

ph_sym4 ph_prony_carson(const ph_prony *p, double s)
{
    if (!p) return (ph_sym4){0};
    ph_sym4 c = p->equilibrium;
    for (int m = 0; m < p->nterms; m++)
        /* x/(1+x) written with 1/x: an x that overflows or vanishes has its limit */
        add(&c, 1 / (1 + 1 / (s * p->term[m].time)), &p->term[m].stiffness);
    return c;
}

void ph_prony_complex(const ph_prony *p, double omega, ph_sym4 *re, ph_sym4 *im)
{
    if (!p || !re || !im) return;
    *re = p->equilibrium;
    *im = (ph_sym4){.n = re->n};
    for (int m = 0; m < p->nterms; m++) {
        double x = omega * p->term[m].time, inverse = 1 / x;
        add(re, 1 / (1 + inverse * inverse), &p->term[m].stiffness);
        add(im, 1 / (x + inverse), &p->term[m].stiffness);
    }
}

ph_sym4 ph_prony_instantaneous(const ph_prony *p)
{
    if (!p) return (ph_sym4){0};
    return ph_prony_carson(p, INFINITY);
}

void ph_prony_rotate(ph_prony *p, const double *R)
{
    if (!p || !R) return;
    p->equilibrium = ph_sym4_rotate(&p->equilibrium, R);
    for (int m = 0; m < p->nterms; m++)
        p->term[m].stiffness = ph_sym4_rotate(&p->term[m].stiffness, R);
}

ph_status ph_prony_scale_times(ph_prony *p, double factor, ph_error *err)
{
    PH_GIVEN(p);
    ph_status st = PH_OK;
    PH_CHECK(factor > 0 && isfinite(factor), PH_EUNPHYSICAL,
             "the factor of the relaxation times must be > 0 and finite, got %g", factor);
    for (int m = 0; m < p->nterms; m++) {
        double time = p->term[m].time * factor;
        PH_CHECK(time >= shortest_time && time <= longest_time, PH_EUNPHYSICAL,
                 "a relaxation time of %g times %g leaves 1e-300 to 1e300",
                 p->term[m].time, factor);
    }
    for (int m = 0; m < p->nterms; m++)
        p->term[m].time *= factor;
out:
    return st;
}
