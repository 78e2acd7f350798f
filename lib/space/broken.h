/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which bonds of a grid are broken: one bit a bond of a family, kept only for nodes that
 * have lost one. A bond is broken from both its ends. Memory in proportion to the damage. */
#ifndef PH_SPACE_BROKEN_H
#define PH_SPACE_BROKEN_H

#include <perihom/crack.h>
#include <perihom/family.h>

#include "core/memory.h"

typedef struct ph_fresh_bond {
    int32_t node, bond;
} ph_fresh_bond;

typedef struct ph_broken {
    const ph_family *family; /* borrowed: of nodes */
    ptrdiff_t n[3];          /* of the box, which wraps */
    ptrdiff_t *mirror;       /* [family->count] the bond of the opposite offset */
    ptrdiff_t words;         /* of 64 bits, per node */
    ptrdiff_t damaged, room;
    int32_t *node;  /* [damaged] ascending once settled */
    uint64_t *bits; /* [damaged][words] bit b: bond b is broken */
    uint8_t *fresh; /* [damaged] bonds were broken since the last ph_i_broken_seen */
    int32_t *slot;  /* [slots] hash of the nodes, -1: empty */
    ptrdiff_t slots;
    ptrdiff_t pairs; /* broken bonds, each counted once */
    /* Since the last ph_i_broken_seen: bonds that were broken, one end each; none of them
     * counts where bonds were healed. */
    ph_fresh_bond *recent;
    ptrdiff_t nrecent, recent_room;
    bool healed;
    double tips; /* length by which cracks are cut shorter at every tip */
    ph_meter *meter;
    size_t bytes;
} ph_broken;

/** Nothing broken yet.
 *  @param[in] family of nodes, with every offset the opposite one
 *  @return PH_OK; PH_EINVAL: stress points, a box of 2^31 nodes or more; PH_ENOMEM */
ph_status ph_i_broken_new(const ph_grid *box, const ph_family *family, ph_meter *meter,
                          ph_broken **out, ph_error *err);
void ph_i_broken_free(ph_broken **broken);

/** Break the bond `b` of a node, and so the opposite bond of its other end. Breaking it
 *  again does nothing. @return PH_OK; PH_ENOMEM */
ph_status ph_i_break(ph_broken *broken, ptrdiff_t node, ptrdiff_t b, ph_error *err);
/** All bonds whole again; what was made of the broken ones is to be made anew. */
void ph_i_broken_heal(ph_broken *broken);
/** Place of a node in the list, or -1: it has all its bonds. */
ptrdiff_t ph_i_broken_place(const ph_broken *broken, ptrdiff_t node);
/** Sort the nodes, so that sums over them do not depend on the order in which bonds broke.
 *  To be called after the last of several ph_i_break. @return PH_OK; PH_ENOMEM */
ph_status ph_i_broken_settle(ph_broken *broken, ph_error *err);
/** Bits that are held: those of the nodes that have lost a bond. */
static inline size_t ph_i_broken_bits(const ph_broken *broken)
{
    return 64 * (size_t)(broken->damaged * broken->words);
}
/** Forget which nodes are fresh, and which bonds. */
void ph_i_broken_seen(ph_broken *broken);
/** Damage of a node: the weight of its broken bonds over that of all, 0 .. 1. */
double ph_i_broken_damage(const ph_broken *broken, ptrdiff_t place);
/** Inverse of the shape tensor of the intact bonds of the node at a place, 00 11 22 12 02 01;
 *  place -1: of a whole family. False, and zeros, where they do not span space. */
bool ph_i_broken_shape(const ph_broken *broken, ptrdiff_t place, double inverse[6]);
/** Node at the other end of a bond. */
ptrdiff_t ph_i_broken_end(const ph_broken *broken, ptrdiff_t node, ptrdiff_t b);

static inline bool ph_i_is_broken(const ph_broken *broken, ptrdiff_t place, ptrdiff_t b)
{
    return broken->bits[place * broken->words + b / 64] >> (b % 64) & 1;
}

/** Add to `to` the cracks of `from`, each tip drawn back by a length: lines along their points,
 *  semi-axes of ellipses, polygons towards the mean of their vertices. What gets shorter than
 *  nothing is left out. @return PH_OK; PH_ENOMEM */
ph_status ph_i_cracks_shorten(const ph_cracks *from, double by, ph_cracks *to,
                              ph_error *err);
/** Radius of the disk that has the area of a plane polygon. */
double ph_i_polygon_radius(ptrdiff_t count, const double (*vertex)[3]);

/** Break every bond that crosses a crack, drawn back by broken->tips at every tip.
 *
 *  A node that lies in the plane of a crack (to 1e-9 of the spacing) belongs to the side
 *  that the normal points to; in 2D the left of the line, as one walks along it. A bond is
 *  cut if its ends are on different sides and it passes through the crack. The tip of a line
 *  is half open in the same way: of two cracks that meet in a point exactly one cuts a bond
 *  through it. The rim of an ellipse belongs to the crack.
 *
 *  @param[in] rve   whose period repeats the cracks
 *  @param[in] first cell of the box where the RVE begins
 *  @param[in] inside bonds without an end in the RVE stay whole
 *  @param[out] missed cracks that cross no bond, shorter than the lattice can tell; may be NULL
 *  Settles `broken`. Cost: nodes near the cracks x family. */
ph_status ph_i_cracks_cut(const ph_cracks *cracks, const ph_grid *rve,
                          const ptrdiff_t first[3], bool inside, ph_broken *broken,
                          ptrdiff_t *missed, ph_error *err);

#endif
