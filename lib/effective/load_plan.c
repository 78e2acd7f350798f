/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which loads a run solves: only those that the scene requires. */
#include <perihom/quantity.h>

#include "effective/run.h"

int ph_i_run_count(unsigned loads)
{
    int count = 0;
    for (; loads; loads >>= 1)
        count += (int)(loads & 1u);
    return count;
}

static int solved_of(const ph_run *r, ph_load_plan p)
{
    if (!r->symmetry.count) return ph_i_run_count(p.strain) + ph_i_run_count(p.stress);
    return ph_i_run_count(ph_i_symmetry_loads(&r->symmetry, p.strain)) +
           ph_i_run_count(ph_i_symmetry_loads(&r->symmetry, p.stress));
}

/* A mean stress of a periodic cell needs a mean strain as a further unknown. */
static bool could_take_stress(const ph_run *r)
{
    return r->symmetry.count && !r->setting.source && !r->setting.fixed && !r->broken &&
           !r->result->bond.present && r->map->cells > 1 && !r->problem->keep_fields &&
           !r->no_stress;
}

/* By strains alone, or each constant of the compliance from its mean stress. */
static ph_load_plan plan_of_constants(const ph_run *r, bool by_stress)
{
    const ph_problem *p = r->problem;
    const ph_kinematics kin = r->result->grid.kinematics;
    const bool pairs = ph_i_run_second_order(r);
    ph_cell_symmetry none = ph_i_symmetry_none(r->map->ns);
    const ph_cell_symmetry *s = r->symmetry.count ? &r->symmetry : &none;
    ph_load_plan plan = {0, 0};
    for (int i = 0; i < p->nconstants; i++) {
        const ph_quantity *q = &p->constants[i];
        bool here = q->kind && !ph_quantity_refuses(q, kin);
        if (!here || !q->kind->row)
            plan.strain |=
                here && pairs ? q->kind->fields(q, kin) : ph_quantity_loads(q, kin);
        else if (!by_stress)
            plan.strain |= ph_i_symmetry_block(s, q->kind->row(q, kin));
        else
            plan.stress |= pairs ? q->kind->fields(q, kin) : 1u << q->kind->row(q, kin);
    }
    plan.strain &= ph_i_run_all_loads(r->result);
    return plan;
}

bool ph_i_run_stress_is_less(const ph_run *r)
{
    if (!could_take_stress(r)) return false;
    return solved_of(r, plan_of_constants(r, true)) <
           solved_of(r, plan_of_constants(r, false));
}

/* Refined entries take the fields of all loads, and so does a compliance as a whole. */
ph_load_plan ph_i_run_plan(const ph_run *r)
{
    const ph_problem *p = r->problem;
    const unsigned all = ph_i_run_all_loads(r->result);
    const bool part = p->loads && !ph_i_run_second_order(r);
    if (r->constraint->by_stress) return (ph_load_plan){all, 0};
    if (!p->nconstants || r->broken)
        return (ph_load_plan){part ? p->loads & all : all, 0};
    bool by_stress = r->solver && r->solver->solve_free && ph_i_run_stress_is_less(r);
    return plan_of_constants(r, by_stress);
}

int ph_i_run_load_count(const ph_run *r)
{
    return solved_of(r, ph_i_run_plan(r));
}
