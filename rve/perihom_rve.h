/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libperihom-rve: microstructures from shapes and from voxel files. Uses libperihom; the
 * library never uses it. */
#ifndef PERIHOM_RVE_H
#define PERIHOM_RVE_H

#include <perihom.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A solid that can be placed in the periodic box. All coordinates are relative to the
 *  centre of the solid and already wrapped to the nearest periodic image. */
typedef struct ph_shape {
    ph_entry info;
    int dimensions; /* 2, 3, or 0 for both */
    /* Signed distance-like level of point p (< 0 inside), and the unit outward normal. */
    double (*level)(const ph_inclusion *inc, const double p[3], double normal[3]);
    /* Half extents of a box around the solid, for the search. */
    void (*bounds)(const ph_inclusion *inc, double half[3]);
    /* Volume (2D: area) of the solid, before overlaps. */
    double (*volume)(const ph_inclusion *inc);
    /* Exact share of the cell with centre p and edges h inside the solid, or NULL:
     * supersampled. */
    double (*overlap)(const ph_inclusion *inc, const double p[3], const double h[3]);
} ph_shape;
PH_API extern const ph_shape ph_shapes[];
PH_API extern const size_t ph_nshapes;

/** The microstructure of a case: shapes painted in order, or the voxel file.
 *  Cut cells are found and described unless the case says node_centre. */
PH_API ph_status ph_rve_build(const ph_case *c, ph_microstructure **out, ph_error *err);

/** Voxel values of a file, by its ending: .h5, .npy, .png, .raw. Values are 0..65535.
 *  @param[in,out] n cells per axis; for .raw they must be given, else they are found
 *  @param[out] values malloc'd, [n0][n1][n2], caller frees */
PH_API ph_status ph_rve_read_voxels(const char *path, const char *dataset, const char *type,
                                    int dimensions, ptrdiff_t n[3], uint16_t **values,
                                    ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
