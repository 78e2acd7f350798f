/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/error.h>

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *ph_status_text(ph_status status)
{
    switch (status) {
#define PH_STATUS_CASE(name, number, text, code)                                         \
    case name:                                                                           \
        return text;
        PH_STATUS_LIST(PH_STATUS_CASE)
#undef PH_STATUS_CASE
    }
    return "unknown status";
}

int ph_status_exit_code(ph_status status)
{
    switch (status) {
#define PH_STATUS_CASE(name, number, text, code)                                         \
    case name:                                                                           \
        return code;
        PH_STATUS_LIST(PH_STATUS_CASE)
#undef PH_STATUS_CASE
    }
    return 1;
}

ph_status ph_error_set(ph_error *err, ph_status status, const char *file, int line,
                       const char *fmt, ...)
{
    if (err && err->status == PH_OK) {
        err->status = status;
        err->file = file;
        err->line = line;
        err->msg[0] = err->key[0] = 0;
        if (!fmt) return status;
        va_list ap;
        va_start(ap, fmt);
        vsnprintf(err->msg, sizeof err->msg, fmt, ap);
        va_end(ap);
    }
    return status;
}

void ph_error_prefix(ph_error *err, const char *fmt, ...)
{
    if (!err || err->status == PH_OK || !fmt) return;
    char old[sizeof err->msg];
    memcpy(old, err->msg, sizeof old);
    va_list ap;
    va_start(ap, fmt);
    int n = vsnprintf(err->msg, sizeof err->msg, fmt, ap);
    va_end(ap);
    if (n < 0) n = 0;
    if ((size_t)n < sizeof err->msg)
        snprintf(err->msg + n, sizeof err->msg - (size_t)n, "%s", old);
}

void ph_error_about(ph_error *err, const char *fmt, ...)
{
    if (!err || err->status == PH_OK || err->key[0] || !fmt) return;
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(err->key, sizeof err->key, fmt, ap);
    va_end(ap);
}
