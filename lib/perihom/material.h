/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_MATERIAL_H
#define PERIHOM_MATERIAL_H

#include <perihom/tensor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A phase. A plain value: copy it freely. */
typedef struct ph_material {
    char name[64];
    bool is_void;      /* stiffness is zero */
    bool is_isotropic; /* E, nu below are meant */
    double E, nu;      /* of an isotropic phase, else NaN */
    double density;    /* NaN where not given */
    ph_sym4 stiffness; /* n = 6, Mandel */
} ph_material;

/** Isotropic phase. @param E Young's modulus [stress, > 0]; nu Poisson ratio [-1 < nu < 1/2]
 *  @return PH_OK; PH_EUNPHYSICAL with the admissible range in the message. */
PH_API ph_status ph_material_isotropic(const char *name, double E, double nu,
                                       ph_material *out, ph_error *err);
/** Anisotropic phase. @param voigt stiffness, engineering shear, row-major [6 x 6, stress,
 *  symmetric positive definite]; R rotation (row-major 3 x 3) applied to it, or NULL. */
PH_API ph_status ph_material_anisotropic(const char *name, const double voigt[36],
                                         const double *R, ph_material *out,
                                         ph_error *err);
/** A hole: zero stiffness. */
PH_API ph_material ph_material_void(const char *name);

#ifdef __cplusplus
}
#endif
#endif
