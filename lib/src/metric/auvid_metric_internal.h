/**
 * @file auvid_metric_internal.h
 * Private declarations shared by the files of the metric.
 */
#ifndef AUVID_METRIC_INTERNAL_H
#define AUVID_METRIC_INTERNAL_H

#include "auvid/metric.h"

/* Channels of a row in the residual path. */
enum {
    MOTION_NU = 3,
    MOTION_NU_DOT = MOTION_NU + AUVID_DOF_COUNT,
    MOTION_TAU = MOTION_NU_DOT + AUVID_DOF_COUNT,
    MOTION_COMMAND = MOTION_TAU + AUVID_DOF_COUNT,
    MOTION_LATE = MOTION_COMMAND + AUVID_MAX_COMMANDS /* wrench and commands at the other delays */
};

/** Larger entries of a row are treated as a fault. The squares of 60000 rows up to this limit are
 * finite in single precision. */
#define METRIC_LARGEST_ENTRY AUVID_C(1e15)

/** Returns true for the regressor path, false for the residual path. */
static inline bool auvid_metric_is_linear(const auvid_metric_config_t *cfg)
{
    return AUVID_REGRESSOR_ONLY || cfg->vehicle->regressor != NULL;
}

static inline bool auvid_metric_has_regressor(const auvid_metric_t *m)
{
    return auvid_metric_is_linear(&m->cfg);
}

/** Number of sets of the ring that count. Ages below start with 0 for the newest of them. */
static inline int auvid_metric_sets(const auvid_metric_t *m)
{
    return m->from < m->cfg.sets ? m->cfg.sets - m->from : 0;
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
    uint32_t back = age < 0 ? 0u : (uint32_t)age + m->from + 1u;
    uint32_t block = (m->sets_stored + 2u * blocks - back) % blocks;
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
    return m->channel_at[j + 1] - m->channel_at[j];
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
    while (4 * (stride + 1) * (stride + 1) <= m->window_length - 1) {
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
    m->spent = (uint16_t)(m->spent + 1u < price ? m->spent + 1u : 0u);
    return m->spent == 0;
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
