/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/relaxation.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static const int axis6[6] = {11, 22, 33, 23, 13, 12}, axis3[3] = {11, 22, 12};

void ph_constants_free(ph_constants **constants)
{
    if (!constants || !*constants) return;
    for (int i = 0; i < (*constants)->count; i++)
        ph_curve_free(&(*constants)->item[i].curve);
    free(*constants);
    *constants = NULL;
}

const ph_constant *ph_constants_find(const ph_constants *constants, const char *name)
{
    if (!constants || !name) return NULL;
    for (int i = 0; i < constants->count; i++)
        if (strcmp(constants->item[i].name, name) == 0) return &constants->item[i];
    return NULL;
}

static void scale(ph_curve *curve, double factor)
{
    curve->infinity *= factor;
    for (int m = 0; m < curve->nterms; m++)
        curve->term[m].modulus *= factor;
}

/* A linear functional of the tensors, at every term. */
static ph_status linear(ph_constants *c, const ph_prony *p, const char *name,
                        double (*of)(const ph_sym4 *, int, int), int i, int j,
                        ph_error *err)
{
    ph_status st = PH_OK;
    ph_constant *item = &c->item[c->count];
    PH_ALLOC(item->curve.term, p->nterms, "a curve");
    snprintf(item->name, sizeof item->name, "%s", name);
    item->is_modulus = true;
    item->curve.infinity = of(&p->equilibrium, i, j);
    item->curve.nterms = p->nterms;
    for (int m = 0; m < p->nterms; m++)
        item->curve.term[m] =
            (ph_modulus_term){p->term[m].time, of(&p->term[m].stiffness, i, j)};
    c->count++;
out:
    return st;
}

/* Voigt, engineering shear. */
static double component(const ph_sym4 *c, int i, int j)
{
    double v[36];
    ph_sym4_to_voigt(c, true, v);
    return v[c->n * i + j];
}

static double bulk(const ph_sym4 *c, int i, int j)
{
    (void)i, (void)j;
    return ph_nearest_isotropic(c, PH_SPACE).K;
}

static double shear(const ph_sym4 *c, int i, int j)
{
    (void)i, (void)j;
    return ph_nearest_isotropic(c, PH_SPACE).G;
}

static ph_status put_components(ph_constants *c, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = p->equilibrium.n;
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++) {
            char name[24];
            /* 2D: the shear component keeps its number 6 */
            int a = n == 3 && i == 2 ? 6 : i + 1, b = n == 3 && j == 2 ? 6 : j + 1;
            snprintf(name, sizeof name, "C%d%d", a, b);
            PH_TRY(linear(c, p, name, component, i, j, err));
        }
out:
    return st;
}

static ph_status uniaxial(ph_constants *c, const ph_prony *p, const char *name,
                          int component_, int lateral, double factor, ph_error *err)
{
    ph_constant *item = &c->item[c->count];
    ph_status st = ph_prony_uniaxial(p, component_, lateral, &item->curve, err);
    if (st != PH_OK) return st;
    snprintf(item->name, sizeof item->name, "%s", name);
    item->is_modulus = lateral < 0;
    scale(&item->curve, factor);
    c->count++;
    return PH_OK;
}

static ph_status put_engineering(ph_constants *c, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    const int n = p->equilibrium.n, axes = n == 6 ? 3 : 2;
    char name[24];
    for (int i = 0; i < axes; i++) {
        snprintf(name, sizeof name, "E%d", i + 1);
        PH_TRY(uniaxial(c, p, name, i, -1, 1, err));
    }
    for (int i = 0; i < axes; i++)
        for (int j = 0; j < axes; j++) {
            if (i == j) continue;
            snprintf(name, sizeof name, "nu%d%d", i + 1, j + 1);
            PH_TRY(uniaxial(c, p, name, i, j, 1, err));
        }
    for (int i = axes; i < n; i++) {
        snprintf(name, sizeof name, "G%d", n == 6 ? axis6[i] : axis3[i]);
        PH_TRY(uniaxial(c, p, name, i, -1, 0.5, err)); /* Mandel: 2 G */
    }
out:
    return st;
}

/* The tensor with the bulk and shear modulus of the nearest isotropic one. */
static ph_sym4 isotropic_part(const ph_sym4 *c)
{
    const int n = c->n, d = n == 3 ? 2 : 3;
    const ph_isotropic iso = ph_nearest_isotropic(c, PH_SPACE);
    ph_sym4 r = {.n = n};
    for (int a = 0; a < n; a++) {
        r.m[a][a] += 2 * iso.G;
        for (int b = 0; a < d && b < d; b++)
            r.m[a][b] += iso.K - 2 * iso.G / d;
    }
    return r;
}

static ph_status put_isotropic(ph_constants *c, const ph_prony *p, ph_error *err)
{
    ph_status st = PH_OK;
    ph_prony *iso = NULL;
    PH_TRY(ph_prony_copy(p, &iso, err));
    iso->equilibrium = isotropic_part(&p->equilibrium);
    for (int m = 0; m < p->nterms; m++)
        iso->term[m].stiffness = isotropic_part(&p->term[m].stiffness);
    PH_TRY(uniaxial(c, iso, "isotropic.E", 0, -1, 1, err));
    PH_TRY(uniaxial(c, iso, "isotropic.nu", 0, 1, 1, err));
    PH_TRY(linear(c, p, "isotropic.K", bulk, 0, 0, err));
    PH_TRY(linear(c, p, "isotropic.G", shear, 0, 0, err));
out:
    ph_prony_free(&iso);
    return st;
}

ph_status ph_constants_new(const ph_prony *p, ph_constants **out, ph_error *err)
{
    PH_GIVEN(p && out);
    ph_status st = PH_OK;
    ph_constants *c = NULL;
    ph_error why = PH_ERROR_INIT;
    *out = NULL;
    PH_ALLOC(c, 1, "engineering constants");
    PH_TRY(put_components(c, p, err));
    st = put_engineering(c, p, &why);
    if (st == PH_OK) st = put_isotropic(c, p, &why);
    if (st == PH_ESINGULAR) {
        /* what was there before the first inverse: the components */
        snprintf(c->why, sizeof c->why, "%s", why.msg);
        st = PH_OK;
    }
    PH_CHECK(st == PH_OK, st, "%s", why.msg);
    *out = c;
    c = NULL;
out:
    ph_constants_free(&c);
    return st;
}

ph_status ph_prony_grid(const ph_prony *p, bool frequencies, int per_decade, int *count,
                        double **grid, ph_error *err)
{
    PH_GIVEN(p && count && grid);
    enum { MOST = 400 };
    ph_status st = PH_OK;
    double first = p->nterms ? p->term[0].time : 1;
    double last = p->nterms ? p->term[p->nterms - 1].time : 1;
    double lo = log10(first) - 1, hi = log10(last) + 1;
    int n = (int)ceil((hi - lo) * per_decade) + 1;
    PH_CHECK(per_decade >= 1, PH_EINVAL, "points a decade must be at least 1, got %d",
             per_decade);
    if (n > MOST) n = MOST;
    PH_ALLOC(*grid, n, "points of a curve");
    for (int k = 0; k < n; k++) {
        double u = lo + (hi - lo) * k / (n - 1);
        (*grid)[frequencies ? n - 1 - k : k] = pow(10, frequencies ? -u : u);
    }
    *count = n;
out:
    return st;
}

static ph_status new_table(const ph_constants *c, int each, const char *first,
                           const char *const *suffix, int nrows, ph_table **out,
                           ph_error *err)
{
    ph_status st = PH_OK;
    char(*text)[40] = NULL;
    const char **name = NULL;
    int ncolumns = 1 + each * c->count;
    PH_ALLOC(text, ncolumns, "names of columns");
    PH_ALLOC(name, ncolumns, "names of columns");
    snprintf(text[0], sizeof *text, "%s", first);
    ncolumns = 1;
    for (int i = 0; i < c->count; i++)
        for (int k = 0; k < each; k++)
            if (k < 2 || c->item[i].is_modulus)
                snprintf(text[ncolumns++], sizeof *text, "%s%s", c->item[i].name,
                         suffix[k]);
    for (int i = 0; i < ncolumns; i++)
        name[i] = text[i];
    PH_TRY(ph_table_new(ncolumns, name, nrows, out, err));
out:
    free(text);
    free(name);
    return st;
}

static double *cell(ph_table *table, int column, int row)
{
    return &table->value[(ptrdiff_t)column * table->nrows + row];
}

ph_status ph_constants_curves(const ph_constants *c, int ntimes, const double *times,
                              ph_table **out, ph_error *err)
{
    PH_GIVEN(c && out && (times || ntimes == 0));
    static const char *const suffix[] = {""};
    ph_status st = new_table(c, 1, "time", suffix, ntimes, out, err);
    if (st != PH_OK) return st;
    for (int k = 0; k < ntimes; k++) {
        *cell(*out, 0, k) = times[k];
        for (int i = 0; i < c->count; i++)
            *cell(*out, 1 + i, k) = ph_curve_at_time(&c->item[i].curve, times[k]);
    }
    return PH_OK;
}

ph_status ph_constants_dynamic(const ph_constants *c, int nomega, const double *omega,
                               ph_table **out, ph_error *err)
{
    PH_GIVEN(c && out && (omega || nomega == 0));
    static const char *const suffix[] = {"_storage", "_loss", "_tan_delta"};
    ph_status st = new_table(c, 3, "omega", suffix, nomega, out, err);
    if (st != PH_OK) return st;
    for (int k = 0; k < nomega; k++) {
        int at = 1;
        *cell(*out, 0, k) = omega[k];
        for (int i = 0; i < c->count; i++) {
            double re, im;
            ph_curve_complex(&c->item[i].curve, omega[k], &re, &im);
            *cell(*out, at++, k) = re;
            *cell(*out, at++, k) = c->item[i].is_modulus ? im : -im;
            if (c->item[i].is_modulus) *cell(*out, at++, k) = im / re;
        }
    }
    return PH_OK;
}

ph_status ph_prony_table(const ph_prony *p, ph_table **out, ph_error *err)
{
    PH_GIVEN(p && out);
    ph_status st = PH_OK;
    ph_constants c = {0};
    PH_TRY(put_components(&c, p, err));
    static const char *const suffix[] = {""};
    PH_TRY(new_table(&c, 1, "time", suffix, p->nterms + 1, out, err));
    for (int m = 0; m <= p->nterms; m++) {
        *cell(*out, 0, m) = m ? p->term[m - 1].time : HUGE_VAL;
        for (int i = 0; i < c.count; i++)
            *cell(*out, 1 + i, m) =
                m ? c.item[i].curve.term[m - 1].modulus : c.item[i].curve.infinity;
    }
out:
    for (int i = 0; i < c.count; i++)
        ph_curve_free(&c.item[i].curve);
    return st;
}
