/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every public function with wrong arguments: none crashes, and what returns a status says
 * which: PH_EINVAL where all is NULL. The calls are made from the headers (make_calls.py), so that none is forgotten; each
 * runs in a process of its own. */
#include <perihom_rve.h>

#include "check.h"

#include <perihom_calibrate.h>
#include <perihom_campaign.h>
#include <perihom_error_bar.h>
#include <perihom_estimators.h>
#include <perihom_fidelity.h>
#include <perihom_trade.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    INPUTS = 1,
    OUTPUTS = 2,
    OUT_OF_RANGE = 4,
    VARIANTS = 8,
    BUFFERS = 16,
    BYTES = 1 << 16
};

struct call {
    const char *name;
    bool status;  /* it returns one */
    bool outputs; /* it has some */
    ph_status (*make)(int variant);
};

static double buffer[BUFFERS][BYTES / sizeof(double)];
static int taken;

static void *zeroed(void)
{
    return memset(buffer[taken++ % BUFFERS], 0, BYTES);
}

static void *in(int v)
{
    return v & INPUTS ? zeroed() : NULL;
}

static void *out(int v)
{
    return v & OUTPUTS ? zeroed() : NULL;
}

static const char *text(int v)
{
    return v & INPUTS ? "" : NULL;
}

static double number(int v)
{
    return v & OUT_OF_RANGE ? (double)INFINITY : (double)NAN;
}

static int integer(int v)
{
    return v & OUT_OF_RANGE ? -1 : 0;
}

#include "calls.inc"

/* Calls that are in order with what is not there or empty. */
static bool may_succeed(const struct call *c, int v)
{
    static const char *const absent[] = {
        "ph_error_set",      /* returns the status that it is given */
        "ph_prony_copy",     /* no series: an elastic material's */
        "ph_fe2_accept_all", /* no points */
    };
    const bool there = (v & OUTPUTS) || !c->outputs;
    for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
        if (there && strcmp(c->name, absent[i]) == 0) return true;
    return there && (v & INPUTS); /* a zeroed structure may be an empty one */
}

/* Exit code of the child: the status; or minus the signal that ended it. */
static int run(const struct call *c, int v)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        static const int fatal[] = {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL};
        for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++)
            signal(fatal[i], SIG_DFL); /* not cmocka's, which would go on */
        alarm(20);
        _exit((int)c->make(v));
    }
    int code = 0;
    if (child < 0 || waitpid(child, &code, 0) != child) return -1;
    return WIFEXITED(code) ? WEXITSTATUS(code) : -WTERMSIG(code);
}

static void wrong_arguments(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        for (int v = 0; v < VARIANTS; v++) {
            const int got = run(&calls[i], v);
            const bool may = may_succeed(&calls[i], v);
            const bool none = !(v & (INPUTS | OUTPUTS)) && !may;
            const bool good = got >= 0 && got != PH_EINTERNAL &&
                              (!calls[i].status || got == PH_EINVAL ||
                               (!none && (got != PH_OK || may)));
            if (good) continue;
            check_failures++;
            print_error("%s, inputs %s, outputs %s, numbers %s: %s %d\n", calls[i].name,
                        v & INPUTS ? "zeroed" : "NULL", v & OUTPUTS ? "zeroed" : "NULL",
                        v & OUT_OF_RANGE ? "-1 and infinity" : "0 and NaN",
                        got < 0 ? "signal" : "status", abs(got));
        }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(wrong_arguments)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
