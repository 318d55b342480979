/* The checkpoint across processes: a run is saved at random ticks, and another process continues it
 * from each of them to its end. Every tick must have the same output as in the uninterrupted run,
 * and the last checkpoint must be equal, byte for byte. Two worlds: one with regressor, started
 * with a prior record, guarded and excited, and one without. */
#define _POSIX_C_SOURCE 200809L /* mkstemp() */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "by_residual.h"
#include "chain.h"
#include "unity.h"

enum {
    SETS = 9,
    SET_ROWS = 20,
    CHAIN_SETS = 3,
    TICKS = 5000,
    PHASES = AUVID_WORK_CONFIDENCE + 1,
    STORE = (SETS + 1) * SET_ROWS,
    MOST = AUVID_CHECKPOINT_MAX(STORE)
};

/* Input and output of an identifier in a tick. */
typedef struct {
    auvid_input_t in;
    auvid_real_t wrench[AUVID_DOF_COUNT]; /* applied */
    uint32_t budget;
    uint32_t answer; /* hash */
    bool waiting;    /* to arm and excite */
    uint8_t phase;   /* of work, afterwards */
    bool late;       /* a set waits for the search to end */
} tick_t;

/* A run, as the other process reads it. */
typedef struct {
    bool residual;
    uint32_t ticks;
    tick_t tick[TICKS];
    uint32_t last_bytes;
    uint8_t last[MOST]; /* checkpoint at its end */
} run_t;

static const char *self; /* this program */
static char path[] = "/tmp/auvid_checkpoint_XXXXXX", saved_path[sizeof path + 2];
static chain_config_t cfg;
static chain_t chain;
static run_t run;
static auvid_row_t store[STORE];
static auvid_vehicle_t vehicle;
static auvid_identifier_t id;
static auvid_actuation_t actuation; /* of it, or of chain.id */
static auvid_allocation_t allocation;
static auvid_validation_t prediction;
static auvid_change_detector_t change;
static auvid_prior_t prior;
static uint8_t saved[MOST];
static auvid_rng_t rng;
static uint8_t known[AUVID_PRIOR_BYTES]; /* before the run */

void setUp(void)
{
    auvid_rng_seed(&rng, 1);
}

void tearDown(void)
{
}

/* The same in both processes. */
static void configure(bool residual)
{
    chain_defaults(&cfg, 1, CHAIN_SETS, 1.0);
    cfg.id.metric.set_rows = SET_ROWS;
    if (residual) { /* only surge, with its delay */
        by_residual_surge(&cfg.id, &vehicle, store, SETS - 1);
    }
}

/* ---- answers ---- */

static uint32_t hash(uint32_t h, const void *data, size_t size)
{
    const uint8_t *byte = data;
    for (size_t k = 0; k < size; ++k) {
        h = (h ^ byte[k]) * 16777619u;
    }
    return h;
}

#define HASH(member) h = hash(h, &(member), sizeof(member))

/* Hash of all outputs of a tick. */
static uint32_t answer(const auvid_identifier_t *of, const auvid_output_t *out)
{
    uint32_t h = 2166136261u;
    const auvid_estimate_t *e = &of->estimate;
    const auvid_change_test_t *test = &of->change_test;
    HASH(out->events);
    HASH(out->excitation);
    HASH(out->thruster_N);
    HASH(out->guard);
    HASH(out->cause);
    HASH(of->work.last_units);
    HASH(e->number);
    HASH(e->t_us);
    HASH(e->sets);
    HASH(e->identified);
    HASH(e->excited);
    HASH(e->pi);
    HASH(e->cost);
    HASH(e->delay_s);
    HASH(e->first_order_lag);
    HASH(e->r2_force);
    HASH(e->evaluations_crs);
    HASH(e->evaluations_line);
    HASH(e->not_converged);
    HASH(e->accepted);
    HASH(e->confidence.sigma);
    HASH(e->confidence.identifiable);
    HASH(e->confidence.implausible);
    HASH(e->confidence.note);
    HASH(e->confidence.partner);
    HASH(e->confidence.effective_noise);
    HASH(e->confidence.residual_rms);
    HASH(test->set);
    HASH(test->changed);
    HASH(test->variance_ratio);
    HASH(test->change);
    HASH(test->r2_velocity);
    return h;
}

/* Save in chunks of random length. */
static uint32_t save(const auvid_identifier_t *from, uint8_t *to)
{
    auvid_checkpoint_t cursor;
    uint32_t at = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, from));
    while (at < cursor.bytes) {
        uint32_t part = 1 + auvid_rng_below(&rng, 1000);
        TEST_ASSERT_TRUE(auvid_checkpoint_next(&cursor, to + at, &part) >= 0 && part > 0);
        at += part;
    }
    return at;
}

/* ---- the uninterrupted run ---- */

static void note_input(chain_t *of, auvid_input_t *in)
{
    run.tick[run.ticks].in = *in;
    run.tick[run.ticks].waiting = of->waiting;
}

/* Ready for the run. */
static void begin(auvid_identifier_t *to)
{
    configure(run.residual);
    memset(store, 0, sizeof store);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(to, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(to, &actuation, &cfg.acting, &allocation));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(to, &prediction));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(to, &change));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(to, &prior));
    if (!run.residual) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(to, known, sizeof known));
    }
}

static void record(bool residual)
{
    chain_defaults(&cfg, 3, 2, 1.0); /* the dive before */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 2));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, known));
    configure(residual);
    cfg.sim.seed = 2;
    memset(&run, 0, sizeof run);
    run.residual = residual;
    cfg.before = note_input;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    begin(&chain.id);
    uint32_t seconds = CHAIN_SETS * CHAIN_SET_S + 4;
    for (run.ticks = 1; run.ticks < 50 * seconds; ++run.ticks) {
        tick_t *tick = &run.tick[run.ticks];
        /* so that some sets complete during a search, and a tick may end in any phase */
        uint32_t usual = residual ? 120 : 60;
        tick->budget = 1 + auvid_rng_below(&rng, auvid_rng_below(&rng, 6) == 0 ? 9 : usual);
        chain.cfg.budget = tick->budget;
        chain_tick(&chain);
        memcpy(tick->wrench, chain.wrench, sizeof tick->wrench);
        tick->answer = answer(&chain.id, &chain.out);
        tick->phase = chain.id.work.phase;
        const auvid_metric_t *m = &chain.id.metric;
        tick->late = m->sets.held && (m->sets.full || m->sets.waiting > 0);
    }
    TEST_ASSERT_TRUE(chain.id.metric.sets.recorded >= SETS - 1 && chain.id.estimate.number > 4);
    TEST_ASSERT_TRUE(residual || prior.known != 0);
    run.last_bytes = save(&chain.id, run.last);
}

/* ---- another process ---- */

static void step(auvid_identifier_t *of, const tick_t *tick, auvid_output_t *out)
{
    if (tick->waiting && auvid_identifier_arm(of) == AUVID_OK) {
        (void)auvid_identifier_excite(of);
    }
    (void)auvid_identifier_step(of, &tick->in, out);
    (void)auvid_identifier_applied(of, tick->in.t_us, tick->wrench, NULL);
    (void)auvid_identifier_work(of, tick->budget);
}

static bool read_file(const char *name, void *to, size_t max, size_t *size)
{
    FILE *file = fopen(name, "rb");
    if (file == NULL) {
        return false;
    }
    *size = fread(to, 1, max, file);
    return fclose(file) == 0;
}

/* Restore the file's identifier after tick `from` and continue to the end of the run.
 * @return first tick with another output, the run's length for another end; 0: no difference */
static int continue_run(const char *run_file, const char *saved_file, uint32_t from)
{
    size_t size = 0;
    auvid_output_t out;
    if (!read_file(run_file, &run, sizeof run, &size) || size != sizeof run) {
        return -1;
    }
    configure(run.residual);
    if (!read_file(saved_file, saved, sizeof saved, &size) ||
        auvid_identifier_init(&id, &cfg.id) != AUVID_OK ||
        auvid_allocation_init(&allocation, &cfg.thrusters) != AUVID_OK ||
        auvid_identifier_attach_actuation(&id, &actuation, &cfg.acting, &allocation) != AUVID_OK ||
        auvid_identifier_attach_prediction(&id, &prediction) != AUVID_OK ||
        auvid_identifier_attach_change_test(&id, &change) != AUVID_OK ||
        auvid_identifier_attach_prior(&id, &prior) != AUVID_OK ||
        auvid_checkpoint_resume(&id, saved, (uint32_t)size) != AUVID_OK) {
        return -1;
    }
    for (uint32_t k = from + 1; k < run.ticks; ++k) {
        step(&id, &run.tick[k], &out);
        if (answer(&id, &out) != run.tick[k].answer) {
            return (int)k;
        }
    }
    bool same = save(&id, saved) == run.last_bytes && memcmp(saved, run.last, run.last_bytes) == 0;
    return same ? 0 : (int)run.ticks;
}

static void write_file(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(name, "wb");
    TEST_ASSERT_TRUE(file != NULL && fwrite(data, 1, size, file) == size && fclose(file) == 0);
}

/* Repeat the run and save at the marked ticks. */
static void check_ticks(const bool *marked)
{
    auvid_output_t out;
    begin(&id);
    write_file(path, &run, sizeof run);
    for (uint32_t k = 1; k < run.ticks; ++k) {
        step(&id, &run.tick[k], &out);
        TEST_ASSERT_EQUAL_HEX32(run.tick[k].answer, answer(&id, &out));
        if (marked[k]) {
            char from[16];
            int status = -1;
            write_file(saved_path, saved, save(&id, saved));
            (void)snprintf(from, sizeof from, "%u", (unsigned)k);
            pid_t child = fork();
            if (child == 0) {
                execl(self, self, path, saved_path, from, (char *)NULL);
                _exit(127);
            }
            TEST_ASSERT_TRUE(child > 0 && waitpid(child, &status, 0) == child);
            TEST_ASSERT_EQUAL_INT_MESSAGE(0, status, from);
        }
    }
}

/* Mark `max` random ticks: two of each phase of work that occurs, then any, and the last ones
 * among those at which a set waits. @return number of phases among them */
static uint32_t mark(uint32_t max, bool *marked)
{
    uint32_t count[PHASES] = {0}, phases = 0, late = 0;
    memset(marked, 0, TICKS * sizeof *marked);
    for (uint32_t n = 0; n < max; ++n) {
        uint32_t k = 1 + auvid_rng_below(&rng, run.ticks - 1);
        for (uint32_t i = 1; n < 2 * PHASES && i < run.ticks && run.tick[k].phase != n / 2; ++i) {
            k = 1 + k % (run.ticks - 1); /* the next */
        }
        for (uint32_t i = 1; n + 3 > max && i < run.ticks && !run.tick[k].late; ++i) {
            k = 1 + k % (run.ticks - 1);
        }
        count[run.tick[k].phase] += !marked[k];
        phases |= 1u << run.tick[k].phase;
        late += run.tick[k].late && !marked[k];
        marked[k] = true;
    }
    printf("%s regressor, ticks saved in phases IDLE, PREPARE ..:", run.residual ? "no" : "with");
    for (int i = 0; i < PHASES; ++i) {
        printf(" %u", (unsigned)count[i]);
    }
    printf("; %u while a set waited\n", (unsigned)late);
    TEST_ASSERT_TRUE(late > 0);
    return phases;
}

static void test_a_run_saved_at_random_ticks_continues_in_a_new_process_bit_for_bit(void)
{
    static bool marked[TICKS];
    bool all = campaign_is_long();
    record(false);
    uint32_t phases = mark(all ? 1000 : 100, marked);
    check_ticks(marked);
    record(true);
    phases |= mark(all ? 200 : 24, marked);
    check_ticks(marked);
    TEST_ASSERT_EQUAL_HEX32((1u << PHASES) - 1, phases);
}

/* The power fails far into the excitation: the applied wrench is unknown. */
static void test_an_excitation_that_was_interrupted_is_aborted(void)
{
    auvid_output_t out;
    record(false);
    begin(&id);
    for (uint32_t k = 1; k < 1000; ++k) {
        step(&id, &run.tick[k], &out);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, out.guard);
    uint32_t bytes = save(&id, saved);
    begin(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(&id, saved, bytes));
    step(&id, &run.tick[1020], &out); /* 0.4 s later */
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, out.guard);
    TEST_ASSERT_EQUAL(AUVID_GUARD_TICK, out.cause);
    TEST_ASSERT_EQUAL_MEMORY((auvid_real_t[AUVID_DOF_COUNT]){0}, out.excitation,
                             sizeof out.excitation);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(&id, saved, bytes));
    step(&id, &run.tick[1], &out); /* a clock that restarted */
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, out.guard);
}

/* Armed, exciting, settling: a program that restores has no permission to act. */
static void test_an_active_identifier_is_restored_disarmed_and_acts_only_when_armed_again(void)
{
    auvid_output_t out;
    uint32_t states = 0;
    record(false);
    begin(&id);
    for (uint32_t k = 1; k < run.ticks; ++k) {
        step(&id, &run.tick[k], &out);
        if ((states >> actuation.guard.state & 1u) != 0 && k % 1000 != 0) {
            continue;
        }
        static auvid_identifier_t before;
        static auvid_actuation_t acting_before;
        static auvid_validation_t prediction_before;
        static auvid_change_detector_t change_before;
        static auvid_prior_t prior_before;
        auvid_guard_state_t state = actuation.guard.state;
        bool latched = state == AUVID_GUARD_DONE || state == AUVID_GUARD_ABORTED;
        states |= 1u << state;
        before = id;
        acting_before = actuation;
        prediction_before = prediction;
        change_before = change;
        prior_before = prior;
        uint32_t bytes = save(&id, saved);
        begin(&id);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
        TEST_ASSERT_EQUAL(latched ? state : AUVID_GUARD_DISARMED, actuation.guard.state);
        for (uint32_t i = k + 1; i < k + 50 && i < run.ticks; ++i) {
            (void)auvid_identifier_step(&id, &run.tick[i].in, &out);
            TEST_ASSERT_EQUAL_MEMORY((auvid_real_t[AUVID_DOF_COUNT]){0}, out.excitation,
                                     sizeof out.excitation);
        }
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&id));
        if (state == AUVID_GUARD_EXCITING && k + 50 < run.ticks) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&id));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&id));
            (void)auvid_identifier_step(&id, &run.tick[k + 50].in, &out);
            TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, out.guard);
            TEST_ASSERT_EQUAL_UINT64(run.tick[k + 50].in.t_us, actuation.excitation.start_us);
        }
        id = before;
        actuation = acting_before;
        prediction = prediction_before;
        change = change_before;
        prior = prior_before;
    }
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_GUARD_DISARMED | 1u << AUVID_GUARD_EXCITING |
                                1u << AUVID_GUARD_SETTLING,
                            states);
}

int main(int count, char **argument)
{
    self = argument[0];
    if (count == 4) {
        setUp();
        int tick = continue_run(argument[1], argument[2], (uint32_t)atoi(argument[3]));
        if (tick != 0) {
            printf("saved after tick %s: output differs in tick %d\n", argument[3], tick);
        }
        return tick != 0;
    }
    int file = mkstemp(path);
    if (file < 0 || close(file) != 0) {
        return 1;
    }
    (void)snprintf(saved_path, sizeof saved_path, "%s_", path);
    UNITY_BEGIN();
    RUN_TEST(test_a_run_saved_at_random_ticks_continues_in_a_new_process_bit_for_bit);
    RUN_TEST(test_an_excitation_that_was_interrupted_is_aborted);
    RUN_TEST(test_an_active_identifier_is_restored_disarmed_and_acts_only_when_armed_again);
    int status = UNITY_END();
    (void)remove(path);
    (void)remove(saved_path);
    return status;
}
