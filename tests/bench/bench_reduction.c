/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What cheaper models save: a campaign with variance_reduction beside the same one without,
 * one after the other, to the same half width.
 *
 *   bench_reduction CASE QUANTITY RELATIVE_HALF_WIDTH
 *   bench_reduction data/cases/epoxy-clay-exfoliated.yaml E1 0.005
 *
 * Prints one JSON object. Times are CPU seconds of the worker process, pilots included. */
#define _XOPEN_SOURCE 700
#include <perihom_campaign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

static double children(void)
{
    struct rusage u;
    getrusage(RUSAGE_CHILDREN, &u);
    return (double)u.ru_utime.tv_sec + 1e-6 * (double)u.ru_utime.tv_usec +
           (double)u.ru_stime.tv_sec + 1e-6 * (double)u.ru_stime.tv_usec;
}

static void die(const ph_error *err)
{
    fprintf(stderr, "bench_reduction: %s\n", err->msg);
    exit(1);
}

static double run(char *const *argv, const char *reduction, ph_campaign_result **r)
{
    ph_error err = PH_ERROR_INIT;
    ph_campaign *c = NULL;
    char text[2048], file[128], folder[] = "/tmp/perihom-bench-XXXXXX", real[1024];
    if (!mkdtemp(folder) || !realpath(argv[1], real)) exit(1);
    int n = snprintf(text, sizeof text,
                     "campaign: 1\ncase: %s\noutputs: [%s]\nvariance_reduction: %s\n"
                     "realisations: {at_most: 100000, until: {quantity: %s, "
                     "relative_half_width: %s}}\n",
                     real, argv[2], reduction, argv[2], argv[3]);
    snprintf(file, sizeof file, "%s/c.yaml", folder);
    if (ph_write_file(file, text, (size_t)n, &err) ||
        ph_campaign_read(file, NULL, 0, &c, NULL, &err))
        die(&err);
    const ph_campaign_params p = {.folder = folder, .jobs = 1, .threads = 1};
    double start = children();
    ph_status st = ph_campaign_run(c, &p, r, &err);
    if (st != PH_OK && st != PH_EPARTIAL) die(&err);
    ph_campaign_free(&c);
    return children() - start;
}

int main(int argc, char **argv)
{
    ph_campaign_result *plain = NULL, *reduced = NULL;
    if (argc != 4) {
        fprintf(stderr, "usage: bench_reduction CASE QUANTITY RELATIVE_HALF_WIDTH\n");
        return 2;
    }
    double with = run(argv, "auto", &reduced), without = run(argv, "none", &plain);
    const ph_estimation *e = reduced->point[0].estimation;
    const ph_interval *a = &reduced->point[0].output[0].mean,
                      *b = &plain->point[0].output[0].mean;
    printf("{\"bench\": \"reduction\", \"quantity\": \"%s\", \"half_width\": %s, "
           "\"method\": \"%s\", \"cpu\": %.4g, \"cpu_plain\": %.4g, \"ratio\": %.3g, "
           "\"work_ratio\": %.3g, \"mean\": %.6g, \"mean_plain\": %.6g, \"n\": [",
           argv[2], argv[3], e->method < 0 ? "none" : ph_estimators[e->method].info.name,
           with, without, without / with, e->estimate.plain_cost / e->estimate.cost,
           a->mean, b->mean);
    for (int l = 0; l < e->estimate.nlevels; l++)
        printf("%s%td", l ? ", " : "", e->estimate.level[l].n);
    printf("], \"n_plain\": %lld}\n", (long long)plain->point[0].output[0].n);
    ph_campaign_result_free(&plain);
    ph_campaign_result_free(&reduced);
    return 0;
}
