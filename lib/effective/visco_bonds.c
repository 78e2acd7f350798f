/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/visco_bonds.h"

#include "effective/visco_model.h"

#include <math.h>
#include <string.h>

/* E(s) / E(0) of a material whose tensor keeps its shape. */
static ph_status decay_of_phase(const ph_material *m, ph_decay *out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_prony still = {.equilibrium = m->stiffness}, *p = m->relaxation;
    double *modulus = NULL, total;
    ph_split split = {0};
    if (!p) p = &still;
    PH_TRY(ph_i_split_new(1, m, &split, err));
    PH_CHECK(ph_i_split_count(&split, 0) <= 1, PH_EUNPHYSICAL,
             "material '%s': its Poisson's ratio moves as it relaxes, and that of bonds "
             "does not: give E(t) and nu, or take model nosb or local",
             m->name);
    PH_ALLOC(modulus, p->nterms + 1, "moduli");
    for (int t = 0; t <= p->nterms; t++)
        modulus[t] = (t < p->nterms ? p->term[t].stiffness : p->equilibrium).m[0][0];
    PH_TRY(ph_i_decay_of(p, modulus, out, &total, err));
out:
    free(modulus);
    ph_i_split_clear(&split);
    return st;
}

/* 2 E_a E_b / (E_a + E_b): springs 2 E_a and 2 E_b one behind the other, x the strain of the
 * first and e - x that of the second. */
static ph_status decay_of_mean(const ph_decay *a, double Ea, const ph_decay *b, double Eb,
                               ph_decay *out, ph_error *err)
{
    ph_status st = PH_OK;
    enum { NS = 3 };
    const ph_decay function[2] = {*a, *b};
    ph_reduced m = {0};
    ph_prony *series = NULL;
    double *modulus = NULL, total;
    PH_TRY(ph_i_reduced_init(&m, NS, 2, function, err));
    PH_TRY(ph_i_reduced_grow(&m, 1, err));
    ph_i_reduced_add(&m, 0, NS, NS, 2.0 * Ea);
    ph_i_reduced_add(&m, 1, NS, NS, 2.0 * Eb);
    ph_i_reduced_add(&m, 1, 0, 0, 2.0 * Eb);
    ph_i_reduced_add(&m, 1, NS, 0, -2.0 * Eb);
    PH_TRY(ph_i_reduced_series(&m, &series, err));
    PH_ALLOC(modulus, series->nterms + 1, "moduli");
    for (int t = 0; t <= series->nterms; t++)
        modulus[t] =
            (t < series->nterms ? series->term[t].stiffness : series->equilibrium)
                .m[0][0];
    PH_TRY(ph_i_decay_of(series, modulus, out, &total, err));
out:
    free(modulus);
    ph_prony_free(&series);
    ph_i_reduced_clear(&m);
    return st;
}

/* Number of the function equal to *d, which is taken or released. */
static ph_status number_of(ph_bond_functions *f, ph_decay *d, int *number, ph_error *err)
{
    ph_status st = PH_OK;
    int q = 0;
    while (q < f->count && !ph_i_decay_same(d, &f->function[q]))
        q++;
    *number = q;
    if (q == f->count) {
        void *p = realloc(f->function, sizeof *f->function * (size_t)(q + 1));
        PH_CHECK(p, PH_ENOMEM, "no memory for %d functions", q + 1);
        f->function = p;
        f->function[f->count++] = *d;
        *d = (ph_decay){0};
    }
out:
    ph_i_decay_clear(d);
    return st;
}

static ph_status copy_decay(const ph_decay *d, ph_decay *out, ph_error *err)
{
    ph_status st = PH_OK;
    *out = (ph_decay){.rest = d->rest, .nterms = d->nterms};
    PH_ALLOC(out->time, d->nterms, "relaxation times");
    PH_ALLOC(out->weight, d->nterms, "relaxation weights");
    for (int t = 0; t < d->nterms; t++)
        out->time[t] = d->time[t], out->weight[t] = d->weight[t];
out:
    if (st != PH_OK) ph_i_decay_clear(out);
    return st;
}

static ph_status fill(ph_bond_functions *f, const ph_bond_classes *c,
                      const ph_decay *phase, const ph_bond_recipe *how,
                      const double *modulus, int *of, double *first, ph_error *err)
{
    ph_status st = PH_OK;
    for (int i = 0; i < c->count * c->count; i++) {
        int a = how[i].first, b = how[i].second;
        ph_decay d = {0};
        of[i] = -1;
        first[i] = modulus[i];
        if (a < 0 || !phase[a].time || (b >= 0 && !phase[b].time)) continue;
        if (b < 0)
            PH_TRY(copy_decay(&phase[a], &d, err));
        else
            PH_TRY(decay_of_mean(&phase[a], c->E[a], &phase[b], c->E[b], &d, err));
        PH_TRY(number_of(f, &d, &of[i], err));
    }
out:
    return st;
}

ph_status ph_i_bond_functions_new(const ph_bond_classes *c,
                                  const ph_microstructure *micro, ph_bond_functions *out,
                                  ph_error *err)
{
    ph_status st = PH_OK;
    ph_decay *phase = NULL;
    size_t n = (size_t)c->count * (size_t)c->count;
    *out = (ph_bond_functions){0};
    PH_ALLOC(out->there, c->count, "bond classes");
    for (ptrdiff_t x = 0; x < c->cells; x++)
        out->there[c->class[x]] = true;
    PH_ALLOC(phase, micro->nmaterials, "functions of the phases");
    PH_ALLOC(out->of, n, "functions of bonds");
    PH_ALLOC(out->of_apart, n, "functions of bonds");
    PH_ALLOC(out->first, n, "moduli of bonds");
    PH_ALLOC(out->first_apart, n, "moduli of bonds");
    for (int p = 0; p < micro->nmaterials; p++)
        if ((out->there[2 * p] || out->there[2 * p + 1]) && !micro->materials[p].is_void)
            PH_TRY(decay_of_phase(&micro->materials[p], &phase[p], err));
    PH_TRY(fill(out, c, phase, c->how, c->pair, out->of, out->first, err));
    PH_TRY(fill(out, c, phase, c->how_apart, c->apart, out->of_apart, out->first_apart,
                err));
out:
    for (int p = 0; phase && p < micro->nmaterials; p++)
        ph_i_decay_clear(&phase[p]);
    free(phase);
    if (st != PH_OK) ph_i_bond_functions_clear(out);
    return st;
}

void ph_i_bond_functions_clear(ph_bond_functions *f)
{
    for (int q = 0; q < f->count; q++)
        ph_i_decay_clear(&f->function[q]);
    free(f->function);
    free(f->there);
    free(f->of);
    free(f->of_apart);
    free(f->first);
    free(f->first_apart);
    *f = (ph_bond_functions){0};
}

static double modulus_at(const ph_bond_functions *f, int of, double first, double s,
                         int function)
{
    if (of < 0) return 0.0;
    if (function >= 0) return of == function ? first : 0.0;
    return first * ph_i_decay_at(&f->function[of], s);
}

void ph_i_bond_functions_set(const ph_bond_functions *f, double s, int function,
                             ph_bond_classes *c)
{
    for (int i = 0; i < c->count * c->count; i++) {
        c->pair[i] = modulus_at(f, f->of[i], f->first[i], s, function);
        c->apart[i] = modulus_at(f, f->of_apart[i], f->first_apart[i], s, function);
    }
}

double ph_i_bond_functions_least(const ph_bond_functions *f, const ph_bond_classes *c)
{
    double least = INFINITY;
    for (int a = 0; a < c->count; a++)
        for (int b = 0; f->there[a] && b < c->count; b++) {
            int at = a * c->count + b;
            if (!f->there[b]) continue;
            least = fmin(least, c->pair[at]);
            if (a % 2 && b % 2) least = fmin(least, c->apart[at]);
        }
    return isfinite(least) ? least : 0.0;
}
