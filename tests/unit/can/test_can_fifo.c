/*
 * The queue, in one thread and between two threads.
 */
#define _POSIX_C_SOURCE 200809L /* nanosleep */
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include "auvid/can.h"
#include "unity.h"

enum { SIZE = 8 };

static auvid_can_fifo_t fifo;
static auvid_can_frame_t storage[SIZE];
static auvid_can_sender_t console;

void setUp(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_init(&fifo, storage, SIZE));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&console, NULL));
}

void tearDown(void)
{
}

/* The number determines every byte of the frame, so a torn frame is detected. */
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

static void test_frames_are_popped_in_the_order_of_pushing(void)
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

static void test_a_full_queue_drops_and_counts_the_newest(void)
{
    auvid_can_frame_t frame;
    for (uint32_t i = 0; i < SIZE + 3; ++i) {
        frame = numbered(i);
        TEST_ASSERT_EQUAL(i < SIZE ? AUVID_OK : AUVID_ERR_FULL, auvid_can_fifo_push(&fifo, &frame));
    }
    TEST_ASSERT_EQUAL_UINT32(3, fifo.dropped);
    for (uint32_t i = 0; i < SIZE; ++i) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_pop(&fifo, &frame));
        TEST_ASSERT_TRUE(is_numbered(&frame, i));
    }
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_can_fifo_pop(&fifo, &frame));
}

static void test_the_queue_works_across_a_wrap_of_its_indices(void)
{
    fifo.pushed = UINT32_MAX - 2;
    fifo.popped = UINT32_MAX - 2;
    test_frames_are_popped_in_the_order_of_pushing();
    setUp();
    fifo.pushed = UINT32_MAX - 2;
    fifo.popped = UINT32_MAX - 2;
    test_a_full_queue_drops_and_counts_the_newest();
}

static auvid_can_frame_t of_operator(auvid_can_sender_t *from, auvid_can_kind_t kind)
{
    auvid_can_frame_t frame;
    auvid_can_message_t m = {.kind = kind};
    m.as.arm.action = kind == AUVID_CAN_ARM ? AUVID_CAN_ACTION_ARM : 0;
    m.as.arm.key = kind == AUVID_CAN_ARM ? AUVID_CAN_ARM_KEY : 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(from, &m, &frame));
    return frame;
}

static void push(const auvid_can_frame_t *frame)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_push(&fifo, frame));
}

static void pops(const auvid_can_frame_t *expected)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_fifo_pop(&fifo, &frame));
    TEST_ASSERT_EQUAL_HEX16(expected->id, frame.id);
    TEST_ASSERT_EQUAL_MEMORY(expected->data, frame.data, AUVID_CAN_BYTES);
}

static void is_empty(void)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_can_fifo_pop(&fifo, &frame));
}

static void test_an_abort_is_popped_before_all_frames_even_from_a_full_queue(void)
{
    for (uint32_t inside = 0; inside <= SIZE; ++inside) {
        auvid_can_frame_t frame;
        setUp();
        fifo.pushed = fifo.popped = UINT32_MAX - inside; /* and wraps */
        fifo.aborts = fifo.aborted = UINT32_MAX;
        auvid_can_frame_t abort = of_operator(&console, AUVID_CAN_ABORT);
        for (uint32_t i = 0; i < inside; ++i) {
            frame = numbered(i);
            push(&frame);
        }
        push(&abort);
        frame = numbered(inside);
        TEST_ASSERT_EQUAL(inside < SIZE ? AUVID_OK : AUVID_ERR_FULL,
                          auvid_can_fifo_push(&fifo, &frame));
        TEST_ASSERT_EQUAL_UINT32(inside == SIZE, fifo.dropped);
        pops(&abort);
        for (uint32_t i = 0; i < inside + (inside < SIZE); ++i) {
            frame = numbered(i);
            pops(&frame);
        }
        is_empty();
    }
}

static void test_pending_aborts_become_one_and_a_later_abort_is_popped_again(void)
{
    auvid_can_frame_t first = of_operator(&console, AUVID_CAN_ABORT);
    auvid_can_frame_t second = of_operator(&console, AUVID_CAN_ABORT);
    push(&first);
    push(&second);
    pops(&first);
    is_empty();
    push(&second);
    pops(&second);
    is_empty();
}

/* An arm frame sent before the abort must not be obeyed after it. */
static void test_arm_frames_from_before_an_abort_are_discarded(void)
{
    auvid_can_frame_t arm = of_operator(&console, AUVID_CAN_ARM), sensor = numbered(1);
    auvid_can_frame_t abort = of_operator(&console, AUVID_CAN_ABORT), last = numbered(2);
    auvid_can_frame_t later = of_operator(&console, AUVID_CAN_ARM);
    for (int round = 0; round < 20; ++round) {
        push(&arm);
        push(&sensor);
        push(&abort);
        push(&arm);
        push(&abort); /* the abort that discards the `arm` before it */
        push(&last);
        push(&later);
        pops(&abort);
        pops(&sensor);
        pops(&last);
        pops(&later);
        push(&arm);
        pops(&arm); /* from before no abort */
        push(&arm);
        push(&abort);
        pops(&abort);
        is_empty();
    }
}

static void test_a_frame_that_is_no_valid_abort_stays_in_order(void)
{
    for (int wrong = 0; wrong < 3; ++wrong) {
        auvid_can_frame_t abort = of_operator(&console, AUVID_CAN_ABORT), before = numbered(1);
        abort.data[2] ^= wrong == 0;
        abort.length = (uint8_t)(abort.length - (wrong == 1));
        abort.id = (uint16_t)(abort.id + (wrong == 2));
        push(&before);
        push(&abort);
        pops(&before);
        pops(&abort);
    }
}

static void test_an_abort_with_moved_identifiers_is_recognised(void)
{
    const auvid_can_ids_t ids = {0x200, 0x300};
    auvid_can_sender_t moved;
    auvid_can_frame_t before = numbered(1);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&moved, &ids));
    fifo.ids = ids;
    auvid_can_frame_t arm = of_operator(&moved, AUVID_CAN_ARM);
    auvid_can_frame_t abort = of_operator(&moved, AUVID_CAN_ABORT);
    auvid_can_frame_t other = of_operator(&console, AUVID_CAN_ABORT);
    push(&arm);
    push(&before);
    push(&other);
    push(&abort);
    pops(&abort);
    pops(&before);
    pops(&other);
    is_empty();
}

enum { MANY = 400000 };

/* On a busy machine, yielding would wait for a time slice of every other program. */
static void pause_thread(void)
{
    (void)nanosleep(&(struct timespec){.tv_nsec = 1}, NULL);
}

/* Retries if the queue is full: the consumer must see all frames. */
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

static void test_two_threads_lose_and_tear_no_frame(void)
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

static volatile bool produced;

/* An abort every 50 frames, with an arm frame before each. A full queue drops all but aborts. */
static void *produce_aborts(void *unused)
{
    for (uint32_t i = 0; i < MANY / 10; ++i) {
        auvid_can_frame_t frame = i % 50 == 49   ? of_operator(&console, AUVID_CAN_ABORT)
                                  : i % 50 == 48 ? of_operator(&console, AUVID_CAN_ARM)
                                                 : numbered(i % 50);
        frame.t_us = i;
        (void)auvid_can_fifo_push(&fifo, &frame);
        if (i % 50 == 0) {
            pause_thread();
        }
    }
    produced = true;
    return unused;
}

/* Every abort is popped, or merged with an earlier pending one. */
static void test_two_threads_lose_no_abort_and_pop_no_arm_frame_from_before_it(void)
{
    pthread_t producer;
    auvid_can_frame_t frame;
    auvid_can_message_t m;
    uint64_t last_us = 0;
    uint32_t aborts = 0, wrong = 0;
    produced = false;
    TEST_ASSERT_EQUAL(0, pthread_create(&producer, NULL, produce_aborts, NULL));
    for (bool ended = false; !ended;) {
        ended = produced; /* read before the queue is read */
        while (auvid_can_fifo_pop(&fifo, &frame) == AUVID_OK) {
            auvid_can_kind_t kind = auvid_can_kind(NULL, frame.id);
            bool is_order = kind == AUVID_CAN_ABORT || kind == AUVID_CAN_ARM;
            wrong += is_order && auvid_can_unpack(NULL, &frame, &m) != AUVID_OK; /* torn */
            wrong += kind == AUVID_CAN_ARM && frame.t_us < last_us;
            wrong += kind == AUVID_CAN_ABORT && aborts > 0 && frame.t_us <= last_us;
            last_us = kind == AUVID_CAN_ABORT ? frame.t_us : last_us;
            aborts += kind == AUVID_CAN_ABORT;
        }
        pause_thread();
    }
    pthread_join(producer, NULL);
    TEST_ASSERT_EQUAL_UINT32(0, wrong);
    TEST_ASSERT_TRUE(aborts > 0);
    TEST_ASSERT_EQUAL_UINT32(fifo.aborts, aborts);
}

#if defined(__x86_64__) && defined(__linux__)
/* The interrupt pushes an abort and then an arm frame, after the n-th instruction of pop. */
static volatile uint32_t instructions, interrupted_at;
static auvid_can_frame_t abort_frame, arm_frame;

static void interrupt(int signal_number)
{
    (void)signal_number;
    if (++instructions == interrupted_at) {
        (void)auvid_can_fifo_push(&fifo, &abort_frame);
        (void)auvid_can_fifo_push(&fifo, &arm_frame);
    }
}

/* The processor's trap flag: a SIGTRAP after each instruction. */
static auvid_status_t pop_interrupted(auvid_can_frame_t *frame)
{
    instructions = 0;
    __asm__ volatile("pushfq\n\torq $0x100, (%%rsp)\n\tpopfq" ::: "memory", "cc");
    auvid_status_t status = auvid_can_fifo_pop(&fifo, frame);
    __asm__ volatile("pushfq\n\tandq $~0x100, (%%rsp)\n\tpopfq" ::: "memory", "cc");
    return status;
}

/* Pop all frames, interrupted in the first one. @return did the interrupt come? */
static bool pop_all_interrupted(int *aborts, int *sensors)
{
    auvid_can_frame_t frame;
    auvid_status_t status = pop_interrupted(&frame);
    bool came = instructions >= interrupted_at;
    if (came && status == AUVID_EMPTY) { /* it came when the queue had been found empty */
        status = auvid_can_fifo_pop(&fifo, &frame);
    }
    for (; status == AUVID_OK && frame.id != arm_frame.id;
         status = auvid_can_fifo_pop(&fifo, &frame)) {
        *aborts += frame.id == abort_frame.id;
        *sensors += frame.id != abort_frame.id;
    }
    is_empty();
    return came;
}

static void test_an_abort_is_before_a_later_arm_frame_wherever_pop_is_interrupted(void)
{
    const auvid_can_frame_t sensor = numbered(1);
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = interrupt;
    TEST_ASSERT_EQUAL(0, sigaction(SIGTRAP, &action, NULL));
    abort_frame = of_operator(&console, AUVID_CAN_ABORT);
    arm_frame = of_operator(&console, AUVID_CAN_ARM);
    for (int queued = 0; queued < 3; ++queued) {
        bool came = true;
        for (interrupted_at = 1; came; ++interrupted_at) {
            int aborts = 0, sensors = 0;
            setUp();
            for (int i = 0; i < queued; ++i) {
                push(&sensor);
            }
            came = pop_all_interrupted(&aborts, &sensors);
            TEST_ASSERT_EQUAL(came, aborts); /* before the arm frame */
            TEST_ASSERT_EQUAL(queued, sensors);
        }
        TEST_ASSERT_TRUE(interrupted_at > 20);
    }
}
#endif

static void test_wrong_calls_return_their_statuses(void)
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
    RUN_TEST(test_frames_are_popped_in_the_order_of_pushing);
    RUN_TEST(test_a_full_queue_drops_and_counts_the_newest);
    RUN_TEST(test_the_queue_works_across_a_wrap_of_its_indices);
    RUN_TEST(test_an_abort_is_popped_before_all_frames_even_from_a_full_queue);
    RUN_TEST(test_pending_aborts_become_one_and_a_later_abort_is_popped_again);
    RUN_TEST(test_arm_frames_from_before_an_abort_are_discarded);
    RUN_TEST(test_a_frame_that_is_no_valid_abort_stays_in_order);
    RUN_TEST(test_an_abort_with_moved_identifiers_is_recognised);
    RUN_TEST(test_two_threads_lose_and_tear_no_frame);
    RUN_TEST(test_two_threads_lose_no_abort_and_pop_no_arm_frame_from_before_it);
#if defined(__x86_64__) && defined(__linux__)
    RUN_TEST(test_an_abort_is_before_a_later_arm_frame_wherever_pop_is_interrupted);
#endif
    RUN_TEST(test_wrong_calls_return_their_statuses);
    return UNITY_END();
}
