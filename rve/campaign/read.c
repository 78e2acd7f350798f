/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign file and the cases of its points. */
#include "campaign/campaign.h"
#include "io/read_file.h"

#include <string.h>

enum { MAX_FILE = 1 << 26 };

static const char *const root_keys[] = {"campaign", "title",
                                        "case",     "set",
                                        "sweep",    "zip",
                                        "table",    "realisations",
                                        "outputs",  "common_random_numbers",
                                        "data",     "variance_reduction",
                                        "size",     "budget"};

static void free_point(ph_campaign_point *p, int nkeys)
{
    for (int k = 0; p->value && k < nkeys; k++)
        free(p->value[k]);
    free(p->value);
    free(p->number);
    ph_case_free(&p->c);
    for (int m = 1; m < PH_MAX_MODELS; m++)
        ph_case_free(&p->model[m]);
}

void ph_campaign_free(ph_campaign **campaign)
{
    if (!campaign || !*campaign) return;
    ph_campaign *c = *campaign;
    for (int p = 0; c->point && p < c->npoints; p++)
        free_point(&c->point[p], c->nkeys);
    for (int k = 0; c->key && k < c->nkeys; k++)
        free(c->key[k]);
    free(c->point);
    free(c->key);
    free(c->output);
    free(c->cheap);
    ph_i_sizes_free(&c->sizes);
    free(c);
    *campaign = NULL;
}

uint64_t ph_campaign_realisation(const ph_campaign *c, int point, int64_t i)
{
    if (!c) return 0;
    return c->common_random_numbers ? (uint64_t)i : ((uint64_t)point << 32) + (uint64_t)i;
}

void ph_i_path_in(const char *folder, const char *name, char *out, size_t size)
{
    bool bare = name[0] == '/' || folder[0] == 0 || strcmp(folder, ".") == 0;
    snprintf(out, size, "%s%s%s", bare ? "" : folder, bare ? "" : "/", name);
}

uint64_t ph_i_hash(uint64_t hash, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    for (size_t i = 0; i < n; i++)
        hash = (hash ^ p[i]) * 0x100000001b3u;
    return hash;
}

static bool read_head(ph_i_reader *r, const ph_i_node *root, ph_campaign *c)
{
    static const char version[] =
        "must be 1, the version of the format that this program reads";
    static const char case_rule[] = "the name of a case file";
    int64_t one;
    char name[512] = "";
    if (!ph_i_read_map(r, root, "a campaign file is a map that begins with campaign: 1"))
        return false;
    const ph_i_node *node = ph_i_need(r, root, "campaign", version);
    if (node && !ph_i_read_integer(r, node, 1, 1, version, &one)) return false;
    ph_i_check_keys(r, root, (ph_i_names)PH_I_NAMES(root_keys), "a campaign");
    node = ph_i_get(root, "title");
    if (node) ph_i_read_text(r, node, sizeof c->title, c->title);
    node = ph_i_need(r, root, "case", case_rule);
    if (node && ph_i_read_text(r, node, sizeof name, name))
        ph_i_path_in(c->folder, name, c->case_path, sizeof c->case_path);
    return node != NULL;
}

static ph_status read_document(ph_i_reader *r, const ph_i_node *root,
                               const char *const *sets, size_t nsets, ph_campaign *c,
                               ph_error *err)
{
    ph_status st = PH_OK;
    ph_i_sweep sweep = {0};
    if (!read_head(r, root, c)) goto out;
    PH_TRY(ph_i_plan_read(r, root, c, err));
    PH_TRY(ph_i_sweep_read(r, root, c->folder, &sweep, err));
    ph_i_data_read(r, root, &sweep, c);
    if (r->invalid + r->unphysical == 0)
        PH_TRY(ph_i_points_resolve(r, root, &sweep, sets, nsets, c, err));
out:
    ph_i_sweep_clear(&sweep);
    return st;
}

ph_status ph_campaign_parse(const char *text, size_t length, const char *name,
                            const char *const *sets, size_t nsets, ph_campaign **out,
                            ph_case_issues *issues, ph_error *err)
{
    PH_GIVEN(text && name && out && (sets || nsets == 0));
    ph_status st = PH_OK;
    ph_case_issues own = {0};
    ph_campaign *c = NULL;
    ph_i_node *root = NULL;
    ph_i_reader r = {.file = name, .issues = issues ? issues : &own};
    *out = NULL;
    PH_ALLOC(c, 1, "a campaign");
    PH_CHECK(strlen(name) < sizeof c->path, PH_EINVAL, "%.100s...: the path is too long",
             name);
    strcpy(c->path, name);
    ph_i_folder_of(name, c->folder, sizeof c->folder);
    PH_TRY(ph_i_tree_parse(&r, text, length, &root, err));
    if (r.issues->count == 0 && (!root || ph_i_is_null(root))) {
        ph_i_tree_free(&root);
        ph_i_complain_line(&r, 0,
                           "the file is empty: a campaign begins with campaign: 1");
    }
    if (root) PH_TRY(read_document(&r, root, sets, nsets, c, err));
    PH_TRY(ph_i_verdict(&r, err));
    *out = c;
    c = NULL;
out:
    ph_i_tree_free(&root);
    ph_campaign_free(&c);
    ph_case_issues_free(&own);
    return st;
}

ph_status ph_campaign_read(const char *path, const char *const *sets, size_t nsets,
                           ph_campaign **out, ph_case_issues *issues, ph_error *err)
{
    PH_GIVEN(path && out && (sets || nsets == 0));
    ph_status st = PH_OK;
    char *text = NULL;
    size_t length = 0;
    *out = NULL;
    PH_TRY(ph_i_read_file(path, MAX_FILE, "campaign file", &text, &length, err));
    PH_TRY(ph_campaign_parse(text, length, path, sets, nsets, out, issues, err));
out:
    free(text);
    return st;
}
