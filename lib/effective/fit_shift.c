/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shift factors by overlap, and the law behind them. */
#include "effective/fit_internal.h"

#include <math.h>
#include <string.h>

enum { LEAST = 3, SCAN = 400, SECTIONS = 60 };

/* ln of a point. */
typedef struct point {
    double x, y[2]; /* value, loss */
} point;

/* One temperature: points by rising x. */
typedef struct curve {
    double temperature, shift; /* ln a_T */
    int n, nvalues;            /* 2 values with loss, else 1 */
    point *p;                  /* [n] */
} curve;

static int by_x(const void *a, const void *b)
{
    const point *p = a, *q = b;
    return (p->x > q->x) - (p->x < q->x);
}

/* Points of one temperature out of the data, into room that all curves share. */
static void take_curve(const ph_prony_data *d, const double *temperature, double at,
                       bool loss, point *room, curve *c)
{
    *c = (curve){.temperature = at, .nvalues = 1 + loss, .p = room};
    for (ptrdiff_t i = 0; i < d->n; i++) {
        if (temperature[i] != at) continue;
        c->p[c->n++] = (point){.x = log(d->x[i]),
                               .y = {log(d->value[i]), loss ? log(d->loss[i]) : 0}};
    }
    qsort(c->p, (size_t)c->n, sizeof *c->p, by_x);
}

/* A value of a curve at x, between its points; false outside. */
static bool between(const curve *c, double x, double out[2])
{
    if (!(x >= c->p[0].x && x <= c->p[c->n - 1].x)) return false;
    int k = c->n - 1, below = 0;
    while (k - below > 1) { /* x lies between points below and k */
        int middle = below + (k - below) / 2;
        *(c->p[middle].x < x ? &below : &k) = middle;
    }
    const point *p = &c->p[below], *q = &c->p[k];
    double width = q->x - p->x, t = width > 0 ? (x - p->x) / width : 0.5;
    for (int v = 0; v < 2; v++)
        out[v] = p->y[v] + t * (q->y[v] - p->y[v]);
    return true;
}

static void add_differences(const curve *a, const curve *b, double by, double *sum,
                            int *count)
{
    for (int i = 0; i < a->n; i++) {
        double y[2];
        if (!between(b, a->p[i].x + by, y)) continue;
        for (int v = 0; v < a->nvalues; v++)
            *sum += (y[v] - a->p[i].y[v]) * (y[v] - a->p[i].y[v]);
        ++*count;
    }
}

/* Mean square of the differences where curve a, moved by `by`, overlaps b; infinite where
 * they share less than LEAST points on either side. */
static double mismatch(const curve *a, const curve *b, double by)
{
    double sum = 0;
    int count = 0, back;
    add_differences(a, b, by, &sum, &count);
    back = count;
    add_differences(b, a, -by, &sum, &count);
    if (back < LEAST || count - back < LEAST) return INFINITY;
    return sum / (count * a->nvalues);
}

/* The move that lets a coincide with b: a scan, then golden sections. */
static double best_move(const curve *a, const curve *b, double *left)
{
    const double golden = 0.6180339887498949;
    const double lo = b->p[0].x - a->p[a->n - 1].x, hi = b->p[b->n - 1].x - a->p[0].x;
    const double step = (hi - lo) / SCAN;
    double best = NAN;
    *left = INFINITY;
    for (int k = 1; k < SCAN; k++) {
        double value = mismatch(a, b, lo + k * step);
        if (value >= *left) continue;
        *left = value;
        best = lo + k * step;
    }
    double from = best - step, to = best + step;
    for (int k = 0; k < SECTIONS && isfinite(*left); k++) {
        double u = to - golden * (to - from), v = from + golden * (to - from);
        double fu = mismatch(a, b, u), fv = mismatch(a, b, v);
        if (fu < fv)
            to = v;
        else
            from = u;
        if (fmin(fu, fv) >= *left) continue;
        *left = fmin(fu, fv);
        best = fu < fv ? u : v;
    }
    return best;
}

static ph_status check_overlap(const ph_prony_data *d, const double *temperature,
                               double reference, ph_error *err)
{
    ph_status st = PH_OK;
    bool there = false;
    PH_CHECK(d->n > 0 && d->x && d->value && temperature, PH_EINVAL, "no data to shift");
    for (ptrdiff_t i = 0; i < d->n; i++) {
        PH_CHECK(isfinite(temperature[i]) && d->x[i] >= 1e-60 && d->x[i] <= 1e60 &&
                     d->value[i] >= 1e-60 && d->value[i] <= 1e60,
                 PH_EINVAL, "point %td: %g, %g at %g: must be positive and finite", i + 1,
                 d->x[i], d->value[i], temperature[i]);
        there = there || temperature[i] == reference;
    }
    PH_CHECK(there, PH_EINVAL, "no data at the reference temperature %g", reference);
out:
    return st;
}

/* The distinct temperatures, rising. @return their number */
static int distinct(ptrdiff_t n, const double *temperature, double *out)
{
    int count = 0;
    for (ptrdiff_t i = 0; i < n; i++) {
        int j = 0;
        while (j < count && out[j] < temperature[i])
            j++;
        if (j < count && out[j] == temperature[i]) continue;
        memmove(out + j + 1, out + j, (size_t)(count - j) * sizeof *out);
        out[j] = temperature[i];
        count++;
    }
    return count;
}

static ph_status join(curve *c, const curve *to, double sign, double *sum, ph_error *err)
{
    ph_status st = PH_OK;
    double left;
    PH_CHECK(c->n >= LEAST, PH_EINVAL, "%d points at %g: a curve needs %d", c->n,
             c->temperature, LEAST);
    double move = best_move(c, to, &left);
    PH_CHECK(isfinite(left), PH_EINVAL,
             "the data at %g and %g have nothing in common, however they are shifted",
             c->temperature, to->temperature);
    c->shift = to->shift - sign * move;
    *sum += left;
out:
    return st;
}

ph_status ph_shift_overlap(const ph_prony_data *data, const double *temperature,
                           double reference, double *factor, double *gap, ph_error *err)
{
    PH_GIVEN(data && temperature && factor);
    ph_status st = PH_OK;
    curve *c = NULL;
    point *room = NULL;
    double *t = NULL, sum = 0;
    bool loss = data->kind == PH_PRONY_DYNAMIC && data->loss;
    PH_TRY(check_overlap(data, temperature, reference, err));
    for (ptrdiff_t i = 0; i < data->n && loss; i++)
        loss = data->loss[i] > 0;
    PH_ALLOC(t, data->n + 1, "the temperatures");
    PH_ALLOC(room, data->n, "the curves");
    const int n = distinct(data->n, temperature, t);
    PH_ALLOC(c, n, "the curves");
    point *at = room;
    int middle = 0;
    for (int k = 0; k < n; k++) {
        take_curve(data, temperature, t[k], loss, at, &c[k]);
        at += c[k].n;
        if (t[k] == reference) middle = k;
    }
    PH_CHECK(c[middle].n >= LEAST, PH_EINVAL, "%d points at %g: a curve needs %d",
             c[middle].n, reference, LEAST);
    /* a_T of a time divides it, of a frequency multiplies it */
    const double sign = data->kind == PH_PRONY_DYNAMIC ? -1 : 1;
    for (int k = middle + 1; k < n; k++)
        PH_TRY(join(&c[k], &c[k - 1], sign, &sum, err));
    for (int k = middle - 1; k >= 0; k--)
        PH_TRY(join(&c[k], &c[k + 1], sign, &sum, err));
    for (ptrdiff_t i = 0; i < data->n; i++)
        for (int k = 0; k < n; k++)
            if (temperature[i] == t[k]) factor[i] = exp(c[k].shift);
    if (gap) *gap = n > 1 ? sqrt(sum / (n - 1)) : 0;
out:
    free(c);
    free(room);
    free(t);
    return st;
}

/* Least squares of ln a = -C1 ln(10) dT / (C2 + dT), linear as dT / log a = -(C2 + dT) / C1
 * first, then a few steps of Gauss and Newton in (C1, C2). */
static ph_status fit_wlf(int n, const double *dt, const double *lna, ph_shift *out,
                         ph_error *err)
{
    ph_status st = PH_OK;
    const double ten = log(10);
    double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int k = 0; k < n; k++) {
        if (lna[k] == 0) continue;
        double y = dt[k] / (lna[k] / ten);
        s += 1;
        sx += dt[k];
        sy += y;
        sxx += dt[k] * dt[k];
        sxy += dt[k] * y;
    }
    double det = s * sxx - sx * sx;
    PH_CHECK(s >= 2 && det > 0, PH_EINVAL,
             "WLF needs shifts at two temperatures besides the reference");
    double slope = (s * sxy - sx * sy) / det, at = (sy - slope * sx) / s;
    double c1 = -1 / slope, c2 = at / slope;
    for (int step = 0; step < 50; step++) {
        double a = 0, b = 0, d = 0, p = 0, q = 0;
        for (int k = 0; k < n; k++) {
            double f = -ten * dt[k] / (c2 + dt[k]), g = -c1 * f / (c2 + dt[k]);
            double r = lna[k] - c1 * f;
            a += f * f;
            b += f * g;
            d += g * g;
            p += f * r;
            q += g * r;
        }
        double determinant = a * d - b * b;
        if (!(determinant > 1e-14 * a * d)) break;
        double e1 = (d * p - b * q) / determinant, e2 = (a * q - b * p) / determinant;
        if (!(fabs(e2) < 0.5 * fabs(c2))) break;
        c1 += e1;
        c2 += e2;
        if (fabs(e1) < 1e-13 * fabs(c1) && fabs(e2) < 1e-13 * fabs(c2)) break;
    }
    bool valid = c1 > 0 && c2 > 0 && c1 < 1e60 && c2 < 1e60;
    for (int k = 0; k < n; k++)
        valid = valid && c2 + dt[k] > 0;
    PH_CHECK(valid, PH_EUNPHYSICAL, "no WLF law: C1 = %g, C2 = %g would come out", c1,
             c2);
    out->c1 = c1;
    out->c2 = c2;
out:
    return st;
}

static ph_status fit_arrhenius(int n, const double *temperature, const double *lna,
                               double reference, double kelvin, ph_shift *out,
                               ph_error *err)
{
    static const double gas_constant = 8.31446261815324;
    ph_status st = PH_OK;
    double xx = 0, xy = 0;
    for (int k = 0; k < n; k++) {
        double T = temperature[k] + kelvin, T0 = reference + kelvin;
        PH_CHECK(T > 0 && T0 > 0, PH_EINVAL,
                 "absolute temperatures must be > 0, got %g and %g", T, T0);
        double x = (T0 - T) / (T * T0) / gas_constant;
        xx += x * x;
        xy += x * lna[k];
    }
    PH_CHECK(xx > 0 && xy > 0, PH_EUNPHYSICAL,
             "no Arrhenius law: the times do not fall as the temperature rises");
    out->activation_energy = xy / xx;
out:
    return st;
}

ph_status ph_shift_fit(ph_shift_kind kind, int n, const double *temperature,
                       const double *factor, double reference, double kelvin,
                       ph_shift *out, double *misfit, ph_error *err)
{
    ph_status st = PH_OK;
    double *lna = NULL, *dt = NULL, sum = 0;
    ph_shift s = {.kind = kind, .reference = reference};
    PH_CHECK((kind == PH_SHIFT_WLF || kind == PH_SHIFT_ARRHENIUS) && n >= 1, PH_EINVAL,
             "a law needs a kind and at least one temperature besides the reference");
    PH_ALLOC(lna, n, "the shifts");
    PH_ALLOC(dt, n, "the shifts");
    for (int k = 0; k < n; k++) {
        PH_CHECK(isfinite(temperature[k]) && factor[k] > 0 && isfinite(factor[k]) &&
                     temperature[k] != reference,
                 PH_EINVAL, "factor %g at %g: must be positive, not at the reference",
                 factor[k], temperature[k]);
        lna[k] = log(factor[k]);
        dt[k] = temperature[k] - reference;
    }
    if (kind == PH_SHIFT_WLF)
        PH_TRY(fit_wlf(n, dt, lna, &s, err));
    else
        PH_TRY(fit_arrhenius(n, temperature, lna, reference, kelvin, &s, err));
    for (int k = 0; k < n; k++) {
        double a;
        PH_TRY(ph_shift_factor(&s, temperature[k], kelvin, &a, err));
        sum += (log(a) - lna[k]) * (log(a) - lna[k]);
    }
    *out = s;
    if (misfit) *misfit = sqrt(sum / n);
out:
    free(lna);
    free(dt);
    return st;
}
