/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libperihom-rve: microstructures from shapes and from voxel files. Uses libperihom; the
 * library never uses it. Theory: docs/theory/microstructure.md. */
#ifndef PERIHOM_RVE_H
#define PERIHOM_RVE_H

#include <perihom.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How a solid ends along one of its own axes. */
typedef enum ph_extent {
    PH_EXTENT_FREE, /* nowhere: it goes through the box */
    PH_EXTENT_FLAT, /* at a plane, |y| <= half */
    PH_EXTENT_ROUND /* together with the other round axes: sum (y / half)^2 <= 1 */
} ph_extent;

/** A convex solid: every shape of the catalogue is one of these. With y the coordinates
 *  of a point in the solid's own frame, y_i = frame_i . (x - centre),
 *
 *      sum over round axes (y_i / half_i)^2 <= 1   and   |y_i| <= half_i on flat axes.
 *
 *  Three round axes: ellipsoid; two: (elliptic) cylinder, or an ellipse in 2D; none: box. */
typedef struct ph_solid {
    double centre[3];
    double frame[3][3]; /* rows: the solid's axes, orthonormal */
    ph_extent kind[3];
    double half[3];   /* half length along each axis, > 0; INFINITY where free */
    double bounds[3]; /* half extents along the axes of the grid, INFINITY where free */
    int slice;        /* grid axis across which its sections are areas of known form */
    bool prism;       /* those sections are all alike between its two ends */
} ph_solid;

/** A shape of the case file. */
typedef struct ph_shape {
    ph_entry info;
    int dimensions;         /* 2, 3, or 0 for both */
    const char *parameters; /* keys of the case file, for people */
    /** Frame, kinds and half lengths from the inclusion; used by ph_shape_place. */
    ph_status (*place)(const ph_inclusion *inc, const ph_grid *grid, ph_solid *solid,
                       ph_error *err);
} ph_shape;
PH_API extern const ph_shape ph_shapes[];
PH_API extern const size_t ph_nshapes;
/** The shape called `name`, or NULL. */
PH_API const ph_shape *ph_shape_find(const char *name);
/** The solid that an inclusion describes, in a box of this size.
 *
 *  fraction (disk, sphere): the radius at which the periodic array fills that fraction of
 *  the box, images that overlap counted once. axis (ellipsoid, cylinder): the first axis of
 *  the frame; the second is the grid axis most across it (the lowest of equals), made
 *  perpendicular, the third completes a right-handed frame. A cylinder along a grid axis
 *  with no length, or one of at least the box, goes through it.
 *  @return PH_OK; PH_EINVAL with what is missing or wrong. */
PH_API ph_status ph_shape_place(const ph_inclusion *inc, const ph_grid *grid,
                                ph_solid *solid, ph_error *err);

/** Distance-like level of point x: negative inside, positive outside, never larger in
 *  magnitude than the distance to the surface (equal to it for disks, spheres, flat faces).
 *  @param[out] normal unit outward normal of the level surface through x, or NULL */
PH_API double ph_solid_level(const ph_solid *solid, const double x[3], double normal[3]);
/** Volume of the solid inside the box lo..hi; `dimensions` 2: area in the plane of axes 1
 *  and 2. Exact to rounding in 2D and for prisms along an axis; else one-dimensional
 *  adaptive quadrature of exact sections: error about 1e-6, at the worst 1e-4 of the box. */
PH_API double ph_solid_overlap(const ph_solid *solid, int dimensions, const double lo[3],
                               const double hi[3]);
/** Integral of the outward normal over the part of the solid's surface in the box lo..hi:
 *  by the divergence theorem the area of the solid on the lower face minus that on the
 *  upper one, axis by axis. Exact to rounding. */
PH_API void ph_solid_area_vector(const ph_solid *solid, int dimensions,
                                 const double lo[3], const double hi[3], double area[3]);

/** The microstructure of a case: shapes painted in order on the periodic box, or the voxel
 *  file. Unless the case says node_centre, every cell that a surface passes through gets its
 *  cuts (ph_cut). The fractions of a cell with several inclusions are those that can be
 *  seen: ph_microstructure_fractions is the volume of the painted picture.
 *  @return PH_OK; PH_EINVAL with the line of the inclusion; PH_EIO, PH_ENOMEM.
 *  Cost: the cells of each inclusion's bounding box, geometry only at its surface.
 *  Tested: tests/unit/test_build.c, tests/laws/test_painting.c */
PH_API ph_status ph_rve_build(const ph_case *c, ph_microstructure **out, ph_error *err);

/** The cracks of a case and what they do. Owns its arrays but for the values of the steps,
 *  which stay the case's. */
typedef struct ph_crack_plan {
    ph_cracks cracks;
    ph_crack_sequence sequence;
    bool *grows;      /* of the sequence, or NULL */
    ptrdiff_t *start; /* [entries of the case] first crack of each */
} ph_crack_plan;
PH_API void ph_crack_plan_free(ph_crack_plan **plan);
/** Cracks that a case names and draws: a pure function of the case, its seed and its
 *  realisation. Centres of random cracks are uniform in the box; they may cross.
 *  @return PH_OK; PH_EUNPHYSICAL (a density that takes more than 1e6 cracks); PH_ENOMEM.
 *  Tested: tests/unit/test_cracks.c */
PH_API ph_status ph_rve_cracks(const ph_case *c, ph_crack_plan **out, ph_error *err);

/** The problem that a case poses on its microstructure and cracks (or NULL); borrows all
 *  three. */
PH_API ph_problem ph_rve_problem(const ph_case *c, const ph_microstructure *micro,
                                 const ph_crack_plan *plan);

/** A shape of random filler of the case file. */
typedef struct ph_filler_shape {
    ph_entry info;
    const char *parameters; /* keys of the case file, for people */
} ph_filler_shape;
PH_API extern const ph_filler_shape ph_filler_shapes[];
PH_API extern const size_t ph_nfiller_shapes;

/** One random filler: a chain of convex solids about its centre. */
typedef struct ph_placed {
    int kind;           /* index into the case's fillers */
    int cluster;        /* agglomerate it belongs to, from 1; 0: none */
    uint64_t number;    /* of its random numbers, within its kind */
    double centre[3];   /* in the box */
    double frame[3][3]; /* rows: along it, normal, third (2D: axis 3) */
    double length, thickness, width, bend;
    double content;         /* nodes, or true area (2D) or volume */
    double reach;           /* no point of it is farther from the centre */
    ptrdiff_t first, count; /* of its solids, whose centres are relative to its own */
    ptrdiff_t first_point, npoints; /* counting nodes: its nodes */
} ph_placed;

/** What became of one entry of `fillers`. */
typedef struct ph_filler_report {
    ph_counting counting; /* PH_COUNT_NODES or PH_COUNT_AREA, never AUTO */
    ptrdiff_t count;
    double target;     /* volume fraction asked for; NaN where a count was */
    double reached;    /* content of all of them over the box; overlaps count twice */
    double largest;    /* content of the largest one over the box */
    double tensor[9];  /* second-order orientation tensor, by number; 2D: axes 1 and 2 */
    ptrdiff_t relaxed; /* fillers that random addition could not place */
    int sweeps;        /* of the relaxation, 0: not needed */
} ph_filler_report;

/** Every filler of a realisation. Owns its arrays. */
typedef struct ph_packing {
    int dimensions;
    ph_grid grid; /* on which they were drawn: `drawn_on` of the case */
    int nkinds;
    ph_filler_report *kind; /* [nkinds] */
    ptrdiff_t n;
    ph_placed *filler; /* [n]; filler i owns the cells with owner i + 1 */
    ptrdiff_t nsolids;
    ph_solid *solid;
    ptrdiff_t npoints;
    int32_t (*point)[3]; /* cells of that grid away from the centre's */
    int nclusters;
    double (*cluster)[4]; /* centre and radius */
    long tests;           /* exact distance computations that placing took */
} ph_packing;
PH_API void ph_packing_free(ph_packing **packing);

/** Place the random fillers of a case: a pure function of the case, its seed and its
 *  realisation, the same on any number of threads.
 *
 *  Fillers are added one by one while content + half of the next <= target. Where they may
 *  not overlap, random sequential addition [Widom1966] with up to 200 trials each; what finds
 *  no room is put anywhere and pairs are then pushed apart until every gap is kept. Distances
 *  are those of the solids of the chains [Gilbert1988], with every periodic image.
 *  @return PH_OK; PH_EUNPHYSICAL (longer than the box; jammed, with what was reached);
 *          PH_ENOMEM. Cost: linear in the number of fillers up to jamming.
 *  Tested: tests/unit/test_fillers.c, tests/laws/test_placement.c */
PH_API ph_status ph_rve_place(const ph_case *c, ph_packing **out, ph_error *err);
/** Inclusions and a packing (NULL: none) on the grid of the case. */
PH_API ph_status ph_rve_paint(const ph_case *c, const ph_packing *packing,
                              ph_microstructure **out, ph_error *err);
/** Like ph_rve_build, and the fillers that it placed; *packing is NULL where the case has
 *  none. micro->owner is set where it has some. */
PH_API ph_status ph_rve_generate(const ph_case *c, ph_microstructure **micro,
                                 ph_packing **packing, ph_error *err);
enum { PH_RVE_DESCRIPTORS = 16 };
/** Numbers that say how a realisation differs from others, without a solution: for every
 *  kind of filler with contents v_i (shares of the box), lengths L_i (over the box) and
 *  directions n (of the length; of the normal of 3D platelets), averaged along the filler,
 *
 *      sum v_i, share of the cells painted, sum v_i L_i, sum v_i L_i <n_a^2>, sum v_i L_i <n_a^4>
 *
 *  a = 1 in 2D; 1, 2 and 1, 2, 3 in 3D; no directions of particles without aspect ratio. In
 *  the dilute limit the stiffness is linear in such sums. At most 16, the rest is left out.
 *  @param[out] out [PH_RVE_DESCRIPTORS], zeros behind the last
 *  @return PH_OK; PH_EINVAL. Tested: tests/unit/test_descriptors.c */
PH_API ph_status ph_rve_describe(const ph_case *c, const ph_packing *packing,
                                 const ph_microstructure *micro, double *out,
                                 ph_error *err);
/** How many numbers that are. */
PH_API int ph_rve_descriptor_count(const ph_case *c);
/** Distance of two solids, the second moved by `shift`; 2D: in the plane.
 *  @param[in] enough stop as soon as it is known to be at least this
 *  @return a lower bound of the distance that is >= enough where the distance is (up to
 *          1e-9 of the solids' size), and else the distance to 1e-9; 0 where they overlap. */
PH_API double ph_solid_distance(const ph_solid *a, const ph_solid *b,
                                const double shift[3], int dimensions, double enough);

/** What can be said of a microstructure of fillers in a matrix. Owns its arrays. Everything
 *  is seen at the cell centres, the periodic box is the whole space. */
typedef struct ph_statistics {
    int dimensions;
    double fraction;    /* f: share of the cells that are filler */
    ptrdiff_t nlags[3]; /* n / 2 + 1 */
    double
        *two_point[3]; /* [nlags] P(x and x + lag e_a both filler); 0: f, far away: f^2 */
    double
        *lineal_path[3]; /* [nlags] P(all of the lag + 1 cells x .. x + lag are filler) */
    /* lag where (S2 - f^2) / (f - f^2) falls below 1/e, a length; the largest lag where it
     * does not, NaN where there is one phase only */
    double correlation_length[3];
    double
        *correlation; /* [cells] S2 at every lag, lag zero in cell n / 2 of each axis */
    double half_scatter; /* std of the fraction in the 2^d half boxes, over f */
    /* smallest ratio of the box to the larger of correlation length and longest filler */
    double size_indicator;
    ptrdiff_t fillers;
    double nearest_mean, nearest_std, nearest_min; /* between centres; NaN below 2 */
    ptrdiff_t clusters; /* of fillers that touch: neighbouring cells, corners too */
    ptrdiff_t largest;  /* fillers in the largest */
    bool percolates[3]; /* some connected filler reaches its own image along an axis */
    double agglomerate_volume; /* xi: share of the box in the agglomerates */
    double agglomerate_share;  /* zeta: share of the filler in them [Shi2004] */
} ph_statistics;
/** @param[in] packing of ph_rve_generate, or NULL: every material but `matrix` is filler,
 *             and nothing is said of single fillers
 *  @return PH_OK; PH_EINVAL; PH_ENOMEM. Cost: two FFTs and some passes over the cells.
 *  Tested: tests/unit/test_statistics.c */
PH_API ph_status ph_rve_statistics(const ph_microstructure *micro,
                                   const ph_packing *packing, int matrix,
                                   ph_statistics **out, ph_error *err);
PH_API void ph_statistics_free(ph_statistics **statistics);

/** Pictures of the fillers, each with its own colour: 2D as it is; 3D the three slices
 *  through the middle and a shaded orthographic view of the box without its matrix.
 *  @return PH_OK; PH_EINVAL; PH_EIO; PH_ENOMEM. Tested: tests/unit/test_fillers.c */
PH_API ph_status ph_rve_write_picture(const char *path, const ph_microstructure *micro,
                                      int matrix, const char *title, ph_error *err);

/** Phases and owners of a microstructure as an .h5 file with the datasets /phase and /owner,
 *  which `voxels: {file, owners: /owner}` reads back bit for bit (cuts are not kept). */
PH_API ph_status ph_rve_write_owners(const char *path, const ph_microstructure *micro,
                                     ph_error *err);
/** Dataset of whole numbers 0 .. 2^31 - 1 with n cells. @param[out] owner [cells] */
PH_API ph_status ph_rve_read_owners(const char *path, const char *dataset, int dimensions,
                                    const ptrdiff_t n[3], int32_t *owner, ph_error *err);

/** Voxel values of a file, by its ending: .h5 .hdf5, .npy, .png, .raw. Values are 0..65535.
 *  Never takes more memory than a small multiple of what the file holds.
 *  @param[in] dataset  .h5: path of the dataset; else not used
 *  @param[in] type     .raw: "uint8", "uint16" or "int32", little-endian; else not used
 *  @param[in,out] n    cells per axis; for .raw they must be given, else zeros: they are
 *                      found; given ones must agree. Missing axes are 1.
 *  @param[out] values  malloc'd, [n0][n1][n2], caller frees
 *  A picture is [width][height]: axis 1 to the right, axis 2 up.
 *  @return PH_OK; PH_EINVAL for what the file says; PH_EIO if it cannot be read; PH_ENOMEM */
PH_API ph_status ph_rve_read_voxels(const char *path, const char *dataset,
                                    const char *type, int dimensions, ptrdiff_t n[3],
                                    uint16_t **values, ph_error *err);
/** Write voxel values by the ending of the path: .npy and .raw (uint8 if all values fit,
 *  else uint16; `type` of .raw "uint8" or "uint16"), .h5 (dataset, default "/phase").
 *  ph_rve_read_voxels gives the same values back. Replaces the file only when whole. */
PH_API ph_status ph_rve_write_voxels(const char *path, const char *dataset,
                                     const char *type, int dimensions,
                                     const ptrdiff_t n[3], const uint16_t *values,
                                     ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
