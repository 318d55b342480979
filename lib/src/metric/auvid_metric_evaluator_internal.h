/**
 * @file auvid_metric_evaluator_internal.h
 * Private: merged R factors, candidates, and passes over the rows of the sets. Only the files of
 * the evaluator and of the two paths read the members of auvid_metric_evaluator_t.
 */
#ifndef AUVID_METRIC_EVALUATOR_INTERNAL_H
#define AUVID_METRIC_EVALUATOR_INTERNAL_H

#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_sets_internal.h"

/* ---- the merged sets ---- */

/** DoF j's equation in the merged sets: its R factor [R | Z], and R x = z at its delay. */
typedef struct {
    const auvid_real_t *factor;
    const auvid_real_t *z; /**< [count] */
    const uint8_t *index;  /**< [count] the parameter of each column */
    int count;             /**< columns of R */
    int rows;              /**< rows of R that determine parameters: all, unless only coupling
                                moves the DoF */
    int order;             /**< of the R factor; 0: the DoF is not modelled */
    int at;                /**< its first channel */
} auvid_equation_t;

AUVID_SHARED auvid_equation_t auvid_metric_equation(const auvid_metric_t *m, int j)
{
    int at = m->layout.channel_at[j];
    return (auvid_equation_t){.factor = m->evaluator.merged + m->layout.factor_at[j],
                              .z = m->evaluator.z + at,
                              .index = m->layout.merged_index + at,
                              .count = m->layout.count[j],
                              .rows = m->layout.leading[j],
                              .order = m->layout.channel_at[j + 1] - at,
                              .at = at};
}

/** Returns the parameter of each column in the rows of DoF j's equation. The order in the merged
 * sets may differ: auvid_equation_t.index. */
AUVID_INLINE const uint8_t *auvid_metric_row_parameters(const auvid_metric_t *m, int j)
{
    return m->layout.index + m->layout.channel_at[j];
}

/** Returns row i of the equation's R factor, from its diagonal on. */
const auvid_real_t *auvid_equation_row(const auvid_equation_t *e, int i);

/** Returns the relative standard error of a parameter of DoF j's own terms because its equation
 * disagrees with those of the excited DoF; 0 unless only coupling moves the DoF. */
auvid_real_t auvid_metric_disagreement(const auvid_metric_t *m, int j, int parameter);

/** Is DoF j's equation informative through coupling only? */
static inline bool auvid_metric_is_coupled(const auvid_metric_t *m, int j)
{
    return (m->result.coupled >> j & 1) != 0;
}

/** Is DoF j's equation informative, through excitation or coupling? */
static inline bool auvid_metric_is_informative(const auvid_metric_t *m, int j)
{
    return auvid_metric_is_excited(m, j) || auvid_metric_is_coupled(m, j);
}

/** Do DoF j's rows of this set count? All sets count for a DoF that only coupling moves. */
AUVID_SHARED bool auvid_metric_set_counts(const auvid_metric_t *m, const auvid_set_t *set, int j)
{
    return (set->excited >> j & 1) != 0 ||
           ((m->result.coupled >> j & 1) != 0 && set->rows_of[j] > 0);
}

/** Returns the sum of squares of the force that DoF j's equation explains, over the sets that
 * count: of the wrench about each set's mean, or of the force of coupling; *rows: its rows. */
auvid_real_t auvid_metric_force_squares(const auvid_metric_t *m, int j, auvid_real_t *rows);

/** Set the weight of DoF j from the number of its rows. */
void auvid_metric_weigh_dof(auvid_metric_t *m, int j);

/** Weight of DoF j in the cost, 1 / (tau_max^2 rows). */
static inline auvid_real_t auvid_metric_weight(const auvid_metric_t *m, int j)
{
    return m->evaluator.weight[j];
}

/** Weight of one band of DoF j: the inverse of its residual. */
static inline auvid_real_t auvid_metric_band_weight(const auvid_metric_t *m, int band, int j)
{
    return m->evaluator.band_weight[band][j];
}

/** Sum of squares of one band's residuals, DoF j, at the last measurement. */
static inline auvid_real_t auvid_metric_band_squares(const auvid_metric_t *m, int band, int j)
{
    return m->evaluator.band_sse[band][j];
}

/** Number of sets with an excited DoF at the last merge. */
static inline uint8_t auvid_metric_sets_merged(const auvid_metric_t *m)
{
    return m->evaluator.sets_merged;
}

/** Row i < count of DoF j in the regressor path's cost, which is ||R pi - z||^2 over all rows
 * of excited DoF. The row has the columns of the n parameters of `active`, then z less what the
 * other parameters explain. row[] has n + 1 entries, at least as many as the model has parameters.
 * @return false: the DoF has no such row */
bool auvid_metric_joint_row(const auvid_metric_t *m, int j, int i, uint32_t active,
                            const auvid_real_t *pi, auvid_real_t *row);

/* ---- delays, in units of the spacing of those at which the wrench is stored ---- */

/** DoF j's delay in use; *lag: is it that of a first-order lag? */
auvid_real_t auvid_metric_delay(const auvid_metric_t *m, int j, bool *lag);

/** Weights of the wrench at those delays for a delay, or a first-order lag, s. */
void auvid_metric_delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** Derivatives of those weights by s. */
void auvid_metric_delay_slopes(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS]);

/** Returns the squared wrench of DoF j that no pi explains at its delay in use. */
auvid_real_t auvid_metric_unexplained(const auvid_metric_t *m, int j);

/** Clear the rows of DoF j whose pivot is only rounding and rotate them in at the next column. */
void auvid_metric_clear_dependent(auvid_metric_t *m, int j);

/* ---- passes over the rows of the sets ---- */

/** Cost of rotating a row into an R factor [units of work]. */
enum { AUVID_METRIC_ROTATION = 4 };

/** Purpose of a pass over the rows of all sets. */
enum {
    PASS_FIRST,
    PASS_RESIDUAL,
    PASS_LAST,
    PASS_COUPLED,
    PASS_ADDED,
    PASS_COST,
    PASS_MEASURE,
    PASS_LINEAR
};

static inline int auvid_metric_pass(const auvid_metric_t *m)
{
    return m->evaluator.at.pass;
}

/** Spend units on a step that costs `price`, at least one. @return true if all are spent: do it;
 * false: the budget is used up */
static inline bool auvid_metric_spend(auvid_metric_cursor_t *at, uint32_t *budget, uint16_t price)
{
    uint32_t left = price > at->spent ? (uint32_t)price - at->spent : 1u;
    bool all = *budget >= left;
    at->spent = (uint16_t)(all ? 0u : at->spent + *budget);
    *budget -= all ? left : *budget;
    return all;
}

/** Begin a pass over the rows of all sets. */
void auvid_metric_restart_pass(auvid_metric_t *m, uint8_t pass);

/** Continue the pass begun by auvid_metric_restart_pass. @return true if it is complete */
bool auvid_metric_for_each_row(auvid_metric_t *m, uint32_t *budget);

/** Rotate row i of one band of a set's R factor, weighted, into DoF j's merged one.
 * @param more share by which the set's wrench is taken larger */
void auvid_metric_rotate(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i,
                         auvid_real_t more);

/** After a pass: compute the delay, z and the least-squares candidate of DoF j, and add to
 * `constant`. */
void auvid_metric_solve_dof(auvid_metric_t *m, int j);

/** Residual path: distance in rows of the windows that are linearised, the standard deviation of a
 * window, sqrt(window_length - 1) / 2. Regressor path: 1. */
static inline int auvid_metric_stride(const auvid_metric_t *m)
{
    int stride = 1;
    while (4 * (stride + 1) * (stride + 1) <= m->layout.window_length - 1) {
        ++stride;
    }
    return stride;
}

/** Returns the number of DoF j's rows in the merged R factor; on the residual path about that, and
 * of its independent residuals. */
static inline auvid_real_t auvid_metric_merged_rows(const auvid_metric_t *m, int j)
{
    return (auvid_real_t)m->result.dof_rows[j] / (auvid_real_t)auvid_metric_stride(m);
}

/** Rows from outside, auvid_metric_prior_t.add_rows: where it stands. */
static inline auvid_metric_cursor_t *auvid_metric_cursor(auvid_metric_t *m)
{
    return &m->evaluator.at;
}

/** Rotate a row, zero before column k, into DoF j's merged R factor. */
static inline void auvid_metric_add_row(auvid_metric_t *m, int j, int k, auvid_real_t *row)
{
    auvid_qr_update(m->evaluator.merged + m->layout.factor_at[j], auvid_metric_order(m, j), k, row);
}

/** Solve DoF j again with the added rows; `before` is what auvid_metric_unexplained was. */
static inline void auvid_metric_solve_again(auvid_metric_t *m, int j, auvid_real_t before)
{
    m->result.constant -= m->evaluator.weight[j] * before;
    auvid_metric_solve_dof(m, j);
}

/** At the residuals of the first pass: note whether DoF j asks for longer cells. */
void auvid_metric_judge_width(auvid_metric_t *m, int j);

/** After a merge and the search: double the cells and drop all sets, or decide to keep the cells.
 * @return true if they are doubled */
bool auvid_metric_lengthen(auvid_metric_t *m);

/** Continue the passes of a merge from the present one on. @return AUVID_OK; AUVID_PENDING;
 * AUVID_EMPTY: the rows from outside were discarded, and the last pass begins again */
auvid_status_t auvid_metric_merge_sets(auvid_metric_t *m, uint32_t *budget);

/* ---- the residual path ---- */

/** Spend units on a call of the model. @return true if all are spent: call it */
static inline bool auvid_metric_spend_model(auvid_metric_t *m, uint32_t *budget, uint32_t price)
{
    uint16_t work = (uint16_t)(price < UINT16_MAX ? price : UINT16_MAX);
    bool due = false;
    while (!due && *budget > 0) {
        due = auvid_metric_spend(&m->evaluator.at, budget, work);
    }
    return due;
}

/** A model's own thrust at a row has the place of the inputs, which it does not read: the wrench in
 * sample.tau, and in late[0][0] the number of its candidate's thrust. Is the present candidate's
 * there? */
static inline bool auvid_metric_has_thrust(const auvid_metric_t *m, const auvid_row_t *row)
{
    auvid_real_t of = row->late[0][0];
    return m->cfg.vehicle->thrust != NULL && !(of < m->evaluator.thrust) &&
           !(of > m->evaluator.thrust);
}

/** Cost of a call of the residual at a row [units].
 * @param follows the row is the next after that of the last call with these parameters */
static inline uint32_t auvid_metric_residual_work(const auvid_metric_t *m, const auvid_row_t *row,
                                                  bool follows)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    if (auvid_metric_has_thrust(m, row)) {
        return (uint32_t)vehicle->work - vehicle->thrust_work;
    }
    return (uint32_t)vehicle->work + (follows ? 0u : vehicle->lead_work);
}

/** Returns the row's sample with wrench and commands at the candidate's delay: *delayed; or the
 * stored one, if the model reads neither. */
const auvid_sample_t *auvid_metric_delayed_sample(const auvid_metric_t *m, const auvid_row_t *row,
                                                  auvid_sample_t *delayed);

/** Computes the residual at a row, with the model's own thrust if it has one.
 * @param sample auvid_metric_delayed_sample of the row
 * @param perturbed value of `pi` that is not the candidate's; -1: none */
void auvid_metric_residual(const auvid_metric_t *m, auvid_row_t *row, const auvid_sample_t *sample,
                           int perturbed, auvid_real_t residual[AUVID_DOF_COUNT]);

/** Returns true if a row is the next after the last one in the window, to half a cell. */
static inline bool auvid_metric_succeeds(const auvid_metric_t *m, uint64_t t_us)
{
    uint64_t row_us = (uint64_t)m->cfg.cell_us * m->cfg.row_cells;
    return m->evaluator.window_rows > 0 &&
           t_us - m->evaluator.window_us + m->cfg.cell_us / 2 - row_us <= m->cfg.cell_us;
}

/** The linearise of the residual path. */
auvid_status_t auvid_metric_linearise_sets(auvid_metric_t *m, auvid_metric_windows_t *windows,
                                           uint32_t *budget);

/** After a linearisation: row i of DoF j's linear model, weighted as in the cost, which is nearly
 * sum (row . pi + *delay (d - delay_s) - row[n])^2. It has a column for each parameter of the
 * model, then what is explained; row[] has n + 1 entries.
 * @param delay_s where the model was linearised
 * @param delay written: the column of the delay
 * @return false: the DoF has no such row */
bool auvid_metric_newton_row(const auvid_metric_t *m, int j, int i, auvid_real_t delay_s,
                             auvid_real_t *row, auvid_real_t *delay);

/** After auvid_metric_linearise_begin: leave out the rows from outside. */
static inline void auvid_metric_linearise_plain(auvid_metric_t *m)
{
    m->evaluator.at.plain = true;
}

#endif
