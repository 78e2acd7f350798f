/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A microstructure and a result made by hand: every number is known, no solver runs. */
#ifndef TESTS_IO_SAMPLE_H
#define TESTS_IO_SAMPLE_H

#include <perihom.h>

#include "check.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

static const double sample_pi = 3.14159265358979323846;

/* Three different axes, so that no two can be mixed up unseen. */
static inline ph_microstructure *sample_micro(ph_kinematics kin)
{
    ph_error err = PH_ERROR_INIT;
    const ptrdiff_t n[3] = {5, 3, 4};
    const double size[3] = {2.0, 1.5, 0.8};
    ph_grid grid;
    ph_material material[3];
    ph_microstructure *micro = NULL;
    assert_int_equal(ph_grid_init(&grid, kin, n, size, &err), PH_OK);
    assert_int_equal(ph_material_isotropic("matrix", 2.385, 0.31, &material[0], &err),
                     PH_OK);
    assert_int_equal(ph_material_isotropic("fibre <1>", 71.3, 0.22, &material[1], &err),
                     PH_OK);
    material[2] = ph_material_void("hole");
    assert_int_equal(ph_microstructure_new(&grid, 3, material, &micro, &err), PH_OK);
    ptrdiff_t cells = ph_grid_cells(&grid);
    for (ptrdiff_t x = 0; x < cells; x++)
        micro->phase[x] = (uint16_t)(x * x % 7 % 3);
    micro->ncuts = 2;
    micro->cuts = calloc(2, sizeof *micro->cuts);
    assert_non_null(micro->cuts);
    /* of cells 3 and 7 the larger share is what `phase` says */
    micro->cuts[0] = (ph_cut){.cell = 3, .base = 1, .material = 2, .fraction = 0.375};
    micro->cuts[1] = (ph_cut){.cell = 7, .base = 0, .material = 1, .fraction = 0.125};
    micro->phase[3] = 1;
    micro->phase[7] = 0;
    micro->cuts[0].normal[0] = 0.6;
    micro->cuts[0].normal[1] = 0.8;
    micro->cuts[1].normal[1] = 1;
    return micro;
}

/* A different linear function of place for every component: shows any mix-up of axes. */
static inline double sample_value(int component, double x, double y, double z)
{
    return component + 10 * x + 100 * y - 1000 * z;
}

/* Periodic part of the displacement. */
static inline double sample_wave(const ph_grid *g, int c, const double x[3])
{
    return 0.01 * (c + 1) * cos(2 * sample_pi * x[0] / g->size[0]) *
           sin(2 * sample_pi * (x[1] / g->size[1] + x[2] / g->size[2]) + c);
}

/* Macro strain of load `a`: high-entropy numbers in every component. */
static inline void sample_macro(int a, int ns, double eps[6])
{
    for (int b = 0; b < ns; b++)
        eps[b] = b == a ? 1.0 : 0.0137 * (b + 2 * a + 1);
}

static inline double sample_affine(int ns, const double *eps, int c, const double x[3])
{
    double e[3][3] = {{eps[0], 0, 0}, {0, eps[1], 0}, {0, 0, 0}};
    if (ns == 3) {
        e[0][1] = e[1][0] = eps[2] / 2;
    } else {
        e[2][2] = eps[2];
        e[1][2] = e[2][1] = eps[3] / 2;
        e[0][2] = e[2][0] = eps[4] / 2;
        e[0][1] = e[1][0] = eps[5] / 2;
    }
    return e[c][0] * x[0] + e[c][1] * x[1] + e[c][2] * x[2];
}

static inline void sample_fields(const ph_grid *g, int load, ph_points points,
                                 ph_fields *f)
{
    size_t cells = (size_t)ph_grid_cells(g), q = 0;
    f->load = load;
    f->ns = ph_strains(g->kinematics);
    f->nu = ph_displacements(g->kinematics);
    sample_macro(load, f->ns, f->macro_strain);
    f->displacement = calloc((size_t)f->nu * cells, sizeof(double));
    f->strain = calloc((size_t)f->ns * cells, sizeof(double));
    f->stress = calloc((size_t)f->ns * cells, sizeof(double));
    assert_true(f->displacement && f->strain && f->stress);
    bool space = g->kinematics == PH_SPACE;
    double shift = points == PH_POINTS_NODES ? 0.5 : 0;
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++, q++) {
                double at[3] = {((double)i + 0.5) * g->h[0], ((double)j + 0.5) * g->h[1],
                                space ? ((double)k + 0.5) * g->h[2] : 0};
                double node[3] = {((double)i + shift) * g->h[0],
                                  ((double)j + shift) * g->h[1],
                                  space ? ((double)k + shift) * g->h[2] : 0};
                for (int a = 0; a < f->ns; a++) {
                    f->strain[(size_t)a * cells + q] =
                        sample_value(a, at[0], at[1], at[2]);
                    f->stress[(size_t)a * cells + q] =
                        -2 * sample_value(a + load, at[0], at[1], at[2]);
                }
                for (int c = 0; c < f->nu; c++)
                    f->displacement[(size_t)c * cells + q] =
                        sample_affine(f->ns, f->macro_strain, c, node) +
                        sample_wave(g, c, node);
            }
}

/* A finished result with the fields of the loads of `keep`. */
static inline ph_result *sample_result(const ph_microstructure *micro, ph_points points,
                                       unsigned keep)
{
    ph_result *r = calloc(1, sizeof *r);
    assert_non_null(r);
    ph_kinematics kin = micro->grid.kinematics;
    int n = ph_strains(kin);
    r->grid = micro->grid;
    ph_sym4 c = ph_sym4_isotropic(13.0 / 7, 0.2718);
    ph_sym4 stiff = ph_sym4_isotropic(29.0 / 7, 0.2718),
            soft = ph_sym4_isotropic(0.7, 0.27);
    ph_error err = PH_ERROR_INIT;
    assert_int_equal(ph_sym4_reduce(&c, kin, &r->stiffness, &err), PH_OK);
    assert_int_equal(ph_sym4_reduce(&stiff, kin, &r->voigt, &err), PH_OK);
    assert_int_equal(ph_sym4_reduce(&soft, kin, &r->reuss, &err), PH_OK);
    r->loads = r->solved = n == 6 ? 63 : 7;
    r->nmaterials = micro->nmaterials;
    r->names = calloc((size_t)micro->nmaterials, sizeof *r->names);
    r->fractions = calloc((size_t)micro->nmaterials, sizeof *r->fractions);
    assert_true(r->names && r->fractions);
    for (int i = 0; i < micro->nmaterials; i++)
        memcpy(r->names[i], micro->materials[i].name, sizeof r->names[i]);
    ph_microstructure_fractions(micro, r->fractions);
    r->model = "nosb";
    r->constraint = "periodic";
    r->solver = "fft_cg";
    r->precision = "single";
    r->route = "cells";
    r->points = points;
    r->horizon = 1.0 / 3;
    r->stabilisation = PH_STABILISE_SPECTRAL;
    r->stabilisation_value = 1e-4;
    r->nloads = n;
    for (int a = 0; a < n; a++) {
        r->iterations[a] = 14 + a;
        r->residual[a] = 1e-7 / (a + 3);
    }
    r->converged = true;
    r->hill_mandel = 1e-9 / 3;
    r->stabilisation_energy = 3e-4 / 7;
    r->work.applications = 101;
    r->work.ffts = 1212;
    r->seconds = 0.4 / 3;
    r->seconds_solve = 0.3 / 7;
    r->work.peak_bytes = 12345678;
    r->threads = 2;
    r->nnotes = 1;
    snprintf(r->notes[0], sizeof r->notes[0], "chose \"nosb\"");
    r->fields = calloc(6, sizeof *r->fields);
    assert_non_null(r->fields);
    for (int a = 0; a < n; a++)
        if (keep >> a & 1u) sample_fields(&r->grid, a, points, &r->fields[r->nfields++]);
    return r;
}

static inline void sample_case(ph_case *c)
{
    memset(c, 0, sizeof *c);
    snprintf(c->title, sizeof c->title, "Sample & <test>");
    snprintf(c->unit_length, sizeof c->unit_length, "um");
    snprintf(c->unit_stress, sizeof c->unit_stress, "GPa");
    snprintf(c->unit_time, sizeof c->unit_time, "s");
    c->seed = 42;
    c->ninclusions = 0;
}

/* A fresh folder below TMPDIR or /tmp; removed by sample_remove_folder. */
static inline void sample_folder(char path[256])
{
    const char *base = getenv("TMPDIR");
    snprintf(path, 256, "%s/perihom-test-XXXXXX",
             base && strlen(base) < 200 ? base : "/tmp");
    assert_non_null(mkdtemp(path));
}

/* Number of entries of a folder; with `empty` they are removed. */
static inline int sample_entries(const char *folder, bool empty)
{
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    int count = 0;
    char name[1024];
    for (struct dirent *entry; (entry = readdir(dir));) {
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
        count++;
        snprintf(name, sizeof name, "%s/%s", folder, entry->d_name);
        if (empty) (void)remove(name);
    }
    closedir(dir);
    return count;
}

static inline void sample_remove_folder(const char *folder)
{
    sample_entries(folder, true);
    rmdir(folder);
}

/* A whole file, malloc'd, ended by a zero. */
static inline char *sample_read(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *text = calloc((size_t)size + 1, 1);
    assert_non_null(text);
    *length = fread(text, 1, (size_t)size, file);
    fclose(file);
    return text;
}

#endif
