/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a case to the composite that the analytic estimates see. */
#ifndef TOOLS_BOUNDS_H
#define TOOLS_BOUNDS_H

#include <perihom_rve.h>

/** A composite with its memory, in a frame of its own. */
typedef struct bounds_composite {
    ph_composite composite;
    ph_material
        *material;    /* [n] matrix first, only those that occur, turned into the frame */
    double *fraction; /* [n] */
    double R[9];      /* from the frame (fibre along 3, layers across 1) to the case's */
    char note[256];   /* what the shape simplifies, or "" */
} bounds_composite;

/** Fractions by building the microstructure, shape and directions from the inclusions. */
ph_status bounds_composite_init(const ph_case *c, bounds_composite *out, ph_error *err);
void bounds_composite_free(bounds_composite *b);
/** Evaluate a method and turn its tensor into the axes of the case. */
ph_status bounds_evaluate(const bounds_composite *b, const ph_estimate_method *method,
                          ph_sym4 *out, ph_error *err);
/** "sphere", "cylinder", "spheroid" or "laminate". */
const char *bounds_shape_name(ph_inclusion_shape shape);

#endif
