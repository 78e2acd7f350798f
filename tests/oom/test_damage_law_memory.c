/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damage laws without memory: from a result, from a document, as a table, at a point. */
#include <perihom.h>

#include "countdown.h"
#include "io/sample.h"

#include <jansson.h>

#include <math.h>

typedef struct world {
    ph_microstructure *micro;
    ph_result *result;
    ph_damage_law *law, *out;
    ph_effective *effective;
    ph_point_material *point;
    ph_fields_step *step;
    char *json, *text, h5[300], base[300];
} world;

/* A strip with a scattered strength, pulled until some of it is broken. */
static ph_result *broken_strip(ph_microstructure **out)
{
    static const double to[] = {0.5};
    ph_error err = PH_ERROR_INIT;
    ptrdiff_t n[2] = {6, 6};
    double size[2] = {1, 1};
    ph_grid g;
    ph_material m;
    ph_microstructure *micro = NULL;
    ph_result *r = NULL;
    CHECK_OK(ph_material_isotropic("m", 1.0, 1.0 / 3, &m, &err));
    CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_microstructure_new(&g, 1, &m, &micro, &err));
    const ph_failure_rule rule = {
        .given = true, .value = (double)NAN, .fracture_energy = 1e-2, .weibull = 3};
    const ph_failure f = {.material = &rule};
    const ph_loading l = {.strain = {0, 1, 0},
                          .ntargets = 1,
                          .to = to,
                          .steps = 6,
                          .window = 1.0,
                          .stiffness_every = 1};
    const ph_problem p = {.micro = micro,
                          .model = {.kind = "bond", .horizon = 1.5},
                          .solver = {.tolerance = 1e-6},
                          .failure = &f,
                          .loading = &l,
                          .keep_fields = true};
    CHECK_OK(ph_homogenise(&p, NULL, &r, &err));
    *out = micro;
    return r;
}

static bool untouched(const void *user)
{
    const world *w = user;
    return !w->out && !w->effective && !w->point && !w->text && !w->step;
}

static void done(void *user)
{
    world *w = user;
    ph_damage_law_free(&w->out);
    ph_effective_free(&w->effective);
    ph_point_material_free(&w->point);
    ph_fields_step_free(&w->step);
    free(w->text);
    w->text = NULL;
}

static ph_status of_result(void *user, ph_error *err)
{
    world *w = user;
    return ph_damage_law_from_result(w->result, &w->out, err);
}

static ph_status effective_of_result(void *user, ph_error *err)
{
    world *w = user;
    return ph_effective_from_result(w->result, NULL, &w->effective, err);
}

static ph_status copy(void *user, ph_error *err)
{
    world *w = user;
    return ph_damage_law_copy(w->law, &w->out, err);
}

static ph_status to_csv(void *user, ph_error *err)
{
    world *w = user;
    return ph_damage_law_to_csv(w->law, &w->text, err);
}

static ph_status to_json(void *user, ph_error *err)
{
    world *w = user;
    return ph_result_to_json(w->result, NULL, NULL, &w->text, err);
}

static ph_status of_json(void *user, ph_error *err)
{
    world *w = user;
    return ph_effective_parse(w->json, strlen(w->json), "r.json", &w->effective, err);
}

static ph_status point(void *user, ph_error *err)
{
    world *w = user;
    const ph_effective e = {.stiffness = w->law->stiffness[0], .damage = w->law};
    return ph_point_material_new(&e, &w->point, err);
}

static ph_status read_step(void *user, ph_error *err)
{
    world *w = user;
    return ph_read_fields_step(w->h5, &w->result->grid, 1, ~0u, &w->step, err);
}

static ph_status write_steps(void *user, ph_error *err)
{
    world *w = user;
    return ph_write_fields(w->base, w->micro, w->result, NULL, err);
}

static void every_allocation_fails(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        ph_status (*call)(void *, ph_error *);
    } calls[] = {{"ph_damage_law_from_result", of_result},
                 {"ph_effective_from_result", effective_of_result},
                 {"ph_damage_law_copy", copy},
                 {"ph_damage_law_to_csv", to_csv},
                 {"ph_result_to_json", to_json},
                 {"ph_effective_parse", of_json},
                 {"ph_point_material_new", point},
                 {"ph_write_fields", write_steps},
                 {"ph_read_fields_step", read_step}};
    ph_error err = PH_ERROR_INIT;
    char folder[256];
    world w = {.micro = NULL};
    w.result = broken_strip(&w.micro);
    sample_folder(folder);
    snprintf(w.base, sizeof w.base, "%s/f", folder);
    snprintf(w.h5, sizeof w.h5, "%s/f.h5", folder);
    json_set_alloc_funcs(countdown_malloc, countdown_free);
    if (w.result) {
        CHECK_OK(ph_damage_law_from_result(w.result, &w.law, &err));
        CHECK_OK(ph_result_to_json(w.result, NULL, NULL, &w.json, &err));
        CHECK(w.law && w.law->nknots > 2);
    }
    for (size_t i = 0; check_failures == 0 && i < sizeof calls / sizeof *calls; i++) {
        countdown_run(calls[i].what, calls[i].call, untouched, done, &w);
    }
    ph_damage_law_free(&w.law);
    ph_result_free(&w.result);
    ph_microstructure_free(&w.micro);
    sample_remove_folder(folder);
    free(w.json);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation_fails)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
