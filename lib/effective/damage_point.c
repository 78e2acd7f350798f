/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The damage law at one integration point. */
#include "core/check.h"
#include "effective/damage_law.h"

#include <math.h>
#include <string.h>

/* One segment, Voigt. */
typedef struct segment {
    double stiffness[36]; /* C_k, where it begins */
    double gone[36];      /* A_k */
    double along[6];      /* A_k E */
    double size;          /* E : A_k : E */
    double begin, end;    /* loads */
} segment;

struct ph_law_points {
    int n, count;   /* segments; one more without A, the end */
    double *damage; /* [count + 1] */
    segment *segment;
};

void ph_i_law_points_free(ph_law_points **points)
{
    if (!points || !*points) return;
    free((*points)->damage);
    free((*points)->segment);
    free(*points);
    *points = NULL;
}

/* a v, Voigt: a stress of a strain. */
static void times(int n, const double *a, const double *v, double *out)
{
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = 0; j < n; j++)
            sum += a[i * n + j] * v[j];
        out[i] = sum;
    }
}

static double dot(int n, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

ph_status ph_i_law_points_new(const ph_damage_law *law, ph_law_points **out,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_law_points *p = NULL;
    int n = law->n;
    PH_ALLOC(p, 1, "a damage law");
    p->n = n;
    p->count = law->nknots - 1;
    PH_ALLOC(p->damage, law->nknots, "damage");
    PH_ALLOC(p->segment, law->nknots, "segments");
    memcpy(p->damage, law->damage, sizeof *p->damage * (size_t)law->nknots);
    for (int k = 0; k < law->nknots; k++) {
        segment *g = &p->segment[k];
        ph_sym4_to_voigt(&law->stiffness[k], true, g->stiffness);
        if (k == p->count) break;
        ph_sym4 gone =
            ph_sym4_combine(1.0, &law->stiffness[k], -1.0, &law->stiffness[k + 1]);
        ph_sym4_to_voigt(&gone, true, g->gone);
        times(n, g->gone, law->strain, g->along);
        g->size = dot(n, g->along, law->strain);
        g->begin = law->begin[k];
        g->end = law->end[k];
    }
    *out = p;
    p = NULL;
out:
    ph_i_law_points_free(&p);
    return st;
}

/* kappa of a strain in a segment; slope [n] its derivative, NULL: not wanted. */
static double drive(int n, const segment *g, const double *strain, double *slope)
{
    double pull[6]; /* A eps */
    times(n, g->gone, strain, pull);
    double square = dot(n, strain, pull), against = dot(n, g->along, strain);
    if (against >= 0.0) against = 0.0; /* nothing of it is against E */
    square = (square - against * against / g->size) / g->size;
    double kappa = square > 0.0 ? sqrt(square) : 0.0;
    for (int i = 0; slope && kappa > 0.0 && i < n; i++)
        slope[i] = (pull[i] - against * g->along[i] / g->size) / (g->size * kappa);
    return kappa;
}

/* Take damage forward under a strain. @return whether it would go on growing with it: then
 * `slope` is the derivative of the part of the segment that is done. */
static bool grow(const ph_law_points *p, const double *strain, double *damage,
                 double *slope)
{
    int k = ph_i_damage_segment(p->count + 1, p->damage, *damage);
    for (; k < p->count; k++) {
        const segment *g = &p->segment[k];
        double width = p->damage[k + 1] - p->damage[k], range = g->end - g->begin;
        double kappa = drive(p->n, g, strain, slope);
        if (kappa >= g->end) {
            *damage = p->damage[k + 1];
            continue;
        }
        double there = p->damage[k] + width * (kappa - g->begin) / range;
        if (!(there > *damage)) return false;
        *damage = fmin(there, nextafter(p->damage[k + 1], 0.0)); /* still in segment k */
        for (int i = 0; i < p->n; i++)
            slope[i] /= range;
        return true;
    }
    return false;
}

void ph_i_law_points_update(const ph_law_points *p, double *state, const double *dstrain,
                            double *stress, double *tangent)
{
    int n = p->n;
    double *damage = state + n, slope[6], lost[6];
    for (int i = 0; i < n; i++)
        state[i] += dstrain[i];
    bool grows = grow(p, state, damage, slope);
    int k = ph_i_damage_segment(p->count + 1, p->damage, *damage);
    const segment *g = &p->segment[k];
    double s = k == p->count || *damage <= 0.0
                   ? 0.0
                   : (*damage - p->damage[k]) / (p->damage[k + 1] - p->damage[k]);
    times(n, g->stiffness, state, stress);
    times(n, g->gone, state, lost);
    for (int i = 0; i < n; i++)
        stress[i] -= s * lost[i];
    for (int i = 0; tangent && i < n; i++)
        for (int j = 0; j < n; j++)
            tangent[i * n + j] = g->stiffness[i * n + j] - s * g->gone[i * n + j] -
                                 (grows ? lost[i] * slope[j] : 0.0);
}
