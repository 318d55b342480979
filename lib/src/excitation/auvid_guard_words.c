/*
 * Names of the guard's states and causes.
 */
#include "auvid/guard.h"

#include "../base/auvid_math_internal.h"

static const char *const state_names[AUVID_GUARD_STATE_COUNT] = {"disarmed", "armed", "exciting",
                                                                 "settling", "done",  "aborted"};

static const char *const cause_names[AUVID_GUARD_CAUSE_COUNT] = {
    "none",
    "aborted by the operator",
    "a tick without input, or without memory for the output",
    "time did not advance",
    "a tick took too long",
    "no heartbeat from the operator",
    "no attitude from the IMU",
    "no velocity over ground",
    "no depth",
    "no altitude",
    "no applied wrench is recorded",
    "too shallow",
    "too deep",
    "too close to the bottom",
    "too much roll",
    "too much pitch",
    "too fast",
    "turning too fast",
    "too far from where it was armed",
    "running for too long",
    "the thrusters stayed saturated",
    "another node commands the thrusters",
};

const char *auvid_guard_state_str(auvid_guard_state_t state)
{
    return (unsigned)state < AUVID_GUARD_STATE_COUNT ? state_names[state] : "unknown state";
}

const char *auvid_guard_cause_str(auvid_guard_cause_t cause)
{
    return (unsigned)cause < AUVID_GUARD_CAUSE_COUNT ? cause_names[cause] : "unknown cause";
}
