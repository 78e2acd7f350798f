/* SPDX-License-Identifier: GPL-3.0-or-later */
/* perihom view: pictures of the phases and fields of a result. */
#include "damage.h"
#include "relaxation.h"
#include "tools.h"
#include "view_steps.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct view_options {
    text_list operands;
    const char *folder, *field, *load;
    int axis;
    bool quiet;
} view_options;

static const option_spec options[] = {
    {'o', "output", "DIR", OPTION_TEXT, offsetof(view_options, folder),
     "beside the result", "where the pictures go"},
    {0, "field", "NAME", OPTION_TEXT, offsetof(view_options, field), "all",
     "phases, damage, stress12, strain11, displacement1 ...; every step"},
    {0, "load", "N", OPTION_TEXT, offsetof(view_options, load), "all",
     "load case: its number 1, 2 ... or its strain 11, 22, 12 ..."},
    {0, "axis", "N", OPTION_INTEGER, offsetof(view_options, axis), "3",
     "3D: normal of the middle slice, 1, 2 or 3"},
    {'q', "quiet", NULL, OPTION_FLAG, offsetof(view_options, quiet), NULL,
     "do not print the paths of the pictures"},
};

static const verb_spec view_verb = {
    .name = "view",
    .title = "pictures (PNG) of the phases, fields and curves of a result",
    .operands = "RESULT",
    .operands_min = 1,
    .operands_max = 1,
    .operands_offset = offsetof(view_options, operands),
    .example = {{"perihom view boron-aluminium-results", "every picture there is"},
                {"perihom view boron-aluminium-results --field von_mises --load 11",
                 "one field of one load case"},
                {"perihom view rve.h5 --field phases --axis 1 -o pictures",
                 "a slice of the phases, into another folder"}},
    .options = options,
    .noptions = sizeof options / sizeof *options,
    .more = "RESULT is a result folder or its .h5 file (output: {fields: true}); of a "
            "case that "
            "relaxes\n"
            "the folder's curves are drawn too. Prints the paths.\n"
            "exit codes: 0 done, 2 usage, 3 no such field, 5 file or memory",
};

/* ---- the file of a result ---- */

static bool ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

/* The .h5 file of RESULT: itself, or the only one of the folder (fields.h5 before others). */
static int find_file(const char *result, char *path, size_t size)
{
    struct stat about;
    if (stat(result, &about) != 0) return talk("'%s': %s", result, strerror(errno)), 5;
    snprintf(path, size, "%s", result);
    if (!S_ISDIR(about.st_mode)) return 0;
    snprintf(path, size, "%s/fields.h5", result);
    if (stat(path, &about) == 0) return 0;
    DIR *dir = opendir(result);
    int found = 0;
    for (struct dirent *entry; dir && (entry = readdir(dir));)
        if (ends_with(entry->d_name, ".h5") && found++ == 0)
            snprintf(path, size, "%s/%s", result, entry->d_name);
    if (dir) closedir(dir);
    if (found == 1) return 0;
    fprintf(stderr, "perihom view: '%s' holds %s\n", result,
            found ? "several .h5 files: name one"
                  : "no .h5 file: run with --set output.fields=true for one");
    return 5;
}

/* ---- drawing ---- */

typedef struct view {
    const view_options *options;
    const ph_fields_file *file;
    const char *folder, *path; /* of the pictures, of the file */
    double *derived;           /* [cells] */
    int drawn;
} view;

static const char *voigt_name(int n, int a)
{
    static const char *const names[2][6] = {{"11", "22", "12"},
                                            {"11", "22", "33", "23", "13", "12"}};
    return names[n == 6][a];
}

/* The path of picture `name`; false if it is too long. */
static bool picture_path(const view *v, const char *name, char *path, size_t size)
{
    return (size_t)snprintf(path, size, "%s/%s.png", v->folder, name) < size;
}

static ph_status draw_phases(view *v, ph_error *err)
{
    char path[4200];
    if (!picture_path(v, "phases", path, sizeof path)) return PH_EIO;
    ph_status st =
        ph_write_phases_png(path, v->file->micro, v->options->axis, v->file->title, err);
    if (st != PH_OK) return st;
    v->drawn++;
    if (!v->options->quiet) puts(path);
    return PH_OK;
}

/* One field of a load, if it was asked for. */
static ph_status draw_field(view *v, const ph_fields *f, const char *field,
                            const double *value, const char *unit, ph_error *err)
{
    char name[64], path[4200], title[400];
    const char *load = voigt_name(f->ns, f->load);
    if (v->options->field && strcmp(v->options->field, field) != 0) return PH_OK;
    snprintf(name, sizeof name, "%s-load%s", field, load);
    snprintf(title, sizeof title, "%s%s%s%s under strain %s", field, unit[0] ? " [" : "",
             unit, unit[0] ? "]" : "", load);
    if (!picture_path(v, name, path, sizeof path)) return PH_EIO;
    ph_status st =
        ph_write_png(path, &v->file->micro->grid, value, v->options->axis, title, err);
    if (st != PH_OK) return st;
    v->drawn++;
    if (!v->options->quiet) puts(path);
    return PH_OK;
}

/* sqrt(3/2 s:s) of the deviator. Plane stress has no stress 33; under plane strain it is not
 * in the file, and there is no von Mises stress then. */
static bool von_mises(const view *v, const ph_fields *f)
{
    const ph_grid *g = &v->file->micro->grid;
    size_t cells = (size_t)ph_grid_cells(g);
    if (!f->stress || g->kinematics == PH_PLANE_STRAIN) return false;
    for (size_t x = 0; x < cells; x++) {
        double s[6] = {0};
        for (int a = 0; a < f->ns; a++)
            s[f->ns == 6 || a < 2 ? a : 5] = f->stress[(size_t)a * cells + x];
        double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
        v->derived[x] = sqrt(0.5 * (a * a + b * b + c * c) +
                             3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    }
    return true;
}

static ph_status draw_load(view *v, const ph_fields *f, ph_error *err)
{
    ph_status st = PH_OK;
    size_t cells = (size_t)ph_grid_cells(&v->file->micro->grid);
    char name[32];
    const struct {
        const char *kind, *unit;
        const double *value;
        int n;
    } set[] = {{"stress", v->file->unit_stress, f->stress, f->ns},
               {"strain", "", f->strain, f->ns},
               {"displacement", v->file->unit_length, f->displacement, f->nu}};
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < set[k].n && set[k].value && st == PH_OK; a++) {
            if (k == 2)
                snprintf(name, sizeof name, "displacement%d", a + 1);
            else
                snprintf(name, sizeof name, "%s%s", set[k].kind, voigt_name(f->ns, a));
            st = draw_field(v, f, name, set[k].value + (size_t)a * cells, set[k].unit,
                            err);
        }
    if (st == PH_OK && von_mises(v, f))
        st = draw_field(v, f, "von_mises", v->derived, v->file->unit_stress, err);
    return st;
}

/* Bits of the loads that `text` names: a number 1.. or a strain 11.. ; 0 if none. */
static unsigned load_mask(const char *text, int n)
{
    if (!text) return ~0u;
    for (int a = 0; a < n; a++) {
        char number[8];
        snprintf(number, sizeof number, "%d", a + 1);
        if (strcmp(text, number) == 0 || strcmp(text, voigt_name(n, a)) == 0)
            return 1u << a;
    }
    return 0;
}

static int draw_all(view *v, ph_error *err)
{
    const view_options *o = v->options;
    int n = ph_strains(v->file->micro->grid.kinematics);
    unsigned mask = load_mask(o->load, n);
    ph_status st = PH_OK;
    if (!mask)
        return options_usage_error(&view_verb, "--load is 1 to %d or a strain, got '%s'",
                                   n, o->load);
    if (!o->field || strcmp(o->field, "phases") == 0) st = draw_phases(v, err);
    for (int i = 0; i < v->file->nfields && st == PH_OK; i++)
        if (mask >> v->file->fields[i].load & 1u)
            st = draw_load(v, &v->file->fields[i], err);
    const view_steps_request steps = {.path = v->path,
                                      .folder = v->folder,
                                      .field = o->field,
                                      .loads = mask,
                                      .axis = o->axis,
                                      .quiet = o->quiet,
                                      .drawn = &v->drawn};
    if (st == PH_OK) st = view_steps(&steps, v->file, err);
    if (st != PH_OK) return talk_error(err);
    if (v->drawn > 0) return 0;
    talk("no field '%s'%s%s in this result", o->field, o->load ? " of load " : "",
         o->load ? o->load : "");
    return 3;
}

/* The folder of a path, "." where it names none. */
static void folder_of(const char *path, char *folder, size_t size)
{
    snprintf(folder, size, "%s", path);
    char *slash = strrchr(folder, '/');
    if (!slash)
        snprintf(folder, size, ".");
    else
        slash[slash == folder] = 0;
}

static int draw_file(const view_options *o, const char *path, const char *folder)
{
    ph_fields_file *file = NULL;
    ph_error err = PH_ERROR_INIT;
    bool fields = !o->field || strcmp(o->field, "phases") != 0;
    if (ph_read_fields(path, fields ? ~0u : 0, &file, &err) != PH_OK)
        return talk_error(&err);
    view v = {.options = o, .file = file, .folder = folder, .path = path};
    int code = 5;
    v.derived = malloc((size_t)ph_grid_cells(&file->micro->grid) * sizeof(double));
    if (v.derived)
        code = draw_all(&v, &err);
    else
        talk("no memory for the von Mises stress");
    free(v.derived);
    ph_fields_file_free(&file);
    return code;
}

static bool has_fields(const char *result)
{
    char path[4096];
    struct stat about;
    snprintf(path, sizeof path, "%s/fields.h5", result);
    return stat(path, &about) == 0;
}

/* The curves of a folder of a case that relaxes or cracks, unless one field was asked for. */
static int draw_curves(const view_options *o, int *drawn)
{
    ph_error err = PH_ERROR_INIT;
    const char *result = o->operands.item[0];
    struct stat about;
    if (o->field || o->load || stat(result, &about) != 0 || !S_ISDIR(about.st_mode))
        return 0;
    ph_status st =
        relaxation_view(result, o->folder ? o->folder : result, o->quiet, drawn, &err);
    if (st == PH_OK)
        st = damage_view(result, o->folder ? o->folder : result, o->quiet, drawn, &err);
    return st == PH_OK ? 0 : talk_error(&err);
}

int cmd_view(int argc, char **argv)
{
    view_options o = {.axis = 0};
    char path[4096], folder[4096];
    int curves = 0;
    int code = options_parse(&view_verb, argc, argv, &o);
    if (code >= 0) goto out;
    if (o.axis == 0) o.axis = 3;
    if (o.axis > 3) {
        code = options_usage_error(&view_verb, "--axis is 1, 2 or 3, got %d", o.axis);
        goto out;
    }
    code = 5;
    if (o.folder && mkdir(o.folder, 0777) != 0 && errno != EEXIST) {
        talk("'%s': %s", o.folder, strerror(errno));
        goto out;
    }
    if ((code = draw_curves(&o, &curves))) goto out;
    if (curves > 0 && !has_fields(o.operands.item[0])) goto out;
    if ((code = find_file(o.operands.item[0], path, sizeof path))) goto out;
    folder_of(path, folder, sizeof folder);
    code = draw_file(&o, path, o.folder ? o.folder : folder);
out:
    free(o.operands.item);
    return code;
}
