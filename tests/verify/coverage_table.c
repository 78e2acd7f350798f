/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How often the intervals of a campaign contain the known mean, docs/theory/sampling.md.
 *
 *   coverage_table [CAMPAIGNS]     default 2000 a row
 *
 * A row is a distribution of the output, a relative half width and a pilot; the columns are
 * the mean number of realisations, its ideal, the share of the intervals that contain the
 * mean, and the same share for the plain rule "stop as soon as the interval is narrow
 * enough", which looks at every realisation. */
#include "coverage.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    const int campaigns = argc > 1 ? atoi(argv[1]) : 2000;
    const struct {
        coverage_kind kind;
        double width;
    } row[] = {{COVERAGE_NORMAL, 0.03},     {COVERAGE_NORMAL, 0.01},
               {COVERAGE_NORMAL, 0.005},    {COVERAGE_UNIFORM, 0.01},
               {COVERAGE_LOGNORMAL, 0.03},  {COVERAGE_LOGNORMAL, 0.01},
               {COVERAGE_LOGNORMAL, 0.005}, {COVERAGE_EXPONENTIAL, 0.2},
               {COVERAGE_EXPONENTIAL, 0.1}, {COVERAGE_EXPONENTIAL, 0.05}};
    static const int pilots[] = {5, 10, 20, 40};
    printf(
        "| output | skewness | half width | pilot | ideal | mean number | coverage, %% | "
        "looking at every one, %% |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (size_t r = 0; r < sizeof row / sizeof *row; r++)
        for (size_t p = 0; p < sizeof pilots / sizeof *pilots; p++) {
            coverage c =
                coverage_of(row[r].kind, row[r].width, pilots[p], campaigns, 1, true);
            printf("| %s | %.2f | %g | %d | %.0f | %.0f | %.1f | %.1f |\n", c.name,
                   c.skewness, row[r].width, pilots[p], c.ideal, c.number,
                   100 * c.covered, 100 * c.covered_greedy);
            fflush(stdout);
        }
    return 0;
}
