/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solve/cg.h"

#include "core/real.h"

#include <math.h>
#include <string.h>

#ifndef PH_SINGLE
bool ph_i_told_to_stop(const ph_cg_report *rep)
{
    if (!rep->ctx || !rep->ctx->progress) return false;
    ph_progress now = {"solve",         rep->load,     rep->loads,
                       rep->iterations, rep->residual, rep->tolerance};
    return !rep->ctx->progress(rep->ctx->user, &now);
}

ph_status ph_i_give_up(ph_status status, const ph_cg_report *rep, const char *why,
                       ph_error *err)
{
    ph_status st =
        PH_FAIL(err, status,
                "load %d: %s after %d iterations, relative residual %.3g "
                "(tolerance %.3g)",
                rep->load, why, rep->iterations, rep->residual, rep->tolerance);
    if (err) {
        err->iteration = rep->iterations;
        err->residual = rep->residual;
    }
    return st;
}

#endif

/* Weight of the last node in the rule of Gauss-Radau: what is left is at most radau r.z. */
typedef struct energy_bound {
    double radau, alpha, rz;
} energy_bound;

/* Bound after the step before; true if that is little enough to stop. */
static bool bound_energy(energy_bound *b, double rz, ph_cg_report *rep)
{
    if (!(rep->least > 0.0)) return false;
    if (rep->iterations) {
        double rest = b->radau - b->alpha;
        b->radau =
            rest > 0.0 ? rest / (rep->least * rest + rz / b->rz) : 1.0 / rep->least;
    } else
        b->radau = 1.0 / rep->least;
    b->rz = rz;
    rep->energy_left = b->radau * rz;
    return rep->energy_left <= rep->energy_most;
}

/* What the last steps have gained; true if that is little enough to stop. */
static bool little_gained(double gained[PH_CG_LOOK_BACK], double gain, ph_cg_report *rep)
{
    double sum = 0.0;
    gained[rep->iterations % PH_CG_LOOK_BACK] = gain;
    if (rep->look_back <= 0 || rep->iterations < rep->look_back) return false;
    for (int i = 0; i < rep->look_back; i++)
        sum += gained[(rep->iterations - i) % PH_CG_LOOK_BACK];
    rep->energy_left = sum;
    return sum <= rep->energy_most;
}

/* A guess with a larger residual than this share of the load is worse than zero: what it
 * leaves is rough. Measured: docs/theory/cracks.md. */
static const double poor_guess = 0.1;

/* Begin at the guess x, r being the load; false, and r as it was, where it is a poor one. */
static bool take_guess(const PH_REAL(ph_linear) * s, double b2, real *x, real *r, real *p,
                       real *q, ph_cg_report *rep)
{
    if (!rep->guessed || !(b2 > 0.0)) return false;
    s->apply(s->self, x, q);
    memset(p, 0, ph_i_space_size(s->space) * sizeof(real));
    double left = sqrt(PH_REAL(ph_i_step)(s->space, 1.0, p, q, p, r) / b2);
    if (left <= poor_guess) {
        rep->residual = left;
        return true;
    }
    PH_REAL(ph_i_step)(s->space, -1.0, p, q, p, r);
    return false;
}

/* Names of [Hestenes1952]: r residual, z = M r, p direction, q = A p. */
ph_status PH_REAL(ph_i_cg)(const PH_REAL(ph_linear) * s, real *x, real *r, real *p,
                           real *q, ph_cg_report *rep, ph_error *err)
{
    const ph_space *space = s->space;
    size_t bytes = ph_i_space_size(space) * sizeof(real);
    double b2 = PH_REAL(ph_i_dot)(space, r, r), rz = 0.0;
    rep->iterations = 0;
    rep->residual = b2 > 0.0 ? 1.0 : 0.0;
    rep->energy = rep->energy_left = 0.0;
    energy_bound bound = {0};
    double gained[PH_CG_LOOK_BACK];
    if (!isfinite(b2))
        return ph_i_give_up(PH_ESINGULAR, rep, "the load is not finite", err);
    if (!take_guess(s, b2, x, r, p, q, rep)) memset(x, 0, bytes);
    memset(p, 0, bytes);
    for (;;) {
        bool converged = !(rep->residual > rep->tolerance);
        if (converged && !(rep->least > 0.0)) return PH_OK;
        if (!converged && rep->iterations >= rep->max_iterations)
            return ph_i_give_up(PH_ENOCONV, rep, "not converged", err);
        s->precondition(s->self, r, q); /* z lives in q until A p is there */
        double rz_new = PH_REAL(ph_i_dot)(space, r, q);
        if (rep->energy_share > 0.0)
            rep->energy_most =
                rep->energy_share * fmax(rep->energy_start - rep->energy, 0.0);
        if (bound_energy(&bound, rz_new, rep) || converged) return PH_OK;
        PH_REAL(ph_i_direction)(space, rep->iterations ? rz_new / rz : 0.0, q, p);
        rz = rz_new;
        s->apply(s->self, p, q);
        double pq = PH_REAL(ph_i_dot)(space, p, q);
        if (!(pq > 0.0) || !(rz > 0.0) || !isfinite(pq))
            return ph_i_give_up(PH_ESINGULAR, rep, "the system is singular for this load",
                                err);
        double r2 = PH_REAL(ph_i_step)(space, rz / pq, p, q, x, r);
        bound.alpha = rz / pq;
        rep->energy += bound.alpha * rz;
        rep->iterations++;
        rep->residual = sqrt(r2 / b2);
        if (!isfinite(r2))
            return ph_i_give_up(PH_ESINGULAR, rep, "the iteration overflowed", err);
        if (little_gained(gained, bound.alpha * rz, rep)) return PH_OK;
        if (ph_i_told_to_stop(rep))
            return ph_i_give_up(PH_ECANCELLED, rep, "interrupted", err);
    }
}
