/*
 * The checkpoint: the range of the members of each struct, in the order of
 * auvid_checkpoint_layout.c. A member that is not listed may have any value, a real any finite one.
 * Conditions between members are in auvid_checkpoint_validate.c.
 */
#include "auvid_checkpoint_layout_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "../search/auvid_line_search_directions_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../navigation/auvid_nav_internal.h"

#define LIMIT(table, same, type, first, last, low, high)                                           \
    {                                                                                              \
        table, same, (uint32_t)offsetof(type, first),                                              \
            (uint32_t)(offsetof(type, last) + sizeof((type *)0)->last), low, high                  \
    }
/* Ranges of `first` .. `last`: low .. high; -max .. max; 0 .. max. */
#define RANGE(table, type, first, last, low, high)                                                 \
    LIMIT(table, false, type, first, last, low, (auvid_real_t)(high))
#define WITHIN(table, type, first, last, max) RANGE(table, type, first, last, -(max), max)
#define UP_TO(table, type, first, last, max) RANGE(table, type, first, last, AUVID_C(0.0), max)
#define FLAG(table, type, first, last) UP_TO(table, type, first, last, 1)
#define DOF_BITS(table, type, member) UP_TO(table, type, member, member, (1 << AUVID_DOF_COUNT) - 1)
/* Bit i: velocity i. */
#define AXES(table, type, member) UP_TO(table, type, member, member, AUVID_DVL_ALL)
/* Determined by the model, so equal to this identifier's. */
#define SAME(table, type, first, last)                                                             \
    LIMIT(table, true, type, first, last, AUVID_C(0.0), AUVID_C(0.0))

/* Parameters, bounds, steps: their squares are finite. Costs. Sums of squares of rows,
 * which are within 1e15. Lengths and speeds. Counts of evaluations: they do not wrap around.
 * Delays: six of the longest cells. */
#define VALUE(table, type, first, last) WITHIN(table, type, first, last, AUVID_C(1e18))
#define COST(table, type, first, last) WITHIN(table, type, first, last, AUVID_COST_FAILED)
#define SQUARES(table, type, first, last) UP_TO(table, type, first, last, AUVID_C(1e35))
#define LENGTH(table, type, first, last) WITHIN(table, type, first, last, AUVID_C(1e9))
#define EVALUATIONS(table, type, member) UP_TO(table, type, member, member, 1 << 30)
#define DELAY(table, type, first, last)                                                            \
    RANGE(table, type, first, last, AUVID_C(-2.01), AUVID_C(6.01))

enum { MAX_ROWS = 60000 }; /* of all sets */

const auvid_checkpoint_limit_t auvid_checkpoint_limit[] = {
    VALUE(TABLE_SEARCH, auvid_search_config_t, lower, good),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, epsilon_crs, epsilon_crs, AUVID_LARGEST),
    FLAG(TABLE_SEARCH, auvid_search_config_t, reduction, reduction),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, omega, omega, AUVID_C(1e9)),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, alpha0, alpha0, 1000),
    FLAG(TABLE_SEARCH, auvid_search_config_t, sigma, sigma),
    RANGE(TABLE_SEARCH, auvid_search_config_t, delta, delta, AUVID_C(1.0), AUVID_C(100.0)),
    FLAG(TABLE_SEARCH, auvid_search_config_t, gamma, epsilon_line),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, population, population, AUVID_MAX_POPULATION),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, n, n, AUVID_MAX_PARAMETERS),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, phases, phases, AUVID_SEARCH_LOCAL),
    FLAG(TABLE_SEARCH, auvid_search_config_t, has_good, paper),

    LENGTH(TABLE_VELOCITY_SAMPLE, auvid_nav_velocity_sample_t, velocity, velocity),
    AXES(TABLE_VELOCITY_SAMPLE, auvid_nav_velocity_sample_t, measured),

    UP_TO(TABLE_DIAGNOSTICS, auvid_nav_diagnostics_t, innovation_count, innovation_count, 3),
    FLAG(TABLE_DIAGNOSTICS, auvid_nav_diagnostics_t, has_sample, has_sample),

    FLAG(TABLE_NAV, auvid_nav_t, horizontal, complete),
    UP_TO(TABLE_NAV, auvid_nav_t, gps_start, gps_count, AUVID_NAV_GPS_START_MAX),
    UP_TO(TABLE_NAV, auvid_nav_t, flags, flags, 2 * (AUVID_NAV_FLAG_END - 1) - 1),
    RANGE(TABLE_NAV, auvid_nav_t, ready, ready, (auvid_real_t)NAV_READY, NAV_RUNNING),
    UP_TO(TABLE_NAV, auvid_nav_t, held_rejected, holding, (1 << AUVID_NAV_SENSOR_COUNT) - 1),
    AXES(TABLE_NAV, auvid_nav_t, held_valid),
    FLAG(TABLE_NAV, auvid_nav_t, imu_turned, imu_turned),
    UP_TO(TABLE_NAV, auvid_nav_t, past_next, past_next, 2 * AUVID_NAV_PAST - 1),
    LENGTH(TABLE_NAV, auvid_nav_t, position, velocity),
    WITHIN(TABLE_NAV, auvid_nav_t, pp, vv, AUVID_C(1e15)),
    WITHIN(TABLE_NAV, auvid_nav_t, rotation, rotation, AUVID_C(1.01)),
    WITHIN(TABLE_NAV, auvid_nav_t, attitude, attitude, AUVID_C(1e4)),
    WITHIN(TABLE_NAV, auvid_nav_t, rates, rates, AUVID_C(100.0)),
    WITHIN(TABLE_NAV, auvid_nav_t, yaw_revolutions, yaw_revolutions, AUVID_C(1e6)),
    RANGE(TABLE_NAV, auvid_nav_t, q, q, AUVID_C(1e-13), AUVID_C(1.01e5)),
    RANGE(TABLE_NAV, auvid_nav_t, r, r, AUVID_C(1e-9), AUVID_C(1e7)),
    UP_TO(TABLE_NAV, auvid_nav_t, gate, gate, AUVID_LARGEST),
    UP_TO(TABLE_NAV, auvid_nav_t, max_acceleration, speed_limit, 100),
    UP_TO(TABLE_NAV, auvid_nav_t, metres_per_pascal, metres_per_pascal, 11),
    UP_TO(TABLE_NAV, auvid_nav_t, surface_pressure, surface_pressure, 1000000),
    WITHIN(TABLE_NAV, auvid_nav_t, surface_depth, surface_depth, AUVID_C(1e5)),
    WITHIN(TABLE_NAV, auvid_nav_t, mount, imu_mount, AUVID_C(1.01)),
    WITHIN(TABLE_NAV, auvid_nav_t, lever, lever, AUVID_C(1e3)),
    UP_TO(TABLE_NAV, auvid_nav_t, max_age_us, future_us, NAV_LARGEST_AGE_US),
    WITHIN(TABLE_NAV, auvid_nav_t, past_rates, past_rates, AUVID_C(100.0)),
    WITHIN(TABLE_NAV, auvid_nav_t, held, held, NAV_LARGEST_POSITION),
    LENGTH(TABLE_NAV, auvid_nav_t, gps_offset, gps_offset),

    FLAG(TABLE_STREAM, auvid_recorder_stream_t, valid, valid),

    RANGE(TABLE_RECORDER, auvid_recorder_t, cfg.cell_us, cfg.cell_us, AUVID_C(1e3), AUVID_C(1e6)),
    UP_TO(TABLE_RECORDER, auvid_recorder_t, cfg.gap_us, cfg.gap_us, AUVID_C(1e9)),
    RANGE(TABLE_RECORDER, auvid_recorder_t, gap_us, gap_us, AUVID_C(1e3), AUVID_C(1e9)),
    UP_TO(TABLE_RECORDER, auvid_recorder_t, intervals, intervals, AUVID_RECORDER_INTERVALS - 1),
    FLAG(TABLE_RECORDER, auvid_recorder_t, cfg.input, cfg.input),
    WITHIN(TABLE_RECORDER, auvid_recorder_t, last, mean, AUVID_C(2e9)),
    AXES(TABLE_RECORDER, auvid_recorder_t, measured),
    FLAG(TABLE_RECORDER, auvid_recorder_t, running, broken),

    SQUARES(TABLE_SET, auvid_set_t, tau_m2, tau_m2),
    RANGE(TABLE_SET, auvid_set_t, exponent, exponent, -AUVID_C(126.0), AUVID_C(60.0)),
    DOF_BITS(TABLE_SET, auvid_set_t, excited),

    SAME(TABLE_METRIC, auvid_metric_t, cfg.free, cfg.fixed),
    RANGE(TABLE_METRIC, auvid_metric_t, cfg.tau_max, cfg.tau_max, AUVID_C(1e-12), AUVID_C(1e12)),
    FLAG(TABLE_METRIC, auvid_metric_t, cfg.excitation_threshold, cfg.excitation_threshold),
    RANGE(TABLE_METRIC, auvid_metric_t, cfg.cell_us, cfg.cell_us, AUVID_C(1e3), AUVID_C(1e6)),
    UP_TO(TABLE_METRIC, auvid_metric_t, cfg.velocity_us, cfg.velocity_us, 1000000),
    RANGE(TABLE_METRIC, auvid_metric_t, cfg.row_cells, cfg.set_rows, AUVID_C(1.0),
          AUVID_C(65535.0)),
    RANGE(TABLE_METRIC, auvid_metric_t, cfg.sets, cfg.sets, AUVID_C(1.0), AUVID_MAX_SETS),
    RANGE(TABLE_METRIC, auvid_metric_t, cfg.lag, cfg.lag, AUVID_C(1.0), AUVID_METRIC_LAGS),
    FLAG(TABLE_METRIC, auvid_metric_t, cfg.estimate_delay, cfg.estimate_delay),
    DELAY(TABLE_METRIC, auvid_metric_t, cfg.delay_s, cfg.delay_s),
    UP_TO(TABLE_METRIC, auvid_metric_t, cfg.delay_sigma_s, cfg.delay_sigma_s, 1),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, cfg.first_order_lag),
    SAME(TABLE_METRIC, auvid_metric_t, layout.columns, layout.count),
    RANGE(TABLE_METRIC, auvid_metric_t, layout.taps, layout.taps, AUVID_C(1.0), AUVID_MAX_TAPS),
    RANGE(TABLE_METRIC, auvid_metric_t, layout.overlap, layout.overlap, AUVID_C(1.0),
          AUVID_MAX_OVERLAP),
    RANGE(TABLE_METRIC, auvid_metric_t, layout.window_length, layout.window_length, AUVID_C(1.0),
          AUVID_METRIC_WINDOW),
    FLAG(TABLE_METRIC, auvid_metric_t, layout.window_weight, layout.window_weight),
    UP_TO(TABLE_METRIC, auvid_metric_t, layout.interpolation_spread, layout.interpolation_spread,
          AUVID_C(0.5)),
    WITHIN(TABLE_METRIC, auvid_metric_t, layout.kernel, layout.kernel, AUVID_C(1e6)),
    SAME(TABLE_METRIC, auvid_metric_t, layout.index, layout.index),
    DELAY(TABLE_METRIC, auvid_metric_t, result.delay_s, result.delay_s),
    UP_TO(TABLE_METRIC, auvid_metric_t, result.dof_rows, result.dof_rows, MAX_ROWS),
    UP_TO(TABLE_METRIC, auvid_metric_t, result.change_rank, result.change_rank,
          AUVID_MAX_PARAMETERS),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, result.excited),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, result.first_order_lag),
    DELAY(TABLE_METRIC, auvid_metric_t, evaluator.linear_delay_s, evaluator.linear_delay_s),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.at.row, evaluator.at.row,
          MAX_ROWS + AUVID_METRIC_WINDOW),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.at.band, evaluator.at.band,
          AUVID_METRIC_BANDS - 1),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.at.dof, evaluator.at.dof, AUVID_DOF_COUNT),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.at.pass, evaluator.at.pass, PASS_LINEAR),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.window_of, evaluator.window_of,
          AUVID_METRIC_WINDOW),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.sets_merged, evaluator.sets_merged,
          AUVID_MAX_SETS),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.weight, evaluator.weight, AUVID_C(1e24)),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.band_weight, evaluator.band_weight, AUVID_C(1e3)),
    VALUE(TABLE_METRIC, auvid_metric_t, evaluator.merged, evaluator.merged),
    UP_TO(TABLE_METRIC, auvid_metric_t, rows.successive, rows.successive, AUVID_METRIC_LAGS),
    VALUE(TABLE_METRIC, auvid_metric_t, rows.set.tau_mean, rows.set.tau_mean),
    SQUARES(TABLE_METRIC, auvid_metric_t, rows.set.tau_m2, rows.set.tau_m2),
    VALUE(TABLE_METRIC, auvid_metric_t, rows.set.factor, rows.previous),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, rows.missing),
    UP_TO(TABLE_METRIC, auvid_metric_t, sets.from, sets.least, AUVID_MAX_SETS),
    FLAG(TABLE_METRIC, auvid_metric_t, sets.held, sets.changed),

    WITHIN(TABLE_CHANNEL, auvid_excitation_channel_t, level, before, AUVID_C(1.0)),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, scale, scale, AUVID_C(1e4)),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, frequency_hz, frequency_hz, AUVID_C(6.0)),
    FLAG(TABLE_CHANNEL, auvid_excitation_channel_t, cycles, cycles),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, segment, segment, AUVID_MAX_SEGMENTS),
    FLAG(TABLE_CHANNEL, auvid_excitation_channel_t, second, negative),
    VALUE(TABLE_EXCITATION, auvid_excitation_t, displacement, displacement),
    FLAG(TABLE_EXCITATION, auvid_excitation_t, running, finished),

    UP_TO(TABLE_TRIP, auvid_guard_trip_t, cause, cause, AUVID_GUARD_CAUSE_COUNT - 1),

    DOF_BITS(TABLE_ADAPTIVE, auvid_adaptive_t, playing),
    LENGTH(TABLE_ADAPTIVE, auvid_adaptive_t, low_owed, low_owed),

    UP_TO(TABLE_GUARD, auvid_guard_t, state, state, AUVID_GUARD_STATE_COUNT - 1),
    LENGTH(TABLE_GUARD, auvid_guard_t, home, home),
    FLAG(TABLE_GUARD, auvid_guard_t, stepped, depth_known),

    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, sigma, sigma, AUVID_LARGEST),
    VALUE(TABLE_CONFIDENCE, auvid_confidence_t, thrust_error, bound),
    FLAG(TABLE_CONFIDENCE, auvid_confidence_t, uncertainty, uncertainty),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, note, note, AUVID_NOTE_COUNT - 1),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, partner, partner, AUVID_MAX_PARAMETERS - 1),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, sets, sets, AUVID_MAX_SETS),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, lost, lost, 100),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, effective_noise, residual_rms,
          AUVID_C(1e18)), /* squared */

    DOF_BITS(TABLE_ESTIMATE, auvid_estimate_t, excited),
    VALUE(TABLE_ESTIMATE, auvid_estimate_t, pi, pi),
    WITHIN(TABLE_ESTIMATE, auvid_estimate_t, covariance, covariance, AUVID_C(1e37)),
    UP_TO(TABLE_ESTIMATE, auvid_estimate_t, speed, speed, 66),
    COST(TABLE_ESTIMATE, auvid_estimate_t, cost, cost),
    DELAY(TABLE_ESTIMATE, auvid_estimate_t, delay_s, delay_s),
    DOF_BITS(TABLE_ESTIMATE, auvid_estimate_t, first_order_lag),
    FLAG(TABLE_ESTIMATE, auvid_estimate_t, not_converged, accepted),

    DOF_BITS(TABLE_CHANGE_TEST, auvid_change_test_t, excited),
    DOF_BITS(TABLE_CHANGE_TEST, auvid_change_test_t, changed),
    DOF_BITS(TABLE_CHANGE_TEST, auvid_change_test_t, simulated),

    VALUE(TABLE_SAMPLE, auvid_sample_t, phi, command),
    DOF_BITS(TABLE_SAMPLE, auvid_sample_t, missing),

    VALUE(TABLE_VALIDATION, auvid_validation_t, pi, pi),
    UP_TO(TABLE_VALIDATION, auvid_validation_t, delay_cells, delay_cells, AUVID_C(6.01)),
    VALUE(TABLE_VALIDATION, auvid_validation_t, wrench, wrench),
    UP_TO(TABLE_VALIDATION, auvid_validation_t, cell_s, cell_s, 1),
    DOF_BITS(TABLE_VALIDATION, auvid_validation_t, dofs),
    VALUE(TABLE_VALIDATION, auvid_validation_t, past, past),
    FLAG(TABLE_VALIDATION, auvid_validation_t, running, running),
    VALUE(TABLE_VALIDATION, auvid_validation_t, mean, mean),
    SQUARES(TABLE_VALIDATION, auvid_validation_t, m2, sse),
    LENGTH(TABLE_VALIDATION, auvid_validation_t, predicted, predicted),

    VALUE(TABLE_CRS, auvid_crs_t, theta, theta),
    COST(TABLE_CRS, auvid_crs_t, cost, cost),
    UP_TO(TABLE_CRS, auvid_crs_t, initial_spread, last_spread, AUVID_LARGEST),

    VALUE(TABLE_LINE_SEARCH, auvid_line_search_t, theta, previous),
    COST(TABLE_LINE_SEARCH, auvid_line_search_t, cost, previous_cost),
    UP_TO(TABLE_LINE_SEARCH, auvid_line_search_t, move, move, MOVE_PROBE),
    FLAG(TABLE_LINE_SEARCH, auvid_line_search_t, plain, plain),

    VALUE(TABLE_OPTIMIZER, auvid_optimizer_t, scale, scale),
    EVALUATIONS(TABLE_OPTIMIZER, auvid_optimizer_t, work),
    RANGE(TABLE_OPTIMIZER, auvid_optimizer_t, state, state, (auvid_real_t)AUVID_OPTIMIZER_FRESH,
          AUVID_OPTIMIZER_STATE_COUNT - 1),
    FLAG(TABLE_OPTIMIZER, auvid_optimizer_t, asked, asked),

    VALUE(TABLE_OPTIMUM, auvid_bounded_ls_t, lower, x),
    UP_TO(TABLE_OPTIMUM, auvid_bounded_ls_t, order, order, AUVID_MAX_PARAMETERS - 1),
    RANGE(TABLE_OPTIMUM, auvid_bounded_ls_t, n, n, AUVID_C(1.0), AUVID_MAX_PARAMETERS),
    UP_TO(TABLE_OPTIMUM, auvid_bounded_ls_t, dof, dof, AUVID_DOF_COUNT),

    VALUE(TABLE_JOB, auvid_confidence_job_t, pi, pi),
    UP_TO(TABLE_JOB, auvid_confidence_job_t, parameter_of, parameter_of, AUVID_MAX_PARAMETERS - 1),
    RANGE(TABLE_JOB, auvid_confidence_job_t, n, n, AUVID_C(1.0), AUVID_MAX_PARAMETERS),
    UP_TO(TABLE_JOB, auvid_confidence_job_t, phase, phase, DONE - 1),
    FLAG(TABLE_JOB, auvid_confidence_job_t, not_converged, delayed),

    FLAG(TABLE_SEEN, auvid_guard_seen_t, known, known),

    FLAG(TABLE_IDENTIFIER, auvid_identifier_t, velocity, velocity),
    FLAG(TABLE_IDENTIFIER, auvid_identifier_t, uncertainty, uncertainty),
    UP_TO(TABLE_IDENTIFIER, auvid_identifier_t, phase, phase, AUVID_WORK_PHASE_COUNT - 1),
    UP_TO(TABLE_IDENTIFIER, auvid_identifier_t, parameter_of, parameter_of,
          AUVID_MAX_PARAMETERS - 1),
    VALUE(TABLE_IDENTIFIER, auvid_identifier_t, candidate, candidate),
    DELAY(TABLE_IDENTIFIER, auvid_identifier_t, delay_s, delay_s),
    FLAG(TABLE_IDENTIFIER, auvid_identifier_t, started, started),
    DOF_BITS(TABLE_IDENTIFIER, auvid_identifier_t, default_scale),
    COST(TABLE_IDENTIFIER, auvid_identifier_t, cost, cost),
    UP_TO(TABLE_IDENTIFIER, auvid_identifier_t, untested, untested, AUVID_MAX_SETS),
    FLAG(TABLE_IDENTIFIER, auvid_identifier_t, set_pending, cold_start),

    UP_TO(TABLE_ACTUATION, auvid_actuation_t, altitude_m, altitude_m, AUVID_C(1e9)),
    LENGTH(TABLE_ACTUATION, auvid_actuation_t, home, home),
    FLAG(TABLE_ACTUATION, auvid_actuation_t, starting, saturated),

    VALUE(TABLE_ROW, auvid_row_t, late, late),
};
const size_t auvid_checkpoint_limits =
    sizeof auvid_checkpoint_limit / sizeof auvid_checkpoint_limit[0];
