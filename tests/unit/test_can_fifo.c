/*
 * The queue, alone and between two threads.
 */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <pthread.h>
#include <string.h>
#include <time.h>

#include "auvid/can_fifo.h"
#include "unity.h"

enum { SIZE = 8 };

static auvid_can_fifo_t fifo;
static auvid_can_frame_t storage[SIZE];

void setUp(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_init(&fifo, storage, SIZE));
}

void tearDown(void)
{
}

/* Every byte of the frame follows from the number, so that a torn frame shows. */
static auvid_can_frame_t numbered(uint32_t number)
{
    auvid_can_frame_t frame;
    memset(&frame, 0, sizeof frame);
    frame.t_us = number * 0x100000001ull;
    frame.id = (uint16_t)(number & 0x7FFu);
    frame.length = (uint8_t)(number % 9);
    memset(frame.data, (int)(number & 0xFFu), sizeof frame.data);
    return frame;
}

static bool is_numbered(const auvid_can_frame_t *frame, uint32_t number)
{
    auvid_can_frame_t expected = numbered(number);
    return frame->t_us == expected.t_us && frame->id == expected.id &&
           frame->length == expected.length && memcmp(frame->data, expected.data, 8) == 0;
}

static void test_frames_come_out_in_the_order_they_went_in(void)
{
    auvid_can_frame_t frame;
    uint32_t in = 0, out = 0;
    for (int round = 0; round < 100; ++round) {
        for (int i = 0; i < round % (SIZE + 1); ++i) {
            frame = numbered(in++);
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_push(&fifo, &frame));
        }
        while (auvid_can_fifo_pop(&fifo, &frame) == AUVID_OK) {
            TEST_ASSERT_TRUE(is_numbered(&frame, out++));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(in, out);
}

static void test_a_full_queue_drops_the_newest_and_counts(void)
{
    auvid_can_frame_t frame;
    for (uint32_t i = 0; i < SIZE + 3; ++i) {
        frame = numbered(i);
        TEST_ASSERT_EQUAL(i < SIZE ? AUVID_OK : AUVID_ERR_LIMIT,
                          auvid_can_fifo_push(&fifo, &frame));
    }
    TEST_ASSERT_EQUAL_UINT32(3, fifo.dropped);
    for (uint32_t i = 0; i < SIZE; ++i) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_pop(&fifo, &frame));
        TEST_ASSERT_TRUE(is_numbered(&frame, i));
    }
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_can_fifo_pop(&fifo, &frame));
}

static void test_the_indices_may_wrap(void)
{
    fifo.pushed = UINT32_MAX - 2;
    fifo.popped = UINT32_MAX - 2;
    test_frames_come_out_in_the_order_they_went_in();
    setUp();
    fifo.pushed = UINT32_MAX - 2;
    fifo.popped = UINT32_MAX - 2;
    test_a_full_queue_drops_the_newest_and_counts();
}

enum { MANY = 400000 };

/* Who only yields waits, on a busy machine, for a time slice of every other program. */
static void pause_thread(void)
{
    (void)nanosleep(&(struct timespec){.tv_nsec = 1}, NULL);
}

/* Tries again when full: the consumer must see all frames. */
static void *produce(void *unused)
{
    for (uint32_t i = 0; i < MANY;) {
        auvid_can_frame_t frame = numbered(i);
        if (auvid_can_fifo_push(&fifo, &frame) == AUVID_OK) {
            ++i;
        } else {
            pause_thread();
        }
    }
    return unused;
}

static void test_two_threads_lose_and_tear_nothing(void)
{
    pthread_t producer;
    auvid_can_frame_t frame;
    uint32_t wrong = 0;
    TEST_ASSERT_EQUAL(0, pthread_create(&producer, NULL, produce, NULL));
    for (uint32_t i = 0; i < MANY;) {
        if (auvid_can_fifo_pop(&fifo, &frame) == AUVID_OK) {
            wrong += !is_numbered(&frame, i++);
        } else {
            pause_thread();
        }
    }
    pthread_join(producer, NULL);
    TEST_ASSERT_EQUAL_UINT32(0, wrong);
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_can_fifo_pop(&fifo, &frame));
}

static void test_wrong_calls_are_named(void)
{
    auvid_can_frame_t frame = numbered(0);
    const uint32_t bad[] = {0, 1, 3, 12, 0x10000, 0x80000000u, UINT32_MAX};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_fifo_init(&fifo, storage, bad[i]));
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_init(NULL, storage, SIZE));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_init(&fifo, NULL, SIZE));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_push(NULL, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_push(&fifo, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_pop(NULL, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_fifo_pop(&fifo, NULL));
    memset(&fifo, 0, sizeof fifo);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_can_fifo_push(&fifo, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_can_fifo_pop(&fifo, &frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_frames_come_out_in_the_order_they_went_in);
    RUN_TEST(test_a_full_queue_drops_the_newest_and_counts);
    RUN_TEST(test_the_indices_may_wrap);
    RUN_TEST(test_two_threads_lose_and_tear_nothing);
    RUN_TEST(test_wrong_calls_are_named);
    return UNITY_END();
}
