/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many realisations: sampling in stages. */
#include "core/check.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <perihom_campaign.h>

/* The share of the estimated number that the second sample takes. */
static const double second_share = 0.5;

static bool is_sequential(const ph_stopping *r)
{
    return r->relative_half_width > 0.0 || r->half_width > 0.0;
}

ph_status ph_sequence_start(ph_sequence *s, const ph_stopping *rule, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(s && rule, PH_EINVAL, "NULL sequence or rule");
    PH_CHECK(rule->at_most >= 1 && rule->at_least <= rule->at_most, PH_EINVAL,
             "at_least %lld, at_most %lld: 1 <= at_least <= at_most is admissible",
             (long long)rule->at_least, (long long)rule->at_most);
    PH_CHECK(rule->relative_half_width >= 0.0 && isfinite(rule->relative_half_width) &&
                 rule->half_width >= 0.0 && isfinite(rule->half_width),
             PH_EINVAL, "half widths must be finite and not negative");
    PH_CHECK(rule->confidence > 0.0 && rule->confidence < 1.0, PH_EINVAL,
             "confidence %g: must lie between 0 and 1", rule->confidence);
    PH_CHECK(!is_sequential(rule) || rule->at_least >= 2, PH_EINVAL,
             "at_least %lld: a deviation needs two values", (long long)rule->at_least);
    *s = (ph_sequence){.rule = *rule, .target = rule->at_most};
    if (is_sequential(rule)) s->target = rule->at_least;
out:
    return st;
}

static double deviation(const ph_sequence *s)
{
    return sqrt(s->m2 / (double)(s->n - 1));
}

static double student(const ph_sequence *s, int64_t n)
{
    return gsl_cdf_tdist_Pinv(0.5 + 0.5 * s->rule.confidence, (double)(n - 1));
}

/* N of the values so far; at_most where it is more, or where the mean is zero. */
static int64_t needed(const ph_sequence *s, double share)
{
    double d = s->rule.half_width > 0.0 ? s->rule.half_width
                                        : s->rule.relative_half_width * fabs(s->mean);
    double ratio = student(s, s->n) * deviation(s) / d;
    double n = ceil(share * ratio * ratio);
    return n <= (double)s->rule.at_most ? (int64_t)n : s->rule.at_most;
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* A stage is complete: how long is the next one? */
static void advance(ph_sequence *s)
{
    if (s->stage++ == 0) s->target = larger(s->n, needed(s, second_share));
    if (s->n == s->target) s->target = larger(s->n, needed(s, 1.0));
    s->done = s->n == s->target;
}

void ph_sequence_add(ph_sequence *s, double x)
{
    if (!s) return;
    double delta = x - s->mean;
    s->n++;
    s->mean += delta / (double)s->n;
    s->m2 += delta * (x - s->mean);
    if (s->done || s->n < s->target) return;
    if (is_sequential(&s->rule))
        advance(s);
    else
        s->done = true;
}

ph_interval ph_sequence_interval(const ph_sequence *s)
{
    if (!s) return (ph_interval){0};
    ph_interval i = {NAN, NAN, NAN, NAN};
    if (s->n > 0) i.mean = s->mean;
    if (s->n < 2) return i;
    i.deviation = deviation(s);
    i.standard_error = i.deviation / sqrt((double)s->n);
    i.half_width = student(s, s->n) * i.standard_error;
    return i;
}
