/*
 * auvid demo: excites a simulated vehicle, identifies it on line, and validates the estimate on an
 * excitation that was not used to identify it.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../commands.h"
#include "../base/report_error.h"
#include "../log/csv.h"
#include "../report/html.h"
#include "../base/progress.h"
#include "../report/report.h"
#include "../report/statistics.h"
#include "../bus/world.h"

/* Limits of the searches after the last set: a time [s of simulated time], and a number of work
 * units. With a small budget the latter covers two searches: the current one and the next one. */
#define PATIENCE_S 600.0
#define PATIENCE_UNITS 150000.0

/* Sets of the held-out excitation: one of steps, one of sines. */
#define HELD_OUT_SETS 2

#define TICK_S (1e-6 * SIM_TICK_US)

/* Rows that wait for the next DVL sample: half a second of ticks, plus one. */
enum { WAITING = 26 };

/* The log that is being written. As in the recorder, velocity is interpolated linearly between DVL
 * samples, so a row waits for the next DVL sample. */
typedef struct {
    csv_writer_t *writer; /* NULL: no log */
    csv_row_t row[WAITING];
    int rows;
    auvid_nav_velocity_sample_t last_velocity; /* the last velocity */
} logger_t;

/* One run. */
typedef struct {
    world_t world;
    logger_t logger;
    estimates_t estimates;
    auvid_validation_t validation[WORLD_NODES];
    trace_t trace;                /* of the held-out excitation */
    result_t result[WORLD_NODES]; /* all sets; last set only (literal) */
    double simulated_s;
    vehicle_calibration_t calibration[VEHICLE_CALIBRATIONS]; /* known forces */
    int calibrations;
} run_t;

/* Writes the rows up to a new velocity. After a gap they are dropped. */
static void log_velocity(logger_t *logger, const auvid_nav_velocity_sample_t *last_velocity)
{
    double t0 = 1e-6 * (double)logger->last_velocity.t_us, t1 = 1e-6 * (double)last_velocity->t_us;
    for (int k = 0; k < logger->rows && logger->last_velocity.sequence > 0 && t1 - t0 <= 0.5; ++k) {
        csv_row_t *row = &logger->row[k];
        double part = (row->value[CSV_T] - t0) / (t1 - t0);
        if (part < 0.0 || part >= 1.0) {
            continue;
        }
        for (int i = 0; i < 3; ++i) {
            double from = (double)logger->last_velocity.velocity[i],
                   to = (double)last_velocity->velocity[i];
            row->value[CSV_NU + i] = from + part * (to - from);
        }
        csv_write_row(logger->writer, row);
    }
    logger->rows = 0;
    logger->last_velocity = *last_velocity;
}

/* Adds a row: the wrench since the previous row, attitude and rates now. */
static void log_tick(logger_t *logger, const world_t *world)
{
    auvid_nav_state_t state;
    const auvid_nav_t *nav = &world->node[0].id.nav;
    const auvid_nav_velocity_sample_t *last_velocity = &nav->ground;
    if (logger->writer == NULL || auvid_nav_state(nav, &state) != AUVID_OK) {
        return;
    }
    if (logger->rows > 0) {
        memcpy(&logger->row[logger->rows - 1].value[CSV_WRENCH], world->vehicle_sim.seen.wrench,
               sizeof world->vehicle_sim.seen.wrench);
    }
    if (last_velocity->sequence != logger->last_velocity.sequence) {
        log_velocity(logger, last_velocity);
    }
    if (logger->rows == WAITING) {
        logger->rows = 0;
    }
    csv_row_t *row = &logger->row[logger->rows++];
    memset(row, 0, sizeof *row);
    row->value[CSV_T] = 1e-6 * (double)state.t_us;
    for (int i = 0; i < 3; ++i) {
        row->value[CSV_ATTITUDE + i] = (double)state.attitude[i];
        row->value[CSV_NU + 3 + i] = (double)state.rates[i];
    }
}

/* shown: number of the estimate that was shown last. */
static void show_progress(const run_t *run, const options_t *options, progress_t *progress,
                          uint32_t *shown)
{
    const auvid_estimate_t *e = &run->world.node[0].id.estimate;
    double truth[VEHICLE_SIM_PARAMETERS];
    vehicle_sim_truth(&run->world.vehicle_sim, truth);
    double rms = report_rms_percent(e, truth);
    double t = world_time_s(&run->world), total = (double)options->sets * WORLD_SET_S + 10.0;
    double part = t < total ? t / total : 1.0;
    if (e->number == 0) {
        progress_bar(progress, part, "%.0f s", t);
        return;
    }
    progress_bar(progress, part, "%.0f s, %u set%s: rms error %.2f %%", t, (unsigned)e->sets,
                 e->sets == 1 ? "" : "s", rms);
    if (e->number != *shown) {
        *shown = e->number;
        progress_line(progress, "%5.0f s, %2u set%s rms error %5.2f %%", t, (unsigned)e->sets,
                      e->sets == 1 ? ": " : "s:", rms);
    }
}

/* Is the recording complete? */
static bool is_over(const auvid_identifier_t *id, const options_t *options)
{
    return options->adaptive ? id->actuation->guard.state == AUVID_GUARD_DONE
                             : id->metric.sets.recorded >= options->sets;
}

/* Lists the estimate of a search that ended in this tick. */
static void list_estimate(run_t *run)
{
    const auvid_node_t *node = &run->world.node[0];
    estimates_t *to = &run->estimates;
    if ((node->events & AUVID_EVENT_ESTIMATE) && to->count < sizeof to->at / sizeof to->at[0]) {
        to->at[to->count].t_s = 1e-6 * (double)node->id.estimate.t_us;
        to->at[to->count++].sets = node->id.estimate.sets;
    }
}

static void add_truth(run_t *run)
{
    const world_t *world = &run->world;
    report_add_truth(&run->result[0], &world->vehicle_sim);
    if (world->calibrations > 0) {
        run->result[0].truth[world->calibrated.k] = 1.0;
    }
    run->result[1].has_truth = true;
    memcpy(run->result[1].truth, run->result[0].truth, sizeof run->result[1].truth);
}

/* Excites, records and identifies. progress may be NULL. */
static bool identify(run_t *run, const options_t *options, uint64_t seed, progress_t *progress)
{
    world_t *world = &run->world;
    const world_config_t config = {.options = options,
                                   .vehicle = options->vehicle,
                                   .seed = seed,
                                   .disturbance_N = options->disturbance_N,
                                   .lag_s = options->lag_s,
                                   .sets = options->sets,
                                   .adaptive = options->adaptive,
                                   .literal = options->literal,
                                   .calibration = run->calibration,
                                   .calibrations = run->calibrations};
    if (!world_begin(world, &config)) {
        return false;
    }
    if (options->literal) {
        auvid_identifier_config_t cfg;
        world_identifier(&cfg, &config);
        cfg.metric.sets = 1;
        if (!world_listen(world, &cfg)) {
            return false;
        }
    }
    uint32_t shown = 0, linger = 0, exciting = 0;
    double end_s = (double)options->sets * WORLD_SET_S + PATIENCE_S +
                   PATIENCE_UNITS * TICK_S / options->budget;
    while (linger < options->vehicle->linger_ticks && world_time_s(world) < end_s) {
        world_tick(world);
        exciting += world->actuation.guard.state == AUVID_GUARD_EXCITING;
        list_estimate(run);
        log_tick(&run->logger, world);
        bool settles = world->actuation.guard.state == AUVID_GUARD_SETTLING;
        bool busy = world_work(world, options->budget) || settles;
        for (int i = 0; i < world->nodes; ++i) {
            busy = busy || !is_over(&world->node[i].id, options);
        }
        linger = busy ? 0 : linger + 1;
        if (progress != NULL) {
            show_progress(run, options, progress, &shown);
        }
    }
    for (int i = 0; i < world->nodes; ++i) {
        report_gather(&run->result[i], &world->node[i].id, seed);
        run->result[i].estimate.not_converged |= linger == 0; /* the time ran out */
        run->result[i].budget = options->budget;
        run->result[i].vehicle =
            options->literal ? options->vehicle->model : run->result[i].vehicle;
    }
    run->result[0].estimates = &run->estimates;
    run->result[0].trace = &run->trace;
    add_truth(run);
    run->simulated_s = world_time_s(world);
    if (options->adaptive) {
        result_t *result = &run->result[0];
        const auvid_adaptive_t *adaptive = &world->adaptive;
        result->excited_s = TICK_S * exciting;
        result->given_up = adaptive->abandoned;
        result->still_missing = adaptive->missing & ~result->estimate.confidence.identifiable;
    }
    return true;
}

/* Simulates another excitation, of which the identifiers feed the cells to their validations. */
static void simulate_held_out(run_t *run, double cell_s)
{
    const auvid_validation_t *validation = &run->validation[0];
    uint32_t compared = 0;
    trace_begin(&run->trace, (size_t)(HELD_OUT_SETS * WORLD_SET_S / cell_s), cell_s);
    while (world_time_s(&run->world) < HELD_OUT_SETS * WORLD_SET_S) {
        world_tick(&run->world);
        (void)world_work(&run->world, 0);
        if (validation->cells != compared) {
            compared = validation->cells;
            trace_add(&run->trace, validation, &validation->last, false);
        }
    }
}

/* Simulates another excitation with the estimate and with the true parameters. */
static bool validate(run_t *run, const options_t *options, uint64_t seed)
{
    world_t *world = &run->world;
    result_t *result = &run->result[0];
    const world_config_t config = {.vehicle = options->vehicle,
                                   .seed = ~seed,
                                   .disturbance_N = options->disturbance_N,
                                   .lag_s = options->lag_s,
                                   .sets = HELD_OUT_SETS,
                                   .calibration = run->calibration,
                                   .calibrations = run->calibrations};
    auvid_real_t truth[AUVID_MAX_PARAMETERS];
    const auvid_real_t *pi[WORLD_NODES] = {result->estimate.pi, truth};
    double *r2[WORLD_NODES] = {result->r2, result->r2_truth};
    bool valid[WORLD_NODES] = {false};
    auvid_identifier_config_t cfg;
    world_identifier(&cfg, &config);
    if (!world_begin(world, &config) || !world_listen(world, &cfg)) {
        return false;
    }
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        truth[i] = (auvid_real_t)result->truth[i];
    }
    for (int i = 0; i < WORLD_NODES; ++i) {
        valid[i] = auvid_validation_init(&run->validation[i], result->vehicle, pi[i], 0,
                                         result->estimate.delay_s, result->estimate.first_order_lag,
                                         AUVID_C(1e-6) * (auvid_real_t)cfg.recorder.cell_us) >= 0;
        auvid_identifier_attach(&world->node[i].id, valid[i] ? &run->validation[i] : NULL);
    }
    simulate_held_out(run, 1e-6 * cfg.recorder.cell_us);
    for (int i = 0; i < WORLD_NODES; ++i) {
        auvid_real_t value[AUVID_DOF_COUNT];
        valid[i] = valid[i] && auvid_validation_r2(&run->validation[i], value) == AUVID_OK;
        for (int j = 0; j < AUVID_DOF_COUNT && valid[i]; ++j) {
            r2[i][j] = (double)value[j];
        }
    }
    result->has_validation = true;
    result->validated = valid[0] ? result->estimate.excited | result->estimate.coupled : 0u;
    result->has_r2_truth = valid[0] && valid[1];
    run->simulated_s += world_time_s(world);
    return true;
}

/* Does one run, with a log unless path is NULL. Returns 0, or EXIT_REFUSED after a message. */
static int run_once(run_t *run, const options_t *options, uint64_t seed, const char *path,
                    progress_t *progress)
{
    csv_writer_t writer;
    memset(run, 0, sizeof *run);
    run->calibrations = vehicle_calibrations_of(options->vehicle, NULL, true, run->calibration);
    if (path != NULL) {
        if (csv_create(&writer, path) != 0) {
            return EXIT_REFUSED;
        }
        csv_write_header(&writer);
        run->logger.writer = &writer;
    }
    bool done = identify(run, options, seed, progress) && validate(run, options, seed);
    if (done && run->world.calibrations > 0) {
        report_calibrate(&run->result[0], &run->world.calibrated);
    }
    if (!done && path != NULL) {
        csv_discard(&writer);
    }
    if (!done) {
        const auvid_refusal_t *why = world_refusal(&run->world);
        return why != NULL ? report_refused("demo", why->status, why, NULL)
                           : report_error("demo: the simulator refused its configuration");
    }
    return path == NULL ? 0 : csv_commit(&writer);
}

/* Prints "100 N on X, Y, Z, 40 Nm on N". */
static void print_amplitudes(const vehicle_t *vehicle)
{
    const char *separator = "";
    double shown = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double amplitude = (double)vehicle->amplitude[j];
        bool moment = j >= AUVID_ROLL;
        if (amplitude > 0.0 && (fabs(amplitude - shown) > 0.0 || j == AUVID_ROLL)) {
            printf("%s%g %s on ", separator, amplitude, moment ? "Nm" : "N");
            shown = amplitude;
            separator = "";
        }
        if (amplitude > 0.0) {
            printf("%s%c", separator, "XYZKMN"[j]);
            separator = ", ";
        }
    }
}

static void print_heading(const options_t *options)
{
    printf("auvid %s demo: a simulated %s, seed %llu", AUVID_VERSION_STRING,
           options->vehicle->title, (unsigned long long)options->seed);
    if (options->runs > 1) {
        printf(" .. %llu", (unsigned long long)(options->seed + options->runs - 1));
    }
    if (options->adaptive) {
        printf("\n  excitation   adaptive, at most %u s: ", (unsigned)options->sets * WORLD_SET_S);
    } else {
        printf("\n  excitation   %u set%s of %d s, alternating steps and sines: ",
               (unsigned)options->sets, options->sets == 1 ? "" : "s", WORLD_SET_S);
    }
    print_amplitudes(options->vehicle);
    printf(
        "\n  sensors      IMU 50 Hz, DVL 5 Hz, depth 10 Hz; disturbance %g N, thruster lag %g s\n",
        options->disturbance_N, options->lag_s);
    printf("  metric       %s\n", options->literal
                                      ? "literal smoothing of the paper: smoothed states, "
                                        "raw wrench"
                                      : "states and wrench smoothed with the same filter");
}

/* Prints the duration of the excitation, and the parameters that are not identified. */
static void print_adaptive(const result_t *result)
{
    printf("  adaptive  %.0f s of excitation; ", result->excited_s);
    const uint32_t lists[] = {result->given_up, result->still_missing};
    static const char *const words[] = {"abandoned:", "still missing:"};
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; lists[k] != 0 && i < result->vehicle->parameters; ++i) {
            bool first = lists[k] << (31 - i) << 1 == 0;
            if (lists[k] >> i & 1u) {
                printf("%s%s %s", first && k > 0 && lists[0] != 0 ? "; " : "",
                       first ? words[k] : ",", result->vehicle->parameter[i].name);
            }
        }
    }
    puts((lists[0] | lists[1]) == 0 ? "nothing is missing" : "");
}

static int single_run(run_t *run, const options_t *options)
{
    progress_t progress;
    progress_begin(&progress, !options->json);
    int status = run_once(run, options, options->seed, options->csv, &progress);
    double wall_s = progress_end(&progress);
    if (status != 0) {
        return status;
    }
    const result_t *last = options->literal ? &run->result[1] : NULL;
    const second_result_t second = {"last_set", last, NULL};
    if (options->json) {
        report_json(stdout, &run->result[0], NULL, last != NULL ? &second : NULL, NULL);
    } else {
        print_heading(options);
        putchar('\n');
        report_result(&run->result[0], last);
        if (options->adaptive) {
            print_adaptive(&run->result[0]);
        }
        printf("  time  %.0f s simulated in %.2f s\n", run->simulated_s, wall_s);
    }
    status = report_html(options, &run->result[0], last != NULL ? &second : NULL);
    return status != 0 ? status : report_exit(&run->result[0]);
}

/* Does all runs and adds them to the tallies. The results of the first run are kept. */
static int run_all(run_t *run, const options_t *options, tally_t *tally, result_t *first)
{
    uint32_t shown = 0;
    int status = 0;
    progress_t progress;
    progress_begin(&progress, !options->json);
    for (uint32_t k = 0; k < options->runs && status == 0; ++k) {
        status = run_once(run, options, options->seed + k, k == 0 ? options->csv : NULL, NULL);
        for (int i = 0; i < (options->literal ? 2 : 1) && status == 0; ++i) {
            tally_add(&tally[i], &run->result[i]);
        }
        if (k == 0) {
            memcpy(first, run->result, sizeof run->result);
        }
        progress_bar(&progress, (double)(k + 1) / options->runs, "run %u of %u", (unsigned)(k + 1),
                     (unsigned)options->runs);
        uint32_t tenths = (uint32_t)(10.0 * (k + 1) / options->runs);
        if (tenths != shown) {
            shown = tenths;
            progress_line(&progress, "%u of %u runs", (unsigned)(k + 1), (unsigned)options->runs);
        }
    }
    double wall_s = progress_end(&progress);
    if (status == 0 && !options->json) {
        print_heading(options);
        printf("  time         %u runs of %.0f s simulated in %.1f s\n\n", (unsigned)options->runs,
               run->simulated_s, wall_s);
    }
    return status;
}

static int many_runs(run_t *run, const options_t *options)
{
    tally_t tally[WORLD_NODES] = {0};
    result_t first[WORLD_NODES];
    int lists = options->literal ? 2 : 1, status = 0;
    for (int i = 0; i < lists && status == 0; ++i) {
        if (!tally_begin(&tally[i], options->runs)) {
            status = report_error("demo: not enough memory for %u runs", (unsigned)options->runs);
        }
    }
    if (status == 0) {
        status = run_all(run, options, tally, first);
    }
    if (status == 0) {
        const campaign_t *all = &tally[0].sum, *last = options->literal ? &tally[1].sum : NULL;
        for (int i = 0; i < lists; ++i) {
            tally_finish(&tally[i], &first[i], options->seed);
        }
        const second_result_t second = {"last_set", &first[1], last};
        if (options->json) {
            report_json(stdout, &first[0], all, last != NULL ? &second : NULL, NULL);
        } else {
            report_campaign(&first[0], all, last);
        }
        status = all->not_converged ? 1 : 0;
    }
    for (int i = 0; i < lists; ++i) {
        tally_free(&tally[i]);
    }
    return status;
}

int demo(const options_t *options)
{
    run_t *run = malloc(sizeof *run);
    if (run == NULL) {
        return report_error("demo: not enough memory");
    }
    int status = options->runs > 0 ? many_runs(run, options) : single_run(run, options);
    free(run);
    return status;
}
