/* SPDX-License-Identifier: GPL-3.0-or-later */
#define PH_SINGLE
#include "model/cells.c" /* NOLINT(bugprone-suspicious-include): compiled twice */
