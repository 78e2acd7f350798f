/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Averages and fields of the corner cells: not in the loop of a solver. */
#include "model/cells_kernel.h"

#include <string.h>

static void strain_of(const ph_cells *c, const weights *w, const row *r, ptrdiff_t k,
                      double *e)
{
    int nd = c->layout.nd, ns = c->layout.ns;
    vec v[3] = {{0}}, sum[6];
    for (int i = 0; i < ns; i++)
        sum[i] = all(w->macro[i]);
    for (int d = 0; d < nd; d++) {
        for (int a = 0; a < nd; a++)
            v[a] = all(r->g[a][d][k]);
        add_column(nd, sum, d, v);
    }
    for (int i = 0; i < ns; i++)
        e[i] = sum[i][0];
}

void ph_i_cells_strain(const ph_cells *c, const double *u, const double *macro,
                       double *strain)
{
    const ph_layout *l = &c->layout;
    weights w = ph_i_cells_weights(c, macro, 1.0);
    row r = ph_i_cells_lines(c, 0);
    for (ptrdiff_t i = 0; i < l->n[0]; i++)
        for (ptrdiff_t j = 0; j < l->n[1]; j++) {
            ph_i_cells_gather(c, u, i, j, false, &r);
            for (ptrdiff_t k = 0; k < l->n[2]; k++) {
                double e[6];
                strain_of(c, &w, &r, k, e);
                for (int a = 0; a < l->ns; a++)
                    strain[a * l->cells + (i * l->n[1] + j) * l->n[2] + k] = e[a];
            }
        }
}

int ph_i_cells_records(const ph_cells *c, double *weight)
{
    const ph_layout *l = &c->layout;
    bool all_axes = l->axis[0] >= 0 && l->axis[1] >= 0 && l->axis[2] >= 0;
    int n = 0;
    weight[n++] = 1.0;
    for (int d = 0; d < l->nd && c->c1 != 0.0; d++)
        weight[n++] = c->c1;
    for (int d = 0; d < 3 && all_axes && c->c2 != 0.0; d++)
        weight[n++] = c->c2;
    return n;
}

/* Strain of the mode linear along d (record 1 + d), or bilinear across d (1 + nd + d), as in
 * linear_mode and bilinear_mode. */
static void mode_strain(const ph_cells *c, const row *r, int record, ptrdiff_t k,
                        double *e)
{
    int nd = c->layout.nd, ns = c->layout.ns;
    bool linear = record <= nd;
    int d = linear ? record - 1 : record - 1 - nd;
    vec v[3] = {{0}}, sum[6];
    for (int i = 0; i < ns; i++)
        sum[i] = all(0.0);
    for (int b = 0; b < nd; b++) {
        if (linear == (b == d)) continue;
        for (int a = 0; a < nd; a++)
            v[a] = all(c->f[b] * r->q[a][linear ? 3 - d - b : 3][k]);
        add_column(nd, sum, b, v);
    }
    for (int i = 0; i < ns; i++)
        e[i] = sum[i][0];
}

void ph_i_cells_records_strain(const ph_cells *c, const double *u, const double *macro,
                               ptrdiff_t count, const ptrdiff_t *cell, double *strain)
{
    const ph_layout *l = &c->layout;
    weights w = ph_i_cells_weights(c, macro, 1.0);
    row r = ph_i_cells_lines(c, 0);
    double weight[7];
    int records = ph_i_cells_records(c, weight);
    ptrdiff_t line = -1;
    for (ptrdiff_t i = 0; i < count; i++) {
        ptrdiff_t k = cell[i] % l->n[2], at = cell[i] / l->n[2];
        if (at != line)
            ph_i_cells_gather(c, u, at / l->n[1], at % l->n[1], records > 1, &r);
        line = at;
        strain_of(c, &w, &r, k, strain + i * l->ns);
        for (int m = 1; m < records; m++)
            mode_strain(c, &r, m, k, strain + (m * count + i) * l->ns);
    }
}

/* Twice the energy of the modes of one cell: sum of raw amplitude times its force. */
static void mode_energy(const ph_cells *c, const double *q, const double *m,
                        ph_hooke kind, ph_cell_energy *energy)
{
    weights w = ph_i_cells_weights(c, NULL, 1.0);
    const lanes own = {-1, 0, 0, 0};
    double value[3][PAIRS][LANES] = {{{0}}}, force[3][PAIRS][LANES] = {{{0}}};
    row one;
    for (int a = 0; a < 3; a++)
        for (int p = 0; p < PAIRS; p++) {
            value[a][p][0] = q[a * PAIRS + p];
            one.q[a][p] = value[a][p];
            one.p[a][p] = force[a][p];
            energy->stabilisation += c->hourglass * q[a * PAIRS + p] * q[a * PAIRS + p];
        }
    w.hourglass = 0.0;
    if (c->layout.nd == 3)
        other_modes(3, kind, m, &w, &one, 0, own);
    else
        other_modes(2, kind, m, &w, &one, 0, own);
    for (int a = 0; a < 3; a++)
        for (int p = 0; p < PAIRS; p++)
            energy->modes += q[a * PAIRS + p] * force[a][p][0];
}

void ph_i_cells_sums(const ph_cells *c, const double *u, const double *macro,
                     const uint8_t *region, double *stress, double *strain,
                     ph_cell_energy *energy)
{
    const ph_layout *l = &c->layout;
    weights w = ph_i_cells_weights(c, macro, 1.0);
    row r = ph_i_cells_lines(c, 0);
    bool modes = ph_i_cells_has_modes(c);
    memset(energy, 0, sizeof *energy);
    for (int a = 0; a < l->ns; a++)
        stress[a] = strain[a] = 0.0;
    for (ptrdiff_t i = 0; i < l->n[0]; i++)
        for (ptrdiff_t j = 0; j < l->n[1]; j++) {
            ph_i_cells_gather(c, u, i, j, modes, &r);
            for (ptrdiff_t k = 0; k < l->n[2]; k++) {
                ptrdiff_t x = (i * l->n[1] + j) * l->n[2] + k;
                if (region && !region[x]) continue;
                int entry = c->map->index[x];
                double e[6], s[6], q[3 * PAIRS];
                strain_of(c, &w, &r, k, e);
                ph_i_hooke(c->map, entry, e, s);
                for (int a = 0; a < l->ns; a++) {
                    stress[a] += s[a];
                    strain[a] += e[a];
                    energy->mean += s[a] * e[a];
                }
                if (!modes) continue;
                for (int a = 0; a < 3; a++)
                    for (int p = 0; p < PAIRS; p++)
                        q[a * PAIRS + p] = a < l->nd ? r.q[a][p][k] : 0.0;
                mode_energy(c, q, c->map->c + (ptrdiff_t)entry * l->ns * l->ns,
                            c->map->hooke[entry] == PH_HOOKE_ZERO ? PH_HOOKE_GENERAL
                                                                  : c->map->hooke[entry],
                            energy);
            }
        }
}
