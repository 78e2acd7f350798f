/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models without a grid: one strain for all phases (voigt, or a homogeneous cell), or one
 * stress (reuss: the strains of the phases are free but for their mean). In plane stress a
 * phase of more than one function has its strains out of the plane as well. */
#include "effective/visco.h"

#include <string.h>

typedef struct lumped {
    int ns, n;     /* macro strains; with the free ones */
    int phases;    /* that are there */
    int *material; /* [phases] */
    double *share; /* [phases] */
    double *B;     /* [phases][6][n] strain of a phase, in the plane ns of it */
    bool *six;     /* [phases] */
} lumped;

static const int in_plane[3] = {0, 1, 5}, out_of_plane[3] = {2, 3, 4};

static double *entry(const lumped *l, int phase, int strain, int unknown)
{
    return &l->B[(phase * 6 + strain) * l->n + unknown];
}

/* Which component of B holds strain a of the plane. */
static int place(const lumped *l, int phase, int a)
{
    return l->six[phase] ? in_plane[a] : a;
}

/* Uniform: every phase e. Else phase p > 0 has its own strain, and phase 0 what is left,
 * (e - sum share_p e_p) / share_0. */
static void fill(lumped *l, bool uniform)
{
    int next = l->ns;
    for (int p = 0; p < l->phases; p++) {
        for (int a = 0; a < l->ns; a++) {
            if (uniform || p == 0)
                *entry(l, p, place(l, p, a), a) = uniform ? 1.0 : 1.0 / l->share[0];
            else {
                *entry(l, p, place(l, p, a), next) = 1.0;
                *entry(l, 0, place(l, 0, a), next++) = -l->share[p] / l->share[0];
            }
        }
        for (int a = 0; l->six[p] && a < 3; a++)
            *entry(l, p, out_of_plane[a], next++) = 1.0;
    }
}

static ph_status add_energy(const lumped *l, ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_kinematics kin = v->run.problem->micro->grid.kinematics;
    for (int q = 0; q < v->split.nfunctions; q++)
        for (int p = 0; p < l->phases; p++) {
            ph_sym4 X = *ph_i_split_shape(&v->split, q, l->material[p]);
            if (ph_sym4_norm(&X) == 0.0) continue;
            if (!l->six[p]) PH_TRY(ph_sym4_reduce(&X, kin, &X, err));
            for (int i = 0; i < l->n; i++)
                for (int j = 0; j <= i; j++) {
                    double sum = 0.0;
                    for (int a = 0; a < X.n; a++)
                        for (int b = 0; b < X.n; b++)
                            sum += *entry(l, p, a, i) * X.m[a][b] * *entry(l, p, b, j);
                    ph_i_reduced_add(&v->model, q, i, j, l->share[p] * sum);
                }
        }
out:
    return st;
}

ph_status ph_i_visco_lumped(ph_visco *v, bool uniform, const double *fraction,
                            ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = v->run.problem->micro;
    lumped l = {.ns = ph_strains(micro->grid.kinematics)};
    PH_ALLOC(l.material, micro->nmaterials, "phases");
    PH_ALLOC(l.share, micro->nmaterials, "phases");
    PH_ALLOC(l.six, micro->nmaterials, "phases");
    for (int p = 0; p < micro->nmaterials; p++) {
        if (!(fraction[p] > 0.0)) continue;
        l.material[l.phases] = p;
        l.share[l.phases] = fraction[p];
        l.six[l.phases++] = micro->grid.kinematics == PH_PLANE_STRESS &&
                            ph_i_split_count(&v->split, p) > 1;
    }
    l.n = l.ns * (uniform ? 1 : l.phases);
    for (int p = 0; p < l.phases; p++)
        l.n += l.six[p] ? 3 : 0;
    PH_ALLOC(l.B, (size_t)l.phases * 6 * (size_t)l.n, "phases");
    fill(&l, uniform);
    PH_TRY(
        ph_i_reduced_init(&v->model, l.ns, v->split.nfunctions, v->split.function, err));
    PH_TRY(ph_i_reduced_grow(&v->model, l.n - l.ns, err));
    PH_TRY(add_energy(&l, v, err));
out:
    free(l.material);
    free(l.share);
    free(l.six);
    free(l.B);
    return st;
}
