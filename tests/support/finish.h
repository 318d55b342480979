/**
 * @file finish.h
 * Loops that wait for a state end: if it never comes, the test fails with a message.
 */
#ifndef FINISH_H
#define FINISH_H

#include "auvid/identifier.h"
#include "unity.h"

/** Call it at the top of such a loop: *turns counts the iterations, 0 before the first. */
static inline void finish_turn(uint32_t *turns, uint32_t max_turns)
{
    TEST_ASSERT_TRUE_MESSAGE((*turns)++ < max_turns, "timeout: the awaited state does not come");
}

/** Calls that the last finish_work took. */
static uint32_t finish_calls;

/** Work until nothing is left, `budget` units a call; checks that no call uses more. */
static inline void finish_work(auvid_identifier_t *id, uint32_t budget)
{
    for (finish_calls = 0; auvid_identifier_work(id, budget) == AUVID_PENDING;) {
        finish_turn(&finish_calls, 1000000);
        TEST_ASSERT_TRUE(id->work.last_units <= budget);
    }
}

#endif
