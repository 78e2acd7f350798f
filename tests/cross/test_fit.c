/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series that are known come back from their own relaxation, creep and dynamic data. */
#include <perihom/fit.h>

#include "check.h"

enum { POINTS = 400, TERMS = 40 };

/* Measurements of a known material. */
typedef struct sample {
    ph_modulus_term term[TERMS];
    ph_modulus modulus;
    double x[POINTS], value[POINTS], loss[POINTS];
    ph_prony_data data;
} sample;

static void set_series(sample *s, double infinity, int n, const double *time,
                       const double *modulus)
{
    for (int k = 0; k < n; k++)
        s->term[k] = (ph_modulus_term){.time = time[k], .modulus = modulus[k]};
    s->modulus = (ph_modulus){.infinity = infinity, .nterms = n, .term = s->term};
}

/* Values written out here, not by the library. */
static void measure(sample *s, ph_prony_kind kind, int n, double first, double last)
{
    for (int i = 0; i < n; i++) {
        double x = first * pow(last / first, i / (n - 1.0));
        s->x[i] = x;
        s->value[i] = s->modulus.infinity;
        s->loss[i] = 0;
        for (int k = 0; k < s->modulus.nterms; k++) {
            double M = s->term[k].modulus, z = x * s->term[k].time;
            if (kind == PH_PRONY_DYNAMIC) {
                s->value[i] += M * z * z / (1 + z * z);
                s->loss[i] += M * z / (1 + z * z);
            } else {
                s->value[i] += M * exp(-x / s->term[k].time);
            }
        }
    }
    s->data = (ph_prony_data){.kind = kind,
                              .n = n,
                              .x = s->x,
                              .value = s->value,
                              .loss = kind == PH_PRONY_DYNAMIC ? s->loss : NULL};
}

/* Multiplicative noise of this size, about normal: the sum of 12 uniform numbers. */
static void add_noise(sample *s, double size, uint64_t *seed)
{
    for (int i = 0; i < s->data.n; i++)
        for (int part = 0; part < 2; part++) {
            double sum = -6;
            for (int k = 0; k < 12; k++)
                sum += check_random(seed);
            *(part ? &s->loss[i] : &s->value[i]) *= 1 + size * sum;
        }
}

static ph_prony_fit *fit_of(const ph_prony_data *data, const ph_prony_fit_params *params)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_fit *fit = NULL;
    ph_status st = ph_prony_fit_new(data, params, &fit, &err);
    if (st != PH_OK) fail_msg("%s", err.msg);
    return fit;
}

static void check_series(const ph_modulus *got, const ph_modulus *want, double tol)
{
    CHECK(got->nterms == want->nterms);
    CHECK_ABS(got->infinity, want->infinity, tol);
    for (int k = 0; k < want->nterms && got->nterms == want->nterms; k++) {
        CHECK_REL(got->term[k].time, want->term[k].time, tol);
        CHECK_ABS(got->term[k].modulus, want->term[k].modulus, tol);
    }
}

static const double five_times[] = {1e-3, 1e-2, 1, 10, 1e3};
static const double five_moduli[] = {1.5, 0.4, 0.9, 0.25, 0.6};

/* Times on the grid: only the moduli are sought. Condition of one time a decade: below 1e3. */
static void test_grid_is_exact(void **state)
{
    (void)state;
    sample s;
    set_series(&s, 0.35, 5, five_times, five_moduli);
    for (int kind = 0; kind < 3; kind += 2) {
        measure(&s, (ph_prony_kind)kind, 90, 1e-5, 1e5);
        ph_prony_fit *fit = fit_of(&s.data, &(ph_prony_fit_params){.per_decade = 1});
        check_series(&fit->modulus, &s.modulus, 1e-10);
        CHECK(fit->misfit < 1e-12 && fit->nsteps == 0);
        ph_prony_fit_free(&fit);
        fit = fit_of(&s.data, &(ph_prony_fit_params){.ntimes = 5, .times = five_times});
        check_series(&fit->modulus, &s.modulus, 1e-10);
        ph_prony_fit_free(&fit);
        fit = fit_of(&s.data, &(ph_prony_fit_params){
                                  .ntimes = 5, .times = five_times, .absolute = true});
        check_series(&fit->modulus, &s.modulus, 1e-10);
        ph_prony_fit_free(&fit);
        CHECK(fit == NULL);
    }
    CHECK_END();
}

/* Times anywhere: found by the search to about the digits that its step criterion leaves. */
static void test_sought_times_are_found(void **state)
{
    (void)state;
    static const double time[] = {2.7e-4, 0.013, 0.41, 88},
                        modulus[] = {2, 0.7, 1.1, 0.5};
    sample s;
    for (int fluid = 0; fluid < 2; fluid++)
        for (int kind = 0; kind < 3; kind += 2) {
            set_series(&s, fluid ? 0 : 0.2, 4, time, modulus);
            measure(&s, (ph_prony_kind)kind, 120, kind ? 1e-4 : 1e-5, kind ? 1e5 : 1e4);
            ph_prony_fit *fit = fit_of(&s.data, NULL);
            check_series(&fit->modulus, &s.modulus, 1e-6);
            CHECK(fit->misfit < 1e-8);
            CHECK(fit->step[fit->chosen].terms == 4);
            ph_prony_fit_free(&fit);
        }
    CHECK_END();
}

/* Relaxation and dynamic data of one material give one series, also with noise in the size
 * of the noise: compared where both were measured. */
static void test_dynamic_agrees_with_relaxation(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    static sample a, b;
    const double noise = 0.01;
    set_series(&a, 0.35, 5, five_times, five_moduli);
    set_series(&b, 0.35, 5, five_times, five_moduli);
    measure(&a, PH_PRONY_RELAXATION, 100, 1e-4, 1e4);
    measure(&b, PH_PRONY_DYNAMIC, 100, 1e-4, 1e4);
    add_noise(&a, noise, &seed);
    add_noise(&b, noise, &seed);
    ph_prony_fit *one = fit_of(&a.data, NULL), *two = fit_of(&b.data, NULL);
    for (int i = 0; i < 100; i++) {
        double t = a.x[i], M = one->modulus.infinity, N = two->modulus.infinity;
        for (int k = 0; k < one->modulus.nterms; k++)
            M += one->modulus.term[k].modulus * exp(-t / one->modulus.term[k].time);
        for (int k = 0; k < two->modulus.nterms; k++)
            N += two->modulus.term[k].modulus * exp(-t / two->modulus.term[k].time);
        /* some 11 parameters share 100 or 200 points: errors below the noise, added */
        CHECK_REL(M, N, 3 * noise);
    }
    ph_prony_fit_free(&one);
    ph_prony_fit_free(&two);
    CHECK_END();
}

/* With noise: as many terms as the truth or fewer, a misfit of the noise's size, and the
 * curve nearer to the truth than the points are. Everything positive, so M falls. */
static void test_noise(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(6); trial++) {
        static sample s, truth;
        const double noise = trial % 2 ? 0.02 : 0.003;
        ph_prony_kind kind = trial % 3 == 0 ? PH_PRONY_DYNAMIC : PH_PRONY_RELAXATION;
        set_series(&s, 0.35, 5, five_times, five_moduli);
        measure(&s, kind, 150, 1e-5, 1e5);
        truth = s;
        add_noise(&s, noise, &seed);
        ph_prony_fit *fit = fit_of(&s.data, NULL);
        double off = 0, m = (double)fit->nresiduals;
        CHECK(fit->modulus.nterms >= 3 && fit->modulus.nterms <= 7);
        /* chi of m residuals: within 5 standard deviations 1/sqrt(2m), less what the
         * parameters take */
        CHECK(fit->misfit < noise * (1 + 5 / sqrt(2 * m)));
        CHECK(fit->misfit > noise * (1 - 5 / sqrt(2 * m) - 15 / m));
        for (int i = 0; i < 150; i++)
            off += pow(fit->value[i] / truth.value[i] - 1, 2) / 150;
        CHECK(sqrt(off) < 0.6 * noise);
        CHECK(fit->modulus.infinity >= 0);
        for (int k = 0; k < fit->modulus.nterms; k++)
            CHECK(fit->modulus.term[k].modulus > 0 && fit->modulus.term[k].time > 0 &&
                  (k == 0 || fit->modulus.term[k].time > fit->modulus.term[k - 1].time));
        ph_prony_fit_free(&fit);
        /* the true standard deviations instead of an unknown one: the same picture */
        static double sd[POINTS], loss_sd[POINTS];
        for (int i = 0; i < 150; i++) {
            sd[i] = noise * truth.value[i];
            loss_sd[i] = noise * truth.loss[i];
        }
        s.data.value_sd = sd;
        if (kind == PH_PRONY_DYNAMIC) s.data.loss_sd = loss_sd;
        fit = fit_of(&s.data, NULL);
        CHECK(fit->misfit > 1 - 5 / sqrt(2 * m) - 15 / m);
        CHECK(fit->misfit < 1 + 5 / sqrt(2 * m));
        ph_prony_fit_free(&fit);
    }
    CHECK_END();
}

/* A chosen number of terms: no more than that, and the misfit falls with the number. */
static void test_chosen_number(void **state)
{
    (void)state;
    sample s;
    set_series(&s, 0.35, 5, five_times, five_moduli);
    measure(&s, PH_PRONY_RELAXATION, 90, 1e-5, 1e5);
    double before = INFINITY;
    for (int n = 1; n <= 5; n++) {
        ph_prony_fit *fit = fit_of(&s.data, &(ph_prony_fit_params){.terms = n});
        CHECK(fit->modulus.nterms == n && fit->misfit < 0.7 * before);
        CHECK(fit->step[fit->nsteps - 1].terms == n);
        before = fit->misfit;
        ph_prony_fit_free(&fit);
    }
    CHECK(before < 1e-8);
    CHECK_END();
}

/* ---- creep */

/* Carson transforms */
static double carson_of_series(double infinity, int n, const ph_modulus_term *t, double s)
{
    double sum = infinity;
    for (int k = 0; k < n; k++)
        sum += t[k].modulus * s * t[k].time / (1 + s * t[k].time);
    return sum;
}

static double carson_of_creep(double J0, int n, const ph_modulus_term *t, double fluidity,
                              double s)
{
    double sum = J0 + fluidity / s;
    for (int k = 0; k < n; k++)
        sum += t[k].modulus / (1 + s * t[k].time);
    return sum;
}

/* J(s) M(s) = 1 for any compliance, over 24 decades. */
static void test_creep_and_modulus_are_inverse(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    uint64_t seed = check_seed();
    for (int trial = 0; trial < check_trials(100); trial++) {
        ph_modulus_term r[TERMS], m[TERMS + 1];
        int n = (int)check_uniform(&seed, 0, TERMS), count = -1;
        double J0 = pow(10, check_uniform(&seed, -3, 3)), infinity = -1;
        double fluidity = trial % 2 ? pow(10, check_uniform(&seed, -12, 12)) : 0;
        for (int k = 0; k < n; k++)
            r[k] = (ph_modulus_term){.time = pow(10, check_uniform(&seed, -12, 12)),
                                     .modulus = pow(10, check_uniform(&seed, -8, 3))};
        CHECK_OK(ph_modulus_of_creep(J0, n, r, fluidity, &infinity, &count, m, &err));
        CHECK(count == n + (fluidity > 0));
        CHECK((infinity == 0) == (fluidity > 0));
        for (int k = 0; k < count; k++)
            CHECK(m[k].modulus > 0 && m[k].time > 0 &&
                  (k == 0 || m[k].time > m[k - 1].time));
        for (int e = -14; e <= 14; e++) {
            double s = pow(10, e);
            double J = carson_of_creep(J0, n, r, fluidity, s);
            CHECK_ABS(J * carson_of_series(infinity, count, m, s), 1, 1e-9);
        }
    }
    CHECK_END();
}

/* The tensor route of perihom/prony.h inverts the other way: the circle closes. */
static void test_against_the_tensor_route(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    ph_sym4 one = {.n = 3};
    ph_prony_term term[5];
    ph_prony *p = NULL;
    ph_creep *creep = NULL;
    for (int i = 0; i < 3; i++)
        one.m[i][i] = 1;
    for (int fluid = 0; fluid < 2; fluid++) {
        sample s;
        set_series(&s, fluid ? 0 : 0.35, 5, five_times, five_moduli);
        for (int k = 0; k < 5; k++) {
            term[k] = (ph_prony_term){.time = five_times[k], .stiffness = one};
            for (int i = 0; i < 3; i++)
                term[k].stiffness.m[i][i] = five_moduli[k];
        }
        ph_sym4 rest = one;
        for (int i = 0; i < 3; i++)
            rest.m[i][i] = s.modulus.infinity;
        CHECK_OK(ph_prony_new(&rest, 5, term, &p, &err));
        CHECK_OK(ph_prony_creep(p, &creep, &err));
        ph_modulus_term r[16], m[17];
        ph_modulus back = {.nterms = -1, .term = m};
        int n = 0;
        for (int k = 0; creep && k < creep->nterms && n < 16; k++) {
            /* the tensor route gives a term for each of the three directions */
            double J = creep->term[k].stiffness.m[0][0];
            if (J < 1e-12) continue;
            if (n > 0 && fabs(creep->term[k].time / r[n - 1].time - 1) < 1e-9)
                r[n - 1].modulus += J;
            else
                r[n++] = (ph_modulus_term){.time = creep->term[k].time, .modulus = J};
        }
        if (creep)
            CHECK_OK(ph_modulus_of_creep(creep->instantaneous.m[0][0], n, r,
                                         creep->fluidity.m[0][0], &back.infinity,
                                         &back.nterms, m, &err));
        check_series(&back, &s.modulus, 1e-8);
        ph_creep_free(&creep);
        ph_prony_free(&p);
    }
    CHECK_END();
}

/* Creep data of a known compliance give the series of moduli whose inverse they are. */
static void test_creep_data(void **state)
{
    (void)state;
    static const ph_modulus_term r[] = {{0.02, 0.4}, {1.7, 0.9}, {130, 0.35}};
    ph_error err = PH_ERROR_INIT;
    for (int fluid = 0; fluid < 2; fluid++) {
        const double J0 = 0.5, fluidity = fluid ? 0.002 : 0;
        double t[100], J[100];
        for (int i = 0; i < 100; i++) {
            t[i] = 1e-4 * pow(10, 7 * i / 99.0);
            J[i] = J0 + fluidity * t[i];
            for (int k = 0; k < 3; k++)
                J[i] += r[k].modulus * (1 - exp(-t[i] / r[k].time));
        }
        const ph_prony_data data = {.kind = PH_PRONY_CREEP, .n = 100, .x = t, .value = J};
        ph_modulus_term m[4];
        ph_modulus want = {.term = m};
        CHECK_OK(ph_modulus_of_creep(J0, 3, r, fluidity, &want.infinity, &want.nterms, m,
                                     &err));
        ph_prony_fit *fit = fit_of(&data, NULL);
        check_series(&fit->modulus, &want, 1e-6);
        CHECK_REL(fit->instantaneous, J0, 1e-6);
        CHECK_ABS(fit->fluidity, fluidity, 1e-8);
        for (int i = 0; i < 100; i++)
            CHECK_REL(fit->value[i], J[i], 1e-8);
        ph_prony_fit_free(&fit);
    }
    CHECK_END();
}

/* ---- input */

/* Order and repetition of points do not matter. */
static void test_order_and_repetition(void **state)
{
    (void)state;
    sample s;
    set_series(&s, 0.35, 5, five_times, five_moduli);
    measure(&s, PH_PRONY_RELAXATION, 80, 1e-5, 1e5);
    ph_prony_fit *one = fit_of(&s.data, &(ph_prony_fit_params){.per_decade = 1});
    double x[160], y[160];
    for (int i = 0; i < 160; i++) {
        x[i] = s.x[(37 * i) % 80];
        y[i] = s.value[(37 * i) % 80];
    }
    const ph_prony_data twice = {.n = 160, .x = x, .value = y};
    ph_prony_fit *two = fit_of(&twice, &(ph_prony_fit_params){.per_decade = 1});
    check_series(&two->modulus, &one->modulus, 1e-10);
    ph_prony_fit_free(&one);
    ph_prony_fit_free(&two);
    CHECK_END();
}

static void check_bad(const ph_prony_data *d, const ph_prony_fit_params *p,
                      ph_status want, const char *says)
{
    ph_error err = PH_ERROR_INIT;
    ph_prony_fit *fit = NULL;
    CHECK(ph_prony_fit_new(d, p, &fit, &err) == want && fit == NULL);
    if (!strstr(err.msg, says)) {
        print_error("'%s' does not say '%s'\n", err.msg, says);
        CHECK(false);
    }
}

static void test_bad_data(void **state)
{
    (void)state;
    double x[] = {1, 2, 3, 4}, y[] = {4, 3, 2, 1}, loss[] = {1, 1, 1, 1};
    ph_prony_data d = {.n = 4, .x = x, .value = y};
    d.n = 1;
    check_bad(&d, NULL, PH_EINVAL, "1 points: needs 3");
    d.n = 0;
    check_bad(&d, NULL, PH_EINVAL, "0 points");
    d.n = 4;
    x[1] = 0;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 2: time 0");
    x[1] = NAN;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 2: time nan");
    x[1] = 2;
    y[2] = -2;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 3: modulus -2");
    y[2] = INFINITY;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 3: modulus inf");
    y[2] = 2;
    d.value = NULL;
    check_bad(&d, NULL, PH_EINVAL, "values are missing");
    d = (ph_prony_data){.kind = PH_PRONY_DYNAMIC, .n = 4, .x = x, .value = y};
    check_bad(&d, NULL, PH_EINVAL, "need a loss modulus");
    d.loss = loss;
    loss[3] = 0;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 4: loss modulus 0 has no relative error");
    loss[3] = -1;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 4: loss modulus -1");
    loss[3] = 1;
    d.value_sd = y;
    check_bad(&d, NULL, PH_EINVAL, "of both moduli or of none");
    d = (ph_prony_data){.n = 4, .x = x, .value = y, .value_sd = loss};
    loss[0] = 0;
    check_bad(&d, NULL, PH_EUNPHYSICAL, "point 1: standard deviation 0");
    d = (ph_prony_data){.kind = (ph_prony_kind)5, .n = 4, .x = x, .value = y};
    check_bad(&d, NULL, PH_EINVAL, "unknown kind of data 5");
    /* compliance that is pure flow: no instantaneous part */
    d = (ph_prony_data){.kind = PH_PRONY_CREEP, .n = 4, .x = x, .value = x};
    check_bad(&d, NULL, PH_ESINGULAR, "do not begin early enough");
    CHECK_END();
}

static void test_bad_parameters(void **state)
{
    (void)state;
    const double x[] = {1, 2, 3}, twice[] = {1, 1}, negative[] = {-1};
    const double late[] = {20, 30, 40}; /* no power of 10^10 is near */
    const ph_prony_data d = {.n = 3, .x = late, .value = x};
    const struct {
        ph_prony_fit_params p;
        const char *says;
    } bad[] = {
        {{.terms = -1}, "-1 terms"},
        {{.terms = PH_PRONY_FIT_TERMS + 1}, "41 terms: 1 to 40"},
        {{.per_decade = -1}, "-1 times per decade"},
        {{.per_decade = NAN}, "times per decade"},
        {{.per_decade = 0.1}, "none lies in the range"},
        {{.ntimes = 2, .times = twice}, "time 1 is given twice"},
        {{.ntimes = 1, .times = negative}, "given time -1"},
        {{.ntimes = 1}, "1 given times"},
        {{.ntimes = 1, .times = x, .terms = 2}, "exclude each other"},
        {{.rest = (ph_prony_rest)9}, "unknown choice 9"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_bad(&d, &bad[i].p, PH_EINVAL, bad[i].says);
    CHECK_END();
}

/* Constant, rising and few data: something sensible, never a crash. */
static void test_odd_data(void **state)
{
    (void)state;
    const double x[] = {1, 2, 3, 5, 8}, flat[] = {2, 2, 2, 2, 2};
    const double rising[] = {1, 2, 3, 4, 5};
    ph_prony_fit *fit = fit_of(&(ph_prony_data){.n = 5, .x = x, .value = flat}, NULL);
    CHECK(fit->modulus.nterms == 0);
    CHECK_ABS(fit->modulus.infinity, 2, 1e-13);
    ph_prony_fit_free(&fit);
    fit = fit_of(&(ph_prony_data){.n = 5, .x = x, .value = rising}, NULL);
    CHECK(fit->modulus.nterms == 0 && fit->modulus.infinity > 1 && fit->misfit > 0.3);
    ph_prony_fit_free(&fit);
    fit = fit_of(&(ph_prony_data){.n = 5, .x = x, .value = flat},
                 &(ph_prony_fit_params){.rest = PH_PRONY_FLUID, .terms = 1});
    CHECK(fit->modulus.infinity == 0 && fit->modulus.nterms == 1);
    ph_prony_fit_free(&fit);
    ph_prony_fit_free(NULL);
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid_is_exact),
        cmocka_unit_test(test_sought_times_are_found),
        cmocka_unit_test(test_dynamic_agrees_with_relaxation),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_chosen_number),
        cmocka_unit_test(test_creep_and_modulus_are_inverse),
        cmocka_unit_test(test_against_the_tensor_route),
        cmocka_unit_test(test_creep_data),
        cmocka_unit_test(test_order_and_repetition),
        cmocka_unit_test(test_bad_data),
        cmocka_unit_test(test_bad_parameters),
        cmocka_unit_test(test_odd_data),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
