/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/cells_kernel.h"

#include <math.h>
#include <string.h>

#ifndef PH_SINGLE
ph_status ph_i_cells_init(ph_cells *cells, const ph_layout *layout,
                          const ph_stiffness_map *map, double c1, double c2,
                          double hourglass, int threads, ph_meter *meter, ph_error *err)
{
    ph_status st = PH_OK;
    memset(cells, 0, sizeof *cells);
    cells->layout = *layout;
    cells->map = map;
    cells->c1 = c1;
    cells->c2 = c2;
    cells->hourglass = hourglass;
    cells->threads = threads > 0 ? threads : 1;
    double corners = 1.0;
    for (int a = 0; a < 3; a++)
        if (layout->axis[a] >= 0) corners *= 2.0;
    for (int a = 0; a < 3; a++)
        if (layout->axis[a] >= 0)
            cells->f[layout->axis[a]] = 2.0 / (corners * layout->h[a]);
    cells->line = (layout->n[2] + 8 + 7) / 8 * 8;
    PH_DOUBLES(cells->lines, meter, (size_t)(cells->threads * LINES * cells->line),
               "work lines");
    PH_DOUBLES(cells->high, meter,
               (size_t)(cells->threads * 2 * layout->nd * layout->n[1] * layout->n[2]),
               "work planes");
    PH_ALLOC(cells->planes, layout->n[0], "sums of planes");
out:
    if (st != PH_OK) ph_i_cells_clear(cells, meter);
    return st;
}

void ph_i_cells_clear(ph_cells *cells, ph_meter *meter)
{
    const ph_layout *l = &cells->layout;
    ph_i_doubles_free(meter, &cells->lines,
                      (size_t)(cells->threads * LINES * cells->line));
    ph_i_doubles_free(meter, &cells->high,
                      (size_t)(cells->threads * 2 * l->nd * l->n[1] * l->n[2]));
    free(cells->planes);
    cells->planes = NULL;
}

#endif

/* Point the lines of a thread's workspace at their modes. */
row PH_REAL(ph_i_cells_lines)(const ph_cells *c, int thread)
{
    row r;
    const int *ax = c->layout.axis;
    real *next = (real *)c->lines + (ptrdiff_t)thread * LINES * c->line;
    real *zero = next, *waste = next + c->line;
    r.tmp = next + 2 * c->line;
    next += 3 * c->line;
    memset(zero, 0, sizeof(real) * (size_t)c->line);
    for (int i = 0; i < 3; i++) {
        for (int d = 0; d < 3; d++)
            r.g[i][d] = zero, r.t[i][d] = waste;
        for (int m = 0; m < PAIRS; m++)
            r.q[i][m] = zero, r.p[i][m] = waste;
        if (i >= c->layout.nd) continue;
        for (int a = 0; a < 3; a++)
            if (ax[a] >= 0) r.g[i][ax[a]] = r.t[i][ax[a]] = next, next += c->line;
        for (int a = 0; a < 3; a++)
            for (int b = a + 1; b < 3; b++)
                if (ax[a] >= 0 && ax[b] >= 0) {
                    int pair = 3 - ax[a] - ax[b];
                    r.q[i][pair] = r.p[i][pair] = next, next += c->line;
                }
        if (ax[0] >= 0 && ax[1] >= 0 && ax[2] >= 0)
            r.q[i][3] = r.p[i][3] = next, next += c->line;
    }
    return r;
}

/* ---- corner sums: the modes of one component of one row of cells -------------------- */

typedef struct sums {
    const real *r00, *r01, *r10, *r11; /* node rows (i,j) (i,j+1) (i+1,j) (i+1,j+1) */
    real *gx, *gy, *gz, *xy, *xz, *yz, *xyz;
    real fx, fy, fz;
} sums;

static inline void sum3(const sums *s, ptrdiff_t k, ptrdiff_t n, bool modes)
{
    real s00 = s->r00[k] + s->r00[n], d00 = s->r00[n] - s->r00[k];
    real s01 = s->r01[k] + s->r01[n], d01 = s->r01[n] - s->r01[k];
    real s10 = s->r10[k] + s->r10[n], d10 = s->r10[n] - s->r10[k];
    real s11 = s->r11[k] + s->r11[n], d11 = s->r11[n] - s->r11[k];
    s->gx[k] = s->fx * ((s10 + s11) - (s00 + s01));
    s->gy[k] = s->fy * ((s11 - s10) + (s01 - s00));
    s->gz[k] = s->fz * ((d10 + d11) + (d00 + d01));
    if (!modes) return;
    s->xy[k] = (s11 - s10) - (s01 - s00);
    s->xz[k] = (d10 + d11) - (d00 + d01);
    s->yz[k] = (d11 - d10) + (d01 - d00);
    s->xyz[k] = (d11 - d10) - (d01 - d00);
}

static inline void sum2(const sums *s, ptrdiff_t k, ptrdiff_t n, bool modes)
{
    real s0 = s->r00[k] + s->r00[n], d0 = s->r00[n] - s->r00[k];
    real s1 = s->r10[k] + s->r10[n], d1 = s->r10[n] - s->r10[k];
    s->gx[k] = s->fx * (s1 - s0);
    s->gz[k] = s->fz * (d1 + d0);
    if (modes) s->xz[k] = d1 - d0;
}

static void sum_line(const sums *s, ptrdiff_t n, int active, bool modes)
{
    const ptrdiff_t last = n - 1;
    if (active == 3 && modes) {
#pragma omp simd
        for (ptrdiff_t k = 0; k < last; k++)
            sum3(s, k, k + 1, true);
        sum3(s, last, 0, true);
    } else if (active == 3) {
#pragma omp simd
        for (ptrdiff_t k = 0; k < last; k++)
            sum3(s, k, k + 1, false);
        sum3(s, last, 0, false);
    } else if (active == 2) {
#pragma omp simd
        for (ptrdiff_t k = 0; k < last; k++)
            sum2(s, k, k + 1, modes);
        sum2(s, last, 0, modes);
    } else if (active == 1) {
        for (ptrdiff_t k = 0; k < last; k++)
            s->gz[k] = s->fz * (s->r00[k + 1] - s->r00[k]);
        s->gz[last] = s->fz * (s->r00[0] - s->r00[last]);
    }
}

static int active_axes(const ph_layout *l)
{
    return (l->axis[0] >= 0) + (l->axis[1] >= 0) + (l->axis[2] >= 0);
}

void PH_REAL(ph_i_cells_gather)(const ph_cells *c, const real *u, ptrdiff_t i,
                                ptrdiff_t j, bool modes, row *r)
{
    const ph_layout *l = &c->layout;
    ptrdiff_t i1 = i + 1 < l->n[0] ? i + 1 : 0, j1 = j + 1 < l->n[1] ? j + 1 : 0,
              n = l->n[2];
    int x = l->axis[0], y = l->axis[1], z = l->axis[2], active = active_axes(l);
    for (int a = 0; a < l->nd; a++) {
        const real *p = u + a * l->cells;
        sums s = {.r00 = p + (i * l->n[1] + j) * n,
                  .r01 = p + (i * l->n[1] + j1) * n,
                  .r10 = p + (i1 * l->n[1] + j) * n,
                  .r11 = p + (i1 * l->n[1] + j1) * n};
        if (z >= 0) s.gz = r->g[a][z], s.fz = (real)c->f[z];
        if (x >= 0) s.gx = r->g[a][x], s.fx = (real)c->f[x], s.xz = r->q[a][3 - x - z];
        if (y >= 0) {
            s.gy = r->g[a][y], s.fy = (real)c->f[y];
            s.xy = r->q[a][3 - x - y], s.yz = r->q[a][3 - y - z], s.xyz = r->q[a][3];
        }
        sum_line(&s, n, active, modes);
    }
}

static void gather_nothing(const ph_cells *c, row *r)
{
    size_t bytes = sizeof(real) * (size_t)c->layout.n[2];
    for (int a = 0; a < c->layout.nd; a++) {
        for (int d = 0; d < 3; d++)
            if (c->f[d] != 0.0) memset(r->g[a][d], 0, bytes);
        for (int m = 0; m < PAIRS; m++)
            if (r->p[a][m] == r->q[a][m]) memset(r->q[a][m], 0, bytes);
    }
}

#define RUN(nd, kind, sum)                                                               \
    for (ptrdiff_t k = from; k < to; k += LANES) {                                       \
        lanes own = first_lanes(to - k);                                                 \
        mean_mode((nd), (kind), c, w, r, k, own, (sum));                                 \
        if (modes) other_modes((nd), (kind), c, w, r, k, own);                           \
    }
#define RUN_EITHER(nd, kind)                                                             \
    if (sum) {                                                                           \
        RUN(nd, kind, sum)                                                               \
    } else {                                                                             \
        RUN(nd, kind, NULL)                                                              \
    }

/* Tractions of a run of cells of one stiffness. */
static void stress_run(int nd, ph_hooke kind, const real *c, const weights *w,
                       const row *r, ptrdiff_t from, ptrdiff_t to, bool modes, vec *sum)
{
    static const real nothing[36];
    if (kind == PH_HOOKE_ZERO) kind = PH_HOOKE_ISOTROPIC, c = nothing;
    if (nd == 3 && kind == PH_HOOKE_ISOTROPIC) {
        RUN_EITHER(3, PH_HOOKE_ISOTROPIC)
    } else if (nd == 3) {
        RUN_EITHER(3, PH_HOOKE_GENERAL)
    } else if (kind == PH_HOOKE_ISOTROPIC) {
        RUN_EITHER(2, PH_HOOKE_ISOTROPIC)
    } else {
        RUN_EITHER(2, PH_HOOKE_GENERAL)
    }
}

/* A tensor of the map, in `own` if it has to be rounded. */
static inline const real *stiffness(const ph_stiffness_map *map, int entry, real own[36])
{
    const double *c = map->c + (ptrdiff_t)entry * map->ns * map->ns;
#ifdef PH_SINGLE
    for (int i = 0; i < map->ns * map->ns; i++)
        own[i] = (real)c[i];
    return own;
#else
    (void)own;
    return c;
#endif
}

static void stress_line(const ph_cells *c, const int32_t *index, const weights *w,
                        const row *r, bool modes, vec *sum)
{
    ptrdiff_t n = c->layout.n[2], to;
    real own[36];
    weights outside = *w; /* around a body that stands alone: no hourglass term either */
    outside.hourglass = 0;
    for (ptrdiff_t from = 0; from < n; from = to) {
        for (to = from + 1; to < n && index[to] == index[from];)
            to++;
        const real *m = stiffness(c->map, index[from], own);
        bool body = index[from] != c->map->materials;
        stress_run(c->layout.nd, c->map->hooke[index[from]], m, body ? w : &outside, r,
                   from, to, modes, sum);
    }
}

/* ---- forces on the corners: the transpose of the sums -------------------------------- */

/* One node row of one component: sa, sb signs of the row along axes 0 and 1. */
static void scatter_row(const row *r, int a, const int *ax, real sa, real sb, ptrdiff_t n,
                        bool modes, real *f)
{
    const int x = ax[0], y = ax[1], z = ax[2];
    const real *tz = r->t[a][z], *tx = x >= 0 ? r->t[a][x] : NULL;
    const real *ty = y >= 0 ? r->t[a][y] : NULL;
    real *tmp = r->tmp;
    if (y >= 0 && modes) {
        const real *xy = r->p[a][3 - x - y], *xz = r->p[a][3 - x - z];
        const real *yz = r->p[a][3 - y - z], *xyz = r->p[a][3];
#pragma omp simd
        for (ptrdiff_t k = 0; k < n; k++) {
            real A = sa * tx[k] + sb * ty[k] + sa * sb * xy[k];
            real B = tz[k] + sa * xz[k] + sb * yz[k] + sa * sb * xyz[k];
            f[k] += A - B;
            tmp[k] = A + B;
        }
    } else if (y >= 0) {
#pragma omp simd
        for (ptrdiff_t k = 0; k < n; k++) {
            real A = sa * tx[k] + sb * ty[k];
            f[k] += A - tz[k];
            tmp[k] = A + tz[k];
        }
    } else if (x >= 0) {
        const real *xz = r->p[a][3 - x - z];
        real m = modes ? sa : (real)0.0;
#pragma omp simd
        for (ptrdiff_t k = 0; k < n; k++) {
            real A = sa * tx[k], B = tz[k] + (modes ? m * xz[k] : (real)0.0);
            f[k] += A - B;
            tmp[k] = A + B;
        }
    } else {
        for (ptrdiff_t k = 0; k < n; k++) {
            f[k] -= tz[k];
            tmp[k] = tz[k];
        }
    }
#pragma omp simd
    for (ptrdiff_t k = 0; k < n - 1; k++)
        f[k + 1] += tmp[k];
    f[0] += tmp[n - 1];
}

/* Forces of cell row j of a plane on its lower and upper node planes. */
static void scatter(const ph_cells *c, const row *r, ptrdiff_t j, bool modes, real *low,
                    ptrdiff_t low_stride, real *high)
{
    const ph_layout *l = &c->layout;
    ptrdiff_t n = l->n[2], j1 = j + 1 < l->n[1] ? j + 1 : 0, plane = l->n[1] * n;
    for (int a = 0; a < l->nd; a++) {
        real *lo = low + a * low_stride, *hi = high + a * plane;
        scatter_row(r, a, l->axis, -1, -1, n, modes, lo + j * n);
        if (l->axis[1] >= 0) scatter_row(r, a, l->axis, -1, 1, n, modes, lo + j1 * n);
        if (l->axis[0] < 0) continue;
        scatter_row(r, a, l->axis, 1, -1, n, modes, hi + j * n);
        if (l->axis[1] >= 0) scatter_row(r, a, l->axis, 1, 1, n, modes, hi + j1 * n);
    }
}

static void add_plane(const ph_layout *l, const real *plane, ptrdiff_t i, real *f)
{
    ptrdiff_t n = l->n[1] * l->n[2];
    for (int a = 0; a < l->nd; a++) {
        real *to = f + a * l->cells + i * n;
        const real *from = plane + a * n;
#pragma omp simd
        for (ptrdiff_t k = 0; k < n; k++)
            to[k] += from[k];
    }
}

static void add_lanes(int ns, const vec *sum, double *out)
{
    for (int i = 0; i < ns; i++) {
        out[i] = 0.0;
        for (int lane = 0; lane < LANES; lane++)
            out[i] += (double)sum[i][lane];
    }
}

/* Planes [from, to) of cells. The force on a node plane is always (sum of the cells above)
 * + (sum of the cells below), so that the bits do not depend on how planes are shared out.
 * Returns the buffer that holds the forces on node plane `to`.
 * stress: NULL, or sums of each plane */
static const real *apply_slab(const ph_cells *c, const real *u, const weights *w,
                              ptrdiff_t from, ptrdiff_t to, int thread, real *f,
                              double (*stress)[6])
{
    const ph_layout *l = &c->layout;
    ptrdiff_t plane = l->n[1] * l->n[2], buffer = l->nd * plane;
    real *work = (real *)c->high;
    real *high[2] = {work + 2 * thread * buffer, work + (2 * thread + 1) * buffer};
    bool modes = ph_i_cells_has_modes(c);
    row r = PH_REAL(ph_i_cells_lines)(c, thread);
    for (ptrdiff_t i = from; i < to; i++) {
        real *now = high[(i - from) % 2], *before = high[(i - from + 1) % 2];
        vec sum[6] = {{0}};
        memset(now, 0, sizeof(real) * (size_t)buffer);
        for (int a = 0; a < l->nd; a++)
            memset(f + a * l->cells + i * plane, 0, sizeof(real) * (size_t)plane);
        for (ptrdiff_t j = 0; j < l->n[1]; j++) {
            if (u)
                PH_REAL(ph_i_cells_gather)(c, u, i, j, modes, &r);
            else
                gather_nothing(c, &r);
            stress_line(c, c->map->index + (i * l->n[1] + j) * l->n[2], w, &r, modes,
                        stress ? sum : NULL);
            scatter(c, &r, j, modes, f + i * plane, l->cells, now);
        }
        if (i > from) add_plane(l, before, i, f);
        if (stress) add_lanes(l->ns, sum, stress[i]);
    }
    return high[(to - from + 1) % 2];
}

/* stress: NULL, or [n0] sums of each plane */
static void apply(const ph_cells *c, const real *u, const double *macro, double scale,
                  real *f, double (*stress)[6])
{
    const ph_layout *l = &c->layout;
    weights w = ph_i_cells_weights(c, macro, scale);
    int slabs = c->threads < l->n[0] ? c->threads : (int)l->n[0];
    if (active_axes(l) == 0) {
        memset(f, 0, sizeof(real) * (size_t)(l->nd * l->cells));
        return;
    }
    /* high[s] ends as the forces of slab s on the first plane of slab s + 1. */
#pragma omp parallel for num_threads(slabs) schedule(static, 1)
    for (int s = 0; s < slabs; s++) {
        ptrdiff_t from = l->n[0] * s / slabs, to = l->n[0] * (s + 1) / slabs;
        apply_slab(c, u, &w, from, to, s, f, stress);
    }
    if (l->axis[0] < 0) return;
    ptrdiff_t buffer = l->nd * l->n[1] * l->n[2];
    for (int s = 0; s < slabs; s++) {
        ptrdiff_t from = l->n[0] * s / slabs, to = l->n[0] * (s + 1) / slabs;
        add_plane(l, (real *)c->high + (2 * s + (to - from + 1) % 2) * buffer,
                  to % l->n[0], f);
    }
}

void PH_REAL(ph_i_cells_apply)(const ph_cells *c, const real *u, const double *macro,
                               double scale, real *f)
{
    apply(c, u, macro, scale, f, NULL);
}

#ifndef PH_SINGLE
void ph_i_cells_apply_mean(const ph_cells *c, const double *u, const double *macro,
                           double scale, double *f, double *sum)
{
    const ph_layout *l = &c->layout;
    memset(sum, 0, (size_t)l->ns * sizeof *sum);
    apply(c, u, macro, scale, f, c->planes);
    for (ptrdiff_t i = 0; i < l->n[0]; i++)
        for (int a = 0; a < l->ns; a++)
            sum[a] += scale * c->planes[i][a];
}

void ph_i_cells_pull(const ph_cells *c, const double *sigma, const uint8_t *region,
                     double *f)
{
    const ph_layout *l = &c->layout;
    row r = ph_i_cells_lines(c, 0);
    ptrdiff_t plane = l->n[1] * l->n[2];
    double *high = c->high;
    vec stress[6], v[3];
    for (int i = 0; i < l->ns; i++)
        stress[i] = all(sigma[i]);
    memset(f, 0, sizeof(double) * (size_t)(l->nd * l->cells));
    for (ptrdiff_t i = 0; i < l->n[0]; i++) {
        memset(high, 0, sizeof(double) * (size_t)(l->nd * plane));
        for (ptrdiff_t j = 0; j < l->n[1]; j++) {
            const uint8_t *here = region + i * plane + j * l->n[2];
            for (int d = 0; d < l->nd; d++) {
                take_column(l->nd, stress, d, c->f[d], v);
                for (int a = 0; a < l->nd; a++)
                    for (ptrdiff_t k = 0; k < l->n[2]; k++)
                        r.t[a][d][k] = here[k] ? v[a][0] : 0.0;
            }
            scatter(c, &r, j, false, f + i * plane, l->cells, high);
        }
        add_plane(l, high, i + 1 < l->n[0] ? i + 1 : 0, f);
    }
}
#endif
