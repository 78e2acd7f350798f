/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/complex_map.h"

#include "core/complex.h"
#include "effective/directions.h"

#include <math.h>
#include <string.h>

typedef double complex cplx;

static cplx entry(const ph_complex_tensor *c, int i, int j)
{
    return ph_i_complex(c->re.m[i][j], c->im.m[i][j]);
}

/* R = M^-1 by cofactors, d = 2 or 3; false where it is not finite. */
static bool invert(int d, cplx M[3][3], cplx R[3][3])
{
    if (d == 2) M[2][2] = 1.0;
    cplx det = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, e = (j + 2) % 3;
            R[j][i] = M[a][c] * M[b][e] - M[a][e] * M[b][c];
        }
    for (int i = 0; i < 3; i++)
        det += M[0][i] * R[i][0];
    if (!(cabs(det) > 0.0) || !isfinite(cabs(det))) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[i][j] /= det;
    return true;
}

/* Z += f N^T C N, and CN = C N. */
static void contract(const ph_complex_tensor *c, double N[6][3], double f, cplx CN[6][3],
                     cplx Z[3][3])
{
    const int n = c->re.n, d = n == 3 ? 2 : 3;
    for (int a = 0; a < n; a++)
        for (int i = 0; i < d; i++) {
            CN[a][i] = 0.0;
            for (int b = 0; b < n; b++)
                CN[a][i] += entry(c, a, b) * N[b][i];
        }
    for (int i = 0; i < d; i++)
        for (int j = 0; j < d; j++)
            for (int a = 0; a < n; a++)
                Z[i][j] += f * N[a][i] * CN[a][j];
}

static ph_complex_tensor combine(double a, const ph_complex_tensor *x, double b,
                                 const ph_complex_tensor *y)
{
    return (ph_complex_tensor){ph_sym4_combine(a, &x->re, b, &y->re),
                               ph_sym4_combine(a, &x->im, b, &y->im)};
}

ph_status ph_i_complex_laminate(const ph_complex_tensor *c1, const ph_complex_tensor *c2,
                                double f2, const double normal[3], ph_complex_tensor *out,
                                ph_error *err)
{
    ph_status st = PH_OK;
    const int n = c1->re.n, d = n == 3 ? 2 : 3;
    const double f1 = 1.0 - f2;
    double N[6][3];
    cplx CN[6][3], Z[3][3] = {{0}}, none[3][3] = {{0}}, R[3][3];
    ph_complex_tensor mean = combine(f1, c1, f2, c2), D = combine(1.0, c1, -1.0, c2);
    ph_i_normal_matrix(n, normal, N);
    contract(c1, N, f2, CN, Z);
    contract(c2, N, f1, CN, Z);
    PH_CHECK(invert(d, Z, R), PH_ESINGULAR,
             "laminate: neither phase resists the strain across the layers");
    contract(&D, N, 1.0, CN, none);
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            cplx sum = 0.0;
            for (int i = 0; i < d; i++)
                for (int j = 0; j < d; j++)
                    sum += CN[a][i] * R[i][j] * CN[b][j];
            mean.re.m[a][b] -= f1 * f2 * creal(sum);
            mean.im.m[a][b] -= f1 * f2 * cimag(sum);
        }
    *out = mean;
out:
    return st;
}

/* What ph_i_stiffness_map_set makes of the same cuts, in complex numbers. */
static ph_status mix(const ph_complex_map *m, ptrdiff_t first, ph_complex_tensor *out,
                     ph_error *err)
{
    ph_status st = PH_OK;
    const ph_microstructure *micro = m->relax->micro;
    const ph_cut *cut = &micro->cuts[first];
    ph_complex_tensor c = m->phase[cut[0].base];
    double solid = micro->materials[cut[0].base].is_void ? 0.0 : 1.0;
    for (ptrdiff_t i = 0; i < ph_i_cuts_of_cell(micro, first); i++) {
        const ph_complex_tensor under = c, *over = &m->phase[cut[i].material];
        bool hole = micro->materials[cut[i].material].is_void, empty = solid == 0.0;
        double f = ph_i_cut_fraction(&cut[i], hole, &solid), normal[3];
        ph_i_cut_normal(m->relax->map, &micro->grid, &cut[i], normal);
        if (hole || empty)
            c = combine(1.0 - f, &under, f, over);
        else
            PH_TRY(ph_i_complex_laminate(&under, over, f, normal, &c, err));
    }
    *out = c;
out:
    return st;
}

ph_status ph_i_complex_map_new(ph_relaxing_map *relax, ph_complex_map **out,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_complex_map *m = NULL;
    *out = NULL;
    PH_ALLOC(m, 1, "complex tensors");
    m->relax = relax;
    m->loss.index = relax->mixed.index;
    m->reserved = (size_t)relax->map->count * (size_t)(relax->map->ns * relax->map->ns);
    PH_DOUBLES(m->loss.c, relax->meter, m->reserved, "loss tensors");
    PH_ALLOC(m->loss.hooke, relax->map->count, "loss tensors");
    PH_ALLOC(m->weight, relax->ntimes, "weights of the branches");
    PH_ALLOC(m->phase, relax->materials, "complex tensors");
    *out = m;
    m = NULL;
out:
    ph_i_complex_map_free(&m);
    return st;
}

void ph_i_complex_map_free(ph_complex_map **map)
{
    if (!map || !*map) return;
    ph_complex_map *m = *map;
    ph_i_relaxing_map_again(m->relax);
    ph_i_doubles_free(m->relax->meter, &m->loss.c, m->reserved);
    free(m->loss.hooke);
    free(m->weight);
    free(m->phase);
    free(m);
    *map = NULL;
}

double ph_i_storage_weight(double x)
{
    return x > 1.0 ? 1.0 / (1.0 + 1.0 / x / x) : x * x / (1.0 + x * x);
}

double ph_i_loss_weight(double x)
{
    return x > 1.0 ? 1.0 / (x + 1.0 / x) : x / (1.0 + x * x);
}

static void store_both(ph_complex_map *m, int at, const ph_complex_tensor *c)
{
    ph_i_complex_map_show(m, true);
    ph_i_stiffness_map_store(m->relax->map, at, &c->im);
    ph_i_complex_map_show(m, false);
    ph_i_stiffness_map_store(m->relax->map, at, &c->re);
}

ph_status ph_i_complex_map_set(ph_complex_map *m, double omega, bool measure,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_relaxing_map *r = m->relax;
    for (int k = 0; k < r->ntimes; k++)
        m->weight[k] = ph_i_storage_weight(omega * r->time[k]) +
                       (measure ? ph_i_loss_weight(omega * r->time[k]) : 0.0);
    m->stabilise[0] = ph_i_relaxing_stabilisation(r, 1.0, m->weight);
    if (measure) return ph_i_relaxing_map_mixed(r, 1.0, m->weight, err);
    for (int p = 0; p < r->materials; p++)
        m->phase[p].re = ph_i_relaxing_phase(r, p, 1.0, m->weight);
    for (int k = 0; k < r->ntimes; k++)
        m->weight[k] = ph_i_loss_weight(omega * r->time[k]);
    m->stabilise[1] = ph_i_relaxing_stabilisation(r, 0.0, m->weight);
    for (int p = 0; p < r->materials; p++) {
        m->phase[p].im = ph_i_relaxing_phase(r, p, 0.0, m->weight);
        store_both(m, p, &m->phase[p]);
    }
    ph_complex_tensor c = {{.n = r->map->ns}, {.n = r->map->ns}};
    store_both(m, r->materials, &c);
    int next = ph_i_first_mixture(r->map);
    for (ptrdiff_t i = 0; next < r->map->count; i += ph_i_cuts_of_cell(r->micro, i)) {
        PH_TRY(mix(m, i, &c, err));
        store_both(m, next++, &c);
    }
out:
    return st;
}

void ph_i_complex_map_show(ph_complex_map *m, bool loss)
{
    if (!loss) {
        ph_i_relaxing_map_again(m->relax);
        return;
    }
    m->relax->map->c = m->loss.c;
    m->relax->map->hooke = m->loss.hooke;
    m->relax->map->index = m->loss.index;
}
