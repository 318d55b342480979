/* The vehicle file: forces from commands, values and places of a text, and random texts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/ini.h"
#include "unity.h"
#include "vehicle/vehicles.h"
#include "vehicle/vehicles_ready.h"

static char message[INI_MESSAGE];

void setUp(void)
{
    message[0] = '\0';
}

void tearDown(void)
{
}

/* ---- maps ---- */

static double force(thrust_map_t map, double command, double voltage_V)
{
    return thrust_map_force(&map, 50, 40, command, voltage_V);
}

static void test_each_map_gives_the_largest_forces_at_full_command(void)
{
    const thrust_map_kind_t kind[] = {THRUST_MAP_LINEAR, THRUST_MAP_SIGNED_SQUARE, THRUST_MAP_RPM};
    for (int k = 0; k < 3; ++k) {
        thrust_map_t map = {.kind = (int)kind[k], .zero_command = 1500, .full_command = 1900};
        TEST_ASSERT_EQUAL_DOUBLE(50, force(map, 1900, 0));
        TEST_ASSERT_EQUAL_DOUBLE(-40, force(map, 1100, 0));
        TEST_ASSERT_EQUAL_DOUBLE(0, force(map, 1500, 0));
        TEST_ASSERT_EQUAL_DOUBLE(kind[k] == THRUST_MAP_LINEAR ? 25 : 12.5, force(map, 1700, 0));
        TEST_ASSERT_EQUAL_DOUBLE(kind[k] == THRUST_MAP_LINEAR ? -20 : -10, force(map, 1300, 0));
    }
}

static void test_newtons_are_newtons(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(-3.5, force((thrust_map_t){.kind = THRUST_MAP_NEWTON}, -3.5, 0));
}

static void test_a_reversed_command_reverses_the_force(void)
{
    thrust_map_t map = {.kind = THRUST_MAP_LINEAR, .full_command = -1};
    TEST_ASSERT_EQUAL_DOUBLE(50, force(map, -1, 0));
    TEST_ASSERT_EQUAL_DOUBLE(-40, force(map, 1, 0));
}

static void test_a_dead_zone_gives_no_force_and_the_full_force_beyond(void)
{
    thrust_map_t map = {.kind = THRUST_MAP_LINEAR, .full_command = 1, .dead_zone = 0.2};
    TEST_ASSERT_EQUAL_DOUBLE(0, force(map, 0.2, 0));
    TEST_ASSERT_EQUAL_DOUBLE(0, force(map, -0.15, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 25, force(map, 0.6, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -40, force(map, -1, 0));
}

static void test_a_table_is_interpolated_and_constant_beyond_its_ends(void)
{
    thrust_map_t map = {.kind = THRUST_MAP_TABLE,
                        .command = {1100, 1500, 1700, 1900},
                        .force_N = {-40, 0, 10, 51},
                        .commands = 4,
                        .forces = 4};
    TEST_ASSERT_EQUAL_DOUBLE(-40, force(map, 1000, 0));
    TEST_ASSERT_EQUAL_DOUBLE(-20, force(map, 1300, 0));
    TEST_ASSERT_EQUAL_DOUBLE(0, force(map, 1500, 0));
    TEST_ASSERT_EQUAL_DOUBLE(5, force(map, 1600, 0));
    TEST_ASSERT_EQUAL_DOUBLE(30.5, force(map, 1800, 0));
    TEST_ASSERT_EQUAL_DOUBLE(51, force(map, 2000, 0));
}

static void test_the_force_follows_the_voltage_if_it_is_known(void)
{
    thrust_map_t map = {
        .kind = THRUST_MAP_LINEAR, .full_command = 1, .voltage_V = 16, .voltage_exponent = 2};
    TEST_ASSERT_EQUAL_DOUBLE(50, force(map, 1, 16));
    TEST_ASSERT_EQUAL_DOUBLE(12.5, force(map, 1, 8));
    TEST_ASSERT_EQUAL_DOUBLE(50, force(map, 1, 0));
    TEST_ASSERT_EQUAL_DOUBLE(50, force(map, 1, NAN));
}

static void test_a_thruster_has_the_map_of_its_group(void)
{
    const vehicle_t *v = vehicle_default();
    TEST_ASSERT_NOT_NULL(v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.25 * 153.8, vehicle_file_thrust(v, 4, -0.5, 0));
}

/* ---- texts ---- */

static char text[INI_BYTES + 1];

static vehicle_t *parse(const char *body, size_t length)
{
    return vehicle_file_parse("x.ini", body, length, message, sizeof message);
}

static void load(const embedded_t *file)
{
    text[0] = '\0';
    for (const char *const *piece = file->piece; *piece != NULL; ++piece) {
        strcat(text, *piece);
    }
}

static void test_values_and_places_of_a_text(void)
{
    static ini_t ini;
    const char *body =
        "\xEF\xBB\xBF# first\r\n[ a.1 ]  ; second\r\n\r\n  key-1 = 1 -2.5e1\t3 # third\n";
    double x[3];
    TEST_ASSERT_TRUE(ini_parse(&ini, "x.ini", body, strlen(body)));
    TEST_ASSERT_EQUAL(2, ini.entries);
    const ini_entry_t *e = ini_find(&ini, "a.1", "key-1");
    TEST_ASSERT_NOT_NULL(e);
    TEST_ASSERT_EQUAL(4, e->line);
    TEST_ASSERT_EQUAL(3, e->key_column);
    TEST_ASSERT_EQUAL(11, e->value_column);
    TEST_ASSERT_EQUAL_STRING("1 -2.5e1\t3", e->value);
    TEST_ASSERT_TRUE(ini_numbers(&ini, e, 3, 3, x, NULL));
    TEST_ASSERT_TRUE(x[0] == 1 && x[1] == -25 && x[2] == 3);
    TEST_ASSERT_FALSE(ini_numbers(&ini, e, 1, 2, x, NULL));
    TEST_ASSERT_EQUAL_STRING("x.ini:4:20: key-1: more than 2 numbers", ini.message);
}

static void test_a_number_of_many_digits_is_refused_not_cut(void)
{
    static ini_t ini;
    double x;
    char body[200];
    (void)snprintf(body, sizeof body, "[a]\nb = %0100d\n", 1);
    TEST_ASSERT_TRUE(ini_parse(&ini, "x.ini", body, strlen(body)));
    TEST_ASSERT_FALSE(ini_numbers(&ini, ini_find(&ini, "a", "b"), 1, 1, &x, NULL));
}

static void test_the_first_message_stays(void)
{
    static ini_t ini;
    (void)ini_parse(&ini, "x.ini", "", 0);
    TEST_ASSERT_FALSE(ini_refuse(&ini, 1, 2, "first"));
    TEST_ASSERT_FALSE(ini_refuse(&ini, 3, 4, "second"));
    TEST_ASSERT_EQUAL_STRING("x.ini:1:2: first", ini.message);
}

/* A ready file with one random change is a vehicle, or a message with a place. */
static void test_damaged_files_are_read_or_refused_with_a_place(void)
{
    static const char bytes[] = "[]=#;\n\t .,-+0123456789eEuvw|_xX\r\001\377";
    sim_rng_t rng;
    int refused = 0;
    sim_rng_seed(&rng, 1, 0);
    for (int n = 0; n < 400; ++n) {
        load(&vehicles_ready[n % 2 == 0 ? 0 : 4]);
        size_t length = strlen(text), at = (size_t)(sim_rng_uniform(&rng) * (double)length);
        size_t span = (size_t)(sim_rng_uniform(&rng) * 30.0);
        span = span < length - at ? span : length - at;
        if (n % 3 == 0) { /* cut a piece out */
            memmove(text + at, text + at + span, length - at - span);
            length -= span;
        } else if (n % 3 == 1) { /* repeat a piece */
            memmove(text + at + span, text + at, length - at);
            length += span;
        } else {
            text[at] = bytes[(size_t)(sim_rng_uniform(&rng) * (sizeof bytes - 1))];
        }
        vehicle_t *v = parse(text, length);
        TEST_ASSERT_TRUE((v == NULL) == (message[0] != '\0'));
        if (v == NULL) {
            int line = 0, column = 0;
            TEST_ASSERT_EQUAL(2, sscanf(message, "x.ini:%d:%d: ", &line, &column));
            TEST_ASSERT_TRUE(line >= 1 && column >= 1 && column <= INI_LINE + 1);
            ++refused;
        }
        free(v);
    }
    TEST_ASSERT_TRUE(refused > 100 && refused < 400);
}

/* ---- the simulator of a model of the library ---- */

static void test_a_model_of_the_library_moves_as_the_simulators_own(void)
{
    sim_config_t own, of_library;
    sim_rng_t rng;
    sim_defaults(&own);
    of_library = own;
    of_library.model = SIM_VEHICLE;
    of_library.vehicle = &auvid_girona500;
    memcpy(of_library.vehicle_parameter, own.parameter, sizeof own.parameter);
    sim_rng_seed(&rng, 1, 0);
    for (int n = 0; n < 100; ++n) {
        double state[12], wrench[6], a[12], b[12];
        for (int i = 0; i < 12; ++i) {
            state[i] = sim_rng_uniform(&rng) - 0.5;
        }
        for (int i = 0; i < 6; ++i) {
            wrench[i] = 200 * (sim_rng_uniform(&rng) - 0.5);
        }
        sim_derivative(&own, state, wrench, a);
        sim_derivative(&of_library, state, wrench, b);
        for (int i = 0; i < 12; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, a[i], b[i]);
        }
    }
}

static void test_instruments_mounted_askew_measure_along_their_own_axes(void)
{
    static sim_t aligned, askew;
    sim_config_t cfg;
    sim_output_t a = {0}, b = {0};
    sim_defaults(&cfg);
    cfg.imu_angle_rad = cfg.imu_rate_rad_s = cfg.dvl_m_s = 0;
    cfg.nu[0] = 0.4;
    cfg.nu[5] = 0.2;
    TEST_ASSERT_TRUE(sim_init(&aligned, &cfg));
    cfg.imu_euler[2] = cfg.dvl_euler[2] = 1.5707963267948966; /* their x is the body's y */
    TEST_ASSERT_TRUE(sim_init(&askew, &cfg));
    for (int k = 0; k < 10; ++k) {
        sim_step(&aligned, NULL, NULL, &a);
        sim_step(&askew, NULL, NULL, &b);
    }
    const double *imu = a.sensor[SIM_IMU].value, *own_imu = b.sensor[SIM_IMU].value;
    const double *dvl = a.sensor[SIM_DVL].value, *own_dvl = b.sensor[SIM_DVL].value;
    TEST_ASSERT_TRUE(a.sensor[SIM_DVL].has && dvl[0] > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, dvl[1], own_dvl[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -dvl[0], own_dvl[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, imu[2] + 1.5707963267948966, own_imu[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, imu[4], own_imu[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -imu[3], own_imu[4]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, imu[5], own_imu[5]);
}

static void test_a_thruster_has_limits_of_its_own(void)
{
    static sim_t sim;
    sim_config_t cfg;
    sim_output_t out;
    const double far[SIM_THRUSTERS] = {1e3, -1e3, 1e3, -1e3};
    sim_defaults(&cfg);
    cfg.thruster_limit_N[0][0] = 20;
    cfg.thruster_limit_N[1][1] = 10;
    TEST_ASSERT_TRUE(sim_init(&sim, &cfg));
    sim_step(&sim, far, NULL, &out);
    TEST_ASSERT_EQUAL_DOUBLE(20, out.thruster_N[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-10, out.thruster_N[1]);
    TEST_ASSERT_EQUAL_DOUBLE(153.8, out.thruster_N[2]);
    TEST_ASSERT_EQUAL_DOUBLE(-153.8, out.thruster_N[3]);
    cfg.thruster_limit_N[0][0] = -1;
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
    cfg.thruster_limit_N[0][0] = NAN;
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_map_gives_the_largest_forces_at_full_command);
    RUN_TEST(test_newtons_are_newtons);
    RUN_TEST(test_a_reversed_command_reverses_the_force);
    RUN_TEST(test_a_dead_zone_gives_no_force_and_the_full_force_beyond);
    RUN_TEST(test_a_table_is_interpolated_and_constant_beyond_its_ends);
    RUN_TEST(test_the_force_follows_the_voltage_if_it_is_known);
    RUN_TEST(test_a_thruster_has_the_map_of_its_group);
    RUN_TEST(test_values_and_places_of_a_text);
    RUN_TEST(test_a_number_of_many_digits_is_refused_not_cut);
    RUN_TEST(test_the_first_message_stays);
    RUN_TEST(test_damaged_files_are_read_or_refused_with_a_place);
    RUN_TEST(test_a_model_of_the_library_moves_as_the_simulators_own);
    RUN_TEST(test_instruments_mounted_askew_measure_along_their_own_axes);
    RUN_TEST(test_a_thruster_has_limits_of_its_own);
    return UNITY_END();
}
