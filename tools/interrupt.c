/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t caught, count;

static void on_signal(int number)
{
    caught = number;
    count = count + 1;
    if (count < 3) return;
    /* Nobody looks at the flag: go. */
    signal(number, SIG_DFL);
    raise(number);
}

void interrupt_install(void)
{
    static const int numbers[] = {SIGINT, SIGTERM};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction old, act = {.sa_handler = on_signal};
        sigemptyset(&act.sa_mask);
        act.sa_flags = SA_RESTART;
        if (sigaction(numbers[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaction(numbers[i], &act, NULL);
    }
}

int interrupt_signal(void)
{
    return caught;
}

void interrupt_reraise(void)
{
    if (!caught) return;
    signal(caught, SIG_DFL);
    raise(caught);
}
