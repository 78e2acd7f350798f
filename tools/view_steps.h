/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIEW_STEPS_H
#define VIEW_STEPS_H

#include <perihom.h>

typedef struct view_steps_request {
    const char *path;   /* of the fields file */
    const char *folder; /* where pictures go */
    const char *field;  /* NULL: damage */
    unsigned loads;     /* bits */
    int axis;
    bool quiet;
    int *drawn; /* counts the pictures */
} view_steps_request;

/** damage_0000.png ... from 0 to 1; of another field FIELD-loadNN_0000.png, or of a loading
 *  FIELD_0000.png, all with one scale. Nothing where the file has no steps. */
ph_status view_steps(const view_steps_request *request, const ph_fields_file *file,
                     ph_error *err);

#endif
