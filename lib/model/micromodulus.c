/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles of the micromodulus. The constant of each follows from its moment: the printed
 * 8 E xi / (pi h delta^4) of the inverted cone is 2/3 of the right one, 12. */
#include <perihom/bond.h>

#include <math.h>

static double constant(double q, double power)
{
    (void)q, (void)power;
    return 1.0;
}
static double constant_moment(int d, double power)
{
    (void)power;
    return 1.0 / (d + 1);
}
static double conical(double q, double power)
{
    (void)power;
    return q < 1.0 ? 1.0 - q : 0.0;
}
static double conical_moment(int d, double power)
{
    (void)power;
    return 1.0 / (d + 1) - 1.0 / (d + 2);
}
static double inverted(double q, double power)
{
    (void)power;
    return q;
}
static double inverted_moment(int d, double power)
{
    (void)power;
    return 1.0 / (d + 2);
}
static double power_law(double q, double power)
{
    return pow(q, -power);
}
static double power_moment(int d, double power)
{
    return 1.0 / (d + 1 - power);
}

const ph_micromodulus ph_micromoduli[] = {
    {{"constant", "c: the prototype microelastic material", "Silling2005", "always"},
     constant,
     constant_moment},
    {{"conical", "c (1 - r/delta), zero beyond delta", "Ha2010",
      "horizon above one spacing"},
     conical,
     conical_moment},
    {{"inverted_conical", "c r/delta", "Ha2010", "always"}, inverted, inverted_moment},
    {{"power_law", "c (delta/r)^alpha", "Ongaro2022",
      "alpha < 3 in the plane, alpha < 4 in space"},
     power_law,
     power_moment},
};
const size_t ph_nmicromoduli = sizeof ph_micromoduli / sizeof *ph_micromoduli;

const ph_calibration_rule ph_calibrations[] = {
    {{"lattice", "the homogeneous Young's modulus is exact on the lattice", "",
      "always"}},
    {{"gamma", "the homogeneous C1111 is exact on the lattice", "Ongaro2022", "always"}},
    {{"continuum", "the constant of the continuum, whatever the lattice", "Silling2005",
      "many nodes in the horizon"}},
};
const size_t ph_ncalibrations = sizeof ph_calibrations / sizeof *ph_calibrations;
