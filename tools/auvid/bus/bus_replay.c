/*
 * auvid replay: runs a log of the bus through a node and compares its estimates with those logged.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/node.h"
#include "bus_link.h"
#include "../commands.h"
#include "../base/report_error.h"
#include "../log/csv.h"
#include "../report/html.h"
#include "../report/report.h"
#include "../fit/prior_file.h"
#include "world.h"

/* Largest number of sent frames that have not yet been found in the log. */
enum { WAITING = 256 };

typedef struct {
    const options_t *options;
    auvid_node_t node;
    auvid_actuation_t actuation; /* obeys the logged orders; the commands go nowhere */
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    auvid_uncertain_t uncertain;
    auvid_prior_t prior;
    bus_candump_t log;
    csv_writer_t csv;
    uint64_t start_us;               /* time of the first tick */
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

/* Writes the motion at the last tick and the thrust that acts after it. */
static void write_row(run_t *run)
{
    auvid_nav_state_t state;
    const auvid_node_t *node = &run->node;
    const auvid_allocation_config_t *cfg = &node->allocation.cfg;
    auvid_real_t force_N[AUVID_MAX_THRUSTERS] = {0}, wrench[AUVID_DOF_COUNT];
    if (run->options->csv == NULL || !node->feedback ||
        auvid_nav_state(&node->id.nav, &state) != AUVID_OK) {
        return;
    }
    for (int i = 0; i < cfg->thrusters; ++i) {
        auvid_real_t part = node->thrust[i];
        force_N[i] = part * (part > 0 ? cfg->thruster[i].max_N : -cfg->thruster[i].min_N);
    }
    (void)auvid_allocation_wrench(&node->allocation, force_N, wrench);
    csv_row_t row = {.value = {[CSV_T] = 1e-6 * (double)node->t_us}};
    for (int i = 0; i < 3; ++i) {
        row.value[CSV_ATTITUDE + i] = (double)state.attitude[i];
        row.value[CSV_NU + i] = (double)state.velocity[i];
        row.value[CSV_NU + 3 + i] = (double)state.rates[i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        row.value[CSV_WRENCH + j] = (double)wrench[j];
    }
    csv_write_row(&run->csv, &row);
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
    auvid_status_t status = auvid_node_take(&run->node, frame);
    if (status < 0) {
        ++run->refused[-(int)status];
    } else if (status == AUVID_TICK) {
        run->start_us = run->start_us > 0 ? run->start_us : run->node.t_us;
        write_row(run);
        (void)auvid_node_step(&run->node, NULL, out, &count);
        (void)auvid_node_work(&run->node, AUVID_DEFAULT_BUDGET);
        (void)auvid_node_report(&run->node, 0, out, &count);
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
    return run->node.counters.ticks > 0
               ? 0
               : report_error("replay: %s: no tick frame, so no time: record the whole bus",
                              run->options->log);
}

static int begin(run_t *run)
{
    const options_t *o = run->options;
    const world_config_t world = {.vehicle = o->vehicle, .seed = o->seed, .sets = o->sets};
    auvid_identifier_config_t identifier;
    auvid_node_config_t cfg;
    world_identifier(&identifier, &world);
    options_uncertainty(o, &identifier.uncertainty);
    identifier.exact_inputs = o->plain;
    auvid_node_defaults(&cfg);
    auvid_status_t status = auvid_node_init(&run->node, &cfg, o->vehicle->allocation, &identifier);
    if (status < 0) {
        return report_refused("replay", status, &run->node.id.refusal, &identifier);
    }
    (void)auvid_identifier_attach_prediction(&run->node.id, &run->prediction);
    (void)auvid_identifier_attach_change_test(&run->node.id, &run->change);
    status = o->plain ? AUVID_OK : world_uncertain(&run->node, &run->uncertain, o->vehicle);
    if (status < 0) {
        return report_error("replay: uncertain inputs: %s", auvid_status_str(status));
    }
    status = world_excite(&run->node, &run->actuation, &world);
    if (status < 0) {
        return report_refused("replay", status, &run->actuation.refusal, NULL);
    }
    if (run->options->prior != NULL &&
        !prior_file_read(&run->node.id, &run->prior, run->options->prior)) {
        return EXIT_REFUSED;
    }
    if (bus_candump_open(&run->log, run->options->log, NULL) != BUS_OK) {
        return report_error("replay: %s", run->log.bus.text);
    }
    return 0;
}

/* Warns on stderr about frames of the log that were ignored. */
static void warn_left_out(const run_t *run)
{
    const uint32_t *refused = run->refused;
    if (run->log.bus.text[0] != '\0') {
        report_warning("%s", run->log.bus.text);
    }
    if (run->node.counters.refused > 0) {
        report_warning(
            "%s: %u frames of auvid are refused: %u with a wrong checksum, %u of a wrong "
            "length, %u with a value out of range, %u repeated, %u after a gap of their counter, "
            "%u late ticks",
            run->options->log, (unsigned)run->node.counters.refused,
            (unsigned)refused[-AUVID_ERR_CHECKSUM], (unsigned)refused[-AUVID_ERR_LENGTH],
            (unsigned)refused[-AUVID_ERR_RANGE], (unsigned)refused[-AUVID_ERR_REPEATED],
            (unsigned)refused[-AUVID_ERR_COUNTER_JUMP], (unsigned)refused[-AUVID_ERR_STALE]);
    }
}

static int report(const run_t *run)
{
    static result_t result;
    report_gather(&result, &run->node.id, run->options->seed);
    result.log = (report_log_t){.path = &run->options->log,
                                .paths = 1,
                                .rows = run->node.counters.ticks,
                                .duration_s = 1e-6 * (double)(run->node.t_us - run->start_us)};
    if (run->options->json) {
        report_json(stdout, &result, NULL, NULL, NULL);
    } else {
        printf("auvid %s replay of %s\n\n", AUVID_VERSION_STRING, run->options->log);
        report_result(&result, NULL);
        printf("  log   %u frames of auvid, %u refused, %u ticks; estimate frames: %u as in the "
               "log, %u different\n",
               (unsigned)run->ours, (unsigned)run->node.counters.refused,
               (unsigned)run->node.counters.ticks, (unsigned)run->same, (unsigned)run->different);
    }
    int status = report_html(run->options, &result, NULL);
    status = status != 0 ? status : report_exit(&result);
    return status == 0 && run->different > 0 ? 1 : status;
}

int bus_replay(const options_t *options)
{
    run_t *run = calloc(1, sizeof *run);
    if (run == NULL) {
        return report_error("replay: not enough memory");
    }
    run->options = options;
    int status = begin(run);
    if (status == 0) {
        bool writes = options->csv != NULL;
        status = writes ? csv_create(&run->csv, options->csv) : 0;
        writes = writes && status == 0;
        if (writes) {
            csv_write_header(&run->csv);
        }
        status = status == 0 ? read_all(run) : status;
        if (writes && status == 0) {
            status = csv_commit(&run->csv);
        } else if (writes) {
            csv_discard(&run->csv);
        }
        if (status == 0) {
            warn_left_out(run);
            status = report(run);
        }
        (void)run->log.bus.close(&run->log.bus);
    }
    free(run);
    return status;
}
