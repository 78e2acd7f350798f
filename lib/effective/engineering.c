/* SPDX-License-Identifier: GPL-3.0-or-later */
typedef int ph_i_empty;
