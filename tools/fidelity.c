/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fidelity.h"

#include "report.h"

#include <math.h>

static void put_nodes(FILE *to, ph_kinematics kin, const ptrdiff_t nodes[3])
{
    fprintf(to, "%td x %td", nodes[0], nodes[1]);
    if (kin == PH_SPACE) fprintf(to, " x %td", nodes[2]);
}

void fidelity_print_plan(FILE *to, const ph_case *c, const ph_fidelity_plan *p)
{
    fprintf(to, "# accuracy %.3g %%: begins with ", 100 * p->accuracy);
    put_nodes(to, c->kinematics, p->nodes);
    fprintf(to, " nodes and a grid of about half of them\n");
    for (int k = 0; k < p->nwhy; k++)
        fprintf(to, "# %s\n", p->why[k]);
}

void fidelity_print(FILE *to, const ph_fidelity *f)
{
    char text[32];
    fprintf(to, "\naccuracy    %.3g %% asked for", 100 * f->plan.accuracy);
    if (isfinite(f->error)) fprintf(to, ", error about %.2g %%", 100 * f->error);
    fprintf(to, "%s\n", f->reached ? "" : ": NOT REACHED");
    for (int k = 0; k < f->nsteps; k++) {
        const ph_fidelity_step *s = &f->step[k];
        fprintf(to, "            ");
        put_nodes(to, f->settings.kinematics, s->nodes);
        fprintf(to, " nodes, %s %.0e, %.2g operations, %s",
                f->plan.energy > 0 ? "energy to" : "tolerance",
                f->plan.energy > 0 ? f->plan.energy : s->tolerance, s->operations,
                report_seconds(s->seconds, text));
        if (isfinite(s->estimate))
            fprintf(to, ": error about %.2g %%", 100 * s->estimate);
        fputc('\n', to);
    }
    for (int k = 0; k < f->plan.nwhy; k++)
        fprintf(to, "why         %s\n", f->plan.why[k]);
    if (f->missing[0]) fprintf(to, "missing     %s\n", f->missing);
}
