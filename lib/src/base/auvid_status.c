/*
 * Sentences for the statuses of types.h.
 */
#include "auvid_math_internal.h"

/* By status, and by minus the status. */
static const char *const news[] = {
    [AUVID_OK] = "done",
    [AUVID_PENDING] = "more work remains, call again",
    [AUVID_FINISHED] = "the procedure has come to its end",
    [AUVID_EMPTY] = "there is nothing to take",
    [AUVID_GAP] = "the record was broken here and starts anew",
    [AUVID_SET_COMPLETE] = "a data set was completed",
    [AUVID_GATED] = "measurement refused by the innovation gate",
    [AUVID_UNUSED] = "measurement is valid but cannot be used now",
    [AUVID_SATURATED] = "limited to what the thrusters can give, or a frame can carry",
    [AUVID_EVALUATION_LIMIT] = "stopped at a cap before its own criterion was met",
    [AUVID_TICK] = "a control tick has opened",
    [AUVID_SET_IDLE] = "a data set was closed and left out: nothing free was driven in it",
};
static const char *const errors[] = {
    [-AUVID_ERR_NULL] = "a required pointer is null",
    [-AUVID_ERR_NOT_FINITE] = "a value is NaN or infinite",
    [-AUVID_ERR_TIME_BACK] = "time went back",
    [-AUVID_ERR_TIME_SAME] = "time did not advance",
    [-AUVID_ERR_STALE] = "sample too old, or from the future",
    [-AUVID_ERR_RANGE] = "a value or a configuration field is out of range",
    [-AUVID_ERR_BOUNDS] = "a lower bound is not below its upper bound",
    [-AUVID_ERR_POPULATION] =
        "the population is smaller than n + 1 or larger than AUVID_MAX_POPULATION",
    [-AUVID_ERR_PARAMETERS] = "no parameter, or more than AUVID_MAX_PARAMETERS",
    [-AUVID_ERR_SIZE] = "something exceeds a size in config.h",
    [-AUVID_ERR_STATE] = "call out of order",
    [-AUVID_ERR_NO_DATA] = "no data to work on",
    [-AUVID_ERR_SINGULAR] = "the data do not determine the answer",
    [-AUVID_ERR_LIMIT] =
        "more is asked for than the thrusters can give, a limit allows, or a queue takes",
    [-AUVID_ERR_ARITHMETIC] = "switch off flush-to-zero, fast math, contraction; round to nearest",
    [-AUVID_ERR_MODEL] = "the vehicle model lacks what is asked of it",
    [-AUVID_ERR_LENGTH] = "a frame has not the length of its message",
    [-AUVID_ERR_CHECKSUM] = "a frame's checksum is wrong",
    [-AUVID_ERR_DRY_MASS] = "the dry mass is not below the upper bound of a mass",
};

const char *auvid_status_str(auvid_status_t status)
{
    int i = (int)status;
    if (i >= 0 && i < (int)(sizeof news / sizeof news[0])) {
        return news[i];
    }
    if (i < 0 && i > -(int)(sizeof errors / sizeof errors[0])) {
        return errors[-i];
    }
    return "unknown status";
}
