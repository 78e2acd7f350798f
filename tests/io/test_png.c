/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/picture.h"
#include "io/sample.h"

#include <png.h>

#include <signal.h>
#include <sys/resource.h>

static char folder[256];

static const char *in_folder(const char *name)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Read back with libpng; the picture is removed. */
static ph_i_picture open_png(const char *path)
{
    ph_i_picture p = {0, 0, NULL};
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    p.width = (int)image.width;
    p.height = (int)image.height;
    p.pixel = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(p.pixel);
    assert_true(png_image_finish_read(&image, NULL, p.pixel, 0, NULL));
    remove(path);
    return p;
}

static ph_i_colour at(const ph_i_picture *p, int x, int y)
{
    return p->pixel[(size_t)y * (size_t)p->width + (size_t)x];
}

static bool same(ph_i_colour a, ph_i_colour b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* Number of pixels of a colour. */
static long count(const ph_i_picture *p, ph_i_colour c)
{
    long n = 0;
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            n += same(at(p, x, y), c);
    return n;
}

/* Top left corner of the first block of a colour, left to right in the top row that has it. */
static void find(const ph_i_picture *p, ph_i_colour c, int place[2])
{
    place[0] = place[1] = -1;
    for (int y = 0; y < p->height && place[0] < 0; y++)
        for (int x = 0; x < p->width && place[0] < 0; x++)
            if (same(at(p, x, y), c)) {
                place[0] = x;
                place[1] = y;
            }
}

/* One bright cell in a dark field, at cell (3, 1) of 5 x 2: its block must be 160 pixels
 * wide, fourth from the left, in the upper row, whatever the slice. */
static void test_a_cell_is_where_it_belongs(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const struct {
        int axis;
        ptrdiff_t n[3], cell[3];
    } cases[] = {
        {3, {5, 2, 3}, {3, 1, 1}}, {2, {5, 3, 2}, {3, 1, 1}}, {1, {3, 5, 2}, {1, 3, 1}}};
    for (int q = 0; q < 3; q++) {
        const ptrdiff_t *n = cases[q].n, *cell = cases[q].cell;
        const double size[3] = {(double)n[0], (double)n[1], (double)n[2]};
        double value[30] = {0};
        ph_grid grid;
        int place[2];
        CHECK_OK(ph_grid_init(&grid, PH_SPACE, n, size, &err));
        value[(cell[0] * n[1] + cell[1]) * n[2] + cell[2]] = 1;
        CHECK_OK(
            ph_write_png(in_folder("a.png"), &grid, value, cases[q].axis, NULL, &err));
        ph_i_picture p = open_png(in_folder("a.png"));
        ph_i_colour bright = ph_i_sequential(1);
        find(&p, bright, place);
        for (int k = 0; k < 160 * 160; k++)
            CHECK(same(at(&p, place[0] + k % 160, place[1] + k / 160), bright));
        ph_i_colour dark = ph_i_sequential(0);
        CHECK(same(at(&p, place[0] - 1, place[1] + 80), dark));
        CHECK(same(at(&p, place[0] - 480, place[1] + 80), dark));
        CHECK(
            !same(at(&p, place[0] - 482, place[1] + 80), dark)); /* frame: fourth block */
        CHECK(same(at(&p, place[0] + 160, place[1] + 80), dark));
        CHECK(same(at(&p, place[0] + 80, place[1] + 160), dark));
        CHECK(!same(at(&p, place[0] + 80, place[1] - 1), dark)); /* frame: upper row */
        ph_i_picture_free(&p);
    }
    CHECK_END();
}

static void test_sizes_and_shapes(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[][2] = {{1, 1}, {64, 64}, {1000, 3}, {2, 300}};
    double *value = calloc(3000, sizeof *value);
    assert_non_null(value);
    for (int i = 0; i < 3000; i++)
        value[i] = i % 17;
    for (int q = 0; q < 4; q++) {
        ph_grid grid;
        const double size[2] = {(double)n[q][0], (double)n[q][1]};
        if (n[q][0] * n[q][1] > 3000) continue;
        CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRAIN, n[q], size, &err));
        CHECK_OK(ph_write_png(in_folder("a.png"), &grid, value, 3, "A title", &err));
        ph_i_picture p = open_png(in_folder("a.png"));
        CHECK(p.width >= 600 && p.width < 1400 && p.height >= 200 && p.height < 1100);
        ph_i_picture_free(&p);
    }
    free(value);
    CHECK_END();
}

static void test_values_without_a_range(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[2] = {4, 4};
    const double size[2] = {1, 1}, fill[] = {0, -3.5, 1e300, NAN, INFINITY, 5e-324};
    ph_grid grid;
    double value[16];
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRESS, n, size, &err));
    for (int q = 0; q < 6; q++) {
        for (int i = 0; i < 16; i++)
            value[i] = fill[q];
        CHECK_OK(ph_write_png(in_folder("a.png"), &grid, value, 3, "constant", &err));
        ph_i_picture p = open_png(in_folder("a.png"));
        long greys = count(&p, (ph_i_colour){190, 190, 190});
        CHECK(isfinite(fill[q]) ? greys == 0 : greys >= 800 * 800);
        ph_i_picture_free(&p);
    }
    CHECK_END();
}

/* Both signs: zero is nearly white, plus and minus of one size are equally light. */
static void test_fields_of_both_signs_diverge(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[2] = {4, 1};
    const double size[2] = {4, 1}, value[4] = {-1, 0, 0.9, NAN};
    ph_grid grid;
    CHECK_OK(ph_grid_init(&grid, PH_PLANE_STRESS, n, size, &err));
    CHECK_OK(ph_write_png(in_folder("a.png"), &grid, value, 3, NULL, &err));
    ph_i_picture p = open_png(in_folder("a.png"));
    ph_i_colour minus = ph_i_diverging(0), none = ph_i_diverging(128 / 255.0);
    CHECK(count(&p, minus) >= 200 * 200 && minus.b > minus.r);
    CHECK(count(&p, none) >= 200 * 200 && none.r > 235 && none.g > 235 && none.b > 235);
    CHECK(count(&p, (ph_i_colour){190, 190, 190}) >= 200 * 200);
    ph_i_picture_free(&p);
    CHECK_END();
}

/* Lightness, in OKLab, of the sequential map rises evenly: what makes it readable. */
static double lightness(ph_i_colour c)
{
    double rgb[3] = {c.r / 255.0, c.g / 255.0, c.b / 255.0};
    for (int k = 0; k < 3; k++)
        rgb[k] = rgb[k] <= 0.04045 ? rgb[k] / 12.92 : pow((rgb[k] + 0.055) / 1.055, 2.4);
    double l =
        cbrt(0.4122214708 * rgb[0] + 0.5363325363 * rgb[1] + 0.0514459929 * rgb[2]);
    double m =
        cbrt(0.2119034982 * rgb[0] + 0.6806995451 * rgb[1] + 0.1073969566 * rgb[2]);
    double s =
        cbrt(0.0883024619 * rgb[0] + 0.2817188376 * rgb[1] + 0.6299787005 * rgb[2]);
    return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

static void test_colours_are_even(void **state)
{
    (void)state;
    for (int k = 0; k <= 20; k++) {
        double t = k / 20.0;
        /* codes have 256 steps: half a step is 0.002 to 0.005 in lightness */
        CHECK_ABS(lightness(ph_i_sequential(t)), 0.26 + 0.66 * t, 0.006);
        CHECK_ABS(lightness(ph_i_diverging(t)), lightness(ph_i_diverging(1 - t)), 0.01);
    }
    for (int i = 0; i < 12; i++)
        for (int j = 0; j < i; j++)
            CHECK(!same(ph_i_material_colour(i, false), ph_i_material_colour(j, false)));
    ph_i_colour a = {10, 200, 30}, b = {250, 0, 99};
    CHECK(same(ph_i_mix_colours(a, b, 0), a) && same(ph_i_mix_colours(a, b, 1), b));
    CHECK_END();
}

static void test_phases_and_cut_cells(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    for (int axis = 1; axis <= 3; axis++) {
        ph_microstructure *micro = sample_micro(axis == 1 ? PH_SPACE : PH_PLANE_STRAIN);
        CHECK_OK(ph_write_phases_png(in_folder("a.png"), micro, axis, "Phases", &err));
        ph_i_picture p = open_png(in_folder("a.png"));
        /* swatches at least; cells too */
        CHECK(count(&p, ph_i_material_colour(0, false)) > 10000);
        CHECK(count(&p, ph_i_material_colour(1, false)) > 10000);
        ph_i_colour cut = ph_i_mix_colours(ph_i_material_colour(1, false),
                                           ph_i_material_colour(2, true), 0.375);
        if (axis > 1) CHECK(count(&p, cut) > 10000);
        ph_i_picture_free(&p);
        ph_microstructure_free(&micro);
    }
    CHECK_END();
}

static void test_every_letter_has_ink_of_its_own(void **state)
{
    (void)state;
    uint8_t a[9], b[9], none[9] = {0};
    for (int i = 33; i < 127; i++) {
        ph_i_glyph((char)i, a);
        CHECK(memcmp(a, none, 9) != 0);
        for (int j = 33; j < i; j++) {
            ph_i_glyph((char)j, b);
            CHECK(memcmp(a, b, 9) != 0);
        }
    }
    ph_i_glyph('\n', a);
    ph_i_glyph('?', b);
    CHECK(memcmp(a, b, 9) == 0);
    CHECK(ph_i_text_width("\xce\xbc"
                          "m",
                          2) == ph_i_text_width("mm", 2));
    CHECK_END();
}

static void test_failures_leave_nothing(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_error err = PH_ERROR_INIT;
    struct rlimit old, small;
    double value[60] = {0};
    CHECK(ph_write_phases_png("/dev/null/a.png", micro, 1, "", &err) == PH_EIO);
    CHECK(ph_write_phases_png(in_folder("missing/a.png"), micro, 1, "", NULL) == PH_EIO);
    CHECK(ph_write_phases_png(in_folder("a.png"), micro, 4, "", NULL) == PH_EINVAL);
    CHECK(ph_write_png(in_folder("a.png"), &micro->grid, value, 0, "", NULL) ==
          PH_EINVAL);
    CHECK(ph_write_png(in_folder("a.png"), &micro->grid, NULL, 1, "", NULL) == PH_EINVAL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_write_png("/dev/full", &micro->grid, value, 1, "", &err) == PH_EIO);
    CHECK(strstr(err.msg, "/dev/full"));
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old);
    small = (struct rlimit){100, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    err = (ph_error)PH_ERROR_INIT;
    ph_status got = ph_write_phases_png(in_folder("a.png"), micro, 1, "", &err);
    setrlimit(RLIMIT_FSIZE, &old);
    CHECK(got == PH_EIO && strstr(err.msg, "a.png"));
    CHECK(sample_entries(folder, false) == 0);
    ph_microstructure_free(&micro);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_cell_is_where_it_belongs),
        cmocka_unit_test(test_sizes_and_shapes),
        cmocka_unit_test(test_values_without_a_range),
        cmocka_unit_test(test_fields_of_both_signs_diverge),
        cmocka_unit_test(test_colours_are_even),
        cmocka_unit_test(test_phases_and_cut_cells),
        cmocka_unit_test(test_every_letter_has_ink_of_its_own),
        cmocka_unit_test(test_failures_leave_nothing),
    };
    sample_folder(folder);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    sample_remove_folder(folder);
    return failed;
}
