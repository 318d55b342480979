/*
 * auvid demo --scenario: runs with a disruption, whose events are printed with simulated times. The
 * same seed gives the same events.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/current.h"
#include "../commands.h"
#include "../base/report_error.h"
#include "../report/report.h"
#include "../report/event_log.h"
#include "../bus/world.h"

/* Longest time that a search may take after the last set [s of simulated time]. */
#define PATIENCE_S 600.0

/* Time of the disruption: in the middle of the fourth set, or (payload) of the ninth [s]. */
#define EVENT_S 100.0
#define PAYLOAD_S 250.0
enum { PAYLOAD_SETS = 16 };

/* Effects of the payload. */
#define MASS_FACTOR 1.1
#define DRAG_FACTOR 1.3

#define CURRENT_M_S 0.3
enum { ROWS = 60 }; /* rows of a set */

typedef struct {
    const options_t *options;
    event_log_t log;
    world_t world;
    result_t result, other; /* other: result of the first of two runs */
    const char *other_key;  /* name of `other` in JSON; NULL: none */
    bool log_change_tests;  /* log how well each set was predicted */

    /* state of the current run */
    auvid_guard_state_t guard;
    double before[AUVID_DOF_COUNT]; /* excitation of the previous tick */
    double after_abort;             /* largest excitation since the guard aborted */
    double farthest_m;              /* true horizontal distance from the start */
    bool changed;                   /* a change was detected */

    auvid_current_t current; /* model of the second node, with the current as parameters */
    auvid_row_t rows[(AUVID_MAX_SETS + 1) * ROWS];
} scenario_run_t;

/* ---- events ---- */

static void log_excitation(scenario_run_t *run, const char *when, const double *wrench)
{
    event_log_add(&run->log, world_time_s(&run->world),
                  "  excitation %s: X %.1f, Y %.1f, Z %.1f N, N %.1f Nm", when, wrench[AUVID_SURGE],
                  wrench[AUVID_SWAY], wrench[AUVID_HEAVE], wrench[AUVID_YAW]);
}

static void log_guard(scenario_run_t *run)
{
    const auvid_guard_t *guard = &run->world.actuation.guard;
    const auvid_guard_trip_t *trip = &guard->trip;
    double t_s = world_time_s(&run->world);
    if (guard->state == AUVID_GUARD_EXCITING) {
        event_log_add(&run->log, t_s, "armed, excitation started");
    } else if (guard->state == AUVID_GUARD_ABORTED) {
        const char *unit = report_cause_unit(trip->cause);
        char value[60] = "";
        if (unit[0] != '\0') {
            (void)snprintf(value, sizeof value, ", %.3g %s (limit %.3g)", (double)trip->value, unit,
                           (double)trip->limit);
        }
        event_log_add(&run->log, t_s, "guard: ABORTED: %s%s", auvid_guard_cause_str(trip->cause),
                      value);
        log_excitation(run, "in the previous tick", run->before);
        log_excitation(run, "in this tick", run->world.excitation);
    } else {
        event_log_add(&run->log, t_s, "guard: %s", auvid_guard_state_str(guard->state));
    }
}

static void log_change_test(scenario_run_t *run)
{
    const auvid_change_test_t *test = &run->world.node[0].id.change_test;
    const auvid_real_t *ratio = test->variance_ratio;
    double max_change = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        max_change = fmax(max_change, (double)test->change[j]);
    }
    event_log_add(&run->log, world_time_s(&run->world),
                  "set %u, predicted: variance ratio X %.1f, Y %.1f, Z %.1f, N %.1f; change %.2f",
                  (unsigned)test->set, (double)ratio[AUVID_SURGE], (double)ratio[AUVID_SWAY],
                  (double)ratio[AUVID_HEAVE], (double)ratio[AUVID_YAW], max_change);
}

/* Logs that the vehicle is another one, most clearly in the only degree of freedom of the mask. */
static void log_alarm(scenario_run_t *run, uint32_t mask, const char *what, const char *then)
{
    int j = 0;
    while (j < AUVID_DOF_COUNT - 1 && !(mask >> j & 1u)) {
        ++j;
    }
    event_log_add(&run->log, world_time_s(&run->world),
                  "THE VEHICLE HAS %s, most clearly in %s: %s", what, report_dof_name[j], then);
}

static void log_estimate(scenario_run_t *run)
{
    const auvid_estimate_t *e = &run->world.node[0].id.estimate;
    double truth[VEHICLE_SIM_PARAMETERS];
    vehicle_sim_truth(&run->world.vehicle_sim, truth);
    event_log_add(&run->log, world_time_s(&run->world),
                  "estimate %u, %u set%s recorded: rms error %.2f %%, %d of %d identifiable",
                  (unsigned)e->number, (unsigned)e->sets, e->sets == 1 ? "" : "s",
                  report_rms_percent(e, truth), report_identifiable(e), SIM_PARAMETERS);
}

static void log_events(scenario_run_t *run)
{
    uint32_t events = run->world.node[0].events;
    double t_s = world_time_s(&run->world);
    if (events & AUVID_EVENT_EXCITATION_DONE) {
        event_log_add(&run->log, t_s, "excitation done");
    }
    if (run->world.actuation.guard.state != run->guard) {
        run->guard = run->world.actuation.guard.state;
        log_guard(run);
    }
    if ((events & AUVID_EVENT_VALIDATED) && run->log_change_tests) {
        log_change_test(run);
    }
    if (events & AUVID_EVENT_CHANGED) {
        run->changed = true;
        log_alarm(run, run->world.node[0].id.change_test.changed, "CHANGED",
                  "older sets dropped, new search");
    }
    if (events & AUVID_EVENT_DRIFTED) {
        log_alarm(run, run->world.node[0].id.change_test.drifted, "DRIFTED",
                  "compared with the first accepted estimate");
    }
    if (events & AUVID_EVENT_RESTORED) {
        event_log_add(&run->log, t_s, "the previous estimate predicted this set better: restored");
    }
    if (events & AUVID_EVENT_ESTIMATE) {
        log_estimate(run);
    }
}

/* ---- the run ---- */

static bool begin(scenario_run_t *run, world_config_t config)
{
    config.options = run->options;
    config.seed = run->options->seed;
    config.disturbance_N = run->options->disturbance_N;
    config.lag_s = run->options->lag_s;
    config.sets = config.sets > 0 ? config.sets : run->options->sets;
    run->guard = AUVID_GUARD_DISARMED;
    run->farthest_m = 0.0;
    return world_begin(&run->world, &config);
}

/* Runs one tick. Returns true while work is left. */
static bool advance(scenario_run_t *run)
{
    world_t *world = &run->world;
    memcpy(run->before, world->excitation, sizeof run->before);
    world_tick(world);
    const sim_t *sim = &world->vehicle_sim.sim;
    const double *position = sim->truth.position, *start = sim->cfg.position;
    run->farthest_m = fmax(run->farthest_m, hypot(position[0] - start[0], position[1] - start[1]));
    log_events(run);
    for (int j = 0; j < AUVID_DOF_COUNT && run->guard == AUVID_GUARD_ABORTED; ++j) {
        run->after_abort = fmax(run->after_abort, fabs(world->excitation[j]));
    }
    return world_work(world, AUVID_DEFAULT_BUDGET);
}

static void run_until(scenario_run_t *run, double t_s)
{
    while (world_time_s(&run->world) < t_s) {
        (void)advance(run);
    }
}

/* Runs until `sets` sets are recorded and searched, then stores the result. */
static void run_to_end(scenario_run_t *run, uint32_t sets)
{
    double end_s = (double)sets * WORLD_SET_S + PATIENCE_S;
    bool busy = true;
    while ((busy || run->world.node[0].id.metric.sets.recorded < sets) &&
           world_time_s(&run->world) < end_s) {
        busy = advance(run);
    }
    for (uint32_t k = 0; k < vehicle_default()->linger_ticks; ++k) {
        (void)advance(run);
    }
    report_gather(&run->result, &run->world.node[0].id, run->options->seed);
    report_add_truth(&run->result, &run->world.vehicle_sim);
    run->result.estimate.not_converged |= busy;
}

/* Checks after an abort that the guard stays latched and that the estimate is kept. */
static bool aftermath(scenario_run_t *run, uint32_t number)
{
    const auvid_identifier_t *id = &run->world.node[0].id;
    double t_s = world_time_s(&run->world) + 5.0;
    run_until(run, t_s);
    run->world.vehicle_sim.order_arm = true;
    event_log_add(&run->log, t_s,
                  "latched: the operator's order to arm is refused until the guard is disarmed");
    run_until(run, t_s + 15.0);
    event_log_add(&run->log, t_s + 15.0,
                  "largest excitation since the abort: %.1f; estimate %u is kept", run->after_abort,
                  (unsigned)id->estimate.number);
    return !(run->after_abort > 0.0) && run->world.actuation.guard.state == AUVID_GUARD_ABORTED &&
           id->estimate.number >= number;
}

/* ---- the scenarios; each returns whether the run went as expected ---- */

static bool payload(scenario_run_t *run)
{
    const world_config_t config = {.sets = PAYLOAD_SETS};
    static const uint8_t mass[] = {SIM_M_U, SIM_M_V, SIM_M_W, SIM_M_R};
    run->log_change_tests = true;
    if (!begin(run, config)) {
        return false;
    }
    run_until(run, PAYLOAD_S);
    for (int k = 0; k < (int)sizeof mass; ++k) {
        run->world.vehicle_sim.sim.cfg.parameter[mass[k]] *= MASS_FACTOR;
    }
    for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
        run->world.vehicle_sim.sim.cfg.parameter[i] *= DRAG_FACTOR;
    }
    event_log_add(&run->log, PAYLOAD_S,
                  "PAYLOAD ABOARD: masses +10 %%, drag +30 %%; errors are relative to this "
                  "truth from now on");
    bool early = run->changed;
    run_to_end(run, PAYLOAD_SETS);
    return !early && run->changed;
}

static bool heave_idle(scenario_run_t *run)
{
    const world_config_t config = {.idle = 1u << AUVID_HEAVE};
    char text[EVENT_LOG_LENGTH];
    if (!begin(run, config)) {
        return false;
    }
    run_to_end(run, run->options->sets);
    for (unsigned k = 0; report_missing(&run->result, k, text, sizeof text); ++k) {
        event_log_add(&run->log, world_time_s(&run->world), "missing: %s", text);
    }
    return (run->result.estimate.identified & 1u << AUVID_G500_M_W) == 0;
}

static bool operator_abort(scenario_run_t *run)
{
    const world_config_t config = {0};
    if (!begin(run, config)) {
        return false;
    }
    run_until(run, EVENT_S);
    event_log_add(&run->log, EVENT_S, "operator: abort in the middle of set 4");
    uint32_t number = run->world.node[0].id.estimate.number;
    run->world.vehicle_sim.order_abort = true;
    bool held = aftermath(run, number);
    run_to_end(run, 0);
    return held && run->result.trip.cause == AUVID_GUARD_OPERATOR;
}

static bool dvl_lost(scenario_run_t *run)
{
    const world_config_t config = {0};
    if (!begin(run, config)) {
        return false;
    }
    run_until(run, EVENT_S);
    event_log_add(&run->log, EVENT_S, "the DVL is lost: no more samples");
    uint32_t number = run->world.node[0].id.estimate.number;
    run->world.vehicle_sim.sim.cfg.sensor[SIM_DVL].dropout = 1.0;
    bool held = aftermath(run, number);
    run_to_end(run, 0);
    return held && run->result.trip.cause == AUVID_GUARD_VELOCITY_STALE;
}

/* Logs the parameter whose error is the largest multiple of its standard error. */
static void log_worst(scenario_run_t *run)
{
    const result_t *result = &run->result;
    double worst = 0.0;
    int at = 0;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double off = fabs((double)result->estimate.pi[i] - result->truth[i]);
        if (off / report_sigma(result, i) > worst) {
            worst = off / report_sigma(result, i);
            at = i;
        }
    }
    event_log_add(
        &run->log, world_time_s(&run->world),
        "largest error by standard error: %s, %.1f, %.1f sigma; farthest from start %.1f m",
        result->vehicle->parameter[at].name, (double)result->estimate.pi[at] - result->truth[at],
        worst, run->farthest_m);
}

/* Adds a second node that receives the same frames and also identifies the current. */
static bool listen_for_current(scenario_run_t *run, world_config_t config)
{
    auvid_identifier_config_t cfg;
    auvid_current_t *to = &run->current;
    config.seed = run->options->seed;
    world_identifier(&cfg, &config);
    if (auvid_current_init(to, &auvid_girona500, false) < 0) {
        return false;
    }
    cfg.vehicle = &to->vehicle;
    cfg.metric.free = to->vehicle.free;
    cfg.metric.rows = run->rows;
    cfg.metric.row_slots = sizeof run->rows / sizeof run->rows[0];
    cfg.metric.set_rows = ROWS;
    return auvid_current_bounds(to, 1, cfg.search.lower, cfg.search.upper) == AUVID_OK &&
           world_listen(&run->world, &cfg);
}

static void log_current(scenario_run_t *run)
{
    const auvid_estimate_t *e = &run->world.node[1].id.estimate;
    int north = run->current.hull->parameters;
    double truth[VEHICLE_SIM_PARAMETERS], half[2]; /* 0 for the parameters of the current */
    vehicle_sim_truth(&run->world.vehicle_sim, truth);
    for (int i = 0; i < 2; ++i) {
        half[i] = HALF_WIDTH * (double)e->confidence.sigma[north + i];
    }
    event_log_add(
        &run->log, world_time_s(&run->world),
        "current identified too: rms error %.2f %%; north %.3f +- %.3f, east %.3f +- %.3f m/s",
        report_rms_percent(e, truth), (double)e->pi[north], half[0], (double)e->pi[north + 1],
        half[1]);
}

static bool current(scenario_run_t *run)
{
    world_config_t config = {.current = {CURRENT_M_S, 0.0, 0.0}};
    if (!begin(run, config) || !listen_for_current(run, config)) {
        return false;
    }
    event_log_add(&run->log, 0.0, "DYNAMICS FROM BOTTOM LOCK: the current is mistaken for motion");
    run_to_end(run, run->options->sets);
    log_worst(run);
    log_current(run);
    bool bottom = run->result.guard != AUVID_GUARD_ABORTED;
    run->other = run->result;
    run->other_key = "bottom_lock";
    config.both_locks = true;
    if (!begin(run, config)) {
        return false;
    }
    event_log_add(&run->log, 0.0,
                  "DYNAMICS FROM WATER LOCK: the DVL alternates between bottom and water");
    run_to_end(run, run->options->sets);
    log_worst(run);
    return bottom && run->result.guard != AUVID_GUARD_ABORTED;
}

static const struct {
    const char *name, *about;
    bool (*run)(scenario_run_t *);
} scenarios[] = {{"payload", "the vehicle changes in the middle of set 9 of 16", payload},
                 {"heave-idle", "heave is never excited", heave_idle},
                 {"operator-abort", "the operator aborts in the middle of a set", operator_abort},
                 {"current",
                  "a current of 0.3 m/s to the north, with DVL bottom lock, then with water lock",
                  current},
                 {"dvl-lost", "the DVL is lost in the middle of a set", dvl_lost}};

enum { SCENARIOS = sizeof scenarios / sizeof scenarios[0] };

/* ---- the command ---- */

static void print_tables(const scenario_run_t *run)
{
    if (run->other_key != NULL) {
        printf("\n  from bottom lock\n");
        report_result(&run->other, NULL);
        printf("\n  from water lock");
    }
    putchar('\n');
    report_result(&run->result, NULL);
}

static int play(scenario_run_t *run, int which)
{
    const options_t *options = run->options;
    run->log.name = scenarios[which].name;
    run->log.silent = options->json;
    if (!options->json) {
        printf("auvid %s demo: scenario %s, seed %llu\n  %s\n", AUVID_VERSION_STRING, run->log.name,
               (unsigned long long)options->seed, scenarios[which].about);
        printf("  disturbance %g N, thruster lag %g s; otherwise as auvid demo\n\n",
               options->disturbance_N, options->lag_s);
    }
    bool as_expected = scenarios[which].run(run);
    if (run->result.vehicle == NULL) {
        const auvid_refusal_t *why = world_refusal(&run->world);
        return why != NULL ? report_refused("demo", why->status, why, NULL)
                           : report_error("demo: the simulator refused its configuration");
    }
    const second_result_t second = {run->other_key, &run->other, NULL};
    if (options->json) {
        report_json(stdout, &run->result, NULL, run->other_key != NULL ? &second : NULL, &run->log);
    } else {
        print_tables(run);
    }
    return as_expected ? report_exit(&run->result) : 1;
}

int scenario(const options_t *options)
{
    int which = 0;
    while (which < SCENARIOS && strcmp(options->scenario, scenarios[which].name) != 0) {
        ++which;
    }
    if (which == SCENARIOS) {
        return report_error(
            "demo: --scenario: '%s' is not one of payload, heave-idle, operator-abort, "
            "current, dvl-lost",
            options->scenario);
    }
    scenario_run_t *run = calloc(1, sizeof *run);
    if (run == NULL) {
        return report_error("demo: not enough memory");
    }
    run->options = options;
    int status = play(run, which);
    free(run);
    return status;
}
