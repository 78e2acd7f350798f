/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failure and loading: when bonds break, and the macro strain that breaks them. */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_TARGETS = 10000, MAX_STEPS = 100000 };

static const char *const rule_keys[] = {"fracture_energy", "criterion",
                                        "critical_stretch", "critical_bond_energy",
                                        "weibull"};
static const char *const criteria[] = {"critical_stretch", "bond_energy"};
static const char *const loading_keys[] = {
    "strain", "stress",      "stress_free",     "to",
    "times",  "rate",        "steps",           "window",
    "break",  "equilibrium", "stiffness_every", "pictures_every"};
static const char *const break_names[] = {"events", "together"};
static const char *const equilibrium_names[] = {"patches", "every_event"};

void ph_i_failure_free(ph_case *c)
{
    free(c->strengths);
    free(c->targets);
    free(c->target_times);
}

/* ---- failure ----------------------------------------------------------------------------- */

/* What the rule is made of: exactly one of three. */
static void read_strength(ph_i_reader *r, const ph_i_node *map, ph_failure_rule *k)
{
    const ph_i_node *energy = ph_i_get(map, "fracture_energy"),
                    *stretch = ph_i_get(map, "critical_stretch"),
                    *bond = ph_i_get(map, "critical_bond_energy"),
                    *criterion = ph_i_get(map, "criterion");
    int given = (energy != NULL) + (stretch != NULL) + (bond != NULL), i;
    if (given != 1) {
        ph_i_complain(r, map, PH_EINVAL,
                      "give one of fracture_energy, critical_stretch and "
                      "critical_bond_energy");
        return;
    }
    if (criterion && !energy)
        ph_i_complain(r, criterion, PH_EINVAL, "goes with fracture_energy");
    if (stretch)
        ph_i_read_number(r, stretch, 0, 1e6, "the critical stretch must be > 0",
                         &k->value);
    if (bond) {
        k->criterion = PH_BOND_ENERGY;
        ph_i_read_positive(r, bond, "the critical bond energy must be > 0", &k->value);
    }
    if (!energy) return;
    ph_i_read_positive(r, energy, "the fracture energy must be > 0", &k->fracture_energy);
    if (criterion &&
        (i = ph_i_read_name(r, criterion, (ph_i_names)PH_I_NAMES(criteria))) >= 0)
        k->criterion = i;
}

static void read_rule(ph_i_reader *r, const ph_i_node *node, ph_failure_rule *k)
{
    static const char rule[] =
        "must be unbreakable, or a map such as {fracture_energy: 100}";
    *k = (ph_failure_rule){.given = true, .value = NAN, .fracture_energy = NAN};
    if (ph_i_is_word(node, "unbreakable")) {
        k->criterion = PH_UNBREAKABLE;
        return;
    }
    if (!ph_i_read_map(r, node, rule)) return;
    ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(rule_keys), "a strength");
    read_strength(r, node, k);
    const ph_i_node *weibull = ph_i_get(node, "weibull");
    if (weibull)
        ph_i_read_number(r, weibull, nextafter(1, 0), 1e6,
                         "the Weibull shape must be a number >= 1 and below 1e6",
                         &k->weibull);
    if (k->criterion == PH_BOND_ENERGY && strcmp(r->c->model.kind, "bond") != 0)
        ph_i_complain(r, node, PH_EINVAL,
                      "a bond energy is that of a spring: take model bond, or "
                      "critical_stretch");
}

static ph_status read_failure(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case *c = r->c;
    const char **names = NULL;
    static const char rule[] = "must be a map of strengths by material";
    if (!ph_i_read_map(r, map, rule)) goto out;
    if (map->count == 0) {
        ph_i_complain(r, map, PH_EINVAL, "is empty: %s", rule);
        goto out;
    }
    PH_ALLOC(c->strengths, c->nmaterials, "strengths");
    c->failure.material = c->strengths;
    PH_ALLOC(names, c->nmaterials + 2, "names");
    for (int i = 0; i < c->nmaterials; i++)
        names[i] = c->materials[i].name;
    names[c->nmaterials] = "interphase";
    names[c->nmaterials + 1] = "agglomeration";
    ph_i_names known = {names, (size_t)c->nmaterials + 2};
    ph_i_check_keys(r, map, known, "failure");
    for (int i = 0; i < c->nmaterials; i++) {
        const ph_i_node *node = ph_i_get(map, names[i]);
        if (!node) continue;
        if (strcmp(names[i], "interphase") == 0 || strcmp(names[i], "agglomeration") == 0)
            ph_i_complain(r, node, PH_EINVAL,
                          "is a class of bonds and the name of a material: rename the "
                          "material");
        read_rule(r, node, &c->strengths[i]);
    }
    const ph_i_node *node = ph_i_get(map, "interphase");
    if (node) read_rule(r, node, &c->failure.interphase);
    node = ph_i_get(map, "agglomeration");
    if (node) read_rule(r, node, &c->failure.agglomeration);
out:
    free(names);
    return st;
}

/* ---- loading ----------------------------------------------------------------------------- */

static ph_status read_targets(ph_i_reader *r, const ph_i_node *node, ph_error *err)
{
    ph_status st = PH_OK;
    static const char rule[] =
        "must be a number that is not zero, or a list of 1 to 10000 numbers, each "
        "below 1e6 in size";
    bool list = node->kind == PH_I_LIST;
    size_t n = list ? node->count : 1;
    if (n < 1 || n > MAX_TARGETS) {
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
        return PH_OK;
    }
    PH_ALLOC(r->c->targets, n, "the targets of the loading");
    r->c->loading.to = r->c->targets;
    r->c->loading.ntargets = (int)n;
    double *to = r->c->targets;
    for (size_t i = 0; i < n; i++)
        if (!ph_i_read_number(r, list ? node->child[i] : node, -1e6, 1e6, rule, &to[i]))
            return PH_OK;
    if (n == 1 && to[0] == 0.0) ph_i_reject(r, node, PH_EUNPHYSICAL, "%s", rule);
out:
    return st;
}

/* When the targets are reached: their times, or the rate at which the load goes there. */
static ph_status read_times(ph_i_reader *r, const ph_i_node *times, const ph_i_node *rate,
                            ph_error *err)
{
    ph_status st = PH_OK;
    static const char rule[] =
        "must be a time >= 0 and below 1e60 for each target, none before the last";
    ph_loading *l = &r->c->loading;
    const int n = l->ntargets;
    double speed = 0.0, *t = NULL;
    if (times && rate) {
        ph_i_complain(r, rate, PH_EINVAL, "times are given too: one of both");
        return PH_OK;
    }
    if (n == 0) return PH_OK; /* said already */
    if (rate && !ph_i_read_positive(r, rate, "the load per time must be > 0", &speed))
        return PH_OK;
    bool list = times && times->kind == PH_I_LIST;
    if (times && (list ? times->count : 1) != (size_t)n) {
        ph_i_reject(r, times, PH_EINVAL, "%s: `to` has %d", rule, n);
        return PH_OK;
    }
    PH_ALLOC(r->c->target_times, n, "the times of the loading");
    t = r->c->target_times;
    for (int i = 0; i < n; i++) {
        double since = i ? t[i - 1] : 0.0, from = i ? l->to[i - 1] : 0.0;
        if (rate) {
            t[i] = since + fabs(l->to[i] - from) / speed;
            continue;
        }
        const ph_i_node *node = list ? times->child[i] : times;
        if (!ph_i_read_number(r, node, -1e60, 1e60, rule, &t[i])) return PH_OK;
        if (t[i] < since) ph_i_reject(r, node, PH_EINVAL, "%s", rule);
    }
    l->times = t;
out:
    return st;
}

static void read_direction(ph_i_reader *r, const ph_i_node *node)
{
    ph_loading *l = &r->c->loading;
    int ns = ph_strains(r->c->kinematics);
    double size = 0.0;
    const char *rule = ns == 3 ? "must be a list of 3 numbers: 11 22 12"
                               : "must be a list of 6 numbers: 11 22 33 23 13 12";
    if (!ph_i_read_numbers(r, node, (size_t)ns, false, rule, l->strain)) return;
    for (int i = 0; i < ns; i++)
        size = fmax(size, fabs(l->strain[i]));
    if (!(size > 0.0))
        ph_i_reject(r, node, PH_EUNPHYSICAL, "must not be zero");
    else if (!(size < 1e6))
        ph_i_reject(r, node, PH_EUNPHYSICAL, "must be below 1e6");
}

/* The direction of a macro stress instead of a strain. */
static void read_stress(ph_i_reader *r, const ph_i_node *stress, const ph_i_node *strain,
                        const ph_i_node *free)
{
    if (strain)
        ph_i_complain(r, stress, PH_EINVAL, "strain is given too: one of both");
    else
        read_direction(r, stress);
    if (free) ph_i_complain(r, free, PH_EINVAL, "goes with strain: a stress says it all");
    r->c->loading.by_stress = true;
}

/* Components that carry no stress; `strain` has been read. */
static void read_stress_free(ph_i_reader *r, const ph_i_node *node)
{
    static const char rule[] = "must be a list of components such as [11, 12]";
    ph_loading *l = &r->c->loading;
    if (!ph_i_read_list(r, node, 0, rule)) return;
    for (size_t i = 0; i < node->count; i++) {
        int k = ph_i_read_component(r, node->child[i]);
        if (k < 0) return;
        if ((l->stress_free >> k) & 1u)
            ph_i_reject(r, node->child[i], PH_EINVAL, "is named twice");
        if (l->strain[k] != 0.0)
            ph_i_reject(r, node->child[i], PH_EINVAL,
                        "its strain is given as %g: one of both (0 where it is free)",
                        l->strain[k]);
        l->stress_free |= 1u << k;
    }
}

static void read_count(ph_i_reader *r, const ph_i_node *map, const char *key,
                       int64_t least, const char *rule, int *out)
{
    const ph_i_node *node = ph_i_get(map, key);
    int64_t i;
    if (node && ph_i_read_integer(r, node, least, MAX_STEPS, rule, &i)) *out = (int)i;
}

static ph_status read_loading(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    ph_status st = PH_OK;
    ph_loading *l = &r->c->loading;
    int i;
    if (!ph_i_read_map(r, map, "must be a map such as {strain: [0, 1, 0], to: 0.02}"))
        return PH_OK;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(loading_keys), "loading");
    l->steps = 40;
    l->window = 0.01;
    const ph_i_node *stress = ph_i_get(map, "stress"),
                    *strain = stress
                                  ? ph_i_get(map, "strain")
                                  : ph_i_need(r, map, "strain", "must be a macro strain"),
                    *times = ph_i_get(map, "times"), *rate = ph_i_get(map, "rate"),
                    *free = ph_i_get(map, "stress_free"),
                    *to = ph_i_need(r, map, "to", "must be a number"), *node;
    if (strain) read_direction(r, strain);
    if (stress) read_stress(r, stress, strain, free);
    if (free && !stress) read_stress_free(r, free);
    if (to) PH_TRY(read_targets(r, to, err));
    if (times || rate) PH_TRY(read_times(r, times, rate, err));
    if (stress && !times && !rate)
        ph_i_complain(r, stress, PH_EINVAL,
                      "is a loading in time: give times, or a rate");
    read_count(r, map, "steps", 1, "must be an integer from 1 to 1e5", &l->steps);
    read_count(r, map, "stiffness_every", 0, "must be an integer from 0 to 1e5",
               &l->stiffness_every);
    read_count(r, map, "pictures_every", 0, "must be an integer from 0 to 1e5",
               &r->c->pictures_every);
    if ((node = ph_i_get(map, "window")))
        ph_i_read_number(r, node, 0, nextafter(1, 2), "must be > 0 and at most 1",
                         &l->window);
    if ((node = ph_i_get(map, "break")) &&
        (i = ph_i_read_name(r, node, (ph_i_names)PH_I_NAMES(break_names))) >= 0)
        l->together = i == 1;
    if ((node = ph_i_get(map, "equilibrium")) &&
        (i = ph_i_read_name(r, node, (ph_i_names)PH_I_NAMES(equilibrium_names))) >= 0)
        l->every_event = i == 1;
    if ((int64_t)l->ntargets * l->steps > MAX_STEPS)
        ph_i_complain(r, map, PH_EINVAL, "has more than 1e5 steps in all");
out:
    return st;
}

static void check_constraint(ph_i_reader *r, const ph_i_node *loading)
{
    const char *kind = r->c->constraint.kind;
    bool bond = strcmp(r->c->model.kind, "bond") == 0;
    if (strcmp(kind, "voigt") == 0 || strcmp(kind, "reuss") == 0)
        ph_i_complain(r, loading, PH_EINVAL,
                      "constraint %s solves no equations, a broken bond would unload "
                      "nothing: take periodic, linear_displacement or uniform_traction",
                      kind);
    if (bond && r->c->constraint.collar != PH_COLLAR_INSIDE)
        ph_i_complain(r, loading, PH_EINVAL,
                      "takes collar inside with model bond: with a frame around the RVE "
                      "its energies are not those of its bonds");
}

static void check_model(ph_i_reader *r, const ph_i_node *loading)
{
    const ph_case *c = r->c;
    if (strcmp(c->model.kind, "local") == 0 || c->model.points == PH_POINTS_STRESS)
        ph_i_complain(r, loading, PH_EINVAL,
                      "bonds break between nodes: take model nosb with points nodes (or "
                      "auto), or model bond");
    if (c->model.stabilisation == PH_STABILISE_SUBPOINT)
        ph_i_complain(r, loading, PH_EINVAL,
                      "sub-points know nothing of broken bonds: take stabilisation auto "
                      "or {spectral: x}");
    check_constraint(r, loading);
    if (c->sequence.kind != PH_SEQUENCE_NONE)
        ph_i_complain(r, loading, PH_EINVAL,
                      "does not go with a sequence of cracks: one of both");
    if (ph_case_relaxes(c) && !c->loading.by_stress && !c->loading.times &&
        !ph_i_get(loading, "times") && !ph_i_get(loading, "rate"))
        ph_i_complain(r, loading, PH_EINVAL,
                      "materials relax: say when, by times or a rate");
}

ph_status ph_i_read_failure(ph_i_reader *r, const ph_i_node *root, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case *c = r->c;
    const ph_i_node *failure = ph_i_get(root, "failure"),
                    *loading = ph_i_get(root, "loading");
    if (!failure && !loading) return PH_OK;
    if (!failure) {
        ph_i_complain(r, loading, PH_EINVAL,
                      "needs to know when bonds break: give failure");
        return PH_OK;
    }
    if (!loading)
        ph_i_complain(r, failure, PH_EINVAL,
                      "does nothing without a loading: give loading");
    if (r->materials.count == 0 || r->dimension == 0) return PH_OK;
    PH_TRY(read_failure(r, failure, err));
    c->failure.seed = c->seed;
    c->failure.realisation = c->realisation;
    if (!loading) return PH_OK;
    PH_TRY(read_loading(r, loading, err));
    check_model(r, loading);
out:
    return st;
}
