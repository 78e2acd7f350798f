/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the reading of a fields file is made of. */
#ifndef PH_IO_FIELDS_READER_H
#define PH_IO_FIELDS_READER_H

#include "io/fields.h"

typedef struct ph_i_fields_reader {
    const char *path;
    hid_t file;
    ph_grid grid;
    double *buffer; /* one array on its way in */
} ph_i_fields_reader;

/** A scalar of the cells. @param[out] to [cells] */
ph_status ph_i_read_cells(ph_i_fields_reader *r, hid_t group, const char *name,
                          double *to, ph_error *err);
/** Whether displacement is on the closed mesh; of a file without loads it does not matter. */
ph_status ph_i_read_extra(ph_i_fields_reader *r, int *extra, ph_error *err);
/** The fields in the group `name`. */
ph_status ph_i_read_load(ph_i_fields_reader *r, const char *name, int load, int extra,
                         ph_fields *fields, ph_error *err);
/** Loads in the group `where`, those that are there as bits of *there. */
ph_status ph_i_read_loads(ph_i_fields_reader *r, const char *where, unsigned loads,
                          int extra, unsigned *there, int *count, ph_fields **fields,
                          ph_error *err);
/** NULL-safe. */
void ph_i_read_fields_free(int count, ph_fields *fields);

#endif
