/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What follows from the stiffnesses of all steps: tangents, and a damage tensor. */
#include "effective/run.h"

#include <math.h>

/* The effect of D [axes] on Mandel vectors: 1 - D_n, shears the geometric mean. */
static void effect(const double *D, int n, double *m)
{
    int axes = n == 6 ? 3 : 2;
    for (int i = 0; i < axes; i++)
        m[i] = 1.0 - D[i];
    if (n == 3) m[2] = sqrt(m[0] * m[1]);
    for (int i = 3; i < n; i++) /* 23 13 12 */
        m[i] = sqrt(m[(i - 2) % 3] * m[(i - 1) % 3]);
}

ph_sym4 ph_damaged_stiffness(const ph_sym4 *pristine, const double *D)
{
    ph_sym4 c = {0};
    double m[6];
    if (!pristine || !D || (pristine->n != 3 && pristine->n != 6)) return c;
    effect(D, c.n = pristine->n, m);
    for (int i = 0; i < c.n; i++)
        for (int j = 0; j < c.n; j++)
            c.m[i][j] = m[i] * pristine->m[i][j] * m[j];
    return c;
}

static void measure_tensor(const ph_damage *d, ph_damage_step *s)
{
    int axes = d->pristine.n == 6 ? 3 : 2;
    for (int n = 0; n < axes; n++)
        s->tensor[n] = 1.0 - sqrt(fmax(s->psi[n], 0.0));
    ph_sym4 c = ph_damaged_stiffness(&d->pristine, s->tensor);
    c = ph_sym4_combine(1.0, &c, -1.0, &s->stiffness);
    s->tensor_error = ph_sym4_norm(&c) / ph_sym4_norm(&d->pristine);
}

/* C - t (A E) (A E) / (E : A : E), A what went on the way, t = from / (to - from): the tensor
 * that takes E to the slope of the stress between the steps. */
static ph_sym4 chord(const ph_sym4 *before, const ph_sym4 *c, const double *strain,
                     double from, double to)
{
    ph_sym4 out = *c;
    double along[6] = {0}, size = 0.0;
    for (int i = 0; i < c->n; i++) {
        for (int j = 0; j < c->n; j++)
            along[i] += (before->m[i][j] - c->m[i][j]) * strain[j];
        size += along[i] * strain[i];
    }
    if (to == from || size == 0.0) return out;
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            out.m[i][j] -= from / (to - from) * along[i] * along[j] / size;
    return out;
}

static ph_sym4 unknown(int n)
{
    ph_sym4 c = {.n = n};
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            c.m[i][j] = (double)NAN;
    return c;
}

void ph_i_damage_measures(ph_result *result)
{
    ph_damage *d = result->damage;
    const ph_failure_path *p = result->failure;
    const int n = d->pristine.n;
    double strain[6] = {0}, from = 0.0;
    ptrdiff_t broken = p ? p->step[0].broken : -1;
    const ph_sym4 *before =
        NULL; /* of load 0: the pristine one, but for initial cracks */
    for (int i = 0; p && i < n; i++)
        strain[i] = p->strain[i] * (i < (n == 3 ? 2 : 3) ? 1.0 : sqrt(0.5));
    if (p && p->step[0].broken == 0) before = &d->pristine;
    for (int i = 0; i < d->nsteps; i++) {
        ph_damage_step *s = &d->step[i];
        bool same = s->broken_bonds == broken;
        s->tangent = p && (p->stress_free || p->in_time) && !same ? unknown(n)
                     : before && !same
                         ? chord(before, &s->stiffness, strain, from, s->value)
                         : s->stiffness;
        measure_tensor(d, s);
        if (!p) continue;
        before = &s->stiffness;
        from = s->value;
        broken = s->broken_bonds;
    }
}
