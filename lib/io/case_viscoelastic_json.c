/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscoelastic materials and their section in the resolved case; case_relaxation.c and
 * case_viscoelastic.c read them back. */
#include "io/case_internal.h"
#include "io/json.h"

#include <math.h>

static json_t *rows(const ph_sym4 *c, bool *good)
{
    json_t *list = json_array();
    double voigt[36];
    ph_sym4_to_voigt(c, true, voigt);
    for (int i = 0; i < 6; i++)
        ph_i_json_append(list, ph_i_json_numbers(&voigt[6 * i], 6, good), good);
    return list;
}

static json_t *term(const char *key, json_t *value, double time, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, key, value, good);
    ph_i_json_set(map, "time", json_real(time), good);
    return map;
}

static json_t *frame(json_t *infinity, json_t *terms, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "infinity", infinity, good);
    ph_i_json_set(map, "terms", terms, good);
    return map;
}

static json_t *modulus(const ph_modulus *M, bool *good)
{
    json_t *terms = json_array();
    if (!M->term) {
        json_decref(terms);
        return json_real(M->infinity);
    }
    for (int m = 0; m < M->nterms; m++)
        ph_i_json_append(
            terms, term("modulus", json_real(M->term[m].modulus), M->term[m].time, good),
            good);
    return frame(json_real(M->infinity), terms, good);
}

static json_t *tensor(const ph_prony *p, bool *good)
{
    json_t *terms = json_array();
    for (int m = 0; m < p->nterms; m++)
        ph_i_json_append(
            terms,
            term("stiffness", rows(&p->term[m].stiffness, good), p->term[m].time, good),
            good);
    return frame(rows(&p->equilibrium, good), terms, good);
}

static json_t *shift(const ph_shift *s, bool *good)
{
    json_t *map = json_object(), *values = json_object();
    if (s->kind == PH_SHIFT_WLF) {
        ph_i_json_set(values, "C1", json_real(s->c1), good);
        ph_i_json_set(values, "C2", json_real(s->c2), good);
    } else {
        ph_i_json_set(values, "activation_energy", json_real(s->activation_energy), good);
    }
    ph_i_json_set(values, "reference", json_real(s->reference), good);
    ph_i_json_set(map, s->kind == PH_SHIFT_WLF ? "wlf" : "arrhenius", values, good);
    return map;
}

json_t *ph_i_relaxation_to_json(const ph_case_relaxation *x, double density, bool *good)
{
    json_t *map = json_object();
    if (x->kind == PH_RELAXATION_E) {
        ph_i_json_set(map, "E", modulus(&x->modulus[0], good), good);
        ph_i_json_set(map, "nu", json_real(x->nu), good);
    } else if (x->kind == PH_RELAXATION_BULK_SHEAR) {
        ph_i_json_set(map, "bulk", modulus(&x->modulus[0], good), good);
        ph_i_json_set(map, "shear", modulus(&x->modulus[1], good), good);
    } else {
        ph_i_json_set(map, "stiffness", tensor(x->tensor, good), good);
    }
    if (x->shift.kind != PH_SHIFT_NONE)
        ph_i_json_set(map, "shift", shift(&x->shift, good), good);
    if (isfinite(density)) ph_i_json_set(map, "density", json_real(density), good);
    return map;
}

/* Ramps and cycles as the points that they are. */
static json_t *history(const ph_history *h, bool *good)
{
    json_t *map = json_object(), *points = json_array();
    for (int p = 0; p < h->npoints; p++) {
        json_t *row = json_array();
        ph_i_json_append(row, json_real(h->time[p]), good);
        for (int i = 0; i < h->n; i++)
            ph_i_json_append(row, json_real(h->value[p][i]), good);
        ph_i_json_append(points, row, good);
    }
    ph_i_json_set(map, "control", json_string(h->stress ? "stress" : "strain"), good);
    ph_i_json_set(map, "points", points, good);
    return map;
}

json_t *ph_i_viscoelastic_to_json(const ph_case_viscoelastic *v, bool *good)
{
    json_t *map = json_object();
    ph_i_json_set(map, "route", json_string(v->route), good);
    ph_i_json_set(map, "tolerance", json_real(v->tolerance), good);
    if (v->terms > 0) ph_i_json_set(map, "terms", json_integer(v->terms), good);
    if (v->compression > 0)
        ph_i_json_set(map, "compression", json_real(v->compression), good);
    if (v->times)
        ph_i_json_set(map, "times", ph_i_json_numbers(v->times, v->ntimes, good), good);
    if (v->frequencies)
        ph_i_json_set(map, "frequencies",
                      ph_i_json_numbers(v->frequencies, v->nfrequencies, good), good);
    if (v->history) ph_i_json_set(map, "history", history(v->history, good), good);
    return map;
}
