/*
 * Thrusters known from a data sheet, with the ordinary mixture of small mismatches of the field
 * simulator: what is flagged, and what is wrong, with Girona500's model of exact thrust, with the
 * thrusters identified without priors, and with priors.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/prior.h"
#include "auvid/thrusters.h"
#include "binomial.h"
#include "field/field_run.h"
#include "field/field_table.h"
#include "unity.h"

enum { OWN = AUVID_G500_COUNT, SETS = 8, SET_S = 30, PERIOD_US = 40000, ROW_CELLS = 2 };
enum { SLOTS = AUVID_THRUSTERS_SLOTS(SETS, SET_S * 1000000u, PERIOD_US) };

typedef enum { PLAIN, FREE_THRUSTERS, WITH_PRIORS, WAYS } way_t;
static const char *const way_name[WAYS] = {"exact thrust", "thrusters", "with priors"};

static int16_t commands[SIM_THRUSTERS * SLOTS];
static auvid_row_t store[(SETS + 1) * SET_S * 10 / ROW_CELLS];
static auvid_thrusters_t thrusters;
static field_run_t run;
static field_run_config_t config;
static field_record_t record;
static way_t way;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The thrusters as in the data sheet: their command is the force told. */
static void describe(auvid_thrusters_config_t *to)
{
    field_sheet_t sheet;
    field_sheet(config.field.vehicle, config.field.seed, &sheet);
    auvid_thrusters_defaults(to);
    to->hull = &auvid_girona500;
    to->thrusters = (uint8_t)sheet.thrusters;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < to->thrusters; ++i) {
            to->matrix[j][i] = (auvid_real_t)sheet.matrix[j][i];
        }
    }
    to->command_max = (auvid_real_t)sheet.thruster_max_N;
    to->gain_max = 3;
    to->dead_band_max = (auvid_real_t)(0.1 * sheet.thruster_max_N);
    to->period_us = PERIOD_US;
    to->log = commands;
    to->slots = SLOTS;
}

static bool configure(auvid_identifier_config_t *cfg)
{
    cfg->metric.rows = store;
    cfg->metric.row_slots = sizeof store / sizeof store[0];
    cfg->metric.row_cells = ROW_CELLS;
    cfg->metric.set_rows = SET_S * 10 / ROW_CELLS;
    cfg->metric.sets = SETS;
    cfg->metric.free &= ~(1u << OWN);
    cfg->metric.fixed[OWN] = 1;
    return auvid_thrusters_configure(&thrusters, cfg) == AUVID_OK;
}

static bool attach(auvid_identifier_t *id)
{
    static auvid_prior_t prior;
    return way != WITH_PRIORS || auvid_thrusters_attach_prior(&thrusters, id, &prior) == AUVID_OK;
}

static void identify(field_vehicle_t vehicle, uint64_t seed, double strength)
{
    auvid_thrusters_config_t described;
    field_run_defaults(&config);
    field_defaults(&config.field, vehicle, FIELD_EXCITED, seed);
    field_draw(&config.field, strength);
    config.uncertain = false;
    if (way != PLAIN) {
        describe(&described);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &described, NULL));
        config.model = &thrusters.vehicle;
        config.configure = configure;
        config.attach = attach;
        config.budget = 0; /* one search, of all sets */
    }
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
}

static void print(const field_table_t *table, const char *name)
{
    static const struct {
        const char *name;
        int at;
    } shown[] = {{"flagged", FIELD_AT(FIELD_FLAGGED, FIELD_ALL)},
                 {"wrong", FIELD_AT(FIELD_WRONG, FIELD_ALL)},
                 {"beyond", FIELD_AT(FIELD_BEYOND, FIELD_ALL)},
                 {"told wrong", FIELD_AT(FIELD_TOLD_WRONG, FIELD_ALL)},
                 {"rms masses", FIELD_AT(FIELD_ERROR, FIELD_MASSES)},
                 {"rms linear", FIELD_AT(FIELD_ERROR, FIELD_LINEAR)},
                 {"rms quadratic", FIELD_AT(FIELD_ERROR, FIELD_QUADRATIC)},
                 {"drag force 0.6 flagged", FIELD_AT_FORCE + FIELD_FORCE_FLAGGED * FIELD_PARTS + 1},
                 {"drag force 0.6 wrong", FIELD_AT_FORCE + FIELD_FORCE_WRONG * FIELD_PARTS + 1},
                 {"drag force 0.6 off", FIELD_AT_FORCE + FIELD_FORCE_OFF * FIELD_PARTS + 1}};
    printf("%s, %u runs\n", name, (unsigned)table->runs);
    for (size_t k = 0; k < sizeof shown / sizeof shown[0]; ++k) {
        const field_figure_t *f = &table->figure[shown[k].at];
        printf("  %-22s %6.1f %% [%5.1f, %5.1f]\n", shown[k].name, 100 * f->value, 100 * f->low,
               100 * f->high);
    }
    fflush(stdout);
}

/* Seeds that were not used to choose anything. */
enum { FRESH = 5000 };

/* Identifies `runs` mixtures, and prints what is flagged and wrong. Returns the sum of the dead
 * bands that were found [N]. */
static double check_runs(field_vehicle_t vehicle, way_t by, int runs)
{
    field_table_t table;
    double dead_bands = 0.0;
    way = by;
    TEST_ASSERT_TRUE(field_table_begin(&table, (uint32_t)runs));
    for (int k = 0; k < runs; ++k) {
        identify(vehicle, (uint64_t)(FRESH + k), 1.0);
        TEST_ASSERT_TRUE(run.id.estimate.number > 0);
        field_table_add(&table, &record);
        dead_bands += (double)run.id.estimate.pi[OWN + AUVID_THRUSTERS_DEAD_BAND];
    }
    TEST_ASSERT_TRUE(field_table_finish(&table, 1));
    if (campaign_is_long()) {
        print(&table, way_name[by]);
    }
    field_table_free(&table);
    return dead_bands;
}

/* What the model lacks looks like a dead band of several newtons. The data sheet says zero. */
static void check_vehicle(field_vehicle_t vehicle)
{
    const int runs = campaign_is_long() ? 60 : 2;
    (void)check_runs(vehicle, PLAIN, runs);
    double without = check_runs(vehicle, FREE_THRUSTERS, runs);
    double with = check_runs(vehicle, WITH_PRIORS, runs);
    TEST_ASSERT_TRUE(with < without);
}

static void test_in_mixtures_priors_keep_the_thrusters_of_girona500_near_their_data_sheet(void)
{
    check_vehicle(FIELD_GIRONA500);
}

static void test_in_mixtures_priors_keep_the_thrusters_of_the_rov_near_their_data_sheet(void)
{
    check_vehicle(FIELD_ROV20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_in_mixtures_priors_keep_the_thrusters_of_girona500_near_their_data_sheet);
    RUN_TEST(test_in_mixtures_priors_keep_the_thrusters_of_the_rov_near_their_data_sheet);
    return UNITY_END();
}
