/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A patch: the nodes around bonds that are about to break, in equilibrium while all others
 * stay where they are.
 *
 * With A the operator on the nodes of the patch when it was made, and bonds of stiffness k_b
 * broken since, whose elongations were e_b then, the patch moves by [Hager1989]
 *
 *   delta = sum_b z_b t_b,   z_b = A^-1 c_b,   sum_j (1/k_i [i = j] - c_i . z_j) t_j = e_i
 *
 * where c_b takes displacements to the elongation of bond b: one solution of a small system a
 * bond. What the neighbours of the patch feel is left to the next solution of the whole box.
 * Model bond. Tested: tests/verify/test_failure_patches.c */
#ifndef PH_EFFECTIVE_PATCH_H
#define PH_EFFECTIVE_PATCH_H

#include "effective/failure_scan.h"
#include "solve/factor.h"

enum {
    PH_PATCH_BONDS = 96,  /* most that break before the patch is made anew */
    PH_SETTLE_BONDS = 16, /* most that break before the whole box is solved again */
};

typedef struct ph_patch_bond {
    ptrdiff_t x, y;
    const double *xi;
    double k,
        e; /* stiffness; elongation when the box was settled last, or 0: broken then */
} ph_patch_bond;

typedef struct ph_patch {
    ph_run *run;     /* borrowed */
    int reach;       /* of the nodes that move from those that are about to lose bonds */
    ptrdiff_t most;  /* nodes */
    bool made;       /* and the displacement is that of the patch */
    uint8_t *part;   /* [cells] PH_PATCH_* */
    int *unknown;    /* [nd][cells], -1: does not move */
    ptrdiff_t count; /* nodes that feel the patch: its own and their neighbours */
    int32_t *node;   /* [cells] ascending */
    int n;           /* unknowns */
    ptrdiff_t *at;   /* [n] their places in a field */
    double *start;   /* [n] displacement when the patch was made */
    size_t room;     /* of the two, and of every c and z */
    ph_factor *factor;
    int nbonds, nsolved; /* broken; with their z */
    int nold;            /* broken when the box was settled last */
    ph_patch_bond bond[PH_PATCH_BONDS];
    double *c, *z;                               /* [PH_PATCH_BONDS][n] */
    double give[PH_PATCH_BONDS][PH_PATCH_BONDS]; /* c_i . z_j */
} ph_patch;

/** Memory: a few numbers a node of the box. */
ph_status ph_i_patch_new(ph_run *run, ph_patch **out, ph_error *err);
void ph_i_patch_free(ph_patch **patch);
/** A patch around the nodes whose bonds break at not much more than `least`, as last scanned.
 *  patch->made says whether there is one. @return PH_OK; PH_ENOMEM */
ph_status ph_i_patch_make(ph_patch *patch, const ph_scan *scan, double least,
                          const double *u, ph_error *err);
void ph_i_patch_forget(ph_patch *patch);
/** May a bond between x and y break in it? */
bool ph_i_patch_takes(const ph_patch *patch, ptrdiff_t x, ptrdiff_t y);
/** Is there room for so many more bonds? */
static inline bool ph_i_patch_has_room(const ph_patch *patch, ptrdiff_t bonds)
{
    return patch->nbonds + bonds <= PH_PATCH_BONDS &&
           (patch->nbonds == patch->nold ||
            patch->nbonds - patch->nold + bonds <= PH_SETTLE_BONDS);
}
/** The box has been settled: go on from u [nd][cells]. */
void ph_i_patch_go_on(ph_patch *patch, const double *u);
/** A bond of stiffness k > 0 breaks. @return its elongation when the box was settled last */
double ph_i_patch_break(ph_patch *patch, const double *u, const ph_picked *bond,
                        double k);
/** Bring the nodes of the patch in u [nd][cells] into equilibrium.
 *  @param[out] held false: some of them have nothing left that holds them, and u is as it was
 *  @return PH_OK; PH_ENOMEM */
ph_status ph_i_patch_relax(ph_patch *patch, double *u, bool *held, ph_error *err);

#endif
