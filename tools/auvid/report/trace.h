/**
 * @file trace.h
 * Measured and predicted velocity of a held-out run, thinned for a plot.
 */
#ifndef PROGRAM_TRACE_H
#define PROGRAM_TRACE_H

#include "auvid/validation.h"

/** Largest number of points, and largest time between two of them [s]: of a longer run only the
 * beginning is stored. */
enum { TRACE_POINTS = 600 };
#define TRACE_MAX_STEP_S 0.5

/** A point. */
typedef struct {
    double t_s;     /**< since the first point */
    bool after_gap; /**< the simulation started again since the point before */
    float measured[AUVID_DOF_COUNT], predicted[AUVID_DOF_COUNT]; /**< [m/s, rad/s] */
} trace_point_t;

/** The trace. Only the functions below write it. */
typedef struct {
    uint32_t points;
    uint32_t every, cells; /* one in `every` cells is stored; cells seen */
    bool gap;              /* the simulation started again since the last point */
    uint64_t start_us;     /* time of the first point */
    trace_point_t point[TRACE_POINTS];
} trace_t;

/** Begins a trace of about so many cells of cell_s seconds. */
void trace_begin(trace_t *trace, size_t cells, double cell_s);

/** Adds a cell that a validation has just compared. after_gap: its simulation started again since
 * the cell before. */
void trace_add(trace_t *trace, const auvid_validation_t *validation, const auvid_sample_t *cell,
               bool after_gap);

#endif
