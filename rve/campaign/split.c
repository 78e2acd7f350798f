/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An error parted between the size of the RVE, the grid and the number of realisations. */
#include "core/check.h"

#include <gsl/gsl_cdf.h>

#include <math.h>
#include <perihom_split.h>
#include <string.h>

enum { LEAST_PAIRS = 4, DOUBLINGS = 10 };
static const double told_apart = 0.05; /* level of the test for one scatter */

void ph_split_answer_free(ph_split_answer **answer)
{
    if (!answer || !*answer) return;
    free((*answer)->candidate);
    free((*answer)->point);
    free(*answer);
    *answer = NULL;
}

static double volume(const ph_split_question *q, int k)
{
    return pow(q->factor[k], q->dimensions);
}

static double law(const ph_split_question *q, int k)
{
    return pow(q->factor[k], -q->exponent);
}

static const double *values(const ph_split_question *q, int k, int p)
{
    return q->value + ((ptrdiff_t)k * q->npoints + p) * q->n;
}

static double student(const ph_split_question *q, double dof)
{
    return gsl_cdf_tdist_Pinv(0.5 + 0.5 * q->confidence, fmax(dof, 1));
}

static ph_split_size *at(const ph_split_question *q, const ph_split_answer *a, int k,
                         int p)
{
    return &a->point[k * q->npoints + p];
}

/* ---- the question ---- */

static ph_status check_arrays(const ph_split_question *q, ph_error *err)
{
    ph_status st = PH_OK;
    for (int k = 0; k < q->nsizes + q->nmore; k++)
        PH_CHECK(q->factor[k] > (k ? q->factor[k - 1] : 0) && isfinite(q->factor[k]),
                 PH_EINVAL, "factor %d, %g: must be > 0, finite and increasing", k,
                 q->factor[k]);
    for (int i = 0; i < q->nsizes * q->npoints; i++)
        PH_CHECK(q->cost[i] > 0 && isfinite(q->cost[i]), PH_EINVAL,
                 "cost %g: must be > 0 and finite", q->cost[i]);
    for (int j = 0; j < q->ngrids; j++)
        PH_CHECK(q->grid_error[j] >= 0 && isfinite(q->grid_error[j]) &&
                     q->grid_cost[j] > 0 && isfinite(q->grid_cost[j]),
                 PH_EINVAL, "grid %d: error %g and cost %g must be >= 0 and > 0", j,
                 q->grid_error[j], q->grid_cost[j]);
out:
    return st;
}

static ph_status check(const ph_split_question *q, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(q->factor && q->value && q->cost && q->grid_error && q->grid_cost, PH_EINVAL,
             "NULL factors, values, costs or grids");
    PH_CHECK(q->nsizes >= 2 && q->nmore >= 0 && q->nmore <= PH_SPLIT_SIZES &&
                 q->nsizes + q->nmore <= PH_SPLIT_SIZES,
             PH_EINVAL, "%d and %d sizes: 2 to %d are admissible", q->nsizes, q->nmore,
             PH_SPLIT_SIZES);
    PH_CHECK(q->ngrids >= 1 && q->ngrids <= PH_SPLIT_GRIDS && q->npoints >= 1, PH_EINVAL,
             "%d grids, %d points: 1 to %d and 1 or more are admissible", q->ngrids,
             q->npoints, PH_SPLIT_GRIDS);
    PH_CHECK(q->dimensions >= 1 && q->dimensions <= 3 && q->exponent > 0 &&
                 isfinite(q->exponent),
             PH_EINVAL, "%d dimensions, exponent %g", q->dimensions, q->exponent);
    PH_CHECK(q->accuracy > 0 && isfinite(q->accuracy) && q->confidence > 0 &&
                 q->confidence < 1,
             PH_EINVAL, "accuracy %g, confidence %g", q->accuracy, q->confidence);
    PH_CHECK(q->n >= LEAST_PAIRS && q->least >= 2 && q->least <= q->most &&
                 q->n <= q->most,
             PH_EINVAL, "%lld pilots, at least %lld, at most %lld realisations",
             (long long)q->n, (long long)q->least, (long long)q->most);
    PH_TRY(check_arrays(q, err));
out:
    return st;
}

/* ---- what the pilots say ---- */

static void moments(const double *x, int64_t n, ph_split_size *s)
{
    double m2 = 0;
    *s = (ph_split_size){0};
    for (int64_t i = 0; i < n; i++) {
        if (!isfinite(x[i])) continue;
        double delta = x[i] - s->mean;
        s->mean += delta / (double)++s->n;
        m2 += delta * (x[i] - s->mean);
    }
    s->deviation = s->n > 1 ? sqrt(m2 / (double)(s->n - 1)) : (double)NAN;
    s->scatter = s->deviation;
}

/* Variance times volume, one for all sizes; false: the test tells them apart. */
static bool one_scatter(const ph_split_question *q, const ph_split_answer *a, int p,
                        double *common)
{
    double dof = 0, sum = 0, logs = 0, inverse = 0;
    bool any = false, all = true;
    for (int k = 0; k < q->nsizes; k++) {
        const ph_split_size *s = at(q, a, k, p);
        double f = (double)(s->n - 1), v = s->deviation * s->deviation * volume(q, k);
        dof += f;
        sum += f * v;
        logs += f * log(v);
        inverse += 1 / f;
        any |= v > 0;
        all &= v > 0;
    }
    *common = sum / dof;
    if (!any) return true; /* nothing is random */
    if (!all) return false;
    double k = q->nsizes, bartlett = (dof * log(*common) - logs) /
                                     (1 + (inverse - 1 / dof) / (3 * (k - 1)));
    return gsl_cdf_chisq_Q(bartlett, k - 1) > told_apart;
}

/* c_k of the slope a = sum_k c_k x(f_k), least squares with weights f^d; and their spread. */
static double slope_weights(const ph_split_question *q, int nsizes, double *c)
{
    double sum = 0, mean = 0, spread = 0;
    for (int k = 0; k < nsizes; k++) {
        sum += volume(q, k);
        mean += volume(q, k) * law(q, k);
    }
    mean /= sum;
    for (int k = 0; k < nsizes; k++) {
        c[k] = volume(q, k) * (law(q, k) - mean);
        spread += c[k] * (law(q, k) - mean);
    }
    for (int k = 0; k < nsizes; k++)
        c[k] /= spread;
    return spread;
}

/* The bias of every size at a point, from realisations that are there at all of them. */
static ph_status find_bias(const ph_split_question *q, const ph_split_answer *a, int p,
                           ph_error *err)
{
    ph_status st = PH_OK;
    double c[PH_SPLIT_SIZES], mean = 0, m2 = 0;
    int64_t n = 0;
    slope_weights(q, q->nsizes, c);
    for (int64_t i = 0; i < q->n; i++) {
        double slope = 0;
        for (int k = 0; k < q->nsizes; k++)
            slope += c[k] * values(q, k, p)[i];
        if (!isfinite(slope)) continue;
        double delta = slope - mean;
        mean += delta / (double)++n;
        m2 += delta * (slope - mean);
    }
    PH_CHECK(n >= LEAST_PAIRS, PH_ESINGULAR,
             "point %d: %lld realisations did not fail at any of %d sizes, at least %d "
             "are needed",
             p, (long long)n, q->nsizes, LEAST_PAIRS);
    double dof = (double)(n - 1), half = student(q, dof) * sqrt(m2 / dof / (double)n);
    for (int k = 0; k < q->nsizes; k++) {
        at(q, a, k, p)->bias = mean * law(q, k);
        at(q, a, k, p)->bias_half_width = half * law(q, k);
    }
out:
    return st;
}

static ph_status look(const ph_split_question *q, ph_split_answer *a, ph_error *err)
{
    ph_status st = PH_OK;
    double common;
    a->one_scatter = true;
    for (int p = 0; p < q->npoints; p++) {
        for (int k = 0; k < q->nsizes; k++)
            moments(values(q, k, p), q->n, at(q, a, k, p));
        PH_TRY(find_bias(q, a, p, err));
        bool one = one_scatter(q, a, p, &common);
        a->one_scatter &= one;
        for (int k = 0; k < q->nsizes; k++) {
            ph_split_size *s = at(q, a, k, p);
            PH_CHECK(q->absolute || s->mean != 0, PH_ESINGULAR,
                     "point %d: the mean is zero, it has no relative error", p);
            if (one) s->scatter = sqrt(common / volume(q, k));
        }
    }
out:
    return st;
}

/* ---- what a size on a grid would take ---- */

/* Pilots as they are, or as they would be: of more sizes, more of them. */
typedef struct stock {
    int64_t n;
    int nsizes;
    double narrower; /* half width of the bias over that of now */
} stock;

/* What is there of a size: that of its pilots, or what the laws make of the last ones. */
static ph_split_size foreseen(const ph_split_question *q, const ph_split_answer *a, int k,
                              int p, const stock *there)
{
    int last = k < q->nsizes ? k : q->nsizes - 1;
    ph_split_size s = *at(q, a, last, p);
    double less = law(q, k) / law(q, last);
    s.bias *= less;
    s.bias_half_width *= less * there->narrower;
    s.scatter *= sqrt(volume(q, last) / volume(q, k));
    return s;
}

static double cost_of(const ph_split_question *q, int k, int p)
{
    int last = k < q->nsizes ? k : q->nsizes - 1;
    return q->cost[last * q->npoints + p] * volume(q, k) / volume(q, last);
}

static double scale_of(const ph_split_question *q, const ph_split_size *s)
{
    return q->absolute ? 1 : fabs(s->mean);
}

static double grid_of(const ph_split_question *q, const ph_split_size *s, int j)
{
    return q->absolute ? q->grid_error[j] * fabs(s->mean) : q->grid_error[j];
}

/* Realisations for a half width of `half`. */
static double number(const ph_split_question *q, double scatter, double half)
{
    double n = pow(student(q, 1e6) * scatter / half, 2);
    for (int i = 0; i < 20 && n < 1e6; i++)
        n = pow(student(q, fmax(n, 2) - 1) * scatter / half, 2);
    return ceil(fmax(n, (double)q->least));
}

static double error_of(const ph_split_question *q, const ph_split_size *s, int j,
                       double n)
{
    double scale = scale_of(q, s),
           half = student(q, n - 1) * s->scatter / sqrt(n) / scale;
    return fabs(s->bias) / scale + grid_of(q, s, j) +
           hypot(s->bias_half_width / scale, half);
}

/* What the point that has least of it leaves to the interval. */
static void find_room(const ph_split_question *q, const ph_split_answer *a,
                      const stock *there, ph_split_candidate *c)
{
    double least = INFINITY;
    c->half_width = NAN;
    for (int p = 0; p < q->npoints; p++) {
        ph_split_size s = foreseen(q, a, c->size, p, there);
        double scale = scale_of(q, &s), bias = fabs(s.bias) / scale,
               wide = s.bias_half_width / scale,
               room = q->accuracy - grid_of(q, &s, c->grid) - bias,
               left = room > wide ? sqrt((room - wide) * (room + wide)) : room - wide;
        if (left >= least) continue;
        least = left;
        c->point = p;
        c->bias = s.bias / scale;
        c->bias_half_width = wide;
    }
    c->meets = least > 0;
    if (c->meets) c->half_width = least;
}

/* Numbers and costs, once it is known what the interval may have. */
static ph_split_candidate weigh(const ph_split_question *q, const ph_split_answer *a,
                                int k, int j, const stock *there)
{
    ph_split_candidate c = {.size = k, .grid = j, .needed = 0};
    double pilots = j == 0 && k < there->nsizes ? (double)there->n : 0;
    find_room(q, a, there, &c);
    for (int p = 0; p < q->npoints; p++) {
        ph_split_size s = foreseen(q, a, k, p, there);
        double n = fmax(pilots, (double)q->least);
        if (c.meets)
            n = fmax(pilots, number(q, s.scatter, c.half_width * scale_of(q, &s)));
        c.meets &= n <= (double)q->most;
        double one = cost_of(q, k, p) * q->grid_cost[j];
        c.error = fmax(c.error, error_of(q, &s, j, n));
        c.needed += n;
        c.cost += n * one;
        c.to_go += (n - pilots) * one;
    }
    if (!c.meets) c.needed = c.cost = c.to_go = INFINITY;
    return c;
}

static bool is_better(const ph_split_candidate *a, const ph_split_candidate *b)
{
    if (a->to_go != b->to_go) return a->to_go < b->to_go;
    return a->error < b->error;
}

/* ---- plans ---- */

/* Costs to go of the best candidate after r doublings of the pilots of nsizes sizes, and of
 * these pilots. */
static double price(const ph_split_question *q, const ph_split_answer *a, int nsizes,
                    int r)
{
    double c[PH_SPLIT_SIZES], best = INFINITY, pilots = 0;
    double now = slope_weights(q, q->nsizes, c), then = slope_weights(q, nsizes, c);
    const stock plan = {q->n << r, nsizes, sqrt(now / then) * pow(2, -0.5 * r)};
    if (plan.n > q->most) return INFINITY;
    for (int k = 0; k < nsizes; k++) {
        int64_t there = k < q->nsizes ? q->n : 0;
        for (int p = 0; p < q->npoints; p++)
            pilots += (double)(plan.n - there) * cost_of(q, k, p);
        for (int j = 0; j < q->ngrids; j++)
            best = fmin(best, weigh(q, a, k, j, &plan).to_go);
    }
    return best + pilots;
}

/* The first step of the cheapest plan; of equal ones the one with less to do first. Nothing is
 * given up before the case's own edge was tried: small cells may be off by more than the law. */
static ph_split_step first_step(const ph_split_question *q, const ph_split_answer *a)
{
    double best = a->chosen >= 0 ? a->candidate[a->chosen].to_go : (double)INFINITY;
    ph_split_step step = a->chosen >= 0 ? PH_SPLIT_CHOSEN : PH_SPLIT_NONE;
    for (int n = q->nsizes; n <= q->nsizes + q->nmore; n++)
        for (int r = 0; r <= DOUBLINGS; r++) {
            double cost = price(q, a, n, r);
            if (!(cost < best)) continue;
            best = cost;
            step = n > q->nsizes ? PH_SPLIT_LARGER
                   : r > 0       ? PH_SPLIT_MORE
                                 : PH_SPLIT_CHOSEN;
        }
    bool own = q->nmore > 0 && q->factor[q->nsizes] <= 1;
    return step == PH_SPLIT_NONE && own ? PH_SPLIT_LARGER : step;
}

/* Where the bias is told from zero: the edge at which it takes half of what there is. */
static double edge_needed(const ph_split_question *q, const ph_split_answer *a)
{
    double most = 0;
    for (int p = 0; p < q->npoints; p++) {
        const ph_split_size *s = at(q, a, q->nsizes - 1, p);
        double room = 0.5 * (q->accuracy - grid_of(q, s, 0)) * scale_of(q, s);
        if (fabs(s->bias) <= s->bias_half_width || room <= 0) continue;
        double more = pow(fabs(s->bias) / room, 1 / q->exponent);
        most = fmax(most, q->factor[q->nsizes - 1] * more);
    }
    return most;
}

ph_status ph_split_choose(const ph_split_question *q, ph_split_answer **out,
                          ph_error *err)
{
    PH_GIVEN(q && out);
    ph_status st = PH_OK;
    ph_split_answer *a = NULL;
    *out = NULL;
    PH_TRY(check(q, err));
    PH_ALLOC(a, 1, "an answer");
    PH_ALLOC(a->candidate, q->nsizes * q->ngrids, "the candidates");
    PH_ALLOC(a->point, (size_t)q->nsizes * (size_t)q->npoints, "the pilots");
    PH_TRY(look(q, a, err));
    const stock now = {q->n, q->nsizes, 1};
    a->chosen = -1;
    for (int k = 0; k < q->nsizes; k++) {
        for (int p = 0; p < q->npoints; p++)
            a->pilot_cost += (double)q->n * cost_of(q, k, p);
        for (int j = 0; j < q->ngrids; j++) {
            int i = a->ncandidates++;
            ph_split_candidate *c = &a->candidate[i];
            *c = weigh(q, a, k, j, &now);
            if (c->meets && (a->chosen < 0 || is_better(c, &a->candidate[a->chosen])))
                a->chosen = i;
            if (c->error < a->candidate[a->nearest].error) a->nearest = i;
        }
    }
    a->step = first_step(q, a);
    a->factor_needed = edge_needed(q, a);
    *out = a;
    a = NULL;
out:
    ph_split_answer_free(&a);
    return st;
}

double ph_split_afforded(const ph_split_question *q, const ph_split_answer *a,
                         double cost)
{
    double best = INFINITY;
    if (!q || !a || !(cost >= 0)) return NAN;
    for (int i = 0; i < a->ncandidates; i++) {
        const ph_split_candidate *c = &a->candidate[i];
        double one = 0, worst = 0, there = c->grid == 0 ? (double)q->n : 0;
        for (int p = 0; p < q->npoints; p++)
            one += cost_of(q, c->size, p) * q->grid_cost[c->grid];
        double n = fmin(there + floor(cost / one), (double)q->most);
        if (n < (double)q->least) continue;
        for (int p = 0; p < q->npoints; p++)
            worst = fmax(worst, error_of(q, at(q, a, c->size, p), c->grid, n));
        best = fmin(best, worst);
    }
    return isfinite(best) ? best : (double)NAN;
}
