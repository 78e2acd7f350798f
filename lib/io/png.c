/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of fields and phases: a slice of the grid, a title above, a colour bar or a legend
 * to the right. */
#include <perihom/output.h>

#include "io/picture.h"

#include <math.h>
#include <string.h>

enum { MARGIN = 28, TEXT = 2, LINE = 26, LONG_SIDE = 800, MAX_LEGEND = 20 };
static const ph_i_colour black = {34, 34, 34}, soft = {110, 110, 110},
                         grey = {190, 190, 190};

/* Which cells are seen: axes to the right and up, the layer of the third. */
typedef struct slice {
    const ph_grid *grid;
    int right, up, through;
    ptrdiff_t layer;
    int zoom[2]; /* pixels of a cell along right, up */
    int width, height;
} slice;

static ptrdiff_t slice_cell(const slice *s, ptrdiff_t i, ptrdiff_t j)
{
    ptrdiff_t at[3];
    at[s->right] = i;
    at[s->up] = j;
    at[s->through] = s->layer;
    return (at[0] * s->grid->n[1] + at[1]) * s->grid->n[2] + at[2];
}

static ph_status slice_init(slice *s, const ph_grid *grid, int axis, ph_error *err)
{
    ph_status st = PH_OK;
    bool space = grid->kinematics == PH_SPACE;
    PH_CHECK(!space || (axis >= 1 && axis <= 3), PH_EINVAL,
             "axis must be 1, 2 or 3, got %d", axis);
    s->grid = grid;
    s->through = space ? axis - 1 : 2;
    s->right = s->through == 0 ? 1 : 0;
    s->up = s->through == 2 ? 1 : 2;
    s->layer = grid->n[s->through] / 2;
    double longest = fmax(grid->size[s->right], grid->size[s->up]);
    const int axes[2] = {s->right, s->up};
    for (int a = 0; a < 2; a++) {
        double pixels = grid->h[axes[a]] * LONG_SIDE / longest;
        s->zoom[a] = pixels < 1 ? 1 : (int)lround(fmin(pixels, LONG_SIDE));
        PH_CHECK(grid->n[axes[a]] * s->zoom[a] <= 30000, PH_EINVAL,
                 "%td cells along axis %d are too many for a picture", grid->n[axes[a]],
                 axes[a] + 1);
    }
    s->width = (int)grid->n[s->right] * s->zoom[0];
    s->height = (int)grid->n[s->up] * s->zoom[1];
out:
    return st;
}

/* ---- layout ---- */

/* The picture with its slice at (left, top). */
typedef struct page {
    ph_i_picture picture;
    int left, top;
    int axes_width; /* of the text below the slice */
} page;

/* As much of `text` as fits, ended by dots if cut. */
static void fitted(const char *text, int width, int scale, char *out, size_t size)
{
    snprintf(out, size, "%s", text);
    size_t length = strlen(out);
    while (length > 3 && ph_i_text_width(out, scale) > width) {
        length--;
        strcpy(out + length - 3, "...");
    }
}

/* Small arrows below the slice that name its axes. */
static void draw_axes(page *p, const slice *s)
{
    char text[96];
    int y = p->top + s->height + 14;
    int used =
        snprintf(text, sizeof text, "axis %d right, axis %d up", s->right + 1, s->up + 1);
    if (s->grid->kinematics == PH_SPACE)
        snprintf(text + used, sizeof text - (size_t)used, ", cut at x%d = %.4g",
                 s->through + 1, ((double)s->layer + 0.5) * s->grid->h[s->through]);
    ph_i_text(&p->picture, p->left, y, TEXT, text, soft);
    p->axes_width = ph_i_text_width(text, TEXT);
}

/* A page with room for `beside` pixels at the right of the slice, title drawn. */
static ph_status page_new(page *p, const slice *s, int beside, int tall,
                          const char *title, ph_error *err)
{
    ph_status st = PH_OK;
    char text[300] = "";
    int body = s->width + beside;
    if (body < 560) body = 560; /* the line below and a title need some room */
    int width = body + 2 * MARGIN;
    int scale = title && ph_i_text_width(title, 3) <= body ? 3 : TEXT;
    if (title) fitted(title, body, scale, text, sizeof text);
    p->left = MARGIN;
    p->top = MARGIN + (text[0] ? 9 * scale + 16 : 0);
    int height = (s->height > tall ? s->height : tall) + p->top + 30 + MARGIN;
    PH_TRY(ph_i_picture_new(width, height, &p->picture, err));
    ph_i_text(&p->picture, p->left, MARGIN - 4, scale, text, black);
    draw_axes(p, s);
out:
    return st;
}

static void draw_cell(page *p, const slice *s, ptrdiff_t i, ptrdiff_t j,
                      ph_i_colour colour)
{
    ph_i_fill(&p->picture, p->left + (int)i * s->zoom[0],
              p->top + s->height - (int)(j + 1) * s->zoom[1], s->zoom[0], s->zoom[1],
              colour);
}

/* ---- a scalar field ---- */

/* The values a slice shows and the colours for them. */
typedef struct scale {
    double low, high; /* of the values */
    double from, to;  /* of the colours */
    bool diverging, empty;
    ph_i_colour table[256];
} scale;

static scale scale_of(const slice *s, const double *value)
{
    scale c = {.low = INFINITY, .high = -INFINITY};
    for (ptrdiff_t i = 0; i < s->grid->n[s->right]; i++)
        for (ptrdiff_t j = 0; j < s->grid->n[s->up]; j++) {
            double x = value[slice_cell(s, i, j)];
            if (!isfinite(x)) continue;
            c.low = fmin(c.low, x);
            c.high = fmax(c.high, x);
        }
    c.empty = c.low > c.high;
    if (c.empty) c.low = c.high = 0;
    c.from = c.low;
    c.to = c.high;
    double most = fmax(-c.low, c.high);
    c.diverging = c.low < 0 && c.high > 0 && fmin(-c.low, c.high) > 0.2 * most;
    if (c.diverging) {
        c.from = -most;
        c.to = most;
    }
    if (c.to - c.from <= 1e-12 * most ||
        c.to == c.from) { /* constant: the middle colour */
        double half = most > 1e-300 ? 0.5 * most : 1;
        c.from = c.low - half;
        c.to = c.high + half;
    }
    for (int k = 0; k < 256; k++)
        c.table[k] = c.diverging ? ph_i_diverging(k / 255.0) : ph_i_sequential(k / 255.0);
    return c;
}

static ph_i_colour colour_at(const scale *c, double t)
{
    t = !(t > 0) ? 0 : t > 1 ? 1 : t; /* NaN, of a range that overflows, goes to 0 */
    return c->table[(int)lround(255 * t)];
}

/* A step of 1, 2, 2.5 or 5 times a power of ten that gives three to five ticks. */
static double tick_step(double from, double to)
{
    double ten = pow(10, floor(log10((to - from) / 5)));
    const double steps[] = {1, 2, 2.5, 5, 10, 20};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        double step = steps[i] * ten;
        if (floor(to / step) - ceil(from / step) + 1 <= 5) return step;
    }
    return to - from;
}

enum { BAR = 26, BAR_GAP = 26 };

static void draw_bar(page *p, const slice *s, int height, const scale *c)
{
    int x = p->left + s->width + BAR_GAP;
    for (int row = 0; row < height; row++)
        ph_i_fill(&p->picture, x, p->top + row, BAR, 1,
                  colour_at(c, 1 - (row + 0.5) / height));
    ph_i_frame(&p->picture, x, p->top, BAR, height, black);
    double step = tick_step(c->from, c->to);
    double first = ceil(c->from / step - 1e-9), last = floor(c->to / step + 1e-9);
    for (int i = 0; i <= (int)(last - first); i++) {
        char text[32];
        double k = first + i;
        double t = (k * step - c->from) / (c->to - c->from);
        int y = p->top + (int)lround((1 - t) * (height - 1));
        snprintf(text, sizeof text, "%.5g", k == 0 ? 0.0 : k * step);
        ph_i_fill(&p->picture, x + BAR, y, 7, 1, black);
        ph_i_text(&p->picture, x + BAR + 12, y - 3 * TEXT - 1, TEXT, text, black);
    }
}

static void draw_range(page *p, const slice *s, int tall, const scale *c)
{
    char text[80];
    int y = p->top + (s->height > tall ? s->height : tall) + 14;
    if (c->empty)
        snprintf(text, sizeof text, "no numbers");
    else
        snprintf(text, sizeof text, "%.4g to %.4g", c->low, c->high);
    int x = p->picture.width - MARGIN - ph_i_text_width(text, TEXT);
    if (x < p->left + p->axes_width + 20) y += 22; /* beside the axes there is no room */
    ph_i_text(&p->picture, x, y, TEXT, text, black);
}

static void fix_range(scale *c, double low, double high)
{
    c->from = low;
    c->to = high;
    c->diverging = low < 0 && high > 0 && fmin(-low, high) > 0.2 * fmax(-low, high);
    if (c->diverging) {
        c->to = fmax(-low, high);
        c->from = -c->to;
    }
    for (int k = 0; k < 256; k++)
        c->table[k] =
            c->diverging ? ph_i_diverging(k / 255.0) : ph_i_sequential(k / 255.0);
}

static ph_status draw_scalar(const char *path, const ph_grid *grid, const double *value,
                             int axis, const char *title, const double *range,
                             ph_error *err)
{
    enum { TALL = 160 };
    ph_status st = PH_OK;
    slice s;
    page p = {.left = 0};
    PH_CHECK(path && grid && value, PH_EINVAL, "no path, grid or field for a picture");
    PH_TRY(slice_init(&s, grid, axis, err));
    scale c = scale_of(&s, value);
    if (range) fix_range(&c, range[0], range[1]);
    int beside = BAR_GAP + BAR + 12 + 10 * PH_I_LETTER_WIDTH * TEXT;
    PH_TRY(page_new(&p, &s, beside, TALL, title, err));
    for (ptrdiff_t i = 0; i < grid->n[s.right]; i++)
        for (ptrdiff_t j = 0; j < grid->n[s.up]; j++) {
            double x = value[slice_cell(&s, i, j)];
            draw_cell(&p, &s, i, j,
                      isfinite(x) ? colour_at(&c, (x - c.from) / (c.to - c.from)) : grey);
        }
    ph_i_frame(&p.picture, p.left, p.top, s.width, s.height, black);
    draw_bar(&p, &s, s.height > TALL ? s.height : TALL, &c);
    draw_range(&p, &s, TALL, &c);
    PH_TRY(ph_i_picture_write(&p.picture, path, err));
out:
    ph_i_picture_free(&p.picture);
    return st;
}

ph_status ph_write_png(const char *path, const ph_grid *grid, const double *value,
                       int axis, const char *title, ph_error *err)
{
    return draw_scalar(path, grid, value, axis, title, NULL, err);
}

ph_status ph_write_png_range(const char *path, const ph_grid *grid, const double *value,
                             int axis, const char *title, double low, double high,
                             ph_error *err)
{
    ph_status st = PH_OK;
    const double range[2] = {low, high};
    PH_CHECK(isfinite(low) && isfinite(high) && high > low, PH_EINVAL,
             "a scale from %g to %g", low, high);
    PH_TRY(draw_scalar(path, grid, value, axis, title, range, err));
out:
    return st;
}

/* ---- phases ---- */

static void draw_phases(page *p, const slice *s, const ph_microstructure *micro)
{
    ptrdiff_t ncuts = micro->ncuts;
    for (ptrdiff_t i = 0; i < s->grid->n[s->right]; i++)
        for (ptrdiff_t j = 0; j < s->grid->n[s->up]; j++) {
            ptrdiff_t cell = slice_cell(s, i, j), low = 0, high = ncuts;
            int phase = micro->phase[cell];
            ph_i_colour colour =
                ph_i_material_colour(phase, micro->materials[phase].is_void);
            while (low < high) { /* first cut of this cell: they are sorted */
                ptrdiff_t middle = (low + high) / 2;
                if (micro->cuts[middle].cell < cell)
                    low = middle + 1;
                else
                    high = middle;
            }
            for (; low < ncuts && micro->cuts[low].cell == cell; low++) {
                const ph_cut *cut = &micro->cuts[low];
                if (cut->base >= 0)
                    colour = ph_i_material_colour(cut->base,
                                                  micro->materials[cut->base].is_void);
                colour = ph_i_mix_colours(
                    colour,
                    ph_i_material_colour(cut->material,
                                         micro->materials[cut->material].is_void),
                    cut->fraction);
            }
            draw_cell(p, s, i, j, colour);
        }
}

enum { SWATCH = 22, LEGEND_GAP = 26, LEGEND_TEXT = 22 };

static void draw_legend(page *p, const slice *s, const ph_microstructure *micro,
                        const double *fraction)
{
    int x = p->left + s->width + LEGEND_GAP;
    for (int i = 0; i < micro->nmaterials && i < MAX_LEGEND; i++) {
        int y = p->top + i * (2 * LINE + 6);
        char text[96];
        const ph_material *m = &micro->materials[i];
        ph_i_fill(&p->picture, x + 1, y + 1, SWATCH, SWATCH,
                  ph_i_material_colour(i, m->is_void));
        ph_i_frame(&p->picture, x + 1, y + 1, SWATCH, SWATCH, black);
        fitted(m->name, LEGEND_TEXT * PH_I_LETTER_WIDTH * TEXT, TEXT, text, sizeof text);
        ph_i_text(&p->picture, x + SWATCH + 12, y, TEXT, text, black);
        snprintf(text, sizeof text, "%.2f %%%s", 100 * fraction[i],
                 m->is_void ? ", void" : "");
        ph_i_text(&p->picture, x + SWATCH + 12, y + 20, TEXT, text, soft);
    }
    if (micro->nmaterials > MAX_LEGEND) {
        char text[64];
        snprintf(text, sizeof text, "and %d more", micro->nmaterials - MAX_LEGEND);
        ph_i_text(&p->picture, x, p->top + MAX_LEGEND * (2 * LINE + 6), TEXT, text, soft);
    }
}

/* Pixels that the legend needs to the right of the slice. */
static int legend_width(const ph_microstructure *micro)
{
    int widest = 14; /* "100.00 %, void" */
    for (int i = 0; i < micro->nmaterials && i < MAX_LEGEND; i++) {
        int letters = (int)strlen(micro->materials[i].name);
        if (letters > widest) widest = letters;
    }
    if (widest > LEGEND_TEXT) widest = LEGEND_TEXT;
    return LEGEND_GAP + SWATCH + 12 + widest * PH_I_LETTER_WIDTH * TEXT;
}

ph_status ph_write_phases_png(const char *path, const ph_microstructure *micro, int axis,
                              const char *title, ph_error *err)
{
    ph_status st = PH_OK;
    slice s;
    page p = {.left = 0};
    double *fraction = NULL;
    PH_CHECK(path && micro, PH_EINVAL, "no path or microstructure for a picture");
    PH_TRY(ph_microstructure_check(micro, err));
    PH_TRY(slice_init(&s, &micro->grid, axis, err));
    PH_ALLOC(fraction, micro->nmaterials, "the fractions");
    ph_microstructure_fractions(micro, fraction);
    int lines = micro->nmaterials < MAX_LEGEND ? micro->nmaterials : MAX_LEGEND + 1;
    PH_TRY(page_new(&p, &s, legend_width(micro), lines * (2 * LINE + 6), title, err));
    draw_phases(&p, &s, micro);
    ph_i_frame(&p.picture, p.left, p.top, s.width, s.height, black);
    draw_legend(&p, &s, micro, fraction);
    PH_TRY(ph_i_picture_write(&p.picture, path, err));
out:
    ph_i_picture_free(&p.picture);
    free(fraction);
    return st;
}
