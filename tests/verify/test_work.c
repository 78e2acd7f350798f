/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Only what the scene requires: in every scene the work that it does not need is exactly
 * zero, and what it needs is as much as can be counted on paper. */
#include <perihom_rve.h>

#include "check.h"

#include <string.h>

enum { MOST_SETS = 6 };

static const char disk[] =
    "perihom: 1\ntitle: a disk\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.2}}\n"
    "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [16, 16], "
    "matrix: m,\n"
    "  inclusions: [{shape: disk, centre: [0.45, 0.6], radius: 0.3, material: f}]}\n"
    "model: {kind: nosb, points: nodes, horizon: 1}\n";

/* A case and what of it is solved. */
typedef struct scene {
    ph_case *c;
    ph_microstructure *micro;
    ph_crack_plan *plan;
    ph_problem problem;
} scene;

static scene set_up(const char *yaml, const char *const *sets)
{
    ph_error err = PH_ERROR_INIT;
    scene s = {0};
    size_t n = 0;
    while (sets && sets[n])
        n++;
    CHECK_OK(ph_case_parse(yaml, strlen(yaml), "scene", sets, n, &s.c, NULL, &err));
    if (!s.c) return s;
    CHECK_OK(ph_rve_build(s.c, &s.micro, &err));
    CHECK_OK(ph_rve_cracks(s.c, &s.plan, &err));
    s.problem = (ph_problem){.micro = s.micro,
                             .interface = s.c->interface,
                             .model = s.c->model,
                             .constraint = s.c->constraint,
                             .solver = s.c->solver,
                             .keep_fields = s.c->fields,
                             .cracks = &s.plan->cracks,
                             .sequence = &s.plan->sequence,
                             .failure = s.c->failure.material ? &s.c->failure : NULL,
                             .loading = s.c->loading.ntargets ? &s.c->loading : NULL};
    return s;
}

static void clear(scene *s)
{
    ph_crack_plan_free(&s->plan);
    ph_microstructure_free(&s->micro);
    ph_case_free(&s->c);
}

static ph_work work_of(const char *const *sets)
{
    ph_error err = PH_ERROR_INIT;
    ph_work w = {.loads = -1};
    ph_result *res = NULL;
    scene s = set_up(disk, sets);
    if (s.c) CHECK_OK(ph_homogenise(&s.problem, &(ph_ctx){.threads = 1}, &res, &err));
    if (res) w = res->work;
    ph_result_free(&res);
    clear(&s);
    return w;
}

/* What is needed: three loads, and after each iteration of them one application. */
static void test_elastic(void **state)
{
    (void)state;
    static const char *const solved[][MOST_SETS] = {
        {NULL},
        {"model.kind=local", NULL},
        {"model={kind: nosb, points: stress}", NULL},
        {"model={kind: nosb, points: stress, horizon: 3}", NULL},
        {"model={kind: bond, horizon: 2}", "materials.m.nu=0.25", "materials.f.nu=0.25",
         NULL}};
    for (size_t i = 0; i < sizeof solved / sizeof *solved; i++) {
        ph_work w = work_of(solved[i]);
        CHECK(w.loads == 3 && w.iterations > 3);
        CHECK(w.applications == w.iterations);
        CHECK(w.ffts > 0 && w.peak_bytes > 0);
        CHECK(w.collar == 0);            /* periodic */
        CHECK(w.history_variables == 0); /* elastic */
        CHECK(w.bond_bits == 0);         /* pristine */
    }
    CHECK_END();
}

static bool no_equations(const ph_work *w)
{
    return w->loads == 0 && w->iterations == 0 && w->applications == 0 && w->ffts == 0 &&
           w->collar == 0 && w->history_variables == 0 && w->bond_bits == 0;
}

static void test_nothing_to_solve(void **state)
{
    (void)state;
    static const char *const answered[][MOST_SETS] = {
        {"constraint.kind=voigt", NULL},
        {"constraint.kind=reuss", NULL},
        {"materials.f={E: 1, nu: 0.3}", NULL},
        {"microstructure.inclusions=[{shape: layer, normal: 1, from: 0.2, to: 0.5, "
         "material: f}]",
         NULL}};
    for (size_t i = 0; i < sizeof answered / sizeof *answered; i++) {
        ph_work w = work_of(answered[i]);
        CHECK(no_equations(&w));
    }
    CHECK_END();
}

/* Two horizons of one spacing on each side, inside or outside the 16 x 16 nodes. */
static void test_collar(void **state)
{
    (void)state;
    static const char *const held[][MOST_SETS] = {
        {"constraint={kind: linear_displacement, collar: inside}", NULL},
        {"constraint={kind: linear_displacement, collar: periodic}", NULL}};
    for (int i = 0; i < 2; i++) {
        ph_work w = work_of(held[i]);
        CHECK(w.loads == 3 && w.collar == (i == 0 ? 0 : 20 * 20 - 16 * 16));
        CHECK(w.history_variables == 0 && w.bond_bits == 0);
    }
    CHECK_END();
}

/* A family of one spacing has eight bonds: one word of 64 bits a node. A crack between two
 * lines of nodes, over six of their columns, damages twelve nodes. */
static void test_bonds(void **state)
{
    (void)state;
    static const char *const none[] = {"cracks=[{from: [0.26, 0.5], to: [0.27, 0.5]}]",
                                       NULL};
    static const char *const six[] = {"cracks=[{from: [0.26, 0.5], to: [0.61, 0.5]}]",
                                      NULL};
    ph_work w = work_of(none);
    CHECK(w.bond_bits == 0);
    w = work_of(six);
    CHECK(w.bond_bits == 12 * 64);
    CHECK(w.history_variables == 0 && w.collar == 0);
    CHECK_END();
}

/* Two displacements of each node for each relaxation time, and the macro strain of it; the
 * routes that know the whole history at once remember nothing. */
static void test_history(void **state)
{
    (void)state;
    static const char *const relaxes[] = {
        "materials.m={nu: 0.3, E: {infinity: 1, terms: [{modulus: 1, time: 1}, "
        "{modulus: 2, time: 10}]}}",
        "microstructure.interface=node_centre", NULL};
    static const char *const route[] = {"stepping", "reduced", "frequency", "carson"};
    scene s = set_up(disk, relaxes);
    const double at = 1.0;
    for (int i = 0; s.c && i < 4; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_viscoelastic *v = NULL;
        ph_relaxation_params p = {.route = route[i], .tolerance = 1e-2};
        p.times = p.omega = p.carson = &at;
        p.ntimes = p.nomega = p.ncarson = 1;
        CHECK_OK(
            ph_viscoelastic_solve(&s.problem, &p, &(ph_ctx){.threads = 1}, &v, &err));
        if (!v) continue;
        const ph_work *w = &v->elastic->work;
        CHECK(w->history_variables == (i == 0 ? 2 * (2 * 16 * 16 + 6) : 0));
        CHECK(w->loads >= 3 && w->applications >= w->iterations);
        CHECK(w->bond_bits == 0 && w->collar == 0);
        ph_viscoelastic_free(&v);
    }
    clear(&s);
    CHECK_END();
}

/* Loads that a case asking for some constants solves, whose values are those of the whole
 * tensor to the tolerance of the solver. */
static void check_constants(const char *const *sets, long loads)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *some = NULL, *all = NULL;
    scene s = set_up(disk, sets);
    if (!s.c) return;
    s.problem.solver.tolerance = 1e-9;
    CHECK_OK(ph_homogenise(&s.problem, &(ph_ctx){.threads = 1}, &all, &err));
    s.problem.nconstants = s.c->nconstants;
    s.problem.constants = s.c->constants;
    CHECK_OK(ph_homogenise(&s.problem, &(ph_ctx){.threads = 1}, &some, &err));
    for (int i = 0; some && all && i < s.c->nconstants; i++) {
        double x = NAN, y = NAN;
        CHECK_OK(ph_quantity_value(&s.c->constants[i], some, &x, &err));
        CHECK_OK(ph_quantity_value(&s.c->constants[i], all, &y, &err));
        CHECK_REL(x, y, 1e-7); /* the residual 1e-9 times the contrast of 10 */
    }
    CHECK(some && some->work.loads == loads && some->nloads == (int)loads);
    ph_result_free(&some);
    ph_result_free(&all);
    clear(&s);
}

/* The disk off the middle has a mirror plane at most (generalised strain), the one in the
 * middle is square. A row of the compliance is one load, a mean stress, where that is fewer
 * than the strains of its block. */
static void test_constants(void **state)
{
    (void)state;
    static const char middle[] = "microstructure.inclusions=[{shape: disk, centre: "
                                 "[0.5, 0.5], radius: 0.3, material: f}]";
    static const char thick[] = "microstructure.plane=generalised_strain";
    /* entries are energies of pairs of fields: two loads, unless one is the other turned */
    static const char rigid[] = "materials.f={E: 1e4, nu: 0.2}";
    const struct {
        const char *set[MOST_SETS];
        long loads;
    } asked[] = {{{"output.constants=[C11]"}, 1},
                 {{"output.constants=[C12]"}, 1},
                 {{"output.constants=[C11, C66]"}, 2},
                 {{"output.constants=[isotropic.K]"}, 2},
                 {{"output.constants=[E1]"}, 1},
                 {{"output.constants=[S16, nu12, E1]"}, 1},
                 {{"output.constants=[E1, E2]"}, 2},
                 {{"output.constants=[E1, C11]"}, 2},
                 {{"output.constants=[E1, C11, C22, C66]"}, 3},
                 {{"output.constants=[E1, E2, G12]"}, 3},
                 {{"output.constants=[E1]", thick}, 1},
                 {{"output.constants=[nu31, E3]", thick}, 1},
                 {{"output.constants=[G13]", thick}, 1},
                 {{"output.constants=[E1]", middle}, 1},
                 {{"output.constants=[E1, nu12]", middle}, 1},
                 {{"output.constants=[E1, E2]", middle}, 1},
                 {{"output.constants=[G12]", middle}, 1},
                 {{"output.constants=[G13]", middle, thick}, 1},
                 {{"output.constants=[E1]", middle, thick}, 1},
                 {{"output.constants=[nu23]", middle, thick}, 1},
                 {{"output.constants=[E1]", "solver.kind=direct"}, 3},
                 {{"output.constants=[E1]", rigid}, 1},
                 {{"output.constants=[nu12]", rigid}, 2},
                 {{"output.constants=[nu12]", rigid, middle}, 1},
                 {{"output.constants=[nu12]", rigid, middle, thick}, 1},
                 {{"output.constants=[C11]", rigid}, 1},
                 {{"output.constants=[C12]", rigid}, 2},
                 {{"output.constants=[C12]", rigid, middle}, 1}};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++)
        check_constants(asked[i].set, asked[i].loads);
    CHECK_END();
}

/* Of a result with the columns 11 and 12, say, what hangs on the others does not exist. */
static void test_missing_constants(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_result *some = NULL;
    scene s = set_up(disk, (const char *const[]){"output.constants=[C11]", NULL});
    if (!s.c) return;
    s.problem.nconstants = s.c->nconstants;
    s.problem.constants = s.c->constants;
    CHECK_OK(ph_homogenise(&s.problem, &(ph_ctx){.threads = 1}, &some, &err));
    static const char *const missing[] = {"C22", "E1", "G12", "S11", "isotropic.E"};
    for (size_t i = 0; some && i < sizeof missing / sizeof *missing; i++) {
        ph_quantity q;
        double x = 7;
        CHECK_OK(ph_quantity_find(missing[i], &q, &err));
        CHECK(ph_quantity_value(&q, some, &x, NULL) == PH_EINVAL && x == 7);
    }
    ph_result_free(&some);
    clear(&s);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_elastic),          cmocka_unit_test(test_nothing_to_solve),
        cmocka_unit_test(test_collar),           cmocka_unit_test(test_bonds),
        cmocka_unit_test(test_history),          cmocka_unit_test(test_constants),
        cmocka_unit_test(test_missing_constants)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
