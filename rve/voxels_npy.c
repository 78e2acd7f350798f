/* SPDX-License-Identifier: GPL-3.0-or-later */
/* .npy, versions 1 to 3: magic, length, a Python dictionary as text, then the values. */
#include "core/check.h"
#include "voxels.h"

#include <string.h>

/* The dictionary, read from left to right. */
typedef struct text {
    const char *p, *end;
} text;

typedef struct header {
    char kind; /* i u b f */
    bool big;  /* endian */
    int bytes;
    bool fortran;
    bool has_descr, has_order, has_shape;
} header;

static void skip_space(text *t)
{
    while (t->p < t->end && strchr(" \t\r\n", *t->p) && *t->p)
        t->p++;
}

/* Takes `c`, after space, if it is next. */
static bool take(text *t, char c)
{
    skip_space(t);
    if (t->p == t->end || *t->p != c) return false;
    t->p++;
    return true;
}

static bool take_word(text *t, const char *word)
{
    size_t n = strlen(word);
    skip_space(t);
    if ((size_t)(t->end - t->p) < n || memcmp(t->p, word, n) != 0) return false;
    t->p += n;
    return true;
}

/* A quoted string without escapes. */
static bool take_string(text *t, char out[32])
{
    skip_space(t);
    if (t->p == t->end || (*t->p != '\'' && *t->p != '"')) return false;
    char quote = *t->p++;
    size_t n = 0;
    while (t->p < t->end && *t->p != quote && n < 31)
        out[n++] = *t->p++;
    out[n] = 0;
    return t->p < t->end && *t->p++ == quote;
}

static bool take_number(text *t, ptrdiff_t *value)
{
    skip_space(t);
    const char *from = t->p;
    *value = 0;
    for (; t->p < t->end && *t->p >= '0' && *t->p <= '9'; t->p++) {
        if (*value > (PTRDIFF_MAX - 9) / 10) return false;
        *value = *value * 10 + (*t->p - '0');
    }
    return t->p > from;
}

static ph_status read_descr(text *t, header *h, ph_error *err)
{
    ph_status st = PH_OK;
    char s[32] = "";
    PH_CHECK(take_string(t, s), PH_EINVAL,
             "its values are not plain numbers (a structured dtype)");
    size_t sign = s[0] && strchr("<>|=", s[0]) ? 1 : 0;
    h->big = s[0] == '>';
    h->kind = s[sign];
    const char *sizes = h->kind == 'b'                     ? "1"
                        : h->kind == 'i' || h->kind == 'u' ? "1248"
                        : h->kind == 'f'                   ? "48"
                                                           : "";
    char size = (char)(h->kind ? s[sign + 1] : 0);
    PH_CHECK(size && strchr(sizes, size) && !s[sign + 2], PH_EINVAL,
             "its values have dtype '%s'; whole numbers are wanted (u1 i1 u2 i2 u4 i4 u8 "
             "i8 b1)",
             s);
    h->bytes = size - '0';
    h->has_descr = true;
out:
    return st;
}

static ph_status read_shape(text *t, header *h, ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(take(t, '('), PH_EINVAL, "the header has no valid shape");
    for (v->rank = 0; !take(t, ')'); v->rank++) {
        ptrdiff_t n;
        PH_CHECK(take_number(t, &n), PH_EINVAL, "the header has no valid shape");
        PH_CHECK(v->rank < 3, PH_EINVAL, "has more than 3 axes");
        v->n[v->rank] = n;
        if (take(t, ',')) continue;
        PH_CHECK(take(t, ')'), PH_EINVAL, "the header has no valid shape");
        v->rank++;
        break;
    }
    PH_CHECK(v->rank > 0, PH_EINVAL, "is a single number, not an array");
    for (int a = v->rank; a < 3; a++)
        v->n[a] = 1;
    h->has_shape = true;
out:
    return st;
}

static ph_status read_dictionary(text t, header *h, ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(take(&t, '{'), PH_EINVAL, "the header is not a dictionary");
    while (!take(&t, '}')) {
        char key[32];
        PH_CHECK(take_string(&t, key) && take(&t, ':'), PH_EINVAL,
                 "the header is damaged");
        if (strcmp(key, "descr") == 0) {
            PH_TRY(read_descr(&t, h, err));
        } else if (strcmp(key, "shape") == 0) {
            PH_TRY(read_shape(&t, h, v, err));
        } else if (strcmp(key, "fortran_order") == 0) {
            h->fortran = take_word(&t, "True");
            PH_CHECK(h->fortran || take_word(&t, "False"), PH_EINVAL,
                     "fortran_order is neither True nor False");
            h->has_order = true;
        } else {
            PH_CHECK(false, PH_EINVAL, "the header has an unknown key '%s'", key);
        }
        if (take(&t, ',')) continue;
        PH_CHECK(take(&t, '}'), PH_EINVAL, "the header is damaged");
        break;
    }
    PH_CHECK(h->has_descr && h->has_order && h->has_shape, PH_EINVAL,
             "the header lacks descr, fortran_order or shape");
out:
    return st;
}

/* Where the header's text and the values are. */
static ph_status split(ph_bytes file, text *t, ph_bytes *values, ph_error *err)
{
    ph_status st = PH_OK;
    const unsigned char *d = file.data;
    PH_CHECK(file.size >= 10 && memcmp(d, "\x93NUMPY", 6) == 0, PH_EINVAL,
             "is not a .npy file");
    PH_CHECK(d[6] >= 1 && d[6] <= 3, PH_EINVAL,
             "has .npy version %d.%d, known are 1 to 3", d[6], d[7]);
    size_t start = d[6] == 1 ? 10 : 12, length = d[8] | (size_t)d[9] << 8;
    PH_CHECK(file.size >= start, PH_EINVAL, "is cut off in its header");
    if (d[6] > 1) length |= (size_t)d[10] << 16 | (size_t)d[11] << 24;
    PH_CHECK(length <= file.size - start, PH_EINVAL, "is cut off in its header");
    *t = (text){(const char *)d + start, (const char *)d + start + length};
    *values = (ph_bytes){d + start + length, file.size - start - length};
out:
    return st;
}

static double decode(const header *h, const unsigned char *p)
{
    uint64_t bits = 0;
    for (int i = 0; i < h->bytes; i++)
        bits |= (uint64_t)p[h->big ? h->bytes - 1 - i : i] << 8 * i;
    if (h->kind == 'f' && h->bytes == 4) {
        uint32_t low = (uint32_t)bits;
        float f;
        memcpy(&f, &low, sizeof f);
        return (double)f;
    }
    if (h->kind == 'f') {
        double f;
        memcpy(&f, &bits, sizeof f);
        return f;
    }
    bool negative = h->kind == 'i' && bits >> (8 * h->bytes - 1) & 1;
    if (!negative) return (double)bits;
    uint64_t magnitude = ~bits + 1;
    return -(double)(h->bytes == 8 ? magnitude
                                   : magnitude & ((1ull << 8 * h->bytes) - 1));
}

ph_status ph_i_npy_parse(ph_bytes file, ph_voxel_data *v, ph_error *err)
{
    ph_status st = PH_OK;
    header h = {0};
    text t = {0};
    ph_bytes data = {0};
    PH_TRY(split(file, &t, &data, err));
    PH_TRY(read_dictionary(t, &h, v, err));
    PH_TRY(ph_i_voxels_alloc(v, (size_t)h.bytes, data.size, err));
    ptrdiff_t cell = 0;
    const ptrdiff_t *n = v->n;
    for (ptrdiff_t i = 0; i < n[0]; i++)
        for (ptrdiff_t j = 0; j < n[1]; j++)
            for (ptrdiff_t k = 0; k < n[2]; k++, cell++) {
                ptrdiff_t at = h.fortran ? (k * n[1] + j) * n[0] + i : cell;
                double value = decode(&h, data.data + at * h.bytes);
                PH_TRY(ph_i_voxel_value(v, cell, value, err));
            }
out:
    return st;
}
