/**
 * @file validation.h
 * Validation (Section IV): simulate held-out inputs with given parameters, compare with the
 * measured velocities, and compute R2 of each velocity.
 *
 * The equations of motion are integrated under the recorded wrench. Attitude and the velocities
 * that the model does not cover come from the record, as in the paper. The integration starts from
 * the velocity measured in the eighth cell, when the wrench is known at every delay. It starts the
 * same way after a gap. At the start, all velocities that the integrated equations read must be
 * measured (sample.missing). A cell in which a velocity that comes from the record is missing stops
 * the integration, which then starts again. A velocity that was not measured is not compared.
 * Commands, for models of the thrusters, are used without delay.
 *
 * The identifier (see auvid_identifier_attach and auvid_identifier_attach_prediction) or the user's
 * own loop calls it for each cell of the record. Cost: 16 calls of the model's acceleration a cell.
 * Memory: sizeof(auvid_validation_t), 720 bytes with default sizes.
 */
#ifndef AUVID_VALIDATION_H
#define AUVID_VALIDATION_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Number of cells of the wrench stored for delays: the longest delay is two cells less. */
#define AUVID_VALIDATION_PAST 8

/** The comparison. All fields are private except `cells` and `predicted`. */
typedef struct {
    const auvid_vehicle_t *vehicle;
    /* state: from here on, see checkpoint.h */
    auvid_sample_t last; /* the cell before */
    auvid_sample_t next; /* in an identifier: the cell that waits */
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    auvid_real_t delay_cells[AUVID_DOF_COUNT];
    auvid_real_t wrench[AUVID_DOF_COUNT]; /* after the lag */
    auvid_real_t cell_s;
    auvid_real_t past[AUVID_VALIDATION_PAST][AUVID_DOF_COUNT]; /* wrench, newest at `cells` */
    auvid_real_t mean[AUVID_DOF_COUNT], m2[AUVID_DOF_COUNT], sse[AUVID_DOF_COUNT];
    auvid_real_t predicted[AUVID_DOF_COUNT]; /**< simulated velocity at the last cell */
    uint32_t first_order_lag;
    uint32_t dofs;                      /* bit j: this DoF is integrated */
    uint32_t since_gap;                 /* cells since the last gap */
    uint32_t compared[AUVID_DOF_COUNT]; /* cells in which this velocity was measured */
    uint32_t cells;                     /**< cells simulated so far */
    bool running;                       /* the integration has started */
    bool waits;                         /* `next` does */
    uint8_t reserved[AUVID_GAP(8, (AUVID_MAX_PARAMETERS + 85) * sizeof(auvid_real_t) + 2)];
} auvid_validation_t;

#define auvid_validation_init AUVID_SIZED(auvid_validation_init)

/** Start a comparison.
 * @param vehicle model with an acceleration; must outlive the comparison
 * @param pi [n] its parameters. They must give the integrated DoF an acceleration: Girona500 needs
 * masses > 0 of these DoF
 * @param dofs bit j: integrate DoF j, which the model must cover (0: every modelled DoF); others
 * come from the record. Leave out DoF that were not identified
 * @param delay_s [6] delay of each DoF's wrench [s], -2 to 6 cells (rounding aside). A negative
 * delay counts as 0, since the future wrench is not known. NULL: none
 * @param first_order_lag bit j: DoF j's delay is that of a first-order lag (the estimate's
 * first_order_lag)
 * @param cell_s the record's cell [s], > 0, <= 1
 * @return AUVID_OK; AUVID_ERR_NULL; those of auvid_vehicle_check; AUVID_ERR_NOT_FINITE (pi);
 * AUVID_ERR_MODEL (no acceleration, or it rejects pi); AUVID_ERR_RANGE (dofs, delay_s or cell_s,
 * also if NaN). */
auvid_status_t auvid_validation_init(auvid_validation_t *validation, const auvid_vehicle_t *vehicle,
                                     const auvid_real_t *pi, uint32_t dofs,
                                     const auvid_real_t *delay_s, uint32_t first_order_lag,
                                     auvid_real_t cell_s);

#define auvid_validation_add AUVID_SIZED(auvid_validation_add)
/** Compare the next cell.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or ended because the cells
 * became longer: AUVID_EVENT_LONGER_CELLS); AUVID_ERR_NOT_FINITE (the cell is ignored and the
 * record has a gap: call auvid_validation_gap). */
auvid_status_t auvid_validation_add(auvid_validation_t *validation, const auvid_sample_t *sample);

#define auvid_validation_gap AUVID_SIZED(auvid_validation_gap)
/** Report a break in the record. NULL is a no-op. */
void auvid_validation_gap(auvid_validation_t *validation);

#define auvid_validation_r2 AUVID_SIZED(auvid_validation_r2)
/** Compute R2 = 1 - sum (y - y_predicted)^2 / sum (y - mean y)^2 of each integrated DoF.
 * @param r2 [6] written; 0 for DoF that are not integrated
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (fewer than two cells). */
auvid_status_t auvid_validation_r2(const auvid_validation_t *validation, auvid_real_t *r2);

#ifdef __cplusplus
}
#endif

#endif
