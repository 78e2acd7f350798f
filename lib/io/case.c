/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"
#include "io/read_file.h"

#include <string.h>

enum { MAX_FILE = 1 << 26 };

static const char *const root_keys[] = {
    "perihom", "title",      "units",  "temperature",  "materials", "microstructure",
    "model",   "constraint", "solver", "viscoelastic", "output"};
static const char *const unit_keys[] = {"length", "stress", "time", "temperature"};

void ph_case_free(ph_case **c)
{
    if (!c || !*c) return;
    for (int i = 0; i < (*c)->nmaterials; i++) {
        ph_material_clear(&(*c)->materials[i]);
        if ((*c)->relaxation) ph_i_relaxation_clear(&(*c)->relaxation[i]);
    }
    free((*c)->materials);
    free((*c)->relaxation);
    free((*c)->viscoelastic.times);
    free((*c)->viscoelastic.frequencies);
    ph_history_free(&(*c)->viscoelastic.history);
    free((*c)->inclusions);
    free((*c)->fillers);
    free(*c);
    *c = NULL;
}

static bool read_version(ph_i_reader *r, const ph_i_node *root)
{
    static const char rule[] =
        "must be 1, the version of the format that this program reads";
    int64_t version;
    const ph_i_node *node = ph_i_need(r, root, "perihom", rule);
    return !node || ph_i_read_integer(r, node, 1, 1, rule, &version);
}

static void read_units(ph_i_reader *r, const ph_i_node *root)
{
    ph_case *c = r->c;
    char *const label[] = {c->unit_length, c->unit_stress, c->unit_time};
    const ph_i_node *map = ph_i_get(root, "units");
    for (size_t i = 0; i < 3; i++)
        snprintf(label[i], sizeof c->unit_length, "-");
    if (!map || !ph_i_read_map(r, map, "must be a map such as {length: um, stress: GPa}"))
        return;
    ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(unit_keys), "units");
    for (size_t i = 0; i < 3; i++) {
        const ph_i_node *node = ph_i_get(map, unit_keys[i]);
        if (node) ph_i_read_text(r, node, sizeof c->unit_length, label[i]);
    }
}

static ph_status read_case(ph_i_reader *r, const ph_i_node *root, ph_error *err)
{
    ph_status st = PH_OK;
    if (!ph_i_read_map(r, root, "a case file is a map that begins with perihom: 1") ||
        !read_version(r, root))
        goto out;
    ph_i_check_keys(r, root, (ph_i_names)PH_I_NAMES(root_keys), "a case");
    const ph_i_node *title = ph_i_get(root, "title");
    if (title) ph_i_read_text(r, title, sizeof r->c->title, r->c->title);
    read_units(r, root);
    ph_i_read_temperature(r, root);
    PH_TRY(ph_i_read_materials(r, root, err));
    PH_TRY(ph_i_read_microstructure(r, root, err));
    ph_i_read_model(r, ph_i_get(root, "model"));
    ph_i_take_kappa(r);
    ph_i_read_constraint(r, ph_i_get(root, "constraint"));
    ph_i_read_solver(r, ph_i_get(root, "solver"));
    PH_TRY(ph_i_read_viscoelastic(r, ph_i_get(root, "viscoelastic"), err));
    ph_i_read_output(r, ph_i_get(root, "output"));
out:
    return st;
}

/* Stable: complaints of one line keep their order; insertion sort, they are few and nearly
 * sorted. Those of --set (line 0) come last. */
static void sort_by_line(ph_case_issues *issues)
{
    for (size_t i = 1; i < issues->count; i++) {
        ph_case_issue moved = issues->item[i];
        size_t k = i;
        unsigned line = (unsigned)moved.line - 1u; /* 0 becomes the largest */
        for (; k > 0 && (unsigned)issues->item[k - 1].line - 1u > line; k--)
            issues->item[k] = issues->item[k - 1];
        issues->item[k] = moved;
    }
}

/* What the complaints come to, the first of them in `err`. */
static ph_status verdict(const ph_i_reader *r, ph_error *err)
{
    char text[512];
    if (r->out_of_memory) return PH_FAIL(err, PH_ENOMEM, "no memory for complaints");
    if (r->invalid + r->unphysical == 0) return PH_OK;
    const ph_case_issue *first = r->issues->item;
    while (first->warning)
        first++;
    ph_case_issue_text(first, r->file, text, sizeof text);
    return PH_FAIL(err, r->invalid ? PH_EINVAL : PH_EUNPHYSICAL, "%s", text);
}

/* path and folder of the case; a path that does not fit is refused. */
static bool set_path(ph_case *c, const char *name)
{
    size_t n = strlen(name);
    if (n >= sizeof c->path) return false;
    memcpy(c->path, name, n + 1);
    const char *slash = strrchr(name, '/');
    if (!slash)
        snprintf(c->folder, sizeof c->folder, ".");
    else
        snprintf(c->folder, sizeof c->folder, "%.*s",
                 slash == name ? 1 : (int)(slash - name), name);
    return true;
}

ph_status ph_case_parse(const char *text, size_t length, const char *name,
                        const char *const *sets, size_t nsets, ph_case **out,
                        ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    ph_case_issues own = {0};
    ph_i_node *root = NULL;
    ph_i_reader r = {.file = name ? name : "", .issues = issues ? issues : &own};
    *out = NULL;
    PH_ALLOC(r.c, 1, "a case");
    PH_CHECK(set_path(r.c, r.file), PH_EINVAL, "%.100s...: the path is too long", r.file);
    PH_TRY(ph_i_tree_parse(&r, text, length, &root, err));
    if (r.issues->count == 0 && (!root || ph_i_is_null(root))) {
        ph_i_tree_free(&root);
        ph_i_complain_line(&r, 0, "the file is empty: a case begins with perihom: 1");
    }
    for (size_t i = 0; root && i < nsets; i++)
        PH_TRY(ph_i_tree_set(&r, &root, sets[i], err));
    if (root) PH_TRY(read_case(&r, root, err));
    sort_by_line(r.issues);
    PH_TRY(verdict(&r, err));
    *out = r.c;
    r.c = NULL;
out:
    ph_i_tree_free(&root);
    free(r.material_names);
    ph_case_free(&r.c);
    ph_case_issues_free(&own);
    return st;
}

ph_status ph_case_read(const char *path, const char *const *sets, size_t nsets,
                       ph_case **out, ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    *out = NULL;
    PH_TRY(ph_i_read_file(path, MAX_FILE, "case file", &text, &length, err));
    PH_TRY(ph_case_parse(text, length, path, sets, nsets, out, issues, err));
out:
    free(text);
    return st;
}
