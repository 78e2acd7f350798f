/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How often campaigns that choose the size of their RVE meet the accuracy, and at what cost,
 * docs/theory/sampling.md.
 *
 *   split_table [CAMPAIGNS]     default 1000 a row
 *
 * Costs are in realisations of the case's own edge: with the choice and its pilots, for who
 * knows bias and scatter, and at the case's own edge without asking for the bias. */
#include "split_model.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    const int campaigns = argc > 1 ? atoi(argv[1]) : 1000;
    const struct {
        split_model m;
        double accuracy;
    } row[] = {
        {{2, 2, 0, 0.02, 0}, 0.03},       {{2, 2, 0, 0.02, 0}, 0.01},
        {{2, 2, 0, 0.02, 0}, 0.003},      {{2, 2, 0, 0.02, 0.5}, 0.01},
        {{2, 2, 0.002, 0.02, 0}, 0.01},   {{2, 2, 0.005, 0.02, 0}, 0.01},
        {{2, 2, 0.005, 0.02, 0.5}, 0.01}, {{2, 2, 0.015, 0.02, 0}, 0.01},
        {{3, 3, 0, 0.02, 0}, 0.01},       {{3, 3, 0.002, 0.02, 0}, 0.01},
        {{3, 3, 0.005, 0.02, 0.5}, 0.01}, {{2, 1, 0.002, 0.02, 0}, 0.01},
        {{2, 1, 0.005, 0.02, 0}, 0.01},   {{2, 3, 0.002, 0.02, 0}, 0.01},
    };
    printf(
        "| d | bias | its power | correlation | accuracy | within it, %% | no plan, %% | "
        "edge, mean | sizes | pilots | cost | least | own edge |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t r = 0; r < sizeof row / sizeof *row; r++) {
        const split_model *m = &row[r].m;
        double t = row[r].accuracy, factor = 0, within = 0, none = 0, edge = 0, sizes = 0,
               pilots = 0, cost = 0, least = split_least(m, t, &factor);
        for (int k = 0; k < campaigns; k++) {
            split_run s = split_campaign(m, 7919 * (uint64_t)k + 1, t);
            sizes += s.sizes;
            pilots += (double)s.pilots;
            cost += s.cost;
            none += s.step == PH_SPLIT_NONE;
            if (s.step != PH_SPLIT_CHOSEN) continue;
            within += s.error <= t;
            edge += s.factor;
        }
        double done = campaigns - none,
               own = fmax(SPLIT_PILOTS, pow(1.96 * m->scatter / t, 2));
        printf(
            "| %d | %g %% | %g | %g | %g %% | %.1f | %.1f | %.2f | %.1f | %.0f | %.1f | "
            "%.1f | %.0f |\n",
            m->dimensions, 100 * m->bias, m->power, m->common, 100 * t,
            100 * within / done, 100 * none / campaigns, edge / done, sizes / campaigns,
            pilots / campaigns, cost / campaigns, least, own);
        fflush(stdout);
    }
    return 0;
}
