/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "damage.h"

#include <perihom/damage_law.h>
#include <perihom/plot.h>
#include <perihom/table.h>

#include "check.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

void damage_print(FILE *to, const char *length, const ph_damage *d)
{
    int axes = d->pristine.n == 6 ? 3 : 2;
    bool grows = d->kind == PH_SEQUENCE_GROWTH, loads = d->kind == PH_SEQUENCE_LOADING;
    char head[48];
    snprintf(head, sizeof head, "crack length [%s]", length);
    fprintf(to, "\ndamage\n  %16.32s %9s",
            grows   ? head
            : loads ? "load"
                    : "step",
            "density");
    for (int n = 0; n < axes; n++)
        fprintf(to, "   E%d/E%d(0)", n + 1, n + 1);
    fprintf(to, " %10s %8s %12s\n", "anisotropy", "mean phi", "broken bonds");
    for (int i = 0; i < d->nsteps; i++) {
        const ph_damage_step *s = &d->step[i];
        fprintf(to, "  %16.6g %9.5g", grows || loads ? s->value : i + 1.0, s->density);
        for (int n = 0; n < axes; n++)
            fprintf(to, " %10.5f", s->psi[n]);
        fprintf(to, " %10.4g %8.5f %12td", s->anisotropy, s->mean_damage,
                s->broken_bonds);
        if (d->kind == PH_SEQUENCE_DENSITY &&
            fabs(s->density - s->value) > 0.1 * s->value)
            fprintf(to, "  (density asked %g, reached %.5g)", s->value, s->density);
        if (s->mute_nodes) fprintf(to, "  (%td nodes without stress)", s->mute_nodes);
        fputc('\n', to);
    }
}

/* The compact law, where there is one. */
static ph_status write_law(const destination *to, const ph_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    ph_damage_law *law = NULL;
    ph_error why = PH_ERROR_INIT;
    st = ph_damage_law_from_result(r, &law, &why);
    if (st == PH_EINVAL) return PH_OK; /* result.json says why */
    PH_CHECK(st == PH_OK, st, "%s", why.msg);
    PH_TRY(ph_damage_law_to_csv(law, &text, err));
    destination_file(to, "damage-law.csv", path, sizeof path);
    PH_TRY(ph_write_file(path, text, strlen(text), err));
out:
    ph_damage_law_free(&law);
    free(text);
    return st;
}

ph_status damage_write(const destination *to, const ph_result *r, ph_error *err)
{
    ph_status st = PH_OK;
    char path[DESTINATION_PATH + 64], *text = NULL;
    destination_file(to, "damage.png", path, sizeof path);
    PH_TRY(ph_write_png(path, &r->grid, r->damage->field, 3, "damage", err));
    PH_TRY(ph_damage_to_csv(r->damage, &text, err));
    destination_file(to, "damage.csv", path, sizeof path);
    PH_TRY(ph_write_file(path, text, strlen(text), err));
    PH_TRY(write_law(to, r, err));
out:
    free(text);
    return st;
}

/* ---- curves ------------------------------------------------------------------------------ */

static const double *column(const ph_table *t, const char *name)
{
    int i = ph_table_column(t, name);
    return i < 0 ? NULL : t->value + (ptrdiff_t)i * t->nrows;
}

static ph_status draw(const char *folder, const char *name, const ph_plot *plot,
                      bool quiet, int *drawn, ph_error *err)
{
    ph_status st = PH_OK;
    char path[4200];
    PH_CHECK((size_t)snprintf(path, sizeof path, "%s/%s", folder, name) < sizeof path,
             PH_EIO, "the path of a picture is too long");
    PH_TRY(ph_plot_write(path, plot, err));
    ++*drawn;
    if (!quiet) puts(path);
out:
    return st;
}

static ph_status draw_table(const ph_table *t, const char *folder, bool quiet, int *drawn,
                            ph_error *err)
{
    ph_status st = PH_OK;
    static const char *const names[] = {"psi1", "psi2", "psi3"};
    static const char *const label[] = {"E1/E1(0)", "E2/E2(0)", "E3/E3(0)"};
    ph_series series[3] = {{0}};
    ph_plot plot = {.xlabel = t->name[0], .ylabel = "E/E(0)", .series = series};
    for (int i = 0; i < 3; i++) {
        const double *y = column(t, names[i]);
        if (!y) continue;
        series[plot.nseries++] = (ph_series){.name = label[i],
                                             .n = t->nrows,
                                             .x = t->value,
                                             .y = y,
                                             .style = PH_PLOT_LINE_POINTS};
    }
    if (plot.nseries > 0)
        PH_TRY(draw(folder, "damage-moduli.png", &plot, quiet, drawn, err));
    series[0] = (ph_series){.n = t->nrows,
                            .x = t->value,
                            .y = column(t, "anisotropy_index"),
                            .style = PH_PLOT_LINE_POINTS};
    plot.nseries = 1;
    plot.ylabel = "anisotropy index";
    if (series[0].y)
        PH_TRY(draw(folder, "damage-anisotropy.png", &plot, quiet, drawn, err));
out:
    return st;
}

ph_status damage_view(const char *result, const char *folder, bool quiet, int *drawn,
                      ph_error *err)
{
    ph_status st = PH_OK;
    char path[4200];
    struct stat about;
    ph_table *t = NULL;
    if ((size_t)snprintf(path, sizeof path, "%s/damage.csv", result) >= sizeof path ||
        stat(path, &about) != 0)
        return PH_OK;
    PH_TRY(ph_table_read(path, &t, err));
    if (t->nrows > 1) st = draw_table(t, folder, quiet, drawn, err);
out:
    ph_table_free(&t);
    return st;
}
