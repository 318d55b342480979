/* Which statuses do the public functions return to a unit test, and which does it assert?
 *
 * statuses.py writes a header that includes this one and wraps each public function that returns a
 * status. Included before everything else in a unit test. At exit the program writes a line
 * "function status asserted" for each pair that it saw to STATUSES_FILE. A status counts as
 * asserted if the next assertion of an equal integer compares it. */
#ifndef STATUSES_H
#define STATUSES_H

#include <stdio.h>

#include "unity.h"

#include "auvid/types.h"

#define STATUSES_LEAST (-64)
#define STATUSES_COUNT 128

static struct {
    bool seen, asserted;
} statuses_of[STATUSES_FUNCTIONS][STATUSES_COUNT];
static int statuses_function = -1, statuses_last; /* of the last call; -1: it has been compared */

static inline auvid_status_t statuses_note(int function, auvid_status_t status)
{
    statuses_function = function;
    statuses_last = (int)status;
    statuses_of[function][(int)status - STATUSES_LEAST].seen = true;
    return status;
}

static inline void statuses_assert_equal(const UNITY_INT expected, const UNITY_INT actual,
                                         const char *message, const UNITY_LINE_TYPE line,
                                         const UNITY_DISPLAY_STYLE_T style)
{
    if (statuses_function >= 0 && expected == actual && actual == statuses_last) {
        statuses_of[statuses_function][statuses_last - STATUSES_LEAST].asserted = true;
    }
    statuses_function = -1;
    UnityAssertEqualNumber(expected, actual, message, line, style);
}
#define UnityAssertEqualNumber statuses_assert_equal

__attribute__((destructor)) static void statuses_write(void)
{
    FILE *file = fopen(STATUSES_FILE, "w");
    for (int i = 0; file != NULL && i < STATUSES_FUNCTIONS; ++i) {
        for (int k = 0; k < STATUSES_COUNT; ++k) {
            if (statuses_of[i][k].seen) {
                fprintf(file, "%s %d %d\n", statuses_name[i], k + STATUSES_LEAST,
                        statuses_of[i][k].asserted);
            }
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

#endif
