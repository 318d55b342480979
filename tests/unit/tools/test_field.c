/* The physics of the field simulator, its table and its drivers. The effect of each mismatch is in
 * test_field_mismatch.c. */
#include "field.h"

#include <math.h>
#include <string.h>

#include "field_hull.h"
#include "unity.h"

enum { X, Y, Z, K, M, N };

#define BELOW(limit, x) TEST_ASSERT_TRUE_MESSAGE((x) < (limit), #x)
#define NOT_ABOVE(limit, x) TEST_ASSERT_TRUE_MESSAGE((x) <= (limit), #x)
#define ABOVE(limit, x) TEST_ASSERT_TRUE_MESSAGE((x) > (limit), #x)

static field_config_t cfg;
static field_t field, other;
static field_output_t out;
static sim_rng_t dice;

void setUp(void)
{
    field_defaults(&cfg, FIELD_GIRONA500, FIELD_EXCITED, 1);
    sim_rng_seed(&dice, 1, 1);
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_TRUE(field_init(&field, &cfg));
}

/* Random steps of force every 1.5 s in all thrusters. */
static void excite(double seconds, void (*each)(void))
{
    double force[SIM_THRUSTERS] = {0}, max = field.sheet.thruster_max_N;
    int n = field.sheet.thrusters;
    for (long tick = 0; tick < lround(seconds * 50); ++tick) {
        for (int j = 0; j < n && tick % 75 == 0; ++j) {
            force[j] = max * 0.4 * floor(3 * sim_rng_uniform(&dice) - 1);
        }
        field_step(&field, force, &out);
        if (each != NULL) {
            each();
        }
    }
}

static void run(double seconds, void (*each)(void))
{
    for (long tick = 0; tick < lround(seconds * 50); ++tick) {
        field_step(&field, NULL, &out);
        if (each != NULL) {
            each();
        }
    }
}

/* ---- physics ---- */

static double energy(void)
{
    const field_hull_t *h = &field.hull;
    const field_truth_t *t = field_truth(&field);
    double r[3][3], sum = 0, clear = fmax(h->seabed_m - t->position[2], 0.5);
    double wall = h->wall * pow(0.5 / clear, 3);
    sim_rotation(t->euler, r);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            sum += 0.5 * t->nu[i] * (h->mass[i][j] + wall * h->added[i][j]) * t->nu[j];
        }
    }
    for (int i = 0; i < 3; ++i) { /* potential energy falls with depth */
        sum -= r[2][i] * (h->weight_N * h->r_g[i] - h->buoyancy_N * h->r_b[i]);
    }
    return sum - (h->weight_N - h->buoyancy_N) * t->position[2];
}

static void test_energy_is_conserved_without_drag_and_thrust(void)
{
    const double nu[6] = {0.6, -0.4, 0.1, 0.2, -0.2, 0.5};
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        for (int wall = 0; wall < 2; ++wall) {
            field_defaults(&cfg, (field_vehicle_t)v, FIELD_EXCITED, 1);
            TEST_ASSERT_TRUE(field_set(&cfg, "cg_x", 0.04));
            TEST_ASSERT_TRUE(field_set(&cfg, "cg_y", -0.03));
            TEST_ASSERT_TRUE(field_set(&cfg, "wall", wall));
            begin();
            memset(field.hull.linear, 0, sizeof field.hull.linear);
            memset(field.hull.quadratic, 0, sizeof field.hull.quadratic);
            memset(field.pilot.hover_N, 0, sizeof field.pilot.hover_N);
            memset(field.pilot.mix, 0, sizeof field.pilot.mix);
            memcpy(field.truth.nu, nu, sizeof nu);
            double before = energy(), changed = 0, weight = field.hull.weight_N;
            for (int i = 0; i < 10; ++i) {
                run(0.2, NULL);
                TEST_ASSERT_DOUBLE_WITHIN(2e-7 * weight, before, energy());
                changed = fmax(changed, fabs(field.truth.nu[Z] - nu[Z]));
            }
            ABOVE(0.05, changed);
        }
    }
}

static double worst;

static void record_residual(void)
{
    double left[6];
    field_hull_residual(&field, left);
    worst =
        fmax(worst, fmax(fmax(fabs(left[X]), fabs(left[Y])), fmax(fabs(left[Z]), fabs(left[N]))));
}

static void test_without_mismatch_the_vehicles_follow_eq_12_to_15(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        field_defaults(&cfg, (field_vehicle_t)v, FIELD_EXCITED, 3);
        TEST_ASSERT_TRUE(field_set(&cfg, "hull", 0.15));
        begin();
        worst = 0;
        excite(20, record_residual);
        BELOW(sizeof(auvid_real_t) == 4 ? 1e-3 : 1e-9, worst);
    }
}

static void test_the_true_acceleration_is_the_derivative_of_velocity(void)
{
    double before[6], sum = 0;
    field_draw(&cfg, 1);
    begin();
    excite(10, NULL);
    for (int tick = 0; tick < 20; ++tick) { /* under constant thrust */
        double rate[6];
        memcpy(before, field.truth.nu, sizeof before);
        memcpy(rate, field.truth.nu_dot, sizeof rate);
        field_step(&field, NULL, &out);
        for (int i = 0; i < 6 && tick > 0; ++i) {
            double mean = 0.5 * (rate[i] + field.truth.nu_dot[i]);
            sum += fabs(field.truth.nu[i] - before[i] - 0.02 * mean);
        }
    }
    BELOW(2e-3, sum / (19 * 6));
}

static void record_sum(void)
{
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(field.truth.delivered[i] + field.truth.disturbance[i],
                                 field.truth.hull[i]);
    }
}

static void test_the_hull_force_is_thrust_plus_disturbance(void)
{
    field_draw(&cfg, 1);
    begin();
    excite(2, record_sum);
}

static void test_hover_thrust_keeps_a_vehicle_in_place(void)
{
    begin();
    run(60, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 20.0, field.truth.position[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -37.3058 * -1, out.wrench[Z]);
}

static void test_the_girona500_is_the_papers(void)
{
    field_built_t built;
    begin();
    field_built(&field, &built);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, auvid_girona500_paper[i], built.parameter[i]);
    }
}

static void test_thrusters_produce_the_amplitude_of_the_excitation(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        field_defaults(&cfg, (field_vehicle_t)v, FIELD_EXCITED, 1);
        begin();
        const field_sheet_t *sheet = &field.sheet;
        for (int j = 0; j < sheet->thrusters; ++j) {
            double force = fabs(field.pilot.hover_N[j]);
            for (int i = 0; i < 4; ++i) {
                force += fabs(field.pilot.mix[j][i]) * sheet->amplitude[i == 3 ? N : i];
            }
            NOT_ABOVE(sheet->thruster_max_N, force);
        }
    }
}

/* ---- the table ---- */

static void test_every_kind_has_a_unique_name_and_a_description(void)
{
    const field_mismatch_t *table;
    int n = field_mismatches(&table);
    TEST_ASSERT_GREATER_THAN(40, n);
    TEST_ASSERT_LESS_OR_EQUAL(FIELD_MISMATCHES, n);
    for (int k = 0; k < n; ++k) {
        TEST_ASSERT_NOT_NULL(table[k].unit);
        TEST_ASSERT_GREATER_THAN(5, strlen(table[k].about));
        TEST_ASSERT_TRUE(table[k].min_size <= 0 && table[k].max_size > 0);
        for (int l = 0; l < k; ++l) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(table[k].name, table[l].name));
        }
    }
}

#define DRAWS 4000

static void check_draws(field_vehicle_t vehicle, double strength)
{
    static double sum[FIELD_MISMATCHES], square[FIELD_MISMATCHES], none[FIELD_MISMATCHES];
    const field_mismatch_t *table;
    int n = field_mismatches(&table);
    memset(sum, 0, sizeof sum);
    memset(square, 0, sizeof square);
    memset(none, 0, sizeof none);
    field_defaults(&cfg, vehicle, FIELD_EXCITED, 0);
    for (int seed = 0; seed < DRAWS; ++seed) {
        cfg.seed = (uint64_t)seed;
        field_draw(&cfg, strength);
        for (int k = 0; k < n; ++k) {
            sum[k] += cfg.size[k];
            square[k] += cfg.size[k] * cfg.size[k];
            none[k] += cfg.size[k] == 0;
        }
    }
    for (int k = 0; k < n; ++k) {
        double scale = table[k].force && vehicle == FIELD_ROV20 ? 0.3 : 1.0;
        bool hull = strcmp(table[k].name, "hull") == 0;
        double low = table[k].low * scale * (hull ? 1 : strength);
        double high = table[k].high * scale * (hull ? 1 : strength), drawn = DRAWS - none[k];
        if (table[k].draw == FIELD_ALONE) {
            TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(DRAWS, none[k], table[k].name);
            continue;
        }
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.04, table[k].chance, drawn / DRAWS, table[k].name);
        double mean = table[k].draw == FIELD_NORMAL ? 0 : (low + high) / 2;
        double sd = table[k].draw == FIELD_NORMAL ? high : (high - low) / sqrt(12);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(5 * sd / sqrt(drawn) + 1e-12, mean, sum[k] / drawn,
                                          table[k].name);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.08 * (mean * mean + sd * sd), mean * mean + sd * sd,
                                          square[k] / drawn, table[k].name);
    }
}

static void test_draws_have_the_means_deviations_and_chances_of_the_table(void)
{
    check_draws(FIELD_GIRONA500, 1);
    check_draws(FIELD_ROV20, 1);
    check_draws(FIELD_GIRONA500, 2);
}

static void test_a_mixture_of_strength_zero_has_only_the_variation_of_the_hull(void)
{
    const field_mismatch_t *table;
    int n = field_mismatches(&table);
    TEST_ASSERT_TRUE(field_set(&cfg, "slew", 1));
    field_draw(&cfg, 0);
    for (int k = 0; k < n; ++k) {
        double size = strcmp(table[k].name, "hull") == 0 ? 0.15 : 0;
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(size, cfg.size[k], table[k].name);
    }
}

static void test_mixtures_of_any_strength_up_to_4_are_simulated(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        for (uint64_t seed = 1; seed <= 20; ++seed) {
            field_defaults(&cfg, (field_vehicle_t)v, FIELD_EXCITED, seed);
            field_draw(&cfg, (double)(seed % 5));
            begin();
            excite(10, NULL);
            BELOW(3, fabs(field.truth.nu[X]));
            BELOW(1.2, fabs(field.truth.euler[1]));
        }
    }
}

static void test_hulls_differ_by_up_to_their_variation(void)
{
    double min = 9, max = -9;
    for (uint64_t seed = 1; seed <= 300; ++seed) {
        field_built_t built;
        cfg.seed = seed;
        TEST_ASSERT_TRUE(field_set(&cfg, "hull", 0.15));
        begin();
        field_built(&field, &built);
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            double off = built.parameter[i] / auvid_girona500_paper[i] - 1;
            min = fmin(min, off);
            max = fmax(max, off);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, -37.3058, built.parameter[SIM_WB]);
        TEST_ASSERT_EQUAL_DOUBLE(160, built.dry_kg);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -0.15, min);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.15, max);
}

static void test_set_refuses_invalid_sizes_and_changes_nothing(void)
{
    field_config_t before = cfg;
    TEST_ASSERT_FALSE(field_set(&cfg, "thrust", 0.1));
    TEST_ASSERT_FALSE(field_set(&cfg, "", 0.1));
    TEST_ASSERT_FALSE(field_set(&cfg, "thrust_lag", -0.1));
    TEST_ASSERT_FALSE(field_set(&cfg, "thrust_lag", NAN));
    TEST_ASSERT_FALSE(field_set(&cfg, "dvl_lost", 1));
    TEST_ASSERT_FALSE(field_set(&cfg, "imu_yaw", INFINITY));
    TEST_ASSERT_EQUAL_MEMORY(&before, &cfg, sizeof cfg);
    TEST_ASSERT_TRUE(field_set(&cfg, "thrust_lag", 0.1));
}

static void test_init_refuses_values_out_of_range_and_does_nothing(void)
{
    const field_config_t good = cfg;
    begin();
    other = field;
    for (int i = 0; i < 5; ++i) {
        cfg = good;
        cfg.vehicle = i == 0 ? FIELD_VEHICLES : cfg.vehicle;
        cfg.driver = i == 1 ? FIELD_DRIVERS : cfg.driver;
        cfg.length_s = i == 2 ? 0 : i == 3 ? NAN : cfg.length_s;
        cfg.size[0] = i == 4 ? NAN : 0;
        TEST_ASSERT_FALSE(field_init(&field, &cfg));
        TEST_ASSERT_EQUAL_MEMORY(&other, &field, sizeof field);
    }
}

/* ---- repeatability ---- */

static void test_the_same_seed_gives_the_same_numbers(void)
{
    field_output_t again;
    for (int d = 0; d < FIELD_DRIVERS; ++d) {
        field_defaults(&cfg, FIELD_ROV20, (field_driver_t)d, 5);
        field_draw(&cfg, 1);
        begin();
        TEST_ASSERT_TRUE(field_init(&other, &cfg));
        for (int tick = 0; tick < 1000; ++tick) {
            field_step(&field, NULL, &out);
            field_step(&other, NULL, &again);
            TEST_ASSERT_EQUAL_MEMORY(&out, &again, sizeof out);
        }
        TEST_ASSERT_EQUAL_MEMORY(field_truth(&field), field_truth(&other), sizeof(field_truth_t));
    }
}

static void test_another_seed_gives_other_numbers(void)
{
    field_output_t again;
    begin();
    cfg.seed = 2;
    TEST_ASSERT_TRUE(field_init(&other, &cfg));
    field_step(&field, NULL, &out);
    field_step(&other, NULL, &again);
    TEST_ASSERT_TRUE(out.sensor[SIM_IMU].value[0] != again.sensor[SIM_IMU].value[0]);
}

static void test_a_copy_continues_identically(void)
{
    field_output_t again;
    field_draw(&cfg, 1);
    begin();
    excite(5, NULL);
    other = field;
    memset(&field, 0x55, sizeof field);
    field = other;
    for (int tick = 0; tick < 200; ++tick) {
        field_step(&field, NULL, &out);
        field_step(&other, NULL, &again);
        TEST_ASSERT_EQUAL_MEMORY(&out, &again, sizeof out);
    }
}

/* ---- drivers ---- */

static void test_excited_with_thrust_too_weak_to_hover_the_vehicle_sinks_a_few_metres(void)
{
    TEST_ASSERT_TRUE(field_set(&cfg, "thrust_common", -0.2));
    begin();
    run(200, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 20 - 3 - 1.9, field.truth.position[2]);
}

static double min[6], max[6], off, askew;

static void record_range(void)
{
    const field_truth_t *t = field_truth(&field);
    for (int i = 0; i < 3; ++i) {
        min[i] = fmin(min[i], t->position[i]);
        max[i] = fmax(max[i], t->position[i]);
    }
    off = fmax(off, hypot(t->position[0] - field.pilot.reference[0],
                          t->position[1] - field.pilot.reference[1]));
    askew = fmax(askew, fabs(remainder(t->euler[2] - field.pilot.reference_heading, 6.283185307)));
}

static void drive(field_vehicle_t vehicle, field_driver_t driver, double strength, double seconds)
{
    field_defaults(&cfg, vehicle, driver, 4);
    if (strength > 0) {
        field_draw(&cfg, strength);
    }
    begin();
    off = askew = 0;
    for (int i = 0; i < 6; ++i) {
        min[i] = 1e9;
        max[i] = -1e9;
    }
    run(seconds, record_range);
}

/* The pilot's care is enough for the two vehicles; some that are drawn dive deeper. */
static void test_no_driver_of_the_two_vehicles_hits_a_near_bottom(void)
{
    for (int v = 0; v < FIELD_ANY; ++v) {
        for (int driver = 0; driver < FIELD_DRIVERS; ++driver) {
            field_defaults(&cfg, (field_vehicle_t)v, (field_driver_t)driver, 4);
            TEST_ASSERT_TRUE(field_set(&cfg, "wall", 0.5));
            begin();
            min[2] = 1e9;
            max[2] = -1e9;
            excite(300, record_range); /* thrust is only read with the excitation */
            BELOW(field.hull.seabed_m, max[2]);
            ABOVE(20 - 1.5, min[2]);
        }
    }
}

static void test_the_lawnmower_follows_its_legs(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        drive((field_vehicle_t)v, FIELD_LAWNMOWER, 0, 300);
        BELOW(2, off);
        BELOW(1, askew);
        TEST_ASSERT_DOUBLE_WITHIN(2, 18, max[0] - min[0]);
        ABOVE(9, max[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 20, min[2]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 20, max[2]);
    }
}

static void test_station_keeping_holds_its_position(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        drive((field_vehicle_t)v, FIELD_STATION, 0, 120);
        BELOW(1, off);
        drive((field_vehicle_t)v, FIELD_STATION, 1, 120);
        BELOW(3, off);
    }
}

static void test_the_pilot_keeps_the_depth_and_moves_in_all_directions(void)
{
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        drive((field_vehicle_t)v, FIELD_JOYSTICK, 1, 300);
        TEST_ASSERT_DOUBLE_WITHIN(4, 20, min[2]);
        TEST_ASSERT_DOUBLE_WITHIN(4, 20, max[2]);
        ABOVE(5, hypot(max[0] - min[0], max[1] - min[1]));
    }
}

static void record_wrench(void)
{
    const field_sheet_t *sheet = &field.sheet;
    TEST_ASSERT_TRUE(out.reported);
    for (int i = 0; i < 6; ++i) {
        double sum = 0;
        for (int j = 0; j < sheet->thrusters; ++j) {
            NOT_ABOVE(sheet->thruster_max_N, fabs(out.thruster_N[j]));
            sum += sheet->matrix[i][j] * out.thruster_N[j];
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sum, out.wrench[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sum, field.truth.reported[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sum, field.truth.delivered[i]);
    }
    TEST_ASSERT_EQUAL_UINT64(out.t_us - SIM_TICK_US, out.reported_us);
}

static void test_without_mismatch_all_thrust_is_reported_correctly(void)
{
    for (int d = 0; d < FIELD_DRIVERS; ++d) {
        field_defaults(&cfg, FIELD_ROV20, (field_driver_t)d, 4);
        begin();
        excite(20, record_wrench);
    }
}

static void test_thrust_saturates_at_the_limit_of_the_thruster(void)
{
    double asked[SIM_THRUSTERS] = {1e9, -1e9, NAN, 0, 500};
    begin();
    field_step(&field, asked, &out);
    TEST_ASSERT_EQUAL_DOUBLE(153.8, out.thruster_N[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-153.8, out.thruster_N[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -37.3058 / 2, out.thruster_N[2]);
    TEST_ASSERT_EQUAL_DOUBLE(153.8, field.truth.delivered[Y]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_energy_is_conserved_without_drag_and_thrust);
    RUN_TEST(test_without_mismatch_the_vehicles_follow_eq_12_to_15);
    RUN_TEST(test_the_true_acceleration_is_the_derivative_of_velocity);
    RUN_TEST(test_the_hull_force_is_thrust_plus_disturbance);
    RUN_TEST(test_hover_thrust_keeps_a_vehicle_in_place);
    RUN_TEST(test_the_girona500_is_the_papers);
    RUN_TEST(test_thrusters_produce_the_amplitude_of_the_excitation);
    RUN_TEST(test_every_kind_has_a_unique_name_and_a_description);
    RUN_TEST(test_draws_have_the_means_deviations_and_chances_of_the_table);
    RUN_TEST(test_a_mixture_of_strength_zero_has_only_the_variation_of_the_hull);
    RUN_TEST(test_mixtures_of_any_strength_up_to_4_are_simulated);
    RUN_TEST(test_hulls_differ_by_up_to_their_variation);
    RUN_TEST(test_set_refuses_invalid_sizes_and_changes_nothing);
    RUN_TEST(test_init_refuses_values_out_of_range_and_does_nothing);
    RUN_TEST(test_the_same_seed_gives_the_same_numbers);
    RUN_TEST(test_another_seed_gives_other_numbers);
    RUN_TEST(test_a_copy_continues_identically);
    RUN_TEST(test_excited_with_thrust_too_weak_to_hover_the_vehicle_sinks_a_few_metres);
    RUN_TEST(test_no_driver_of_the_two_vehicles_hits_a_near_bottom);
    RUN_TEST(test_the_lawnmower_follows_its_legs);
    RUN_TEST(test_station_keeping_holds_its_position);
    RUN_TEST(test_the_pilot_keeps_the_depth_and_moves_in_all_directions);
    RUN_TEST(test_without_mismatch_all_thrust_is_reported_correctly);
    RUN_TEST(test_thrust_saturates_at_the_limit_of_the_thruster);
    return UNITY_END();
}
