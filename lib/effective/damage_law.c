/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A damage law: its parts, checked, and what they say. */
#include "effective/damage_law.h"

#include <perihom/damage_law.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

static const double digits =
    1e-9; /* of the first stiffness: what files and solvers leave */

void ph_damage_law_free(ph_damage_law **law)
{
    if (!law || !*law) return;
    free((*law)->damage);
    free((*law)->stiffness);
    free((*law)->begin);
    free((*law)->end);
    free(*law);
    *law = NULL;
}

double ph_i_energy(const ph_sym4 *c, const double *strain)
{
    double voigt[36], sum = 0.0;
    ph_sym4_to_voigt(c, true, voigt);
    for (int i = 0; i < c->n; i++)
        for (int j = 0; j < c->n; j++)
            sum += strain[i] * voigt[i * c->n + j] * strain[j];
    return sum;
}

/* ---- checks ------------------------------------------------------------------------------ */

static ph_status check_stiffnesses(const ph_damage_law *l, ph_error *err)
{
    ph_status st = PH_OK;
    double least, size = ph_sym4_norm(&l->stiffness[0]);
    PH_CHECK(ph_sym4_is_stiffness(&l->stiffness[0]), PH_EINVAL,
             "the stiffness without damage is not symmetric positive definite");
    for (int k = 0; k < l->nknots; k++) {
        const ph_sym4 *c = &l->stiffness[k];
        PH_CHECK(c->n == l->n, PH_EINVAL, "stiffness %d has n = %d, not %d", k + 1, c->n,
                 l->n);
        double norm = ph_sym4_norm(c);
        PH_CHECK(isfinite(norm), PH_EINVAL, "stiffness %d is not finite", k + 1);
        ph_sym4_eigenvalues(c, &least, NULL);
        PH_CHECK(least >= -digits * size, PH_EINVAL,
                 "stiffness %d is not positive semidefinite", k + 1);
        if (k == 0) continue;
        ph_sym4 gone = ph_sym4_combine(1.0, &l->stiffness[k - 1], -1.0, c);
        ph_sym4_eigenvalues(&gone, &least, NULL);
        PH_CHECK(least >= -digits * size, PH_EINVAL,
                 "stiffness %d is above the one before it: damage does not heal", k + 1);
    }
out:
    return st;
}

static ph_status check_loads(const ph_damage_law *l, ph_error *err)
{
    ph_status st = PH_OK;
    double first = ph_i_energy(&l->stiffness[0], l->strain), last = 0.0;
    for (int i = 0; i < l->n; i++)
        PH_CHECK(isfinite(l->strain[i]), PH_EINVAL, "strain %d is %g", i + 1,
                 l->strain[i]);
    PH_CHECK(first > 0.0, PH_EINVAL, "the strain of the damage law is zero");
    for (int k = 0; k + 1 < l->nknots; k++) {
        ph_sym4 gone = ph_sym4_combine(1.0, &l->stiffness[k], -1.0, &l->stiffness[k + 1]);
        PH_CHECK(isfinite(l->begin[k]) && isfinite(l->end[k]) && l->begin[k] >= last &&
                     l->end[k] > l->begin[k],
                 PH_EINVAL,
                 "segment %d goes from load %g to %g after %g: loads must rise", k + 1,
                 l->begin[k], l->end[k], last);
        PH_CHECK(ph_i_energy(&gone, l->strain) > digits * first, PH_EINVAL,
                 "segment %d releases nothing under its strain", k + 1);
        last = l->end[k];
    }
out:
    return st;
}

static ph_status check_damage(const ph_damage_law *l, ph_error *err)
{
    ph_status st = PH_OK;
    for (int k = 0; k < l->nknots; k++)
        PH_CHECK(k == 0 ? l->damage[k] == 0.0
                        : l->damage[k] > l->damage[k - 1] && isfinite(l->damage[k]),
                 PH_EINVAL, "damage %d is %g: it must rise from 0", k + 1, l->damage[k]);
out:
    return st;
}

/* ---- making ------------------------------------------------------------------------------ */

ph_status ph_damage_law_new(int n, const double *strain, int nknots, const double *damage,
                            const ph_sym4 *stiffness, const double *begin,
                            const double *end, ph_damage_law **out, ph_error *err)
{
    ph_status st = PH_OK;
    ph_damage_law *l = NULL;
    PH_GIVEN(damage && stiffness && out);
    *out = NULL;
    PH_CHECK(n == 3 || n == 6, PH_EINVAL, "a damage law has n = %d, not 3 or 6", n);
    PH_CHECK(nknots >= 1, PH_EINVAL, "a damage law has %d stiffnesses", nknots);
    PH_CHECK(!strain || nknots == 1 || (begin && end), PH_EINVAL,
             "a damage law with a strain needs loads");
    PH_ALLOC(l, 1, "a damage law");
    PH_ALLOC(l->damage, nknots, "damage");
    PH_ALLOC(l->stiffness, nknots, "stiffnesses");
    PH_ALLOC(l->begin, nknots - 1, "loads");
    PH_ALLOC(l->end, nknots - 1, "loads");
    l->n = n;
    l->nknots = nknots;
    l->driven = strain != NULL;
    memcpy(l->damage, damage, sizeof *damage * (size_t)nknots);
    memcpy(l->stiffness, stiffness, sizeof *stiffness * (size_t)nknots);
    if (strain) memcpy(l->strain, strain, sizeof *strain * (size_t)n);
    if (strain && nknots > 1) {
        memcpy(l->begin, begin, sizeof *begin * (size_t)(nknots - 1));
        memcpy(l->end, end, sizeof *end * (size_t)(nknots - 1));
    }
    PH_TRY(check_damage(l, err));
    PH_TRY(check_stiffnesses(l, err));
    if (l->driven) PH_TRY(check_loads(l, err));
    *out = l;
    l = NULL;
out:
    ph_damage_law_free(&l);
    return st;
}

ph_status ph_damage_law_copy(const ph_damage_law *law, ph_damage_law **out, ph_error *err)
{
    ph_status st = PH_OK;
    PH_GIVEN(law && out);
    PH_TRY(ph_damage_law_new(law->n, law->driven ? law->strain : NULL, law->nknots,
                             law->damage, law->stiffness, law->begin, law->end, out,
                             err));
    (*out)->correction = law->correction;
out:
    return st;
}

/* ---- what it says ------------------------------------------------------------------------ */

int ph_i_damage_segment(int nknots, const double *knot, double damage)
{
    int low = 0, high = nknots - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (knot[middle] <= damage)
            low = middle;
        else
            high = middle;
    }
    return damage >= knot[high] ? high : low;
}

ph_sym4 ph_damage_law_stiffness(const ph_damage_law *l, double damage)
{
    if (!l || l->nknots < 1 || isnan(damage)) return (ph_sym4){0};
    int k = ph_i_damage_segment(l->nknots, l->damage, damage);
    if (k == l->nknots - 1 || damage <= 0.0) return l->stiffness[k];
    double s = (damage - l->damage[k]) / (l->damage[k + 1] - l->damage[k]);
    return ph_sym4_combine(1.0 - s, &l->stiffness[k], s, &l->stiffness[k + 1]);
}

double ph_damage_law_force(const ph_damage_law *l, double damage, const double *strain)
{
    if (!l || !strain || l->nknots < 1 || isnan(damage)) return NAN;
    int k = ph_i_damage_segment(l->nknots, l->damage, damage);
    if (k == l->nknots - 1) return 0.0;
    ph_sym4 gone = ph_sym4_combine(1.0, &l->stiffness[k], -1.0, &l->stiffness[k + 1]);
    return 0.5 * ph_i_energy(&gone, strain) / (l->damage[k + 1] - l->damage[k]);
}
