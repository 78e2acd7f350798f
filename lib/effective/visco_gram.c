/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of the reduced model: K_q[i][j] = <e_i : X_q : e_j>, with the operator whose stiffness
 * is X_q where cells are of one phase, and layer by layer where they are not. (S) follows the
 * shape of one phase through the functions. */
#include "core/dense.h"
#include "effective/visco.h"

#include <math.h>
#include <string.h>

static double trace(const ph_sym4 *c)
{
    double t = 0.0;
    for (int i = 0; i < c->n; i++)
        t += c->m[i][i];
    return t;
}

/* Stiffness X_q, cut cells empty, and (S) by the share that q has of the soft phase. */
static ph_status set_function(ph_visco *v, int q, ph_error *err)
{
    const ph_run *r = &v->run;
    const ph_microstructure *micro = r->problem->micro;
    if (r->op->springs) {
        ph_i_bond_functions_set(&v->bonds, INFINITY, q, r->classes);
        return ph_i_operator_renew_springs(r->op, err);
    }
    double whole = 0.0, own = trace(ph_i_split_shape(&v->split, q, v->soft));
    for (int k = 0; k < v->split.nfunctions; k++)
        whole += trace(ph_i_split_shape(&v->split, k, v->soft));
    ph_i_operator_stabilise(r->op, own / whole);
    return ph_i_stiffness_map_set(r->map, micro, v->shape + q * micro->nmaterials, false,
                                  err);
}

/* y = weights shares X_q x of the layers. */
static void layer_stress(const ph_visco *v, int q, const double *x, double *y)
{
    int n = v->run.problem->micro->nmaterials;
    ph_i_layers_stress(&v->layers, &v->sites, v->shape + q * n, v->split.shape + q * n, x,
                       y);
}

/* Layers of macro strain a, in v->x. */
static void macro_layers(ph_visco *v, int a)
{
    double unit[6] = {0};
    unit[a] = 1.0;
    ph_i_sites_strain(&v->sites, NULL, unit, v->strain);
    ph_i_layers_spread(&v->layers, &v->sites, v->strain, v->x);
}

ph_status ph_i_visco_macro_rows(ph_visco *v, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    int ns = r->map->ns;
    double n = (double)r->setting.averaged, stress[6], strain[6];
    ph_cell_energy e;
    memset(v->u, 0, sizeof *v->u * ph_i_visco_size(v));
    PH_ALLOC(v->whole, 36 * v->nfunctions, "the reduced model");
    for (int q = 0; q < v->nfunctions; q++) {
        PH_TRY(set_function(v, q, err));
        for (int a = 0; a < ns; a++) {
            double unit[6] = {0};
            unit[a] = 1.0;
            PH_TRY(ph_i_operator_sums(r->op, v->u, unit, r->setting.region, stress,
                                      strain, &e, err));
            v->out->applications++;
            for (int b = 0; b <= a; b++)
                ph_i_reduced_add(&v->model, q, a, b, stress[b] / n);
            for (int b = 0; b < ns; b++)
                v->whole[36 * q + 6 * a + b] = stress[b] / n;
            if (v->layers.count == 0) continue;
            macro_layers(v, a);
            layer_stress(v, q, v->x, v->y);
            for (int b = 0; b <= a; b++) {
                macro_layers(v, b);
                ph_i_reduced_add(&v->model, q, a, b,
                                 ph_i_inner((ptrdiff_t)ph_i_visco_hidden(v), v->x, v->y) /
                                     n);
            }
        }
    }
out:
    return st;
}

/* Row of basis field j in function q; load[a] = - B^T X_q of macro strain a. */
static void field_row(ph_visco *v, int q, int j, double *const load[6])
{
    ph_run *r = &v->run;
    const ph_basis_field *b = &v->basis[j];
    size_t size = ph_i_visco_size(v), hidden = ph_i_visco_hidden(v);
    int ns = r->map->ns, row = ns + j;
    double n = (double)r->setting.averaged, stress[6];
    ph_i_operator_apply(r->op, b->u, v->f);
    for (int a = 0; a < ns; a++) {
        stress[a] = -ph_i_inner((ptrdiff_t)size, load[a], b->u) / n;
        for (int c = 0; c < ns; c++)
            stress[a] += v->whole[36 * q + 6 * a + c] * b->macro[c];
        for (size_t i = 0; b->macro[a] != 0.0 && i < size; i++)
            v->f[i] -= b->macro[a] * load[a][i];
    }
    for (int i = 0; i <= j; i++) {
        double sum = ph_i_inner((ptrdiff_t)size, v->basis[i].u, v->f) / n;
        for (int a = 0; a < ns; a++)
            sum += v->basis[i].macro[a] * stress[a];
        ph_i_reduced_add(&v->model, q, row, ns + i, sum);
    }
    for (int a = 0; a < ns; a++)
        ph_i_reduced_add(&v->model, q, row, a, stress[a]);
    if (v->layers.count == 0) return;
    layer_stress(v, q, b->x, v->y);
    for (int i = 0; i <= j; i++)
        ph_i_reduced_add(&v->model, q, row, ns + i,
                         ph_i_inner((ptrdiff_t)hidden, v->basis[i].x, v->y) / n);
    for (int a = 0; a < ns; a++) {
        macro_layers(v, a);
        ph_i_reduced_add(&v->model, q, row, a,
                         ph_i_inner((ptrdiff_t)hidden, v->x, v->y) / n);
    }
}

ph_status ph_i_visco_gram(ph_visco *v, int more, ph_error *err)
{
    ph_status st = PH_OK;
    ph_run *r = &v->run;
    PH_TRY(ph_i_reduced_grow(&v->model, more, err));
    for (int q = 0; more > 0 && q < v->nfunctions; q++) {
        PH_TRY(set_function(v, q, err));
        for (int a = 0; a < r->map->ns; a++) {
            double unit[6] = {0};
            unit[a] = 1.0;
            ph_i_operator_load(r->op, unit, v->r[a]);
            v->out->applications++;
        }
        for (int j = v->nbasis - more; j < v->nbasis; j++)
            field_row(v, q, j, v->r);
    }
out:
    return st;
}
