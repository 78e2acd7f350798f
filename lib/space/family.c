/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/family.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

/* Below this a weight is round-off of the ramp's end, not a bond. */
static const double smallest_weight = 1e-12;

static int half_diagonal_check(const ph_family *f, const double h[3], double *least)
{
    double sum = 0.0, widest = 0.0;
    for (int d = 0; d < 3; d++)
        if (f->active[d]) {
            sum += h[d] * h[d];
            widest = fmax(widest, h[d]);
        }
    *least = f->points == PH_POINTS_STRESS ? 0.5 * sqrt(sum) : widest;
    return f->horizon >= *least * (1.0 - 1e-9);
}

/* Weight of the node at offset o, bond xi from the point. */
static double bond_weight(const ph_family *f, const double h[3], const double xi[3],
                          const ph_influence *influence, const ph_volume_weight *weight)
{
    double r = sqrt(xi[0] * xi[0] + xi[1] * xi[1] + xi[2] * xi[2]);
    if (r == 0.0) return 0.0;
    double beta = f->points == PH_POINTS_STRESS
                      ? (double)(r <= f->horizon * (1.0 + 1e-9))
                      : weight->eval(xi, h, f->active, f->horizon);
    if (beta <= 0.0) return 0.0;
    double w = influence->eval(r / f->horizon) * beta;
    return w > smallest_weight ? w : 0.0;
}

/* Visit every offset in reach; with `fill`, store the bonds. Returns their number. */
static ptrdiff_t scan(ph_family *f, const double h[3], const ph_influence *influence,
                      const ph_volume_weight *weight, bool fill)
{
    double shift = f->points == PH_POINTS_STRESS ? 0.5 : 0.0;
    int low[3], high[3];
    for (int d = 0; d < 3; d++) {
        int n = f->active[d] ? (int)ceil(f->horizon / h[d]) + 1 : 0;
        low[d] = -n;
        high[d] = f->active[d] && shift > 0.0 ? n + 1 : n;
    }
    ptrdiff_t count = 0;
    for (int i = low[0]; i <= high[0]; i++)
        for (int j = low[1]; j <= high[1]; j++)
            for (int k = low[2]; k <= high[2]; k++) {
                int o[3] = {i, j, k};
                double xi[3];
                for (int d = 0; d < 3; d++)
                    xi[d] = f->active[d] ? (o[d] - shift) * h[d] : 0.0;
                double w = bond_weight(f, h, xi, influence, weight);
                if (w == 0.0) continue;
                if (fill) {
                    memcpy(f->offset[count], o, sizeof o);
                    memcpy(f->xi[count], xi, sizeof xi);
                    f->w[count] = w;
                }
                count++;
            }
    return count;
}

/* Inverse of the shape tensor on the active axes, zero elsewhere. */
static ph_status invert_shape(const ph_family *f, double inv[3][3], ph_error *err)
{
    ph_status st = PH_OK;
    double a[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] = f->active[i] && f->active[j] ? f->K[i][j] : (double)(i == j);
    double c[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1];
        }
    double det = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2], scale = 1.0;
    for (int d = 0; d < 3; d++)
        if (f->active[d]) scale *= f->K[d][d]; /* cells may be long and thin */
    PH_CHECK(det > 1e-14 * scale, PH_ESINGULAR,
             "the shape tensor of the family is singular: the horizon %g reaches too few "
             "nodes; give a larger horizon",
             f->horizon);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            inv[i][j] = f->active[i] && f->active[j] ? c[j][i] / det : 0.0;
out:
    return st;
}

/* Weighted mean, shape tensor and gradient weights from the bonds. */
static ph_status weigh(ph_family *f, ph_error *err)
{
    ph_status st = PH_OK;
    double mean[3] = {0, 0, 0}, inv[3][3];
    f->weight = 0.0;
    for (ptrdiff_t b = 0; b < f->count; b++) {
        f->weight += f->w[b];
        for (int d = 0; d < 3; d++)
            mean[d] += f->w[b] * f->xi[b][d];
    }
    for (int d = 0; d < 3; d++)
        mean[d] /= f->weight;
    /* Stress points have no node at the centre: bonds are measured from the mean, so that
     * linear fields stay exact. Nodes: the family is symmetric, the mean is the node. */
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int d = 0; d < 3; d++) {
            if (f->points == PH_POINTS_STRESS) f->xi[b][d] -= mean[d];
            f->reach[d] =
                abs(f->offset[b][d]) > f->reach[d] ? abs(f->offset[b][d]) : f->reach[d];
        }
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                f->K[i][j] += f->w[b] * f->xi[b][i] * f->xi[b][j];
    PH_TRY(invert_shape(f, inv, err));
    for (ptrdiff_t b = 0; b < f->count; b++)
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                f->g[b][i] += f->w[b] * inv[i][j] * f->xi[b][j];
            f->g0[i] -= f->g[b][i];
        }
    if (f->points == PH_POINTS_STRESS) memset(f->g0, 0, sizeof f->g0);
out:
    return st;
}

static ph_status check_reach(const ph_grid *grid, const ph_family *f, ph_error *err)
{
    ph_status st = PH_OK;
    static const char axis_name[] = "123";
    double least;
    PH_CHECK_KEY(half_diagonal_check(f, grid->h, &least), PH_EINVAL, "model.horizon",
                 "horizon %g is too small for this grid: at least %g (%s)", f->horizon,
                 least,
                 f->points == PH_POINTS_STRESS ? "half the diagonal of a cell"
                                               : "the largest spacing");
    /* Half a diagonal reaches the corners of the cell and nothing else, however flat it is. */
    if (f->points == PH_POINTS_STRESS && f->horizon <= least * (1.0 + 1e-9)) return PH_OK;
    for (int d = 0; d < 3; d++)
        PH_CHECK_KEY(
            !f->active[d] || f->horizon <= 0.5 * grid->size[d] * (1.0 + 1e-9) ||
                f->horizon <= 2.0 * grid->h[d] * (1.0 + 1e-9),
            PH_EINVAL, "model.horizon",
            "horizon %g is more than half the box along axis %c (size %g): a point "
            "would meet its own images; give a smaller horizon or a larger RVE",
            f->horizon, axis_name[d], grid->size[d]);
out:
    return st;
}

ph_status ph_family_new(const ph_grid *grid, ph_points points, double horizon,
                        const ph_influence *influence, const ph_volume_weight *weight,
                        ph_family **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_family *f = NULL;
    PH_CHECK(out && grid && influence && weight, PH_EINVAL, "NULL argument");
    *out = NULL;
    PH_CHECK_KEY(isfinite(horizon) && horizon > 0.0, PH_EINVAL, "model.horizon",
                 "horizon must be > 0, got %g", horizon);
    PH_ALLOC(f, 1, "a family");
    f->points = points == PH_POINTS_STRESS ? PH_POINTS_STRESS : PH_POINTS_NODES;
    f->horizon = horizon;
    for (int d = 0; d < 3; d++)
        f->active[d] = grid->n[d] > 1;
    if (f->active[0] || f->active[1] || f->active[2]) PH_TRY(check_reach(grid, f, err));
    f->count = scan(f, grid->h, influence, weight, false);
    PH_ALLOC(f->offset, f->count, "bond offsets");
    PH_ALLOC(f->xi, f->count, "bonds");
    PH_ALLOC(f->w, f->count, "bond weights");
    PH_ALLOC(f->g, f->count, "gradient weights");
    scan(f, grid->h, influence, weight, true);
    if (f->active[0] || f->active[1] || f->active[2]) {
        PH_CHECK_KEY(
            f->count > 0, PH_EINVAL, "model.influence",
            "the family of horizon %g has no bond with influence '%s', which is zero at "
            "the horizon: give a larger model.horizon or another influence",
            horizon, influence->info.name);
        PH_TRY(weigh(f, err));
    }
    *out = f;
    f = NULL;
out:
    ph_family_free(&f);
    return st;
}

void ph_family_free(ph_family **family)
{
    if (!family || !*family) return;
    ph_family *f = *family;
    free(f->offset);
    free(f->xi);
    free(f->w);
    free(f->g);
    free(f);
    *family = NULL;
}
