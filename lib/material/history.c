/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/history.h>

#include "core/check.h"

#include <math.h>
#include <string.h>

ph_status ph_history_new(int n, int npoints, bool stress, ph_history **out, ph_error *err)
{
    PH_GIVEN(out);
    ph_status st = PH_OK;
    ph_history *h = NULL;
    *out = NULL;
    PH_CHECK(n == 3 || n == 6, PH_EINVAL, "a history has 3 or 6 components, got %d", n);
    PH_CHECK(npoints >= 1, PH_EINVAL, "a history has at least one point, got %d",
             npoints);
    PH_ALLOC(h, 1, "a history");
    h->stress = stress;
    h->n = n;
    h->npoints = npoints;
    PH_ALLOC(h->time, npoints, "a history");
    PH_ALLOC(h->value, npoints, "a history");
    *out = h;
    h = NULL;
out:
    ph_history_free(&h);
    return st;
}

void ph_history_free(ph_history **history)
{
    if (!history || !*history) return;
    free((*history)->time);
    free((*history)->value);
    free(*history);
    *history = NULL;
}

ph_status ph_history_validate(const ph_history *h, ph_error *err)
{
    PH_GIVEN(h);
    ph_status st = PH_OK;
    PH_CHECK((h->n == 3 || h->n == 6) && h->npoints >= 1, PH_EINVAL,
             "a history has 3 or 6 components and at least one point, got %d and %d",
             h->n, h->npoints);
    for (int p = 0; p < h->npoints; p++) {
        PH_CHECK(isfinite(h->time[p]), PH_EINVAL,
                 "point %d of the history: its time is not a number", p + 1);
        PH_CHECK(p == 0 || h->time[p] >= h->time[p - 1], PH_EINVAL,
                 "point %d of the history: time %g comes after %g", p + 1, h->time[p],
                 h->time[p - 1]);
        PH_CHECK(p < 2 || h->time[p] > h->time[p - 2], PH_EINVAL,
                 "point %d of the history: three points at time %g", p + 1, h->time[p]);
        for (int i = 0; i < h->n; i++)
            PH_CHECK(isfinite(h->value[p][i]), PH_EINVAL,
                     "point %d of the history: a value is not a number", p + 1);
    }
out:
    return st;
}

static ph_status check_component(int n, int component, ph_error *err)
{
    ph_status st = PH_OK;
    PH_CHECK(component >= 0 && component < n, PH_EINVAL,
             "component %d of a history is outside 0..%d", component, n - 1);
out:
    return st;
}

ph_status ph_history_ramp(int n, int component, bool stress, double value, double rise,
                          double hold, double rest, ph_history **out, ph_error *err)
{
    PH_GIVEN(out);
    ph_status st = PH_OK;
    const double at[5] = {0, rise, rise + hold, 2 * rise + hold, 2 * rise + hold + rest};
    const double level[5] = {0, 1, 1, 0, 0};
    *out = NULL;
    PH_TRY(check_component(n, component, err));
    PH_CHECK(rise >= 0 && hold > 0 && rest >= 0 && isfinite(at[4]), PH_EINVAL,
             "a ramp needs rise >= 0, hold > 0 and rest >= 0, got %g, %g and %g", rise,
             hold, rest);
    PH_TRY(ph_history_new(n, rest > 0 ? 5 : 3, stress, out, err));
    for (int p = 0; p < (*out)->npoints; p++) {
        (*out)->time[p] = at[p];
        (*out)->value[p][component] = level[p] * value;
    }
    PH_TRY(ph_history_validate(*out, err));
out:
    if (st != PH_OK) ph_history_free(out);
    return st;
}

ph_status ph_history_cycle(int n, int component, bool stress, const ph_cycle *cycle,
                           ph_history **out, ph_error *err)
{
    PH_GIVEN(cycle && out);
    ph_status st = PH_OK;
    const int cycles = cycle->cycles, points = cycle->points;
    const double two_pi = 2 * acos(-1.0);
    enum { MOST = 10000000 };
    *out = NULL;
    PH_TRY(check_component(n, component, err));
    PH_CHECK(cycle->omega > 0 && isfinite(cycle->omega), PH_EINVAL,
             "the angular frequency of a cycle must be > 0, got %g", cycle->omega);
    PH_CHECK(cycles >= 1 && points >= 4 && cycles <= MOST / points, PH_EINVAL,
             "a history of %d cycles of %d points: at least 1 of 4, at most 1e7 points",
             cycles, points);
    PH_TRY(ph_history_new(n, cycles * points + 1, stress, out, err));
    for (int p = 0; p < (*out)->npoints; p++) {
        double turn = (double)p / points;
        (*out)->time[p] = turn * two_pi / cycle->omega;
        (*out)->value[p][component] =
            cycle->mean + cycle->amplitude * sin(two_pi * (p % points) / points);
    }
    PH_TRY(ph_history_validate(*out, err));
out:
    if (st != PH_OK) ph_history_free(out);
    return st;
}

void ph_history_at(const ph_history *h, double time, double value[6])
{
    if (!h || !value) return;
    int next = 0; /* first point after `time` */
    while (next < h->npoints && h->time[next] <= time)
        next++;
    memset(value, 0, 6 * sizeof *value);
    if (next == 0) return;
    memcpy(value, h->value[next - 1], 6 * sizeof *value);
    if (next == h->npoints) return;
    double share = (time - h->time[next - 1]) / (h->time[next] - h->time[next - 1]);
    for (int i = 0; i < h->n; i++)
        value[i] += share * (h->value[next][i] - value[i]);
}
