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

/** Hill's tensor P of an inclusion shape in a homogeneous medium: an eigenstress tau in
 *  the inclusion strains it by -P : tau.
 *
 *  P = 1/|B| int_B Gamma(A^-1 xi) d xi,  Gamma(n) = N (N^T C N)^-1 N^T over directions xi
 *
 *  A = diag(1, 1, aspect), N maps a vector a to the strain of sym(a (x) n). Isotropic
 *  media: closed form, aspect 1e-6 to 1e6 without cancellation; others: quadrature.
 *  @param[in] c0     medium, Mandel, n = 6, or n = 3 for cylinder (a disk in the plane) and
 *                    laminate                              [stress, SPD]
 *  @param[in] aspect a3/a1 of a spheroid, else unused       [-, 1e-6 <= . <= 1e6]
 *  @param[out] p     [1/stress]; may be c0
 *  @return PH_OK; PH_EINVAL (shape in the plane, aspect); PH_ESINGULAR.
 *  Cost: O(1) isotropic or laminate, 0.1 ms cylinder, 1 to 10 ms anisotropic spheroid.
 *  Ref: [Eshelby1957], [Willis1977], [Mura1987] ch. 2. Tested: tests/cross/test_eshelby.c */
PH_API ph_status ph_hill_tensor(const ph_sym4 *c0, ph_inclusion_shape shape,
                                double aspect, ph_sym4 *p, ph_error *err);
/** The same, always by quadrature over directions, which also serves as a check.
 *  Relative error about 1e-10 for aspect 1e-3 to 1e3 and moderate anisotropy. */
PH_API ph_status ph_hill_tensor_quadrature(const ph_sym4 *c0, ph_inclusion_shape shape,
                                           double aspect, ph_sym4 *p, ph_error *err);
/** Eshelby's tensor S = P : C0 (strain of the inclusion over its eigenstrain). Not
 *  symmetric. Arguments and errors as ph_hill_tensor. */
PH_API ph_status ph_eshelby_tensor(const ph_sym4 *c0, ph_inclusion_shape shape,
                                   double aspect, ph_sym4 *s, ph_error *err);

/** What is known of a microstructure without solving it. Phase 0 is the matrix. */
typedef struct ph_composite {
    int n;                       /* phases */
    const ph_material *material; /* [n] */
    const double *fraction;      /* [n], adds up to 1 */
    ph_inclusion_shape shape;    /* of all inclusion phases */
    double aspect;               /* spheroid: a3/a1 > 0 */
    ph_kinematics kinematics;    /* which tensor is wanted */
} ph_composite;

typedef enum ph_estimate_kind {
    PH_BOUND_LOWER,
    PH_BOUND_UPPER,
    PH_POINT_ESTIMATE
} ph_estimate_kind;

/** An analytic bound or estimate. */
typedef struct ph_estimate_method {
    ph_entry info;
    ph_estimate_kind kind;
    /* may this method be used? returns NULL, or why not */
    const char *(*refuses)(const ph_composite *composite);
    /* effective tensor in Mandel, n by the kinematics. PH_EINVAL where the composite is
     * malformed or refused; PH_EUNPHYSICAL, PH_ESINGULAR, PH_ENOCONV where the method has
     * no answer. A lower bound of a body with voids is the zero tensor. */
    ph_status (*eval)(const ph_composite *composite, ph_sym4 *out, ph_error *err);
} ph_estimate_method;
PH_API extern const ph_estimate_method ph_estimate_methods[];
PH_API extern const size_t ph_nestimate_methods;

#ifdef __cplusplus
}
#endif
#endif
