/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effective/visco_model.h"

#include <math.h>
#include <string.h>

/* Pivots below this share of their diagonal are digits of arithmetic: such a field adds
 * nothing to those before it. */
static const double dependent = 1e-13;

ph_status ph_i_reduced_init(ph_reduced *m, int ns, int nfunctions,
                            const ph_decay *function, ph_error *err)
{
    ph_status st = PH_OK;
    *m = (ph_reduced){.ns = ns, .nfunctions = nfunctions, .function = function};
    PH_ALLOC(m->K, nfunctions, "the reduced model");
    PH_TRY(ph_i_reduced_grow(m, ns, err));
out:
    return st;
}

void ph_i_reduced_clear(ph_reduced *m)
{
    for (int q = 0; m->K && q < m->nfunctions; q++)
        free(m->K[q]);
    free(m->K);
    *m = (ph_reduced){0};
}

ph_status ph_i_reduced_grow(ph_reduced *m, int more, ph_error *err)
{
    ph_status st = PH_OK;
    int n = m->n + more, room = m->room;
    if (n > room) {
        room = 2 * n;
        for (int q = 0; q < m->nfunctions; q++) {
            double *K;
            PH_ALLOC(K, (size_t)room * (size_t)room, "the reduced model");
            for (int i = 0; m->K[q] && i < m->n; i++)
                memcpy(K + i * room, m->K[q] + i * m->room, sizeof *K * (size_t)m->n);
            free(m->K[q]);
            m->K[q] = K;
        }
    }
    m->room = room;
    m->n = n;
out:
    return st;
}

void ph_i_reduced_add(ph_reduced *m, int q, int i, int j, double value)
{
    m->K[q][i * m->room + j] += value;
    if (i != j) m->K[q][j * m->room + i] += value;
}

/* ---- C*(s) -------------------------------------------------------------------------------- */

/* L of P^T A P = L L^T with diagonal pivoting on a matrix of unit diagonal; the order of the
 * pivots in `order`. Returns the rank. */
static int factorise(int n, double *a, int *order)
{
    int rank = 0;
    for (int i = 0; i < n; i++)
        order[i] = i;
    for (int k = 0; k < n; k++, rank++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (a[i * n + i] > a[best * n + best]) best = i;
        if (!(a[best * n + best] > dependent)) break;
        for (int j = 0; j < n && best != k; j++) { /* swap rows, then columns */
            double t = a[k * n + j];
            a[k * n + j] = a[best * n + j], a[best * n + j] = t;
        }
        for (int j = 0; j < n && best != k; j++) {
            double t = a[j * n + k];
            a[j * n + k] = a[j * n + best], a[j * n + best] = t;
        }
        int o = order[k];
        order[k] = order[best], order[best] = o;
        double d = sqrt(a[k * n + k]);
        a[k * n + k] = d;
        for (int i = k + 1; i < n; i++)
            a[i * n + k] /= d;
        for (int i = k + 1; i < n; i++)
            for (int j = k + 1; j < n; j++)
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
        for (int j = k + 1; j < n; j++)
            a[k * n + j] = 0.0;
    }
    return rank;
}

/* A = sum phi_q(s) K_q, [n][n], and the scale of each basis field. */
static void assemble(const ph_reduced *m, double s, double *A, double *scale)
{
    int n = m->n;
    memset(A, 0, sizeof *A * (size_t)(n * n));
    for (int q = 0; q < m->nfunctions; q++) {
        double phi = ph_i_decay_at(&m->function[q], s);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                A[i * n + j] += phi * m->K[q][i * m->room + j];
    }
    for (int i = 0; i < n; i++)
        scale[i] = i >= m->ns && A[i * n + i] > 0.0 ? 1.0 / sqrt(A[i * n + i]) : 1.0;
}

ph_status ph_i_reduced_at(const ph_reduced *m, double s, ph_sym4 *C, double *c,
                          ph_error *err)
{
    ph_status st = PH_OK;
    int n = m->n, ns = m->ns, nb = n - ns;
    double *A = NULL, *B = NULL, *scale = NULL, *y = NULL;
    int *order = NULL;
    PH_ALLOC(A, n * n, "the reduced system");
    PH_ALLOC(B, nb * nb, "the reduced system");
    PH_ALLOC(scale, n, "the reduced system");
    PH_ALLOC(y, ns * nb, "the reduced system");
    PH_ALLOC(order, nb, "the reduced system");
    assemble(m, s, A, scale);
    for (int i = 0; i < nb; i++)
        for (int j = 0; j < nb; j++)
            B[i * nb + j] = A[(ns + i) * n + ns + j] * scale[ns + i] * scale[ns + j];
    int rank = factorise(nb, B, order);
    *C = (ph_sym4){.n = ns};
    for (int a = 0; a < ns; a++) { /* L y = coupling */
        double *ya = y + a * nb;
        for (int i = 0; i < rank; i++) {
            ya[i] = A[a * n + ns + order[i]] * scale[ns + order[i]];
            for (int k = 0; k < i; k++)
                ya[i] -= B[i * nb + k] * ya[k];
            ya[i] /= B[i * nb + i];
        }
        for (int b = 0; b <= a; b++) {
            double sum = A[a * n + b];
            for (int i = 0; i < rank; i++)
                sum -= ya[i] * y[b * nb + i];
            C->m[a][b] = C->m[b][a] = sum;
        }
    }
    for (int a = 0; c && a < ns; a++) { /* L^T c = -y */
        double *ca = c + a * nb, *ya = y + a * nb;
        memset(ca, 0, sizeof *ca * (size_t)nb);
        for (int i = rank - 1; i >= 0; i--) {
            for (int k = i + 1; k < rank; k++)
                ya[i] -= B[k * nb + i] * ya[k];
            ya[i] /= B[i * nb + i];
            ca[order[i]] = -ya[i] * scale[ns + order[i]];
        }
    }
out:
    free(A);
    free(B);
    free(scale);
    free(y);
    free(order);
    return st;
}
