/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/superelement.h>

#include "io/text.h"

static void point(ph_i_growing *g, const double x[3])
{
    for (int a = 0; a < 3; a++) {
        ph_i_append(g, " ", 1);
        ph_i_append_exact(g, x[a]);
    }
}

ph_status ph_superelement_to_mtx(const ph_superelement *e, char **text, ph_error *err)
{
    PH_GIVEN(e && text);
    ph_status st = PH_OK;
    ph_i_growing g = {0};
    const ptrdiff_t n = e->nd * e->nodes + e->strains;
    ph_i_appendf(&g,
                 "%%%%MatrixMarket matrix array real symmetric\n"
                 "%% superelement of an RVE: row %d node + component, node and component "
                 "from 0\n%% node x y z\n",
                 e->nd);
    for (ptrdiff_t k = 0; k < e->nodes; k++) {
        ph_i_appendf(&g, "%% %td", k);
        point(&g, e->position[k]);
        ph_i_append(&g, "\n", 1);
    }
    ph_i_appendf(&g, "%td %td\n", n, n);
    for (ptrdiff_t j = 0; j < n; j++)
        for (ptrdiff_t i = j; i < n; i++) {
            ph_i_append_exact(&g, e->stiffness[i * n + j]);
            ph_i_append(&g, "\n", 1);
        }
    PH_CHECK(!g.failed, PH_ENOMEM, "no memory for the text of a superelement");
    *text = g.text;
    g.text = NULL;
out:
    free(g.text);
    return st;
}
