/**
 * @file validation.h
 * Validation (Section IV): simulate held-out inputs with given parameters, compare with what was
 * measured, R2 for each velocity.
 *
 * The equations of motion are integrated under the recorded wrench; attitude and the velocities
 * that the model does not cover come from the record, as in the paper. The integration starts from
 * the velocity measured in the eighth cell, when the wrench is known at every delay; so it does
 * again after a gap. It starts where all velocities that the integrated equations read were
 * measured (sample.missing), and again after a cell without one that comes from the record; a
 * velocity that was not measured is not compared. Commands, for models of the thrusters, are taken
 * as they come: not delayed.
 *
 * Called for each cell of the record, by the identifier (attach it) or by the user's own loop.
 * Cost: 16 calls of the model's acceleration a cell. Memory: sizeof(auvid_validation_t), 560
 * bytes with default sizes.
 */
#ifndef AUVID_VALIDATION_H
#define AUVID_VALIDATION_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Cells of the wrench kept for delays: the longest delay is two less. */
#define AUVID_VALIDATION_PAST 8

/** The comparison. Fields are private but for `cells` and `predicted`. */
typedef struct {
    const auvid_vehicle_t *vehicle;
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    auvid_real_t delay_cells[AUVID_DOF_COUNT];
    auvid_real_t wrench[AUVID_DOF_COUNT]; /* after the lag */
    uint32_t first_order_lag;
    auvid_real_t cell_s;
    uint32_t dofs;                                             /* bit j: this DoF is integrated */
    auvid_sample_t last;                                       /* the cell before */
    auvid_real_t past[AUVID_VALIDATION_PAST][AUVID_DOF_COUNT]; /* wrench, newest at `cells` */
    uint32_t since_gap;                                        /* cells in the running piece */
    bool running;                                              /* it is simulated */
    auvid_real_t mean[AUVID_DOF_COUNT], m2[AUVID_DOF_COUNT], sse[AUVID_DOF_COUNT];
    uint32_t compared[AUVID_DOF_COUNT];      /* cells in which this velocity was measured */
    uint32_t cells;                          /**< cells simulated so far */
    auvid_real_t predicted[AUVID_DOF_COUNT]; /**< simulated velocity at the last cell */
} auvid_validation_t;

#define auvid_validation_init                                                                      \
    AUVID_SIZED2(auvid_validation_init, AUVID_MAX_PARAMETERS, AUVID_MAX_COMMANDS)

/** Start.
 * @param vehicle model with an acceleration; must outlive the comparison
 * @param pi [n] its parameters. They must give the integrated DoF an acceleration: Girona500 needs
 * their masses > 0
 * @param dofs bit j: integrate DoF j, which the model must cover (0: every modelled DoF); others
 * come from the record. Leave out what was not identified
 * @param delay_s [6] delay of each DoF's wrench, -2 to 6 cells (rounding aside); a negative
 * one counts as 0, since the wrench to come is not known; null: none
 * @param lagged bit j: DoF j's delay is that of a first-order lag (estimate.lagged)
 * @param cell_s the record's cell [s], > 0, <= 1
 * @return AUVID_OK; AUVID_ERR_NULL; those of auvid_vehicle_check; AUVID_ERR_NOT_FINITE (pi);
 * AUVID_ERR_MODEL (no acceleration, or it refuses pi); AUVID_ERR_RANGE (dofs, delay_s or cell_s,
 * NaN too). */
auvid_status_t auvid_validation_init(auvid_validation_t *validation, const auvid_vehicle_t *vehicle,
                                     const auvid_real_t *pi, uint32_t dofs,
                                     const auvid_real_t *delay_s, uint32_t lagged,
                                     auvid_real_t cell_s);

#define auvid_validation_add                                                                       \
    AUVID_SIZED2(auvid_validation_add, AUVID_MAX_PARAMETERS, AUVID_MAX_COMMANDS)
/** Compare the next cell. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE (cell
 * ignored: the record has a hole now, say `gap`). */
auvid_status_t auvid_validation_add(auvid_validation_t *validation, const auvid_sample_t *sample);

#define auvid_validation_gap                                                                       \
    AUVID_SIZED2(auvid_validation_gap, AUVID_MAX_PARAMETERS, AUVID_MAX_COMMANDS)
/** The record was broken. Null is ignored. */
void auvid_validation_gap(auvid_validation_t *validation);

#define auvid_validation_r2                                                                        \
    AUVID_SIZED2(auvid_validation_r2, AUVID_MAX_PARAMETERS, AUVID_MAX_COMMANDS)
/** R2 = 1 - sum (y - y_predicted)^2 / sum (y - mean y)^2 of each integrated DoF; 0 for others.
 * @param r2 [6]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (fewer than two cells). */
auvid_status_t auvid_validation_r2(const auvid_validation_t *validation, auvid_real_t *r2);

#ifdef __cplusplus
}
#endif

#endif
