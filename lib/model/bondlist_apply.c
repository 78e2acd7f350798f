/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/bondlist.h"

#include <string.h>

#define R2 0.70710678118654752440 /* 1/sqrt(2): Mandel shear */

/* Mandel component of the pair (a, d). */
static int component(int nd, int a, int d)
{
    return a == d ? a : nd == 3 ? 6 - a - d : 2;
}

/* G = grad u at a point. */
static void gradient(const ph_bondlist *l, const ph_bond_point *p, const double *u,
                     double G[3][3])
{
    memset(G, 0, sizeof(double) * 9);
    for (ptrdiff_t b = p->first; b < p[1].first; b++)
        for (int a = 0; a < l->nd; a++)
            for (int d = 0; d < 3; d++)
                G[a][d] += l->bond[b].g[d] * u[a * l->nodes + l->bond[b].node];
}

static void strain_at(const ph_bondlist *l, const ph_bond_point *p, const double *u,
                      const double *macro, double *e)
{
    double G[3][3] = {{0}};
    if (u) gradient(l, p, u, G);
    for (int i = 0; i < l->ns; i++)
        e[i] = macro ? macro[i] : 0.0;
    for (int a = 0; a < l->nd; a++)
        for (int d = 0; d < l->nd; d++)
            e[component(l->nd, a, d)] += G[a][d] * (a == d ? 1.0 : R2);
}

/* f += weight B^T sigma */
static void scatter(const ph_bondlist *l, const ph_bond_point *p, const double *s,
                    double weight, double *f)
{
    for (ptrdiff_t b = p->first; b < p[1].first; b++)
        for (int a = 0; a < l->nd; a++)
            for (int d = 0; d < l->nd; d++)
                f[a * l->nodes + l->bond[b].node] += weight * l->bond[b].g[d] *
                                                     s[component(l->nd, a, d)] *
                                                     (a == d ? 1.0 : R2);
}

/* One component of the deviations of a point: f += s sum_b w_b z_b dz_b/du, where it is
 * wanted. Returns s sum_b w_b z_b^2. */
static double deviate(const ph_bondlist *l, const ph_bond_point *p, const double *u,
                      double *f)
{
    double G[3] = {0}, origin = 0.0, energy = 0.0, sum = 0.0, sum_xi[3] = {0};
    for (ptrdiff_t b = p->first; b < p[1].first; b++) {
        double v = u[l->bond[b].node];
        origin += l->deviation[b].origin * v;
        for (int d = 0; d < 3; d++)
            G[d] += l->bond[b].g[d] * v;
    }
    for (ptrdiff_t b = p->first; b < p[1].first; b++) {
        const ph_deviation *v = &l->deviation[b];
        double z = u[l->bond[b].node] - origin, t;
        for (int d = 0; d < 3; d++)
            z -= G[d] * v->xi[d];
        t = l->s * v->w * z;
        energy += t * z;
        sum += t;
        for (int d = 0; d < 3; d++)
            sum_xi[d] += t * v->xi[d];
        if (f) f[l->bond[b].node] += t;
    }
    for (ptrdiff_t b = p->first; f && b < p[1].first; b++) {
        double t = l->deviation[b].origin * sum;
        for (int d = 0; d < 3; d++)
            t += l->bond[b].g[d] * sum_xi[d];
        f[l->bond[b].node] -= t;
    }
    return energy;
}

static double deviations(const ph_bondlist *l, const ph_bond_point *p, const double *u,
                         double *f)
{
    double energy = 0.0;
    if (!l->deviation || !p->family || l->s == 0.0) return 0.0;
    for (int a = 0; a < l->nd; a++)
        energy += deviate(l, p, u + a * l->nodes, f ? f + a * l->nodes : NULL);
    return energy;
}

static void clear(const ph_bondlist *l, double *f)
{
    memset(f, 0, sizeof(double) * (size_t)(l->nd * l->nodes));
}

void ph_i_bondlist_apply(const ph_bondlist *l, const double *u, double *f)
{
    double e[6], s[6];
    clear(l, f);
    for (ptrdiff_t i = 0; i < l->points; i++) {
        const ph_bond_point *p = &l->point[i];
        strain_at(l, p, u, NULL, e);
        ph_i_hooke(l->map, l->map->index[p->cell], e, s);
        scatter(l, p, s, p->share, f);
        deviations(l, p, u, f);
    }
}

void ph_i_bondlist_load(const ph_bondlist *l, const double *macro, double *f)
{
    double s[6];
    clear(l, f);
    for (ptrdiff_t i = 0; i < l->points; i++) {
        const ph_bond_point *p = &l->point[i];
        ph_i_hooke(l->map, l->map->index[p->cell], macro, s);
        scatter(l, p, s, -p->share, f);
    }
}

void ph_i_bondlist_pull(const ph_bondlist *l, const double *sigma, const uint8_t *region,
                        double *f)
{
    clear(l, f);
    for (ptrdiff_t i = 0; i < l->points; i++)
        if (!region || region[l->point[i].cell])
            scatter(l, &l->point[i], sigma, l->point[i].share, f);
}

void ph_i_bondlist_point_strain(const ph_bondlist *l, ptrdiff_t point, const double *u,
                                const double *macro, double *strain)
{
    strain_at(l, &l->point[point], u, macro, strain);
}

void ph_i_bondlist_point_force(const ph_bondlist *l, ptrdiff_t point,
                               const double *stress, double weight, double *f)
{
    scatter(l, &l->point[point], stress, weight * l->point[point].share, f);
}

void ph_i_bondlist_strain(const ph_bondlist *l, const double *u, const double *macro,
                          double *strain)
{
    memset(strain, 0, sizeof(double) * (size_t)(l->ns * l->nodes));
    for (ptrdiff_t i = 0, j; i < l->points;
         i = j) { /* the points of a cell stand together */
        int32_t cell = l->point[i].cell;
        double e[6], sum[6] = {0}, n = 0.0;
        for (j = i; j < l->points && l->point[j].cell == cell; j++) {
            if (!l->point[j].family) continue;
            strain_at(l, &l->point[j], u, macro, e);
            for (int k = 0; k < l->ns; k++)
                sum[k] += e[k];
            n += 1.0;
        }
        for (int k = 0; k < l->ns && n > 0.0; k++)
            strain[k * l->nodes + cell] = sum[k] / n;
    }
}

void ph_i_bondlist_sums(const ph_bondlist *l, const double *u, const double *macro,
                        const uint8_t *region, double *stress, double *strain,
                        ph_cell_energy *energy)
{
    memset(energy, 0, sizeof *energy);
    for (int i = 0; i < l->ns; i++)
        stress[i] = strain[i] = 0.0;
    for (ptrdiff_t i = 0; i < l->points; i++) {
        const ph_bond_point *p = &l->point[i];
        double e[6], s[6], work = 0.0;
        if (region && !region[p->cell]) continue;
        strain_at(l, p, u, macro, e);
        ph_i_hooke(l->map, l->map->index[p->cell], e, s);
        for (int k = 0; k < l->ns; k++) {
            stress[k] += p->share * s[k];
            strain[k] += p->share * e[k];
            work += p->share * s[k] * e[k];
        }
        *(p->family ? &energy->mean : &energy->modes) += work;
        if (u) energy->stabilisation += deviations(l, p, u, NULL);
    }
}
