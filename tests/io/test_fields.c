/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/sample.h"

#include <hdf5.h>

#include <signal.h>
#include <sys/resource.h>

static char folder[256];

static const char *in_folder(const char *name)
{
    static char path[8][600];
    static int next;
    next = (next + 1) % 8;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void free_all(ph_microstructure **micro, ph_result **r, ph_fields_file **file)
{
    ph_fields_file_free(file);
    ph_result_free(r);
    ph_microstructure_free(micro);
    sample_entries(folder, true);
}

static void check_same_micro(const ph_microstructure *a, const ph_microstructure *b)
{
    size_t cells = (size_t)ph_grid_cells(&a->grid);
    CHECK(memcmp(a->grid.n, b->grid.n, sizeof a->grid.n) == 0);
    CHECK(memcmp(a->grid.size, b->grid.size, sizeof a->grid.size) == 0);
    CHECK(a->grid.kinematics == b->grid.kinematics);
    CHECK(memcmp(a->phase, b->phase, cells * sizeof *a->phase) == 0);
    CHECK(a->nmaterials == b->nmaterials && a->ncuts == b->ncuts);
    for (int i = 0; i < a->nmaterials; i++) {
        const ph_material *p = &a->materials[i], *q = &b->materials[i];
        CHECK(strcmp(p->name, q->name) == 0 && p->is_void == q->is_void);
        CHECK(p->is_isotropic == q->is_isotropic);
        CHECK(p->is_void ? isnan(q->E) : p->E == q->E && p->nu == q->nu);
        CHECK(isnan(q->density));
        /* Mandel to Voigt and back: two roundings */
        for (int k = 0; k < 36; k++)
            CHECK_REL(q->stiffness.m[k / 6][k % 6], p->stiffness.m[k / 6][k % 6], 4e-16);
    }
    for (ptrdiff_t q = 0; q < a->ncuts; q++) {
        CHECK(a->cuts[q].cell == b->cuts[q].cell && a->cuts[q].base == b->cuts[q].base);
        CHECK(a->cuts[q].material == b->cuts[q].material);
        CHECK(a->cuts[q].fraction == b->cuts[q].fraction);
        CHECK(memcmp(a->cuts[q].normal, b->cuts[q].normal, sizeof a->cuts[q].normal) ==
              0);
    }
}

static void check_same_fields(const ph_grid *g, const ph_fields *a, const ph_fields *b)
{
    size_t cells = (size_t)ph_grid_cells(g);
    CHECK(a->load == b->load && a->nu == b->nu && a->ns == b->ns);
    CHECK(memcmp(a->macro_strain, b->macro_strain, sizeof a->macro_strain) == 0);
    CHECK(memcmp(a->displacement, b->displacement, cells * (size_t)a->nu * 8) == 0);
    CHECK(memcmp(a->strain, b->strain, cells * (size_t)a->ns * 8) == 0);
    CHECK(memcmp(a->stress, b->stress, cells * (size_t)a->ns * 8) == 0);
}

static void round_trip(ph_kinematics kin, ph_points points)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(kin);
    ph_result *r = sample_result(micro, points, 1u << 0 | 1u << 2);
    ph_fields_file *file = NULL;
    ph_case c;
    sample_case(&c);
    CHECK_OK(ph_write_fields(in_folder("f"), micro, r, &c, &err));
    CHECK(sample_entries(folder, false) == 2);
    CHECK_OK(ph_read_fields(in_folder("f.h5"), ~0u, &file, &err));
    assert_non_null(file);
    CHECK(strcmp(file->title, c.title) == 0 && strcmp(file->unit_stress, "GPa") == 0);
    CHECK(strcmp(file->unit_length, "um") == 0);
    CHECK(strcmp(file->git, ph_git_revision()) == 0);
    check_same_micro(micro, file->micro);
    CHECK(file->nfields == 2 && file->loads == (1u << 0 | 1u << 2));
    for (int i = 0; i < 2; i++)
        check_same_fields(&micro->grid, &r->fields[i], &file->fields[i]);
    ph_fields_file_free(&file);
    CHECK_OK(ph_read_fields(in_folder("f.h5"), 1u << 2, &file, &err));
    CHECK(file && file->nfields == 1 && file->fields[0].load == 2 && file->loads == 5);
    free_all(&micro, &r, &file);
}

static void test_round_trip(void **state)
{
    (void)state;
    for (int kin = PH_SPACE; kin <= PH_PLANE_STRESS; kin++) {
        round_trip((ph_kinematics)kin, PH_POINTS_NODES);
        round_trip((ph_kinematics)kin, PH_POINTS_STRESS);
    }
    CHECK_END();
}

/* Read a dataset as it lies in the file. */
static void read_raw(const char *name, int rank, const hsize_t *want, double *out)
{
    hid_t file = H5Fopen(in_folder("f.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    hsize_t dims[8] = {0};
    CHECK(H5Sget_simple_extent_ndims(space) == rank);
    H5Sget_simple_extent_dims(space, dims, NULL);
    CHECK(memcmp(dims, want, (size_t)rank * sizeof *dims) == 0);
    CHECK(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
}

/* A known function of place must sit at its place for a reader that takes x fastest. */
static void test_file_order_is_x_fastest(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_NODES, 1u << 3);
    const double *h = micro->grid.h;
    double got[60];
    CHECK_OK(ph_write_fields(in_folder("f"), micro, r, NULL, &err));
    read_raw("/loads/23/strain/13", 3, (const hsize_t[]){4, 3, 5}, got);
    for (int k = 0, q = 0; k < 4; k++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 5; i++, q++)
                CHECK_REL(
                    got[q],
                    sample_value(4, (i + 0.5) * h[0], (j + 0.5) * h[1], (k + 0.5) * h[2]),
                    1e-14);
    read_raw("/phase", 3, (const hsize_t[]){4, 3, 5}, got);
    CHECK(got[(2 * 3 + 1) * 5 + 4] == micro->phase[(4 * 3 + 1) * 4 + 2]);
    free_all(&micro, &r, NULL);
    CHECK_END();
}

/* Displacement at the corners: the closed mesh has it on the far faces too, where the
 * periodic part repeats and the affine part goes on. */
static void closed_mesh(ph_kinematics kin, const char *constraint)
{
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(kin);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 1u << 1);
    const ph_grid *g = &micro->grid;
    const ph_fields *f = &r->fields[0];
    bool space = kin == PH_SPACE;
    double got[3 * 6 * 4 * 5];
    r->constraint = constraint;
    CHECK_OK(ph_write_fields(in_folder("f"), micro, r, NULL, &err));
    const hsize_t shape[4] = {space ? 5 : 1, 4, 6, 3};
    read_raw("/loads/22/displacement", 4, shape, got);
    for (int k = 0, q = 0; k < (space ? 5 : 1); k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 6; i++)
                for (int c = 0; c < 3; c++, q++) {
                    const double x[3] = {i * g->h[0], j * g->h[1],
                                         space ? k * g->h[2] : 0};
                    double want = c < f->nu
                                      ? sample_affine(f->ns, f->macro_strain, c, x) +
                                            sample_wave(g, c, x)
                                      : 0;
                    CHECK_ABS(got[q], want, 1e-14); /* values are of order one */
                }
    free_all(&micro, &r, NULL);
}

static void test_corner_displacement_is_continued(void **state)
{
    (void)state;
    closed_mesh(PH_SPACE, "periodic");
    closed_mesh(PH_PLANE_STRAIN, "linear_displacement");
    closed_mesh(PH_GENERALISED_STRAIN, "periodic");
    CHECK_END();
}

/* Without the macro strain of the solver the mean of the strain field is taken. */
static void test_macro_strain_from_the_mean(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(PH_PLANE_STRESS);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 1u << 1);
    ph_fields_file *file = NULL;
    memset(r->fields[0].macro_strain, 0, sizeof r->fields[0].macro_strain);
    CHECK_OK(ph_write_fields(in_folder("f"), micro, r, NULL, &err));
    CHECK_OK(ph_read_fields(in_folder("f.h5"), ~0u, &file, &err));
    /* the mean of a linear function is its value in the middle; z is 0 in the plane */
    for (int a = 0; a < 3 && file; a++)
        CHECK_REL(file->fields[0].macro_strain[a], sample_value(a, 1.0, 0.75, 0), 1e-14);
    free_all(&micro, &r, &file);
    CHECK_END();
}

/* Tags open and close in order, attributes are quoted, nothing raw is left: enough of XML
 * for what we write. */
static void check_well_formed(const char *text)
{
    char open[32][32];
    int depth = 0;
    for (const char *p = strchr(text, '<'); p; p = strchr(p, '<')) {
        const char *end = strchr(p, '>');
        const char *inside = strchr(p + 1, '<');
        CHECK(end && (!inside || inside > end));
        if (!end) return;
        char name[32] = "";
        sscanf(p + 1 + (p[1] == '/'), "%31[A-Za-z?]", name);
        int quotes = 0;
        for (const char *q = p; q < end; q++)
            quotes += *q == '"';
        CHECK(quotes % 2 == 0);
        if (p[1] == '/')
            CHECK(depth > 0 && strcmp(open[--depth], name) == 0);
        else if (p[1] != '?' && end[-1] != '/' && depth < 32)
            strcpy(open[depth++], name);
        p = end;
    }
    CHECK(depth == 0);
}

static void test_xdmf_is_well_formed(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 63);
    ph_case c;
    size_t length = 0;
    sample_case(&c);
    CHECK_OK(ph_write_fields(in_folder("a & b"), micro, r, &c, &err));
    char *text = sample_read(in_folder("a & b.xdmf"), &length);
    assert_non_null(text);
    check_well_formed(text);
    CHECK(strstr(text, "Value=\"Sample &amp; &lt;test&gt;\""));
    CHECK(strstr(text, "a &amp; b.h5:/phase</DataItem>"));
    CHECK(strstr(text, "TopologyType=\"3DCoRectMesh\" Dimensions=\"5 4 6\""));
    CHECK(strstr(text, "Name=\"load13_stress23\""));
    CHECK(strstr(text, folder) == NULL); /* the pair can be moved */
    free(text);
    free_all(&micro, &r, NULL);
    CHECK_END();
}

/* A cracked sheet with all fields: cracks that grow, or a loading that breaks bonds. */
static ph_result *cracked(bool loading, const char *constraint, ph_microstructure **micro)
{
    static const double lengths[] = {0.2, 0.5}, to[] = {0.09};
    static const bool grows = true;
    ph_error err = PH_ERROR_INIT;
    ph_grid g;
    ph_material m;
    ph_cracks c = {0};
    ph_result *r = NULL;
    double v[2][3] = {{0.3, 0.45, 0}, {0.7, 0.55, 0}};
    CHECK_OK(ph_grid_init(&g, PH_PLANE_STRESS, (ptrdiff_t[]){12, 10}, (double[]){1.2, 1},
                          &err));
    CHECK_OK(ph_material_isotropic("m", 1.0, 1.0 / 3, &m, &err));
    CHECK_OK(ph_microstructure_new(&g, 1, &m, micro, &err));
    CHECK_OK(ph_cracks_add_line(&c, 2, (const double(*)[3])v, &err));
    const ph_failure_rule rule = {
        .given = true, .value = (double)NAN, .fracture_energy = 1e-3, .weibull = 4};
    const ph_failure f = {.material = &rule};
    const ph_loading l = {.strain = {0.3, 1, 0.2},
                          .ntargets = 1,
                          .to = to,
                          .steps = 4,
                          .window = 0.5,
                          .stiffness_every = 2};
    const ph_crack_sequence q = {
        .kind = PH_SEQUENCE_GROWTH, .nsteps = 2, .value = lengths, .grows = &grows};
    const ph_problem p = {.micro = *micro,
                          .model = {.horizon = 2},
                          .constraint = {.kind = constraint},
                          .solver = {.tolerance = 1e-10},
                          .cracks = &c,
                          .sequence = loading ? NULL : &q,
                          .failure = loading ? &f : NULL,
                          .loading = loading ? &l : NULL,
                          .keep_fields = true};
    CHECK_OK(ph_homogenise(&p, NULL, &r, &err));
    ph_cracks_free(&c);
    return r;
}

/* Steps of damage: what is in the file is what was solved, the last step is that of the
 * result; under a loading the mean stress of its fields is C times its strain. One temporal
 * collection describes them. */
static void test_steps(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        ph_error err = PH_ERROR_INIT;
        ph_microstructure *micro = NULL;
        ph_fields_file *file = NULL;
        ph_fields_step *step = NULL;
        ph_result *r = cracked(k > 0, k == 2 ? "uniform_traction" : "periodic", &micro);
        size_t length = 0;
        if (!r) break;
        ptrdiff_t cells = ph_grid_cells(&r->grid);
        CHECK_OK(ph_write_fields(in_folder("s"), micro, r, NULL, &err));
        CHECK_OK(ph_read_fields(in_folder("s.h5"), 0, &file, &err));
        CHECK(file && file->nsteps == r->damage->nsteps && file->loads == 7);
        CHECK(file && strcmp(file->step_value, k ? "load" : "crack_length") == 0);
        for (int i = 0; i < r->damage->nsteps; i++) {
            const ph_damage_step *s = &r->damage->step[i];
            bool last = i == r->damage->nsteps - 1;
            double voigt[36], mean = 0;
            CHECK_OK(
                ph_read_fields_step(in_folder("s.h5"), &r->grid, i, ~0u, &step, &err));
            if (!step || step->nfields != (k ? 1 : 3)) break;
            CHECK(step->value == s->value);
            CHECK(memcmp(step->damage, s->field, sizeof(double) * (size_t)cells) == 0);
            CHECK(step->nfields == (k ? 1 : 3) && (last ? r->nfields : s->nfields) == 3);
            const ph_fields *f = last ? r->fields : s->fields;
            for (int a = 0; k == 0 && a < 3 && a < step->nfields; a++)
                check_same_fields(&r->grid, &f[a], &step->fields[a]);
            ph_sym4_to_voigt(&s->stiffness, true, voigt);
            for (int a = 0; k > 0 && a < 3; a++) {
                double want = 0;
                mean = 0;
                for (ptrdiff_t x = 0; x < cells; x++)
                    mean += step->fields[0].stress[a * cells + x] / (double)cells;
                for (int b = 0; b < 3; b++)
                    want += voigt[3 * a + b] * s->strain[b];
                CHECK_ABS(mean, want, 1e-8);
            }
            ph_fields_step_free(&step);
        }
        CHECK(memcmp(r->damage->step[r->damage->nsteps - 1].field, r->damage->field,
                     sizeof(double) * (size_t)cells) == 0);
        CHECK(ph_read_fields_step(in_folder("s.h5"), &r->grid, r->damage->nsteps, 0,
                                  &step, NULL) == PH_EINVAL &&
              !step);
        char *text = sample_read(in_folder("s.xdmf"), &length);
        assert_non_null(text);
        check_well_formed(text);
        CHECK(strstr(text, "CollectionType=\"Temporal\""));
        CHECK(strstr(text, "s.h5:/steps/0001/damage<"));
        CHECK(!strstr(text, k ? "s.h5:/steps/0000/loads/22/displacement<"
                              : "s.h5:/steps/0000/displacement<"));
        free(text);
        free_all(&micro, &r, &file);
    }
    CHECK_END();
}

static void test_microstructure_alone(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_microstructure *micro = sample_micro(PH_PLANE_STRAIN);
    ph_fields_file *file = NULL;
    CHECK_OK(ph_write_fields(in_folder("f"), micro, NULL, NULL, &err));
    CHECK_OK(ph_read_fields(in_folder("f.h5"), ~0u, &file, &err));
    if (file) check_same_micro(micro, file->micro);
    CHECK(file && file->nfields == 0 && file->loads == 0);
    free_all(&micro, NULL, &file);
    CHECK_END();
}

static void test_failures_leave_nothing(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 63);
    const char *const bases[] = {"/dev/null/f", "/proc/perihom", in_folder("missing/f")};
    for (size_t i = 0; i < 3; i++) {
        ph_error err = PH_ERROR_INIT;
        CHECK(ph_write_fields(bases[i], micro, r, NULL, &err) == PH_EIO);
        CHECK(strstr(err.msg, bases[i]));
    }
    ph_error err = PH_ERROR_INIT;
    r->grid.n[1] = 7;
    CHECK(ph_write_fields(in_folder("f"), micro, r, NULL, &err) == PH_EINVAL);
    CHECK(ph_write_fields("", micro, r, NULL, NULL) == PH_EINVAL);
    CHECK(ph_write_fields(in_folder("f"), NULL, r, NULL, NULL) == PH_EINVAL);
    CHECK(sample_entries(folder, false) == 0);
    free_all(&micro, &r, NULL);
    CHECK_END();
}

/* Whatever the write that the disk fills up at, the old pair stays and nothing else does. */
static void test_full_disk_at_every_size(void **state)
{
    (void)state;
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 63);
    ph_fields_file *file = NULL;
    ph_error err = PH_ERROR_INIT;
    struct rlimit old, small;
    CHECK_OK(ph_write_fields(in_folder("f"), micro, NULL, NULL, &err));
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old);
    int failed = 0;
    for (rlim_t limit = 0; limit < 60000; limit += 1499) {
        err = (ph_error)PH_ERROR_INIT;
        small = (struct rlimit){limit, old.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        ph_status got = ph_write_fields(in_folder("f"), micro, r, NULL, &err);
        setrlimit(RLIMIT_FSIZE, &old);
        failed += got == PH_EIO;
        CHECK(got == PH_EIO && strstr(err.msg, "too large"));
        CHECK(sample_entries(folder, false) == 2);
    }
    CHECK(failed > 30);
    CHECK_OK(ph_read_fields(in_folder("f.h5"), ~0u, &file, &err));
    CHECK(file && file->nfields == 0);                             /* the old one */
    CHECK(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL) == 0); /* nothing left open */
    free_all(&micro, &r, &file);
    CHECK_END();
}

static void check_unreadable(const char *path, const char *word)
{
    ph_error err = PH_ERROR_INIT;
    ph_fields_file *file = NULL;
    ph_status got = ph_read_fields(path, ~0u, &file, &err);
    if (got != PH_EIO || file || !strstr(err.msg, word)) {
        check_failures++;
        print_error("%s: status %d, '%s'\n", path, (int)got, err.msg);
    }
    ph_fields_file_free(&file);
}

static void test_unreadable_files(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    size_t length = 0;
    check_unreadable(in_folder("missing.h5"), "No such file");
    CHECK_OK(ph_write_file(in_folder("text.h5"), "not HDF5", 8, &err));
    check_unreadable(in_folder("text.h5"), "signature");
    hid_t other =
        H5Fcreate(in_folder("other.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(other);
    check_unreadable(in_folder("other.h5"), "schema");
    ph_microstructure *micro = sample_micro(PH_SPACE);
    ph_result *r = sample_result(micro, PH_POINTS_STRESS, 63);
    CHECK_OK(ph_write_fields(in_folder("f"), micro, r, NULL, &err));
    char *whole = sample_read(in_folder("f.h5"), &length);
    assert_non_null(whole);
    for (size_t part = 0; part < 8; part++) {
        CHECK_OK(ph_write_file(in_folder("cut.h5"), whole, part * length / 8, &err));
        check_unreadable(in_folder("cut.h5"), "cut.h5");
    }
    free(whole);
    free_all(&micro, &r, NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_file_order_is_x_fastest),
        cmocka_unit_test(test_corner_displacement_is_continued),
        cmocka_unit_test(test_macro_strain_from_the_mean),
        cmocka_unit_test(test_xdmf_is_well_formed),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_microstructure_alone),
        cmocka_unit_test(test_failures_leave_nothing),
        cmocka_unit_test(test_full_disk_at_every_size),
        cmocka_unit_test(test_unreadable_files),
    };
    sample_folder(folder);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    sample_remove_folder(folder);
    return failed;
}
