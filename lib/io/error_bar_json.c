/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error bars in the result document. */
#include "io/json.h"

#include <math.h>
#include <string.h>

bool ph_i_is_linear(const ph_error_constant *k)
{
    return k->name[0] == 'C' || strcmp(k->name, "isotropic.K") == 0 ||
           strcmp(k->name, "isotropic.G") == 0;
}

ph_status ph_i_json_error_list(const ph_error_bar *bar, const char *path, bool linear,
                               json_t *map, const char *key, json_t *reasons,
                               ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object();
    PH_TRY(ph_i_json_put(map, key, list, err));
    for (int i = 0; i < bar->count; i++) {
        const ph_error_constant *k = &bar->constant[i];
        if (linear && !ph_i_is_linear(k)) continue;
        PH_TRY(ph_i_json_put_number(list, path, k->name, k->bar, reasons,
                                    k->why ? k->why : "not estimated", err));
    }
out:
    return st;
}

/* One part of every constant that has it; null with one reason where none has. */
static ph_status put_part(const ph_error_bar *bar, size_t part, json_t *parts,
                          json_t *reasons, ph_error *err)
{
    ph_status st = PH_OK;
    const char *name = ph_error_parts[part].info.name;
    char path[64];
    snprintf(path, sizeof path, "quality.error_parts.%s", name);
    if (bar->why[part][0]) {
        PH_TRY(ph_i_json_put(parts, name, json_null(), err));
        PH_TRY(ph_i_json_put(reasons, path, ph_i_json_text(bar->why[part]), err));
        goto out;
    }
    json_t *list = json_object();
    PH_TRY(ph_i_json_put(parts, name, list, err));
    for (int i = 0; i < bar->count; i++)
        if (isfinite(bar->constant[i].part[part]))
            PH_TRY(ph_i_json_put(list, bar->constant[i].name,
                                 ph_i_json_number(bar->constant[i].part[part]), err));
out:
    return st;
}

static ph_status put_richardson(const ph_error_bar *bar, json_t *quality, json_t *reasons,
                                ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object();
    bool any = false;
    PH_TRY(ph_i_json_put(quality, "richardson", list, err));
    for (int i = 0; i < bar->count; i++) {
        const ph_error_constant *k = &bar->constant[i];
        if (!isfinite(k->richardson)) continue;
        any = true;
        PH_TRY(ph_i_json_put(list, k->name, ph_i_json_number(k->richardson), err));
    }
    if (!any)
        PH_TRY(ph_i_json_put(
            reasons, "quality.richardson",
            ph_i_json_text(bar->why[0][0] ? bar->why[0] : "no constant has two values"),
            err));
out:
    return st;
}

ph_status ph_i_json_error_bar(const ph_error_bar *bar, json_t *quality, json_t *reasons,
                              ph_error *err)
{
    ph_status st = PH_OK;
    json_t *parts = NULL;
    if (!bar) return ph_i_json_put(quality, "error_bar", json_object(), err);
    PH_TRY(ph_i_json_error_list(bar, "quality.error_bar", false, quality, "error_bar",
                                reasons, err));
    parts = json_object();
    PH_TRY(ph_i_json_put(quality, "error_parts", json_incref(parts), err));
    for (size_t i = 0; i < ph_nerror_parts; i++)
        PH_TRY(put_part(bar, i, parts, reasons, err));
    PH_TRY(put_richardson(bar, quality, reasons, err));
out:
    json_decref(parts);
    return st;
}

ph_status ph_i_json_error_cost(const ph_error_bar *bar, json_t *cost, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object(), *nodes = json_array();
    PH_CHECK(list && nodes, PH_ENOMEM, "no memory for the cost");
    PH_TRY(ph_i_json_put(list, "seconds", ph_i_json_number(bar->seconds), err));
    PH_TRY(ph_i_json_put(list, "iterations", json_integer((json_int_t)bar->iterations),
                         err));
    PH_TRY(ph_i_json_put(list, "applications",
                         json_integer((json_int_t)bar->applications), err));
    PH_TRY(ph_i_json_put(list, "ffts", json_integer((json_int_t)bar->ffts), err));
    for (int a = 0; a < 3 && bar->nodes[a] > 0; a++)
        PH_TRY(ph_i_json_add(nodes, json_integer((json_int_t)bar->nodes[a]), err));
    PH_TRY(ph_i_json_put(list, "nodes", json_incref(nodes), err));
    PH_TRY(ph_i_json_put(cost, "error_bar", json_incref(list), err));
out:
    json_decref(list);
    json_decref(nodes);
    return st;
}
