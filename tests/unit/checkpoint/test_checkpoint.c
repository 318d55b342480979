/* The checkpoint: what it accepts, what it refuses, and that an identifier continues from it. The
 * same in another process, with sensors and excitation: test_checkpoint_process.c. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/prior.h"
#include "search/auvid_line_search_directions_internal.h"
#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "checkpoint/auvid_checkpoint_layout_internal.h"
#include "identifier/auvid_identifier_internal.h"
#include "binomial.h"
#include "by_residual.h"
#include "unity.h"

enum { CELL_US = 100000, SET_ROWS = 20, CELLS = 450, BUDGET = 400, ROWS = 9 * SET_ROWS };

static auvid_identifier_config_t cfg;
static auvid_identifier_t id, other;
static auvid_actuation_config_t acting;
static auvid_actuation_t actuation;
static auvid_validation_t prediction; /* of `id`, and of copies of it */
static auvid_change_detector_t change, of_other;
static auvid_prior_t prior;
static uint8_t saved[AUVID_CHECKPOINT_MAX(ROWS)], again[AUVID_CHECKPOINT_MAX(ROWS)];
static uint32_t bytes;

static void init(auvid_identifier_t *of)
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

static void init_predicting(auvid_identifier_t *of)
{
    init(of);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(of, &prediction));
}

void tearDown(void)
{
}

static void init_acting(void)
{
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
}

/* A cell of sinusoidal motion, with the wrench that causes it. */
static void record(auvid_identifier_t *to, int cell)
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
static void move(auvid_identifier_t *to, int cell)
{
    record(to, cell);
    (void)auvid_identifier_work(to, BUDGET);
}

static void move_from_to(auvid_identifier_t *to, int first, int last)
{
    for (int cell = first; cell < last; ++cell) {
        move(to, cell);
    }
}

/* Save in chunks of up to `chunk` bytes. @return bytes of the checkpoint */
static uint32_t save(const auvid_identifier_t *from, uint8_t *to, uint32_t chunk)
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

/* Save an identifier in the middle of its second search. */
static void make(void)
{
    for (int cell = 1; cell < CELLS && !(id.estimate.number == 1 && id.work.searching); ++cell) {
        move(&id, cell);
    }
    TEST_ASSERT_TRUE(id.work.searching);
    bytes = save(&id, saved, sizeof saved);
    init(&id);
}

static void check_refused(auvid_status_t status, const uint8_t *checkpoint, uint32_t size)
{
    other = id;
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_restore(&id, checkpoint, size));
    TEST_ASSERT_EQUAL(status, auvid_checkpoint_resume(&id, checkpoint, size));
    TEST_ASSERT_EQUAL_MEMORY(&other, &id, sizeof other);
}

static void test_the_bytes_do_not_depend_on_the_chunks(void)
{
    static const uint32_t chunk[] = {1, 3, 17, 256, 4096};
    make();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    for (size_t i = 0; i < sizeof chunk / sizeof chunk[0]; ++i) {
        memset(again, 0, sizeof again);
        TEST_ASSERT_EQUAL_UINT32(bytes, save(&id, again, chunk[i]));
        TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
    }
    TEST_ASSERT_TRUE(bytes <= AUVID_CHECKPOINT_MAX(0));
    uint32_t check = 0;
    memcpy(&check, saved + bytes - 4, 4);
    printf("%u bytes, checksum %08lx\n", (unsigned)bytes, (unsigned long)check);
    fflush(stdout);
}

static void test_after_the_last_byte_there_is_none(void)
{
    auvid_checkpoint_t cursor;
    uint32_t part = sizeof again;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, again, &part));
    TEST_ASSERT_EQUAL_UINT32(cursor.bytes, part);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, again, &part));
    TEST_ASSERT_EQUAL_UINT32(0, part);
}

/* At many ticks of a run: restore into another identifier. Both continue identically, to the same
 * bytes. */
static void test_an_identifier_continues_where_it_was_saved(void)
{
    uint32_t phases = 0;
    for (int cell = 1; cell < CELLS; ++cell) {
        move(&id, cell);
        if (cell % 37 == 0 || !(phases >> id.work.phase & 1u)) {
            phases |= 1u << id.work.phase;
            bytes = save(&id, saved, 333);
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&other, &cfg));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&other, &of_other));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&other, &prior));
            move_from_to(&other, 1, 100); /* with a state of its own */
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&other, saved, bytes));
            static auvid_identifier_t twin;
            static auvid_change_detector_t of_twin;
            twin = id;
            of_twin = change;
            twin.attached.change = &of_twin;
            move_from_to(&twin, cell + 1, cell + 60);
            move_from_to(&other, cell + 1, cell + 60);
            bytes = save(&twin, saved, sizeof saved);
            TEST_ASSERT_EQUAL_UINT32(bytes, save(&other, again, sizeof again));
            TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
        }
    }
    TEST_ASSERT_TRUE(id.estimate.number >= 2 && phases != 1u);
}

/* Restore into an identifier that has an estimate and is in the middle of a search. */
static void test_nothing_is_left_of_the_previous_state(void)
{
    static auvid_identifier_t twin;
    static auvid_change_detector_t of_twin;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&twin, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&twin, &of_twin));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prior(&twin, &prior));
    move_from_to(&twin, 1, 9);
    bytes = save(&twin, saved, sizeof saved);
    for (int cell = 1; cell < CELLS && !(id.estimate.number == 1 && id.work.searching); ++cell) {
        move(&id, cell);
    }
    TEST_ASSERT_TRUE(id.work.searching);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    TEST_ASSERT_EQUAL_UINT32(bytes, save(&id, again, sizeof again));
    TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
    move_from_to(&twin, 9, 250);
    move_from_to(&id, 9, 250);
    TEST_ASSERT_TRUE(id.estimate.number >= 1);
    bytes = save(&twin, saved, sizeof saved);
    TEST_ASSERT_EQUAL_UINT32(bytes, save(&id, again, sizeof again));
    TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
}

static void test_a_prior_record_is_part_of_it(void)
{
    static uint8_t record[AUVID_PRIOR_BYTES];
    move_from_to(&id, 1, 240);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&id, record));
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&id, record, sizeof record));
    bytes = save(&id, saved, sizeof saved);
    auvid_prior_t loaded = prior;
    TEST_ASSERT_TRUE(loaded.known != 0);
    init(&other);
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&other, saved, bytes));
    TEST_ASSERT_EQUAL_MEMORY(&loaded, &prior, sizeof prior);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    check_refused(AUVID_ERR_STATE, saved, bytes); /* no memory for a prior is attached */
    init(&id);                                    /* and restore an empty one */
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&id, record, sizeof record));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
}

static void test_what_is_attached_stays(void)
{
    static auvid_validation_t validation;
    init_predicting(&id); /* nothing is predicted yet: fits one without a prediction, too */
    uint32_t empty_bytes = save(&id, again, sizeof again);
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, again, empty_bytes));
    init_predicting(&id);
    make();
    check_refused(AUVID_ERR_STATE, saved, bytes); /* it has a prediction, *id has none */
    init_predicting(&id);
    auvid_identifier_attach(&id, &validation);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    TEST_ASSERT_EQUAL_PTR(&prediction, id.attached.prediction);
    TEST_ASSERT_EQUAL_PTR(&validation, id.attached.validation);
    TEST_ASSERT_EQUAL_PTR(&auvid_girona500, id.metric.cfg.vehicle);
    TEST_ASSERT_EQUAL_PTR(&auvid_girona500, prediction.vehicle);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, again, empty_bytes));
    TEST_ASSERT_NULL(prediction.vehicle);
}

/* All positions (in double every eleventh, except in the long form). In head and tail all other
 * values, elsewhere one of them. */
static void test_every_damaged_byte_is_detected(void)
{
#ifdef __linux__
    const uint32_t stride = campaign_is_long() || sizeof(auvid_real_t) == 4 ? 1 : 11;
#else
    const uint32_t stride = 199; /* in an emulator */
#endif
    auvid_rng_t rng;
    auvid_rng_seed(&rng, 1);
    make();
    other = id;
    for (uint32_t k = 0; k < bytes;) {
        bool edge = k < AUVID_CHECKPOINT_HEAD || k >= bytes - AUVID_CHECKPOINT_TAIL;
        for (uint32_t i = 1; i < (edge ? 256u : 2u); ++i) {
            uint8_t change = (uint8_t)(edge ? i : 1u + auvid_rng_below(&rng, 255));
            saved[k] = (uint8_t)(saved[k] ^ change);
            TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_checkpoint_restore(&id, saved, bytes));
            saved[k] = (uint8_t)(saved[k] ^ change);
        }
        TEST_ASSERT_EQUAL_INT(0, memcmp(&other, &id, sizeof id));
        k += k < AUVID_CHECKPOINT_HEAD || k + stride >= bytes - AUVID_CHECKPOINT_TAIL ? 1 : stride;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes)); /* it was valid */
}

static void test_a_checkpoint_cut_or_lengthened_is_refused(void)
{
    make();
    for (uint32_t size = 0; size < bytes; size += 1 + size / 32) {
        check_refused(AUVID_ERR_CHECKSUM, saved, size);
    }
    check_refused(AUVID_ERR_CHECKSUM, saved, bytes - 1);
    check_refused(AUVID_ERR_CHECKSUM, saved, bytes + 1);
    for (uint32_t size = 8; size <= AUVID_CHECKPOINT_HEAD + AUVID_CHECKPOINT_TAIL; ++size) {
        memcpy(again, saved, size - 4); /* with a correct checksum */
        auvid_put_word(again + size - 4, ~auvid_checksum(UINT32_MAX, again, size - 4));
        check_refused(AUVID_ERR_CHECKSUM, again, size);
    }
    memset(again, 0, sizeof again); /* erased flash */
    check_refused(AUVID_ERR_CHECKSUM, again, bytes);
    memset(again, 0xFF, sizeof again);
    check_refused(AUVID_ERR_CHECKSUM, again, bytes);
}

/* Of the version, of the layout that tests/validation/layout.py computes, and of the sizes. */
static void test_the_head_is_of_this_layout(void)
{
    uint32_t c = auvid_checksum_word(
        UINT32_MAX, AUVID_VERSION_MAJOR * 65536 + AUVID_VERSION_MINOR * 256 + AUVID_VERSION_PATCH);
    c = auvid_checksum_word(c, AUVID_CHECKPOINT_LAYOUT);
    for (int k = 0; k < CHECKPOINT_BLOCKS; ++k) {
        c = auvid_checksum_word(c, auvid_checkpoint_block[k].bytes);
    }
    (void)save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL_HEX32(c, auvid_get_word(saved + 4));
}

/* Undamaged checkpoints from elsewhere, with a correct checksum. */
static void forge(uint32_t at)
{
    saved[at] ^= 1u;
    uint32_t c = UINT32_MAX;
    for (uint32_t k = 0; k < bytes - 4; ++k) {
        c ^= saved[k];
        for (int bit = 0; bit < 8; ++bit) {
            c = c >> 1 ^ (0xEDB88320u & (0u - (c & 1u)));
        }
    }
    for (uint32_t k = 0; k < 4; ++k) {
        saved[bytes - 4 + k] = (uint8_t)(~c >> 8 * k);
    }
}

static void check_forged(auvid_status_t status, uint32_t byte)
{
    forge(byte);
    check_refused(status, saved, bytes);
    forge(byte);
}

static void test_one_of_another_version_or_other_sizes_is_refused(void)
{
    make();
    for (uint32_t byte = 0; byte < 4; ++byte) {
        check_forged(AUVID_ERR_CHECKSUM, 0 + byte); /* the format */
        check_forged(AUVID_ERR_SIZE, 4 + byte);     /* the checksum of the layout */
        check_forged(AUVID_ERR_MODEL, 8 + byte);    /* that of the model */
        check_forged(AUVID_ERR_CONFIGURATION, 12 + byte);
        check_forged(AUVID_ERR_SIZE, 20 + byte);     /* the storage of a model without regressor */
        check_forged(AUVID_ERR_CHECKSUM, 24 + byte); /* the length */
    }
    check_forged(AUVID_ERR_CHECKSUM, 16); /* parts that this model cannot have */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_one_of_another_model_is_refused(void)
{
    make();
    cfg.metric.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_R);
    init(&id);
    check_refused(AUVID_ERR_MODEL, saved, bytes);
    cfg.metric.free = 0;
    auvid_identifier_defaults(&cfg, &auvid_girona500_decoupled);
    init(&id);
    check_refused(AUVID_ERR_MODEL, saved, bytes);
    static auvid_vehicle_t nameless;
    nameless = auvid_girona500;
    nameless.name = NULL;
    auvid_identifier_defaults(&cfg, &nameless);
    init(&id);
    check_refused(AUVID_ERR_MODEL, saved, bytes);
    static auvid_vehicle_t other_equation;
    other_equation = auvid_girona500;
    other_equation.columns[AUVID_SURGE] ^= 1u << AUVID_G500_M_R;
    auvid_identifier_defaults(&cfg, &other_equation);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    check_refused(AUVID_ERR_MODEL, saved, bytes);
}

/* What a checkpoint was saved with must be what it continues with. */
static void test_one_of_another_configuration_is_refused(void)
{
    static auvid_identifier_config_t same;
    same = cfg;
    bytes = save(&id, saved, sizeof saved);
    for (int k = 0; k < 16; ++k) {
        cfg = same;
        cfg.nav.gate += (auvid_real_t)(k == 0);
        cfg.nav.max_consecutive_rejections += k == 1;
        cfg.nav.mount.imu_euler[2] += (auvid_real_t)(k == 2);
        cfg.recorder.gap_us += 2000000 * (k == 3);
        cfg.recorder.input += k == 4;
        cfg.metric.tau_max[3] += (auvid_real_t)(k == 5);
        cfg.metric.set_rows += k == 6;
        cfg.metric.sets -= k == 7;
        cfg.metric.estimate_delay = k != 8;
        cfg.metric.first_order_lag += k == 9;
        cfg.velocity = k == 10 ? AUVID_VELOCITY_WATER : AUVID_VELOCITY_GROUND;
        cfg.search.lower[0] += (auvid_real_t)(k == 11);
        cfg.search.seed += k == 12;
        cfg.search.paper = k == 13;
        cfg.dry_mass_kg += (auvid_real_t)(k == 14);
        cfg.uncertainty.delay_s += AUVID_C(0.1) * (auvid_real_t)(k == 15);
        init(&id);
        check_refused(AUVID_ERR_CONFIGURATION, saved, bytes);
    }
    cfg = same;
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_rows_are_part_of_it_and_other_storage_is_refused(void)
{
    static auvid_row_t store[2][ROWS];
    static auvid_vehicle_t vehicle;
    vehicle = by_residual_girona500();
    cfg.vehicle = &vehicle;
    cfg.metric.rows = store[0];
    cfg.metric.sets = 8;
    init(&id);
    make(); /* with the same contents of its storage */
    TEST_ASSERT_EQUAL_UINT32(ROWS, auvid_get_word(saved + 20));
    cfg.metric.rows = store[1];
    init(&id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    TEST_ASSERT_EQUAL_PTR(store[1], id.metric.cfg.rows);
    TEST_ASSERT_EQUAL_UINT64(store[0][SET_ROWS].sample.t_us, store[1][SET_ROWS].sample.t_us);
    TEST_ASSERT_TRUE(store[1][SET_ROWS].sample.t_us > 0);
    TEST_ASSERT_EQUAL_MEMORY(store[0][1].late, store[1][1].late, sizeof store[0][1].late);
    TEST_ASSERT_EQUAL_UINT32(bytes, save(&id, again, 100));
    TEST_ASSERT_EQUAL_MEMORY(saved, again, bytes);
    cfg.metric.sets = 7;
    init(&id);
    check_refused(AUVID_ERR_SIZE, saved, bytes);
    cfg.vehicle = &auvid_girona500;
    init(&id);
    check_refused(AUVID_ERR_MODEL, saved, bytes);
}

/* Stages of a run, set directly. */
static void test_an_armed_guard_is_restored_disarmed_a_latched_one_latched(void)
{
    for (int state = AUVID_GUARD_DISARMED; state <= AUVID_GUARD_ABORTED; ++state) {
        bool watched = state >= AUVID_GUARD_ARMED && state <= AUVID_GUARD_SETTLING;
        const auvid_excitation_t *run = &actuation.excitation;
        init_acting();
        actuation.guard.state = (auvid_guard_state_t)state;
        actuation.starting = watched;
        actuation.excitation.running = actuation.excitation.stopping = watched;
        bytes = save(&id, saved, sizeof saved);
        init_acting();
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
        TEST_ASSERT_EQUAL(watched ? AUVID_GUARD_DISARMED : state, actuation.guard.state);
        TEST_ASSERT_FALSE(actuation.starting || run->running || run->stopping);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(&id, saved, bytes));
        TEST_ASSERT_EQUAL(state, actuation.guard.state);
        TEST_ASSERT_EQUAL(watched, actuation.starting && run->running && run->stopping);
    }
}

/* The plan and the guard's limits decide on forces: a file must not change them. */
static void test_plan_thrusters_and_limits_are_those_of_init(void)
{
    const auvid_real_t weak[AUVID_DOF_COUNT] = {10}, strong[AUVID_DOF_COUNT] = {100};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&acting.excitation, strong, 30, 2, 1));
    acting.guard.distance_max_m = 300;
    init_acting();
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&acting.excitation, weak, 30, 2, 1));
    acting.guard.distance_max_m = 30;
    init_acting();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    auvid_real_t peak[AUVID_DOF_COUNT];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_peak(&actuation.excitation, peak));
    TEST_ASSERT_EQUAL_MEMORY(weak, peak, sizeof peak);
    TEST_ASSERT_TRUE(actuation.guard.cfg.distance_max_m < 31);
}

static void test_work_in_an_unknown_phase_ends(void)
{
    id.work.phase = UINT8_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&id, BUDGET));
    TEST_ASSERT_EQUAL(AUVID_WORK_IDLE, id.work.phase);
}

/* As auvid_checkpoint_begin writes them if memory is damaged. */
static auvid_identifier_t good;
#define IMPOSSIBLE(assignment)                                                                     \
    other = good;                                                                                  \
    other.assignment;                                                                              \
    bytes = save(&other, saved, sizeof saved);                                                     \
    check_refused(AUVID_ERR_RANGE, saved, bytes)

static void check_good(void)
{
    bytes = save(&good, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_impossible_values_are_refused(void)
{
    init(&good);
    IMPOSSIBLE(work.phase = UINT8_MAX);
    IMPOSSIBLE(metric.rows.set.rows = SET_ROWS + 1);
    IMPOSSIBLE(metric.sets.set[3].exponent[0] = 100);
    IMPOSSIBLE(metric.sets.set[3].excited = 1); /* without a row */
    IMPOSSIBLE(metric.rows.set.factor[0][0] = AUVID_C(1e30));
    IMPOSSIBLE(nav.gps.count = 200);
    IMPOSSIBLE(nav.ekf.position[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(estimate.pi[0] = (auvid_real_t)-INFINITY);
    IMPOSSIBLE(nav.ground.measured = 8);
    IMPOSSIBLE(nav.imu.past_next = 2 * AUVID_NAV_PAST);
    IMPOSSIBLE(nav.held.valid[1] = 8);
    IMPOSSIBLE(nav.held.sensors = 1); /* before the first tick */
    IMPOSSIBLE(metric.rows.missing[0][1] = 64);
    IMPOSSIBLE(metric.rows.successive[0] = AUVID_METRIC_LAGS + 1);
    IMPOSSIBLE(metric.evaluator.window_of[0] = AUVID_METRIC_WINDOW + 1);
    IMPOSSIBLE(metric.rows.set.rows_of[0] = 1);    /* of no row */
    IMPOSSIBLE(metric.sets.set[3].number = 1);     /* none was recorded */
    IMPOSSIBLE(metric.sets.set[3].windows[0] = 1); /* of no row */
    IMPOSSIBLE(metric.sets.from = 1);              /* the ring is not held */
    IMPOSSIBLE(metric.sets.least = 1);
    IMPOSSIBLE(metric.sets.full = true);
    IMPOSSIBLE(metric.sets.changed = true);
    IMPOSSIBLE(metric.sets.held = true); /* no work is under way */
    IMPOSSIBLE(metric.sets.waiting = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(metric.evaluator.sets_merged = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(work.untested = 1);
    IMPOSSIBLE(work.active = 1u << 31);
    IMPOSSIBLE(work.searching = true);
    IMPOSSIBLE(estimate.speed[0][0] = -1);
    IMPOSSIBLE(estimate.confidence.lost[0] = 101);
    IMPOSSIBLE(estimate.confidence.note[0] = AUVID_NOTE_UNCHECKED + 1);
    IMPOSSIBLE(estimate.confidence.thrust_error[0] = AUVID_C(2e18));
    IMPOSSIBLE(estimate.confidence.dvl_error[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(estimate.confidence.uncertainty.thrust_scale = AUVID_C(1.1));
    IMPOSSIBLE(estimate.covariance[0] = AUVID_C(2e37));
    check_good();
}

static void test_impossible_values_of_the_acting_half_are_refused(void)
{
    static auvid_actuation_t before;
    static auvid_adaptive_t adaptive;
    auvid_adaptive_config_t plan;
    auvid_adaptive_defaults(&plan);
    plan.amplitude[AUVID_SURGE] = 100;
    init_acting();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&id, &adaptive, &plan));
    before = actuation;
    for (int k = 0; k < 6; ++k) {
        actuation = before;
        actuation.guard.state = k == 0 ? (auvid_guard_state_t)17 : before.guard.state;
        adaptive.low_owed[0] = k == 1 ? AUVID_C(2e9) : 0;
        actuation.altitude_m = k == 2 ? -1 : 0;
        actuation.home[1] = k == 3 ? (auvid_real_t)NAN : 0;
        actuation.excitation.displacement[2] = k == 4 ? (auvid_real_t)INFINITY : 0;
        bytes = save(&id, saved, sizeof saved);
        actuation = before;
        adaptive.low_owed[0] = 0;
        if (k < 5) {
            check_refused(AUVID_ERR_RANGE, saved, bytes);
            TEST_ASSERT_EQUAL_MEMORY(&before, &actuation, sizeof before);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_one_with_an_acting_half_is_refused_without_and_vice_versa(void)
{
    bytes = save(&id, saved, sizeof saved);
    init_acting();
    check_refused(AUVID_ERR_STATE, saved, bytes);
    uint32_t acting_bytes = save(&id, again, sizeof again);
    TEST_ASSERT_TRUE(acting_bytes > bytes + 500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, again, acting_bytes));
    init(&id);
    check_refused(AUVID_ERR_STATE, again, acting_bytes);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_a_note_that_names_no_parameter_is_refused(void)
{
    static auvid_vehicle_t vehicle; /* with fewer parameters than there is room for */
    vehicle = auvid_girona500;
    --vehicle.parameters;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        vehicle.columns[j] &= ~(1u << vehicle.parameters);
    }
    vehicle.free &= ~(1u << vehicle.parameters);
    cfg.vehicle = &vehicle;
    init(&id);
    init(&good);
    good.estimate.confidence.note[0] = AUVID_NOTE_BESIDE_BOUND;
    change.accepted.confidence.note[0] = AUVID_NOTE_COMBINATION;
    IMPOSSIBLE(estimate.confidence.partner[0] = vehicle.parameters);
    IMPOSSIBLE(attached.change->accepted.confidence.partner[0] = vehicle.parameters);
    change.accepted.confidence.partner[0] = 0;
    good.estimate.confidence.note[0] = AUVID_NOTE_DISCREDITED;
    IMPOSSIBLE(estimate.confidence.partner[0] = vehicle.parameters);
    check_good();
}

/* The recorder's ring does not reach from its oldest cell to the newest: a walk through it would
 * take hours. */
static void test_a_record_of_too_many_cells_is_refused(void)
{
    move_from_to(&id, 1, 9);
    TEST_ASSERT_TRUE(id.recorder.running);
    good = id;
    IMPOSSIBLE(recorder.next = 0);
    IMPOSSIBLE(recorder.next = UINT32_MAX);
    IMPOSSIBLE(recorder.opened = good.recorder.next + AUVID_RECORDER_CELLS);
    IMPOSSIBLE(recorder.stream[0].cell = UINT32_MAX);
    IMPOSSIBLE(recorder.stream[4].valid = false);
    IMPOSSIBLE(recorder.measured[15] = 8);
    IMPOSSIBLE(recorder.velocity_us = 0);
    IMPOSSIBLE(recorder.cell_us = 200000);
    IMPOSSIBLE(metric.result.doublings = 1);
    IMPOSSIBLE(metric.result.doublings = 32);
    IMPOSSIBLE(metric.evaluator.noise = 4);
    IMPOSSIBLE(recorder.velocity_us = 1000001);
    IMPOSSIBLE(recorder.intervals = AUVID_RECORDER_INTERVALS);
    IMPOSSIBLE(recorder.interval_us[6] = 1000001);
    IMPOSSIBLE(recorder.gap_us = 0);
    check_good();
}

/* Work until this phase, a few units at a time. */
static void move_to_phase(uint8_t phase)
{
    for (int cell = 1; cell < CELLS && id.work.phase != phase; ++cell) {
        record(&id, cell);
        for (int k = 0; k < BUDGET && id.work.phase != phase; ++k) {
            (void)auvid_identifier_work(&id, 10);
        }
    }
    TEST_ASSERT_EQUAL(phase, id.work.phase);
    good = id;
}

static void test_an_impossible_optimum_is_refused(void)
{
    move_to_phase(AUVID_WORK_MERGE);
    for (int k = 0; k < 100000 && good.work.spent != WORK_OPTIMUM; ++k) {
        (void)auvid_identifier_work(&good, 1);
    }
    TEST_ASSERT_EQUAL(AUVID_WORK_MERGE, good.work.phase);
    TEST_ASSERT_TRUE(good.optimum.n > 1);
    IMPOSSIBLE(optimum.n = 0);
    IMPOSSIBLE(optimum.n = (uint8_t)(good.optimum.n - 1));
    IMPOSSIBLE(optimum.order[0] = good.optimum.n);
    IMPOSSIBLE(optimum.fixed_from = (uint8_t)(good.optimum.n + 1));
    IMPOSSIBLE(optimum.at = (uint8_t)(good.optimum.n + 2));
    IMPOSSIBLE(optimum.changes = UINT8_MAX);
    IMPOSSIBLE(optimum.dof = AUVID_DOF_COUNT + 1);
    IMPOSSIBLE(optimum.row = UINT8_MAX);
    IMPOSSIBLE(optimum.x[0] = good.optimum.upper[0] + 1);
    IMPOSSIBLE(optimum.qr_factor[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(work.active = 0);
    IMPOSSIBLE(metric.sets.held = false);
    IMPOSSIBLE(metric.sets.waiting = 1); /* it would not be used */
    check_good();
}

/* Directions are made conjugate by probes along the directions before. On the regressor path only
 * if the certificate is wrong. */
static void test_a_probe_along_a_direction_not_before_its_own_is_refused(void)
{
    const auvid_line_search_t *search = &good.optimizer.line_search;
    move_to_phase(AUVID_WORK_COST);
    good.optimizer.least = AUVID_C(1.0);
    for (int k = 0; k < 100000 && !(good.optimizer.state == AUVID_OPTIMIZER_LOCAL &&
                                    search->move == MOVE_PROBE && good.optimizer.asked);
         ++k) {
        (void)auvid_identifier_work(&good, 1);
    }
    TEST_ASSERT_EQUAL(MOVE_PROBE, search->move);
    TEST_ASSERT_TRUE(good.optimizer.asked);
    TEST_ASSERT_TRUE(search->probe < search->direction / 2);
    IMPOSSIBLE(optimizer.line_search.probe = (uint8_t)(search->direction / 2));
    IMPOSSIBLE(optimizer.line_search.probe = (uint8_t)(good.optimizer.cfg.n - 1));
    IMPOSSIBLE(optimizer.line_search.direction = 0);
    check_good();
}

static void test_sets_that_contradict_the_phase_of_work_are_refused(void)
{
    move_to_phase(AUVID_WORK_PREDICT); /* of the first estimate, by the next set */
    TEST_ASSERT_EQUAL(1, good.work.untested);
    IMPOSSIBLE(work.untested = 0);
    IMPOSSIBLE(work.untested = 2);
    IMPOSSIBLE(metric.sets.from = 1);
    IMPOSSIBLE(metric.sets.full = true); /* with a regressor */
    IMPOSSIBLE(metric.evaluator.at.to_set = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(metric.sets.set[0].rows_of[0] = SET_ROWS + 1);
    IMPOSSIBLE(metric.sets.set[0].rows_of[0] = 0); /* of an excited DoF */
    check_good();
}

static void test_a_prediction_of_more_cells_than_there_were_is_refused(void)
{
    init_predicting(&id);
    for (int cell = 1; cell < CELLS && id.estimate.number == 0; ++cell) {
        move(&id, cell);
    }
    TEST_ASSERT_NOT_NULL(prediction.vehicle);
    ++prediction.compared[0];
    bytes = save(&id, saved, sizeof saved);
    --prediction.compared[0];
    check_refused(AUVID_ERR_RANGE, saved, bytes);
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_a_held_sample_not_ahead_of_the_imu_is_refused(void)
{
    const auvid_real_t still[3] = {0};
    const auvid_dvl_sample_t ahead = {.t_us = 200000, .valid = AUVID_DVL_ALL};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_imu(&id.nav, 100000, still, still));
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_nav_dvl(&id.nav, &ahead));
    good = id;
    IMPOSSIBLE(nav.held.t_us[AUVID_NAV_DVL_BOTTOM] = 100000);
    IMPOSSIBLE(nav.held.t_us[AUVID_NAV_DVL_BOTTOM] = 100001 + good.nav.cfg.max_age_us[0]);
    IMPOSSIBLE(nav.held.value[AUVID_NAV_DVL_BOTTOM][0] = AUVID_C(1e6));
    check_good();
}
#undef IMPOSSIBLE

static void test_an_identifier_that_steps_while_it_is_saved_is_detected(void)
{
    auvid_checkpoint_t cursor;
    auvid_input_t in = {.t_us = 20000};
    auvid_output_t out;
    uint32_t part = 100;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &id));
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_checkpoint_next(&cursor, again, &part));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_checkpoint_next(&cursor, again, &part));
    TEST_ASSERT_EQUAL_UINT32(0, part);
}

static void test_calls_out_of_order_are_refused(void)
{
    auvid_checkpoint_t cursor;
    uint32_t part = sizeof again;
    make();
    memset(&cursor, 0, sizeof cursor);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_checkpoint_next(&cursor, again, &part));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_next(NULL, again, &part));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_next(&cursor, NULL, &part));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_next(&cursor, again, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_begin(NULL, &id));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_begin(&cursor, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_restore(NULL, saved, bytes));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_restore(&id, NULL, bytes));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_resume(NULL, saved, bytes));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_checkpoint_resume(&id, NULL, bytes));
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_checkpoint_begin(&cursor, &id));
    check_refused(AUVID_ERR_STATE, saved, bytes);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_bytes_do_not_depend_on_the_chunks);
    RUN_TEST(test_after_the_last_byte_there_is_none);
    RUN_TEST(test_an_identifier_continues_where_it_was_saved);
    RUN_TEST(test_nothing_is_left_of_the_previous_state);
    RUN_TEST(test_a_prior_record_is_part_of_it);
    RUN_TEST(test_what_is_attached_stays);
    RUN_TEST(test_every_damaged_byte_is_detected);
    RUN_TEST(test_a_checkpoint_cut_or_lengthened_is_refused);
    RUN_TEST(test_the_head_is_of_this_layout);
    RUN_TEST(test_one_of_another_version_or_other_sizes_is_refused);
    RUN_TEST(test_one_of_another_model_is_refused);
    RUN_TEST(test_one_of_another_configuration_is_refused);
    RUN_TEST(test_rows_are_part_of_it_and_other_storage_is_refused);
    RUN_TEST(test_an_armed_guard_is_restored_disarmed_a_latched_one_latched);
    RUN_TEST(test_plan_thrusters_and_limits_are_those_of_init);
    RUN_TEST(test_work_in_an_unknown_phase_ends);
    RUN_TEST(test_impossible_values_are_refused);
    RUN_TEST(test_impossible_values_of_the_acting_half_are_refused);
    RUN_TEST(test_one_with_an_acting_half_is_refused_without_and_vice_versa);
    RUN_TEST(test_a_note_that_names_no_parameter_is_refused);
    RUN_TEST(test_a_record_of_too_many_cells_is_refused);
    RUN_TEST(test_an_impossible_optimum_is_refused);
    RUN_TEST(test_a_probe_along_a_direction_not_before_its_own_is_refused);
    RUN_TEST(test_sets_that_contradict_the_phase_of_work_are_refused);
    RUN_TEST(test_a_prediction_of_more_cells_than_there_were_is_refused);
    RUN_TEST(test_a_held_sample_not_ahead_of_the_imu_is_refused);
    RUN_TEST(test_an_identifier_that_steps_while_it_is_saved_is_detected);
    RUN_TEST(test_calls_out_of_order_are_refused);
    return UNITY_END();
}
