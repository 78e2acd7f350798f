/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_TENSOR_H
#define PERIHOM_TENSOR_H

#include <perihom/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What is held fixed out of the plane. */
typedef enum ph_kinematics {
    PH_SPACE,              /* 3D: three displacements, six strains */
    PH_GENERALISED_STRAIN, /* fields do not vary along 3, six macro strains */
    PH_PLANE_STRAIN,       /* eps33 = 0: two displacements, strains 11 22 12 */
    PH_PLANE_STRESS        /* sigma33 = 0 locally: two displacements, strains 11 22 12 */
} ph_kinematics;

/** Number of displacement components, 2 or 3. */
PH_API int ph_displacements(ph_kinematics kin);
/** Number of strain components, 3 or 6. */
PH_API int ph_strains(ph_kinematics kin);

/** Fourth-order tensor with minor symmetries, in Mandel notation.
 *
 *  n = 6: order 11 22 33 23 13 12; n = 3: order 11 22 12. Shear rows and columns carry
 *  sqrt(2), so that contraction is a matrix product and inversion a matrix inversion.
 *  Entries outside n x n are zero. */
typedef struct ph_sym4 {
    int n;
    double m[6][6];
} ph_sym4;

/** From Voigt notation with engineering shear (stress = C * engineering strain): shear
 *  rows and columns of a stiffness are multiplied by sqrt(2). `stiffness` false: `voigt`
 *  is a compliance, they are divided instead. @param[in] voigt row-major n x n. */
PH_API ph_sym4 ph_sym4_from_voigt(int n, const double *voigt, bool stiffness);
/** The inverse of ph_sym4_from_voigt. @param[out] voigt row-major n x n. */
PH_API void ph_sym4_to_voigt(const ph_sym4 *c, bool stiffness, double *voigt);

/** Isotropic stiffness of Young's modulus E > 0 and Poisson ratio -1 < nu < 1/2, n = 6. */
PH_API ph_sym4 ph_sym4_isotropic(double E, double nu);
/** Isotropic stiffness from bulk modulus K and shear modulus G, n = 6. */
PH_API ph_sym4 ph_sym4_isotropic_kg(double K, double G);

/** Inverse of a symmetric positive definite tensor.
 *  @return PH_OK; PH_ESINGULAR if it is not positive definite, or if a pivot is round-off
 *  (4e-15) of the largest diagonal entry. `inv` may be `c`. */
PH_API ph_status ph_sym4_inverse(const ph_sym4 *c, ph_sym4 *inv, ph_error *err);
/** Smallest and largest eigenvalue of the symmetric part; either may be NULL. */
PH_API void ph_sym4_eigenvalues(const ph_sym4 *c, double *smallest, double *largest);
/** Symmetric positive definite, entries finite, relative asymmetry at most 1e-6. */
PH_API bool ph_sym4_is_stiffness(const ph_sym4 *c);
/** c = a b (matrix product of Mandel matrices, contraction of tensors). */
PH_API ph_sym4 ph_sym4_product(const ph_sym4 *a, const ph_sym4 *b);
/** a x + b y, entry by entry. */
PH_API ph_sym4 ph_sym4_combine(double a, const ph_sym4 *x, double b, const ph_sym4 *y);
/** Frobenius norm, which is the norm of the tensor. */
PH_API double ph_sym4_norm(const ph_sym4 *c);
/** Rotated tensor C'_ijkl = R_ip R_jq R_kr R_ls C_pqrs. @param[in] R rotation, row-major
 *  3 x 3 for n = 6, 2 x 2 for n = 3. */
PH_API ph_sym4 ph_sym4_rotate(const ph_sym4 *c, const double *R);
/** The n = 3 or n = 6 tensor that a kinematic assumption leaves of a spatial stiffness:
 *  itself, the in-plane block (plane strain), or the block condensed to sigma33 = sigma23
 *  = sigma13 = 0 (plane stress). A zero tensor stays zero. */
PH_API ph_status ph_sym4_reduce(const ph_sym4 *c, ph_kinematics kin, ph_sym4 *out,
                                ph_error *err);

/** Exact stiffness of a fine laminate of two phases, traction and displacement continuous.
 *
 *  C = c1 C1 + c2 C2 - c1 c2 D N (c2 N^T C1 N + c1 N^T C2 N)^-1 N^T D,  D = C1 - C2
 *
 *  N maps a vector a to the strain of sym(a (x) n).
 *  @param[in] fraction2 volume fraction of c2            [-, 0 <= . <= 1]
 *  @param[in] normal    unit normal of the layers        [3; for n = 3 the first two]
 *  A zero tensor (void) in either place scales the other by its fraction: a laminate with
 *  void carries nothing across, which is far too soft for a cell cut by a free surface.
 *  Ref: [Backus1962], [Milton2002] ch. 9. */
PH_API ph_status ph_sym4_laminate(const ph_sym4 *c1, const ph_sym4 *c2, double fraction2,
                                  const double normal[3], ph_sym4 *out, ph_error *err);

/** Engineering constants of an elastic tensor; those a 2D tensor lacks are NaN.
 *  nuij = - strain along j over strain along i under uniaxial stress along i. */
typedef struct ph_engineering {
    double E[3];     /* E1 E2 E3 */
    double nu[3][3]; /* nu[i][j], diagonal unused */
    double G23, G13, G12;
} ph_engineering;

/** @return PH_OK; PH_ESINGULAR where the tensor has no inverse. */
PH_API ph_status ph_engineering_constants(const ph_sym4 *c, ph_engineering *out,
                                          ph_error *err);

/** Nearest isotropic tensor in the Frobenius norm (n = 3: nearest isotropic 2D tensor). */
typedef struct ph_isotropic {
    double E, nu, K, G;
    double distance; /* |C - C_iso| / |C| */
} ph_isotropic;
PH_API ph_isotropic ph_nearest_isotropic(const ph_sym4 *c, ph_kinematics kin);

#ifdef __cplusplus
}
#endif
#endif
