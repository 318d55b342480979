/*
 * The checkpoint: its contents, struct by struct. Three kinds of members are left out: pointers,
 * which the restored identifier already has; memory that is unused between calls; and what decides
 * on forces. The plan of the excitation, the thrusters and the guard's limits stay those of init. A
 * test (tests/validation/test_checkpoint.sh) lists what is missing. The range of each member is in
 * auvid_checkpoint_limits.c.
 */
#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_math_internal.h"

/* `first` .. `last` are neighbours, all of type `unit`. Another type among them mostly leaves a
 * remainder; then the array has a negative size, which does not compile. */
#define SIZE(type, member) sizeof(((type *)0)->member)
#define BYTES(type, first, last) (offsetof(type, last) + SIZE(type, last) - offsetof(type, first))
#define WHOLE(bytes, unit) ((bytes) / sizeof(char[(bytes) % sizeof(unit) == 0 ? 1 : -1]))
#define SOME(type, unit, first, last, parts, finite)                                               \
    {                                                                                              \
        offsetof(type, first), (uint32_t)(WHOLE(BYTES(type, first, last), unit) / sizeof(unit)),   \
            (uint32_t)sizeof(unit), (uint8_t)sizeof(unit), 0, parts, finite                        \
    }
#define SPAN(type, unit, first, last) SOME(type, unit, first, last, 0, false)
#define REALS(type, first, last) SOME(type, auvid_real_t, first, last, 0, true)
/* Costs and residuals, which may be infinite or NaN where a model fails. */
#define COSTS(type, first, last) SOME(type, auvid_real_t, first, last, 0, false)
/* Flags are bytes, too. */
#define BYTE(type, first, last) SOME(type, uint8_t, first, last, 0, false)
/* An enumeration, in a byte: the compiler chooses its width in memory. */
#define ENUM(type, member)                                                                         \
    {                                                                                              \
        offsetof(type, member), 1, (uint32_t)SIZE(type, member), 1, 0, 0, false                    \
    }
#define STRUCT_OF(type, member, table, parts)                                                      \
    {                                                                                              \
        offsetof(type, member), 1, (uint32_t)SIZE(type, member), 0, table, parts, false            \
    }
#define STRUCT(type, member, table) STRUCT_OF(type, member, table, 0)
/* An array of structs. */
#define STRUCTS(type, member, table)                                                               \
    {                                                                                              \
        offsetof(type, member), (uint32_t)(SIZE(type, member) / SIZE(type, member[0])),            \
            (uint32_t)SIZE(type, member[0]), 0, table, 0, false                                    \
    }

typedef auvid_checkpoint_row_t row_t;

static const row_t search[] = {
    SPAN(auvid_search_config_t, uint64_t, seed, seed),
    REALS(auvid_search_config_t, lower, epsilon_line),
    SPAN(auvid_search_config_t, uint32_t, max_evaluations_crs, max_rejections),
    SPAN(auvid_search_config_t, uint16_t, population, population),
    BYTE(auvid_search_config_t, n, paper),
};

static const row_t velocity_sample[] = {
    SPAN(auvid_nav_velocity_sample_t, uint64_t, t_us, t_us),
    REALS(auvid_nav_velocity_sample_t, velocity, velocity),
    SPAN(auvid_nav_velocity_sample_t, uint32_t, sequence, sequence),
    BYTE(auvid_nav_velocity_sample_t, measured, measured),
};

static const row_t diagnostics[] = {
    SPAN(auvid_nav_diagnostics_t, uint64_t, seen_us, good_us),
    SPAN(auvid_nav_diagnostics_t, uint32_t, accepted, accepted),
    SPAN(auvid_nav_diagnostics_t, uint16_t, unused, consecutive_rejections),
    BYTE(auvid_nav_diagnostics_t, innovation_count, has_sample),
    REALS(auvid_nav_diagnostics_t, innovation, nis),
};

static const row_t nav[] = {
    STRUCT(auvid_nav_t, ground, TABLE_VELOCITY_SAMPLE),
    STRUCT(auvid_nav_t, water, TABLE_VELOCITY_SAMPLE),
    SPAN(auvid_nav_t, uint64_t, horizontal_us, complete_us),
    BYTE(auvid_nav_t, horizontal, complete),
    STRUCTS(auvid_nav_t, diagnostics, TABLE_DIAGNOSTICS),
    SPAN(auvid_nav_t, uint16_t, imu_time, max_consecutive_rejections),
    BYTE(auvid_nav_t, gps_start, gps_count),
    SPAN(auvid_nav_t, uint16_t, flags, flags),
    BYTE(auvid_nav_t, ready, past_next),
    SPAN(auvid_nav_t, uint64_t, held_us, last_update_us),
    REALS(auvid_nav_t, position, rates),
    SPAN(auvid_nav_t, int32_t, yaw_revolutions, yaw_revolutions),
    REALS(auvid_nav_t, q, lever),
    SPAN(auvid_nav_t, uint32_t, max_age_us, past_us),
    REALS(auvid_nav_t, past_rates, gps_offset),
};

static const row_t stream[] = {
    SPAN(auvid_recorder_stream_t, uint64_t, t_us, filled_us),
    SPAN(auvid_recorder_stream_t, uint32_t, cell, cell),
    BYTE(auvid_recorder_stream_t, valid, valid),
};

static const row_t recorder[] = {
    SPAN(auvid_recorder_t, uint32_t, cfg.cell_us, cfg.velocity_us),
    ENUM(auvid_recorder_t, cfg.input),
    STRUCTS(auvid_recorder_t, stream, TABLE_STREAM),
    REALS(auvid_recorder_t, last, mean),
    SPAN(auvid_recorder_t, uint64_t, origin_us, origin_us),
    SPAN(auvid_recorder_t, uint32_t, opened, interval_us),
    BYTE(auvid_recorder_t, measured, intervals),
};

static const row_t set[] = {
    REALS(auvid_set_t, tau_m2, tau_m2),          SPAN(auvid_set_t, auvid_packed_t, factor, factor),
    SPAN(auvid_set_t, uint32_t, number, number), SPAN(auvid_set_t, uint16_t, rows, fastest),
    BYTE(auvid_set_t, exponent, excited),
};

static const row_t metric[] = {
    SPAN(auvid_metric_t, uint32_t, cfg.free, cfg.free),
    REALS(auvid_metric_t, cfg.fixed, cfg.excitation_threshold),
    SPAN(auvid_metric_t, uint32_t, cfg.cell_us, cfg.velocity_us),
    SPAN(auvid_metric_t, uint16_t, cfg.row_cells, cfg.set_rows),
    BYTE(auvid_metric_t, cfg.sets, cfg.sets),
    BYTE(auvid_metric_t, cfg.half_width, cfg.estimate_delay),
    REALS(auvid_metric_t, cfg.delay_s, cfg.delay_sigma_s),
    BYTE(auvid_metric_t, cfg.first_order_lag, cfg.first_order_lag),
    SPAN(auvid_metric_t, uint32_t, prior.known, prior.known),
    REALS(auvid_metric_t, prior.pi, prior.variance_inflation),
    SPAN(auvid_metric_t, uint32_t, layout.columns, layout.columns),
    SPAN(auvid_metric_t, uint16_t, layout.factor_at, layout.channel_at),
    BYTE(auvid_metric_t, layout.count, layout.window_length),
    REALS(auvid_metric_t, layout.window_weight, layout.kernel),
    BYTE(auvid_metric_t, layout.index, layout.index),
    COSTS(auvid_metric_t, result.cost, result.cost),
    REALS(auvid_metric_t, result.constant, result.delay_s),
    COSTS(auvid_metric_t, result.sse, result.change),
    SPAN(auvid_metric_t, uint16_t, result.dof_rows, result.dof_rows),
    BYTE(auvid_metric_t, result.change_rank, result.first_order_lag),
    SPAN(auvid_metric_t, uint64_t, evaluator.window_us, evaluator.window_us),
    COSTS(auvid_metric_t, evaluator.sum, evaluator.squares),
    REALS(auvid_metric_t, evaluator.linear_delay_s, evaluator.linear_delay_s),
    SPAN(auvid_metric_t, uint32_t, evaluator.window_rows, evaluator.window_rows),
    SPAN(auvid_metric_t, uint16_t, evaluator.at.row, evaluator.at.spent),
    BYTE(auvid_metric_t, evaluator.at.set, evaluator.at.pass),
    BYTE(auvid_metric_t, evaluator.window_of, evaluator.sets_merged),
    REALS(auvid_metric_t, evaluator.weight, evaluator.band_weight),
    COSTS(auvid_metric_t, evaluator.band_sse, evaluator.band_sse),
    REALS(auvid_metric_t, evaluator.delay_weight, evaluator.candidate),
    COSTS(auvid_metric_t, evaluator.z, evaluator.z),
    REALS(auvid_metric_t, evaluator.merged, evaluator.merged),
    SOME(auvid_metric_t, auvid_real_t, evaluator.window, evaluator.window, PART_RESIDUAL, false),
    SPAN(auvid_metric_t, uint32_t, rows.cells, rows.since_gap),
    BYTE(auvid_metric_t, rows.successive, rows.successive),
    SPAN(auvid_metric_t, uint16_t, rows.set.rows, rows.set.fastest),
    REALS(auvid_metric_t, rows.set.tau_mean, rows.previous),
    BYTE(auvid_metric_t, rows.missing, rows.missing),
    SPAN(auvid_metric_t, uint64_t, sets.until_us, sets.resume_us),
    SPAN(auvid_metric_t, uint32_t, sets.recorded, sets.stored),
    BYTE(auvid_metric_t, sets.from, sets.changed),
    STRUCTS(auvid_metric_t, sets.set, TABLE_SET),
};

static const row_t channel[] = {
    SPAN(auvid_excitation_channel_t, uint32_t, rng, repetition),
    REALS(auvid_excitation_channel_t, level, cycles),
    BYTE(auvid_excitation_channel_t, segment, negative),
};

static const row_t excitation[] = {
    STRUCTS(auvid_excitation_t, channel, TABLE_CHANNEL),
    REALS(auvid_excitation_t, displacement, displacement),
    SPAN(auvid_excitation_t, uint32_t, repetition, repetition),
    SPAN(auvid_excitation_t, uint64_t, repeated_us, repeated_us),
    SPAN(auvid_excitation_t, uint64_t, start_us, stop_us),
    BYTE(auvid_excitation_t, running, finished),
};

static const row_t trip[] = {
    ENUM(auvid_guard_trip_t, cause),
    REALS(auvid_guard_trip_t, value, limit),
    SPAN(auvid_guard_trip_t, uint64_t, t_us, t_us),
};

static const row_t adaptive[] = {
    SPAN(auvid_adaptive_t, uint64_t, run_us, run_us),
    REALS(auvid_adaptive_t, low_owed, low_owed),
    SPAN(auvid_adaptive_t, uint32_t, missing, sets),
    SPAN(auvid_adaptive_t, uint16_t, close_rows, close_rows),
    BYTE(auvid_adaptive_t, playing, tried),
};

static const row_t guard[] = {
    ENUM(auvid_guard_t, state),
    STRUCT(auvid_guard_t, trip, TABLE_TRIP),
    STRUCT(auvid_guard_t, refused, TABLE_TRIP),
    SPAN(auvid_guard_t, uint64_t, t_us, heartbeat_us),
    REALS(auvid_guard_t, home, home),
    BYTE(auvid_guard_t, stepped, depth_known),
};

static const row_t confidence[] = {
    REALS(auvid_confidence_t, sigma, bound),
    SPAN(auvid_confidence_t, uint32_t, identifiable, implausible),
    BYTE(auvid_confidence_t, note, lost),
    REALS(auvid_confidence_t, effective_noise, uncertainty),
};

static const row_t estimate[] = {
    SPAN(auvid_estimate_t, uint32_t, number, number),
    SPAN(auvid_estimate_t, uint64_t, t_us, t_us),
    SPAN(auvid_estimate_t, uint32_t, sets, identified),
    BYTE(auvid_estimate_t, excited, excited),
    REALS(auvid_estimate_t, pi, delay_s),
    BYTE(auvid_estimate_t, first_order_lag, first_order_lag),
    REALS(auvid_estimate_t, r2_force, r2_force),
    SPAN(auvid_estimate_t, uint32_t, evaluations_crs, evaluations_line),
    BYTE(auvid_estimate_t, not_converged, accepted),
    STRUCT(auvid_estimate_t, confidence, TABLE_CONFIDENCE),
};

static const row_t change_test[] = {
    SPAN(auvid_change_test_t, uint32_t, set, estimate),
    BYTE(auvid_change_test_t, excited, changed),
    REALS(auvid_change_test_t, variance_ratio, r2_velocity),
    BYTE(auvid_change_test_t, simulated, simulated),
};

static const row_t sample[] = {
    SPAN(auvid_sample_t, uint64_t, t_us, t_us),
    REALS(auvid_sample_t, phi, command),
    BYTE(auvid_sample_t, missing, missing),
};

static const row_t validation[] = {
    REALS(auvid_validation_t, pi, wrench),
    SPAN(auvid_validation_t, uint32_t, first_order_lag, first_order_lag),
    REALS(auvid_validation_t, cell_s, cell_s),
    SPAN(auvid_validation_t, uint32_t, dofs, dofs),
    STRUCT(auvid_validation_t, last, TABLE_SAMPLE),
    REALS(auvid_validation_t, past, past),
    SPAN(auvid_validation_t, uint32_t, since_gap, since_gap),
    BYTE(auvid_validation_t, running, running),
    REALS(auvid_validation_t, mean, sse),
    SPAN(auvid_validation_t, uint32_t, compared, cells),
    REALS(auvid_validation_t, predicted, predicted),
};

static const row_t crs[] = {
    REALS(auvid_crs_t, theta, last_spread),
    SPAN(auvid_crs_t, uint32_t, rng, rejections),
    SPAN(auvid_crs_t, uint16_t, order, worst),
};

static const row_t line_search[] = {
    REALS(auvid_line_search_t, theta, cost_far),
    BYTE(auvid_line_search_t, direction, plain),
};

static const row_t optimizer[] = {
    STRUCT(auvid_optimizer_t, cfg, TABLE_SEARCH),
    REALS(auvid_optimizer_t, scale, scale),
    COSTS(auvid_optimizer_t, trial, trial),
    SPAN(auvid_optimizer_t, uint32_t, work, work),
    BYTE(auvid_optimizer_t, state, asked),
    STRUCT_OF(auvid_optimizer_t, crs, TABLE_CRS, PART_GLOBAL),
    STRUCT_OF(auvid_optimizer_t, line_search, TABLE_LINE_SEARCH, PART_LOCAL),
};

static const row_t optimum[] = {
    REALS(auvid_bounded_ls_t, lower, work),
    SPAN(auvid_bounded_ls_t, uint32_t, free, free),
    BYTE(auvid_bounded_ls_t, order, row),
};

static const row_t job[] = {
    STRUCT(auvid_confidence_job_t, result, TABLE_CONFIDENCE),
    REALS(auvid_confidence_job_t, dry_mass_kg, joint_factor),
    REALS(auvid_confidence_job_t, part, part), /* zeros, where a regressor may have been */
    REALS(auvid_confidence_job_t, score, rows),
    BYTE(auvid_confidence_job_t, column_of, parameter_of),
    SPAN(auvid_confidence_job_t, uint32_t, at_bound, at_bound),
    BYTE(auvid_confidence_job_t, n, delayed),
};

static const row_t seen[] = {
    SPAN(auvid_guard_seen_t, uint64_t, t_us, t_us),
    BYTE(auvid_guard_seen_t, known, known),
};

static const row_t identifier[] = {
    STRUCT(auvid_identifier_t, search, TABLE_SEARCH),
    ENUM(auvid_identifier_t, velocity),
    REALS(auvid_identifier_t, dry_mass_kg, uncertainty),
    STRUCT(auvid_identifier_t, nav, TABLE_NAV),
    STRUCT(auvid_identifier_t, recorder, TABLE_RECORDER),
    STRUCT(auvid_identifier_t, metric, TABLE_METRIC),
    STRUCT(auvid_identifier_t, estimate, TABLE_ESTIMATE),
    STRUCT(auvid_identifier_t, accepted_estimate, TABLE_ESTIMATE),
    STRUCT(auvid_identifier_t, change_test, TABLE_CHANGE_TEST),
    COSTS(auvid_identifier_t, predicted, predicted),
    SPAN(auvid_identifier_t, uint64_t, t_us, t_us),
    SPAN(auvid_identifier_t, uint32_t, last_sample, max_work),
    BYTE(auvid_identifier_t, phase, parameter_of),
    SPAN(auvid_identifier_t, uint32_t, active, active),
    REALS(auvid_identifier_t, candidate, delay_s),
    BYTE(auvid_identifier_t, started, started),
    STRUCT(auvid_identifier_t, applied, TABLE_SEEN),
    SPAN(auvid_identifier_t, uint32_t, searched, searched),
    REALS(auvid_identifier_t, cost, cost),
    BYTE(auvid_identifier_t, spent, cold_start),
    STRUCT_OF(auvid_identifier_t, optimizer, TABLE_OPTIMIZER, PART_GLOBAL | PART_LOCAL),
    STRUCT_OF(auvid_identifier_t, optimum, TABLE_OPTIMUM, PART_OPTIMUM),
    STRUCT_OF(auvid_identifier_t, confidence, TABLE_JOB, PART_CONFIDENCE),
};

static const row_t actuation[] = {
    STRUCT(auvid_actuation_t, excitation, TABLE_EXCITATION),
    STRUCT(auvid_actuation_t, guard, TABLE_GUARD),
    STRUCT(auvid_actuation_t, altitude, TABLE_SEEN),
    REALS(auvid_actuation_t, altitude_m, home),
    BYTE(auvid_actuation_t, starting, saturated),
};

static const row_t row[] = {
    STRUCT(auvid_row_t, sample, TABLE_SAMPLE),
    REALS(auvid_row_t, late, late),
};

#define TABLE(rows)                                                                                \
    {                                                                                              \
        rows, sizeof(rows) / sizeof(row_t)                                                         \
    }
const auvid_checkpoint_table_t auvid_checkpoint_table[TABLE_COUNT] = {
    [TABLE_SEARCH] = TABLE(search),
    [TABLE_VELOCITY_SAMPLE] = TABLE(velocity_sample),
    [TABLE_DIAGNOSTICS] = TABLE(diagnostics),
    [TABLE_NAV] = TABLE(nav),
    [TABLE_STREAM] = TABLE(stream),
    [TABLE_RECORDER] = TABLE(recorder),
    [TABLE_SET] = TABLE(set),
    [TABLE_METRIC] = TABLE(metric),
    [TABLE_CHANNEL] = TABLE(channel),
    [TABLE_EXCITATION] = TABLE(excitation),
    [TABLE_ADAPTIVE] = TABLE(adaptive),
    [TABLE_TRIP] = TABLE(trip),
    [TABLE_GUARD] = TABLE(guard),
    [TABLE_CONFIDENCE] = TABLE(confidence),
    [TABLE_ESTIMATE] = TABLE(estimate),
    [TABLE_CHANGE_TEST] = TABLE(change_test),
    [TABLE_SAMPLE] = TABLE(sample),
    [TABLE_VALIDATION] = TABLE(validation),
    [TABLE_CRS] = TABLE(crs),
    [TABLE_LINE_SEARCH] = TABLE(line_search),
    [TABLE_OPTIMIZER] = TABLE(optimizer),
    [TABLE_OPTIMUM] = TABLE(optimum),
    [TABLE_JOB] = TABLE(job),
    [TABLE_SEEN] = TABLE(seen),
    [TABLE_IDENTIFIER] = TABLE(identifier),
    [TABLE_ACTUATION] = TABLE(actuation),
    [TABLE_ROW] = TABLE(row),
};

const auvid_checkpoint_root_t auvid_checkpoint_root[CHECKPOINT_ROOTS] = {
    {TABLE_IDENTIFIER, 0},
    {TABLE_ACTUATION, PART_ACTUATION},
    {TABLE_ADAPTIVE, PART_ADAPTIVE},
    {TABLE_VALIDATION, PART_SIMULATED},
};
