/* SPDX-License-Identifier: GPL-3.0-or-later */
#define PH_SINGLE
#include "space/fft.c" /* NOLINT(bugprone-suspicious-include): compiled twice */
