/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/fit_internal.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST_ROWS = 100000, MOST_GRID = 400 };

void ph_prony_fit_free(ph_prony_fit **fit)
{
    if (!fit || !*fit) return;
    free((ph_modulus_term *)(uintptr_t)(*fit)->modulus.term); /* owned here */
    free((*fit)->retardation);
    free((*fit)->value);
    free((*fit)->loss);
    free((*fit)->step);
    free(*fit);
    *fit = NULL;
}

/* ---- what is admissible ---- */

static ph_status check_sd(const double *sd, ptrdiff_t n, ph_error *err)
{
    ph_status st = PH_OK;
    for (ptrdiff_t i = 0; sd && i < n; i++)
        PH_CHECK(sd[i] > 0 && sd[i] <= 1e100, PH_EUNPHYSICAL,
                 "point %td: standard deviation %g: must be positive and finite", i + 1,
                 sd[i]);
out:
    return st;
}

static ph_status check_data(const ph_prony_data *d, const ph_prony_fit_params *p,
                            ph_error *err)
{
    static const char *const x_name[] = {"time", "time", "angular frequency"};
    static const char *const y_name[] = {"modulus", "compliance", "storage modulus"};
    ph_status st = PH_OK;
    PH_CHECK(d->kind >= PH_PRONY_RELAXATION && d->kind <= PH_PRONY_DYNAMIC, PH_EINVAL,
             "unknown kind of data %d", (int)d->kind);
    const bool dynamic = d->kind == PH_PRONY_DYNAMIC;
    PH_CHECK(d->n >= 3 && d->n <= MOST_ROWS, PH_EINVAL, "%td points: needs 3 to %d", d->n,
             MOST_ROWS);
    PH_CHECK(d->x && d->value && (d->loss != NULL) == dynamic, PH_EINVAL,
             dynamic ? "dynamic data need a loss modulus" : "values are missing");
    PH_CHECK(!dynamic || !d->value_sd == !d->loss_sd, PH_EINVAL,
             "standard deviations are needed of both moduli or of none");
    for (ptrdiff_t i = 0; i < d->n; i++) {
        PH_CHECK(d->x[i] >= 1e-60 && d->x[i] <= 1e60, PH_EUNPHYSICAL,
                 "point %td: %s %g: must be 1e-60 to 1e60", i + 1, x_name[d->kind],
                 d->x[i]);
        PH_CHECK(d->value[i] >= 1e-60 && d->value[i] <= 1e60, PH_EUNPHYSICAL,
                 "point %td: %s %g: must be 1e-60 to 1e60", i + 1, y_name[d->kind],
                 d->value[i]);
        PH_CHECK(!dynamic || (d->loss[i] >= 0 && d->loss[i] <= 1e60), PH_EUNPHYSICAL,
                 "point %td: loss modulus %g: must be 0 to 1e60", i + 1, d->loss[i]);
        PH_CHECK(!dynamic || d->loss[i] >= 1e-60 || p->absolute || d->loss_sd,
                 PH_EUNPHYSICAL,
                 "point %td: loss modulus %g has no relative error: use absolute ones or "
                 "standard deviations",
                 i + 1, d->loss[i]);
    }
    PH_TRY(check_sd(d->value_sd, d->n, err));
    PH_TRY(check_sd(dynamic ? d->loss_sd : NULL, d->n, err));
out:
    return st;
}

static ph_status check_params(const ph_prony_fit_params *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p->terms >= 0 && p->terms <= PH_PRONY_FIT_TERMS, PH_EINVAL,
             "%d terms: 1 to %d, or 0 for the criterion", p->terms, PH_PRONY_FIT_TERMS);
    PH_CHECK(p->per_decade == 0 || (p->per_decade > 0 && p->per_decade <= 10), PH_EINVAL,
             "%g times per decade: more than 0, at most 10", p->per_decade);
    PH_CHECK(p->ntimes >= 0 && p->ntimes <= MOST_GRID && (p->ntimes == 0 || p->times),
             PH_EINVAL, "%d given times: at most %d", p->ntimes, MOST_GRID);
    PH_CHECK((p->terms > 0) + (p->per_decade > 0) + (p->ntimes > 0) <= 1, PH_EINVAL,
             "a number of terms, times per decade and given times exclude each other");
    PH_CHECK(p->rest >= PH_PRONY_AUTOMATIC && p->rest <= PH_PRONY_FLUID, PH_EINVAL,
             "unknown choice %d of the equilibrium modulus", (int)p->rest);
    for (int k = 0; k < p->ntimes; k++) {
        PH_CHECK(p->times[k] >= 1e-60 && p->times[k] <= 1e60, PH_EINVAL,
                 "given time %g: must be 1e-60 to 1e60", p->times[k]);
        for (int j = 0; j < k; j++)
            PH_CHECK(p->times[j] != p->times[k], PH_EINVAL, "time %g is given twice",
                     p->times[k]);
    }
out:
    return st;
}

/* ---- rows ---- */

static void rows_free(ph_i_prony_fit_rows *r)
{
    free(r->x);
    free(r->y);
    free(r->weight);
    free(r->is_loss);
}

static ph_status rows_new(const ph_prony_data *d, bool absolute, ph_i_prony_fit_rows *r,
                          ph_error *err)
{
    ph_status st = PH_OK;
    const bool dynamic = d->kind == PH_PRONY_DYNAMIC;
    double largest = 0, least_x = INFINITY, most_x = 0;
    r->kind = d->kind;
    r->m = dynamic ? 2 * d->n : d->n;
    r->known_sd = d->value_sd != NULL;
    PH_ALLOC(r->x, r->m, "the data of a fit");
    PH_ALLOC(r->y, r->m, "the data of a fit");
    PH_ALLOC(r->weight, r->m, "the data of a fit");
    PH_ALLOC(r->is_loss, r->m, "the data of a fit");
    for (ptrdiff_t i = 0; i < d->n; i++)
        largest = fmax(largest, d->value[i]);
    for (ptrdiff_t i = 0; i < r->m; i++) {
        const ptrdiff_t k = i % d->n;
        r->is_loss[i] = i >= d->n;
        const double *sd = r->is_loss[i] ? d->loss_sd : d->value_sd;
        r->x[i] = d->x[k];
        r->y[i] = r->is_loss[i] ? d->loss[k] : d->value[k];
        r->weight[i] = 1 / (sd ? sd[k] : absolute ? largest : r->y[i]);
        least_x = fmin(least_x, d->x[k]);
        most_x = fmax(most_x, d->x[k]);
    }
    /* half a decade more than the data on both sides: they still say something there */
    r->first = (dynamic ? 1 / most_x : least_x) / sqrt(10);
    r->last = (dynamic ? 1 / least_x : most_x) * sqrt(10);
out:
    return st;
}

/* ---- the result ---- */

/* Coefficients of given or found times become the series; terms of no modulus go. */
static ph_status take_series(const ph_i_prony_fit_rows *r, bool constant, bool rate,
                             int ntimes, const double *times, const double *c,
                             ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    ph_modulus_term *term = NULL;
    const double first = constant ? c[0] : 0, second = rate ? c[constant] : 0;
    double sum = 0;
    int n = 0;
    PH_ALLOC(term, ntimes + 1, "the terms of a fit");
    c += constant + rate;
    for (int k = 0; k < ntimes; k++)
        sum += c[k];
    for (int k = 0; k < ntimes; k++) {
        if (!(c[k] > 1e-13 * sum)) continue; /* rounding */
        int j = n++;
        for (; j > 0 && term[j - 1].time > times[k]; j--)
            term[j] = term[j - 1];
        term[j] = (ph_modulus_term){.time = times[k], .modulus = c[k]};
    }
    if (r->kind != PH_PRONY_CREEP) {
        fit->modulus = (ph_modulus){.infinity = first, .nterms = n, .term = term};
        term = NULL;
        goto out;
    }
    fit->instantaneous = first;
    fit->fluidity = second;
    fit->nretardations = n;
    fit->retardation = term;
    PH_ALLOC(term, n + 1, "the terms of a fit");
    fit->modulus.term = term;
    st = ph_modulus_of_creep(first, n, fit->retardation, second, &fit->modulus.infinity,
                             &fit->modulus.nterms, term, err);
    term = NULL;
    if (st == PH_ESINGULAR) ph_error_prefix(err, "the data do not begin early enough: ");
out:
    free(term);
    return st;
}

double ph_prony_fit_at(const ph_prony_fit *fit, double x, double *loss)
{
    if (!fit) return NAN;
    const bool creep = fit->kind == PH_PRONY_CREEP;
    const ph_modulus_term *term = creep ? fit->retardation : fit->modulus.term;
    const int n = creep ? fit->nretardations : fit->modulus.nterms;
    double at[2] = {x, x};
    bool is_loss[2] = {false, true};
    const ph_i_prony_fit_rows row = {
        .kind = fit->kind, .m = 2, .x = at, .is_loss = is_loss};
    double sum = creep ? fit->instantaneous + x * fit->fluidity : fit->modulus.infinity;
    double imaginary = 0;
    for (int k = 0; k < n; k++) {
        sum += term[k].modulus * ph_i_prony_fit_basis(&row, 0, term[k].time, NULL);
        if (fit->kind == PH_PRONY_DYNAMIC)
            imaginary +=
                term[k].modulus * ph_i_prony_fit_basis(&row, 1, term[k].time, NULL);
    }
    if (loss) *loss = imaginary;
    return sum;
}

static ph_status measure(const ph_prony_data *d, const ph_i_prony_fit_rows *r,
                         ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    const bool dynamic = d->kind == PH_PRONY_DYNAMIC;
    double sum = 0;
    fit->n = d->n;
    fit->nresiduals = r->m;
    PH_ALLOC(fit->value, d->n, "the values of a fit");
    if (dynamic) PH_ALLOC(fit->loss, d->n, "the values of a fit");
    for (ptrdiff_t i = 0; i < d->n; i++)
        fit->value[i] = ph_prony_fit_at(fit, d->x[i], dynamic ? &fit->loss[i] : NULL);
    for (ptrdiff_t i = 0; i < r->m; i++) {
        double model = r->is_loss[i] ? fit->loss[i - d->n] : fit->value[i];
        double residual = r->weight[i] * (model - r->y[i]);
        sum += residual * residual;
        fit->worst = fmax(fit->worst, fabs(residual));
    }
    fit->misfit = sqrt(sum / (double)r->m);
out:
    return st;
}

/* ---- ways to choose the times ---- */

/* Whether the series has a constant (equilibrium modulus, instantaneous compliance) and a
 * rate (fluidity). */
static bool has_constant(ph_prony_kind kind, bool fluid)
{
    return kind == PH_PRONY_CREEP || !fluid;
}

static bool has_rate(ph_prony_kind kind, bool fluid)
{
    return kind == PH_PRONY_CREEP && fluid;
}

static double criterion_of(const ph_i_prony_fit_rows *r, const ph_i_prony_fit_model *m)
{
    int used = 0;
    for (int e = 0; e < ph_i_prony_fit_extras(m); e++)
        used += m->c[e] > 0;
    return ph_i_prony_fit_criterion(r, used, m->n, m->rss);
}

static int choose(const ph_i_prony_fit_rows *r,
                  const ph_i_prony_fit_model best[PH_PRONY_FIT_TERMS + 1], int want)
{
    int chosen = -1;
    for (int k = 0; k <= PH_PRONY_FIT_TERMS; k++) {
        if (best[k].rss < 0 || (want > 0 && k > want)) continue;
        if (chosen < 0 ||
            (want > 0 ? best[k].rss < best[chosen].rss
                      : criterion_of(r, &best[k]) < criterion_of(r, &best[chosen])))
            chosen = k;
    }
    return chosen;
}

static ph_status record(const ph_i_prony_fit_rows *r,
                        const ph_i_prony_fit_model best[PH_PRONY_FIT_TERMS + 1],
                        int chosen, ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    free(fit->step);
    fit->step = NULL;
    fit->nsteps = 0;
    PH_ALLOC(fit->step, PH_PRONY_FIT_TERMS + 1, "the steps of a fit");
    for (int k = 0; k <= PH_PRONY_FIT_TERMS; k++) {
        if (best[k].rss < 0) continue;
        if (k == chosen) fit->chosen = fit->nsteps;
        fit->step[fit->nsteps++] =
            (ph_prony_fit_step){.terms = k,
                                .misfit = sqrt(best[k].rss / (double)r->m),
                                .criterion = criterion_of(r, &best[k])};
    }
out:
    return st;
}

/* Sought times, as a solid, as a fluid, or as what the criterion prefers. */
static ph_status seek(const ph_i_prony_fit_rows *r, const ph_prony_fit_params *p,
                      ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_prony_fit_model *best = NULL, *model = NULL;
    double least = INFINITY;
    PH_ALLOC(best, PH_PRONY_FIT_TERMS + 1, "the fit of a series");
    PH_ALLOC(model, 1, "the fit of a series");
    for (int fluid = 0; fluid < 2; fluid++) {
        if (fluid ? p->rest == PH_PRONY_SOLID : p->rest == PH_PRONY_FLUID) continue;
        PH_TRY(ph_i_prony_fit_path(r, has_constant(r->kind, fluid),
                                   has_rate(r->kind, fluid), p->terms, best, err));
        int k = choose(r, best, p->terms);
        double now = criterion_of(r, &best[k]);
        if (now >= least) continue;
        least = now;
        *model = best[k];
        PH_TRY(record(r, best, k, fit, err));
    }
    PH_TRY(take_series(r, model->constant, model->rate, model->n, model->time, model->c,
                       fit, err));
out:
    free(best);
    free(model);
    return st;
}

/* Times that are given or on the grid. */
static ph_status solve_given(const ph_i_prony_fit_rows *r, const ph_prony_fit_params *p,
                             int ntimes, const double *times, ph_prony_fit *fit,
                             ph_error *err)
{
    ph_status st = PH_OK;
    double *c = NULL, *kept = NULL, rss = 0, least = INFINITY;
    bool constant = false, rate = false;
    PH_ALLOC(c, ntimes + 2, "the fit of a series");
    PH_ALLOC(kept, ntimes + 2, "the fit of a series");
    for (int fluid = 0; fluid < 2; fluid++) {
        if (fluid ? p->rest == PH_PRONY_SOLID : p->rest == PH_PRONY_FLUID) continue;
        bool with = has_constant(r->kind, fluid), flows = has_rate(r->kind, fluid);
        PH_TRY(ph_i_prony_fit_solve(r, with, flows, ntimes, times, c, &rss, err));
        int extras = with + flows, used = 0;
        for (int k = 0; k < extras + ntimes; k++)
            used += c[k] > 0;
        double now = ph_i_prony_fit_criterion(r, used, 0, rss);
        if (now >= least) continue;
        least = now;
        constant = with;
        rate = flows;
        memcpy(kept, c, (size_t)(extras + ntimes) * sizeof *c);
    }
    PH_TRY(take_series(r, constant, rate, ntimes, times, kept, fit, err));
out:
    free(c);
    free(kept);
    return st;
}

static ph_status solve_grid(const ph_i_prony_fit_rows *r, const ph_prony_fit_params *p,
                            ph_prony_fit *fit, ph_error *err)
{
    ph_status st = PH_OK;
    double *times = NULL;
    const double first = ceil(p->per_decade * log10(r->first));
    const double last = floor(p->per_decade * log10(r->last));
    PH_CHECK(last - first < MOST_GRID, PH_EINVAL,
             "%g times per decade over %.3g decades: more than %d times", p->per_decade,
             log10(r->last / r->first), MOST_GRID);
    PH_CHECK(last >= first, PH_EINVAL,
             "%g times per decade: none lies in the range of the data", p->per_decade);
    PH_ALLOC(times, last - first + 1, "the times of a fit");
    for (int k = 0; k <= (int)(last - first); k++)
        times[k] = pow(10, (first + k) / p->per_decade);
    PH_TRY(solve_given(r, p, (int)(last - first) + 1, times, fit, err));
out:
    free(times);
    return st;
}

ph_status ph_prony_fit_new(const ph_prony_data *data, const ph_prony_fit_params *params,
                           ph_prony_fit **out, ph_error *err)
{
    PH_GIVEN(data && out);
    ph_status st = PH_OK;
    static const ph_prony_fit_params automatic = {.terms = 0};
    const ph_prony_fit_params *p = params ? params : &automatic;
    ph_i_prony_fit_rows rows = {.m = 0};
    ph_prony_fit *fit = NULL;
    PH_TRY(check_params(p, err));
    PH_TRY(check_data(data, p, err));
    PH_ALLOC(fit, 1, "a fit");
    fit->kind = data->kind;
    PH_TRY(rows_new(data, p->absolute, &rows, err));
    if (p->ntimes > 0)
        PH_TRY(solve_given(&rows, p, p->ntimes, p->times, fit, err));
    else if (p->per_decade > 0)
        PH_TRY(solve_grid(&rows, p, fit, err));
    else
        PH_TRY(seek(&rows, p, fit, err));
    PH_TRY(measure(data, &rows, fit, err));
    *out = fit;
    fit = NULL;
out:
    rows_free(&rows);
    ph_prony_fit_free(&fit);
    return st;
}
