/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operator of a periodic box: A = sum over parts of B^T C B, plus the spectral
 * stabilisation. One family part (by convolution, stencil or cell corners), and with (P) a
 * sub-point part; or all of it by bond lists, where families end at the faces of an RVE. The
 * force is built as the transpose of the gradient, whatever the route. A bond-based medium
 * has no gradient: all of it is springs. */
#ifndef PH_MODEL_OPERATOR_H
#define PH_MODEL_OPERATOR_H

#include "model/bondlist.h"
#include "model/cells.h"
#include "model/convolution.h"
#include "model/damaged.h"
#include "model/operator_params.h"
#include "model/springs.h"
#include "model/stencil.h"

typedef struct ph_operator {
    ph_layout layout;
    const ph_stiffness_map *map;
    ph_fft *fft;
    ph_meter *meter;
    int threads;
    ptrdiff_t modes;
    ph_route route;
    double share; /* of the family part: 1 - theta */
    bool has_cells;
    ph_cells cells; /* the cells route, or nothing */
    ph_stencil *stencil;
    ph_bondlist *bonds;  /* the bonds route, or NULL */
    ph_bondlist *whole;  /* the same with no bond broken, where some are; else NULL */
    ph_springs *springs; /* model bond, whatever the route, or NULL */
    bool has_convolution;
    ph_convolution convolution;
    int nsub; /* (P) of nodes: one-sided simplices of each node */
    ph_stencil *sub[8];
    double *spectral;    /* [modes] S(k), or NULL */
    double stabilise;    /* factor of every term of (S), see ph_i_operator_stabilise */
    double hourglass;    /* that of the cells, and of the bond lists, at factor 1 */
    double s;            /* its coefficient */
    ph_damaged *damaged; /* nodes that have lost bonds, or NULL */
    const ph_family *family;
    double *u, *f;      /* [nd][cells] */
    size_t nu;          /* doubles of u */
    bool shares_f;      /* f is the beginning of e */
    double *e;          /* [ns][cells], stencil and convolution */
    double *pad;        /* stencil */
    double *hat, *hat2; /* [nd][modes] complex, where fields pass through Fourier space */
    long applications;
    long ffts; /* of its fields by others than `fft`, which counts its own */
} ph_operator;

ph_status ph_i_operator_new(const ph_grid *box, const ph_stiffness_map *map,
                            const ph_operator_params *params, ph_meter *meter,
                            ph_operator **out, ph_error *err);
void ph_i_operator_free(ph_operator **out);
/** Do the points of such an operator see only their own cell? */
bool ph_i_operator_by_cells(const ph_operator_params *params);
/** Room for at least `count` doubles in u, whose contents are lost. @return PH_OK; PH_ENOMEM */
ph_status ph_i_operator_widen(ph_operator *op, size_t count, ph_error *err);

/** Multiply the coefficient of (S) that the operator was made with. @param factor >= 0 */
void ph_i_operator_stabilise(ph_operator *op, double factor);

/** Springs of other moduli, where the tables of their classes have changed.
 *  @return PH_OK; PH_ENOMEM: then there are no springs */
ph_status ph_i_operator_renew_springs(ph_operator *op, ph_error *err);

/** Take in bonds that have broken since the operator was made, or since the last call: only
 *  their nodes are made anew. Not of the route `bonds`, whose lists are made once.
 *  @return PH_OK; PH_ENOMEM */
ph_status ph_i_operator_update(ph_operator *op, ph_error *err);

/** fhat = A uhat, [nd][modes] complex, hat = unnormalised transform. */
void ph_i_operator_apply_hat(ph_operator *op, const double *uhat, double *fhat);
/** fhat = A uhat + F B^T C macro, and sum = C (B u + macro) of all cells together: the gradient
 *  of the energy in u and in a macro strain [ns] Mandel that is free. Not of springs, bond lists
 *  and damaged nodes. */
void ph_i_operator_apply_mean(ph_operator *op, const double *uhat, const double *macro,
                              double *fhat, double *sum);
/** Make ready for ph_i_operator_apply: a solver whose vectors are fields calls it once. */
ph_status ph_i_operator_in_space(ph_operator *op, ph_error *err);
/** f = A u, [nd][cells]. Only after ph_i_operator_in_space. */
void ph_i_operator_apply(ph_operator *op, const double *u, double *f);
/** f = -B^T C macro, the load of a macro strain [ns] Mandel. */
void ph_i_operator_load(ph_operator *op, const double *macro, double *f);
/** The assembled operator, for solvers that need its entries: the springs, the bond lists of
 *  the route, or lists made for the purpose. */
typedef struct ph_assembly {
    const ph_springs *springs;
    const ph_bondlist *list;
    ph_bondlist *own;
} ph_assembly;
ph_status ph_i_assembly_init(ph_assembly *assembly, const ph_operator *op,
                             const ph_grid *box, const ph_operator_params *params,
                             ph_meter *meter, ph_error *err);
void ph_i_assembly_clear(ph_assembly *assembly);
/** As ph_i_bondlist_matrix and ph_i_bondlist_row_sums. */
ph_status ph_i_assembly_matrix(const ph_assembly *assembly, const int *unknown, int n,
                               ph_csc *out, ph_error *err);
ph_status ph_i_assembly_row_sums(const ph_assembly *assembly, double *sum, ph_error *err);

/** f = B^T sigma of a uniform stress [ns] Mandel in the cells with region[x] != 0: the load
 *  of a macro stress. Routes cells and bonds. Broken bonds are left out of account: the
 *  faces of cracks are free, those of the body are pulled. */
void ph_i_operator_pull(ph_operator *op, const double *sigma, const uint8_t *region,
                        double *f);
/** Transforms of all displacement components. */
void ph_i_operator_forward(ph_operator *op, const double *u, double *uhat);
void ph_i_operator_backward(ph_operator *op, const double *uhat, double *work, double *u);

/** Sums over a region (NULL: all cells) of stress, strain [ns] Mandel, and energies. Of a
 *  body with broken bonds (route bonds) the strain is that of whole families: what the gaps
 *  take is in it. */
ph_status ph_i_operator_sums(ph_operator *op, const double *u, const double *macro,
                             const uint8_t *region, double *stress, double *strain,
                             ph_cell_energy *energy, ph_error *err);
/** Strain at the family's points, [ns][cells] Mandel. Not of springs. */
void ph_i_operator_strain(ph_operator *op, const double *u, const double *macro,
                          double *strain);
/** Strain and stress at the family's points, [ns][cells] Mandel. */
ph_status ph_i_operator_fields(ph_operator *op, const double *u, const double *macro,
                               double *strain, double *stress, ph_error *err);
/** Symbol of the operator with one stiffness C0 everywhere: P(k) = B^H C0 B + S,
 *  symmetric nd x nd, packed 00 11 22 12 02 01 (nd = 2: 00 11 01), [nd (nd+1)/2][modes]. */
ph_status ph_i_operator_symbol(ph_operator *op, const ph_sym4 *C0, double *P,
                               ph_error *err);

static inline const char *ph_i_route_name(ph_route route)
{
    static const char *const name[] = {"auto", "cells", "stencil", "convolution",
                                       "bonds"};
    return name[route];
}

#endif
