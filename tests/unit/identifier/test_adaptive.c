/* Adaptive excitation: it excites for missing information within its limits, and ends by itself. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/adaptive.h"
#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "auvid/uncertain.h"
#include "binomial.h"
#include "chain.h"
#include "unity.h"

enum { N = 13, ALL = 0x1FFF, SWAY_ONES = 1 << 1 | 1 << 7 | 1 << 8 };

static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};

static chain_config_t config;
static chain_t chain;
static auvid_adaptive_config_t cfg;

/* Observations of a run. */
static struct {
    bool over;     /* a wrench exceeded an amplitude or the thrusters */
    bool outside;  /* a wrench while the guard was not EXCITING */
    double done_s; /* when everything was known; 0: not yet */
    double square; /* mean square error at that time */
    double rest_s; /* when the excitation had faded out: SETTLING; 0: not yet */
    double end_s;  /* when the guard was DONE; 0: not yet */
    uint32_t changed;
} seen;

static void watch(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    (void)status;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double f = fabs((double)out->excitation[j]);
        seen.over = seen.over || !(f <= (double)cfg.amplitude[j] * 1.000001);
        seen.outside = seen.outside || (f > 0.0 && out->guard != AUVID_GUARD_EXCITING);
    }
    seen.over = seen.over || c->actuation.saturated;
    seen.changed += (out->events & AUVID_EVENT_CHANGED) != 0;
    if (seen.done_s <= 0.0 && c->id.estimate.confidence.identifiable == ALL) {
        seen.done_s = 1e-6 * (double)c->t_us;
        seen.square = chain_mean_square(c);
    }
    if (seen.rest_s <= 0.0 && out->guard == AUVID_GUARD_SETTLING) {
        seen.rest_s = 1e-6 * (double)c->t_us;
    }
    if (seen.end_s <= 0.0 && out->guard == AUVID_GUARD_DONE) {
        seen.end_s = 1e-6 * (double)c->t_us;
    }
}

/* A world with bounds for vehicles of all sizes. */
static void make_world(uint64_t seed, double disturbance_N)
{
    chain_defaults(&config, seed, 16, disturbance_N);
    for (int i = 0; i < N; ++i) {
        config.id.search.lower[i] = -4000;
        config.id.search.upper[i] = 4000;
    }
    config.after = watch;
    memset(&seen, 0, sizeof seen);
    auvid_adaptive_defaults(&cfg);
    memcpy(cfg.amplitude, amplitude, sizeof cfg.amplitude);
    cfg.seed = seed;
}

void setUp(void)
{
    make_world(1, 1.0);
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
}

/* Run until the guard is DONE or ABORTED, at most max_s. */
static void run(double max_s)
{
    while (1e-6 * (double)chain.t_us < max_s && chain.out.guard != AUVID_GUARD_DONE &&
           chain.out.guard != AUVID_GUARD_ABORTED) {
        chain_tick(&chain);
    }
}

static void test_it_ends_by_itself_when_everything_is_known(void)
{
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    /* at once: with the fade and two ticks */
    const double fade_s = (double)chain.actuation.excitation.cfg.fade_s;
    TEST_ASSERT_TRUE(seen.rest_s > 0.0 && seen.rest_s <= seen.done_s + fade_s + 0.04);
    TEST_ASSERT_FALSE(seen.over);
    TEST_ASSERT_FALSE(seen.outside);
    TEST_ASSERT_TRUE((chain.events & AUVID_EVENT_EXCITATION_DONE) != 0);
}

/* What cannot become known is not waited for. */
static void test_it_ends_with_a_degree_of_freedom_in_closed_loop(void)
{
    const uint32_t heave = 1u << 2 | 1u << 4 | 1u << 9 | 1u << 10;
    config.id.metric.closed_loop = AUVID_DOF_BIT(AUVID_HEAVE);
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(ALL & ~heave, chain.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing | chain.adaptive.abandoned);
}

/* The estimate that the user reads decides, not the one with the inputs as supplied, which is known
 * sooner. */
static void test_with_uncertain_inputs_it_ends_when_the_estimate_with_them_is_known(void)
{
    static auvid_uncertain_t uncertain;
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        make_world(seed, 0.3);
        config.id.exact_inputs = false;
        config.id.uncertainty.thrust_scale = AUVID_C(0.05);
        begin();
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &uncertain,
                                                                      &inputs, &chain.allocation));
        run(600);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
        const auvid_estimate_t *e = auvid_identifier_estimate(&chain.id);
        TEST_ASSERT_TRUE(e == &uncertain.estimate);
        for (int i = 0; i < N; ++i) { /* or no motion helps */
            auvid_note_t note = (auvid_note_t)e->confidence.note[i];
            bool abandoned = (chain.adaptive.abandoned >> i & 1u) != 0;
            uint32_t ended = e->confidence.identifiable | chain.adaptive.abandoned;
            TEST_ASSERT_TRUE(!abandoned || i == AUVID_G500_W_B || note == AUVID_NOTE_INPUTS);
            TEST_ASSERT_TRUE((ended >> i & 1u) != 0 || note == AUVID_NOTE_THRUST_SCALE ||
                             note == AUVID_NOTE_SMALL);
        }
    }
}

static void test_a_run_may_be_begun_again(void)
{
    begin();
    run(300);
    double first_s = 1e-6 * (double)chain.t_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    chain.waiting = true;
    chain_tick(&chain);
    run(600); /* everything is known: nothing remains to be done */
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_TRUE(1e-6 * (double)chain.t_us < first_s + 12.0);
}

/* A prior from the last dive does not count as known until a set has confirmed it. */
static void test_dives_with_a_prior_record_end_sooner_but_not_without_a_set(void)
{
    enum { DIVES = 10 };
    uint8_t record[AUVID_PRIOR_BYTES];
    double cold_s = 0, prior_s = 0;
    for (uint64_t dive = 1; dive <= DIVES; ++dive) {
        begin();
        run(300);
        cold_s += seen.end_s;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
        make_world(100 + dive, 1.0);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
        run(300);
        prior_s += seen.end_s;
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
        TEST_ASSERT_TRUE(chain.id.metric.sets.recorded >= 1);
        make_world(1 + dive, 1.0);
    }
    printf("mean time until the end: %.1f s, with a prior %.1f s\n", cold_s / DIVES,
           prior_s / DIVES);
    TEST_ASSERT_TRUE(prior_s < 0.75 * cold_s);
}

static void test_without_a_side_thruster_coupling_identifies_sway(void)
{
    config.thrusters.thruster[4].min_N = config.thrusters.thruster[4].max_N = 0;
    config.acting.excitation.segments = 0; /* the excitation would reject that plan */
    begin();
    chain.waiting = true;
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SWAY, chain.id.estimate.coupled);
    TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(&chain, i)) < 0.2);
    }
}

/* Without yaw moment only disturbances turn the vehicle. */
static void test_sway_that_hardly_moves_is_abandoned(void)
{
    const uint32_t drag = 1u << SIM_Y_V | 1u << SIM_Y_VV;
    config.thrusters.thruster[4].min_N = config.thrusters.thruster[4].max_N = 0;
    config.acting.excitation.segments = 0;
    cfg.amplitude[AUVID_YAW] = 0;
    begin();
    chain.waiting = true;
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(drag, chain.adaptive.abandoned & drag);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable & drag);
}

/* The sway thruster runs without effect: an infinite mass. */
static void test_a_dof_that_does_not_move_is_abandoned_in_time(void)
{
    config.sim.parameter[SIM_M_V] = 1e9;
    begin();
    run(450);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(SWAY_ONES, chain.adaptive.abandoned & SWAY_ONES);
    TEST_ASSERT_TRUE(seen.end_s < 250.0);
}

static void test_weak_thrusters_excite_in_turn_and_everything_is_known(void)
{
    for (int i = 0; i < 5; ++i) { /* X or N, not both */
        config.thrusters.thruster[i].min_N = i < 2 ? -60 : -153;
        config.thrusters.thruster[i].max_N = i < 2 ? 60 : 153;
    }
    config.acting.excitation.segments = 0;
    begin();
    chain.waiting = true;
    uint8_t together = 0, ever = 0;
    while (1e-6 * (double)chain.t_us < 450 && chain.out.guard != AUVID_GUARD_DONE) {
        chain_tick(&chain);
        uint8_t driving = chain.adaptive.playing;
        ever |= driving;
        together |= (driving & 0x21) == 0x21;
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, together);
    TEST_ASSERT_EQUAL_HEX32(0x27, ever);
    TEST_ASSERT_FALSE(seen.over);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
}

static void test_it_ends_after_the_longest_run_time(void)
{
    cfg.max_s = 40;
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_TRUE(seen.end_s < 52.0);
    TEST_ASSERT_TRUE(chain.adaptive.missing != 0); /* and reports what is missing */
}

static void test_the_operator_ends_it_with_a_fade_or_at_once(void)
{
    begin();
    chain_run(&chain, 20);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id));
    run(40);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    begin();
    chain_run(&chain, 20);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    chain_run(&chain, 5);
    TEST_ASSERT_FALSE(seen.outside);
}

static void test_a_limit_of_the_guard_ends_it(void)
{
    config.acting.guard.distance_max_m = 3;
    cfg.excursion_limit[AUVID_SURGE] = cfg.excursion_limit[AUVID_SWAY] = 0; /* never brought back */
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISTANCE, chain.out.cause);
    TEST_ASSERT_FALSE(seen.outside);
}

/* The default excursion limit of 5 m would equal the distance at which the guard aborts. */
static void test_with_a_small_distance_limit_it_is_brought_back_in_time(void)
{
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        make_world(seed, 1.0);
        config.acting.guard.distance_max_m = 5;
        begin();
        run(300);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    }
}

/* In heave a part of the depths that the guard permits; none, which is 0, would be no limit. */
static void test_heave_stays_within_the_depths_of_the_guard(void)
{
    static const double depths[][3] = {{1, 12, 1.65}, {1, 100, 3}, {5, 5, 0.1}};
    for (size_t k = 0; k < sizeof depths / sizeof depths[0]; ++k) {
        make_world(1, 1.0);
        config.acting.guard.depth_min_m = (auvid_real_t)depths[k][0];
        config.acting.guard.depth_max_m = (auvid_real_t)depths[k][1];
        begin();
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, depths[k][2],
            (double)chain.id.actuation->excitation.cfg.excursion_limit[AUVID_HEAVE]);
    }
}

static void check_refused(auvid_status_t status)
{
    static auvid_identifier_t before;
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    setUp();
}

static void test_an_invalid_configuration_is_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(NULL, &chain.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(&chain.id, &chain.adaptive, NULL, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(&chain.id, NULL, &cfg, NULL));
    auvid_adaptive_defaults(NULL);
    memset(cfg.amplitude, 0, sizeof cfg.amplitude);
    check_refused(AUVID_ERR_RANGE);
    cfg.amplitude[0] = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.excursion_limit[5] = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.max_s = 29;
    check_refused(AUVID_ERR_RANGE);
    cfg.max_s = 3601;
    check_refused(AUVID_ERR_RANGE);
    cfg.amplitude[2] = (auvid_real_t)NAN;
    check_refused(AUVID_ERR_NOT_FINITE);
    cfg.excursion_limit[2] = (auvid_real_t)INFINITY;
    check_refused(AUVID_ERR_NOT_FINITE);
    cfg.amplitude[0] = 400;
    check_refused(AUVID_ERR_CAPACITY);
}

static void test_calls_out_of_order_are_refused(void)
{
    memset(&chain, 0, sizeof chain);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE,
                      auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    begin();
    chain_run(&chain, 5); /* exciting */
    check_refused(AUVID_ERR_STATE);
}

static chain_t other;
static uint8_t bytes[AUVID_CHECKPOINT_MAX(0)];

/* @return bytes of a checkpoint of chain. */
static uint32_t save(void)
{
    auvid_checkpoint_t cursor;
    uint32_t count = sizeof bytes;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, bytes, &count));
    return count;
}

/* Restore into other, where an adaptive excitation has been begun; both continue equally. */
static void restore_and_continue(uint32_t count, int seconds)
{
    other = chain;
    memset(&other.id, 0xA5, sizeof other.id);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&other, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&other.id, &other.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(&other.id, bytes, count));
    for (int k = 0; k < seconds * 50; ++k) {
        chain_tick(&chain);
        chain_tick(&other);
        TEST_ASSERT_EQUAL_MEMORY(chain.out.excitation, other.out.excitation,
                                 sizeof chain.out.excitation);
    }
}

static void test_a_checkpoint_continues_bit_for_bit(void)
{
    begin();
    chain_run(&chain, 65);
    restore_and_continue(save(), 60);
    TEST_ASSERT_TRUE(chain.id.estimate.number > 2);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, other.out.guard);
    TEST_ASSERT_EQUAL_MEMORY(chain.id.estimate.pi, other.id.estimate.pi,
                             sizeof chain.id.estimate.pi);
}

/* As a sequence its plan would excite all degrees of freedom together, at full amplitude. */
static void test_a_checkpoint_of_it_is_refused_where_it_has_not_been_begun(void)
{
    static auvid_identifier_t before;
    begin();
    uint32_t count = save();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_checkpoint_resume(&chain.id, bytes, count));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_a_checkpoint_of_a_sequence_is_refused_where_it_has_been_begun(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 5);
    uint32_t count = save();
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_checkpoint_restore(&chain.id, bytes, count));
}

/* ---- comparison with the plan ---- */

enum { MOST_RUNS = 100, MAX_S = 480, SETS = MAX_S / 30, RESAMPLES = 1000 };

enum { ADAPTIVE, AT_ONCE, ONE_BY_ONE, WAYS };

/* Of one run: time until everything was known, at most MAX_S (one by one four times that); mean
 * square error at the run's end, or after each set. */
typedef struct {
    double done_s[WAYS], end_s, end_square, square[SETS + 1], set_s[SETS + 1];
    double known_square[WAYS]; /* mean square error when everything was known */
    bool known[WAYS];
} outcome_t;

static outcome_t outcome[MOST_RUNS];
static uint32_t aborted, gave_up, false_alarms;
static bool over;

/* One of many vehicles: each mass and drag of the Girona500 up to halved or doubled. */
static void vary(uint64_t seed)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 77);
    for (int i = 0; i < N; ++i) {
        double f = exp2(2.0 * sim_rng_uniform(&rng) - 1.0);
        config.sim.parameter[i] *= i == SIM_WB ? 1.0 : f;
    }
}

static void run_one(uint32_t seed, double disturbance_N, bool other, int way)
{
    outcome_t *o = &outcome[seed - 1];
    double max_s = way == ONE_BY_ONE ? 4.0 * MAX_S : MAX_S;
    uint32_t number = 0;
    make_world(seed, disturbance_N);
    if (way == ONE_BY_ONE) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_schedule(&config.acting.excitation, amplitude,
                                                              30, SETS, seed, 0, true));
    }
    config.acting.guard.run_max_s = 3600; /* one by one takes longer */
    if (other) {
        vary(seed);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    if (way == ADAPTIVE) {
        cfg.max_s = MAX_S;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    }
    const auvid_estimate_t *e = &chain.id.estimate;
    while (1e-6 * (double)chain.t_us < max_s + 12.0 && chain.out.guard != AUVID_GUARD_ABORTED &&
           !(way != AT_ONCE && (seen.done_s > 0.0 || chain.out.guard == AUVID_GUARD_DONE))) {
        chain_tick(&chain);
        if (way == AT_ONCE && e->number != number && e->sets <= SETS) {
            number = e->number;
            o->square[e->sets] = chain_mean_square(&chain);
            o->set_s[e->sets] = 1e-6 * (double)chain.t_us;
        }
    }
    o->known[way] = seen.done_s > 0.0;
    o->known_square[way] = seen.square;
    o->done_s[way] = seen.done_s > 0.0 && seen.done_s < max_s ? seen.done_s : max_s;
    aborted += chain.out.guard == AUVID_GUARD_ABORTED;
    if (way == ADAPTIVE) {
        o->end_s = 1e-6 * (double)chain.t_us;
        o->end_square = chain_mean_square(&chain);
        gave_up += chain.adaptive.abandoned != 0;
        over = over || seen.over || seen.outside;
        false_alarms += seen.changed;
    }
}

/* Of a sample of runs: time until everything is known, over that of `way`. */
static double ratio_known(const int *sample, int runs, int way)
{
    double adaptive = 0.0, fixed = 0.0;
    for (int k = 0; k < runs; ++k) {
        adaptive += outcome[sample[k]].done_s[ADAPTIVE];
        fixed += outcome[sample[k]].done_s[way];
    }
    return adaptive / fixed;
}

/* Of a sample of runs: time until their end, over that after which the plan, all at once, has the
 * same rms error, between sets on a straight line of logarithms. */
static double ratio_error(const int *sample, int runs, int way)
{
    double square = 0.0, end_s = 0.0, before = 0.0, before_s = 0.0;
    (void)way;
    for (int k = 0; k < runs; ++k) {
        square += outcome[sample[k]].end_square;
        end_s += outcome[sample[k]].end_s;
    }
    for (int set = 1; set <= SETS; ++set) {
        double now = 0.0, now_s = 0.0;
        for (int k = 0; k < runs; ++k) {
            now += outcome[sample[k]].square[set];
            now_s += outcome[sample[k]].set_s[set];
        }
        if (now <= square && set > 1) {
            double part = log(square / before) / log(now / before);
            return end_s / (before_s * pow(now_s / before_s, part > 0.0 ? part : 0.0));
        }
        before = now;
        before_s = now_s;
    }
    return end_s / before_s; /* the plan never gets there */
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The ratio, and its 95 % interval by bootstrap over runs. */
static void print_ratio(const char *what, double (*ratio)(const int *, int, int), int runs, int way,
                        double interval[3])
{
    static double value[RESAMPLES];
    int sample[MOST_RUNS];
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 1);
    for (int b = 0; b < RESAMPLES; ++b) {
        for (int k = 0; k < runs; ++k) {
            sample[k] = (int)(sim_rng_uniform(&rng) * runs);
        }
        value[b] = ratio(sample, runs, way);
    }
    for (int k = 0; k < runs; ++k) {
        sample[k] = k;
    }
    qsort(value, RESAMPLES, sizeof value[0], ascending);
    interval[0] = ratio(sample, runs, way);
    interval[1] = value[RESAMPLES / 40];
    interval[2] = value[RESAMPLES - 1 - RESAMPLES / 40];
    printf("  %-50s %.2f [%.2f, %.2f]\n", what, interval[0], interval[1], interval[2]);
}

static double mean_s(int runs, int way)
{
    double sum = 0.0;
    for (int k = 0; k < runs; ++k) {
        sum += outcome[k].done_s[way];
    }
    return sum / runs;
}

/* Over the runs in which everything was known [%]. */
static double rms_known(int runs, int way)
{
    double sum = 0.0;
    int count = 0;
    for (int k = 0; k < runs; ++k) {
        sum += outcome[k].known[way] ? outcome[k].known_square[way] : 0.0;
        count += outcome[k].known[way];
    }
    return count > 0 ? 100.0 * sqrt(sum / count) : 0.0;
}

/* The short form has fewer runs, and omits the plan one by one. */
static void compare(double disturbance_N, bool other, int few, double interval[3])
{
    int runs = campaign_is_long() ? MOST_RUNS : few, known[WAYS] = {0};
    int ways = campaign_is_long() ? WAYS : ONE_BY_ONE;
    double square = 0.0, ignored[3];
    memset(outcome, 0, sizeof outcome);
    aborted = gave_up = false_alarms = 0;
    over = false;
    for (int way = 0; way < ways; ++way) {
        for (int k = 0; k < runs; ++k) {
            run_one((uint32_t)k + 1, disturbance_N, other, way);
            known[way] += outcome[k].known[way];
        }
    }
    for (int k = 0; k < runs; ++k) {
        square += outcome[k].end_square / runs;
    }
    printf(
        "%g N, %s, %d runs of at most %d s; adaptive, all at once, one by one (%d s):\n"
        "  all 13 identifiable in %d, %d, %d runs, after %.1f, %.1f, %.1f s, rms error then %.2f, "
        "%.2f, %.2f %%\n  adaptive: %u abandoned something, rms error at the end %.2f %%\n",
        disturbance_N, other ? "other vehicles" : "Girona500", runs, MAX_S, 4 * MAX_S,
        known[ADAPTIVE], known[AT_ONCE], known[ONE_BY_ONE], mean_s(runs, ADAPTIVE),
        mean_s(runs, AT_ONCE), mean_s(runs, ONE_BY_ONE), rms_known(runs, ADAPTIVE),
        rms_known(runs, AT_ONCE), rms_known(runs, ONE_BY_ONE), (unsigned)gave_up,
        100.0 * sqrt(square));
    print_ratio("time until known, over all at once", ratio_known, runs, AT_ONCE, interval);
    if (ways == WAYS) {
        print_ratio("time until known, over one by one", ratio_known, runs, ONE_BY_ONE, ignored);
    }
    print_ratio("time until the end, over that of the same error", ratio_error, runs, AT_ONCE,
                ignored);
    TEST_ASSERT_EQUAL_UINT32(0, aborted);
    TEST_ASSERT_EQUAL_UINT32(0, false_alarms);
    TEST_ASSERT_FALSE(over);
}

static void test_it_needs_no_more_data_than_the_plan(void)
{
    double interval[3];
    compare(1.0, false, 20, interval);
    TEST_ASSERT_TRUE(interval[campaign_is_long() ? 2 : 0] < 1.0);
}

static void test_nor_does_it_for_other_vehicles_and_disturbances(void)
{
    double interval[3];
    for (int k = campaign_is_long() ? 0 : 2; k < 3; ++k) {
        compare(k == 0 ? 1.0 : 3.0, k != 1, (int)campaign_runs(10), interval);
        TEST_ASSERT_TRUE(interval[1] < 1.0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_ends_by_itself_when_everything_is_known);
    RUN_TEST(test_it_ends_with_a_degree_of_freedom_in_closed_loop);
    RUN_TEST(test_with_uncertain_inputs_it_ends_when_the_estimate_with_them_is_known);
    RUN_TEST(test_a_run_may_be_begun_again);
    RUN_TEST(test_dives_with_a_prior_record_end_sooner_but_not_without_a_set);
    RUN_TEST(test_without_a_side_thruster_coupling_identifies_sway);
    RUN_TEST(test_sway_that_hardly_moves_is_abandoned);
    RUN_TEST(test_a_dof_that_does_not_move_is_abandoned_in_time);
    RUN_TEST(test_weak_thrusters_excite_in_turn_and_everything_is_known);
    RUN_TEST(test_it_ends_after_the_longest_run_time);
    RUN_TEST(test_the_operator_ends_it_with_a_fade_or_at_once);
    RUN_TEST(test_a_limit_of_the_guard_ends_it);
    RUN_TEST(test_with_a_small_distance_limit_it_is_brought_back_in_time);
    RUN_TEST(test_heave_stays_within_the_depths_of_the_guard);
    RUN_TEST(test_an_invalid_configuration_is_refused);
    RUN_TEST(test_calls_out_of_order_are_refused);
    RUN_TEST(test_a_checkpoint_continues_bit_for_bit);
    RUN_TEST(test_a_checkpoint_of_it_is_refused_where_it_has_not_been_begun);
    RUN_TEST(test_a_checkpoint_of_a_sequence_is_refused_where_it_has_been_begun);
    RUN_TEST(test_it_needs_no_more_data_than_the_plan);
    RUN_TEST(test_nor_does_it_for_other_vehicles_and_disturbances);
    return UNITY_END();
}
