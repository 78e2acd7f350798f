/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where cracks go, and what becomes of cells that they cut to pieces. */
#include "check.h"
#include "failure_case.h"

static const double radius = 0.15;

static ph_microstructure *disk_cell(ptrdiff_t n, double contrast, double y)
{
    ph_material m[2] = {isotropic("matrix", 1.0, 1.0 / 3),
                        isotropic("fibre", contrast, 1.0 / 3)};
    ph_inclusion inc = blank_inclusion("disk", 1);
    inc.centre[0] = 0.5;
    inc.centre[1] = y;
    inc.radius = radius;
    return shapes_cell(box_grid(PH_PLANE_STRESS, n, n, 1, 1, 1, 1), 2, m, 1, &inc);
}

static bool same_path(const ph_failure_path *a, const ph_failure_path *b)
{
    return a->nevents == b->nevents && a->nbonds == b->nbonds &&
           memcmp(a->event, b->event, (size_t)a->nevents * sizeof *a->event) == 0 &&
           memcmp(a->bond, b->bond, (size_t)a->nbonds * sizeof *a->bond) == 0;
}

/* Two runs, on one thread in one step and on two in seven: the same events to the last bit. */
static ph_result *twice(void (*make)(trial *t))
{
    ph_result *res[2] = {NULL}, *no = NULL;
    for (int k = 0; k < 2; k++) {
        trial t;
        make(&t);
        t.loading.steps = k ? 7 : 1;
        res[k] = run(&t, k ? 2 : 1);
        tear_down(&t, &no);
    }
    if (res[0] && res[1]) CHECK(same_path(res[0]->failure, res[1]->failure));
    ph_result_free(&res[1]);
    return res[0];
}

static void obstacle(trial *t)
{
    set_up(t, disk_cell(40, 10.0, 0.53), energy_of(1e-4, PH_CRITICAL_STRETCH), none(),
           0.05, 1, 2.0);
    t->failure.interphase = energy_of(2e-4, PH_CRITICAL_STRETCH);
    t->problem.solver.tolerance = 1e-6;
    t->loading.window = 0.05;
    t->loading.every_event = false;
    notch(t, -0.05, 0.2, 0.5);
}

/* A crack that runs from x = 0.2 at y = 0.5 at a stiff, unbreakable fibre, whose centre is a
 * little above: it turns below it, breaks no bond of the fibre and comes out through the
 * periodic face at the back of the notch. */
static void around_a_fibre(void **state)
{
    (void)state;
    enum { N = 40 };
    trial t;
    obstacle(&t);
    const uint16_t *phase = t.micro->phase;
    ph_result *res = twice(obstacle), *no = NULL;
    bool column[N] = {false};
    int above = 0, below = 0;
    CHECK(res != NULL);
    for (ptrdiff_t i = 0; res && i < res->failure->nbonds; i++) {
        const ph_broken_bond *b = &res->failure->bond[i];
        int x = b->node / N, y = b->node % N;
        CHECK(phase[b->node] == 0 || phase[b->other] == 0);
        column[x] = true;
        if (x == N / 2) above += y > 0.53 * N, below += y < 0.53 * N;
    }
    for (int x = N / 5; x < N - 3; x++)
        CHECK(column[x]);
    CHECK(above == 0 && below > 0);
    /* the fibre hangs by some bonds of its interphase */
    if (res) CHECK(res->stiffness.m[1][1] < 0.1 * res->damage->pristine.m[1][1]);
    ph_result_free(&res);
    tear_down(&t, &no);
    CHECK_END();
}

static void weak_interface(trial *t)
{
    set_up(t, disk_cell(24, 1e3, 0.5), energy_of(1e-2, PH_CRITICAL_STRETCH), none(), 0.02,
           1, 2.0);
    t->failure.interphase = energy_of(1e-5, PH_CRITICAL_STRETCH);
    t->problem.solver.tolerance = 1e-6;
    t->loading.window = 0.05;
}

/* A fibre of contrast 1000 debonds: every broken bond has its ends in two materials; it stays
 * in contact at the sides, where it is pressed. */
static void debonding(void **state)
{
    (void)state;
    trial t;
    weak_interface(&t);
    ph_result *res = twice(weak_interface), *no = NULL;
    const ph_failure_path *p = res ? res->failure : NULL;
    CHECK(p && p->nbonds > 50 && !p->severed);
    for (ptrdiff_t i = 0; p && i < p->nbonds; i++)
        CHECK(t.micro->phase[p->bond[i].node] != t.micro->phase[p->bond[i].other]);
    if (p) CHECK(p->imbalance < 1e-4);
    ph_result_free(&res);
    tear_down(&t, &no);
    CHECK_END();
}

/* A long sheet with a small notch stores more than its crack needs: past the peak the path of
 * events goes back, its load falls below half of the peak while bonds break one after the
 * other, and every state of it is in equilibrium: external work is stored or dissipated. Under
 * controlled strain the same bonds break at the load of the peak at once, and that costs at
 * least as much. */
static void snap_back(void **state)
{
    (void)state;
    trial t;
    ph_failure_rule weak = energy_of(1e-4, PH_CRITICAL_STRETCH);
    set_up(&t, bar(16, 3.0, 1.0, 0.5), weak, weak, 1.0, 10, 2.0);
    t.loading.window = 0.01;
    notch(&t, 0.0, 0.4, 1.51);
    ph_result *res = run(&t, 1);
    const ph_failure_path *p = res ? res->failure : NULL;
    CHECK(p && p->severed && p->nevents > 20);
    if (p) {
        ptrdiff_t top = 0, low = 0;
        check_balance(p, 1e-6);
        for (ptrdiff_t i = 0; i < p->nevents; i++) {
            const ph_failure_event *e = &p->event[i];
            if (e->before > p->event[top].before) top = i;
            if (e->load < p->event[low].load) low = i;
            if (i > 0) CHECK(e->broken > e[-1].broken);
            CHECK(e->after <= e->before * (1 + 1e-9));
        }
        CHECK(low > top);
        CHECK(p->event[low].load < 0.5 * p->event[top].load);
        const ph_failure_step *last = &p->step[p->nsteps - 1];
        CHECK(last->energy.dissipated >= last_event(p)->energy.dissipated);
        CHECK_ABS(last->energy.external - last->energy.stored - last->energy.dissipated,
                  0.0, 1e-6 * last->energy.external);
    }
    tear_down(&t, &res);
    CHECK_END();
}

/* Scatter that leaves some bonds nearly without strength: bonds break everywhere, pieces come
 * loose, the cell is severed, nothing hangs. */
static void to_pieces(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        trial t;
        ph_failure_rule rule = energy_of(1e-4, PH_CRITICAL_STRETCH);
        rule.weibull = 1.0;
        set_up(&t, bar(20, 1.0, 1.0, 0.5), rule, rule, 10.0, 3, 1.5);
        t.problem.solver.tolerance = 1e-6;
        t.loading.window = 0.5;
        t.loading.every_event = k;
        t.loading.strain[0] = t.loading.strain[1] = 1.0;
        ph_result *res = run(&t, 1);
        const ph_failure_path *p = res ? res->failure : NULL;
        CHECK(p && p->severed);
        if (p) {
            CHECK(p->nbonds > 20 * 20); /* of 4 a node */
            /* 1e-5 of the stiffness, a few moduli, times the strain of 10 */
            CHECK_ABS(p->step[3].work, 0.0, 1e-3);
            CHECK(isfinite(p->toughness) && p->toughness > 0.0);
        }
        tear_down(&t, &res);
    }
    CHECK_END();
}

/* A crack on the line between cells in the middle, and one on the border of the period over
 * its corner, are the same cell moved: the same events. One through nodes severs it too, at a
 * load that is not far: nodes on a crack are on its positive side, which moves it by half a
 * spacing where its tips are half a spacing from where they were. */
static void at_the_corner(void **state)
{
    (void)state;
    ph_result *res[3] = {NULL}, *no = NULL;
    for (int k = 0; k < 3; k++) {
        trial t;
        ph_failure_rule rule = energy_of(1e-4, PH_CRITICAL_STRETCH);
        set_up(&t, bar(16, 1.0, 1.0, 0.5), rule, rule, 0.05, 2, 2.0);
        t.loading.window = 0.02;
        double y = k == 1 ? 0.0 : 0.5, x = k == 1 ? -0.25 : 0.25; /* on grid lines */
        if (k == 2) y += 0.5 / 16;
        notch(&t, x, x + 0.5, y);
        res[k] = run(&t, 1);
        tear_down(&t, &no);
    }
    CHECK(res[0] && res[1] && res[2]);
    if (res[0] && res[1] && res[2]) {
        CHECK(res[0]->failure->severed && res[1]->failure->severed &&
              res[2]->failure->severed);
        CHECK_REL(res[2]->failure->peak_stress, res[0]->failure->peak_stress, 0.1);
        CHECK_REL(res[0]->failure->first_load, res[1]->failure->first_load, 1e-7);
        CHECK_REL(res[0]->failure->peak_stress, res[1]->failure->peak_stress, 1e-6);
    }
    for (int k = 0; k < 3; k++)
        ph_result_free(&res[k]);
    CHECK_END();
}

/* In space a penny grows along the interface of two halves until they are apart. Every column
 * of cells across it is one share of the area; those that the penny cut have no energy to
 * give. The rim is cut bond by bond, hence 10 %. */
static void penny(void **state)
{
    (void)state;
    enum { N = 8 };
    ph_error err = PH_ERROR_INIT;
    trial t;
    ph_material m[2] = {isotropic("one", 1.0, 0.25), isotropic("two", 1.0, 0.25)};
    ph_inclusion inc = blank_inclusion("layer", 1);
    inc.normal = 2;
    inc.from = 0.25;
    inc.to = 0.75;
    double centre[3] = {0.5, 0.25, 0.5}, normal[3] = {0, 1, 0}, axes[2] = {0.3, 0.3};
    set_up(&t, shapes_cell(box_grid(PH_SPACE, N, N, N, 1, 1, 1), 2, m, 1, &inc), none(),
           none(), 0.5, 2, 2.0);
    t.failure.interphase = energy_of(1e-4, PH_CRITICAL_STRETCH);
    t.problem.solver.tolerance = 1e-7;
    t.loading.window = 0.02;
    CHECK_OK(ph_cracks_add_ellipse(&t.cracks, centre, normal, NULL, axes, &err));
    ph_result *res = run(&t, 1);
    const ph_failure_path *p = res ? res->failure : NULL;
    CHECK(p && p->severed && p->nevents > 5);
    if (p) {
        double open =
            0.0; /* columns whose cells on both sides have lost the bond between */
        for (int i = 0; i < N; i++)
            for (int k = 0; k < N; k++) {
                double x = (i + 0.5) / N - 0.5, z = (k + 0.5) / N - 0.5;
                open += x * x + z * z < 0.09;
            }
        double area = 1.0 - open / (N * N);
        check_balance(p, 1e-5);
        CHECK_REL(last_event(p)->energy.dissipated, 1e-4 * area, 0.1);
    }
    tear_down(&t, &res);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(around_a_fibre), cmocka_unit_test(debonding),
        cmocka_unit_test(snap_back),      cmocka_unit_test(to_pieces),
        cmocka_unit_test(at_the_corner),  cmocka_unit_test(penny),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
