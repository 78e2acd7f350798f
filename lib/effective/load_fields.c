/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/run.h"

#include <math.h>

/* Voigt component i of Mandel values: strain (engineering shear) or stress. */
static double to_voigt(int ns, int i, double mandel, bool strain)
{
    bool shear = i >= (ns == 6 ? 3 : 2);
    return !shear ? mandel : strain ? mandel * sqrt(2.0) : mandel / sqrt(2.0);
}

/* A unit Mandel load is so much of a unit Voigt one: engineering shear, or shear stress. */
static double per_voigt_unit(const ph_run *r, int load)
{
    return ph_i_run_by_stress(r, load) ? 1.0 / to_voigt(r->map->ns, load, 1.0, false)
                                       : 1.0 / to_voigt(r->map->ns, load, 1.0, true);
}

/* Average strain of the load just solved: its column, or what it was loaded with. */
static void macro_strain_of(const ph_run *r, int load, double scale, double *out)
{
    int ns = r->map->ns;
    for (int a = 0; a < ns; a++) {
        double mandel =
            ph_i_run_by_stress(r, a) ? r->columns.m[a][load] : (double)(a == load);
        out[a] = scale * to_voigt(ns, a, mandel, true);
    }
}

ph_status ph_i_run_keep_fields(ph_run *r, int load, const double *macro, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &r->op->layout;
    const ph_grid *g = &r->result->grid, *box = &r->setting.box;
    ptrdiff_t cells = ph_grid_cells(g), x = 0;
    double *strain = NULL, *stress = NULL;
    ph_fields *f = &r->result->fields[r->result->nfields];
    f->load = load;
    f->nu = l->nd;
    f->ns = l->ns;
    r->result->nfields++; /* the result frees what it has got so far */
    PH_ALLOC(f->displacement, l->nd * cells, "the displacement field");
    PH_ALLOC(f->strain, l->ns * cells, "the strain field");
    PH_ALLOC(f->stress, l->ns * cells, "the stress field");
    PH_DOUBLES(strain, &r->meter, (size_t)(l->ns * l->cells), "the strain field");
    PH_DOUBLES(stress, &r->meter, (size_t)(l->ns * l->cells), "the stress field");
    PH_TRY(ph_i_operator_fields(r->op, r->u, macro, strain, stress, err));
    double scale = per_voigt_unit(r, load);
    macro_strain_of(r, load, scale, f->macro_strain);
    double shift = r->result->points == PH_POINTS_NODES ? 0.5 : 0.0;
    for (ptrdiff_t i = 0; i < g->n[0]; i++)
        for (ptrdiff_t j = 0; j < g->n[1]; j++)
            for (ptrdiff_t k = 0; k < g->n[2]; k++, x++) {
                ptrdiff_t at[3] = {i, j, k}, b = 0;
                double pos[3];
                for (int d = 0; d < 3; d++) {
                    b = b * box->n[d] + at[d] + r->setting.first[d];
                    pos[d] = g->n[d] > 1 ? ((double)at[d] + shift) * g->h[d] : 0.0;
                }
                for (int a = 0; a < l->ns; a++) {
                    double e = strain[a * l->cells + b], t = stress[a * l->cells + b];
                    f->strain[a * cells + x] = scale * to_voigt(l->ns, a, e, true);
                    f->stress[a * cells + x] = scale * to_voigt(l->ns, a, t, false);
                }
                for (int a = 0; a < l->nd; a++) {
                    double u = r->u[a * l->cells + b];
                    for (int d = 0; macro && d < l->nd; d++) {
                        int c = a == d ? a : l->nd == 3 ? 6 - a - d : 2;
                        u += macro[c] * (a == d ? 1.0 : 1.0 / sqrt(2.0)) * pos[d];
                    }
                    f->displacement[a * cells + x] = scale * u;
                }
            }
out:
    ph_i_doubles_free(&r->meter, &strain, (size_t)(l->ns * l->cells));
    ph_i_doubles_free(&r->meter, &stress, (size_t)(l->ns * l->cells));
    return st;
}
