/*
 * The width of the smoother follows the vehicle: a slow ship gets longer cells, a quick ROV keeps
 * its own. The logs are of ship_and_rov.h. The statistics, R2 and how often one and two standard
 * errors cover the truth, are of 4 logs of each; with AUVID_TEST_LONG in the environment of 200,
 * and the coverage must be in its range.
 */
#include <stdio.h>
#include <stdlib.h>

#include "auvid/checkpoint.h"
#include "ship_and_rov.h"
#include "unity.h"

static auvid_identifier_t id, other;
static auvid_identifier_config_t cfg;

void setUp(void)
{
    memset(&id, 0, sizeof id);
}

void tearDown(void)
{
}

static uint32_t run_aboard(const sea_log_t *log, uint32_t max_cell_us)
{
    sea_configure(log, 1, &cfg);
    cfg.metric.max_cell_us = max_cell_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    return sea_play(log, 1, 5000, &id);
}

static void test_a_slow_ship_gets_longer_cells_and_its_force_is_explained(void)
{
    uint32_t events = run_aboard(&sea_ship, 800000);
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    TEST_ASSERT_TRUE(events & AUVID_EVENT_LONGER_CELLS);
    TEST_ASSERT_TRUE(id.recorder.cell_us >= 200000 && id.recorder.cell_us <= 400000);
    TEST_ASSERT_EQUAL_UINT32(100000, id.recorder.cfg.cell_us);
    TEST_ASSERT_TRUE(id.metric.result.width_chosen);
    /* a sample of the velocity every 0.2 s, in cells */
    auvid_real_t cells = AUVID_C(200000.0) / (auvid_real_t)id.recorder.cell_us;
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, (float)(cells * cells / AUVID_C(12.0)),
                             (float)id.metric.layout.interpolation_spread);
    TEST_ASSERT_NOT_NULL(e);
    TEST_ASSERT_TRUE(e->r2_force[AUVID_SURGE] > AUVID_C(0.98));
    TEST_ASSERT_TRUE(e->r2_force[AUVID_SWAY] > AUVID_C(0.95));
    for (int i = AUVID_G500_M_U; i <= AUVID_G500_M_V; ++i) {
        double error = (double)e->pi[i] / sea_ship.pi[i] - 1.0;
        TEST_ASSERT_TRUE(fabs(error) < 0.04);
        TEST_ASSERT_TRUE(e->confidence.identifiable >> i & 1u);
    }
}

static void test_without_leave_the_cells_stay_and_less_of_the_force_is_explained(void)
{
    uint32_t events = run_aboard(&sea_ship, 0);
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    TEST_ASSERT_FALSE(events & AUVID_EVENT_LONGER_CELLS);
    TEST_ASSERT_EQUAL_UINT32(100000, id.recorder.cell_us);
    TEST_ASSERT_NOT_NULL(e);
    TEST_ASSERT_TRUE(e->r2_force[AUVID_SWAY] < AUVID_C(0.9));
}

static void test_cells_are_never_longer_than_permitted(void)
{
    sea_log_t waves = sea_ship;
    waves.wave_N = 150;
    (void)run_aboard(&waves, 399999);
    TEST_ASSERT_EQUAL_UINT32(200000, id.recorder.cell_us);
    TEST_ASSERT_TRUE(id.metric.result.width_chosen);
}

static void test_a_quick_rov_keeps_its_cells_also_in_noise(void)
{
    sea_log_t noisy = sea_rov;
    TEST_ASSERT_FALSE(run_aboard(&sea_rov, 800000) & AUVID_EVENT_LONGER_CELLS);
    TEST_ASSERT_TRUE(id.metric.result.width_chosen);
    noisy.noise_mps = 0.6;
    noisy.noise_radps = 0.6;
    TEST_ASSERT_FALSE(run_aboard(&noisy, 800000) & AUVID_EVENT_LONGER_CELLS);
    TEST_ASSERT_EQUAL_UINT32(100000, id.recorder.cell_us);
}

static void test_longer_cells_drop_all_sets_and_break_the_record(void)
{
    sea_log_t start = sea_ship;
    uint32_t events = 0;
    for (start.seconds = 30.0; (events & AUVID_EVENT_LONGER_CELLS) == 0; start.seconds += 1.0) {
        TEST_ASSERT_TRUE(start.seconds < 200.0);
        events = run_aboard(&start, 800000);
    }
    TEST_ASSERT_TRUE(id.recorder.broken || (events & AUVID_EVENT_GAP));
    TEST_ASSERT_EQUAL_UINT32(200000, id.recorder.cell_us);
    TEST_ASSERT_NOT_NULL(auvid_identifier_estimate(&id)); /* from the sets that are dropped */
    TEST_ASSERT_EQUAL(AUVID_WORK_IDLE, id.work.phase);
    TEST_ASSERT_EQUAL_UINT32(0, id.metric.rows.set.rows);
    for (int i = 0; i < AUVID_MAX_SETS; ++i) {
        TEST_ASSERT_EQUAL_UINT32(0, id.metric.sets.set[i].rows);
    }
}

static void test_longer_cells_begin_a_new_reference_for_drift(void)
{
    static auvid_change_detector_t detector;
    sea_configure(&sea_ship, 1, &cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &detector));
    detector.first.value[0][AUVID_HEAVE] = AUVID_C(1.0); /* of a DoF that rests */
    TEST_ASSERT_TRUE(sea_play(&sea_ship, 1, 5000, &id) & AUVID_EVENT_LONGER_CELLS);
    TEST_ASSERT_TRUE(detector.first.value[0][AUVID_HEAVE] < AUVID_C(1.0));
    TEST_ASSERT_FALSE(id.change_test.drifted);
}

static uint8_t saved[100000];

static void test_a_checkpoint_has_the_length_of_the_cells(void)
{
    auvid_checkpoint_t cursor;
    uint32_t bytes = sizeof saved;
    (void)run_aboard(&sea_ship, 800000);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, saved, &bytes));
    sea_configure(&sea_ship, 1, &cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&other, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&other, saved, bytes));
    TEST_ASSERT_EQUAL_UINT32(id.recorder.cell_us, other.recorder.cell_us);
    for (int run = 0; run < 2; ++run) { /* both continue alike, cell by cell */
        auvid_identifier_t *to = run == 0 ? &id : &other;
        auvid_real_t attitude[3] = {0}, nu[6] = {0}, tau[6] = {0};
        for (uint64_t t_us = 2000000000u; t_us < 2060000000u; t_us += 100000) {
            nu[0] = tau[0] = (auvid_real_t)(t_us % 7000000u) * AUVID_C(1e-7);
            (void)auvid_identifier_motion(to, t_us, attitude, nu);
            (void)auvid_identifier_applied(to, t_us, tau, NULL);
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(&id.metric.rows, &other.metric.rows, sizeof id.metric.rows);
}

/* Results of many logs: means over the logs, and their squares for the intervals. */
typedef struct {
    double runs, r2[3], within[2], squares[2], flagged, wrong, cells_s;
} tally_t;

static void tally_add(tally_t *tally, const sea_log_t *log)
{
    static const int parameter[] = {0, 1, 3, 5, 6, 7, 8, 11, 12}, dof[] = {0, 1, 5};
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    double within[2] = {0.0};
    TEST_ASSERT_NOT_NULL(e);
    for (size_t k = 0; k < sizeof parameter / sizeof parameter[0]; ++k) {
        int i = parameter[k];
        double error = fabs((double)e->pi[i] - log->pi[i]);
        double sigma = (double)e->confidence.sigma[i];
        bool flagged = (e->confidence.identifiable >> i & 1u) != 0;
        within[0] += (error < sigma) / 9.0;
        within[1] += (error < 2.0 * sigma) / 9.0;
        tally->flagged += flagged;
        tally->wrong += flagged && error > 0.2 * fabs(log->pi[i]);
    }
    for (int k = 0; k < 2; ++k) {
        tally->within[k] += within[k];
        tally->squares[k] += within[k] * within[k];
    }
    for (int k = 0; k < 3; ++k) {
        tally->r2[k] += (double)e->r2_force[dof[k]];
    }
    tally->cells_s += 1e-6 * id.recorder.cell_us;
    tally->runs += 1.0;
}

static double tally_interval(const tally_t *tally, int k)
{
    double n = tally->runs, mean = tally->within[k] / n;
    return 1.96 * sqrt(fmax(tally->squares[k] / n - mean * mean, 0.0) / (n - 1.0));
}

static tally_t campaign(const sea_log_t *log, uint32_t max_cell_us)
{
    tally_t tally = {.runs = 0.0};
    int runs = getenv("AUVID_TEST_LONG") != NULL ? 200 : 4;
    for (uint64_t seed = 9100001; seed <= 9100000u + (uint64_t)runs; ++seed) {
        TEST_ASSERT_TRUE(sea_fit(log, seed, max_cell_us, &id) > 0);
        tally_add(&tally, log);
    }
    double n = tally.runs;
    printf(
        "%s, %s cells, mean %.2f s, %.0f logs: R2 %.3f %.3f %.3f; one %.1f %% +- %.1f, two %.1f %% "
        "+- %.1f; flagged %.1f %%, of these wrong %.1f %%\n",
        log->name, max_cell_us > 0 ? "chosen" : "fixed", tally.cells_s / n, n, tally.r2[0] / n,
        tally.r2[1] / n, tally.r2[2] / n, 100.0 * tally.within[0] / n,
        100.0 * tally_interval(&tally, 0), 100.0 * tally.within[1] / n,
        100.0 * tally_interval(&tally, 1), 100.0 * tally.flagged / n / 9.0,
        tally.flagged > 0.0 ? 100.0 * tally.wrong / tally.flagged : 0.0);
    return tally;
}

static void check_coverage(const tally_t *tally)
{
    if (getenv("AUVID_TEST_LONG") != NULL) {
        TEST_ASSERT_TRUE(tally->within[0] / tally->runs > 0.60);
        TEST_ASSERT_TRUE(tally->within[0] / tally->runs < 0.80);
        TEST_ASSERT_TRUE(tally->within[1] / tally->runs > 0.92);
        TEST_ASSERT_TRUE(tally->within[1] / tally->runs < 0.99);
    }
}

static void test_chosen_cells_explain_the_force_of_ships_in_noise_and_in_waves(void)
{
    sea_log_t waves = sea_ship, rough = sea_ship;
    waves.name = "ship in waves";
    waves.wave_N = 40;
    rough.name = "ship in rough sea";
    rough.wave_N = 150;
    rough.noise_mps = 0.05;
    const sea_log_t *log[] = {&sea_ship, &waves, &rough};
    static const double most[] = {0.90, 0.80, 0.30}, least[] = {0.95, 0.94, 0.80};
    for (int k = 0; k < 3; ++k) {
        tally_t fixed = campaign(log[k], 0), chosen = campaign(log[k], 800000);
        TEST_ASSERT_TRUE(fixed.r2[1] < most[k] * fixed.runs);
        for (int j = 0; j < 3; ++j) {
            TEST_ASSERT_TRUE(chosen.r2[j] > least[k] * chosen.runs);
        }
        TEST_ASSERT_TRUE(chosen.flagged > fixed.flagged);
        if (k < 2) {
            check_coverage(&chosen);
        }
    }
}

static void test_the_choice_changes_nothing_for_an_rov(void)
{
    tally_t fixed = campaign(&sea_rov, 0), chosen = campaign(&sea_rov, 800000);
    TEST_ASSERT_EQUAL_MEMORY(&fixed, &chosen, sizeof fixed);
    check_coverage(&chosen);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_slow_ship_gets_longer_cells_and_its_force_is_explained);
    RUN_TEST(test_without_leave_the_cells_stay_and_less_of_the_force_is_explained);
    RUN_TEST(test_cells_are_never_longer_than_permitted);
    RUN_TEST(test_a_quick_rov_keeps_its_cells_also_in_noise);
    RUN_TEST(test_longer_cells_drop_all_sets_and_break_the_record);
    RUN_TEST(test_longer_cells_begin_a_new_reference_for_drift);
    RUN_TEST(test_a_checkpoint_has_the_length_of_the_cells);
    RUN_TEST(test_chosen_cells_explain_the_force_of_ships_in_noise_and_in_waves);
    RUN_TEST(test_the_choice_changes_nothing_for_an_rov);
    return UNITY_END();
}
