/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strains, stresses and their sums: after a solve, not in its loop. */
#include "model/operator.h"

#include <string.h>

void ph_i_operator_strain(ph_operator *op, const double *u, const double *macro,
                          double *strain)
{
    const ph_layout *l = &op->layout;
    if (op->has_cells) {
        ph_i_cells_strain(&op->cells, u, macro, strain);
        return;
    }
    if (op->bonds) {
        ph_i_bondlist_strain(op->bonds, u, macro, strain);
        return;
    }
    if (op->stencil) {
        ph_i_stencil_strain(op->stencil, u, macro, op->pad, strain);
    } else {
        ph_i_operator_forward(op, u, op->hat);
        ph_i_convolution_strain(&op->convolution, op->hat, 1.0 / (double)l->cells,
                                strain);
        for (int i = 0; macro && i < l->ns; i++)
            for (ptrdiff_t x = 0; x < l->cells; x++)
                strain[i * l->cells + x] += macro[i];
    }
    if (op->damaged) ph_i_damaged_strain(op->damaged, u, macro, 1.0, strain);
}

ph_status ph_i_operator_fields(ph_operator *op, const double *u, const double *macro,
                               double *strain, double *stress, ph_error *err)
{
    if (op->springs)
        return ph_i_springs_fields(op->springs, u, macro, stress, strain, NULL, err);
    ph_i_operator_strain(op, u, macro, strain);
    ph_i_hooke_field(op->map, op->threads, strain, stress);
    return PH_OK;
}

/* The strain of a periodic box is the macro strain; over a part of it, its nodes' mean. */
static ph_status sum_springs(ph_operator *op, const double *u, const double *macro,
                             const uint8_t *region, double *stress, double *strain,
                             ph_cell_energy *energy, ph_error *err)
{
    ph_status st = PH_OK;
    const ptrdiff_t n = op->layout.cells;
    const int ns = op->layout.ns;
    double *s = NULL, *e = NULL, *w = NULL;
    PH_DOUBLES(s, op->meter, (size_t)(ns * n), "the stress field");
    PH_DOUBLES(w, op->meter, (size_t)n, "the energy");
    if (region) PH_DOUBLES(e, op->meter, (size_t)(ns * n), "the strain field");
    PH_TRY(ph_i_springs_fields(op->springs, u, macro, s, e, w, err));
    memset(energy, 0, sizeof *energy);
    for (int i = 0; i < ns; i++) {
        stress[i] = 0.0;
        strain[i] = e ? 0.0 : (double)n * (macro ? macro[i] : 0.0);
    }
    for (ptrdiff_t x = 0; x < n; x++) {
        if (region && !region[x]) continue;
        energy->mean += w[x];
        for (int i = 0; i < ns; i++) {
            stress[i] += s[i * n + x];
            if (e) strain[i] += e[i * n + x];
        }
    }
out:
    ph_i_doubles_free(op->meter, &s, (size_t)(ns * n));
    ph_i_doubles_free(op->meter, &e, (size_t)(ns * n));
    ph_i_doubles_free(op->meter, &w, (size_t)n);
    return st;
}

/* Sums of a strain field [ns][cells]; adds share times stress, strain, energy. */
static void sum_field(const ph_operator *op, const double *e, const uint8_t *region,
                      double share, double *stress, double *strain, double *energy)
{
    const ph_layout *l = &op->layout;
    for (ptrdiff_t x = 0; x < l->cells; x++) {
        if (region && !region[x]) continue;
        double v[6], s[6];
        for (int i = 0; i < l->ns; i++)
            v[i] = e[i * l->cells + x];
        ph_i_hooke(op->map, op->map->index[x], v, s);
        for (int i = 0; i < l->ns; i++) {
            stress[i] += share * s[i];
            strain[i] += share * v[i];
            *energy += share * s[i] * v[i];
        }
    }
}

ph_status ph_i_operator_sums(ph_operator *op, const double *u, const double *macro,
                             const uint8_t *region, double *stress, double *strain,
                             ph_cell_energy *energy, ph_error *err)
{
    const ph_layout *l = &op->layout;
    if (op->springs)
        return sum_springs(op, u, macro, region, stress, strain, energy, err);
    if (op->has_cells) {
        ph_i_cells_sums(&op->cells, u, macro, region, stress, strain, energy);
    } else if (op->bonds) {
        double other[6];
        ph_cell_energy not_wanted;
        ph_i_bondlist_sums(op->bonds, u, macro, region, stress, strain, energy);
        if (op->whole)
            ph_i_bondlist_sums(op->whole, u, macro, region, other, strain, &not_wanted);
    } else {
        memset(energy, 0, sizeof *energy);
        for (int i = 0; i < l->ns; i++)
            stress[i] = strain[i] = 0.0;
        ph_i_operator_strain(op, u, macro, op->e);
        sum_field(op, op->e, region, op->share, stress, strain, &energy->mean);
        for (int i = 0; i < op->nsub; i++) {
            ph_i_stencil_strain(op->sub[i], u, macro, op->pad, op->e);
            sum_field(op, op->e, region, (1.0 - op->share) / op->nsub, stress, strain,
                      &energy->modes);
        }
    }
    if (!op->spectral || op->stabilise == 0.0) return PH_OK;
    if (op->damaged) energy->stabilisation += ph_i_damaged_energy(op->damaged, u);
    ph_i_operator_forward(op, u, op->hat);
    ptrdiff_t row = ph_i_fft_row(op->fft);
    for (int a = 0; a < l->nd; a++)
        for (ptrdiff_t k = 0; k < op->modes; k++) {
            const double *z = op->hat + 2 * (a * op->modes + k);
            ptrdiff_t c = k % row;
            double w = c == 0 || (l->n[2] % 2 == 0 && c == row - 1) ? 1.0 : 2.0;
            energy->stabilisation += w * op->stabilise * op->spectral[k] *
                                     (z[0] * z[0] + z[1] * z[1]) / (double)l->cells;
        }
    return PH_OK;
}
