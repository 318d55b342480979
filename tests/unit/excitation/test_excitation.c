/* The excitation: its signals, amplitude limits, fades, and reproducible repetitions. */
#include "auvid/excitation.h"

#include <math.h>
#include <string.h>

#include "unity.h"

#define PI 3.14159265358979323846
#define S 1000000u /* microseconds */

static auvid_excitation_config_t cfg;
static auvid_excitation_t e;
static auvid_real_t wrench[6];

static const auvid_real_t girona500[6] = {100, 100, 100, 0, 0, 40};

void setUp(void)
{
    auvid_excitation_defaults(&cfg);
    cfg.fade_s = 0;
    memset(&e, 0, sizeof e);
}

void tearDown(void)
{
}

/* One segment in surge. */
static auvid_segment_t *add(auvid_segment_kind_t kind, double amplitude, double duration_s)
{
    auvid_segment_t *s = &cfg.segment[cfg.segments++];
    s->kind = kind;
    s->amplitude = (auvid_real_t)amplitude;
    s->duration_s = (auvid_real_t)duration_s;
    s->frequency_hz = AUVID_C(0.1);
    s->frequency_high_hz = AUVID_C(0.25);
    s->hold_min_s = 4;
    s->hold_max_s = 8;
    s->sines = 1;
    return s;
}

static void begin(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&e, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_start(&e, 0));
}

static void begin_plan(double set_s, unsigned sets, uint64_t seed)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK,
                          auvid_excitation_plan(&cfg, girona500, (auvid_real_t)set_s, sets, seed));
    begin();
}

static double at(uint64_t t_us)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_step(&e, t_us, wrench));
    return (double)wrench[0];
}

static double roughness(void)
{
    return sizeof(auvid_real_t) == sizeof(double) ? 1e-9 : 1e-5;
}

static void test_a_step_holds_its_amplitude(void)
{
    add(AUVID_SEGMENT_STEP, -80, 3);
    begin();
    TEST_ASSERT_EQUAL_DOUBLE(-80.0, at(0));
    TEST_ASSERT_EQUAL_DOUBLE(-80.0, at(3 * S - 1));
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 3 * S, wrench));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)wrench[0]);
}

static void test_a_ramp_is_a_straight_line(void)
{
    add(AUVID_SEGMENT_RAMP, 30, 4)->from = -10;
    begin();
    for (unsigned i = 0; i < 40; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(40 * roughness(), -10.0 + i, at(i * (S / 10)));
    }
}

static void test_a_sine_is_the_sine_of_the_C_library(void)
{
    auvid_segment_t *s = add(AUVID_SEGMENT_SINE, 50, 100);
    s->frequency_hz = AUVID_C(0.25);
    s->phase = AUVID_C(1.5);
    begin();
    for (unsigned i = 0; i < 1000; ++i) {
        double t = 0.1 * i;
        TEST_ASSERT_DOUBLE_WITHIN(100 * roughness(), 50 * sin(2 * PI * 0.25 * t + 1.5),
                                  at(i * (S / 10)));
    }
}

static void test_a_pause_is_zero_and_segments_follow_in_order(void)
{
    add(AUVID_SEGMENT_STEP, 1, 1);
    add(AUVID_SEGMENT_PAUSE, 99, 1);
    add(AUVID_SEGMENT_STEP, 2, 1);
    begin();
    TEST_ASSERT_EQUAL_DOUBLE(1.0, at(S - 1));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at(S));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at(2 * S - 1));
    TEST_ASSERT_EQUAL_DOUBLE(2.0, at(2 * S));
}

static void test_degrees_of_freedom_play_in_parallel(void)
{
    add(AUVID_SEGMENT_STEP, 1, 1);
    add(AUVID_SEGMENT_STEP, 2, 2)->dof = AUVID_YAW;
    add(AUVID_SEGMENT_STEP, 3, 1);
    begin();
    at(S / 2);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)wrench[AUVID_SURGE]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, (double)wrench[AUVID_YAW]);
    at(S + S / 2);
    TEST_ASSERT_EQUAL_DOUBLE(3.0, (double)wrench[AUVID_SURGE]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, (double)wrench[AUVID_YAW]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)wrench[AUVID_HEAVE]);
}

static void test_the_sequence_repeats_until_the_run_is_over(void)
{
    add(AUVID_SEGMENT_STEP, 1, 1);
    add(AUVID_SEGMENT_PAUSE, 0, 1);
    cfg.duration_s = 7;
    begin();
    for (unsigned i = 0; i < 70; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE((i / 10) % 2 == 0 ? 1.0 : 0.0, at(i * (S / 10)));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 7 * S, wrench));
}

static void test_the_run_fades_in_and_out_with_a_raised_cosine(void)
{
    add(AUVID_SEGMENT_STEP, 100, 10);
    cfg.fade_s = 2;
    begin();
    for (unsigned i = 0; i < 1000; ++i) {
        double t = i * 0.01, in = t < 2 ? t : t > 8 ? 10 - t : 2;
        TEST_ASSERT_DOUBLE_WITHIN(100 * roughness(), 50 - 50 * cos(PI * in / 2), at(i * (S / 100)));
    }
}

static void test_a_segment_fades_in_and_out(void)
{
    add(AUVID_SEGMENT_STEP, 100, 4)->fade_s = 1;
    add(AUVID_SEGMENT_STEP, -100, 4)->fade_s = 2;
    begin();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, at(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 50.0, at(S / 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100.0, at(2 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 50.0, at(3 * S + S / 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, at(4 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -50.0, at(5 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -100.0, at(6 * S));
}

static void test_stop_fades_out_and_ends(void)
{
    add(AUVID_SEGMENT_STEP, 100, 60);
    cfg.fade_s = 2;
    begin();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100.0, at(30 * S));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_stop(&e, 30 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100.0, at(30 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 50.0, at(31 * S));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_stop(&e, 31 * S)); /* no second fade */
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, at(32 * S - 10000));
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 32 * S, wrench));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)auvid_excitation_progress(&e));
}

static void test_progress_is_at_most_1_if_the_stop_comes_late(void)
{
    add(AUVID_SEGMENT_STEP, 100, 10);
    begin();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_stop(&e, 1000 * S));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)auvid_excitation_progress(&e));
}

static void test_runs_and_sequences_of_microseconds_are_refused(void)
{
    add(AUVID_SEGMENT_STEP, 100, 1e-6);
    cfg.duration_s = 86400;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.segment[0].duration_s = 1;
    cfg.duration_s = AUVID_C(1e-7);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
}

static void test_no_wrench_before_start_and_after_the_end(void)
{
    add(AUVID_SEGMENT_STEP, 100, 1);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&e, &cfg));
    memset(wrench, 0x55, sizeof wrench);
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 5, wrench));
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)wrench[i]);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)auvid_excitation_progress(&e));
}

static void test_time_that_goes_back_gives_no_wrench_and_does_no_harm(void)
{
    add(AUVID_SEGMENT_STEP, 100, 10);
    begin();
    at(5 * S);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_excitation_step(&e, 5 * S - 1, wrench));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)wrench[0]);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_excitation_stop(&e, 5 * S - 1));
    TEST_ASSERT_EQUAL_DOUBLE(100.0, at(5 * S));
}

static void test_progress_runs_from_0_to_1(void)
{
    add(AUVID_SEGMENT_STEP, 100, 10);
    begin();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)auvid_excitation_progress(&e));
    at(5 * S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, (double)auvid_excitation_progress(&e));
    auvid_excitation_step(&e, 11 * S, wrench);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)auvid_excitation_progress(&e));
}

static void test_peak_is_the_largest_of_each_degree_of_freedom(void)
{
    auvid_real_t peak[6];
    add(AUVID_SEGMENT_STEP, -7, 1);
    add(AUVID_SEGMENT_RAMP, 3, 1)->from = -9;
    add(AUVID_SEGMENT_PAUSE, 50, 1);
    add(AUVID_SEGMENT_SINES, 4, 1)->dof = AUVID_YAW;
    begin();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_peak(&e, peak));
    TEST_ASSERT_EQUAL_DOUBLE(9.0, (double)peak[0]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, (double)peak[5]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)peak[1]);
}

/* Return the lowest peak of the sums of sines in sets of set_s, relative to the amplitude: 60
 * seeds, all DoFs with an amplitude, 100 Hz. The amplitude is never exceeded. */
static double lowest_peak(const auvid_real_t amplitude[6], unsigned set_s)
{
    double lowest = 1.0;
    for (uint64_t seed = 0; seed < 60; ++seed) {
        double max_wrench[6] = {0};
        TEST_ASSERT_EQUAL_INT(AUVID_OK,
                              auvid_excitation_plan(&cfg, amplitude, (auvid_real_t)set_s, 2, seed));
        for (int i = 0; i < cfg.segments; ++i) {
            cfg.segment[i].fade_s = 0; /* a peak within a fade would not be reached */
        }
        begin();
        for (unsigned i = 0; i < 200 * set_s; ++i) {
            at(i * (S / 100));
            for (int d = 0; d < 6; ++d) {
                TEST_ASSERT_TRUE(fabs((double)wrench[d]) <= (double)amplitude[d]);
                if (i >= 100 * set_s) {
                    max_wrench[d] = fmax(max_wrench[d], fabs((double)wrench[d]));
                }
            }
        }
        for (int d = 0; d < 6; ++d) {
            if (amplitude[d] > 0) {
                lowest = fmin(lowest, max_wrench[d] / (double)amplitude[d]);
                /* Below it without clipping. */
                TEST_ASSERT_TRUE(max_wrench[d] < (double)amplitude[d]);
            }
        }
    }
    return lowest;
}

static void test_a_plan_keeps_to_its_amplitude_and_uses_it(void)
{
    const auvid_real_t righted[6] = {0, 0, 0, 5, 6, 0};
    TEST_ASSERT_TRUE_MESSAGE(lowest_peak(girona500, 30) >= 0.93,
                             "peak of a sum of sines below 0.93 of its amplitude");
    TEST_ASSERT_TRUE(lowest_peak(righted, 30) >= 0.9);
    TEST_ASSERT_TRUE(lowest_peak(girona500, 10) >= 0.8);
}

static void test_a_plan_with_fades_is_continuous(void)
{
    double before[6] = {0};
    cfg.fade_s = 2;
    begin_plan(30, 4, 7);
    /* Steepest: a change of 2 A within 0.2 s, pi / 2 times its mean slope. */
    double slope = 2.0 * PI / 2.0 / 0.2;
    for (unsigned i = 0; i < 120000; ++i) {
        at(i * (S / 1000));
        for (int d = 0; d < 6; ++d) {
            double change = fabs((double)wrench[d] - before[d]);
            TEST_ASSERT_TRUE(change <= 1.01 * slope * 0.001 * (double)girona500[d] + 1e-4);
            before[d] = (double)wrench[d];
        }
    }
    for (int d = 0; d < 6; ++d) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, before[d]);
    }
}

static void test_the_wrench_does_not_depend_on_the_previous_ticks(void)
{
    static auvid_real_t every[8000][6];
    cfg.fade_s = 2;
    begin_plan(20, 8, 3);
    for (unsigned i = 0; i < 8000; ++i) {
        at(i * 20000u);
        memcpy(every[i], wrench, sizeof wrench);
    }
    auvid_excitation_start(&e, 12345);
    for (unsigned i = 0; i < 8000; i += 1 + (i * 7919u) % 3001u) {
        at(12345 + i * 20000u);
        TEST_ASSERT_EQUAL_MEMORY(every[i], wrench, sizeof wrench);
    }
}

static void test_seeds_repetitions_and_degrees_of_freedom_differ(void)
{
    static double y[3][6][6000];
    for (unsigned seed = 0; seed < 3; ++seed) {
        begin_plan(30, 4, seed);
        for (unsigned i = 0; i < 6000; ++i) {
            at(i * 20000u);
            for (int d = 0; d < 6; ++d) {
                y[seed][d][i] = (double)wrench[d] / (d == 5 ? 40.0 : 100.0);
            }
        }
    }
    double seeds = 0, repetitions = 0, dofs = 0; /* mean square of the difference */
    for (unsigned i = 0; i < 3000; ++i) {
        seeds += pow(y[1][0][i] - y[2][0][i], 2) / 3000;
        repetitions += pow(y[1][0][i] - y[1][0][i + 3000], 2) / 3000;
        dofs += pow(y[1][0][i] - y[1][5][i], 2) / 3000;
    }
    TEST_ASSERT_TRUE(seeds > 0.1 && repetitions > 0.1 && dofs > 0.1);
}

/* 400 seeds of a 300 s segment: about 20000 holds. Two neighbours may be equal, so the test reads
 * the ends of holds from the state. Frequencies of signs and levels and the mean hold are within
 * four standard deviations. */
static void test_random_steps_have_the_documented_holds_levels_and_signs(void)
{
    double holds = 0, changes = 0, hold_sum = 0, high = 0, first_positive = 0;
    add(AUVID_SEGMENT_STEPS, 100, 300);
    for (cfg.seed = 0; cfg.seed < 400; ++cfg.seed) {
        begin();
        double level = at(0);
        uint32_t since = 0;
        first_positive += level > 0;
        for (unsigned i = 1; i < 15000; ++i) {
            double y = at(i * 20000u);
            uint32_t from = e.channel[0].hold_from_us;
            if (from > since) {
                TEST_ASSERT_TRUE(fabs(fabs(level) - 30.0) < 1e-3 || fabs(level) == 100.0);
                TEST_ASSERT_TRUE(from - since >= 4 * S && from - since <= 8 * S);
                holds += 1;
                changes += (y > 0) != (level > 0);
                hold_sum += (from - since) * 1e-6;
                high += fabs(level) == 100.0;
                since = from;
                level = y;
            }
            TEST_ASSERT_EQUAL_DOUBLE(level, y);
        }
    }
    TEST_ASSERT_TRUE(holds > 15000);
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(0.75 * 0.25 / holds), 0.75, changes / holds);
    TEST_ASSERT_DOUBLE_WITHIN(4 * 0.5 / sqrt(holds), 0.5, high / holds);
    /* Uniform in 4..8 s: deviation 4 / sqrt 12. The hold that reaches past the end is not
     * counted; it is longer than the mean by variance over mean, 0.22 s, and one in 50. */
    TEST_ASSERT_DOUBLE_WITHIN(0.0045 + 4 * 4 / sqrt(12 * holds), 6.0, hold_sum / holds);
    TEST_ASSERT_DOUBLE_WITHIN(4 * 0.5 / sqrt(400.0), 0.5, first_positive / 400);
}

static double impulse_of_steps(bool pairs, double fade_s, uint64_t seed)
{
    double sum = 0;
    setUp();
    auvid_segment_t *s = add(AUVID_SEGMENT_STEPS, 100, 60);
    s->pairs = pairs;
    s->fade_s = (auvid_real_t)fade_s;
    cfg.seed = seed;
    begin();
    for (unsigned i = 0; i < 60000; ++i) {
        sum += at(i * (S / 1000) + 500) * 0.001;
    }
    return sum;
}

static void test_steps_in_pairs_leave_no_impulse(void)
{
    double unpaired = 0;
    for (uint64_t seed = 0; seed < 10; ++seed) {
        /* The sum resolves the end of a hold to a millisecond: 0.2 Ns each. */
        TEST_ASSERT_DOUBLE_WITHIN(1.5, 0.0, impulse_of_steps(true, 0.0, seed));
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, impulse_of_steps(true, 1.0, seed));
        unpaired = fmax(unpaired, fabs(impulse_of_steps(false, 1.0, seed)));
    }
    TEST_ASSERT_TRUE(unpaired > 100.0);
}

static void test_sines_lie_geometrically_between_the_two_frequencies(void)
{
    for (uint64_t seed = 0; seed < 50; ++seed) {
        begin_plan(30, 2, seed);
        at(31 * S);
        for (int i = 0; i < 5; ++i) {
            double f = 1.0 / 30 * pow(0.25 * 30, i / 4.0);
            double ratio = (double)e.channel[AUVID_SWAY].frequency_hz[i] / f;
            TEST_ASSERT_TRUE(ratio > 0.8799 && ratio < 1.1201);
        }
    }
}

static void test_a_plan_alternates_steps_and_sines_for_the_sets_asked(void)
{
    begin_plan(10, 3, 1);
    TEST_ASSERT_EQUAL_INT(8, cfg.segments);
    at(5 * S);
    TEST_ASSERT_EQUAL_INT(AUVID_SEGMENT_STEPS, cfg.segment[e.channel[0].segment - 1].kind);
    at(15 * S);
    TEST_ASSERT_EQUAL_INT(AUVID_SEGMENT_SINES, cfg.segment[e.channel[0].segment - 1].kind);
    at(25 * S);
    TEST_ASSERT_EQUAL_INT(AUVID_SEGMENT_STEPS, cfg.segment[e.channel[0].segment - 1].kind);
    TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, auvid_excitation_step(&e, 30 * S, wrench));
}

static void test_plan_refuses_what_it_cannot_make(void)
{
    const auvid_real_t none[6] = {0}, negative[6] = {-1}, nan[6] = {(auvid_real_t)NAN};
    auvid_excitation_config_t before = cfg;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_plan(NULL, girona500, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_plan(&cfg, NULL, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_excitation_plan(&cfg, nan, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE,
                          auvid_excitation_plan(&cfg, girona500, (auvid_real_t)INFINITY, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_plan(&cfg, none, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_plan(&cfg, negative, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_plan(&cfg, girona500, 4, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_plan(&cfg, girona500, 30, 0, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_plan(&cfg, girona500, 600, 1000, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &cfg, sizeof cfg);
}

typedef struct {
    const char *what;
    auvid_status_t status;
    auvid_segment_t segment;
} refused_t;

static void test_init_refuses_a_bad_segment_and_names_why(void)
{
    const auvid_real_t nan = (auvid_real_t)NAN;
    const refused_t refused[] = {
        {"dof", AUVID_ERR_RANGE, {.dof = AUVID_DOF_COUNT, .duration_s = 1}},
        {"kind", AUVID_ERR_RANGE, {.kind = AUVID_SEGMENT_KIND_COUNT, .duration_s = 1}},
        {"length", AUVID_ERR_RANGE, {.duration_s = 0}},
        {"negative", AUVID_ERR_RANGE, {.duration_s = -1}},
        {"too long", AUVID_ERR_RANGE, {.duration_s = 3601}},
        {"nan", AUVID_ERR_NOT_FINITE, {.duration_s = nan}},
        {"nan", AUVID_ERR_NOT_FINITE, {.duration_s = 1, .amplitude = nan}},
        {"nan", AUVID_ERR_NOT_FINITE, {.duration_s = 1, .hold_max_s = nan}},
        {"amplitude", AUVID_ERR_RANGE, {.duration_s = 1, .amplitude = 2e6f}},
        {"fade", AUVID_ERR_RANGE, {.duration_s = 1, .fade_s = 0.6f}},
        {"sines", AUVID_ERR_SIZE, {.kind = AUVID_SEGMENT_SINES, .duration_s = 1}},
        {"sines",
         AUVID_ERR_SIZE,
         {.kind = AUVID_SEGMENT_SINES, .duration_s = 1, .sines = AUVID_MAX_SINES + 1}},
        {"frequency",
         AUVID_ERR_RANGE,
         {.kind = AUVID_SEGMENT_SINES, .duration_s = 1, .sines = 1, .frequency_hz = 1}},
        {"frequency", AUVID_ERR_RANGE, {.kind = AUVID_SEGMENT_SINE, .duration_s = 1}},
        {"hold", AUVID_ERR_RANGE, {.kind = AUVID_SEGMENT_STEPS, .duration_s = 1}},
        {"holds",
         AUVID_ERR_RANGE,
         {.kind = AUVID_SEGMENT_STEPS, .duration_s = 1000, .hold_min_s = 3, .hold_max_s = 4}},
        {"fade longer than a hold",
         AUVID_ERR_RANGE,
         {.kind = AUVID_SEGMENT_STEPS,
          .duration_s = 10,
          .fade_s = 2,
          .hold_min_s = 1,
          .hold_max_s = 2}},
    };
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; ++i) {
        auvid_excitation_t before;
        cfg.segments = 1;
        cfg.segment[0] = refused[i].segment;
        memset(&e, 0x5a, sizeof e);
        before = e;
        TEST_ASSERT_EQUAL_INT_MESSAGE(refused[i].status, auvid_excitation_init(&e, &cfg),
                                      refused[i].what);
        TEST_ASSERT_EQUAL_MEMORY(&before, &e, sizeof e);
    }
}

static void test_init_refuses_a_bad_run(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_init(NULL, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_init(&e, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE, auvid_excitation_init(&e, &cfg));
    cfg.segments = AUVID_MAX_SEGMENTS + 1;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE, auvid_excitation_init(&e, &cfg));
    cfg.segments = 0;
    add(AUVID_SEGMENT_STEP, 1, 10);
    cfg.fade_s = AUVID_C(5.1);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.fade_s = -1;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
    cfg.fade_s = 5;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&e, &cfg));
    cfg.duration_s = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_excitation_init(&e, &cfg));
    cfg.duration_s = 90000;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_excitation_init(&e, &cfg));
}

static void test_null_is_refused(void)
{
    auvid_real_t peak[6];
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_start(NULL, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_stop(NULL, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_step(&e, 0, NULL));
    wrench[0] = 1;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_step(NULL, 0, wrench));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)wrench[0]);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_peak(NULL, peak));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_excitation_peak(&e, NULL));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)auvid_excitation_progress(NULL));
    auvid_excitation_defaults(NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_step_holds_its_amplitude);
    RUN_TEST(test_a_ramp_is_a_straight_line);
    RUN_TEST(test_a_sine_is_the_sine_of_the_C_library);
    RUN_TEST(test_a_pause_is_zero_and_segments_follow_in_order);
    RUN_TEST(test_degrees_of_freedom_play_in_parallel);
    RUN_TEST(test_the_sequence_repeats_until_the_run_is_over);
    RUN_TEST(test_the_run_fades_in_and_out_with_a_raised_cosine);
    RUN_TEST(test_a_segment_fades_in_and_out);
    RUN_TEST(test_stop_fades_out_and_ends);
    RUN_TEST(test_progress_is_at_most_1_if_the_stop_comes_late);
    RUN_TEST(test_runs_and_sequences_of_microseconds_are_refused);
    RUN_TEST(test_no_wrench_before_start_and_after_the_end);
    RUN_TEST(test_time_that_goes_back_gives_no_wrench_and_does_no_harm);
    RUN_TEST(test_progress_runs_from_0_to_1);
    RUN_TEST(test_peak_is_the_largest_of_each_degree_of_freedom);
    RUN_TEST(test_a_plan_keeps_to_its_amplitude_and_uses_it);
    RUN_TEST(test_a_plan_with_fades_is_continuous);
    RUN_TEST(test_the_wrench_does_not_depend_on_the_previous_ticks);
    RUN_TEST(test_seeds_repetitions_and_degrees_of_freedom_differ);
    RUN_TEST(test_random_steps_have_the_documented_holds_levels_and_signs);
    RUN_TEST(test_steps_in_pairs_leave_no_impulse);
    RUN_TEST(test_sines_lie_geometrically_between_the_two_frequencies);
    RUN_TEST(test_a_plan_alternates_steps_and_sines_for_the_sets_asked);
    RUN_TEST(test_plan_refuses_what_it_cannot_make);
    RUN_TEST(test_init_refuses_a_bad_segment_and_names_why);
    RUN_TEST(test_init_refuses_a_bad_run);
    RUN_TEST(test_null_is_refused);
    return UNITY_END();
}
