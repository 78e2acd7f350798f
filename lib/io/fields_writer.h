/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the writing of a fields file is made of. */
#ifndef PH_IO_FIELDS_WRITER_H
#define PH_IO_FIELDS_WRITER_H

#include "io/fields.h"
#include "io/hdf5_sink.h"

typedef struct ph_i_fields_writer {
    const char *path; /* for messages */
    const ph_grid *grid;
    hid_t file;
    ph_i_hdf5_sink sink;
    void *buffer; /* one array on its way out */
} ph_i_fields_writer;

/** A scalar of the cells into a group, compressed. */
ph_status ph_i_write_cells(ph_i_fields_writer *w, hid_t group, const char *name,
                           const double *value, ph_error *err);
/** Macro strain, displacement, strain and stress into a group. */
ph_status ph_i_write_field(ph_i_fields_writer *w, hid_t group, const ph_fields *fields,
                           bool at_nodes, ph_error *err);
/** The same into a group of its own, named by the load. */
ph_status ph_i_write_load(ph_i_fields_writer *w, hid_t loads, const ph_fields *fields,
                          bool at_nodes, ph_error *err);
/** The steps of damage (fields_steps.c). */
ph_status ph_i_write_steps(ph_i_fields_writer *w, const ph_result *result, ph_error *err);

#endif
