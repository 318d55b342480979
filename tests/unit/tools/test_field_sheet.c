/* The vehicles that are drawn at random, and their data sheets. */
#include "field.h"

#include <math.h>
#include <string.h>

#include "unity.h"

enum { SEEDS = 1000, DOFS = 4 };
static const int axis[DOFS] = {0, 1, 2, 5};

static field_sheet_t sheet, other;
static field_config_t cfg;
static field_t field;

/* What was drawn, and the smallest and largest of it. */
typedef struct {
    double low, high;
} seen_t;

void setUp(void)
{
}

void tearDown(void)
{
}

static void take(seen_t *seen, double x)
{
    seen->low = fmin(seen->low, x);
    seen->high = fmax(seen->high, x);
}

/* Everything lies in its range, and comes within 2 % of its width to each end. */
static void assert_range(const seen_t *seen, double low, double high, const char *name)
{
    double near = 0.02 * (high - low), rounded = 1e-9 * fabs(high);
    TEST_ASSERT_TRUE_MESSAGE(seen->low >= low - rounded && seen->low <= low + near, name);
    TEST_ASSERT_TRUE_MESSAGE(seen->high <= high + rounded && seen->high >= high - near, name);
}

/* The speed at which the drag of equation e is equal to the force of the excitation. */
static double top_speed(int e)
{
    double l = -sheet.parameter[SIM_X_U + 2 * e], q = -sheet.parameter[SIM_X_UU + 2 * e];
    double force = sheet.amplitude[axis[e]];
    return (sqrt(l * l + 4 * q * force) - l) / (2 * q);
}

static void test_the_same_seed_gives_the_same_vehicle(void)
{
    for (uint64_t seed = 0; seed < 10; ++seed) {
        memset(&sheet, 0x55, sizeof sheet);
        memset(&other, 0xaa, sizeof other);
        field_sheet(FIELD_ANY, seed, &sheet);
        field_sheet(FIELD_ANY, seed, &other);
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(sheet.parameter, other.parameter, SIM_PARAMETERS);
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(sheet.amplitude, other.amplitude, 6);
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(&sheet.matrix[0][0], &other.matrix[0][0], 6 * SIM_THRUSTERS);
        TEST_ASSERT_EQUAL_DOUBLE(sheet.thruster_max_N, other.thruster_max_N);
        TEST_ASSERT_EQUAL(sheet.thrusters, other.thrusters);
        const double one[] = {sheet.dry_kg,      sheet.tilt_inertia,   sheet.rigid_share,
                              sheet.tilt_linear, sheet.tilt_quadratic, sheet.cb_above_m,
                              sheet.length_m,    sheet.noise_arm_m,    sheet.max_acceleration,
                              sheet.speed_m_s,   sheet.bandwidth,      sheet.largest_parameter};
        const double two[] = {other.dry_kg,      other.tilt_inertia,   other.rigid_share,
                              other.tilt_linear, other.tilt_quadratic, other.cb_above_m,
                              other.length_m,    other.noise_arm_m,    other.max_acceleration,
                              other.speed_m_s,   other.bandwidth,      other.largest_parameter};
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(one, two, sizeof one / sizeof one[0]);
    }
}

static void test_each_seed_gives_another_vehicle(void)
{
    static double mass[SEEDS];
    for (int seed = 0; seed < SEEDS; ++seed) {
        field_sheet(FIELD_ANY, (uint64_t)seed, &sheet);
        mass[seed] = sheet.parameter[SIM_M_U];
        for (int k = 0; k < seed; ++k) {
            TEST_ASSERT_TRUE(mass[seed] != mass[k]);
        }
    }
}

static void test_the_two_vehicles_do_not_depend_on_the_seed(void)
{
    for (int v = 0; v < FIELD_ANY; ++v) {
        field_sheet((field_vehicle_t)v, 1, &sheet);
        field_sheet((field_vehicle_t)v, 2, &other);
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(sheet.parameter, other.parameter, SIM_PARAMETERS);
        TEST_ASSERT_EQUAL_DOUBLE(v == FIELD_ROV20 ? 20 : 160, sheet.dry_kg);
        TEST_ASSERT_EQUAL(v == FIELD_ROV20, sheet.fast);
    }
}

static void test_masses_forces_and_speeds_fill_their_ranges(void)
{
    seen_t kg = {1e9, 0}, length = kg, mass[3] = {kg, kg, kg}, weight = {1, -1}, push = kg;
    seen_t side[2] = {kg, kg}, slower[2] = {kg, kg}, linear[DOFS] = {kg, kg, kg, kg};
    seen_t surge = kg, yaw = kg, inertia = kg, arm = kg;
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        field_sheet(FIELD_ANY, seed, &sheet);
        const double *p = sheet.parameter;
        take(&kg, log(sheet.dry_kg));
        take(&length, sheet.length_m / cbrt(sheet.dry_kg));
        for (int i = 0; i < 3; ++i) {
            take(&mass[i], p[SIM_M_U + i] / sheet.dry_kg);
        }
        take(&weight, p[SIM_WB] / (9.81 * sheet.dry_kg));
        take(&push, log(sheet.amplitude[0] / p[SIM_M_U]));
        take(&surge, log(top_speed(0)));
        take(&yaw, log(top_speed(3)));
        take(&inertia, p[SIM_M_R] / (sheet.dry_kg * sheet.length_m * sheet.length_m / 12));
        take(&arm, sheet.amplitude[5] / (sheet.amplitude[0] * sheet.length_m));
        for (int i = 0; i < 2; ++i) {
            take(&side[i], sheet.amplitude[1 + i] / sheet.amplitude[0]);
            take(&slower[i], top_speed(1 + i) / top_speed(0));
        }
        for (int e = 0; e < DOFS; ++e) {
            take(&linear[e], -p[SIM_X_U + 2 * e] * top_speed(e) / sheet.amplitude[axis[e]]);
        }
    }
    assert_range(&kg, log(8), log(450), "mass in air");
    assert_range(&length, 0.22 * 0.8, 0.22 * 1.4, "length");
    assert_range(&mass[0], 1.25, 1.6, "m_u");
    assert_range(&mass[1], 1.3, 2.4, "m_v");
    assert_range(&mass[2], 1.3, 4.2, "m_w");
    assert_range(&weight, -0.025, 0.003, "W-B");
    assert_range(&push, log(0.25), log(1.5), "acceleration");
    assert_range(&surge, log(0.4), log(1.5), "speed in surge");
    assert_range(&yaw, log(0.4), log(2), "rate of yaw");
    assert_range(&inertia, 0.8, 2.6, "m_r");
    assert_range(&arm, 0.12, 0.4, "moment");
    for (int i = 0; i < 2; ++i) {
        assert_range(&side[i], 0.5, 1, "force in sway and heave");
        assert_range(&slower[i], 0.4, 0.8, "speed in sway and heave");
    }
    for (int e = 0; e < DOFS; ++e) {
        assert_range(&linear[e], 0.05, 0.6, "share of linear drag");
    }
}

static void test_time_constants_are_those_of_vehicles(void)
{
    static const double low[DOFS] = {0.33, 0.26, 0.32, 0.06}, high[DOFS] = {4.8, 6.5, 10.4, 4.4};
    int fast = 0, vectored = 0, usual[DOFS] = {0};
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        field_sheet(FIELD_ANY, seed, &sheet);
        for (int e = 0; e < DOFS; ++e) {
            double s = sheet.parameter[SIM_M_U + e] * top_speed(e) / sheet.amplitude[axis[e]];
            usual[e] += s > low[e] && s < high[e];
        }
        double slope = sheet.parameter[SIM_X_U] + 2 * sheet.parameter[SIM_X_UU] * top_speed(0);
        TEST_ASSERT_EQUAL(sheet.parameter[SIM_M_U] / -slope < 1, sheet.fast);
        fast += sheet.fast;
        vectored += sheet.thrusters == 6;
    }
    for (int e = 0; e < DOFS; ++e) {
        TEST_ASSERT_INT_WITHIN(22, 980, usual[e]); /* five standard deviations, of all */
    }
    TEST_ASSERT_INT_WITHIN(75, 650, fast);
    TEST_ASSERT_INT_WITHIN(80, 500, vectored);
}

static void test_a_hull_with_its_largest_variation_is_physical(void)
{
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        field_defaults(&cfg, FIELD_ANY, FIELD_EXCITED, seed);
        TEST_ASSERT_TRUE(field_set(&cfg, "hull", 0.2));
        TEST_ASSERT_TRUE(field_init(&field, &cfg));
        for (int i = 0; i < 6; ++i) {
            TEST_ASSERT_TRUE(field.hull.added[i][i] > 0);
        }
    }
}

static void test_thrusters_have_the_lever_arms_of_one_of_the_two_relative_to_the_length(void)
{
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        field_sheet(FIELD_ANY, seed, &sheet);
        field_sheet(sheet.thrusters == 6 ? FIELD_ROV20 : FIELD_GIRONA500, 0, &other);
        for (int j = 0; j < sheet.thrusters; ++j) {
            for (int i = 0; i < 6; ++i) {
                double scale = i < 3 ? 1 : sheet.length_m / other.length_m;
                TEST_ASSERT_DOUBLE_WITHIN(1e-12, scale * other.matrix[i][j], sheet.matrix[i][j]);
            }
        }
    }
}

static void test_thrusters_give_all_forces_at_once_and_hover_with_a_reserve(void)
{
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        double largest = 0;
        field_defaults(&cfg, FIELD_ANY, FIELD_EXCITED, seed);
        TEST_ASSERT_TRUE(field_init(&field, &cfg));
        for (int j = 0; j < field.sheet.thrusters; ++j) {
            double force = fabs(field.pilot.hover_N[j]);
            for (int e = 0; e < DOFS; ++e) {
                force += fabs(field.pilot.mix[j][e]) * field.sheet.amplitude[axis[e]];
            }
            largest = fmax(largest, force);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * largest, field.sheet.thruster_max_N, 1.5 * largest);
    }
}

static void test_its_mixture_is_that_of_the_girona500_with_forces_in_proportion(void)
{
    static field_config_t mine;
    const field_mismatch_t *kind;
    int count = field_mismatches(&kind);
    for (uint64_t seed = 0; seed < 50; ++seed) {
        field_defaults(&cfg, FIELD_GIRONA500, FIELD_EXCITED, seed);
        field_defaults(&mine, FIELD_ANY, FIELD_EXCITED, seed);
        field_draw(&cfg, 1);
        field_draw(&mine, 1);
        field_sheet(FIELD_ANY, seed, &sheet);
        for (int k = 0; k < count; ++k) {
            double scale = kind[k].force ? sheet.amplitude[0] / 100 : 1;
            double wanted = scale * cfg.size[k];
            wanted = fmax(kind[k].min_size, fmin(kind[k].max_size, wanted));
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-12 * fabs(wanted), wanted, mine.size[k],
                                              kind[k].name);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_same_seed_gives_the_same_vehicle);
    RUN_TEST(test_each_seed_gives_another_vehicle);
    RUN_TEST(test_the_two_vehicles_do_not_depend_on_the_seed);
    RUN_TEST(test_masses_forces_and_speeds_fill_their_ranges);
    RUN_TEST(test_time_constants_are_those_of_vehicles);
    RUN_TEST(test_a_hull_with_its_largest_variation_is_physical);
    RUN_TEST(test_thrusters_have_the_lever_arms_of_one_of_the_two_relative_to_the_length);
    RUN_TEST(test_thrusters_give_all_forces_at_once_and_hover_with_a_reserve);
    RUN_TEST(test_its_mixture_is_that_of_the_girona500_with_forces_in_proportion);
    return UNITY_END();
}
