/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a case would take. */
#include "companion.h"
#include "core/check.h"

#include <string.h>

/* Solutions of the elastic cell that a relaxation is worth, by route: `reduced` takes its basis
 * from a few Carson variables, `carson` and `frequency` solve at each, four a decade, from the
 * one before; `stepping` at each step. Measured on data/cases. */
static double relaxation_worth(const ph_case *c)
{
    enum { DECADES = 6 };
    const char *route = c->viscoelastic.route;
    if (strcmp(route, "reduced") == 0) return 3.0;
    if (strcmp(route, "stepping") == 0) return 60.0;
    return 4.0 * DECADES;
}

/* The fields of the basis, and their products with the operator. */
static double relaxation_bytes(const ph_problem *p, const ph_estimate *e)
{
    ph_kinematics kin = p->micro->grid.kinematics;
    double basis = 3.0 * ph_strains(kin);
    return 2.0 * 8.0 * basis * ph_displacements(kin) * (double)e->nodes;
}

static ph_status estimate(const ph_case *c, const ph_problem *p, ph_estimate *out,
                          ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_homogenise_estimate(p, out, err));
    if (!ph_case_relaxes(c) || p->loading) goto out;
    out->seconds = out->seconds_least =
        relaxation_worth(c) * out->loads * out->seconds_load;
    out->bytes += (size_t)relaxation_bytes(p, out);
out:
    return st;
}

/* The companion's, once for each part that has it solved with another setting. */
static ph_status add_companions(const ph_case *c, const ph_problem *p, ph_estimate *out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_companion k = {.c = c, .problem = p};
    ph_estimate one = {0};
    double times = 1.0;
    PH_TRY(ph_i_companion_build(&k, err));
    if (k.why[0] || !k.coarse_problem.micro) goto out;
    ph_error none = PH_ERROR_INIT; /* what cannot be solved is no companion either */
    st = estimate(c, &k.coarse_problem, &one, &none);
    if (st != PH_OK && st != PH_ENOMEM) st = PH_OK, one.seconds = one.seconds_least = 0.0;
    PH_CHECK(st == PH_OK, st, "%s", none.msg);
    for (size_t i = 0; i < ph_nerror_parts; i++) {
        const char *name = ph_error_parts[i].info.name;
        times += (c->error_parts >> i & 1u) &&
                 (strcmp(name, "boundary") == 0 ||
                  (strcmp(name, "horizon") == 0 && p->model.horizon_is_length));
    }
    out->seconds += times * one.seconds;
    out->seconds_least += times * one.seconds_least;
    if (one.bytes > out->bytes) out->bytes = one.bytes; /* one after the other */
out:
    ph_i_companion_clear(&k);
    return st;
}

ph_status ph_rve_estimate(const ph_case *c, const ph_problem *problem, ph_estimate *out,
                          ph_error *err)
{
    PH_GIVEN(c && problem && problem->micro && out);
    ph_status st = PH_OK;
    PH_TRY(estimate(c, problem, out, err));
    bool all = problem->nconstants == 0;
    if (c->error_parts && all && out->seconds > 0.0 && c->accuracy.relative == 0.0)
        PH_TRY(add_companions(c, problem, out, err));
out:
    return st;
}
