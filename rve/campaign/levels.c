/* SPDX-License-Identifier: GPL-3.0-or-later */
/* variance_reduction of a campaign file: the cheaper models of every point. */
#include "campaign/campaign.h"

#include <math.h>
#include <string.h>

static const char levels_rule[] =
    "must be auto, or a list of cheaper models: maps of keys of the case and values, or "
    "the word fillers";
/* What derived models solve to, and the least grid that is halved. */
static const double loose = 0.1;
enum { LEAST_NODES = 32, SETS = 8 };

void ph_i_levels_clear(ph_i_levels *levels)
{
    for (int m = 0; m < PH_MAX_MODELS; m++) {
        for (size_t i = 0; i < levels->nsets[m]; i++)
            free(levels->set[m][i]);
        free(levels->set[m]);
    }
    *levels = (ph_i_levels){0};
}

static ph_status read_sets(const ph_i_node *map, ph_i_levels *levels, int m,
                           ph_error *err)
{
    ph_status st = PH_OK;
    char *value = NULL;
    PH_ALLOC(levels->set[m], map->count, "the keys of a model");
    for (size_t i = 0; i < map->count; i++) {
        value = ph_i_tree_text(map->child[i]);
        PH_CHECK(value, PH_ENOMEM, "no memory for an override");
        size_t size = strlen(map->child[i]->key) + strlen(value) + 2;
        PH_ALLOC(levels->set[m][i], size, "an override");
        levels->nsets[m]++;
        snprintf(levels->set[m][i], size, "%s=%s", map->child[i]->key, value);
        free(value);
        value = NULL;
    }
out:
    free(value);
    return st;
}

static ph_status read_list(ph_i_reader *r, const ph_i_node *list, ph_i_levels *levels,
                           ph_error *err)
{
    ph_status st = PH_OK;
    if (list->kind == PH_I_SCALAR && strcmp(list->text, "auto") == 0) {
        levels->automatic = true;
        goto out;
    }
    if (!ph_i_read_list(r, list, 0, levels_rule)) goto out;
    if (list->count < 1 || list->count > PH_MAX_MODELS - 1) {
        ph_i_reject(r, list, PH_EINVAL, "must have 1 to %d models", PH_MAX_MODELS - 1);
        goto out;
    }
    for (size_t i = 0; i < list->count; i++) {
        const ph_i_node *item = list->child[i];
        int m = ++levels->n;
        if (item->kind == PH_I_SCALAR && strcmp(item->text, "fillers") == 0) {
            levels->fillers[m] = true;
            if (i + 1 < list->count)
                ph_i_complain(r, item, PH_EINVAL, "must be the last of the list");
        } else if (item->kind != PH_I_MAP || item->count == 0) {
            ph_i_reject(r, item, PH_EINVAL, "%s", levels_rule);
        } else {
            PH_TRY(read_sets(item, levels, m, err));
        }
    }
out:
    return st;
}

static void read_method(ph_i_reader *r, const ph_i_node *node, ph_campaign *c,
                        ph_i_levels *levels)
{
    const char *names[8] = {"auto", "none"};
    for (size_t i = 0; i < ph_nestimators; i++)
        names[2 + i] = ph_estimators[i].info.name;
    int i = ph_i_read_name(r, node, (ph_i_names){names, 2 + ph_nestimators});
    if (i == 1) levels->given = false;
    if (i > 1) c->method = ph_estimators[i - 2].info.name;
}

ph_status ph_i_levels_read(ph_i_reader *r, const ph_i_node *root, ph_i_levels *levels,
                           ph_campaign *c, ph_error *err)
{
    static const char *const keys[] = {"method", "levels", "pilot"};
    ph_status st = PH_OK;
    const ph_i_node *map = ph_i_get(root, "variance_reduction");
    if (!map) goto out;
    if (map->kind == PH_I_SCALAR) {
        int i = ph_i_read_name(
            r, map, (ph_i_names)PH_I_NAMES(((const char *const[]){"auto", "none"})));
        levels->given = levels->automatic = i == 0;
    } else if (ph_i_read_map(r, map,
                             "must be auto, none or a map with method, levels, pilot")) {
        levels->given = levels->automatic = true;
        ph_i_check_keys(r, map, (ph_i_names)PH_I_NAMES(keys), "variance_reduction");
        const ph_i_node *method = ph_i_get(map, "method"),
                        *list = ph_i_get(map, "levels"), *pilot = ph_i_get(map, "pilot");
        if (method) read_method(r, method, c, levels);
        if (pilot)
            ph_i_read_integer(r, pilot, 4, 1000000,
                              "must be an integer from 4 to 1000000", &c->pilot);
        if (list) {
            levels->automatic = false;
            PH_TRY(read_list(r, list, levels, err));
        }
    }
    int64_t least = 2 * (c->pilot ? c->pilot : 12);
    if (levels->given && c->stopping.at_most < least)
        ph_i_complain(r, map, PH_EINVAL,
                      "realisations.at_most is %lld: not worth it below %lld, twice the "
                      "pilots",
                      (long long)c->stopping.at_most, (long long)least);
out:
    return st;
}

/* ---- what follows from the case -------------------------------------------------------- */

static int dimensions(const ph_case *c)
{
    return c->kinematics == PH_SPACE ? 3 : 2;
}

static bool can_be_halved(const ph_case *c)
{
    bool any = false;
    for (int a = 0; a < dimensions(c); a++) {
        if (c->nodes[a] > 1 && c->nodes[a] < LEAST_NODES) return false;
        any |= c->nodes[a] > 1;
    }
    return any && !c->voxels.file[0];
}

static void put_grid(char *text, size_t size, const char *key, const ph_case *c, int part)
{
    size_t n = (size_t)snprintf(text, size, "%s=[", key);
    for (int a = 0; a < dimensions(c); a++)
        n += (size_t)snprintf(text + n, size - n, "%s%td", a ? ", " : "",
                              (c->nodes[a] + part - 1) / part);
    snprintf(text + n, size - n, "]");
}

/* The overrides of derived model `kind`: 0 the tolerance, 1 half the grid as well, with the
 * same horizon in length and the same fillers. */
static size_t derive(const ph_case *c, int kind, char text[SETS][256])
{
    size_t n = 0;
    double tolerance = c->solver.tolerance > 0 ? c->solver.tolerance : 1e-6;
    snprintf(text[n++], 256, "solver.tolerance=%g", fmax(loose, tolerance));
    if (kind == 0) return n;
    put_grid(text[n++], 256, "microstructure.nodes", c, 2);
    if (c->nfillers > 0 && c->drawn_on[0] == 0)
        put_grid(text[n++], 256, "microstructure.drawn_on", c, 1);
    if (c->model.horizon > 0 && !c->model.horizon_is_length)
        snprintf(text[n++], 256, "model.horizon=%.17g",
                 fmax(c->model.horizon / 2, fmin(2, c->model.horizon)));
    return n;
}

/* Kinds of models that point 0 has: its other points get the same. */
static int derived(const ph_case *c, int kinds[3])
{
    int n = 0;
    double tolerance = c->solver.tolerance > 0 ? c->solver.tolerance : 1e-6;
    if (tolerance < loose / 2) kinds[n++] = 0;
    if (can_be_halved(c)) kinds[n++] = 1;
    if (c->nfillers > 0) kinds[n++] = 2;
    return n;
}

/* ---- the cases ------------------------------------------------------------------------- */

/* Overrides of a case. */
typedef struct overrides {
    const char *const *item;
    size_t n;
} overrides;

/* Model m of a point: the case with the overrides of the point and its own. */
static ph_status read_model(const overrides *of_point, const overrides *own, int point,
                            int m, ph_campaign *c, ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    ph_error why = PH_ERROR_INIT;
    char *json = NULL;
    const char **all = NULL;
    size_t n = of_point->n + own->n, used = 0;
    PH_ALLOC(all, n, "overrides");
    for (size_t i = 0; i < n; i++)
        all[i] = i < of_point->n ? of_point->item[i] : own->item[i - of_point->n];
    ph_case **out = &c->point[point].model[m];
    ph_status read = ph_case_read(c->case_path, all, n, out, issues, &why);
    PH_CHECK(read != PH_ENOMEM && (read == PH_OK || issues->count > 0), read, "%s",
             why.msg);
    if (read != PH_OK) goto out;
    PH_TRY(ph_case_to_json(*out, &json, err));
    c->hash = ph_i_hash(c->hash, json, strlen(json) + 1);
    char *name = c->model_name[m];
    for (size_t i = 0; point == 0 && i < own->n && used < sizeof c->model_name[m]; i++)
        used += (size_t)snprintf(name + used, sizeof c->model_name[m] - used, "%s%s",
                                 i ? ", " : "", own->item[i]);
out:
    free(json);
    free(all);
    return st;
}

static void take_fillers(ph_campaign *c, int m)
{
    c->fillers_model = m;
    snprintf(c->model_name[m], sizeof c->model_name[m], "fillers");
    c->hash = ph_i_hash(c->hash, "fillers", 8);
}

static ph_status resolve_derived(const overrides *of_point, int point, ph_campaign *c,
                                 ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    char text[SETS][256];
    const char *own[SETS];
    int kinds[3], n = derived(c->point[0].c, kinds);
    for (int i = 0; i < SETS; i++)
        own[i] = text[i];
    c->nmodels = 1 + n;
    for (int m = 1; m <= n; m++) {
        if (kinds[m - 1] == 2) {
            take_fillers(c, m);
            continue;
        }
        const overrides mine = {own, derive(c->point[point].c, kinds[m - 1], text)};
        PH_TRY(read_model(of_point, &mine, point, m, c, issues, err));
    }
out:
    return st;
}

/* The modulus of the free stretch differs from E by what couples to shear: as a control it is
 * as good, and needs the load of its own axis only. */
static ph_status choose_outputs(ph_campaign *c, int point, ph_error *err)
{
    ph_status st = PH_OK;
    if (c->cheap) goto out;
    PH_ALLOC(c->cheap, c->noutputs, "the outputs of cheaper models");
    for (int k = 0; k < c->noutputs; k++) {
        const char *name = c->output[k].name;
        ph_quantity q;
        char other[128];
        c->cheap[k] = c->output[k];
        if (name[0] != 'E' || strlen(name) != 2) continue;
        snprintf(other, sizeof other, "stretch.%s", name);
        if (ph_quantity_find(other, &q, NULL) == PH_OK &&
            !ph_quantity_refuses(&q, c->point[point].c->kinematics))
            c->cheap[k] = q;
    }
out:
    return st;
}

ph_status ph_i_levels_resolve(const ph_i_levels *levels, int point,
                              const char *const *sets, size_t nsets, ph_campaign *c,
                              ph_case_issues *issues, ph_error *err)
{
    ph_status st = PH_OK;
    const overrides of_point = {sets, nsets};
    if (!levels->given) goto out;
    PH_TRY(choose_outputs(c, point, err));
    if (levels->automatic) {
        PH_TRY(resolve_derived(&of_point, point, c, issues, err));
        PH_TRY(ph_i_grids_find(c, point, err));
        goto out;
    }
    c->nmodels = 1 + levels->n;
    for (int m = 1; m <= levels->n; m++) {
        if (levels->fillers[m]) {
            take_fillers(c, m);
            PH_CHECK(c->point[point].c->nfillers > 0, PH_EINVAL,
                     "variance_reduction.levels: the case has no fillers");
            continue;
        }
        const overrides own = {(const char *const *)levels->set[m], levels->nsets[m]};
        PH_TRY(read_model(&of_point, &own, point, m, c, issues, err));
    }
    PH_TRY(ph_i_grids_find(c, point, err));
out:
    return st;
}

const ph_case *ph_i_slot_case(const ph_campaign *c, int slot)
{
    const ph_campaign_point *p = &c->point[slot % c->npoints];
    int m = slot / c->npoints;
    return m == 0 || m == c->fillers_model ? p->c : p->model[m];
}

const ph_quantity *ph_i_slot_output(const ph_campaign *c, int slot)
{
    return slot < c->npoints ? c->output : c->cheap;
}

int ph_i_slot_values(const ph_campaign *c, int slot)
{
    if (!ph_i_is_fillers(c, slot)) return c->noutputs;
    return ph_rve_descriptor_count(ph_i_slot_case(c, slot));
}

void ph_i_slot_name(const ph_campaign *c, int slot, int k, char name[96])
{
    if (ph_i_is_fillers(c, slot))
        snprintf(name, 96, "fillers.%d", k);
    else
        snprintf(name, 96, "%s", ph_i_slot_output(c, slot)[k].name);
}
