/*
 * The node: periodic reports. Each message has its ticks in a cycle of 50 ticks, 1 s at 50 Hz.
 */
#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "auvid_node_step_internal.h"

/* What is reported has its values in the DBC, or fits the bits that the DBC gives it. */
_Static_assert(AUVID_NAV_FLAG_END - 1 <= 512, "nav_position.flags: 10 bits");
_Static_assert(AUVID_MAX_PARAMETERS <= 32, "estimate.index: 5 bits");
_Static_assert(AUVID_DOF_COUNT <= 6, "progress.excited: 6 bits");
_Static_assert((int)AUVID_NOTE_COUNT == AUVID_CAN_NOTE_INPUTS + 1, "estimate_sigma.note");
_Static_assert((int)AUVID_GUARD_STATE_COUNT == AUVID_CAN_GUARD_ABORTED + 1, "progress.guard");
_Static_assert((int)AUVID_GUARD_CAUSE_COUNT == AUVID_CAN_CAUSE_FOREIGN_COMMAND + 1, "abort.cause");
_Static_assert((int)AUVID_WORK_PHASE_COUNT == AUVID_CAN_WORK_CONFIDENCE + 1, "progress.work");

static uint32_t node_min(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void node_report_position(auvid_node_t *node, const auvid_nav_state_t *state,
                                 auvid_can_frame_t *frame, int *count)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_NAV_POSITION};
    m.as.nav_position.x = state->position[0];
    m.as.nav_position.y = state->position[1];
    m.as.nav_position.flags = state->flags & 1023u;
    auvid_node_send(node, &m, frame, count);
    m = (auvid_can_message_t){.kind = AUVID_CAN_NAV_DEPTH};
    m.as.nav_depth.z = state->position[2];
    auvid_node_send(node, &m, frame, count);
}

static void node_report_velocity(auvid_node_t *node, const auvid_nav_state_t *state,
                                 auvid_can_frame_t *frame, int *count)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_NAV_VELOCITY};
    m.as.nav_velocity.u = state->velocity[0];
    m.as.nav_velocity.v = state->velocity[1];
    m.as.nav_velocity.w = state->velocity[2];
    auvid_node_send(node, &m, frame, count);
}

/* Flags of parameter i: see the DBC. */
static uint32_t node_parameter_flags(const auvid_node_t *node, int i)
{
    const auvid_estimate_t *e = identifier_read_estimate(&node->id);
    auvid_dof_t dof = node->id.metric.cfg.vehicle->parameter[i].dof;
    return (e->identified >> i & 1u) | (uint32_t)(e->excited >> dof & 1) << 1 |
           (uint32_t)e->not_converged << 2 | (e->confidence.identifiable >> i & 1u) << 3 |
           (e->confidence.implausible >> i & 1u) << 4 | (uint32_t)e->accepted << 5;
}

/* Each call reports the next parameter; an unknown value is absent. */
static void node_report_estimate(auvid_node_t *node, auvid_can_frame_t *frame, int *count)
{
    const auvid_estimate_t *e = identifier_read_estimate(&node->id);
    int i = node->next.parameter;
    node->next.parameter = (uint8_t)((i + 1) % node->id.metric.cfg.vehicle->parameters);
    auvid_can_message_t m = {.kind = AUVID_CAN_ESTIMATE};
    m.as.estimate.index = (uint32_t)i;
    m.as.estimate.number = auvid_node_number(e->number);
    m.as.estimate.flags = node_parameter_flags(node, i);
    m.as.estimate.value = e->pi[i];
    m.absent = e->number == 0 ? AUVID_CAN_ESTIMATE_NO_VALUE : 0u;
    auvid_node_send(node, &m, frame, count);
    m = (auvid_can_message_t){.kind = AUVID_CAN_ESTIMATE_SIGMA};
    m.as.estimate_sigma.index = (uint32_t)i;
    m.as.estimate_sigma.number = auvid_node_number(e->number);
    m.as.estimate_sigma.note = e->confidence.note[i];
    m.as.estimate_sigma.sigma = e->confidence.sigma[i];
    bool known = e->number > 0 && e->confidence.sigma[i] < AUVID_LARGEST;
    m.absent = known ? 0u : AUVID_CAN_ESTIMATE_SIGMA_NO_SIGMA;
    auvid_node_send(node, &m, frame, count);
}

/* Fractions of the maximum speed in one direction. */
static const auvid_real_t drag_fraction[] = {AUVID_C(0.3), AUVID_C(0.6), AUVID_C(1.0)};
enum { FRACTIONS = sizeof drag_fraction / sizeof drag_fraction[0], POINTS = 2 * FRACTIONS };
_Static_assert(AUVID_CAN_POINT_YAW_BACKWARD_1_0 + 1 == POINTS * AUVID_DOF_COUNT, "drag.point");

/* Drag force at a point: see the DBC. */
static auvid_status_t node_drag_at(const auvid_node_t *node, int point, auvid_drag_t *drag)
{
    const auvid_estimate_t *e = identifier_read_estimate(&node->id);
    int dof = point / POINTS, backward = point % POINTS >= FRACTIONS;
    auvid_real_t speed = drag_fraction[point % FRACTIONS] * e->speed[dof][backward];
    return identifier_drag(&node->id, (auvid_dof_t)dof, backward ? -speed : speed, drag);
}

/* Each call reports the next point; degrees of freedom without drag are skipped. */
static void node_report_drag(auvid_node_t *node, auvid_can_frame_t *frame, int *count)
{
    auvid_drag_t drag;
    int point = node->next.point;
    auvid_status_t status = node_drag_at(node, point, &drag);
    for (int j = 0; status == AUVID_ERR_RANGE && j < AUVID_DOF_COUNT; ++j) {
        point = (point / POINTS + 1) % AUVID_DOF_COUNT * POINTS;
        status = node_drag_at(node, point, &drag);
    }
    if (status < 0) {
        return;
    }
    node->next.point = (uint8_t)((point + 1) % (POINTS * AUVID_DOF_COUNT));
    bool seen = auvid_abs(drag.speed) > AUVID_C(0.0);
    bool known = seen && drag.half_width < AUVID_LARGEST;
    auvid_can_message_t m = {.kind = AUVID_CAN_DRAG};
    m.as.drag.point = (uint32_t)point;
    m.as.drag.number = auvid_node_number(identifier_read_estimate(&node->id)->number);
    m.as.drag.flags = drag.identifiable;
    m.as.drag.force = drag.force;
    m.absent = seen ? 0u : AUVID_CAN_DRAG_NO_FORCE;
    auvid_node_send(node, &m, frame, count);
    m = (auvid_can_message_t){.kind = AUVID_CAN_DRAG_HALF_WIDTH};
    m.as.drag_half_width.point = (uint32_t)point;
    m.as.drag_half_width.speed = drag.speed;
    m.as.drag_half_width.half_width = drag.half_width;
    m.absent = (seen ? 0u : AUVID_CAN_DRAG_HALF_WIDTH_NO_SPEED) |
               (known ? 0u : AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH);
    auvid_node_send(node, &m, frame, count);
}

static void node_report_progress(auvid_node_t *node, auvid_can_frame_t *frame, int *count)
{
    const auvid_identifier_t *id = &node->id;
    auvid_can_message_t m = {.kind = AUVID_CAN_PROGRESS};
    if (id->actuation != NULL) {
        const auvid_guard_t *guard = &id->actuation->guard;
        bool refused = guard->trip.cause == AUVID_GUARD_NO_CAUSE;
        auvid_real_t part = auvid_excitation_progress(&id->actuation->excitation);
        m.as.progress.guard = (uint32_t)guard->state;
        m.as.progress.cause = (uint32_t)(refused ? guard->refused.cause : guard->trip.cause);
        m.as.progress.percent = (uint32_t)(AUVID_C(100.0) * part);
    }
    m.as.progress.work = id->work.phase;
    m.as.progress.sets = id->metric.sets.recorded % 256u;
    m.as.progress.searches = id->work.searches % 256u;
    m.as.progress.excited = id->estimate.excited;
    m.as.progress.changed = id->change_test.changed | id->change_test.drifted;
    auvid_node_send(node, &m, frame, count);
}

static void node_report_health(auvid_node_t *node, uint32_t load, auvid_can_frame_t *frame,
                               int *count)
{
    const auvid_node_counters_t *c = &node->counters;
    auvid_can_message_t m = {.kind = AUVID_CAN_HEALTH};
    m.as.health.ticks_missed = node_min(c->ticks_missed, 4095u);
    m.as.health.frames_refused = node_min(c->refused, 4095u);
    m.as.health.samples_dropped = node_min(c->samples_dropped, 4095u);
    m.as.health.saturated = node_min(node->sender.saturated, 255u);
    m.as.health.load = load;
    auvid_node_send(node, &m, frame, count);
}

static void node_report_heartbeat(auvid_node_t *node, auvid_can_frame_t *frame, int *count)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_HEARTBEAT};
    m.as.heartbeat.protocol = AUVID_CAN_PROTOCOL;
    m.as.heartbeat.role = AUVID_CAN_ROLE_NODE;
    uint64_t up_us = node->t_us - node->first_us;
    m.as.heartbeat.uptime = node_min((uint32_t)auvid_divide(up_us, 1000000u), 0xFFFFFFu);
    m.as.heartbeat.major = AUVID_VERSION_MAJOR;
    m.as.heartbeat.minor = AUVID_VERSION_MINOR;
    auvid_node_send(node, &m, frame, count);
}

auvid_status_t auvid_node_report(auvid_node_t *node, uint32_t load, auvid_can_frame_t *frame,
                                 int *count)
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
    auvid_nav_state_t state;
    uint32_t turn = node->reports++ % 50u;
    node->load = load > node->load ? load : node->load;
    bool navigates = turn % 5u < 2u && auvid_nav_state(&node->id.nav, &state) == AUVID_OK;
    if (navigates && turn % 5u == 0) {
        node_report_position(node, &state, frame, count);
    } else if (navigates) {
        node_report_velocity(node, &state, frame, count);
    } else if (turn % 5u == 2u) {
        node_report_estimate(node, frame, count);
    } else if (turn % 10u == 3u) {
        node_report_progress(node, frame, count);
    } else if (turn % 10u == 8u) {
        node_report_drag(node, frame, count);
    } else if (turn == 4u) {
        node_report_health(node, node_min(node->load, 255u), frame, count);
        node->load = 0;
    } else if (turn % 25u == 9u) {
        node_report_heartbeat(node, frame, count);
    }
    if (turn % 10u == 9u && node->report_causes != NULL) {
        node->report_causes(node, frame, count);
    }
    if (node->cfg.answer) {
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK_DONE};
        m.as.tick_done.sequence = node->sequence;
        m.as.tick_done.load = node_min(load, 255u);
        auvid_node_send(node, &m, frame, count);
    }
    return AUVID_OK;
}
