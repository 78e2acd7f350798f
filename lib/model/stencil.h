/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A gradient as a direct sum over bonds in real space, for families of any shape:
 * grad u(x) = sum_b u(x + o_b) (x) g_b. Pays where the family is small. */
#ifndef PH_MODEL_STENCIL_H
#define PH_MODEL_STENCIL_H

#include <perihom/family.h>

#include "model/stiffness_map.h"
#include "space/layout.h"

typedef struct ph_stencil {
    ph_layout layout;
    int threads;
    ptrdiff_t count;  /* bonds, the centre among them where it has a weight */
    int (*offset)[3]; /* [count] along the loops of the layout */
    double (*g)[3];   /* [count] by direction */
    int reach;        /* along the last loop */
    ptrdiff_t groups; /* distinct (offset[0], offset[1]) */
    int (*group)[2];  /* [groups] */
    int *member;      /* [count] group of a bond */
    ptrdiff_t *start; /* [threads][groups] work */
} ph_stencil;

ph_status ph_i_stencil_new(const ph_layout *layout, ptrdiff_t count,
                           const int (*offset)[3], const double (*g)[3], int threads,
                           ph_stencil **out, ph_error *err);
void ph_i_stencil_free(ph_stencil **stencil);
/** Row length of a padded field. */
ptrdiff_t ph_i_stencil_row(const ph_stencil *stencil);
/** strain [ns][cells] = sym grad u + macro (Mandel). `pad` [nd][n0 n1][row] is work. */
void ph_i_stencil_strain(const ph_stencil *stencil, const double *u, const double *macro,
                         double *pad, double *strain);
/** f [nd][cells] = scale * B^T stress, added if `add`. `pad` [ns][n0 n1][row] is work. */
void ph_i_stencil_divergence(const ph_stencil *stencil, const double *stress,
                             double scale, bool add, double *pad, double *f);

/** stress = C strain, cell by cell, may be in place. [ns][cells] */
void ph_i_hooke_field(const ph_stiffness_map *map, int threads, const double *strain,
                      double *stress);

#endif
