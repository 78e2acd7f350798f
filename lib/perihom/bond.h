/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bond-based medium: one spring between every two nodes within the horizon. */
#ifndef PERIHOM_BOND_H
#define PERIHOM_BOND_H

#include <perihom/family.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A profile g of the micromodulus, c(xi) = c g(|xi| / delta). */
typedef struct ph_micromodulus {
    ph_entry info;
    double (*eval)(double q, double power); /* g(q), q > 0 */
    /* Integral of g(q) q^d from 0 to 1, d the dimension; power_law: finite for
     * power < d + 1 only. */
    double (*moment)(int dimension, double power);
} ph_micromodulus;
PH_API extern const ph_micromodulus ph_micromoduli[];
PH_API extern const size_t ph_nmicromoduli;

/** What a unit-modulus family has right on its lattice. With the numerical sums
 *  C_ijkl = 1/2 sum_b k_b xi_i xi_j xi_k xi_l, the constant c is scaled so that */
typedef enum ph_calibration {
    PH_CALIBRATE_LATTICE, /* Young's modulus along the axes is exact (mean of the axes) */
    PH_CALIBRATE_GAMMA,   /* C_1111 is exact (mean of the axes) */
    PH_CALIBRATE_CONTINUUM /* nothing is scaled: exact for m -> infinity */
} ph_calibration;

/** An entry of the catalogue of calibrations; index = ph_calibration. */
typedef struct ph_calibration_rule {
    ph_entry info;
} ph_calibration_rule;
PH_API extern const ph_calibration_rule ph_calibrations[];
PH_API extern const size_t ph_ncalibrations;

/** What the springs of a family amount to. */
typedef struct ph_bond_lattice {
    double constant; /* c delta^(d+1) / E of the continuum: 9/pi, 48/(5 pi), 12/pi, .. */
    double factor;   /* by which the calibration scales it ("gamma") */
    double nu;       /* Poisson ratio of the material that the lattice makes of nu */
    double zener;    /* 2 C1212 / (C1111 - C1122): 1 where the lattice is isotropic */
    ph_sym4 C;       /* stiffness of the lattice for E = 1, n = 3 or 6 */
} ph_bond_lattice;

/** Poisson ratio that central forces have: 1/3 in plane stress, 1/4 in plane strain and 3D.
 *  NaN for generalised strain, which they do not do. */
PH_API double ph_bond_poisson(ph_kinematics kin);

/** The springs of a node for E = 1. w[b] = k_b = factor c g beta V / |xi|^3, so that
 *
 *  f(x) = sum_b k_b E_b xi_b xi_b . (u(x) - u(x + o_b))   force per volume
 *  C_ijkl = 1/2 sum_b k_b xi_i xi_j xi_k xi_l             of a homogeneous medium of E = 1
 *
 *  Bonds go to images too, also along axes of one cell; g and K of the family stay zero.
 *  @param[in] horizon delta [length, >= the spacing of every axis, <= the box]
 *  @param[in] power   alpha of power_law, else ignored
 *  @param[out] lattice may be NULL
 *  @return PH_OK; PH_EINVAL (horizon, power, generalised strain); PH_ESINGULAR (a family
 *          that resists no shear); PH_ENOMEM.
 *  Ref: [Silling2005], [Ongaro2022] 3.3 and A.4. Tested: tests/verify/test_bond_lattice.c */
PH_API ph_status ph_bond_family_new(const ph_grid *grid, double horizon,
                                    const ph_micromodulus *profile, double power,
                                    const ph_volume_weight *weight,
                                    ph_calibration calibration, ph_family **out,
                                    ph_bond_lattice *lattice, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
