/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fit against GSL's nonlinear least squares, the surrogate against the model, the
 * intervals of two unknowns against their definition. */
#include "calibrate/calibrate.h"
#include "check.h"
#include "synthetic.h"

#include <gsl/gsl_multifit_nlinear.h>

static const ph_ctx one_thread = {.threads = 1};

/* y = a (1 - exp(-b t)), t = 100 x */
static double rise(const double *u, double x, int output)
{
    (void)output;
    return u[0] * (1 - exp(-u[1] * 100 * x));
}

static void setup_rise(synthetic_fit *f, int points, double sigma)
{
    synthetic_setup(f, points, sigma);
    f->model.mean = rise;
    f->problem.nunknowns = 2;
    f->unknown[0] = (ph_fit_unknown){.name = "a", .from = 0, .to = 20, .start = 5};
    f->unknown[1] =
        (ph_fit_unknown){.name = "b", .from = 0.01, .to = 10, .start = 1, .log = true};
}

static int gsl_residuals(const gsl_vector *x, void *user, gsl_vector *f)
{
    const synthetic_fit *s = user;
    const double u[] = {gsl_vector_get(x, 0), gsl_vector_get(x, 1)};
    for (int i = 0; i < s->problem.nmeasurements; i++) {
        const ph_fit_measurement *m = &s->measurement[i];
        double r = rise(u, s->model.content[m->point], 0) - m->value;
        gsl_vector_set(f, (size_t)i, r / m->sigma);
    }
    return GSL_SUCCESS;
}

static void solve_with_gsl(synthetic_fit *f, double x[2], double cov[4], double *chi2)
{
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    how.fdtype = GSL_MULTIFIT_NLINEAR_CTRDIFF;
    gsl_multifit_nlinear_fdf fdf = {
        .f = gsl_residuals, .n = (size_t)f->problem.nmeasurements, .p = 2, .params = f};
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, fdf.n, fdf.p);
    gsl_vector_view start = gsl_vector_view_array(x, 2);
    gsl_matrix_view c = gsl_matrix_view_array(cov, 2, 2);
    int info;
    gsl_multifit_nlinear_init(&start.vector, &fdf, w);
    gsl_multifit_nlinear_driver(200, 1e-12, 1e-12, 0, NULL, NULL, &info, w);
    gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(w), 0, &c.matrix);
    for (size_t j = 0; j < 2; j++)
        x[j] = gsl_vector_get(gsl_multifit_nlinear_position(w), j);
    *chi2 = 0;
    for (size_t i = 0; i < fdf.n; i++) {
        double r = gsl_vector_get(gsl_multifit_nlinear_residual(w), i);
        *chi2 += r * r;
    }
    gsl_multifit_nlinear_free(w);
}

static void test_gsl(void **state)
{
    static const double truth[] = {8, 0.5};
    uint64_t seed = check_seed();
    (void)state;
    for (int t = 0; t < check_trials(10); t++) {
        synthetic_fit f;
        ph_error err = PH_ERROR_INIT;
        ph_fit *fit = NULL;
        double x[2] = {6, 0.4}, cov[4], chi2;
        setup_rise(&f, 8, 0.1);
        synthetic_measure(&f, truth, 0.1, seed + (uint64_t)t);
        solve_with_gsl(&f, x, cov, &chi2);
        CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
        /* ours stops a hundredth of a standard error short at most */
        CHECK_ABS(fit->unknown[0].value, x[0], 0.01 * sqrt(cov[0]));
        CHECK_ABS(fit->unknown[1].value, x[1], 0.01 * sqrt(cov[3]));
        CHECK_ABS(fit->misfit, chi2, 1e-3);
        /* central differences of half a per cent of a scale of log 1000: the third
         * derivative leaves (0.035)^2 / 6 = 2e-4 of the first; at the place where ours
         * stopped the curvature differs by about as much as that is away */
        CHECK_REL(fit->unknown[0].standard_error, sqrt(cov[0]), 5e-3);
        CHECK_REL(fit->unknown[1].standard_error, sqrt(cov[3]), 5e-3);
        CHECK_ABS(fit->correlation[1], cov[1] / sqrt(cov[0] * cov[3]), 5e-3);
        ph_fit_free(&fit);
    }
    CHECK_END();
}

/* At the end of an interval the least misfit over the other unknown, found by golden
 * section, has risen by 1.96^2. */
static double least_misfit(const synthetic_fit *f, double b)
{
    double top = 0, bottom = 0, sum = 0; /* a is linear: one normal equation */
    for (int i = 0; i < f->problem.nmeasurements; i++) {
        const double u[] = {1, b};
        double g = rise(u, f->model.content[i], 0), y = f->measurement[i].value;
        top += g * y;
        bottom += g * g;
    }
    for (int i = 0; i < f->problem.nmeasurements; i++) {
        const double u[] = {top / bottom, b};
        double r = rise(u, f->model.content[i], 0) - f->measurement[i].value;
        sum += r * r / (f->measurement[i].sigma * f->measurement[i].sigma);
    }
    return sum;
}

static void test_profile(void **state)
{
    static const double truth[] = {8, 0.5};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_rise(&f, 8, 0.15);
    synthetic_measure(&f, truth, 0.15, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    const ph_fit_estimate *b = &fit->unknown[1];
    CHECK(fit->surrogate_error < 0.1);
    for (int side = 0; side < 2; side++) {
        double risen = least_misfit(&f, b->profile[side]) - fit->misfit;
        /* the surrogate misses residuals of size 2 by surrogate_error at most */
        CHECK_ABS(risen, 3.8414588, 0.01 + 4 * 2 * fit->surrogate_error);
    }
    for (int i = 0; i < b->nprofile; i += 8)
        if (b->profile_misfit[i] < fit->misfit + 4.5)
            CHECK_ABS(b->profile_misfit[i], least_misfit(&f, b->profile_value[i]),
                      0.01 + 4 * 3 * fit->surrogate_error);
    ph_fit_free(&fit);
    CHECK_END();
}

/* ---- parts */

static ph_status valley(void *user, int m, const double *u, double *f, ph_error *err)
{
    (void)user, (void)err;
    for (int i = 0; i < m; i++) {
        double x = 4 * u[i * K] - 2, y = 4 * u[i * K + 1] - 2;
        f[2 * i] = 10 * (y - x * x); /* Rosenbrock's valley */
        f[2 * i + 1] = 1 - x;
    }
    return PH_OK;
}

static void test_minimise(void **state)
{
    const ph_i_residuals r = {.k = 2, .n = 2, .eval = valley};
    ph_i_search how = {
        .hi = {1, 1}, .step = 1e-5, .tolerance = 1e-6, .scale = 1, .iterations = 200};
    ph_error err = PH_ERROR_INIT;
    double u[K] = {0.2, 0.75}, chi2;
    bool converged;
    (void)state;
    CHECK_OK(ph_i_minimise(&r, &how, u, &chi2, &converged, &err));
    CHECK(converged);
    CHECK_ABS(u[0], 0.75, 1e-5);
    CHECK_ABS(u[1], 0.75, 1e-5);
    /* With x held below 0.5: at the bound y = x^2, and chi2 = (1 - x)^2. */
    how.hi[0] = 0.625;
    u[0] = 0.2, u[1] = 0.75;
    CHECK_OK(ph_i_minimise(&r, &how, u, &chi2, &converged, &err));
    CHECK(converged && u[0] == 0.625);
    CHECK_ABS(4 * u[1] - 2, 0.25, 1e-5);
    CHECK_ABS(chi2, 0.25, 1e-8);
    CHECK_END();
}

static ph_status polynomial(void *user, int m, const double *u, double *f, ph_error *err)
{
    (void)user, (void)err;
    for (int i = 0; i < m; i++) {
        double x = u[i * K], y = u[i * K + 1];
        f[2 * i] = 1 + x * x * x * x - 2 * x * y * y * y;
        f[2 * i + 1] = y * y * y * y * x * x * x * x;
    }
    return PH_OK;
}

/* Five nodes an axis: exact up to the fourth power of each. */
static void test_surrogate(void **state)
{
    const ph_i_residuals r = {.k = 2, .n = 2, .eval = polynomial};
    const double lo[K] = {0.1, 0.3}, hi[K] = {0.7, 1}, centre[K] = {0.4, 0.5};
    ph_error err = PH_ERROR_INIT;
    ph_i_surrogate *s = NULL;
    uint64_t seed = check_seed();
    bool built;
    (void)state;
    CHECK_OK(ph_i_surrogate_new(&r, lo, hi, centre, &s, &built, &err));
    CHECK(built && s->nodes == 5 && s->error < 1e-13);
    for (int t = 0; t < 50; t++) {
        double u[K] = {check_uniform(&seed, lo[0], hi[0]),
                       check_uniform(&seed, lo[1], hi[1])};
        double got[2], want[2];
        CHECK_OK(ph_i_surrogate_residuals(s, 1, u, got, &err));
        CHECK_OK(polynomial(NULL, 1, u, want, &err));
        CHECK_ABS(got[0], want[0], 1e-13);
        CHECK_ABS(got[1], want[1], 1e-13);
    }
    ph_i_surrogate_free(&s);
    CHECK(s == NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gsl), cmocka_unit_test(test_profile),
        cmocka_unit_test(test_minimise), cmocka_unit_test(test_surrogate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
