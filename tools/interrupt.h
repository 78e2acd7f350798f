/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SIGINT and SIGTERM as a flag that long computations look at. */
#ifndef TOOLS_INTERRUPT_H
#define TOOLS_INTERRUPT_H

#include <stdbool.h>

/** From now on SIGINT and SIGTERM set the flag; the third one stops at once. A signal that
 *  the parent had set to be ignored stays ignored. */
void interrupt_install(void);
/** The signal that arrived, or 0. */
int interrupt_signal(void);
/** If a signal arrived, end the process by it, so that the shell sees 128 + signal. */
void interrupt_reraise(void);

#endif
