/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells whose equations have a closed form: one stiffness everywhere, or layers across one
 * axis. With sym(a (x) n) = N a for the normal n and Z = N^T C N of each layer [Backus1962],
 *
 *   C* = <C> - <C N Z^-1 N^T C> + <C N Z^-1> <Z^-1>^-1 <Z^-1 N^T C>,
 *
 * means over the layers: the traction N^T sigma is the same in all of them, and so is what
 * of the strain is not N a. Cells that an interface cuts are layers of the same normal.
 * Tested: tests/verify/test_layers.c, tests/verify/test_work.c */
#include "effective/directions.h"
#include "effective/run.h"

#include <math.h>
#include <string.h>

/* Cells mixed of one material differ by so much. */
static const double round_off = 1e-14;

static const double *tensor_at(const ph_stiffness_map *map, ptrdiff_t x)
{
    return map->c + (ptrdiff_t)map->index[x] * map->ns * map->ns;
}

static bool same_tensor(int n, const double *a, const double *b)
{
    double off = 0.0, size = 0.0;
    if (a == b) return true;
    for (int i = 0; i < n; i++) {
        off = fmax(off, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return off <= round_off * size;
}

/* Does the stiffness change along no axis but this one (-1: along none)? */
static bool varies_along(const ph_run *r, int axis)
{
    const ph_stiffness_map *map = r->map;
    const ptrdiff_t *n = r->setting.box.n;
    ptrdiff_t stride = axis == 0 ? n[1] * n[2] : axis == 1 ? n[2] : 1;
    for (ptrdiff_t x = 0; x < map->cells; x++) {
        ptrdiff_t layer = axis < 0 ? 0 : x / stride % n[axis] * stride;
        if (!same_tensor(map->ns * map->ns, tensor_at(map, x), tensor_at(map, layer)))
            return false;
    }
    return true;
}

static ph_sym4 sym4_at(const ph_stiffness_map *map, ptrdiff_t x)
{
    ph_sym4 c = {.n = map->ns};
    const double *m = tensor_at(map, x);
    for (int i = 0; i < c.n; i++)
        memcpy(c.m[i], m + i * c.n, sizeof(double) * (size_t)c.n);
    return c;
}

/* Sums over the layers: flexible += C - CN R CN^T, coupling += CN R, give += R. */
static bool add_layer(const ph_sym4 *c, double N[6][3], int d, ph_sym4 *flexible,
                      double coupling[6][3], double give[3][3])
{
    double CN[6][3], Z[3][3] = {{0}}, R[3][3];
    ph_i_contract(c, N, CN, Z);
    if (!ph_i_invert_small(d, Z, R)) return false;
    for (int a = 0; a < c->n; a++)
        for (int j = 0; j < d; j++) {
            double CNR = 0.0;
            for (int i = 0; i < d; i++)
                CNR += CN[a][i] * R[i][j];
            coupling[a][j] += CNR;
            for (int b = 0; b < c->n; b++)
                flexible->m[a][b] -= CNR * CN[b][j];
        }
    for (int a = 0; a < c->n; a++)
        for (int b = 0; b < c->n; b++)
            flexible->m[a][b] += c->m[a][b];
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++)
            give[i][j] += R[i][j];
    return true;
}

/* False where a layer does not resist: a void, or nearly one. */
static bool laminate(const ph_run *r, int axis, ph_sym4 *out)
{
    const ptrdiff_t *n = r->setting.box.n;
    const int ns = r->map->ns, d = ns == 3 ? 2 : 3;
    const double share = 1.0 / (double)n[axis];
    ptrdiff_t stride = axis == 0 ? n[1] * n[2] : axis == 1 ? n[2] : 1;
    double normal[3] = {axis == 0, axis == 1, axis == 2}, N[6][3], coupling[6][3] = {{0}};
    double give[3][3] = {{0}}, hold[3][3];
    ph_sym4 sum = {.n = ns};
    ph_i_normal_matrix(ns, normal, N);
    for (ptrdiff_t k = 0; k < n[axis]; k++) {
        ph_sym4 c = sym4_at(r->map, k * stride);
        if (!add_layer(&c, N, d, &sum, coupling, give)) return false;
    }
    if (!ph_i_invert_small(d, give, hold)) return false;
    for (int a = 0; a < ns; a++)
        for (int b = 0; b < ns; b++)
            for (int i = 0; i < d; i++)
                for (int j = 0; j < d; j++)
                    sum.m[a][b] += coupling[a][i] * hold[i][j] * coupling[b][j];
    for (int a = 0; a < ns; a++)
        for (int b = 0; b <= a; b++)
            sum.m[a][b] = sum.m[b][a] = 0.5 * share * (sum.m[a][b] + sum.m[b][a]);
    *out = sum;
    return true;
}

/* Fields are asked for, bonds are broken or the solver is named: then equations are solved. */
static bool wants_equations(const ph_run *r)
{
    const char *kind = r->problem->solver.kind;
    return r->problem->keep_fields || r->result->bond.present || r->broken ||
           r->setting.source || (kind && strcmp(kind, "auto") != 0);
}

bool ph_i_run_closed_form(const ph_run *r, ph_sym4 *c, char *why)
{
    if (wants_equations(r)) return false;
    if (varies_along(r, -1)) {
        *c = sym4_at(r->map, 0); /* not the mean of the phases: cells may be mixtures */
        snprintf(why, 64, "the cell is homogeneous");
        return true;
    }
    /* A horizon that is a length stays as large on fine grids: not this limit. */
    if (r->setting.fixed || r->problem->model.horizon_is_length) return false;
    for (int a = 0; a < 3; a++)
        if (r->setting.box.n[a] > 1 && varies_along(r, a) && laminate(r, a, c)) {
            snprintf(why, 64, "layers across axis %d: exact laminate", a + 1);
            return true;
        }
    return false;
}
