/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/version.h>

#include "io/json.h"

#include <string.h>
#include <time.h>

/* "model name" of the first processor, or "unknown" where the system does not say. */
static void host_cpu(char *name, size_t size)
{
    snprintf(name, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (!file) return;
    char line[256];
    while (fgets(line, sizeof line, file)) {
        char *colon = strchr(line, ':');
        if (!colon || strncmp(line, "model name", 10) != 0) continue;
        colon += 1 + strspn(colon + 1, " \t");
        colon[strcspn(colon, "\n")] = 0;
        snprintf(name, size, "%s", colon);
        break;
    }
    fclose(file);
}

/* Now, in UTC, as ISO 8601. */
static void utc_date(char text[32])
{
    time_t now = time(NULL);
    struct tm parts;
    if (!gmtime_r(&now, &parts) || !strftime(text, 32, "%Y-%m-%dT%H:%M:%SZ", &parts))
        snprintf(text, 32, "unknown");
}

static ph_status libraries(json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *list = json_object();
    PH_CHECK(list, PH_ENOMEM, "no memory for the list of libraries");
    const char *name, *version = NULL;
    for (int i = 0; (name = ph_dependency(i, &version)) != NULL; i++)
        PH_TRY(ph_i_json_put(list, name, ph_i_json_text(version), err));
    *out = list;
    list = NULL;
out:
    json_decref(list);
    return st;
}

ph_status ph_i_json_provenance(const char *command, json_t **out, ph_error *err)
{
    ph_status st = PH_OK;
    json_t *made = json_object(), *list = NULL;
    char cpu[256], date[32];
    host_cpu(cpu, sizeof cpu);
    utc_date(date);
    PH_CHECK(made, PH_ENOMEM, "no memory for the provenance");
    PH_TRY(ph_i_json_put(made, "perihom", ph_i_json_text(ph_version()), err));
    PH_TRY(ph_i_json_put(made, "git", ph_i_json_text(ph_git_revision()), err));
    PH_TRY(ph_i_json_put(made, "compiler", ph_i_json_text(ph_compiler()), err));
    PH_TRY(libraries(&list, err));
    PH_TRY(ph_i_json_put(made, "libraries", json_incref(list), err));
    PH_TRY(ph_i_json_put(made, "host_cpu", ph_i_json_text(cpu), err));
    PH_TRY(ph_i_json_put(made, "date", ph_i_json_text(date), err));
    if (command) PH_TRY(ph_i_json_put(made, "command", ph_i_json_text(command), err));
    *out = made;
    made = NULL;
out:
    json_decref(list);
    json_decref(made);
    return st;
}
