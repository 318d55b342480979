/*
 * auvid replay: runs a log of the bus through a node and compares its estimates with those logged.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/node.h"
#include "bus_link.h"
#include "../commands.h"
#include "../base/report_error.h"
#include "../doctor/doctor_report.h"
#include "../log/csv.h"
#include "../report/html.h"
#include "../report/report.h"
#include "../fit/prior_file.h"
#include "bus_identifier.h"

/* Largest number of sent frames that have not yet been found in the log. */
enum { WAITING = 256 };

typedef struct {
    const options_t *options;
    bus_identifier_t own; /* obeys the logged orders; the commands go nowhere */
    auvid_prior_t prior;
    bus_candump_t log;
    csv_writer_t csv;
    doctor_t doctor;    /* of the rows, as of a log */
    double velocity[3]; /* of the last row */
    report_findings_t findings;
    auvid_can_frame_t sent[WAITING]; /* a ring buffer */
    uint32_t first, count;
    uint32_t ours, same, different; /* frames of auvid; estimates, equal and different */
    uint32_t refused[1 - AUVID_ERR_COUNTER_JUMP]; /* by minus the status, the last of all */
} run_t;

static bool is_estimate(const auvid_can_frame_t *frame)
{
    auvid_can_kind_t kind = auvid_can_kind(NULL, frame->id);
    return kind == AUVID_CAN_ESTIMATE || kind == AUVID_CAN_ESTIMATE_SIGMA ||
           kind == AUVID_CAN_WRONG_INPUTS || kind == AUVID_CAN_WRONG_INPUT;
}

/* Compares an estimate in the log with the one that this node has sent. */
static void compare(run_t *run, const auvid_can_frame_t *frame)
{
    if (run->count == 0) {
        ++run->different;
        return;
    }
    const auvid_can_frame_t *mine = &run->sent[run->first];
    bool same = mine->id == frame->id && memcmp(mine->data, frame->data, sizeof mine->data) == 0;
    run->first = (run->first + 1) % WAITING;
    --run->count;
    run->same += same;
    run->different += !same;
}

static void keep(run_t *run, const auvid_can_frame_t *frame, int count)
{
    for (int i = 0; i < count; ++i) {
        if (is_estimate(&frame[i]) && run->count < WAITING) {
            run->sent[(run->first + run->count++) % WAITING] = frame[i];
        }
    }
}

/* Starts the doctor: it sees the columns of write_row. */
static void begin_doctor(run_t *run)
{
    bool has[CSV_COLUMNS] = {false};
    for (int c = CSV_T; c < CSV_COMMAND; ++c) {
        has[c] = true;
    }
    doctor_init(&run->doctor, has);
}

/* A velocity that stands still between samples of the DVL is no new sample. */
static void leave_out_repeated(run_t *run, csv_row_t *row)
{
    double *velocity = &row->value[CSV_NU];
    bool repeats = true;
    for (int i = 0; i < 3; ++i) {
        repeats = repeats && !(fabs(velocity[i] - run->velocity[i]) > 0.0);
        run->velocity[i] = velocity[i];
    }
    for (int i = 0; i < 3 && repeats; ++i) {
        velocity[i] = NAN;
    }
}

/* Takes the motion at the last tick and the thrust that acts after it as a row of a log. */
static void take_row(run_t *run)
{
    auvid_nav_state_t state;
    const auvid_node_t *node = &run->own.node;
    const auvid_allocation_config_t *cfg = &node->allocation.cfg;
    auvid_real_t force_N[AUVID_MAX_THRUSTERS] = {0}, wrench[AUVID_DOF_COUNT];
    if (!node->feedback || auvid_nav_state(&node->id.nav, &state) != AUVID_OK) {
        return;
    }
    for (int i = 0; i < cfg->thrusters; ++i) {
        auvid_real_t part = node->thrust[i];
        force_N[i] = part * (part > 0 ? cfg->thruster[i].max_N : -cfg->thruster[i].min_N);
    }
    (void)auvid_allocation_wrench(&node->allocation, force_N, wrench);
    csv_row_t row = {.value = {[CSV_T] = 1e-6 * (double)(node->t_us - run->own.start_us)}};
    for (int i = 0; i < 3; ++i) {
        row.value[CSV_ATTITUDE + i] = (double)state.attitude[i];
        row.value[CSV_NU + i] = (double)state.velocity[i];
        row.value[CSV_NU + 3 + i] = (double)state.rates[i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        row.value[CSV_WRENCH + j] = (double)wrench[j];
    }
    leave_out_repeated(run, &row);
    if (run->options->csv != NULL) {
        csv_write_row(&run->csv, &row);
    }
    doctor_feed(&run->doctor, &row);
}

static void take(run_t *run, const auvid_can_frame_t *frame)
{
    auvid_can_frame_t out[AUVID_NODE_FRAMES];
    auvid_can_message_t message;
    int count = 0;
    if (auvid_can_unpack(NULL, frame, &message) == AUVID_OK) {
        ++run->ours;
    }
    if (is_estimate(frame)) {
        compare(run, frame);
        return;
    }
    auvid_status_t status = bus_identifier_take(&run->own, frame);
    if (status < 0) {
        ++run->refused[-(int)status];
    } else if (status == AUVID_TICK) {
        take_row(run);
        bus_identifier_step(&run->own, NULL, out, &count);
        (void)auvid_node_work(&run->own.node, AUVID_DEFAULT_BUDGET);
        (void)auvid_node_report(&run->own.node, 0, out, &count);
        keep(run, out, count);
    }
}

static int read_all(run_t *run)
{
    bus_t *bus = &run->log.bus;
    bus_frame_t raw;
    auvid_can_frame_t frame;
    int count = 0;
    while ((count = bus->receive(bus, &raw, 1)) > 0) {
        if (frames_convert(&raw, &frame)) {
            take(run, &frame);
        }
    }
    if (count != BUS_END) {
        return report_error("replay: %s", bus->text);
    }
    if (run->ours == 0) {
        return report_error("replay: %s: no frame of auvid: check that this is a log of its bus",
                            run->options->log);
    }
    return run->own.node.counters.ticks > 0
               ? 0
               : report_error("replay: %s: no tick frame, so no time: record the whole bus",
                              run->options->log);
}

static int begin(run_t *run)
{
    begin_doctor(run);
    if (bus_identifier_begin(&run->own, run->options, run->options->log, false,
                             run->options->vehicle->has_excitation) != 0) {
        return EXIT_REFUSED;
    }
    if (run->options->prior != NULL &&
        !prior_file_read(&run->own.node.id, &run->prior, run->options->prior)) {
        return EXIT_REFUSED;
    }
    if (bus_candump_open(&run->log, run->options->log, NULL) != BUS_OK) {
        return report_error("replay: %s", run->log.bus.text);
    }
    return 0;
}

static double span_s(const run_t *run)
{
    return 1e-6 * (double)(run->own.node.t_us - run->own.start_us);
}

/* Warns on stderr about frames of the log that were ignored, and known forces outside it. */
static void warn_left_out(const run_t *run)
{
    const uint32_t *refused = run->refused;
    char text[300];
    if (vehicle_calibrations_miss(run->own.calibration, run->own.calibrations, 0.0, span_s(run),
                                  text, sizeof text)) {
        report_warning("%s: %s", run->options->log, text);
    }
    if (run->log.bus.text[0] != '\0') {
        report_warning("%s", run->log.bus.text);
    }
    if (run->options->prior != NULL) {
        prior_file_judge(&run->prior, run->options->prior);
    }
    if (run->own.node.counters.refused > 0) {
        report_warning(
            "%s: %u frames of auvid are refused: %u with a wrong checksum, %u of a wrong "
            "length, %u with a value out of range, %u repeated, %u after a gap of their counter, "
            "%u late ticks",
            run->options->log, (unsigned)run->own.node.counters.refused,
            (unsigned)refused[-AUVID_ERR_CHECKSUM], (unsigned)refused[-AUVID_ERR_LENGTH],
            (unsigned)refused[-AUVID_ERR_RANGE], (unsigned)refused[-AUVID_ERR_REPEATED],
            (unsigned)refused[-AUVID_ERR_COUNTER_JUMP], (unsigned)refused[-AUVID_ERR_STALE]);
    }
}

/* The estimate, the allocation and the axes are those of one vehicle: errors of a log may be those
 * of another one. */
static void warn_vehicle(const run_t *run)
{
    bool error = run->different > 0;
    for (int i = 0; i < run->doctor.findings; ++i) {
        error = error || run->doctor.finding[i].severity == DOCTOR_ERROR;
    }
    if (error && !run->options->whole) {
        report_warning("%s: the log is compared with the vehicle %s, because none is named: give "
                       "that of the log first, with --vehicle FILE.ini",
                       run->options->log, run->options->vehicle->word);
    }
}

static int report(run_t *run)
{
    static result_t result;
    report_gather(&result, &run->own.node.id, run->options->seed);
    bus_identifier_calibrate(&run->own, &result);
    doctor_finish(&run->doctor);
    warn_vehicle(run);
    if (doctor_tell(&run->doctor, run->options->log, &run->findings) != 0) {
        return EXIT_REFUSED;
    }
    result.findings = &run->findings;
    result.log = (report_log_t){.path = &run->options->log,
                                .paths = 1,
                                .rows = run->own.node.counters.ticks,
                                .duration_s = span_s(run)};
    if (run->options->json) {
        report_json(stdout, &result, NULL, NULL, NULL);
    } else {
        printf("auvid %s replay of %s\n\n", AUVID_VERSION_STRING, run->options->log);
        report_result(&result, NULL);
        bus_identifier_print_missing(&run->own);
        printf("  log   %u frames of auvid, %u refused, %u ticks; estimate frames: %u as in the "
               "log, %u different\n",
               (unsigned)run->ours, (unsigned)run->own.node.counters.refused,
               (unsigned)run->own.node.counters.ticks, (unsigned)run->same,
               (unsigned)run->different);
        if (run->different > 0) {
            puts(
                "        give the --vehicle, --seed, --sets and --prior of the node that wrote it");
        }
    }
    int status = report_html(run->options, &result, NULL);
    status = status != 0 ? status : report_exit(&result);
    return status == 0 && run->different > 0 ? 1 : status;
}

/* Replays an open log, and writes it as CSV. */
static int replay_log(run_t *run)
{
    const char *path = run->options->csv;
    int status = path != NULL ? csv_create(&run->csv, path) : 0;
    bool writes = path != NULL && status == 0;
    if (writes) {
        csv_write_header(&run->csv);
    }
    status = status == 0 ? read_all(run) : status;
    if (writes && status == 0) {
        status = csv_commit(&run->csv);
    } else if (writes) {
        csv_discard(&run->csv);
    }
    return status;
}

int bus_replay(const options_t *options)
{
    run_t *run = calloc(1, sizeof *run);
    if (run == NULL) {
        return report_error("replay: not enough memory");
    }
    run->options = options;
    int status = begin(run);
    bool opened = status == 0;
    status = opened ? replay_log(run) : status;
    if (status == 0) {
        warn_left_out(run);
        status = report(run);
    } else if (options->json) {
        report_error_json();
    }
    if (opened) {
        (void)run->log.bus.close(&run->log.bus);
    }
    report_free_findings(&run->findings);
    free(run);
    return status;
}
