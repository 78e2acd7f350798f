/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speed, one problem per word of the command line; verified before it is timed.
 *
 *   iteration:64x64x64:nodes:2     one CG iteration and its parts (route, horizon)
 *   solve:P3:64:nosb               all load cases of a peer's problem
 *   solve:clay:150:bond            clay in epoxy, three loads (horizon 8 spacings)
 *   random:clay:150:200            so many realisations of it, two tensile loads
 *   threads:P3:64                  one thread against two
 *   horizon:64x64x64               an iteration at horizon 12 over one at horizon 2
 *   clay:150                       one clay/epoxy realisation, beside the direct solver
 *   clay_batch:200                 as many realisations on two threads
 *   relax:V29:100                  the whole relaxation over one elastic solution, all loads
 *   point:10                       the material point with so many terms, n = 6
 *   damage:20                      the same with a damage law of so many segments
 *   stepping:V29:64                a thousand steps over twelve decades, all loads, beside it
 *   precision_errors:16            single precision beside double: errors by contrast and tolerance
 *   precision:SC:64:10:5           the same at contrast 10: least CPU time of 5 pairs, bytes (SC or P2)
 *
 * Prints one JSON object a line. Times are CPU seconds of the process, the least of several
 * runs, unless called wall. Ratios are of two runs in the same minute. */
#include <perihom_rve.h>

#include "model/models.h"
#include "solve/solver.h"

#include <math.h>
#include <string.h>
#include <time.h>

static double clock_of(clockid_t id)
{
    struct timespec t;
    clock_gettime(id, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void die(const char *what, const ph_error *err)
{
    fprintf(stderr, "bench: %s: %s\n", what, err->msg);
    exit(1);
}

/* ---- problems ------------------------------------------------------------------------- */

static const char *const problem_yaml[] = {
    "P2",
    "perihom: 1\ntitle: P2\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials: {m: {E: 68.3, nu: 0.3}, f: {E: 379.3, nu: 0.1}}\n"
    "microstructure: {dimension: 2, plane: strain, size: [1, 1], nodes: [%d, %d], "
    "matrix: m,\n"
    "  inclusions: [{shape: disk, centre: [0.5, 0.5], fraction: 0.47, material: f}]}\n",
    "P3",
    "perihom: 1\ntitle: P3\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials: {m: {E: 3.5, nu: 0.35}, f: {E: 70, nu: 0.2}}\n"
    "microstructure: {dimension: 3, size: [1, 1, 1], nodes: [%d, %d, %d], matrix: m,\n"
    "  inclusions: [{shape: sphere, centre: [0.5, 0.5, 0.5], fraction: 0.25, material: "
    "f}]}\n",
    "clay", /* [Ongaro2022] table 3.1 */
    "perihom: 1\ntitle: clay\nunits: {length: nm, stress: GPa, time: s}\n"
    "materials: {m: {E: 3.5, nu: 0.3333333333333333, density: 1156.5},\n"
    "  f: {E: 178, nu: 0.3333333333333333, density: 1660}}\n"
    "microstructure:\n  dimension: 2\n  plane: stress\n  nodes: [%d, %d]\n"
    "  size: [%d0, %d0]\n  matrix: m\n  interface: node_centre\n  fillers:\n"
    "    - {shape: platelet, material: f, weight_fraction: 0.05, thickness: 1.0,\n"
    "       aspect_ratio: {normal: {mean: 300, std: 60, min: 10}},\n"
    "       curvature: {arc_angle: {uniform: {min: 0, max: 90}}}, orientation: uniform,\n"
    "       placement: {overlap: true}, counting: nodes, interphase: {kappa: 0.1}}\n"
    "model: {kind: bond, horizon: 8, calibration: gamma}\n",
    "V29", /* [Galadima2023] 8.6.1 */
    "perihom: 1\ntitle: V29\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials:\n  m: {E: {infinity: 3, terms: [{modulus: 17, time: 1}]}, nu: 0.38}\n"
    "  f: {E: 20, nu: 0.21}\n"
    "microstructure: {dimension: 2, plane: stress, size: [1, 1], nodes: [%d, %d], "
    "matrix: m,\n"
    "  inclusions: [{shape: disk, centre: [0.5, 0.5], fraction: 0.5, material: f}]}\n",
    "R3", /* P3 with a matrix of four times over ten decades */
    "perihom: 1\ntitle: R3\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials:\n  m: {E: {infinity: 0.5, terms: [{modulus: 1, time: 1e-5},\n"
    "    {modulus: 1, time: 1e-2}, {modulus: 0.5, time: 1e1}, {modulus: 0.5, time: "
    "1e5}]},\n"
    "    nu: 0.35}\n"
    "  f: {E: 70, nu: 0.2}\n"
    "microstructure: {dimension: 3, size: [1, 1, 1], nodes: [%d, %d, %d], matrix: m,\n"
    "  inclusions: [{shape: sphere, centre: [0.5, 0.5, 0.5], fraction: 0.25, material: "
    "f}]}\n",
    "edge", /* data/cases/edge-crack.yaml in a hundred steps */
    "perihom: 1\ntitle: edge\nunits: {length: mm, stress: MPa}\n"
    "materials: {epoxy: {E: 3000, nu: 0.3333333333333333}, air: {void: true},\n"
    "  glass: {E: 30000, nu: 0.3333333333333333}}\n"
    "microstructure: {dimension: 2, plane: stress, nodes: [%d, %d], size: [1, 1],\n"
    "  matrix: epoxy, inclusions: [\n"
    "    {shape: layer, material: air, normal: 1, from: 0.95, to: 1.0},\n"
    "    {shape: disk, material: glass, centre: [0.5, 0.53], radius: 0.12}]}\n"
    "model: {kind: bond, horizon: 3}\ncracks: [{from: [-0.05, 0.5], to: [0.2, 0.5]}]\n"
    "failure: {epoxy: {fracture_energy: 0.1}, glass: unbreakable,\n"
    "  interphase: {fracture_energy: 0.2}}\n"
    "loading: {strain: [0, 1, 0], to: 0.02, steps: 100, window: 0.02}\n",
    "notch", /* the same without free edges and fibre */
    "perihom: 1\ntitle: notch\nunits: {length: mm, stress: MPa}\n"
    "materials: {epoxy: {E: 3000, nu: 0.3333333333333333}}\n"
    "microstructure: {dimension: 2, plane: stress, nodes: [%d, %d], size: [1, 1],\n"
    "  matrix: epoxy}\n"
    "model: {kind: bond, horizon: 3}\n"
    "cracks: [{from: [-0.05, 0.507], to: [0.25, 0.507]}]\n"
    "failure: {epoxy: {fracture_energy: 0.1}}\n"
    "loading: {strain: [0, 1, 0], to: 0.03, steps: 100, window: 0.02}\n",
    "SC", /* simple-cubic spheres with exact constants */
    "perihom: 1\ntitle: spheres\nunits: {length: mm, stress: GPa, time: s}\n"
    "materials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.3}}\n"
    "microstructure: {dimension: 3, size: [1, 1, 1], nodes: [%d, %d, %d], matrix: m,\n"
    "  inclusions: [{shape: sphere, centre: [0.5, 0.5, 0.5], fraction: 0.2, material: "
    "f}]}\n",
};

typedef struct scene {
    ph_case *c;
    ph_microstructure *micro;
    ph_problem problem;
} scene;

static scene scene_seeded(const char *name, int n, const char *model, bool voxels,
                          int seed)
{
    ph_error err = PH_ERROR_INIT;
    scene s = {0};
    char text[2048], set[64], number[64];
    for (size_t i = 0; i < sizeof problem_yaml / sizeof *problem_yaml; i += 2)
        if (strcmp(problem_yaml[i], name) == 0)
            snprintf(text, sizeof text, problem_yaml[i + 1], n, n, n, n);
    snprintf(set, sizeof set, "model.kind=%s", model);
    snprintf(number, sizeof number, "microstructure.seed=%d", seed);
    const char *sets[] = {set, number, "microstructure.interface=node_centre"};
    if (ph_case_parse(text, strlen(text), name, sets, voxels ? 3 : 2, &s.c, NULL, &err) ||
        ph_rve_build(s.c, &s.micro, &err))
        die(name, &err);
    s.problem = (ph_problem){.micro = s.micro,
                             .interface = s.c->interface,
                             .model = s.c->model,
                             .constraint = s.c->constraint,
                             .solver = s.c->solver};
    return s;
}

static scene scene_new(const char *name, int n, const char *model, bool voxels)
{
    return scene_seeded(name, n, model, voxels, 1);
}

static void scene_free(scene *s)
{
    ph_microstructure_free(&s->micro);
    ph_case_free(&s->c);
}

/* Least CPU seconds of `runs` solves; wall in *wall; the last result in *out. */
static double solve(const scene *s, int threads, int runs, double *wall, ph_result **out)
{
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = threads};
    double cpu = INFINITY;
    *wall = INFINITY;
    for (int i = 0; i < runs; i++) {
        ph_result_free(out);
        double c = clock_of(CLOCK_PROCESS_CPUTIME_ID), w = clock_of(CLOCK_MONOTONIC);
        if (ph_homogenise(&s->problem, &ctx, out, &err)) die("solve", &err);
        cpu = fmin(cpu, clock_of(CLOCK_PROCESS_CPUTIME_ID) - c);
        *wall = fmin(*wall, clock_of(CLOCK_MONOTONIC) - w);
    }
    return cpu;
}

static void bench_solve(const char *name, int n, const char *model)
{
    /* The peers' problems are voxelised by the cell centre; SC has exact constants. */
    bool voxels = strcmp(name, "SC") != 0;
    scene s = scene_new(name, n, model, voxels);
    ph_result *res = NULL;
    double wall, cpu = solve(&s, 1, n > 100 ? 1 : 3, &wall, &res), v[36];
    int iterations = 0, ns = res->stiffness.n;
    ph_sym4_to_voigt(&res->stiffness, true, v);
    for (int i = 0; i < res->nloads; i++)
        iterations += res->iterations[i];
    ptrdiff_t cells = ph_grid_cells(&res->grid);
    printf("{\"bench\": \"solve\", \"problem\": \"%s\", \"n\": %d, \"model\": \"%s\", "
           "\"route\": \"%s\", \"cpu\": %.4g, \"wall\": %.4g, \"iterations\": %d, "
           "\"loads\": %d, \"ns_per_node_iteration\": %.3g, \"bytes_per_node\": %.4g, "
           "\"C11\": %.7g, \"C12\": %.7g, \"C_shear\": %.7g}\n",
           name, n, model, res->route, cpu, wall, iterations, res->nloads,
           1e9 * res->seconds_solve / iterations / (double)cells,
           (double)res->work.peak_bytes / (double)cells, v[0], v[1], v[ns * ns - 1]);
    ph_result_free(&res);
    scene_free(&s);
}

/* The relaxation by the reduced route, and the instantaneous problem to 1e-6. */
static void bench_relax(const char *name, int n)
{
    ph_error err = PH_ERROR_INIT;
    const ph_ctx ctx = {.threads = 1};
    scene s = scene_new(name, n, "nosb", false);
    ph_result *res = NULL;
    ph_viscoelastic *v = NULL;
    double wall, elastic = solve(&s, 1, 3, &wall, &res), cpu = INFINITY;
    int iterations = 0;
    for (int i = 0; i < res->nloads; i++)
        iterations += res->iterations[i];
    for (int i = 0; i < 3; i++) {
        ph_viscoelastic_free(&v);
        double c = clock_of(CLOCK_PROCESS_CPUTIME_ID);
        if (ph_viscoelastic_solve(&s.problem, NULL, &ctx, &v, &err)) die("relax", &err);
        cpu = fmin(cpu, clock_of(CLOCK_PROCESS_CPUTIME_ID) - c);
    }
    double cells = (double)ph_grid_cells(&res->grid);
    printf("{\"bench\": \"relax\", \"problem\": \"%s\", \"n\": %d, \"cpu\": %.4g, "
           "\"cpu_elastic\": %.4g, \"iterations\": %ld, \"iterations_elastic\": %d, "
           "\"applications\": %ld, \"applications_elastic\": %ld, \"points\": %d, "
           "\"basis\": %d, \"basis_bytes_per_node\": %.4g, \"bytes_per_node\": %.4g, "
           "\"terms\": %d, \"error\": %.2g}\n",
           name, n, cpu, elastic, v->iterations, iterations, v->applications,
           res->work.applications, v->npoints, v->basis, (double)v->basis_bytes / cells,
           (double)v->elastic->work.peak_bytes / cells, v->series->nterms, v->error);
    ph_viscoelastic_free(&v);
    ph_result_free(&res);
    scene_free(&s);
}

/* A thousand steps, one to each of as many times over twelve decades, against the series of
 * the reduced route: applications of both, and the largest difference. */
static void bench_stepping(const char *name, int n)
{
    enum { STEPS = 1000 };
    ph_error err = PH_ERROR_INIT;
    const ph_ctx ctx = {.threads = 1};
    scene s = scene_new(name, n, "nosb", false);
    ph_viscoelastic *series = NULL, *steps = NULL;
    double times[STEPS], worst = 0.0, c;
    for (int k = 0; k < STEPS; k++)
        times[k] = pow(10.0, -6.0 + 12.0 * k / (STEPS - 1));
    ph_relaxation_params p = {
        .route = "stepping", .tolerance = 0.5, .times = times, .ntimes = STEPS};
    if (ph_viscoelastic_solve(&s.problem, NULL, &ctx, &series, &err)) die("relax", &err);
    c = clock_of(CLOCK_PROCESS_CPUTIME_ID);
    if (ph_viscoelastic_solve(&s.problem, &p, &ctx, &steps, &err)) die("stepping", &err);
    c = clock_of(CLOCK_PROCESS_CPUTIME_ID) - c;
    for (int k = 0; k < STEPS; k++) {
        ph_sym4 want = ph_prony_at_time(series->series, times[k]);
        ph_sym4 d = ph_sym4_combine(1.0, &steps->curve[k].stiffness, -1.0, &want);
        worst = fmax(worst, ph_sym4_norm(&d) / ph_sym4_norm(&want));
    }
    double cells = (double)ph_grid_cells(&steps->elastic->grid);
    printf("{\"bench\": \"stepping\", \"problem\": \"%s\", \"n\": %d, \"cpu\": %.4g, "
           "\"cpu_reduced\": %.4g, \"steps\": %ld, \"iterations\": %ld, "
           "\"applications\": %ld, \"applications_reduced\": %ld, \"error\": %.2g, "
           "\"bytes_per_node\": %.4g}\n",
           name, n, c, series->seconds, steps->steps, steps->iterations,
           steps->applications, series->applications, worst,
           (double)steps->elastic->work.peak_bytes / cells);
    ph_viscoelastic_free(&steps);
    ph_viscoelastic_free(&series);
    scene_free(&s);
}

/* A loading until the crack is through, by patches or with every event settled. */
static void bench_failure(const char *name, int n, bool every_event)
{
    ph_error err = PH_ERROR_INIT;
    scene s = scene_new(name, n, "bond", false);
    ph_crack_plan *plan = NULL;
    ph_result *res = NULL;
    double wall;
    if (ph_rve_cracks(s.c, &plan, &err)) die("cracks", &err);
    s.problem = ph_rve_problem(s.c, s.micro, plan);
    ph_loading loading = s.c->loading;
    loading.every_event = every_event;
    s.problem.loading = &loading;
    double cpu = solve(&s, 1, 1, &wall, &res);
    const ph_failure_path *p = res->failure;
    int settled = 0, iterations = 0;
    for (ptrdiff_t i = 0; i < p->nevents; i++) {
        settled += p->event[i].iterations > 0;
        iterations += p->event[i].iterations;
    }
    printf(
        "{\"bench\": \"failure\", \"problem\": \"%s\", \"n\": %d, \"every_event\": %s, "
        "\"steps\": %d, \"events\": %td, \"bonds\": %td, \"settled\": %d, "
        "\"iterations\": %d, \"cpu\": %.4g, \"bytes_per_node\": %.4g, \"severed\": %s, "
        "\"peak\": %.6g, \"dissipated\": %.5g, \"imbalance\": %.2g}\n",
        name, n, every_event ? "true" : "false", p->nsteps - 1, p->nevents, p->nbonds,
        settled, iterations, cpu, (double)res->work.peak_bytes / n / n,
        p->severed ? "true" : "false", p->peak_stress,
        p->event[p->nevents - 1].energy.dissipated, p->imbalance);
    ph_result_free(&res);
    scene_free(&s);
}

/* Realisations of a random problem one after the other: what a campaign would take. */
static void bench_random(const char *name, int n, int count)
{
    double cpu = 0.0, sum = 0.0, squares = 0.0;
    int iterations = 0;
    for (int k = 1; k <= count; k++) {
        double c = clock_of(CLOCK_PROCESS_CPUTIME_ID), wall;
        scene s = scene_seeded(name, n, "bond", false, k);
        s.problem.loads = 3;
        ph_result *res = NULL;
        solve(&s, 1, 1, &wall, &res);
        double a = res->stiffness.m[0][0], b = res->stiffness.m[1][0], E = a - b * b / a;
        cpu += clock_of(CLOCK_PROCESS_CPUTIME_ID) - c;
        sum += E;
        squares += E * E;
        iterations += res->iterations[0] + res->iterations[1];
        ph_result_free(&res);
        scene_free(&s);
    }
    double mean = sum / count;
    printf(
        "{\"bench\": \"random\", \"problem\": \"%s\", \"n\": %d, \"count\": %d, "
        "\"cpu\": %.4g, \"iterations_per_load\": %.3g, \"E11\": %.6g, \"std\": %.3g}\n",
        name, n, count, cpu, 0.5 * iterations / count, mean,
        sqrt(fmax(0.0, squares / count - mean * mean)));
}

static void bench_threads(const char *name, int n)
{
    scene s = scene_new(name, n, "nosb", false);
    ph_result *one = NULL, *two = NULL;
    double wall1, wall2, cpu1 = solve(&s, 1, 3, &wall1, &one),
                         cpu2 = solve(&s, 2, 3, &wall2, &two);
    bool same = memcmp(&one->stiffness, &two->stiffness, sizeof one->stiffness) == 0;
    printf("{\"bench\": \"threads\", \"problem\": \"%s\", \"n\": %d, \"wall_1\": %.4g, "
           "\"wall_2\": %.4g, \"speedup\": %.3g, \"cpu_1\": %.4g, \"cpu_2\": %.4g, "
           "\"same_bits\": %s}\n",
           name, n, wall1, wall2, wall1 / wall2, cpu1, cpu2, same ? "true" : "false");
    ph_result_free(&one);
    ph_result_free(&two);
    scene_free(&s);
}

/* ---- random nanocomposites --------------------------------------------------------------- */

/* Both stretches of one realisation by FFT and by the sparse direct solver, in turn. */
static void bench_clay(int n)
{
    scene s = scene_new("clay", n, "bond", false);
    ph_result *res = NULL, *direct = NULL;
    double wall, wall_direct, difference = 0.0;
    s.problem.loads = 3;
    double cpu = solve(&s, 1, 5, &wall, &res);
    s.problem.solver.kind = "direct";
    double cpu_direct = solve(&s, 1, 1, &wall_direct, &direct);
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            difference = fmax(difference,
                              fabs(res->stiffness.m[a][b] - direct->stiffness.m[a][b]));
    printf("{\"bench\": \"clay\", \"n\": %d, \"horizon\": 8, \"route\": \"%s\", "
           "\"iterations\": [%d, %d], \"cpu\": %.4g, \"bytes_per_node\": %.4g, "
           "\"cpu_direct\": %.4g, \"bytes_per_node_direct\": %.4g, "
           "\"direct_over_fft\": %.4g, \"difference\": %.2g}\n",
           n, res->route, res->iterations[0], res->iterations[1], cpu,
           (double)res->work.peak_bytes / n / n, cpu_direct,
           (double)direct->work.peak_bytes / n / n, cpu_direct / cpu,
           difference / res->stiffness.m[0][0]);
    ph_result_free(&res);
    ph_result_free(&direct);
    scene_free(&s);
}

/* a11 of realisation k: generated, solved, forgotten. */
static double one_realisation(const scene *s, int k)
{
    ph_error err = PH_ERROR_INIT;
    ph_ctx ctx = {.threads = 1};
    ph_case c = *s->c;
    ph_problem p = s->problem;
    ph_microstructure *micro = NULL;
    ph_result *res = NULL;
    c.realisation = (uint64_t)k;
    p.loads = 3;
    if (ph_rve_build(&c, &micro, &err)) die("clay_batch", &err);
    p.micro = micro;
    if (ph_homogenise(&p, &ctx, &res, &err)) die("clay_batch", &err);
    double a11 = res->stiffness.m[0][0];
    ph_result_free(&res);
    ph_microstructure_free(&micro);
    return a11;
}

static void bench_clay_batch(int count)
{
    scene s = scene_new("clay", 150, "bond", false);
    double w = clock_of(CLOCK_MONOTONIC), c = clock_of(CLOCK_PROCESS_CPUTIME_ID),
           sum = 0.0;
#pragma omp parallel for schedule(dynamic) num_threads(2) reduction(+ : sum)
    for (int k = 0; k < count; k++)
        sum += one_realisation(&s, k);
    w = clock_of(CLOCK_MONOTONIC) - w;
    c = clock_of(CLOCK_PROCESS_CPUTIME_ID) - c;
    printf("{\"bench\": \"clay_batch\", \"realisations\": %d, \"threads\": 2, "
           "\"wall\": %.4g, \"cpu\": %.4g, \"cpu_over_threads\": %.4g, "
           "\"mean_a11\": %.5g}\n",
           count, w, c, c / 2, sum / count);
    scene_free(&s);
}

/* ---- one iteration and its parts -------------------------------------------------------- */

typedef struct parts {
    ph_operator *op;
    ph_green green;
    ph_space space;
    double *x, *r, *p, *q;
} parts;

static double time_of(void (*part)(parts *), parts *p)
{
    double best = INFINITY;
    for (int i = 0; i < 9; i++) {
        double t = clock_of(CLOCK_THREAD_CPUTIME_ID);
        part(p);
        best = fmin(best, clock_of(CLOCK_THREAD_CPUTIME_ID) - t);
    }
    return best;
}

static void part_apply(parts *p)
{
    ph_i_operator_apply_hat(p->op, p->p, p->q);
}
static void part_green(parts *p)
{
    ph_i_green_apply(&p->green, p->r, p->q);
}
static void part_transforms(parts *p)
{
    ph_i_operator_backward(p->op, p->p, p->q, p->op->u);
    ph_i_operator_forward(p->op, p->op->u, p->q);
}
static void part_vectors(parts *p)
{
    double rz = ph_i_dot(&p->space, p->r, p->q), pq = ph_i_dot(&p->space, p->p, p->q);
    ph_i_step(&p->space, 1e-3 * (rz != pq), p->p, p->q, p->x, p->r);
    ph_i_direction(&p->space, 1e-3, p->q, p->p);
}

static ph_microstructure *ball(const ptrdiff_t *n, ph_error *err)
{
    double size[3] = {1.0, 1.0, 1.0};
    ph_grid grid;
    ph_material m[2];
    ph_microstructure *micro = NULL;
    if (ph_grid_init(&grid, n[2] > 1 ? PH_SPACE : PH_GENERALISED_STRAIN, n, size, err) ||
        ph_material_isotropic("m", 1.0, 0.3, &m[0], err) ||
        ph_material_isotropic("f", 10.0, 0.3, &m[1], err) ||
        ph_microstructure_new(&grid, 2, m, &micro, err))
        die("ball", err);
    for (ptrdiff_t x = 0; x < ph_grid_cells(&grid); x++) {
        ptrdiff_t at[3] = {x / n[2] / n[1], x / n[2] % n[1], x % n[2]};
        double r = 0.0;
        for (int d = 0; d < 3; d++)
            if (n[d] > 1) r += pow(((double)at[d] + 0.5) / (double)n[d] - 0.5, 2.0);
        micro->phase[x] = r < 0.13;
    }
    return micro;
}

/* Seconds of one iteration; prints the parts if `tell`. */
static double iteration(const ptrdiff_t *n, const char *points, double horizon,
                        ph_route route, bool tell)
{
    ph_error err = PH_ERROR_INIT;
    ph_meter meter = {0};
    ph_microstructure *micro = ball(n, &err);
    ptrdiff_t cells = ph_grid_cells(&micro->grid);
    ph_stiffness_map *map = NULL;
    ph_family *family = NULL;
    ph_operator_params params;
    bool local = strcmp(points, "local") == 0;
    ph_problem problem = {
        .micro = micro,
        .model = {
            .kind = local ? "local" : "nosb",
            .points = strcmp(points, "nodes") == 0 ? PH_POINTS_NODES : PH_POINTS_STRESS,
            .horizon = horizon,
            .stabilisation = strcmp(points, "subpoint") == 0 ? PH_STABILISE_SUBPOINT
                                                             : PH_STABILISE_SPECTRAL}};
    parts p = {0};
    if (ph_i_stiffness_map_new(micro, PH_INTERFACE_NODE_CENTRE, false, NULL, cells,
                               &meter, &map, &err) ||
        ph_i_model_choose(&problem, map, false, &params, &family, NULL, &err))
        die("iteration", &err);
    params.threads = 1;
    params.route = route;
    if (ph_i_operator_new(&micro->grid, map, &params, &meter, &p.op, &err) ||
        ph_i_space_init(&p.space, &p.op->layout, p.op->fft, 1, &err) ||
        ph_i_green_init(&p.green, p.op, &map->middle, NULL, &err))
        die("iteration", &err);
    size_t size = ph_i_space_size(&p.space);
    p.x = ph_i_doubles_new(&meter, size);
    p.r = ph_i_doubles_new(&meter, size);
    p.p = ph_i_doubles_new(&meter, size);
    p.q = ph_i_doubles_new(&meter, size);
    if (!p.x || !p.r || !p.p || !p.q) exit(1);
    for (size_t i = 0; i < size; i++)
        p.r[i] = p.p[i] = sin((double)i);
    double apply = time_of(part_apply, &p), green = time_of(part_green, &p);
    double vectors = time_of(part_vectors, &p), transforms = time_of(part_transforms, &p);
    double all = apply + green + vectors, ns = 1e9 / (double)cells;
    /* The convolution transforms strains and stresses, not displacements and forces. */
    int nd = p.op->layout.nd, columns = n[2] > 1 ? 6 : 5;
    if (p.op->has_convolution) transforms *= (double)columns / nd;
    if (tell)
        printf(
            "{\"bench\": \"iteration\", \"n\": [%td, %td, %td], \"points\": \"%s\", "
            "\"horizon\": %g, \"route\": \"%s\", \"ns_per_node\": %.4g, \"apply\": %.4g, "
            "\"transforms\": %.4g, \"preconditioner\": %.4g, \"vectors\": %.4g, "
            "\"transform_share\": %.3g, \"bytes_per_node\": %.4g}\n",
            n[0], n[1], n[2], points, horizon, ph_i_route_name(p.op->route), all * ns,
            apply * ns, transforms * ns, green * ns, vectors * ns, transforms / all,
            (double)meter.peak / (double)cells);
    ph_i_doubles_free(&meter, &p.x, size);
    ph_i_doubles_free(&meter, &p.r, size);
    ph_i_doubles_free(&meter, &p.p, size);
    ph_i_doubles_free(&meter, &p.q, size);
    ph_i_green_clear(&p.green, &meter);
    ph_i_space_clear(&p.space);
    ph_i_operator_free(&p.op);
    ph_family_free(&family);
    ph_i_stiffness_map_free(&meter, &map);
    ph_microstructure_free(&micro);
    return all;
}

static void bench_horizon(const ptrdiff_t *n)
{
    double two = INFINITY, twelve = INFINITY;
    for (int i = 0; i < 3; i++) { /* in turn, so that a busy minute hits both */
        two = fmin(two, iteration(n, "nodes", 2.0, PH_ROUTE_CONVOLUTION, i == 2));
        twelve = fmin(twelve, iteration(n, "nodes", 12.0, PH_ROUTE_CONVOLUTION, i == 2));
    }
    printf(
        "{\"bench\": \"horizon\", \"n\": [%td, %td, %td], \"ratio_12_over_2\": %.3g}\n",
        n[0], n[1], n[2], twelve / two);
}

static ph_route route_called(const char *name)
{
    for (int r = PH_ROUTE_AUTO; r <= PH_ROUTE_CONVOLUTION; r++)
        if (strcmp(name, ph_i_route_name((ph_route)r)) == 0) return (ph_route)r;
    return PH_ROUTE_AUTO;
}

/* Stiffness (1 - d) C in so many segments, between loads that the strains of the bench pass. */
static ph_point_material *point_of_damage(int segments)
{
    ph_error err = PH_ERROR_INIT;
    const double strain[6] = {1, 1, 1, 1, 1, 1};
    double d[65], begin[64], end[64];
    ph_sym4 c[65];
    ph_effective effective = {.stiffness = ph_sym4_isotropic_kg(4, 2)};
    ph_point_material *point = NULL;
    if (segments < 1 || segments > 64) die("damage: 1 to 64 segments", &err);
    for (int k = 0; k <= segments; k++) {
        d[k] = 0.9 * k / segments;
        c[k] = ph_sym4_combine(1 - d[k], &effective.stiffness, 0, &effective.stiffness);
        if (k < segments)
            begin[k] = 0.1 * k / segments, end[k] = 0.1 * (k + 1) / segments;
    }
    if (ph_damage_law_new(6, strain, segments + 1, d, c, begin, end, &effective.damage,
                          &err) ||
        ph_point_material_new(&effective, &point, &err))
        die("damage", &err);
    ph_damage_law_free(&effective.damage);
    return point;
}

/* A material whose terms are spread over ten decades; K and G positive, so all are. */
static ph_point_material *point_of_terms(int terms)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_term term[64];
    ph_effective effective = {.stiffness = ph_sym4_isotropic_kg(4, 2)};
    ph_point_material *point = NULL;
    if (terms < 0 || terms > 64) die("point: 0 to 64 terms", &err);
    for (int k = 0; k < terms; k++)
        term[k] = (ph_prony_term){pow(10, 10.0 * k / terms - 5),
                                  ph_sym4_isotropic_kg(1 + k, 2)};
    if (terms > 0) {
        if (ph_prony_new(&effective.stiffness, terms, term, &effective.relaxation, &err))
            die("point", &err);
        effective.stiffness = ph_prony_instantaneous(effective.relaxation);
    }
    if (ph_point_material_new(&effective, &point, &err)) die("point", &err);
    ph_prony_free(&effective.relaxation);
    return point;
}

/* Nanoseconds a call: one point after the other with and without the tangent, and 1000 at
 * once; both ways must end with the same bits. */
static void bench_point(const char *kind, int size_of_law)
{
    enum { POINTS = 1000, CALLS = 200 };
    static double tangent[36 * POINTS];
    ph_point_material *point = strcmp(kind, "damage") == 0 ? point_of_damage(size_of_law)
                                                           : point_of_terms(size_of_law);
    const size_t size = ph_point_state_size(point);
    double *state[3], *de = malloc(6 * POINTS * sizeof *de),
                      *stress = malloc(6 * POINTS * sizeof *de);
    double least[3] = {INFINITY, INFINITY, INFINITY};
    for (int i = 0; i < 6 * POINTS; i++)
        de[i] = 1e-3 * sin(i);
    for (int way = 0; way < 3; way++) {
        state[way] = calloc(size * POINTS, sizeof **state);
        for (int call = 0; call < CALLS; call++) {
            const double begin = clock_of(CLOCK_PROCESS_CPUTIME_ID);
            if (way == 2)
                ph_points_update(point, POINTS, state[2], de, 0.1, stress, tangent);
            for (int p = 0; way < 2 && p < POINTS; p++)
                ph_point_update(point, state[way] + p * size, de + 6 * p, 0.1,
                                stress + 6 * p, way == 0 ? tangent : NULL);
            least[way] = fmin(least[way], clock_of(CLOCK_PROCESS_CPUTIME_ID) - begin);
        }
    }
    const bool same = memcmp(state[0], state[2], size * POINTS * sizeof **state) == 0;
    printf("{\"bench\": \"%s\", \"%s\": %d, \"ns_tangent\": %.4g, \"ns_stress\": "
           "%.4g, "
           "\"ns_of_1000\": %.4g, \"state_bytes\": %zu, \"same_bits\": %s}\n",
           kind, strcmp(kind, "damage") == 0 ? "segments" : "terms", size_of_law,
           1e9 * least[0] / POINTS, 1e9 * least[1] / POINTS, 1e9 * least[2] / POINTS,
           size * sizeof(double), same ? "true" : "false");
    for (int way = 0; way < 3; way++)
        free(state[way]);
    free(de);
    free(stress);
    ph_point_material_free(&point);
}

/* ---- single precision beside double -------------------------------------------------- */

static ph_result *solved(ph_problem *p, const char *precision, double tolerance,
                         double *cpu)
{
    ph_error err = PH_ERROR_INIT;
    ph_result *res = NULL;
    p->solver = (ph_solver_params){.kind = "fft_cg",
                                   .precision = precision,
                                   .tolerance = tolerance,
                                   .max_iterations = 20000};
    double start = clock_of(CLOCK_PROCESS_CPUTIME_ID);
    if (ph_homogenise(p, &(ph_ctx){.threads = 1}, &res, &err) != PH_OK)
        fprintf(stderr, "%s %g: %s\n", precision, tolerance, err.msg);
    *cpu = clock_of(CLOCK_PROCESS_CPUTIME_ID) - start;
    if (res && !res->converged) ph_result_free(&res);
    return res;
}

static double apart(const ph_result *a, const ph_result *b)
{
    if (!a || !b) return (double)NAN;
    ph_sym4 d = ph_sym4_combine(1.0, &a->stiffness, -1.0, &b->stiffness);
    return ph_sym4_norm(&d) / ph_sym4_norm(&b->stiffness);
}

/* Fibres of P2 or spheres of SC, cut cells, one contrast; 0: void. */
static scene scene_of_contrast(bool space, int n, double contrast)
{
    ph_error err = PH_ERROR_INIT;
    scene s = scene_new(space ? "SC" : "P2", n, "nosb", false);
    ph_material *m = s.micro->materials;
    if (ph_material_isotropic("m", 1.0, 0.3, &m[0], &err)) die("precision", &err);
    if (contrast == 0.0)
        m[1] = ph_material_void("f");
    else if (ph_material_isotropic("f", contrast, 0.3, &m[1], &err))
        die("precision", &err);
    return s;
}

/* A number of JSON, which knows no NaN. */
static void put_number(const char *key, double x)
{
    if (isnan(x))
        printf(", \"%s\": null", key);
    else
        printf(", \"%s\": %.2g", key, x);
}

/* Errors of the tensor against 1e-11, by contrast (0: void) and tolerance. */
static void bench_precision_errors(int n)
{
    static const double contrast[] = {1, 10, 100, 1e3, 1e4, 1e5, 1e6, 0.01, 1e-4, 0};
    for (size_t e = 0; e < sizeof contrast / sizeof *contrast; e++) {
        scene s = scene_of_contrast(true, n, contrast[e]);
        double cpu;
        ph_result *exact = solved(&s.problem, "double", 1e-11, &cpu);
        for (int t = 2; exact && t <= 10; t += t == 4 || t == 5 ? 1 : 2) {
            double tolerance = t == 5 ? 1e-5 : pow(10.0, -t);
            ph_result *two = solved(&s.problem, "double", tolerance, &cpu);
            ph_result *one = solved(&s.problem, "single", tolerance, &cpu);
            printf("{\"bench\": \"precision_errors\", \"problem\": \"SC\", \"n\": %d, "
                   "\"contrast\": %g, \"tolerance\": %g",
                   n, contrast[e], tolerance);
            put_number("error_double", apart(two, exact));
            put_number("error_single", apart(one, exact));
            printf(", \"iterations_double\": %ld, \"iterations_single\": %ld}\n",
                   two ? two->work.iterations : -1, one ? one->work.iterations : -1);
            fflush(stdout);
            ph_result_free(&two);
            ph_result_free(&one);
        }
        ph_result_free(&exact);
        scene_free(&s);
    }
}

/* CPU seconds, the least of some alternating pairs, and bytes, by tolerance. */
static void bench_precision(bool space, int n, double contrast, int pairs)
{
    static const double tolerance[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8};
    static const char *const name[2] = {"double", "single"};
    scene s = scene_of_contrast(space, n, contrast);
    for (size_t t = 0; t < sizeof tolerance / sizeof *tolerance; t++) {
        double least[2] = {INFINITY, INFINITY}, cpu;
        double bytes[2] = {NAN, NAN};
        for (int i = 0; i < 2 * pairs; i++) {
            ph_result *res = solved(&s.problem, name[i % 2], tolerance[t], &cpu);
            least[i % 2] = fmin(least[i % 2], cpu);
            if (res) bytes[i % 2] = (double)res->work.peak_bytes;
            ph_result_free(&res);
        }
        printf("{\"bench\": \"precision\", \"problem\": \"%s\", \"n\": %d, \"contrast\": "
               "%g, \"tolerance\": %g, \"cpu\": %.4g, \"cpu_single\": %.4g, "
               "\"cpu_ratio\": %.3f, \"bytes_per_node\": %.4g, \"bytes_ratio\": %.3f}\n",
               space ? "SC" : "P2", n, contrast, tolerance[t], least[0], least[1],
               least[1] / least[0], bytes[0] / pow(n, space ? 3 : 2),
               bytes[1] / bytes[0]);
        fflush(stdout);
    }
    scene_free(&s);
}

static int run(const char *word)
{
    ptrdiff_t n[3] = {1, 1, 1};
    char name[32], model[32] = "nosb", route[32] = "auto";
    int size, count;
    double horizon = 0.0;
    if (sscanf(word, "solve:%31[^:]:%d:%31s", name, &size, model) >= 2)
        bench_solve(name, size, model);
    else if (sscanf(word, "random:%31[^:]:%d:%d", name, &size, &count) == 3 && count > 0)
        bench_random(name, size, count);
    else if (sscanf(word, "threads:%31[^:]:%d", name, &size) == 2)
        bench_threads(name, size);
    else if (sscanf(word, "failure:%31[^:]:%d:%31s", name, &size, model) >= 2)
        bench_failure(name, size, strcmp(model, "every_event") == 0);
    else if (sscanf(word, "clay:%d", &size) == 1)
        bench_clay(size);
    else if (sscanf(word, "precision_errors:%d", &size) == 1)
        bench_precision_errors(size);
    else if (sscanf(word, "precision:%31[^:]:%d:%lf:%d", name, &size, &horizon, &count) ==
             4)
        bench_precision(strcmp(name, "SC") == 0, size, horizon, count);
    else if (sscanf(word, "stepping:%31[^:]:%d", name, &size) == 2)
        bench_stepping(name, size);
    else if (sscanf(word, "relax:%31[^:]:%d", name, &size) == 2)
        bench_relax(name, size);
    else if (sscanf(word, "point:%d", &size) == 1)
        bench_point("point", size);
    else if (sscanf(word, "damage:%d", &size) == 1)
        bench_point("damage", size);
    else if (sscanf(word, "clay_batch:%d", &size) == 1)
        bench_clay_batch(size);
    else if (sscanf(word, "horizon:%tdx%tdx%td", &n[0], &n[1], &n[2]) == 3)
        bench_horizon(n);
    else if (sscanf(word, "iteration:%tdx%tdx%td:%31[^:]:%lf:%31s", &n[0], &n[1], &n[2],
                    name, &horizon, route) >= 4)
        iteration(n, name, horizon, route_called(route), true);
    else
        return 2;
    fflush(stdout);
    return 0;
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (run(argv[i]) != 0) {
            fprintf(stderr, "bench: cannot read '%s'\n", argv[i]);
            return 2;
        }
    return 0;
}
