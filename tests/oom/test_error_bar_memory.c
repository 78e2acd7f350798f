/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error bars with every allocation of their companions failing once. */
#include "check.h"
#include "oom/countdown.h"

#include <perihom_error_bar.h>

typedef struct world {
    ph_case *c;
    ph_microstructure *micro;
    ph_crack_plan *plan;
    ph_problem problem;
    ph_relaxation_params params;
    ph_result *result;
    ph_viscoelastic *relaxation;
} world;

static const ph_ctx one_thread = {.threads = 1};

static ph_status call(void *user, ph_error *err)
{
    world *w = user;
    if (w->relaxation)
        return ph_rve_relaxation_error_bar(w->c, &w->problem, &w->params, &one_thread,
                                           w->relaxation, err);
    return ph_rve_error_bar(w->c, &w->problem, &one_thread, w->result, err);
}

static bool untouched(const void *user)
{
    const world *w = user;
    if (w->relaxation)
        return !w->relaxation->error_bars && !w->relaxation->elastic->error_bar;
    const ph_damage *d = w->result->damage;
    return !w->result->error_bar && !(d && (d->error_bars || d->pristine_error_bar)) &&
           !(w->result->failure && w->result->failure->error);
}

/* What the call made was made while it was watched. */
static void done(void *user)
{
    world *w = user;
    ph_result *r = w->relaxation ? w->relaxation->elastic : w->result;
    CHECK(r->error_bar);
    free(r->error_bar);
    r->error_bar = NULL;
    if (r->damage) {
        free(r->damage->error_bars);
        free(r->damage->pristine_error_bar);
        r->damage->error_bars = r->damage->pristine_error_bar = NULL;
    }
    if (r->failure) {
        CHECK(r->failure->error);
        free(r->failure->error);
        r->failure->error = NULL;
    }
    if (w->relaxation) {
        free(w->relaxation->error_bars);
        w->relaxation->error_bars = NULL;
        w->relaxation->nerror_bars = 0;
    }
}

static const char head[] =
    "perihom: 1\nerror_bar: {boundary: true, horizon: true}\n"
    "materials: {i: {E: 5, nu: 0.2, density: 2}, m: {density: 1, nu: 0.3, E: %s}}\n";

typedef struct way {
    const char *what, *modulus, *rest;
    bool voxels; /* as if they came from a file */
} way;

static const way ways[] = {
    {"node centres, boundary", "1",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], matrix: "
     "m, "
     "interface: node_centre, inclusions: [{shape: disk, centre: [0.5, 0.5], radius: "
     "0.3, "
     "material: i}]}\n",
     false},
    {"particles, half the horizon", "1",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [12, 12], "
     "matrix: m, "
     "fillers: [{shape: particle, material: i, volume_fraction: 0.2, size: 0.3}]}\n"
     "model: {points: nodes, horizon: {length: 0.25}}\n",
     false},
    {"voxels by twos", "1",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], matrix: "
     "m, "
     "interface: node_centre, inclusions: [{shape: disk, centre: [0.5, 0.5], radius: "
     "0.3, "
     "material: i}]}\n",
     true},
    {"steps of a crack", "1",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [12, 12], "
     "matrix: m}\n"
     "cracks: [{from: [0.3, 0.5], to: [0.7, 0.5]}]\n"
     "sequence: {crack_growth: {lengths: {list: [0.2, 0.5]}}}\n",
     false},
    {"bonds that break", "1",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], "
     "matrix: m}\nmodel: {points: nodes, horizon: 3}\n"
     "failure: {m: {fracture_energy: 1e-4}}\n"
     "loading: {strain: [0, 1, 0], to: 0.05, steps: 1, window: 1, break: together}\n",
     false},
    {"relaxation", "{infinity: 1, terms: [{modulus: 3, time: 1}]}",
     "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [8, 8], matrix: "
     "m, "
     "inclusions: [{shape: disk, centre: [0.5, 0.5], radius: 0.3, material: i}]}\n",
     false},
};

static void make(world *w, const way *x)
{
    ph_error err = PH_ERROR_INIT;
    char text[2048];
    int n = snprintf(text, sizeof text, head, x->modulus);
    n += snprintf(text + n, sizeof text - (size_t)n, "%s", x->rest);
    CHECK_OK(ph_case_parse(text, (size_t)n, "text", NULL, 0, &w->c, NULL, &err));
    if (!w->c) return;
    CHECK_OK(ph_rve_build(w->c, &w->micro, &err));
    CHECK_OK(ph_rve_cracks(w->c, &w->plan, &err));
    if (!w->micro || !w->plan) return;
    if (x->voxels) snprintf(w->c->voxels.file, sizeof w->c->voxels.file, "some.npy");
    w->problem = ph_rve_problem(w->c, w->micro, w->plan);
    if (ph_case_relaxes(w->c))
        CHECK_OK(ph_viscoelastic_solve(&w->problem, &w->params, &one_thread,
                                       &w->relaxation, &err));
    else
        CHECK_OK(ph_homogenise(&w->problem, &one_thread, &w->result, &err));
}

static void every_allocation_fails(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        world w = {0};
        make(&w, &ways[i]);
        if (w.result || w.relaxation)
            countdown_run(ways[i].what, call, untouched, done, &w);
        ph_result_free(&w.result);
        ph_viscoelastic_free(&w.relaxation);
        ph_crack_plan_free(&w.plan);
        ph_microstructure_free(&w.micro);
        ph_case_free(&w.c);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation_fails)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
