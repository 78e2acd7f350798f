/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Influence functions. Poles inside the family make the shape tensor meaningless, so only
 * functions that are finite and non-negative for 0 < q are here. */
#include <perihom/family.h>

#include <math.h>

static double constant(double q)
{
    (void)q;
    return 1.0;
}
static double conical(double q)
{
    return q < 1.0 ? 1.0 - q : 0.0;
}
static double gaussian(double q)
{
    return exp(-q * q);
}
static double inverse(double q)
{
    return 1.0 / q;
}
static double inverse_square(double q)
{
    return 1.0 / (q * q);
}
static double cubic(double q)
{
    return q < 1.0 ? 1.0 - 3.0 * q * q + 2.0 * q * q * q : 0.0;
}

const ph_influence ph_influences[] = {
    {{"constant", "omega = 1", "Silling2007", "always"}, constant},
    {{"conical", "omega = 1 - r/delta, zero beyond delta", "Silling2007",
      "horizon above one spacing"},
     conical},
    {{"gaussian", "omega = exp(-r^2/delta^2)", "Silling2007", "always"}, gaussian},
    {{"inverse", "omega = delta/r", "Silling2007", "always"}, inverse},
    {{"inverse_square", "omega = (delta/r)^2", "Silling2007", "always"}, inverse_square},
    {{"cubic", "omega = 1 - 3 (r/delta)^2 + 2 (r/delta)^3, zero beyond delta",
      "Silling2007", "horizon above one spacing"},
     cubic},
};
const size_t ph_ninfluences = sizeof ph_influences / sizeof *ph_influences;
