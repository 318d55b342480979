/*
 * The node: configuration and received frames.
 */
#include "auvid/node.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../excitation/auvid_excitation_init_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "../identifier/auvid_input_internal.h"
#include "../navigation/auvid_sensors_internal.h"
#include "auvid_can_follow_internal.h"
#include "auvid_node_step_internal.h"

/* If the clock of the tick advances by more than this [us], it was set. Time then advances by this
 * much only, and the record has a gap. */
#define CLOCK_STEP_US 1000000u
/* Ticks are at least so far apart [us]. The 32 bits of their time wrap in 71 min: only the sequence
 * shows that so many were missed. */
#define LEAST_TICK_US 1000u

/* A tick numbered less than this behind the last one is late, or a copy. */
#define LATE_TICKS 16u

void auvid_node_defaults(auvid_node_config_t *cfg)
{
    if (cfg != NULL) {
        memset(cfg, 0, sizeof *cfg);
        auvid_can_ids_defaults(&cfg->ids);
    }
}

/* Check the number of thrusters, and prepare the frames. */
static void node_check(auvid_node_t *node, const auvid_node_config_t *cfg, int thrusters,
                       auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        WHOLE_IN(auvid_can_ids_t, fast, 1, 0, 0x800 - AUVID_CAN_FAST_KINDS),
        WHOLE_IN(auvid_can_ids_t, slow, 1, 0, 0x800 - AUVID_CAN_SLOW_KINDS),
    };
    auvid_check_part(why, "allocation");
    auvid_check_count(why, AUVID_ERR_SIZE, "thrusters", (uint32_t)thrusters, AUVID_CAN_THRUSTERS);
    auvid_check_part(why, "ids");
    AUVID_CHECK_TABLE(why, &cfg->ids, fields);
    if (why->status == AUVID_OK) { /* refused if the blocks overlap */
        auvid_status_t status = auvid_can_sender_init(&node->sender, &cfg->ids);
        auvid_check_limit(why, status >= 0, status, "slow", (auvid_real_t)cfg->ids.slow,
                          (auvid_real_t)(cfg->ids.fast + AUVID_CAN_FAST_KINDS));
    }
}

auvid_status_t auvid_node_init(auvid_node_t *node, const auvid_node_config_t *cfg,
                               const auvid_allocation_config_t *allocation,
                               const auvid_identifier_config_t *identifier)
{
    if (node == NULL || cfg == NULL || allocation == NULL || identifier == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_refusal_t why;
    const auvid_node_config_t own = *cfg;        /* it may be that of *node */
    memset(node, 0, offsetof(auvid_node_t, id)); /* its configuration may be in node->id */
    auvid_check_begin(&why);
    node_check(node, &own, allocation->thrusters, &why);
    if (why.status == AUVID_OK && auvid_identifier_init(&node->id, identifier) < 0) {
        why = node->id.refusal;
    }
    if (why.status == AUVID_OK) {
        auvid_allocation_set_up(&node->allocation, allocation, &why);
    }
    if (why.status < 0) {
        memset(node, 0, sizeof *node);
        node->id.refusal = why;
        return why.status;
    }
    auvid_identifier_set_scale(&node->id, &node->allocation);
    node->cfg = own;
    node->ready = true;
    return AUVID_OK;
}

auvid_status_t auvid_node_attach_actuation(auvid_node_t *node, auvid_actuation_t *storage,
                                           const auvid_actuation_config_t *cfg)
{
    if (node == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status =
        auvid_identifier_attach_actuation(&node->id, storage, cfg, &node->allocation);
    if (status == AUVID_OK) {
        node->arm = auvid_identifier_arm;
    }
    return status;
}

/* ---- received frames ---- */

/* Is the age of the sample known? Counts those without. */
static AUVID_NOINLINE bool node_has_age(auvid_node_t *node, uint32_t age_ms)
{
    bool known = age_ms != AUVID_CAN_AGE_UNKNOWN;
    node->counters.unknown_age += !known;
    return known;
}

/* Until the step, the time of a sample holds its age: the time of the tick is not known yet. */
static uint64_t node_age_us(uint32_t age_ms)
{
    return (uint64_t)age_ms * 1000u;
}

/* The message of each sample of auvid_input_t. */
#define NODE_SAMPLE(name, ...) [AUVID_NAV_##name] = AUVID_CAN_NODE_##name,
static const uint8_t node_samples[AUVID_INPUT_SAMPLES] = {
    [AUVID_INPUT_ALTITUDE] = AUVID_CAN_NODE_DVL_ALTITUDE, AUVID_SENSORS(NODE_SAMPLE)};
#define NODE_VALUES(name, input, event, kind, axis, axes, ...)                                     \
    _Static_assert(AUVID_CAN_##name##_VALUES == axes, "values of message " #name);
AUVID_SENSORS(NODE_VALUES)
_Static_assert(AUVID_CAN_IMU_ATTITUDE_VALUES == 3 && AUVID_CAN_IMU_RATES_VALUES == 3, "values");

static void node_take_sample(auvid_node_t *node, const auvid_can_message_t *m)
{
    auvid_can_node_kind_t received = auvid_can_node_kind(m->kind);
    auvid_input_sample_t sample;
    uint32_t age_ms;
    int i = 0;
    while (i < AUVID_INPUT_ALTITUDE && node_samples[i] != received) {
        ++i;
    }
    bool bottom = i == AUVID_NAV_DVL_BOTTOM, dvl = bottom || i == AUVID_NAV_DVL_WATER;
    size_t bytes = auvid_input_places[i].values * sizeof(auvid_real_t);
    memcpy(sample.value, &m->as, bytes);
    memcpy(&age_ms, (const unsigned char *)&m->as + bytes, sizeof age_ms);
    if ((m->absent != 0 && !dvl) || !node_has_age(node, age_ms)) {
        return;
    }
    sample.present = true;
    sample.t_us = node_age_us(age_ms);
    auvid_input_set(&node->in, i, &sample);
    if (dvl) {
        auvid_dvl_sample_t *s = bottom ? &node->in.dvl.sample : &node->in.dvl_water.sample;
        s->lock = bottom ? AUVID_DVL_BOTTOM : AUVID_DVL_WATER;
        /* AUVID_DVL_X, _Y, _Z in the order of the signals */
        s->valid = (uint8_t)(~m->absent & 7u);
    }
}

static void node_take_imu(auvid_node_t *node, const auvid_can_message_t *m)
{
    bool attitude = m->kind == AUVID_CAN_IMU_ATTITUDE;
    uint32_t age = attitude ? m->as.imu_attitude.age : m->as.imu_rates.age;
    if ((m->absent & 7u) != 0 || !node_has_age(node, age)) {
        return;
    }
    if (attitude) {
        memcpy(node->in.imu.attitude, &m->as, sizeof node->in.imu.attitude);
        node->imu.attitude_us = node_age_us(age);
        node->imu.attitude = node->imu.new_attitude = true;
    } else {
        memcpy(node->in.imu.rates, &m->as, sizeof node->in.imu.rates);
        node->imu.rates_us = node_age_us(age);
        node->imu.rates = node->imu.new_rates = true;
    }
}

/* Without the thrust of one thruster the wrench is not known: the half is dropped. */
static void node_take_feedback(auvid_node_t *node, const auvid_can_message_t *m)
{
    bool first = m->kind == AUVID_CAN_THRUSTER_FEEDBACK_A;
    int at = first ? 0 : 4, thrusters = node->allocation.cfg.thrusters - at;
    const auvid_real_t *thrust =
        first ? m->as.thruster_feedback_a.thrust : m->as.thruster_feedback_b.thrust;
    if (thrusters <= 0) {
        return;
    }
    uint32_t half = first ? 1u : 2u, used = thrusters < 4 ? (1u << thrusters) - 1u : 15u;
    bool lonely = (node->feedback & half) != 0 && !auvid_node_has_feedback(node);
    bool unknown = (m->absent & used) != 0;
    node->counters.samples_dropped += (uint32_t)lonely + (uint32_t)unknown;
    node->feedback = (uint8_t)(unknown ? node->feedback & ~half : node->feedback | half);
    for (int i = 0; i < 4 && !unknown; ++i) {
        node->thrust[at + i] = thrust[i];
    }
}

/* Take the time of the first tick. An identifier that was restored from a checkpoint goes on: the
 * restart may have taken minutes, but time does not go back. */
static void node_take_first_tick(auvid_node_t *node, uint32_t time)
{
    uint64_t last_us = node->id.t_us;
    node->bus_us = node->id.started ? auvid_can_extend_us(last_us, time) : time;
    node->tick_us = node->bus_us;
    if (node->id.started && node->bus_us <= last_us) {
        ++node->counters.clock_steps;
        node->tick_us = last_us + CLOCK_STEP_US;
    }
}

/* Time of the tick: the time on the bus less the clock steps. A bus that reorders and duplicates
 * frames may deliver a tick twice, and the counter may accept it. Such a tick is no clock step. */
static auvid_status_t node_take_tick(auvid_node_t *node, const auvid_can_tick_t *tick)
{
    uint32_t behind = (node->sequence - tick->sequence) & 0xFFFFFu;
    if (node->started && behind < LATE_TICKS) {
        ++node->counters.refused;
        return AUVID_ERR_STALE;
    }
    if (!node->started) {
        node_take_first_tick(node, tick->time);
    } else {
        uint64_t bus_us = auvid_can_extend_us(node->bus_us, tick->time);
        uint32_t passed = (tick->sequence - node->sequence) & 0xFFFFFu;
        if (bus_us <= node->bus_us || bus_us - node->bus_us > CLOCK_STEP_US ||
            passed > CLOCK_STEP_US / LEAST_TICK_US) {
            ++node->counters.clock_steps;
            node->tick_us += CLOCK_STEP_US;
        } else {
            node->tick_us += bus_us - node->bus_us;
            node->counters.ticks_missed += passed - 1u; /* passed >= 1: see `behind` */
        }
        node->bus_us = bus_us;
    }
    node->sequence = tick->sequence;
    node->started = true;
    return AUVID_TICK;
}

/* Is the frame one of the last four commands of this node? A frame of zeros is none: its checksum
 * is wrong. */
static bool node_is_echo(const auvid_node_t *node, auvid_can_kind_t kind,
                         const auvid_can_frame_t *frame)
{
    bool second = kind == AUVID_CAN_THRUSTER_COMMAND_B;
    uint64_t data;
    memcpy(&data, frame->data, sizeof data);
    return (second || kind == AUVID_CAN_THRUSTER_COMMAND_A) && data != 0 &&
           data == node->sent[second][frame->data[1] & 3u];
}

/* Another node commands the thrusters. */
static void node_take_foreign_command(auvid_node_t *node)
{
    auvid_guard_state_t state = auvid_node_guard_state(node);
    ++node->counters.foreign_commands;
    if (state == AUVID_GUARD_ARMED || state == AUVID_GUARD_EXCITING) {
        auvid_node_abort(node, AUVID_GUARD_FOREIGN_COMMAND);
    }
}

/* Is this message obeyed? A message that takes thrust away is obeyed with any counter. */
static bool node_obeys(auvid_status_t status, const auvid_can_message_t *m)
{
    if (status != AUVID_ERR_REPEATED && status != AUVID_ERR_COUNTER_JUMP) {
        return status == AUVID_OK; /* else not authentic: *m is not written */
    }
    bool command =
        m->kind == AUVID_CAN_THRUSTER_COMMAND_A || m->kind == AUVID_CAN_THRUSTER_COMMAND_B;
    bool disarms = m->kind == AUVID_CAN_ARM && m->as.arm.action != AUVID_CAN_ACTION_ARM;
    return m->kind == AUVID_CAN_ABORT || command || disarms;
}

#define NODE_CASE(name, ...) case AUVID_CAN_NODE_##name:

/* A message that the DBC gives to a node and that has no case here does not compile quietly. */
static auvid_status_t node_take_message(auvid_node_t *node, const auvid_can_message_t *m,
                                        bool fresh)
{
    switch (auvid_can_node_kind(m->kind)) {
    case AUVID_CAN_NODE_ABORT: /* a pending arm frame then finds the guard ABORTED */
        (void)auvid_identifier_abort(&node->id);
        break;
    case AUVID_CAN_NODE_ARM:
        auvid_node_order(node, m->as.arm.action, fresh);
        break;
    case AUVID_CAN_NODE_THRUSTER_COMMAND_A:
    case AUVID_CAN_NODE_THRUSTER_COMMAND_B:
        node_take_foreign_command(node);
        break;
    case AUVID_CAN_NODE_TICK:
        return node_take_tick(node, &m->as.tick);
    case AUVID_CAN_NODE_IMU_ATTITUDE:
    case AUVID_CAN_NODE_IMU_RATES:
        node_take_imu(node, m);
        break;
    case AUVID_CAN_NODE_THRUSTER_FEEDBACK_A:
    case AUVID_CAN_NODE_THRUSTER_FEEDBACK_B:
        node_take_feedback(node, m);
        break;
        AUVID_SENSORS(NODE_CASE)
    case AUVID_CAN_NODE_DVL_ALTITUDE:
        node_take_sample(node, m);
        break;
    case AUVID_CAN_NODE_KINDS:
        break;
    }
    return AUVID_OK;
}

auvid_status_t auvid_node_take(auvid_node_t *node, const auvid_can_frame_t *frame)
{
    if (node == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!node->ready) {
        return AUVID_ERR_STATE;
    }
    auvid_can_kind_t kind = auvid_can_kind(&node->cfg.ids, frame->id);
    auvid_can_node_kind_t received = auvid_can_node_kind(kind);
    if (received == AUVID_CAN_NODE_KINDS || node_is_echo(node, kind, frame)) {
        return AUVID_UNUSED;
    }
    auvid_node_received_t *of = &node->received[received];
    auvid_can_message_t message;
    auvid_status_t status = auvid_can_unpack(&node->cfg.ids, frame, &message);
    if (status == AUVID_OK) {
        status = auvid_can_follow(&of->counter, &of->started, message.counter, &of->lost);
    }
    of->good += status == AUVID_OK;
    of->refused += status < 0;
    if (!node_obeys(status, &message)) {
        ++node->counters.refused;
        return status;
    }
    status = node_take_message(node, &message, status == AUVID_OK);
    node->counters.frames += status >= 0;
    return status;
}
