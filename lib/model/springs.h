/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operator of a bond-based medium, linear springs between nodes of a periodic box:
 *
 *   f(x) = sum_b k_b E(x, x+o_b) xi_b xi_b . (u(x) - u(x + o_b))
 *
 * The modulus E of a bond depends on both its ends. Written as a few products and a rest,
 *
 *   E(x,y) = sum_r lambda_r v_r(x) v_r(y) + dE(x,y),  K_o = sum of k_b xi_b xi_b over o_b = o,
 *   f = D u - sum_r lambda_r v_r (K * (v_r u)) - sum_y dE K u,
 *   D(x) = sum_b k_b E xi_b xi_b
 *
 * the sum over the family is a convolution of fields, by FFT (its cost does not depend on
 * the horizon) or directly, and dE is kept pair by pair where it is not zero. A matrix with
 * little filler takes one term, v = 1 in the matrix and E_interphase / E_m in the filler,
 * whose own bonds are the rest; media of large phases take a term a phase and have no rest
 * but the bonds between fillers that touch.
 * Tested against the sum over bonds (ph_i_springs_plain_apply): tests/cross/test_bond_routes.c */
#ifndef PH_MODEL_SPRINGS_H
#define PH_MODEL_SPRINGS_H

#include "model/bond_classes.h"
#include "model/bondlist.h"
#include "space/broken.h"
#include "space/fft.h"

enum { PH_SPRING_TERMS = 8 }; /* more classes than this: one term and a longer rest */

typedef struct ph_spring_pair {
    int32_t node, bond;
    double dE;
} ph_spring_pair;

/* Springs that share an offset along the loops of the layout. */
typedef struct ph_spring_offset {
    int o[3];
    double K[6]; /* 00 11 22 12 02 01, or 00 11 01 */
} ph_spring_offset;

typedef struct ph_springs {
    ph_layout layout;
    ph_meter *meter;
    ph_fft *fft; /* borrowed */
    int threads;
    ptrdiff_t modes;
    const ph_family *family;        /* borrowed */
    const ph_bond_classes *classes; /* borrowed */
    const ph_broken *broken;        /* borrowed: springs without stiffness, or NULL */
    bool by_fft, plain;             /* plain: the sum over bonds, from the definition */
    int (*o)[3];                    /* [family->count] offsets along the loops */
    int terms;
    double lambda[PH_SPRING_TERMS];
    double *v[PH_SPRING_TERMS]; /* [cells] */
    double *D;                  /* [nd (nd+1)/2][cells] */
    ptrdiff_t npairs;
    ptrdiff_t *first;       /* [cells + 1] of the pairs of a cell, or NULL: none */
    ph_spring_pair *pair;   /* [npairs], both ways */
    ptrdiff_t nhalf;        /* direct: one of o and -o */
    ph_spring_offset *half; /* [nhalf] */
    double *symbol;         /* by FFT: K(k), real, [nd (nd+1)/2][modes] */
    double *hat;            /* [nd][modes] complex */
    double *w;              /* [nd][cells] */
    int reach[3];           /* along the loops */
    ptrdiff_t row;          /* of a padded line */
    int32_t *wrapped[2];    /* line number i - reach .. n + reach, of loops 0 and 1 */
    double *pad;            /* [nd + terms][n0 n1][row] */
    double *lines;          /* [threads][LINES][n2] */
} ph_springs;

/** @param[in] route PH_ROUTE_AUTO, _STENCIL (direct), _CONVOLUTION (FFT) or _BONDS (plain)
 *  @return PH_OK; PH_ENOMEM */
ph_status ph_i_springs_new(const ph_layout *layout, ph_fft *fft, const ph_family *family,
                           const ph_bond_classes *classes, ph_route route, int threads,
                           ph_meter *meter, ph_springs **out, ph_error *err);
void ph_i_springs_free(ph_springs **springs);
ph_route ph_i_springs_route(const ph_springs *springs);

/** f = scale A u, [nd][cells]. The same bits for any number of threads. */
void ph_i_springs_apply(ph_springs *springs, const double *u, double scale, double *f);
/** The load of a macro strain [ns] Mandel, sum_b k_b E xi_b (xi_b . macro xi_b). */
void ph_i_springs_load(ph_springs *springs, const double *macro, double *f);
/** Of every node: stress = 1/2 sum_b t_b xi_b (bond virial) and strain = the weighted
 *  gradient sum_b w_b du (x) xi_b K^-1, w_b = k_b |xi_b|^2, [ns][cells] Mandel; energy =
 *  1/2 sum_b k_b E e_b^2, twice what the node holds, [cells]. macro NULL: zero. Each of the
 *  three may be NULL. @return PH_OK; PH_ENOMEM */
ph_status ph_i_springs_fields(ph_springs *springs, const double *u, const double *macro,
                              double *stress, double *strain, double *energy,
                              ph_error *err);
/** P(k) = E0 (K(0) - K(k)), packed as ph_i_operator_symbol. */
ph_status ph_i_springs_symbol(ph_springs *springs, double E0, double *P, ph_error *err);

/** f = A u bond by bond, from the definition: the oracle. */
void ph_i_springs_plain_apply(const ph_springs *springs, const double *u, double *f);
/** As ph_i_bondlist_matrix and ph_i_bondlist_row_sums. */
ph_status ph_i_springs_matrix(const ph_springs *springs, const int *unknown, int n,
                              ph_csc *out, ph_error *err);
ph_status ph_i_springs_row_sums(const ph_springs *springs, double *sum, ph_error *err);

/** Stress of the RVE from the forces that cross its faces, [ns] Mandel: the moment
 *  1/V sum F (x) x of bond forces about the points where the bonds leave or enter the RVE,
 *  which is cells first .. first + n of the box. Equal to the virial with every bond counted
 *  by the share of its length that lies within, if the nodes of the RVE are in equilibrium. */
void ph_i_springs_reactions(const ph_springs *springs, const ptrdiff_t first[3],
                            const ptrdiff_t n[3], const double *u, const double *macro,
                            double *stress);

/* Shared by the files of this module. */
enum { PH_SPRING_LINES = 8 };
static inline int ph_i_springs_packed(const ph_springs *s)
{
    return s->layout.nd * (s->layout.nd + 1) / 2;
}
static inline const double *ph_i_springs_line(const ph_springs *s, int field, ptrdiff_t i,
                                              ptrdiff_t j, const int o[3])
{
    ptrdiff_t a = s->wrapped[0][i + o[0] + s->reach[0]],
              b = s->wrapped[1][j + o[1] + s->reach[1]];
    const ptrdiff_t *n = s->layout.n;
    return s->pad + ((field * n[0] + a) * n[1] + b) * s->row + s->reach[2] + o[2];
}
/** Field `field` of the pads from a field of the box. */
void ph_i_springs_pad(ph_springs *s, int field, const double *u);
/** y = cell that bond b leads to from x. */
ptrdiff_t ph_i_springs_end(const ph_springs *s, ptrdiff_t x, ptrdiff_t b);
/** Modulus of bond b of x, which leads to y; 0 where it is broken. */
double ph_i_springs_modulus(const ph_springs *s, ptrdiff_t x, ptrdiff_t b, ptrdiff_t y);
/** What damaged nodes have of a field, from their intact springs, instead of what the fast
 *  routes gave them: a broken spring has two damaged ends, so that all other rows are right.
 *  Arguments as those of ph_i_springs_apply, _load and _fields. */
void ph_i_springs_damaged_apply(const ph_springs *s, const double *u, double scale,
                                double *f);
void ph_i_springs_damaged_load(const ph_springs *s, const double *macro, double *f);
void ph_i_springs_damaged_fields(const ph_springs *s, const double *u,
                                 const double *macro, double *stress, double *strain,
                                 double *energy);
/** xi . macro . xi */
double ph_i_springs_stretch(int nd, const double *xi, const double *macro);

#endif
