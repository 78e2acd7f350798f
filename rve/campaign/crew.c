/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How many worker processes, and how many threads each. */
#include "campaign/campaign.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <math.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

static int processors(void)
{
#ifdef _OPENMP
    return omp_get_num_procs(); /* respects the affinity that a batch system has set */
#else
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (int)n : 1;
#endif
}

static double nodes_of(const ph_case *c)
{
    double n = 1.0;
    for (int d = 0; d < 3; d++)
        n *= c->nodes[d] > 0 ? (double)c->nodes[d] : 1.0;
    return n;
}

double ph_i_crew_bytes(const ph_campaign *c, double enough)
{
    int ends[2], largest = 0, status;
    double bytes = 0.0;
    for (int p = 1; p < c->npoints; p++)
        if (nodes_of(c->point[p].c) > nodes_of(c->point[largest].c)) largest = p;
    /* small ones need no question: 1 kB a node is more than any solver takes */
    const ph_case *one = c->point[largest].c;
    if (one->voxels.file[0] == 0 && nodes_of(one) < 3e4 && 1e3 * nodes_of(one) <= enough)
        return 1e3 * nodes_of(one);
    if (pipe(ends) != 0) return 0.0;
    pid_t pid = fork();
    if (pid == 0) {
        ph_microstructure *micro = NULL;
        ph_estimate estimate = {0};
        ph_problem problem = {.interface = one->interface,
                              .model = one->model,
                              .constraint = one->constraint,
                              .solver = one->solver};
        signal(SIGINT, SIG_IGN);
        if (ph_rve_build(one, &micro, NULL) == PH_OK) {
            problem.micro = micro;
            if (ph_homogenise_estimate(&problem, &estimate, NULL) == PH_OK)
                bytes = (double)estimate.bytes + 8.0 * nodes_of(one);
        }
        _exit(write(ends[1], &bytes, sizeof bytes) != sizeof bytes);
    }
    close(ends[1]);
    if (pid > 0) {
        if (read(ends[0], &bytes, sizeof bytes) != sizeof bytes) bytes = 0.0;
        waitpid(pid, &status, 0);
    }
    close(ends[0]);
    return bytes;
}

void ph_i_crew_choose(const ph_campaign *c, const ph_campaign_params *params,
                      int *workers, int *threads)
{
    int jobs = params->jobs > 0 ? params->jobs : processors();
    double memory = (double)params->memory, each = ph_i_crew_bytes(c, INFINITY);
    if (c->memory > 0 && !(memory > 0 && memory < c->memory)) memory = c->memory;
    if (memory == 0.0)
        memory = 0.8 * (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    *threads = params->threads;
    *workers = *threads > 0 && *threads < jobs ? jobs / *threads
               : *threads > 0                  ? 1
                                               : jobs;
    if (each > 0.0 && *workers * each > memory) *workers = (int)(memory / each);
    if (*workers < 1) *workers = 1;
    if (*workers > 256) *workers = 256;
    if (*threads == 0) *threads = jobs / *workers;
}
