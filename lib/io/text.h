/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text: a growing one, numbers whatever the locale, UTF-8. */
#ifndef PH_IO_TEXT_H
#define PH_IO_TEXT_H

#include "core/check.h"

#include <stdint.h>

/** The whole text as a decimal number, or YAML's .nan and .inf (both give NaN). */
bool ph_i_text_to_number(const char *text, double *out);

/** A growing text with a zero behind it. Once memory has run out it stays so: look at
 *  `failed` when all is written. Zeroed: empty. The owner frees `text`. */
typedef struct ph_i_growing {
    char *text;
    size_t length, capacity;
    bool failed;
} ph_i_growing;

/** False if memory ran out, now or before. */
bool ph_i_append(ph_i_growing *g, const char *piece, size_t size);
void ph_i_appendf(ph_i_growing *g, const char *fmt, ...) PH_PRINTF(2, 3);
/** A number with at most `digits` significant digits ("%.*g") and a decimal point. */
void ph_i_append_number(ph_i_growing *g, double x, int digits);
/** The number with the fewest of 15, 16 or 17 digits that read back as the same double. */
void ph_i_append_exact(ph_i_growing *g, double x);
/** Text as XML character data or attribute value: escaped, control characters as blanks,
 *  bytes that are not UTF-8 as U+FFFD. */
void ph_i_append_xml(ph_i_growing *g, const char *text);

/** Bytes of the UTF-8 character at `text` (1 .. 4) and its code point, 0 if there is none:
 *  overlong, cut off, a surrogate or beyond U+10FFFF. */
int ph_i_utf8(const char *text, size_t length, uint32_t *code);
/** Take one character off a text; 0xfffd for a byte that is none. False at the end. */
bool ph_i_utf8_next(const char **text, uint32_t *code);
/** How many characters that gives. */
int ph_i_utf8_letters(const char *text);

/** Print a number as "%.*f", or "%.*e" where `e`, with a decimal point in any locale. */
void ph_i_number_text(char *out, size_t size, bool e, int digits, double x);
/** Print a number with at most `digits` significant digits ("%.*g"). */
void ph_i_short_number(char *out, size_t size, int digits, double x);

#endif
