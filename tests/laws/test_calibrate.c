/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calibration of models whose answer is known. */
#include "check.h"
#include "synthetic.h"

static const ph_ctx one_thread = {.threads = 1};

static bool within(double x, const double interval[2])
{
    return x >= interval[0] && x <= interval[1];
}

/* ---- coverage: how often do the intervals contain the truth? */

typedef struct coverage {
    double kappa, sigma, noise;
    int points;
    bool known;            /* sigma is given */
    double relative_error; /* target of the sampling */
} coverage;

static void cover(const coverage *c, int trials, uint64_t seed, double *local,
                  double *profile)
{
    int inside[2] = {0, 0};
    for (int i = 0; i < trials; i++) {
        ph_error err = PH_ERROR_INIT;
        ph_fit *fit = NULL;
        synthetic_fit f;
        synthetic_setup(&f, c->points, c->known ? c->sigma : (double)NAN);
        f.model.seed = seed + 1000000u + (uint64_t)i;
        f.model.noise = c->noise;
        f.problem.random = c->noise > 0;
        synthetic_measure(&f, &c->kappa, c->sigma, seed + 2000000u + (uint64_t)i);
        const ph_fit_params how = {.relative_error = c->relative_error};
        CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &fit, &err));
        if (!fit) return;
        inside[0] += within(c->kappa, fit->unknown[0].local);
        inside[1] += within(c->kappa, fit->unknown[0].profile);
        ph_fit_free(&fit);
    }
    *local = (double)inside[0] / trials;
    *profile = (double)inside[1] / trials;
    print_message("kappa %g, sigma %g, noise %g, %d points: local %.3f, profile %.3f\n",
                  c->kappa, c->sigma, c->noise, c->points, *local, *profile);
}

/* n trials scatter by sqrt(0.95 0.05 / n), 1.3 % for 300: three of them, and 1 % because the
 * intervals are right to first order only. 1000 trials: docs/theory/calibration.md. */
static void test_coverage(void **state)
{
    static const coverage all[] = {
        {15, 0.05, 0, 5, true, 0.01},  /* errors of the data alone */
        {15, 0.05, 1, 5, true, 0.05},  /* sampling a third of them */
        {5, 0.05, 4, 3, true, 0.5},    /* sampling the larger one */
        {15, 0.05, 0, 5, false, 0.01}, /* sigma from the scatter: Student's t */
        {1, 0.03, 2, 5, true, 0.3}};   /* intervals that reach the flat part */
    uint64_t seed = check_seed();
    int trials = check_trials(300);
    double allowed = 0.01 + 3 * sqrt(0.95 * 0.05 / trials);
    (void)state;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        double local, profile;
        cover(&all[i], trials, seed + 10000000u * i, &local, &profile);
        CHECK_ABS(profile, 0.95, allowed);
        /* symmetric intervals of a saturating model are worse than profiles */
        CHECK_ABS(local, 0.95, allowed + 0.02);
    }
    CHECK_END();
}

/* ---- linear models: everything has a formula */

static double line(const double *u, double x, int output)
{
    (void)output;
    return u[0] + 20 * x * u[1];
}

/* y = a + b t, t = 20 x: normal equations by hand. */
static void setup_line(synthetic_fit *f, int points, double sigma)
{
    synthetic_setup(f, points, sigma);
    f->model.mean = line;
    f->problem.nunknowns = 2;
    f->unknown[0] = (ph_fit_unknown){.name = "a", .from = -10, .to = 10, .start = 3};
    f->unknown[1] = (ph_fit_unknown){.name = "b", .from = -10, .to = 10, .start = -4};
}

typedef struct normal_equations {
    double a, b, va, vb, cab, chi2;
} normal_equations;

static normal_equations solve_line(const synthetic_fit *f, int skip, double sigma)
{
    double s = 0, st = 0, stt = 0, sy = 0, sty = 0;
    normal_equations e = {0};
    for (int i = 0; i < f->problem.nmeasurements; i++) {
        double t = 20 * f->model.content[i], y = f->measurement[i].value;
        if (i == skip) continue;
        s += 1, st += t, stt += t * t, sy += y, sty += t * y;
    }
    double d = s * stt - st * st;
    e.a = (stt * sy - st * sty) / d;
    e.b = (s * sty - st * sy) / d;
    e.va = sigma * sigma * stt / d;
    e.vb = sigma * sigma * s / d;
    e.cab = -sigma * sigma * st / d;
    for (int i = 0; i < f->problem.nmeasurements; i++) {
        double r = e.a + e.b * 20 * f->model.content[i] - f->measurement[i].value;
        if (i != skip) e.chi2 += r * r / (sigma * sigma);
    }
    return e;
}

static void test_line(void **state)
{
    static const double truth[] = {1.5, 2.5};
    const double sigma = 0.1;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_line(&f, 6, sigma);
    synthetic_measure(&f, truth, sigma, check_seed());
    normal_equations e = solve_line(&f, -1, sigma);
    const ph_fit_params how = {.samples = 20000, .seed = 3};
    CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &fit, &err));
    /* The search stops at a step below 1 % of a standard error; on a line Gauss-Newton is
     * exact but for the damping, which the steps before have taken to 1e-5. */
    CHECK_ABS(fit->unknown[0].value, e.a, 1e-3 * sqrt(e.va));
    CHECK_ABS(fit->unknown[1].value, e.b, 1e-3 * sqrt(e.vb));
    CHECK_REL(fit->unknown[0].standard_error, sqrt(e.va), 1e-9);
    CHECK_REL(fit->unknown[1].standard_error, sqrt(e.vb), 1e-9);
    CHECK_ABS(fit->correlation[1], e.cab / sqrt(e.va * e.vb), 1e-9);
    CHECK_ABS(fit->misfit, e.chi2, 1e-5);
    for (int j = 0; j < 2; j++) {
        /* The profile of a line is the parabola of its curvature: both intervals agree, to
         * where the search stops. */
        double error = fit->unknown[j].standard_error;
        for (int side = 0; side < 2; side++)
            CHECK_ABS(fit->unknown[j].profile[side], fit->unknown[j].local[side],
                      2e-3 * error);
        /* 20000 samples in chains of some ten correlated steps: 2000 that count, so that
         * the mean scatters by 0.02 and the deviation by 0.016 standard errors. */
        CHECK_ABS(fit->unknown[j].posterior_mean, fit->unknown[j].value, 0.08 * error);
        CHECK_REL(fit->unknown[j].posterior_std, error, 0.07);
        CHECK(fit->unknown[j].autocorrelation > 1 &&
              fit->unknown[j].autocorrelation < 60);
    }
    CHECK(fit->acceptance > 0.5 && fit->acceptance < 0.9);
    /* leave-one-out from normal equations without the measurement */
    for (int i = 0; i < 6; i++) {
        normal_equations without = solve_line(&f, i, sigma);
        double want = without.a + without.b * 20 * f.model.content[i];
        CHECK_ABS(fit->point[i].left_out, want, 2e-3 * sigma);
    }
    ph_fit_free(&fit);
    CHECK_END();
}

/* Without sigma: relative errors, so that each equation is divided by its measured value; the
 * same answers as with sigma = the value times what is found. */
static void test_sigma_found(void **state)
{
    static const double truth[] = {1.5, 2.5};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *found = NULL, *given = NULL;
    (void)state;
    setup_line(&f, 6, NAN);
    synthetic_measure(&f, truth, 0.1, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &found, &err));
    for (int i = 0; i < 6; i++)
        f.measurement[i].sigma = found->sigma_scale * f.measurement[i].value;
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &given, &err));
    CHECK_REL(given->misfit, 4, 1e-4); /* by construction: the degrees of freedom */
    for (int j = 0; j < 2; j++) {
        double error = given->unknown[j].standard_error;
        CHECK_ABS(found->unknown[j].value, given->unknown[j].value, 2e-3 * error);
        CHECK_REL(found->unknown[j].standard_error, error, 1e-3);
        CHECK(found->unknown[j].freedom == 4);
        /* Student's t with four degrees of freedom, 2.7764, instead of 1.95996 */
        double wide = found->unknown[j].profile[1] - found->unknown[j].profile[0];
        double slim = given->unknown[j].profile[1] - given->unknown[j].profile[0];
        CHECK_REL(wide / slim, 2.77644511 / 1.95996398, 2e-3);
    }
    for (int i = 0; i < 6; i++) {
        CHECK_ABS(found->point[i].left_out, given->point[i].left_out,
                  5e-3 * given->point[i].sigma);
        CHECK_REL(found->point[i].sigma, given->point[i].sigma, 1e-9);
    }
    CHECK_REL(found->left_out_rms, given->left_out_rms, 5e-3);
    ph_fit_free(&found);
    ph_fit_free(&given);
    CHECK_END();
}

/* Sampling error of a line: realisations shift each mean; the formula is that of the mean of
 * the estimates of single realisations. */
static void test_sampling_error(void **state)
{
    static const double truth[] = {2, 1};
    enum { N = 64 };
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    double sum[2] = {0}, square[2] = {0};
    (void)state;
    setup_line(&f, 5, 1.0);
    f.model.noise = 3;
    f.problem.random = true;
    synthetic_measure(&f, truth, 0, check_seed());
    const ph_fit_params how = {.at_least = N, .at_most = N};
    CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &fit, &err));
    /* Estimate from realisation r alone, at the values that were found: the data minus its
     * deviation from the mean. Linear: normal equations of the deviations. */
    const double best[] = {fit->unknown[0].value, fit->unknown[1].value};
    for (int r = 0; r < N; r++) {
        synthetic_fit g = f;
        for (int i = 0; i < 5; i++)
            CHECK_OK(synthetic_model(&f.model, best, i, (uint64_t)r,
                                     &g.measurement[i].value, &err));
        normal_equations e = solve_line(&g, -1, 1.0);
        const double x[] = {e.a, e.b};
        for (int j = 0; j < 2; j++)
            sum[j] += x[j], square[j] += x[j] * x[j];
    }
    for (int j = 0; j < 2; j++) {
        double variance = (square[j] - sum[j] * sum[j] / N) / (N - 1) / N;
        /* Noise is a factor on the model: the Jacobian has it too, which the hand
         * calculation has not: 1 / sqrt(64) of its size, 3 0.05 = 15 %. */
        CHECK_REL(fit->unknown[j].error_sampling, sqrt(variance), 0.06);
    }
    CHECK(fit->solves >= 5 * N && fit->point[0].realisations == N);
    ph_fit_free(&fit);
    CHECK_END();
}

/* ---- more realisations only where they change the answer */

static void test_allocation(void **state)
{
    static const double kappa = 15;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    synthetic_setup(&f, 5, 0.05);
    f.model.content[0] = 0; /* nothing to average there */
    f.model.noise = 2;
    f.problem.random = true;
    synthetic_measure(&f, &kappa, 0.05, check_seed());
    const ph_fit_params large = {.at_most = 100000};
    CHECK_OK(ph_calibrate(&f.problem, &large, &one_thread, &fit, &err));
    const ph_fit_estimate *x = &fit->unknown[0];
    CHECK(fit->reached);
    CHECK(x->error_sampling <= fmax(0.01 * x->value, x->error_data / 3));
    CHECK(fit->point[0].realisations == 8);
    CHECK(fit->point[4].realisations > 2 * fit->point[1].realisations);
    ph_fit_free(&fit);
    /* A budget that is too small is said. */
    const ph_fit_params small = {.at_most = 10};
    CHECK_OK(ph_calibrate(&f.problem, &small, &one_thread, &fit, &err));
    CHECK(!fit->reached && fit->point[4].realisations == 10);
    CHECK(fit->nnotes > 0 && strstr(fit->notes[0], "budget"));
    ph_fit_free(&fit);
    CHECK_END();
}

/* Threads and the order of their work change nothing. */
static void test_threads(void **state)
{
    static const double kappa = 2;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *one = NULL, *many = NULL;
    const ph_ctx four = {.threads = 4};
    const ph_fit_params how = {.samples = 100, .relative_error = 0.2};
    (void)state;
    synthetic_setup(&f, 4, 0.05);
    f.model.noise = 2;
    f.problem.random = true;
    synthetic_measure(&f, &kappa, 0.05, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &one, &err));
    CHECK_OK(ph_calibrate(&f.problem, &how, &four, &many, &err));
    CHECK(memcmp(one->unknown, many->unknown, sizeof *one->unknown) == 0);
    CHECK(memcmp(one->sample, many->sample, 100 * sizeof *one->sample) == 0);
    CHECK(one->solves == many->solves && one->misfit == many->misfit);
    ph_fit_free(&one);
    ph_fit_free(&many);
    CHECK_END();
}

/* ---- what cannot be known */

static bool notes_say(const ph_fit *fit, const char *what)
{
    for (int i = 0; i < fit->nnotes; i++)
        if (strstr(fit->notes[i], what)) return true;
    return false;
}

static double first_only(const double *u, double x, int output)
{
    (void)output;
    return 3 + 20 * x * u[0];
}

static void test_flat(void **state)
{
    static const double truth[] = {1, 1};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_line(&f, 5, 0.1);
    f.model.mean = first_only;
    synthetic_measure(&f, truth, 0.1, check_seed());
    const ph_fit_params how = {.samples = 2000};
    CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &fit, &err));
    const ph_fit_estimate *a = &fit->unknown[0], *b = &fit->unknown[1];
    CHECK(a->knowledge == PH_FIT_KNOWN && b->knowledge == PH_FIT_FLAT);
    CHECK(isnan(b->standard_error) && b->interval[0] == -10 && b->interval[1] == 10);
    CHECK(b->open[0] && b->open[1] && b->value == -4); /* the start */
    CHECK(notes_say(fit, "b is not identifiable"));
    CHECK(fit->direction[1].eigenvalue == 0 && fabs(fit->direction[1].component[1]) == 1);
    CHECK(fit->freedom == 4);
    CHECK(isnan(fit->correlation[1]));
    /* The profile is flat, and the posterior is the prior: uniform, deviation 20 / sqrt(12) */
    CHECK_ABS(b->profile_misfit[0], b->profile_misfit[PH_FIT_PROFILE - 1], 1e-9);
    CHECK_REL(b->posterior_std, 20 / sqrt(12), 0.1);
    ph_fit_free(&fit);
    CHECK_END();
}

static double sum_only(const double *u, double x, int output)
{
    (void)output;
    return (u[0] + u[1]) * (1 + x);
}

/* Only the sum is known: neither of the two, and the direction says so. */
static void test_sum(void **state)
{
    static const double truth[] = {1, 2};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_line(&f, 5, 0.01);
    f.model.mean = sum_only;
    synthetic_measure(&f, truth, 0.01, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    CHECK_ABS(fit->unknown[0].value + fit->unknown[1].value, 3, 0.03);
    for (int j = 0; j < 2; j++) {
        CHECK(isnan(fit->unknown[j].standard_error));
        CHECK(fit->unknown[j].knowledge != PH_FIT_KNOWN);
    }
    CHECK_ABS(fit->direction[0].component[0], fit->direction[0].component[1], 1e-9);
    CHECK_ABS(fit->direction[1].component[0], -fit->direction[1].component[1], 1e-9);
    CHECK(fit->direction[1].knowledge == PH_FIT_FLAT);
    ph_fit_free(&fit);
    CHECK_END();
}

static double nearly_sum(const double *u, double x, int output)
{
    (void)output;
    return u[0] + u[1] * (1 + x);
}

static void test_correlated(void **state)
{
    static const double truth[] = {1, 2};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_line(&f, 6, 0.01);
    f.model.mean = nearly_sum;
    synthetic_measure(&f, truth, 0.01, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    CHECK(fit->correlation[1] < -0.99);
    CHECK(notes_say(fit, "correlated"));
    for (int j = 0; j < 2; j++) {
        double error = fit->unknown[j].standard_error;
        CHECK_ABS(fit->unknown[j].value, truth[j], 5 * error);
        /* a parabola: profile and curvature agree, to where the search stops */
        CHECK_ABS(fit->unknown[j].profile[0], fit->unknown[j].local[0], 0.02 * error);
        CHECK_ABS(fit->unknown[j].profile[1], fit->unknown[j].local[1], 0.02 * error);
    }
    ph_fit_free(&fit);
    CHECK_END();
}

static double squared(const double *u, double x, int output)
{
    (void)output;
    return (u[0] * u[0]) * (1 + x);
}

/* Both roots fit: the second is said. */
static void test_several(void **state)
{
    static const double truth = 3;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    synthetic_setup(&f, 4, 0.1);
    f.unknown[0] = (ph_fit_unknown){.name = "x", .from = -8, .to = 10, .start = 1};
    f.model.mean = squared;
    synthetic_measure(&f, &truth, 0.1, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    CHECK(fit->nminima == 2 && fit->minimum[1].as_good);
    CHECK_ABS(fabs(fit->minimum[0].value[0]), 3, 0.1);
    CHECK_ABS(fit->minimum[1].value[0], -fit->minimum[0].value[0], 0.01);
    CHECK(notes_say(fit, "not unique"));
    ph_fit_free(&fit);
    CHECK_END();
}

/* The truth lies beyond the bound. */
static void test_bound(void **state)
{
    static const double kappa = 60;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    synthetic_setup(&f, 5, 0.02);
    f.unknown[0].to = 20;
    synthetic_measure(&f, &kappa, 0, check_seed());
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    const ph_fit_estimate *x = &fit->unknown[0];
    CHECK(x->value == 20 && x->at_bound && x->open[1] && !x->open[0]);
    CHECK(x->interval[1] == 20 && x->interval[0] > 10 && x->interval[0] < 20);
    CHECK(notes_say(fit, "bound 20"));
    ph_fit_free(&fit);
    CHECK_END();
}

/* ---- data */

static void test_outlier(void **state)
{
    static const double truth[] = {1.5, 2.5};
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    setup_line(&f, 8, 0.1);
    synthetic_measure(&f, truth, 0.05, check_seed());
    f.measurement[3].value += 1;
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    /* It draws the line towards itself, so that neighbours may be called outliers too. */
    CHECK(fit->point[3].outlier);
    for (int i = 0; i < 8; i++)
        CHECK(fabs(fit->point[i].residual) <= fabs(fit->point[3].residual));
    CHECK(notes_say(fit, "measurement 4") && notes_say(fit, "misfit"));
    CHECK(fit->probability < 1e-6);
    CHECK_ABS(fit->point[3].left_out, f.measurement[3].value - 1, 0.3);
    CHECK(fit->left_out_rms > fit->residual_rms);
    ph_fit_free(&fit);
    CHECK_END();
}

static void test_one_point(void **state)
{
    static const double kappa = 15;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    synthetic_setup(&f, 1, 0.05);
    synthetic_measure(&f, &kappa, 0, 1);
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    CHECK_REL(fit->unknown[0].value, 15, 1e-3);
    CHECK(within(15, fit->unknown[0].interval) && fit->freedom == 0);
    CHECK(isnan(fit->point[0].left_out) && isnan(fit->left_out_rms));
    CHECK(notes_say(fit, "checks nothing"));
    /* 95 %: where the model is 1.96 sigma away */
    for (int side = 0; side < 2; side++) {
        double there = synthetic_kappa(&fit->unknown[0].profile[side], 0.05, 0);
        CHECK_ABS(fabs(there - f.measurement[0].value), 1.96 * 0.05, 1e-3);
    }
    ph_fit_free(&fit);
    /* Without sigma nothing is known of the error. */
    f.measurement[0].sigma = NAN;
    CHECK_OK(ph_calibrate(&f.problem, NULL, &one_thread, &fit, &err));
    CHECK_REL(fit->unknown[0].value, 15, 1e-3);
    CHECK(isnan(fit->unknown[0].error_data) && isnan(fit->unknown[0].profile[0]));
    CHECK(notes_say(fit, "no sigma"));
    ph_fit_free(&fit);
    CHECK_END();
}

/* Odd realisations fail where kappa is large: they are left out everywhere, so that the means
 * stay smooth; where most fail, the value is refused. */
static ph_status some_fail(const double *u, int point, uint64_t r, ph_error *err)
{
    (void)point;
    bool fails = (r % 4 == 1 && u[0] > 10) || u[0] > 60;
    return fails ? ph_error_set(err, PH_ENOCONV, __FILE__, __LINE__, "too stiff") : PH_OK;
}

static void test_failures(void **state)
{
    static const double kappa = 15;
    synthetic_fit f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    (void)state;
    synthetic_setup(&f, 5, 0.05);
    f.model.noise = 1;
    f.model.odd = some_fail;
    f.problem.random = true;
    synthetic_measure(&f, &kappa, 0, 1);
    const ph_fit_params how = {.at_least = 40, .at_most = 40};
    CHECK_OK(ph_calibrate(&f.problem, &how, &one_thread, &fit, &err));
    CHECK(within(15, fit->unknown[0].interval));
    for (int i = 0; i < 5; i++)
        CHECK(fit->point[i].failed == 10 && fit->point[i].realisations == 30);
    CHECK(notes_say(fit, "10 of 40 realisations failed") && notes_say(fit, "too stiff"));
    CHECK(fit->failures > 0);
    ph_fit_free(&fit);
    CHECK_END();
}

static ph_status all_fail(const double *u, int point, uint64_t r, ph_error *err)
{
    (void)u, (void)point, (void)r;
    return ph_error_set(err, PH_ESINGULAR, __FILE__, __LINE__, "no way");
}

static ph_status no_memory(const double *u, int point, uint64_t r, ph_error *err)
{
    (void)u, (void)point;
    return r == 2 ? ph_error_set(err, PH_ENOMEM, __FILE__, __LINE__, "full") : PH_OK;
}

static bool stop(void *user, const ph_progress *now)
{
    (void)now;
    return --*(int *)user > 0;
}

static void expect(const synthetic_fit *f, const ph_fit_params *how, ph_status want,
                   const char *says)
{
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    CHECK(ph_calibrate(&f->problem, how, &one_thread, &fit, &err) == want);
    CHECK(fit == NULL);
    if (!strstr(err.msg, says)) print_error("'%s' does not say '%s'\n", err.msg, says);
    CHECK(strstr(err.msg, says));
}

static void test_refusals(void **state)
{
    static const double kappa = 15;
    synthetic_fit good, f;
    ph_error err = PH_ERROR_INIT;
    ph_fit *fit = NULL;
    int left = 30;
    const ph_ctx impatient = {.progress = stop, .user = &left, .threads = 1};
    (void)state;
    synthetic_setup(&good, 3, 0.05);
    good.problem.random = true;
    synthetic_measure(&good, &kappa, 0.05, 1);
#define BAD(change, status, says)                                                        \
    do {                                                                                 \
        f = good;                                                                        \
        f.problem.unknown = f.unknown;                                                   \
        f.problem.measurement = f.measurement;                                           \
        f.problem.user = &f.model;                                                       \
        change;                                                                          \
        expect(&f, NULL, status, says);                                                  \
    } while (0)
    BAD(f.measurement[1].value = NAN, PH_EINVAL, "measurement 2: nan");
    BAD(f.measurement[1].value = INFINITY, PH_EINVAL, "measurement 2: inf");
    BAD(f.measurement[2].sigma = 0, PH_EINVAL, "measurement 3: sigma 0");
    BAD(f.measurement[2].sigma = -1, PH_EINVAL, "sigma -1");
    BAD(f.measurement[2].sigma = NAN, PH_EINVAL, "have a sigma or none");
    BAD(f.measurement[0].point = 3, PH_EINVAL, "no such point");
    BAD(f.unknown[0].from = 200, PH_EINVAL, "from must be less");
    BAD(f.unknown[0].from = 0, PH_EINVAL, "scale log");
    BAD(f.unknown[0].start = 1000, PH_EINVAL, "outside");
    BAD(f.unknown[0].to = INFINITY, PH_EINVAL, "finite");
    BAD(f.problem.nunknowns = 0, PH_EINVAL, "0 unknowns");
    BAD(f.problem.nunknowns = 9, PH_EINVAL, "9 unknowns");
    BAD(f.problem.nmeasurements = 0, PH_EINVAL, "no measurements");
    BAD((f.problem.nunknowns = 2, f.unknown[1] = f.unknown[0],
         f.problem.nmeasurements = 1),
        PH_EINVAL, "2 unknowns and 1 measurement:");
    BAD(f.problem.model = NULL, PH_EINVAL, "needs a model");
    BAD(f.model.odd = all_fail, PH_ENOCONV, "no way");
    BAD(f.model.odd = no_memory, PH_ENOMEM, "full");
    const ph_fit_params bad = {.relative_error = -1};
    expect(&good, &bad, PH_EINVAL, "positive");
    CHECK(ph_calibrate(&good.problem, NULL, &impatient, &fit, &err) == PH_ECANCELLED);
    CHECK(left <= 0 && fit == NULL);
    CHECK(ph_calibrate(NULL, NULL, NULL, &fit, NULL) == PH_EINVAL);
    ph_fit_free(NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coverage),    cmocka_unit_test(test_line),
        cmocka_unit_test(test_sigma_found), cmocka_unit_test(test_sampling_error),
        cmocka_unit_test(test_allocation),  cmocka_unit_test(test_threads),
        cmocka_unit_test(test_flat),        cmocka_unit_test(test_sum),
        cmocka_unit_test(test_correlated),  cmocka_unit_test(test_several),
        cmocka_unit_test(test_bound),       cmocka_unit_test(test_outlier),
        cmocka_unit_test(test_one_point),   cmocka_unit_test(test_failures),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
