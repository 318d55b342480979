/**
 * @file literal.h
 * The paper's smoothing to the letter (Karras et al. 2013, III-B), with the metric of the library.
 *
 * The library smooths rows and wrench alike. The paper smooths the states and names no filter for
 * tau. Here a Savitzky-Golay filter of order 3 and half-width 0.5 s smooths attitude and velocity
 * and differentiates the velocity for the acceleration; the wrench stays raw.
 *
 * The metric gets these rows without an option for them:
 * - Its model is `vehicle`, whose rows are those of the smoothed state.
 * - Its own smoother is one that passes its middle cell unchanged: three cells, order 2. So of the
 *   cells given to it for a row only the middle one counts; the others give the wrench at the
 *   stored delays.
 * - Its merge weights both bands alike: it ends after the first of the three passes.
 *
 * An identifier has no such rows by itself: literal_tick takes what its recorder was given and
 * records it here.
 */
#ifndef SIMULATOR_LITERAL_H
#define SIMULATOR_LITERAL_H

#include "auvid/identifier.h"

/** Cells that are stored, a power of two. */
enum { LITERAL_CELLS = 256 };

/** Its address is the context of `vehicle`: it must not move. Its members are private. */
typedef struct {
    auvid_vehicle_t vehicle;
    const auvid_vehicle_t *model;
    auvid_metric_t *metric;
    auvid_recorder_t recorder;
    auvid_sample_t cell[LITERAL_CELLS];
    auvid_sample_t smoothed;                  /* whose rows `vehicle` gives */
    uint32_t cells;                           /* since the record began */
    auvid_real_t fastest[2][AUVID_DOF_COUNT]; /* velocities since the last row, up and down */
    uint32_t half;                            /* half-width [cells] */
    auvid_real_t c[2][2 * AUVID_MAX_HALF_WIDTH + 1]; /* coefficients of value and derivative */
} literal_t;

/** Changes a configuration, also its model, for literal smoothing. Set cfg->cell_us before. The
 * statuses are those of auvid_smoother_coefficients; AUVID_ERR_RANGE: fewer than 2 cells a row. */
auvid_status_t literal_metric(literal_t *literal, auvid_metric_config_t *cfg);

/** The same for an identifier: set cfg->recorder.cell_us before. */
auvid_status_t literal_identifier(literal_t *literal, auvid_identifier_config_t *cfg);

/** Attaches the metric. Call it after the metric or its identifier was initialised. */
void literal_attach(literal_t *literal, auvid_metric_t *metric);

/** Adds the next cell of an unbroken record. @return as auvid_metric_add */
auvid_status_t literal_add(literal_t *literal, const auvid_sample_t *cell);

/** Reports a break in the record. */
void literal_gap(literal_t *literal);

/** Replaces auvid_metric_merge, for any metric. @return as it */
auvid_status_t literal_merge(auvid_metric_t *metric, uint32_t *budget);

/** Adds a cell to the attached metric and to the simulation of its identifier; NULL: a gap. */
void literal_cell(literal_t *literal, auvid_identifier_t *id, const auvid_sample_t *cell);

/** Call it after each tick of the identifier: it records the filter's state and the wrench, and
 * keeps the identifier from recording them. */
void literal_tick(literal_t *literal, auvid_identifier_t *id);

/** Replaces auvid_identifier_work. @return as it */
auvid_status_t literal_work(auvid_identifier_t *id, uint32_t budget);

#endif
