/*
 * auvid demo --scenario: what goes otherwise than planned, told with simulated times. The same seed
 * tells the same story.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/current.h"
#include "commands.h"
#include "report_error.h"
#include "report.h"
#include "event_log.h"
#include "world.h"

/* A search may go on for so long after the last set [s of simulated time]. */
#define PATIENCE_S 600.0

/* When something happens: in the middle of the fourth set, or (payload) of the ninth [s]. */
#define EVENT_S 100.0
#define PAYLOAD_S 250.0
enum { PAYLOAD_SETS = 16 };

/* What the payload does. */
#define MASS_FACTOR 1.1
#define DRAG_FACTOR 1.3

#define CURRENT_M_S 0.3
enum { ROWS = 60 }; /* of a set */

typedef struct {
    const options_t *options;
    event_log_t story;
    world_t world;
    result_t result, other; /* other: of the first of two runs */
    const char *other_key;  /* its name in JSON; null: there is none */
    bool judgements;        /* tell of each set how it was foretold */

    /* of the run under way */
    auvid_guard_state_t guard;
    double before[AUVID_DOF_COUNT]; /* excitation of the tick before */
    double after_abort;             /* largest excitation since the guard aborted */
    double farthest_m;              /* in truth, from the start, horizontally */
    bool changed;                   /* a change was found */

    auvid_current_t current; /* of the second node, which searches the current as well */
    auvid_row_t rows[(AUVID_MAX_SETS + 1) * ROWS];
} play_t;

/* ---- telling ---- */

static void tell_excitation(play_t *play, const char *when, const double *wrench)
{
    event_log_add(&play->story, world_time_s(&play->world),
                  "  excitation %s: X %.1f, Y %.1f, Z %.1f N, N %.1f Nm", when, wrench[AUVID_SURGE],
                  wrench[AUVID_SWAY], wrench[AUVID_HEAVE], wrench[AUVID_YAW]);
}

static void tell_guard(play_t *play)
{
    const auvid_guard_t *guard = &play->world.node[0].id.guard;
    const auvid_guard_trip_t *trip = &guard->trip;
    double t_s = world_time_s(&play->world);
    if (guard->state == AUVID_GUARD_EXCITING) {
        event_log_add(&play->story, t_s, "armed, and exciting");
    } else if (guard->state == AUVID_GUARD_ABORTED) {
        const char *unit = report_cause_unit(trip->cause);
        char value[60] = "";
        if (unit[0] != '\0') {
            (void)snprintf(value, sizeof value, ", %.3g %s (limit %.3g)", (double)trip->value, unit,
                           (double)trip->limit);
        }
        event_log_add(&play->story, t_s, "guard: ABORTED: %s%s", auvid_guard_cause_str(trip->cause),
                      value);
        tell_excitation(play, "in the tick before", play->before);
        tell_excitation(play, "in this tick", play->world.excitation);
    } else {
        event_log_add(&play->story, t_s, "guard: %s", auvid_guard_state_str(guard->state));
    }
}

static void print_change_test(play_t *play)
{
    const auvid_change_test_t *judged = &play->world.node[0].id.change_test;
    const auvid_real_t *ratio = judged->variance_ratio;
    double most = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        most = fmax(most, (double)judged->change[j]);
    }
    event_log_add(&play->story, world_time_s(&play->world),
                  "set %u, foretold: variance ratio X %.1f, Y %.1f, Z %.1f, N %.1f; change %.2f",
                  (unsigned)judged->set, (double)ratio[AUVID_SURGE], (double)ratio[AUVID_SWAY],
                  (double)ratio[AUVID_HEAVE], (double)ratio[AUVID_YAW], most);
}

static void tell_change(play_t *play)
{
    const auvid_change_test_t *judged = &play->world.node[0].id.change_test;
    int j = 0;
    while (j < AUVID_DOF_COUNT - 1 && !(judged->changed >> j & 1u)) {
        ++j;
    }
    event_log_add(&play->story, world_time_s(&play->world),
                  "THE VEHICLE HAS CHANGED, most clearly in %s: older sets dropped, a new search",
                  report_dof_name[j]);
}

static void tell_estimate(play_t *play)
{
    const auvid_estimate_t *e = &play->world.node[0].id.estimate;
    double truth[CRAFT_PARAMETERS];
    vehicle_sim_truth(&play->world.craft, truth);
    event_log_add(&play->story, world_time_s(&play->world),
                  "estimate %u, %u set%s recorded: rms error %.2f %%, %d of %d identifiable",
                  (unsigned)e->number, (unsigned)e->sets, e->sets == 1 ? "" : "s",
                  report_rms_percent(e, truth), report_identifiable(e), SIM_PARAMETERS);
}

static void tell_events(play_t *play)
{
    const auvid_identifier_t *id = &play->world.node[0].id;
    uint32_t events = play->world.node[0].events;
    double t_s = world_time_s(&play->world);
    if (events & AUVID_EVENT_EXCITATION_DONE) {
        event_log_add(&play->story, t_s, "excitation done");
    }
    if (id->guard.state != play->guard) {
        play->guard = id->guard.state;
        tell_guard(play);
    }
    if ((events & AUVID_EVENT_VALIDATED) && play->judgements) {
        print_change_test(play);
    }
    if (events & AUVID_EVENT_CHANGED) {
        play->changed = true;
        tell_change(play);
    }
    if (events & AUVID_EVENT_RESTORED) {
        event_log_add(&play->story, t_s,
                      "the estimate before foretold this set better: taken back");
    }
    if (events & AUVID_EVENT_ESTIMATE) {
        tell_estimate(play);
    }
}

/* ---- running ---- */

static bool begin(play_t *play, world_config_t config)
{
    config.options = play->options;
    config.seed = play->options->seed;
    config.disturbance_N = play->options->disturbance_N;
    config.lag_s = play->options->lag_s;
    config.sets = config.sets > 0 ? config.sets : play->options->sets;
    play->guard = AUVID_GUARD_DISARMED;
    play->farthest_m = 0.0;
    return world_begin(&play->world, &config);
}

/* A tick. @return is there work left? */
static bool advance(play_t *play)
{
    world_t *world = &play->world;
    memcpy(play->before, world->excitation, sizeof play->before);
    world_tick(world);
    const sim_t *sim = &world->craft.sim;
    const double *position = sim->truth.position, *start = sim->config.position;
    play->farthest_m =
        fmax(play->farthest_m, hypot(position[0] - start[0], position[1] - start[1]));
    tell_events(play);
    for (int j = 0; j < AUVID_DOF_COUNT && play->guard == AUVID_GUARD_ABORTED; ++j) {
        play->after_abort = fmax(play->after_abort, fabs(world->excitation[j]));
    }
    return world_work(world, AUVID_DEFAULT_BUDGET);
}

static void run_until(play_t *play, double t_s)
{
    while (world_time_s(&play->world) < t_s) {
        (void)advance(play);
    }
}

/* Until so many sets are recorded and searched; then the result. */
static void run_to_end(play_t *play, uint32_t sets)
{
    double end_s = (double)sets * WORLD_SET_S + PATIENCE_S;
    bool busy = true;
    while ((busy || play->world.node[0].id.metric.sets_recorded < sets) &&
           world_time_s(&play->world) < end_s) {
        busy = advance(play);
    }
    for (uint32_t k = 0; k < vehicle_girona500.linger_ticks; ++k) {
        (void)advance(play);
    }
    report_gather(&play->result, &play->world.node[0].id, play->options->seed);
    report_heard(&play->result, &play->world.craft);
    play->result.estimate.not_converged |= busy;
}

/* After an abort: the latch holds, and the estimate stays. @return did both? */
static bool aftermath(play_t *play, uint32_t number)
{
    const auvid_identifier_t *id = &play->world.node[0].id;
    double t_s = world_time_s(&play->world) + 5.0;
    run_until(play, t_s);
    play->world.craft.order_arm = true;
    event_log_add(&play->story, t_s,
                  "latched: the operator's order to arm is refused until disarm");
    run_until(play, t_s + 15.0);
    event_log_add(
        &play->story, t_s + 15.0,
        "largest excitation since the abort: %.1f; what was identified stays: estimate %u",
        play->after_abort, (unsigned)id->estimate.number);
    return !(play->after_abort > 0.0) && id->guard.state == AUVID_GUARD_ABORTED &&
           id->estimate.number >= number;
}

/* ---- the scenarios; each returns whether it went as its story has it ---- */

static bool payload(play_t *play)
{
    const world_config_t config = {.sets = PAYLOAD_SETS};
    static const uint8_t mass[] = {SIM_M_U, SIM_M_V, SIM_M_W, SIM_M_R};
    play->judgements = true;
    if (!begin(play, config)) {
        return false;
    }
    run_until(play, PAYLOAD_S);
    for (int k = 0; k < (int)sizeof mass; ++k) {
        play->world.craft.sim.config.parameter[mass[k]] *= MASS_FACTOR;
    }
    for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
        play->world.craft.sim.config.parameter[i] *= DRAG_FACTOR;
    }
    event_log_add(&play->story, PAYLOAD_S,
                  "PAYLOAD ABOARD: masses +10 %%, drag +30 %%; from now on "
                  "errors are against this truth");
    bool early = play->changed;
    run_to_end(play, PAYLOAD_SETS);
    return !early && play->changed;
}

static bool yaw_idle(play_t *play)
{
    const world_config_t config = {.idle = 1u << AUVID_YAW};
    char text[EVENT_LOG_LENGTH];
    if (!begin(play, config)) {
        return false;
    }
    run_to_end(play, play->options->sets);
    for (unsigned k = 0; report_missing(&play->result, k, text, sizeof text); ++k) {
        event_log_add(&play->story, world_time_s(&play->world), "missing: %s", text);
    }
    return (play->result.estimate.identified & 1u << AUVID_G500_M_R) == 0;
}

static bool operator_abort(play_t *play)
{
    const world_config_t config = {0};
    if (!begin(play, config)) {
        return false;
    }
    run_until(play, EVENT_S);
    event_log_add(&play->story, EVENT_S, "operator: abort, in the middle of set 4");
    uint32_t number = play->world.node[0].id.estimate.number;
    play->world.craft.order_abort = true;
    bool held = aftermath(play, number);
    run_to_end(play, 0);
    return held && play->result.trip.cause == AUVID_GUARD_OPERATOR;
}

static bool dvl_lost(play_t *play)
{
    const world_config_t config = {0};
    if (!begin(play, config)) {
        return false;
    }
    run_until(play, EVENT_S);
    event_log_add(&play->story, EVENT_S, "the DVL falls silent, for good");
    uint32_t number = play->world.node[0].id.estimate.number;
    play->world.craft.sim.config.sensor[SIM_DVL].dropout = 1.0;
    bool held = aftermath(play, number);
    run_to_end(play, 0);
    return held && play->result.trip.cause == AUVID_GUARD_VELOCITY_STALE;
}

/* The parameter that its standard error explains least. */
static void tell_worst(play_t *play)
{
    const result_t *result = &play->result;
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
        &play->story, world_time_s(&play->world),
        "worst in standard errors: %s, %.1f off, %.1f of them; farthest from start %.1f m",
        result->vehicle->parameter[at].name, (double)result->estimate.pi[at] - result->truth[at],
        worst, play->farthest_m);
}

/* A second node hears the same frames, and searches the current with the parameters. */
static bool listen_for_current(play_t *play, world_config_t config)
{
    auvid_identifier_config_t cfg;
    auvid_current_t *to = &play->current;
    config.seed = play->options->seed;
    world_identifier(&cfg, &config);
    if (auvid_current_init(to, &auvid_girona500, false) < 0) {
        return false;
    }
    cfg.vehicle = &to->vehicle;
    cfg.metric.free = to->vehicle.free;
    cfg.metric.rows = play->rows;
    cfg.metric.set_rows = ROWS;
    return auvid_current_bounds(to, 1, cfg.search.lower, cfg.search.upper) == AUVID_OK &&
           world_listen(&play->world, &cfg);
}

static void tell_current(play_t *play)
{
    const auvid_estimate_t *e = &play->world.node[1].id.estimate;
    int north = play->current.hull->parameters;
    double truth[CRAFT_PARAMETERS], half[2]; /* the current's stands elsewhere: 0 here */
    vehicle_sim_truth(&play->world.craft, truth);
    for (int i = 0; i < 2; ++i) {
        half[i] = HALF_WIDTH * (double)e->confidence.sigma[north + i];
    }
    event_log_add(
        &play->story, world_time_s(&play->world),
        "current searched too: rms error %.2f %%; north %.3f +- %.3f, east %.3f +- %.3f m/s",
        report_rms_percent(e, truth), (double)e->pi[north], half[0], (double)e->pi[north + 1],
        half[1]);
}

static bool current(play_t *play)
{
    world_config_t config = {.current = {CURRENT_M_S, 0.0, 0.0}};
    if (!begin(play, config) || !listen_for_current(play, config)) {
        return false;
    }
    event_log_add(&play->story, 0.0, "DYNAMICS FROM BOTTOM LOCK: the current is taken for motion");
    run_to_end(play, play->options->sets);
    tell_worst(play);
    tell_current(play);
    bool bottom = play->result.guard != AUVID_GUARD_ABORTED;
    play->other = play->result;
    play->other_key = "bottom_lock";
    config.both_locks = true;
    if (!begin(play, config)) {
        return false;
    }
    event_log_add(&play->story, 0.0,
                  "DYNAMICS FROM WATER LOCK: the DVL pings bottom and water in turn");
    run_to_end(play, play->options->sets);
    tell_worst(play);
    return bottom && play->result.guard != AUVID_GUARD_ABORTED;
}

static const struct {
    const char *name, *about;
    bool (*play)(play_t *);
} scenarios[] = {
    {"payload", "the vehicle changes in the middle of set 9 of 16", payload},
    {"yaw-idle", "yaw is never excited", yaw_idle},
    {"operator-abort", "the operator aborts in the middle of a set", operator_abort},
    {"current", "a current of 0.3 m/s to the north, seen with two locks of the DVL", current},
    {"dvl-lost", "the DVL falls silent in the middle of a set", dvl_lost}};

enum { SCENARIOS = sizeof scenarios / sizeof scenarios[0] };

/* ---- the command ---- */

static void print_tables(const play_t *play)
{
    if (play->other_key != NULL) {
        printf("\n  from bottom lock\n");
        report_result(&play->other, NULL);
        printf("\n  from water lock");
    }
    putchar('\n');
    report_result(&play->result, NULL);
}

static int tell(play_t *play, int which)
{
    const options_t *options = play->options;
    play->story.name = scenarios[which].name;
    play->story.silent = options->json;
    if (!options->json) {
        printf("auvid %s demo: scenario %s, seed %llu\n  %s\n", AUVID_VERSION_STRING,
               play->story.name, (unsigned long long)options->seed, scenarios[which].about);
        printf("  disturbance %g N, thruster lag %g s; all else as in auvid demo\n\n",
               options->disturbance_N, options->lag_s);
    }
    bool as_told = scenarios[which].play(play);
    if (play->result.vehicle == NULL) {
        return report_error("demo: the identifier refused its configuration");
    }
    const beside_t beside = {play->other_key, &play->other, NULL};
    if (options->json) {
        report_json(&play->result, NULL, play->other_key != NULL ? &beside : NULL, &play->story);
    } else {
        print_tables(play);
    }
    return as_told ? report_exit(&play->result) : 1;
}

int scenario(const options_t *options)
{
    int which = 0;
    while (which < SCENARIOS && strcmp(options->scenario, scenarios[which].name) != 0) {
        ++which;
    }
    if (which == SCENARIOS) {
        return report_error(
            "demo: --scenario: '%s' is not one of payload, yaw-idle, operator-abort, "
            "current, dvl-lost",
            options->scenario);
    }
    play_t *play = calloc(1, sizeof *play);
    if (play == NULL) {
        return report_error("demo: not enough memory");
    }
    play->options = options;
    int status = tell(play, which);
    free(play);
    return status;
}
