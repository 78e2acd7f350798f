/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Operators whose points live in a cell and see only its corners.
 *
 * The displacement of a cell is the multilinear interpolation of its corners,
 * u = sum_m a_m phi_m with phi in {1, x, y, z, xy, xz, yz, xyz}, local coordinates in
 * [-1, 1]. Points at (+-t, +-t, +-t) with equal weights give, because the phi are
 * orthogonal over them, an energy that is a sum over the modes of the strain:
 *
 *   E = 1/2 sum_cells V [ e_0:C:e_0 + c1 sum_{x,y,z} e_phi:C:e_phi + c2 sum_{xy,xz,yz} e_phi:C:e_phi ]
 *
 * with c1 = t^2, c2 = t^4. One kernel is then
 *   stress points, smallest family          c1 = c2 = 0       (t = 0)
 *   Q1 / trilinear finite elements          c1 = 1/3, c2 = 1/9 (Gauss points)
 *   a share theta at the 2^d simplices (P)  c1 = c2 = theta   (t = 1)
 * and the hourglass energy (S) in real space is `hourglass` times the squared amplitudes. */
#ifndef PH_MODEL_CELLS_H
#define PH_MODEL_CELLS_H

#include "model/stiffness_map.h"
#include "space/layout.h"

typedef struct ph_cells {
    ph_layout layout;
    const ph_stiffness_map *map;
    double c1, c2;
    double hourglass; /* per raw (signed corner sum) amplitude squared */
    int threads;
    double f[3];         /* 2 / (2^active h) by direction, 0 where inactive */
    ptrdiff_t line;      /* doubles per line buffer */
    double *lines;       /* [threads] work lines */
    double *high;        /* [threads][2][nd][plane] forces on the upper node plane */
    double (*planes)[6]; /* [n0] stresses of a plane of cells together */
} ph_cells;

ph_status ph_i_cells_init(ph_cells *cells, const ph_layout *layout,
                          const ph_stiffness_map *map, double c1, double c2,
                          double hourglass, int threads, ph_meter *meter, ph_error *err);
void ph_i_cells_clear(ph_cells *cells, ph_meter *meter);

/** f = scale * B^T C (B u + macro). Component-first fields [nd][cells]; macro [ns] Mandel.
 *  `u` NULL: zero. The same bits for any number of threads. */
void ph_i_cells_apply(const ph_cells *cells, const double *u, const double *macro,
                      double scale, double *f);
/** The same, and sum = scale times the stresses C (B u + macro) of all cells together. There
 *  must be an axis to move along. */
void ph_i_cells_apply_mean(const ph_cells *cells, const double *u, const double *macro,
                           double scale, double *f, double *sum);
/** f in single precision, with the same work lines: not at the same time. */
void ph_i_cells_apply_single(const ph_cells *cells, const float *u, const double *macro,
                             double scale, float *f);

/** f = B^T sigma of a uniform stress [ns] Mandel in the cells with region[x] != 0. */
void ph_i_cells_pull(const ph_cells *cells, const double *sigma, const uint8_t *region,
                     double *f);

/** Strain of mode 1 (the cell average) of u plus macro, [ns][cells] Mandel. */
void ph_i_cells_strain(const ph_cells *cells, const double *u, const double *macro,
                       double *strain);

/** Strains of all modes of some cells: 0 the average, which alone feels macro, then linear
 *  along each direction, then bilinear across each direction (three axes only).
 *  @param[in] cell [count] increasing
 *  @param[out] strain [ph_i_cells_records][count][ns] Mandel */
void ph_i_cells_records_strain(const ph_cells *cells, const double *u,
                               const double *macro, ptrdiff_t count,
                               const ptrdiff_t *cell, double *strain);
/** Number of modes with an energy, and the weight of each, 1, c1 or c2. weight [7] */
int ph_i_cells_records(const ph_cells *cells, double *weight);

/** What one cell holds: twice its energy over V in the average strain, in the other modes
 *  (weights c1, c2), and in the hourglass term. */
typedef struct ph_cell_energy {
    double mean, modes, stabilisation;
} ph_cell_energy;

/** Sums over the cells with region[x] != 0 (NULL: all): stress and strain [ns] Mandel. */
void ph_i_cells_sums(const ph_cells *cells, const double *u, const double *macro,
                     const uint8_t *region, double *stress, double *strain,
                     ph_cell_energy *energy);

#endif
