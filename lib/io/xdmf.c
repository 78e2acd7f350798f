/* SPDX-License-Identifier: GPL-3.0-or-later */
/* XDMF: where in the HDF5 file ParaView finds the mesh and each field. */
#include "io/fields.h"

#include <string.h>

/* Text as XML character data or attribute value. */
static void put_escaped(FILE *out, const char *text)
{
    for (; *text; text++) {
        unsigned char ch = (unsigned char)*text;
        if (ch == '&')
            fputs("&amp;", out);
        else if (ch == '<')
            fputs("&lt;", out);
        else if (ch == '>')
            fputs("&gt;", out);
        else if (ch == '"')
            fputs("&quot;", out);
        else if (ch >= 0x20) /* XML has no other control characters */
            fputc(ch, out);
        else
            fputc(' ', out);
    }
}

/* What one attribute is. */
typedef struct attribute {
    const char *dataset; /* path in the HDF5 file */
    bool node, vector, phase;
} attribute;

static void put_shape(FILE *out, const hsize_t shape[3])
{
    fprintf(out, "%llu %llu %llu", (unsigned long long)shape[0],
            (unsigned long long)shape[1], (unsigned long long)shape[2]);
}

static void put_attribute(FILE *out, const char *h5, const ph_grid *g, const char *name,
                          attribute a)
{
    hsize_t shape[3];
    ph_i_array_shape(g, a.node, shape);
    fprintf(out, "   <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">\n", name,
            a.vector ? "Vector" : "Scalar", a.node ? "Node" : "Cell");
    fputs("    <DataItem Dimensions=\"", out);
    put_shape(out, shape);
    fprintf(out, "%s\" NumberType=\"%s\" Precision=\"%d\" Format=\"HDF\">",
            a.vector ? " 3" : "", a.phase ? "UInt" : "Float", a.phase ? 2 : 8);
    put_escaped(out, h5);
    fprintf(out, ":%s</DataItem>\n   </Attribute>\n", a.dataset);
}

/* Nodes of the mesh are the corners of the cells; XDMF counts from the slowest axis. A plane
 * is one layer of nodes: ParaView puts a 2DCoRectMesh into the y-z plane. */
static void put_mesh(FILE *out, const ph_grid *g)
{
    hsize_t shape[3];
    ph_i_array_shape(g, 1, shape);
    fputs("   <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"", out);
    put_shape(out, shape);
    fputs("\"/>\n   <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
          "    <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" "
          "Format=\"XML\">0 0 0</DataItem>\n"
          "    <DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" "
          "Format=\"XML\">",
          out);
    fprintf(out, "%.17g %.17g %.17g</DataItem>\n   </Geometry>\n", g->h[2], g->h[1],
            g->h[0]);
}

/* The fields in the group `where`, their names after `prefix`. */
static void put_fields(FILE *out, const char *h5, const ph_grid *g, const ph_fields *f,
                       bool at_nodes, const char *prefix, const char *where)
{
    char name[64], dataset[96];
    if (f->displacement) {
        snprintf(name, sizeof name, "%sdisplacement", prefix);
        snprintf(dataset, sizeof dataset, "%s/displacement", where);
        put_attribute(out, h5, g, name,
                      (attribute){.dataset = dataset, .node = at_nodes, .vector = true});
    }
    for (int k = 0; k < 2 * f->ns; k++) {
        const char *kind = k < f->ns ? "strain" : "stress";
        if (!(k < f->ns ? f->strain : f->stress)) continue;
        const char *component = ph_i_voigt_name(f->ns, k % f->ns);
        snprintf(name, sizeof name, "%s%s%s", prefix, kind, component);
        snprintf(dataset, sizeof dataset, "%s/%s/%s", where, kind, component);
        put_attribute(out, h5, g, name, (attribute){.dataset = dataset});
    }
}

static void put_load(FILE *out, const char *h5, const ph_grid *g, const ph_fields *f,
                     bool at_nodes, const char *group)
{
    const char *load = ph_i_voigt_name(f->ns, f->load);
    char prefix[32], where[64];
    snprintf(prefix, sizeof prefix, "load%s_", load);
    snprintf(where, sizeof where, "%s/loads/%s", group, load);
    put_fields(out, h5, g, f, at_nodes, prefix, where);
}

/* One grid a step in a temporal collection, which ParaView plays. */
static void put_steps(FILE *out, const char *h5, const ph_grid *g, const ph_result *r)
{
    const bool at_nodes = ph_i_displacement_at_nodes(r);
    /* which fields there are: those of any load */
    const ph_fields all = {.ns = ph_strains(g->kinematics),
                           .displacement = &(double){0},
                           .strain = &(double){0},
                           .stress = &(double){0}};
    fputs("  <Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
          out);
    for (int i = 0; i < r->damage->nsteps; i++) {
        char group[32], dataset[64];
        const ph_fields *f;
        int count;
        snprintf(group, sizeof group, "/steps/" PH_I_STEP_NAME, i);
        snprintf(dataset, sizeof dataset, "%s/damage", group);
        fprintf(out, "  <Grid Name=\"step %d\" GridType=\"Uniform\">\n", i);
        fprintf(out, "   <Time Value=\"%.17g\"/>\n", ph_i_step_value(r, i));
        put_mesh(out, g);
        put_attribute(out, h5, g, "phase",
                      (attribute){.dataset = "/phase", .phase = true});
        put_attribute(out, h5, g, "damage", (attribute){.dataset = dataset});
        if (ph_i_step_is_loaded(r, i)) put_fields(out, h5, g, &all, at_nodes, "", group);
        bool loads = ph_i_step_has_loads(r, i, &f, &count);
        for (int k = 0; loads && k < count; k++)
            put_load(out, h5, g, &f[k], at_nodes, group);
        fputs("  </Grid>\n", out);
    }
    fputs("  </Grid>\n", out);
}

static void put_document(FILE *out, const char *h5, const ph_microstructure *micro,
                         const ph_result *result, const ph_case *c)
{
    const ph_grid *g = &micro->grid;
    bool fields = result && result->nfields > 0, steps = ph_i_has_steps(result);
    bool at_nodes = (fields || steps) && ph_i_displacement_at_nodes(result);
    fputs("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n", out);
    const char *title = c ? c->title : "";
    fputs("  <Information Name=\"title\" Value=\"", out);
    put_escaped(out, title);
    fputs("\"/>\n", out);
    if ((fields || steps) && !at_nodes)
        fprintf(out,
                "  <Information Name=\"displacement\" Value=\"cell data, "
                "taken at the %s\"/>\n",
                result->points == PH_POINTS_NODES ? "cell centres"
                                                  : "lower cell corners");
    if (steps) {
        put_steps(out, h5, g, result);
        fputs(" </Domain>\n</Xdmf>\n", out);
        return;
    }
    fputs("  <Grid Name=\"rve\" GridType=\"Uniform\">\n", out);
    put_mesh(out, g);
    put_attribute(out, h5, g, "phase", (attribute){.dataset = "/phase", .phase = true});
    for (int i = 0; fields && i < result->nfields; i++)
        put_load(out, h5, g, &result->fields[i], at_nodes, "");
    fputs("  </Grid>\n </Domain>\n</Xdmf>\n", out);
}

ph_status ph_i_xdmf_text(const char *h5_name, const ph_microstructure *micro,
                         const ph_result *result, const ph_case *c, char **text,
                         size_t *length, ph_error *err)
{
    ph_status st = PH_OK;
    char *made = NULL;
    FILE *out = open_memstream(&made, length);
    PH_CHECK(out, PH_ENOMEM, "no memory for the XDMF description");
    put_document(out, h5_name, micro, result, c);
    bool failed = ferror(out) != 0;
    if (fclose(out) != 0) failed = true;
    PH_CHECK(!failed, PH_ENOMEM, "no memory for the XDMF description");
    *text = made;
    made = NULL;
out:
    free(made);
    return st;
}
