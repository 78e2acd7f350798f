/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots are read back: a point must lie where the ticks of the axes say. */
#include <perihom/plot.h>

#include "io/picture.h"
#include "io/plot_canvas.h"
#include "io/sample.h"

#include <png.h>

#include <locale.h>

enum { POINTS = 4096 };

typedef struct points {
    int n, paths;
    double x[POINTS], y[POINTS];
} points;

__attribute__((noinline)) static char *svg_of(const ph_plot *p)
{
    ph_error err = PH_ERROR_INIT;
    char *text = NULL;
    ph_status st = ph_plot_svg(p, &text, &err);
    if (st != PH_OK) fail_msg("%s", err.msg);
    return text;
}

/* What stands in the group `head` (the beginning of its tag), up to `</g>`. */
static char *group(const char *svg, const char *head)
{
    const char *from = strstr(svg, head);
    if (!from) fail_msg("no %s", head);
    const char *to = strstr(from, "</g>");
    char *text = calloc(1, (size_t)(to - from) + 1);
    assert_non_null(text);
    memcpy(text, from, (size_t)(to - from));
    return text;
}

/* All vertices of all paths of a group. */
static points vertices(const char *svg, const char *head)
{
    points p = {.n = 0};
    char *text = group(svg, head);
    for (char *at = strstr(text, " d=\""); at; at = strstr(at, " d=\"")) {
        at += 4;
        p.paths++;
        while (*at && *at != '"') {
            if (strchr("MLmlhvzZ ", *at)) {
                at++;
                continue;
            }
            char *end = NULL;
            double x = strtod(at, &end), y = strtod(end, &end);
            if (p.n < POINTS) {
                p.x[p.n] = x;
                p.y[p.n++] = y;
            }
            at = end;
        }
    }
    free(text);
    return p;
}

/* Value of a label: 0.5, -3, 10^-6 and 2.5x10^4 with raised digits. */
static double label_value(const char *label)
{
    char plain[64] = "";
    size_t used = 0;
    for (uint32_t code; ph_i_utf8_next(&label, &code) && used < 60;) {
        static const uint32_t raised[] = {0x2070, 0xb9,   0xb2,   0xb3,   0x2074,
                                          0x2075, 0x2076, 0x2077, 0x2078, 0x2079};
        bool power = code == 0x207b;
        for (int k = 0; k < 10; k++)
            power = power || code == raised[k];
        if (power && used >= 2 && strcmp(plain + used - 2, "10") == 0 &&
            (used == 2 || plain[used - 3] == 'x')) { /* "10" becomes "e" */
            used -= used > 2 ? 3 : 2;
            if (used == 0) plain[used++] = '1';
            plain[used++] = 'e';
        }
        for (int k = 0; k < 10; k++)
            if (code == raised[k]) plain[used++] = (char)('0' + k);
        if (code == 0x207b) plain[used++] = '-';
        if (code == 0xd7) plain[used++] = 'x';
        if (code < 0x80) plain[used++] = (char)code;
        plain[used] = 0;
    }
    return strtod(plain, NULL);
}

/* An axis from its ticks: place = at + slope * (value or its logarithm). */
typedef struct read_axis {
    bool log;
    int ticks;
    double at, slope;
    double first, last; /* values of the ticks */
} read_axis;

static read_axis axis_of(const char *svg, bool below, bool log)
{
    read_axis a = {.log = log};
    double place[64], value[64];
    char *text = group(svg, below ? "<g class=\"x-axis\"" : "<g class=\"y-axis\"");
    for (char *at = strstr(text, "<text"); at && a.ticks < 64; at = strstr(at, "<text")) {
        char label[64] = "";
        double x = 0, y = 0;
        sscanf(at, "<text x=\"%lf\" y=\"%lf\"", &x, &y);
        at = strchr(at, '>') + 1;
        memcpy(label, at, strcspn(at, "<"));
        place[a.ticks] = below ? x : y - 3.5;
        value[a.ticks++] = label_value(label);
    }
    free(text);
    CHECK(a.ticks >= 2);
    if (a.ticks < 2) return a;
    a.first = value[0];
    a.last = value[a.ticks - 1];
    double u = log ? log10(a.first) : a.first, v = log ? log10(a.last) : a.last;
    a.slope = (place[a.ticks - 1] - place[0]) / (v - u);
    a.at = place[0] - a.slope * u;
    for (int k = 0; k < a.ticks; k++) /* two decimals of the file */
        CHECK_ABS(a.at + a.slope * (log ? log10(value[k]) : value[k]), place[k], 0.012);
    return a;
}

static double place(read_axis a, double value)
{
    return a.at + a.slope * (a.log ? log10(value) : value);
}

/* A line of a few points is there to the two decimals of the file, on every kind of axis. */
static void check_line(bool log_x, bool log_y, double x0, double x1, double y0, double y1)
{
    enum { N = 9 };
    double x[N], y[N];
    for (int i = 0; i < N; i++) {
        double t = i / (N - 1.0), s = t * t * (3 - 2 * t);
        x[i] = log_x ? exp(log(x0) + t * log(x1 / x0)) : x0 + (x1 - x0) * t;
        y[i] = log_y ? exp((1 - s) * log(y0) + s * log(y1)) : y0 + (y1 - y0) * s;
    }
    const ph_series s = {.name = "curve", .n = N, .x = x, .y = y};
    const ph_plot p = {.log_x = log_x, .log_y = log_y, .nseries = 1, .series = &s};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\" data-name=\"curve\"");
    read_axis ax = axis_of(svg, true, log_x), ay = axis_of(svg, false, log_y);
    CHECK(got.n == N && got.paths == 1);
    for (int i = 0; i < N && i < got.n; i++) {
        /* ticks of few digits fix the slope to 0.012 over their distance */
        CHECK_ABS(got.x[i], place(ax, x[i]), 0.05);
        CHECK_ABS(got.y[i], place(ay, y[i]), 0.05);
    }
    free(svg);
}

static void test_points_lie_where_the_axes_say(void **state)
{
    (void)state;
    check_line(false, false, 0, 1, 0, 1);
    check_line(false, false, -3e5, 7e6, 2e-7, -5e-7);
    check_line(false, false, 1000.00001, 1000.00003, 1e9, 1.1e9);
    check_line(true, false, 1e-6, 1e6, 0.5, 3);
    check_line(true, true, 1e-12, 1e12, 1e-250, 1e250);
    check_line(true, true, 1, 3, 2, 150);
    check_line(true, true, 1.01, 1.09, 0.02, 30000);
    CHECK_END();
}

static void test_ticks(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(300); trial++) {
        ph_i_axis a = {.log = trial % 2, .from = 0, .to = 500};
        double size = pow(10, check_uniform(&seed, -290, 290));
        double lo = size * check_uniform(&seed, a.log ? 0.01 : -1, 1);
        double hi = a.log ? lo * pow(10, check_uniform(&seed, 0, 9))
                          : lo + size * pow(10, check_uniform(&seed, -9, 0));
        ph_i_axis_range(&a, lo, hi, 0.04);
        CHECK(a.lo < lo && a.hi > hi);
        ph_i_axis_ticks(&a, 7);
        int labels = 0;
        for (int k = 0; k < a.nticks; k++) {
            double at = ph_i_axis_place(&a, a.tick[k].value);
            CHECK(at > -1e-3 && at < 500 + 1e-3);
            CHECK(k == 0 || a.tick[k].value > a.tick[k - 1].value);
            if (!a.tick[k].label[0]) continue;
            labels++;
            double value = label_value(a.tick[k].label);
            CHECK_ABS(ph_i_axis_place(&a, value), at, 0.5);
        }
        CHECK(labels >= 1 && labels <= 9);
    }
    CHECK_END();
}

static void test_gaps_and_values_without_a_place(void **state)
{
    (void)state;
    const double x[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const double y[] = {1, 2, NAN, 4, INFINITY, 6, 7, -8, 9};
    ph_series s = {.name = "s", .n = 9, .x = x, .y = y};
    ph_plot p = {.nseries = 1, .series = &s};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    /* lines 1-2 and 6-9, the point 4 alone as a dot with its end of no length */
    CHECK(got.paths == 3 && strstr(svg, "h0\""));
    read_axis ay = axis_of(svg, false, false);
    CHECK(ay.first < 0);
    free(svg);
    p.log_y = true; /* now -8 has no place either */
    svg = svg_of(&p);
    got = vertices(svg, "<g class=\"series\"");
    CHECK(got.paths == 4);
    free(svg);
    CHECK_END();
}

static void test_nothing_to_draw(void **state)
{
    (void)state;
    const double x[] = {1, NAN}, y[] = {NAN, 1}, one = 3, zero = 0, many[] = {5, 5, 5};
    const ph_series none[] = {{.n = 0}, {.n = 2, .x = x, .y = y, .name = "n"}};
    const ph_series single = {.n = 1, .x = &one, .y = &one, .style = PH_PLOT_POINTS};
    const ph_series flat = {.n = 3, .x = many, .y = many};
    const ph_series origin = {.n = 1, .x = &zero, .y = &zero};
    ph_plot p = {.title = NULL};
    for (int log = 0; log < 2; log++) {
        p.log_x = p.log_y = log;
        p.nseries = 0;
        char *svg = svg_of(&p);
        CHECK(strstr(svg, ">no data</text>"));
        free(svg);
        p.nseries = 2;
        p.series = none;
        svg = svg_of(&p);
        CHECK(strstr(svg, ">no data</text>"));
        free(svg);
        p.nseries = 1;
        p.series = &origin;
        svg = svg_of(&p);
        CHECK((strstr(svg, ">no data</text>") != NULL) == log);
        free(svg);
        for (int k = 0; k < 2; k++) { /* alone or all equal: in the middle */
            p.series = k == 0 ? &single : &flat;
            svg = svg_of(&p);
            points got = vertices(svg, "<g class=\"series\"");
            read_axis ax = axis_of(svg, true, log);
            CHECK(!strstr(svg, "no data") && got.n >= 1);
            CHECK_ABS(got.x[0], place(ax, k == 0 ? 3 : 5), 0.05);
            free(svg);
        }
    }
    CHECK_END();
}

static void test_extreme_values(void **state)
{
    (void)state;
    const double x[] = {-1.7e308, -1e299, 0, 1e299, 1.7e308, 4.9e-324};
    for (int k = 0; k < 4; k++) {
        const ph_series s = {.n = 6, .x = x, .y = x, .style = PH_PLOT_LINE_POINTS};
        const ph_plot p = {.nseries = 1, .series = &s, .log_x = k & 1, .log_y = k & 2};
        char *svg = svg_of(&p);
        CHECK(!strstr(svg, "nan") && !strstr(svg, "inf\""));
        free(svg);
    }
    CHECK_END();
}

static void test_many_points(void **state)
{
    (void)state;
    enum { N = 1000000 };
    double *x = malloc(2 * N * sizeof *x), *y = x + N;
    assert_non_null(x);
    for (int i = 0; i < N; i++) {
        x[i] = i;
        y[i] = sin(1e-5 * i) + (i == 333333 ? 5 : 0);
    }
    ph_series s = {.n = N, .x = x, .y = y};
    const ph_plot p = {.nseries = 1, .series = &s};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    read_axis ay = axis_of(svg, false, false);
    double top = 1e9;
    for (int i = 0; i < got.n; i++)
        top = fmin(top, got.y[i]);
    /* at most 4 vertices for each half unit of less than 720 units */
    CHECK(got.n > 500 && got.n < 4 * 1440 && strlen(svg) < 120000);
    CHECK_ABS(top, place(ay, sin(3.33333) + 5), 0.05); /* the one peak is still there */
    free(svg);
    s.style = PH_PLOT_POINTS;
    svg = svg_of(&p);
    CHECK(strlen(svg) < 120000);
    free(svg);
    s.style = PH_PLOT_BAND;
    s.low = y;
    s.high = y;
    svg = svg_of(&p);
    CHECK(strlen(svg) < 240000);
    free(svg);
    free(x);
    CHECK_END();
}

static void test_band_bars_steps(void **state)
{
    (void)state;
    const double x[] = {0, 1, 2, 3}, y[] = {1, 3, 2, 4};
    const double low[] = {0, 2, 1, 3}, high[] = {2, 4, 3, 5};
    ph_series s = {
        .name = "s", .n = 4, .x = x, .low = low, .high = high, .style = PH_PLOT_BAND};
    ph_plot p = {.nseries = 1, .series = &s};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    read_axis ax = axis_of(svg, true, false), ay = axis_of(svg, false, false);
    CHECK(got.n == 8 && got.paths == 1);
    for (int i = 0; i < 4 && got.n == 8; i++) { /* low forward, high back */
        CHECK_ABS(got.y[i], place(ay, low[i]), 0.05);
        CHECK_ABS(got.y[7 - i], place(ay, high[i]), 0.05);
        CHECK_ABS(got.x[i], place(ax, x[i]), 0.05);
    }
    free(svg);
    s.style = PH_PLOT_STEPS;
    s.y = y;
    s.low = s.high = NULL;
    svg = svg_of(&p);
    got = vertices(svg, "<g class=\"series\"");
    CHECK(got.n == 7);
    free(svg);
    s.style = PH_PLOT_BARS;
    svg = svg_of(&p);
    ax = axis_of(svg, true, false);
    ay = axis_of(svg, false, false);
    char *bars = group(svg, "<g class=\"series\""), *at = bars;
    for (int i = 0; i < 4; i++) {
        double bx = 0, by = 0, bw = 0, bh = 0;
        at = strstr(at, "<rect x=");
        assert_non_null(at);
        sscanf(at++, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &bx, &by,
               &bw, &bh);
        CHECK_ABS(bx + bw / 2, place(ax, x[i]), 0.05);
        CHECK_ABS(bw, place(ax, 1) - place(ax, 0) - 1, 0.05); /* half a unit each side */
        CHECK_ABS(by, place(ay, y[i]), 0.05);
        CHECK_ABS(by + bh, place(ay, 0), 0.05);
    }
    free(bars);
    free(svg);
    CHECK_END();
}

static void test_error_bars_on_a_logarithmic_axis(void **state)
{
    (void)state;
    const double x[] = {1, 2, 3}, y[] = {1, 10, 100}, low[] = {-1, 5, NAN};
    const double high[] = {2, 20, 200};
    const ph_series s = {.name = "s",
                         .n = 3,
                         .x = x,
                         .y = y,
                         .low = low,
                         .high = high,
                         .style = PH_PLOT_POINTS};
    const ph_plot p = {.nseries = 1, .series = &s, .log_y = true};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    read_axis ay = axis_of(svg, false, true);
    CHECK(got.paths == 2 * 3 + 1); /* two bars with caps, three marks */
    CHECK_ABS(got.y[1], place(ay, 2), 0.05);
    CHECK(got.y[0] > place(ay, 1)); /* the end of the axis */
    CHECK_ABS(got.y[6], place(ay, 5), 0.05);
    CHECK_ABS(got.y[7], place(ay, 20), 0.05);
    free(svg);
    CHECK_END();
}

/* With a range of its own only what is inside is drawn, cut exactly at the edge. */
static void test_given_ranges(void **state)
{
    (void)state;
    const double x[] = {0, 10}, y[] = {0, 1000};
    const ph_series s = {.name = "s", .n = 2, .x = x, .y = y};
    const ph_plot p = {
        .nseries = 1, .series = &s, .x_range = {4, 6}, .y_range = {0, 500}};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    read_axis ax = axis_of(svg, true, false), ay = axis_of(svg, false, false);
    CHECK(got.n == 2);
    for (int i = 0; i < got.n; i++) { /* on the line y = 100 x */
        double u = (got.x[i] - ax.at) / ax.slope, v = (got.y[i] - ay.at) / ay.slope;
        CHECK_ABS(v, 100 * u, 0.2);
        CHECK(u > 3.9 && u < 6.1 && v > 0 && v < 510);
    }
    CHECK_ABS(ax.first, 4, 1e-12);
    CHECK_ABS(ay.last, 500, 1e-12);
    free(svg);
    CHECK_END();
}

static void test_text_is_escaped(void **state)
{
    (void)state;
    const double x = 1;
    const ph_series s = {.name = "<a & \"b\">\xff\x01", .n = 1, .x = &x, .y = &x};
    const ph_plot p = {
        .title = "E\xe2\x80\xb2 < \xcf\x89 & 1", .nseries = 1, .series = &s};
    char *svg = svg_of(&p);
    CHECK(strncmp(svg, "<svg", 4) == 0);
    CHECK(strstr(svg, "E\xe2\x80\xb2 &lt; \xcf\x89 &amp; 1"));
    CHECK(strstr(svg, "&lt;a &amp; &quot;b&quot;&gt;\xef\xbf\xbd "));
    CHECK(!strstr(svg, "<a &") && !strchr(svg, '\xff') && !strchr(svg, '\x01'));
    CHECK(!strstr(svg, " id=")); /* several may stand in one page */
    free(svg);
    CHECK_END();
}

static void test_numbers_do_not_depend_on_the_locale(void **state)
{
    (void)state;
    const double x[] = {0, 0.37, 1}, y[] = {0.1, 0.25, 0.9};
    const ph_series s = {.name = "s", .n = 3, .x = x, .y = y};
    const ph_plot p = {.nseries = 1, .series = &s};
    char *want = svg_of(&p);
    if (setlocale(LC_ALL, "de_DE.UTF-8")) {
        char *got = svg_of(&p);
        CHECK(strcmp(want, got) == 0);
        free(got);
        setlocale(LC_ALL, "C");
    }
    CHECK(strstr(want, ">0.5</text>") && !strstr(want, ">0,5</text>"));
    free(want);
    CHECK_END();
}

/* In a corner that is free; beside the axes where no corner is; cut where it is long. */
static void test_legend(void **state)
{
    (void)state;
    double x[41], y[41], z[41];
    for (int i = 0; i < 41; i++) {
        x[i] = i;
        y[i] = i;
        z[i] = 40 - i;
    }
    ph_series s[] = {{.name = "rising", .n = 41, .x = x, .y = y},
                     {.name = "falling", .n = 41, .x = x, .y = z}};
    ph_plot p = {.nseries = 1, .series = s};
    double at[2] = {0, 0}, right;
    char *svg = svg_of(&p);
    const char *box = strstr(svg, "<g class=\"legend\">\n<rect");
    assert_non_null(box);
    sscanf(box, "<g class=\"legend\">\n<rect x=\"%lf\" y=\"%lf\"", &at[0], &at[1]);
    CHECK(at[0] < 200 && at[1] < 100); /* a rising curve leaves the upper left free */
    free(svg);
    p.nseries = 2;
    svg = svg_of(&p);
    box = strstr(svg, "<g class=\"legend\">\n<rect");
    assert_non_null(box);
    sscanf(box, "<g class=\"legend\">\n<rect x=\"%lf\"", &at[0]);
    right = place(axis_of(svg, true, false), 40);
    CHECK(at[0] > right && at[0] < 720);
    free(svg);
    s[0].name = "a name that is so long that nobody would ever want to see all of it, "
                "and even longer than that by more than a few words, which is long";
    svg = svg_of(&p);
    CHECK(strstr(svg, "\xe2\x80\xa6</text>"));
    right = place(axis_of(svg, true, false), 40);
    CHECK(right > 300);
    free(svg);
    s[0].name = s[1].name = "";
    svg = svg_of(&p);
    CHECK(!strstr(svg, "class=\"legend\""));
    free(svg);
    CHECK_END();
}

static void check_bad(const ph_plot *p, const char *says)
{
    ph_error err = PH_ERROR_INIT;
    char *text = NULL;
    CHECK(ph_plot_svg(p, &text, &err) == PH_EINVAL && text == NULL);
    if (!strstr(err.msg, says)) {
        print_error("'%s' does not say '%s'\n", err.msg, says);
        CHECK(false);
    }
}

static void test_wrong_arguments(void **state)
{
    (void)state;
    const double x[] = {1, 2}, back[] = {2, 1};
    ph_series s = {.n = 2, .x = x, .y = x};
    ph_plot p = {.nseries = 1, .series = &s};
    ph_plot q = p;
    q.width = 100;
    check_bad(&q, "a plot of 100 x 0");
    q = p;
    q.height = 5000;
    check_bad(&q, "height 150 to 4000");
    q = p;
    q.nseries = PH_PLOT_SERIES + 1;
    check_bad(&q, "0 to 256");
    q = p;
    q.series = NULL;
    check_bad(&q, "1 series");
    q = p;
    q.x_range[0] = 1;
    check_bad(&q, "range of the x axis from 1 to 0");
    q.x_range[0] = NAN;
    check_bad(&q, "range of the x axis");
    q = p;
    q.y_range[0] = -1;
    q.log_y = true;
    check_bad(&q, "logarithmic y axis from -1");
    s.style = (ph_series_style)7;
    check_bad(&p, "unknown style 7");
    s = (ph_series){.n = 2, .x = x};
    check_bad(&p, "series 1: no y");
    s = (ph_series){.n = 2, .y = x};
    check_bad(&p, "series 1: no x");
    s = (ph_series){.n = -1, .x = x, .y = x};
    check_bad(&p, "-1 points");
    s = (ph_series){.n = 2, .x = x, .y = x, .low = x};
    check_bad(&p, "low and high come together");
    s = (ph_series){.n = 2, .x = x, .y = x, .style = PH_PLOT_BAND};
    check_bad(&p, "no low and high");
    s = (ph_series){.n = 2, .x = back, .y = x, .style = PH_PLOT_BARS};
    check_bad(&p, "at point 2 it is 1");
    s = (ph_series){.n = 2, .x = x, .y = x};
    CHECK(ph_plot_write("/tmp/a.pdf", &p, NULL) == PH_EINVAL);
    CHECK(ph_plot_write("svg", &p, NULL) == PH_EINVAL);
    CHECK(ph_plot_write("", &p, NULL) == PH_EINVAL);
    CHECK(ph_plot_write("/none/a.svg", &p, NULL) == PH_EIO);
    CHECK(ph_plot_write("/none/a.png", &p, NULL) == PH_EIO);
    CHECK_END();
}

/* ---- pixels */

static ph_i_picture read_png(const char *path)
{
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    ph_i_picture p = {(int)image.width, (int)image.height, NULL};
    p.pixel = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(p.pixel);
    assert_true(png_image_finish_read(&image, NULL, p.pixel, 0, NULL));
    return p;
}

static bool same(ph_i_colour a, ph_i_colour b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static ph_i_colour pixel(const ph_i_picture *p, double x, double y)
{
    return p->pixel[(int)(2 * y) * p->width + (int)(2 * x)];
}

/* The PNG shows the vertices of the SVG, two pixels a unit, in the colour of the series. */
static void test_png_agrees_with_svg(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    char folder[256], path[300];
    const double x[] = {1, 10, 100, 1000}, y[] = {3, 1, 2, 4};
    const ph_series s = {
        .name = "s", .n = 4, .x = x, .y = y, .style = PH_PLOT_LINE_POINTS};
    const ph_plot p = {.nseries = 1,
                       .series = &s,
                       .log_x = true,
                       .width = 400,
                       .height = 300,
                       .title = "t"};
    char *svg = svg_of(&p);
    points got = vertices(svg, "<g class=\"series\"");
    sample_folder(folder);
    snprintf(path, sizeof path, "%s/a.PNG", folder);
    CHECK_OK(ph_plot_write(path, &p, &err));
    ph_i_picture picture = read_png(path);
    CHECK(picture.width == 800 && picture.height == 600);
    for (int i = 0; i < 4; i++)
        CHECK(same(pixel(&picture, got.x[i], got.y[i]), ph_i_series_colour(0)));
    double mx = 0.5 * (got.x[0] + got.x[1]), my = 0.5 * (got.y[0] + got.y[1]);
    CHECK(same(pixel(&picture, mx, my), ph_i_series_colour(0)));
    CHECK(!same(pixel(&picture, mx + 3, my), ph_i_series_colour(0)));
    free(picture.pixel);
    snprintf(path, sizeof path, "%s/a.svg", folder);
    CHECK_OK(ph_plot_write(path, &p, &err));
    size_t length = 0;
    char *file = sample_read(path, &length);
    CHECK(file && length == strlen(svg) && memcmp(file, svg, length) == 0);
    free(file);
    free(svg);
    sample_remove_folder(folder);
    CHECK_END();
}

/* Sum of what a shape covers, in pixels, against its area. */
static void test_mask_covers_the_area(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    ph_i_mask m = {.cover = NULL};
    ph_i_picture p = {.pixel = NULL};
    CHECK_OK(ph_i_mask_new(200, 200, &m, &err));
    CHECK_OK(ph_i_picture_new(200, 200, &p, &err));
    for (int trial = 0; trial < check_trials(20); trial++) {
        const double a[2] = {check_uniform(&seed, 20, 180),
                             check_uniform(&seed, 20, 180)};
        const double b[2] = {check_uniform(&seed, 20, 180),
                             check_uniform(&seed, 20, 180)};
        const ph_i_point t[3] = {{a[0], a[1]}, {b[0], b[1]}, {100, 10}};
        double width = check_uniform(&seed, 2, 8),
               length = hypot(b[0] - a[0], b[1] - a[1]);
        for (int shape = 0; shape < 2; shape++) {
            double sum = 0, area = length * width + 0.25 * sample_pi * width * width;
            double edge = 2 * length + sample_pi * width;
            if (shape == 0) {
                ph_i_mask_segment(&m, a, b, width);
            } else {
                ph_i_mask_polygon(&m, 3, t, 1);
                area = 0.5 *
                       fabs((b[0] - a[0]) * (10 - a[1]) - (b[1] - a[1]) * (100 - a[0]));
                edge =
                    length + hypot(100 - a[0], 10 - a[1]) + hypot(100 - b[0], 10 - b[1]);
            }
            for (int i = 0; i < 200 * 200; i++)
                sum += m.cover[i] / 255.0;
            /* an edge pixel is off by some percent, with either sign along the edge */
            CHECK_ABS(sum, area, 0.03 * edge + 2);
            ph_i_mask_paint(&m, &p, (ph_i_colour){0, 0, 0}, 1);
            for (int i = 0; i < 200 * 200; i++)
                if (m.cover[i]) CHECK(false);
        }
    }
    ph_i_mask_free(&m);
    ph_i_picture_free(&p);
    CHECK_END();
}

static void test_letters_beyond_ascii(void **state)
{
    (void)state;
    static const uint32_t known[] = {0xb0,   0xb5,   0xb1,   0xd7,   0x3b1,  0x3b4, 0x3c3,
                                     0x3c4,  0x3c9,  0x2070, 0x2074, 0x207b, 0xb2,  0xb3,
                                     0x2026, 0x2032, 0x2033, 0x2264, 0x2265, 0x221e};
    uint8_t a[9], b[9];
    ph_i_glyph('?', b);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        ph_i_glyph(known[i], a);
        CHECK(memcmp(a, b, 9) != 0);
    }
    ph_i_glyph(0x4e2d, a);
    CHECK(memcmp(a, b, 9) == 0);
    /* one letter each, also where bytes are no UTF-8 */
    CHECK(ph_i_text_width("\xcf\x89", 1) == 5 && ph_i_text_width("a\xff\xffz", 1) == 23);
    CHECK(ph_i_utf8_letters("\xf0\x9f\x98\x80\xc3\xa9") == 2);
    CHECK(ph_i_utf8_letters("\xc0\x80\xed\xa0\x80") == 5); /* overlong, surrogate */
    CHECK_END();
}

/* ---- heat maps */

static void test_heatmap(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const double v[] = {1, 10, 100, 1000, NAN, -5};
    const char *const names[] = {"a<b", NULL, "c"};
    ph_heatmap m = {.title = "map",
                    .nx = 3,
                    .ny = 2,
                    .value = v,
                    .xnames = names,
                    .log_colour = true,
                    .cell_text = true,
                    .value_label = "v"};
    char *svg = NULL;
    CHECK_OK(ph_heatmap_svg(&m, &svg, &err));
    assert_non_null(svg);
    char *cells = group(svg, "<g class=\"cells\"");
    int rects = 0, grey = 0;
    for (char *at = cells; (at = strstr(at, "<rect")); at++)
        rects++;
    for (char *at = cells; (at = strstr(at, "#c8c8c8")); at++)
        grey++;
    CHECK(rects == 5 && grey == 1); /* the two without a place are one run */
    CHECK(strstr(svg, "a&lt;b") && strstr(svg, ">1e+03<") && strstr(svg, ">v</text>"));
    free(cells);
    free(svg);
    svg = NULL;
    m.log_colour = false; /* both signs: 0 is white, equal values equally strong */
    m.range[0] = -1000;
    m.range[1] = 10;
    CHECK_OK(ph_heatmap_svg(&m, &svg, &err));
    CHECK(strstr(svg, ">-500<") || strstr(svg, ">500<"));
    free(svg);
    CHECK_END();
}

static void test_heatmap_png(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    char folder[256], path[300];
    double v[6 * 4];
    for (int i = 0; i < 24; i++)
        v[i] = i;
    const ph_heatmap m = {.nx = 6, .ny = 4, .value = v};
    char *svg = NULL;
    CHECK_OK(ph_heatmap_svg(&m, &svg, &err));
    char *cells = group(svg, "<g class=\"cells\""), *at = cells;
    sample_folder(folder);
    snprintf(path, sizeof path, "%s/m.png", folder);
    CHECK_OK(ph_heatmap_write(path, &m, &err));
    ph_i_picture picture = read_png(path);
    for (int i = 0; i < 24; i++) { /* rows from the top, the same colours in both */
        double x, y, w, h;
        at = strstr(at, "<rect x=");
        assert_non_null(at);
        sscanf(at++, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &x, &y, &w,
               &h);
        ph_i_colour want = ph_i_sequential(i / 23.0);
        CHECK(same(pixel(&picture, x + 0.5 * w, y + 0.5 * h), want));
    }
    free(cells);
    free(svg);
    free(picture.pixel);
    sample_remove_folder(folder);
    CHECK_END();
}

static void test_heatmap_wrong_arguments(void **state)
{
    (void)state;
    const double v[4] = {NAN, NAN, NAN, NAN};
    ph_heatmap m = {.nx = 2, .ny = 2, .value = v};
    ph_error err = PH_ERROR_INIT;
    char *svg = NULL;
    CHECK_OK(ph_heatmap_svg(&m, &svg, &err)); /* nothing to see is no error */
    CHECK(svg && !strstr(svg, "colour-bar"));
    free(svg);
    svg = NULL;
    ph_heatmap q = m;
    q.nx = 0;
    CHECK(ph_heatmap_svg(&q, &svg, NULL) == PH_EINVAL);
    q.nx = PH_HEATMAP_CELLS + 1;
    CHECK(ph_heatmap_svg(&q, &svg, NULL) == PH_EINVAL);
    q = m;
    q.value = NULL;
    CHECK(ph_heatmap_svg(&q, &svg, NULL) == PH_EINVAL);
    q = m;
    q.range[0] = 2;
    CHECK(ph_heatmap_svg(&q, &svg, NULL) == PH_EINVAL);
    q = m;
    q.width = 1;
    CHECK(ph_heatmap_svg(&q, &svg, NULL) == PH_EINVAL);
    CHECK(ph_heatmap_write("a.gif", &m, NULL) == PH_EINVAL && svg == NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_lie_where_the_axes_say),
        cmocka_unit_test(test_ticks),
        cmocka_unit_test(test_gaps_and_values_without_a_place),
        cmocka_unit_test(test_nothing_to_draw),
        cmocka_unit_test(test_extreme_values),
        cmocka_unit_test(test_many_points),
        cmocka_unit_test(test_band_bars_steps),
        cmocka_unit_test(test_error_bars_on_a_logarithmic_axis),
        cmocka_unit_test(test_given_ranges),
        cmocka_unit_test(test_text_is_escaped),
        cmocka_unit_test(test_numbers_do_not_depend_on_the_locale),
        cmocka_unit_test(test_legend),
        cmocka_unit_test(test_wrong_arguments),
        cmocka_unit_test(test_png_agrees_with_svg),
        cmocka_unit_test(test_mask_covers_the_area),
        cmocka_unit_test(test_letters_beyond_ascii),
        cmocka_unit_test(test_heatmap),
        cmocka_unit_test(test_heatmap_png),
        cmocka_unit_test(test_heatmap_wrong_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
