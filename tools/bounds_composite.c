/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "bounds.h"
#include "check.h"
#include "memory.h"

#include <math.h>
#include <string.h>

const char *bounds_shape_name(ph_inclusion_shape shape)
{
    switch (shape) {
    case PH_SHAPE_SPHERE:
        return "sphere";
    case PH_SHAPE_CYLINDER:
        return "cylinder";
    case PH_SHAPE_SPHEROID:
        return "spheroid";
    case PH_SHAPE_LAMINATE:
        return "laminate";
    }
    return "unknown";
}

/* Columns of R: a frame whose axis `which` (0-based) is along d; nearest to the case's. */
static void frame_along(const double d[3], int which, double R[9])
{
    double e[3][3], length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    int least = 0;
    for (int i = 0; i < 3; i++) {
        e[0][i] = d[i] / length;
        if (fabs(d[i]) < fabs(d[least])) least = i;
    }
    double dot = e[0][least], norm = sqrt(1.0 - dot * dot);
    for (int i = 0; i < 3; i++)
        e[1][i] = ((i == least) - dot * e[0][i]) / norm;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        e[2][i] = e[0][j] * e[1][k] - e[0][k] * e[1][j];
    }
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++)
            R[3 * i + (which + a) % 3] = e[a][i];
}

static void layers(bounds_composite *b, const ph_inclusion *inc)
{
    b->composite.shape = PH_SHAPE_LAMINATE;
    if (inc->normal ==
        2) { /* a quarter turn about axis 3, which stays out of the plane */
        const double R[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
        memcpy(b->R, R, sizeof R);
    } else if (inc->normal == 3) {
        const double R[9] = {0, 0, -1, 0, 1, 0, 1, 0, 0};
        memcpy(b->R, R, sizeof R);
    }
}

static void rod(bounds_composite *b, const ph_case *c, const ph_inclusion *inc)
{
    const double shortest = fmin(c->size[0], fmin(c->size[1], c->size[2]));
    frame_along(inc->axis, 2, b->R);
    if (!(inc->length < shortest * (1.0 - 1e-9))) {
        b->composite.shape = PH_SHAPE_CYLINDER;
        return;
    }
    b->composite.shape = PH_SHAPE_SPHEROID;
    b->composite.aspect = inc->length / (2.0 * inc->radius);
    snprintf(b->note, sizeof b->note,
             "short cylinders are taken as spheroids of aspect %g", b->composite.aspect);
}

/* A spheroid where the two semi-axes across `axis` agree; else the sphere stands in. */
static void ellipsoid(bounds_composite *b, const ph_inclusion *inc)
{
    const double *a = inc->semi_axes;
    if (fabs(a[1] - a[2]) <= 1e-9 * a[1]) {
        b->composite.shape = PH_SHAPE_SPHEROID;
        b->composite.aspect = a[0] / a[1];
        frame_along(inc->axis, 2, b->R);
    } else {
        snprintf(b->note, sizeof b->note,
                 "ellipsoids with three different axes are taken as spheres");
    }
}

static bool plane(const ph_case *c)
{
    return c->kinematics != PH_SPACE;
}

static void guess_shape(const ph_case *c, bounds_composite *b)
{
    const ph_inclusion *inc = c->ninclusions > 0 ? &c->inclusions[0] : NULL;
    const char *shape = inc ? inc->shape : "";
    b->composite.shape = plane(c) ? PH_SHAPE_CYLINDER : PH_SHAPE_SPHERE;
    if (strcmp(shape, "layer") == 0)
        layers(b, inc);
    else if (strcmp(shape, "cylinder") == 0 && !plane(c))
        rod(b, c, inc);
    else if (strcmp(shape, "ellipsoid") == 0 && !plane(c))
        ellipsoid(b, inc);
    else if (inc && strcmp(shape, "disk") != 0 && strcmp(shape, "sphere") != 0)
        snprintf(b->note, sizeof b->note, "inclusions of shape %s are taken as a %s",
                 shape, bounds_shape_name(b->composite.shape));
    else if (!inc && c->voxels.file[0])
        snprintf(b->note, sizeof b->note,
                 "the shape of voxel phases is not known: taken as a %s",
                 bounds_shape_name(b->composite.shape));
    for (int i = 1; i < c->ninclusions; i++)
        if (strcmp(c->inclusions[i].shape, shape) != 0)
            snprintf(
                b->note, sizeof b->note,
                "inclusions of several shapes are all taken as a %s, after the first",
                bounds_shape_name(b->composite.shape));
}

/* Which material the estimates call the matrix: the case's, of voxels the commonest solid. */
static int matrix_of(const ph_case *c, const double *fraction)
{
    if (!c->voxels.file[0]) return c->matrix;
    int best = 0;
    for (int i = 0; i < c->nmaterials; i++) {
        bool better = fraction[i] > fraction[best] || c->materials[best].is_void;
        if (!c->materials[i].is_void && better) best = i;
    }
    return best;
}

static void add_phase(bounds_composite *b, const ph_material *m, double fraction)
{
    double Rt[9];
    for (int i = 0; i < 9; i++)
        Rt[i] = b->R[i % 3 * 3 + i / 3];
    const int n = b->composite.n++;
    b->material[n] = *m;
    b->material[n].stiffness = ph_sym4_rotate(&m->stiffness, Rt);
    b->fraction[n] = fraction;
}

ph_status bounds_composite_init(const ph_case *c, bounds_composite *out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_microstructure *micro = NULL;
    double *fraction = NULL;
    bounds_composite b = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const size_t n = (size_t)c->nmaterials;
    *out = b;
    b.composite.kinematics = c->kinematics;
    b.composite.aspect = 1.0;
    fraction = calloc(n, sizeof *fraction);
    b.fraction = calloc(n, sizeof *b.fraction);
    b.material = calloc(n, sizeof *b.material);
    if (!fraction || !b.fraction || !b.material) {
        st = ph_error_set(err, PH_ENOMEM, __FILE__, __LINE__, "no memory for %zu phases",
                          n);
        goto out;
    }
    PH_TRY(memory_check_cells(c, false, err));
    st = ph_rve_build(c, &micro, err);
    if (st != PH_OK) goto out;
    ph_microstructure_fractions(micro, fraction);
    guess_shape(c, &b);
    const int matrix = matrix_of(c, fraction);
    add_phase(&b, &c->materials[matrix], fraction[matrix]);
    for (int i = 0; i < c->nmaterials; i++)
        if (i != matrix && fraction[i] > 0.0)
            add_phase(&b, &c->materials[i], fraction[i]);
    b.composite.material = b.material;
    b.composite.fraction = b.fraction;
    *out = b;
    b.material = NULL;
    b.fraction = NULL;
out:
    free(fraction);
    ph_microstructure_free(&micro);
    bounds_composite_free(&b);
    return st;
}

void bounds_composite_free(bounds_composite *b)
{
    free(b->material);
    free(b->fraction);
    b->material = NULL;
    b->fraction = NULL;
}

ph_status bounds_evaluate(const bounds_composite *b, const ph_estimate_method *method,
                          ph_sym4 *out, ph_error *err)
{
    ph_status st = method->eval(&b->composite, out, err);
    if (st != PH_OK) return st;
    const double plane_R[4] = {b->R[0], b->R[1], b->R[3], b->R[4]};
    *out = ph_sym4_rotate(out, out->n == 3 ? plane_R : b->R);
    return PH_OK;
}
