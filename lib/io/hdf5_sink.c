/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/hdf5_sink.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

typedef struct sink_file {
    H5FD_t base; /* HDF5 writes into this: must come first */
    int fd;
    haddr_t end_of_allocation, end_of_file;
    ph_i_hdf5_sink *sink;
} sink_file;

/* What the access properties carry. */
typedef struct sink_info {
    ph_i_hdf5_sink *sink;
} sink_info;

static H5FD_t *sink_open(const char *name, unsigned flags, hid_t access, haddr_t maxaddr)
{
    (void)maxaddr;
    const sink_info *info = H5Pget_driver_info(access);
    if (!info) return NULL;
    sink_file *file = calloc(1, sizeof *file);
    if (!file) {
        info->sink->failed = ENOMEM;
        return NULL;
    }
    int mode = O_RDWR | O_CLOEXEC | (flags & H5F_ACC_TRUNC ? O_TRUNC : 0) |
               (flags & H5F_ACC_CREAT ? O_CREAT : 0);
    file->sink = info->sink;
    file->fd = open(name, mode, 0666);
    if (file->fd < 0) {
        info->sink->failed = errno;
        free(file);
        return NULL;
    }
    return &file->base;
}

static herr_t sink_close(H5FD_t *base)
{
    sink_file *file = (sink_file *)base;
    if (close(file->fd) != 0 && !file->sink->failed) file->sink->failed = errno;
    free(file);
    return 0;
}

static herr_t sink_query(const H5FD_t *base, unsigned long *flags)
{
    (void)base;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
}

static haddr_t sink_get_eoa(const H5FD_t *base, H5FD_mem_t type)
{
    (void)type;
    return ((const sink_file *)base)->end_of_allocation;
}

static herr_t sink_set_eoa(H5FD_t *base, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    ((sink_file *)base)->end_of_allocation = address;
    return 0;
}

static haddr_t sink_get_eof(const H5FD_t *base, H5FD_mem_t type)
{
    (void)type;
    return ((const sink_file *)base)->end_of_file;
}

/* What was dropped reads as zeros. */
static herr_t sink_read(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address,
                        size_t size, void *buffer)
{
    (void)type;
    (void)transfer;
    char *to = buffer;
    while (size > 0) {
        ssize_t n = pread(((sink_file *)base)->fd, to, size, (off_t)address);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        to += n;
        size -= (size_t)n;
        address += (haddr_t)n;
    }
    memset(to, 0, size);
    return 0;
}

static herr_t sink_write(H5FD_t *base, H5FD_mem_t type, hid_t transfer, haddr_t address,
                         size_t size, const void *buffer)
{
    (void)type;
    (void)transfer;
    sink_file *file = (sink_file *)base;
    const char *from = buffer;
    if (address + size > file->end_of_file) file->end_of_file = address + size;
    while (size > 0 && !file->sink->failed) {
        ssize_t n = pwrite(file->fd, from, size, (off_t)address);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            file->sink->failed = n < 0 ? errno : ENOSPC;
            break;
        }
        from += n;
        size -= (size_t)n;
        address += (haddr_t)n;
    }
    return 0;
}

/* HDF5 may allocate more than it writes; the file must be as long as it says. */
static herr_t sink_truncate(H5FD_t *base, hid_t transfer, hbool_t closing)
{
    (void)transfer;
    (void)closing;
    sink_file *file = (sink_file *)base;
    if (file->end_of_allocation == file->end_of_file) return 0;
    if (!file->sink->failed && ftruncate(file->fd, (off_t)file->end_of_allocation) != 0)
        file->sink->failed = errno;
    file->end_of_file = file->end_of_allocation;
    return 0;
}

static const H5FD_class_t sink_class = {
#if H5_VERSION_GE(1, 13, 0)
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)600, /* from the range for private use */
#endif
    .name = "perihom",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_WEAK,
    .fapl_size = sizeof(sink_info),
    .open = sink_open,
    .close = sink_close,
    .query = sink_query,
    .get_eoa = sink_get_eoa,
    .set_eoa = sink_set_eoa,
    .get_eof = sink_get_eof,
    .read = sink_read,
    .write = sink_write,
    .truncate = sink_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

hid_t ph_i_hdf5_sink_access(ph_i_hdf5_sink *sink)
{
    const sink_info info = {sink};
    sink->failed = 0;
    hid_t driver = H5FDregister(&sink_class);
    if (driver < 0) return -1;
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access >= 0 && H5Pset_driver(access, driver, &info) < 0) {
        H5Pclose(access);
        access = -1;
    }
    H5FDunregister(driver); /* the properties keep their own reference */
    return access;
}
