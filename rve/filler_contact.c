/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distance of convex solids by the algorithm of Gilbert, Johnson and Keerthi [Gilbert1988]:
 * the point nearest to the origin of the difference of the two bodies. */
#include "fillers.h"

#include <math.h>
#include <string.h>

/* Farthest point of the solid in direction d, its centre moved by `shift`; lengths times
 * `scale` about the centre. */
static void support(const ph_solid *s, const double shift[3], double scale, int dim,
                    const double d[3], double p[3])
{
    double along[3], norm2 = 0;
    for (int a = 0; a < 3; a++)
        p[a] = a < dim ? s->centre[a] + shift[a] : 0;
    for (int i = 0; i < dim; i++) {
        along[i] = ph_i_dot3(s->frame[i], d) * s->half[i];
        if (s->kind[i] == PH_EXTENT_ROUND) norm2 += along[i] * along[i];
    }
    double norm = norm2 > 0 ? sqrt(norm2) : 1;
    for (int i = 0; i < dim; i++) {
        double t = s->kind[i] == PH_EXTENT_ROUND ? along[i] / norm
                   : along[i] > 0                ? 1
                                                 : -1;
        for (int a = 0; a < dim; a++)
            p[a] += scale * t * s->half[i] * s->frame[i][a];
    }
}

typedef struct simplex {
    int n;
    double w[4][3], a[4][3]; /* of the difference, and of the first body */
    double weight[4];
} simplex;

/* Weights of the point of the affine hull of the chosen corners nearest to the origin. */
static bool affine(const simplex *s, const int *pick, int n, double *weight)
{
    double m[3][4];
    for (int i = 1; i < n; i++) {
        double e[3], f[3];
        for (int a = 0; a < 3; a++)
            e[a] = s->w[pick[i]][a] - s->w[pick[0]][a];
        for (int j = 1; j < n; j++) {
            for (int a = 0; a < 3; a++)
                f[a] = s->w[pick[j]][a] - s->w[pick[0]][a];
            m[i - 1][j - 1] = ph_i_dot3(e, f);
        }
        m[i - 1][n - 1] = -ph_i_dot3(e, s->w[pick[0]]);
    }
    int k = n - 1;
    for (int c = 0; c < k; c++) {
        int best = c;
        for (int i = c + 1; i < k; i++)
            if (fabs(m[i][c]) > fabs(m[best][c])) best = i;
        if (fabs(m[best][c]) < 1e-300) return false;
        for (int j = c; j <= k; j++) {
            double t = m[c][j];
            m[c][j] = m[best][j];
            m[best][j] = t;
        }
        for (int i = 0; i < k; i++) {
            if (i == c) continue;
            double q = m[i][c] / m[c][c];
            for (int j = c; j <= k; j++)
                m[i][j] -= q * m[c][j];
        }
    }
    weight[0] = 1;
    for (int i = 0; i < k; i++)
        weight[0] -= weight[i + 1] = m[i][k] / m[i][i];
    return true;
}

static double norm2_of(const double v[3])
{
    return ph_i_dot3(v, v);
}

/* Nearest point v of the simplex, which is reduced to the corners that carry it. */
static void reduce(simplex *s, double v[3])
{
    double best = INFINITY, keep[4] = {0};
    int kept[4] = {0}, nkept = 0;
    for (int set = 1; set < 1 << s->n; set++) {
        int pick[4], n = 0;
        double weight[4], x[3] = {0};
        bool inside = true;
        for (int i = 0; i < s->n; i++)
            if (set >> i & 1) pick[n++] = i;
        if (!affine(s, pick, n, weight)) continue;
        for (int i = 0; i < n; i++) {
            inside &= weight[i] >= -1e-14;
            for (int a = 0; a < 3; a++)
                x[a] += weight[i] * s->w[pick[i]][a];
        }
        if (!inside || norm2_of(x) >= best) continue;
        best = norm2_of(x);
        memcpy(v, x, sizeof x);
        memcpy(keep, weight, sizeof keep);
        memcpy(kept, pick, sizeof kept);
        nkept = n;
    }
    simplex t = {.n = nkept};
    for (int i = 0; i < nkept; i++) {
        memcpy(t.w[i], s->w[kept[i]], sizeof t.w[i]);
        memcpy(t.a[i], s->a[kept[i]], sizeof t.a[i]);
        t.weight[i] = keep[i];
    }
    *s = t;
}

/* Difference b - a in direction d, into the simplex. */
static void add_corner(simplex *s, const ph_solid *a, const ph_solid *b,
                       const double shift[3], double scale, int dim, const double d[3])
{
    static const double nowhere[3] = {0};
    double minus[3] = {-d[0], -d[1], -d[2]}, pb[3];
    support(b, shift, scale, dim, d, pb);
    support(a, nowhere, scale, dim, minus, s->a[s->n]);
    for (int k = 0; k < 3; k++)
        s->w[s->n][k] = pb[k] - s->a[s->n][k];
    s->n++;
}

static double size_of(const ph_solid *s, int dim)
{
    double sum = 0;
    for (int i = 0; i < dim; i++)
        sum += s->half[i];
    return sum;
}

/* Lower bound of the distance, `v` the vector between the nearest points, `at` that of a.
 * Stops where the bound is `enough` or the distance is known to be less. */
static double gjk(const ph_solid *a, const ph_solid *b, const double shift[3],
                  double scale, int dim, double enough, double v[3], double at[3])
{
    enum { STEPS = 100 };
    simplex s = {0};
    double bound = 0, size = size_of(a, dim) + size_of(b, dim);
    for (int k = 0; k < 3; k++)
        v[k] = k < dim ? b->centre[k] + shift[k] - a->centre[k] : 0;
    if (norm2_of(v) == 0) v[0] = size;
    for (int step = 0; step < STEPS; step++) {
        double d[3] = {-v[0], -v[1], -v[2]}, length = sqrt(norm2_of(v));
        if (length <= 1e-12 * size) {
            bound = 0;
            break;
        }
        add_corner(&s, a, b, shift, scale, dim, d);
        bound = fmax(bound, ph_i_dot3(v, s.w[s.n - 1]) / length);
        if (bound >= enough || (step > 0 && length - bound <= 1e-10 * size)) break;
        reduce(&s, v);
        if (s.n == dim + 1) { /* the origin is inside */
            v[0] = v[1] = v[2] = 0;
            bound = 0;
            break;
        }
    }
    for (int k = 0; k < 3; k++) {
        at[k] = 0;
        for (int i = 0; i < s.n; i++)
            at[k] += s.weight[i] * s.a[i][k];
    }
    return bound;
}

static bool is_ball(const ph_solid *s, int dim)
{
    for (int i = 0; i < dim; i++)
        if (s->kind[i] != PH_EXTENT_ROUND || s->half[i] != s->half[0]) return false;
    return true;
}

double ph_solid_distance(const ph_solid *a, const ph_solid *b, const double shift[3],
                         int dim, double enough)
{
    if (!a || !b || !shift) return NAN;
    double v[3], at[3];
    if (!is_ball(a, dim) || !is_ball(b, dim))
        return gjk(a, b, shift, 1, dim, enough, v, at);
    for (int k = 0; k < 3; k++)
        v[k] = k < dim ? b->centre[k] + shift[k] - a->centre[k] : 0;
    return fmax(sqrt(norm2_of(v)) - a->half[0] - b->half[0], 0);
}

/* Where they overlap, the direction is that between shrunken copies: moving them apart along
 * it by the returned depth separates them for certain. */
double ph_i_separation(const ph_solid *a, const ph_solid *b, const double shift[3],
                       int dim, double n[3], double at[3])
{
    static const double scales[] = {1, 0.7, 0.3, 0.02};
    static const double nowhere[3] = {0};
    double v[3] = {0}, pa[3], pb[3], minus[3], length = 0;
    for (int i = 0; i < 4 && length == 0; i++) {
        (void)gjk(a, b, shift, scales[i], dim, INFINITY, v, at);
        length = sqrt(norm2_of(v));
        if (length < 1e-9 * (a->half[0] + b->half[0])) length = 0;
    }
    if (length == 0) { /* concentric: any direction across is as good */
        memcpy(v, a->frame[1], sizeof v);
        memcpy(at, a->centre, sizeof v);
        length = 1;
    }
    for (int k = 0; k < 3; k++) {
        n[k] = v[k] / length;
        minus[k] = -n[k];
    }
    support(a, nowhere, 1, dim, n, pa);
    support(b, shift, 1, dim, minus, pb);
    return ph_i_dot3(n, pb) - ph_i_dot3(n, pa);
}
