/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "interrupt.h"
#include "tools.h"

#include <gsl/gsl_errno.h>

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const verb verbs[] = {
    {"compute", "run", "effective properties of a case", cmd_run},
    {"compute", "check", "what a case means and what it would take; solves nothing",
     cmd_check},
    {"compute", "bounds", "analytic bounds and estimates of a case", cmd_bounds},
    {"compute", "fit", "Prony series of a modulus from measurements", cmd_fit},
    {"compute", "calibrate", "unknowns of a case from measurements", cmd_calibrate},
    {"compute", "campaign", "many realisations, sweeps; resumes", cmd_campaign},
    {"compute", "trade", "what accuracy costs: settings, errors, cost", cmd_trade},
    {"microstructure", "generate", "only the microstructure: picture, voxels, statistics",
     cmd_generate},
    {"look", "view", "pictures of a result", cmd_view},
    {"look", "export", "a result as a material card for another code", cmd_export},
    {"look", "list", "the catalogues of this build: models, solvers, shapes ...",
     cmd_list},
    {"about", "version", "version, licence, compiler and libraries", cmd_version},
    {"about", "help", "this list, or the help of one verb", cmd_help},
    {NULL, NULL, NULL, NULL},
};

const verb *verb_find(const char *name)
{
    for (const verb *v = verbs; v->name; v++)
        if (strcmp(v->name, name) == 0) return v;
    return NULL;
}

int verb_unknown(const char *name)
{
    const char *names[sizeof verbs / sizeof *verbs];
    size_t n = 0;
    for (const verb *v = verbs; v->name; v++)
        names[n++] = v->name;
    const char *near = ph_nearest_name(name, names, n);
    if (near)
        talk("unknown verb '%s'; did you mean '%s'?", name, near);
    else
        talk("unknown verb '%s'", name);
    fprintf(stderr, "'perihom help' lists the verbs\n");
    return PH_EUSAGE;
}

/* Data that did not reach its reader is a failure. A reader that left early (a closed pipe)
 * is not worth a message: end by SIGPIPE, as the shell expects. */
static int close_stdout(int code)
{
    errno = 0;
    if (!ferror(stdout) && fflush(stdout) == 0) return code;
    if (errno == EPIPE) {
        signal(SIGPIPE, SIG_DFL);
        raise(SIGPIPE);
    }
    talk("error: standard output: %s", errno ? strerror(errno) : "could not be written");
    return code ? code : ph_status_exit_code(PH_EIO);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2) {
        help_overview(stderr);
        return PH_EUSAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) argv[1] = "help";
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0)
        argv[1] = "version";
    const verb *v = verb_find(argv[1]);
    return v ? v->run(argc - 1, argv + 1) : verb_unknown(argv[1]);
}

/* Threads that spin while they wait make a busy machine many times slower. The OpenMP
 * library reads its settings before main, so the program starts itself once more. */
static void wait_asleep(char **argv)
{
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT")) return;
    if (setenv("OMP_WAIT_POLICY", "passive", 1) == 0) execv("/proc/self/exe", argv);
}

int main(int argc, char **argv)
{
    wait_asleep(argv);
    /* GSL would abort; its errors come back as status codes. */
    gsl_set_error_handler_off();
    /* A pager that closes must not cost a result that is about to be written. */
    signal(SIGPIPE, SIG_IGN);
    /* A limit of the file size is an error of the write, with its message. */
    signal(SIGXFSZ, SIG_IGN);
    int code = close_stdout(dispatch(argc, argv));
    interrupt_reraise();
    return code;
}
