/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conjugate gradients for complex symmetric systems, from real parts. */
#ifndef PH_SOLVE_COCG_H
#define PH_SOLVE_COCG_H

#include "solve/cg.h"

/** A = S + i L with S and L real symmetric, positive semidefinite, and a real preconditioner.
 *  One product with A is two of S and two of L. */
typedef struct ph_complex_linear {
    const ph_space *space;
    void *self;
    void (*apply)(void *self, bool loss, const double *p, double *q); /* S or L */
    void (*precondition)(void *self, const double *r, double *z);
} ph_complex_linear;

/** A complex vector: real and imaginary part. */
typedef struct ph_complex_vector {
    double *re, *im;
} ph_complex_vector;

/** Solve A x = b from x = 0 by COCG [VanDerVorst1990]: conjugate gradients with the bilinear
 *  form x^T y (not conjugated), for which A is symmetric. A preconditioner that is a complex
 *  multiple of a real one gives the same iterates; where all phases have one loss angle the
 *  iteration is that of the real problem.
 *  @param[in,out] r  the right-hand side; ends as the residual
 *  @param p, q, t    work; t real
 *  @return PH_OK; PH_ENOCONV; PH_ESINGULAR (breakdown, overflow); PH_ECANCELLED */
ph_status ph_i_cocg(const ph_complex_linear *system, ph_complex_vector x,
                    ph_complex_vector r, ph_complex_vector p, ph_complex_vector q,
                    double *t, ph_cg_report *report, ph_error *err);

#endif
