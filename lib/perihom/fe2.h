/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An RVE at every integration point of a macroscale code, solved when it is asked. */
#ifndef PERIHOM_FE2_H
#define PERIHOM_FE2_H

#include <perihom/homogenise.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What happens in the RVE, found from the problem. */
typedef enum ph_fe2_kind {
    PH_FE2_ELASTIC,      /* C* once, then no solve at all */
    PH_FE2_VISCOELASTIC, /* a phase relaxes: time steps of the RVE */
    PH_FE2_FAILURE       /* problem.failure: bonds break, event by event */
} ph_fe2_kind;

/** Zeroed: all defaults. */
typedef struct ph_fe2_params {
    size_t cache_bytes; /* for histories on which no point stands; 0: 128 MiB */
    int tangents;       /* lengths of step whose tangents are kept; 0: 8 */
    double window;      /* of an event, see ph_loading; 0: 0.01 */
} ph_fe2_params;

/** An RVE and all that its points share. Never changes to the eye: any number of threads may
 *  work with points of one. */
typedef struct ph_fe2 ph_fe2;
/** One integration point: the accepted state, and an increment that is tried. A point is
 *  used by one thread at a time. */
typedef struct ph_fe2_point ph_fe2_point;

/** Make an RVE ready. Solves the elastic one for all loads; one that relaxes or fails gets
 *  its operator and, failing, the fields of the whole cell.
 *  @param[in] problem borrowed with all it points to until ph_fe2_free; loads, keep_fields,
 *             sequence and loading are not looked at. Failing: nothing relaxes. Relaxing: no
 *             cracks. Both: constraint periodic or linear_displacement
 *  @param[in] params  NULL: defaults
 *  @param[in] ctx     threads of one solve; progress of this call
 *  @return PH_OK; what ph_homogenise and its loading return. */
PH_API ph_status ph_fe2_new(const ph_problem *problem, const ph_fe2_params *params,
                            const ph_ctx *ctx, ph_fe2 **out, ph_error *err);
/** Lets go of it; what it holds goes with its last point. */
PH_API void ph_fe2_free(ph_fe2 **fe2);
PH_API ph_fe2_kind ph_fe2_kind_of(const ph_fe2 *fe2);
/** Components of strain and stress: 6 (Voigt 11 22 33 23 13 12), or 3 (11 22 12). */
PH_API int ph_fe2_components(const ph_fe2 *fe2);

/** A virgin point. @return PH_OK; PH_ENOMEM */
PH_API ph_status ph_fe2_point_new(ph_fe2 *fe2, ph_fe2_point **out, ph_error *err);
PH_API void ph_fe2_point_free(ph_fe2_point **point);

/** Try an increment from the accepted state; what was tried before is forgotten, so that a
 *  macroscale Newton iteration calls it as often as it likes. The macro strain grows
 *  linearly over dt.
 *
 *      elastic       sigma = C* eps
 *      viscoelastic  sigma = sigma_past + C_alg(dt) deps: one solve of the RVE per state and
 *                    dt, whatever deps, and n for each new dt, shared by all points
 *      failing       sigma = C(broken bonds) eps; no solve until a bond reaches its strength,
 *                    then one or two an event and n for the new tangent
 *
 *  The answer is a function of the history of accepted increments, deps and dt alone, to the
 *  bit: not of other points, threads, or what was tried.
 *  @param[in]  dstrain [n] Voigt, engineering shear; the strain it leads to below 1e6 in size
 *  @param[in]  dt      [time, >= 0, finite; 0: a jump]
 *  @param[out] stress  [n] at the end of the increment
 *  @param[out] tangent [n * n] d stress / d dstrain, symmetric, row-major; NULL: not wanted
 *  @param[in]  ctx     progress and cancelling of the solves; NULL: silent
 *  @return PH_OK; PH_EINVAL; PH_ENOCONV; PH_ECANCELLED; PH_ENOMEM. Failing, nothing is tried
 *          and the outputs are untouched. Ref: [Feyel2000]. Tested: tests/unit/test_fe2.c */
PH_API ph_status ph_fe2_update(ph_fe2_point *point, const double *dstrain, double dt,
                               double *stress, double *tangent, const ph_ctx *ctx,
                               ph_error *err);
/** The same at many points of one RVE, those that need a solve side by side in ctx->threads
 *  threads; points of one history and increment are solved once. The bits of as many calls of
 *  ph_fe2_update. ctx->progress is called by one thread at a time.
 *  @param[in]  point   [points] distinct, of one RVE
 *  @param[in]  dstrain [points][n]
 *  @param[out] stress  [points][n]
 *  @param[out] tangent [points][n * n] or NULL
 *  @return as ph_fe2_update, the first point's that failed; then nothing is tried anywhere */
PH_API ph_status ph_fe2_update_all(ph_fe2_point *const *point, ptrdiff_t points,
                                   const double *dstrain, double dt, double *stress,
                                   double *tangent, const ph_ctx *ctx, ph_error *err);
/** Take the increment that was tried last. Without one: nothing happens.
 *  @return PH_OK; PH_ENOMEM: the point stays where it is, with what was tried. Cost: some
 *  passes over the fields, no solve. */
PH_API ph_status ph_fe2_accept(ph_fe2_point *point, ph_error *err);
/** The same for many points, side by side in ctx->threads threads: all, or, failing, none. */
PH_API ph_status ph_fe2_accept_all(ph_fe2_point *const *point, ptrdiff_t points,
                                   const ph_ctx *ctx, ph_error *err);
/** Forget the increment that was tried; the accepted state was never touched. */
PH_API void ph_fe2_reject(ph_fe2_point *point);

/** Where a point is, as accepted. Voigt, engineering shear strain. */
typedef struct ph_fe2_state {
    double time; /* sum of dt */
    double strain[6], stress[6];
    long increments;
    /* failing, else 0: */
    ptrdiff_t broken_bonds; /* by the history, without initial cracks */
    ptrdiff_t events;
    double dissipated; /* energy per volume of the RVE, by the breaking of bonds */
} ph_fe2_state;
PH_API ph_status ph_fe2_point_state(const ph_fe2_point *point, ph_fe2_state *out,
                                    ph_error *err);

/** Bytes of the accepted state of a point. */
PH_API size_t ph_fe2_point_bytes(const ph_fe2_point *point);
/** Write the accepted state into the caller's memory, as many bytes; a restart from there has
 *  the same bits. For this build and kind of machine. @return PH_OK; PH_EINVAL (too few) */
PH_API ph_status ph_fe2_point_save(const ph_fe2_point *point, void *memory, size_t bytes,
                                   ph_error *err);
/** @return PH_OK; PH_EINVAL (of another problem, or damaged: the point is untouched);
 *  PH_ENOMEM */
PH_API ph_status ph_fe2_point_restore(ph_fe2_point *point, const void *memory,
                                      size_t bytes, ph_error *err);

/** What the points of an RVE have cost so far. */
typedef struct ph_fe2_counts {
    long updates;    /* increments tried, all points */
    long hits;       /* answered by a history that was known */
    long solves;     /* of the RVE, the first ones included */
    long iterations; /* of these */
    long tangents;   /* algorithmic stiffnesses made */
    long events;     /* of breaking bonds */
    long states;     /* histories held now */
    size_t bytes;    /* operators, fields and states, now */
} ph_fe2_counts;
PH_API void ph_fe2_counts_get(ph_fe2 *fe2, ph_fe2_counts *out);

#ifdef __cplusplus
}
#endif
#endif
