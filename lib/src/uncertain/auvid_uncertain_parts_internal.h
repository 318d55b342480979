/**
 * @file auvid_uncertain_parts_internal.h
 * Private: the parts of the uncertain inputs.
 */
#ifndef AUVID_UNCERTAIN_PARTS_INTERNAL_H
#define AUVID_UNCERTAIN_PARTS_INTERNAL_H

#include "auvid_uncertain_table_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

/** Where a parameter is in the joint factor; its last column is the thrust. */
enum { PARAMETERS_AT = AUVID_UNCERTAIN_SHARED, JOINT_ORDER = AUVID_UNCERTAIN_JOINT };

/** Phases of a solution, auvid_uncertain_solution_t.phase. */
enum {
    SOLVE_PREPARE,
    SOLVE_ROWS,
    SOLVE_OWN,
    SOLVE_TRANSFER,
    SOLVE_SHARED,
    SOLVE_FINISH,
    SOLVE_SCALE,
    SOLVE_REDUCE, /**< from its second step to SOLVE_START, id->optimum is in use */
    SOLVE_OPTIMUM,
    SOLVE_START,
    SOLVE_SEARCH, /**< id->optimizer is in use, if id->work.searching */
    SOLVE_KEEP,
    SOLVE_SIDES,
    SOLVE_SIGMA,
    SOLVE_CAUSES,
    SOLVE_DONE
};

/** Lay out the columns of all equations. *why: AUVID_ERR_SIZE if there is not enough room */
void auvid_uncertain_lay_out(auvid_uncertain_t *u, const auvid_metric_t *m, auvid_refusal_t *why);

/** Compare the thrusters' forces of a cell with the wrench that was recorded. */
void auvid_uncertain_compare(auvid_uncertain_t *u, const auvid_metric_t *m,
                             const auvid_sample_t *cell);

/** Compute the channels of a cell: the inputs of each equation, and last its thrust. */
void auvid_uncertain_channels(auvid_uncertain_t *u, const auvid_metric_t *m,
                              const auvid_sample_t *cell);

/** Returns the supplied force of thruster i [N]; 0 if it can give none. */
static inline auvid_real_t auvid_uncertain_force(const auvid_uncertain_t *u, int i,
                                                 auvid_real_t command)
{
    const auvid_thruster_t *t = &u->allocation->cfg.thruster[i];
    auvid_real_t forward = t->max_N, backward = -t->min_N;
    if (!(forward > AUVID_C(0.0)) && !(backward > AUVID_C(0.0))) {
        return AUVID_C(0.0);
    }
    return u->cfg.fractions ? command * (command > AUVID_C(0.0) ? forward : backward) : command;
}

/** Advance the propellers' speeds over a part of a cell: auvid_recorder_t.take_part.
 * @param context auvid_uncertain_t */
void auvid_uncertain_advance_propellers(void *context, uint32_t cell, bool opens, uint32_t us,
                                        const auvid_real_t *value);

/** Take the propellers' forces in the cell that the recorder has just given. */
void auvid_uncertain_take_forces(auvid_uncertain_t *u);

/** Take the next step with the last cell: form its channels, or add them to the rows.
 * @return false: there was none, the next cell may come */
bool auvid_uncertain_add_cell(auvid_identifier_t *id);

/** Rotate one band of a complete row of a DoF into its factor, if one waits. */
void auvid_uncertain_rotate(auvid_identifier_t *id);

/** Forget the rows. */
void auvid_uncertain_restart(auvid_uncertain_t *u);

/** Begin the solution, from the last one or from the estimate without uncertain inputs. */
void auvid_uncertain_begin(auvid_uncertain_t *u);

/** Continue it. @return AUVID_OK: .pi, .shared and .own are written, and the covariance of the
 * parameters, packed, is in .work.part.factor; AUVID_PENDING */
auvid_status_t auvid_uncertain_solve(auvid_uncertain_t *u, const auvid_metric_t *m,
                                     uint32_t *budget);

/** Can a solution be at step i of this phase, of DoF j? @param projected its rows are */
bool auvid_uncertain_is_step(const auvid_uncertain_t *u, const auvid_metric_t *m, int phase, int j,
                             int i, bool projected);

/** Returns the number of DoF j's columns that are eliminated within its equation, the first ones:
 * its own inputs; in roll and pitch all inputs. */
int auvid_uncertain_eliminated(const auvid_uncertain_t *u, int j);

/** Column of the joint factor of column k of DoF j, k >= own. */
int auvid_uncertain_joint_column(const auvid_uncertain_t *u, const auvid_metric_t *m, int j, int k);

/** Prepare DoF j's part of a pass: residual, weights of the bands, changes of the columns. */
void auvid_uncertain_prepare(auvid_uncertain_t *u, const auvid_metric_t *m, int j);

/** At the end of the first and second solution: DoF j's rows from before it count less from now on,
 * because their columns of current, lever arm and late DVL are of no vehicle, or of no current. */
void auvid_uncertain_forget_early(auvid_uncertain_t *u, const auvid_metric_t *m, int j);

/** Find what column k of DoF j, of the hull, has of its linear and quadratic drag. Writes
 * work.part.drag_at, too. */
void auvid_uncertain_drag_parts(auvid_uncertain_t *u, const auvid_metric_t *m, int j, int k,
                                auvid_real_t part[2]);

/** Rotate row i of one band, with its changed columns, into the DoF's factor. */
void auvid_uncertain_add_row(auvid_uncertain_t *u, int j, int band, int i);

/** Rotate the prior of its input k into the DoF's factor. */
void auvid_uncertain_add_own_prior(auvid_uncertain_t *u, const auvid_metric_t *m, int j, int k);

/** Keep the rows of the own inputs; eliminate from the side what is eliminated. */
void auvid_uncertain_keep_own(auvid_uncertain_t *u, const auvid_metric_t *m, int j);

/** Rotate row i of the DoF's factor, of no column that is eliminated, into the joint factor. */
void auvid_uncertain_transfer(auvid_uncertain_t *u, const auvid_metric_t *m, int j, int i);

/** Is DoF j's equation left out, as it says nothing of the scale of its terms? It has no thrust,
 * and is that of roll or pitch, or has no free parameter of its own, or no known force: of the mass
 * of another DoF, or of a fixed parameter. The same throughout a solution. See
 * auvid_uncertain_solve.c. */
bool auvid_uncertain_is_left_out(const auvid_uncertain_t *u, const auvid_metric_t *m, int j);

/** Returns the equations whose motion through the water is another one than the measured, by a
 * current, lever arm or mounting angle, a bit each. */
static inline unsigned auvid_uncertain_moves(const auvid_uncertain_t *u)
{
    unsigned dofs = 0;
    for (int k = 0; k < AUVID_UNCERTAIN_SHIFTS; ++k) {
        dofs |= u->moved[k];
    }
    return dofs;
}

/** Channel k of an equation: of an input, for k = inputs of its thrust, then of a parameter. */
static inline int auvid_uncertain_channel(const auvid_uncertain_t *u,
                                          const auvid_uncertain_equation_t *e, int k)
{
    return u->place[e->channel_at + k];
}

/** Row of own input i of an equation, by column, from column i on. */
static inline const auvid_real_t *
auvid_uncertain_own_row(const auvid_uncertain_t *u, const auvid_uncertain_equation_t *e, int i)
{
    return u->work.own_rows + e->own_rows_at + auvid_qr_row(e->order, i) - i;
}

/** Row i of the joint factor, by column, from column i on. */
static inline const auvid_real_t *auvid_uncertain_joint_row(const auvid_uncertain_t *u, int i)
{
    return u->work.joint + auvid_qr_row(JOINT_ORDER, i) - i;
}

/** Take row i of the reduced R factor, which has the parameters alone, into the problem of their
 * minimum; the first begins it. */
void auvid_uncertain_reduce(auvid_uncertain_t *u, int i);

/** Change the active set of the minimum within the bounds. @return is it found? */
bool auvid_uncertain_find_optimum(auvid_uncertain_t *u);

/** Begin the search, with this minimum. */
void auvid_uncertain_begin_search(auvid_uncertain_t *u);

/** Evaluate a point. @return has the search ended? Then its result is kept. */
bool auvid_uncertain_search(auvid_uncertain_t *u);

/** Write the solution without bounds, of the last pass. */
void auvid_uncertain_free(const auvid_uncertain_t *u, auvid_real_t pi[AUVID_MAX_PARAMETERS]);

/** Consider input k of DoF j as a cause. */
void auvid_uncertain_consider(auvid_uncertain_t *u, int j, int k);

/** Keep what DoF j's asymmetry, its input k with this value, makes of the drag in each direction.
 * @return a unit of the asymmetry, per newton of its column; 0: it is not known */
auvid_real_t auvid_uncertain_find_one_way(auvid_uncertain_t *u, int j, int k, auvid_real_t value);

/** Drag force of the estimate in one direction, see auvid_causes_drag. */
auvid_status_t auvid_uncertain_drag(const auvid_identifier_t *id, auvid_dof_t dof,
                                    auvid_real_t speed, auvid_drag_t *drag);

/** Publish the causes, after the estimate. */
void auvid_uncertain_publish_causes(auvid_uncertain_t *u);

/** Does the solution read DoF j's factors in several steps? Then they must not change. */
bool auvid_uncertain_reads(const auvid_uncertain_t *u, int j);

/** Fewest rows for a solution. */
#define AUVID_UNCERTAIN_LEAST_ROWS AUVID_C(30.0)
/** Factor of the covariance, see auvid_uncertain_solve.c. */
#define AUVID_UNCERTAIN_COVARIANCE AUVID_C(1.9)

/** Largest common scale of the priors; its inverse is the smallest. */
#define AUVID_UNCERTAIN_LARGEST_SCALE AUVID_C(2.0)

/** Has DoF j enough rows for a solution? */
static inline bool auvid_uncertain_has_rows(const auvid_uncertain_t *u, int j)
{
    return u->rows[j] >= AUVID_UNCERTAIN_LEAST_ROWS;
}

/** Do the thrusters' forces not make the wrench? */
static inline bool auvid_uncertain_thrust_differs(const auvid_uncertain_t *u)
{
    return u->recorded.difference > AUVID_C(0.25) * u->recorded.wrench;
}

/** Row i of DoF j, projected onto the instruments. */
static inline const auvid_real_t *auvid_instruments_row(const auvid_instruments_t *n, int j, int i)
{
    int count = n->of[j].count, order = count + n->uncertain->equation[j].order;
    return n->factor + n->of[j].factor_at + auvid_qr_row(order, i) + count - i;
}

/** Returns the sum over both bands of the product of columns k and l of DoF j. */
auvid_real_t auvid_uncertain_product(const auvid_uncertain_t *u, int j, int k, int l);

extern const struct auvid_metric_extra auvid_uncertain_extra;

/** What a checkpoint checks of the uncertain inputs, and of the instruments. */
extern const struct auvid_checkpoint_part auvid_uncertain_checkpoint, auvid_instruments_checkpoint;

#endif
