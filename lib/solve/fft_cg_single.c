/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fft_cg with vectors, transforms and kernel in single precision, for periodic cells whose
 * points see only their own cell. All its fields but one lie in the work fields of the
 * operator, which single precision halves. A residual that floats cannot reach is come to by
 * iterative refinement [Wilkinson1963]: the residual of the sum so far in double, a
 * correction in single; that takes four fields more in double. */
#include "solve/solver.h"

#include <math.h>
#include <string.h>

/* What a solution in floats is good for; below it the residual is refined. Measured:
 * docs/theory/solvers.md. */
static const double single_limit = PH_SINGLE_LIMIT;
/* A correction lowers the residual by so much, or to the tolerance. */
static const double correction = 1e-4;
enum { CORRECTIONS = 12 };
/* Of stiffness over the spacing: what a float can hold, and room for sums and contrasts. */
enum { DECADES = 25 };

typedef struct single {
    ph_operator *op;
    ph_meter *meter;
    double force; /* unit of the forces in floats */
    ph_fft_single *fft;
    ph_space space;
    float *green; /* packed as ph_green, at the beginning of the doubles it came in */
    double *green_doubles;
    size_t green_size; /* doubles that are left of it */
    double *pair;      /* room of two half spectra where the operator has none, or NULL */
    double *sum, *wanted; /* refinement: the solution, the load [nd][cells]; or NULL */
    float *x, *r, *p, *q; /* half spectra */
    float *u, *f;         /* fields */
} single;

static size_t vector_size(const single *s) /* floats of a half spectrum */
{
    return (size_t)(2 * s->op->layout.nd * s->op->modes);
}

static size_t field_size(const single *s)
{
    return (size_t)(s->op->layout.nd * s->op->layout.cells);
}

/* ---- the system ------------------------------------------------------------------------- */

static void forward(single *s, const float *u, float *hat)
{
    const ph_layout *l = &s->op->layout;
    s->op->ffts += l->nd;
    for (int a = 0; a < l->nd; a++)
        ph_i_fft_forward_single(s->fft, u + a * l->cells, hat + 2 * a * s->op->modes);
}

static void backward(single *s, const float *hat, float *work, float *u)
{
    const ph_layout *l = &s->op->layout;
    s->op->ffts += l->nd;
    for (int a = 0; a < l->nd; a++)
        ph_i_fft_backward_single(s->fft, hat + 2 * a * s->op->modes,
                                 work + 2 * a * s->op->modes, u + a * l->cells);
}

static void apply(void *self, const float *p, float *q)
{
    single *s = self;
    const ph_operator *op = s->op;
    const double factor = op->stabilise;
    s->op->applications++;
    backward(s, p, q, s->u);
    ph_i_cells_apply_single(&op->cells, s->u, NULL,
                            1.0 / (s->force * (double)op->layout.cells), s->f);
    forward(s, s->f, q);
    if (!op->spectral || factor == 0.0) return;
    for (int a = 0; a < op->layout.nd; a++) {
        const float *from = p + 2 * a * op->modes;
        float *to = q + 2 * a * op->modes;
#pragma omp parallel for num_threads(op->threads) schedule(static, PH_CHUNK)
        for (ptrdiff_t k = 0; k < op->modes; k++) {
            float share = (float)(factor / s->force * op->spectral[k]);
            to[2 * k] += share * from[2 * k];
            to[2 * k + 1] += share * from[2 * k + 1];
        }
    }
}

/* One real factor for the two parts of each complex number: four modes at a time. */
typedef float oct __attribute__((vector_size(32), aligned(4), may_alias));

static inline oct twice(const float *a)
{
    return (oct){a[0], a[0], a[1], a[1], a[2], a[2], a[3], a[3]};
}

static inline oct at(const float *a)
{
    return *(const oct *)a;
}

/* Modes k .. k + 3. */
static inline void precondition_four(const single *s, ptrdiff_t k, const float *r,
                                     float *z)
{
    const ptrdiff_t n = s->op->modes;
    const float *g = s->green + k; /* 00 11 22 12 02 01, or 00 11 01 */
    oct r0 = at(r + 2 * k), r1 = at(r + 2 * (k + n));
    if (s->op->layout.nd == 2) {
        oct off = twice(g + 2 * n);
        *(oct *)(z + 2 * k) = twice(g) * r0 + off * r1;
        *(oct *)(z + 2 * (k + n)) = off * r0 + twice(g + n) * r1;
        return;
    }
    oct r2 = at(r + 2 * (k + 2 * n));
    oct g12 = twice(g + 3 * n), g02 = twice(g + 4 * n), g01 = twice(g + 5 * n);
    *(oct *)(z + 2 * k) = twice(g) * r0 + g01 * r1 + g02 * r2;
    *(oct *)(z + 2 * (k + n)) = g01 * r0 + twice(g + n) * r1 + g12 * r2;
    *(oct *)(z + 2 * (k + 2 * n)) = g02 * r0 + g12 * r1 + twice(g + 2 * n) * r2;
}

static void precondition_one(const single *s, ptrdiff_t k, const float *r, float *z)
{
    static const int place3[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    static const int place2[2][2] = {{0, 2}, {2, 1}};
    const ptrdiff_t n = s->op->modes;
    const int nd = s->op->layout.nd;
    for (int part = 0; part < 2; part++)
        for (int i = 0; i < nd; i++) {
            float sum = 0.0F;
            for (int j = 0; j < nd; j++)
                sum += s->green[(nd == 3 ? place3[i][j] : place2[i][j]) * n + k] *
                       r[2 * (j * n + k) + part];
            z[2 * (i * n + k) + part] = sum;
        }
}

static void precondition(void *self, const float *r, float *z)
{
    const single *s = self;
    const ptrdiff_t n = s->op->modes;
#pragma omp parallel for num_threads(s->op->threads) schedule(static, PH_CHUNK)
    for (ptrdiff_t k = 0; k < n / 4; k++)
        precondition_four(s, 4 * k, r, z);
    for (ptrdiff_t k = n / 4 * 4; k < n; k++)
        precondition_one(s, k, r, z);
}

/* ---- set up ------------------------------------------------------------------------------ */

const char *ph_i_fft_cg_single_refuses(const ph_system *system)
{
    if (system->setting->fixed || system->setting->source || system->one_sided)
        return "it takes constraint periodic";
    if (!ph_i_operator_by_cells(system->params))
        return "it takes points stress with their smallest family, or model local";
    return NULL;
}

void ph_i_fft_cg_single_free(void **state)
{
    single *s = *state;
    if (!s) return;
    ph_i_doubles_free(s->meter, &s->green_doubles, s->green_size);
    ph_i_doubles_free(s->meter, &s->pair, vector_size(s));
    ph_i_doubles_free(s->meter, &s->sum, field_size(s));
    ph_i_doubles_free(s->meter, &s->wanted, field_size(s));
    ph_i_fft_free_single(&s->fft);
    ph_i_space_clear(&s->space);
    free(s);
    *state = NULL;
}

/* In units of its largest entry, so that none is beyond a float. It is made in double where
 * the residual and the product will be, which is as large or larger. */
static ph_status round_green(single *s, const ph_system *system, ph_error *err)
{
    ph_status st = PH_OK;
    ph_green green = {0};
    double *room = s->op->hat ? s->op->hat : s->pair, top = 0.0;
    PH_TRY(ph_i_reference_green(system, &green, room, err));
    size_t n = (size_t)(green.nd * (green.nd + 1) / 2 * green.modes);
    s->green_size = (n + 1) / 2;
    PH_DOUBLES(s->green_doubles, s->meter, s->green_size, "the preconditioner");
    s->green = (float *)s->green_doubles;
    for (size_t k = 0; k < n; k++)
        top = fmax(top, fabs(room[k]));
    for (size_t k = 0; k < n; k++)
        s->green[k] = (float)(top > 0.0 ? room[k] / top : 0.0);
out:
    return st;
}

/* Floats hold forces over that of a unit displacement of a corner; stresses on the way there
 * have to be in range. */
static ph_status find_force(single *s, ph_error *err)
{
    ph_status st = PH_OK;
    double per_length = 0.0, stiff = ph_sym4_norm(&s->op->map->middle);
    for (int d = 0; d < 3; d++)
        per_length = fmax(per_length, s->op->cells.f[d]);
    s->force = per_length > 0.0 ? stiff * per_length * per_length : 1.0;
    PH_CHECK(per_length == 0.0 || fabs(log10(stiff * per_length)) < DECADES, PH_EINVAL,
             "stiffness over the spacing is %.2g, beyond single precision: choose other "
             "units",
             stiff * per_length);
out:
    return st;
}

ph_status ph_i_fft_cg_single_init(const ph_system *system, void **state, ph_error *err)
{
    ph_status st = PH_OK;
    single *s = NULL;
    void *self = NULL;
    PH_ALLOC(s, 1, "the solver");
    self = s;
    s->op = system->op;
    s->meter = system->meter;
    PH_TRY(find_force(s, err));
    PH_TRY(ph_i_fft_new_single(&s->op->layout, s->op->threads, &s->fft, err));
    PH_TRY(ph_i_space_init(&s->space, &s->op->layout, s->op->fft, s->op->threads, err));
    if (!s->op->hat)
        PH_DOUBLES(s->pair, s->meter, vector_size(s), "two transformed fields");
    PH_TRY(round_green(s, system, err));
    PH_TRY(ph_i_operator_widen(s->op, vector_size(s), err)); /* as doubles, room of two */
    s->r = (float *)(s->op->hat ? s->op->hat : s->pair);
    s->q = s->r + vector_size(s);
    s->x = (float *)s->op->u;
    s->p = s->x + vector_size(s);
    s->u = (float *)s->op->f;
    s->f = s->u + field_size(s);
    *state = self;
    self = NULL;
out:
    ph_i_fft_cg_single_free(&self);
    return st;
}

/* ---- solve ------------------------------------------------------------------------------- */

static double norm_of(const single *s, const double *load)
{
    double sum = 0.0;
    for (size_t x = 0; x < field_size(s); x++)
        sum += load[x] * load[x];
    return sqrt(sum);
}

/* A load over its norm, transformed, without its mean. The field passes through op->u, since
 * `load` may be op->f. */
static void enter(single *s, const double *load, double size)
{
    const ph_layout *l = &s->op->layout;
    float *field = (float *)s->op->u;
    s->op->ffts += l->nd;
    for (int a = 0; a < l->nd; a++) {
        for (ptrdiff_t x = 0; x < l->cells; x++)
            field[x] = (float)(load[a * l->cells + x] / size);
        ph_i_fft_forward_single(s->fft, field, s->r + 2 * a * s->op->modes);
        s->r[2 * a * s->op->modes] = s->r[2 * a * s->op->modes + 1] = 0.0F;
    }
}

/* Solve for s->r; the solution as a field in s->u. */
static ph_status solve_once(single *s, ph_cg_report *report, ph_error *err)
{
    const ph_linear_single system = {&s->space, s, apply, precondition};
    ph_status st = ph_i_cg_single(&system, s->x, s->r, s->p, s->q, report, err);
    backward(s, s->x, s->q, s->u);
    return st;
}

/* What the field of an unnormalised transform counts, for a load of norm `size`. */
static double unit(const single *s, double size)
{
    return size / (s->force * (double)s->op->layout.cells);
}

/* r = wanted - A sum, in op->f. */
static void residual(single *s)
{
    ph_i_operator_apply(s->op, s->sum, s->op->f);
    for (size_t x = 0; x < field_size(s); x++)
        s->op->f[x] = s->wanted[x] - s->op->f[x];
}

static ph_status refine(single *s, const double *load, ph_cg_report *report,
                        ph_error *err)
{
    ph_status st = PH_OK;
    size_t n = field_size(s), bytes = n * sizeof(double);
    double size = norm_of(s, load), left = size;
    if (!s->sum) PH_DOUBLES(s->sum, s->meter, n, "the solution in double precision");
    if (!s->wanted) PH_DOUBLES(s->wanted, s->meter, n, "the load in double precision");
    PH_TRY(ph_i_operator_in_space(s->op, err));
    memcpy(s->wanted, load, bytes);
    memset(s->sum, 0, bytes);
    report->iterations = 0;
    report->residual = 1.0;
    for (int k = 0; k < CORRECTIONS && report->residual > report->tolerance; k++) {
        ph_cg_report inner = *report;
        inner.tolerance = fmax(correction, 0.5 * report->tolerance / report->residual);
        inner.max_iterations = report->max_iterations - report->iterations;
        enter(s, k ? s->op->f : s->wanted, left);
        st = solve_once(s, &inner, err);
        report->iterations += inner.iterations;
        if (st == PH_ECANCELLED) return st;
        for (size_t x = 0; x < n; x++)
            s->sum[x] += unit(s, left) * (double)s->u[x];
        residual(s);
        double now = norm_of(s, s->op->f);
        report->residual = now / size;
        if (st != PH_OK || !(now < 0.5 * left)) break;
        left = now;
    }
    if (st == PH_OK && report->residual > report->tolerance)
        st = ph_i_give_up(PH_ENOCONV, report,
                          "corrections in single precision no longer help", err);
out:
    return st;
}

ph_status ph_i_fft_cg_single_solve(void *state, const double *load, double *u,
                                   ph_cg_report *report, ph_error *err)
{
    ph_status st = PH_OK;
    single *s = state;
    report->guessed = false;
    /* Energies of scaled floats bound nothing: the tolerance alone decides. */
    report->least = report->energy_most = report->energy_share = 0.0;
    report->look_back = 0;
    if (report->tolerance < single_limit) {
        st = refine(s, load, report, err);
        if (s->sum) memcpy(u, s->sum, field_size(s) * sizeof(double));
        return st;
    }
    double size = norm_of(s, load);
    enter(s, load, size);
    st = solve_once(s, report, err);
    for (size_t x = 0; x < field_size(s); x++)
        u[x] = unit(s, size) * (double)s->u[x];
    return st;
}
