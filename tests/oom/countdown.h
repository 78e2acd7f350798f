/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every allocation fails once. Linked with -Wl,--wrap=malloc,... (tests/meson.build) against
 * the static library, a call runs again and again while its 1st, 2nd, 3rd ... allocation
 * fails, until it gets through. Each time it must return PH_ENOMEM with a message, leave its
 * outputs untouched and leak nothing:
 *
 *     static ph_status call(void *user, ph_error *err) { ... one call of the library ... }
 *     static bool untouched(const void *user) { ... are the outputs as before? ... }
 *     static void done(void *user) { ... free what the successful call made ... }
 *     countdown_run("ph_thing_new", call, untouched, done, &thing);
 *
 * Allocations inside shared libraries (HDF5, libpng) are not seen; jansson's are, after
 * json_set_alloc_funcs(countdown_malloc, countdown_free). One thread only. */
#ifndef TESTS_OOM_COUNTDOWN_H
#define TESTS_OOM_COUNTDOWN_H

#include <perihom/error.h>

#include "check.h"

#include <errno.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *p, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *p);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *p, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *p);

enum { COUNTDOWN_SLOTS = 1 << 16 };

static struct {
    bool armed, fired;
    long left; /* allocations that still succeed */
    long live; /* blocks allocated while armed and not freed */
    void *block[COUNTDOWN_SLOTS];
} countdown;

static size_t countdown_slot(const void *p)
{
    size_t i = ((uintptr_t)p >> 4) * 0x9e3779b97f4a7c15u >> 48;
    while (countdown.block[i % COUNTDOWN_SLOTS] &&
           countdown.block[i % COUNTDOWN_SLOTS] != p)
        i++;
    return i % COUNTDOWN_SLOTS;
}

/* Note a block that was allocated while armed. */
static void *countdown_add(void *p)
{
    if (countdown.armed && p) {
        if (countdown.live > COUNTDOWN_SLOTS / 2) abort();
        countdown.block[countdown_slot(p)] = p;
        countdown.live++;
    }
    return p;
}

/* Forget it; blocks of shared libraries and of before are not known and pass. */
static void countdown_remove(void *p)
{
    size_t i = p ? countdown_slot(p) : 0;
    if (!p || countdown.block[i] != p) return;
    countdown.block[i] = NULL;
    countdown.live--;
    for (size_t j = (i + 1) % COUNTDOWN_SLOTS; countdown.block[j];
         j = (j + 1) % COUNTDOWN_SLOTS) {
        void *moved = countdown.block[j]; /* close the gap in its run */
        countdown.block[j] = NULL;
        countdown.block[countdown_slot(moved)] = moved;
    }
}

static bool countdown_fails(void)
{
    if (!countdown.armed || countdown.left-- > 0) return false;
    countdown.fired = true;
    countdown.left = 0x7fffffff; /* only this one */
    errno = ENOMEM;              /* as POSIX has it */
    return true;
}

void *__wrap_malloc(size_t size)
{
    return countdown_fails() ? NULL : countdown_add(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return countdown_fails() ? NULL : countdown_add(__real_calloc(count, size));
}

void *__wrap_realloc(void *p, size_t size)
{
    if (countdown_fails()) return NULL;
    countdown_remove(p);
    return countdown_add(__real_realloc(p, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return countdown_fails() ? NULL
                             : countdown_add(__real_aligned_alloc(alignment, size));
}

void __wrap_free(void *p)
{
    countdown_remove(p);
    __real_free(p);
}

static inline void *countdown_malloc(size_t size)
{
    return __wrap_malloc(size);
}
static inline void countdown_free(void *p)
{
    __wrap_free(p);
}

/* Run `call` with its n-th allocation failing, n = 1, 2, ...; see above. `untouched` and
 * `done` may be NULL. */
static inline void countdown_run(const char *name, ph_status (*call)(void *, ph_error *),
                                 bool (*untouched)(const void *), void (*done)(void *),
                                 void *user)
{
    for (long n = 0;; n++) {
        ph_error err = PH_ERROR_INIT;
        countdown.left = n;
        countdown.fired = false;
        countdown.armed = true;
        ph_status st = call(user, &err);
        countdown.armed = false;
        if (!countdown.fired) {
            if (st != PH_OK) fail_msg("%s: %s", name, err.msg);
            if (done) done(user);
            CHECK(countdown.live == 0);
            CHECK(n > 0); /* else nothing was wrapped */
            print_message("%s: %ld allocations\n", name, n);
            return;
        }
        bool same = !untouched || untouched(user);
        if (st == PH_ENOMEM && err.status == PH_ENOMEM && err.msg[0] && same &&
            countdown.live == 0)
            continue;
        fail_msg("%s, allocation %ld: status %d '%s', outputs %s, %ld blocks leaked",
                 name, n + 1, (int)st, err.msg, same ? "untouched" : "touched",
                 countdown.live);
    }
}

#endif
