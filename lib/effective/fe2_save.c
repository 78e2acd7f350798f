/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of a point as bytes: a head, then the fields. */
#include "effective/fe2.h"

#include <math.h>
#include <string.h>

static const char magic[8] = "phfe2-1";

typedef struct head {
    char magic[8];
    uint64_t kind, ns, unknowns, block, nbonds;
    double fingerprint;
    uint64_t checksum; /* of the head with 0 here, and what follows */
    ph_fe2_state state;
} head;

typedef struct writer {
    unsigned char *to;
    size_t at;
} writer;

static head head_of(const ph_fe2 *f)
{
    head h = {.kind = (uint64_t)f->kind,
              .ns = (uint64_t)f->ns,
              .unknowns = f->unknowns,
              .block = f->block,
              .fingerprint = f->fingerprint};
    memcpy(h.magic, magic, sizeof magic);
    return h;
}

/* Fowler, Noll, Vo: sees what was cut off or turned over by chance. */
static uint64_t checksum(const unsigned char *p, size_t n)
{
    uint64_t h = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < n; i++)
        h = (h ^ p[i]) * UINT64_C(1099511628211);
    return h;
}

static size_t bytes_with(const ph_fe2 *f, size_t nbonds)
{
    size_t n = sizeof(head);
    if (f->kind == PH_FE2_VISCOELASTIC) n += f->block * sizeof(double);
    if (f->kind == PH_FE2_FAILURE)
        n += nbonds * sizeof(ph_broken_bond) + sizeof(ph_sym4) +
             (size_t)f->ns * f->unknowns * sizeof(double);
    return n;
}

static size_t bonds_of(const ph_fe2_node *n)
{
    return n->damage ? (size_t)n->damage->nbonds : 0;
}

size_t ph_fe2_point_bytes(const ph_fe2_point *point)
{
    return point && point->at ? bytes_with(point->fe2, bonds_of(point->at)) : 0;
}

static void put(writer *w, const void *from, size_t bytes)
{
    if (bytes) memcpy(w->to + w->at, from, bytes);
    w->at += bytes;
}

ph_status ph_fe2_point_save(const ph_fe2_point *point, void *memory, size_t bytes,
                            ph_error *err)
{
    PH_GIVEN(point && point->at && memory);
    ph_status st = PH_OK;
    const ph_fe2 *f = point->fe2;
    const ph_fe2_node *n = point->at;
    const size_t all = ph_fe2_point_bytes(point);
    head h = head_of(f);
    writer w = {memory, 0};
    PH_CHECK(bytes >= all, PH_EINVAL, "the state takes %zu bytes, there are %zu", all,
             bytes);
    h.nbonds = bonds_of(n);
    h.state = n->s;
    put(&w, &h, sizeof h);
    if (n->block) put(&w, n->block, f->block * sizeof *n->block);
    if (n->damage) {
        put(&w, n->damage->bond, h.nbonds * sizeof *n->damage->bond);
        put(&w, &n->damage->c, sizeof n->damage->c);
        for (int a = 0; a < f->ns; a++)
            put(&w, n->damage->u[a], f->unknowns * sizeof(double));
    }
    h.checksum = checksum(memory, all);
    memcpy(memory, &h, sizeof h);
out:
    return st;
}

/* ---- and back ---------------------------------------------------------------------------- */

static ph_status check(const ph_fe2 *f, const void *memory, size_t bytes, head *h,
                       ph_error *err)
{
    ph_status st = PH_OK;
    const unsigned char *p = memory;
    const head want = head_of(f);
    PH_CHECK(bytes >= sizeof *h, PH_EINVAL, "no state of a point: %zu bytes", bytes);
    memcpy(h, p, sizeof *h);
    PH_CHECK(memcmp(h->magic, magic, sizeof magic) == 0, PH_EINVAL,
             "no state of a point: it begins otherwise");
    PH_CHECK(h->kind == want.kind && h->ns == want.ns && h->unknowns == want.unknowns &&
                 h->block == want.block && h->fingerprint == want.fingerprint,
             PH_EINVAL, "the state is of another RVE");
    PH_CHECK(h->nbonds < bytes && bytes_with(f, (size_t)h->nbonds) == bytes, PH_EINVAL,
             "the state has %zu bytes, not %zu", bytes, bytes_with(f, (size_t)h->nbonds));
    /* the sum over the head as it was before the sum was known */
    head before = *h;
    before.checksum = 0;
    uint64_t sum = checksum((const unsigned char *)&before, sizeof before);
    for (size_t i = sizeof before; i < bytes; i++)
        sum = (sum ^ p[i]) * UINT64_C(1099511628211);
    PH_CHECK(sum == h->checksum, PH_EINVAL, "the state is damaged");
out:
    return st;
}

static ph_status read_damage(const ph_fe2 *f, const unsigned char *p, ptrdiff_t nbonds,
                             ph_fe2_node *n, ph_error *err)
{
    ph_status st = PH_OK;
    ph_fe2_damage *d = NULL;
    PH_ALLOC(d, 1, "broken bonds");
    d->holds = 1;
    n->damage = d;
    n->broke = true;
    d->nbonds = nbonds;
    PH_ALLOC(d->bond, nbonds, "broken bonds");
    for (int a = 0; a < f->ns; a++)
        PH_DOUBLES(d->u[a], NULL, f->unknowns, "the fields of broken bonds");
    const size_t list = (size_t)nbonds * sizeof *d->bond;
    if (list) memcpy(d->bond, p, list);
    p += list;
    memcpy(&d->c, p, sizeof d->c);
    p += sizeof d->c;
    for (int a = 0; a < f->ns; a++, p += f->unknowns * sizeof(double))
        memcpy(d->u[a], p, f->unknowns * sizeof(double));
    for (ptrdiff_t i = 0; i < nbonds; i++)
        PH_CHECK(d->bond[i].node >= 0 && d->bond[i].node < f->cells &&
                     d->bond[i].bond >= 0 && d->bond[i].bond < f->family,
                 PH_EINVAL, "the state breaks a bond that there is not");
    n->tangent = d->c;
out:
    return st;
}

ph_status ph_fe2_point_restore(ph_fe2_point *point, const void *memory, size_t bytes,
                               ph_error *err)
{
    PH_GIVEN(point && point->at && memory);
    ph_status st = PH_OK;
    ph_fe2 *f = point->fe2;
    ph_fe2_node *n = NULL;
    const unsigned char *rest = (const unsigned char *)memory + sizeof(head);
    head h;
    PH_TRY(check(f, memory, bytes, &h, err));
    PH_TRY(ph_i_fe2_node_new(f, NULL, NULL, 0.0, &n, err));
    n->s = h.state;
    n->known = true;
    if (f->kind == PH_FE2_VISCOELASTIC) {
        PH_DOUBLES(n->block, NULL, f->block, "the state of a point");
        memcpy(n->block, rest, f->block * sizeof *n->block);
    }
    if (f->kind == PH_FE2_FAILURE)
        PH_TRY(read_damage(f, rest, (ptrdiff_t)h.nbonds, n, err));
    pthread_mutex_lock(&f->lock);
    ph_i_fe2_plant(f, n, NULL);
    ph_i_fe2_drop(f, &point->tried);
    ph_i_fe2_drop(f, &point->at);
    point->at = n;
    n = NULL;
    pthread_mutex_unlock(&f->lock);
out:
    if (n) {
        pthread_mutex_lock(&f->lock);
        ph_i_fe2_drop(f, &n);
        pthread_mutex_unlock(&f->lock);
    }
    return st;
}
