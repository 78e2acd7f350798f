/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws over the whole catalogue of bounds and estimates, on random composites. */
#include <perihom/estimates.h>

#include "check.h"
#include "tensors.h"

/* A random composite and the memory it needs. */
typedef struct sample {
    ph_composite composite;
    ph_material material[3];
    double fraction[3];
} sample;

static ph_material random_phase(uint64_t *seed, bool isotropic)
{
    ph_error err = PH_ERROR_INIT;
    ph_material m;
    if (isotropic) {
        double E = pow(10, check_uniform(seed, -1.5, 1.5));
        CHECK_OK(
            ph_material_isotropic("i", E, check_uniform(seed, -0.2, 0.45), &m, &err));
    } else {
        double v[36];
        ph_sym4 c = random_stiffness(seed, 6);
        for (int i = 0; i < 6; i++)
            c.m[i][i] += 1;
        ph_sym4_to_voigt(&c, true, v);
        CHECK_OK(ph_material_anisotropic("a", v, NULL, &m, &err));
    }
    return m;
}

static void random_sample(uint64_t *seed, int trial, sample *s)
{
    static const struct {
        ph_inclusion_shape shape;
        ph_kinematics kinematics;
    } kind[] = {
        {PH_SHAPE_SPHERE, PH_SPACE},          {PH_SHAPE_CYLINDER, PH_GENERALISED_STRAIN},
        {PH_SHAPE_CYLINDER, PH_PLANE_STRAIN}, {PH_SHAPE_CYLINDER, PH_PLANE_STRESS},
        {PH_SHAPE_SPHEROID, PH_SPACE},        {PH_SHAPE_LAMINATE, PH_SPACE},
        {PH_SHAPE_LAMINATE, PH_PLANE_STRESS}};
    const int k = trial % 7, n = 2 + (int)(check_random(seed) * 2);
    const bool round =
        kind[k].shape == PH_SHAPE_SPHERE || kind[k].shape == PH_SHAPE_SPHEROID;
    /* anisotropic media of round inclusions cost milliseconds a step: left out here */
    const bool isotropic = round || check_random(seed) < 0.7;
    double sum = 0;
    for (int i = 0; i < n; i++) {
        s->material[i] = random_phase(seed, isotropic);
        sum += s->fraction[i] = check_uniform(seed, 0.05, 1);
    }
    for (int i = 0; i < n; i++)
        s->fraction[i] /= sum;
    if (kind[k].shape != PH_SHAPE_LAMINATE && check_random(seed) < 0.2)
        s->material[n - 1] = ph_material_void("hole");
    s->composite = (ph_composite){n,
                                  s->material,
                                  s->fraction,
                                  kind[k].shape,
                                  pow(10, check_uniform(seed, -1, 1)),
                                  kind[k].kinematics};
}

static const ph_estimate_method *method(const char *name)
{
    for (size_t i = 0; i < ph_nestimate_methods; i++)
        if (strcmp(ph_estimate_methods[i].info.name, name) == 0)
            return &ph_estimate_methods[i];
    fail_msg("no method %s", name);
    return NULL;
}

static bool is(const ph_estimate_method *m, const char *name)
{
    return strcmp(m->info.name, name) == 0;
}

static bool has_void(const ph_composite *c)
{
    return c->material[c->n - 1].is_void && c->fraction[c->n - 1] > 0;
}

/* Evaluate; true where there is a tensor to look at. A refusal must fail as one; only the
 * methods whose answer can vanish or lose its sign may fail otherwise. */
static bool evaluate(const ph_estimate_method *m, const ph_composite *c, ph_sym4 *out)
{
    ph_error err = PH_ERROR_INIT;
    const char *refusal = m->refuses(c);
    ph_status st = m->eval(c, out, &err);
    if (refusal) {
        CHECK(st == PH_EINVAL && strcmp(err.msg, refusal) == 0);
        return false;
    }
    if (st == PH_OK) return true;
    bool may = (is(m, "dilute") && st == PH_EUNPHYSICAL) ||
               (is(m, "self_consistent") && has_void(c) &&
                (st == PH_ESINGULAR || st == PH_ENOCONV));
    CHECK(may);
    if (!may) print_error("%s: %s\n", m->info.name, err.msg);
    return false;
}

/* Symmetric, positive, right size; inside every bound that accepts the composite. */
static void test_symmetric_positive_and_bounded(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    int used[64] = {0};
    assert_true(ph_nestimate_methods <= 64);
    for (int t = 0; t < check_trials(35); t++) {
        sample s;
        random_sample(&seed, t, &s);
        ph_sym4 result[64];
        bool have[64];
        for (size_t i = 0; i < ph_nestimate_methods; i++) {
            const ph_estimate_method *m = &ph_estimate_methods[i];
            have[i] = evaluate(m, &s.composite, &result[i]);
            if (!have[i]) continue;
            used[i]++;
            CHECK(result[i].n == ph_strains(s.composite.kinematics));
            if (m->kind == PH_BOUND_LOWER && has_void(&s.composite))
                CHECK(ph_sym4_norm(&result[i]) == 0.0);
            else
                CHECK(ph_sym4_is_stiffness(&result[i]));
        }
        for (size_t i = 0; i < ph_nestimate_methods; i++)
            for (size_t j = 0; j < ph_nestimate_methods; j++) {
                if (!have[i] || !have[j] || is(&ph_estimate_methods[j], "dilute") ||
                    is(&ph_estimate_methods[i], "dilute"))
                    continue; /* dilute is no bounded estimate: see the counter-example */
                if (ph_estimate_methods[i].kind != PH_BOUND_UPPER ||
                    ph_estimate_methods[j].kind == PH_BOUND_UPPER)
                    if (ph_estimate_methods[i].kind != PH_POINT_ESTIMATE ||
                        ph_estimate_methods[j].kind != PH_BOUND_LOWER)
                        continue;
                /* i above j; iteration and integration are good to 1e-10 */
                CHECK(gap(&result[i], &result[j]) > -1e-9);
                if (gap(&result[i], &result[j]) <= -1e-9)
                    print_error("%s below %s by %g, shape %d kinematics %d\n",
                                ph_estimate_methods[i].info.name,
                                ph_estimate_methods[j].info.name,
                                gap(&result[i], &result[j]), s.composite.shape,
                                s.composite.kinematics);
            }
    }
    for (size_t i = 0; i < ph_nestimate_methods; i++)
        CHECK(used[i] > 1);
    CHECK_END();
}

/* Why dilute is left out above: stiff spheres at 0.6 lie below the lower bound. */
static void test_dilute_leaves_the_bounds(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    sample s = {.fraction = {0.4, 0.6}};
    CHECK_OK(ph_material_isotropic("m", 1, 0.3, &s.material[0], &err));
    CHECK_OK(ph_material_isotropic("i", 100, 0.3, &s.material[1], &err));
    s.composite = (ph_composite){2, s.material, s.fraction, PH_SHAPE_SPHERE, 1, PH_SPACE};
    ph_sym4 dilute, lower;
    CHECK_OK(method("dilute")->eval(&s.composite, &dilute, &err));
    CHECK_OK(method("hashin_shtrikman_lower")->eval(&s.composite, &lower, &err));
    CHECK(gap(&dilute, &lower) < -0.1);
    s.material[1] = ph_material_void("hole");
    CHECK(method("dilute")->eval(&s.composite, &dilute, NULL) == PH_EUNPHYSICAL);
    CHECK_END();
}

static void test_equal_phases_and_pure_ends(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < check_trials(14); t++) {
        sample s;
        random_sample(&seed, t, &s);
        if (has_void(&s.composite)) s.material[s.composite.n - 1] = s.material[0];
        ph_error err = PH_ERROR_INIT;
        ph_sym4 c, want;
        for (size_t i = 0; i < ph_nestimate_methods; i++) {
            const ph_estimate_method *m = &ph_estimate_methods[i];
            sample one = s;
            one.composite.material = one.material;
            one.composite.fraction = one.fraction;
            for (int k = 1; k < 3; k++)
                one.material[k] = one.material[0];
            CHECK_OK(ph_sym4_reduce(&one.material[0].stiffness, one.composite.kinematics,
                                    &want, &err));
            if (evaluate(m, &one.composite, &c))
                CHECK_ABS(difference(&c, &want), 0, 1e-12);
            for (int end = 0; end < 2; end++) {
                one = s;
                one.composite.material = one.material;
                one.composite.fraction = one.fraction;
                for (int k = 0; k < 3; k++)
                    one.fraction[k] = k == end;
                CHECK_OK(ph_sym4_reduce(&one.material[end].stiffness,
                                        one.composite.kinematics, &want, &err));
                if (end == 1 && is(m, "dilute")) continue;
                if (!evaluate(m, &one.composite, &c)) continue;
                CHECK_ABS(difference(&c, &want), 0, 1e-10); /* contrast 1e3 x round-off */
                if (difference(&c, &want) > 1e-10)
                    print_error("%s end %d\n", m->info.name, end);
            }
        }
    }
    CHECK_END();
}

/* Every point estimate starts with the slope of dilute inclusions. */
static void test_dilute_slope(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    const double f = 1e-7;
    for (int t = 0; t < check_trials(14); t++) {
        sample s;
        random_sample(&seed, t, &s);
        ph_error err = PH_ERROR_INIT;
        ph_sym4 c0, slope, c;
        s.fraction[0] = 1 - f;
        for (int k = 1; k < s.composite.n; k++)
            s.fraction[k] = f / (s.composite.n - 1);
        if (!evaluate(method("dilute"), &s.composite, &slope)) continue;
        CHECK_OK(
            ph_sym4_reduce(&s.material[0].stiffness, s.composite.kinematics, &c0, &err));
        slope = ph_sym4_combine(1 / f, &slope, -1 / f, &c0);
        for (size_t i = 0; i < ph_nestimate_methods; i++) {
            const ph_estimate_method *m = &ph_estimate_methods[i];
            if (m->kind != PH_POINT_ESTIMATE || !evaluate(m, &s.composite, &c)) continue;
            c = ph_sym4_combine(1 / f, &c, -1 / f, &c0);
            /* next order: f^(2/3) = 2e-5 (coated spheres), times the contrast of 1e3 at
             * most; iteration 1e-13/f = 1e-6 */
            CHECK_ABS(difference(&c, &slope), 0, 5e-3);
            if (difference(&c, &slope) > 5e-3) print_error("%s\n", m->info.name);
        }
    }
    CHECK_END();
}

/* Hill 1963: isotropic phases of one shear modulus G; exact for every statistically
 * isotropic geometry: sum f/(K_i + 4G/3) = 1/(K + 4G/3). In the plane G instead of 4G/3. */
static void test_equal_shear_moduli(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < check_trials(20); t++) {
        const bool plane = t % 2;
        const double G = check_uniform(&seed, 0.5, 2);
        sample s = {.fraction = {0.3, 0.45, 0.25}};
        double sum = 0, shift = plane ? G : 4 * G / 3;
        const int n = 2 + t / 2 % 2;
        if (n == 2) s.fraction[0] += s.fraction[2];
        for (int i = 0; i < n; i++) {
            double nu = check_uniform(&seed, -0.4, 0.45);
            CHECK_OK(
                ph_material_isotropic("", 2 * G * (1 + nu), nu, &s.material[i], &err));
            double K = 2 * G * (1 + nu) / (3 * (1 - 2 * nu)) + (plane ? G / 3 : 0);
            sum += s.fraction[i] / (K + shift);
        }
        s.composite =
            (ph_composite){n,          s.material,
                           s.fraction, plane ? PH_SHAPE_CYLINDER : PH_SHAPE_SPHERE,
                           1,          plane ? PH_PLANE_STRAIN : PH_SPACE};
        for (size_t i = 0; i < ph_nestimate_methods; i++) {
            const ph_estimate_method *m = &ph_estimate_methods[i];
            ph_sym4 c;
            if (is(m, "voigt") || is(m, "reuss") || is(m, "dilute")) continue;
            if (!evaluate(m, &s.composite, &c)) continue;
            ph_isotropic iso = ph_nearest_isotropic(&c, s.composite.kinematics);
            CHECK_REL(iso.G, G, 1e-10);
            CHECK_REL(iso.K, 1 / sum - shift, 1e-9);
            CHECK_ABS(iso.distance, 0, 1e-12);
        }
    }
    CHECK_END();
}

/* Which methods coincide: Mori-Tanaka in a softest matrix is the lower bound; layers have
 * one exact answer; two well-ordered phases make Walpole Hashin-Shtrikman. */
static void test_coincidences(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    ph_error err = PH_ERROR_INIT;
    for (int t = 0; t < check_trials(14); t++) {
        sample s;
        random_sample(&seed, t, &s);
        s.composite.n = 2;
        s.fraction[0] = 1 - s.fraction[1];
        CHECK_OK(ph_material_isotropic("m", 1, 0.3, &s.material[0], &err));
        CHECK_OK(ph_material_isotropic("i", 8, 0.25, &s.material[1], &err));
        ph_sym4 mt, lower, upper, w;
        CHECK_OK(method("mori_tanaka")->eval(&s.composite, &mt, &err));
        CHECK_OK(method("hashin_shtrikman_lower")->eval(&s.composite, &lower, &err));
        CHECK_OK(method("hashin_shtrikman_upper")->eval(&s.composite, &upper, &err));
        CHECK_ABS(difference(&mt, &lower), 0, 1e-13);
        CHECK_OK(method("walpole_lower")->eval(&s.composite, &w, &err));
        CHECK_ABS(difference(&w, &lower), 0, 1e-13);
        CHECK_OK(method("walpole_upper")->eval(&s.composite, &w, &err));
        CHECK_ABS(difference(&w, &upper), 0, 1e-13);
        if (s.composite.shape != PH_SHAPE_LAMINATE) continue;
        ph_sym4 c1, c2, exact;
        CHECK_OK(
            ph_sym4_reduce(&s.material[0].stiffness, s.composite.kinematics, &c1, &err));
        CHECK_OK(
            ph_sym4_reduce(&s.material[1].stiffness, s.composite.kinematics, &c2, &err));
        CHECK_OK(
            ph_sym4_laminate(&c1, &c2, s.fraction[1], (double[]){1, 0, 0}, &exact, &err));
        static const char *const same[] = {"laminate",        "mori_tanaka",
                                           "self_consistent", "hashin_shtrikman_upper",
                                           "walpole_lower",   "differential"};
        for (int i = 0; i < 6; i++) {
            CHECK_OK(method(same[i])->eval(&s.composite, &w, &err));
            CHECK_ABS(difference(&w, &exact), 0, i == 5 ? 1e-8 : 1e-12);
        }
    }
    CHECK_END();
}

/* Turning phases and axis system together turns the result. */
static void test_rotation_about_the_fibre(void **state)
{
    (void)state;
    uint64_t seed = check_seed();
    for (int t = 0; t < 4; t++) {
        sample s;
        do
            random_sample(&seed, t % 2 ? 0 : 1, &s);
        while (has_void(&s.composite));
        const double w = check_uniform(&seed, 0, 3);
        double R[9] = {cos(w), -sin(w), 0, sin(w), cos(w), 0, 0, 0, 1};
        if (s.composite.shape == PH_SHAPE_SPHERE) random_rotation(&seed, R);
        s.material[0] = random_phase(&seed, true);
        s.material[1] = random_phase(&seed, false);
        sample turned = s;
        turned.composite.material = turned.material;
        turned.composite.fraction = turned.fraction;
        for (int i = 0; i < s.composite.n; i++)
            turned.material[i].stiffness = ph_sym4_rotate(&s.material[i].stiffness, R);
        for (size_t i = 0; i < ph_nestimate_methods; i++) {
            const ph_estimate_method *m = &ph_estimate_methods[i];
            /* these two iterate over anisotropic media, too slow for round shapes */
            bool slow = is(m, "self_consistent") || is(m, "differential");
            if (slow && s.composite.shape == PH_SHAPE_SPHERE) continue;
            ph_sym4 c, other;
            if (!evaluate(m, &s.composite, &c)) continue;
            if (!evaluate(m, &turned.composite, &other)) continue;
            c = ph_sym4_rotate(&c, R);
            CHECK_ABS(difference(&c, &other), 0, 1e-8);
        }
    }
    CHECK_END();
}

static void test_malformed(void **state)
{
    (void)state;
    ph_error err = PH_ERROR_INIT;
    static const double bad[][2] = {{0.5, 0.6}, {1.2, -0.2}, {NAN, 1}};
    sample s;
    CHECK_OK(ph_material_isotropic("m", 1, 0.3, &s.material[0], &err));
    s.material[1] = ph_material_void("hole");
    s.composite =
        (ph_composite){2, s.material, s.fraction, PH_SHAPE_SPHEROID, 2, PH_SPACE};
    for (size_t i = 0; i < ph_nestimate_methods; i++) {
        const ph_estimate_method *m = &ph_estimate_methods[i];
        ph_sym4 c;
        for (int k = 0; k < 3; k++) {
            memcpy(s.fraction, bad[k], sizeof bad[k]);
            CHECK(m->eval(&s.composite, &c, NULL) == PH_EINVAL);
        }
        s.fraction[0] = s.fraction[1] = 0.5;
        ph_composite c2 = s.composite;
        c2.aspect = 0;
        CHECK(is(m, "voigt") || is(m, "reuss") || m->refuses(&c2) != NULL);
        c2.aspect = 1;
        c2.kinematics = PH_PLANE_STRESS;
        CHECK(is(m, "voigt") || is(m, "reuss") || m->refuses(&c2) != NULL);
        c2.n = 0;
        CHECK(m->eval(&c2, &c, NULL) == PH_EINVAL);
    }
    CHECK_END();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_symmetric_positive_and_bounded),
        cmocka_unit_test(test_dilute_leaves_the_bounds),
        cmocka_unit_test(test_equal_phases_and_pure_ends),
        cmocka_unit_test(test_dilute_slope),
        cmocka_unit_test(test_equal_shear_moduli),
        cmocka_unit_test(test_coincidences),
        cmocka_unit_test(test_rotation_about_the_fibre),
        cmocka_unit_test(test_malformed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
