/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a neighbour's cell lies within the horizon. */
#include <perihom/family.h>

#include <math.h>

static double length3(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* 1 up to delta - h/2, then linear to 0 at delta + h/2; h is the cell's width along the
 * bond, so that a cell of unequal edges is cut where it is cut. */
static double linear(const double xi[3], const double h[3], const bool active[3],
                     double delta)
{
    double r = length3(xi), width = 0.0;
    for (int d = 0; d < 3; d++)
        if (active[d]) width += h[d] * h[d] * xi[d] * xi[d];
    width = sqrt(width) / r;
    double beta = (delta + width / 2.0 - r) / width;
    return fmin(1.0, fmax(0.0, beta));
}

static double none(const double xi[3], const double h[3], const bool active[3],
                   double delta)
{
    (void)h;
    (void)active;
    return length3(xi) <= delta * (1.0 + 1e-9) ? 1.0 : 0.0;
}

/* Integral of sqrt(R^2 - x^2) from 0 to x, |x| <= R. */
static double half_disk(double x, double R)
{
    double t = fmin(1.0, fmax(-1.0, x / R));
    return 0.5 * R * R * (t * sqrt(1.0 - t * t) + asin(t));
}

/* Area of {0 <= x <= a, 0 <= y <= b} within the disk of radius R about the origin; signed
 * in a and b, so that four corners give any rectangle. */
static double corner_area(double a, double b, double R)
{
    double sign = (a < 0.0 ? -1.0 : 1.0) * (b < 0.0 ? -1.0 : 1.0);
    a = fmin(fabs(a), R);
    b = fmin(fabs(b), R);
    double x = sqrt(fmax(0.0, R * R - b * b)); /* up to here the disk is higher than b */
    if (x >= a) return sign * a * b;
    return sign * (x * b + half_disk(a, R) - half_disk(x, R));
}

static double rectangle_area(const double lo[2], const double hi[2], double R)
{
    if (R <= 0.0) return 0.0;
    return corner_area(hi[0], hi[1], R) - corner_area(lo[0], hi[1], R) -
           corner_area(hi[0], lo[1], R) + corner_area(lo[0], lo[1], R);
}

/* Points and weights of the 8-point Gauss rule on [-1, 1], positive half. */
static const double gauss_x[4] = {0.18343464249564980, 0.52553240991632899,
                                  0.79666647741362674, 0.96028985649753623};
static const double gauss_w[4] = {0.36268378337836198, 0.31370664587788729,
                                  0.22238103445337447, 0.10122853629037626};

/* Ball against box: exact disk areas of slices along the third axis, Gauss quadrature
 * between the heights where the slice changes form (z = +-R included). */
static double box_volume(const double lo[3], const double hi[3], double R)
{
    double z0 = fmax(lo[2], -R), z1 = fmin(hi[2], R), volume = 0.0;
    if (z1 <= z0) return 0.0;
    enum { PIECES = 8 }; /* of the smooth pieces: error below 1e-6 of a cell */
    for (int p = 0; p < PIECES; p++) {
        double a = z0 + (z1 - z0) * p / PIECES, b = z0 + (z1 - z0) * (p + 1) / PIECES;
        for (int q = 0; q < 8; q++) {
            double t = q < 4 ? gauss_x[q] : -gauss_x[q - 4];
            double z = 0.5 * (a + b) + 0.5 * (b - a) * t;
            volume += 0.5 * (b - a) * gauss_w[q % 4] *
                      rectangle_area(lo, hi, sqrt(fmax(0.0, R * R - z * z)));
        }
    }
    return volume;
}

static double exact(const double xi[3], const double h[3], const bool active[3],
                    double delta)
{
    double lo[3], hi[3], cell = 1.0;
    int n = 0; /* active axes first */
    for (int d = 0; d < 3; d++)
        if (active[d]) {
            lo[n] = xi[d] - h[d] / 2.0;
            hi[n] = xi[d] + h[d] / 2.0;
            cell *= h[d];
            n++;
        }
    if (n == 1) return fmax(0.0, fmin(hi[0], delta) - fmax(lo[0], -delta)) / cell;
    if (n == 2) return rectangle_area(lo, hi, delta) / cell;
    return box_volume(lo, hi, delta) / cell;
}

const ph_volume_weight ph_volume_weights[] = {
    {{"linear", "1 to delta - h/2, then linear to 0 at delta + h/2", "Parks2008",
      "always"},
     linear},
    {{"exact", "share of the cell inside the ball of radius delta", "Seleson2014",
      "always"},
     exact},
    {{"none", "1 where the cell's centre lies within delta", "Silling2005", "always"},
     none},
};
const size_t ph_nvolume_weights = sizeof ph_volume_weights / sizeof *ph_volume_weights;
