/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where to look next. The fields depend on s through the ratios of the moduli of the phases
 * only, so that a line of values of s is measured by how far these ratios move,
 *
 *   dt = max over two moduli of |d log(M_a / M_b)|,
 *
 * bulk- and shear-like moduli of every phase. An elastic field in a medium of contrast
 * exp(t) is a Stieltjes function of the contrast, and the error of a projection on the fields
 * at t_1 .. t_n falls like the product of tanh^2((t - t_k)/2), the rule of best rational
 * points. */
#include "effective/visco.h"

#include <math.h>
#include <string.h>

enum { PER_DECADE = 8, BEYOND = 2, MOST = 100000 };

static void moduli(const ph_sym4 *c, double *K, double *G)
{
    double trace = 0.0;
    *K = 0.0;
    for (int i = 0; i < 6; i++)
        trace += c->m[i][i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            *K += c->m[i][j] / 9.0;
    *G = (trace - 3.0 * *K) / 10.0;
}

/* Logarithms of the moduli of the phases that are there; returns their number. */
static int log_moduli(const ph_visco *v, double s, double *out)
{
    const ph_microstructure *micro = v->run.problem->micro;
    int n = 0;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_material *m = &micro->materials[p];
        if (!v->run.map->used[p] || m->is_void) continue;
        ph_sym4 c = m->relaxation ? ph_prony_carson(m->relaxation, s) : m->stiffness;
        double K, G;
        moduli(&c, &K, &G);
        out[n++] = log(K);
        out[n++] = log(G);
    }
    return n;
}

static double move(int n, const double *a, const double *b)
{
    double low = INFINITY, high = -(double)INFINITY;
    for (int i = 0; i < n; i++) {
        low = fmin(low, b[i] - a[i]);
        high = fmax(high, b[i] - a[i]);
    }
    return n > 0 ? high - low : 0.0;
}

/* Shortest and longest time, and by how much a phase falls: with C_inf = 1e-6 C_0 it goes on
 * falling until s is a millionth of 1 / time. */
static void times(const ph_visco *v, double *shortest, double *longest, double *fall)
{
    const ph_microstructure *micro = v->run.problem->micro;
    *shortest = INFINITY;
    *longest = 0.0;
    *fall = 1.0;
    for (int p = 0; p < micro->nmaterials; p++) {
        const ph_prony *series = micro->materials[p].relaxation;
        for (int t = 0; v->run.map->used[p] && series && t < series->nterms; t++) {
            *shortest = fmin(*shortest, series->term[t].time);
            *longest = fmax(*longest, series->term[t].time);
        }
        double low, high;
        if (!v->run.map->used[p] || !series || v->fluid) continue;
        ph_sym4 begin = ph_prony_instantaneous(series);
        ph_i_visco_relative(&series->equilibrium, &begin, &low, &high);
        *fall = fmax(*fall, 1.0 / low);
    }
}

ph_status ph_i_path_new(const ph_visco *v, double tolerance, ph_path *out, ph_error *err)
{
    ph_status st = PH_OK;
    double shortest, longest, fall, *before = NULL, *after = NULL;
    *out = (ph_path){0};
    times(v, &shortest, &longest, &fall);
    bool elastic = !(longest > 0.0);
    /* A fluid moves on; its field is settled where the contrast is past the tolerance. */
    double late = v->fluid ? 2.0 - log10(tolerance) : BEYOND + log10(fall);
    double high = elastic ? 0.0 : BEYOND - log10(shortest);
    double low = elastic ? 0.0 : -late - log10(longest);
    int steps = elastic ? 0 : (int)ceil((high - low) * PER_DECADE);
    PH_CHECK(steps < MOST, PH_EINVAL, "relaxation times from %g to %g are too far apart",
             shortest, longest);
    PH_ALLOC(out->s, steps + 3, "values of s");
    PH_ALLOC(out->t, steps + 3, "values of s");
    PH_ALLOC(before, 2 * v->run.problem->micro->nmaterials, "moduli");
    PH_ALLOC(after, 2 * v->run.problem->micro->nmaterials, "moduli");
    out->s[out->n++] = INFINITY;
    for (int i = 0; i <= steps && !elastic; i++)
        out->s[out->n++] = pow(10.0, high - (high - low) * i / steps);
    if (!v->fluid && !elastic) out->s[out->n++] = 0.0;
    for (int i = 1; i < out->n; i++) {
        int n = log_moduli(v, out->s[i - 1], before);
        log_moduli(v, out->s[i], after);
        out->t[i] = out->t[i - 1] + move(n, before, after);
    }
out:
    free(before);
    free(after);
    if (st != PH_OK) ph_i_path_clear(out);
    return st;
}

void ph_i_path_clear(ph_path *p)
{
    free(p->s);
    free(p->t);
    *p = (ph_path){0};
}
