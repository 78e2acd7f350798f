/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/viscoelastic.h>

#include "core/jacobi.h"
#include "effective/visco.h"

#include <math.h>
#include <string.h>

const ph_relaxation_route ph_relaxation_routes[] = {
    {{"reduced", "elastic fields at a few Carson variables, projection, exact poles",
      "Hashin1965a", "every constraint and model"},
     ph_i_relaxation_reduced},
    {{"carson", "an elastic problem at every Carson variable asked for", "Hashin1965",
      "every constraint and model"},
     ph_i_relaxation_carson},
    {{"stepping", "time steps with exact exponential weights, adaptive",
      "Taylor1970 Simo1998", "always, but for voigt and reuss"},
     ph_i_relaxation_stepping},
    {{"frequency", "a complex problem at every frequency asked for", "VanDerVorst1990",
      "families whole, not voigt or reuss"},
     ph_i_relaxation_frequency},
};
const size_t ph_nrelaxation_routes =
    sizeof ph_relaxation_routes / sizeof *ph_relaxation_routes;

static const ph_relaxation_route *find(const char *name)
{
    for (size_t i = 0; i < ph_nrelaxation_routes; i++)
        if (strcmp(name ? name : "reduced", ph_relaxation_routes[i].info.name) == 0)
            return &ph_relaxation_routes[i];
    return NULL;
}

void ph_viscoelastic_free(ph_viscoelastic **out)
{
    if (!out || !*out) return;
    ph_viscoelastic *v = *out;
    ph_prony_free(&v->series);
    ph_result_free(&v->elastic);
    free(v->points);
    free(v->values);
    free(v->curve);
    free(v->response);
    free(v->dynamic);
    free(v->error_bars);
    free(v);
    *out = NULL;
}

/* ---- from a model to the answer -------------------------------------------------------------- */

/* A direction of C_inf below this share of the solid phases' own stiffness is a fluid's: the
 * model cannot make it exactly zero, its last value of s is not zero. */
static void drop_fluid_directions(ph_prony *series, const ph_reduced *m, double tolerance)
{
    int ns = m->ns;
    ph_sym4 *rest = &series->equilibrium, a = *rest, V = {.n = ns};
    double solid = 0.0;
    int dropped = 0;
    for (int q = 0; q < m->nfunctions; q++)
        for (int i = 0; i < ns; i++)
            solid += m->function[q].rest * m->K[q][i * m->room + i] / ns;
    ph_i_jacobi(ns, 6, &a.m[0][0], &V.m[0][0]);
    for (int k = 0; k < ns; k++) {
        if (a.m[k][k] > tolerance * solid) continue;
        dropped++;
        for (int i = 0; i < ns; i++)
            for (int j = 0; j < ns; j++) {
                double x = a.m[k][k] * V.m[i][k] * V.m[j][k];
                rest->m[i][j] -= x;
                if (series->nterms > 0) /* what is lost at last */
                    series->term[series->nterms - 1].stiffness.m[i][j] += x;
            }
    }
    if (dropped == ns) *rest = (ph_sym4){.n = ns};
    for (int i = 0; i < ns; i++) /* what is left of a difference is not symmetric */
        for (int j = 0; j < i; j++)
            rest->m[i][j] = rest->m[j][i] = 0.5 * (rest->m[i][j] + rest->m[j][i]);
}

static int count_lost(const ph_sym4 *rest, const ph_sym4 *begin)
{
    double scale = ph_sym4_norm(begin);
    ph_sym4 a = *rest;
    int lost = 0;
    ph_i_jacobi(a.n, 6, &a.m[0][0], NULL);
    for (int k = 0; k < a.n; k++)
        lost += a.m[k][k] <= 1e-13 * scale;
    return lost;
}

ph_status ph_i_visco_answer(ph_viscoelastic *out, const ph_reduced *model,
                            const ph_relaxation_params *params, bool fluid,
                            double tolerance, ph_error *err)
{
    ph_status st = PH_OK;
    PH_TRY(ph_i_reduced_series(model, &out->series, err));
    if (fluid) drop_fluid_directions(out->series, model, tolerance);
    out->instantaneous = ph_prony_instantaneous(out->series);
    out->equilibrium = out->series->equilibrium;
    out->lost = count_lost(&out->equilibrium, &out->instantaneous);
    PH_ALLOC(out->values, params->ncarson, "values of the Carson variable");
    for (int i = 0; i < params->ncarson; i++)
        out->values[out->nvalues++] = (ph_carson_value){
            params->carson[i], ph_prony_carson(out->series, params->carson[i])};
out:
    return st;
}

/* ---- the call ---------------------------------------------------------------------------------- */

static ph_status check_params(const ph_relaxation_params *p, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(p->tolerance == 0.0 || (p->tolerance >= 1e-12 && p->tolerance < 1.0),
             PH_EINVAL, "relaxation tolerance must be in [1e-12, 1), got %g",
             p->tolerance);
    PH_CHECK(p->max_points >= 0, PH_EINVAL, "max_points must not be negative, got %d",
             p->max_points);
    PH_CHECK(p->ncarson >= 0 && (p->ncarson == 0 || p->carson), PH_EINVAL,
             "no array of %d Carson variables", p->ncarson);
    for (int i = 0; i < p->ncarson; i++)
        PH_CHECK(p->carson[i] >= 0.0, PH_EINVAL, "a Carson variable must be >= 0, got %g",
                 p->carson[i]);
out:
    return st;
}

/* What a route that gives a series need not say itself. */
static ph_status evaluate(ph_viscoelastic *v, const ph_relaxation_params *p,
                          ph_error *err)
{
    ph_status st = PH_OK;
    if (!v->series) return PH_OK;
    PH_ALLOC(v->curve, p->ntimes, "the curve");
    PH_ALLOC(v->dynamic, p->nomega, "complex moduli");
    for (; v->ncurve < p->ntimes; v->ncurve++)
        v->curve[v->ncurve] = (ph_time_value){
            p->times[v->ncurve], ph_prony_at_time(v->series, p->times[v->ncurve])};
    for (; v->ndynamic < p->nomega; v->ndynamic++) {
        ph_dynamic_value *d = &v->dynamic[v->ndynamic];
        d->omega = p->omega[v->ndynamic];
        ph_prony_complex(v->series, d->omega, &d->storage, &d->loss);
    }
    if (!p->history) goto out;
    PH_ALLOC(v->response, p->ntimes, "the response");
    PH_TRY(
        ph_prony_response(v->series, p->history, p->ntimes, p->times, v->response, err));
out:
    return st;
}

static void say_lost(ph_viscoelastic *v)
{
    if (v->lost == 0 || !v->elastic) return;
    if (v->lost == v->instantaneous.n)
        ph_i_note(v->elastic,
                  "equilibrium: zero, the composite flows in every direction");
    else
        ph_i_note(v->elastic,
                  "equilibrium: singular, the composite flows in %d of %d directions",
                  v->lost, v->instantaneous.n);
}

ph_status ph_viscoelastic_solve(const ph_problem *problem,
                                const ph_relaxation_params *params, const ph_ctx *ctx,
                                ph_viscoelastic **out, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_relaxation_params none = {0};
    ph_viscoelastic *v = NULL;
    if (!params) params = &none;
    PH_CHECK(out, PH_EINVAL, "NULL result");
    *out = NULL;
    PH_TRY(check_params(params, err));
    const ph_relaxation_route *route = find(params->route);
    PH_CHECK(route, PH_EINVAL, "unknown route '%s'", params->route);
    PH_ALLOC(v, 1, "the viscoelastic result");
    v->route = route->info.name;
    PH_TRY(route->solve(problem, params, ctx, v, err));
    PH_TRY(evaluate(v, params, err));
    say_lost(v);
    *out = v;
    v = NULL;
out:
    ph_viscoelastic_free(&v);
    return st;
}
