/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/text.h"

#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* [-+] digits [. digits] [e [-+] digits], or .inf and .nan in YAML's spellings. */
static bool is_number_text(const char *text)
{
    const char *p = text + (*text == '-' || *text == '+');
    static const char *const special[] = {".inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN"};
    for (size_t i = 0; i < sizeof special / sizeof special[0]; i++)
        if (strcmp(p, special[i]) == 0) return true;
    size_t whole = strspn(p, "0123456789"), part = 0;
    p += whole;
    if (*p == '.') part = strspn(++p, "0123456789");
    p += part;
    if (whole + part == 0) return false;
    if (*p == 'e' || *p == 'E') {
        p++;
        p += *p == '-' || *p == '+';
        size_t digits = strspn(p, "0123456789");
        if (digits == 0) return false;
        p += digits;
    }
    return *p == 0;
}

bool ph_i_text_to_number(const char *text, double *out)
{
    char copy[64];
    size_t n = strlen(text);
    if (n >= sizeof copy - 8 || !is_number_text(text)) return false;
    if (strpbrk(text, "nN")) { /* inf and nan, and nothing else, have an n */
        *out = NAN;
        return true;
    }
    /* strtod wants the decimal point of the locale that the program has chosen */
    const char *dot = strchr(text, '.'), *point = localeconv()->decimal_point;
    if (dot && strlen(point) < 8)
        snprintf(copy, sizeof copy, "%.*s%s%s", (int)(dot - text), text, point, dot + 1);
    else
        memcpy(copy, text, n + 1);
    *out = strtod(copy, NULL);
    return true;
}

bool ph_i_append(ph_i_growing *g, const char *piece, size_t size)
{
    if (g->failed) return false;
    if (g->length + size + 1 > g->capacity) {
        size_t capacity = 2 * (g->length + size + 1);
        char *bigger = realloc(g->text, capacity);
        g->failed = !bigger;
        if (!bigger) return false;
        g->text = bigger;
        g->capacity = capacity;
    }
    memcpy(g->text + g->length, piece, size);
    g->length += size;
    g->text[g->length] = 0;
    return true;
}

void ph_i_appendf(ph_i_growing *g, const char *fmt, ...)
{
    char piece[512];
    va_list args;
    va_start(args, fmt);
    int size = vsnprintf(piece, sizeof piece, fmt, args);
    va_end(args);
    if (size < 0) return;
    ph_i_append(g, piece, (size_t)size < sizeof piece ? (size_t)size : sizeof piece - 1);
}

/* The point of the locale becomes a decimal point. */
static void set_point(char *text)
{
    const char *point = localeconv()->decimal_point;
    char *at = *point && strcmp(point, ".") != 0 ? strstr(text, point) : NULL;
    if (!at) return;
    *at = '.';
    memmove(at + 1, at + strlen(point), strlen(at + strlen(point)) + 1);
}

void ph_i_short_number(char *out, size_t size, int digits, double x)
{
    snprintf(out, size, "%.*g", digits, x);
    set_point(out);
}

void ph_i_append_number(ph_i_growing *g, double x, int digits)
{
    char piece[64];
    ph_i_short_number(piece, sizeof piece, digits, x);
    ph_i_append(g, piece, strlen(piece));
}

void ph_i_number_text(char *out, size_t size, bool e, int digits, double x)
{
    if (e)
        snprintf(out, size, "%.*e", digits, x);
    else
        snprintf(out, size, "%.*f", digits, x);
    set_point(out);
}

void ph_i_append_exact(ph_i_growing *g, double x)
{
    char piece[64];
    int digits = 15;
    for (; digits < 17; digits++) {
        snprintf(piece, sizeof piece, "%.*g", digits, x);
        if (strtod(piece, NULL) == x) break;
    }
    ph_i_append_number(g, x, digits);
}

int ph_i_utf8(const char *text, size_t length, uint32_t *code)
{
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned char *t = (const unsigned char *)text;
    if (length == 0) return 0;
    int n = t[0] < 0x80 ? 1 : t[0] < 0xc0 ? 0 : t[0] < 0xe0 ? 2 : t[0] < 0xf0 ? 3 : 4;
    if (n == 0 || t[0] > 0xf4 || (size_t)n > length) return 0;
    uint32_t c = n == 1 ? t[0] : t[0] & (0x7fu >> n);
    for (int k = 1; k < n; k++) {
        if ((t[k] & 0xc0) != 0x80) return 0;
        c = c << 6 | (t[k] & 0x3fu);
    }
    if (c < least[n] || c > 0x10ffff || (c >= 0xd800 && c < 0xe000)) return 0;
    *code = c;
    return n;
}

bool ph_i_utf8_next(const char **text, uint32_t *code)
{
    if (!**text) return false;
    int n = ph_i_utf8(*text, strnlen(*text, 4), code);
    if (n == 0) *code = 0xfffd;
    *text += n ? n : 1;
    return true;
}

int ph_i_utf8_letters(const char *text)
{
    int letters = 0;
    for (uint32_t code; ph_i_utf8_next(&text, &code);)
        letters++;
    return letters;
}

void ph_i_append_xml(ph_i_growing *g, const char *text)
{
    for (size_t left = strlen(text); left > 0;) {
        uint32_t code = 0;
        int n = ph_i_utf8(text, left, &code);
        const char *piece = n == 0                             ? "\xef\xbf\xbd"
                            : code == '&'                      ? "&amp;"
                            : code == '<'                      ? "&lt;"
                            : code == '>'                      ? "&gt;"
                            : code == '"'                      ? "&quot;"
                            : code < 0x20                      ? " "
                            : code >= 0xfffe && code <= 0xffff ? "\xef\xbf\xbd"
                                                               : NULL;
        ph_i_append(g, piece ? piece : text, piece ? strlen(piece) : (size_t)n);
        n = n ? n : 1;
        text += n;
        left -= (size_t)n;
    }
}
