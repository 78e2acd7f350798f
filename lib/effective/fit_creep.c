/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From retardations to relaxations: M(s) = 1 / J(s), pole by pole. */
#include "effective/fit_internal.h"

#include <math.h>
#include <string.h>

/* J on the negative axis s = -p: J0 + sum J_k / (1 - p t_k) - fluidity / p. */
typedef struct compliance {
    double instantaneous, fluidity;
    int n;
    const ph_modulus_term *term; /* [n] times falling, compliances > 0 */
} compliance;

/* A place p = (1 + d) / time of term `origin`; origin ZERO: p = d / the longest time. */
enum { ZERO = -1 };

static double place(const compliance *c, int origin, double d)
{
    return origin == ZERO ? d / c->term[0].time : (1 + d) / c->term[origin].time;
}

/* 1 - p t_k, exact for the origin itself. */
static double factor(const compliance *c, int origin, double d, int k)
{
    if (k == origin) return -d;
    double ratio = c->term[k].time / c->term[origin == ZERO ? 0 : origin].time;
    return origin == ZERO ? 1 - d * ratio : (1 - ratio) - d * ratio;
}

static double value(const compliance *c, int origin, double d)
{
    double sum = c->instantaneous;
    for (int k = 0; k < c->n; k++)
        sum += c->term[k].modulus / factor(c, origin, d, k);
    if (c->fluidity > 0) sum -= c->fluidity / place(c, origin, d);
    return sum;
}

/* The zero between lo and hi, J rising from negative to positive: in places relative to the
 * pole of `origin`, so that a zero near to it keeps its digits. Halves the logarithm where
 * the interval begins or ends at the pole. */
static double zero_between(const compliance *c, int origin, double lo, double hi)
{
    for (int step = 0; step < 2200; step++) {
        double middle = 0.5 * (lo + hi);
        if (lo > 0 && hi / lo > 4) middle = sqrt(lo) * sqrt(hi);
        if (hi < 0 && lo / hi > 4) middle = -sqrt(-lo) * sqrt(-hi);
        if (middle <= lo || middle >= hi) break;
        if (value(c, origin, middle) > 0)
            hi = middle;
        else
            lo = middle;
    }
    return 0.5 * (lo + hi);
}

/* The term of M that belongs to a zero. */
static ph_modulus_term term_at(const compliance *c, int origin, double d)
{
    const double time = 1 / place(c, origin, d);
    double sum = 0; /* p times the derivative of J(-p) */
    for (int k = 0; k < c->n; k++) {
        double f = factor(c, origin, d, k);
        sum += c->term[k].modulus * (c->term[k].time / time) / (f * f);
    }
    sum += c->fluidity * time;
    return (ph_modulus_term){.time = time, .modulus = 1 / sum};
}

/* The zero of a fluid before the first pole. */
static ph_modulus_term before_all(const compliance *c)
{
    if (value(c, ZERO, 0.5) > 0)
        return term_at(c, ZERO, zero_between(c, ZERO, 1e-300, 0.5));
    return term_at(c, 0, zero_between(c, 0, -0.5, -1e-300));
}

/* The zero between the poles of terms k and k + 1 (times falling: p rises). */
static ph_modulus_term between(const compliance *c, int k)
{
    const double tiny = 1e-300;
    const double span = c->term[k].time / c->term[k + 1].time - 1; /* in d of origin k */
    if (value(c, k, 0.5 * span) > 0)
        return term_at(c, k, zero_between(c, k, tiny, 0.5 * span));
    const double back = 1 - c->term[k + 1].time / c->term[k].time;
    return term_at(c, k + 1, zero_between(c, k + 1, -0.5 * back, -tiny));
}

static ph_status check_compliance(double instantaneous, int n,
                                  const ph_modulus_term *retardation, double fluidity,
                                  ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(instantaneous >= 0 && instantaneous <= 1e300 && fluidity >= 0 &&
                 fluidity <= 1e300 && n >= 0,
             PH_EUNPHYSICAL,
             "compliance %g and fluidity %g: must be finite and not negative",
             instantaneous, fluidity);
    PH_CHECK(instantaneous > 0, PH_ESINGULAR,
             "no instantaneous compliance: the modulus would begin at infinity");
    for (int k = 0; k < n; k++) {
        const ph_modulus_term *t = &retardation[k];
        PH_CHECK(t->time > 0 && t->time <= 1e300 && t->modulus >= 0 &&
                     t->modulus <= 1e300,
                 PH_EUNPHYSICAL,
                 "retardation %d: time %g, compliance %g: must be finite, the time "
                 "positive, the compliance not negative",
                 k + 1, t->time, t->modulus);
        for (int j = 0; j < k; j++)
            PH_CHECK(retardation[j].time != t->time, PH_EUNPHYSICAL,
                     "retardation time %g is there twice", t->time);
    }
out:
    return st;
}

/* By falling time, without those of no compliance. */
static int sort_terms(int n, const ph_modulus_term *from, ph_modulus_term *to)
{
    int count = 0;
    for (int k = 0; k < n; k++) {
        if (from[k].modulus == 0) continue;
        int j = count++;
        for (; j > 0 && to[j - 1].time < from[k].time; j--)
            to[j] = to[j - 1];
        to[j] = from[k];
    }
    return count;
}

/* Only spring and dashpot: one Maxwell element. */
static void maxwell(double instantaneous, double fluidity, double *infinity, int *nterms,
                    ph_modulus_term *term)
{
    *nterms = fluidity > 0;
    *infinity = fluidity > 0 ? 0 : 1 / instantaneous;
    if (fluidity > 0)
        term[0] = (ph_modulus_term){.time = instantaneous / fluidity,
                                    .modulus = 1 / instantaneous};
}

ph_status ph_modulus_of_creep(double instantaneous, int n,
                              const ph_modulus_term *retardation, double fluidity,
                              double *infinity, int *nterms, ph_modulus_term *term,
                              ph_error *err)
{
    PH_GIVEN(infinity && nterms && term && (retardation || n == 0));
    ph_status st = PH_OK;
    ph_modulus_term *sorted = NULL;
    PH_TRY(check_compliance(instantaneous, n, retardation, fluidity, err));
    PH_ALLOC(sorted, n, "the inverse of a compliance");
    compliance c = {instantaneous, fluidity, sort_terms(n, retardation, sorted), sorted};
    if (c.n == 0) {
        maxwell(instantaneous, fluidity, infinity, nterms, term);
        goto out;
    }
    int count = 0;
    /* p rises from 0: the times come out falling */
    if (fluidity > 0) term[count++] = before_all(&c);
    for (int k = 0; k + 1 < c.n; k++)
        term[count++] = between(&c, k);
    double far = 1; /* J is positive far beyond the last pole */
    while (value(&c, c.n - 1, far) <= 0 && far < 1e300)
        far *= 4;
    term[count++] = term_at(&c, c.n - 1, zero_between(&c, c.n - 1, 1e-300, far));
    for (int k = 0; k < count / 2; k++) {
        ph_modulus_term t = term[k];
        term[k] = term[count - 1 - k];
        term[count - 1 - k] = t;
    }
    double rubber = instantaneous;
    for (int k = 0; k < c.n; k++)
        rubber += sorted[k].modulus;
    *infinity = fluidity > 0 ? 0 : 1 / rubber;
    *nterms = count;
out:
    free(sorted);
    return st;
}
