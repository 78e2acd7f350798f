/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report.h"

#include <perihom/error_bar.h>

#include "damage.h"
#include "failure.h"

#include <math.h>
#include <string.h>

const char *report_bytes(size_t bytes, char text[32])
{
    static const char *const unit[] = {"B", "kB", "MB", "GB", "TB"};
    double value = (double)bytes;
    int i = 0;
    for (; value >= 999.5 && i < 4; i++)
        value /= 1000;
    snprintf(text, 32, i ? "%.3g %s" : "%.0f %s", value, unit[i]);
    return text;
}

const char *report_seconds(double seconds, char text[32])
{
    if (seconds < 120)
        snprintf(text, 32, "%.2g s", seconds);
    else if (seconds < 7200)
        snprintf(text, 32, "%.0f min", seconds / 60);
    else
        snprintf(text, 32, "%.1f h", seconds / 3600);
    return text;
}

const char *report_kinematics(ph_kinematics kin)
{
    switch (kin) {
    case PH_SPACE:
        return "3D";
    case PH_GENERALISED_STRAIN:
        return "generalised plane strain";
    case PH_PLANE_STRAIN:
        return "plane strain";
    case PH_PLANE_STRESS:
        return "plane stress";
    }
    return "";
}

static void put_head(FILE *to, const ph_case *c, const ph_result *r)
{
    const ptrdiff_t *n = r->grid.n;
    fprintf(to, "%s\n\n", c->title[0] ? c->title : c->path);
    fprintf(to, "RVE         %td x %td", n[0], n[1]);
    if (r->grid.kinematics == PH_SPACE) fprintf(to, " x %td", n[2]);
    fprintf(to, " nodes, %s, %s\n", report_kinematics(r->grid.kinematics), r->constraint);
    fprintf(to, "model       %s", r->model);
    if (r->points == PH_POINTS_STRESS) fprintf(to, " on stress points");
    if (r->horizon > 0) fprintf(to, ", horizon %.4g %s", r->horizon, c->unit_length);
    fprintf(to, "\nphases      ");
    for (int i = 0; i < r->nmaterials; i++)
        fprintf(to, "%s%s %.4f", i ? ", " : "", r->names[i], r->fractions[i]);
    fputc('\n', to);
}

/* A row of the table; what is NaN is left out, a row without value is not printed. */
static void put_constant(FILE *to, const ph_result *r, const char *name, double value,
                         const char *unit, double lower, double upper)
{
    if (isnan(value)) return;
    const ph_error_constant *x =
        r->error_bar ? ph_error_bar_find(r->error_bar, name) : NULL;
    char bar[32] = "";
    if (x && !isnan(x->bar)) snprintf(bar, sizeof bar, "+- %.2g", 100 * x->bar);
    fprintf(to, "  %-5s %12.5g", name, value);
    if (!isnan(upper))
        fprintf(to, "  %-6s  %-9s  %9.5g .. %.5g", unit, bar, isnan(lower) ? 0.0 : lower,
                upper);
    else if (bar[0])
        fprintf(to, "  %-6s  %s", "", bar);
    fputc('\n', to);
}

static ph_engineering constants_or_nan(const ph_sym4 *c)
{
    ph_engineering e;
    if (ph_engineering_constants(c, &e, NULL) == PH_OK) return e;
    e = (ph_engineering){{NAN, NAN, NAN}, {{0}}, NAN, NAN, NAN};
    for (int i = 0; i < 9; i++)
        e.nu[i / 3][i % 3] = NAN;
    return e;
}

static void put_engineering(FILE *to, const char *stress, const ph_result *r)
{
    const ph_engineering e = constants_or_nan(&r->stiffness);
    const ph_engineering up = constants_or_nan(&r->voigt);
    const ph_engineering low = constants_or_nan(&r->reuss);
    if (isnan(e.E[0])) {
        fprintf(to, "\nno engineering constants: the stiffness has no inverse\n");
        return;
    }
    fprintf(to, "\nengineering constants       %s       Reuss .. Voigt\n",
            r->error_bar ? "+- [%]" : "      ");
    for (int i = 0; i < 3; i++)
        put_constant(to, r, (char[]){'E', (char)('1' + i), 0}, e.E[i], stress, low.E[i],
                     up.E[i]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i != j)
                put_constant(to, r,
                             (char[]){'n', 'u', (char)('1' + i), (char)('1' + j), 0},
                             e.nu[i][j], "", NAN, NAN);
    put_constant(to, r, "G23", e.G23, stress, low.G23, up.G23);
    put_constant(to, r, "G13", e.G13, stress, low.G13, up.G13);
    put_constant(to, r, "G12", e.G12, stress, low.G12, up.G12);
    const ph_isotropic iso = ph_nearest_isotropic(&r->stiffness, r->grid.kinematics);
    fprintf(to, "  nearest isotropic: E %.5g %s, nu %.4f; distance %.2g\n", iso.E, stress,
            iso.nu, iso.distance);
}

static void put_stiffness(FILE *to, const char *stress, const ph_result *r)
{
    int n = r->stiffness.n;
    double voigt[36];
    ph_sym4_to_voigt(&r->stiffness, true, voigt);
    double largest = 0;
    for (int i = 0; i < n * n; i++)
        largest = fmax(largest, fabs(voigt[i]));
    fprintf(to, "\nstiffness [%s], Voigt %s, engineering shear\n", stress,
            n == 6 ? "11 22 33 23 13 12" : "11 22 12");
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            bool solved = r->loads >> j & 1u; /* else the other index may be, */
            double x = solved ? voigt[i * n + j] : voigt[j * n + i]; /* by symmetry */
            if ((!solved && !(r->loads >> i & 1u)) || isnan(x))
                fprintf(to, " %10s", "-"); /* neither load was asked for */
            else /* round-off beside the large entries is noise */
                fprintf(to, " %10.5g", fabs(x) < 1e-9 * largest ? 0.0 : x);
        }
        fputc('\n', to);
    }
}

/* A part without which there is no bar says why it is not there. */
static void put_no_error_bar(FILE *to, const ph_error_bar *bar)
{
    for (size_t p = 0; bar && p < ph_nerror_parts; p++)
        if (ph_error_parts[p].needed && bar->why[p][0])
            fprintf(to, "note        no error bar: %s\n", bar->why[p]);
}

static void put_solver(FILE *to, const ph_result *r)
{
    char bytes[32], total[32], solve[32];
    double worst = 0;
    const char *single =
        r->precision && strcmp(r->precision, "single") == 0 ? ", single precision" : "";
    fprintf(to, "\nsolver      %s%s%s%s%s; iterations", r->solver ? r->solver : "none",
            r->route ? " (" : "", r->route ? r->route : "", r->route ? single : "",
            r->route ? ")" : "");
    for (int i = 0; i < r->nloads; i++) {
        fprintf(to, " %d", r->iterations[i]);
        worst = fmax(worst, r->residual[i]);
    }
    if (r->unchecked) {
        fprintf(to, "%s\nquality     %s\n", r->converged ? "" : "; NOT CONVERGED",
                r->unchecked);
    } else {
        fprintf(to, "; residual %.1e%s\n", worst, r->converged ? "" : ", NOT CONVERGED");
        fprintf(
            to,
            "quality     Hill-Mandel %.1e, asymmetry %.1e, stabilisation energy %.1e\n",
            r->hill_mandel, r->asymmetry, r->stabilisation_energy);
    }
    fprintf(to, "cost        %s (solve %s), %s, %d thread%s\n",
            report_seconds(r->seconds, total), report_seconds(r->seconds_solve, solve),
            report_bytes(r->work.peak_bytes, bytes), r->threads,
            r->threads == 1 ? "" : "s");
    for (int i = 0; i < r->nnotes; i++)
        fprintf(to, "note        %s\n", r->notes[i]);
    put_no_error_bar(to, r->error_bar);
}

static void put_constants(FILE *to, const ph_case *c, const ph_result *r)
{
    for (int i = 0; i < c->nconstants; i++) {
        const ph_quantity *q = &c->constants[i];
        ph_error why = PH_ERROR_INIT;
        double x;
        if (ph_quantity_value(q, r, &x, &why) == PH_OK)
            fprintf(to, "%-11s %.6g%s%s\n", q->name, x, q->stress == 1 ? " " : "",
                    q->stress == 1 ? c->unit_stress : "");
        else
            fprintf(to, "%-11s none: %s\n", q->name, why.msg);
    }
}

void report_result(FILE *to, const ph_case *c, const ph_result *result)
{
    unsigned all = (1u << result->stiffness.n) - 1;
    put_head(to, c, result);
    if ((result->loads & all) == all && isfinite(ph_sym4_norm(&result->stiffness)))
        put_engineering(to, c->unit_stress, result);
    put_constants(to, c, result);
    if (result->loads) put_stiffness(to, c->unit_stress, result);
    if (result->damage) damage_print(to, c->unit_length, result->damage);
    if (result->failure) failure_print(to, c, result->failure);
    put_solver(to, result);
}
