/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscoelastic materials of a case file: series of moduli, shift with temperature. */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_TERMS = 1000 };

static const char *const modulus_keys[] = {"infinity", "terms"};
static const char *const term_keys[] = {"modulus", "time"};
static const char *const tensor_term_keys[] = {"stiffness", "time"};
static const char *const shift_keys[] = {"wlf", "arrhenius"};
static const char *const wlf_keys[] = {"C1", "C2", "reference"};
static const char *const arrhenius_keys[] = {"activation_energy", "reference"};

static const char modulus_rule[] =
    "must be a number > 0 or a series {infinity: 3, terms: [{modulus: 17, time: 1}]}";
static const char time_rule[] = "a relaxation time must be a number > 0";

bool ph_case_relaxes(const ph_case *c)
{
    if (!c) return false;
    for (int i = 0; i < c->nmaterials; i++)
        if (c->materials[i].relaxation) return true;
    return false;
}

bool ph_i_is_relaxing(const ph_i_node *map)
{
    const ph_i_node *E = ph_i_get(map, "E"), *C = ph_i_get(map, "stiffness"),
                    *hole = ph_i_get(map, "void");
    if (hole && !ph_i_is_word(hole, "false")) return false;
    return ph_i_get(map, "bulk") || ph_i_get(map, "shear") ||
           (E && E->kind == PH_I_MAP) || (C && C->kind == PH_I_MAP);
}

void ph_i_relaxation_clear(ph_case_relaxation *x)
{
    for (int k = 0; k < 2; k++)
        free((ph_modulus_term *)(uintptr_t)x->modulus[k].term);
    ph_prony_free(&x->tensor);
    *x = (ph_case_relaxation){0};
}

/* ---- temperature ---- */

static bool read_temperature(ph_i_reader *r, const ph_i_node *node, double *out)
{
    const char *unit = r->c->unit_temperature;
    bool celsius = unit[0] == 'C';
    if (unit[0] == 0) {
        ph_i_complain(r, node, PH_EINVAL,
                      "units.temperature must say whether it is K or C");
        return false;
    }
    if (!ph_i_read_number(r, node, celsius ? -273.15 : 0, 1e6,
                          celsius ? "must be a temperature > -273.15 degrees Celsius"
                                  : "must be a temperature > 0 K",
                          out))
        return false;
    if (!celsius && *out < 100)
        ph_i_complain(r, node, PH_OK, "%g K: are degrees Celsius meant?", *out);
    return true;
}

void ph_i_read_temperature(ph_i_reader *r, const ph_i_node *root)
{
    ph_case *c = r->c;
    const ph_i_node *units = ph_i_get(root, "units"),
                    *unit = units && units->kind == PH_I_MAP
                                ? ph_i_get(units, "temperature")
                                : NULL,
                    *node = ph_i_get(root, "temperature");
    c->temperature = NAN;
    if (unit && (ph_i_is_word(unit, "K") || ph_i_is_word(unit, "C")))
        snprintf(c->unit_temperature, sizeof c->unit_temperature, "%s", unit->text);
    else if (unit)
        ph_i_reject(r, unit, PH_EINVAL, "must be K or C (degrees Celsius)");
    if (node) read_temperature(r, node, &c->temperature);
}

static bool need_number(ph_i_reader *r, const ph_i_node *map, const char *key,
                        const char *rule, double *out)
{
    const ph_i_node *node = ph_i_need(r, map, key, rule);
    return node && ph_i_read_positive(r, node, rule, out);
}

static bool read_shift_values(ph_i_reader *r, const ph_i_node *map, ph_shift *out)
{
    static const char C1[] = "C1 must be a number > 0 (17.44 where nothing is known)";
    static const char C2[] = "C2 must be degrees > 0 (51.6 where nothing is known)";
    static const char energy[] = "the activation energy must be a number > 0 in J/mol";
    static const char where[] = "must be the temperature at which the series holds";
    bool wlf = strcmp(map->key, "wlf") == 0, good;
    if (!ph_i_read_map(r, map,
                       wlf ? "must be {C1: 17.44, C2: 51.6, reference: T}"
                           : "must be {activation_energy: J/mol, reference: T}"))
        return false;
    if (wlf)
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(wlf_keys), "wlf");
    else
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(arrhenius_keys), "arrhenius");
    if (wlf) {
        good = need_number(r, map, "C1", C1, &out->c1);
        good &= need_number(r, map, "C2", C2, &out->c2);
    } else {
        good = need_number(r, map, "activation_energy", energy, &out->activation_energy);
    }
    const ph_i_node *reference = ph_i_need(r, map, "reference", where);
    return reference && read_temperature(r, reference, &out->reference) && good;
}

/* false after a complaint */
static bool read_shift(ph_i_reader *r, const ph_i_node *map, ph_case_relaxation *out)
{
    static const char rule[] = "must be {wlf: {C1, C2, reference}} or {arrhenius: "
                               "{activation_energy, reference}}";
    const ph_i_node *node = ph_i_get(map, "shift");
    ph_error why = PH_ERROR_INIT;
    out->factor = 1;
    if (!node) return true;
    if (!ph_i_read_map(r, node, rule)) return false;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(shift_keys), "shift");
    const ph_i_node *wlf = ph_i_get(node, "wlf"), *other = ph_i_get(node, "arrhenius");
    if (!wlf == !other) {
        ph_i_complain(r, node, PH_EINVAL, "%s", rule);
        return false;
    }
    out->shift.kind = wlf ? PH_SHIFT_WLF : PH_SHIFT_ARRHENIUS;
    if (!read_shift_values(r, wlf ? wlf : other, &out->shift)) return false;
    if (isnan(r->c->temperature)) return true; /* stays at the reference */
    if (ph_shift_factor(&out->shift, r->c->temperature,
                        r->c->unit_temperature[0] == 'C' ? 273.15 : 0, &out->factor,
                        &why) == PH_OK)
        return true;
    ph_i_complain(r, node, PH_EUNPHYSICAL, "%s", why.msg);
    return false;
}

/* ---- series ---- */

/* A modulus >= 0, of a magnitude that can be squared. */
static bool read_modulus(ph_i_reader *r, const ph_i_node *node, double *out)
{
    static const char rule[] = "a modulus must be a number >= 0 and at most 1e60";
    if (!ph_i_read_number(r, node, -1e60, 1e60, rule, out)) return false;
    if (*out == 0) return true;
    return ph_i_read_positive(r, node, rule, out);
}

static bool read_term(ph_i_reader *r, const ph_i_node *node, ph_modulus_term *out)
{
    static const char rule[] = "must be {modulus: 17, time: 1}";
    static const char modulus[] = "a modulus must be a number >= 0 and at most 1e60";
    if (!ph_i_read_map(r, node, rule)) return false;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(term_keys), "a term");
    const ph_i_node *M = ph_i_need(r, node, "modulus", modulus);
    bool good = M && read_modulus(r, M, &out->modulus);
    return need_number(r, node, "time", time_rule, &out->time) && good;
}

/* infinity and terms; NULL where they are wrong */
static const ph_i_node *read_frame(ph_i_reader *r, const ph_i_node *node,
                                   const char *rule, const ph_i_node **infinity)
{
    static const char list[] = "must be a list of terms";
    if (!ph_i_read_map(r, node, rule)) return NULL;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(modulus_keys), "a series");
    *infinity = ph_i_need(r, node, "infinity",
                          "what is left at infinite time (0: nothing, a fluid)");
    const ph_i_node *terms = ph_i_need(r, node, "terms", list);
    if (!*infinity || !terms || !ph_i_read_list(r, terms, 0, list)) return NULL;
    if (terms->count <= MAX_TERMS) return terms;
    ph_i_complain(r, terms, PH_EINVAL, "%zu terms: at most %d are admissible",
                  terms->count, MAX_TERMS);
    return NULL;
}

static bool distinct(ph_i_reader *r, const ph_i_node *term, size_t k, double time,
                     double earlier)
{
    if (time != earlier) return true;
    ph_i_complain(r, ph_i_get(term->child[k], "time"), PH_EUNPHYSICAL,
                  "%g stands twice: relaxation times must be distinct", time);
    return false;
}

static ph_status read_series(ph_i_reader *r, const ph_i_node *node, ph_modulus *out,
                             bool *good, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *infinity = NULL, *terms;
    ph_modulus_term *term = NULL;
    *good = false;
    if (node->kind != PH_I_MAP) {
        *good = ph_i_read_positive(r, node, modulus_rule, &out->infinity);
        goto out;
    }
    terms = read_frame(r, node, modulus_rule, &infinity);
    if (!terms) goto out;
    PH_ALLOC(term, terms->count, "the terms of a series");
    out->term = term;
    out->nterms = (int)terms->count;
    *good = read_modulus(r, infinity, &out->infinity);
    for (size_t k = 0; k < terms->count; k++) {
        bool read = read_term(r, terms->child[k], &term[k]);
        for (size_t j = 0; read && j < k; j++)
            read = distinct(r, terms, k, term[k].time, term[j].time);
        *good &= read;
    }
out:
    return st;
}

/* Checked here, so that the line is that of the tensor. */
static bool read_tensor(ph_i_reader *r, const ph_i_node *node, ph_sym4 *out)
{
    double voigt[36];
    ph_error why = PH_ERROR_INIT;
    if (!ph_i_read_matrix(r, node, voigt)) return false;
    *out = ph_sym4_from_voigt(6, voigt, true);
    const ph_prony alone = {*out, 0, NULL};
    if (ph_prony_validate(&alone, &why) == PH_OK) return true;
    const char *text =
        strncmp(why.msg, "the equilibrium tensor", 22) == 0 ? why.msg + 22 : why.msg;
    ph_i_complain(r, node, PH_EUNPHYSICAL, "%s", text + strspn(text, ": "));
    return false;
}

static bool read_tensor_term(ph_i_reader *r, const ph_i_node *node, ph_prony_term *out)
{
    static const char rule[] = "must be {stiffness: [6 rows], time: 1}";
    if (!ph_i_read_map(r, node, rule)) return false;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(tensor_term_keys), "a term");
    const ph_i_node *C = ph_i_need(r, node, "stiffness", "must be 6 rows of 6 numbers");
    bool good = C && read_tensor(r, C, &out->stiffness);
    return need_number(r, node, "time", time_rule, &out->time) && good;
}

static ph_status read_tensor_series(ph_i_reader *r, const ph_i_node *node, ph_prony **out,
                                    ph_error *err)
{
    ph_status st = PH_OK;
    const ph_i_node *infinity = NULL;
    ph_prony_term *term = NULL;
    ph_sym4 equilibrium;
    const ph_i_node *terms = read_frame(
        r, node, "must be {infinity: [6 rows], terms: [{stiffness: [6 rows], time: 1}]}",
        &infinity);
    if (!terms) goto out;
    PH_ALLOC(term, terms->count, "the terms of a series");
    bool good = read_tensor(r, infinity, &equilibrium);
    for (size_t k = 0; k < terms->count; k++) {
        bool read = read_tensor_term(r, terms->child[k], &term[k]);
        for (size_t j = 0; read && j < k; j++)
            read = distinct(r, terms, k, term[k].time, term[j].time);
        good &= read;
    }
    if (good) PH_TRY(ph_prony_new(&equilibrium, (int)terms->count, term, out, err));
out:
    free(term);
    return st;
}

/* ---- the material ---- */

/* The phase from what was read, its times shifted. What is wrong with it is a complaint. */
static ph_status make(ph_i_reader *r, const ph_i_node *map, const ph_case_relaxation *x,
                      ph_material *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_error why = PH_ERROR_INIT;
    if (x->kind == PH_RELAXATION_E)
        st = ph_material_viscoelastic_young(out->name, &x->modulus[0], x->nu, out, &why);
    else if (x->kind == PH_RELAXATION_BULK_SHEAR)
        st = ph_material_viscoelastic_bulk_shear(out->name, &x->modulus[0],
                                                 &x->modulus[1], out, &why);
    else
        st = ph_material_viscoelastic_tensor(out->name, x->tensor, NULL, out, &why);
    if (st == PH_OK && out->relaxation)
        st = ph_prony_scale_times(out->relaxation, x->factor, &why);
    if (st == PH_ENOMEM) {
        PH_FAIL(err, st, "%s", why.msg);
    } else if (st != PH_OK) {
        ph_i_complain(r, map, st, "%s", ph_i_without_name(&why, out->name));
        st = PH_OK;
    }
    return st;
}

static ph_status read_young(ph_i_reader *r, const ph_i_node *map, ph_case_relaxation *x,
                            bool *good, ph_error *err)
{
    static const char *const others[] = {"nu", "density", "shift"};
    static const char rule[] = "Poisson's ratio must be > -1 and < 0.5";
    const ph_i_node *nu = ph_i_need(r, map, "nu", rule);
    x->kind = PH_RELAXATION_E;
    ph_i_refuse_others(r, map, "E", (ph_i_names)PH_I_NAMES(others));
    ph_status st = read_series(r, ph_i_get(map, "E"), &x->modulus[0], good, err);
    *good &= nu && ph_i_read_number(r, nu, -1, 0.5, rule, &x->nu);
    return st;
}

static ph_status read_bulk_shear(ph_i_reader *r, const ph_i_node *map,
                                 ph_case_relaxation *x, bool *good, ph_error *err)
{
    static const char *const others[] = {"shear", "density", "shift"};
    ph_status st = PH_OK;
    const ph_i_node *bulk = ph_i_need(r, map, "bulk", modulus_rule),
                    *shear = ph_i_need(r, map, "shear", modulus_rule);
    bool good_shear = false;
    x->kind = PH_RELAXATION_BULK_SHEAR;
    ph_i_refuse_others(r, map, "bulk", (ph_i_names)PH_I_NAMES(others));
    *good = false;
    if (bulk) PH_TRY(read_series(r, bulk, &x->modulus[0], good, err));
    if (shear) PH_TRY(read_series(r, shear, &x->modulus[1], &good_shear, err));
    *good &= good_shear;
out:
    return st;
}

static ph_status read_full(ph_i_reader *r, const ph_i_node *map, ph_case_relaxation *x,
                           bool *good, ph_error *err)
{
    static const char *const others[] = {"rotation", "euler", "density", "shift"};
    ph_status st = PH_OK;
    double R[9];
    bool good_rotation;
    x->kind = PH_RELAXATION_TENSOR;
    ph_i_refuse_others(r, map, "stiffness", (ph_i_names)PH_I_NAMES(others));
    bool rotated = ph_i_read_rotation(r, map, R, &good_rotation);
    PH_TRY(read_tensor_series(r, ph_i_get(map, "stiffness"), &x->tensor, err));
    *good = x->tensor && good_rotation;
    if (*good && rotated) ph_prony_rotate(x->tensor, R);
out:
    return st;
}

ph_status ph_i_read_relaxation(ph_i_reader *r, const ph_i_node *map, ph_material *out,
                               ph_case_relaxation *x, ph_error *err)
{
    ph_status st = PH_OK;
    bool good = false;
    const ph_i_node *matrix = ph_i_get(map, "stiffness");
    if (matrix && matrix->kind == PH_I_MAP)
        PH_TRY(read_full(r, map, x, &good, err));
    else if (ph_i_get(map, "bulk") || ph_i_get(map, "shear"))
        PH_TRY(read_bulk_shear(r, map, x, &good, err));
    else
        PH_TRY(read_young(r, map, x, &good, err));
    good &= read_shift(r, map, x);
    if (good) PH_TRY(make(r, map, x, out, err));
out:
    return st;
}
