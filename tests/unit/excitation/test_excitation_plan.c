/*
 * The schedule of the excitation: pauses, one degree of freedom after the other, and the excursion
 * limit that prevents the vehicle from drifting away.
 */
#include <math.h>
#include <string.h>

#include "auvid/excitation.h"
#include "simulator.h"
#include "unity.h"

#define S 1000000u /* microseconds */

static auvid_excitation_config_t cfg;
static auvid_excitation_t e;
static auvid_real_t wrench[6];

static const auvid_real_t girona500[6] = {100, 100, 100, 0, 0, 40};
static const auvid_real_t home[6] = {0};

void setUp(void)
{
    auvid_excitation_defaults(&cfg);
    cfg.fade_s = 0;
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&e, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_start(&e, 0));
}

static void at(uint64_t t_us)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_step(&e, t_us, wrench));
}

static void schedule(double pause_s, bool one_by_one, uint64_t seed)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_schedule(&cfg, girona500, 10, 4, seed,
                                                              (auvid_real_t)pause_s, one_by_one));
    begin();
}

/* ---- pauses ---- */

static void test_a_pause_before_a_segment_is_zero(void)
{
    cfg.segments = 2;
    for (int i = 0; i < 2; ++i) {
        cfg.segment[i].kind = AUVID_SEGMENT_STEP;
        cfg.segment[i].amplitude = (auvid_real_t)(i + 1);
        cfg.segment[i].duration_s = 2;
        cfg.segment[i].pause_s = 1;
    }
    cfg.duration_s = 12; /* twice */
    begin();
    for (unsigned i = 0; i < 120; ++i) {
        unsigned in = i % 60;
        at(i * (S / 10));
        double expected = in < 10 ? 0 : in < 30 ? 1 : in < 40 ? 0 : 2;
        TEST_ASSERT_EQUAL_DOUBLE(expected, (double)wrench[0]);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 12 * S, wrench));
}

static void test_invalid_pauses_are_refused(void)
{
    cfg.segments = 1;
    cfg.segment[0].duration_s = 1;
    cfg.segment[0].pause_s = -1;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.segment[0].pause_s = 3601;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.segment[0].pause_s = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_excitation_init(&e, &cfg));
}

static void test_sets_with_pauses_play_what_they_play_without(void)
{
    static auvid_excitation_t plain;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        schedule(0, false, seed);
        plain = e;
        schedule(5, false, seed);
        for (uint64_t t_us = 0; t_us < 60 * S; t_us += S / 10) {
            uint64_t set = t_us / (15 * S), in_us = t_us % (15 * S);
            auvid_real_t expected[6] = {0};
            if (in_us >= 5 * S) {
                TEST_ASSERT_EQUAL_INT(
                    AUVID_OK,
                    auvid_excitation_step(&plain, set * 10 * S + in_us - 5 * S, expected));
            }
            at(t_us);
            TEST_ASSERT_EQUAL_MEMORY(expected, wrench, sizeof wrench);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 60 * S, wrench));
    }
}

/* ---- one by one ---- */

static void test_one_by_one_excites_one_degree_of_freedom_at_a_time_in_turn(void)
{
    static const int order[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    schedule(2, true, 7);
    for (uint64_t t_us = 0; t_us < 192 * S; t_us += S / 10) { /* 4 sets, 4 DoF, 12 s */
        uint64_t turn = t_us / (12 * S), in_us = t_us % (12 * S);
        at(t_us);
        for (int j = 0; j < 6; ++j) {
            bool may = j == order[turn % 4] && in_us >= 2 * S;
            TEST_ASSERT_TRUE(may || wrench[j] == 0);
        }
        if (in_us == 5 * S) {
            int segment = e.channel[order[turn % 4]].segment - 1;
            TEST_ASSERT_EQUAL_INT(turn / 4 % 2 == 0 ? AUVID_SEGMENT_STEPS : AUVID_SEGMENT_SINES,
                                  cfg.segment[segment].kind);
            TEST_ASSERT_TRUE(wrench[order[turn % 4]] != 0);
        }
    }
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 192 * S, wrench));
}

static void test_a_schedule_without_pause_all_at_once_is_the_plan(void)
{
    auvid_excitation_config_t plan = cfg;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&plan, girona500, 10, 4, 9));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_schedule(&cfg, girona500, 10, 4, 9, 0, false));
    TEST_ASSERT_EQUAL_MEMORY(&plan, &cfg, sizeof cfg);
}

/* Their periods are 2-3 s: steps of 4-8 s have few transients for drag and inertia. */
static void test_roll_and_pitch_have_faster_signals_than_the_others(void)
{
    const auvid_real_t all[6] = {40, 40, 35, 5, 6, 6};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, all, 90, 8, 1));
    for (int i = 0; i < cfg.segments; ++i) {
        const auvid_segment_t *s = &cfg.segment[i];
        bool quick = s->dof == AUVID_ROLL || s->dof == AUVID_PITCH;
        TEST_ASSERT_EQUAL_DOUBLE(quick ? 1 : 4, (double)s->hold_min_s);
        TEST_ASSERT_EQUAL_DOUBLE(quick ? 2 : 8, (double)s->hold_max_s);
        TEST_ASSERT_TRUE(s->frequency_hz == (quick ? AUVID_C(0.1) : AUVID_C(0.03)));
        TEST_ASSERT_TRUE(s->frequency_high_hz == (quick ? AUVID_C(0.8) : AUVID_C(0.25)));
    }
    begin();
}

/* Sets beyond 256 s need longer steps in roll and pitch: AUVID_EXCITATION_HOLDS. */
static void test_a_plan_of_any_length_can_be_played(void)
{
    const auvid_real_t all[6] = {40, 40, 35, 5, 6, 6};
    for (double set_s = 5; set_s <= 600; set_s += set_s < 300 ? 0.7 : 33.3) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK,
                              auvid_excitation_plan(&cfg, all, (auvid_real_t)set_s, 2, 1));
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&e, &cfg));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, all, 600, 2, 1));
    begin();
    at(299 * S);
    TEST_ASSERT_TRUE(fabs((double)wrench[AUVID_ROLL]) > 0);
}

static void test_a_schedule_refuses_what_it_cannot_make(void)
{
    auvid_excitation_config_t before = cfg;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL,
                          auvid_excitation_schedule(NULL, girona500, 30, 8, 1, 0, false));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL,
                          auvid_excitation_schedule(&cfg, NULL, 30, 8, 1, 0, false));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_excitation_schedule(&cfg, girona500, 30, 8, 1, -1, false));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_excitation_schedule(&cfg, girona500, 30, 8, 1, 601, false));
    TEST_ASSERT_EQUAL_INT(
        AUVID_ERR_NOT_FINITE,
        auvid_excitation_schedule(&cfg, girona500, 30, 8, 1, (auvid_real_t)NAN, false));
    /* 4 x 1200 s between sets of one DoF, and 200 x 4 x 120 s in all */
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_excitation_schedule(&cfg, girona500, 600, 1, 1, 600, true));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_excitation_schedule(&cfg, girona500, 60, 200, 1, 60, true));
    TEST_ASSERT_EQUAL_MEMORY(&before, &cfg, sizeof cfg);
    TEST_ASSERT_EQUAL_INT(AUVID_OK,
                          auvid_excitation_schedule(&cfg, girona500, 300, 1, 1, 600, true));
    begin();
}

/* ---- the excursion limit ---- */

static void test_within_the_excursion_limit_the_wrench_is_unchanged(void)
{
    static auvid_excitation_t free;
    const auvid_real_t inside[6] = {5, -5, 3, 9, -9, AUVID_C(6.28)};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, girona500, 10, 4, 3));
    begin();
    free = e;
    memset(free.cfg.excursion_limit, 0, sizeof free.cfg.excursion_limit);
    for (uint64_t t_us = 0; t_us < 40 * S; t_us += S / 50) {
        auvid_real_t expected[6];
        const auvid_real_t far[6] = {1000, 1000, 1000, 1000, 1000, 1000};
        TEST_ASSERT_EQUAL_INT(AUVID_OK,
                              auvid_excitation_set_displacement(&free, far)); /* no limit */
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_step(&free, t_us, expected));
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, inside));
        at(t_us);
        TEST_ASSERT_EQUAL_MEMORY(expected, wrench, sizeof wrench);
    }
}

/* All steps that begin beyond the limit bring back, for either sign of the amplitude. */
static void test_random_steps_beyond_the_excursion_limit_bring_back(void)
{
    for (uint64_t seed = 0; seed < 20; ++seed) {
        for (int side = -1; side <= 1; side += 2) {
            for (int sign = -1; sign <= 1; sign += 2) {
                const auvid_real_t d[6] = {(auvid_real_t)side * AUVID_C(5.001)};
                setUp();
                TEST_ASSERT_EQUAL_INT(AUVID_OK,
                                      auvid_excitation_plan(&cfg, girona500, 60, 1, seed));
                cfg.segment[0].amplitude *= (auvid_real_t)sign;
                begin();
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, d));
                for (uint64_t t_us = S; t_us < 59 * S; t_us += S / 10) {
                    at(t_us);
                    TEST_ASSERT_TRUE((double)wrench[0] * side < -29);
                }
            }
        }
    }
}

/* The limit and the displacement are in metres and may be fractions. */
static void test_a_limit_of_half_a_metre_brings_back_on_both_sides(void)
{
    for (int side = -1; side <= 1; side += 2) {
        const auvid_real_t d[6] = {(auvid_real_t)side * AUVID_C(0.7)};
        setUp();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, girona500, 60, 1, 1));
        cfg.excursion_limit[AUVID_SURGE] = AUVID_C(0.5);
        begin();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, d));
        for (uint64_t t_us = S; t_us < 59 * S; t_us += S / 10) {
            at(t_us);
            TEST_ASSERT_TRUE((double)wrench[0] * side < -29);
        }
    }
}

/* Wrench of a sine of 20 N in surge with an excursion limit of 5 m, at one displacement. */
static void play_sine(double displacement, double *min_x, double *max_x)
{
    const auvid_real_t d[6] = {(auvid_real_t)displacement};
    setUp();
    cfg.segments = 1;
    cfg.segment[0].kind = AUVID_SEGMENT_SINE;
    cfg.segment[0].amplitude = 20;
    cfg.segment[0].frequency_hz = AUVID_C(0.1);
    cfg.segment[0].duration_s = 20;
    cfg.excursion_limit[AUVID_SURGE] = 5;
    begin();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, d));
    *min_x = INFINITY;
    *max_x = -INFINITY;
    for (uint64_t t_us = 0; t_us < 20 * S; t_us += S / 10) {
        at(t_us);
        *min_x = fmin(*min_x, (double)wrench[0]);
        *max_x = fmax(*max_x, (double)wrench[0]);
    }
}

/* From twice the limit on the bias is the segment's amplitude, no more. */
static void test_a_sine_has_both_signs_within_the_limit_and_one_from_twice_it_on(void)
{
    static const double within[] = {-4.9, 0.0, 4.9}, beyond[] = {-50.0, -10.0, 10.0, 50.0};
    double min_x, max_x;
    for (int i = 0; i < 3; ++i) {
        play_sine(within[i], &min_x, &max_x);
        TEST_ASSERT_TRUE(min_x < -19.9 && max_x > 19.9);
    }
    for (int i = 0; i < 4; ++i) {
        play_sine(beyond[i], &min_x, &max_x);
        double near_zero = beyond[i] > 0 ? max_x : min_x;
        TEST_ASSERT_TRUE(fabs(near_zero) < 0.1);
        TEST_ASSERT_TRUE(beyond[i] > 0 ? min_x < -19.9 : max_x > 19.9);
    }
}

/* At twice the limit, sines also have one sign only, never beyond the peak. */
static void test_the_bias_grows_with_the_distance_and_keeps_the_peak(void)
{
    auvid_real_t peak[6];
    for (uint64_t seed = 0; seed < 20; ++seed) {
        setUp();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, girona500, 30, 2, seed));
        begin();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_peak(&e, peak));
        double mean[3] = {0};
        for (int far = 0; far < 3; ++far) { /* 1, 1.5 and 10 times the limit */
            static const double times[3] = {1.0, 1.5, 10.0};
            const auvid_real_t d[6] = {(auvid_real_t)(5 * times[far]),
                                       (auvid_real_t)(-5 * times[far]),
                                       (auvid_real_t)(3 * times[far]),
                                       0,
                                       0,
                                       (auvid_real_t)(6.2831 * times[far])};
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_start(&e, 0));
            for (uint64_t t_us = 0; t_us < 60 * S; t_us += S / 20) {
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, d));
                at(t_us);
                for (int j = 0; j < 6; ++j) {
                    TEST_ASSERT_TRUE(fabs((double)wrench[j]) <= (double)peak[j]);
                    TEST_ASSERT_TRUE(far < 2 || wrench[j] * d[j] <= 0 || t_us < 8 * S);
                }
                mean[far] += t_us >= 30 * S ? (double)wrench[0] / 600 : 0;
            }
        }
        TEST_ASSERT_TRUE(mean[2] < mean[1] - 15 && mean[1] < mean[0] - 15);
    }
}

static void test_an_invalid_limit_or_displacement_is_refused(void)
{
    auvid_real_t bad[6] = {1, 2, 3, 4, 5, (auvid_real_t)NAN};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, girona500, 30, 2, 1));
    cfg.excursion_limit[4] = -1;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.excursion_limit[4] = (auvid_real_t)INFINITY;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_excitation_init(&e, &cfg));
    cfg.excursion_limit[4] = 0;
    begin();
    auvid_excitation_t before = e;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_excitation_set_displacement(&e, bad));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_set_displacement(&e, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_set_displacement(NULL, home));
    TEST_ASSERT_EQUAL_MEMORY(&before, &e, sizeof e);
}

/* Largest horizontal distance in a run of the plan, 8 sets of 30 s. */
static double largest_distance(uint64_t seed, bool limited, double current, double disturbance_N)
{
    static sim_t sim;
    sim_config_t world;
    sim_output_t seen;
    double max_x = 0;
    setUp();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&cfg, girona500, 30, 8, seed));
    if (!limited) {
        memset(cfg.excursion_limit, 0, sizeof cfg.excursion_limit);
    }
    begin();
    sim_defaults(&world);
    world.seed = seed;
    world.disturbance_N = disturbance_N;
    world.disturbance_Nm = 0.4 * disturbance_N;
    world.current[0] = current * cos(2.4 * (double)seed);
    world.current[1] = current * sin(2.4 * (double)seed);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    for (int k = 0; k < 12000; ++k) {
        const sim_truth_t *t = &sim.truth;
        double r[3][3], moved[3] = {t->position[0], t->position[1], t->position[2] - 50}, f[6];
        auvid_real_t d[6] = {0};
        sim_rotation(t->euler, r);
        for (int j = 0; j < 3; ++j) {
            d[j] = (auvid_real_t)(r[0][j] * moved[0] + r[1][j] * moved[1] + r[2][j] * moved[2]);
        }
        d[AUVID_YAW] = (auvid_real_t)t->euler[2];
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_set_displacement(&e, d));
        at(t->t_us);
        for (int j = 0; j < 6; ++j) {
            f[j] = (double)wrench[j];
        }
        f[2] -= world.parameter[SIM_WB];
        sim_step(&sim, NULL, f, &seen);
        max_x = fmax(max_x, hypot(t->position[0], t->position[1]));
    }
    return max_x;
}

/* The figures of excitation.h, on fewer seeds. The distance is of both axes: a corner of the limits
 * is at 1.4 of one, and the vehicle coasts. */
static void test_the_excursion_limit_holds_against_drift_and_a_current(void)
{
    double still = 0, current = 0, without = 0;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        still = fmax(still, largest_distance(seed, true, 0.0, 3.0));
        current = fmax(current, largest_distance(seed, true, 0.3, 3.0));
        without += largest_distance(seed, false, 0.3, 3.0) / 10;
    }
    TEST_ASSERT_TRUE(still < 15);
    TEST_ASSERT_TRUE(current < 18);
    TEST_ASSERT_TRUE(without > 60);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_pause_before_a_segment_is_zero);
    RUN_TEST(test_invalid_pauses_are_refused);
    RUN_TEST(test_sets_with_pauses_play_what_they_play_without);
    RUN_TEST(test_one_by_one_excites_one_degree_of_freedom_at_a_time_in_turn);
    RUN_TEST(test_a_schedule_without_pause_all_at_once_is_the_plan);
    RUN_TEST(test_roll_and_pitch_have_faster_signals_than_the_others);
    RUN_TEST(test_a_plan_of_any_length_can_be_played);
    RUN_TEST(test_a_schedule_refuses_what_it_cannot_make);
    RUN_TEST(test_within_the_excursion_limit_the_wrench_is_unchanged);
    RUN_TEST(test_random_steps_beyond_the_excursion_limit_bring_back);
    RUN_TEST(test_a_limit_of_half_a_metre_brings_back_on_both_sides);
    RUN_TEST(test_a_sine_has_both_signs_within_the_limit_and_one_from_twice_it_on);
    RUN_TEST(test_the_bias_grows_with_the_distance_and_keeps_the_peak);
    RUN_TEST(test_an_invalid_limit_or_displacement_is_refused);
    RUN_TEST(test_the_excursion_limit_holds_against_drift_and_a_current);
    return UNITY_END();
}
