/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_MATERIAL_H
#define PERIHOM_MATERIAL_H

#include <perihom/prony.h>
#include <perihom/tensor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A phase. An elastic phase (`relaxation` NULL) is a plain value: copy it freely. What the
 *  constructors of a viscoelastic phase return owns its series: ph_material_clear frees it,
 *  ph_material_copy copies it. ph_microstructure and ph_case own deep copies; a plain copy
 *  of a ph_material borrows the series of what it was copied from. */
typedef struct ph_material {
    char name[64];
    bool is_void;      /* stiffness is zero */
    bool is_isotropic; /* E, nu below are meant */
    double E, nu;      /* of an isotropic phase, else NaN */
    double density;    /* NaN where not given */
    ph_sym4 stiffness; /* n = 6, Mandel; viscoelastic: instantaneous */
    /* n = 6; NULL: elastic. With it E, nu of an isotropic phase are the instantaneous ones */
    ph_prony *relaxation;
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

/** Viscoelastic phases. Moduli >= 0, times > 0, finite and distinct; the instantaneous
 *  tensor must be positive definite, the equilibrium one may vanish (a fluid). A series
 *  without terms is an elastic phase. Output is the caller's: ph_material_clear.
 *  @return PH_OK; PH_EUNPHYSICAL with key, value and what is admissible; PH_ENOMEM.
 *  Tested: tests/unit/test_viscoelastic_material.c */
/** E(t) relaxes, Poisson's ratio -1 < nu < 1/2 stays: C(t) = E(t) C(1, nu). */
PH_API ph_status ph_material_viscoelastic_young(const char *name, const ph_modulus *E,
                                                double nu, ph_material *out,
                                                ph_error *err);
/** Bulk modulus K(t) and shear modulus G(t) relax each on their own. */
PH_API ph_status ph_material_viscoelastic_bulk_shear(const char *name,
                                                     const ph_modulus *K,
                                                     const ph_modulus *G,
                                                     ph_material *out, ph_error *err);
/** Any series of spatial tensors. @param[in] series n = 6, Mandel; copied.
 *  @param[in] R rotation (row-major 3 x 3) applied to it, or NULL */
PH_API ph_status ph_material_viscoelastic_tensor(const char *name, const ph_prony *series,
                                                 const double *R, ph_material *out,
                                                 ph_error *err);

/** The elastic phase at Carson variable s: stiffness C(s), see ph_prony_carson. Elastic and
 *  void phases are returned as they are; a zero equilibrium tensor is a void.
 *  @param s [1/time, >= 0; 0: equilibrium, INFINITY: instantaneous]
 *  @return PH_OK; PH_EINVAL for s < 0 or NaN; PH_ESINGULAR where C(s) is singular but not
 *  zero (the equilibrium of a phase that resists a change of volume only) */
PH_API ph_status ph_material_at(const ph_material *m, double s, ph_material *out,
                                ph_error *err);
/** A deep copy. */
PH_API ph_status ph_material_copy(const ph_material *m, ph_material *out, ph_error *err);
/** Frees the series; `m` is then elastic, with the instantaneous stiffness. */
PH_API void ph_material_clear(ph_material *m);

#ifdef __cplusplus
}
#endif
#endif
