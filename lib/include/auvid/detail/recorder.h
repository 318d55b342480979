/**
 * @file detail/recorder.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
 * Recorder: averages attitude, velocity and applied wrench, which arrive at irregular times, over
 * a common grid of cells (III-B, the buffers eta, nu, nu_dot, tau of Eq. 9).
 *
 * A cell holds the exact mean of each signal over the same interval. The equation of motion then
 * holds for the smoothed signals: mean acceleration and mean wrench belong together. Attitude and
 * velocity are interpolated linearly between samples. The wrench is held (a thruster command) or
 * interpolated linearly. Feed velocity only when a DVL update has just corrected it: a
 * constant-velocity filter lags in between. Accelerations are central differences of the cell
 * means, of fourth order:
 *
 *     nu_dot[k] = (8 (nu[k+1] - nu[k-1]) - (nu[k+2] - nu[k-2])) / (12 T)
 *
 * The identifier calls it in the control tick: feed the three streams, then pop cells until
 * AUVID_EMPTY. Three cases break the record:
 * - a stream has no sample for longer than `gap_us`;
 * - the caller says so (auvid_recorder_break);
 * - a stream lags by more than the stored cells, which must span the time between its samples. This
 *   also detects a stream that stops for good.
 * A break discards the cells that were not popped; auvid_recorder_pop() returns AUVID_GAP once, and
 * the next samples begin a new record.
 *
 * A velocity sample may measure a subset of u, v and w. Each component is interpolated linearly
 * between its own samples. A component does not break the record if another one is measured: after
 * `gap_us`, or AUVID_RECORDER_CELLS - 8 cells, without it, cells are marked in sample.missing.
 *
 * A velocity sample is an outlier if the component jumps to it and back, by more than five times
 * what the samples usually deviate from the line between their neighbours. Two jumps are what tells
 * it from motion: a kink does not jump to its sample, a step does not jump back. It is put on that
 * line, as if it had not been measured; cells that were popped before the next sample came keep
 * what it did to them, which is little.
 *
 * The period of the velocity samples may be observed: the median of the intervals between the first
 * 8. Until then complete cells wait in the ring. If it overflows first (a slow DVL), the record
 * begins again. A rate that changes later is not noticed.
 *
 * The input can be taken part by part, as it is integrated (take_part): what depends on its course
 * within a cell, as the speed of a propeller does, cannot be computed from the mean.
 *
 * Cost: about 30 multiplications a sample, 45 of a velocity, beside take_part; pop about 60.
 * Memory: sizeof(auvid_recorder_t), 1.8 KiB with default sizes.
 */
#ifndef AUVID_RECORDER_H
#define AUVID_RECORDER_H

#include "auvid/nav.h"
#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Number of stored cells. The slowest stream may lag the fastest by this many, less five. */
#define AUVID_RECORDER_CELLS 16
#define AUVID_RECORDER_CHANNELS (9 + AUVID_DOF_COUNT + AUVID_MAX_COMMANDS)
/** Intervals between velocity samples whose median is their period. */
#define AUVID_RECORDER_INTERVALS 7

/** One stream: attitude, u, v, w, or input. Private. */
typedef struct {
    uint64_t t_us;      /* last sample's time */
    uint64_t filled_us; /* integrated up to here */
    uint32_t cell;      /* index of the cell being filled */
    bool valid;         /* t_us is valid */
    uint8_t reserved[3];
} auvid_recorder_stream_t;

/** Takes a part of a cell: between two inputs, or the ends of the cell. Private.
 * @param cell number of the cell in this record
 * @param opens is it the first part of the cell?
 * @param us its length [us]; cell_us at most
 * @param value [AUVID_DOF_COUNT + AUVID_MAX_COMMANDS] tau, command; with AUVID_INPUT_LINEAR their
 * means */
typedef void auvid_recorder_part_t(void *context, uint32_t cell, bool opens, uint32_t us,
                                   const auvid_real_t *value);

/** The recorder. Private, but cell_us and outliers may be read. */
typedef struct {
    auvid_recorder_config_t cfg;
    auvid_recorder_part_t *take_part; /* of the input; NULL: nothing takes it */
    void *part_context;
    /* state: from here on, see checkpoint.h */
    uint64_t origin_us;   /* start of cell 0 */
    uint32_t opened;      /* cells begun so far */
    uint32_t next;        /* next cell to pop */
    uint32_t cell_us;     /* as configured, or as the metric chose */
    uint32_t velocity_us; /* as configured, or as observed */
    uint32_t gap_us;      /* longest time between samples */
    uint32_t outliers;    /**< corrected so far, of u, v and w */
    bool running, broken;
    uint8_t intervals; /* observed so far */
    uint8_t reserved[5];
    auvid_recorder_stream_t stream[5];
    uint32_t before_us[3];                          /* from `before` to `last`; 0: no `before` */
    uint32_t interval_us[AUVID_RECORDER_INTERVALS]; /* between velocity samples, ascending */
    uint8_t measured[AUVID_RECORDER_CELLS];         /* bit i: velocity[i] covers the whole cell */
    auvid_real_t last[AUVID_RECORDER_CHANNELS];     /* last sample of each stream */
    auvid_real_t before[3];                         /* velocity before it [m/s] */
    auvid_real_t slope[3];                          /* up to that one [m/s per us] */
    auvid_real_t spread[3];                         /* 73 % of the samples deviate less [m/s] */
    auvid_real_t mean[AUVID_RECORDER_CELLS][AUVID_RECORDER_CHANNELS];
} auvid_recorder_t;

/** Fill *cfg with the defaults stated at its fields.
 * @param cfg written whole; NULL is a no-op. */
void auvid_recorder_defaults(auvid_recorder_config_t *cfg);

/** Default of gap_us: five sample intervals, at least 0.5 s and at most 1 s, but at least 1.5
 * intervals: a DVL with 1 Hz is not that punctual.
 * @param velocity_us period of the velocity samples [us]; above 1000000: not known.
 * @return 500000..1500000 [us]. */
uint32_t auvid_recorder_gap(uint32_t velocity_us);

#define auvid_recorder_init AUVID_SIZED(auvid_recorder_init)
/** Initialise an empty recorder.
 * take_part becomes NULL.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE if a field is outside its range. On an error
 *         *recorder is unchanged. */
auvid_status_t auvid_recorder_init(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg);

#define auvid_recorder_attitude AUVID_SIZED(auvid_recorder_attitude)
/** Record attitude and rates.
 * @param t_us time of measurement [us]
 * @param attitude [3] phi theta psi [rad], psi unwrapped
 * @param rates [3] p q r [rad/s]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if a value exceeds
 *         AUVID_RECORDER_LARGEST; AUVID_ERR_TIME_BACK or AUVID_ERR_TIME_SAME if t_us is not after
 *         this stream's last sample. After a break the stream that stopped may restart at any time.
 *         On an error nothing changes. Cost: O(cells overlapped), <= 16. */
auvid_status_t auvid_recorder_attitude(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *rates);

#define auvid_recorder_velocity AUVID_SIZED(auvid_recorder_velocity)
/** Record the body velocity through the water.
 * @param t_us time of measurement [us]
 * @param velocity [3] u v w [m/s]
 * @param measured bit i: velocity[i] was measured, 0..7; the others are not read
 * @return as auvid_recorder_attitude; AUVID_ERR_RANGE also if `measured` exceeds 7; AUVID_UNUSED
 *         if it is 0: nothing changes. Cost as auvid_recorder_attitude. */
auvid_status_t auvid_recorder_velocity(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *velocity, unsigned measured);

#define auvid_recorder_break AUVID_SIZED(auvid_recorder_break)
/** Break the record, if there is one: the samples before do not belong to those that follow. NULL
 * is a no-op. Cost: O(1). */
void auvid_recorder_break(auvid_recorder_t *recorder);

#define auvid_recorder_motion AUVID_SIZED(auvid_recorder_motion)
/** Record attitude and velocity of the same time.
 * @param t_us time of measurement [us]
 * @param attitude [3] phi theta psi [rad], psi unwrapped
 * @param nu [6] u v w p q r [m/s, rad/s]
 * @return as auvid_recorder_attitude. If either of the two is rejected, neither is recorded. */
auvid_status_t auvid_recorder_motion(auvid_recorder_t *recorder, uint64_t t_us,
                                     const auvid_real_t *attitude, const auvid_real_t *nu);

#define auvid_recorder_input AUVID_SIZED(auvid_recorder_input)
/** Record the applied wrench from t_us on.
 * @param t_us time of the wrench [us]
 * @param tau [6] [N, Nm]: total of all sources, not only auvid's
 * @param command [AUVID_MAX_COMMANDS] thruster commands, any unit; NULL: zeros
 * @return as auvid_recorder_attitude. Cost as auvid_recorder_attitude. */
auvid_status_t auvid_recorder_input(auvid_recorder_t *recorder, uint64_t t_us,
                                    const auvid_real_t *tau, const auvid_real_t *command);

#define auvid_recorder_pop AUVID_SIZED(auvid_recorder_pop)
/** Read and remove the next complete cell. A cell is complete when all streams have passed the
 * second cell after it.
 * @param sample written whole on AUVID_OK, else untouched.
 * @return AUVID_OK; AUVID_EMPTY if no cell is complete; AUVID_GAP once for each break;
 *         AUVID_ERR_NULL. */
auvid_status_t auvid_recorder_pop(auvid_recorder_t *recorder, auvid_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
