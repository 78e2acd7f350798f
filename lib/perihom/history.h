/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PERIHOM_HISTORY_H
#define PERIHOM_HISTORY_H

#include <perihom/prony.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What happens to the macroscopic strain (or stress): at rest before the first point, then
 *  linear between points. Two points of one time are a jump, and so is a first point that
 *  is not zero. After the last point the value is held. Owns its arrays. */
typedef struct ph_history {
    bool stress;  /* the values are stresses and the response strains; else reverse */
    int n;        /* components, 3 or 6 */
    int npoints;  /* >= 1 */
    double *time; /* [npoints], not decreasing */
    double (*value)[6]; /* [npoints] Voigt order, engineering shear strain */
} ph_history;

/** `npoints` points, all zero. @return PH_OK; PH_EINVAL; PH_ENOMEM */
PH_API ph_status ph_history_new(int n, int npoints, bool stress, ph_history **out,
                                ph_error *err);
PH_API void ph_history_free(ph_history **history);
/** Times finite and not decreasing, at most two points of one time; values finite.
 *  @return PH_OK; PH_EINVAL */
PH_API ph_status ph_history_validate(const ph_history *history, ph_error *err);

/** One component that rises linearly to `value` in time `rise` (0: a jump), stays until
 *  `hold` after that, returns in the same time `rise`, and rests until `rest` after that.
 *  @param rest  0: held, no return
 *  @param component 0-based, Voigt order. @return PH_OK; PH_EINVAL; PH_ENOMEM */
PH_API ph_status ph_history_ramp(int n, int component, bool stress, double value,
                                 double rise, double hold, double rest, ph_history **out,
                                 ph_error *err);
/** mean + amplitude sin(omega t) from t = 0, by straight lines between `points` points a
 *  period (relative error of a line: (2 pi / points)^2 / 8). */
typedef struct ph_cycle {
    double mean, amplitude;
    double omega; /* angular frequency [rad/time, > 0] */
    int cycles;   /* periods, >= 1 */
    int points;   /* >= 4 */
} ph_cycle;
PH_API ph_status ph_history_cycle(int n, int component, bool stress,
                                  const ph_cycle *cycle, ph_history **out, ph_error *err);
/** The value at a time; at a jump, after it. */
PH_API void ph_history_at(const ph_history *history, double time, double value[6]);

/** Response of a relaxation series: stress to a history of strain, strain to one of stress,
 *  by recursion over the pieces, exact for straight lines (no time step, no error of
 *  integration), whatever the ratio of pieces to relaxation times.
 *  @param[in]  times [ntimes] not decreasing; at a jump the value after it
 *  @param[out] response [ntimes][6] Voigt, engineering shear strain; zero before the history
 *  @return PH_OK; PH_EINVAL (history.n differs from that of the series, times); PH_ESINGULAR
 *  (stress history, no inverse); PH_ENOMEM. Cost: O((points + times) terms n^2), for stress
 *  that of ph_prony_creep in addition. Tested: tests/unit/test_history.c */
PH_API ph_status ph_prony_response(const ph_prony *p, const ph_history *history,
                                   int ntimes, const double *times, double (*response)[6],
                                   ph_error *err);

#ifdef __cplusplus
}
#endif
#endif
