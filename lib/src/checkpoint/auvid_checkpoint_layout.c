/*
 * The checkpoint: its contents, block by block. In each struct the configuration and the pointers
 * come first, then the state. What decides on forces is not state: the plan of the excitation, the
 * thrusters and the guard's limits stay those of init. A test (tests/validation/test_checkpoint.sh)
 * names each member of a struct that is in no block, each gap, and each member that has moved. The
 * range of each member is in auvid_checkpoint_limits.c.
 */
#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_math_internal.h"

#define END(type, last) (offsetof(type, last) + sizeof(((type *)0)->last))
/* Members `first` .. `last` of a root, if one of the parts is present. */
#define BLOCK(root, type, first, last, parts)                                                      \
    {                                                                                              \
        root, parts, (uint32_t)offsetof(type, first),                                              \
            (uint32_t)(END(type, last) - offsetof(type, first))                                    \
    }
#define OF_ID(first, last, parts) BLOCK(ROOT_IDENTIFIER, auvid_identifier_t, first, last, parts)
#define SEARCHING (PART_GLOBAL | PART_LOCAL)

const auvid_checkpoint_block_t auvid_checkpoint_configured[CHECKPOINT_CONFIGURED] = {
    OF_ID(search, search, 0),
    OF_ID(dry_mass_kg, velocity, 0),
    OF_ID(nav.cfg.q, nav.cfg.imu_turned, 0),
    OF_ID(recorder.cfg.cell_us, recorder.cfg.input, 0),
    OF_ID(metric.cfg.fixed, metric.cfg.open_loop, 0),
    BLOCK(ROOT_UNCERTAIN, auvid_uncertain_t, cfg.backward, cfg.fractions, PART_UNCERTAIN),
    BLOCK(ROOT_UNCERTAIN, auvid_uncertain_t, equation, section, PART_UNCERTAIN),
};

const auvid_checkpoint_block_t auvid_checkpoint_block[CHECKPOINT_BLOCKS] = {
    OF_ID(nav.ground, nav.gps, 0),
    OF_ID(recorder.origin_us, recorder.mean, 0),
    OF_ID(metric.result.cost, metric.result.coupled, 0),
    OF_ID(metric.evaluator.window_us, metric.evaluator.noise, 0),
    OF_ID(metric.evaluator.window, metric.evaluator.window, PART_RESIDUAL),
    OF_ID(metric.rows.cells, metric.rows.previous, 0),
    OF_ID(metric.sets.until_us, metric.sets.min_wrench_m2, 0),
    OF_ID(metric.feedback, metric.feedback, 0),
    OF_ID(t_us, work.parameter_of, 0),
    OF_ID(optimizer.work, optimizer.allowed, SEARCHING),
    OF_ID(optimizer.crs.initial_spread, optimizer.crs.order, PART_GLOBAL),
    OF_ID(optimizer.line_search, optimizer.line_search, PART_LOCAL),
    OF_ID(optimum, optimum, PART_OPTIMUM),
    OF_ID(linear.windows, linear.windows, PART_NEWTON | PART_WINDOWS),
    OF_ID(linear.newton, linear.newton, PART_NEWTON),
    OF_ID(confidence.dry_mass_kg, confidence.part, PART_CONFIDENCE),
    BLOCK(ROOT_ACTUATION, auvid_actuation_t, excitation.repeated_us, excitation.reserved,
          PART_ACTUATION),
    BLOCK(ROOT_ACTUATION, auvid_actuation_t, guard.t_us, guard.reserved, PART_ACTUATION),
    BLOCK(ROOT_ACTUATION, auvid_actuation_t, altitude, reserved, PART_ACTUATION),
    BLOCK(ROOT_ADAPTIVE, auvid_adaptive_t, run_us, reserved, PART_ADAPTIVE),
    BLOCK(ROOT_CHANGE, auvid_change_detector_t, accepted, reserved, PART_CHANGE),
    BLOCK(ROOT_PRIOR, auvid_prior_t, pi, known, PART_PRIOR),
    BLOCK(ROOT_PREDICTION, auvid_validation_t, last, reserved, PART_SIMULATED),
    BLOCK(ROOT_UNCERTAIN, auvid_uncertain_t, begin_us, gave_set, PART_UNCERTAIN),
    BLOCK(ROOT_INSTRUMENTS, auvid_instruments_t, last_us, wide, PART_INSTRUMENTS),
    BLOCK(ROOT_ROWS, auvid_row_t, sample, late, PART_RESIDUAL),
};

/* One struct, or an array of `count`. */
#define STRUCTS(table, root, type, member, count, parts)                                           \
    {                                                                                              \
        TABLE_##table, root, parts, count, (uint32_t)offsetof(type, member),                       \
            (uint32_t)(sizeof(((type *)0)->member) / (count))                                      \
    }
#define IN_ID(table, member, count, parts)                                                         \
    STRUCTS(table, ROOT_IDENTIFIER, auvid_identifier_t, member, count, parts)
#define IN_ACTUATION(table, member, count)                                                         \
    STRUCTS(table, ROOT_ACTUATION, auvid_actuation_t, member, count, PART_ACTUATION)
#define ENTIRE(table, root, type, parts)                                                           \
    {                                                                                              \
        TABLE_##table, root, parts, 1, 0, sizeof(type)                                             \
    }

const auvid_checkpoint_struct_t auvid_checkpoint_struct[] = {
    ENTIRE(identifier, ROOT_IDENTIFIER, auvid_identifier_t, 0),
    IN_ID(nav, nav, 1, 0),
    IN_ID(nav_velocity_sample, nav.ground, 1, 0),
    IN_ID(nav_velocity_sample, nav.water, 1, 0),
    IN_ID(nav_diagnostics, nav.diagnostics, AUVID_NAV_SENSOR_COUNT, 0),
    IN_ID(recorder, recorder, 1, 0),
    IN_ID(recorder_stream, recorder.stream, 5, 0),
    IN_ID(metric, metric, 1, 0),
    IN_ID(set, metric.sets.set, AUVID_MAX_SETS, 0),
    IN_ID(estimate, estimate, 1, 0),
    IN_ID(confidence, estimate.confidence, 1, 0),
    IN_ID(change_test, change_test, 1, 0),
    IN_ID(guard_seen, applied, 1, 0),
    IN_ID(crs, optimizer.crs, 1, PART_GLOBAL),
    IN_ID(line_search, optimizer.line_search, 1, PART_LOCAL),
    IN_ID(optimizer, optimizer, 1, SEARCHING),
    IN_ID(search_config, optimizer.cfg, 1, SEARCHING),
    IN_ID(bounded_ls, optimum, 1, PART_OPTIMUM),
    IN_ID(gauss_newton, linear.newton, 1, PART_NEWTON),
    IN_ID(bounded_ls, linear.newton.ls, 1, PART_NEWTON),
    IN_ID(confidence_job, confidence, 1, PART_CONFIDENCE),
    IN_ID(confidence, confidence.result, 1, PART_CONFIDENCE),
    ENTIRE(actuation, ROOT_ACTUATION, auvid_actuation_t, PART_ACTUATION),
    IN_ACTUATION(excitation, excitation, 1),
    IN_ACTUATION(excitation_channel, excitation.channel, AUVID_DOF_COUNT),
    IN_ACTUATION(guard, guard, 1),
    IN_ACTUATION(guard_trip, guard.trip, 1),
    IN_ACTUATION(guard_trip, guard.refused, 1),
    IN_ACTUATION(guard_seen, altitude, 1),
    ENTIRE(adaptive, ROOT_ADAPTIVE, auvid_adaptive_t, PART_ADAPTIVE),
    ENTIRE(change_detector, ROOT_CHANGE, auvid_change_detector_t, PART_CHANGE),
    STRUCTS(estimate, ROOT_CHANGE, auvid_change_detector_t, accepted, 1, PART_CHANGE),
    STRUCTS(confidence, ROOT_CHANGE, auvid_change_detector_t, accepted.confidence, 1, PART_CHANGE),
    ENTIRE(prior, ROOT_PRIOR, auvid_prior_t, PART_PRIOR),
    ENTIRE(validation, ROOT_PREDICTION, auvid_validation_t, PART_SIMULATED),
    STRUCTS(sample, ROOT_PREDICTION, auvid_validation_t, last, 1, PART_SIMULATED),
    STRUCTS(sample, ROOT_PREDICTION, auvid_validation_t, next, 1, PART_SIMULATED),
    ENTIRE(uncertain, ROOT_UNCERTAIN, auvid_uncertain_t, PART_UNCERTAIN),
    STRUCTS(sample, ROOT_UNCERTAIN, auvid_uncertain_t, cell, 1, PART_UNCERTAIN),
    STRUCTS(estimate, ROOT_UNCERTAIN, auvid_uncertain_t, estimate, 1, PART_UNCERTAIN),
    STRUCTS(confidence, ROOT_UNCERTAIN, auvid_uncertain_t, estimate.confidence, 1, PART_UNCERTAIN),
    STRUCTS(cause, ROOT_UNCERTAIN, auvid_uncertain_t, causes.cause, AUVID_CAUSE_COUNT,
            PART_UNCERTAIN),
    STRUCTS(cause, ROOT_UNCERTAIN, auvid_uncertain_t, work.causes.cause, AUVID_CAUSE_COUNT,
            PART_UNCERTAIN),
    ENTIRE(instruments, ROOT_INSTRUMENTS, auvid_instruments_t, PART_INSTRUMENTS),
    STRUCTS(reference, ROOT_INSTRUMENTS, auvid_instruments_t, past, AUVID_INSTRUMENT_PAST,
            PART_INSTRUMENTS),
    ENTIRE(row, ROOT_ROWS, auvid_row_t, PART_RESIDUAL),
    ENTIRE(sample, ROOT_ROWS, auvid_row_t, PART_RESIDUAL), /* each begins with one */
};
const size_t auvid_checkpoint_structs =
    sizeof auvid_checkpoint_struct / sizeof auvid_checkpoint_struct[0];

/* No gap after the last member: with the members in the order of their widths, or small ones filled
 * up, none between them either. */
#define NO_GAP(type, last) _Static_assert(END(type, last) == sizeof(type), "a gap in " #type)
NO_GAP(auvid_nav_velocity_sample_t, reserved);
NO_GAP(auvid_recorder_stream_t, reserved);
NO_GAP(auvid_set_t, excited);
NO_GAP(auvid_excitation_channel_t, reserved);
NO_GAP(auvid_guard_trip_t, reserved);
NO_GAP(auvid_guard_seen_t, reserved);
NO_GAP(auvid_confidence_t, reserved);
NO_GAP(auvid_estimate_t, reserved);
NO_GAP(auvid_change_test_t, reserved);
NO_GAP(auvid_metric_change_t, reserved);
NO_GAP(auvid_drift_reference_t, variance);
NO_GAP(auvid_change_detector_t, reserved);
NO_GAP(auvid_sample_t, reserved);
NO_GAP(auvid_row_t, late);
NO_GAP(auvid_line_search_t, shear);
NO_GAP(auvid_metric_windows_t, missing);
NO_GAP(auvid_gauss_newton_t, damped);
NO_GAP(auvid_uncertain_rows_t, difference);
NO_GAP(auvid_uncertain_part_t, scale);
NO_GAP(auvid_cause_t, reserved);
NO_GAP(auvid_causes_t, reserved);
NO_GAP(auvid_uncertain_solution_t, part);
NO_GAP(auvid_reference_t, nu);
