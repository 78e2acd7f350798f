#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the C source of the extension module perihom._perihom.

Structures are declared with `...`: the C compiler fills in what is not named here, so their
layout is that of the headers and not a copy of it.

usage: build_cffi.py OUTPUT.c
"""
import sys

from cffi import FFI

DECLARATIONS = r"""
typedef int ph_status;
#define PH_EINVAL ...
typedef struct { ph_status status; int iteration; double residual; char msg[...]; ...; } ph_error;
const char *ph_status_text(ph_status status);
int ph_status_exit_code(ph_status status);
const char *ph_version(void);
const char *ph_git_revision(void);

typedef struct { const char *stage; int load, loads, iteration; double residual, tolerance; ...; } ph_progress;
typedef struct { bool (*progress)(void *user, const ph_progress *now); void *user; int threads; ...; } ph_ctx;

typedef struct { const char *name, *title, *reference, *valid; ...; } ph_entry;
typedef struct { const char *name, *title; const size_t *count; ...; } ph_catalogue;
const ph_catalogue *ph_catalogues(void);
const ph_entry *ph_catalogue_entry(const ph_catalogue *catalogue, size_t i);
const ph_catalogue *ph_card_formats(void);

typedef struct { int n; double m[6][6]; ...; } ph_sym4;
void ph_sym4_to_voigt(const ph_sym4 *c, bool stiffness, double *voigt);
ph_sym4 ph_sym4_from_voigt(int n, const double *voigt, bool stiffness);
ph_status ph_sym4_inverse(const ph_sym4 *c, ph_sym4 *inv, ph_error *err);
typedef struct { double E[3]; double nu[3][3]; double G23, G13, G12; ...; } ph_engineering;
ph_status ph_engineering_constants(const ph_sym4 *c, ph_engineering *out, ph_error *err);
typedef struct { double E, nu, K, G, distance; ...; } ph_isotropic;
ph_isotropic ph_nearest_isotropic(const ph_sym4 *c, int kin);

typedef struct { double time; ph_sym4 stiffness; ...; } ph_prony_term;
typedef struct { ph_sym4 equilibrium; int nterms; ph_prony_term *term; ...; } ph_prony;
ph_status ph_prony_new(const ph_sym4 *equilibrium, int nterms, const ph_prony_term *term, ph_prony **out, ph_error *err);
ph_status ph_prony_copy(const ph_prony *p, ph_prony **out, ph_error *err);
void ph_prony_free(ph_prony **p);
ph_sym4 ph_prony_at_time(const ph_prony *p, double t);
ph_sym4 ph_prony_instantaneous(const ph_prony *p);
void ph_prony_complex(const ph_prony *p, double omega, ph_sym4 *re, ph_sym4 *im);
ph_status ph_prony_compress(const ph_prony *p, int nterms, double tolerance, ph_prony **out, double *error, ph_error *err);

typedef struct { char name[64]; bool is_void, is_isotropic; double E, nu, density; ph_sym4 stiffness;
                 ph_prony *relaxation; ...; } ph_material;
typedef struct { double time, modulus; } ph_modulus_term;
typedef struct { double infinity; int nterms; const ph_modulus_term *term; ...; } ph_modulus;
ph_status ph_material_viscoelastic_young(const char *name, const ph_modulus *E, double nu, ph_material *out, ph_error *err);
ph_status ph_material_viscoelastic_bulk_shear(const char *name, const ph_modulus *K, const ph_modulus *G,
                                              ph_material *out, ph_error *err);
ph_status ph_material_viscoelastic_tensor(const char *name, const ph_prony *series, const double *R, ph_material *out,
                                          ph_error *err);
void ph_material_clear(ph_material *m);
ph_status ph_material_isotropic(const char *name, double E, double nu, ph_material *out, ph_error *err);
ph_status ph_material_anisotropic(const char *name, const double *voigt, const double *R, ph_material *out, ph_error *err);
ph_material ph_material_void(const char *name);

typedef struct { int kinematics; ptrdiff_t n[3]; double size[3]; double h[3]; ...; } ph_grid;
ph_status ph_grid_init(ph_grid *grid, int kin, const ptrdiff_t *n, const double *size, ph_error *err);
typedef struct { ph_grid grid; int nmaterials; ph_material *materials; uint16_t *phase; ptrdiff_t ncuts;
                 int32_t *owner; ...; } ph_microstructure;
ph_status ph_microstructure_new(const ph_grid *grid, int nmaterials, const ph_material *materials,
                                ph_microstructure **out, ph_error *err);
void ph_microstructure_free(ph_microstructure **micro);
void ph_microstructure_fractions(const ph_microstructure *micro, double *fraction);

typedef struct { const char *kind; int points; double horizon; bool horizon_is_length; const char *influence;
                 const char *weights; int stabilisation; double stabilisation_value; double crack_tips; double kappa; ...; } ph_model_params;
typedef struct { const char *kind; double tolerance; int max_iterations; const char *precision; ...; } ph_solver_params;
typedef struct { const char *kind; int collar; ...; } ph_constraint_params;
typedef struct { bool given; int criterion; double value, fracture_energy, weibull; ...; } ph_failure_rule;
typedef struct { const ph_failure_rule *material; ph_failure_rule interphase, agglomeration; uint64_t seed, realisation;
                 ...; } ph_failure;
typedef struct { const ph_microstructure *micro; int interface; ph_model_params model;
                 ph_constraint_params constraint; ph_solver_params solver; unsigned loads; bool keep_fields;
                 const ph_failure *failure; ...; } ph_problem;
typedef struct { char name[16]; double value, bar, richardson; double part[12]; const char *why; ...; } ph_error_constant;
typedef struct ph_error_bar { int count; ph_error_constant constant[40]; char why[12][200]; double seconds; ...; } ph_error_bar;
typedef struct { int load; double macro_strain[6]; int nu, ns; double *displacement, *strain, *stress; ...; } ph_fields;
typedef struct { long loads, iterations, applications, ffts; ptrdiff_t collar; size_t history_variables, bond_bits,
                 peak_bytes; } ph_work;
typedef struct { ph_grid grid; ph_sym4 stiffness; unsigned loads; ph_sym4 compliance; unsigned stresses;
                 ph_sym4 voigt, reuss; bool reuss_is_zero;
                 int nmaterials; char (*names)[64]; double *fractions; const char *model, *constraint, *solver,
                 *precision, *route;
                 double horizon; int nloads; int iterations[6]; double residual[6]; bool converged; double hill_mandel,
                 strain_average, asymmetry, stabilisation_energy; ph_work work; double seconds,
                 seconds_solve; int threads; int nnotes; char notes[...][256]; int nfields;
                 ph_fields *fields; struct ph_error_bar *error_bar; ...; } ph_result;
ph_status ph_homogenise(const ph_problem *problem, const ph_ctx *ctx, ph_result **out, ph_error *err);
void ph_result_free(ph_result **result);

typedef struct { ph_entry info; ...; } ph_error_part;
extern const ph_error_part ph_error_parts[];
extern const size_t ph_nerror_parts;

typedef struct { const char *route; double tolerance; int max_points; ...; } ph_relaxation_params;
typedef struct { double s, error; int iterations, added; ...; } ph_carson_point;
typedef struct { const char *route; ph_prony *series; ph_sym4 instantaneous, equilibrium; int lost; double error, error_at;
                 int npoints; ph_carson_point *points; long iterations; double seconds; ph_result *elastic; ...; } ph_viscoelastic;
ph_status ph_viscoelastic_solve(const ph_problem *problem, const ph_relaxation_params *params, const ph_ctx *ctx,
                                ph_viscoelastic **out, ph_error *err);
void ph_viscoelastic_free(ph_viscoelastic **v);

typedef struct { bool given; const char *route; double tolerance; ...; } ph_case_viscoelastic;
typedef struct { double relative, memory; ...; } ph_case_accuracy;
typedef struct { char title[...]; int nmaterials; ph_material *materials; int kinematics; uint64_t seed, realisation;
                 int interface; ph_model_params model; ph_constraint_params constraint; ph_solver_params solver;
                 ph_case_viscoelastic viscoelastic; ph_case_accuracy accuracy; bool fields; ph_failure failure; ...; } ph_case;
typedef struct { int line; bool warning; char message[...]; ...; } ph_case_issue;
typedef struct { size_t count; ph_case_issue *item; ...; } ph_case_issues;
void ph_case_issues_free(ph_case_issues *issues);
void ph_case_issue_text(const ph_case_issue *issue, const char *name, char *text, size_t size);
ph_status ph_case_read(const char *path, const char *const *sets, size_t nsets, ph_case **out,
                       ph_case_issues *issues, ph_error *err);
ph_status ph_case_parse(const char *text, size_t length, const char *name, const char *const *sets, size_t nsets,
                        ph_case **out, ph_case_issues *issues, ph_error *err);
void ph_case_free(ph_case **c);
ph_status ph_case_to_json(const ph_case *c, char **json, ph_error *err);

typedef struct { char name[...]; ...; } ph_quantity;
ph_status ph_quantity_find(const char *name, ph_quantity *out, ph_error *err);
unsigned ph_quantity_loads(const ph_quantity *q, int kin);
ph_status ph_quantity_value(const ph_quantity *q, const ph_result *result, double *out, ph_error *err);

ph_status ph_result_to_json(const ph_result *result, const ph_case *c, const char *command, char **json, ph_error *err);
ph_status ph_write_fields(const char *base, const ph_microstructure *micro, const ph_result *result, const ph_case *c,
                          ph_error *err);
ph_status ph_write_phases_png(const char *path, const ph_microstructure *micro, int axis, const char *title,
                              ph_error *err);
ph_status ph_write_png(const char *path, const ph_grid *grid, const double *value, int axis, const char *title,
                       ph_error *err);

typedef struct { int n; double strain[6]; bool driven; int nknots; double *damage; ph_sym4 *stiffness; double *begin,
                 *end; double correction; ...; } ph_damage_law;
ph_status ph_damage_law_new(int n, const double *strain, int nknots, const double *damage, const ph_sym4 *stiffness,
                            const double *begin, const double *end, ph_damage_law **out, ph_error *err);
ph_status ph_damage_law_copy(const ph_damage_law *law, ph_damage_law **out, ph_error *err);
ph_status ph_damage_law_from_growth(const ph_result *result, const double *strain, double fracture_energy,
                                    ph_damage_law **out, ph_error *err);
void ph_damage_law_free(ph_damage_law **law);
ph_sym4 ph_damage_law_stiffness(const ph_damage_law *law, double damage);
double ph_damage_law_force(const ph_damage_law *law, double damage, const double *strain);
typedef struct { char title[256], unit_length[32], unit_stress[32], unit_time[32]; int kinematics; ph_sym4 stiffness;
                 ph_prony *relaxation; ph_damage_law *damage; double density; ...; } ph_effective;
ph_status ph_effective_from_result(const ph_result *result, const ph_case *c, ph_effective **out, ph_error *err);
ph_status ph_effective_read(const char *path, ph_effective **out, ph_error *err);
void ph_effective_free(ph_effective **effective);
typedef struct ph_point_material ph_point_material;
ph_status ph_point_material_new(const ph_effective *effective, ph_point_material **out, ph_error *err);
void ph_point_material_free(ph_point_material **material);
int ph_point_components(const ph_point_material *material);
size_t ph_point_state_size(const ph_point_material *material);
ptrdiff_t ph_point_tangents(const ph_point_material *material, ptrdiff_t points);
ph_status ph_points_update(const ph_point_material *material, ptrdiff_t points, double *state, const double *dstrain,
                           double dt, double *stress, double *tangent);
typedef struct { const char *name; int id; int symmetry; double tolerance; bool nearest; ...; } ph_card_params;
ph_status ph_card_write(const ph_effective *effective, const char *format, const ph_card_params *params, char **text,
                        double *distance, ph_error *err);

typedef struct { int kinematics; int nd, strains; ptrdiff_t nodes; double (*position)[3]; double *stiffness; ptrdiff_t condensed;
                 ph_sym4 linear, periodic; ...; } ph_superelement;
ph_status ph_superelement_new(const ph_problem *problem, const ph_ctx *ctx, ph_superelement **out, ph_error *err);
void ph_superelement_free(ph_superelement **element);
ph_status ph_superelement_to_mtx(const ph_superelement *element, char **text, ph_error *err);
ph_status ph_superelement_write_h5(const ph_superelement *element, const char *path, ph_error *err);

typedef struct ph_fe2 ph_fe2;
typedef struct ph_fe2_point ph_fe2_point;
typedef struct { size_t cache_bytes; int tangents; double window; ...; } ph_fe2_params;
ph_status ph_fe2_new(const ph_problem *problem, const ph_fe2_params *params, const ph_ctx *ctx, ph_fe2 **out, ph_error *err);
void ph_fe2_free(ph_fe2 **fe2);
int ph_fe2_kind_of(const ph_fe2 *fe2);
int ph_fe2_components(const ph_fe2 *fe2);
ph_status ph_fe2_point_new(ph_fe2 *fe2, ph_fe2_point **out, ph_error *err);
void ph_fe2_point_free(ph_fe2_point **point);
ph_status ph_fe2_update_all(ph_fe2_point *const *point, ptrdiff_t points, const double *dstrain, double dt, double *stress,
                            double *tangent, const ph_ctx *ctx, ph_error *err);
ph_status ph_fe2_accept_all(ph_fe2_point *const *point, ptrdiff_t points, const ph_ctx *ctx, ph_error *err);
void ph_fe2_reject(ph_fe2_point *point);
typedef struct { double time, strain[6], stress[6]; long increments; ptrdiff_t broken_bonds, events; double dissipated;
                 ...; } ph_fe2_state;
ph_status ph_fe2_point_state(const ph_fe2_point *point, ph_fe2_state *out, ph_error *err);
size_t ph_fe2_point_bytes(const ph_fe2_point *point);
ph_status ph_fe2_point_save(const ph_fe2_point *point, void *memory, size_t bytes, ph_error *err);
ph_status ph_fe2_point_restore(ph_fe2_point *point, const void *memory, size_t bytes, ph_error *err);
typedef struct { long updates, hits, solves, iterations, tangents, events, states; size_t bytes; ...; } ph_fe2_counts;
void ph_fe2_counts_get(ph_fe2 *fe2, ph_fe2_counts *out);

ph_status ph_rve_build(const ph_case *c, ph_microstructure **out, ph_error *err);
typedef struct ph_crack_plan ph_crack_plan;
ph_status ph_rve_cracks(const ph_case *c, ph_crack_plan **out, ph_error *err);
void ph_crack_plan_free(ph_crack_plan **plan);
ph_problem ph_rve_problem(const ph_case *c, const ph_microstructure *micro, const ph_crack_plan *plan);

ph_status ph_rve_error_bar(const ph_case *c, const ph_problem *problem, const ph_ctx *ctx, ph_result *result,
                           ph_error *err);
typedef struct { double error; ptrdiff_t nodes[3]; ph_result *result; ...; } ph_fidelity;
void ph_fidelity_free(ph_fidelity **fidelity);
ph_status ph_fidelity_solve(const ph_case *c, const ph_ctx *ctx, ph_fidelity **out, ph_error *err);
ph_status ph_fidelity_to_json(const ph_fidelity *fidelity, const ph_case *c, const char *command, char **json,
                              ph_error *err);
void free(void *);
extern "Python" bool perihom_progress(void *user, const ph_progress *now);
"""

SOURCE = """
#include <perihom.h>
#include <perihom_error_bar.h>
#include <perihom_fidelity.h>
#include <perihom_rve.h>
"""

ffi = FFI()
ffi.cdef(DECLARATIONS)
ffi.set_source("_perihom", SOURCE)
ffi.emit_c_code(sys.argv[1])
