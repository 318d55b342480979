/*
 * Counter and time-out of a message; reception of the thruster commands.
 */
#include "auvid/can.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_can_follow_internal.h"

#define RECEIVER_HALF (AUVID_CAN_THRUSTERS / 2)

auvid_status_t auvid_can_receiver_init(auvid_can_receiver_t *receiver, auvid_can_kind_t kind,
                                       uint32_t timeout_us, const auvid_can_ids_t *ids)
{
    auvid_can_ids_t defaults;
    auvid_can_ids_defaults(&defaults);
    ids = ids != NULL ? ids : &defaults;
    if (receiver == NULL) {
        return AUVID_ERR_NULL;
    }
    if ((uint32_t)kind >= AUVID_CAN_KINDS) {
        return AUVID_ERR_RANGE;
    }
    auvid_status_t status = auvid_can_ids_check(ids);
    if (status == AUVID_OK) {
        memset(receiver, 0, sizeof *receiver);
        receiver->status = AUVID_EMPTY;
        receiver->ids = *ids;
        receiver->kind = (uint8_t)kind;
        receiver->timeout_us = timeout_us;
    }
    return status;
}

/* Is t_us more than a time-out before now_us, or at least a time-out after it? A frame less than
 * that ahead arrived after the caller read the clock. One of the two differences wraps. */
static bool can_receiver_is_silent(const auvid_can_receiver_t *receiver, uint64_t t_us,
                                   uint64_t now_us)
{
    uint64_t timeout = receiver->timeout_us != 0 ? receiver->timeout_us : UINT64_MAX;
    return now_us - t_us > timeout && t_us - now_us >= timeout;
}

static bool can_receiver_is_ahead(const auvid_can_receiver_t *receiver, uint64_t t_us,
                                  uint64_t now_us)
{
    return t_us > now_us && can_receiver_is_silent(receiver, t_us, now_us);
}

/* Detects silence: the next frame then has no predecessor. With `ends` the last good frame expires,
 * too. */
static void can_receiver_check_timeout(auvid_can_receiver_t *receiver, uint64_t now_us, bool ends)
{
    if (can_receiver_is_silent(receiver, receiver->seen_us, now_us)) {
        receiver->started = false;
    }
    if (ends && receiver->is_fresh && can_receiver_is_silent(receiver, receiver->good_us, now_us)) {
        receiver->is_fresh = false;
        receiver->status = AUVID_ERR_STALE;
        ++receiver->timeouts;
    }
}

auvid_status_t auvid_can_receiver_status(auvid_can_receiver_t *receiver, uint64_t now_us)
{
    if (receiver == NULL) {
        return AUVID_ERR_NULL;
    }
    can_receiver_check_timeout(receiver, now_us, true);
    return (auvid_status_t)receiver->status;
}

/* Verdict on an authentic frame by its counter. */
static auvid_status_t can_receiver_check_counter(auvid_can_receiver_t *receiver, uint8_t counter)
{
    bool first = receiver->strict && !receiver->started;
    auvid_status_t status =
        auvid_can_follow(&receiver->counter, &receiver->started, counter, &receiver->lost);
    status = first ? AUVID_ERR_COUNTER_JUMP : status;
    receiver->counter_jumps += status == AUVID_ERR_COUNTER_JUMP;
    receiver->repeated += status == AUVID_ERR_REPEATED;
    return status;
}

auvid_status_t auvid_can_receiver_take(auvid_can_receiver_t *receiver,
                                       const auvid_can_frame_t *frame, auvid_can_message_t *message)
{
    if (receiver == NULL || frame == NULL || message == NULL) {
        return AUVID_ERR_NULL;
    }
    if (frame->id != auvid_can_id(&receiver->ids, (auvid_can_kind_t)receiver->kind)) {
        return AUVID_UNUSED;
    }
    /* a command expires by the clock, not by timestamps */
    can_receiver_check_timeout(receiver, frame->t_us, !receiver->strict);
    auvid_status_t status = auvid_can_unpack(&receiver->ids, frame, message);
    if (status == AUVID_OK) {
        status = can_receiver_check_counter(receiver, message->counter);
        receiver->seen_us = frame->t_us;
    } else if (status == AUVID_ERR_CHECKSUM) {
        ++receiver->checksum;
    } else {
        ++receiver->invalid;
    }
    if (status == AUVID_OK) {
        ++receiver->good;
        receiver->good_us = frame->t_us;
        receiver->is_fresh = true;
    }
    receiver->status = (int8_t)status;
    return status;
}

auvid_status_t auvid_can_command_init(auvid_can_command_t *command, uint8_t thrusters,
                                      const auvid_can_ids_t *ids)
{
    if (command == NULL) {
        return AUVID_ERR_NULL;
    }
    if (thrusters < 1 || thrusters > AUVID_CAN_THRUSTERS) {
        return AUVID_ERR_RANGE;
    }
    auvid_can_command_t fresh = {.halves = thrusters > RECEIVER_HALF ? 2 : 1};
    for (int i = 0; i < 2; ++i) {
        auvid_can_kind_t kind =
            i == 0 ? AUVID_CAN_THRUSTER_COMMAND_A : AUVID_CAN_THRUSTER_COMMAND_B;
        auvid_status_t status =
            auvid_can_receiver_init(&fresh.half[i], kind, AUVID_CAN_COMMAND_TIMEOUT_US, ids);
        if (status != AUVID_OK) {
            return status;
        }
        fresh.half[i].strict = true;
    }
    memcpy(fresh.half_before, fresh.half, sizeof fresh.half);
    *command = fresh;
    return AUVID_OK;
}

auvid_status_t auvid_can_command_take(auvid_can_command_t *command, const auvid_can_frame_t *frame)
{
    if (command == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = AUVID_UNUSED;
    for (int i = 0; i < command->halves; ++i) {
        auvid_can_message_t message;
        auvid_status_t answer = auvid_can_receiver_take(&command->half[i], frame, &message);
        if (answer == AUVID_OK) {
            const auvid_real_t *thrust = i == 0 ? message.as.thruster_command_a.thrust
                                                : message.as.thruster_command_b.thrust;
            for (int j = 0; j < RECEIVER_HALF; ++j) {
                bool absent = (message.absent >> j & 1u) != 0;
                command->thrust[RECEIVER_HALF * i + j] = absent ? AUVID_C(0.0) : thrust[j];
            }
        }
        status = answer != AUVID_UNUSED ? answer : status;
    }
    return status;
}

/* Is the command of this half good at now_us? A frame with a timestamp too far ahead is undone. */
static bool can_receiver_half_is_good(auvid_can_command_t *command, int i, uint64_t now_us)
{
    auvid_can_receiver_t *half = &command->half[i], *before = &command->half_before[i];
    auvid_real_t *thrust = &command->thrust[RECEIVER_HALF * i],
                 *kept = &command->thrust_before[RECEIVER_HALF * i];
    if ((half->started && can_receiver_is_ahead(half, half->seen_us, now_us)) ||
        (half->is_fresh && can_receiver_is_ahead(half, half->good_us, now_us))) {
        *half = *before;
        memcpy(thrust, kept, RECEIVER_HALF * sizeof *kept);
        ++half->ahead;
    }
    can_receiver_check_timeout(half, now_us, true);
    *before = *half;
    memcpy(kept, thrust, RECEIVER_HALF * sizeof *kept);
    return half->is_fresh;
}

auvid_status_t auvid_can_command_thrust(auvid_can_command_t *command, uint64_t now_us,
                                        auvid_real_t thrust[AUVID_CAN_THRUSTERS])
{
    if (thrust == NULL) {
        return AUVID_ERR_NULL;
    }
    memset(thrust, 0, AUVID_CAN_THRUSTERS * sizeof thrust[0]);
    if (command == NULL) {
        return AUVID_ERR_NULL;
    }
    if (command->halves == 0) {
        return AUVID_ERR_STATE;
    }
    bool good = true;
    for (int i = 0; i < command->halves; ++i) {
        good = can_receiver_half_is_good(command, i, now_us) && good;
    }
    if (!good) {
        return AUVID_ERR_STALE;
    }
    memcpy(thrust, command->thrust, sizeof command->thrust);
    return AUVID_OK;
}
