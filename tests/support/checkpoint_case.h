/**
 * @file checkpoint_case.h
 * What tests of the checkpoint share: an identifier with what is attached to it, its motion, and
 * its checkpoint.
 */
#ifndef CHECKPOINT_CASE_H
#define CHECKPOINT_CASE_H

#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "base/auvid_math_internal.h"
#include "unity.h"

enum { CELL_US = 100000, SET_ROWS = 20, CELLS = 450, BUDGET = 400, ROWS = 9 * SET_ROWS };

static auvid_identifier_config_t cfg;
static auvid_identifier_t id, other;
static auvid_actuation_config_t acting;
static auvid_actuation_t actuation;
static auvid_validation_t prediction; /* of `id`, and of copies of it */
static auvid_change_detector_t change;
static auvid_prior_t prior;
static uint8_t saved[AUVID_CHECKPOINT_MAX(ROWS)];
static uint32_t bytes;

static inline void init(auvid_identifier_t *of)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(of, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(of, &change));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(of, &prior));
}

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.metric.set_rows = SET_ROWS;
    auvid_actuation_defaults(&acting);
    init(&id);
}

void tearDown(void)
{
}

static inline void init_predicting(auvid_identifier_t *of)
{
    init(of);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(of, &prediction));
}

static inline void init_acting(void)
{
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
}

/* A cell of sinusoidal motion, with the wrench that causes it. */
static inline void record(auvid_identifier_t *to, int cell)
{
    auvid_sample_t s;
    auvid_real_t attitude[3] = {0}, tau[AUVID_DOF_COUNT] = {0};
    memset(&s, 0, sizeof s);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t t = (auvid_real_t)cell * AUVID_C(0.1), sine, cosine;
        for (int k = 1; k <= 2 && j != AUVID_ROLL && j != AUVID_PITCH; ++k) {
            auvid_real_t w = AUVID_C(0.3) * (auvid_real_t)k + AUVID_C(0.11) * (auvid_real_t)j;
            auvid_sincos(w * t + (auvid_real_t)(j * k), &sine, &cosine);
            s.nu[j] += AUVID_C(0.2) * sine;
            s.nu_dot[j] += AUVID_C(0.2) * w * cosine;
        }
    }
    auvid_vehicle_residual(&auvid_girona500, &s, auvid_girona500_paper, tau);
    uint64_t t_us = (uint64_t)cell * CELL_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(to, t_us, tau, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(to, t_us, attitude, s.nu));
}

/* A cell, then work. */
static inline void move(auvid_identifier_t *to, int cell)
{
    record(to, cell);
    (void)auvid_identifier_work(to, BUDGET);
}

static inline void move_from_to(auvid_identifier_t *to, int first, int last)
{
    for (int cell = first; cell < last; ++cell) {
        move(to, cell);
    }
}

/* Save in chunks of up to `chunk` bytes. @return bytes of the checkpoint */
static inline uint32_t save(const auvid_identifier_t *from, uint8_t *to, uint32_t chunk)
{
    auvid_checkpoint_t cursor;
    auvid_status_t status;
    uint32_t at = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, from));
    do {
        uint32_t part = chunk;
        status = auvid_checkpoint_next(&cursor, to + at, &part);
        at += part;
        TEST_ASSERT_EQUAL(at < cursor.bytes ? AUVID_PENDING : AUVID_OK, status);
        TEST_ASSERT_TRUE(at == cursor.bytes || part == chunk);
    } while (status == AUVID_PENDING);
    return at;
}

static inline void check_refused(auvid_status_t status, const uint8_t *checkpoint, uint32_t size)
{
    other = id;
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_restore(&id, checkpoint, size));
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_resume(&id, checkpoint, size));
    TEST_ASSERT_EQUAL_MEMORY(&other, &id, sizeof other);
}

#endif
