/*
 * The node: the tick.
 */
#include <stddef.h>
#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../identifier/auvid_input_internal.h"
#include "auvid_node_step_internal.h"

/* Maximum time between the two halves of one IMU sample [us]. */
#define MAX_IMU_SKEW_US 30000u

void auvid_node_send(auvid_node_t *node, const auvid_can_message_t *message,
                     auvid_can_frame_t *frame, int *count)
{
    const uint8_t *data = frame[*count].data;
    if (*count < AUVID_NODE_FRAMES && auvid_can_pack(&node->sender, message, &frame[*count]) >= 0) {
        unsigned half = (unsigned)message->kind - AUVID_CAN_THRUSTER_COMMAND_A;
        if (half < 2u) {
            memcpy(&node->sent[half][data[1] & 3u], data, AUVID_CAN_BYTES);
        }
        ++*count;
    }
}

void auvid_node_abort(auvid_node_t *node, auvid_guard_cause_t cause)
{
    auvid_guard_t *guard = &node->id.actuation->guard;
    node->id.events |= guard->state == AUVID_GUARD_ABORTED ? 0u : AUVID_EVENT_ABORTED;
    (void)auvid_guard_abort_for(guard, node->id.t_us, cause);
    (void)auvid_guard_abort(guard, node->id.t_us); /* whatever the cause */
}

/* Aborts the excitation and cancels a pending arm frame. DISARMED and DONE remain: they have
 * no thrust. */
static void node_abort_thrust(auvid_node_t *node, auvid_guard_cause_t cause)
{
    auvid_guard_state_t state = auvid_node_guard_state(node);
    node->arming = false;
    if (state != AUVID_GUARD_DISARMED && state != AUVID_GUARD_DONE) {
        auvid_node_abort(node, cause);
    }
}

void auvid_node_order(auvid_node_t *node, uint32_t action, bool fresh)
{
    node->arming = action == AUVID_CAN_ACTION_ARM && node->arm != NULL;
    if (action == AUVID_CAN_ACTION_STOP) {
        (void)auvid_identifier_stop(&node->id);
    } else if (action == AUVID_CAN_ACTION_DISARM && fresh) {
        (void)auvid_identifier_disarm(&node->id);
    } else if (action == AUVID_CAN_ACTION_DISARM) {
        node_abort_thrust(node, AUVID_GUARD_OPERATOR);
    }
}

/* Tries a pending arm frame once, with the present state of the sensors. The guard and the progress
 * frame give the cause of a refusal. */
static void node_arm(auvid_node_t *node)
{
    if (node->arming && node->arm(&node->id) >= 0) {
        (void)auvid_identifier_excite(&node->id);
    }
    node->arming = false;
}

/* ---- ages of samples to times ---- */

static void node_age_to_time(uint64_t *t_us, uint64_t tick_us)
{
    *t_us = tick_us > *t_us ? tick_us - *t_us : 0;
}

/* Forms a sample of the IMU from its halves, which may arrive in different ticks. */
static void node_complete_imu(auvid_node_t *node)
{
    uint64_t a = node->imu.attitude_us, r = node->imu.rates_us;
    node->in.imu.present = false;
    if (!node->imu.attitude || !node->imu.rates) {
        return;
    }
    if ((a > r ? a - r : r - a) > MAX_IMU_SKEW_US) {
        node->imu.attitude = a > r; /* keep the later half and wait for its other half */
        node->imu.rates = !node->imu.attitude;
        return;
    }
    node->in.imu.present = true;
    node->in.imu.t_us = a > r ? a : r;
    node->imu.attitude = node->imu.rates = false;
}

static void node_set_sample_times(auvid_node_t *node, uint64_t tick_us)
{
    auvid_input_t *in = &node->in;
    in->t_us = tick_us;
    for (int i = 0; i < AUVID_INPUT_SAMPLES; ++i) {
        if (auvid_input_has(in, i)) {
            size_t at = auvid_input_places[i].at + offsetof(auvid_input_sample_t, t_us);
            node_age_to_time((void *)((unsigned char *)in + at), tick_us);
        }
    }
    if (node->imu.new_attitude) {
        node_age_to_time(&node->imu.attitude_us, tick_us);
    }
    if (node->imu.new_rates) {
        node_age_to_time(&node->imu.rates_us, tick_us);
    }
    node->imu.new_attitude = node->imu.new_rates = false;
    node_complete_imu(node);
}

/* Records the thrust feedback, which acted since the previous tick. The wrench is computed in the
 * input to save stack in this deep call. It is not marked present there, so the step ignores it. */
static AUVID_NOINLINE void node_record_thrust(auvid_node_t *node)
{
    const auvid_allocation_config_t *cfg = &node->allocation.cfg;
    auvid_real_t force_N[AUVID_MAX_THRUSTERS];
    auvid_real_t *wrench = node->in.applied.wrench, *command = node->in.applied.command;
    if (!auvid_node_has_feedback(node)) {
        return;
    }
    node->feedback = 0;
    if (node->counters.ticks == 0) { /* the previous tick is not known */
        return;
    }
    auvid_clear(force_N, AUVID_MAX_THRUSTERS);
    for (int i = 0; i < cfg->thrusters; ++i) {
        auvid_real_t part = node->thrust[i];
        const auvid_thruster_t *t = &cfg->thruster[i];
        force_N[i] = part > AUVID_C(0.0) ? part * t->max_N : -part * t->min_N;
        if (i < AUVID_MAX_COMMANDS) {
            command[i] = part;
        }
    }
    (void)auvid_allocation_wrench(&node->allocation, force_N, wrench);
    if (auvid_identifier_applied(&node->id, node->t_us, wrench, command) < 0) {
        ++node->counters.samples_dropped;
    }
}

/* ---- thruster commands ---- */

/* Returns the force of thruster i as a fraction of its maximum; 0: there is none. */
static auvid_real_t node_command_part(const auvid_allocation_config_t *cfg,
                                      const auvid_real_t *force_N, int i)
{
    if (i >= cfg->thrusters || force_N == NULL) {
        return AUVID_C(0.0);
    }
    auvid_real_t max_N =
        force_N[i] > AUVID_C(0.0) ? cfg->thruster[i].max_N : -cfg->thruster[i].min_N;
    return max_N > AUVID_C(0.0) ? force_N[i] / max_N : AUVID_C(0.0);
}

/* Sends the forces as fractions of the maximum force of each thruster; NULL: zero. */
static void node_send_command(auvid_node_t *node, const auvid_real_t *force_N,
                              auvid_can_frame_t *frame, int *count)
{
    const auvid_allocation_config_t *cfg = &node->allocation.cfg;
    for (int first = 0; first < cfg->thrusters; first += 4) {
        auvid_can_message_t m;
        m.kind = first == 0 ? AUVID_CAN_THRUSTER_COMMAND_A : AUVID_CAN_THRUSTER_COMMAND_B;
        m.absent = 0;
        for (int i = 0; i < 4; ++i) { /* both have the same signals */
            m.as.thruster_command_a.thrust[i] = node_command_part(cfg, force_N, first + i);
        }
        auvid_node_send(node, &m, frame, count);
    }
}

/* Sends the excitation while exciting, zero in the first tick after it, and then nothing. */
static void node_command_thrusters(auvid_node_t *node, const auvid_output_t *out,
                                   auvid_can_frame_t *frame, int *count)
{
    bool exciting = out->guard == AUVID_GUARD_EXCITING && node->arm != NULL;
    if (exciting || node->commanding) {
        node_send_command(node, exciting ? out->thruster_N : NULL, frame, count);
    }
    node->commanding = exciting;
}

static void node_open_tick(auvid_node_t *node, uint64_t t_us, auvid_can_frame_t *frame, int *count)
{
    auvid_can_message_t tick = {.kind = AUVID_CAN_TICK};
    node->sequence = (node->sequence + 1u) & 0xFFFFFu;
    tick.as.tick.sequence = node->sequence;
    tick.as.tick.time = (uint32_t)t_us;
    auvid_node_send(node, &tick, frame, count);
    node->tick_us = t_us;
    node->started = true;
}

static void node_count_drops(auvid_node_t *node, uint32_t events)
{
    uint32_t dropped = AUVID_EVENT_IMU_DROPPED | AUVID_EVENT_INPUT_DROPPED;
    for (int i = 0; events != 0 && i < AUVID_INPUT_SAMPLES; ++i) {
        dropped |= auvid_input_places[i].event;
    }
    node->counters.samples_dropped += auvid_count_bits(dropped & events);
}

/* Returns how many samples wait for the tick. */
static uint32_t node_count_samples(const auvid_input_t *in)
{
    uint32_t count = in->imu.present;
    for (int i = 0; i < AUVID_INPUT_SAMPLES; ++i) {
        count += auvid_input_has(in, i);
    }
    return count;
}

/* Clears all samples but the IMU's: a half of it may be pending. */
static void node_clear_samples(auvid_input_t *in)
{
    const size_t after = offsetof(auvid_input_t, imu) + sizeof in->imu;
    auvid_zero(in, offsetof(auvid_input_t, imu));
    auvid_zero((unsigned char *)in + after, sizeof *in - after);
}

auvid_status_t auvid_node_step(auvid_node_t *node, const uint64_t *t_us, auvid_can_frame_t *frame,
                               int *count)
{
    if (count != NULL) {
        *count = 0;
    }
    if (node == NULL || frame == NULL || count == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!node->ready || (t_us == NULL && !node->started)) {
        return AUVID_ERR_STATE;
    }
    auvid_output_t out;
    uint64_t tick_us = t_us != NULL ? *t_us : node->tick_us;
    if (!node->id.started ||
        tick_us > node->id.t_us) { /* otherwise auvid_identifier_step refuses the tick */
        if (t_us != NULL) {
            node_open_tick(node, tick_us, frame, count);
        }
        node_record_thrust(node);
        node_arm(node);
    }
    node_set_sample_times(node, tick_us);
    auvid_status_t status = auvid_identifier_step(&node->id, &node->in, &out);
    node_command_thrusters(node, &out, frame, count);
    node_count_drops(node, out.events);
    node->events = out.events;
    if (status >= 0) {
        node->t_us = tick_us;
        node->first_us = node->counters.ticks > 0 ? node->first_us : tick_us;
        ++node->counters.ticks;
    } else {
        node->counters.samples_dropped += node_count_samples(&node->in);
    }
    node_clear_samples(&node->in);
    return status;
}

auvid_status_t auvid_node_work(auvid_node_t *node, uint32_t budget)
{
    if (node == NULL) {
        return AUVID_ERR_NULL;
    }
    return auvid_identifier_work(&node->id, budget);
}

auvid_status_t auvid_node_halt(auvid_node_t *node, auvid_guard_cause_t cause,
                               auvid_can_frame_t *frame, int *count)
{
    if (count != NULL) {
        *count = 0;
    }
    if (node == NULL || frame == NULL || count == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!node->ready) {
        return AUVID_ERR_STATE;
    }
    node_abort_thrust(node, cause);
    if (node->commanding) {
        node_send_command(node, NULL, frame, count);
        node->commanding = false;
    }
    return AUVID_OK;
}
