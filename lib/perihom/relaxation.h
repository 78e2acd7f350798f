/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an effective relaxation series means: components and engineering constants in time
 * and in frequency, and a series of fewer terms. */
#ifndef PERIHOM_RELAXATION_H
#define PERIHOM_RELAXATION_H

#include <perihom/prony.h>
#include <perihom/table.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A named number that relaxes. */
typedef struct ph_constant {
    /* "C11" ... Voigt, engineering shear; "E1", "nu12", "G12", "isotropic.E" */
    char name[24];
    bool is_modulus; /* a stress, with storage and loss; else a ratio */
    ph_curve curve;
} ph_constant;

/** All that a series has. Owns its curves. */
typedef struct ph_constants {
    int count;
    ph_constant item[48];
    char why[200]; /* why the engineering constants are missing, or "" */
} ph_constants;

/** Components C_ij (i <= j), engineering constants under uniaxial stress, and the moduli and
 *  Poisson ratio of the nearest isotropic series (of K and G, which are linear in C), each as
 *  an exact series of exponentials, see ph_prony_uniaxial. Where the instantaneous tensor has
 *  no inverse only the components are there and `why` says so.
 *  @return PH_OK; PH_ENOMEM; PH_ENOCONV. Cost: n^2 eliminations of O((terms n)^3).
 *  Tested: tests/unit/test_relaxation_constants.c */
PH_API ph_status ph_constants_new(const ph_prony *p, ph_constants **out, ph_error *err);
PH_API void ph_constants_free(ph_constants **constants);
/** The one of this name, or NULL. */
PH_API const ph_constant *ph_constants_find(const ph_constants *constants,
                                            const char *name);

/** Logarithmic points with `per_decade` of them a decade that cover the relaxation times of
 *  the series and one decade beyond on each side; at most 400 (fewer a decade then).
 *  @param[in] frequencies true: angular frequencies, 1/time; malloc'd, the caller's */
PH_API ph_status ph_prony_grid(const ph_prony *p, bool frequencies, int per_decade,
                               int *count, double **grid, ph_error *err);

/** Columns "time" and every constant at these times. */
PH_API ph_status ph_constants_curves(const ph_constants *constants, int ntimes,
                                     const double *times, ph_table **out, ph_error *err);
/** Columns "omega" and NAME_storage, NAME_loss, NAME_tan_delta of every modulus (ratios:
 *  storage and loss, their real part and minus the imaginary one). */
PH_API ph_status ph_constants_dynamic(const ph_constants *constants, int nomega,
                                      const double *omega, ph_table **out, ph_error *err);
/** Columns "time" and C11, C12, ... (Voigt, upper triangle): one row a term, the first row
 *  with time infinite (an empty cell in CSV) is the equilibrium. */
PH_API ph_status ph_prony_table(const ph_prony *p, ph_table **out, ph_error *err);

/** A series of fewer terms. Its times are chosen to fit, its tensors are the least-squares
 *  ones of all positive semidefinite ones, both limits C(0+) and C_inf are kept.
 *
 *  @param[in] nterms    most terms, >= 1; 0: as few as `tolerance` needs
 *  @param[in] tolerance where nterms is 0: largest error, in (0, 1)
 *  @param[out] error largest over t and x of |x.(C' - C).x| / x.(C + C(0)/1000).x, over t
 *              from 1e-3 of the shortest time to 50 times the longest; measured, not estimated
 *  A series that has no more terms than asked for is copied, error 0.
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM. Cost: O(terms^3) times some hundred trials of the
 *  times, 0.1 s for 10 terms. Tested: tests/unit/test_compress.c */
PH_API ph_status ph_prony_compress(const ph_prony *p, int nterms, double tolerance,
                                   ph_prony **out, double *error, ph_error *err);
/** The error that ph_prony_compress reports, between any two series of one n. */
PH_API double ph_prony_difference(const ph_prony *p, const ph_prony *reference);

#ifdef __cplusplus
}
#endif
#endif
