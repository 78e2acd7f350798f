/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/case.h>

#include "check.h"

#include <locale.h>

#define MATERIALS                                                                        \
    "perihom: 1\n"                                                                       \
    "materials:\n"                                                                       \
    "  matrix: {E: 3.5, nu: 0.35}\n"                                                     \
    "  fibre: {E: 70, nu: 0.2, density: 2500}\n"                                         \
    "  hole: {void: true}\n"
#define BOX2                                                                             \
    "microstructure:\n"                                                                  \
    "  dimension: 2\n"                                                                   \
    "  plane: strain\n"                                                                  \
    "  size: [1.0, 2.0]\n"                                                               \
    "  nodes: [8, 16]\n"
#define BOX3                                                                             \
    "microstructure:\n"                                                                  \
    "  dimension: 3\n"                                                                   \
    "  size: [1.0, 2.0, 3.0]\n"                                                          \
    "  nodes: [8, 16, 24]\n"

static ph_case *parse_set(const char *text, const char *const *sets, size_t nsets)
{
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(ph_case_parse(text, strlen(text), "t.yaml", sets, nsets, &c, NULL, &err));
    return c;
}

static ph_case *parse(const char *text)
{
    return parse_set(text, NULL, 0);
}

/* The first complaint about a text with one override. */
static const char *complaint(const char *text, const char *set)
{
    static char message[512];
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    ph_status st =
        ph_case_parse(text, strlen(text), "t.yaml", &set, set ? 1 : 0, &c, NULL, &err);
    snprintf(message, sizeof message, "%s", st == PH_OK ? "" : err.msg);
    ph_case_free(&c);
    return message;
}

#define CHECK_TEXT(got, want) check_text_(__LINE__, (got), (want))
static void check_text_(int line, const char *got, const char *want)
{
    if (strcmp(got, want) == 0) return;
    print_error("line %d: got '%s', want '%s'\n", line, got, want);
    check_failures++;
}

static void test_boron_aluminium(void **state)
{
    (void)state;
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT;
    CHECK_OK(
        ph_case_read(PH_DATA_DIR "/cases/boron-aluminium.yaml", NULL, 0, &c, NULL, &err));
    assert_non_null(c);
    CHECK_TEXT(c->title, "Boron/aluminium, square array");
    CHECK_TEXT(c->folder, PH_DATA_DIR "/cases");
    CHECK_TEXT(c->unit_length, "um");
    CHECK_TEXT(c->unit_stress, "GPa");
    CHECK_TEXT(c->unit_time, "s");
    CHECK(c->nmaterials == 2 && c->matrix == 0);
    CHECK_TEXT(c->materials[1].name, "boron");
    CHECK(c->materials[0].E == 68.3 && c->materials[0].nu == 0.30);
    CHECK(c->materials[0].density == 2700 && isnan(c->materials[1].density));
    CHECK(c->kinematics == PH_GENERALISED_STRAIN);
    CHECK(c->nodes[0] == 256 && c->nodes[1] == 256 && c->nodes[2] == 1);
    CHECK(c->size[0] == 1 && c->size[1] == 1 && c->size[2] == 1);
    assert_int_equal(c->ninclusions, 1);
    const ph_inclusion *disk = c->inclusions;
    CHECK_TEXT(disk->shape, "disk");
    CHECK(disk->fraction == 0.47 && isnan(disk->radius) && disk->material == 1);
    CHECK(disk->centre[0] == 0.5 && disk->centre[1] == 0.5);
    CHECK_TEXT(c->model.kind, "nosb");
    CHECK(c->model.horizon == 2 && !c->model.horizon_is_length);
    ph_case_free(&c);
    CHECK(c == NULL);
    CHECK_END();
}

static void test_defaults(void **state)
{
    (void)state;
    ph_case *c = parse(MATERIALS BOX2 "  matrix: matrix\n");
    assert_non_null(c);
    CHECK_TEXT(c->title, "");
    CHECK_TEXT(c->unit_length, "-");
    CHECK_TEXT(c->folder, ".");
    CHECK(c->kinematics == PH_PLANE_STRAIN && c->ninclusions == 0 && c->seed == 1);
    CHECK(c->interface == PH_INTERFACE_COMPOSITE && !c->fields);
    CHECK_TEXT(c->model.kind, "nosb");
    CHECK_TEXT(c->model.influence, "constant");
    CHECK_TEXT(c->model.weights, "linear");
    CHECK(c->model.points == PH_POINTS_AUTO && c->model.horizon == 0);
    CHECK(c->model.stabilisation == PH_STABILISE_AUTO);
    CHECK_TEXT(c->constraint.kind, "periodic");
    CHECK_TEXT(c->solver.kind, "auto");
    CHECK(c->solver.tolerance == 1e-6 && c->solver.max_iterations == 2000);
    CHECK_TEXT(c->solver.precision, "double");
    ph_case_free(&c);
    CHECK_END();
}

static void test_every_shape(void **state)
{
    (void)state;
    ph_case *c =
        parse(MATERIALS BOX2
              "  matrix: matrix\n"
              "  inclusions:\n"
              "    - {shape: ellipse, centre: [0.1, 0.2], semi_axes: [0.3, 0.15], "
              "angle: 30, material: fibre}\n"
              "    - {shape: box, centre: [0, -1], size: [0.2, 0.4], material: hole}\n"
              "    - {shape: layer, normal: 2, from: 0.5, to: 1.5, material: fibre}\n");
    assert_non_null(c);
    CHECK(c->inclusions[0].semi_axes[1] == 0.15 && c->inclusions[0].angle == 30);
    CHECK(c->inclusions[0].line == 13 && c->inclusions[2].line == 15);
    CHECK(c->inclusions[1].size[1] == 0.4 && c->inclusions[1].angle == 0);
    CHECK(c->inclusions[1].centre[1] == -1 && c->inclusions[1].material == 2);
    CHECK(c->inclusions[2].normal == 2 && c->inclusions[2].to == 1.5);
    ph_case_free(&c);
    c = parse(
        MATERIALS BOX3
        "  matrix: matrix\n"
        "  inclusions:\n"
        "    - {shape: sphere, centre: [0.1, 0.2, 0.3], radius: 0.2, material: fibre}\n"
        "    - {shape: ellipsoid, centre: [0, 0, 0], semi_axes: [0.3, 0.2, 0.1], "
        "axis: [0, 3, 4], material: fibre}\n"
        "    - {shape: cylinder, centre: [0, 0, 0], radius: 0.2, length: 1, "
        "material: hole}\n"
        "    - {shape: layer, normal: 3, from: -0.5, to: 0.5, material: fibre}\n"
        "    - {shape: box, centre: [0, 0, 0], size: [1, 1, 1], angle: 45, "
        "material: fibre}\n");
    assert_non_null(c);
    CHECK(c->kinematics == PH_SPACE && c->size[2] == 3 && c->nodes[2] == 24);
    CHECK(c->inclusions[0].radius == 0.2 && isnan(c->inclusions[0].fraction));
    CHECK(c->inclusions[1].axis[2] == 4 && c->inclusions[1].semi_axes[2] == 0.1);
    CHECK(c->inclusions[2].axis[2] == 1 && c->inclusions[2].length == 1);
    CHECK(c->inclusions[3].from == -0.5 && c->inclusions[4].angle == 45);
    ph_case_free(&c);
    CHECK_END();
}

/* The cubic crystal turned by 90 degrees about an axis of its own is itself; a transversely
 * isotropic one whose axis 3 is turned onto axis 1 has C11 and C33 exchanged. */
static void test_rotated_stiffness(void **state)
{
    (void)state;
    static const char *const turns[] = {"rotation: {axis: [0, 2, 0], angle: 90}",
                                        "euler: [90, 90, 0]"};
    for (size_t i = 0; i < 2; i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "perihom: 1\n"
                 "materials:\n"
                 "  ply:\n"
                 "    stiffness: [[4, 1, 2, 0, 0, 0], [1, 4, 2, 0, 0, 0], [2, 2, 9, 0, "
                 "0, 0],\n"
                 "                [0, 0, 0, 3, 0, 0], [0, 0, 0, 0, 3, 0], [0, 0, 0, 0, "
                 "0, 1.5]]\n"
                 "    %s\n"
                 "    density: 1600\n" BOX3 "  matrix: ply\n",
                 turns[i]);
        ph_case *c = parse(text);
        assert_non_null(c);
        double v[36];
        ph_sym4_to_voigt(&c->materials[0].stiffness, true, v);
        /* products of cosines of 90 degrees, 6e-17 each */
        CHECK_ABS(v[0], 9, 1e-13);
        CHECK_ABS(v[7], 4, 1e-13);
        CHECK_ABS(v[14], 4, 1e-13);
        CHECK_ABS(v[8], 1, 1e-13);
        CHECK_ABS(v[21], 1.5, 1e-13);
        CHECK_ABS(v[35], 3, 1e-13);
        CHECK(!c->materials[0].is_isotropic && c->materials[0].density == 1600);
        ph_case_free(&c);
    }
    CHECK_END();
}

static void test_voxels(void **state)
{
    (void)state;
    ph_case *c =
        parse(MATERIALS "microstructure:\n"
                        "  dimension: 3\n"
                        "  size: [1, 1, 1]\n"
                        "  voxels: {file: a/rve.h5, materials: [fibre, ~, hole]}\n");
    assert_non_null(c);
    CHECK(c->nodes[0] == 0 && c->nodes[2] == 0);
    CHECK_TEXT(c->voxels.file, "a/rve.h5");
    CHECK_TEXT(c->voxels.dataset, "/phase");
    CHECK(c->voxels.nmaterials == 3 && c->voxels.line == 9);
    CHECK(c->voxels.materials[0] == 1 && c->voxels.materials[1] == -1 &&
          c->voxels.materials[2] == 2 && c->voxels.materials[3] == -1);
    CHECK(c->interface == PH_INTERFACE_NODE_CENTRE);
    ph_case_free(&c);
    c = parse(MATERIALS BOX2 "  voxels: {file: x.raw, type: uint16,\n"
                             "           materials: {255: matrix, 0: hole}}\n");
    assert_non_null(c);
    CHECK(c->voxels.nmaterials == 256 && c->voxels.materials[255] == 0 &&
          c->voxels.materials[0] == 2 && c->voxels.materials[7] == -1);
    CHECK_TEXT(c->voxels.type, "uint16");
    ph_case_free(&c);
    CHECK_END();
}

static void test_model_and_below(void **state)
{
    (void)state;
    ph_case *c = parse(MATERIALS BOX2
                       "  matrix: matrix\n"
                       "  interface: node_centre\n"
                       "  seed: 9007199254740992\n"
                       "model: {kind: local, points: stress, horizon: {length: 0.08},\n"
                       "        influence: inverse_square, weights: exact,\n"
                       "        stabilisation: {subpoint: 0.05}}\n"
                       "constraint: {kind: linear_displacement, collar: fibre}\n"
                       "solver: {kind: direct, tolerance: 1.0e-9, max_iterations: 50,\n"
                       "         precision: auto}\n"
                       "output: {fields: true}\n");
    assert_non_null(c);
    CHECK(c->interface == PH_INTERFACE_NODE_CENTRE && c->seed == 9007199254740992u);
    CHECK_TEXT(c->model.kind, "local");
    CHECK(c->model.points == PH_POINTS_STRESS);
    CHECK(c->model.horizon == 0.08 && c->model.horizon_is_length);
    CHECK_TEXT(c->model.influence, "inverse_square");
    CHECK_TEXT(c->model.weights, "exact");
    CHECK(c->model.stabilisation == PH_STABILISE_SUBPOINT &&
          c->model.stabilisation_value == 0.05);
    CHECK_TEXT(c->constraint.kind, "linear_displacement");
    CHECK(c->constraint.collar == PH_COLLAR_MATRIX && c->constraint.collar_material == 1);
    CHECK_TEXT(c->solver.kind, "direct");
    CHECK(c->solver.tolerance == 1e-9 && c->solver.max_iterations == 50 && c->fields);
    CHECK_TEXT(c->solver.precision, "auto");
    ph_case_free(&c);
    c = parse(MATERIALS BOX2 "  matrix: fibre\n"
                             "model: {points: nodes, stabilisation: none}\n"
                             "constraint: {kind: linear_displacement, collar: matrix}\n");
    assert_non_null(c);
    CHECK(c->model.horizon == 2 && c->model.stabilisation == PH_STABILISE_NONE);
    CHECK(c->constraint.collar == PH_COLLAR_MATRIX && c->constraint.collar_material == 1);
    ph_case_free(&c);
    CHECK_END();
}

/* Windows line ends, a byte order mark, aliases, null for "not there", JSON. */
static void test_other_spellings(void **state)
{
    (void)state;
    ph_case *c = parse(
        "\xEF\xBB\xBF# comment\r\nperihom: 1\r\ntitle: \"Fibre \\u00e0 \xC3\xA9\"\r\n"
        "materials:\r\n  a: &steel {E: +2.1E2, nu: .3}\r\n  b: *steel\r\n"
        "microstructure: {dimension: 2, plane: stress, size: [1, 1],\r\n"
        "  nodes: [4.0, 4], matrix: b, inclusions: ~}\r\nmodel:\r\n");
    assert_non_null(c);
    CHECK_TEXT(c->title, "Fibre \xC3\xA0 \xC3\xA9");
    CHECK(c->nmaterials == 2 && c->materials[1].E == 210 && c->materials[1].nu == 0.3);
    CHECK(c->nodes[0] == 4 && c->ninclusions == 0);
    ph_case_free(&c);
    c = parse(
        "{\"perihom\": 1, \"materials\": {\"a\": {\"E\": 1, \"nu\": 0}}, "
        "\"microstructure\":"
        "{\"dimension\": 2, \"plane\": \"stress\", \"size\": [1, 1], \"nodes\": [1, 1],"
        "\"matrix\": \"a\"}}");
    assert_non_null(c);
    ph_case_free(&c);
    CHECK_END();
}

static void test_overrides(void **state)
{
    (void)state;
    const char *text = MATERIALS BOX2
        "  matrix: matrix\n"
        "  inclusions:\n"
        "    - {shape: disk, centre: [0, 0], fraction: 0.2, material: fibre}\n";
    const char *const sets[] = {
        "microstructure.inclusions.0.fraction=",
        "microstructure.inclusions.0.radius=0.3",
        ("microstructure.inclusions.1={shape: layer, normal: 1, from: 0, "
         "to: 0.1, material: steel}"),
        "materials.steel={E: 210, nu: 0.3}",
        "model.horizon.length=0.25",
        "constraint=linear_displacement",
        "title=a=b: really"};
    ph_case *c = parse_set(text, sets, 6);
    assert_non_null(c);
    CHECK(c->inclusions[0].radius == 0.3 && isnan(c->inclusions[0].fraction));
    CHECK(c->ninclusions == 2 && c->inclusions[1].material == 3);
    CHECK(c->model.horizon == 0.25 && c->model.horizon_is_length);
    CHECK_TEXT(c->constraint.kind, "linear_displacement");
    ph_case_free(&c);
    CHECK_TEXT(
        complaint(text, "model.kind=nsob"),
        "t.yaml: --set model.kind: 'nsob' is not admissible: must be nosb, local or "
        "bond; did you mean 'nosb'?");
    CHECK_TEXT(
        complaint(text, "materials.fibre.nu=0.62"),
        "t.yaml: --set materials.fibre.nu: 0.62 is not admissible: Poisson's ratio must "
        "be > -1 and < 0.5");
    CHECK_TEXT(
        complaint(text, "microstructure.inclusions.5.radius=1"),
        "t.yaml: --set microstructure.inclusions.5.radius: '5' is not admissible: the "
        "list has 1 entries, counted from 0");
    CHECK_TEXT(
        complaint(text, "materials.fibre.E.infinity=1"),
        "t.yaml: --set materials.fibre.E.infinity: 'E' holds one value here, so it has "
        "no 'infinity'");
    CHECK_TEXT(complaint(text, "solver"), "t.yaml: --set solver: must be key.path=value");
    CHECK_TEXT(complaint(text, "=3"), "t.yaml: --set =3: must be key.path=value");
    CHECK_TEXT(complaint(text, "solver={kind: auto"),
               "t.yaml: --set solver: not valid YAML: did not find expected ',' or '}'");
    CHECK_TEXT(complaint(text, "solver={kind: auto, kind: direct}"),
               "t.yaml: --set solver.kind: this key is there twice");
    CHECK_END();
}

/* A disk larger than the box is admissible but covers less than it says: a warning. */
static void test_warning(void **state)
{
    (void)state;
    const char *text = MATERIALS BOX2
        "  matrix: matrix\n"
        "  inclusions:\n"
        "    - {shape: disk, centre: [0, 0], fraction: 0.6, material: fibre}\n";
    ph_case *c = NULL;
    ph_case_issues issues = {0};
    ph_error err = PH_ERROR_INIT;
    char line[500];
    CHECK_OK(ph_case_parse(text, strlen(text), "t.yaml", NULL, 0, &c, &issues, &err));
    assert_int_equal(issues.count, 1);
    CHECK(issues.item[0].warning && issues.item[0].line == 13);
    ph_case_issue_text(&issues.item[0], "t.yaml", line, sizeof line);
    /* radius sqrt(0.6 * 2 / pi) = 0.618039 */
    CHECK_TEXT(line,
               "t.yaml:13: warning: microstructure.inclusions.0.fraction: its radius "
               "0.618039 is more than half of the box (1 along axis 1): it overlaps its "
               "periodic image and covers less than this fraction");
    ph_case_issues_free(&issues);
    ph_case_free(&c);
    CHECK_END();
}

static void test_complaints_are_limited(void **state)
{
    (void)state;
    char *text = calloc(1, 100000);
    assert_non_null(text);
    strcat(text, MATERIALS BOX2 "  matrix: matrix\n");
    for (int i = 0; i < 3000; i++)
        snprintf(text + strlen(text), 32, "key%d: 1\n", i);
    ph_case *c = NULL;
    ph_case_issues issues = {0};
    ph_error err = PH_ERROR_INIT;
    CHECK(ph_case_parse(text, strlen(text), "t", NULL, 0, &c, &issues, &err) ==
          PH_EINVAL);
    CHECK(issues.count == 201);
    CHECK_TEXT(issues.item[200].message, "more complaints than these are not shown");
    ph_case_issues_free(&issues);
    free(text);
    CHECK_END();
}

static void test_unreadable_files(void **state)
{
    (void)state;
    ph_case *c = NULL;
    ph_error err = PH_ERROR_INIT, folder = PH_ERROR_INIT;
    CHECK(ph_case_read("/nowhere/a.yaml", NULL, 0, &c, NULL, &err) == PH_EIO);
    CHECK_TEXT(err.msg, "/nowhere/a.yaml: cannot be opened: No such file or directory");
    CHECK(ph_case_read(PH_DATA_DIR, NULL, 0, &c, NULL, &folder) == PH_EIO);
    CHECK(strstr(folder.msg, "cannot be read: Is a directory") != NULL);
    CHECK(c == NULL);
    CHECK_END();
}

/* ---- the resolved case */

static bool same_numbers(const double *a, const double *b, int n)
{
    for (int i = 0; i < n; i++)
        if (!(a[i] == b[i] || (isnan(a[i]) && isnan(b[i])))) return false;
    return true;
}

static void check_same_inclusion(const ph_inclusion *a, const ph_inclusion *b)
{
    CHECK_TEXT(a->shape, b->shape);
    CHECK(a->material == b->material && a->normal == b->normal);
    CHECK(same_numbers(a->centre, b->centre, 3) &&
          same_numbers(&a->radius, &b->radius, 1));
    CHECK(same_numbers(&a->fraction, &b->fraction, 1));
    CHECK(same_numbers(a->semi_axes, b->semi_axes, 3) &&
          same_numbers(a->size, b->size, 3));
    CHECK(same_numbers(&a->angle, &b->angle, 1) && same_numbers(a->axis, b->axis, 3));
    CHECK(same_numbers(&a->length, &b->length, 1) && same_numbers(&a->from, &b->from, 1));
    CHECK(same_numbers(&a->to, &b->to, 1));
}

static void check_same_case(const ph_case *a, const ph_case *b)
{
    CHECK_TEXT(a->title, b->title);
    CHECK_TEXT(a->unit_length, b->unit_length);
    CHECK_TEXT(a->unit_stress, b->unit_stress);
    CHECK_TEXT(a->unit_time, b->unit_time);
    assert_int_equal(a->nmaterials, b->nmaterials);
    for (int i = 0; i < a->nmaterials; i++) {
        const ph_material *x = &a->materials[i], *y = &b->materials[i];
        CHECK_TEXT(x->name, y->name);
        CHECK(x->is_void == y->is_void && x->is_isotropic == y->is_isotropic);
        CHECK(same_numbers(&x->E, &y->E, 1) && same_numbers(&x->nu, &y->nu, 1));
        CHECK(same_numbers(&x->density, &y->density, 1));
        /* to Voigt and back: a factor sqrt(2) or 2 divided and multiplied, one rounding each */
        ph_sym4 difference = ph_sym4_combine(1, &x->stiffness, -1, &y->stiffness);
        CHECK(ph_sym4_norm(&difference) <= 1e-15 * ph_sym4_norm(&x->stiffness));
    }
    CHECK(a->kinematics == b->kinematics && a->matrix == b->matrix && a->seed == b->seed);
    CHECK(memcmp(a->nodes, b->nodes, sizeof a->nodes) == 0);
    CHECK(same_numbers(a->size, b->size, 3));
    assert_int_equal(a->ninclusions, b->ninclusions);
    for (int i = 0; i < a->ninclusions; i++)
        check_same_inclusion(&a->inclusions[i], &b->inclusions[i]);
    CHECK_TEXT(a->voxels.file, b->voxels.file);
    CHECK_TEXT(a->voxels.dataset, b->voxels.dataset);
    CHECK_TEXT(a->voxels.type, b->voxels.type);
    CHECK(a->voxels.nmaterials == b->voxels.nmaterials);
    CHECK(memcmp(a->voxels.materials, b->voxels.materials, sizeof a->voxels.materials) ==
          0);
    CHECK(a->interface == b->interface && a->fields == b->fields);
    CHECK_TEXT(a->model.kind, b->model.kind);
    CHECK(a->model.points == b->model.points);
    CHECK(a->model.horizon == b->model.horizon);
    CHECK(a->model.horizon_is_length == b->model.horizon_is_length);
    CHECK_TEXT(a->model.influence, b->model.influence);
    CHECK_TEXT(a->model.weights, b->model.weights);
    CHECK(a->model.stabilisation == b->model.stabilisation);
    CHECK(a->model.stabilisation_value == b->model.stabilisation_value);
    CHECK_TEXT(a->constraint.kind, b->constraint.kind);
    CHECK(a->constraint.collar == b->constraint.collar);
    CHECK(a->constraint.collar_material == b->constraint.collar_material);
    CHECK_TEXT(a->solver.kind, b->solver.kind);
    CHECK(a->solver.tolerance == b->solver.tolerance);
    CHECK(a->solver.max_iterations == b->solver.max_iterations);
    CHECK_TEXT(a->solver.precision, b->solver.precision);
}

static void check_round_trip(ph_case *c)
{
    char *json = NULL;
    ph_error err = PH_ERROR_INIT;
    assert_non_null(c);
    CHECK_OK(ph_case_to_json(c, &json, &err));
    assert_non_null(json);
    ph_case *again = parse(json);
    assert_non_null(again);
    check_same_case(c, again);
    free(json);
    ph_case_free(&again);
    ph_case_free(&c);
}

static void test_resolved_case_reads_back(void **state)
{
    (void)state;
    static const char *const files[] = {
        "boron-aluminium.yaml", "boron-aluminium-plane-strain.yaml",
        "spheres.yaml",         "holed-sheet.yaml",
        "laminate.yaml",        "glass-epoxy.yaml"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char path[600];
        ph_case *c = NULL;
        ph_case_issues issues = {0};
        ph_error err = PH_ERROR_INIT;
        snprintf(path, sizeof path, "%s/cases/%s", PH_DATA_DIR, files[i]);
        CHECK_OK(ph_case_read(path, NULL, 0, &c, &issues, &err));
        CHECK(issues.count == 0);
        ph_case_issues_free(&issues);
        check_round_trip(c);
    }
    check_round_trip(parse(
        "perihom: 1\n"
        "title: 'quote \" backslash \\ and \xF0\x9F\x98\x80'\n"
        "materials:\n"
        "  periodic: {void: true}\n"
        "  ply:\n"
        "    stiffness: [[4, 1, 2, 0, 0, 0], [1, 4, 2, 0, 0, 0], [2, 2, 9, 0, 0, 0],\n"
        "                [0, 0, 0, 3, 0, 0], [0, 0, 0, 0, 3, 0], [0, 0, 0, 0, 0, 1.5]]\n"
        "    euler: [10, 20, 30]\n" BOX3 "  matrix: periodic\n"
        "  inclusions:\n"
        "    - {shape: ellipsoid, centre: [0, 0, 0], semi_axes: [0.3, 0.2, 0.1], "
        "axis: [0, 3, 4], material: ply}\n"
        "    - {shape: cylinder, centre: [0, 0, 0], radius: 0.2, length: 1, material: "
        "ply}\n"
        "    - {shape: box, centre: [0, 0, 0], size: [1, 1, 1], angle: 45, material: "
        "ply}\n"
        "model: {points: stress, horizon: {length: 1.0e-7}, stabilisation: {spectral: "
        "0.01}}\n"
        "constraint: {kind: linear_displacement, collar: matrix}\n"));
    check_round_trip(parse(MATERIALS BOX2
                           "  voxels: {file: x.raw, type: uint16,\n"
                           "           materials: {255: matrix, 0: hole}}\n"
                           "constraint: {kind: linear_displacement, "
                           "collar: hole}\n"));
    CHECK_END();
}

/* A host program may have set a locale with a decimal comma: numbers stay what they are. */
static void test_decimal_comma(void **state)
{
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8")) {
        print_message("no locale with a decimal comma here\n");
        skip();
    }
    ph_case *c = parse(MATERIALS BOX2 "  matrix: matrix\n");
    assert_non_null(c);
    CHECK(c->materials[0].E == 3.5);
    check_round_trip(c);
    setlocale(LC_NUMERIC, "C");
    CHECK_END();
}

/* What an error is about is looked up in the file as it is with its overrides. */
static void test_error_text(void **state)
{
    (void)state;
    char folder[] = "/tmp/perihom-about-XXXXXX", path[100], text[300] = "as before",
         want[400];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/c.yaml", folder);
    FILE *to = fopen(path, "w");
    fputs("perihom: 1\nmodel:\n  horizon: {length: 3}\nconstraint: periodic\n", to);
    fclose(to);
    static const char *const sets[] = {"solver.kind=direct"};
    const struct {
        const char *key, *text;
    } row[] = {
        {"model.horizon", ":3: model.horizon.length: 3 is not admissible: no"},
        {"model", ":2: model: no"}, /* of the map as a whole */
        {"model.influence", ":2: model.influence: not given: no"},
        {"constraint.kind", ":4: constraint: 'periodic' is not admissible: no"},
        {"solver.kind", ": --set solver.kind: 'direct' is not admissible: no"},
        {"", NULL},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_error_set(&err, PH_EINVAL, NULL, 0, "no");
        ph_error_about(&err, "%s", row[i].key);
        snprintf(text, sizeof text, "as before");
        bool found = ph_case_error_text(path, sets, 1, &err, text, sizeof text);
        snprintf(want, sizeof want, "%s%s", path, row[i].text ? row[i].text : "");
        CHECK(found == (row[i].text != NULL));
        CHECK(strcmp(text, found ? want : "as before") == 0);
        err.status = PH_ENOCONV; /* this says nothing of the case */
        CHECK(!ph_case_error_text(path, sets, 1, &err, text, sizeof text));
    }
    ph_error gone = {.status = PH_EINVAL, .key = "model"};
    remove(path);
    CHECK(!ph_case_error_text(path, NULL, 0, &gone, text, sizeof text));
    remove(folder);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_text),
        cmocka_unit_test(test_boron_aluminium),
        cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_every_shape),
        cmocka_unit_test(test_rotated_stiffness),
        cmocka_unit_test(test_voxels),
        cmocka_unit_test(test_model_and_below),
        cmocka_unit_test(test_other_spellings),
        cmocka_unit_test(test_overrides),
        cmocka_unit_test(test_warning),
        cmocka_unit_test(test_complaints_are_limited),
        cmocka_unit_test(test_unreadable_files),
        cmocka_unit_test(test_resolved_case_reads_back),
        cmocka_unit_test(test_decimal_comma),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
