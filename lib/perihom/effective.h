/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The effective material of an RVE, apart from the RVE: what a macroscale code needs. */
#ifndef PERIHOM_EFFECTIVE_H
#define PERIHOM_EFFECTIVE_H

#include <perihom/case.h>
#include <perihom/damage_law.h>
#include <perihom/homogenise.h>
#include <perihom/prony.h>

#ifdef __cplusplus
extern "C" {
#endif

/** An effective material. Owns its arrays. Units are those of its case. */
typedef struct ph_effective {
    char title[256];
    char unit_length[32], unit_stress[32], unit_time[32]; /* "" where not known */
    char revision[64]; /* of the program that made it */
    ph_kinematics kinematics;
    ph_sym4 stiffness; /* n = 6, or 3 in plane strain and plane stress; instantaneous */
    ph_prony *relaxation; /* viscoelastic: C(t), whose C(0+) is `stiffness`; else NULL */
    ph_damage_law
        *damage;    /* of a result of a loading: how it fails, the unloaded material
                            * first; `stiffness` is then that of the last step, which may
                            * be singular. Else NULL */
    double density; /* of the mixture; NaN unless every phase has one */
} ph_effective;

PH_API void ph_effective_free(ph_effective **effective);

/** Of a result that has all its columns. @param[in] c its case, for title, units and
 *  densities, or NULL
 *  @return PH_OK; PH_EINVAL (columns are missing); PH_ENOMEM. */
PH_API ph_status ph_effective_from_result(const ph_result *result, const ph_case *c,
                                          ph_effective **out, ph_error *err);
/** Read it back from a result document (schema perihom.result/1, docs/results.md).
 *  @param[in] path of a result.json, or of the folder that holds one
 *  @return PH_OK; PH_EIO (missing, not JSON); PH_EINVAL (not a result, or one without a
 *          stiffness: what is missing is said); PH_ENOMEM. Tested: tests/io/test_effective.c */
PH_API ph_status ph_effective_read(const char *path, ph_effective **out, ph_error *err);
/** The same from text; `name` stands for the file in messages. */
PH_API ph_status ph_effective_parse(const char *text, size_t length, const char *name,
                                    ph_effective **out, ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
