/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/plot_canvas.h"

#include <string.h>

/* A letter is as wide as the picture's are; those of SVG are narrower on average. */
static int letter_width(int size)
{
    return size < PH_I_LARGE ? PH_I_LETTER_WIDTH : 3 * PH_I_LETTER_WIDTH / 2;
}

double ph_i_label_width(const char *text, int size)
{
    return ph_i_utf8_letters(text) * letter_width(size);
}

void ph_i_label_fit(const char *text, int size, double width, char out[512])
{
    static const char ellipsis[] = "\xe2\x80\xa6";
    size_t used = 0;
    int room = (int)(width / letter_width(size)), letters = ph_i_utf8_letters(text);
    bool cut = letters > room;
    int keep = cut ? room - 1 : letters;
    const char *at = text;
    for (uint32_t code; keep > 0 && ph_i_utf8_next(&at, &code); keep--) {
        size_t n = (size_t)(at - text);
        if (used + n + sizeof ellipsis > 512) {
            cut = true;
            break;
        }
        memcpy(out + used, text, n);
        used += n;
        text = at;
    }
    strcpy(out + used, cut && room > 0 ? ellipsis : "");
}

int ph_i_mark_outline(int shape, double radius, ph_i_point corner[4])
{
    static const ph_i_point unit[PH_I_MARKS][4] = {
        {{0, 0}},
        {{-0.89, -0.89}, {0.89, -0.89}, {0.89, 0.89}, {-0.89, 0.89}},
        {{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}},
        {{0, -1.3}, {1.2, 0.8}, {-1.2, 0.8}},
    };
    static const int corners[PH_I_MARKS] = {0, 4, 4, 3};
    for (int k = 0; k < corners[shape]; k++)
        corner[k] = (ph_i_point){radius * unit[shape][k].x, radius * unit[shape][k].y};
    return corners[shape];
}

void ph_i_canvas_segment(ph_i_canvas *c, double x0, double y0, double x1, double y1,
                         ph_i_pen pen)
{
    const ph_i_point p[2] = {{x0, y0}, {x1, y1}};
    c->line(c, 2, p, pen);
}

void ph_i_canvas_text(ph_i_canvas *c, double x, double y, const char *text,
                      ph_i_anchor anchor, ph_i_colour colour)
{
    c->text(c, text,
            (ph_i_label){
                .at = {x, y}, .size = PH_I_SMALL, .anchor = anchor, .colour = colour});
}

ph_i_colour ph_i_series_colour(int k)
{
    /* of the materials' colours those that are dark enough, the clearest first */
    static const int order[] = {1, 4, 3, 2, 5, 7};
    const int count = (int)(sizeof order / sizeof *order);
    return ph_i_material_colour(k < count ? order[k] : k + 2, false);
}
