/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/factor.h"

#include <suitesparse/cholmod.h>

#include <math.h>
#include <string.h>

/* Below so many unknowns the threads of BLAS cost more than they gain. */
enum { small = 8192 };

struct ph_factor {
    cholmod_common common;
    cholmod_factor *L;
    cholmod_dense *x, *y, *e; /* kept between solves */
    double condition;
    size_t n, bytes;
    bool changes;
    double flops, taken;
};

static ph_status translate(const cholmod_common *c, const char *doing, ph_error *err)
{
    if (c->status == CHOLMOD_OK) return PH_OK;
    if (c->status == CHOLMOD_NOT_POSDEF)
        return PH_FAIL(err, PH_ESINGULAR, "the matrix is not positive definite");
    return PH_FAIL(err, c->status == CHOLMOD_OUT_OF_MEMORY ? PH_ENOMEM : PH_EINTERNAL,
                   "CHOLMOD could not %s the matrix (status %d)", doing, c->status);
}

/* Smallest over largest pivot of L D L^T; negative where one is. */
static double pivots(const ph_factor *f)
{
    const int *start = f->L->p;
    const double *x = f->L->x;
    double least = INFINITY, most = 0.0;
    for (size_t j = 0; j < f->n; j++) {
        least = fmin(least, x[start[j]]);
        most = fmax(most, fabs(x[start[j]]));
    }
    return f->n == 0 ? 1.0 : isfinite(least) && most > 0.0 ? least / most : 0.0;
}

static void measure(ph_factor *f)
{
    f->condition = f->changes ? pivots(f) : cholmod_rcond(f->L, &f->common);
}

ph_status ph_i_factor_new(const ph_csc *m, bool changes, ph_factor **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_factor *f = NULL;
    *out = NULL;
    PH_ALLOC(f, 1, "a factor");
    cholmod_common *c = &f->common;
    cholmod_start(c);
    c->print = 0;
    if (m->n <= small) c->supernodal = CHOLMOD_SIMPLICIAL;
    f->changes = changes;
    c->final_ll = !changes; /* L L^T fails where L D L^T goes on with a negative pivot */
    c->final_super = changes ? 0 : c->final_super;
    c->final_monotonic = 1; /* of the columns, which downdates need */
    f->n = (size_t)m->n;
    cholmod_sparse a = {.nrow = f->n,
                        .ncol = f->n,
                        .nzmax = (size_t)m->start[m->n],
                        .p = m->start,
                        .i = m->row,
                        .x = m->value,
                        .stype = -1,
                        .itype = CHOLMOD_INT,
                        .xtype = CHOLMOD_REAL,
                        .dtype = CHOLMOD_DOUBLE,
                        .packed = 1};
    f->L = cholmod_analyze(&a, c);
    PH_TRY(translate(c, "analyse", err));
    PH_CHECK_KEY(
        c->lnz <= (double)PH_MATRIX_MOST, PH_EINVAL, "solver.kind",
        "the factor of the matrix would have %.3g entries, more than %d: take solver "
        "fft_cg",
        c->lnz, PH_MATRIX_MOST);
    f->bytes = (size_t)c->lnz * sizeof(double);
    cholmod_factorize(&a, f->L, c);
    PH_TRY(translate(c, "factorise", err));
    f->flops = c->fl;
    if (changes && f->L->is_super)
        cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, f->L, c);
    PH_TRY(translate(c, "unpack", err));
    measure(f);
    *out = f;
    f = NULL;
out:
    ph_i_factor_free(&f);
    return st;
}

double ph_i_factor_flops(const ph_factor *f, double *taken)
{
    *taken = f->taken;
    return f->flops;
}

ph_status ph_i_factor_take(ph_factor *f, const ph_csc *columns, int count, ph_error *err)
{
    ph_status st = PH_OK;
    cholmod_common *c = &f->common;
    cholmod_sparse *permuted = NULL;
    cholmod_sparse a = {.nrow = f->n,
                        .ncol = (size_t)count,
                        .nzmax = (size_t)columns->start[count],
                        .p = columns->start,
                        .i = columns->row,
                        .x = columns->value,
                        .itype = CHOLMOD_INT,
                        .xtype = CHOLMOD_REAL,
                        .dtype = CHOLMOD_DOUBLE,
                        .packed = 1};
    PH_ASSERT(f->changes);
    permuted = cholmod_submatrix(&a, f->L->Perm, (int64_t)f->n, NULL, -1, 1, 1, c);
    PH_TRY(translate(c, "permute", err));
    cholmod_updown(0, permuted, f->L, c);
    PH_TRY(translate(c, "downdate", err));
    f->taken += c->modfl;
    measure(f);
out:
    cholmod_free_sparse(&permuted, c);
    return st;
}

void ph_i_factor_free(ph_factor **factor)
{
    if (!factor || !*factor) return;
    ph_factor *f = *factor;
    cholmod_free_dense(&f->x, &f->common);
    cholmod_free_dense(&f->y, &f->common);
    cholmod_free_dense(&f->e, &f->common);
    cholmod_free_factor(&f->L, &f->common);
    cholmod_finish(&f->common);
    free(f);
    *factor = NULL;
}

double ph_i_factor_condition(const ph_factor *f)
{
    return f->condition;
}

size_t ph_i_factor_bytes(const ph_factor *f)
{
    return f->bytes;
}

ph_status ph_i_factor_solve(ph_factor *f, const double *b, double *x, ph_error *err)
{
    return ph_i_factor_solve_all(f, 1, b, x, err);
}

ph_status ph_i_factor_solve_all(ph_factor *f, int count, const double *b, double *x,
                                ph_error *err)
{
    ph_status st = PH_OK;
    size_t all = f->n * (size_t)count;
    double *copy = NULL; /* CHOLMOD's interface is not const */
    PH_ALLOC(copy, all, "a right-hand side");
    memcpy(copy, b, all * sizeof *copy);
    cholmod_dense rhs = {.nrow = f->n,
                         .ncol = (size_t)count,
                         .nzmax = all,
                         .d = f->n,
                         .x = copy,
                         .xtype = CHOLMOD_REAL,
                         .dtype = CHOLMOD_DOUBLE};
    cholmod_solve2(CHOLMOD_A, f->L, &rhs, NULL, &f->x, NULL, &f->y, &f->e, &f->common);
    PH_TRY(translate(&f->common, "solve with", err));
    memcpy(x, f->x->x, all * sizeof *x);
out:
    free(copy);
    return st;
}
