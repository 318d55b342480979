/*
 * The node: configuration and received frames.
 */
#include "auvid/node.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "auvid_node_step_internal.h"

/* If the clock of the tick advances by more than this [us], it was set. Time then advances by this
 * much only, and the record has a gap. */
#define CLOCK_STEP_US 1000000u

/* A tick numbered less than this behind the last one is late, or a copy. */
#define LATE_TICKS 16u

void auvid_node_defaults(auvid_node_config_t *cfg)
{
    if (cfg != NULL) {
        memset(cfg, 0, sizeof *cfg);
        auvid_can_ids_defaults(&cfg->ids);
    }
}

static auvid_status_t node_init_frames(auvid_node_t *node, const auvid_node_config_t *cfg)
{
    auvid_status_t status = auvid_can_sender_init(&node->sender, &cfg->ids);
    for (int i = 0; i < AUVID_NODE_KINDS && status >= 0; ++i) {
        status = auvid_can_receiver_init(&node->receiver[i], (auvid_can_kind_t)i, 0, &cfg->ids);
    }
    return status;
}

/* Check the number of thrusters, and prepare the frames. */
static auvid_status_t node_check(auvid_node_t *node, const auvid_node_config_t *cfg, int thrusters,
                                 auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        WHOLE_IN(auvid_can_ids_t, fast, 1, 0, 0x800 - AUVID_CAN_FAST_KINDS),
        WHOLE_IN(auvid_can_ids_t, slow, 1, 0, 0x800 - AUVID_CAN_SLOW_KINDS),
    };
    auvid_status_t status = AUVID_OK;
    if (thrusters < 1 || thrusters > AUVID_CAN_THRUSTERS) {
        status = auvid_refuse(why, AUVID_ERR_SIZE, "thrusters", (auvid_real_t)thrusters,
                              (auvid_real_t)(thrusters < 1 ? 1 : AUVID_CAN_THRUSTERS));
        return auvid_refuse_part(why, status, "allocation");
    }
    status = auvid_check_fields(&cfg->ids, fields, sizeof fields / sizeof fields[0], why);
    if (status >= 0) {
        status = node_init_frames(node, cfg);
        if (status < 0) { /* they overlap */
            (void)auvid_refuse(why, status, "slow", (auvid_real_t)cfg->ids.slow,
                               (auvid_real_t)(cfg->ids.fast + AUVID_CAN_FAST_KINDS));
        }
    }
    return auvid_refuse_part(why, status, "ids");
}

auvid_status_t auvid_node_init(auvid_node_t *node, const auvid_node_config_t *cfg,
                               const auvid_identifier_config_t *identifier)
{
    if (node == NULL || cfg == NULL || identifier == NULL) {
        return AUVID_ERR_NULL;
    }
    int thrusters = identifier->allocation.thrusters;
    auvid_refusal_t why = {0};
    /* all but the identifier, which may contain its configuration */
    memset((unsigned char *)node + sizeof node->id, 0, sizeof *node - sizeof node->id);
    auvid_status_t status = node_check(node, cfg, thrusters, &why);
    if (status >= 0) {
        status = auvid_identifier_init(&node->id, identifier);
        why = status < 0 ? node->id.refusal : why;
    }
    if (status < 0) {
        memset(node, 0, sizeof *node);
        node->id.refusal = why;
        return status;
    }
    node->cfg = *cfg;
    node->ready = true;
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

static void node_take_dvl(auvid_node_t *node, const auvid_can_message_t *m)
{
    bool bottom = m->kind == AUVID_CAN_DVL_BOTTOM;
    const auvid_can_dvl_bottom_t *b = &m->as.dvl_bottom; /* dvl_water is laid out alike */
    auvid_dvl_sample_t *sample = bottom ? &node->in.dvl.sample : &node->in.dvl_water.sample;
    if (!node_has_age(node, b->age)) {
        return;
    }
    *(bottom ? &node->in.dvl.present : &node->in.dvl_water.present) = true;
    sample->t_us = node_age_us(b->age);
    sample->velocity[0] = b->u;
    sample->velocity[1] = b->v;
    sample->velocity[2] = b->w;
    sample->lock = bottom ? AUVID_DVL_BOTTOM : AUVID_DVL_WATER;
    /* AUVID_DVL_X, _Y, _Z in the order of the signals */
    sample->valid = (uint8_t)(~m->absent & 7u);
}

static void node_take_imu(auvid_node_t *node, const auvid_can_message_t *m)
{
    bool attitude = m->kind == AUVID_CAN_IMU_ATTITUDE;
    uint32_t age = attitude ? m->as.imu_attitude.age : m->as.imu_rates.age;
    if ((m->absent & 7u) != 0 || !node_has_age(node, age)) {
        return;
    }
    if (attitude) {
        const auvid_can_imu_attitude_t *a = &m->as.imu_attitude;
        node->in.imu.attitude[0] = a->phi;
        node->in.imu.attitude[1] = a->theta;
        node->in.imu.attitude[2] = a->psi;
        node->attitude_us = node_age_us(age);
        node->attitude = node->new_attitude = true;
    } else {
        const auvid_can_imu_rates_t *r = &m->as.imu_rates;
        node->in.imu.rates[0] = r->p;
        node->in.imu.rates[1] = r->q;
        node->in.imu.rates[2] = r->r;
        node->rates_us = node_age_us(age);
        node->rates = node->new_rates = true;
    }
}

static void node_take_scalar(auvid_node_t *node, const auvid_can_message_t *m)
{
    if (m->kind == AUVID_CAN_DEPTH && m->absent == 0 && node_has_age(node, m->as.depth.age)) {
        node->in.depth.present = true;
        node->in.depth.t_us = node_age_us(m->as.depth.age);
        node->in.depth.depth_m = m->as.depth.depth;
    } else if (m->kind == AUVID_CAN_GPS && m->absent == 0 && node_has_age(node, m->as.gps.age)) {
        node->in.gps.present = true;
        node->in.gps.t_us = node_age_us(m->as.gps.age);
        node->in.gps.x_m = m->as.gps.x;
        node->in.gps.y_m = m->as.gps.y;
    } else if (m->kind == AUVID_CAN_DVL_ALTITUDE && m->absent == 0 &&
               node_has_age(node, m->as.dvl_altitude.age)) {
        node->in.altitude.present = true;
        node->in.altitude.t_us = node_age_us(m->as.dvl_altitude.age);
        node->in.altitude.altitude_m = m->as.dvl_altitude.altitude;
    }
}

static void node_take_feedback(auvid_node_t *node, const auvid_can_message_t *m)
{
    bool first = m->kind == AUVID_CAN_THRUSTER_FEEDBACK_A;
    const auvid_real_t *thrust =
        first ? m->as.thruster_feedback_a.thrust : m->as.thruster_feedback_b.thrust;
    for (int i = 0; i < 4; ++i) {
        bool absent = (m->absent >> i & 1u) != 0;
        node->thrust[(first ? 0 : 4) + i] = absent ? AUVID_C(0.0) : thrust[i];
    }
    node->feedback = true;
}

/* Time of the tick: the time on the bus less the clock steps. A bus that reorders and duplicates
 * frames may deliver a tick twice, and the counter may accept it. Such a tick is no clock step. */
static auvid_status_t node_take_tick(auvid_node_t *node, const auvid_can_tick_t *tick)
{
    uint32_t behind = (node->sequence - tick->sequence) & 0xFFFFFu;
    if (node->started && behind < LATE_TICKS) {
        ++node->counters.refused;
        return AUVID_ERR_CHECKSUM;
    }
    uint64_t bus_us = node->started ? auvid_can_extend_us(node->bus_us, tick->time) : tick->time;
    uint32_t passed = (tick->sequence - node->sequence) & 0xFFFFFu;
    bool set = bus_us <= node->bus_us || bus_us - node->bus_us > CLOCK_STEP_US;
    if (!node->started) {
        node->tick_us = tick->time;
    } else if (set) {
        ++node->counters.clock_steps;
        node->tick_us += CLOCK_STEP_US;
    } else {
        node->tick_us += bus_us - node->bus_us;
        node->counters.ticks_missed += passed - 1u; /* passed >= 1: see `behind` */
    }
    node->bus_us = bus_us;
    node->sequence = tick->sequence;
    node->started = true;
    return AUVID_TICK;
}

/* Is the frame one of the last four commands of this node? */
static bool node_is_echo(const auvid_node_t *node, auvid_can_kind_t kind,
                         const auvid_can_frame_t *frame)
{
    bool second = kind == AUVID_CAN_THRUSTER_COMMAND_B;
    uint64_t data;
    memcpy(&data, frame->data, sizeof data);
    return (second || kind == AUVID_CAN_THRUSTER_COMMAND_A) &&
           data == node->sent[second][frame->data[1] & 3u];
}

/* Another node commands the thrusters. */
static void node_take_foreign_command(auvid_node_t *node)
{
    auvid_guard_t *guard = &node->id.guard;
    ++node->counters.foreign_commands;
    if (guard->state == AUVID_GUARD_ARMED || guard->state == AUVID_GUARD_EXCITING) {
        (void)auvid_guard_abort_for(guard, node->id.t_us, AUVID_GUARD_FOREIGN_COMMAND);
        node->id.events |= AUVID_EVENT_ABORTED;
    }
}

/* Is this message obeyed? A message that takes thrust away is obeyed with any counter. */
static bool node_obeys(auvid_can_state_t state, const auvid_can_message_t *m)
{
    _Static_assert(AUVID_NODE_KINDS <= 32, "a bit of `kinds` for each message");
    const uint32_t kinds = 1u << AUVID_CAN_ABORT | 1u << AUVID_CAN_THRUSTER_COMMAND_A |
                           1u << AUVID_CAN_THRUSTER_COMMAND_B;
    bool disarms = m->kind == AUVID_CAN_ARM && m->as.arm.action != AUVID_CAN_ACTION_ARM;
    return state == AUVID_CAN_GOOD || (kinds >> m->kind & 1u) != 0 || disarms;
}

static auvid_status_t node_take_message(auvid_node_t *node, const auvid_can_message_t *m,
                                        bool fresh)
{
    switch ((int)m->kind) {
    case AUVID_CAN_ABORT: /* a pending arm frame then finds the guard ABORTED */
        (void)auvid_identifier_abort(&node->id);
        break;
    case AUVID_CAN_ARM:
        auvid_node_order(node, m->as.arm.action, fresh);
        break;
    case AUVID_CAN_THRUSTER_COMMAND_A:
    case AUVID_CAN_THRUSTER_COMMAND_B:
        node_take_foreign_command(node);
        break;
    case AUVID_CAN_TICK:
        return node_take_tick(node, &m->as.tick);
    case AUVID_CAN_IMU_ATTITUDE:
    case AUVID_CAN_IMU_RATES:
        node_take_imu(node, m);
        break;
    case AUVID_CAN_DVL_BOTTOM:
    case AUVID_CAN_DVL_WATER:
        node_take_dvl(node, m);
        break;
    case AUVID_CAN_THRUSTER_FEEDBACK_A:
    case AUVID_CAN_THRUSTER_FEEDBACK_B:
        node_take_feedback(node, m);
        break;
    default:
        node_take_scalar(node, m);
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
    if ((unsigned)kind >= AUVID_NODE_KINDS || kind == AUVID_CAN_TICK_DONE ||
        node_is_echo(node, kind, frame)) {
        return AUVID_UNUSED;
    }
    auvid_can_frame_t at_tick = *frame;
    auvid_can_message_t message;
    at_tick.t_us = node->t_us; /* nothing depends on the time of arrival */
    auvid_can_state_t state = auvid_can_receiver_take(&node->receiver[kind], &at_tick, &message);
    if (state == AUVID_CAN_BAD || !node_obeys(state, &message)) {
        ++node->counters.refused;
        return AUVID_ERR_CHECKSUM;
    }
    auvid_status_t status = node_take_message(node, &message, state == AUVID_CAN_GOOD);
    node->counters.frames += status >= 0;
    return status;
}
