/**
 * @file metric_config.h
 * Configuration of the metric: rows, data sets, smoother and delays (cfg.metric), and the memory
 * that the residual path needs. detail/metric.h describes the metric itself.
 */
#ifndef AUVID_METRIC_CONFIG_H
#define AUVID_METRIC_CONFIG_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Number of delays at which the wrench is stored, and their spacing in cells. */
#define AUVID_METRIC_DELAYS 3
#define AUVID_METRIC_DELAY_CELLS 3
/** Magnitude of the most negative delay, for which the weights are extrapolated [cells]. */
#define AUVID_METRIC_EARLY_CELLS 2

/** A stored row of the residual path: an averaged sample, and the wrench and the commands at the
 * other delays. Written by the metric. */
typedef struct {
    auvid_sample_t sample;
    auvid_real_t late[AUVID_METRIC_DELAYS - 1][AUVID_DOF_COUNT + AUVID_MAX_COMMANDS];
} auvid_row_t;

/** Configuration of the metric; copied at init. Written by the user; the defaults are those of
 * auvid_identifier_defaults. A parameter whose bit in `free` is set is estimated. */
typedef struct {
    const auvid_vehicle_t *vehicle; /**< required; the identifier sets it */
    auvid_row_t *rows;    /**< residual path: storage for (sets + 1) set_rows rows, owned by the
                            caller, must outlive the metric, cleared by init; NULL otherwise */
    uint32_t row_slots;   /**< number of rows for which `rows` has memory, at least these
                               (AUVID_ERR_SIZE); not read without `rows` */
    uint32_t velocity_us; /**< time between velocity samples [us], interpolated in between;
                               0..1000000; 0: a sample in every cell; default 200000. In the
                               identifier also AUVID_VELOCITY_OBSERVED (default): the median of the
                               first seven intervals; a rate that changes later is not noticed.
                               In the residual path only thrusters.h and the test for feedback
                               read it */
    auvid_real_t fixed[AUVID_MAX_PARAMETERS]; /**< values of the parameters that are not free, and
                                of free ones while their DoF is not excited, in the model's order
                                and units; 0 of a free one: not known. Default 0 */
    auvid_real_t tau_max[AUVID_DOF_COUNT]; /**< scale of the wrench [N, Nm], 1e-9..1e9: the largest
                                that you apply. Makes the cost dimensionless, and scales
                                excitation_threshold. Default 100, 40. In the identifier 0
                                (default): 100, 40 until auvid_node_init,
                                auvid_identifier_attach_uncertain or
                                auvid_identifier_attach_actuation names the thrusters; then what
                                they give in this DoF (auvid_allocation_capacity, the larger
                                direction), if that is above 0 and at most AUVID_RECORDER_LARGEST;
                                else the largest force, or moment, that they give in another DoF,
                                if that is less */
    /** a DoF is excited in a set if the rms of its wrench about its mean exceeds this part of
     * tau_max; 0..1, default 0.02. Once there is an estimate, the rms must also exceed sqrt(3)
     * times that of the residual in this DoF, unless the sets of the estimate do not, either: the
     * wrench of a controller that only keeps its place is an answer to the disturbance */
    auvid_real_t excitation_threshold;
    auvid_real_t delay_s[AUVID_DOF_COUNT]; /**< delay of the wrench if it is not estimated [s]:
                                                a shift of -2..6 cells (-0.2..0.6 s);
                                                default 0. Not read in the residual
                                                path: the delay is a parameter of each
                                                evaluation there */
    auvid_real_t delay_sigma_s; /**< standard deviation of the delay [s], 0..1; > 0: negative delays
                                     are also estimated; default 0. The identifier overwrites it
                                     with its uncertainty.delay_s */
    uint32_t free;        /**< bit i: parameter i is estimated; others stay at `fixed`. 0: all free;
                        default the vehicle's own choice */
    uint32_t cell_us;     /**< the recorder's cell [us]; default 100000. The identifier sets it */
    uint32_t max_cell_us; /**< regressor path: longest cell that the identifier may choose [us], see
                               detail/metric.h; at most cell_us: it keeps cell_us; 0..1000000,
                               default 800000 */
    uint16_t row_cells;   /**< cells between rows; >= 1, default 5 */
    uint16_t set_rows;    /**< rows in a set; >= 1, default 60 (30 s);
                              sets * set_rows <= 60000 */
    uint8_t sets;         /**< sets in the ring, 1..AUVID_MAX_SETS; default all */
    uint8_t half_width[2]; /**< half-width of the Savitzky-Golay smoother of order 2 [cells] for
                                forces [0] and for moments [1]; 1..255, at most AUVID_MAX_TAPS
                                taps; default 10, 7. That of forces is shorter with velocities
                                below 4 Hz. Not used in the residual path */
    uint8_t lag[2]; /**< distance in rows of the two rows of a sum or difference, for forces [0] and
                         for moments [1]; 1..AUVID_METRIC_LAGS, default 2, 1 */
    uint8_t passes; /**< number of applications of the smoother, 1 or 2;
                         default 2 */
    bool estimate_delay;     /**< default true */
    uint8_t first_order_lag; /**< bit j: delay_s of DoF j is that of a first-order lag, not a shift;
                                  default 0 */
    /** bit j: a controller makes the wrench of DoF j from its motion, as where an autopilot holds
     * depth (AUVID_HEAVE) and heading (AUVID_YAW) while a pilot drives the others. Nothing of these
     * DoF is identifiable (AUVID_NOTE_FEEDBACK): do not excite them. The test for feedback is of
     * the others; with 0 it is of all together: then the controller makes nothing identifiable, or
     * it is not recognised, and the parameters of its DoF are biased. 0..63 (AUVID_ERR_RANGE),
     * default 0 */
    uint8_t closed_loop;
    /** bit j: DoF j is known to be driven in open loop, as by an excitation of the user's own: it
     * is not tested for feedback, which the test may see in sines or triangles, where the model
     * does not explain much of the force. If it finds feedback in another one, nothing is
     * identifiable all the same. Disjoint from closed_loop; 0..63 (AUVID_ERR_RANGE), default 0 */
    uint8_t open_loop;
} auvid_metric_config_t;

#ifdef __cplusplus
}
#endif

#endif
