/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of placing and painting random fibres at constant density: argument N, an N^3 grid.
 * Hard-core fibres four cells thick and twelve long, a tenth of the volume; 512 holds 1e5.
 * One JSON line an argument: CPU seconds, the same per filler and voxel, peak memory. */
#include <perihom_rve.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double cpu(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int fail(const ph_error *err)
{
    fprintf(stderr, "bench_fillers: %s\n", err->msg);
    return 1;
}

static int bench(long n)
{
    const long count =
        (long)(1e5 * (double)n * (double)n * (double)n / (512.0 * 512.0 * 512.0));
    ph_error err = PH_ERROR_INIT;
    ph_case *c = NULL;
    ph_packing *packing = NULL;
    ph_microstructure *micro = NULL;
    char text[1024];
    snprintf(
        text, sizeof text,
        "perihom: 1\nmaterials: {m: {E: 1, nu: 0.3}, f: {E: 10, nu: 0.3}}\n"
        "microstructure: {dimension: 3, size: [%ld, %ld, %ld], nodes: [%ld, %ld, %ld],\n"
        "  matrix: m, interface: node_centre, fillers: [{shape: fibre, material: f,\n"
        "  count: %ld, thickness: 4, length: 12, placement: {gap: 0.5}}]}\n",
        n, n, n, n, n, n, count);
    if (ph_case_parse(text, strlen(text), "bench", NULL, 0, &c, NULL, &err))
        return fail(&err);
    double start = cpu();
    if (ph_rve_place(c, &packing, &err)) return fail(&err);
    double placed = cpu();
    if (ph_rve_paint(c, packing, &micro, &err)) return fail(&err);
    double painted = cpu(), fraction[2];
    struct rusage use;
    getrusage(RUSAGE_SELF, &use);
    ph_microstructure_fractions(micro, fraction);
    printf("{\"bench\": \"fillers\", \"n\": %ld, \"fillers\": %ld, \"fraction\": %.4g, "
           "\"place\": %.4g, \"paint\": %.4g, \"place_us_per_filler\": %.4g, "
           "\"paint_ns_per_voxel\": %.4g, \"peak_MB\": %.4g}\n",
           n, count, fraction[1], placed - start, painted - placed,
           1e6 * (placed - start) / (double)count,
           1e9 * (painted - placed) / ((double)n * (double)n * (double)n),
           (double)use.ru_maxrss / 1024.0);
    fflush(stdout);
    ph_microstructure_free(&micro);
    ph_packing_free(&packing);
    ph_case_free(&c);
    return 0;
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (bench(strtol(argv[i], NULL, 10))) return 1;
    return 0;
}
