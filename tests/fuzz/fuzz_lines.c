/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whatever stands behind the first line of realisations.jsonl, a campaign goes on: what is
 * no whole line of its own does not count. An input is what stands there. */
#include <perihom_campaign.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char text[] = "campaign: 1\ncase: random.yaml\nrealisations: 5\n"
                           "sweep: {materials.clay.E: [50, 178]}\noutputs: [C11]\n";

static void demand(int condition)
{
    if (!condition) abort();
}

static void check(const ph_campaign *c, const char *folder, const uint8_t *data,
                  size_t size)
{
    ph_campaign_result *r = NULL;
    ph_error err = PH_ERROR_INIT, none = PH_ERROR_INIT;
    char path[128];
    demand(ph_campaign_summarise(c, folder, &r, &none) == PH_EIO); /* nothing is there */
    demand(ph_campaign_merge(c, folder, NULL, 0, &r, &err) == PH_OK); /* the first line */
    demand(r->realisations == 0);
    ph_campaign_result_free(&r);
    snprintf(path, sizeof path, "%s/realisations.jsonl", folder);
    FILE *file = fopen(path, "a");
    demand(file && fwrite(data, 1, size, file) == size && fclose(file) == 0);
    demand(ph_campaign_summarise(c, folder, &r, &err) == PH_OK);
    int64_t first = r->realisations;
    ph_campaign_result_free(&r);
    /* now the file is in order: the same again, nothing dropped */
    demand(ph_campaign_summarise(c, folder, &r, &err) == PH_OK);
    demand(r->realisations == first && r->dropped == 0 && r->differing == 0);
    ph_campaign_result_free(&r);
    remove(path);
    snprintf(path, sizeof path, "%s/campaign.lock", folder);
    remove(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char folder[] = "/tmp/perihom-fuzz-XXXXXX";
    ph_campaign *c = NULL;
    ph_error err = PH_ERROR_INIT;
    demand(ph_campaign_parse(text, sizeof text - 1, PH_TEST_DIR "/cli/campaigns/c.yaml",
                             NULL, 0, &c, NULL, &err) == PH_OK);
    if (mkdtemp(folder)) check(c, folder, data, size);
    rmdir(folder);
    ph_campaign_free(&c);
    return 0;
}
