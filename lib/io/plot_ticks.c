/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/plot_canvas.h"

#include <math.h>
#include <string.h>

/* Margins around such numbers are still finite, and not zero where they are positive. */
static const double SMALLEST = 1e-300, LARGEST = 1e300;

bool ph_i_axis_has(const ph_i_axis *a, double value)
{
    return a->log ? value >= SMALLEST && value <= LARGEST : fabs(value) <= LARGEST;
}

double ph_i_axis_place(const ph_i_axis *a, double value)
{
    double t = a->log ? (log10(value) - log10(a->lo)) / (log10(a->hi) - log10(a->lo))
                      : (value - a->lo) / (a->hi - a->lo);
    return a->from + t * (a->to - a->from);
}

void ph_i_axis_range(ph_i_axis *a, double least, double greatest, double margin)
{
    double lo = least, hi = greatest;
    if (!(lo <= hi)) {
        lo = a->log ? 1 : 0;
        hi = a->log ? 10 : 1;
    } else if (a->log) {
        double span = log10(hi) - log10(lo);
        double more = span > 1e-9 ? margin * span : 0.3;
        lo = fmax(pow(10, log10(lo) - more), 1e-305);
        hi = fmin(pow(10, log10(hi) + more), 1e305);
    } else if (hi - lo > fmax(1e-12 * fmax(fabs(lo), fabs(hi)), SMALLEST)) {
        double more = margin * (hi - lo);
        lo -= more;
        hi += more;
    } else { /* all equal */
        double size = fmax(fabs(lo), fabs(hi));
        double more = size > 10 * SMALLEST ? 0.1 * size : 1;
        lo -= more;
        hi += more;
    }
    a->lo = lo;
    a->hi = hi;
}

static void raised(int exponent, char *out)
{
    static const char *const digit[] = {
        "\xe2\x81\xb0", "\xc2\xb9",     "\xc2\xb2",     "\xc2\xb3",     "\xe2\x81\xb4",
        "\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7", "\xe2\x81\xb8", "\xe2\x81\xb9"};
    char plain[16];
    snprintf(plain, sizeof plain, "%d", exponent);
    for (const char *p = plain; *p; p++) {
        const char *sign = *p == '-' ? "\xe2\x81\xbb" : digit[*p - '0'];
        strcpy(out, sign);
        out += strlen(sign);
    }
}

/* "1.25", or "1.25x10^6" where the numbers of the axis are large or small. */
static void set_label(ph_i_tick *t, double step, double greatest)
{
    const int last = (int)floor(log10(step) + 1e-9); /* decimal place that must be seen */
    char text[64];
    if (t->value == 0) {
        strcpy(text, "0");
    } else if (greatest < 99999.5 && last >= -4) {
        ph_i_number_text(text, sizeof text, false, last < 0 ? -last : 0, t->value);
    } else {
        int first = (int)floor(log10(fabs(t->value)) + 1e-9);
        int digits = first > last ? first - last : 0;
        ph_i_number_text(text, sizeof text, true, digits > 16 ? 16 : digits, t->value);
        char *e = strchr(text, 'e');
        int exponent = (int)strtol(e + 1, NULL, 10);
        bool bare = strncmp(text, "1e", 2) == 0;
        if (bare) e = text;
        strcpy(e, bare ? "10"
                       : "\xc3\x97"
                         "10");
        raised(exponent, e + strlen(e));
    }
    snprintf(t->label, sizeof t->label, "%.31s", text);
}

static ph_i_tick *add_tick(ph_i_axis *a, double value)
{
    if (a->nticks == PH_I_TICKS) return NULL;
    a->tick[a->nticks] = (ph_i_tick){.value = value};
    return &a->tick[a->nticks++];
}

static void linear_ticks(ph_i_axis *a, int most)
{
    const double raw = (a->hi - a->lo) / most, ten = pow(10, floor(log10(raw)));
    const double step = raw <= ten       ? ten
                        : raw <= 2 * ten ? 2 * ten
                        : raw <= 5 * ten ? 5 * ten
                                         : 10 * ten;
    const double greatest = fmax(fabs(a->lo), fabs(a->hi));
    const double first = ceil(a->lo / step - 1e-9), last = floor(a->hi / step + 1e-9);
    for (int k = 0; k <= last - first; k++) {
        ph_i_tick *t = add_tick(a, (first + k) * step);
        if (!t) break;
        set_label(t, step, greatest);
    }
}

/* 0.001 .. 1000 as they are, others as powers, the same way all along the axis. */
static void decade_label(ph_i_tick *t, int exponent, int digit, bool plain)
{
    char text[64];
    if (plain) {
        ph_i_number_text(text, sizeof text, false, exponent < 0 ? -exponent : 0,
                         t->value);
    } else {
        strcpy(text, digit == 1   ? "10"
                     : digit == 2 ? "2\xc3\x97"
                                    "10"
                                  : "5\xc3\x97"
                                    "10");
        raised(exponent, text + strlen(text));
    }
    snprintf(t->label, sizeof t->label, "%.31s", text);
}

static void decade_ticks(ph_i_axis *a, int most)
{
    const double lo = log10(a->lo), hi = log10(a->hi), span = hi - lo;
    const int first = (int)floor(lo - 1e-9), last = (int)floor(hi + 1e-9);
    const bool fine = span < 2, plain = first >= -4 && last <= 4;
    int stride = (int)ceil(span / most);
    if (stride < 1) stride = 1;
    for (int e = first; e <= last; e++)
        for (int digit = 1; digit <= 9; digit++) {
            double at = e + log10(digit);
            bool big = fine ? digit == 1 || digit == 2 || digit == 5
                            : digit == 1 && e % stride == 0;
            bool small = stride == 1 ? span <= 8 : digit == 1 && stride <= 10;
            if (at < lo - 1e-9 || at > hi + 1e-9 || !(big || small)) continue;
            ph_i_tick *t = add_tick(a, digit * pow(10, e));
            if (t && big) decade_label(t, e, digit, plain);
        }
}

void ph_i_axis_ticks(ph_i_axis *a, int most)
{
    most = most < 2 ? 2 : most;
    a->nticks = 0;
    if (!a->log || log10(a->hi) - log10(a->lo) < 0.7)
        linear_ticks(a, most);
    else
        decade_ticks(a, most);
}
