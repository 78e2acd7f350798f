/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rve_case.h"
#include "voxels.h"

#include <hdf5.h>
#include <png.h>

#include <unistd.h>

static char folder[] = "/tmp/perihom-voxels-XXXXXX";
static ph_error err;

static const char *in_folder(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_bytes(const char *name, const void *data, size_t size)
{
    FILE *f = fopen(in_folder(name), "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) != 0) fail_msg("%s", name);
}

/* Read with axes to be found; the caller frees. */
static ph_status read_any(const char *name, int dim, ptrdiff_t n[3], uint16_t **values)
{
    err = (ph_error)PH_ERROR_INIT;
    n[0] = n[1] = n[2] = 0;
    return ph_rve_read_voxels(in_folder(name), "/phase", "", dim, n, values, &err);
}

static void test_round_trips(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const char *names[] = {"a.npy", "a.h5", "a.raw", "b.npy", "b.hdf5", "b.raw"};
    for (int i = 0; i < 6; i++)
        for (int dim = 2; dim <= 3; dim++) {
            const ptrdiff_t n[3] = {5, 7, dim == 3 ? 3 : 1};
            uint16_t values[105], *back = NULL;
            const char *type = i < 3 ? "uint8" : "uint16";
            for (int k = 0; k < 105; k++)
                values[k] = (uint16_t)(check_random(&seed) * (i < 3 ? 256 : 65536));
            ptrdiff_t m[3] = {5, 7, dim == 3 ? 3 : 0};
            err = (ph_error)PH_ERROR_INIT;
            CHECK_OK(ph_rve_write_voxels(in_folder(names[i]), NULL, type, dim, n, values,
                                         &err));
            CHECK_OK(ph_rve_read_voxels(in_folder(names[i]), "/phase", type, dim, m,
                                        &back, &err));
            CHECK(m[0] == 5 && m[1] == 7 && m[2] == n[2]);
            if (back) CHECK(memcmp(back, values, (size_t)(35 * n[2]) * 2) == 0);
            free(back);
            if (strstr(names[i], ".raw")) continue;
            CHECK_OK(read_any(names[i], dim, m, &back)); /* the file knows its axes */
            CHECK(m[0] == 5 && m[1] == 7 && m[2] == n[2]);
            free(back);
            m[1] = 8; /* what the case asks for must agree */
            CHECK(ph_rve_read_voxels(in_folder(names[i]), "/phase", "", dim, m, &back,
                                     &err) == PH_EINVAL);
            CHECK(back == NULL && strstr(err.msg, "7 voxels along axis 2"));
        }
    CHECK_END();
}

/* A .npy file by hand: version, dictionary, raw data. */
static size_t npy(unsigned char *out, int version, const char *dict, const void *data,
                  size_t size)
{
    size_t n = strlen(dict), start = version == 1 ? 10 : 12;
    memcpy(out, "\x93NUMPY", 6);
    out[6] = (unsigned char)version, out[7] = 0;
    out[8] = (unsigned char)(n & 255), out[9] = (unsigned char)(n >> 8),
    out[10] = out[11] = 0;
    memcpy(out + start, dict, n);
    memcpy(out + start + n, data, size);
    return start + n + size;
}

static void test_npy_types_and_orders(void **state)
{
    (void)state;
    static const struct {
        const char *descr;
        unsigned char data[48];
        size_t size;
    } types[] = {{"|u1", {0, 1, 2, 3, 4, 5}, 6},
                 {"|i1", {0, 1, 2, 3, 4, 5}, 6},
                 {"|b1", {0, 1, 1, 0, 1, 0}, 6},
                 {"<u2", {0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0}, 12},
                 {">i2", {0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5}, 12},
                 {"<i4", {[4] = 1, [8] = 2, [12] = 3, [16] = 4, [20] = 5}, 24},
                 {">u4", {[7] = 1, [11] = 2, [15] = 3, [19] = 4, [23] = 5}, 24},
                 {"<i8", {[8] = 1, [16] = 2, [24] = 3, [32] = 4, [40] = 5}, 48},
                 {">i8", {[15] = 1, [23] = 2, [31] = 3, [39] = 4, [47] = 5}, 48},
                 {">f4",
                  {[4] = 0x3f,
                   0x80,
                   [8] = 0x40,
                   0,
                   [12] = 0x40,
                   0x40,
                   [16] = 0x40,
                   0x80,
                   [20] = 0x40,
                   0xa0},
                  24}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int fortran = 0; fortran < 2; fortran++) {
            unsigned char file[256];
            char dict[128];
            snprintf(dict, sizeof dict,
                     "{'descr': '%s', 'fortran_order': %s, 'shape': (2, 3), }\n",
                     types[i].descr, fortran ? "True" : "False");
            size_t size = npy(file, 1 + (int)i % 3, dict, types[i].data, types[i].size);
            ptrdiff_t n[3];
            uint16_t *v = NULL;
            write_bytes("t.npy", file, size);
            CHECK_OK(read_any("t.npy", 2, n, &v));
            CHECK(n[0] == 2 && n[1] == 3 && n[2] == 1);
            for (int k = 0; v && k < 6; k++) {
                int at = fortran ? k / 3 + 2 * (k % 3) : k;
                CHECK(v[k] ==
                      (strcmp(types[i].descr, "|b1") == 0 ? types[i].data[at] : at));
            }
            free(v);
        }
    CHECK_END();
}

static void test_hostile_npy(void **state)
{
    (void)state;
    static const struct {
        const char *dict, *says;
    } bad[] = {
        {"{'descr': '|O', 'fortran_order': False, 'shape': (2, 3), }", "'|O'"},
        {"{'descr': [('a', '<i4')], 'fortran_order': False, 'shape': (2, 3), }",
         "structured"},
        {"{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }", "'<c8'"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 0), }", "0 voxels"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, -3), }", "shape"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 4), }",
         "more than the file"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (4294967296, 4294967296), }",
         "more than"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (99999999999999999999,), }",
         "shape"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (1, 1, 1, 1), }", "3 axes"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (), }", "single number"},
        {"{'descr': '|u1', 'fortran_order': 0, 'shape': (2, 3), }", "fortran_order"},
        {"{'descr': '|u1', 'shape': (2, 3), }", "lacks"},
        {"{'descr': '|u1', 'colour': 3}", "colour"},
        {"{'descr': '|u1", "dtype"},
        {"", "dictionary"},
        {"{'descr': '|i1', 'fortran_order': False, 'shape': (2, 3), }", "is -1, not"},
        {"{'descr': '<i4', 'fortran_order': False, 'shape': (1,), }", "is 67305983, not"},
        {"{'descr': '<f4', 'fortran_order': False, 'shape': (1,), }",
         "not a whole number"},
    };
    const unsigned char data[6] = {255, 1, 3, 4, 5, 6};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        unsigned char file[256];
        ptrdiff_t n[3];
        uint16_t *v = NULL;
        write_bytes("bad.npy", file, npy(file, 1, bad[i].dict, data, sizeof data));
        CHECK(read_any("bad.npy", 3, n, &v) == PH_EINVAL && v == NULL);
        CHECK(strstr(err.msg, "bad.npy: ") != NULL);
        if (!strstr(err.msg, bad[i].says)) print_error("%s\n", err.msg);
        CHECK(strstr(err.msg, bad[i].says) != NULL);
    }
    CHECK_END();
}

/* Every file, cut off anywhere, is refused without harm. */
static void test_cut_off_files(void **state)
{
    (void)state;
    const ptrdiff_t n[3] = {4, 5, 3};
    uint16_t values[60] = {0};
    const char *names[] = {"c.npy", "c.raw", "c.h5"};
    for (int i = 0; i < 3; i++) {
        static unsigned char data[1 << 16];
        err = (ph_error)PH_ERROR_INIT;
        CHECK_OK(
            ph_rve_write_voxels(in_folder(names[i]), NULL, "uint8", 3, n, values, &err));
        FILE *f = fopen(in_folder(names[i]), "rb");
        size_t size = f ? fread(data, 1, sizeof data, f) : 0;
        if (f) fclose(f);
        for (size_t cut = 0; cut < size; cut += i == 2 ? 97 : 1) {
            ptrdiff_t m[3] = {4, 5, 3};
            uint16_t *v = NULL;
            write_bytes(names[i], data, cut);
            CHECK(ph_rve_read_voxels(in_folder(names[i]), "/phase", "uint8", 3, m, &v,
                                     NULL) != PH_OK);
            CHECK(v == NULL);
        }
    }
    CHECK_END();
}

static void write_png(const char *name, png_uint_32 format, const void *pixels,
                      const void *colours)
{
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = 3,
                       .height = 2,
                       .format = format,
                       .colormap_entries = colours ? 3 : 0};
    if (!png_image_write_to_file(&image, in_folder(name), 0, pixels, 0, colours))
        fail_msg("%s: %s", name, image.message);
}

static void test_pictures(void **state)
{
    (void)state;
    const unsigned char gray[6] = {10, 20, 30, 40, 50, 60}, index[6] = {0, 1, 2, 2, 1, 0};
    const unsigned char colours[9] = {255, 0, 0, 0, 255, 0, 0, 0, 255};
    /* top row 10 20 30: value [i][j] is column i, row j from below */
    const uint16_t want[2][6] = {{40, 10, 50, 20, 60, 30}, {2, 0, 1, 1, 0, 2}};
    write_png("0.png", PNG_FORMAT_GRAY, gray, NULL);
    write_png("1.png", PNG_FORMAT_RGB_COLORMAP, index, colours);
    for (int i = 0; i < 2; i++) {
        ptrdiff_t n[3];
        uint16_t *v = NULL;
        CHECK_OK(read_any(i ? "1.png" : "0.png", 2, n, &v));
        CHECK(n[0] == 3 && n[1] == 2 && n[2] == 1);
        if (v) CHECK(memcmp(v, want[i], sizeof want[i]) == 0);
        free(v);
    }
    const unsigned char rgb[18] = {1, 2, 3};
    ptrdiff_t n[3];
    uint16_t *v = NULL;
    write_png("rgb.png", PNG_FORMAT_RGB, rgb, NULL);
    CHECK(read_any("rgb.png", 2, n, &v) == PH_EINVAL && !v && strstr(err.msg, "colour"));
    write_bytes("no.png", "\x89PNG\r\n\x1a\n", 8);
    CHECK(read_any("no.png", 2, n, &v) == PH_EINVAL && !v);
    write_bytes("no.png", "GIF89a..", 8);
    CHECK(read_any("no.png", 2, n, &v) == PH_EINVAL && strstr(err.msg, "not a .png"));
    CHECK_END();
}

static void write_dataset(const char *name, hid_t type, int rank, const hsize_t *dims,
                          bool chunked, const void *data)
{
    hid_t file = H5Fcreate(in_folder("s.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(rank, dims, NULL),
          create = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[4] = {1, 1, 1, 1};
    if (chunked) H5Pset_chunk(create, rank, chunk);
    hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, create, H5P_DEFAULT);
    if (data) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
    H5Dclose(set), H5Sclose(space), H5Pclose(create), H5Fclose(file);
}

static void test_hdf5_datasets(void **state)
{
    (void)state;
    const hsize_t small[4] = {2, 3, 1, 1}, huge[2] = {1u << 20, 1u << 20},
                  none[2] = {2, 0};
    const int32_t good[6] = {0, 1, 2, 3, 4, 5}, negative[6] = {0, -1};
    const double half[6] = {0, 1, 0.5};
    ptrdiff_t n[3];
    uint16_t *v = NULL;
    write_dataset("phase", H5T_STD_I32BE, 2, small, false, NULL);
    write_dataset("phase", H5T_NATIVE_INT32, 2, small, true, good);
    CHECK_OK(read_any("s.h5", 2, n, &v));
    CHECK(n[0] == 2 && n[1] == 3 && v && v[5] == 5);
    free(v);
    write_dataset("phase", H5T_NATIVE_INT32, 2, small, false, negative);
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL && strstr(err.msg, "[0, 1, 0] is -1"));
    write_dataset("phase", H5T_NATIVE_DOUBLE, 2, small, false, half);
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL && strstr(err.msg, "0.5"));
    write_dataset("phase", H5T_NATIVE_INT32, 2, huge, true, NULL); /* nothing is stored */
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL &&
          strstr(err.msg, "more than the file"));
    write_dataset("phase", H5T_NATIVE_INT32, 2, none, false, NULL);
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL && strstr(err.msg, "0 voxels"));
    write_dataset("phase", H5T_NATIVE_INT32, 4, small, false, good);
    CHECK(read_any("s.h5", 3, n, &v) == PH_EINVAL && strstr(err.msg, "4 axes"));
    write_dataset("other", H5T_NATIVE_INT32, 2, small, false, good);
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL &&
          strstr(err.msg, "no dataset '/phase'"));
    write_bytes("s.h5", "not hdf5 at all", 15);
    CHECK(read_any("s.h5", 2, n, &v) == PH_EINVAL && !v);
    H5E_auto2_t print; /* the error print of the caller is as it was */
    void *data;
    H5Eget_auto2(H5E_DEFAULT, &print, &data);
    CHECK(print != NULL);
    CHECK_END();
}

static void test_other_failures(void **state)
{
    (void)state;
    ptrdiff_t n[3];
    uint16_t *v = NULL, one[8] = {300};
    const ptrdiff_t box[3] = {2, 2, 2};
    const char *missing[] = {"missing.npy", "missing.h5", "missing.raw"};
    for (int i = 0; i < 3; i++)
        CHECK(read_any(missing[i], 2, n, &v) == PH_EIO);
    CHECK(read_any("x.tif", 2, n, &v) == PH_EINVAL && strstr(err.msg, ".npy"));
    write_bytes("x.raw", one, sizeof one);
    CHECK(read_any("x.raw", 2, n, &v) == PH_EINVAL && strstr(err.msg, "type"));
    n[0] = n[1] = n[2] = 0;
    CHECK(ph_rve_read_voxels(in_folder("x.raw"), "", "uint8", 3, n, &v, NULL) ==
          PH_EINVAL);
    n[0] = n[1] = n[2] = 3;
    CHECK(ph_rve_read_voxels(in_folder("x.raw"), "", "uint8", 3, n, &v, NULL) ==
          PH_EINVAL);
    err = (ph_error)PH_ERROR_INIT;
    CHECK(ph_rve_write_voxels(in_folder("y.raw"), NULL, "uint8", 3, box, one, &err) ==
          PH_EINVAL);
    CHECK(access(in_folder("y.raw"), F_OK) != 0 &&
          access(in_folder("y.raw.part.raw"), F_OK) != 0);
    CHECK(ph_rve_write_voxels("/nowhere/y.npy", NULL, NULL, 3, box, one, NULL) == PH_EIO);
    CHECK(ph_rve_write_voxels("/nowhere/y.h5", NULL, NULL, 3, box, one, NULL) == PH_EIO);
    CHECK_OK(ph_rve_write_voxels(in_folder("three.npy"), NULL, NULL, 3, box, one,
                                 (err = (ph_error)PH_ERROR_INIT, &err)));
    CHECK(read_any("three.npy", 2, n, &v) == PH_EINVAL && strstr(err.msg, "dimension 2"));
    CHECK_END();
}

/* Written out and read back as a case: the same phases. */
static void test_case_from_voxels(void **state)
{
    (void)state;
    ph_material materials[TEST_MATERIALS];
    const ptrdiff_t n[3] = {6, 8, 1};
    const double size[3] = {1, 1, 1};
    ph_inclusion d = no_inclusion("disk", 2);
    d.centre[0] = d.centre[1] = 0.5, d.radius = 0.3;
    ph_case c = shapes_case(2, n, size, &d, 1, materials);
    ph_microstructure *m = NULL, *back = NULL;
    err = (ph_error)PH_ERROR_INIT;
    CHECK_OK(ph_rve_build(&c, &m, &err));
    CHECK_OK(ph_rve_write_voxels(in_folder("rve.npy"), NULL, NULL, 2, n, m->phase, &err));
    snprintf(c.folder, sizeof c.folder, "%s", folder);
    snprintf(c.voxels.file, sizeof c.voxels.file, "rve.npy");
    c.voxels.nmaterials = 3, c.voxels.line = 9;
    for (int i = 0; i < 3; i++)
        c.voxels.materials[i] = i;
    c.nodes[0] = c.nodes[1] = 0;
    CHECK_OK(ph_rve_build(&c, &back, &err));
    CHECK(back && back->ncuts == 0 && back->grid.n[1] == 8);
    CHECK(back && memcmp(back->phase, m->phase, 48 * sizeof *m->phase) == 0);
    ph_microstructure_free(&back);
    c.voxels.nmaterials = 2; /* value 2 has no material */
    CHECK(ph_rve_build(&c, &back, &err) == PH_EINVAL && back == NULL);
    CHECK(strstr(err.msg, "test.yaml:9: ") && strstr(err.msg, "value 2"));
    ph_microstructure_free(&m);
    CHECK_END();
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_npy_types_and_orders),
        cmocka_unit_test(test_hostile_npy),
        cmocka_unit_test(test_cut_off_files),
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_hdf5_datasets),
        cmocka_unit_test(test_other_failures),
        cmocka_unit_test(test_case_from_voxels),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
