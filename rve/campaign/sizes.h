/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the choice of a size of the RVE. */
#ifndef RVE_CAMPAIGN_SIZES_H
#define RVE_CAMPAIGN_SIZES_H

#include "campaign/campaign.h"

#include <jansson.h>

enum { PH_I_SIZE_SETS = 3 };

/** A size: how it is asked for, and what its pilots were. */
typedef struct ph_i_option {
    int entry; /* in the report */
    char set[PH_I_SIZE_SETS][96];
    char folder[1100];
    ph_campaign *c;
    double *value; /* [npoints][pilots] */
    double *cost;  /* [npoints] */
    double rate;   /* seconds for a unit of cost, NaN: not known */
} ph_i_option;

typedef struct ph_i_chooser {
    const ph_campaign *c;
    const char *const *sets;
    size_t nsets;
    const ph_campaign_params *params;
    double start;
    ph_campaign_sizes *report;
    int64_t pilots; /* of every point and size */
    int noptions, ntried, next;
    ph_i_option option[PH_SPLIT_SIZES]; /* by edge; tried ones are options[tried[i]] */
    int tried[PH_SPLIT_SIZES];
    double grid_cost[PH_SPLIT_GRIDS];
} ph_i_chooser;

/* ---- size_options.c */

/** The sizes to choose from, and the grids where the case leaves them open. */
void ph_i_options_make(ph_i_chooser *s);
/** Seconds of the budget that are left; infinite without one. */
double ph_i_time_left(const ph_i_chooser *s);
/** Realisations of one size, read back. It is left out where the case cannot be had in this
 *  size; its own size may have realisations that fail, as in any campaign. */
ph_status ph_i_pilots_solve(ph_i_chooser *s, ph_i_option *o, bool *good, ph_error *err);
void ph_i_option_clear(ph_i_option *o);

/* ---- document_sizes.c */

/** The block "split" of campaign.json; `good` becomes false without memory. */
json_t *ph_i_sizes_json(const ph_campaign *c, bool *good);

#endif
