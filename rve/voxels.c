/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "voxels.h"

#include "core/check.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

ph_status ph_i_voxels_alloc(ph_voxel_data *v, size_t bytes, size_t available,
                            ph_error *err)
{
    ph_status st = PH_OK;
    size_t cells = 1, most = available / bytes;
    for (int a = 0; a < 3; a++)
        PH_CHECK(v->n[a] > 0, PH_EINVAL, "axis %d has %td voxels", a + 1, v->n[a]);
    for (int a = 0; a < 3; a++) {
        PH_CHECK((size_t)v->n[a] <= most / cells, PH_EINVAL,
                 "%td x %td x %td voxels are more than the file holds", v->n[0], v->n[1],
                 v->n[2]);
        cells *= (size_t)v->n[a];
    }
    PH_ALLOC(v->values, cells, "voxels");
out:
    return st;
}

ph_status ph_i_voxel_value(const ph_voxel_data *v, ptrdiff_t cell, double value,
                           ph_error *err)
{
    ph_status st = PH_OK;
    bool fits = value >= 0 && value <= UINT16_MAX && value == floor(value);
    PH_CHECK(fits, PH_EINVAL,
             "voxel [%td, %td, %td] is %.17g, not a whole number 0 to %d",
             cell / v->n[2] / v->n[1], cell / v->n[2] % v->n[1], cell % v->n[2], value,
             UINT16_MAX);
    v->values[cell] = (uint16_t)value;
out:
    return st;
}

static ph_status read_file(const char *path, unsigned char **data, size_t *size,
                           ph_error *err)
{
    ph_status st = PH_OK;
    struct stat info;
    FILE *f = fopen(path, "rb");
    PH_CHECK(f, PH_EIO, "cannot be opened: %s", strerror(errno));
    PH_CHECK(fstat(fileno(f), &info) == 0 && S_ISREG(info.st_mode), PH_EIO,
             "is not a regular file");
    *size = (size_t)info.st_size;
    *data = malloc(*size ? *size : 1);
    PH_CHECK(*data, PH_ENOMEM, "no memory for its %zu bytes", *size);
    PH_CHECK(fread(*data, 1, *size, f) == *size, PH_EIO, "cannot be read: %s",
             strerror(errno));
out:
    if (f) fclose(f);
    return st;
}

static bool ends_with(const char *path, const char *ending)
{
    size_t n = strlen(path), m = strlen(ending);
    return n > m && strcmp(path + n - m, ending) == 0;
}

static bool is_hdf5(const char *path)
{
    return ends_with(path, ".h5") || ends_with(path, ".hdf5");
}

static ph_status parse(const char *path, const char *dataset, const char *type,
                       const ptrdiff_t n[3], ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    unsigned char *data = NULL;
    size_t size = 0;
    if (is_hdf5(path)) return ph_i_hdf5_read(path, dataset, v, err);
    bool npy = ends_with(path, ".npy"), png = ends_with(path, ".png");
    PH_CHECK(npy || png || ends_with(path, ".raw"), PH_EINVAL,
             "unknown ending: .h5, .npy, .png and .raw can be read");
    PH_TRY(read_file(path, &data, &size, err));
    ph_bytes file = {data, size};
    if (npy)
        PH_TRY(ph_i_npy_parse(file, v, err));
    else if (png)
        PH_TRY(ph_i_png_parse(file, v, err));
    else
        PH_TRY(ph_i_raw_parse(file, type, n, v, err));
out:
    free(data);
    return st;
}

ph_status ph_rve_read_voxels(const char *path, const char *dataset, const char *type,
                             int dimensions, ptrdiff_t n[3], uint16_t **values,
                             ph_error *err)
{
    PH_GIVEN(path && n && values);
    ph_status st = PH_OK;
    ph_voxel_data v = {0};
    *values = NULL;
    PH_CHECK(dimensions == 2 || dimensions == 3, PH_EINVAL,
             "dimension must be 2 or 3, got %d", dimensions);
    ptrdiff_t want[3] = {n[0], n[1], dimensions == 3 ? n[2] : 1};
    PH_TRY(parse(path, dataset, type, want, &v, err));
    PH_CHECK(dimensions == 3 || v.n[2] == 1, PH_EINVAL,
             "has %td x %td x %td voxels, but the case has dimension 2", v.n[0], v.n[1],
             v.n[2]);
    for (int a = 0; a < dimensions; a++)
        PH_CHECK(want[a] == 0 || want[a] == v.n[a], PH_EINVAL,
                 "has %td voxels along axis %d, the case asks for %td nodes", v.n[a],
                 a + 1, want[a]);
    memcpy(n, v.n, sizeof v.n);
    *values = v.values;
    v.values = NULL;
out:
    if (st != PH_OK) ph_error_prefix(err, "%s: ", path);
    free(v.values);
    return st;
}

/* Header and little-endian values into an open file. */
static bool write_values(FILE *f, const char *header, size_t length, bool narrow,
                         const uint16_t *values, ptrdiff_t cells)
{
    unsigned char block[8192];
    if (length && fwrite(header, 1, length, f) != length) return false;
    for (ptrdiff_t i = 0; i < cells;) {
        size_t k = 0;
        for (; i < cells && k + 2 <= sizeof block; i++) {
            block[k++] = (unsigned char)(values[i] & 255);
            if (!narrow) block[k++] = (unsigned char)(values[i] >> 8);
        }
        if (fwrite(block, 1, k, f) != k) return false;
    }
    return true;
}

/* Header of format 1.0, padded so that the data begin at a multiple of 64. */
static size_t npy_header(char out[192], bool narrow, int dimensions, const ptrdiff_t n[3])
{
    char shape[80], dict[160];
    snprintf(shape, sizeof shape, dimensions == 3 ? "%td, %td, %td" : "%td, %td", n[0],
             n[1], n[2]);
    int length = snprintf(dict, sizeof dict,
                          "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }",
                          narrow ? "|u1" : "<u2", shape);
    size_t total = ((size_t)length + 11 + 63) / 64 * 64, text = total - 10;
    memcpy(out, "\x93NUMPY\x01", 7);
    out[7] = 0;
    out[8] = (char)(text & 255);
    out[9] = (char)(text >> 8);
    memset(out + 10, ' ', text);
    memcpy(out + 10, dict, (size_t)length);
    out[total - 1] = '\n';
    return total;
}

static ph_status write_flat(const char *path, const char *type, int dimensions,
                            const ptrdiff_t n[3], const uint16_t *values, ph_error *err)
{
    ph_status st = PH_OK;
    FILE *f = NULL;
    char header[192];
    ptrdiff_t cells = n[0] * n[1] * n[2];
    bool npy = ends_with(path, ".npy"), narrow = true;
    for (ptrdiff_t i = 0; i < cells && narrow; i++)
        narrow = values[i] <= 255;
    if (!npy) {
        PH_CHECK(type && (strcmp(type, "uint8") == 0 || strcmp(type, "uint16") == 0),
                 PH_EINVAL, "type must be uint8 or uint16, got '%s'", type ? type : "");
        PH_CHECK(narrow || strcmp(type, "uint16") == 0, PH_EINVAL,
                 "values above 255 do not fit into uint8");
        narrow = strcmp(type, "uint8") == 0;
    }
    f = fopen(path, "wb");
    PH_CHECK(f, PH_EIO, "cannot be written: %s", strerror(errno));
    size_t length = npy ? npy_header(header, narrow, dimensions, n) : 0;
    bool done = write_values(f, header, length, narrow, values, cells);
    done = fclose(f) == 0 && done;
    f = NULL;
    PH_CHECK(done, PH_EIO, "cannot be written: %s", strerror(errno));
out:
    if (f) fclose(f);
    return st;
}

ph_status ph_rve_write_voxels(const char *path, const char *dataset, const char *type,
                              int dimensions, const ptrdiff_t n[3],
                              const uint16_t *values, ph_error *err)
{
    PH_GIVEN(path && n && values);
    ph_status st = PH_OK;
    char *part = NULL;
    const ptrdiff_t m[3] = {n[0], n[1], dimensions == 3 ? n[2] : 1};
    bool flat = ends_with(path, ".npy") || ends_with(path, ".raw");
    PH_CHECK(flat || is_hdf5(path), PH_EINVAL,
             "unknown ending: .h5, .npy and .raw can be written");
    PH_CHECK(m[0] > 0 && m[1] > 0 && m[2] > 0, PH_EINVAL, "there are no voxels to write");
    size_t size = strlen(path) + 16; /* part.<ending>: written beside it, then renamed */
    PH_ALLOC(part, size, "a path");
    snprintf(part, size, "%s.part%s", path, flat ? strrchr(path, '.') : "");
    if (flat)
        PH_TRY(write_flat(part, type, dimensions, m, values, err));
    else
        PH_TRY(ph_i_hdf5_write(part, dataset, dimensions, m, values, err));
    PH_CHECK(rename(part, path) == 0, PH_EIO, "cannot be written: %s", strerror(errno));
out:
    if (st != PH_OK) {
        if (part) remove(part);
        ph_error_prefix(err, "%s: ", path);
    }
    free(part);
    return st;
}
