/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/fields.h"
#include "io/hdf5.h"

#include <string.h>

const char *const ph_i_kinematics_names[4] = {"space", "generalised_strain", "strain",
                                              "stress"};

const char *ph_i_voigt_name(int n, int a)
{
    static const char *const names[2][6] = {{"11", "22", "12"},
                                            {"11", "22", "33", "23", "13", "12"}};
    return names[n == 6][a];
}

bool ph_i_displacement_at_nodes(const ph_result *result)
{
    bool periodic = !result->constraint || strcmp(result->constraint, "periodic") == 0 ||
                    strcmp(result->constraint, "linear_displacement") == 0;
    return result->points != PH_POINTS_NODES && periodic;
}

void ph_i_array_shape(const ph_grid *grid, int extra, hsize_t shape[3])
{
    for (int a = 0; a < 3; a++) {
        bool wider = a < 2 || grid->kinematics == PH_SPACE;
        shape[2 - a] = (hsize_t)grid->n[a] + (hsize_t)(wider ? extra : 0);
    }
}

/* A member of a compound type. */
typedef struct member {
    const char *name;
    size_t offset;
    hid_t type;
} member;

static ph_status compound(size_t size, size_t count, const member *list, hid_t *out,
                          const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    hid_t type = -1;
    PH_HDF5(type = H5Tcreate(H5T_COMPOUND, size), "describe");
    for (size_t i = 0; i < count; i++)
        PH_HDF5(H5Tinsert(type, list[i].name, list[i].offset, list[i].type), "describe");
    *out = type;
    type = -1;
out:
    if (type >= 0) H5Tclose(type);
    return st;
}

ph_status ph_i_material_type(hid_t *out, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    const hsize_t shape[2] = {6, 6};
    hid_t name = -1, matrix = -1;
    PH_HDF5(name = H5Tcopy(H5T_C_S1), "describe");
    PH_HDF5(H5Tset_size(name, sizeof((ph_i_material_row *)0)->name), "describe");
    PH_HDF5(matrix = H5Tarray_create2(H5T_NATIVE_DOUBLE, 2, shape), "describe");
    const member list[] = {
        {"name", offsetof(ph_i_material_row, name), name},
        {"void", offsetof(ph_i_material_row, is_void), H5T_NATIVE_INT},
        {"isotropic", offsetof(ph_i_material_row, is_isotropic), H5T_NATIVE_INT},
        {"E", offsetof(ph_i_material_row, E), H5T_NATIVE_DOUBLE},
        {"nu", offsetof(ph_i_material_row, nu), H5T_NATIVE_DOUBLE},
        {"density", offsetof(ph_i_material_row, density), H5T_NATIVE_DOUBLE},
        {"fraction", offsetof(ph_i_material_row, fraction), H5T_NATIVE_DOUBLE},
        {"stiffness", offsetof(ph_i_material_row, voigt), matrix},
    };
    PH_TRY(compound(sizeof(ph_i_material_row), sizeof list / sizeof *list, list, out,
                    path, err));
out:
    if (matrix >= 0) H5Tclose(matrix);
    if (name >= 0) H5Tclose(name);
    return st;
}

ph_status ph_i_cut_type(hid_t *out, const char *path, ph_error *err)
{
    ph_status st = PH_OK;
    const hsize_t three = 3;
    hid_t index = -1, normal = -1;
    PH_HDF5(index = H5Tarray_create2(H5T_NATIVE_INT64, 1, &three), "describe");
    PH_HDF5(normal = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three), "describe");
    const member list[] = {
        {"index", offsetof(ph_i_cut_row, index), index},
        {"base", offsetof(ph_i_cut_row, base), H5T_NATIVE_INT},
        {"material", offsetof(ph_i_cut_row, material), H5T_NATIVE_INT},
        {"fraction", offsetof(ph_i_cut_row, fraction), H5T_NATIVE_DOUBLE},
        {"normal", offsetof(ph_i_cut_row, normal), normal},
    };
    PH_TRY(
        compound(sizeof(ph_i_cut_row), sizeof list / sizeof *list, list, out, path, err));
out:
    if (normal >= 0) H5Tclose(normal);
    if (index >= 0) H5Tclose(index);
    return st;
}
