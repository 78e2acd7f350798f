/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/failure_scan.h"

#include <math.h>
#include <string.h>

/* ---- set up ------------------------------------------------------------------------------ */

static ph_status list_halves(ph_scan *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_broken *br = s->strengths->broken;
    PH_ALLOC(s->half, br->family->count, "bonds");
    for (ptrdiff_t b = 0; b < br->family->count; b++)
        if (br->mirror[b] < b) s->half[s->nhalf++] = (int)b;
out:
    return st;
}

static ph_status wrap_axes(ph_scan *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_broken *br = s->strengths->broken;
    for (int d = 0; d < 3; d++) {
        ptrdiff_t n = br->n[d], reach = br->family->reach[d];
        PH_ALLOC(s->wrap[d], n + 2 * reach, "neighbours");
        for (ptrdiff_t i = -reach; i < n + reach; i++)
            s->wrap[d][i + reach] = (int32_t)((i % n + n) % n);
        s->wrap[d] += reach; /* index 0 is cell 0; undone by ph_i_scan_free */
    }
out:
    return st;
}

/* Strengths with scatter cost a logarithm and a power: once for all. */
static ph_status keep_strengths(ph_scan *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_broken *br = s->strengths->broken;
    if (!s->strengths->scatters) return PH_OK;
    PH_DOUBLES(s->critical, br->meter, (size_t)(s->cells * s->nhalf), "strengths");
#pragma omp parallel for num_threads(s->run->threads) schedule(static)
    for (ptrdiff_t x = 0; x < s->cells; x++)
        for (ptrdiff_t h = 0; h < s->nhalf; h++)
            s->critical[x * s->nhalf + h] = ph_i_strength(
                s->strengths, x, s->half[h], ph_i_broken_end(br, x, s->half[h]));
out:
    return st;
}

/* No bond breaks at a smaller stretch. */
static double weakest(const ph_scan *s)
{
    const ph_strengths *k = s->strengths;
    double least = INFINITY, form = INFINITY;
    for (ptrdiff_t i = 0; s->critical && i < s->cells * s->nhalf; i++)
        least = fmin(least, s->critical[i]);
    if (s->critical) return least;
    for (int c = 0; c < PH_STRENGTH_FORMS; c++)
        for (ptrdiff_t b = 0; b < k->broken->family->count; b++)
            form = fmin(form, k->form[c][b]);
    for (ptrdiff_t i = 0; i < 2 * (ptrdiff_t)k->classes * k->classes; i++)
        least = fmin(least, k->amplitude[i % 2][i / 2]);
    return least * form * (1.0 - 1e-12);
}

ph_status ph_i_scan_new(const ph_run *r, const ph_strengths *strengths,
                        const double *macro, ph_scan **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_scan *s = NULL;
    PH_ALLOC(s, 1, "bonds to look at");
    s->run = r;
    s->strengths = strengths;
    s->macro = macro;
    s->cells = r->op->layout.cells;
    PH_TRY(list_halves(s, err));
    PH_TRY(wrap_axes(s, err));
    PH_TRY(keep_strengths(s, err));
    PH_ALLOC(s->stretch, s->nhalf, "stretches");
    s->weakest = weakest(s);
    PH_DOUBLES(s->least, strengths->broken->meter, (size_t)s->cells, "critical loads");
    *out = s;
    s = NULL;
out:
    ph_i_scan_free(&s);
    return st;
}

void ph_i_scan_free(ph_scan **scan)
{
    if (!scan || !*scan) return;
    ph_scan *s = *scan;
    const ph_broken *br = s->strengths->broken;
    for (int d = 0; d < 3; d++)
        if (s->wrap[d]) free(s->wrap[d] - br->family->reach[d]);
    ph_i_doubles_free(br->meter, &s->critical, (size_t)(s->cells * s->nhalf));
    ph_i_doubles_free(br->meter, &s->least, (size_t)s->cells);
    free(s->half);
    free(s->stretch);
    free(s->picked);
    free(s);
    *scan = NULL;
}

/* ---- one bond ---------------------------------------------------------------------------- */

double ph_i_scan_pull_of(const ph_scan *s, const double *u, const double *macro,
                         ptrdiff_t x, ptrdiff_t b, ptrdiff_t y)
{
    const double *xi = s->strengths->broken->family->xi[b];
    const ph_layout *l = &s->run->op->layout;
    double sum = ph_i_springs_stretch(l->ns == 3 ? 2 : 3, xi, macro);
    for (int a = 0; a < l->nd; a++)
        sum += xi[a] * (u[a * l->cells + y] - u[a * l->cells + x]);
    return sum;
}

double ph_i_scan_pull(const ph_scan *s, const double *u, ptrdiff_t x, ptrdiff_t b,
                      ptrdiff_t y)
{
    return ph_i_scan_pull_of(s, u, s->macro, x, b, y);
}

/* Both ends are nodes of the RVE, which stands alone in its box. */
static bool stays_inside(const ph_scan *s, const ptrdiff_t at[3], const int o[3])
{
    const ph_setting *set = &s->run->setting;
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = at[d] - set->first[d], n = s->run->result->grid.n[d];
        if (i < 0 || i >= n || (n > 1 && (i + o[d] < 0 || i + o[d] >= n))) return false;
    }
    return true;
}

/* Cell that a bond leads to, -1: none that could break. */
static ptrdiff_t end_of(const ph_scan *s, const ptrdiff_t at[3], ptrdiff_t b)
{
    const int *o = s->strengths->broken->family->offset[b];
    const ptrdiff_t *n = s->strengths->broken->n;
    if (s->run->setting.source && !stays_inside(s, at, o)) return -1;
    return (s->wrap[0][at[0] + o[0]] * n[1] + s->wrap[1][at[1] + o[1]]) * n[2] +
           s->wrap[2][at[2] + o[2]];
}

/* Critical stretch of bond h of the half family. What holds the RVE does not break: bonds
 * that leave it, and those between two nodes that are held. */
static double critical_stretch(const ph_scan *s, ptrdiff_t x, ptrdiff_t h, ptrdiff_t y)
{
    const uint8_t *held = s->run->setting.fixed;
    if (y < 0 || (held && held[x] && held[y])) return INFINITY;
    return s->critical ? s->critical[x * s->nhalf + h]
                       : ph_i_strength(s->strengths, x, s->half[h], y);
}

static double length2(const ph_scan *s, ptrdiff_t h)
{
    const double *xi = s->strengths->broken->family->xi[s->half[h]];
    return xi[0] * xi[0] + xi[1] * xi[1] + xi[2] * xi[2];
}

/* Load at which it breaks. */
static double critical_load(const ph_scan *s, const double *u, double sign, ptrdiff_t x,
                            ptrdiff_t h, ptrdiff_t y)
{
    double critical = critical_stretch(s, x, h, y);
    if (!isfinite(critical)) return INFINITY;
    double stretch = sign * ph_i_scan_pull(s, u, x, s->half[h], y) / length2(s, h);
    return stretch > 0.0 ? critical / stretch : (double)INFINITY;
}

static bool is_intact(const ph_scan *s, ptrdiff_t place, ptrdiff_t h)
{
    return place < 0 || !ph_i_is_broken(s->strengths->broken, place, s->half[h]);
}

/* ---- all bonds --------------------------------------------------------------------------- */

static void cell_at(const ph_scan *s, ptrdiff_t x, ptrdiff_t at[3])
{
    const ptrdiff_t *n = s->strengths->broken->n;
    at[0] = x / n[2] / n[1];
    at[1] = x / n[2] % n[1];
    at[2] = x % n[2];
}

/* The strength of a bond is looked up only if it could be the first to break. */
static void scan_cell(ph_scan *s, const double *u, double sign, ptrdiff_t x)
{
    const ph_family *f = s->strengths->broken->family;
    const ptrdiff_t cells = s->cells;
    const int nd = s->run->op->layout.nd;
    ptrdiff_t at[3], place = ph_i_broken_place(s->strengths->broken, x);
    double mine = INFINITY, here[3];
    cell_at(s, x, at);
    for (int a = 0; a < nd; a++)
        here[a] = u[a * cells + x];
    for (ptrdiff_t h = 0; h < s->nhalf; h++) {
        ptrdiff_t b = s->half[h], y = end_of(s, at, b);
        const double *xi = f->xi[b];
        double e = s->stretch[h], square = 0.0;
        if (y < 0 || !is_intact(s, place, h)) continue;
        for (int a = 0; a < nd; a++) {
            e += xi[a] * (u[a * cells + y] - here[a]);
            square += xi[a] * xi[a];
        }
        if (!(sign * e * mine > s->weakest * square)) continue;
        double load = critical_load(s, u, sign, x, h, y);
        if (load < mine) mine = load;
    }
    s->least[x] = mine;
}

/* Of the macro strain, xi . macro xi. */
static void stretch_of_macro(ph_scan *s)
{
    int nd = s->run->op->layout.ns == 3 ? 2 : 3;
    for (ptrdiff_t h = 0; h < s->nhalf; h++)
        s->stretch[h] = ph_i_springs_stretch(
            nd, s->strengths->broken->family->xi[s->half[h]], s->macro);
}

double ph_i_scan_least(const ph_scan *s)
{
    double least = INFINITY;
    for (ptrdiff_t x = 0; x < s->cells; x++)
        least = fmin(least, s->least[x]);
    return least;
}

double ph_i_scan(ph_scan *s, const double *u, double sign)
{
    stretch_of_macro(s);
#pragma omp parallel for num_threads(s->run->threads) schedule(static)
    for (ptrdiff_t x = 0; x < s->cells; x++)
        scan_cell(s, u, sign, x);
    return ph_i_scan_least(s);
}

void ph_i_scan_cells(ph_scan *s, const double *u, double sign, ptrdiff_t count,
                     const int32_t *cell)
{
    stretch_of_macro(s);
    for (ptrdiff_t i = 0; i < count; i++)
        scan_cell(s, u, sign, cell[i]);
}

double ph_i_scan_reach(ph_scan *s, const double *u, const double *macro, const double *du,
                       const double *dmacro)
{
    double least = INFINITY;
#pragma omp parallel for num_threads(s->run->threads) schedule(static)
    for (ptrdiff_t x = 0; x < s->cells; x++) {
        ptrdiff_t at[3], place = ph_i_broken_place(s->strengths->broken, x);
        double mine = INFINITY;
        cell_at(s, x, at);
        for (ptrdiff_t h = 0; h < s->nhalf; h++) {
            if (!is_intact(s, place, h)) continue;
            const ptrdiff_t b = s->half[h], y = end_of(s, at, b);
            const double critical = critical_stretch(s, x, h, y) * length2(s, h);
            if (!isfinite(critical)) continue;
            const double missing = critical - ph_i_scan_pull_of(s, u, macro, x, b, y);
            const double rate = ph_i_scan_pull_of(s, du, dmacro, x, b, y);
            if (missing <= 0.0)
                mine = 0.0;
            else if (rate > 0.0)
                mine = fmin(mine, missing / rate);
        }
        s->least[x] = mine;
    }
    for (ptrdiff_t x = 0; x < s->cells; x++)
        least = fmin(least, s->least[x]);
    return least;
}

static ph_status pick(ph_scan *s, ph_picked bond, ph_error *err)
{
    ph_status st = PH_OK;
    if (s->npicked == s->room) {
        ptrdiff_t room = s->room ? 2 * s->room : 64;
        void *p = realloc(s->picked, (size_t)room * sizeof *s->picked);
        PH_CHECK(p, PH_ENOMEM, "no memory for %td breaking bonds", room);
        s->picked = p;
        s->room = room;
    }
    s->picked[s->npicked++] = bond;
out:
    return st;
}

ph_status ph_i_scan_pick(ph_scan *s, const double *u, double sign, double most,
                         ph_error *err)
{
    ph_status st = PH_OK;
    s->npicked = 0;
    for (ptrdiff_t x = 0; x < s->cells; x++) {
        if (!(s->least[x] <= most)) continue;
        ptrdiff_t at[3], place = ph_i_broken_place(s->strengths->broken, x);
        cell_at(s, x, at);
        for (ptrdiff_t h = 0; h < s->nhalf; h++) {
            ptrdiff_t b = s->half[h], y = end_of(s, at, b);
            if (!is_intact(s, place, h) || !(critical_load(s, u, sign, x, h, y) <= most))
                continue;
            PH_TRY(pick(s, (ph_picked){x, b, y, ph_i_scan_pull(s, u, x, b, y)}, err));
        }
    }
out:
    return st;
}
