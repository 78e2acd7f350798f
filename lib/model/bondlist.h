/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operator written out: for every point the nodes that it sees and their gradient
 * weights. Slow, and made from the definition alone: bond vectors, weights and a shape
 * tensor K of its own for each point. It is what the fast routes are tested against, the
 * source of assembled matrices, and the only form of families that end at the faces of an
 * RVE, where no two shape tensors are alike.
 *
 *   E / V = 1/2 sum_p share_p eps_p : C(cell_p) : eps_p + s/2 sum_p sum_b w_b |z_b|^2
 *   grad u at p = sum_b u_b (x) g_b,  z_b = u_b - u_0 - grad u xi_b
 *
 * with u_0 the displacement of the point's node, or the weighted mean of the family.
 * Tested: tests/cross/test_bondlist.c. Ref: [Silling2007], [Silling2017]. */
#ifndef PH_MODEL_BONDLIST_H
#define PH_MODEL_BONDLIST_H

#include "model/cells.h"
#include "model/operator_params.h"

typedef struct ph_bond {
    int32_t node;
    double g[3]; /* gradient weight, 1/length */
} ph_bond;

/* What the energy of deviations from the gradient needs beside. */
typedef struct ph_deviation {
    double xi[3], w; /* bond vector and weight */
    double origin;   /* u_0 = sum_b origin_b u_b */
} ph_deviation;

typedef struct ph_bond_point {
    ptrdiff_t first; /* its bonds: [first, first of the next point) */
    int32_t cell;    /* whose stiffness */
    bool family;     /* of the family, or a sub-point of (P) */
    double share;    /* of the cell's volume */
} ph_bond_point;

typedef struct ph_bondlist {
    const ph_stiffness_map *map;
    int nd, ns;
    ptrdiff_t nodes, points, bonds;
    ph_bond_point *point;    /* [points + 1] */
    ph_bond *bond;           /* [bonds] */
    ph_deviation *deviation; /* [bonds], or NULL without (S) */
    double s;                /* coefficient of (S) */
    ph_meter *meter;
    size_t bytes;
} ph_bondlist;

/** The lists of a box. Families come with their offsets and weights omega beta only.
 *  params->one_sided: points and nodes of the first params->rve cells of the box alone.
 *  @return PH_OK; PH_ESINGULAR if a cut family has too few nodes left; PH_ENOMEM. */
ph_status ph_i_bondlist_new(const ph_grid *box, const ph_stiffness_map *map,
                            const ph_operator_params *params, ph_meter *meter,
                            ph_bondlist **out, ph_error *err);
void ph_i_bondlist_free(ph_bondlist **list);

/** f = A u, [nd][nodes]. */
void ph_i_bondlist_apply(const ph_bondlist *list, const double *u, double *f);
/** f = -B^T C macro, macro [ns] Mandel. */
void ph_i_bondlist_load(const ph_bondlist *list, const double *macro, double *f);
/** f = B^T sigma of a uniform stress [ns] Mandel in the cells with region[x] != 0. */
void ph_i_bondlist_pull(const ph_bondlist *list, const double *sigma,
                        const uint8_t *region, double *f);
/** Strain [ns] Mandel at one point; u NULL: of the macro strain alone, macro NULL: none. */
void ph_i_bondlist_point_strain(const ph_bondlist *list, ptrdiff_t point, const double *u,
                                const double *macro, double *strain);
/** f += weight share B^T stress of one point. */
void ph_i_bondlist_point_force(const ph_bondlist *list, ptrdiff_t point,
                               const double *stress, double weight, double *f);
/** Mean strain of the family's points of every cell, [ns][cells] Mandel; zero where a cell
 *  has none. */
void ph_i_bondlist_strain(const ph_bondlist *list, const double *u, const double *macro,
                          double *strain);
/** Sums over the cells with region[x] != 0 (NULL: all), as ph_i_operator_sums; `modes` of
 *  the energy is that of the sub-points. */
void ph_i_bondlist_sums(const ph_bondlist *list, const double *u, const double *macro,
                        const uint8_t *region, double *stress, double *strain,
                        ph_cell_energy *energy);

/** A symmetric sparse matrix, lower triangle by columns, rows of a column in no order. */
typedef struct ph_csc {
    int n;
    int *start;    /* [n + 1] */
    int *row;      /* [start[n]] */
    double *value; /* [start[n]] */
} ph_csc;

enum { PH_MATRIX_MOST = 200000000 }; /* entries: more is a mistake, not a matrix */

/** The matrix of A on the unknowns.
 *  @param[in] unknown [nd][nodes] number of a displacement 0 .. n-1, or -1 if it is held
 *  @return PH_OK; PH_EINVAL if it has more than PH_MATRIX_MOST entries; PH_ENOMEM */
ph_status ph_i_bondlist_matrix(const ph_bondlist *list, const int *unknown, int n,
                               ph_csc *out, ph_error *err);
void ph_i_csc_clear(ph_csc *m);

/** Absolute row sums of A, sum_j |A_ij|, [nd][nodes]: by Gershgorin's theorem a diagonal
 *  that is nowhere below A. */
ph_status ph_i_bondlist_row_sums(const ph_bondlist *list, double *sum, ph_error *err);

#endif
