/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks step by step: cut, take the damaged nodes in, solve from the fields of the step
 * before, keep what came out. */
#include "effective/run.h"

#include <math.h>
#include <string.h>

void ph_damage_free(ph_damage **damage)
{
    if (!damage || !*damage) return;
    for (int i = 0; (*damage)->step && i < (*damage)->nsteps; i++) {
        ph_damage_step *s = &(*damage)->step[i];
        free(s->field);
        ph_i_fields_free(s->nfields, s->fields);
    }
    free((*damage)->step);
    free((*damage)->field);
    free((*damage)->error_bars);
    free((*damage)->pristine_error_bar);
    free(*damage);
    *damage = NULL;
}

/* ---- which cracks a step has ------------------------------------------------------------- */

static ph_status copy_crack(ph_cracks *to, const ph_cracks *from, ptrdiff_t i,
                            ph_error *err)
{
    const ph_crack *k = &from->crack[i];
    const double(*v)[3] = (const double(*)[3])(from->vertex + k->first);
    if (k->shape == PH_CRACK_LINE) return ph_cracks_add_line(to, k->count, v, err);
    if (k->shape == PH_CRACK_POLYGON) return ph_cracks_add_polygon(to, k->count, v, err);
    return ph_cracks_add_grown(to, from, i, PH_TIP_BOTH, 2.0 * k->semi_axes[0], err);
}

/* How many cracks have the density that is the nearest to the one asked for. */
static ptrdiff_t cracks_of_density(const ph_cracks *all, const ph_grid *g,
                                   ptrdiff_t first, double value)
{
    ph_cracks part = *all; /* borrowed, only counted */
    ptrdiff_t best = first;
    double nearest = INFINITY;
    for (part.count = first; part.count <= all->count; part.count++) {
        double off = fabs(ph_cracks_density(&part, g) - value);
        if (off >= nearest) continue;
        nearest = off;
        best = part.count;
    }
    return best;
}

static ph_status cracks_of_step(const ph_problem *p, int step, ph_cracks *out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    const ph_cracks *all = p->cracks;
    const ph_crack_sequence *q = p->sequence;
    ptrdiff_t count = all->count;
    if (q && q->kind == PH_SEQUENCE_DENSITY)
        count = cracks_of_density(all, &p->micro->grid, q->first, q->value[step]);
    for (ptrdiff_t i = 0; i < count; i++)
        if (q && q->kind == PH_SEQUENCE_GROWTH && q->grows[i])
            PH_TRY(ph_cracks_add_grown(out, all, i, q->tip, q->value[step], err));
        else
            PH_TRY(copy_crack(out, all, i, err));
out:
    return st;
}

static ph_status check_sequence(const ph_problem *p, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_crack_sequence *q = p->sequence;
    if (!q || q->kind == PH_SEQUENCE_NONE) return PH_OK;
    PH_CHECK(q->nsteps > 0 && q->value, PH_EINVAL, "a sequence has no steps");
    PH_CHECK(q->kind != PH_SEQUENCE_GROWTH || q->grows, PH_EINVAL,
             "a sequence says of no crack that it grows");
    PH_CHECK(q->first >= 0 && q->first <= p->cracks->count, PH_EINVAL,
             "a sequence begins with %td of %td cracks", q->first, p->cracks->count);
    for (int i = 0; i < q->nsteps; i++) {
        double least = i ? q->value[i - 1] : 0.0;
        PH_CHECK(q->value[i] >= least && isfinite(q->value[i]), PH_EINVAL,
                 "step %d of a sequence is %g after %g: bonds do not heal", i + 1,
                 q->value[i], least);
    }
out:
    return st;
}

/* ---- a step ------------------------------------------------------------------------------ */

static ph_status solve_step(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    r->result->nloads = 0;
    r->result->loads = r->result->solved = 0;
    r->result->converged = false;
    PH_TRY(ph_i_run_loads(r, err));
    PH_TRY(ph_i_run_stiffness(r, err));
    if (r->result->loads == ph_i_run_all_loads(r->result))
        ph_i_drop_nothing(&r->result->stiffness);
out:
    return st;
}

ptrdiff_t ph_i_run_node_of_rve(const ph_run *r, ptrdiff_t node)
{
    const ptrdiff_t *n = r->setting.box.n, *rve = r->result->grid.n;
    ptrdiff_t at[3] = {node / n[2] / n[1], node / n[2] % n[1], node % n[2]}, x = 0;
    for (int d = 0; d < 3; d++) {
        ptrdiff_t i = at[d] - r->setting.first[d];
        if (i < 0 || i >= rve[d]) return -1;
        x = x * rve[d] + i;
    }
    return x;
}

/* Too few bonds for a gradient; of springs, none at all. */
static bool is_mute(const ph_run *r, ptrdiff_t place)
{
    double inverse[6];
    if (r->classes) return ph_i_broken_damage(r->broken, place) >= 1.0;
    return !ph_i_broken_shape(r->broken, place, inverse);
}

static void count_damage(const ph_run *r, ph_damage_step *s)
{
    const ph_broken *br = r->broken;
    double *field = r->result->damage->field, sum = 0.0;
    s->broken_bonds = br->pairs;
    for (ptrdiff_t i = 0; i < br->damaged; i++) {
        ptrdiff_t x = ph_i_run_node_of_rve(r, br->node[i]);
        if (x < 0) continue;
        field[x] = ph_i_broken_damage(br, i);
        sum += field[x];
        s->damaged_nodes++;
        s->mute_nodes += is_mute(r, i);
    }
    s->mean_damage = sum / (double)ph_grid_cells(&r->result->grid);
}

/* E_n over that without cracks; 0 where there never was one (a plate between empty strips). */
static double share_left(const ph_result *res, int axis)
{
    const ph_sym4 *before = &res->damage->pristine;
    double E = ph_axial_modulus(before, axis);
    if (!(E > 1e-10 * ph_sym4_norm(before))) return 0.0;
    return ph_axial_modulus(&res->stiffness, axis) / E;
}

static void record(const ph_run *r, ph_damage_step *s)
{
    const ph_result *res = r->result;
    int axes = res->stiffness.n == 6 ? 3 : 2;
    bool whole = res->loads == ph_i_run_all_loads(res);
    s->stiffness = res->stiffness;
    s->anisotropy = whole ? ph_anisotropy_index(&res->stiffness) : (double)NAN;
    for (int n = 0; n < axes; n++)
        s->psi[n] = whole ? share_left(res, n) : (double)NAN;
    for (int i = 0; i < res->nloads; i++) {
        s->iterations += res->iterations[i];
        s->residual = fmax(s->residual, res->residual[i]);
    }
}

/* The result has the fields of the last step; those before go to their steps. */
static ph_status begin_fields(ph_run *r, ph_damage_step *s, ph_error *err)
{
    ph_status st = PH_OK;
    ph_result *res = r->result;
    ptrdiff_t cells = ph_grid_cells(&res->grid);
    r->keep_fields = r->problem->keep_fields;
    if (!r->keep_fields) return PH_OK;
    if (s != res->damage->step) {
        s[-1].nfields = res->nfields;
        s[-1].fields = res->fields;
        res->nfields = 0;
        res->fields = NULL;
    }
    PH_ALLOC(s->field, cells, "the damage field");
    memcpy(s->field, res->damage->field, sizeof *s->field * (size_t)cells);
out:
    return st;
}

ph_status ph_i_damage_step(ph_run *r, ph_damage_step *s, bool apart, ph_error *err)
{
    ph_status st = PH_OK;
    count_damage(r, s);
    PH_TRY(begin_fields(r, s, err));
    if (apart) {
        r->result->stiffness = (ph_sym4){.n = r->map->ns};
        r->result->loads = ph_i_run_all_loads(r->result);
        r->result->nloads = 0;
        r->result->converged = true;
    } else {
        double worst = r->result->stabilisation_energy;
        r->result->stabilisation_energy = 0.0;
        PH_TRY(solve_step(r, err));
        s->stabilisation_energy = r->result->stabilisation_energy;
        r->result->stabilisation_energy = fmax(worst, s->stabilisation_energy);
    }
    record(r, s);
out:
    return st;
}

ph_status ph_i_run_cut(ph_run *r, const ph_cracks *cracks, bool inside, bool note,
                       ph_error *err)
{
    ph_status st = PH_OK;
    ptrdiff_t missed = 0;
    PH_TRY(ph_i_cracks_cut(cracks, &r->result->grid, r->setting.first, inside, r->broken,
                           &missed, err));
    if (note && missed > 0)
        ph_i_note(
            r->result,
            "%td of %td cracks cut no bond and count for nothing: they are too short "
            "for the spacing of the nodes, or lie between them",
            missed, cracks->count);
out:
    return st;
}

ph_status ph_i_run_cut_last(ph_run *r, double *density, ptrdiff_t *count, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    const ph_crack_sequence *q = p->sequence;
    ph_cracks cracks = {0};
    bool steps = q && q->kind != PH_SEQUENCE_NONE && q->nsteps > 0 && q->value;
    *density = 0.0;
    *count = 0;
    if (!p->cracks || p->cracks->count == 0) return PH_OK;
    PH_TRY(cracks_of_step(p, steps ? q->nsteps - 1 : 0, &cracks, err));
    PH_TRY(ph_i_run_cut(r, &cracks, ph_i_run_whole_collar(r), true, err));
    *density = ph_cracks_density(&cracks, &r->result->grid);
    *count = cracks.count;
out:
    ph_cracks_free(&cracks);
    return st;
}

bool ph_i_run_whole_collar(const ph_run *r)
{
    return r->setting.source && r->problem->constraint.collar == PH_COLLAR_MATRIX;
}

static ph_status take_step(ph_run *r, int number, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_problem *p = r->problem;
    ph_damage_step *s = &r->result->damage->step[number];
    ph_cracks cracks = {0};
    bool last = number == r->result->damage->nsteps - 1;
    PH_TRY(cracks_of_step(p, number, &cracks, err));
    PH_TRY(ph_i_run_cut(r, &cracks, ph_i_run_whole_collar(r), last, err));
    PH_TRY(ph_i_run_rebuild(r, err));
    s->value = p->sequence && p->sequence->kind != PH_SEQUENCE_NONE
                   ? p->sequence->value[number]
                   : (double)NAN;
    s->density = ph_cracks_density(&cracks, &r->result->grid);
    s->surface = ph_cracks_surface(&cracks, &r->result->grid);
    PH_TRY(ph_i_damage_step(r, s, false, err));
out:
    ph_cracks_free(&cracks);
    return st;
}

ph_status ph_i_damage_begin(ph_run *r, ph_sequence_kind kind, int nsteps, ph_error *err)
{
    ph_status st = PH_OK;
    ph_damage *d = NULL;
    size_t n = (size_t)(r->op->layout.nd * r->op->layout.cells);
    PH_ALLOC(d, 1, "the damage");
    r->result->damage = d;
    d->kind = kind;
    d->nsteps = nsteps;
    PH_ALLOC(d->step, d->nsteps, "steps");
    PH_ALLOC(d->field, ph_grid_cells(&r->result->grid), "the damage field");
    r->keep_fields = false;
    PH_TRY(solve_step(r, err));
    d->pristine = r->result->stiffness;
    for (int a = 0; a < r->map->ns; a++)
        if (r->result->loads >> a & 1 && d->nsteps > 1)
            PH_DOUBLES(r->first[a], &r->meter, n, "a first guess");
out:
    return st;
}

ph_status ph_i_run_damage(ph_run *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_crack_sequence *q = r->problem->sequence;
    ph_sequence_kind kind = q ? q->kind : PH_SEQUENCE_NONE;
    PH_TRY(check_sequence(r->problem, err));
    PH_TRY(ph_i_damage_begin(r, kind, kind == PH_SEQUENCE_NONE ? 1 : q->nsteps, err));
    for (int i = 0; i < r->result->damage->nsteps; i++)
        PH_TRY(take_step(r, i, err));
    ph_i_damage_measures(r->result);
out:
    return st;
}
