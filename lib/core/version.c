/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <perihom/version.h>

#include "revision.h" /* made by meson in the build folder */

#include <fftw3.h>
#include <gsl/gsl_version.h>
#include <hdf5.h>
#include <jansson.h>
#include <png.h>
#include <suitesparse/cholmod.h>
#include <yaml.h>

#define STRING(x)         #x
#define VERSION3(a, b, c) STRING(a) "." STRING(b) "." STRING(c)

const char *ph_version(void)
{
    return PH_VERSION;
}

const char *ph_git_revision(void)
{
    return PH_GIT_REVISION;
}

/* At run time where the library hands out a string; HDF5 and CHOLMOD only have numbers, and
 * show what perihom was compiled for (HDF5 refuses to run as another version). */
const char *ph_dependency(int i, const char **version)
{
    const char *name = NULL, *v = NULL;
    switch (i) {
    case 0:
        name = "FFTW", v = fftw_version;
        break;
    case 1:
        name = "GSL", v = gsl_version;
        break;
    case 2:
        name = "HDF5";
        v = VERSION3(H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
        break;
    case 3:
        name = "CHOLMOD";
        v = VERSION3(CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION);
        break;
    case 4:
        name = "jansson", v = jansson_version_str();
        break;
    case 5:
        name = "libyaml", v = yaml_get_version_string();
        break;
    case 6:
        name = "libpng", v = png_get_libpng_ver(NULL);
        break;
    default:
        break;
    }
    if (version) *version = v;
    return name;
}

const char *ph_compiler(void)
{
#if defined(__clang__)
    return "clang " __clang_version__;
#elif defined(__GNUC__)
    return "gcc " __VERSION__;
#else
    return "unknown";
#endif
}
