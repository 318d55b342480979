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

#define KIND(unit)                                                                                 \
    _Generic((unit)0, auvid_real_t                                                                 \
             : KIND_REAL, int8_t                                                                   \
             : KIND_SIGNED, int32_t                                                                \
             : KIND_SIGNED, default                                                                \
             : KIND_UNSIGNED)
#define BYTES(type, first, last)                                                                   \
    (offsetof(type, last) + sizeof(((type *)0)->last) - offsetof(type, first))
/* A negative size, which does not compile, unless there are whole units. */
#define WHOLE_UNITS(bytes, unit)                                                                   \
    ((bytes) / sizeof(char[(bytes) % sizeof(unit) ? -1 : sizeof(unit)]))
/* `first` .. `last`, scalars of type `unit`. */
#define LIMIT(table, type, unit, first, last, low, high)                                           \
    {                                                                                              \
        table, KIND(unit), sizeof(unit), (uint32_t)offsetof(type, first),                          \
            (uint32_t)WHOLE_UNITS(BYTES(type, first, last), unit), low, (auvid_real_t)(high)       \
    }
/* Reals: low .. high; -max .. max; 0 .. max; any finite one. */
#define RANGE(table, type, first, last, low, high)                                                 \
    LIMIT(table, type, auvid_real_t, first, last, low, high)
#define WITHIN(table, type, first, last, max) RANGE(table, type, first, last, -(max), max)
#define UP_TO(table, type, first, last, max) RANGE(table, type, first, last, AUVID_C(0.0), max)
#define FINITE(table, type, first, last) WITHIN(table, type, first, last, AUVID_LARGEST)
/* Integers of a type: low .. high; 0 .. max. */
#define WHOLE(table, type, unit, first, last, low, high)                                           \
    LIMIT(table, type, unit, first, last, (auvid_real_t)(low), high)
#define COUNT(table, type, unit, first, last, max) WHOLE(table, type, unit, first, last, 0, max)
#define BYTE(table, type, first, last, max) COUNT(table, type, uint8_t, first, last, max)
#define FLAG(table, type, first, last) BYTE(table, type, first, last, 1)
/* Bit j: DoF j; bit i: velocity i. */
#define DOF_BITS(table, type, first, last)                                                         \
    BYTE(table, type, first, last, (1 << AUVID_DOF_COUNT) - 1)
#define AXES(table, type, member) BYTE(table, type, member, member, AUVID_DVL_ALL)

/* Parameters, bounds, steps: their squares are finite. Costs (crs.h). Sums of squares of rows,
 * which are within 1e15. Lengths and speeds. Counts of evaluations: they do not wrap around.
 * Delays: six of the longest cells. */
#define VALUE(table, type, first, last) WITHIN(table, type, first, last, AUVID_C(1e18))
#define COST(table, type, first, last) WITHIN(table, type, first, last, AUVID_COST_FAILED)
#define SQUARES(table, type, first, last) UP_TO(table, type, first, last, AUVID_C(1e35))
#define LENGTH(table, type, first, last) WITHIN(table, type, first, last, AUVID_C(1e9))
#define EVALUATIONS(table, type, member) COUNT(table, type, uint32_t, member, member, 1 << 30)
#define DELAY(table, type, first, last)                                                            \
    RANGE(table, type, first, last, AUVID_C(-2.01), AUVID_C(6.01))

enum { ALL_DOF = (1 << AUVID_DOF_COUNT) - 1, MAX_ROWS = 60000 /* of all sets */ };

const auvid_checkpoint_limit_t auvid_checkpoint_limit[] = {
    LENGTH(TABLE_VELOCITY_SAMPLE, auvid_nav_velocity_sample_t, velocity, velocity),
    AXES(TABLE_VELOCITY_SAMPLE, auvid_nav_velocity_sample_t, measured),

    FINITE(TABLE_DIAGNOSTICS, auvid_nav_diagnostics_t, innovation, nis),
    BYTE(TABLE_DIAGNOSTICS, auvid_nav_diagnostics_t, innovation_count, innovation_count, 3),
    FLAG(TABLE_DIAGNOSTICS, auvid_nav_diagnostics_t, has_sample, has_sample),

    FINITE(TABLE_NAV, auvid_nav_t, position, gps_offset),
    LENGTH(TABLE_NAV, auvid_nav_t, position, velocity),
    WITHIN(TABLE_NAV, auvid_nav_t, pp, vv, AUVID_C(1e15)),
    WITHIN(TABLE_NAV, auvid_nav_t, rotation, rotation, AUVID_C(1.01)),
    WITHIN(TABLE_NAV, auvid_nav_t, attitude, attitude, AUVID_C(1e4)),
    WITHIN(TABLE_NAV, auvid_nav_t, rates, past_rates, AUVID_C(100.0)),
    WITHIN(TABLE_NAV, auvid_nav_t, held, held, NAV_LARGEST_POSITION),
    LENGTH(TABLE_NAV, auvid_nav_t, gps_offset, gps_offset),
    WHOLE(TABLE_NAV, auvid_nav_t, int32_t, yaw_revolutions, yaw_revolutions, AUVID_C(-1e6),
          AUVID_C(1e6)),
    COUNT(TABLE_NAV, auvid_nav_t, uint16_t, flags, flags, 2 * (AUVID_NAV_FLAG_END - 1) - 1),
    FLAG(TABLE_NAV, auvid_nav_t, horizontal, complete),
    BYTE(TABLE_NAV, auvid_nav_t, gps_start, gps_count, AUVID_NAV_GPS_START_MAX),
    WHOLE(TABLE_NAV, auvid_nav_t, uint8_t, ready, ready, NAV_READY, NAV_RUNNING),
    BYTE(TABLE_NAV, auvid_nav_t, held_rejected, holding, (1 << AUVID_NAV_SENSOR_COUNT) - 1),
    BYTE(TABLE_NAV, auvid_nav_t, past_next, past_next, 2 * AUVID_NAV_PAST - 1),
    AXES(TABLE_NAV, auvid_nav_t, held_valid),

    FLAG(TABLE_STREAM, auvid_recorder_stream_t, valid, valid),

    WITHIN(TABLE_RECORDER, auvid_recorder_t, last, mean, AUVID_C(2e9)),
    AXES(TABLE_RECORDER, auvid_recorder_t, measured),
    WHOLE(TABLE_RECORDER, auvid_recorder_t, uint32_t, gap_us, gap_us, 1000, 1000000000),
    COUNT(TABLE_RECORDER, auvid_recorder_t, uint32_t, interval_us, interval_us, 1000000),
    FLAG(TABLE_RECORDER, auvid_recorder_t, running, broken),
    BYTE(TABLE_RECORDER, auvid_recorder_t, intervals, intervals, AUVID_RECORDER_INTERVALS - 1),

    SQUARES(TABLE_SET, auvid_set_t, tau_m2, tau_m2),
    WHOLE(TABLE_SET, auvid_set_t, int8_t, exponent, exponent, -126, 60),
    DOF_BITS(TABLE_SET, auvid_set_t, excited, excited),

    FINITE(TABLE_METRIC, auvid_metric_t, prior.pi, prior.variance_inflation),
    FINITE(TABLE_METRIC, auvid_metric_t, result.constant, result.constant),
    DELAY(TABLE_METRIC, auvid_metric_t, result.delay_s, result.delay_s),
    COUNT(TABLE_METRIC, auvid_metric_t, uint16_t, result.dof_rows, result.dof_rows, MAX_ROWS),
    BYTE(TABLE_METRIC, auvid_metric_t, result.change_rank, result.change_rank,
         AUVID_MAX_PARAMETERS),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, result.excited, result.first_order_lag),
    DELAY(TABLE_METRIC, auvid_metric_t, evaluator.linear_delay_s, evaluator.linear_delay_s),
    COUNT(TABLE_METRIC, auvid_metric_t, uint16_t, evaluator.at.row, evaluator.at.row,
          MAX_ROWS + AUVID_METRIC_WINDOW),
    BYTE(TABLE_METRIC, auvid_metric_t, evaluator.at.band, evaluator.at.band,
         AUVID_METRIC_BANDS - 1),
    BYTE(TABLE_METRIC, auvid_metric_t, evaluator.at.dof, evaluator.at.dof, AUVID_DOF_COUNT),
    BYTE(TABLE_METRIC, auvid_metric_t, evaluator.at.pass, evaluator.at.pass, PASS_LINEAR),
    BYTE(TABLE_METRIC, auvid_metric_t, evaluator.window_of, evaluator.window_of,
         AUVID_METRIC_WINDOW),
    BYTE(TABLE_METRIC, auvid_metric_t, evaluator.sets_merged, evaluator.sets_merged,
         AUVID_MAX_SETS),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.weight, evaluator.weight, AUVID_C(1e24)),
    UP_TO(TABLE_METRIC, auvid_metric_t, evaluator.band_weight, evaluator.band_weight, AUVID_C(1e3)),
    FINITE(TABLE_METRIC, auvid_metric_t, evaluator.delay_weight, evaluator.candidate),
    VALUE(TABLE_METRIC, auvid_metric_t, evaluator.merged, evaluator.merged),
    BYTE(TABLE_METRIC, auvid_metric_t, rows.successive, rows.successive, AUVID_METRIC_LAGS),
    VALUE(TABLE_METRIC, auvid_metric_t, rows.set.tau_mean, rows.set.tau_mean),
    SQUARES(TABLE_METRIC, auvid_metric_t, rows.set.tau_m2, rows.set.tau_m2),
    VALUE(TABLE_METRIC, auvid_metric_t, rows.set.factor, rows.previous),
    DOF_BITS(TABLE_METRIC, auvid_metric_t, rows.missing, rows.missing),
    BYTE(TABLE_METRIC, auvid_metric_t, sets.from, sets.least, AUVID_MAX_SETS),
    FLAG(TABLE_METRIC, auvid_metric_t, sets.held, sets.changed),

    WITHIN(TABLE_CHANNEL, auvid_excitation_channel_t, level, before, AUVID_C(1.0)),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, scale, scale, AUVID_C(1e4)),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, frequency_hz, frequency_hz, AUVID_C(6.0)),
    UP_TO(TABLE_CHANNEL, auvid_excitation_channel_t, cycles, cycles, 1),
    BYTE(TABLE_CHANNEL, auvid_excitation_channel_t, segment, segment, AUVID_MAX_SEGMENTS),
    FLAG(TABLE_CHANNEL, auvid_excitation_channel_t, second, negative),
    VALUE(TABLE_EXCITATION, auvid_excitation_t, displacement, displacement),
    FLAG(TABLE_EXCITATION, auvid_excitation_t, running, finished),

    FINITE(TABLE_TRIP, auvid_guard_trip_t, value, limit),
    BYTE(TABLE_TRIP, auvid_guard_trip_t, cause, cause, AUVID_GUARD_CAUSE_COUNT - 1),

    LENGTH(TABLE_ADAPTIVE, auvid_adaptive_t, low_owed, low_owed),
    DOF_BITS(TABLE_ADAPTIVE, auvid_adaptive_t, playing, playing),

    LENGTH(TABLE_GUARD, auvid_guard_t, home, home),
    BYTE(TABLE_GUARD, auvid_guard_t, state, state, AUVID_GUARD_STATE_COUNT - 1),
    FLAG(TABLE_GUARD, auvid_guard_t, stepped, depth_known),

    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, sigma, sigma, AUVID_LARGEST),
    VALUE(TABLE_CONFIDENCE, auvid_confidence_t, thrust_error, bound),
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, effective_noise, residual_rms,
          AUVID_C(1e18)), /* squared */
    UP_TO(TABLE_CONFIDENCE, auvid_confidence_t, uncertainty, uncertainty, 1),
    BYTE(TABLE_CONFIDENCE, auvid_confidence_t, note, note, AUVID_NOTE_COUNT - 1),
    BYTE(TABLE_CONFIDENCE, auvid_confidence_t, partner, partner, AUVID_MAX_PARAMETERS - 1),
    BYTE(TABLE_CONFIDENCE, auvid_confidence_t, sets, sets, AUVID_MAX_SETS),
    BYTE(TABLE_CONFIDENCE, auvid_confidence_t, lost, lost, 100),

    VALUE(TABLE_ESTIMATE, auvid_estimate_t, pi, pi),
    WITHIN(TABLE_ESTIMATE, auvid_estimate_t, covariance, covariance, AUVID_C(1e37)),
    UP_TO(TABLE_ESTIMATE, auvid_estimate_t, speed, speed, 66),
    COST(TABLE_ESTIMATE, auvid_estimate_t, cost, cost),
    DELAY(TABLE_ESTIMATE, auvid_estimate_t, delay_s, delay_s),
    FINITE(TABLE_ESTIMATE, auvid_estimate_t, r2_force, r2_force),
    DOF_BITS(TABLE_ESTIMATE, auvid_estimate_t, excited, first_order_lag),
    FLAG(TABLE_ESTIMATE, auvid_estimate_t, not_converged, accepted),

    FINITE(TABLE_CHANGE_TEST, auvid_change_test_t, variance_ratio, r2_velocity),
    DOF_BITS(TABLE_CHANGE_TEST, auvid_change_test_t, excited, simulated),

    VALUE(TABLE_SAMPLE, auvid_sample_t, phi, command),
    DOF_BITS(TABLE_SAMPLE, auvid_sample_t, missing, missing),

    VALUE(TABLE_PREDICTION, auvid_validation_t, pi, mean),
    UP_TO(TABLE_PREDICTION, auvid_validation_t, delay_cells, delay_cells, AUVID_C(6.01)),
    UP_TO(TABLE_PREDICTION, auvid_validation_t, cell_s, cell_s, 1),
    SQUARES(TABLE_PREDICTION, auvid_validation_t, m2, sse),
    LENGTH(TABLE_PREDICTION, auvid_validation_t, predicted, predicted),
    COUNT(TABLE_PREDICTION, auvid_validation_t, uint32_t, dofs, dofs, ALL_DOF),
    FLAG(TABLE_PREDICTION, auvid_validation_t, running, running),

    FINITE(TABLE_SEARCH, auvid_search_config_t, lower, epsilon_line),
    VALUE(TABLE_SEARCH, auvid_search_config_t, lower, good),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, epsilon_crs, epsilon_crs, AUVID_LARGEST),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, reduction, reduction, 1),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, omega, omega, AUVID_C(1e9)),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, alpha0, alpha0, 1000),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, sigma, sigma, 1),
    RANGE(TABLE_SEARCH, auvid_search_config_t, delta, delta, AUVID_C(1.0), AUVID_C(100.0)),
    UP_TO(TABLE_SEARCH, auvid_search_config_t, gamma, epsilon_line, 1),
    COUNT(TABLE_SEARCH, auvid_search_config_t, uint16_t, population, population,
          AUVID_MAX_POPULATION),
    WHOLE(TABLE_SEARCH, auvid_search_config_t, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(TABLE_SEARCH, auvid_search_config_t, phases, phases, AUVID_SEARCH_LOCAL),
    FLAG(TABLE_SEARCH, auvid_search_config_t, has_good, paper),

    VALUE(TABLE_OPTIMIZER, auvid_optimizer_t, scale, scale),
    EVALUATIONS(TABLE_OPTIMIZER, auvid_optimizer_t, work),
    WHOLE(TABLE_OPTIMIZER, auvid_optimizer_t, uint8_t, state, state, AUVID_OPTIMIZER_FRESH,
          AUVID_OPTIMIZER_STATE_COUNT - 1),
    FLAG(TABLE_OPTIMIZER, auvid_optimizer_t, asked, asked),

    VALUE(TABLE_CRS, auvid_crs_t, theta, theta),
    COST(TABLE_CRS, auvid_crs_t, cost, cost),
    UP_TO(TABLE_CRS, auvid_crs_t, initial_spread, last_spread, AUVID_LARGEST),

    FINITE(TABLE_LINE_SEARCH, auvid_line_search_t, theta, cost_far),
    VALUE(TABLE_LINE_SEARCH, auvid_line_search_t, theta, previous),
    COST(TABLE_LINE_SEARCH, auvid_line_search_t, cost, previous_cost),
    BYTE(TABLE_LINE_SEARCH, auvid_line_search_t, move, move, MOVE_PROBE),
    FLAG(TABLE_LINE_SEARCH, auvid_line_search_t, plain, plain),

    FINITE(TABLE_OPTIMUM, auvid_bounded_ls_t, lower, work),
    VALUE(TABLE_OPTIMUM, auvid_bounded_ls_t, lower, x),
    BYTE(TABLE_OPTIMUM, auvid_bounded_ls_t, order, order, AUVID_MAX_PARAMETERS - 1),
    WHOLE(TABLE_OPTIMUM, auvid_bounded_ls_t, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(TABLE_OPTIMUM, auvid_bounded_ls_t, dof, dof, AUVID_DOF_COUNT),

    FINITE(TABLE_JOB, auvid_confidence_job_t, dry_mass_kg, rows),
    VALUE(TABLE_JOB, auvid_confidence_job_t, pi, pi),
    BYTE(TABLE_JOB, auvid_confidence_job_t, parameter_of, parameter_of, AUVID_MAX_PARAMETERS - 1),
    WHOLE(TABLE_JOB, auvid_confidence_job_t, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(TABLE_JOB, auvid_confidence_job_t, phase, phase, DONE - 1),
    FLAG(TABLE_JOB, auvid_confidence_job_t, not_converged, delayed),

    FLAG(TABLE_SEEN, auvid_guard_seen_t, known, known),

    BYTE(TABLE_IDENTIFIER, auvid_identifier_t, phase, phase, AUVID_WORK_PHASE_COUNT - 1),
    BYTE(TABLE_IDENTIFIER, auvid_identifier_t, parameter_of, parameter_of,
         AUVID_MAX_PARAMETERS - 1),
    VALUE(TABLE_IDENTIFIER, auvid_identifier_t, candidate, candidate),
    DELAY(TABLE_IDENTIFIER, auvid_identifier_t, delay_s, delay_s),
    COST(TABLE_IDENTIFIER, auvid_identifier_t, cost, cost),
    BYTE(TABLE_IDENTIFIER, auvid_identifier_t, untested, untested, AUVID_MAX_SETS),
    FLAG(TABLE_IDENTIFIER, auvid_identifier_t, started, cold_start),

    UP_TO(TABLE_ACTUATION, auvid_actuation_t, altitude_m, altitude_m, AUVID_C(1e9)),
    LENGTH(TABLE_ACTUATION, auvid_actuation_t, home, home),
    FLAG(TABLE_ACTUATION, auvid_actuation_t, starting, saturated),

    VALUE(TABLE_ROW, auvid_row_t, late, late),
};
const size_t auvid_checkpoint_limits =
    sizeof auvid_checkpoint_limit / sizeof auvid_checkpoint_limit[0];
