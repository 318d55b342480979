/**
 * @file dive.h
 * Simulated logs for the log doctor: a random vehicle between a small ROV and the Girona500 in the
 * field simulator (field.h), its rows as a user would log them, and the slips that users make.
 */
#ifndef SUPPORT_DIVE_H
#define SUPPORT_DIVE_H

#include "log/csv.h"
#include "field.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIVE_ROWS = 32000 };

typedef struct {
    field_config_t field;
    bool coarse; /* rows at 0.1 to 0.2 s, with gaps to 0.8 s; else at 50 Hz */
    bool depth;  /* a column z_m */
} dive_config_t;

typedef struct {
    field_t field;
    bool has[CSV_COLUMNS];
    csv_row_t row[DIVE_ROWS];
    int rows;
} dive_t;

/** Simulates a vehicle whose hull, thrust and speed are random factors of those configured. Returns
 * false if the simulator refuses. */
bool dive_simulate(dive_t *dive, const dive_config_t *cfg);

/** Slips. */
typedef enum {
    SLIP_ANGLE_DEGREES,
    SLIP_RATE_DEGREES,
    SLIP_ANGLE_SIGN,
    SLIP_VELOCITY_SIGN,
    SLIP_EXCHANGED,
    SLIP_FRAME,
    SLIP_SHIFT,
    SLIP_INPUT_SIGN,
    SLIP_INPUT_EXCHANGED,
    SLIP_LOGGING, /* held velocities, a velocity that is always zero, pulse widths */
    SLIP_ACCELEROMETER,
    SLIP_UNIT,       /* forces in kgf, velocities in knots; of the whole log */
    SLIP_WORLD,      /* velocities to the north, east and down; of the whole log */
    SLIP_QUATERNION, /* x, y, z, w; of the whole log */
    SLIPS
} slip_kind_t;

/** A slip. */
typedef struct {
    slip_kind_t kind;
    int which;         /* the variant: an axis, a pair */
    int severity;      /* 0: severe .. 2: mild */
    int column, other; /* written by dive_slip: the columns that it concerns */
} slip_t;

/** Draws a slip of a kind. */
void dive_draw_slip(slip_t *slip, slip_kind_t kind, int severity, uint64_t seed);

/** Makes it: copies the log `from`, changed, to `to`. */
void dive_slip(const dive_t *from, slip_t *slip, dive_t *to);

/** Its name. */
extern const char *const slip_name[SLIPS];

#ifdef __cplusplus
}
#endif

#endif
