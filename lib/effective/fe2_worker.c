/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Run, operator and solver of one RVE, lent to whoever computes. */
#include "effective/fe2.h"

#include <string.h>

static const double default_tolerance = 1e-6;

static ph_status by_strain(const ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(!r->constraint->by_stress && !r->constraint->analytic, PH_EINVAL,
             "FE2 prescribes the macro strain and solves: take constraint periodic or "
             "linear_displacement, not %s",
             r->constraint->info.name);
out:
    return st;
}

static ph_status make_relaxing(const ph_fe2 *f, ph_fe2_worker *w, ph_error *err)
{
    ph_status st = PH_OK;
    const double t = f->problem.solver.tolerance;
    PH_TRY(ph_i_run_relaxing(&w->run, err));
    PH_TRY(by_strain(&w->run, err));
    PH_TRY(ph_i_stepper_new(&w->run, t > 0.0 ? t : default_tolerance, &w->stepper, err));
out:
    return st;
}

static ph_status make_failing(const ph_fe2 *f, ph_fe2_worker *w, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &w->run;
    PH_TRY(ph_i_run_begin(r, err));
    PH_TRY(by_strain(r, err));
    PH_TRY(ph_i_run_prepare(r, err));
    PH_CHECK(!r->classes || !r->setting.source, PH_EINVAL,
             "model bond fails with the collar inside: with a frame around the RVE its "
             "energies are not those of its bonds");
    PH_TRY(ph_i_run_build(r, err));
    const size_t n = (size_t)(r->op->layout.nd * r->op->layout.cells);
    PH_DOUBLES(w->u, &r->meter, n, "a displacement");
    PH_DOUBLES(w->du, &r->meter, n, "an increment");
    for (int a = 0; a < r->map->ns; a++)
        PH_DOUBLES(r->first[a], &r->meter, n, "a first guess");
    PH_TRY(ph_i_strengths_new(r, f->problem.failure, &w->strengths, err));
    PH_TRY(ph_i_scan_new(r, w->strengths, w->macro, &w->scan, err));
out:
    return st;
}

static void clear(ph_fe2 *f, ph_fe2_worker *w)
{
    if (w->run.op) {
        const size_t n = (size_t)(w->run.op->layout.nd * w->run.op->layout.cells);
        ph_i_doubles_free(&w->run.meter, &w->u, n);
        ph_i_doubles_free(&w->run.meter, &w->du, n);
    }
    ph_i_scan_free(&w->scan);
    ph_i_strengths_free(&w->strengths);
    ph_i_stepper_free(&w->stepper);
    ph_i_run_clear(&w->run);
    ph_result_free(&w->run.result);
    ph_i_fe2_drop_damage(f, &w->has);
    free(w);
}

static ph_status new_worker(ph_fe2 *f, ph_fe2_worker **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_worker *w = NULL;
    const ph_ctx ctx = {.threads = f->threads};
    PH_ALLOC(w, 1, "a solver of the RVE");
    w->run.problem = &f->problem;
    w->run.ctx = &ctx;
    PH_TRY(f->kind == PH_FE2_FAILURE ? make_failing(f, w, err)
                                     : make_relaxing(f, w, err));
    pthread_mutex_lock(&f->lock);
    f->worker_bytes += w->run.meter.bytes;
    pthread_mutex_unlock(&f->lock);
    *out = w;
    w = NULL;
out:
    if (w) clear(f, w);
    return st;
}

ph_status ph_i_fe2_take_worker(ph_fe2 *f, const ph_ctx *ctx, ph_fe2_worker **out,
                               ph_error *err)
{
    ph_status st = PH_OK;
    pthread_mutex_lock(&f->lock);
    ph_fe2_worker *w = f->worker;
    if (w) f->worker = w->next;
    pthread_mutex_unlock(&f->lock);
    if (!w) PH_TRY(new_worker(f, &w, err));
    w->run.ctx = ctx;
    w->next = NULL;
    w->run.work.loads = w->run.work.iterations = 0;
    *out = w;
out:
    return st;
}

void ph_i_fe2_return_worker(ph_fe2 *f, ph_fe2_worker **worker)
{
    ph_fe2_worker *w = *worker;
    *worker = NULL;
    if (!w) return;
    w->run.ctx = NULL;
    pthread_mutex_lock(&f->lock);
    f->counts.solves += w->run.work.loads;
    f->counts.iterations += w->run.work.iterations;
    w->next = f->worker;
    f->worker = w;
    pthread_mutex_unlock(&f->lock);
}

void ph_i_fe2_free_worker(ph_fe2 *f, ph_fe2_worker **worker)
{
    ph_fe2_worker *w = *worker;
    *worker = NULL;
    if (w) clear(f, w);
}
