/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocations of the library fail on demand: link with --wrap of these five. After
 * oom_after(n) the n-th allocation from now (and, with `forever`, all later ones) gives NULL. */
#ifndef TESTS_OOM_WRAP_H
#define TESTS_OOM_WRAP_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t size);

static long oom_left = LONG_MAX;
static bool oom_forever;

static void oom_after(long n, bool forever)
{
    oom_left = n;
    oom_forever = forever;
}
/* @return whether the failure came */
static bool oom_stop(void)
{
    bool came = oom_left <= 0;
    oom_left = LONG_MAX;
    return came;
}

static bool oom_now(void)
{
    if (oom_left == LONG_MAX) return false;
    oom_left--;
    return oom_left == 0 || (oom_left < 0 && oom_forever);
}

void *__wrap_malloc(size_t size)
{
    return oom_now() ? NULL : __real_malloc(size);
}
void *__wrap_calloc(size_t count, size_t size)
{
    return oom_now() ? NULL : __real_calloc(count, size);
}
void *__wrap_realloc(void *old, size_t size)
{
    return oom_now() ? NULL : __real_realloc(old, size);
}
char *__wrap_strdup(const char *text)
{
    return oom_now() ? NULL : __real_strdup(text);
}
char *__wrap_strndup(const char *text, size_t size)
{
    return oom_now() ? NULL : __real_strndup(text, size);
}

#endif
