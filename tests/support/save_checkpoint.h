/**
 * @file save_checkpoint.h
 * Save a checkpoint in one piece.
 */
#ifndef SAVE_CHECKPOINT_H
#define SAVE_CHECKPOINT_H

#include "auvid/checkpoint.h"
#include "unity.h"

/** Save *from to to[room]. @return its bytes */
static inline uint32_t save_checkpoint(const auvid_identifier_t *from, uint8_t *to, uint32_t room)
{
    auvid_checkpoint_t cursor;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, from));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, to, &room));
    return room;
}

#endif
