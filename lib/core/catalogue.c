/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/catalogue.h>

#include <limits.h>
#include <string.h>

const ph_entry *ph_catalogue_entry(const ph_catalogue *catalogue, size_t i)
{
    if (!(catalogue && catalogue->count && i < *catalogue->count)) return NULL;
    return (const ph_entry *)(const void *)((const char *)catalogue->first +
                                            i * catalogue->stride);
}

int ph_catalogue_find(const ph_catalogue *catalogue, const char *name)
{
    if (!(catalogue && catalogue->count && name)) return -1;
    for (size_t i = 0; name && i < *catalogue->count; i++)
        if (strcmp(ph_catalogue_entry(catalogue, i)->name, name) == 0) return (int)i;
    return -1;
}

enum { LONGEST = 63 };

static int lower(int c)
{
    return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Edit distance (insert, delete, replace, swap neighbours), capitals alike. */
static int distance(const char *a, const char *b)
{
    const int na = (int)strlen(a), nb = (int)strlen(b);
    int row[3][LONGEST + 1]; /* rows i-2, i-1, i of the table */
    if (na > LONGEST || nb > LONGEST) return INT_MAX;
    for (int j = 0; j <= nb; j++)
        row[0][j] = j;
    for (int i = 1; i <= na; i++) {
        int *now = row[i % 3], *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= nb; j++) {
            int x = lower(a[i - 1]), y = lower(b[j - 1]);
            now[j] = least(last[j - 1] + (x != y), 1 + least(last[j], now[j - 1]));
            if (i > 1 && j > 1 && x == lower(b[j - 2]) && y == lower(a[i - 2]))
                now[j] = least(now[j], before[j - 2] + 1);
        }
    }
    return row[na % 3][nb];
}

const char *ph_nearest_name(const char *word, const char *const *names, size_t n)
{
    const char *best = NULL;
    int nearest = INT_MAX;
    const int length = word ? (int)strnlen(word, LONGEST + 1) : 0;
    for (size_t i = 0; length > 0 && i < n; i++) {
        if (!names[i]) continue;
        int d = distance(word, names[i]);
        if (d < nearest) nearest = d, best = names[i];
    }
    /* A quarter of the letters may be wrong, and one always; but never all of them. */
    return nearest <= 1 + length / 4 && nearest < length ? best : NULL;
}
