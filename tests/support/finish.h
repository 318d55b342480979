/**
 * @file finish.h
 * Loops that wait for a state end: a state that never comes is a failure that says so.
 */
#ifndef FINISH_H
#define FINISH_H

#include "auvid/identifier.h"
#include "unity.h"

/** At the top of such a loop: *turns counts them, 0 before the first. */
static inline void finish_turn(uint32_t *turns, uint32_t most)
{
    TEST_ASSERT_TRUE_MESSAGE((*turns)++ < most, "what is waited for does not come");
}

/** Work until nothing is left, `budget` units a call; each call keeps to it. */
static inline void finish_work(auvid_identifier_t *id, uint32_t budget)
{
    for (uint32_t calls = 0; auvid_identifier_work(id, budget) == AUVID_PENDING;) {
        finish_turn(&calls, 1000000);
        TEST_ASSERT_TRUE(id->work_last <= budget);
    }
}

#endif
