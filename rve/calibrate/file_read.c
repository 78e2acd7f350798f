/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calibration files. */
#include "calibrate/file.h"
#include "campaign/campaign.h"
#include "io/read_file.h"

#include <math.h>
#include <perihom_campaign.h>
#include <string.h>

static const char *const root_keys[] = {"calibration", "title",  "case",      "unknowns",
                                        "data",        "budget", "posterior", "starts"};
static const char *const unknown_keys[] = {"from",  "to",   "scale",
                                           "start", "name", "also"};
static const char *const scale_names[] = {"linear", "log"};
static const char *const budget_keys[] = {"relative_error", "at_least", "realisations",
                                          "seconds"};
static const char *const posterior_keys[] = {"samples", "seed"};
enum { MAX_FILE = 1 << 26 };

void ph_fit_file_free(ph_fit_file **file)
{
    if (!file || !*file) return;
    for (size_t i = 0; i < (*file)->nsets && (*file)->sets; i++)
        free((*file)->sets[i]);
    free((*file)->sets);
    free((*file)->case_text);
    ph_case_free(&(*file)->base);
    free((*file)->place);
    free((*file)->line);
    free((*file)->measurement);
    free(*file);
    *file = NULL;
}

/* The last word of a key path, unless another unknown has it too. */
static void name_unknowns(ph_fit_file *f)
{
    for (int j = 0; j < f->nunknowns; j++) {
        if (f->unknown[j].name[0]) continue;
        const char *dot = strrchr(f->unknown_key[j], '.');
        const char *last = dot ? dot + 1 : f->unknown_key[j];
        bool alone = true;
        for (int i = 0; i < f->nunknowns; i++) {
            const char *other = strrchr(f->unknown_key[i], '.');
            if (i != j && strcmp(other ? other + 1 : f->unknown_key[i], last) == 0)
                alone = false;
        }
        snprintf(f->unknown[j].name, sizeof f->unknown[j].name, "%.120s",
                 alone ? last : f->unknown_key[j]);
    }
}

static bool read_limits(ph_i_reader *r, const ph_i_node *map, ph_fit_unknown *x)
{
    static const char rule[] = "must be a number (at most 1e60)";
    const ph_i_node *from = ph_i_need(r, map, "from", "where the range begins"),
                    *to = ph_i_need(r, map, "to", "where the range ends"),
                    *scale = ph_i_get(map, "scale"), *start = ph_i_get(map, "start");
    x->start = NAN;
    if (!from || !to || !ph_i_read_number(r, from, -1e60, 1e60, rule, &x->from) ||
        !ph_i_read_number(r, to, -1e60, 1e60, rule, &x->to))
        return false;
    if (scale) {
        int which = ph_i_read_name(r, scale, (ph_i_names)PH_I_NAMES(scale_names));
        if (which < 0) return false;
        x->log = which == 1;
    }
    if (!(x->from < x->to)) {
        ph_i_reject(r, to, PH_EINVAL, "must be larger than from, %g", x->from);
        return false;
    }
    if (x->log && !(x->from > 0)) {
        ph_i_reject(r, from, PH_EINVAL, "must be > 0 with scale: log");
        return false;
    }
    if (!start) return true;
    if (!ph_i_read_number(r, start, -1e60, 1e60, rule, &x->start)) return false;
    if (x->start < x->from || x->start > x->to) {
        ph_i_reject(r, start, PH_EINVAL, "must lie between from and to, %g to %g",
                    x->from, x->to);
        return false;
    }
    return true;
}

/* Is the key already set by unknown 0 .. j - 1, or one of those that go along with them? */
static bool is_taken(const ph_fit_file *f, size_t j, const char *key)
{
    for (size_t i = 0; i < j; i++) {
        if (strcmp(f->unknown_key[i], key) == 0) return true;
        for (int a = 0; a < f->nalso[i]; a++)
            if (strcmp(f->also[i][a], key) == 0) return true;
    }
    return false;
}

/* Further keys of the case that get the same value. */
static bool read_also(ph_i_reader *r, const ph_i_node *list, ph_fit_file *f, size_t j)
{
    static const char rule[] = "must be a list of 1 to 4 keys of the case";
    if (!list) return true;
    if (!ph_i_read_list(r, list, 0, rule)) return false;
    if (list->count < 1 || list->count > PH_FIT_ALSO) {
        ph_i_reject(r, list, PH_EINVAL, "%s", rule);
        return false;
    }
    for (size_t i = 0; i < list->count; i++) {
        if (!ph_i_read_text(r, list->child[i], PH_FIT_KEY, f->also[j][i])) return false;
        if (strchr(f->also[j][i], '=') || !f->also[j][i][0]) {
            ph_i_reject(r, list->child[i], PH_EINVAL, "must be a key path of the case");
            return false;
        }
        if (strcmp(f->also[j][i], f->unknown_key[j]) == 0 ||
            is_taken(f, j, f->also[j][i])) {
            ph_i_reject(r, list->child[i], PH_EINVAL, "is an unknown already");
            return false;
        }
    }
    f->nalso[j] = (int)list->count;
    return true;
}

static bool read_unknowns(ph_i_reader *r, const ph_i_node *map, ph_fit_file *f)
{
    bool good = true;
    if (!ph_i_read_map(r, map,
                       "must be a map of keys of the case, each with {from, to, "
                       "scale, start}"))
        return false;
    if (map->count < 1 || map->count > PH_FIT_UNKNOWNS) {
        ph_i_complain(r, map, PH_EINVAL, "%zu unknowns: must be 1 to %d", map->count,
                      PH_FIT_UNKNOWNS);
        return false;
    }
    for (size_t j = 0; j < map->count; j++) {
        const ph_i_node *node = map->child[j], *name;
        ph_fit_unknown *x = &f->unknown[j];
        if (strlen(node->key) >= PH_FIT_KEY || strchr(node->key, '=')) {
            ph_i_complain(r, node, PH_EINVAL, "must be a key path of the case");
            good = false;
            continue;
        }
        snprintf(f->unknown_key[j], PH_FIT_KEY, "%s", node->key);
        if (is_taken(f, j, node->key)) {
            ph_i_complain(r, node, PH_EINVAL, "goes along with another unknown (also)");
            good = false;
        }
        if (!ph_i_read_map(r, node,
                           "must be a map such as {from: 0.01, to: 100, scale: log}")) {
            good = false;
            continue;
        }
        ph_i_check_keys(r, node, (ph_i_names)PH_I_NAMES(unknown_keys), "an unknown");
        good &= read_limits(r, node, x);
        good &= read_also(r, ph_i_get(node, "also"), f, j);
        name = ph_i_get(node, "name");
        if (name) good &= ph_i_read_text(r, name, sizeof x->name, x->name);
        for (size_t i = 0; name && i < j; i++)
            if (x->name[0] && strcmp(f->unknown[i].name, x->name) == 0) {
                ph_i_reject(r, name, PH_EINVAL, "is the name of another unknown");
                good = false;
            }
    }
    f->nunknowns = (int)map->count;
    if (good) name_unknowns(f);
    return good;
}

static void read_budget(ph_i_reader *r, const ph_i_node *map, ph_fit_params *p)
{
    static const char many[] = "must be an integer from 1 to 1000000";
    const ph_i_node *node;
    int64_t n;
    if (!map || !ph_i_read_map(r, map, "must be a map such as {relative_error: 0.01}"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(budget_keys), "budget");
    if ((node = ph_i_get(map, "relative_error")))
        ph_i_read_number(r, node, 0, 1, "must be a number between 0 and 1",
                         &p->relative_error);
    if ((node = ph_i_get(map, "realisations")) &&
        ph_i_read_integer(r, node, 1, 1000000, many, &n))
        p->at_most = (int)n;
    if ((node = ph_i_get(map, "at_least"))) {
        int64_t most = p->at_most ? p->at_most : 1000000;
        if (ph_i_read_integer(
                r, node, 1, most,
                "must be an integer from 1 to the realisations of the budget", &n))
            p->at_least = (int)n;
    }
    if ((node = ph_i_get(map, "seconds")))
        ph_i_read_number(r, node, 0, 1e9, "must be a number of seconds > 0", &p->seconds);
}

static void read_posterior(ph_i_reader *r, const ph_i_node *map, ph_fit_params *p)
{
    const ph_i_node *node;
    int64_t n;
    p->seed = 1;
    if (!map || !ph_i_read_map(r, map, "must be a map such as {samples: 2000}")) return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(posterior_keys), "posterior");
    node = ph_i_need(r, map, "samples", "how many");
    if (node && ph_i_read_integer(r, node, 1, 1000000,
                                  "must be an integer from 1 to 1000000", &n))
        p->samples = (int)n;
    if ((node = ph_i_get(map, "seed")) &&
        ph_i_read_integer(r, node, 0, (int64_t)1 << 53,
                          "must be an integer from 0 to 2^53", &n))
        p->seed = (uint64_t)n;
}

/* A file beside the calibration, unless its path is absolute. */
static bool read_path(ph_i_reader *r, const ph_i_node *node, const char *folder,
                      char out[1024])
{
    char text[512];
    if (!node || !ph_i_read_text(r, node, sizeof text, text)) return false;
    if (!text[0]) {
        ph_i_reject(r, node, PH_EINVAL, "must be the name of a file");
        return false;
    }
    snprintf(out, 1024, "%s%s%s", text[0] == '/' ? "" : folder, text[0] == '/' ? "" : "/",
             text);
    return true;
}

static ph_status read_root(ph_i_reader *r, const ph_i_node *root, ph_fit_file *f,
                           ph_error *err)
{
    ph_status st = PH_OK;
    static const char version[] = "must be 1, the version of the format";
    char folder[512];
    int64_t n;
    ph_i_folder_of(f->path, folder, sizeof folder);
    if (!ph_i_read_map(r, root,
                       "a calibration file is a map that begins with calibration: 1"))
        goto out;
    const ph_i_node *node = ph_i_need(r, root, "calibration", version);
    if (!node || !ph_i_read_integer(r, node, 1, 1, version, &n)) goto out;
    ph_i_check_keys(r, root, (ph_i_names)PH_I_NAMES(root_keys), "a calibration");
    if ((node = ph_i_get(root, "title")))
        ph_i_read_text(r, node, sizeof f->title, f->title);
    read_path(r, ph_i_need(r, root, "case", "the case file"), folder, f->case_path);
    node = ph_i_need(r, root, "unknowns", "a map of keys of the case");
    if (node) read_unknowns(r, node, f);
    read_budget(r, ph_i_get(root, "budget"), &f->params);
    read_posterior(r, ph_i_get(root, "posterior"), &f->params);
    if ((node = ph_i_get(root, "starts")) &&
        ph_i_read_integer(r, node, 1, PH_FIT_MINIMA, "must be an integer from 1 to 8",
                          &n))
        f->params.starts = (int)n;
    node = ph_i_need(r, root, "data", "a map such as {file: data.csv, columns: {E1: E}}");
    if (node) PH_TRY(ph_i_fit_read_data(r, node, folder, f, err));
out:
    return st;
}

static ph_status read_calibration(ph_fit_file *f, ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    ph_i_node *root = NULL;
    ph_i_reader r = {.file = f->path, .issues = issues};
    PH_TRY(ph_i_read_file(f->path, MAX_FILE, "calibration file", &text, &length, err));
    PH_TRY(ph_i_tree_parse(&r, text, length, &root, err));
    if (root)
        PH_TRY(read_root(&r, root, f, err));
    else if (issues->count == 0)
        ph_i_complain_line(&r, 0,
                           "the file is empty: a calibration begins with calibration: 1");
    PH_TRY(ph_i_verdict(&r, err));
out:
    ph_i_tree_free(&root);
    free(text);
    return st;
}

/* The case as it is, and with the unknowns at their starts at every point: is it admissible,
 * and does it have the outputs? */
static ph_status read_case(ph_fit_file *f, ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case *c = NULL;
    double start[PH_FIT_UNKNOWNS];
    PH_TRY(ph_i_read_file(f->case_path, MAX_FILE, "case file", &f->case_text,
                          &f->case_length, err));
    PH_TRY(ph_case_parse(f->case_text, f->case_length, f->case_path,
                         (const char *const *)f->sets, f->nsets, &f->base, issues, err));
    for (int j = 0; j < f->nunknowns; j++) {
        const ph_fit_unknown *x = &f->unknown[j];
        start[j] = !isnan(x->start) ? x->start
                   : x->log         ? sqrt(x->from * x->to)
                                    : 0.5 * (x->from + x->to);
    }
    for (int p = 0; p < f->npoints; p++) {
        ph_case_issues_free(issues);
        st = ph_i_fit_case(f, p, start, &c, issues, err);
        if (st != PH_OK) ph_error_prefix(err, "%s:%d: ", f->data_path, f->line[p]);
        PH_TRY(st);
        PH_CHECK(!ph_i_is_open(c), PH_EINVAL, "%s: %s", f->case_path, ph_i_open_words);
        for (int o = 0; o < f->noutputs; o++) {
            st = ph_scenario_admits(c, &f->output[o], err);
            if (st != PH_OK) ph_error_prefix(err, "%s: data.columns: ", f->path);
            PH_TRY(st);
        }
        ph_case_free(&c);
    }
out:
    ph_case_free(&c);
    return st;
}

/* An override of a key that the calibration itself sets would never be seen. */
static ph_status check_sets(const ph_fit_file *f, ph_error *err)
{
    ph_status st = PH_OK;
    for (size_t i = 0; i < f->nsets; i++) {
        char key[PH_FIT_KEY] = "";
        bool own = false;
        size_t n = strcspn(f->sets[i], "=");
        if (n < sizeof key) memcpy(key, f->sets[i], n);
        for (int k = 0; k < f->nkeys; k++)
            own |= strcmp(f->key[k], key) == 0;
        own |= is_taken(f, (size_t)f->nunknowns, key);
        PH_CHECK(!own, PH_EINVAL,
                 "--set %s: the calibration sets this key (unknowns, data.columns)", key);
    }
out:
    return st;
}

static ph_status keep_sets(ph_fit_file *f, const char *const *sets, size_t nsets,
                           ph_error *err)
{
    ph_status st = PH_OK;
    PH_ALLOC(f->sets, nsets, "--set");
    f->nsets = nsets;
    for (size_t i = 0; i < nsets; i++) {
        f->sets[i] = strdup(sets[i]);
        PH_CHECK(f->sets[i], PH_ENOMEM, "no memory for --set");
    }
out:
    return st;
}

ph_status ph_fit_file_read(const char *path, const char *const *sets, size_t nsets,
                           ph_fit_file **out, ph_case_issues *issues, char where[1024],
                           ph_error *err)
{
    PH_GIVEN(path && out && (sets || nsets == 0));
    ph_status st = PH_OK;
    ph_fit_file *f = NULL;
    ph_case_issues own = {0};
    if (!issues) issues = &own;
    if (where) snprintf(where, 1024, "%s", path);
    PH_CHECK(strlen(path) < sizeof f->path, PH_EINVAL, "%.100s...: the path is too long",
             path);
    PH_ALLOC(f, 1, "a calibration");
    snprintf(f->path, sizeof f->path, "%s", path);
    PH_TRY(keep_sets(f, sets, nsets, err));
    PH_TRY(read_calibration(f, issues, err));
    PH_TRY(check_sets(f, err));
    if (where) snprintf(where, 1024, "%s", f->case_path);
    PH_TRY(read_case(f, issues, err));
    *out = f;
    f = NULL;
out:
    ph_case_issues_free(&own);
    ph_fit_file_free(&f);
    return st;
}
