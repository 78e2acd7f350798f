/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/quantity_relaxation.h"

#include <perihom/relaxation.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static const char *const suffix[] = {"", "_storage", "_loss", "_tan_delta"};

/* The constants that a series of these kinematics has; 1 in 3D, 2 in a plane, 3 in both. */
static int where(const char *name)
{
    static const char *const plane[] = {"E1", "E2", "nu12", "nu21", "G12"};
    static const char *const space[] = {"E3",   "nu13", "nu23", "nu31",
                                        "nu32", "G13",  "G23"};
    static const char *const iso[] = {"isotropic.E", "isotropic.nu", "isotropic.K",
                                      "isotropic.G"};
    for (int i = 0; i < 5; i++)
        if (strcmp(name, plane[i]) == 0) return 3;
    for (int i = 0; i < 7; i++)
        if (strcmp(name, space[i]) == 0) return 1;
    for (int i = 0; i < 4; i++)
        if (strcmp(name, iso[i]) == 0) return 3;
    if (name[0] != 'C' || strlen(name) != 3) return 0;
    if (name[1] < '1' || name[2] > '6' || name[1] > name[2]) return 0;
    return strchr("126", name[1]) && strchr("126", name[2]) ? 3 : 1;
}

/* "(t=NUMBER)" or "(omega=NUMBER)" to the end. */
static bool parse_argument(const char *text, const char *key, double *out)
{
    char *end;
    size_t n = strlen(key);
    if (strncmp(text, key, n) != 0) return false;
    *out = strtod(text + n, &end);
    return end > text + n && strcmp(end, ")") == 0 && isfinite(*out) && *out >= 0;
}

bool ph_i_relaxing_parse(ph_quantity *q)
{
    const char *open = strchr(q->name, '(');
    if (!open) return false;
    size_t length = (size_t)(open - q->name), cut = 0;
    bool in_time = parse_argument(open, "(t=", &q->at);
    if (!in_time && !parse_argument(open, "(omega=", &q->at)) return false;
    for (int i = 1; !in_time && i < 4; i++) {
        size_t n = strlen(suffix[i]);
        if (length > n && strncmp(open - n, suffix[i], n) == 0) q->row = i, cut = n;
    }
    if (!in_time && q->row == 0) return false;
    if (length - cut >= sizeof q->argument) return false;
    snprintf(q->argument, sizeof q->argument, "%.*s", (int)(length - cut), q->name);
    bool ratio = strstr(q->argument, "nu") != NULL;
    q->stress = !ratio && q->row < 3;
    return where(q->argument) != 0 && !(ratio && q->row == 3);
}

const char *ph_i_relaxing_word(size_t i)
{
    static const char *const words[] = {"E1(t=1)",
                                        "C11(t=1)",
                                        "nu12(t=1)",
                                        "isotropic.G(t=1)",
                                        "E1_storage(omega=1)",
                                        "E1_loss(omega=1)",
                                        "E1_tan_delta(omega=1)",
                                        NULL};
    return words[i];
}

const char *ph_i_relaxing_refuses(const ph_quantity *q, ph_kinematics kin)
{
    return ph_strains(kin) == 6 || where(q->argument) == 3
               ? NULL
               : "plane stress and plane strain have no constants along axis 3";
}

unsigned ph_i_relaxing_loads(const ph_quantity *q, ph_kinematics kin)
{
    (void)q;
    return (1u << ph_strains(kin)) - 1u;
}

ph_status ph_i_relaxing_value(const ph_quantity *q, const ph_result *r, double *out,
                              ph_error *err)
{
    ph_status st = PH_OK;
    ph_constants *k = NULL;
    PH_CHECK(r->relaxation, PH_EINVAL, "%s: no material of the case relaxes", q->name);
    PH_TRY(ph_constants_new(r->relaxation, &k, err));
    const ph_constant *one = ph_constants_find(k, q->argument);
    PH_CHECK(one, PH_ESINGULAR, "%s: %s", q->name,
             k->why[0] ? k->why : "the series has no such constant");
    if (q->row == 0) {
        *out = ph_curve_at_time(&one->curve, q->at);
    } else {
        double re, im;
        ph_curve_complex(&one->curve, q->at, &re, &im);
        if (!one->is_modulus) im = -im;
        *out = q->row == 1 ? re : q->row == 2 ? im : im / re;
    }
out:
    ph_constants_free(&k);
    return st;
}
