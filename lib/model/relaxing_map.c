/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/relaxing_map.h"

#include <math.h>
#include <string.h>

/* Times of two phases closer than this, relative, are one. */
static const double same_time = 1e-9;

static int by_size(const void *a, const void *b)
{
    double s = *(const double *)a, t = *(const double *)b;
    return (s > t) - (s < t);
}

/* The distinct times of all series that are used. */
static ph_status find_times(ph_relaxing_map *r, ph_prony *const *series,
                            const ph_prony *soft, ph_error *err)
{
    ph_status st = PH_OK;
    int all = soft ? soft->nterms : 0, n = 0;
    for (int p = 0; p < r->materials; p++)
        all += series[p] && r->map->used[p] ? series[p]->nterms : 0;
    PH_ALLOC(r->time, all, "relaxation times");
    for (int p = 0; p < r->materials; p++)
        for (int m = 0; series[p] && r->map->used[p] && m < series[p]->nterms; m++)
            r->time[n++] = series[p]->term[m].time;
    for (int m = 0; soft && m < soft->nterms; m++)
        r->time[n++] = soft->term[m].time;
    qsort(r->time, (size_t)n, sizeof *r->time, by_size);
    for (int i = 0; i < n; i++)
        if (r->ntimes == 0 ||
            r->time[i] - r->time[r->ntimes - 1] > same_time * r->time[i])
            r->time[r->ntimes++] = r->time[i];
out:
    return st;
}

static int nearest_time(const ph_relaxing_map *r, double time)
{
    int best = 0;
    for (int i = 1; i < r->ntimes; i++)
        if (fabs(r->time[i] - time) < fabs(r->time[best] - time)) best = i;
    return best;
}

static void sort_terms(ph_relaxing_map *r, int p, const ph_prony *series)
{
    r->infinity[p] = series->equilibrium;
    for (int m = 0; r->map->used[p] && m < series->nterms; m++) {
        ph_sym4 *to =
            &r->branch[nearest_time(r, series->term[m].time) * r->materials + p];
        *to = ph_sym4_combine(1.0, &series->term[m].stiffness, 1.0, to);
        to->n = r->map->ns;
    }
}

static double trace(const ph_sym4 *c)
{
    double sum = 0.0;
    for (int i = 0; i < c->n; i++)
        sum += c->m[i][i];
    return sum;
}

static ph_status sort_stabilisation(ph_relaxing_map *r, const ph_prony *soft,
                                    ph_error *err)
{
    ph_status st = PH_OK;
    r->hold = 1.0;
    PH_ALLOC(r->give, r->ntimes, "the stabilisation");
    if (!soft) return PH_OK;
    ph_sym4 whole = ph_prony_instantaneous(soft);
    r->hold = trace(&soft->equilibrium) / trace(&whole);
    for (int m = 0; m < soft->nterms; m++)
        r->give[nearest_time(r, soft->term[m].time)] +=
            trace(&soft->term[m].stiffness) / trace(&whole);
out:
    return st;
}

static ph_status reduce_phases(ph_relaxing_map *r, const ph_prony *soft, ph_error *err)
{
    ph_status st = PH_OK;
    ph_prony **series = NULL;
    ph_kinematics kin = r->micro->grid.kinematics;
    PH_ALLOC(series, r->materials, "series");
    for (int p = 0; p < r->materials; p++) {
        const ph_material *m = &r->micro->materials[p];
        if (m->relaxation && r->map->used[p])
            PH_TRY(ph_prony_reduce(m->relaxation, kin, &series[p], err));
        else
            PH_TRY(ph_sym4_reduce(&m->stiffness, kin, &r->infinity[p], err));
    }
    PH_TRY(find_times(r, series, soft, err));
    PH_TRY(sort_stabilisation(r, soft, err));
    PH_ALLOC(r->branch, r->ntimes * r->materials, "branches of the phases");
    for (int i = 0; i < r->ntimes * r->materials; i++)
        r->branch[i].n = r->map->ns;
    for (int p = 0; p < r->materials; p++)
        if (series[p]) sort_terms(r, p, series[p]);
out:
    for (int p = 0; series && p < r->materials; p++)
        ph_prony_free(&series[p]);
    free(series);
    return st;
}

/* The table without cut cells: entry materials + 1 is empty, and inside the body. */
static ph_status new_whole(ph_relaxing_map *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_stiffness_map *map = r->map;
    int entries = r->materials + 2;
    ph_sym4 nothing = {.n = map->ns};
    r->mixed = (ph_tensor_table){map->c, map->hooke, map->index};
    r->whole.index = r->mixed.index;
    r->has_cuts = map->count > map->materials + 1;
    PH_ALLOC(r->whole.c, entries * map->ns * map->ns, "tensors of the phases");
    PH_ALLOC(r->whole.hooke, entries, "tensors of the phases");
    if (r->has_cuts) {
        r->whole.index = NULL; /* of its own from here on */
        PH_ALLOC(r->whole.index, map->cells, "the index of whole cells");
        r->meter->bytes += sizeof(int32_t) * (size_t)map->cells;
        if (r->meter->bytes > r->meter->peak) r->meter->peak = r->meter->bytes;
        for (ptrdiff_t x = 0; x < map->cells; x++)
            r->whole.index[x] =
                map->index[x] > r->materials ? r->materials + 1 : map->index[x];
    }
    ph_i_relaxing_map_whole(r, 0.0, NULL);
    ph_i_stiffness_map_store(r->map, r->materials, &nothing);
    ph_i_stiffness_map_store(r->map, r->materials + 1, &nothing);
    ph_i_relaxing_map_again(r);
out:
    return st;
}

ph_status ph_i_relaxing_map_new(ph_stiffness_map *map, const ph_microstructure *micro,
                                int soft, ph_meter *meter, ph_relaxing_map **out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    ph_relaxing_map *r = NULL;
    *out = NULL;
    PH_ALLOC(r, 1, "viscoelastic phases");
    r->map = map;
    r->micro = micro;
    r->meter = meter;
    r->materials = map->materials;
    PH_ALLOC(r->infinity, r->materials, "equilibrium tensors");
    PH_ALLOC(r->phase, r->materials, "tensors of the phases");
    PH_TRY(reduce_phases(r, soft >= 0 ? micro->materials[soft].relaxation : NULL, err));
    PH_TRY(new_whole(r, err));
    *out = r;
    r = NULL;
out:
    ph_i_relaxing_map_free(&r);
    return st;
}

void ph_i_relaxing_map_free(ph_relaxing_map **relaxing)
{
    if (!relaxing || !*relaxing) return;
    ph_relaxing_map *r = *relaxing;
    if (r->mixed.c) ph_i_relaxing_map_again(r);
    if (r->whole.index && r->whole.index != r->mixed.index) {
        r->meter->bytes -= sizeof(int32_t) * (size_t)r->map->cells;
        free(r->whole.index);
    }
    free(r->whole.c);
    free(r->whole.hooke);
    free(r->time);
    free(r->give);
    free(r->infinity);
    free(r->branch);
    free(r->phase);
    free(r);
    *relaxing = NULL;
}

double ph_i_relaxing_stabilisation(const ph_relaxing_map *r, double infinity,
                                   const double *weight)
{
    double sum = infinity * r->hold;
    for (int m = 0; m < r->ntimes; m++)
        sum += weight[m] * r->give[m];
    return sum;
}

ph_sym4 ph_i_relaxing_phase(const ph_relaxing_map *r, int p, double infinity,
                            const double *weight)
{
    ph_sym4 zero = {.n = r->map->ns};
    ph_sym4 c = ph_sym4_combine(infinity, &r->infinity[p], 0.0, &zero);
    for (int m = 0; weight && m < r->ntimes; m++)
        if (weight[m] != 0.0)
            c = ph_sym4_combine(1.0, &c, weight[m], &r->branch[m * r->materials + p]);
    c.n = r->map->ns;
    return c;
}

static void show(ph_relaxing_map *r, const ph_tensor_table *t)
{
    r->map->c = t->c;
    r->map->hooke = t->hooke;
    r->map->index = t->index;
}

void ph_i_relaxing_map_again(ph_relaxing_map *r)
{
    show(r, &r->mixed);
}

ph_status ph_i_relaxing_map_mixed(ph_relaxing_map *r, double infinity,
                                  const double *weight, ph_error *err)
{
    for (int p = 0; p < r->materials; p++)
        r->phase[p] = ph_i_relaxing_phase(r, p, infinity, weight);
    show(r, &r->mixed);
    return ph_i_stiffness_map_set(r->map, r->micro, r->phase, true, err);
}

void ph_i_relaxing_map_whole(ph_relaxing_map *r, double infinity, const double *weight)
{
    show(r, &r->whole);
    for (int p = 0; p < r->materials; p++) {
        ph_sym4 c = ph_i_relaxing_phase(r, p, infinity, weight);
        ph_i_stiffness_map_store(r->map, p, &c);
    }
}

void ph_i_relaxing_map_fill_cuts(ph_relaxing_map *r)
{
    const int n = r->map->ns;
    ph_sym4 mean = {.n = n};
    double used = 0.0;
    for (int p = 0; p < r->materials; p++) {
        if (!r->map->used[p]) continue;
        used += 1.0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                mean.m[i][j] += r->whole.c[(p * n + i) * n + j];
    }
    mean = ph_sym4_combine(1.0 / used, &mean, 0.0, &mean);
    show(r, &r->whole);
    ph_i_stiffness_map_store(r->map, r->materials + 1, &mean);
}

void ph_i_relaxing_map_empty_cuts(ph_relaxing_map *r)
{
    const ph_sym4 nothing = {.n = r->map->ns};
    show(r, &r->whole);
    ph_i_stiffness_map_store(r->map, r->materials + 1, &nothing);
}
