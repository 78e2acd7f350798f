/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "memory.h"

#include "check.h"
#include "report.h"

#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

double memory_here(void)
{
    double here = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    struct rlimit limit;
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        (double)limit.rlim_cur < here)
        here = (double)limit.rlim_cur;
    return here > 0.0 ? here : 0.0;
}

static ph_status refuse_above(double bytes, const char *about, ph_error *err)
{
    ph_status st = PH_OK;
    char wanted[32], there[32];
    double here = memory_here();
    PH_CHECK(here == 0.0 || bytes <= here, PH_ENOMEM,
             "the case takes %s %s of memory and %s are here: fewer microstructure.nodes "
             "take less",
             about, report_bytes((size_t)bytes, wanted),
             report_bytes((size_t)here, there));
out:
    return st;
}

ph_status memory_check_cells(const ph_case *c, bool solves, ph_error *err)
{
    double cells = 1.0, each = 2.0; /* the number of its phase */
    for (int d = 0; d < 3; d++)
        cells *= c->nodes[d] > 0 ? (double)c->nodes[d] : 1.0;
    /* Conjugate gradients hold four vectors, in two directions at least. */
    const char *precision = c->solver.precision ? c->solver.precision : "double";
    if (solves) each += 4.0 * 2.0 * (strcmp(precision, "double") == 0 ? 8.0 : 4.0);
    return refuse_above(cells * each, "at least", err);
}

ph_status memory_check_problem(const ph_problem *problem, ph_error *err)
{
    ph_status st = PH_OK;
    ph_estimate e = {0};
    PH_TRY(ph_homogenise_estimate(problem, &e, err));
    PH_TRY(refuse_above((double)e.bytes, "about", err));
out:
    return st;
}
