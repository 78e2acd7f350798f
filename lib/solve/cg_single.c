/* SPDX-License-Identifier: GPL-3.0-or-later */
#define PH_SINGLE
#include "solve/cg.c" /* NOLINT(bugprone-suspicious-include): compiled twice */
