/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any text at all is either a campaign or a complaint. An input is the text of a campaign
 * file; it stands in the folder of the test campaigns. */
#include <perihom_campaign.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(int condition)
{
    if (!condition) abort();
}

static void check_campaign(const ph_campaign *c)
{
    demand(c->npoints >= 1 && c->npoints <= PH_CAMPAIGN_POINTS);
    demand(c->noutputs >= 1 && c->noutputs <= PH_MAX_OUTPUTS);
    demand(c->judged >= -1 && c->judged < c->noutputs);
    demand(c->stopping.at_least <= c->stopping.at_most);
    demand(c->nfactors == 0 || (c->nfactors >= 2 && c->judged >= 0));
    demand(c->nfactors <= PH_SPLIT_SIZES && !c->sizes);
    for (int i = 0; i + 1 < c->nfactors; i++)
        demand(c->factor[i] > 0 && c->factor[i] < c->factor[i + 1]);
    for (int p = 0; p < c->npoints; p++) {
        demand(c->point[p].c != NULL);
        for (int k = 0; k < c->nkeys; k++)
            demand(c->key[k][0] && c->point[p].value[k] != NULL);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ph_campaign *c = NULL;
    ph_case_issues issues = {0};
    ph_error err = PH_ERROR_INIT;
    ph_status st = ph_campaign_parse((const char *)data, size,
                                     PH_TEST_DIR "/cli/campaigns/fuzz.yaml", NULL, 0, &c,
                                     &issues, &err);
    demand((st == PH_OK) == (c != NULL));
    if (c) check_campaign(c);
    if (!c) demand(err.msg[0] && (issues.count > 0 || st == PH_EIO || st == PH_EINVAL));
    ph_campaign_free(&c);
    ph_case_issues_free(&issues);
    return 0;
}
