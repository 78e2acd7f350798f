/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a square array of square boron fibres, half the volume, in aluminium. */
#include <perihom.h>

#include <stdio.h>

int main(void)
{
    ph_error err = PH_ERROR_INIT;
    ph_grid grid;
    ph_material phases[2];
    ph_microstructure *rve = NULL;
    ph_result *result = NULL;
    ph_engineering e;

    if (ph_grid_init(&grid, PH_GENERALISED_STRAIN, (ptrdiff_t[]){64, 64},
                     (double[]){1.0, 1.0}, &err) ||
        ph_material_isotropic("aluminium", 68.3, 0.30, &phases[0], &err) ||
        ph_material_isotropic("boron", 379.3, 0.10, &phases[1], &err) ||
        ph_microstructure_new(&grid, 2, phases, &rve, &err))
        goto out;
    for (int i = 9; i < 55; i++)
        for (int j = 9; j < 55; j++)
            rve->phase[i * 64 + j] = 1;

    ph_problem problem = {.micro = rve}; /* every choice at its default */
    if (ph_homogenise(&problem, NULL, &result, &err) ||
        ph_engineering_constants(&result->stiffness, &e, &err))
        goto out;
    printf("E along %.1f GPa, across %.1f GPa, %d iterations\n", e.E[2], e.E[0],
           result->iterations[0]);
out:
    if (err.status) fprintf(stderr, "%s\n", err.msg);
    ph_result_free(&result);
    ph_microstructure_free(&rve);
    return err.status != PH_OK;
}
