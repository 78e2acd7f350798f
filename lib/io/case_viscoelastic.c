/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section viscoelastic of a case file. */
#include "io/case_internal.h"

#include <math.h>
#include <string.h>

enum { MAX_POINTS = 1000000, MAX_TERMS = 1000 };

static const char *const section_keys[] = {
    "route", "tolerance", "terms", "compression", "times", "frequencies", "history"};
static const char *const history_keys[] = {"control", "component", "points", "ramp",
                                           "cycle"};
static const char *const ramp_keys[] = {"value", "rise", "hold", "rest"};
static const char *const cycle_keys[] = {"amplitude", "mean", "frequency", "cycles",
                                         "points"};
static const char *const controls[] = {"strain", "stress"};

static const char list_rule[] = "must be a list of increasing numbers > 0";

static ph_status read_increasing(ph_i_reader *r, const ph_i_node *node, int *count,
                                 double **out, ph_error *err)
{
    ph_status st = PH_OK;
    if (!ph_i_read_list(r, node, 0, list_rule)) goto out;
    if (node->count == 0 || node->count > MAX_POINTS) {
        ph_i_complain(r, node, PH_EINVAL, "%zu numbers: 1 to %d are admissible",
                      node->count, MAX_POINTS);
        goto out;
    }
    PH_ALLOC(*out, node->count, "a list of numbers");
    for (size_t i = 0; i < node->count; i++) {
        const ph_i_node *x = node->child[i];
        if (!ph_i_read_positive(r, x, "must be a number > 0", &(*out)[i])) goto out;
        if (i > 0 && (*out)[i] <= (*out)[i - 1]) {
            ph_i_reject(r, x, PH_EINVAL, "%s, this one follows %g", list_rule,
                        (*out)[i - 1]);
            goto out;
        }
    }
    *count = (int)node->count;
out:
    return st;
}

/* ---- history ---- */

int ph_i_read_component(ph_i_reader *r, const ph_i_node *node)
{
    int i = ph_i_read_name(r, node, ph_i_component_names);
    if (i < 0 || ph_strains(r->c->kinematics) == 6) return i;
    if (i == 0 || i == 1) return i;
    if (i == 5) return 2;
    ph_i_reject(r, node, PH_EINVAL, "in this plane it must be 11, 22 or 12");
    return -1;
}

/* One row [time, value] or [time, all components]. */
static bool read_point(ph_i_reader *r, const ph_i_node *node, int component,
                       ph_history *h, size_t p)
{
    double x[7];
    size_t all = (size_t)h->n + 1;
    bool whole = node->kind == PH_I_LIST && node->count == all;
    char rule[160];
    snprintf(rule, sizeof rule,
             "must be [time, value] beside `component`, or [time, %d "
             "components]",
             h->n);
    if (!ph_i_read_numbers(r, node, whole ? all : 2, false, rule, x)) return false;
    if (!whole && component < 0) {
        ph_i_complain(r, node, PH_EINVAL, "component must say which one this is");
        return false;
    }
    h->time[p] = x[0];
    if (whole)
        memcpy(h->value[p], x + 1, (size_t)h->n * sizeof *x);
    else
        h->value[p][component] = x[1];
    if (p > 0 && x[0] < h->time[p - 1]) {
        ph_i_complain(r, node, PH_EINVAL, "time %g comes after %g", x[0], h->time[p - 1]);
        return false;
    }
    return true;
}

static ph_status read_points(ph_i_reader *r, const ph_i_node *node, int component,
                             bool stress, ph_history **out, ph_error *err)
{
    static const char rule[] = "must be a list of points [time, value]";
    ph_status st = PH_OK;
    ph_error why = PH_ERROR_INIT;
    if (!ph_i_read_list(r, node, 0, rule)) goto out;
    if (node->count == 0 || node->count > MAX_POINTS) {
        ph_i_complain(r, node, PH_EINVAL, "%zu points: 1 to %d are admissible",
                      node->count, MAX_POINTS);
        goto out;
    }
    PH_TRY(
        ph_history_new(ph_strains(r->c->kinematics), (int)node->count, stress, out, err));
    bool good = true;
    for (size_t p = 0; p < node->count; p++)
        good &= read_point(r, node->child[p], component, *out, p);
    if (good && ph_history_validate(*out, &why) != PH_OK)
        ph_i_complain(r, node, PH_EINVAL, "%s", why.msg);
out:
    return st;
}

static bool optional_number(ph_i_reader *r, const ph_i_node *map, const char *key,
                            double lo, const char *rule, double *out)
{
    const ph_i_node *node = ph_i_get(map, key);
    return !node || ph_i_read_number(r, node, lo, 1e60, rule, out);
}

static bool needed_number(ph_i_reader *r, const ph_i_node *map, const char *key,
                          double lo, const char *rule, double *out)
{
    const ph_i_node *node = ph_i_need(r, map, key, rule);
    return node && ph_i_read_number(r, node, lo, 1e60, rule, out);
}

static ph_status read_ramp(ph_i_reader *r, const ph_i_node *map, int component,
                           bool stress, ph_history **out, ph_error *err)
{
    static const char rule[] = "must be {value: 0.01, rise: 1, hold: 10, rest: 10}";
    ph_status st = PH_OK;
    double value, rise = 0, hold, rest = 0;
    if (!ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(ramp_keys), "ramp");
    bool good = needed_number(r, map, "value", -1e60, "must be a number", &value);
    good &= needed_number(r, map, "hold", 0, "must be a time > 0", &hold);
    good &= optional_number(r, map, "rise", 0,
                            "must be a time > 0 (a jump where it is not given)", &rise);
    good &= optional_number(
        r, map, "rest", 0, "must be a time > 0 (no return where it is not given)", &rest);
    if (good)
        PH_TRY(ph_history_ramp(ph_strains(r->c->kinematics), component, stress, value,
                               rise, hold, rest, out, err));
out:
    return st;
}

static ph_status read_cycle(ph_i_reader *r, const ph_i_node *map, int component,
                            bool stress, ph_history **out, ph_error *err)
{
    static const char rule[] = "must be {amplitude: 0.01, frequency: 6.28, cycles: 3}";
    ph_status st = PH_OK;
    double amplitude, mean = 0, omega;
    int64_t cycles = 3, points = 128;
    const ph_i_node *node;
    if (!ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(cycle_keys), "cycle");
    bool good = needed_number(r, map, "amplitude", -1e60, "must be a number", &amplitude);
    good &= needed_number(r, map, "frequency", 0,
                          "must be an angular frequency > 0 (radians per time)", &omega);
    good &= optional_number(r, map, "mean", -1e60, "must be a number", &mean);
    if ((node = ph_i_get(map, "cycles")))
        good &= ph_i_read_integer(r, node, 1, 10000, "must be an integer from 1 to 1e4",
                                  &cycles);
    if ((node = ph_i_get(map, "points")))
        good &= ph_i_read_integer(r, node, 4, 1000,
                                  "must be an integer from 4 to 1000: points a cycle",
                                  &points);
    if (good)
        PH_TRY(ph_history_cycle(
            ph_strains(r->c->kinematics), component, stress,
            &(ph_cycle){mean, amplitude, omega, (int)cycles, (int)points}, out, err));
out:
    return st;
}

static ph_status read_history(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    static const char rule[] =
        "must be a map such as {component: 11, ramp: {value: 0.01, hold: 10}}";
    static const char which[] = "must have one of points, ramp and cycle";
    ph_status st = PH_OK;
    ph_history **out = &r->c->viscoelastic.history;
    int control = 0, component = -1;
    const ph_i_node *node;
    if (!ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(history_keys), "history");
    if ((node = ph_i_get(map, "control")) &&
        (control = ph_i_read_name(r, node, (ph_i_names)PH_I_NAMES(controls))) < 0)
        goto out;
    if ((node = ph_i_get(map, "component")) &&
        (component = ph_i_read_component(r, node)) < 0)
        goto out;
    const ph_i_node *points = ph_i_get(map, "points"), *ramp = ph_i_get(map, "ramp"),
                    *cycle = ph_i_get(map, "cycle");
    if (!points + !ramp + !cycle != 2) {
        ph_i_complain(r, map, PH_EINVAL, "%s", which);
        goto out;
    }
    if (!points && component < 0) {
        ph_i_missing(r, map, "component", "must be 11, 22, 33, 23, 13 or 12");
        goto out;
    }
    if (points)
        PH_TRY(read_points(r, points, component, control == 1, out, err));
    else if (ramp)
        PH_TRY(read_ramp(r, ramp, component, control == 1, out, err));
    else
        PH_TRY(read_cycle(r, cycle, component, control == 1, out, err));
out:
    return st;
}

/* ---- the section ---- */

static void read_compression(ph_i_reader *r, const ph_i_node *map,
                             ph_case_viscoelastic *out)
{
    const ph_i_node *terms = ph_i_get(map, "terms"),
                    *compression = ph_i_get(map, "compression");
    int64_t count = 0;
    if (terms && compression)
        ph_i_complain(r, compression, PH_EINVAL,
                      "terms is given too: one of both is admissible");
    if (terms)
        ph_i_read_integer(r, terms, 1, MAX_TERMS,
                          "must be an integer from 1 to 1000: terms to compress to",
                          &count);
    if (compression)
        ph_i_read_number(r, compression, 0, 1,
                         "the relative error to compress to must be > 0 and < 1",
                         &out->compression);
    out->terms = (int)count;
}

/* Below 1e-12 the error is that of the arithmetic, which no route can state. */
static void read_tolerance(ph_i_reader *r, const ph_i_node *node, double *out)
{
    static const char rule[] = "the relative error must be at least 1e-12 and < 1";
    if (ph_i_read_number(r, node, 0, 1, rule, out) && *out < 1e-12)
        ph_i_reject(r, node, PH_EINVAL, "%s", rule);
}

/* What the route cannot do is refused, what it does not look at is said. */
static void check_route(ph_i_reader *r, const ph_i_node *map)
{
    static const struct {
        const char *key, *routes; /* routes that read it */
    } used[] = {{"terms", "reduced"},
                {"compression", "reduced"},
                {"times", "reduced stepping"},
                {"history", "reduced stepping"},
                {"frequencies", "reduced frequency"}};
    const char *route = r->c->viscoelastic.route, *kind = r->c->constraint.kind;
    bool equations = strcmp(route, "stepping") == 0 || strcmp(route, "frequency") == 0;
    if (equations && kind && (strcmp(kind, "voigt") == 0 || strcmp(kind, "reuss") == 0))
        ph_i_reject(r, ph_i_get(map, "route"), PH_EINVAL,
                    "constraint %s has no equations to solve: route must be reduced or "
                    "carson",
                    kind);
    for (size_t i = 0; i < sizeof used / sizeof *used; i++) {
        const ph_i_node *node = ph_i_get(map, used[i].key);
        if (node && !strstr(used[i].routes, route))
            ph_i_complain(r, node, PH_OK, "route %s does not use it: it has no effect",
                          route);
    }
}

ph_status ph_i_read_viscoelastic(ph_i_reader *r, const ph_i_node *map, ph_error *err)
{
    static const char rule[] = "must be a map such as {route: reduced, tolerance: 1e-4}";
    ph_status st = PH_OK;
    ph_case_viscoelastic *v = &r->c->viscoelastic;
    const ph_i_node *node;
    int i;
    v->route = ph_i_route_names.name[0];
    v->tolerance = 1e-4;
    if (!map || !ph_i_read_map(r, map, rule)) goto out;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(section_keys), "viscoelastic");
    v->given = true;
    if ((node = ph_i_get(map, "route")) &&
        (i = ph_i_read_name(r, node, ph_i_route_names)) >= 0)
        v->route = ph_i_route_names.name[i];
    if ((node = ph_i_get(map, "tolerance"))) read_tolerance(r, node, &v->tolerance);
    read_compression(r, map, v);
    if ((node = ph_i_get(map, "times")))
        PH_TRY(read_increasing(r, node, &v->ntimes, &v->times, err));
    if ((node = ph_i_get(map, "frequencies")))
        PH_TRY(read_increasing(r, node, &v->nfrequencies, &v->frequencies, err));
    if ((node = ph_i_get(map, "history"))) PH_TRY(read_history(r, node, err));
    check_route(r, map);
    if (r->invalid == 0 && r->unphysical == 0 && !ph_case_relaxes(r->c))
        ph_i_complain(r, map, PH_OK, "no material relaxes: the section has no effect");
out:
    return st;
}
