/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of campaigns. */
#ifndef RVE_CAMPAIGN_H
#define RVE_CAMPAIGN_H

#include "core/check.h"
#include "io/case_internal.h"
#include "io/text.h"

#include <perihom_campaign.h>

/* Pilots of a size of the RVE, at least. */
enum { PH_I_PILOTS = 4 };

/* A relative_error that is the accuracy of the case, while that is not read. */
#define PH_I_OF_CASE (-1.0)

/** The values that one key takes, and how it is varied. */
typedef struct ph_i_axis {
    char *key;
    size_t count;
    char **value;
    double *number;
} ph_i_axis;

/** Keys of `sweep` are varied independently (each its own group), those of `zip` together,
 *  those of `table` together. Groups are multiplied; the last one runs fastest. */
typedef struct ph_i_sweep {
    size_t naxes, capacity;
    ph_i_axis *axis;
    int *group; /* [naxes] */
    int ngroups;
} ph_i_sweep;

/** sweep, zip and table of the document; complaints go to `r`. */
ph_status ph_i_sweep_read(ph_i_reader *r, const ph_i_node *root, const char *folder,
                          ph_i_sweep *sweep, ph_error *err);
void ph_i_sweep_clear(ph_i_sweep *sweep);
/** Number of points, or 0 where there are more than PH_CAMPAIGN_POINTS. */
int ph_i_sweep_points(const ph_i_sweep *sweep);
/** Index of the value of axis `a` at a point. */
size_t ph_i_sweep_at(const ph_i_sweep *sweep, int point, size_t a);
/** realisations and outputs of the document. */
ph_status ph_i_plan_read(ph_i_reader *r, const ph_i_node *root, ph_campaign *c,
                         ph_error *err);
/** data of the document: its keys must vary, its columns must be there. */
void ph_i_data_read(ph_i_reader *r, const ph_i_node *root, const ph_i_sweep *sweep,
                    ph_campaign *c);
/** Resolve the cases of all points and hash them. */
ph_status ph_i_points_resolve(ph_i_reader *r, const ph_i_node *root,
                              const ph_i_sweep *sweep, const char *const *sets,
                              size_t nsets, ph_campaign *c, ph_error *err);

/* ---- levels.c: cheaper models of the points */

/** What `variance_reduction` asks for. */
typedef struct ph_i_levels {
    bool given, automatic;
    int n;
    bool fillers[PH_MAX_MODELS];
    size_t nsets[PH_MAX_MODELS];
    char **set[PH_MAX_MODELS]; /* overrides of each */
} ph_i_levels;
ph_status ph_i_levels_read(ph_i_reader *r, const ph_i_node *root, ph_i_levels *levels,
                           ph_campaign *c, ph_error *err);
void ph_i_levels_clear(ph_i_levels *levels);
/** The models of a point whose case is there; `sets` made that case. Complaints are added to
 *  `issues`, the hash of the campaign takes them in. */
ph_status ph_i_levels_resolve(const ph_i_levels *levels, int point,
                              const char *const *sets, size_t nsets, ph_campaign *c,
                              ph_case_issues *issues, ph_error *err);
/** grids.c: the grid pair of a point whose models are there. */
ph_status ph_i_grids_find(ph_campaign *c, int point, ph_error *err);
static inline int ph_i_slots(const ph_campaign *c)
{
    return c->npoints * (c->nmodels > 1 ? c->nmodels : 1);
}
static inline bool ph_i_is_fillers(const ph_campaign *c, int slot)
{
    return c->nmodels > 1 && slot / c->npoints == c->fillers_model;
}
/** The case of model m of a point. */
const ph_case *ph_i_slot_case(const ph_campaign *c, int slot);
/** Its outputs (not of the fillers). */
const ph_quantity *ph_i_slot_output(const ph_campaign *c, int slot);
/** Numbers of a realisation, and the name of each: outputs, or what is read off fillers. */
int ph_i_slot_values(const ph_campaign *c, int slot);
void ph_i_slot_name(const ph_campaign *c, int slot, int k, char name[96]);

/* ---- record.c: a line of realisations.jsonl */

/** What became of realisation i of a point. */
typedef struct ph_i_record {
    int point; /* model m of point p is "point" p + m npoints: ph_i_slots(c) of them */
    int64_t i;
    ph_status status; /* PH_OK, or why it failed: then `message` */
    char message[512];
    double value[PH_MAX_OUTPUTS];
    int iterations;
    /* not in the line: these differ from run to run */
    double seconds;
    ph_work work;
} ph_i_record;

enum { PH_I_LINE = 64 * PH_MAX_OUTPUTS + 4096 };
/** The line with its end, in text[PH_I_LINE]. @return its length */
size_t ph_i_record_line(const ph_campaign *c, const ph_i_record *r, char *text);
/** Read it back. False: damaged, or not a line of this campaign. */
bool ph_i_record_parse(const ph_campaign *c, const char *line, size_t length,
                       ph_i_record *r);
/** The first line of the file; allocated by the caller as above. */
size_t ph_i_record_header(const ph_campaign *c, char *text);

/* ---- store.c: the file */

typedef struct ph_i_entry {
    int point;
    bool failed;
    int64_t i;
    int64_t offset;
    int32_t length;
} ph_i_entry;

/** The folder of a campaign, held by one process. */
typedef struct ph_i_store {
    const ph_campaign *c;
    char folder[1024], path[1100];
    int lock, fd;
    int64_t size;  /* bytes of whole lines on disk */
    char *waiting; /* lines not written yet */
    size_t nwaiting, capacity;
    size_t count, room; /* entries, sorted and without doubles after _open and _sort */
    ph_i_entry *entry;
    bool sorted;         /* the file itself is in order and has each realisation once */
    ptrdiff_t dropped;   /* damaged lines found */
    ptrdiff_t differing; /* realisations that came with two results */
    double sync_seconds; /* of the last sync */
    char *window;        /* a piece of the file, for reading lines one by one */
    int64_t window_at, window_size;
} ph_i_store;

/** Make the folder, take its lock, read the file or begin it.
 *  @return PH_OK; PH_EIO (another process has the lock, no permission, realisations of
 *          another campaign); PH_ENOMEM */
ph_status ph_i_store_open(ph_i_store *s, const char *folder, const ph_campaign *c,
                          ph_error *err);
/** Does the folder hold realisations of the campaign? Touches nothing.
 *  @return PH_OK; PH_EIO */
ph_status ph_i_store_probe(const ph_campaign *c, const char *folder, ph_error *err);
/** A line to be written with the next sync. */
ph_status ph_i_store_add(ph_i_store *s, const ph_i_record *r, ph_error *err);
/** Everything added is on disk after it, in one write. On failure the file ends as before. */
ph_status ph_i_store_sync(ph_i_store *s, ph_error *err);
/** Line of an entry, read back. */
ph_status ph_i_store_get(ph_i_store *s, const ph_i_entry *e, ph_i_record *r,
                         ph_error *err);
/** Put the entries in order, one a realisation: a success before a failure, then the
 *  lexicographically first line, so that no order of adding matters. */
ph_status ph_i_store_sort(ph_i_store *s, ph_error *err);
/** Rewrite the file in this order where it is in another. */
ph_status ph_i_store_compact(ph_i_store *s, ph_error *err);
/** Take the lines of another file of the same campaign. */
ph_status ph_i_store_merge(ph_i_store *s, const char *path, ph_error *err);
void ph_i_store_close(ph_i_store *s);

/* ---- tally.c: statistics of every point, fed in any order, counted in index order */

typedef struct ph_i_waiting {
    int64_t i;
    bool failed;
    int iterations;
    double *value;
} ph_i_waiting;

typedef struct ph_i_point_tally {
    int64_t next;   /* realisations 0 .. next - 1 are counted */
    int64_t failed; /* of those */
    bool done;
    ph_sequence *output; /* [noutputs] */
    size_t nwaiting, room;
    ph_i_waiting *waiting;        /* heap by i: those that came early */
    double *kept[PH_MAX_OUTPUTS]; /* with models: values in order, NaN where failed */
    int64_t kept_room;
    double iterations; /* of the first realisations that did not fail, for the cost */
    int costed;
} ph_i_point_tally;

typedef struct ph_i_tally {
    const ph_campaign *c;
    ph_i_point_tally *point; /* [slots] */
    ph_sequence *all;
    ph_estimation *estimation; /* [npoints] with models, else NULL */
} ph_i_tally;
ph_status ph_i_tally_init(ph_i_tally *t, const ph_campaign *c, ph_error *err);
void ph_i_tally_clear(ph_i_tally *t);
ph_status ph_i_tally_add(ph_i_tally *t, const ph_i_record *r, ph_error *err);
/** Realisations 0 .. this - 1 of a point are certainly needed. */
int64_t ph_i_tally_wanted(const ph_i_tally *t, int point);
/** variance.c: room for estimations; their first wants. */
ph_status ph_i_variance_begin(ph_i_tally *t, ph_error *err);
/** Keep the values of a realisation, and decide what comes next where a stage of
 *  its point is complete. */
ph_status ph_i_variance_add(ph_i_tally *t, int slot, bool failed, int iterations,
                            const double *value, ph_error *err);
/** Mean of output k of a point by the estimation so far; false: there is none yet. */
bool ph_i_variance_mean(const ph_i_tally *t, int point, int k, ph_interval *out);
/** What the grid adds to it; n = 0: not known. */
ph_discretisation ph_i_variance_bias(const ph_i_tally *t, int point, int k);
/** All entries of a store. */
ph_status ph_i_tally_load(ph_i_tally *t, ph_i_store *s, bool skip_failed, ph_error *err);

/* ---- pool.c: worker processes */

typedef struct ph_i_task {
    int point;
    int32_t attempt; /* 0, or 1 after the death of a worker */
    int64_t i;
} ph_i_task;

typedef ph_status ph_i_work(void *user, const ph_i_task *task, ph_i_record *out);

enum { PH_I_QUEUE = 32, PH_I_WORKERS = 256 };
typedef struct ph_i_worker {
    long pid; /* 0: none */
    int to, from;
    int first, count; /* ring of tasks that it has */
    ph_i_task queue[PH_I_QUEUE];
} ph_i_worker;

typedef struct ph_i_pool {
    int n, last; /* last: the worker of the last result */
    ph_i_worker *worker;
    ph_i_work *work;
    void *user;
    int keep_out[2]; /* files that workers must not hold */
} ph_i_pool;
ph_status ph_i_pool_start(ph_i_pool *p, int workers, ph_i_work *work, void *user,
                          const int keep_out[2], ph_error *err);
/** Give a worker n more tasks. False: it is dead. */
bool ph_i_pool_send(ph_i_pool *p, int worker, const ph_i_task *task, int n);
/** Wait up to `seconds` for a result. @return 1: a result from `worker`; 2: that worker died,
 *  its tasks are still in its queue, `how` says of what; 0: nothing. */
int ph_i_pool_wait(ph_i_pool *p, double seconds, int *worker, ph_i_record *out, char *how,
                   size_t size);
/** A new process in the place of a dead one, with an empty queue. */
ph_status ph_i_pool_renew(ph_i_pool *p, int worker, ph_error *err);
/** End all workers now. */
void ph_i_pool_stop(ph_i_pool *p);

/* ---- run.c */

/** Wall clock, seconds since some moment. */
double ph_i_clock(void);

/* ---- settle.c, size.c */

/** The campaign once more with more overrides; its stopping rule and grid error stay. */
ph_status ph_i_campaign_reread(const ph_campaign *c, const char *const *sets,
                               size_t nsets, const char *const *more, size_t nmore,
                               ph_campaign **out, ph_error *err);
/** "microstructure.KEY=[128, 128]" */
void ph_i_grid_set(const char *key, const ptrdiff_t *nodes, int axes, char *text,
                   size_t size);
/** What is said where a total error is asked for and nothing is known of the grid. */
extern const char ph_i_grid_words[];
void ph_i_sizes_free(ph_campaign_sizes **sizes);
/** variance.c: operations of a realisation, in node iterations. */
double ph_i_work_of(const ph_case *one, const ph_quantity *output, int noutputs,
                    double iterations);

/* ---- crew.c, result.c */

/** Bytes of realisation 0 of the largest point, asked of a process of its own: it may use
 *  OpenMP, this one not. 0: unknown. @param[in] enough where it is certainly less, a guess that
 *  is too large does */
double ph_i_crew_bytes(const ph_campaign *c, double enough);

/** Worker processes and threads of each, by processors and memory. */
void ph_i_crew_choose(const ph_campaign *c, const ph_campaign_params *params,
                      int *workers, int *threads);
/** Put the file in order and sum it up. */
ph_status ph_i_result_make(ph_i_store *store, ph_campaign_result **out, ph_error *err);

/* ---- rows_hdf5.c, plots.c: what follows from the lines of a sorted store */

ph_status ph_i_rows_write(ph_i_store *store, const char *path, ph_error *err);
ph_status ph_i_plots_write(ph_i_store *s, const ph_campaign_result *r, ph_error *err);

/** FNV-1a, 64 bits. Start with PH_I_HASH_START. */
#define PH_I_HASH_START 0xcbf29ce484222325u
uint64_t ph_i_hash(uint64_t hash, const void *bytes, size_t n);

/** Folder and a relative name; an absolute one stays. */
void ph_i_path_in(const char *folder, const char *name, char *out, size_t size);

/* ---- scenario.c */

/** The case leaves its grid to an accuracy; and what is said where it must not. */
bool ph_i_is_open(const ph_case *c);
extern const char ph_i_open_words[];

/** The result of a scenario's realisation. @param[out] out on failure: as ph_homogenise */
ph_status ph_i_scenario_solve(const ph_scenario *s, const ph_ctx *ctx, ph_result **out,
                              ph_error *err);

#endif
