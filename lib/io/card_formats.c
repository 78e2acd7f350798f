/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The words of each code. Orders of components: Abaqus, CalculiX and sfepy 11 22 33 12 13 23;
 * Ansys and LS-DYNA 11 22 33 12 23 13; ours 11 22 33 23 13 12. */
#include "io/card.h"

#include <math.h>
#include <string.h>

static const int abaqus_order[6] = {0, 1, 2, 5, 4, 3};
static const int ansys_order[6] = {0, 1, 2, 5, 3, 4};

static const char *class_of(const ph_i_card *c)
{
    return c->symmetry == PH_SYMMETRY_ISOTROPIC     ? "isotropic"
           : c->symmetry == PH_SYMMETRY_ORTHOTROPIC ? "orthotropic"
                                                    : "anisotropic";
}

/* Where the numbers come from, as comment lines of the code. */
static void head(FILE *to, const ph_i_card *c, const char *mark)
{
    const ph_effective *e = c->effective;
    fprintf(to, "%s %s\n", mark, e->title[0] ? e->title : "effective material");
    fprintf(to, "%s perihom %s; units: length %s, stress %s, time %s\n", mark,
            e->revision, e->unit_length[0] ? e->unit_length : "?",
            e->unit_stress[0] ? e->unit_stress : "?",
            e->unit_time[0] ? e->unit_time : "?");
    fprintf(to, "%s %s, %s; relative distance from the effective tensor %.3g\n", mark,
            c->name, class_of(c), c->distance);
}

/* ---- Abaqus and CalculiX: eight numbers a line ---- */

static void keyword_lines(FILE *to, const double *v, int n)
{
    for (int i = 0; i < n; i++)
        fprintf(to, "%.11g%s", v[i], i == n - 1 ? "\n" : i % 8 == 7 ? ",\n" : ", ");
}

/* D1111 D1122 D2222 D1133 D2233 D3333 D1112 ...: columns of the upper triangle. */
static void keyword_anisotropic(FILE *to, const ph_i_card *c)
{
    double v[21];
    int n = 0;
    for (int j = 0; j < 6; j++)
        for (int i = 0; i <= j; i++)
            v[n++] = c->D[abaqus_order[i]][abaqus_order[j]];
    fprintf(to, "*ELASTIC, TYPE=ANISO\n");
    keyword_lines(to, v, n);
}

static void keyword_elastic(FILE *to, const ph_i_card *c)
{
    const ph_engineering *e = &c->e;
    const double nine[9] = {e->E[0],     e->E[1], e->E[2], e->nu[0][1], e->nu[0][2],
                            e->nu[1][2], e->G12,  e->G13,  e->G23};
    if (c->symmetry == PH_SYMMETRY_ISOTROPIC) {
        fprintf(to, "*ELASTIC, TYPE=ISO\n%.11g, %.11g\n", e->E[0], e->nu[0][1]);
    } else if (c->symmetry == PH_SYMMETRY_ORTHOTROPIC) {
        fprintf(to, "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n");
        keyword_lines(to, nine, 9);
    } else {
        keyword_anisotropic(to, c);
    }
}

/* g_i = G_i / G0, k_i = K_i / K0, tau_i, beside the instantaneous constants. */
static void keyword_prony(FILE *to, const ph_i_card *c)
{
    fprintf(to,
            "*ELASTIC, MODULI=INSTANTANEOUS\n%.11g, %.11g\n*VISCOELASTIC, TIME=PRONY\n",
            c->e.E[0], c->e.nu[0][1]);
    for (int k = 0; k < c->series->nterms; k++)
        fprintf(to, "%.11g, %.11g, %.11g\n", c->G[k + 1] / c->G0, c->K[k + 1] / c->K0,
                c->series->term[k].time);
}

static void write_keyword(FILE *to, const ph_i_card *c)
{
    head(to, c, "**");
    fprintf(to, "*MATERIAL, NAME=%s\n", c->name);
    if (!isnan(c->density)) fprintf(to, "*DENSITY\n%.11g\n", c->density);
    if (c->series)
        keyword_prony(to, c);
    else
        keyword_elastic(to, c);
}

/* ---- Ansys ---- */

static void ansys_property(FILE *to, const ph_i_card *c, const char *label, double x)
{
    fprintf(to, "MP,%s,%d,%.11g\n", label, c->id, x);
}

/* Pairs of relative modulus and time, six numbers a TBDATA. */
static void ansys_prony(FILE *to, const ph_i_card *c, const char *label, const double *m,
                        double m0)
{
    fprintf(to, "TB,PRONY,%d,,%d,%s\n", c->id, c->series->nterms, label);
    for (int k = 0; k < c->series->nterms; k++) {
        if (k % 3 == 0) fprintf(to, "%sTBDATA,%d", k ? "\n" : "", 2 * k + 1);
        fprintf(to, ",%.11g,%.11g", m[k + 1] / m0, c->series->term[k].time);
    }
    fputc('\n', to);
}

static void write_ansys(FILE *to, const ph_i_card *c)
{
    const ph_engineering *e = &c->e;
    head(to, c, "!");
    if (!isnan(c->density)) ansys_property(to, c, "DENS", c->density);
    if (c->symmetry == PH_SYMMETRY_ISOTROPIC) {
        ansys_property(to, c, "EX", e->E[0]);
        ansys_property(to, c, "PRXY", e->nu[0][1]);
    } else if (c->symmetry == PH_SYMMETRY_ORTHOTROPIC) {
        static const char *const label[] = {"EX",   "EY",  "EZ",  "PRXY", "PRYZ",
                                            "PRXZ", "GXY", "GYZ", "GXZ"};
        const double nine[] = {e->E[0],     e->E[1], e->E[2], e->nu[0][1], e->nu[1][2],
                               e->nu[0][2], e->G12,  e->G23,  e->G13};
        for (int i = 0; i < 9; i++)
            ansys_property(to, c, label[i], nine[i]);
    } else {
        fprintf(to, "TB,ANEL,%d,1,21,0\n", c->id);
        int n = 0;
        for (int j = 0; j < 6; j++)
            for (int i = j; i < 6; i++, n++) {
                if (n % 6 == 0) fprintf(to, "%sTBDATA,%d", n ? "\n" : "", n + 1);
                fprintf(to, ",%.11g", c->D[ansys_order[i]][ansys_order[j]]);
            }
        fputc('\n', to);
    }
    if (c->series) {
        ansys_prony(to, c, "SHEAR", c->G, c->G0);
        ansys_prony(to, c, "BULK", c->K, c->K0);
    }
}

/* ---- Code_Aster ---- */

static void write_aster(FILE *to, const ph_i_card *c)
{
    const ph_engineering *e = &c->e;
    head(to, c, "#");
    if (c->symmetry == PH_SYMMETRY_ISOTROPIC) {
        fprintf(to, "%s = DEFI_MATERIAU(ELAS=_F(E=%.11g, NU=%.11g", c->name, e->E[0],
                e->nu[0][1]);
    } else {
        fprintf(to,
                "# axes: L = 1, T = 2, N = 3\n"
                "%s = DEFI_MATERIAU(ELAS_ORTH=_F(E_L=%.11g, E_T=%.11g, E_N=%.11g,\n"
                "    NU_LT=%.11g, NU_LN=%.11g, NU_TN=%.11g,\n"
                "    G_LT=%.11g, G_LN=%.11g, G_TN=%.11g",
                c->name, e->E[0], e->E[1], e->E[2], e->nu[0][1], e->nu[0][2], e->nu[1][2],
                e->G12, e->G13, e->G23);
    }
    if (!isnan(c->density)) fprintf(to, ", RHO=%.11g", c->density);
    fprintf(to, "))\n");
}

/* ---- LS-DYNA: fields of ten characters ---- */

/* A number in at most 10 characters with as many digits as fit. */
static void ten(FILE *to, double x)
{
    char text[40];
    for (int digits = 9; digits > 0; digits--)
        if (snprintf(text, sizeof text, "%.*g", digits, x) <= 10) break;
    fprintf(to, "%10s", text);
}

static void tens(FILE *to, const double *v, int n)
{
    for (int i = 0; i < n; i++)
        ten(to, v[i]);
    fputc('\n', to);
}

/* Axes of the material are the global ones: AOPT 2, a = e1, d = e2. */
static void dyna_axes(FILE *to)
{
    fprintf(to, "$       xp        yp        zp        a1        a2        a3\n");
    tens(to, (const double[]){0, 0, 0, 1, 0, 0}, 6);
    fprintf(to, "$       v1        v2        v3        d1        d2        d3\n");
    tens(to, (const double[]){0, 0, 0, 0, 1, 0}, 6);
}

/* G_i, beta_i = 1 / tau_i, K_i, beta_i; the first term is the equilibrium, beta = 0. */
static void dyna_prony(FILE *to, const ph_i_card *c, double rho)
{
    fprintf(to,
            "*MAT_GENERAL_VISCOELASTIC\n"
            "$      mid        ro      bulk       pcf        ef      tref         a"
            "         b\n%10d",
            c->id);
    tens(to, (const double[]){rho, c->K0, 0, 0, 0, 0, 0}, 7);
    fprintf(to, "$     lcid        nt    bstart     tramp     lcidk       ntk   bstartk"
                "    trampk\n");
    tens(to, (const double[]){0, 0, 0, 0, 0, 0, 0, 0}, 8);
    fprintf(to, "$       gi     betai        ki    betaki\n");
    for (int k = 0; k <= c->series->nterms; k++) {
        double beta = k ? 1.0 / c->series->term[k - 1].time : 0.0;
        tens(to, (const double[]){c->G[k], beta, c->K[k], beta}, 4);
    }
}

static void write_dyna(FILE *to, const ph_i_card *c)
{
    const ph_engineering *e = &c->e;
    double rho = isnan(c->density) ? 0.0 : c->density;
    head(to, c, "$");
    if (isnan(c->density)) fprintf(to, "$ density not known: set RO\n");
    if (c->series) {
        dyna_prony(to, c, rho);
    } else if (c->symmetry == PH_SYMMETRY_ISOTROPIC) {
        fprintf(to, "*MAT_ELASTIC\n%10d", c->id);
        tens(to, (const double[]){rho, e->E[0], e->nu[0][1]}, 3);
    } else if (c->symmetry == PH_SYMMETRY_ORTHOTROPIC) {
        fprintf(to,
                "*MAT_ORTHOTROPIC_ELASTIC\n"
                "$      mid        ro        ea        eb        ec      prba      prca"
                "      prcb\n%10d",
                c->id);
        tens(to,
             (const double[]){rho, e->E[0], e->E[1], e->E[2], e->nu[1][0], e->nu[2][0],
                              e->nu[2][1]},
             7);
        fprintf(to, "$      gab       gbc       gca      aopt\n");
        tens(to, (const double[]){e->G12, e->G23, e->G13, 2}, 4);
        dyna_axes(to);
    } else {
        double v[21];
        int n = 0;
        for (int j = 0; j < 6; j++)
            for (int i = 0; i <= j; i++)
                v[n++] = c->D[ansys_order[i]][ansys_order[j]];
        fprintf(to, "*MAT_ANISOTROPIC_ELASTIC\n%10d", c->id);
        tens(to, (const double[]){rho, v[0], v[1], v[2], v[3], v[4], v[5]}, 7);
        tens(to, v + 6, 8);
        tens(to, (const double[]){v[14], v[15], v[16], v[17], v[18], v[19], v[20], 2}, 8);
        dyna_axes(to);
    }
}

/* ---- OpenRadioss: fields of twenty characters ---- */

static void write_radioss(FILE *to, const ph_i_card *c)
{
    head(to, c, "#");
    if (isnan(c->density)) fprintf(to, "# density not known: set RHO_I\n");
    fprintf(to,
            "/MAT/ELAST/%d\n%s\n#              RHO_I\n%20.11g\n"
            "#                  E                  nu\n%20.11g%20.11g\n",
            c->id, c->name, isnan(c->density) ? 0.0 : c->density, c->e.E[0],
            c->e.nu[0][1]);
}

/* ---- Python: sfepy and FEniCS ---- */

static void python_matrix(FILE *to, const ph_i_card *c, const int *order)
{
    for (int i = 0; i < 6; i++) {
        fprintf(to, "    [");
        for (int j = 0; j < 6; j++)
            fprintf(to, "%.17g%s", c->D[order[i]][order[j]], j < 5 ? ", " : "],\n");
    }
}

static void write_sfepy(FILE *to, const ph_i_card *c)
{
    head(to, c, "#");
    fprintf(to, "import numpy as np\n\n# order 11 22 33 12 13 23, engineering shear\n"
                "D = np.array([\n");
    python_matrix(to, c, abaqus_order);
    fprintf(to, "])\nmaterials = {'%s': ({'D': D},)}\n", c->name);
    if (!isnan(c->density)) fprintf(to, "density = %.17g\n", c->density);
}

static void write_fenics(FILE *to, const ph_i_card *c)
{
    static const int own[6] = {0, 1, 2, 3, 4, 5};
    head(to, c, "#");
    fprintf(to, "import ufl\n\n# order 11 22 33 23 13 12, engineering shear\nD = "
                "ufl.as_matrix([\n");
    python_matrix(to, c, own);
    fprintf(to, "])\n\n\n"
                "def stress(u):\n"
                "    e = ufl.sym(ufl.grad(u))\n"
                "    v = ufl.as_vector([e[0, 0], e[1, 1], e[2, 2],\n"
                "                       2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]])\n"
                "    s = D * v\n"
                "    return ufl.as_matrix([[s[0], s[5], s[4]],\n"
                "                          [s[5], s[1], s[3]],\n"
                "                          [s[4], s[3], s[2]]])\n");
    if (!isnan(c->density)) fprintf(to, "\n\ndensity = %.17g\n", c->density);
}

/* ---- JSON ---- */

static void json_text(FILE *to, const char *text)
{
    fputc('"', to);
    for (const char *p = text; *p; p++) {
        if (*p == '"' || *p == '\\') fputc('\\', to);
        if ((unsigned char)*p >= 0x20) fputc(*p, to);
    }
    fputc('"', to);
}

static void json_matrix(FILE *to, int n, double rows[6][6])
{
    for (int i = 0; i < n; i++) {
        fprintf(to, "  [");
        for (int j = 0; j < n; j++)
            fprintf(to, "%.17g%s", rows[i][j], j < n - 1 ? ", " : "]");
        fputs(i < n - 1 ? ",\n" : "\n ]", to);
    }
}

static void write_json(FILE *to, const ph_i_card *c)
{
    const ph_effective *e = c->effective;
    fprintf(to, "{\"schema\": \"perihom.card/1\", \"title\": ");
    double D[6][6];
    memcpy(D, c->D, sizeof D);
    json_text(to, e->title);
    fprintf(to, ", \"name\": \"%s\",\n \"units\": {\"length\": ", c->name);
    json_text(to, e->unit_length);
    fprintf(to, ", \"stress\": ");
    json_text(to, e->unit_stress);
    fprintf(to, ", \"time\": ");
    json_text(to, e->unit_time);
    fprintf(to,
            "},\n \"symmetry\": \"%s\", \"distance\": %.17g, \"density\": ", class_of(c),
            c->distance);
    fprintf(to, isnan(c->density) ? "null" : "%.17g", c->density);
    fprintf(to, ",\n \"notation\": \"voigt %s, engineering shear\",\n \"stiffness\": [\n",
            c->n == 6 ? "11 22 33 23 13 12" : "11 22 12");
    json_matrix(to, c->n, D);
    for (int k = -1; c->series && k < c->series->nterms; k++) {
        double voigt[36], rows[6][6] = {{0}};
        ph_sym4_to_voigt(k < 0 ? &c->series->equilibrium : &c->series->term[k].stiffness,
                         true, voigt);
        for (int i = 0; i < c->n * c->n; i++)
            rows[i / c->n][i % c->n] = voigt[i];
        if (k < 0)
            fprintf(to, ",\n \"stiffness_infinity\": [\n");
        else
            fprintf(to, "%s{\"time\": %.17g, \"stiffness\": [\n",
                    k ? ", " : ",\n \"terms\": [", c->series->term[k].time);
        json_matrix(to, c->n, rows);
        if (k >= 0) fputc('}', to);
    }
    fputs(c->series ? "]}\n" : "}\n", to);
}

enum {
    ISO = 1 << PH_SYMMETRY_ISOTROPIC,
    ORTHO = 1 << PH_SYMMETRY_ORTHOTROPIC,
    ANISO = 1 << PH_SYMMETRY_ANISOTROPIC
};

const ph_card_format ph_i_card_formats[] = {
    {{"abaqus", "Abaqus: *MATERIAL, *ELASTIC, *VISCOELASTIC", "",
      "any elastic tensor, an isotropic relaxation"},
     ".inp",
     ISO | ORTHO | ANISO,
     false,
     ISO,
     write_keyword,
     0},
    {{"calculix", "CalculiX: *MATERIAL, *ELASTIC", "", "any elastic tensor"},
     ".inp",
     ISO | ORTHO | ANISO,
     false,
     0,
     write_keyword,
     0},
    {{"ansys", "Ansys APDL: MP, TB,ANEL, TB,PRONY", "",
      "any elastic tensor, an isotropic relaxation"},
     ".mac",
     ISO | ORTHO | ANISO,
     false,
     ISO,
     write_ansys,
     0},
    {{"code_aster", "Code_Aster: DEFI_MATERIAU, ELAS or ELAS_ORTH", "",
      "isotropic or orthotropic in the axes of the RVE"},
     ".comm",
     ISO | ORTHO,
     false,
     0,
     write_aster,
     0},
    {{"ls_dyna",
      "LS-DYNA: *MAT_ELASTIC, *MAT_ORTHOTROPIC_ELASTIC, "
      "*MAT_ANISOTROPIC_ELASTIC, *MAT_GENERAL_VISCOELASTIC",
      "", "any elastic tensor, an isotropic relaxation; seven digits or so"},
     ".k",
     ISO | ORTHO | ANISO,
     false,
     ISO,
     write_dyna,
     17}, /* 18 cards, one of them the equilibrium */
    {{"openradioss", "OpenRadioss: /MAT/ELAST", "", "isotropic"},
     ".rad",
     ISO,
     false,
     0,
     write_radioss,
     0},
    {{"sfepy", "sfepy: a NumPy matrix in its order", "", "any elastic tensor"},
     ".py",
     ANISO,
     false,
     0,
     write_sfepy,
     0},
    {{"fenics", "FEniCS (UFL): a matrix and a stress function", "", "any elastic tensor"},
     ".py",
     ANISO,
     false,
     0,
     write_fenics,
     0},
    {{"json", "JSON, schema perihom.card/1", "",
      "any elastic tensor or relaxation series, 2D too"},
     ".json",
     ISO | ORTHO | ANISO,
     true,
     ANISO,
     write_json,
     0},
};
const size_t ph_i_ncard_formats = sizeof ph_i_card_formats / sizeof *ph_i_card_formats;

const ph_catalogue *ph_card_formats(void)
{
    static const ph_catalogue formats = {"formats", "material cards for other codes",
                                         ph_i_card_formats, &ph_i_ncard_formats,
                                         sizeof *ph_i_card_formats};
    return &formats;
}
