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

/* The simplest class that the format has and that holds the tensor. */
static ph_status choose_class(const ph_card_format *f, const ph_sym4 *c,
                              const ph_card_params *params, ph_symmetry *out,
                              ph_error *err)
{
    ph_status st = PH_OK;
    double tolerance = params->tolerance > 0.0 ? params->tolerance : default_tolerance;
    double distance = INFINITY;
    ph_symmetry largest = PH_SYMMETRY_AUTO;
    for (int s = PH_SYMMETRY_ISOTROPIC; s <= PH_SYMMETRY_ANISOTROPIC; s++) {
        bool asked =
            params->symmetry == PH_SYMMETRY_AUTO || params->symmetry == (ph_symmetry)s;
        if (!asked || !(f->classes >> s & 1)) continue;
        largest = (ph_symmetry)s;
        distance = ph_symmetry_project(c, largest, NULL);
        if (distance <= tolerance) break;
    }
    PH_CHECK(largest != PH_SYMMETRY_AUTO, PH_EUNPHYSICAL,
             "format '%s' has no card for %s materials: %s", f->info.name,
             class_name[params->symmetry], f->info.valid);
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

static ph_status fill(const ph_effective *effective, const ph_card_params *params,
                      ph_i_card *card, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c;
    double voigt[36];
    int n = effective->stiffness.n;
    card->effective = effective;
    card->name = params->name ? params->name : "perihom";
    card->id = params->id > 0 ? params->id : 1;
    card->n = n;
    card->density = effective->density;
    card->distance = ph_symmetry_project(&effective->stiffness, card->symmetry, &c);
    ph_sym4_to_voigt(&c, true, voigt);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            card->D[i][j] = voigt[i * n + j];
    double least = round_off * ph_sym4_norm(&c);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            if (fabs(card->D[i][j]) < least) card->D[i][j] = 0.0;
    PH_TRY(ph_engineering_constants(&c, &card->e, err));
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
    PH_CHECK(ph_sym4_is_stiffness(&effective->stiffness), PH_EINVAL,
             "the stiffness is not symmetric positive definite");
    PH_CHECK(
        effective->stiffness.n == 6 || f->plane, PH_EINVAL,
        "a %s result has no constants out of the plane, which format '%s' needs: solve "
        "with plane: generalised_strain, or in 3D",
        effective->kinematics == PH_PLANE_STRESS ? "plane stress" : "plane strain",
        f->info.name);
    if (params->name) PH_TRY(check_name(params->name, err));
    PH_TRY(choose_class(f, &effective->stiffness, params, &card.symmetry, err));
    PH_TRY(fill(effective, params, &card, err));
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
    return st;
}
