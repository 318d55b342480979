/*
 * Texts for the statuses of types.h.
 */
#include "auvid_math_internal.h"

/* Indexed by the status. */
static const char *const result_text[] = {
    [AUVID_OK] = "done",
    [AUVID_PENDING] = "more work remains, call again",
    [AUVID_FINISHED] = "the procedure is complete",
    [AUVID_EMPTY] = "nothing is available",
    [AUVID_GAP] = "gap in the data, the record restarts",
    [AUVID_SET_COMPLETE] = "a data set is complete",
    [AUVID_GATED] = "the innovation gate rejected the measurement",
    [AUVID_UNUSED] = "the measurement is valid but not usable now",
    [AUVID_SATURATED] = "limited to the thrusters' capacity or a frame's range",
    [AUVID_EVALUATION_LIMIT] = "stopped at the evaluation limit, not converged",
    [AUVID_TICK] = "a control tick is due, call the step function",
    [AUVID_SET_IDLE] =
        "a data set is complete and discarded: no DoF with a free parameter was excited",
};
/* Indexed by minus the status. */
static const char *const error_text[] = {
    [-AUVID_ERR_NULL] = "a required pointer is NULL",
    [-AUVID_ERR_NOT_FINITE] = "a value is NaN or infinite",
    [-AUVID_ERR_TIME_BACK] = "time went backwards",
    [-AUVID_ERR_TIME_SAME] = "time did not advance",
    [-AUVID_ERR_STALE] = "the sample is too old or from the future",
    [-AUVID_ERR_RANGE] = "a value or a configuration field is out of range",
    [-AUVID_ERR_BOUNDS] = "a lower bound is not below its upper bound",
    [-AUVID_ERR_POPULATION] =
        "the population is smaller than n + 1 or larger than AUVID_MAX_POPULATION",
    [-AUVID_ERR_PARAMETERS] = "there is no parameter, or more than AUVID_MAX_PARAMETERS",
    [-AUVID_ERR_SIZE] = "a count exceeds its size in config.h",
    [-AUVID_ERR_STATE] = "the function was called out of order or before init",
    [-AUVID_ERR_NO_DATA] = "there is no data to work on",
    [-AUVID_ERR_SINGULAR] = "the data do not determine the result",
    [-AUVID_ERR_LIMIT] = "a limit of the guard is exceeded",
    [-AUVID_ERR_ARITHMETIC] =
        "wrong arithmetic: disable flush-to-zero, fast math, contraction; round to nearest",
    [-AUVID_ERR_MODEL] = "the vehicle model does not support the request",
    [-AUVID_ERR_LENGTH] = "the frame's length is not that of its message",
    [-AUVID_ERR_CHECKSUM] = "the frame's checksum is wrong",
    [-AUVID_ERR_DRY_MASS] = "the dry mass is not below the upper bound of a mass",
    [-AUVID_ERR_CAPACITY] = "the thrusters cannot give so much",
    [-AUVID_ERR_FULL] = "the queue is full",
    [-AUVID_ERR_REPEATED] = "the frame's counter is that of the last one",
    [-AUVID_ERR_COUNTER_JUMP] = "the frame's counter jumped",
    [-AUVID_ERR_ATTACHED] = "such a part is attached already",
    [-AUVID_ERR_DETACHED] = "the function needs a part that is not attached",
    [-AUVID_ERR_STARTED] = "too late, the identifier has stepped or recorded since init",
    [-AUVID_ERR_CONFIGURATION] = "saved with another configuration",
};

const char *auvid_status_str(auvid_status_t status)
{
    int i = (int)status;
    if (i >= 0 && i < (int)(sizeof result_text / sizeof result_text[0])) {
        return result_text[i];
    }
    if (i < 0 && i > -(int)(sizeof error_text / sizeof error_text[0])) {
        return error_text[-i];
    }
    return "unknown status";
}
