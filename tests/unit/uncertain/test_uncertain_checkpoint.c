/* The checkpoint of uncertain inputs and instruments: a run that is split at any moment of a
 * solution ends as one that is not, byte for byte; one of other inputs, or damaged, is refused. */
#include <string.h>

#include "auvid/checkpoint.h"
#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "checkpoint/auvid_checkpoint_layout_internal.h"
#include "save_checkpoint.h"
#include "uncertain/auvid_uncertain_parts_internal.h"
#include "uncertain_worlds.h"
#include "unity.h"

enum {
    SPLIT = 997,             /* ticks from one split to the next, outside of solutions */
    PHASES = SOLVE_DONE + 1, /* of a solution */
    PASSES = 4,
    MOST = AUVID_CHECKPOINT_MAX(0) + sizeof(auvid_uncertain_t) + sizeof(auvid_instruments_t)
};

static auvid_instruments_t untouched;
static auvid_identifier_t same;
static uint8_t saved[MOST], again[MOST];
static uint32_t bytes;
static uint64_t seen[2]; /* steps of solutions, bit phase + PHASES * pass; of projected rows */

void setUp(void)
{
    seen[0] = seen[1] = 0;
}

void tearDown(void)
{
}

/* ---- saving ---- */

static uint32_t save(uint8_t *to)
{
    return save_checkpoint(id, to, MOST);
}

/* Also from a copy, as during a dive. */
static void check_saves_the_same(void)
{
    same = *id;
    before = uncertain;
    untouched = instruments;
    same.attached.uncertain = &before;
    before.instruments = uncertain.instruments != NULL ? &untouched : NULL;
    TEST_ASSERT_EQUAL_UINT32(bytes, save_checkpoint(&same, again, MOST));
    TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
    TEST_ASSERT_EQUAL_UINT32(bytes, save(again));
    TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
}

/* Is this a step of a solution that was not seen before? */
static bool is_new_step(void)
{
    const auvid_uncertain_solution_t *w = &uncertain.work;
    uint64_t bit = (uint64_t)1 << (w->phase + PHASES * w->pass), *of = &seen[w->strong != 0];
    bool found = w->solving && (*of & bit) == 0;
    *of |= w->solving ? bit : 0;
    return found;
}

static void run(world_t of, uint32_t ticks, bool split)
{
    begin(of);
    for (uint32_t k = 1; k <= ticks; ++k) {
        tick();
        if (split && (is_new_step() || k % SPLIT == 0)) {
            bytes = save(saved);
            start();
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(id, saved, bytes));
            check_saves_the_same();
        }
    }
}

static void check_split_run(world_t of, uint32_t ticks)
{
    run(of, ticks, false);
    bytes = save(saved);
    TEST_ASSERT_TRUE(uncertain.estimate.number > 0 && !uncertain.contradicted);
    run(of, ticks, true);
    bytes = save(again);
    run(of, ticks, false);
    TEST_ASSERT_EQUAL_UINT32(bytes, save(saved));
    TEST_ASSERT_EQUAL_MEMORY(again, saved, bytes);
}

/* Three passes of all phases up to the scale of the priors; the others after the last. Later
 * solutions of an excited vehicle have one pass. */
enum { IN_PASS = SOLVE_SCALE + 1, AFTER = SOLVE_DONE + 1 - IN_PASS };
#define AFTER_PASSES(n) ((((uint64_t)1 << AFTER) - 1) << (IN_PASS + (n)*PHASES))
static const uint64_t all_steps =
    (((uint64_t)1 << IN_PASS) - 1) * (1 | (uint64_t)1 << PHASES | (uint64_t)1 << 2 * PHASES) |
    AFTER_PASSES(3);

static void test_a_split_run_ends_as_a_whole_one_excited(void)
{
    check_split_run(EXCITED, 10000);
    TEST_ASSERT_TRUE(uncertain.excited);
    TEST_ASSERT_EQUAL_HEX64(all_steps | AFTER_PASSES(1), seen[0]);
}

static void test_a_split_run_ends_as_a_whole_one_passive(void)
{
    check_split_run(PASSIVE, 32000);
    TEST_ASSERT_EQUAL_HEX64(all_steps, seen[0]);
}

static void test_a_split_run_ends_as_a_whole_one_with_instruments(void)
{
    check_split_run(INSTRUMENTS, 50000);
    TEST_ASSERT_TRUE(instruments.strong != 0);
    TEST_ASSERT_EQUAL_HEX64(all_steps, seen[1]);
}

/* Heave has no uncertain input. */
static void test_an_equation_without_uncertain_inputs_can_be_saved_at_any_step(void)
{
    uint32_t solved = 0;
    begin(EXCITED);
    inputs = (auvid_uncertain_config_t){.arm_m = AUVID_C(0.05), .nominal_lag_s = AUVID_C(0.15)};
    begin_world();
    TEST_ASSERT_EQUAL(0, uncertain.equation[AUVID_HEAVE].inputs);
    for (uint32_t k = 0; k < 5000; ++k) {
        tick();
        if (uncertain.work.solving) {
            ++solved;
            bytes = save(saved);
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(id, saved, bytes));
        }
    }
    TEST_ASSERT_TRUE(solved > 100 && uncertain.estimate.number > 0);
    TEST_ASSERT_TRUE(auvid_is_zero(uncertain.causes.cause[AUVID_CAUSE_CURVE].sigma));
}

/* ---- refusals ---- */

static void check_refused(auvid_status_t status)
{
    same = *id;
    before = uncertain;
    untouched = instruments;
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_resume(id, saved, bytes));
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_restore(id, saved, bytes));
    TEST_ASSERT_EQUAL_MEMORY(&same, id, sizeof same);
    TEST_ASSERT_EQUAL_MEMORY(&before, &uncertain, sizeof before);
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &instruments, sizeof untouched);
}

static void test_it_is_refused_by_an_identifier_with_less_or_more_attached(void)
{
    begin(PASSIVE);
    bytes = save(saved);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg)); /* without */
    check_refused(AUVID_ERR_DETACHED);
    bytes = save(saved);
    start();
    check_refused(AUVID_ERR_ATTACHED);
    bytes = save(saved);
    world = INSTRUMENTS;
    start();
    check_refused(AUVID_ERR_ATTACHED);
    bytes = save(saved);
    world = PASSIVE;
    start();
    check_refused(AUVID_ERR_DETACHED);
    world = INSTRUMENTS;
    start();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes));
}

static void test_one_of_other_inputs_or_thrusters_is_refused(void)
{
    begin(PASSIVE);
    bytes = save(saved);
    inputs.nominal_lag_s *= 2;
    start();
    check_refused(AUVID_ERR_CONFIGURATION);
    auvid_uncertain_defaults(&inputs);
    inputs.fractions = true;
    start();
    check_refused(AUVID_ERR_CONFIGURATION);
    inputs.fractions = false;
    inputs.sag = 0; /* one column less */
    start();
    check_refused(AUVID_ERR_CONFIGURATION);
    auvid_uncertain_defaults(&inputs);
    allocation.thruster[0].max_N *= 2;
    start();
    check_refused(AUVID_ERR_CONFIGURATION);
    allocation.thruster[0].max_N /= 2;
    allocation.thruster[0].wrench[AUVID_SURGE] *= -1;
    start();
    check_refused(AUVID_ERR_CONFIGURATION);
    allocation.thruster[0].wrench[AUVID_SURGE] *= -1;
    allocation.thruster[0].gain_forward *= 2; /* no command passes through it */
    start();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes));
}

/* Run until a solution is in this phase, with the rows of instruments. */
static void run_to_phase(uint8_t phase)
{
    begin(INSTRUMENTS);
    while (
        !(uncertain.work.solving && uncertain.work.phase == phase && uncertain.work.strong != 0)) {
        TEST_ASSERT_TRUE(chain.tick < 60000);
        tick();
    }
    bytes = save(saved);
}

/* Every byte in head and tail, else every 37th, or all in the long form. */
static void test_every_damaged_byte_is_detected_and_every_cut(void)
{
    const uint32_t stride = campaign_is_long() ? 1 : 37;
    run_to_phase(SOLVE_ROWS);
    same = *id;
    before = uncertain;
    untouched = instruments;
    for (uint32_t k = 0; k < bytes;
         k += k < AUVID_CHECKPOINT_HEAD || k + stride >= bytes ? 1 : stride) {
        uint8_t was = saved[k];
        saved[k] = (uint8_t)(was ^ (1u << k % 8));
        TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_checkpoint_restore(id, saved, bytes));
        saved[k] = was;
        TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_checkpoint_restore(id, saved, k));
    }
    TEST_ASSERT_EQUAL_MEMORY(&same, id, sizeof same);
    TEST_ASSERT_EQUAL_MEMORY(&before, &uncertain, sizeof before);
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &instruments, sizeof untouched);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes)); /* it was valid */
}

#define IMPOSSIBLE(of, assignment)                                                                 \
    before = uncertain;                                                                            \
    untouched = instruments;                                                                       \
    (of).assignment;                                                                               \
    bytes = save(saved);                                                                           \
    uncertain = before;                                                                            \
    instruments = untouched;                                                                       \
    check_refused(AUVID_ERR_RANGE)
#define OF_INPUTS(assignment) IMPOSSIBLE(uncertain, assignment)
#define OF_INSTRUMENTS(assignment) IMPOSSIBLE(instruments, assignment)

static void test_impossible_values_are_refused(void)
{
    run_to_phase(SOLVE_ROWS);
    TEST_ASSERT_EQUAL(AUVID_SURGE, uncertain.work.dof);
    OF_INPUTS(recorded.pending = 1 << 2 * AUVID_ROLL); /* not modelled */
    OF_INPUTS(recorded.pending = 1 << 2 * AUVID_DOF_COUNT);
    OF_INPUTS(recorded.successive[0] = AUVID_METRIC_LAGS + 1);
    OF_INPUTS(recorded.begun_before = AUVID_MAX_OVERLAP + 1);
    OF_INPUTS(recorded.elapsed = -1);
    OF_INPUTS(recorded.wrench = (auvid_real_t)INFINITY);
    OF_INPUTS(recorded.speed[0] = (auvid_real_t)NAN);
    OF_INPUTS(rows[AUVID_ROLL] = 1);
    OF_INPUTS(rows[AUVID_SURGE] = 0); /* that are being solved */
    OF_INPUTS(factor[1][0] = (auvid_real_t)INFINITY);
    OF_INPUTS(pi[0] = (auvid_real_t)NAN);
    OF_INPUTS(scale = 3);
    OF_INPUTS(estimate.covariance[0] = AUVID_C(2e37));
    OF_INPUTS(estimate.confidence.note[0] = AUVID_NOTE_COUNT);
    OF_INPUTS(causes.order[0] = AUVID_CAUSE_COUNT);
    uncertain.causes.cause[0].named = true;
    OF_INPUTS(causes.cause[0].input = AUVID_UNCERTAIN_GAIN); /* of no class */
    uncertain.causes.cause[0].named = false;
    OF_INPUTS(causes.cause[AUVID_CAUSE_SAG].sigma = (auvid_real_t)NAN);
    OF_INPUTS(work.causes.cause[0].dof = AUVID_DOF_COUNT);
    OF_INPUTS(work.solving = false); /* what was to be assessed then is lost */
    OF_INPUTS(work.phase = SOLVE_DONE + 1);
    OF_INPUTS(work.pass = PASSES);
    OF_INPUTS(work.dof = AUVID_ROLL);
    OF_INPUTS(work.dof = AUVID_DOF_COUNT);
    OF_INPUTS(work.dof = UINT8_MAX);
    OF_INPUTS(work.row = instruments.of[AUVID_SURGE].count);
    OF_INPUTS(work.part.factor[0] = (auvid_real_t)INFINITY);
    OF_INPUTS(work.part.sag_at = AUVID_UNCERTAIN_ORDER + 1);
    OF_INSTRUMENTS(taken = instruments.given + 1);
    OF_INSTRUMENTS(taken = instruments.given - AUVID_INSTRUMENT_PAST - 1u);
    OF_INSTRUMENTS(waiting = 1 << AUVID_ROLL);
    OF_INSTRUMENTS(past[31].nu[5] = AUVID_C(1e30));
    OF_INSTRUMENTS(rows[0] = -1);
    OF_INSTRUMENTS(wide[0] = (auvid_real_t)NAN);
    OF_INSTRUMENTS(lagged[0][0] = (auvid_real_t)NAN);
}

static void test_impossible_steps_of_a_solution_are_refused(void)
{
    run_to_phase(SOLVE_SHARED);
    OF_INPUTS(work.dof = 0); /* of no DoF */
    OF_INPUTS(work.row = AUVID_UNCERTAIN_SHARED);
    OF_INPUTS(work.row = UINT16_MAX);
    run_to_phase(SOLVE_FINISH);
    OF_INPUTS(work.phase = SOLVE_DONE);    /* only while the confidence is computed */
    OF_INPUTS(work.phase = SOLVE_OPTIMUM); /* its memory is not saved */
    OF_INPUTS(work.phase = SOLVE_START);
    run_to_phase(SOLVE_OPTIMUM);
    OF_INPUTS(work.phase = SOLVE_KEEP); /* and here it is */
    OF_INPUTS(work.phase = SOLVE_SEARCH);
    run_to_phase(SOLVE_SEARCH);
    TEST_ASSERT_TRUE(id->work.searching);
    OF_INPUTS(work.phase = SOLVE_KEEP);
    run_to_phase(SOLVE_FINISH);
    id->work.phase = AUVID_WORK_IDLE;
    id->metric.sets.held = false;
    id->metric.sets.from = id->metric.sets.least = 0;
    OF_INPUTS(work.row = 0); /* a solution belongs to the work */
    uncertain.work.solving = false;
    bytes = save(saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes));
    begin(PASSIVE);
    while (!uncertain.work.solving) {
        tick();
    }
    OF_INPUTS(work.strong = 1); /* there are no instruments */
    bytes = save(saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes));
}

/* After spikes of the inputs. What is kept must be accepted again. */
static void test_a_solution_that_is_no_number_of_a_checkpoint_is_not_kept(void)
{
    const int last = AUVID_UNCERTAIN_JOINT - 1;
    run_to_phase(SOLVE_FINISH);
    memcpy(before.pi, uncertain.pi, sizeof before.pi);
    for (int i = 0; i < last; ++i) { /* the thrust */
        uncertain.work.joint[auvid_qr_row(AUVID_UNCERTAIN_JOINT, i) + last - i] *= AUVID_C(1e25);
    }
    while (uncertain.work.phase == SOLVE_FINISH) {
        tick();
    }
    TEST_ASSERT_EQUAL_MEMORY(before.pi, uncertain.pi, sizeof before.pi);
    bytes = save(saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(id, saved, bytes));
}

/* ---- forgeries ---- */

static auvid_rng_t rng;

/* Where whole numbers are in both blocks: so many bytes each. */
#define IN_BLOCK(type, first, member) (uint32_t)(offsetof(type, member) - offsetof(type, first))
static const struct {
    uint8_t root;
    uint32_t at;
} whole[] = {{ROOT_UNCERTAIN, IN_BLOCK(auvid_uncertain_t, begin_us, recorded)},
             {ROOT_UNCERTAIN, IN_BLOCK(auvid_uncertain_t, begin_us, work)},
             {ROOT_UNCERTAIN, IN_BLOCK(auvid_uncertain_t, begin_us, work.part)},
             {ROOT_INSTRUMENTS, IN_BLOCK(auvid_instruments_t, last_us, given)}};
enum { WHOLE = sizeof whole / sizeof whole[0], WHOLE_BYTES = 16 };

/* Change one number of the inputs or instruments; the checksum is right. */
static void forge(void)
{
    static const auvid_real_t critical[] = {
        0, -1, 1, AUVID_C(1e-30), AUVID_C(1e17), AUVID_C(-1e17)};
    const auvid_checkpoint_view_t view = {.parts = auvid_get_word(saved + 16)};
    const auvid_checkpoint_block_t *block = auvid_checkpoint_block;
    uint32_t k = auvid_rng_below(&rng, 2 * WHOLE), at = AUVID_CHECKPOINT_HEAD;
    for (; block->root != whole[k % WHOLE].root; ++block) {
        at += auvid_checkpoint_bytes(&view, block);
    }
    if (k < WHOLE) {
        at += whole[k].at + auvid_rng_below(&rng, WHOLE_BYTES);
        saved[at] = (uint8_t)auvid_rng_below(&rng, auvid_rng_below(&rng, 2) == 0 ? 8 : 256);
    } else {
        uint32_t reals = block->bytes / (uint32_t)sizeof critical[0];
        at += auvid_rng_below(&rng, reals) * (uint32_t)sizeof critical[0];
        memcpy(saved + at, &critical[auvid_rng_below(&rng, 6)], sizeof critical[0]);
    }
    auvid_put_word(saved + bytes - 4, ~auvid_checksum(UINT32_MAX, saved, bytes - 4));
}

/* Ticks, from the last reference on, and the whole solution. */
static void check_harmless(void)
{
    for (int k = 0; k < 100 || (uncertain.work.solving && k < 2000); ++k) {
        if (instruments.last_us < (uint64_t)(chain.tick + 1u) * TICK_US) {
            tick();
        }
        (void)auvid_identifier_work(id, 400);
        TEST_ASSERT_TRUE(id->work.last_units <= 400);
    }
    const auvid_estimate_t *e = auvid_identifier_estimate(id);
    TEST_ASSERT_TRUE(auvid_all_finite(e->pi, AUVID_MAX_PARAMETERS));
    TEST_ASSERT_TRUE(auvid_all_finite(e->confidence.sigma, AUVID_MAX_PARAMETERS));
}

static void test_a_forged_checkpoint_is_refused_or_harmless(void)
{
    static auvid_identifier_t original;
    const uint32_t forgeries = campaign_is_long() ? 20000 : campaign_runs(400);
    uint32_t taken = 0, number = 0;
    auvid_rng_seed(&rng, 1);
    for (uint8_t phase = 0; phase < PHASES; ++phase) {
        run_to_phase(phase);
        original = *id;
        before = uncertain;
        untouched = instruments;
        uint32_t ticks = chain.tick;
        for (uint32_t n = 0; n < forgeries; n += PHASES, ++number) {
            *id = original;
            uncertain = before;
            instruments = untouched;
            chain.tick = ticks;
            bytes = save(saved);
            forge();
            if (auvid_checkpoint_resume(id, saved, bytes) == AUVID_OK) {
                ++taken;
                check_harmless();
            }
        }
    }
    TEST_ASSERT_TRUE(taken > number / 10 && taken < number - number / 10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_split_run_ends_as_a_whole_one_excited);
    RUN_TEST(test_a_split_run_ends_as_a_whole_one_passive);
    RUN_TEST(test_a_split_run_ends_as_a_whole_one_with_instruments);
    RUN_TEST(test_an_equation_without_uncertain_inputs_can_be_saved_at_any_step);
    RUN_TEST(test_it_is_refused_by_an_identifier_with_less_or_more_attached);
    RUN_TEST(test_one_of_other_inputs_or_thrusters_is_refused);
    RUN_TEST(test_every_damaged_byte_is_detected_and_every_cut);
    RUN_TEST(test_impossible_values_are_refused);
    RUN_TEST(test_impossible_steps_of_a_solution_are_refused);
    RUN_TEST(test_a_solution_that_is_no_number_of_a_checkpoint_is_not_kept);
    RUN_TEST(test_a_forged_checkpoint_is_refused_or_harmless);
    return UNITY_END();
}
