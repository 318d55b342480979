/* The checkpoint: what it accepts, what it refuses, and that an identifier continues from it. The
 * same in another process, with sensors and excitation: test_checkpoint_process.c. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/auvid_checksum_internal.h"
#include "base/auvid_math_internal.h"
#include "checkpoint/auvid_checkpoint_layout_internal.h"
#include "identifier/auvid_identifier_internal.h"
#include "binomial.h"
#include "by_residual.h"
#include "checkpoint_case.h"

static auvid_change_detector_t of_other;
static uint8_t again[AUVID_CHECKPOINT_MAX(ROWS)];

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
    check_refused(AUVID_ERR_DETACHED, saved, bytes); /* no memory for a prior is attached */
    init(&id);                                       /* and restore an empty one */
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
    check_refused(AUVID_ERR_DETACHED, saved, bytes); /* it has a prediction, *id has none */
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
    for (int k = 0; k < 17; ++k) {
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
        cfg.metric.closed_loop += k == 16;
        cfg.metric.open_loop += k == 17;
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
    cfg.metric.row_slots = sizeof store[0] / sizeof store[0][0];
    cfg.metric.sets = 8;
    init(&id);
    make(); /* whose init clears the storage */
    TEST_ASSERT_EQUAL_UINT32(ROWS, auvid_get_word(saved + 20));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    cfg.metric.rows = store[1];
    cfg.metric.row_slots = sizeof store[1] / sizeof store[1][0];
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

static void test_storage_need_not_be_zero_before_init(void)
{
    static auvid_row_t store[ROWS];
    static auvid_vehicle_t vehicle;
    vehicle = by_residual_girona500();
    cfg.vehicle = &vehicle;
    cfg.metric.rows = store;
    cfg.metric.row_slots = sizeof store / sizeof store[0];
    cfg.metric.sets = 8;
    memset(store, 0xff, sizeof store);
    init(&id);
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
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

static void test_one_with_an_acting_half_is_refused_without_and_vice_versa(void)
{
    bytes = save(&id, saved, sizeof saved);
    init_acting();
    check_refused(AUVID_ERR_ATTACHED, saved, bytes);
    uint32_t acting_bytes = save(&id, again, sizeof again);
    TEST_ASSERT_TRUE(acting_bytes > bytes + 500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, again, acting_bytes));
    init(&id);
    check_refused(AUVID_ERR_DETACHED, again, acting_bytes);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

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
    RUN_TEST(test_storage_need_not_be_zero_before_init);
    RUN_TEST(test_an_armed_guard_is_restored_disarmed_a_latched_one_latched);
    RUN_TEST(test_plan_thrusters_and_limits_are_those_of_init);
    RUN_TEST(test_work_in_an_unknown_phase_ends);
    RUN_TEST(test_one_with_an_acting_half_is_refused_without_and_vice_versa);
    RUN_TEST(test_an_identifier_that_steps_while_it_is_saved_is_detected);
    RUN_TEST(test_calls_out_of_order_are_refused);
    return UNITY_END();
}
