/**
 * @file auvid_metric_internal.h
 * Private declarations shared by the files of the metric.
 */
#ifndef AUVID_METRIC_INTERNAL_H
#define AUVID_METRIC_INTERNAL_H

#include "auvid/detail/metric.h"
#include "../base/auvid_math_internal.h"

/** Number of cells whose inputs are stored; inputs are the wrench and the commands. */
enum {
    METRIC_PAST = AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + 1,
    METRIC_INPUTS = AUVID_DOF_COUNT + AUVID_MAX_COMMANDS
};

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
    /** Checks the model's functions, the storage and the filter. Statuses of auvid_metric_init. */
    auvid_status_t (*check)(const auvid_metric_config_t *cfg, auvid_refusal_t *why);
    /** Makes the filter, once the configuration is in m->cfg and the rest is zero. */
    void (*make_filter)(auvid_metric_t *m);
    /** Adds cell n of the record to all rows under construction. The newest of these, begun
     * n % row_cells cells ago, is at `slot`. Extra columns of uncertain inputs would follow those
     * of the wrench here: nothing else knows what a channel is. */
    void (*add_cell)(auvid_metric_t *m, const auvid_sample_t *cell, uint32_t n, uint32_t slot);
    /** Takes the complete row at `slot`, whose middle is at t_us. */
    void (*finish_row)(auvid_metric_t *m, uint64_t t_us, uint32_t slot);
    /** Begins the evaluation of a candidate. NULL if `linearise` is. */
    void (*begin)(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s);
    /** Continues it, for the cost (PASS_COST) or the residuals (PASS_MEASURE).
     * @return AUVID_OK; AUVID_PENDING */
    auvid_status_t (*evaluate)(auvid_metric_t *m, uint32_t *budget);
    /** Merges the sets before a search; NULL: the cost needs no R factors.
     * @return true if they are merged */
    bool (*merge)(auvid_metric_t *m, uint32_t *budget);
    /** Forms R factors at a result, from rows d residual / d pi. NULL: they are exact as they are.
     * @return AUVID_OK; AUVID_PENDING */
    auvid_status_t (*linearise)(auvid_metric_t *m, uint32_t *budget);
};

/** Larger entries of a row are treated as a fault. The squares of 60000 rows up to this limit are
 * finite in single precision. */
#define METRIC_LARGEST_ENTRY AUVID_C(1e15)

static inline const auvid_path_t *auvid_metric_path(const auvid_metric_t *m)
{
    return m->cfg.vehicle->path;
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

/** Check that so many taps, made by `field`, and the rows that they overlap, fit. */
auvid_status_t auvid_metric_check_taps(const auvid_metric_config_t *cfg, uint32_t taps,
                                       const char *field, auvid_refusal_t *why);

/** Set the period of the velocity samples. Only before the first cell, and not from or to 0. */
void auvid_metric_set_velocity_us(auvid_metric_t *m, uint32_t velocity_us);

static inline void auvid_metric_set_taps(auvid_metric_t *m, uint32_t taps)
{
    m->layout.taps = (uint8_t)taps;
    m->layout.overlap = (uint8_t)((taps + m->cfg.row_cells - 1u) / m->cfg.row_cells);
}

/** Returns wrench and commands at delay number `delay`, in steps of AUVID_METRIC_DELAY_CELLS. */
static inline const auvid_real_t *auvid_metric_delayed_inputs(const auvid_metric_t *m, int delay)
{
    uint32_t ago = (uint32_t)(delay * AUVID_METRIC_DELAY_CELLS), now = m->rows.cells % METRIC_PAST;
    return m->rows.past_tau[now >= ago ? now - ago : now + METRIC_PAST - ago];
}

/** y += a x; four entries at a time, which halves the cost. */
AUVID_INLINE void auvid_metric_add_scaled(auvid_real_t *y, auvid_real_t a, const auvid_real_t *x,
                                          int n)
{
    for (; n >= 4; n -= 4, x += 4, y += 4) {
        y[0] += a * x[0];
        y[1] += a * x[1];
        y[2] += a * x[2];
        y[3] += a * x[3];
    }
    for (; n > 0; --n) {
        *y++ += a * *x++;
    }
}

/** Record the velocities that were not measured in a cell with a weight in the row. */
static inline void auvid_metric_record_missing(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                               uint8_t missing)
{
    for (int moment = 0; moment <= 1 && missing != 0; ++moment) {
        bool counts = auvid_abs(m->layout.kernel[moment][age]) > AUVID_C(0.0);
        m->rows.missing[slot][moment] |= counts ? missing : 0u;
    }
}

/** Returns the DoF (bit j) that have no row, because the model reads a missing velocity. */
static inline uint8_t auvid_metric_dofs_without_row(const auvid_metric_t *m, uint32_t slot)
{
    unsigned forces = auvid_vehicle_unmeasured(m->cfg.vehicle, m->rows.missing[slot][0]);
    unsigned moments = auvid_vehicle_unmeasured(m->cfg.vehicle, m->rows.missing[slot][1]);
    return (uint8_t)((forces & 7u) | (moments & ~7u));
}

/** Update the mean of the wrench and the sum of squares about it by one value (Welford). */
static inline void auvid_metric_update_wrench_moments(auvid_metric_t *m, int j, auvid_real_t tau)
{
    auvid_real_t off = tau - m->rows.set.tau_mean[j];
    m->rows.set.tau_mean[j] += off / (auvid_real_t)++m->rows.set.rows_of[j];
    m->rows.set.tau_m2[j] += off * (tau - m->rows.set.tau_mean[j]);
}

static inline void auvid_metric_count_lost_rows(auvid_metric_t *m, uint32_t rows)
{
    uint32_t lost = m->rows.set.lost + rows;
    m->rows.set.lost = (uint16_t)(lost < UINT16_MAX ? lost : UINT16_MAX);
}

/** Count a row: taken if some DoF has taken it, else lost. */
static inline void auvid_metric_count_row(auvid_metric_t *m, bool taken)
{
    m->rows.set.rows = (uint16_t)(m->rows.set.rows + taken);
    auvid_metric_count_lost_rows(m, !taken);
}

/** The linearise of the residual path. */
auvid_status_t auvid_metric_linearise_sets(auvid_metric_t *m, uint32_t *budget);

/** Number of sets of the ring that count. Ages below start with 0 for the newest of them. */
static inline int auvid_metric_sets(const auvid_metric_t *m)
{
    return m->sets.from < m->cfg.sets ? m->cfg.sets - m->sets.from : 0;
}

/** Index of the set that entered a ring of `sets` slots `back` sets before the last one; `stored`
 * sets have entered it. */
static inline uint32_t auvid_metric_ring_index(uint32_t stored, uint32_t sets, uint32_t back)
{
    return (stored + 2u * sets - 1u - back) % sets;
}

/** Index in the ring of the set of that age, age < auvid_metric_sets. */
int auvid_metric_slot(const auvid_metric_t *m, int age);

/** Residual path: rows of the set of that age; age -1: rows of the set being recorded. */
static inline auvid_row_t *auvid_metric_rows(const auvid_metric_t *m, int age)
{
    uint32_t blocks = m->cfg.sets + 1u;
    uint32_t back = age < 0 ? 0u : (uint32_t)age + m->sets.from + 1u;
    uint32_t block = (m->sets.stored + 2u * blocks - back) % blocks;
    return m->cfg.rows + block * m->cfg.set_rows;
}

/** Binary digits of an entry of a stored R factor, without the sign; a double keeps all it has. */
enum { AUVID_METRIC_DIGITS = sizeof(auvid_packed_t) == sizeof(int16_t) ? 15 : 52 };

/** Pack m->factor into *set. */
void auvid_metric_pack(const auvid_metric_t *m, auvid_set_t *set);

/** Store the completed set in the ring, in place of the oldest; `excited`: bit j, DoF j. */
void auvid_metric_store_set(auvid_metric_t *m, uint8_t excited);

/** Write row i of one band of DoF j's R factor, of order n, to row[i..n-1]. */
void auvid_metric_unpack_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j,
                             int i, auvid_real_t *row);

/** Order of DoF j's R factor: its parameters and the wrench at each delay; 0: not modelled. */
static inline int auvid_metric_order(const auvid_metric_t *m, int j)
{
    return m->layout.channel_at[j + 1] - m->layout.channel_at[j];
}

/** Spacing of the delays at which the wrench is stored [s]. */
static inline auvid_real_t auvid_metric_node_s(const auvid_metric_t *m)
{
    return (auvid_real_t)m->cfg.cell_us * AUVID_C(1e-6) * (auvid_real_t)AUVID_METRIC_DELAY_CELLS;
}

/** Returns the free parameters (bit i) of the DoF in `excited` (bit j). */
uint32_t auvid_metric_free_of(const auvid_metric_t *m, uint8_t excited);

/** Weights of the wrench at those delays for a delay, or a first-order lag, of s spacings. */
void auvid_metric_delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** Distance in rows of the windows of residuals that are linearised: the standard deviation of the
 * window, sqrt(window_length - 1) / 2. */
static inline int auvid_metric_stride(const auvid_metric_t *m)
{
    int stride = 1;
    while (4 * (stride + 1) * (stride + 1) <= m->layout.window_length - 1) {
        ++stride;
    }
    return stride;
}

/** Derivatives of those weights by s. */
void auvid_metric_delay_slopes(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** Returns ||T l||^2, T the last 3 x 3 block of DoF j's merged R factor: the squared wrench that no
 * pi explains at a delay, or first-order lag, of s spacings. */
auvid_real_t auvid_metric_unexplained(const auvid_metric_t *m, int j, auvid_real_t s, bool lag);

/** Clear the rows of DoF j whose pivot is only rounding and rotate them in at the next column. */
void auvid_metric_clear_dependent(auvid_metric_t *m, int j);

/** Returns the stored sample with wrench and commands at the candidate's delay. */
auvid_sample_t auvid_metric_delayed_sample(const auvid_metric_t *m, const auvid_row_t *row);

/** Set pi and the common delay as the candidate of the next evaluation. */
void auvid_metric_take_candidate(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s);

/** Returns true if a row at `later_us` is the next after one at `earlier_us`, to half a cell. */
static inline bool auvid_metric_succeeds(const auvid_metric_t *m, uint64_t earlier_us,
                                         uint64_t later_us)
{
    uint64_t row_us = (uint64_t)m->cfg.cell_us * m->cfg.row_cells;
    return later_us - earlier_us + m->cfg.cell_us / 2 - row_us <= m->cfg.cell_us;
}

/** Cost of rotating a row into an R factor [units of work]. */
enum { AUVID_METRIC_ROTATION = 4 };

/** Purpose of a pass over the rows of all sets. */
enum { PASS_FIRST, PASS_RESIDUAL, PASS_LAST, PASS_PRIOR, PASS_COST, PASS_MEASURE, PASS_LINEAR };

/** Spend one unit of a step that costs `price`. @return true if all of them are spent: do it */
static inline bool auvid_metric_spend(auvid_metric_t *m, uint32_t *budget, uint16_t price)
{
    --*budget;
    m->evaluator.at.spent =
        (uint16_t)(m->evaluator.at.spent + 1u < price ? m->evaluator.at.spent + 1u : 0u);
    return m->evaluator.at.spent == 0;
}

/** Spend units on a call of the model's residual. @return true if all are spent: call it */
static inline bool auvid_metric_spend_model(auvid_metric_t *m, uint32_t *budget)
{
    uint16_t work = m->cfg.vehicle->work;
    bool due = false;
    while (!due && *budget > 0) {
        due = auvid_metric_spend(m, budget, work);
    }
    return due;
}

/** Row i < count[j] of DoF j in the regressor path's cost, which is ||R pi - z||^2 over all rows
 * of excited DoF. The row has the columns of the n parameters of `active`, then z less what the
 * other parameters explain. row[] has n + 1 entries, at least as many as the model has parameters.
 * */
void auvid_metric_joint_row(const auvid_metric_t *m, int j, int i, uint32_t active,
                            const auvid_real_t *pi, auvid_real_t *row);

/** Check a configuration. *why names what is refused; NULL: not wanted. @return the statuses of
 * auvid_metric_init */
auvid_status_t auvid_metric_check(const auvid_metric_config_t *cfg, auvid_refusal_t *why);

/** Check a prior against the metric's model. Returns the statuses of auvid_metric_set_prior. */
auvid_status_t auvid_metric_check_prior(const auvid_metric_t *metric, const auvid_prior_t *prior);

/** Begin a pass over the rows of all sets. */
void auvid_metric_restart_pass(auvid_metric_t *m, uint8_t pass);

/** Rotate row i of one band of a set's R factor, weighted, into DoF j's merged one. */
void auvid_metric_rotate(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i);

/** After a pass: compute the delay, z and the least-squares candidate of DoF j, and add to
 * `constant`. */
void auvid_metric_solve_dof(auvid_metric_t *m, int j);

/** Continue the passes of a merge from the present one on. @return true if they are complete */
bool auvid_metric_merge_sets(auvid_metric_t *m, uint32_t *budget);

/** Continue the pass begun by auvid_metric_restart_pass. @return true if it is complete */
bool auvid_metric_for_each_row(auvid_metric_t *m, uint32_t *budget);

/** Checksum of what gives the parameters their meaning: names, units, and which are free or fixed,
 * with the fixed values. */
uint32_t auvid_checksum_of_model(const auvid_metric_config_t *cfg);

#endif
