/*
 * The checkpoint: the range of the members of each struct, in the order of
 * auvid_checkpoint_layout.c. A member that is not listed may have any value, a real any finite one.
 * Conditions between members are in auvid_checkpoint_validate.c.
 */
#include "auvid_checkpoint_limits_internal.h"
#include "../identifier/auvid_actuation_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "../search/auvid_gauss_newton_internal.h"
#include "../search/auvid_line_search_directions_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../navigation/auvid_nav_internal.h"

enum { MAX_ROWS = 60000 /* of all sets */ };

/* A parameter, or what a note counts with it. */
enum {
    MAX_PARTNER =
        AUVID_MAX_PARAMETERS > UNACTUATED_ROWS ? AUVID_MAX_PARAMETERS - 1 : UNACTUATED_ROWS
};

const auvid_checkpoint_limit_t auvid_checkpoint_limit[] = {
    LENGTH(nav_velocity_sample, velocity, velocity),
    AXES(nav_velocity_sample, measured),

    FINITE(nav_diagnostics, innovation, nis),
    BYTE(nav_diagnostics, innovation_count, innovation_count, 3),
    FLAG(nav_diagnostics, has_sample, has_sample),

    COUNT(nav, uint16_t, flags, flags, 2 * (AUVID_NAV_FLAG_END - 1) - 1),
    FLAG(nav, horizontal, complete),
    WITHIN(nav, held.value, held.value, NAV_LARGEST_POSITION),
    AXES(nav, held.valid),
    BYTE(nav, held.sensors, held.rejected, (1 << AUVID_NAV_SENSOR_COUNT) - 1),
    WITHIN(nav, imu.rotation, imu.rotation, AUVID_C(1.01)),
    WITHIN(nav, imu.attitude, imu.attitude, AUVID_C(1e4)),
    WITHIN(nav, imu.rates, imu.past_rates, AUVID_C(100.0)),
    SIGNED(nav, int32_t, imu.revolutions, imu.revolutions, -1000000, 1000000),
    BYTE(nav, imu.past_next, imu.past_next, 2 * AUVID_NAV_PAST - 1),
    BYTE(nav, imu.ready, imu.ready, NAV_RUNNING),
    LENGTH(nav, ekf.position, ekf.velocity),
    WITHIN(nav, ekf.pp, ekf.vv, AUVID_C(1e15)),
    LENGTH(nav, gps.offset, gps.offset),
    BYTE(nav, gps.start, gps.count, AUVID_NAV_GPS_START_MAX),

    FLAG(recorder_stream, valid, valid),

    WITHIN(recorder, last, slope, AUVID_C(2e9)),
    RANGE(recorder, spread, spread, AUVID_C(0.0005), AUVID_C(2e9)),
    WITHIN(recorder, mean, mean, AUVID_C(2e9)),
    AXES(recorder, measured),
    WHOLE(recorder, uint32_t, gap_us, gap_us, 1000, 1000000000),
    COUNT(recorder, uint32_t, before_us, before_us, 1000000000),
    COUNT(recorder, uint32_t, interval_us, interval_us, 1000000),
    FLAG(recorder, running, broken),
    BYTE(recorder, intervals, intervals, AUVID_RECORDER_INTERVALS - 1),

    SQUARES(set, tau_m2, tau_m2),
    SIGNED(set, int8_t, exponent, exponent, -126, 60),
    DOF_BITS(set, excited, excited),

    FINITE(metric, result.constant, result.constant),
    DELAY(metric, result.delay_s, result.delay_s),
    COUNT(metric, uint16_t, result.dof_rows, result.dof_rows, MAX_ROWS),
    DOF_BITS(metric, result.excited, result.first_order_lag),
    FLAG(metric, result.width_chosen, result.width_chosen),
    BYTE(metric, evaluator.noise, evaluator.noise, 3),
    DOF_BITS(metric, result.coupled, result.coupled),
    DELAY(metric, evaluator.linear_delay_s, evaluator.linear_delay_s),
    UP_TO(metric, evaluator.thrust, evaluator.thrust, AUVID_C(16000000.0)),
    COUNT(metric, uint16_t, evaluator.at.row, evaluator.at.row, MAX_ROWS + AUVID_METRIC_WINDOW),
    BYTE(metric, evaluator.at.band, evaluator.at.band, AUVID_METRIC_BANDS - 1),
    BYTE(metric, evaluator.at.dof, evaluator.at.dof, AUVID_DOF_COUNT),
    BYTE(metric, evaluator.at.pass, evaluator.at.pass, PASS_LINEAR),
    FLAG(metric, evaluator.at.plain, evaluator.at.plain),
    BYTE(metric, evaluator.window_of, evaluator.window_of, AUVID_METRIC_WINDOW),
    BYTE(metric, evaluator.sets_merged, evaluator.sets_merged, AUVID_MAX_SETS),
    UP_TO(metric, evaluator.weight, evaluator.weight, AUVID_C(1e24)),
    UP_TO(metric, evaluator.band_weight, evaluator.band_weight, AUVID_C(1e3)),
    SQUARES(metric, evaluator.high_wrench, evaluator.coupled_squares),
    UP_TO(metric, evaluator.disagreement, evaluator.disagreement, AUVID_LARGEST),
    FINITE(metric, evaluator.delay_weight, evaluator.candidate),
    VALUE(metric, evaluator.merged, evaluator.merged),
    BYTE(metric, rows.successive, rows.successive, AUVID_METRIC_LAGS),
    VALUE(metric, rows.set.tau_mean, rows.set.tau_mean),
    SQUARES(metric, rows.set.tau_m2, rows.set.tau_m2),
    VALUE(metric, rows.set.factor, rows.previous),
    DOF_BITS(metric, rows.missing, rows.waiting),
    SQUARES(metric, sets.min_wrench_m2, sets.min_wrench_m2),
    BYTE(metric, sets.from, sets.least, AUVID_MAX_SETS),
    FLAG(metric, sets.held, sets.changed),
    VALUE(metric, feedback.factor, feedback.wrench),
    UP_TO(metric, feedback.rows, feedback.rows, AUVID_C(1e9)),

    WITHIN(excitation_channel, level, before, AUVID_C(1.0)),
    UP_TO(excitation_channel, scale, scale, AUVID_C(1e4)),
    UP_TO(excitation_channel, frequency_hz, frequency_hz, AUVID_C(6.0)),
    UP_TO(excitation_channel, cycles, cycles, 1),
    BYTE(excitation_channel, segment, segment, AUVID_MAX_SEGMENTS),
    FLAG(excitation_channel, second, negative),
    VALUE(excitation, displacement, displacement),
    FLAG(excitation, running, finished),

    FINITE(guard_trip, value, limit),
    BYTE(guard_trip, cause, cause, AUVID_GUARD_CAUSE_COUNT - 1),

    LENGTH(adaptive, low_owed, low_owed),
    DOF_BITS(adaptive, playing, playing),

    LENGTH(guard, home, home),
    BYTE(guard, state, state, AUVID_GUARD_STATE_COUNT - 1),
    FLAG(guard, stepped, depth_known),

    UP_TO(confidence, sigma, sigma, AUVID_LARGEST),
    VALUE(confidence, thrust_error, bound),
    UP_TO(confidence, effective_noise, residual_rms, AUVID_C(1e18)), /* squared */
    UP_TO(confidence, uncertainty, uncertainty, 1),
    BYTE(confidence, note, note, AUVID_NOTE_COUNT - 1),
    BYTE(confidence, partner, partner, MAX_PARTNER),
    BYTE(confidence, sets, sets, AUVID_MAX_SETS),
    BYTE(confidence, lost, lost, 100),
    FLAG(confidence, unchecked, unchecked),

    VALUE(estimate, pi, pi),
    WITHIN(estimate, covariance, covariance, AUVID_C(1e37)),
    UP_TO(estimate, speed, speed, 66),
    COST(estimate, cost, cost),
    DELAY(estimate, delay_s, delay_s),
    FINITE(estimate, r2_force, r2_force),
    DOF_BITS(estimate, excited, first_order_lag),
    FLAG(estimate, not_converged, accepted),

    UP_TO(change_detector, noise, noise, AUVID_C(1e18)), /* squared */
    UP_TO(change_detector, first.speed, first.speed, 66),
    FINITE(change_detector, first.value, first.value),
    UP_TO(change_detector, first.variance, first.variance, AUVID_LARGEST),
    BYTE(change_detector, statistic.rank, statistic.rank, AUVID_MAX_PARAMETERS),
    FLAG(change_detector, straddles_change, straddles_change),
    DOF_BITS(change_detector, suspected, suspected),
    FINITE(prior, pi, variance_inflation),
    FINITE(change_test, variance_ratio, drift),
    DOF_BITS(change_test, excited, drifted),

    VALUE(sample, phi, command),
    DOF_BITS(sample, missing, missing),

    VALUE(validation, pi, mean),
    UP_TO(validation, delay_cells, delay_cells, AUVID_C(6.01)),
    UP_TO(validation, cell_s, cell_s, 1),
    SQUARES(validation, m2, sse),
    LENGTH(validation, predicted, predicted),
    COUNT(validation, uint32_t, dofs, dofs, ALL_DOF),
    FLAG(validation, running, waits),

    VALUE(search_config, lower, good),
    UP_TO(search_config, epsilon_crs, epsilon_crs, AUVID_LARGEST),
    UP_TO(search_config, reduction, reduction, 1),
    UP_TO(search_config, omega, omega, AUVID_C(1e9)),
    UP_TO(search_config, alpha0, alpha0, 1000),
    UP_TO(search_config, sigma, sigma, 1),
    RANGE(search_config, delta, delta, AUVID_C(1.0), AUVID_C(100.0)),
    UP_TO(search_config, gamma, epsilon_line, 1),
    COUNT(search_config, uint16_t, population, population, AUVID_MAX_POPULATION),
    WHOLE(search_config, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(search_config, phases, phases, AUVID_SEARCH_LOCAL),
    FLAG(search_config, has_good, paper),

    VALUE(optimizer, scale, scale),
    EVALUATIONS(optimizer, work),
    WHOLE(optimizer, uint8_t, state, state, AUVID_OPTIMIZER_FRESH, AUVID_OPTIMIZER_STATE_COUNT - 1),
    COST(optimizer, least, allowed),
    FLAG(optimizer, asked, has_goal),

    VALUE(crs, theta, theta),
    COST(crs, cost, cost),
    UP_TO(crs, initial_spread, last_spread, AUVID_LARGEST),

    FINITE(line_search, axis_cost, shear),
    VALUE(line_search, theta, previous),
    COST(line_search, cost, previous_cost),
    BYTE(line_search, move, move, MOVE_PROBE),
    FLAG(line_search, plain, plain),

    FINITE(bounded_ls, lower, work),
    VALUE(bounded_ls, lower, x),
    BYTE(bounded_ls, order, order, AUVID_MAX_PARAMETERS - 1),
    WHOLE(bounded_ls, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(bounded_ls, dof, dof, AUVID_DOF_COUNT),

    VALUE(gauss_newton, lower, x),
    COST(gauss_newton, cost, cost),
    SQUARES(gauss_newton, squares, squares),
    UP_TO(gauss_newton, damping, damping, NEWTON_MAX_DAMPING),
    BYTE(gauss_newton, state, state, NEWTON_DONE),
    BYTE(gauss_newton, rows, rows, NEWTON_MAX_ROWS),
    BYTE(gauss_newton, rejected, rejected, NEWTON_MAX_REJECTED),
    BYTE(gauss_newton, damped, damped, AUVID_MAX_PARAMETERS),

    FINITE(confidence_job, dry_mass_kg, dry_mass_kg),
    FINITE(confidence_job, score, part),
    VALUE(confidence_job, pi, single_dof_optimum),
    BYTE(confidence_job, parameter_of, parameter_of, AUVID_MAX_PARAMETERS - 1),
    WHOLE(confidence_job, uint8_t, n, n, 1, AUVID_MAX_PARAMETERS),
    BYTE(confidence_job, phase, phase, DONE),
    FLAG(confidence_job, not_converged, delayed),

    FLAG(guard_seen, known, known),

    BYTE(identifier, work.phase, work.phase, AUVID_WORK_PHASE_COUNT - 1),
    BYTE(identifier, work.parameter_of, work.parameter_of, AUVID_MAX_PARAMETERS - 1),
    VALUE(identifier, work.candidate, work.candidate),
    DELAY(identifier, work.delay_s, work.delay_s),
    COST(identifier, work.cost, work.minimum),
    BYTE(identifier, work.untested, work.untested, AUVID_MAX_SETS),
    BYTE(identifier, work.refuted, work.refuted, WORK_CONTINUATIONS + 1),
    BYTE(identifier, work.neighbours, work.neighbours, WORK_NEIGHBOURS),
    BYTE(identifier, work.sides_left, work.sides_left, 2),
    FLAG(identifier, work.set_pending, work.seeks_optimum),
    FLAG(identifier, started, started),

    UP_TO(actuation, altitude_m, altitude_m, AUVID_ACTUATION_HIGHEST_M),
    LENGTH(actuation, home, home),
    FLAG(actuation, starting, saturated),

    VALUE(row, late, late),
};
const size_t auvid_checkpoint_limits =
    sizeof auvid_checkpoint_limit / sizeof auvid_checkpoint_limit[0];
