/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_FAMILY_H
#define PERIHOM_FAMILY_H

#include <perihom/catalogue.h>
#include <perihom/microstructure.h>

#ifdef __cplusplus
extern "C" {
#endif

/** An influence function omega(r / delta), r the bond length. */
typedef struct ph_influence {
    ph_entry info;
    double (*eval)(double q); /* q = r/delta, 0 < q <= 1 + h/(2 delta) */
} ph_influence;
PH_API extern const ph_influence ph_influences[];
PH_API extern const size_t ph_ninfluences;

/** A rule for the share of a cell's volume that lies in the family ball. */
typedef struct ph_volume_weight {
    ph_entry info;
    /* offset xi of the cell, its edges h, horizon delta, d active axes (flags) */
    double (*eval)(const double xi[3], const double h[3], const bool active[3],
                   double delta);
} ph_volume_weight;
PH_API extern const ph_volume_weight ph_volume_weights[];
PH_API extern const size_t ph_nvolume_weights;

/** Where the strain of the nonlocal operator lives. */
typedef enum ph_points {
    PH_POINTS_AUTO,
    PH_POINTS_NODES, /* strain and material at the nodes */
    PH_POINTS_STRESS /* strain and material at the cell centres, displacement at corners */
} ph_points;

/** The family of every point of a uniform grid, and its gradient weights.
 *
 *  grad u(x) = sum_b u(x + o_b) (x) g_b,   o_b in index offsets from the point's base node
 *
 *  g_b = w_b K^-1 xi_b,  K = sum_b w_b xi_b (x) xi_b,  w_b = omega(|xi_b|) beta_b, and for
 *  nodes the centre with minus their sum, so that constants have no gradient. The node
 *  volume V cancels in g. Axes with one cell carry no bonds: fields do not vary there. */
typedef struct ph_family {
    ph_points points;
    double horizon;   /* delta, a length */
    bool active[3];   /* axes with more than one cell */
    int reach[3];     /* largest |offset| per axis */
    ptrdiff_t count;  /* of bonds, the centre not among them */
    int (*offset)[3]; /* [count] index offsets of the nodes; stress points: base corner */
    double (*xi)[3];  /* [count] bond vectors from the point, lengths */
    double *w;        /* [count] omega * beta */
    double (*g)[3];   /* [count] gradient weights, 1/length */
    double g0[3];     /* weight of the centre node (nodes; zero by symmetry) */
    double K[3][3];   /* shape tensor without V */
    double weight;    /* sum_b w_b */
} ph_family;

/** Build the family of a grid.
 *  @param[in] horizon delta [length, >= half the smallest cell diagonal for stress points,
 *             >= the spacing of every active axis for nodes]
 *  @return PH_OK; PH_EINVAL (horizon too small, or more than half the box, or an
 *          influence that leaves no bond);
 *          PH_ESINGULAR (shape tensor); PH_ENOMEM */
PH_API ph_status ph_family_new(const ph_grid *grid, ph_points points, double horizon,
                               const ph_influence *influence,
                               const ph_volume_weight *weight, ph_family **out,
                               ph_error *err);
PH_API void ph_family_free(ph_family **family);

#ifdef __cplusplus
}
#endif
#endif
