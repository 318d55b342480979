/* The checkpoint of uncertain inputs and instruments: a run that is split at any moment of a
 * solution ends as one that is not, byte for byte; one of other inputs, or damaged, is refused. Two
 * worlds: Girona500 that is excited, and a body in surge that a controller drives. */
#include <math.h>
#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/uncertain.h"
#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "chain.h"
#include "checkpoint/auvid_checkpoint_layout_internal.h"
#include "save_checkpoint.h"
#include "unity.h"
#include "uncertain/auvid_uncertain_parts_internal.h"

enum {
    TICK_US = 20000,
    SAMPLE = 10,             /* ticks between velocities of the body */
    SPLIT = 997,             /* ticks from one split to the next, outside of solutions */
    PHASES = SOLVE_DONE + 1, /* of a solution */
    PASSES = 4,
    SET_ROWS = 40,
    MOST = AUVID_CHECKPOINT_MAX(0) + sizeof(auvid_uncertain_t) + sizeof(auvid_instruments_t)
};
#define TAU_MAX_N AUVID_C(300.0)

typedef enum { EXCITED, PASSIVE, INSTRUMENTS } world_t;

static world_t world;
static chain_config_t cfg;
static chain_t chain;
static auvid_identifier_t *const id = &chain.id;
static auvid_allocation_config_t allocation;
static auvid_allocation_t thrusters;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t uncertain, before;
static auvid_instruments_t instruments, untouched;
static auvid_identifier_t same;
static double pilot_N; /* who drives surge beside the excitation */
static uint8_t saved[MOST], again[MOST];
static uint32_t bytes;
static uint64_t seen[2]; /* steps of solutions, bit phase + PHASES * pass; of projected rows */
static struct {
    sim_rng_t rng;
    double u, disturbance, wanted, smooth, sum, tau, sampled;
} body;

/* Init and attach, as a program does that was started again. */
static void start(void)
{
    memset(&uncertain, 0xA5, sizeof uncertain);
    memset(&instruments, 0xA5, sizeof instruments);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&thrusters, &allocation));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(id, &uncertain, &inputs, &thrusters));
    if (world == INSTRUMENTS) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_instruments(id, &instruments));
    }
}

static void begin_world(void)
{
    memset(&body, 0, sizeof body);
    sim_rng_seed(&body.rng, 1, 1);
    memset(&chain, 0, sizeof chain);
    TEST_ASSERT_TRUE(sim_init(&chain.sim, &cfg.sim));
    chain.waiting = true;
    start();
}

/* One thruster for each DoF that is driven. */
static void begin(world_t of)
{
    static const int driven[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    world = of;
    chain_defaults(&cfg, 1, 4, 1.0);
    cfg.id.metric.set_rows = world == INSTRUMENTS ? 6 * SET_ROWS : SET_ROWS;
    cfg.passive = world != EXCITED;
    auvid_uncertain_defaults(&inputs);
    auvid_allocation_defaults(&allocation);
    allocation.thrusters = (uint8_t)(world == EXCITED ? 4 : 1);
    for (int i = 0; i < allocation.thrusters; ++i) {
        allocation.thruster[i].wrench[driven[i]] = 1;
        allocation.thruster[i].max_N = TAU_MAX_N;
        allocation.thruster[i].min_N = -TAU_MAX_N;
    }
    if (world != EXCITED) {
        cfg.id.metric.free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U;
    }
    begin_world();
}

void setUp(void)
{
    seen[0] = seen[1] = 0;
}

void tearDown(void)
{
}

/* ---- the worlds ---- */

static void tick_vehicle(void)
{
    sim_output_t out;
    auvid_input_t in;
    double wrench[AUVID_DOF_COUNT];
    auvid_real_t command[AUVID_MAX_COMMANDS] = {0};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (double)chain.wrench[j];
    }
    sim_step(&chain.sim, NULL, wrench, &out);
    chain_sense(&out, 0, &in);
    if (chain.waiting && auvid_identifier_arm(id) == AUVID_OK) {
        chain.waiting = false;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(id));
    }
    (void)auvid_identifier_step(id, &in, &chain.out);
    memcpy(chain.wrench, chain.out.excitation, sizeof chain.wrench);
    chain.wrench[AUVID_HEAVE] -= (auvid_real_t)cfg.sim.parameter[SIM_WB];
    chain.wrench[AUVID_SURGE] += (auvid_real_t)pilot_N;
    memcpy(command, chain.wrench, 3 * sizeof command[0]);
    command[3] = chain.wrench[AUVID_YAW];
    (void)auvid_identifier_applied(id, in.t_us, chain.wrench, command);
}

/* A fast controller against a strong disturbance; see test_instruments.c. */
static void tick_body(void)
{
    const double dt = TICK_US * 1e-6;
    auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0}, wrench[AUVID_DOF_COUNT] = {0};
    auvid_real_t command[AUVID_MAX_COMMANDS] = {0}, reference[AUVID_DOF_COUNT] = {0};
    uint64_t t_us = (uint64_t)(chain.tick + 1u) * TICK_US;
    if (chain.tick % SAMPLE == 0) {
        body.sampled = body.u + 0.003 * sim_rng_gauss(&body.rng);
        nu[AUVID_SURGE] = (auvid_real_t)body.sampled;
        (void)auvid_identifier_motion(id, t_us, attitude, nu);
        if (chain.tick % 500 == 0) {
            body.wanted = 2.0 * sim_rng_uniform(&body.rng) - 1.0;
        }
        body.smooth += (body.wanted - body.smooth) * 0.2;
        body.sum += 10.0 * (body.smooth - body.sampled);
        body.tau = fmax(-300.0, fmin(300.0, 250.0 * (body.smooth - body.sampled) + body.sum));
    }
    reference[AUVID_SURGE] = (auvid_real_t)body.smooth;
    if (world == INSTRUMENTS) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_instruments_reference(&instruments, t_us, reference));
    }
    wrench[AUVID_SURGE] = command[0] = (auvid_real_t)body.tau;
    (void)auvid_identifier_applied(id, t_us, wrench, command);
    body.disturbance += -body.disturbance * dt / 2.0 + 40.0 * sqrt(dt) * sim_rng_gauss(&body.rng);
    body.u += (body.tau + body.disturbance - 120.0 * body.u) / 250.0 * dt;
}

/* A tick, and work: so little that no phase of a solution is passed over. */
static void tick(void)
{
    if (world == EXCITED) {
        tick_vehicle();
    } else {
        tick_body();
    }
    ++chain.tick;
    (void)auvid_identifier_work(id, id->work.phase == AUVID_WORK_IDLE ? 400
                                    : world == EXCITED                ? 20
                                                                      : 6);
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

/* A set has fewer rows than a solution needs: those of the first sets are too few once they count
 * less. */
static void test_the_estimate_stays_while_early_rows_count_less(void)
{
    bool waited = false, estimated = false;
    begin(EXCITED);
    cfg.id.metric.set_rows = 14;
    begin_world();
    for (uint32_t k = 0; k < 2500; ++k) {
        tick();
        (void)auvid_identifier_work(id, 100000);
        waited = waited || (estimated && uncertain.estimate.number < id->estimate.number);
        TEST_ASSERT_TRUE(!estimated || uncertain.estimate.number > 0);
        estimated = uncertain.estimate.number > 0;
    }
    TEST_ASSERT_TRUE(waited && estimated);
}

/* A pilot drives surge alone when the excitation is over: the ring forgets the other axes, but the
 * rows of the excitation are all there. */
static void test_driving_after_an_excitation_does_not_erase_its_result(void)
{
    begin(EXCITED);
    cfg.id.metric.sets = 4;
    begin_world();
    for (uint32_t k = 0; k < 20000; ++k) {
        pilot_N = k > 9000 ? 60.0 * sin(0.02 * k) : 0.0;
        tick();
        (void)auvid_identifier_work(id, 100000);
        if (k == 9000) {
            before = uncertain;
        }
    }
    pilot_N = 0.0;
    TEST_ASSERT_TRUE(id->estimate.number > before.estimate.number);
    TEST_ASSERT_FALSE(id->estimate.excited >> AUVID_HEAVE & 1);
    TEST_ASSERT_TRUE(uncertain.estimate.excited >> AUVID_HEAVE & 1);
    TEST_ASSERT_EQUAL_MEMORY(before.estimate.pi, uncertain.estimate.pi, sizeof before.estimate.pi);
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
    check_refused(AUVID_ERR_STATE);
    bytes = save(saved);
    start();
    check_refused(AUVID_ERR_STATE);
    bytes = save(saved);
    world = INSTRUMENTS;
    start();
    check_refused(AUVID_ERR_STATE);
    bytes = save(saved);
    world = PASSIVE;
    start();
    check_refused(AUVID_ERR_STATE);
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
    RUN_TEST(test_the_estimate_stays_while_early_rows_count_less);
    RUN_TEST(test_driving_after_an_excitation_does_not_erase_its_result);
    RUN_TEST(test_it_is_refused_by_an_identifier_with_less_or_more_attached);
    RUN_TEST(test_one_of_other_inputs_or_thrusters_is_refused);
    RUN_TEST(test_every_damaged_byte_is_detected_and_every_cut);
    RUN_TEST(test_impossible_values_are_refused);
    RUN_TEST(test_impossible_steps_of_a_solution_are_refused);
    RUN_TEST(test_a_solution_that_is_no_number_of_a_checkpoint_is_not_kept);
    RUN_TEST(test_a_forged_checkpoint_is_refused_or_harmless);
    return UNITY_END();
}
