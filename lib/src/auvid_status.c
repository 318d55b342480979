/*
 * Sentences for the statuses of types.h.
 */
#include "auvid_math.h"

const char *auvid_status_str(auvid_status_t status)
{
    switch (status) {
    case AUVID_OK:
        return "done";
    case AUVID_PENDING:
        return "more work remains, call again";
    case AUVID_FINISHED:
        return "the procedure has come to its end";
    case AUVID_EMPTY:
        return "there is nothing to take";
    case AUVID_GAP:
        return "the record was broken here and starts anew";
    case AUVID_SET_COMPLETE:
        return "a data set was completed";
    case AUVID_GATED:
        return "measurement refused by the innovation gate";
    case AUVID_UNUSED:
        return "measurement is valid but cannot be used now";
    case AUVID_SATURATED:
        return "limited to what the thrusters can give, or a frame can carry";
    case AUVID_CAPPED:
        return "stopped at a cap before its own criterion was met";
    case AUVID_TICK:
        return "a control tick has opened";
    case AUVID_ERR_NULL:
        return "a required pointer is null";
    case AUVID_ERR_NOT_FINITE:
        return "a value is NaN or infinite";
    case AUVID_ERR_TIME_BACK:
        return "time went back";
    case AUVID_ERR_TIME_SAME:
        return "time did not advance";
    case AUVID_ERR_STALE:
        return "sample too old, or from the future";
    case AUVID_ERR_RANGE:
        return "a value or a configuration field is out of range";
    case AUVID_ERR_BOUNDS:
        return "a lower bound is not below its upper bound";
    case AUVID_ERR_POPULATION:
        return "the population is smaller than n + 1 or larger than AUVID_MAX_POPULATION";
    case AUVID_ERR_PARAMETERS:
        return "no parameter, or more than AUVID_MAX_PARAMETERS";
    case AUVID_ERR_SIZE:
        return "something exceeds a size in config.h";
    case AUVID_ERR_STATE:
        return "call out of order";
    case AUVID_ERR_NO_DATA:
        return "no data to work on";
    case AUVID_ERR_SINGULAR:
        return "the data do not determine the answer";
    case AUVID_ERR_LIMIT:
        return "more is asked for than the thrusters can give, a limit allows, or a queue takes";
    case AUVID_ERR_ARITHMETIC:
        return "the arithmetic of this machine or build is not auvid's";
    case AUVID_ERR_MODEL:
        return "the vehicle model lacks what is asked of it";
    case AUVID_ERR_LENGTH:
        return "a frame has not the length of its message";
    case AUVID_ERR_CHECKSUM:
        return "a frame's checksum is wrong";
    }
    return "unknown status";
}
