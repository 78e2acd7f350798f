/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the estimators: the sum of one chain (estimator_sum.c), which chain and how many
 * realisations (estimators.c). */
#ifndef PH_CAMPAIGN_ESTIMATORS_H
#define PH_CAMPAIGN_ESTIMATORS_H

#include <perihom_estimators.h>

/* Models in the order of the sum, and how many realisations of each are looked at. */
typedef struct ph_i_chain {
    int n;
    int model[PH_MAX_MODELS];
    ptrdiff_t count[PH_MAX_MODELS]; /* not descending */
    ptrdiff_t
        seen[PH_MAX_MODELS]; /* of these, those whose scatter counts: not descending */
    bool fits;
} ph_i_chain;

/* Mean, standard error, degrees of freedom and level reports (not costs) of a chain.
 * PH_ESINGULAR where a level has too few realisations for it. */
ph_status ph_i_chain_sum(const ph_i_chain *chain, const ph_model_samples *models,
                         ph_mean_estimate *out, ph_error *err);
/* ph_estimation_allocate, of arguments that are known to be right. */
void ph_i_allocate(int n, const double *V, const double *c, const double *least, double v,
                   double *out);
/* Whether a grid pair is one of so many models. */
bool ph_i_is_pair(const ph_grid_pair *grid, int nmodels);
/* Realisations that both of its models have. */
static inline ptrdiff_t ph_i_pairs(const ph_grid_pair *grid, const ptrdiff_t *n)
{
    return n[grid->fine] < n[grid->coarse] ? n[grid->fine] : n[grid->coarse];
}
/* Quantile of Student's t that makes a two-sided interval. */
double ph_i_student(double confidence, double dof);

#endif
