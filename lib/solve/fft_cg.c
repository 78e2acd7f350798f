/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conjugate gradients with the homogeneous medium as preconditioner. Periodic: the vectors
 * stay in Fourier space, where the preconditioner is a product. Held nodes: the vectors are
 * fields, and both the operator and the preconditioner are masked. */
#include "solve/solver.h"

#include <math.h>
#include <string.h>

typedef struct fft_cg {
    ph_operator *op;
    ph_meter *meter;
    const uint8_t *fixed; /* NULL: vectors in Fourier space */
    ph_green green;
    ph_space space;
    double *x, *r, *p, *q;
    bool shares_q;        /* q is the operator's */
    double *hat;          /* held nodes: [nd][modes] complex */
    ph_sym4 free;         /* preconditioner of a free mean strain */
    double size;          /* and what it is multiplied by in a vector; */
    double before[6];     /* what it was, */
    ph_sym4 mean;         /* mean stiffness, */
    double tolerance;     /* at that strain */
    ph_cg_report *report; /* of the load */
} fft_cg;

static void apply_hat(void *self, const double *p, double *q)
{
    ph_i_operator_apply_hat(((fft_cg *)self)->op, p, q);
}

static void precondition_hat(void *self, const double *r, double *z)
{
    ph_i_green_apply(&((fft_cg *)self)->green, r, z);
}

static void mask(const fft_cg *s, double *u)
{
    const ph_layout *l = &s->op->layout;
    for (int a = 0; a < l->nd; a++)
#pragma omp parallel for num_threads(s->op->threads) schedule(static)
        for (ptrdiff_t x = 0; x < l->cells; x++)
            if (s->fixed[x]) u[a * l->cells + x] = 0.0;
}

static void apply_masked(void *self, const double *p, double *q)
{
    fft_cg *s = self;
    ph_i_operator_apply(s->op, p, q);
    mask(s, q);
}

static void precondition_masked(void *self, const double *r, double *z)
{
    fft_cg *s = self;
    ph_i_operator_forward(s->op, r, s->hat);
    ph_i_green_apply(&s->green, s->hat, s->hat);
    ph_i_operator_backward(s->op, s->hat, s->hat, z);
    mask(s, z);
}

void ph_i_fft_cg_free(void **state)
{
    fft_cg *s = *state;
    if (!s) return;
    size_t n = ph_i_space_size(&s->space);
    ph_i_doubles_free(s->meter, &s->x, n);
    ph_i_doubles_free(s->meter, &s->r, n);
    ph_i_doubles_free(s->meter, &s->p, n);
    if (!s->shares_q) ph_i_doubles_free(s->meter, &s->q, n);
    ph_i_doubles_free(s->meter, &s->hat, (size_t)(2 * s->op->layout.nd * s->op->modes));
    ph_i_green_clear(&s->green, s->meter);
    ph_i_space_clear(&s->space);
    free(s);
    *state = NULL;
}

/* Families that a crack has cut on one side see the modes which whole families leave to (S).
 * The reference medium must not be much softer for these than the damaged nodes are: it has
 * at least this coefficient of (S), whatever the operator has. Measured, docs/theory/cracks.md:
 * between 0.3 and 1 the iterations are the fewest, for operators of 0.1 and of 0.01. */
static const double reference_alpha = 0.5;

static double reference_factor(const ph_system *system)
{
    const ph_operator_params *p = system->params;
    bool few = p->broken && p->stabilisation == PH_STABILISE_SPECTRAL && p->value > 0.0;
    return few && p->value < reference_alpha ? reference_alpha / p->value : 1.0;
}

ph_status ph_i_reference_green(const ph_system *system, ph_green *green, double *storage,
                               ph_error *err)
{
    ph_operator *op = system->op;
    double factor = op->stabilise;
    ph_i_operator_stabilise(op, factor * reference_factor(system));
    ph_status st = ph_i_green_init(green, op, &op->map->middle, storage, err);
    ph_i_operator_stabilise(op, factor);
    return st;
}

ph_status ph_i_fft_cg_init(const ph_system *system, void **state, ph_error *err)
{
    ph_status st = PH_OK;
    fft_cg *s = NULL;
    void *self = NULL;
    PH_ALLOC(s, 1, "the solver");
    self = s;
    s->op = system->op;
    s->meter = system->meter;
    s->fixed = system->setting->fixed;
    PH_TRY(ph_i_space_init(&s->space, &s->op->layout, s->fixed ? NULL : s->op->fft,
                           s->op->threads, err));
    PH_TRY(ph_i_reference_green(system, &s->green, NULL, err));
    size_t n = ph_i_space_size(&s->space);
    PH_DOUBLES(s->x, s->meter, n, "the solution");
    PH_DOUBLES(s->r, s->meter, n, "the residual");
    PH_DOUBLES(s->p, s->meter, n, "the direction");
    /* The operator's transformed field is free while the iteration runs, and as large. */
    s->shares_q = !s->fixed && s->op->hat;
    if (s->shares_q)
        s->q = s->op->hat;
    else
        PH_DOUBLES(s->q, s->meter, n, "the product");
    if (s->fixed) PH_TRY(ph_i_operator_in_space(s->op, err));
    if (s->fixed)
        PH_DOUBLES(s->hat, s->meter, (size_t)(2 * s->op->layout.nd * s->op->modes),
                   "the transformed residual");
    *state = self;
    self = NULL;
out:
    ph_i_fft_cg_free(&self);
    return st;
}

void ph_i_fft_cg_parts(void *state, ph_linear *system, double *vector[4])
{
    fft_cg *s = state;
    *system = (ph_linear){&s->space, s, s->fixed ? apply_masked : apply_hat,
                          s->fixed ? precondition_masked : precondition_hat};
    double *const own[4] = {s->x, s->r, s->p, s->q};
    memcpy(vector, own, sizeof own);
}

void ph_i_fft_cg_enter(void *state, const double *load, double *r)
{
    fft_cg *s = state;
    const ph_layout *l = &s->op->layout;
    if (s->fixed) {
        memcpy(r, load, sizeof(double) * (size_t)(l->nd * l->cells));
        mask(s, r);
        return;
    }
    ph_i_operator_forward(s->op, load, r);
    for (int a = 0; a < l->nd; a++) /* the mean force is round-off */
        r[2 * a * s->op->modes] = r[2 * a * s->op->modes + 1] = 0.0;
}

static void enter_guess(fft_cg *s, const double *u, double *x)
{
    const ph_layout *l = &s->op->layout;
    if (s->fixed)
        memcpy(x, u, sizeof(double) * (size_t)(l->nd * l->cells));
    else
        ph_i_operator_forward(s->op, u, x);
}

void ph_i_fft_cg_leave(void *state, const double *x, double *work, double *u)
{
    fft_cg *s = state;
    const ph_layout *l = &s->op->layout;
    if (s->fixed)
        memcpy(u, x, sizeof(double) * (size_t)(l->nd * l->cells));
    else
        ph_i_operator_backward(s->op, x, work, u);
}

ph_status ph_i_fft_cg_solve(void *state, const double *load, double *u,
                            ph_cg_report *report, ph_error *err)
{
    ph_linear system;
    double *v[4];
    ph_i_fft_cg_parts(state, &system, v);
    ph_i_fft_cg_enter(state, load, v[1]);
    if (report->guessed) enter_guess(state, u, v[0]);
    /* Products of unnormalised transforms are so many times those of the fields. */
    const fft_cg *s = state;
    double scale = s->fixed ? 1.0 : (double)s->op->layout.cells;
    report->energy_most *= scale;
    report->energy_start *= scale;
    ph_status st = ph_i_cg(&system, v[0], v[1], v[2], v[3], report, err);
    report->energy_most /= scale;
    report->energy_start /= scale;
    report->energy /= scale;
    report->energy_left /= scale;
    ph_i_fft_cg_leave(state, v[0], v[3], u);
    return st;
}

/* ---- a mean strain that is free ---------------------------------------------------------- */

/* The energy 1/2 a(strain + grad u) is convex in both, so that conjugate gradients find both
 * at once. No displacement is there at wave number zero: the 2 nd numbers of that mode hold the
 * mean strain, ns <= 2 nd of them, times cells x spacing, as an unnormalised transform of a
 * displacement that grows with it would be. Its residual is the mean stress over the spacing. */
static double *mean_place(const fft_cg *s, double *hat, int i)
{
    return hat + 2 * (i / 2) * s->op->modes + i % 2;
}

static void take_mean(const fft_cg *s, double *hat, double *mean)
{
    for (int i = 0; i < s->op->layout.ns; i++)
        mean[i] = *mean_place(s, hat, i);
    for (int a = 0; a < s->op->layout.nd; a++)
        hat[2 * a * s->op->modes] = hat[2 * a * s->op->modes + 1] = 0.0;
}

static void put_mean(const fft_cg *s, const double *mean, double *hat)
{
    for (int i = 0; i < s->op->layout.ns; i++)
        *mean_place(s, hat, i) = mean[i];
}

static void apply_free(void *self, const double *direction, double *q)
{
    fft_cg *s = self;
    const int ns = s->op->layout.ns;
    double *p =
        s->p; /* it is `direction`, the only vector that the iteration applies to */
    double held[6], strain[6], stress[6], waste[6];
    (void)direction;
    take_mean(s, p, held);
    for (int i = 0; i < ns; i++)
        strain[i] = held[i] / s->size;
    ph_i_operator_apply_mean(s->op, p, strain, q, stress);
    put_mean(s, held, p);
    double scale = (double)s->op->layout.cells / s->size;
    for (int i = 0; i < ns; i++)
        stress[i] *= scale;
    take_mean(s, q, waste);
    put_mean(s, stress, q);
}

/* Its square is a stiffness over the mean stiffness: below 1e-12 it is round-off. */
static const double most_growth = 1e6;

/* So many times the load is that of the strain which is found: a cell with a few stiff cells has
 * a stiff mean, but strains. */
static double growth(const fft_cg *s)
{
    const int ns = s->op->layout.ns;
    double now[6], was = 0.0, is = 0.0;
    for (int i = 0; i < ns; i++)
        now[i] = s->before[i] + *mean_place(s, s->x, i) / s->size;
    for (int i = 0; i < ns; i++)
        for (int j = 0; j < ns; j++) {
            was += s->before[i] * s->mean.m[i][j] * s->before[j];
            is += now[i] * s->mean.m[i][j] * now[j];
        }
    return sqrt(is / was);
}

static void precondition_free(void *self, const double *r, double *z)
{
    fft_cg *s = self;
    const int ns = s->op->layout.ns;
    double mean[6];
    s->report->tolerance = s->tolerance * growth(s);
    for (int i = 0; i < ns; i++) {
        mean[i] = 0.0;
        for (int j = 0; j < ns; j++)
            mean[i] += s->free.m[i][j] * r[2 * (j / 2) * s->op->modes + j % 2];
    }
    ph_i_green_apply(&s->green, r, z);
    put_mean(s, mean, z);
}

/* The mode of wave number zero of a uniform strain: cells x its mean stiffness. */
static ph_status prepare_free(fft_cg *s, ph_error *err)
{
    ph_status st = PH_OK;
    const ph_layout *l = &s->op->layout;
    double cells = (double)l->cells, least = INFINITY;
    ph_sym4 inverse;
    s->mean = ph_i_stiffness_map_mean(s->op->map);
    for (int d = 0; d < 3; d++)
        if (l->axis[d] >= 0) least = fmin(least, l->h[d]);
    PH_TRY(ph_sym4_inverse(&s->mean, &inverse, err));
    s->size = cells * least;
    s->free = ph_sym4_combine(least * least, &inverse, 0.0, &inverse);
out:
    return st;
}

ph_status ph_i_fft_cg_solve_free(void *state, const double *load, double *u,
                                 double *strain, ph_cg_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    fft_cg *s = state;
    double found[6];
    PH_TRY(prepare_free(s, err));
    memcpy(s->before, strain, sizeof(double) * (size_t)s->op->layout.ns);
    s->report = report;
    s->tolerance = report->tolerance;
    const ph_linear system = {&s->space, s, apply_free, precondition_free};
    ph_i_fft_cg_enter(s, load, s->r);
    st = ph_i_cg(&system, s->x, s->r, s->p, s->q, report, err);
    double grown = growth(s);
    report->residual /= grown;
    report->tolerance = s->tolerance;
    if (st == PH_OK && !(grown < most_growth))
        st = ph_i_give_up(PH_ESINGULAR, report, "nothing bears this stress", err);
    take_mean(s, s->x, found);
    for (int i = 0; i < s->op->layout.ns; i++)
        strain[i] += found[i] / s->size;
    ph_i_fft_cg_leave(s, s->x, s->q, u);
out:
    return st;
}

const char *ph_i_fft_cg_refuses(const ph_system *system)
{
    return system->one_sided ? "families cut at the faces are no convolution" : NULL;
}
