/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run whose phases relax, for routes that need no more of `reduced` than its choices. */
#include "effective/visco.h"

/* (S) of the instantaneous softness of the phase that is softest late; the operator. */
static ph_status build(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c;
    const ph_microstructure *micro = r->problem->micro;
    PH_TRY(ph_sym4_reduce(&micro->materials[r->soft].stiffness, micro->grid.kinematics,
                          &c, err));
    r->softness = r->map->softest = ph_i_visco_softness(&c);
    PH_TRY(ph_i_run_build(r, err));
out:
    return st;
}

ph_status ph_i_run_relaxing(ph_run *r, ph_error *err)
{
    ph_visco v;
    ph_status st = ph_i_visco_choose(&v, r->problem, r->ctx, err);
    bool own = v.run.problem == &v.run.own;
    *r = v.run; /* all that is made so far */
    if (own) r->problem = &r->own;
    if (r->broken) r->broken->meter = &r->meter; /* it was counted in v.run's */
    r->soft = v.soft;
    if (st != PH_OK) return st;
    PH_CHECK(!r->constraint->analytic, PH_EINVAL,
             "constraint %s needs no equations, and no route that solves them",
             r->constraint->info.name);
    PH_TRY(build(r, err));
out:
    return st;
}
