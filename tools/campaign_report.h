/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What people see of a campaign: where it is, and what came out. */
#ifndef TOOLS_CAMPAIGN_REPORT_H
#define TOOLS_CAMPAIGN_REPORT_H

#include "progress.h"

#include <perihom_campaign.h>
#include <stdio.h>

typedef struct campaign_talk {
    const ph_campaign *c;
    progress_style style;
    double shown; /* seconds of the run */
    int width;    /* of the line on the screen */
} campaign_talk;

/** The callback of ph_campaign_params, `user` a campaign_talk; false after a signal. */
bool campaign_step(void *user, const ph_campaign_progress *now);
/** Wipe the line. */
void campaign_talk_end(campaign_talk *t);
/** A table, one row a point; with the sizes that were weighed. */
void campaign_table(FILE *to, const ph_campaign *c, const ph_campaign_result *r);
/** The sizes of the RVE that were weighed, and the choice. */
void campaign_sizes(FILE *to, const ph_campaign *c);

#endif
