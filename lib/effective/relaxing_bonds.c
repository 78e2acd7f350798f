/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/relaxing_bonds.h"

#include <math.h>
#include <string.h>

/* Times of two functions closer than this, relative, are one. */
static const double same_time = 1e-9;

static int by_size(const void *a, const void *b)
{
    double s = *(const double *)a, t = *(const double *)b;
    return (s > t) - (s < t);
}

static ph_status find_times(ph_relaxing_bonds *b, ph_error *err)
{
    ph_status st = PH_OK;
    int all = 0, n = 0;
    for (int q = 0; q < b->functions.count; q++)
        all += b->functions.function[q].nterms;
    PH_ALLOC(b->time, all, "relaxation times");
    for (int q = 0; q < b->functions.count; q++)
        for (int t = 0; t < b->functions.function[q].nterms; t++)
            b->time[n++] = b->functions.function[q].time[t];
    qsort(b->time, (size_t)n, sizeof *b->time, by_size);
    for (int i = 0; i < n; i++)
        if (b->ntimes == 0 ||
            b->time[i] - b->time[b->ntimes - 1] > same_time * b->time[i])
            b->time[b->ntimes++] = b->time[i];
out:
    return st;
}

static int nearest_time(const ph_relaxing_bonds *b, double time)
{
    int best = 0;
    for (int i = 1; i < b->ntimes; i++)
        if (fabs(b->time[i] - time) < fabs(b->time[best] - time)) best = i;
    return best;
}

ph_status ph_i_relaxing_bonds_new(ph_operator *op, ph_bond_classes *classes,
                                  const ph_microstructure *micro, int slots,
                                  ph_relaxing_bonds **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_relaxing_bonds *b = NULL;
    *out = NULL;
    PH_ALLOC(b, 1, "bonds that relax");
    b->op = op;
    b->classes = classes;
    b->own = op->springs;
    PH_TRY(ph_i_bond_functions_new(classes, micro, &b->functions, err));
    PH_TRY(find_times(b, err));
    PH_ALLOC(b->factor, b->functions.count, "factors of functions");
    b->slots = slots >= 0 ? slots : b->ntimes + 1;
    PH_ALLOC(b->tables, b->slots, "tables of bonds");
    PH_ALLOC(b->springs, b->slots, "sets of springs");
    for (int k = 0; k < b->slots; k++) {
        b->tables[k] = *classes;
        b->tables[k].pair = b->tables[k].apart = NULL;
    }
    for (int k = 0; k < b->slots; k++) {
        PH_ALLOC(b->tables[k].pair, classes->count * classes->count, "moduli of bonds");
        PH_ALLOC(b->tables[k].apart, classes->count * classes->count, "moduli of bonds");
    }
    *out = b;
    b = NULL;
out:
    ph_i_relaxing_bonds_free(&b);
    return st;
}

void ph_i_relaxing_bonds_free(ph_relaxing_bonds **bonds)
{
    if (!bonds || !*bonds) return;
    ph_relaxing_bonds *b = *bonds;
    ph_i_relaxing_bonds_show(b, -1);
    for (int k = 0; k < b->slots && b->tables; k++) {
        if (b->springs) ph_i_springs_free(&b->springs[k]);
        free(b->tables[k].pair);
        free(b->tables[k].apart);
    }
    ph_i_bond_functions_clear(&b->functions);
    free(b->time);
    free(b->factor);
    free(b->tables);
    free(b->springs);
    free(b);
    *bonds = NULL;
}

void ph_i_relaxing_bonds_show(ph_relaxing_bonds *b, int slot)
{
    b->op->springs = slot < 0 ? b->own : b->springs[slot];
}

/* first times factor, entry by entry; entries that are nothing stay so. */
static void fill(const ph_relaxing_bonds *b, const int *of, const double *first,
                 double *table)
{
    for (int i = 0; i < b->classes->count * b->classes->count; i++)
        table[i] = of[i] < 0 ? 0.0 : first[i] * b->factor[of[i]];
}

ph_status ph_i_relaxing_bonds_make(ph_relaxing_bonds *b, int slot, double infinity,
                                   const double *weight, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bond_functions *f = &b->functions;
    ph_bond_classes *table = slot < 0 ? b->classes : &b->tables[slot];
    for (int q = 0; q < f->count; q++) {
        b->factor[q] = infinity * f->function[q].rest;
        for (int t = 0; t < f->function[q].nterms; t++)
            b->factor[q] += weight[nearest_time(b, f->function[q].time[t])] *
                            f->function[q].weight[t];
    }
    fill(b, f->of, f->first, table->pair);
    fill(b, f->of_apart, f->first_apart, table->apart);
    ph_i_relaxing_bonds_show(b, -1);
    if (slot < 0) {
        st = ph_i_operator_renew_springs(b->op, err);
        b->own = b->op->springs;
        return st;
    }
    ph_route route = ph_i_springs_route(b->own);
    ph_i_springs_free(&b->springs[slot]);
    st = ph_i_springs_new(&b->op->layout, b->op->fft, b->own->family, table, route,
                          b->op->threads, b->op->meter, &b->springs[slot], err);
    if (st == PH_OK) b->springs[slot]->broken = b->own->broken;
    return st;
}
