/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result document, section by section. */
#include <perihom/output.h>

#include "io/json.h"

#include <math.h>
#include <string.h>

/* What the sections share: the result, its case (or NULL), the document, the reasons. */
typedef struct draft_document {
    const ph_result *result;
    const ph_case *c;
    json_t *root, *reasons;
} draft_document;

static const char *const strain_names[2][6] = {{"11", "22", "12"},
                                               {"11", "22", "33", "23", "13", "12"}};

static const char *load_name(int n, int load)
{
    return strain_names[n == 6][load];
}

/* A new empty object, put into `parent` under `key`, which keeps it. */
static ph_status section(json_t *parent, const char *key, json_t **out, ph_error *err)
{
    json_t *made = json_object();
    *out = made;
    return ph_i_json_put(parent, key, made, err);
}

static ph_status put_text(json_t *obj, const char *key, const char *text, ph_error *err)
{
    return ph_i_json_put(obj, key, ph_i_json_text(text), err);
}

static ph_status put_real(draft_document *d, json_t *obj, const char *path,
                          const char *key, double x, ph_error *err)
{
    const char *why = d->result->unchecked ? d->result->unchecked : "not computed";
    return ph_i_json_put_number(obj, path, key, x, d->reasons, why, err);
}

static ph_status put_reason(draft_document *d, const char *path, const char *why,
                            ph_error *err)
{
    return put_text(d->reasons, path, why, err);
}

/* obj[key]: the tensor in Voigt notation; `path` names it among the reasons. */
static ph_status put_matrix(draft_document *d, json_t *obj, const char *path,
                            const char *key, const ph_sym4 *c, bool stiffness,
                            ph_error *err)
{
    ph_status st = PH_OK;
    double voigt[36];
    json_t *rows = NULL;
    bool finite = true;
    ph_sym4_to_voigt(c, stiffness, voigt);
    for (int k = 0; k < c->n * c->n; k++)
        finite = finite && isfinite(voigt[k]);
    PH_TRY(ph_i_json_matrix(c->n, voigt, &rows, err));
    PH_TRY(ph_i_json_put(obj, key, rows, err));
    if (!finite) PH_TRY(put_reason(d, path, "not finite", err));
out:
    return st;
}

/* ---- head: title, units, case, seed ---- */

static ph_status put_case(draft_document *d, ph_error *err)
{
    json_t *map = NULL;
    ph_status st = ph_i_case_json(d->c, &map, err);
    return st == PH_OK ? ph_i_json_put(d->root, "case", map, err) : st;
}

/* JSON integers are signed here; a larger seed is written as text. */
static json_t *seed_value(uint64_t seed)
{
    char text[32];
    if (seed <= INT64_MAX) return json_integer((json_int_t)seed);
    snprintf(text, sizeof text, "%llu", (unsigned long long)seed);
    return json_string(text);
}

static ph_status put_head(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_case *c = d->c;
    json_t *units;
    PH_TRY(put_text(d->root, "schema", "perihom.result/1", err));
    PH_TRY(put_text(d->root, "title", c ? c->title : "", err));
    PH_TRY(section(d->root, "units", &units, err));
    PH_TRY(put_text(units, "length", c ? c->unit_length : NULL, err));
    PH_TRY(put_text(units, "stress", c ? c->unit_stress : NULL, err));
    PH_TRY(put_text(units, "time", c ? c->unit_time : NULL, err));
    if (c) {
        PH_TRY(put_case(d, err));
        PH_TRY(ph_i_json_put(d->root, "seed", seed_value(c->seed), err));
        goto out;
    }
    PH_TRY(ph_i_json_put(d->root, "case", json_null(), err));
    PH_TRY(ph_i_json_put(d->root, "seed", json_null(), err));
    for (int i = 0; i < 3; i++) {
        static const char *const missing[] = {"units", "case", "seed"};
        PH_TRY(put_reason(d, missing[i], "solved without a case file", err));
    }
out:
    return st;
}

/* ---- what was solved ---- */

static ph_status put_fractions(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list;
    PH_TRY(section(d->root, "fractions", &list, err));
    for (int i = 0; i < d->result->nmaterials; i++) {
        json_t *name = ph_i_json_text(d->result->names[i]);
        PH_CHECK(name, PH_ENOMEM, "no memory for the fractions");
        /* materials of one name are one line */
        double before = json_number_value(json_object_get(list, json_string_value(name)));
        st = ph_i_json_put(list, json_string_value(name),
                           ph_i_json_number(before + d->result->fractions[i]), err);
        json_decref(name);
        if (st != PH_OK) goto out;
    }
out:
    return st;
}

static ph_status put_grid(draft_document *d, ph_error *err)
{
    static const char *const kinematics[] = {"space", "generalised_strain", "strain",
                                             "stress"};
    ph_status st = PH_OK;
    const ph_grid *g = &d->result->grid;
    int axes = g->kinematics == PH_SPACE ? 3 : 2;
    json_t *grid, *nodes = json_array(), *size = json_array();
    PH_CHECK(nodes && size, PH_ENOMEM, "no memory for the grid");
    PH_TRY(section(d->root, "grid", &grid, err));
    PH_TRY(ph_i_json_put(grid, "dimension", json_integer(axes), err));
    PH_TRY(put_text(grid, "kinematics", kinematics[g->kinematics], err));
    for (int a = 0; a < axes; a++) {
        PH_TRY(ph_i_json_add(nodes, json_integer((json_int_t)g->n[a]), err));
        PH_TRY(ph_i_json_add(size, ph_i_json_number(g->size[a]), err));
    }
    PH_TRY(ph_i_json_put(grid, "nodes", json_incref(nodes), err));
    PH_TRY(ph_i_json_put(grid, "size", json_incref(size), err));
out:
    json_decref(nodes);
    json_decref(size);
    return st;
}

static ph_status put_stabilisation(draft_document *d, json_t *model, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_result *r = d->result;
    json_t *kind;
    if (r->stabilisation == PH_STABILISE_AUTO)
        return put_text(model, "stabilisation", "auto", err);
    if (r->stabilisation == PH_STABILISE_NONE)
        return put_text(model, "stabilisation", "none", err);
    PH_TRY(section(model, "stabilisation", &kind, err));
    const char *name =
        r->stabilisation == PH_STABILISE_SPECTRAL ? "spectral" : "subpoint";
    PH_TRY(put_real(d, kind, "model.stabilisation", name, r->stabilisation_value, err));
out:
    return st;
}

static ph_status put_model(draft_document *d, ph_error *err)
{
    static const char *const points[] = {"auto", "nodes", "stress"};
    ph_status st = PH_OK;
    const ph_result *r = d->result;
    json_t *model;
    PH_TRY(section(d->root, "model", &model, err));
    PH_TRY(put_text(model, "kind", r->model, err));
    PH_TRY(put_text(model, "points", points[r->points], err));
    PH_TRY(put_real(d, model, "model", "horizon", r->horizon, err));
    PH_TRY(put_stabilisation(d, model, err));
    PH_TRY(put_text(model, "interface",
                    r->interface == PH_INTERFACE_COMPOSITE ? "composite" : "node_centre",
                    err));
    PH_TRY(put_text(model, "constraint", r->constraint, err));
out:
    return st;
}

/* ---- the effective tensor ---- */

/* The load cases that were not solved, "23 13"; empty if none is missing. */
static void missing_loads(const ph_result *r, char *text, size_t size)
{
    size_t used = 0;
    text[0] = 0;
    for (int a = 0; a < r->stiffness.n && used < size; a++)
        if (!(r->loads >> a & 1u))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " " : "",
                                     load_name(r->stiffness.n, a));
}

static ph_status put_engineering(draft_document *d, json_t *effective,
                                 const ph_engineering *e, const char *why, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list;
    char key[8];
    const char *path = "effective.engineering";
    int axes = d->result->stiffness.n == 6 ? 3 : 2;
    PH_TRY(section(effective, "engineering", &list, err));
    for (int i = 0; i < axes; i++) {
        snprintf(key, sizeof key, "E%d", i + 1);
        PH_TRY(ph_i_json_put_number(list, path, key, e->E[i], d->reasons, why, err));
    }
    for (int k = 0; k < axes * axes; k++) {
        int i = k / axes, j = k % axes;
        if (i == j) continue;
        snprintf(key, sizeof key, "nu%d%d", i + 1, j + 1);
        PH_TRY(ph_i_json_put_number(list, path, key, e->nu[i][j], d->reasons, why, err));
    }
    if (axes == 3) {
        PH_TRY(ph_i_json_put_number(list, path, "G23", e->G23, d->reasons, why, err));
        PH_TRY(ph_i_json_put_number(list, path, "G13", e->G13, d->reasons, why, err));
    }
    PH_TRY(ph_i_json_put_number(list, path, "G12", e->G12, d->reasons, why, err));
out:
    return st;
}

static ph_status put_isotropic(draft_document *d, json_t *effective,
                               const ph_isotropic *iso, const char *why, ph_error *err)
{
    const struct {
        const char *key;
        double x;
    } entry[] = {{"E", iso->E},
                 {"nu", iso->nu},
                 {"K", iso->K},
                 {"G", iso->G},
                 {"distance", iso->distance}};
    ph_status st = PH_OK;
    json_t *list;
    PH_TRY(section(effective, "isotropic", &list, err));
    for (size_t i = 0; i < sizeof entry / sizeof *entry; i++)
        PH_TRY(ph_i_json_put_number(list, "effective.isotropic", entry[i].key, entry[i].x,
                                    d->reasons, why, err));
out:
    return st;
}

static ph_engineering no_engineering(void)
{
    ph_engineering e = {.G23 = NAN, .G13 = NAN, .G12 = NAN};
    for (int k = 0; k < 9; k++) {
        e.E[k / 3] = NAN;
        e.nu[k / 3][k % 3] = NAN;
    }
    return e;
}

static ph_status put_stiffness(draft_document *d, json_t *effective, const char *missing,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c = d->result->stiffness;
    char why[128];
    for (int i = 0; i < c.n; i++)
        for (int j = 0; j < c.n; j++) {
            if (d->result->loads >> j & 1u) continue;
            bool mirrored =
                d->result->loads >> i & 1u; /* the column of the other index */
            c.m[i][j] = mirrored ? c.m[j][i] : (double)NAN;
        }
    PH_TRY(put_matrix(d, effective, "effective.stiffness", "stiffness", &c, true, err));
    if (!missing[0]) goto out;
    snprintf(why, sizeof why, "load cases %s were not solved", missing);
    PH_TRY(put_reason(d, "effective.stiffness", why, err));
out:
    return st;
}

/* Columns of the compliance from mean stresses. */
static ph_status put_columns(draft_document *d, json_t *effective, ph_error *err)
{
    ph_status st = PH_OK;
    ph_sym4 c = d->result->compliance;
    for (int k = 0; k < 36; k++)
        if (!(d->result->stresses >> (k % 6) & 1u)) c.m[k / 6][k % 6] = NAN;
    PH_TRY(
        put_matrix(d, effective, "effective.compliance", "compliance", &c, false, err));
    PH_TRY(put_reason(d, "effective.compliance",
                      "no constant that was asked for needs the other columns", err));
out:
    return st;
}

/* A mean stress along an axis gives its modulus and Poisson ratios, a shear stress its own. */
static ph_engineering engineering_of_columns(const ph_result *r)
{
    const ph_sym4 *s = &r->compliance;
    const int axes = s->n == 3 ? 2 : 3;
    ph_engineering e = no_engineering();
    double *const shear[3] = {&e.G23, &e.G13, &e.G12};
    for (int i = 0; i < s->n; i++) {
        if (!(r->stresses >> i & 1u) || !(s->m[i][i] > 0.0)) continue;
        if (i >= axes) *shear[s->n == 3 ? 2 : i - 3] = 0.5 / s->m[i][i];
        if (i < axes) e.E[i] = 1.0 / s->m[i][i];
        for (int j = 0; i < axes && j < axes; j++)
            if (i != j) e.nu[i][j] = -s->m[j][i] / s->m[i][i];
    }
    return e;
}

/* Compliance, constants and nearest isotropic tensor need every load case; the first two
 * also a stiffness that has an inverse. */
static ph_status put_derived(draft_document *d, json_t *effective, const char *missing,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const ph_sym4 *c = &d->result->stiffness;
    ph_sym4 inverse = *c;
    ph_engineering e = no_engineering();
    ph_isotropic iso = {NAN, NAN, NAN, NAN, NAN};
    char why[600] = "not finite";
    bool ok = !missing[0];
    if (ok) {
        ph_error reason = PH_ERROR_INIT;
        iso = ph_nearest_isotropic(c, d->result->grid.kinematics);
        ok = ph_sym4_inverse(c, &inverse, &reason) == PH_OK &&
             ph_engineering_constants(c, &e, &reason) == PH_OK;
        if (!ok) snprintf(why, sizeof why, "no compliance: %s", reason.msg);
    } else {
        snprintf(why, sizeof why, "load cases %s were not solved", missing);
    }
    if (!ok)
        e = d->result->stresses ? engineering_of_columns(d->result) : no_engineering();
    if (ok) {
        PH_TRY(put_matrix(d, effective, "effective.compliance", "compliance", &inverse,
                          false, err));
    } else if (d->result->stresses) {
        PH_TRY(put_columns(d, effective, err));
    } else {
        PH_TRY(ph_i_json_put(effective, "compliance", json_null(), err));
        PH_TRY(put_reason(d, "effective.compliance", why, err));
    }
    PH_TRY(put_engineering(d, effective, &e, why, err));
    PH_TRY(put_isotropic(d, effective, &iso, why, err));
out:
    return st;
}

/* The two estimates of model bond, as they came: not made symmetric. */
static ph_status put_bond(draft_document *d, json_t *effective, const char *missing,
                          ph_error *err)
{
    ph_status st = PH_OK;
    const ph_bond_report *b = &d->result->bond;
    json_t *bond;
    const char *path = "effective.bond.reactions";
    ph_sym4 virial = b->virial, reactions = b->reactions;
    virial.n = reactions.n = d->result->stiffness.n;
    for (int i = 0; i < virial.n; i++)
        for (int j = 0; j < virial.n; j++) {
            bool solved = d->result->loads >> j & 1u;
            if (!solved) virial.m[i][j] = NAN;
            if (!solved || !b->has_reactions) reactions.m[i][j] = NAN;
        }
    PH_TRY(section(effective, "bond", &bond, err));
    PH_TRY(put_text(bond, "micromodulus", b->micromodulus, err));
    if (isfinite(b->power))
        PH_TRY(put_real(d, bond, "effective.bond", "power", b->power, err));
    PH_TRY(put_text(bond, "calibration", b->calibration, err));
    PH_TRY(put_real(d, bond, "effective.bond", "factor", b->lattice.factor, err));
    PH_TRY(put_real(d, bond, "effective.bond", "nu", b->lattice.nu, err));
    PH_TRY(put_real(d, bond, "effective.bond", "zener", b->lattice.zener, err));
    PH_TRY(ph_i_json_put_number(
        bond, "effective.bond", "kappa", b->kappa, d->reasons,
        "not given: interphase bonds have the harmonic mean of the two moduli", err));
    PH_TRY(put_matrix(d, bond, "effective.bond.virial", "virial", &virial, true, err));
    PH_TRY(put_matrix(d, bond, path, "reactions", &reactions, true, err));
    if (missing[0])
        PH_TRY(put_reason(d, "effective.bond.virial", "load cases were not solved", err));
    if (missing[0] || !b->has_reactions)
        PH_TRY(put_reason(d, path,
                          b->has_reactions
                              ? "load cases were not solved"
                              : "only linear_displacement with its collar outside has "
                                "reactions: elsewhere the RVE has no faces",
                          err));
out:
    return st;
}

/* What the case asks for, each by itself. */
static ph_status put_constants(draft_document *d, json_t *effective, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list;
    if (!d->c || d->c->nconstants == 0) return PH_OK;
    PH_TRY(section(effective, "constants", &list, err));
    for (int i = 0; i < d->c->nconstants; i++) {
        const ph_quantity *q = &d->c->constants[i];
        ph_error why = PH_ERROR_INIT;
        double x = (double)NAN;
        ph_quantity_value(q, d->result, &x, &why);
        PH_TRY(ph_i_json_put_number(list, "effective.constants", q->name, x, d->reasons,
                                    why.msg, err));
    }
out:
    return st;
}

static ph_status put_effective(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *effective;
    char missing[32];
    missing_loads(d->result, missing, sizeof missing);
    PH_TRY(section(d->root, "effective", &effective, err));
    PH_TRY(put_text(effective, "notation",
                    d->result->stiffness.n == 6
                        ? "voigt 11 22 33 23 13 12, engineering shear"
                        : "voigt 11 22 12, engineering shear",
                    err));
    PH_TRY(put_stiffness(d, effective, missing, err));
    if (d->result->bond.present) PH_TRY(put_bond(d, effective, missing, err));
    PH_TRY(put_derived(d, effective, missing, err));
    PH_TRY(put_constants(d, effective, err));
    if (d->result->damage)
        PH_TRY(ph_i_json_damage(d->result, effective, d->reasons, err));
    if (d->result->failure)
        PH_TRY(ph_i_json_failure(d->result->failure, effective, d->reasons, err));
out:
    return st;
}

static ph_status put_bounds(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *bounds, *voigt, *reuss;
    PH_TRY(section(d->root, "bounds", &bounds, err));
    PH_TRY(section(bounds, "voigt", &voigt, err));
    PH_TRY(put_matrix(d, voigt, "bounds.voigt.stiffness", "stiffness", &d->result->voigt,
                      true, err));
    PH_TRY(section(bounds, "reuss", &reuss, err));
    ph_sym4 lower = d->result->reuss;
    if (d->result->reuss_is_zero) {
        memset(lower.m, 0, sizeof lower.m);
        PH_TRY(put_text(reuss, "note", "zero: a phase is void", err));
    }
    PH_TRY(
        put_matrix(d, reuss, "bounds.reuss.stiffness", "stiffness", &lower, true, err));
out:
    return st;
}

/* ---- how it was solved, what it is worth, what it cost ---- */

static ph_status put_solver(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_result *r = d->result;
    json_t *solver, *loads = json_array(), *iterations = json_array();
    json_t *residual = json_array();
    PH_CHECK(loads && iterations && residual, PH_ENOMEM, "no memory for the solver");
    PH_TRY(section(d->root, "solver", &solver, err));
    PH_TRY(put_text(solver, "kind", r->solver, err));
    PH_TRY(put_text(solver, "precision", r->precision, err));
    PH_TRY(put_text(solver, "route", r->route, err));
    for (int a = 0; a < r->stiffness.n; a++)
        if (r->solved >> a & 1u)
            PH_TRY(
                ph_i_json_add(loads, ph_i_json_text(load_name(r->stiffness.n, a)), err));
    for (int a = 0; a < r->compliance.n; a++) {
        char name[24];
        snprintf(name, sizeof name, "stress %s", load_name(r->compliance.n, a));
        if (r->solved_stresses >> a & 1u)
            PH_TRY(ph_i_json_add(loads, ph_i_json_text(name), err));
    }
    for (int i = 0; i < r->nloads && i < 6; i++) {
        PH_TRY(ph_i_json_add(iterations, json_integer(r->iterations[i]), err));
        PH_TRY(ph_i_json_add(residual, ph_i_json_number(r->residual[i]), err));
        if (!isfinite(r->residual[i]))
            PH_TRY(put_reason(
                d, "solver.residual",
                r->unchecked ? r->unchecked : "not finite: the solver broke down", err));
    }
    PH_TRY(ph_i_json_put(solver, "loads", json_incref(loads), err));
    PH_TRY(ph_i_json_put(solver, "iterations", json_incref(iterations), err));
    PH_TRY(ph_i_json_put(solver, "residual", json_incref(residual), err));
    PH_TRY(ph_i_json_put(solver, "converged", json_boolean(r->converged), err));
out:
    json_decref(loads);
    json_decref(iterations);
    json_decref(residual);
    return st;
}

static ph_status put_work(json_t *to, const ph_work *w, ph_error *err)
{
    ph_status st = PH_OK;
    const struct {
        const char *name;
        json_int_t value;
    } count[] = {{"loads", w->loads},
                 {"iterations", w->iterations},
                 {"applications", w->applications},
                 {"ffts", w->ffts},
                 {"collar_nodes", w->collar},
                 {"history_variables", (json_int_t)w->history_variables},
                 {"bond_bits", (json_int_t)w->bond_bits},
                 {"peak_bytes", (json_int_t)w->peak_bytes}};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++)
        PH_TRY(ph_i_json_put(to, count[i].name, json_integer(count[i].value), err));
out:
    return st;
}

static ph_status put_worth_and_cost(draft_document *d, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_result *r = d->result;
    json_t *quality, *cost;
    PH_TRY(section(d->root, "quality", &quality, err));
    PH_TRY(put_real(d, quality, "quality", "hill_mandel", r->hill_mandel, err));
    PH_TRY(put_real(d, quality, "quality", "stabilisation_energy",
                    r->stabilisation_energy, err));
    PH_TRY(ph_i_json_error_bar(r->error_bar, quality, d->reasons, err));
    PH_TRY(section(d->root, "cost", &cost, err));
    if (r->error_bar) PH_TRY(ph_i_json_error_cost(r->error_bar, cost, err));
    PH_TRY(put_real(d, cost, "cost", "seconds", r->seconds, err));
    PH_TRY(put_real(d, cost, "cost", "seconds_solve", r->seconds_solve, err));
    PH_TRY(ph_i_json_put(cost, "threads", json_integer(r->threads), err));
    PH_TRY(put_work(cost, &r->work, err));
out:
    return st;
}

static ph_status put_tail(draft_document *d, const char *command, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *made = NULL, *notes = json_array();
    PH_CHECK(notes, PH_ENOMEM, "no memory for the notes");
    PH_TRY(ph_i_json_provenance(command, &made, err));
    PH_TRY(ph_i_json_put(d->root, "provenance", json_incref(made), err));
    for (int i = 0; i < d->result->nnotes && i < PH_MAX_NOTES; i++)
        PH_TRY(ph_i_json_add(notes, ph_i_json_text(d->result->notes[i]), err));
    PH_TRY(ph_i_json_put(d->root, "notes", json_incref(notes), err));
    PH_TRY(ph_i_json_put(d->root, "reasons", json_incref(d->reasons), err));
out:
    json_decref(made);
    json_decref(notes);
    return st;
}

ph_status ph_i_result_document(const ph_result *result, const ph_case *c,
                               const char *command, json_t **document, ph_error *err)
{
    ph_status st = PH_OK;
    draft_document d = {result, c, NULL, NULL};
    PH_CHECK(result, PH_EINVAL, "no result to write");
    PH_CHECK(result->stiffness.n == 3 || result->stiffness.n == 6, PH_EINVAL,
             "the stiffness has n = %d, not 3 or 6", result->stiffness.n);
    d.root = json_object();
    d.reasons = json_object();
    PH_CHECK(d.root && d.reasons, PH_ENOMEM, "no memory for the result document");
    PH_TRY(put_head(&d, err));
    PH_TRY(put_fractions(&d, err));
    PH_TRY(put_grid(&d, err));
    PH_TRY(put_effective(&d, err));
    PH_TRY(put_bounds(&d, err));
    PH_TRY(put_model(&d, err));
    PH_TRY(put_solver(&d, err));
    PH_TRY(put_worth_and_cost(&d, err));
    PH_TRY(put_tail(&d, command, err));
    *document = json_incref(d.root);
out:
    json_decref(d.root);
    json_decref(d.reasons);
    return st;
}

ph_status ph_result_to_json(const ph_result *result, const ph_case *c,
                            const char *command, char **json, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *document = NULL;
    PH_CHECK(json, PH_EINVAL, "no place for the document");
    PH_TRY(ph_i_result_document(result, c, command, &document, err));
    PH_TRY(ph_i_json_dump(document, json, err));
out:
    json_decref(document);
    return st;
}
