/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/picture.h"

#include <math.h>

/* Linear light of OKLab coordinates. */
static void light_of_oklab(double L, double a, double b, double rgb[3])
{
    double l = L + 0.3963377774 * a + 0.2158037573 * b;
    double m = L - 0.1055613458 * a - 0.0638541728 * b;
    double s = L - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    rgb[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
    rgb[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
    rgb[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
}

/* The transfer curve of sRGB and its inverse. */
static uint8_t code_of_light(double x)
{
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    double code = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (uint8_t)(255 * code + 0.5);
}

static double light_of_code(uint8_t code)
{
    double x = code / 255.0;
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

/* Linear light; false if a screen cannot show it. */
static bool light_of_oklch(double L, double C, double hue, double rgb[3])
{
    const double degree = 3.14159265358979323846 / 180;
    bool shown = true;
    light_of_oklab(L, C * cos(hue * degree), C * sin(hue * degree), rgb);
    for (int k = 0; k < 3; k++)
        shown = shown && rgb[k] > -1e-3 && rgb[k] < 1 + 1e-3;
    return shown;
}

ph_i_colour ph_i_oklch(double L, double C, double hue)
{
    double rgb[3], most = C, least = 0;
    if (!light_of_oklch(L, C, hue, rgb)) {
        for (int k = 0; k < 24; k++) { /* greys can always be shown: bisect */
            C = 0.5 * (least + most);
            if (light_of_oklch(L, C, hue, rgb))
                least = C;
            else
                most = C;
        }
        (void)light_of_oklch(L, least, hue, rgb);
    }
    return (ph_i_colour){code_of_light(rgb[0]), code_of_light(rgb[1]),
                         code_of_light(rgb[2])};
}

ph_i_colour ph_i_sequential(double t)
{
    /* lightness is linear; hue runs from violet over teal to yellow */
    double L = 0.26 + 0.66 * t;
    double hue = 308 - 200 * t - 18 * sin(3.14159265358979323846 * t);
    double C = 0.115 + 0.055 * t * t;
    return ph_i_oklch(L, C, hue);
}

ph_i_colour ph_i_diverging(double t)
{
    double s = fabs(2 * t - 1);
    return ph_i_oklch(0.96 - 0.52 * s, 0.19 * s, t < 0.5 ? 255 : 28);
}

ph_i_colour ph_i_material_colour(int i, bool is_void)
{
    static const double chosen[][3] = {
        {0.88, 0.025, 85}, {0.50, 0.105, 250}, {0.70, 0.150, 55},  {0.62, 0.120, 165},
        {0.58, 0.160, 20}, {0.52, 0.130, 310}, {0.80, 0.140, 100}, {0.72, 0.090, 215},
    };
    const int count = (int)(sizeof chosen / sizeof *chosen);
    if (is_void) return (ph_i_colour){255, 255, 255};
    if (i < count) return ph_i_oklch(chosen[i][0], chosen[i][1], chosen[i][2]);
    return ph_i_oklch(0.45 + 0.1 * (i % 5), 0.13, fmod(137.50776405 * i, 360));
}

ph_i_colour ph_i_mix_colours(ph_i_colour a, ph_i_colour b, double f)
{
    return (ph_i_colour){
        code_of_light((1 - f) * light_of_code(a.r) + f * light_of_code(b.r)),
        code_of_light((1 - f) * light_of_code(a.g) + f * light_of_code(b.g)),
        code_of_light((1 - f) * light_of_code(a.b) + f * light_of_code(b.b))};
}
