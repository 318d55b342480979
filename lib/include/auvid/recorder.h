/**
 * @file recorder.h
 * Recorder: brings attitude, velocity and applied wrench, each arriving at its own irregular times,
 * onto one grid of cells (III-B, the buffers eta, nu, nu_dot, tau of Eq. 9).
 *
 * A cell holds the exact mean of each signal over the same interval, so that a smoothed equation of
 * motion still holds: mean acceleration and mean wrench belong together. Between its samples a
 * signal runs straight; the wrench holds (a thruster command) or runs straight. Velocity is best
 * given only when a DVL update has just corrected it: a constant-velocity filter lags in between.
 * Accelerations are central differences of the cell means, of fourth order:
 *
 *     nu_dot[k] = (8 (nu[k+1] - nu[k-1]) - (nu[k+2] - nu[k-2])) / (12 T)
 *
 * Called by the identifier in the control tick: feed the three streams, then pop cells until
 * AUVID_EMPTY. A stream silent for longer than `gap_us` breaks the record: cells not popped by then
 * are lost, pop says AUVID_GAP once, and a new record begins with the next samples. (A stream that
 * says nothing at all is found out when the others have run through all cells kept.) So does a
 * stream that lags further behind than the cells kept, which must therefore span the time between
 * its samples.
 *
 * Cost: about 30 multiplications a sample; pop about 60. Memory: sizeof(auvid_recorder_t), 1.7 KiB
 * with default sizes.
 */
#ifndef AUVID_RECORDER_H
#define AUVID_RECORDER_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Cells kept: the slowest stream may lag behind the fastest by this many, less five. */
#define AUVID_RECORDER_CELLS 16
/** Largest value taken, whatever its unit: beyond it there is a fault, and in single precision its
 * squares would stay in the data for as long as the set does. */
#define AUVID_RECORDER_LARGEST AUVID_C(1e9)
#define AUVID_RECORDER_CHANNELS (9 + AUVID_DOF_COUNT + AUVID_MAX_COMMANDS)

/** How the applied wrench runs between its samples. */
typedef enum {
    AUVID_INPUT_HOLD = 0,  /**< a sample holds until the next (a command, the tick's thrust) */
    AUVID_INPUT_LINEAR = 1 /**< straight from sample to sample (a measured force) */
} auvid_input_mode_t;

typedef struct {
    uint32_t cell_us;         /**< cell length [us]; 1000..1000000, default 100000 */
    uint32_t gap_us;          /**< longest silence that is bridged [us]; >= cell_us, <= 1e9,
                                 default 500000. A DVL slower than 2.5 Hz needs more: 900000 at
                                 2 Hz, or every sample would break the record */
    auvid_input_mode_t input; /**< default AUVID_INPUT_HOLD */
} auvid_recorder_config_t;

/** One of the three streams. Private. */
typedef struct {
    uint64_t t_us;      /* last sample's time */
    uint64_t filled_us; /* integrated up to here */
    uint32_t cell;      /* number of the cell being filled */
    bool valid;         /* there is a last sample */
} auvid_recorder_stream_t;

/** The recorder. All fields private. */
typedef struct {
    auvid_recorder_config_t cfg;
    auvid_recorder_stream_t stream[3];
    auvid_real_t last[AUVID_RECORDER_CHANNELS]; /* last sample of each stream */
    auvid_real_t mean[AUVID_RECORDER_CELLS][AUVID_RECORDER_CHANNELS];
    uint64_t origin_us; /* start of cell 0 */
    uint32_t opened;    /* cells begun so far */
    uint32_t next;      /* cell to be popped next */
    bool running, broken;
} auvid_recorder_t;

/** Fill *cfg with the defaults. Null is ignored. */
void auvid_recorder_defaults(auvid_recorder_config_t *cfg);

#define auvid_recorder_init AUVID_SIZED1(auvid_recorder_init, AUVID_MAX_COMMANDS)
/** Start empty. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (a field out of its range). */
auvid_status_t auvid_recorder_init(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg);

/** Attitude and rates at t_us.
 * @param attitude [3] phi theta psi [rad], psi unwrapped
 * @param rates [3] p q r [rad/s]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a value beyond
 * AUVID_RECORDER_LARGEST); AUVID_ERR_TIME_BACK and AUVID_ERR_TIME_SAME (not after this stream's
 * last sample; after a break a stream that was silent may start at any time). Refused: nothing
 * changed. Cost: O(cells overlapped), <= 16. */
auvid_status_t auvid_recorder_attitude(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *rates);

/** Body velocity u v w [m/s] through the water at t_us, [3]. Statuses and cost as above. */
auvid_status_t auvid_recorder_velocity(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *velocity);

/** Both at t_us: attitude [3] and nu [6], u v w p q r. Statuses as above; where one of the two is
 * refused, neither is taken. */
auvid_status_t auvid_recorder_motion(auvid_recorder_t *recorder, uint64_t t_us,
                                     const auvid_real_t *attitude, const auvid_real_t *nu);

/** Applied wrench from t_us on.
 * @param tau [6] N, Nm: of all sources, not only auvid's
 * @param command [AUVID_MAX_COMMANDS] thruster commands, any unit; null: zeros
 * Statuses and cost as above. */
auvid_status_t auvid_recorder_input(auvid_recorder_t *recorder, uint64_t t_us,
                                    const auvid_real_t *tau, const auvid_real_t *command);

/** Take the next complete cell. A cell is complete when all streams have passed the second cell
 * after it.
 * @return AUVID_OK (*sample written); AUVID_EMPTY; AUVID_GAP (once for each break; *sample
 * untouched); AUVID_ERR_NULL. */
auvid_status_t auvid_recorder_pop(auvid_recorder_t *recorder, auvid_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
