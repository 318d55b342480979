/*
 * auvid node: the identifier on a CAN bus.
 */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "auvid/node.h"
#include "bus_link.h"
#include "../commands.h"
#include "../base/report_error.h"
#include "../report/report.h"
#include "../fit/prior_file.h"
#include "bus_identifier.h"

/* Largest number of frames per turn of the loop: more than a full bus transmits in a tick. */
#define MAX_FRAMES 512

/* Upper end of the histogram of tick times [us]: longer ticks count in the last bin. */
#define MAX_US 40000

/* For so long the command of zero at the end is sent again [ms]. */
#define END_MS 50

typedef struct {
    const options_t *options;
    bus_identifier_t own;
    auvid_prior_t prior;
    bool has_prior;
    link_t link;
    vehicle_sim_t vehicle_sim; /* --bus memory: the vehicle in this process */
    bus_memory_t hub;          /* its ends: node, vehicle */
    bool simulated, silent, warned;
    uint64_t last_tick_us;          /* time of the last tick */
    uint64_t dropped;               /* frames that the bus lost so far */
    auvid_can_frame_t zero[AUVID_NODE_COMMANDS]; /* commands of zero that the bus did not take */
    int zeros;
    uint32_t linger;                /* ticks since all work was done */
    uint32_t histogram[MAX_US + 1]; /* ticks by execution time of step and work [us] */
} run_t;

static int begin(run_t *run)
{
    const options_t *o = run->options;
    if (bus_identifier_begin(&run->own, o, NULL, o->lock_step || run->simulated, o->excite) != 0) {
        return EXIT_REFUSED;
    }
    if (o->prior != NULL) {
        run->has_prior = prior_file_read(&run->own.node.id, &run->prior, o->prior);
    }
    if (!run->simulated) {
        return link_open(&run->link, "node", o);
    }
    vehicle_sim_config_t vehicle_sim;
    vehicle_simulation(o->vehicle, &vehicle_sim);
    vehicle_sim.sim.seed = o->seed;
    vehicle_sim.sim.lag_s = o->lag_s;
    vehicle_sim.no_arm = !o->excite;
    if (bus_memory_init(&run->hub, 2, o->seed) != BUS_OK ||
        !vehicle_sim_init(&run->vehicle_sim, &vehicle_sim)) {
        return report_error("node: the simulator refused its configuration");
    }
    link_take(&run->link, "node", &run->hub.end[0].bus);
    return o->realtime ? link_tick(&run->link, o) : 0;
}

/* Sends frames. A command of zero that the bus does not take is kept, to be sent again. */
static int send_frames(run_t *run, const auvid_can_frame_t *frame, int count)
{
    int status = link_send(&run->link, frame, count);
    if (run->own.node.commanding) {
        run->zeros = 0;
        return status;
    }
    for (int i = 0; i < count; ++i) {
        bool command = frame[i].id == auvid_can_id(NULL, AUVID_CAN_THRUSTER_COMMAND_A) ||
                       frame[i].id == auvid_can_id(NULL, AUVID_CAN_THRUSTER_COMMAND_B);
        if (command && (run->link.unsent >> i & 1u) != 0 && run->zeros < AUVID_NODE_COMMANDS) {
            run->zero[run->zeros++] = frame[i];
        }
    }
    return status;
}

static int send_zeros(run_t *run)
{
    auvid_can_frame_t frame[AUVID_NODE_COMMANDS];
    int count = run->zeros;
    memcpy(frame, run->zero, sizeof frame);
    run->zeros = 0;
    return count > 0 ? send_frames(run, frame, count) : 0;
}

/* Ends the thrust, if there is any or if it is about to begin. why: a line on stderr, or NULL */
static int halt(run_t *run, auvid_guard_cause_t cause, const char *why)
{
    auvid_can_frame_t frame[AUVID_NODE_COMMANDS];
    auvid_node_t *node = &run->own.node;
    int count = 0;
    if (!node->commanding && !node->arming) {
        return 0;
    }
    if (why != NULL) {
        report_error_line("node: %s: excitation aborted", why);
    }
    (void)auvid_node_halt(node, cause, frame, &count);
    return send_frames(run, frame, count);
}

/* Is the tick that came, or should have come, at this time so late that the guard would not let the
 * excitation go on? The time of a tick that waited in the queue does not say so. */
static bool is_late(const run_t *run, uint64_t tick_us)
{
    const auvid_actuation_t *acts = run->own.node.id.actuation;
    if (run->simulated || run->options->lock_step || acts == NULL ||
        (acts->guard.cfg.off & AUVID_GUARD_BIT(AUVID_GUARD_TICK)) != 0) {
        return false;
    }
    uint64_t now_us = tick_now_us();
    return now_us > tick_us && now_us - tick_us > acts->guard.cfg.max_tick_us;
}

/* Were frames lost? An abort may be among them. */
static bool lost_frames(run_t *run)
{
    uint64_t dropped = run->link.bus->statistics.dropped;
    bool more = dropped != run->dropped;
    run->dropped = dropped;
    return more;
}

/* Does all work of one tick. clock_us: time of the node's own clock, or NULL. */
static int serve(run_t *run, const uint64_t *clock_us)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    auvid_node_t *node = &run->own.node;
    uint64_t began_us = tick_now_us();
    int count = 0;
    bus_identifier_step(&run->own, clock_us, frame, &count);
    int status = send_frames(run, frame, count);
    bool busy = auvid_node_work(node, AUVID_DEFAULT_BUDGET) == AUVID_PENDING;
    uint64_t took_us = tick_now_us() - began_us;
    ++run->histogram[took_us < MAX_US ? took_us : MAX_US];
    (void)auvid_node_report(node, (uint32_t)(100u * took_us / LINK_TICK_US), frame, &count);
    status = status == 0 ? link_send(&run->link, frame, count) : status;
    bool over = !busy && node->id.metric.sets.recorded >= run->options->sets;
    run->linger = over ? run->linger + 1 : 0;
    run->last_tick_us = began_us;
    run->silent = false;
    return status;
}

static void warn_of_two_clocks(run_t *run)
{
    if (!run->warned) {
        report_error_line("node: --clock own, but another node on %s sends ticks, too",
                          run->options->bus);
        run->warned = true;
    }
}

/* Receives pending frames up to a tick. The limit lets signals through on a saturated bus. */
static int receive(run_t *run)
{
    auvid_can_frame_t frame;
    int got = 0, status = 0;
    for (int k = 0; k < MAX_FRAMES && (got = link_receive(&run->link, &frame)) > 0; ++k) {
        auvid_status_t taken = bus_identifier_take(&run->own, &frame);
        if (lost_frames(run)) {
            status =
                halt(run, AUVID_GUARD_OPERATOR, "frames were lost, an abort may be among them");
        }
        if (taken == AUVID_TICK && run->options->clock_own) {
            warn_of_two_clocks(run);
        } else if (taken == AUVID_TICK) {
            if (status == 0 && is_late(run, frame.t_us)) {
                status = halt(run, AUVID_GUARD_TICK, "a tick waited too long");
            }
            return status == 0 ? serve(run, NULL) : status;
        }
    }
    return got < 0 ? EXIT_REFUSED : status;
}

/* Waits for frames or for the tick. Returns TICK_..., or a negative number after an error. */
static int wait(run_t *run)
{
    int events = run->link.ticking ? tick_wait(&run->link.tick, 500) : TICK_DUE;
    if (events < 0) {
        report_error_line("node: %s", run->link.tick.text);
    }
    if (run->simulated) {
        if (events > 0 && (events & TICK_DUE) != 0) {
            (void)vehicle_load(run->own.calibration, run->own.calibrations, &run->vehicle_sim);
            frames_vehicle(&run->hub.end[1], &run->vehicle_sim);
        }
        return events;
    }
    if (!run->silent && tick_now_us() - run->last_tick_us > LINK_SILENCE_US) {
        report_error_line("node: no tick frame on %s: waiting", run->options->bus);
        run->silent = true;
    }
    return events;
}

static int loop(run_t *run)
{
    int status = 0, events = 0;
    bool own_clock = run->options->clock_own;
    run->last_tick_us = tick_now_us();
    while (status == 0 && (events & TICK_STOP) == 0 &&
           run->linger < run->options->vehicle->linger_ticks) {
        events = wait(run);
        status = events < 0 ? EXIT_REFUSED : send_zeros(run);
        status = status == 0 ? receive(run) : status;
        if (status == 0 && !own_clock && is_late(run, run->last_tick_us)) {
            status = halt(run, AUVID_GUARD_TICK, "no tick comes");
        }
        if (status == 0 && own_clock && (events & TICK_DUE) != 0) {
            const tick_t *tick = &run->link.tick;
            uint64_t t_us = tick->start_us + tick->ticks * tick->period_us;
            run->own.node.counters.ticks_missed = (uint32_t)tick->missed;
            status = serve(run, &t_us);
        }
    }
    return status;
}

static void print_counters(const run_t *run)
{
    const auvid_node_counters_t *c = &run->own.node.counters;
    const bus_statistics_t *s = &run->link.bus->statistics;
    unsigned long long lost = s->send_busy + s->send_failed + s->dropped;
    printf("  bus   %s: %llu frames received, %llu sent, %llu lost; %u ticks, %u missed;\n"
           "        refused: %u frames, %u samples; clock set %u times; %u foreign commands\n"
           "        link down %llu times, bus off %llu times, wall clock set %llu times\n",
           run->options->bus, (unsigned long long)s->received, (unsigned long long)s->sent, lost,
           (unsigned)c->ticks, (unsigned)c->ticks_missed, (unsigned)c->refused,
           (unsigned)c->samples_dropped, (unsigned)c->clock_steps, (unsigned)c->foreign_commands,
           (unsigned long long)s->link_downs, (unsigned long long)s->bus_offs,
           (unsigned long long)s->clock_steps);
}

/* The execution time that a fraction `part` of the ticks did not exceed [us]. */
static unsigned quantile(const run_t *run, double part)
{
    double below = part * run->own.node.counters.ticks;
    unsigned us = 0;
    for (double sum = run->histogram[0]; sum < below && us < MAX_US; sum += run->histogram[us]) {
        ++us;
    }
    return us;
}

static void print_ticks(const run_t *run)
{
    printf("  tick  step and work: p50 %u, p99 %u, max %u us", quantile(run, 0.5),
           quantile(run, 0.99), quantile(run, 1.0));
    if (run->link.ticking) {
        const tick_t *tick = &run->link.tick;
        printf("; of %llu ticks in %.0f s, missed %llu", (unsigned long long)tick->ticks,
               1e-6 * (double)(tick->ticks * tick->period_us), (unsigned long long)tick->missed);
    }
    putchar('\n');
}

/* The first line of a run that has identified nothing: why. */
static void print_nothing(const run_t *run, const result_t *result)
{
    const auvid_metric_t *m = &run->own.node.id.metric;
    const auvid_actuation_t *acts = run->own.node.id.actuation;
    bool complete = m->sets.recorded > 0;
    if (!run->options->excite || acts == NULL) {
        printf("nothing identified: %s\n\n",
               complete || m->rows.set.rows == 0
                   ? "no thrust varied: use --excite, or drive the vehicle"
                   : "the run ended before the first set was complete");
    } else if (acts->guard.excite_us == 0) {
        bool refused = acts->guard.refused.cause != AUVID_GUARD_NO_CAUSE;
        printf("nothing identified: the excitation did not begin%s%s\n\n", refused ? ": " : "",
               refused ? auvid_guard_cause_str((auvid_guard_cause_t)acts->guard.refused.cause)
                       : "");
    } else if (result->guard == AUVID_GUARD_ABORTED) {
        printf("nothing identified: the excitation ended after %.1f s, before %s: %s\n\n",
               1e-6 * (double)(result->trip.t_us - acts->guard.excite_us),
               complete ? "enough was recorded" : "the first set was complete",
               auvid_guard_cause_str((auvid_guard_cause_t)result->trip.cause));
    } else {
        printf("nothing identified: %s\n\n",
               complete ? "no input varied enough"
                        : "the run ended before the first set was complete");
    }
}

static int finish(run_t *run)
{
    static result_t result;
    report_gather(&result, &run->own.node.id, run->options->seed);
    result.has_guard = run->options->excite;
    if (run->simulated) {
        report_add_truth(&result, &run->vehicle_sim);
    }
    bus_identifier_calibrate(&run->own, &result);
    if (run->options->json) {
        report_json(stdout, &result, NULL, NULL, NULL);
    } else {
        printf("auvid %s node on %s, %s\n\n", AUVID_VERSION_STRING, run->options->bus,
               run->options->excite ? "exciting" : "passive");
        if (result.estimate.number == 0 || result.estimate.excited == 0) {
            print_nothing(run, &result);
        }
        report_result(&result, NULL);
        bus_identifier_print_missing(&run->own);
        print_counters(run);
        print_ticks(run);
    }
    if (run->has_prior) {
        prior_file_judge(&run->prior, run->options->prior);
    }
    return report_exit(&result);
}

/* Ends the thrust before the program ends; if the bus is busy, within END_MS. */
static int end_thrust(run_t *run)
{
    static const struct timespec ms = {.tv_nsec = 1000000};
    int status = halt(run, AUVID_GUARD_OPERATOR, NULL);
    for (int k = 0; k < END_MS && run->zeros > 0; ++k) {
        (void)nanosleep(&ms, NULL);
        status = send_zeros(run);
    }
    return run->zeros > 0 ? report_error("node: the command of zero could not be sent: %s",
                                         run->link.bus->text)
                          : status;
}

int bus_node(const options_t *options)
{
    run_t *run = calloc(1, sizeof *run);
    if (run == NULL) {
        return report_error("node: not enough memory");
    }
    run->options = options;
    run->simulated = strcmp(options->bus, "memory") == 0;
    int status = options->save != NULL ? prior_file_check(options->save) : 0;
    status = status == 0 ? begin(run) : status;
    if (status == 0) {
        const char *name = run->simulated ? "memory" : options->bus;
        status = options->log != NULL ? link_log(&run->link, options->log, name) : 0;
        status = status == 0 ? loop(run) : status;
        int ended = end_thrust(run);
        bool reports = status == 0 || (run->link.log_failed &&
                                       auvid_identifier_estimate(&run->own.node.id) != NULL);
        status = status == 0 ? ended : status;
        int report = reports ? finish(run) : 0;
        if (reports && options->save != NULL &&
            !prior_file_write(&run->own.node.id, options->save)) {
            report = EXIT_REFUSED;
        }
        int closed = link_close(&run->link);
        status = status == 0 ? closed : status;
        status = status == 0 ? report : status;
    }
    free(run);
    return status;
}
