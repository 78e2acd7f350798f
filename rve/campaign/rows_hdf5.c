/* SPDX-License-Identifier: GPL-3.0-or-later */
/* campaign.h5: one row a realisation, in order. Written in one pass over the lines. */
#include "campaign/campaign.h"
#include "io/draft.h"
#include "io/hdf5.h"
#include "io/hdf5_sink.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 4096 };

/* A column that is filled block by block. */
typedef struct column {
    hid_t set;
    hid_t type; /* in memory */
} column;

typedef struct rows {
    ph_i_store *store;
    const char *path;
    hid_t file;
    column point, level, realisation, failed, iterations; /* level: with models only */
    column output[PH_MAX_OUTPUTS];
    int32_t *p, *l, *it;
    int64_t *i;
    uint8_t *f;
    double *value; /* [noutputs][BLOCK] */
} rows;

/* The same bytes for the same rows: no times in the file. */
static ph_status create(rows *r, const char *name, hid_t type, column *c, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    hsize_t n = r->store->count, chunk = BLOCK;
    hid_t space = -1, how = -1;
    c->type = type;
    PH_HDF5(space = H5Screate_simple(1, &n, NULL), "write");
    PH_HDF5(how = H5Pcreate(H5P_DATASET_CREATE), "write");
    PH_HDF5(H5Pset_obj_track_times(how, false), "write");
    if (n > BLOCK) {
        PH_HDF5(H5Pset_chunk(how, 1, &chunk), "write");
        PH_HDF5(H5Pset_deflate(how, 4), "write");
    }
    PH_HDF5(c->set =
                H5Dcreate2(r->file, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT),
            "write");
out:
    if (how >= 0) H5Pclose(how);
    if (space >= 0) H5Sclose(space);
    return st;
}

static ph_status put(const rows *r, const column *c, hsize_t first, hsize_t n,
                     const void *data, ph_error *err)
{
    ph_status st = PH_OK;
    const char *path = r->path;
    hid_t file = -1, memory = -1;
    PH_HDF5(file = H5Dget_space(c->set), "write");
    PH_HDF5(memory = H5Screate_simple(1, &n, NULL), "write");
    PH_HDF5(H5Sselect_hyperslab(file, H5S_SELECT_SET, &first, NULL, &n, NULL), "write");
    PH_HDF5(H5Dwrite(c->set, c->type, memory, file, H5P_DEFAULT, data), "write");
out:
    if (memory >= 0) H5Sclose(memory);
    if (file >= 0) H5Sclose(file);
    return st;
}

static ph_status create_all(rows *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = r->store->c;
    PH_TRY(create(r, "point", H5T_NATIVE_INT32, &r->point, err));
    if (c->nmodels > 1) PH_TRY(create(r, "level", H5T_NATIVE_INT32, &r->level, err));
    PH_TRY(create(r, "realisation", H5T_NATIVE_INT64, &r->realisation, err));
    PH_TRY(create(r, "failed", H5T_NATIVE_UINT8, &r->failed, err));
    PH_TRY(create(r, "iterations", H5T_NATIVE_INT32, &r->iterations, err));
    for (int k = 0; k < c->noutputs; k++) {
        char name[sizeof c->output[k].name];
        strcpy(name, c->output[k].name);
        for (char *p = name; *p; p++)
            if (*p == '/') *p = '_'; /* of a material; to HDF5 it is a folder */
        PH_TRY(create(r, name, H5T_NATIVE_DOUBLE, &r->output[k], err));
    }
    PH_ALLOC(r->p, BLOCK, "rows of realisations");
    PH_ALLOC(r->l, BLOCK, "rows of realisations");
    PH_ALLOC(r->it, BLOCK, "rows of realisations");
    PH_ALLOC(r->i, BLOCK, "rows of realisations");
    PH_ALLOC(r->f, BLOCK, "rows of realisations");
    PH_ALLOC(r->value, BLOCK * (size_t)c->noutputs, "rows of realisations");
out:
    return st;
}

static ph_status put_block(rows *r, size_t first, size_t n, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = r->store->c;
    ph_i_record one;
    for (size_t k = 0; k < n; k++) {
        PH_TRY(ph_i_store_get(r->store, &r->store->entry[first + k], &one, err));
        r->p[k] = one.point % c->npoints;
        r->l[k] = one.point / c->npoints;
        bool nothing = one.status != PH_OK || ph_i_is_fillers(c, one.point);
        r->i[k] = one.i;
        r->f[k] = one.status != PH_OK;
        r->it[k] = one.iterations;
        for (int o = 0; o < c->noutputs; o++)
            r->value[o * BLOCK + (int)k] = nothing ? (double)NAN : one.value[o];
    }
    PH_TRY(put(r, &r->point, first, n, r->p, err));
    if (c->nmodels > 1) PH_TRY(put(r, &r->level, first, n, r->l, err));
    PH_TRY(put(r, &r->realisation, first, n, r->i, err));
    PH_TRY(put(r, &r->failed, first, n, r->f, err));
    PH_TRY(put(r, &r->iterations, first, n, r->it, err));
    for (int o = 0; o < c->noutputs; o++)
        PH_TRY(put(r, &r->output[o], first, n, r->value + (ptrdiff_t)o * BLOCK, err));
out:
    return st;
}

/* Values of the swept keys, as attributes of the file: key 0 is "key0", its values at the
 * points "values0", NaN where the value is no number. */
static ph_status put_keys(rows *r, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_campaign *c = r->store->c;
    const char *path = r->path;
    double *x = NULL;
    PH_TRY(ph_i_hdf5_put_text(r->file, "schema", "perihom.campaign.rows/1", path, err));
    PH_ALLOC(x, c->npoints, "the values of a key");
    for (int k = 0; k < c->nkeys && c->npoints < 5000; k++) {
        char name[32];
        snprintf(name, sizeof name, "key%d", k);
        PH_TRY(ph_i_hdf5_put_text(r->file, name, c->key[k], path, err));
        for (int p = 0; p < c->npoints; p++)
            x[p] = c->point[p].number[k];
        snprintf(name, sizeof name, "values%d", k);
        PH_TRY(ph_i_hdf5_put_doubles(r->file, name, c->npoints, x, path, err));
    }
out:
    free(x);
    return st;
}

static void close_set(column *c)
{
    if (c->set > 0) H5Dclose(c->set);
    c->set = 0;
}

static void close_all(rows *r)
{
    close_set(&r->point);
    close_set(&r->level);
    close_set(&r->realisation);
    close_set(&r->failed);
    close_set(&r->iterations);
    for (int k = 0; k < r->store->c->noutputs; k++)
        close_set(&r->output[k]);
    free(r->p);
    free(r->l);
    free(r->it);
    free(r->i);
    free(r->f);
    free(r->value);
}

static ph_status fill(rows *r, const ph_i_hdf5_sink *sink, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(create_all(r, err));
    PH_TRY(put_keys(r, err));
    for (size_t first = 0; first < r->store->count; first += BLOCK) {
        size_t left = r->store->count - first;
        PH_TRY(put_block(r, first, left < BLOCK ? left : BLOCK, err));
        if (sink->failed) break;
    }
out:
    return st;
}

ph_status ph_i_rows_write(ph_i_store *store, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_draft draft = {.open = false};
    ph_i_hdf5_quiet quiet;
    ph_i_hdf5_sink sink = {0};
    rows r = {.store = store, .path = path, .file = -1};
    hid_t access = -1, how = -1;
    ph_i_hdf5_begin(&quiet);
    PH_TRY(ph_i_draft_begin(&draft, path, err));
    PH_HDF5(access = ph_i_hdf5_sink_access(&sink), "write");
    PH_HDF5(how = H5Pcreate(H5P_FILE_CREATE), "write");
    PH_HDF5(H5Pset_obj_track_times(how, false), "write");
    PH_HDF5(r.file = H5Fcreate(draft.path, H5F_ACC_TRUNC, how, access), "write");
    st = fill(&r, &sink, err);
    close_all(&r);
    if (H5Fclose(r.file) < 0 && st == PH_OK) st = ph_i_hdf5_error(err, "write", path);
    if (st == PH_OK && sink.failed) st = ph_i_io_error(err, "write", path, sink.failed);
    PH_TRY(st);
    PH_TRY(ph_i_draft_commit(&draft, err));
out:
    if (how >= 0) H5Pclose(how);
    if (access >= 0) H5Pclose(access);
    ph_i_hdf5_end(&quiet);
    ph_i_draft_discard(&draft);
    return st;
}
