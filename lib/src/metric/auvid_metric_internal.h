/**
 * @file auvid_metric_internal.h
 * Private: the path of a model, and what follows from the metric's configuration. Each of the three
 * objects of the metric has its own header: auvid_metric_rows_internal.h,
 * auvid_metric_sets_internal.h and auvid_metric_evaluator_internal.h.
 */
#ifndef AUVID_METRIC_INTERNAL_H
#define AUVID_METRIC_INTERNAL_H

#include "auvid/detail/metric.h"
#include "../base/auvid_math_internal.h"

/** The start of a search, defined in the identifier. The metric only knows which one its path has,
 * so that the linker drops the other one. */
typedef struct auvid_path_start auvid_path_start_t;
/** Of the regressor path: the minimum of the R factor. */
extern const auvid_path_start_t auvid_start_optimum;
/** Of the residual path: Gauss-Newton steps. */
extern const auvid_path_start_t auvid_start_newton;

/**
 * A path: what becomes of the cells of a model, and how a candidate is evaluated. The model names
 * one (vehicle.h); no other code of the library does, so the linker drops the other path.
 *
 *     cells --add_cell--> rows under construction --finish_row--> the set being recorded
 *     ring  --merge-----> R factors | begin, evaluate: cost or residuals | linearise: R factors
 *
 * Each function continues where it stopped when its budget was used up.
 */
struct auvid_path {
    /** Checks the model's functions, the storage and the smoother, but not the number of taps.
     * Statuses of auvid_metric_init. */
    void (*check)(const auvid_metric_config_t *cfg, auvid_refusal_t *why);
    /** Makes the filter, once configuration and layout are in *m. */
    void (*make_filter)(auvid_metric_t *m);
    /** Adds cell n of the record to all rows under construction. The newest of these, begun
     * n % row_cells cells ago, is at `slot`. Nothing else knows what a
     * channel is. */
    void (*add_cell)(auvid_metric_t *m, const auvid_sample_t *cell, uint32_t n, uint32_t slot);
    /** Takes the complete row at `slot`, whose middle is at t_us. */
    void (*finish_row)(auvid_metric_t *m, uint64_t t_us, uint32_t slot);
    /** Rotates a part of the row that waits in rows.waiting into the R factors. NULL: none does. */
    void (*rotate_row)(auvid_metric_t *m);
    /** Begins the evaluation of a candidate. NULL if `linearise` is. */
    void (*begin)(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s);
    /** Continues it, for the cost (PASS_COST) or the residuals (PASS_MEASURE).
     * @return AUVID_OK; AUVID_PENDING */
    auvid_status_t (*evaluate)(auvid_metric_t *m, uint32_t *budget);
    /** Merges the sets before a search; NULL: the cost needs no R factors.
     * @return AUVID_OK; AUVID_PENDING; AUVID_EMPTY (a pass begins again: call it again) */
    auvid_status_t (*merge)(auvid_metric_t *m, uint32_t *budget);
    /** Forms R factors at a result, from rows d residual / d pi. NULL: they are exact as they are.
     * @return AUVID_OK; AUVID_PENDING; AUVID_EMPTY (as for merge: search again) */
    auvid_status_t (*linearise)(auvid_metric_t *m, auvid_metric_windows_t *windows,
                                uint32_t *budget);
    /** How the identifier finds the point at which a search starts. */
    const auvid_path_start_t *start;
};

/** What is known of the parameters before the sets, attached from outside (prior.h). */
typedef struct auvid_metric_prior {
    /** Rotates its rows into the merged factors, after those of the sets. Returns AUVID_OK;
     * AUVID_PENDING; AUVID_EMPTY (repeat the last pass) */
    auvid_status_t (*add_rows)(auvid_metric_t *m, uint32_t *budget);
    /** Residual path: writes the mean of parameter i's prior in DoF j's equation. Returns w: a
     * distance d from it costs as much as (w d)^2 mean squares of the residual; 0: it has none. */
    auvid_real_t (*weight)(const auvid_metric_t *m, int j, int i, auvid_real_t *mean);
    /** The vehicle has changed: discards what holds for the one before only. */
    void (*change_vehicle)(auvid_metric_t *m);
} auvid_metric_prior_t;

/** Attach a prior. */
static inline void auvid_metric_attach_prior(auvid_metric_t *m, const auvid_metric_prior_t *prior,
                                             void *context)
{
    m->prior = prior;
    m->prior_context = context;
}

/** Where a cell is in the record. */
typedef struct {
    uint32_t n;          /**< its number since the last gap */
    uint32_t slot;       /**< of the newest row under construction, begun n % row_cells cells ago */
    auvid_real_t spread; /**< of the interpolation between samples of the velocity */
} auvid_metric_place_t;

/** Adds a cell to the row under construction at `slot`. @param begins it is its first cell
 * @param motion, thrust the weights of columns of motion and of thrust, for forces [0] and for
 * moments [1] */
typedef void auvid_metric_add_t(void *context, uint32_t slot, bool begins,
                                const auvid_real_t motion[2], const auvid_real_t thrust[2]);

/** Columns that are formed outside of the metric from the same cells as its rows, with the same
 * smoother (regressor path). */
typedef struct auvid_metric_extra {
    /** Before a cell: finishes the one before, whose row may be overwritten. */
    void (*finish)(void *context, const auvid_metric_t *m);
    /** A cell, to be added to the rows by auvid_metric_add_extra. */
    void (*cell)(void *context, const auvid_metric_t *m, const auvid_sample_t *cell,
                 const auvid_metric_place_t *place);
    /** The cell completes the row at `slot`. @param counts false: the row is left out
     * @param dofs those that have a row, a bit each */
    void (*take)(void *context, const auvid_metric_t *m, uint32_t slot, bool counts, uint8_t dofs);
} auvid_metric_extra_t;

/** Attach further columns. */
static inline void auvid_metric_attach_extra(auvid_metric_t *m, const auvid_metric_extra_t *extra,
                                             void *context)
{
    m->extra = extra;
    m->extra_context = context;
}

/** Call `add` for each row under construction that the cell meets. */
void auvid_metric_add_extra(const auvid_metric_t *m, const auvid_metric_place_t *place,
                            auvid_metric_add_t *add, void *context);

/** Returns DoF j's regressor in the complete row at `slot`. */
const auvid_real_t *auvid_metric_complete_row(const auvid_metric_t *m, uint32_t slot, int j);

/** Returns the part of DoF j's wrench in this row that fixed parameters explain. */
static inline auvid_real_t auvid_metric_fixed_wrench(const auvid_metric_t *m, uint32_t slot, int j)
{
    return m->rows.fixed_wrench[slot][j];
}

/** Larger entries of a row are treated as a fault. The squares of 60000 rows up to this limit are
 * finite in single precision. */
#define METRIC_LARGEST_ENTRY AUVID_C(1e15)

static inline const auvid_path_t *auvid_metric_path(const auvid_metric_t *m)
{
    return m->cfg.vehicle->path;
}

/** Rotate all of the row that waits into the R factors. */
static inline void auvid_metric_rotate_rows(auvid_metric_t *m)
{
    while (m->rows.waiting != 0) {
        auvid_metric_path(m)->rotate_row(m);
    }
}

/** Does the path store rows, to be evaluated with one delay for all DoF? Else it has R factors. */
static inline bool auvid_path_stores_rows(const auvid_path_t *path)
{
    return AUVID_MAX_COMMANDS > 0 && path->linearise != NULL;
}

static inline bool auvid_metric_stores_rows(const auvid_metric_t *m)
{
    return auvid_path_stores_rows(auvid_metric_path(m));
}

/** Is it the path of rows, also where AUVID_MAX_COMMANDS leaves it no memory? */
static inline bool auvid_path_is_residual(const auvid_path_t *path)
{
    return path->add_cell == NULL || auvid_path_stores_rows(path);
}

/** The larger half-width of the smoother. */
static inline uint32_t auvid_metric_max_half(const auvid_metric_config_t *cfg)
{
    return cfg->half_width[cfg->half_width[1] > cfg->half_width[0]];
}

/** Taps of the filter: of a mean over a row, or of the smoother. */
uint32_t auvid_metric_taps(const auvid_metric_config_t *cfg, bool rows);

/** Counts the columns of all equations, and the numbers of their R factors.
 * @param free as in auvid_metric_config_t */
void auvid_metric_count(const auvid_vehicle_t *vehicle, uint32_t free, uint32_t *columns,
                        uint32_t *factor);

/** Length of the cells in use [us]. */
static inline uint32_t auvid_metric_cell_us(const auvid_metric_t *m)
{
    return m->cfg.cell_us << m->result.doublings;
}

/** Set the period of the velocity samples. Before a cell, and not from or to 0. */
void auvid_metric_set_velocity_us(auvid_metric_t *m, uint32_t velocity_us);

/** Returns the free parameters of DoF j's equation, a bit each. */
static inline uint32_t auvid_metric_free_columns(const auvid_metric_t *m, int j)
{
    return m->layout.columns[j];
}

/** Order of DoF j's R factor: its parameters and the wrench at each delay; 0: not modelled. */
static inline int auvid_metric_order(const auvid_metric_t *m, int j)
{
    return m->layout.channel_at[j + 1] - m->layout.channel_at[j];
}

/** Spacing of the delays at which the wrench is stored [s]. */
AUVID_SHARED auvid_real_t auvid_metric_node_s(const auvid_metric_t *m)
{
    return (auvid_real_t)(m->cfg.cell_us << m->result.doublings) * AUVID_C(1e-6) *
           (auvid_real_t)AUVID_METRIC_DELAY_CELLS;
}

/** Is DoF j excited in some merged set? */
static inline bool auvid_metric_is_excited(const auvid_metric_t *m, int j)
{
    return (m->result.excited >> j & 1) != 0;
}

/** May DoF j's equation be informative although the DoF is excited in no merged set? */
static inline bool auvid_metric_may_be_coupled(const auvid_metric_t *m, int j)
{
    return !auvid_metric_is_excited(m, j) && m->layout.leading[j] > 0 &&
           !auvid_metric_stores_rows(m);
}

/** Put the columns of the merged R factors in order: natural order for an excited DoF, else its own
 * terms first. It follows from result.excited; call it when that changes. */
void auvid_metric_order_columns(auvid_metric_t *m);

/** Returns the free parameters (bit i) of the DoF in `excited` (bit j). */
uint32_t auvid_metric_free_of(const auvid_metric_t *m, uint8_t excited);

/** auvid_metric_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_metric_set_up(auvid_metric_t *metric, const auvid_metric_config_t *cfg,
                         auvid_refusal_t *why);

/** Checksum of what gives the parameters their meaning: names, units, and which are free or fixed,
 * with the fixed values. */
uint32_t auvid_checksum_of_model(const auvid_metric_config_t *cfg);

/** Are the motion of a sample without its acceleration, and its inputs, finite? */
static inline bool auvid_metric_is_finite(const auvid_sample_t *sample)
{
    return auvid_is_finite(sample->phi) && auvid_is_finite(sample->theta) &&
           auvid_is_finite(sample->psi) && auvid_all_finite(sample->nu, AUVID_DOF_COUNT) &&
           auvid_all_finite(sample->tau, AUVID_DOF_COUNT) &&
           auvid_all_finite(sample->command, AUVID_MAX_COMMANDS);
}

#endif
