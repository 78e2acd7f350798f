/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which class of symmetry a card gets, and whether its format can hold it. */
#include "io/card.h"

#include "core/check.h"

#include <math.h>
#include <string.h>

static const double default_tolerance = 1e-5;
/* Entries below this share of the norm are zeros that were computed. */
static const double round_off = 1e-13;

static const char *const class_name[] = {"", "isotropic", "orthotropic", "anisotropic"};

/* Nearest isotropic tensor: alpha on the part of hydrostatic strain, beta on the rest. */
static ph_sym4 isotropic_part(const ph_sym4 *c)
{
    int n = c->n, d = n == 6 ? 3 : 2;
    double sum = 0.0, trace = 0.0;
    for (int i = 0; i < n; i++) {
        trace += c->m[i][i];
        for (int j = 0; i < d && j < d; j++)
            sum += c->m[i][j];
    }
    double alpha = sum / d, beta = (trace - alpha) / (n - 1);
    ph_sym4 p = {.n = n};
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            p.m[i][j] =
                (i == j ? beta : 0.0) + (i < d && j < d ? (alpha - beta) / d : 0.0);
    return p;
}

static ph_sym4 orthotropic_part(const ph_sym4 *c)
{
    ph_sym4 p = *c;
    int d = c->n == 6 ? 3 : 2;
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            if (i != j && (i >= d || j >= d)) p.m[i][j] = 0.0;
    return p;
}

double ph_symmetry_project(const ph_sym4 *c, ph_symmetry symmetry, ph_sym4 *out)
{
    if (!c) return NAN;
    ph_sym4 p = symmetry == PH_SYMMETRY_ISOTROPIC     ? isotropic_part(c)
                : symmetry == PH_SYMMETRY_ORTHOTROPIC ? orthotropic_part(c)
                                                      : *c;
    ph_sym4 rest = ph_sym4_combine(1.0, c, -1.0, &p);
    double distance = ph_sym4_norm(&rest) / ph_sym4_norm(c);
    if (out) *out = p;
    return distance;
}

static const ph_card_format *find_format(const char *name)
{
    for (size_t i = 0; name && i < ph_i_ncard_formats; i++)
        if (strcmp(name, ph_i_card_formats[i].info.name) == 0)
            return &ph_i_card_formats[i];
    return NULL;
}

const char *ph_card_ending(const char *format)
{
    const ph_card_format *f = find_format(format);
    return f ? f->ending : NULL;
}

/* |C - C_class| / |C|; of a series the worst of its tensors over |C(0+)|. */
static double distance_of(const ph_sym4 *c, const ph_prony *series, ph_symmetry symmetry)
{
    double worst = ph_symmetry_project(c, symmetry, NULL);
    for (int k = -1; series && k < series->nterms; k++) {
        const ph_sym4 *t = k < 0 ? &series->equilibrium : &series->term[k].stiffness;
        double norm = ph_sym4_norm(t);
        if (norm > 0.0)
            worst = fmax(worst,
                         ph_symmetry_project(t, symmetry, NULL) * norm / ph_sym4_norm(c));
    }
    return worst;
}

/* The simplest class that the format has and that holds the material. */
static ph_status choose_class(const ph_card_format *f, const ph_sym4 *c,
                              const ph_prony *series, const ph_card_params *params,
                              ph_symmetry *out, ph_error *err)
{
    unsigned classes = series ? f->relaxes : f->classes;
    ph_status st = PH_OK;
    double tolerance = params->tolerance > 0.0 ? params->tolerance : default_tolerance;
    double distance = INFINITY;
    ph_symmetry largest = PH_SYMMETRY_AUTO;
    for (int s = PH_SYMMETRY_ISOTROPIC; s <= PH_SYMMETRY_ANISOTROPIC; s++) {
        bool asked =
            params->symmetry == PH_SYMMETRY_AUTO || params->symmetry == (ph_symmetry)s;
        if (!asked || !(classes >> s & 1)) continue;
        largest = (ph_symmetry)s;
        distance = distance_of(c, series, largest);
        if (distance <= tolerance) break;
    }
    PH_CHECK(largest != PH_SYMMETRY_AUTO, PH_EUNPHYSICAL,
             "format '%s' has no card for %s%s materials: %s", f->info.name,
             class_name[params->symmetry], series ? " viscoelastic" : "", f->info.valid);
    PH_CHECK(distance <= tolerance || params->nearest, PH_EUNPHYSICAL,
             "the material is not %s: the nearest such tensor is %.2g of its norm away "
             "(tolerance %.2g); format '%s' takes it only where the nearest is asked for",
             class_name[largest], distance, tolerance, f->info.name);
    *out = largest;
out:
    return st;
}

static ph_status check_name(const char *name, ph_error *err)
{
    ph_status st = PH_OK;
    size_t n = strlen(name);
    bool good = n > 0 && n <= 64 && strchr("0123456789_-", name[0]) == NULL;
    for (size_t i = 0; i < n; i++) {
        char ch = name[i];
        good &= (ch >= 'a' && ch <= 'z') || (ch >= 'A' && ch <= 'Z') ||
                (ch >= '0' && ch <= '9') || ch == '_' || ch == '-';
    }
    PH_CHECK(
        good, PH_EINVAL,
        "the name of the material must be 1 to 64 letters, digits, _ or -, beginning "
        "with a letter, got '%.70s'",
        name);
out:
    return st;
}

/* Moduli of an isotropic series: shear is half an eigenvalue, bulk a third of the other. */
static ph_status fill_moduli(const ph_prony *series, ph_i_card *card, ph_error *err)
{
    ph_status st = PH_OK;
    card->series = series;
    PH_ALLOC(card->G, 1 + series->nterms, "shear moduli");
    PH_ALLOC(card->K, 1 + series->nterms, "bulk moduli");
    for (int k = -1; k < series->nterms; k++) {
        ph_sym4 p;
        ph_symmetry_project(k < 0 ? &series->equilibrium : &series->term[k].stiffness,
                            PH_SYMMETRY_ISOTROPIC, &p);
        card->G[k + 1] = 0.5 * p.m[p.n - 1][p.n - 1];
        card->K[k + 1] = p.m[0][1] + 2.0 / 3.0 * card->G[k + 1];
        card->G0 += card->G[k + 1];
        card->K0 += card->K[k + 1];
    }
out:
    return st;
}

static ph_status fill(const ph_effective *effective, const ph_sym4 *stiffness,
                      const ph_prony *series, const ph_card_params *params,
                      ph_i_card *card, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c;
    double voigt[36];
    int n = stiffness->n;
    card->effective = effective;
    card->name = params->name ? params->name : "perihom";
    card->id = params->id > 0 ? params->id : 1;
    card->n = n;
    card->density = effective->density;
    card->distance = distance_of(stiffness, series, card->symmetry);
    ph_symmetry_project(stiffness, card->symmetry, &c);
    ph_sym4_to_voigt(&c, true, voigt);
    double least = round_off * ph_sym4_norm(&c);
    for (int i = 0; i < n * n; i++)
        card->D[i / n][i % n] = fabs(voigt[i]) < least ? 0.0 : voigt[i];
    PH_TRY(ph_engineering_constants(&c, &card->e, err));
    if (series) PH_TRY(fill_moduli(series, card, err));
out:
    return st;
}

/* What the card is to say: the tensor of a state, with the series or without. */
static ph_status choose_state(const ph_effective *e, const ph_card_params *params,
                              ph_sym4 *stiffness, const ph_prony **series, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_prony *p = e->relaxation && e->relaxation->nterms > 0 ? e->relaxation : NULL;
    PH_CHECK((unsigned)params->state <= PH_CARD_EQUILIBRIUM, PH_EINVAL,
             "unknown state %d", (int)params->state);
    *stiffness = e->stiffness;
    if (p) *stiffness = ph_prony_instantaneous(p);
    if (p && params->state == PH_CARD_EQUILIBRIUM) *stiffness = p->equilibrium;
    *series = params->state == PH_CARD_RELAXATION ? p : NULL;
    PH_CHECK(ph_sym4_is_stiffness(stiffness), PH_EINVAL,
             "the %sstiffness is not symmetric positive definite",
             p && params->state == PH_CARD_EQUILIBRIUM ? "equilibrium " : "");
out:
    return st;
}

ph_status ph_card_write(const ph_effective *effective, const char *format,
                        const ph_card_params *params, char **text, double *distance,
                        ph_error *err)
{
    static const ph_card_params defaults = {0};
    ph_status st = PH_OK;
    ph_i_card card = {0};
    ph_sym4 stiffness = {0};
    const ph_prony *series = NULL;
    char *buffer = NULL;
    size_t size = 0;
    FILE *to = NULL;
    if (!params) params = &defaults;
    PH_CHECK(effective && text, PH_EINVAL, "no effective material");
    const ph_card_format *f = find_format(format);
    PH_CHECK(f, PH_EINVAL, "unknown format '%s'", format ? format : "(none)");
    PH_CHECK((unsigned)params->symmetry <= PH_SYMMETRY_ANISOTROPIC, PH_EINVAL,
             "unknown symmetry %d", (int)params->symmetry);
    PH_CHECK(params->tolerance >= 0.0 && params->tolerance < 1.0, PH_EINVAL,
             "the tolerance must be in (0, 1), got %g", params->tolerance);
    PH_TRY(choose_state(effective, params, &stiffness, &series, err));
    PH_CHECK(
        stiffness.n == 6 || f->plane, PH_EINVAL,
        "a %s result has no constants out of the plane, which format '%s' needs: solve "
        "with plane: generalised_strain, or in 3D",
        effective->kinematics == PH_PLANE_STRESS ? "plane stress" : "plane strain",
        f->info.name);
    PH_CHECK(!series || f->relaxes, PH_EUNPHYSICAL,
             "format '%s' has no card for a relaxation series; its instantaneous or its "
             "equilibrium tensor can be written instead",
             f->info.name);
    PH_CHECK(!series || !f->most_terms || series->nterms <= f->most_terms, PH_EUNPHYSICAL,
             "format '%s' holds %d terms of a relaxation, this one has %d: compress it "
             "(ph_prony_compress, Series.compress)",
             f->info.name, f->most_terms, series->nterms);
    if (params->name) PH_TRY(check_name(params->name, err));
    PH_TRY(choose_class(f, &stiffness, series, params, &card.symmetry, err));
    PH_TRY(fill(effective, &stiffness, series, params, &card, err));
    to = open_memstream(&buffer, &size);
    PH_CHECK(to, PH_ENOMEM, "no memory for the card");
    f->write(to, &card);
    int failed = ferror(to);
    failed |= fclose(to);
    PH_CHECK(!failed, PH_ENOMEM, "no memory for the card");
    if (distance) *distance = card.distance;
    *text = buffer;
    buffer = NULL;
out:
    free(buffer);
    free(card.G);
    free(card.K);
    return st;
}
