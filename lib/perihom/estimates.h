/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_ESTIMATES_H
#define PERIHOM_ESTIMATES_H

#include <perihom/catalogue.h>
#include <perihom/material.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The shape that a mean-field estimate sees in an inclusion phase. */
typedef enum ph_inclusion_shape {
    PH_SHAPE_SPHERE,   /* isotropic effective tensor */
    PH_SHAPE_CYLINDER, /* aligned fibres along axis 3 (2D: disks) */
    PH_SHAPE_SPHEROID, /* aspect ratio a3/a1, aligned along axis 3 */
    PH_SHAPE_LAMINATE  /* layers with normal along axis 1 */
} ph_inclusion_shape;

/** What is known of a microstructure without solving it. Phase 0 is the matrix. */
typedef struct ph_composite {
    int n;                       /* phases */
    const ph_material *material; /* [n] */
    const double *fraction;      /* [n], adds up to 1 */
    ph_inclusion_shape shape;    /* of all inclusion phases */
    double aspect;               /* spheroid: a3/a1 > 0 */
    ph_kinematics kinematics;    /* which tensor is wanted */
} ph_composite;

typedef enum ph_estimate_kind { PH_BOUND_LOWER, PH_BOUND_UPPER, PH_POINT_ESTIMATE } ph_estimate_kind;

/** An analytic bound or estimate. */
typedef struct ph_estimate_method {
    ph_entry info;
    ph_estimate_kind kind;
    /* may this method be used? returns NULL, or why not */
    const char *(*refuses)(const ph_composite *composite);
    ph_status (*eval)(const ph_composite *composite, ph_sym4 *out, ph_error *err);
} ph_estimate_method;
PH_API extern const ph_estimate_method ph_estimate_methods[];
PH_API extern const size_t ph_nestimate_methods;

#ifdef __cplusplus
}
#endif
#endif
