/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/case_internal.h"
#include "io/read_file.h"

#include <string.h>

enum { MAX_FILE = 1 << 26 };

static const char *const root_keys[] = {
    "perihom",  "title",      "units",   "temperature",  "materials", "microstructure",
    "model",    "constraint", "solver",  "viscoelastic", "output",    "cracks",
    "sequence", "failure",    "loading", "error_bar",    "accuracy",  "budget"};
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
    ph_i_cracks_free(*c);
    ph_i_failure_free(*c);
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
    r->automatic = ph_i_get(root, "accuracy") != NULL;
    PH_TRY(ph_i_read_materials(r, root, err));
    PH_TRY(ph_i_read_microstructure(r, root, err));
    ph_i_read_model(r, ph_i_get(root, "model"));
    ph_i_take_kappa(r);
    ph_i_read_constraint(r, ph_i_get(root, "constraint"));
    ph_i_read_solver(r, ph_i_get(root, "solver"));
    PH_TRY(ph_i_read_cracks(r, root, err));
    PH_TRY(ph_i_read_failure(r, root, err));
    PH_TRY(ph_i_read_viscoelastic(r, ph_i_get(root, "viscoelastic"), err));
    ph_i_read_output(r, ph_i_get(root, "output"));
    ph_i_read_error_bar(r, ph_i_get(root, "error_bar"));
    ph_i_read_accuracy(r, root);
out:
    return st;
}

/* path and folder of the case; a path that does not fit is refused. */
static bool set_path(ph_case *c, const char *name)
{
    size_t n = strlen(name);
    if (n >= sizeof c->path) return false;
    memcpy(c->path, name, n + 1);
    ph_i_folder_of(name, c->folder, sizeof c->folder);
    return true;
}

ph_status ph_case_parse(const char *text, size_t length, const char *name,
                        const char *const *sets, size_t nsets, ph_case **out,
                        ph_case_issues *issues, ph_error *err)
{
    PH_GIVEN(text && name && out && (sets || nsets == 0));
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
    PH_TRY(ph_i_verdict(&r, err));
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
    PH_GIVEN(path && out && (sets || nsets == 0));
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
