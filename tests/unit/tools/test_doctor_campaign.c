/*
 * How often the log doctor is right, on logs of random vehicles with noise and mismatches (dive.h):
 * fourteen slips at three severities, clean logs, two slips at once. Short: few vehicles, rows at 5
 * to 10 Hz. AUVID_TEST_LONG: the whole campaign, with tables; AUVID_TEST_SEED its first seed.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dive.h"
#include "doctor/doctor.h"
#include "unity.h"

static dive_t clean, wrong, twice;
static doctor_t doctor;
static bool complete; /* the whole campaign */
static uint64_t first_seed;

void setUp(void)
{
}

void tearDown(void)
{
}

static void examine(const dive_t *dive)
{
    doctor_init(&doctor, dive->has);
    doctor_dry_mass(&doctor, clean.field.hull.dry_kg, false);
    for (int k = 0; k < dive->rows; ++k) {
        doctor_feed(&doctor, &dive->row[k]);
    }
    doctor_finish(&doctor);
}

static void simulate(uint64_t seed, field_driver_t driver, double strength)
{
    dive_config_t cfg = {.coarse = !complete || seed % 4 >= 2, .depth = seed % 5 != 0};
    field_vehicle_t vehicle = seed % 2 == 0 ? FIELD_ROV20 : FIELD_GIRONA500;
    field_defaults(&cfg.field, vehicle, driver, seed);
    field_draw(&cfg.field, strength);
    cfg.field.length_s = driver == FIELD_EXCITED || !complete ? 240.0 : 600.0;
    TEST_ASSERT_TRUE(dive_simulate(&clean, &cfg));
}

static bool found(doctor_code_t code, int column)
{
    return doctor_has_finding(&doctor, code, column);
}

static bool found_anywhere(doctor_code_t code)
{
    for (int i = 0; i < doctor.findings; ++i) {
        if (doctor.finding[i].code == code) {
            return true;
        }
    }
    return false;
}

/* Of a reversed velocity or rate: its own sentence, or one that names it beside its input. */
static bool reversed(int column)
{
    return found(DOCTOR_VELOCITY_SIGN, column) || found(DOCTOR_RATE_SIGN, column) ||
           found(DOCTOR_EITHER_SIGN, column - CSV_NU + CSV_WRENCH);
}

/* Is an axis of the accelerometer named, which runs against this angle? */
static bool tilts_against(int angle)
{
    for (int i = 0; i < doctor.findings; ++i) {
        if (doctor.finding[i].code == DOCTOR_FORCE_SIGN && doctor.finding[i].other == angle) {
            return true;
        }
    }
    return false;
}

/* The sentence of a slip of the accelerometer. Where it hardly tilts, only fz shows the axes. */
static bool accelerometer(int which)
{
    bool upside = found(DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + 2);
    switch (which) {
    case 0:
        return found_anywhere(DOCTOR_FORCE_UNIT);
    case 1:
        return found_anywhere(DOCTOR_NO_GRAVITY);
    case 2:
        return found(DOCTOR_FRAME, CSV_SPECIFIC_FORCE + 1) || upside;
    case 3:
        return upside;
    default:
        return found_anywhere(DOCTOR_FORCE_EXCHANGED);
    }
}

/* Is the slip among the findings? */
static bool is_named(const slip_t *s)
{
    switch (s->kind) {
    case SLIP_ANGLE_DEGREES:
        return found(DOCTOR_ANGLE_DEGREES, CSV_ATTITUDE + 2);
    case SLIP_RATE_DEGREES:
        return found(DOCTOR_RATE_DEGREES, s->column);
    case SLIP_ANGLE_SIGN:
        return found(DOCTOR_ANGLE_SIGN, s->column) || tilts_against(s->column);
    case SLIP_VELOCITY_SIGN:
        return reversed(s->column);
    case SLIP_EXCHANGED:
        return found(DOCTOR_RATE_EXCHANGED, s->column) ||
               found(DOCTOR_VELOCITY_EXCHANGED, s->column) ||
               (s->column == CSV_NU && found(DOCTOR_EITHER_EXCHANGED, CSV_WRENCH));
    case SLIP_FRAME:
        return found_anywhere(DOCTOR_FRAME);
    case SLIP_SHIFT:
        return found_anywhere(s->column == CSV_ATTITUDE ? DOCTOR_ATTITUDE_SHIFT
                                                        : DOCTOR_INPUT_SHIFT);
    case SLIP_INPUT_SIGN:
        return found(DOCTOR_INPUT_SIGN, s->column) || found(DOCTOR_EITHER_SIGN, s->column);
    case SLIP_INPUT_EXCHANGED:
        return found(DOCTOR_INPUT_EXCHANGED, s->column) ||
               found(DOCTOR_EITHER_EXCHANGED, s->column);
    case SLIP_LOGGING:
        return found(DOCTOR_HELD, s->column) || found(DOCTOR_STUCK, s->column) ||
               found(DOCTOR_SCALE, s->column);
    case SLIP_ACCELEROMETER:
        return accelerometer(s->which);
    case SLIP_UNIT:
        return found(DOCTOR_SCALE, s->column);
    case SLIP_WORLD:
        return found(DOCTOR_WORLD_FRAME, s->column);
    case SLIP_QUATERNION:
        return found(DOCTOR_QUATERNION, s->column);
    case SLIPS:
    default:
        return false;
    }
}

/* Errors and warnings of a clean log, except what is true of it: rows too slow for a quick axis. */
static int accusations(void)
{
    int n = 0;
    for (int i = 0; i < doctor.findings; ++i) {
        const doctor_finding_t *f = &doctor.finding[i];
        bool slow = f->code == DOCTOR_SLOW && f->severity == DOCTOR_WARNING;
        n += f->severity != DOCTOR_NOTE && !slow;
    }
    return n;
}

/* Warnings of rows too slow for a DoF, and how many are true: that the rows are further apart than
 * 0.4 of its time constant, of the simulated hull at its rms speed. The doctor's limit is 0.6 of
 * its own estimate of it. */
static int slow_warnings, slow_true;

static void judge_slow_warnings(void)
{
    const field_hull_t *hull = &clean.field.hull;
    for (int i = 0; i < doctor.findings; ++i) {
        const doctor_finding_t *f = &doctor.finding[i];
        if (f->code != DOCTOR_SLOW || f->severity != DOCTOR_WARNING) {
            continue;
        }
        int j = f->other - CSV_NU;
        double square = 0.0;
        for (int k = 0; k < clean.rows; ++k) {
            square += clean.row[k].value[f->other] * clean.row[k].value[f->other] / clean.rows;
        }
        double drag = hull->linear[j] + 2.0 * hull->quadratic[j] * sqrt(square);
        double constant_s = hull->mass[j][j] / drag;
        ++slow_warnings;
        slow_true += doctor_interval_quantile(&doctor, 0.5) > 0.4 * constant_s;
    }
}

static const field_driver_t drivers[3] = {FIELD_EXCITED, FIELD_JOYSTICK, FIELD_LAWNMOWER};

/* Each slip at each severity: its sentence in 90 % of the logs. */
static void test_slips_are_named(void)
{
    int right[SLIPS][3] = {{0}}, logs[SLIPS][3] = {{0}}, named = 0, all = 0;
    uint64_t vehicles = complete ? 20 : 1;
    for (uint64_t k = 0; k < 2 * vehicles; ++k) {
        uint64_t seed = first_seed + k % vehicles;
        simulate(seed, complete ? drivers[seed % 3] : FIELD_EXCITED, k < vehicles ? 0.0 : 0.5);
        for (int kind = 0; kind < SLIPS; ++kind) {
            for (int severity = 0; severity < 3; ++severity) {
                slip_t slip;
                if (!complete && severity != (int)(k + (uint64_t)kind) % 3) {
                    continue;
                }
                dive_draw_slip(&slip, (slip_kind_t)kind, severity, seed);
                dive_slip(&clean, &slip, &wrong);
                examine(&wrong);
                ++logs[kind][severity];
                ++all;
                right[kind][severity] += is_named(&slip);
                named += is_named(&slip);
            }
        }
    }
    for (int kind = 0; kind < SLIPS && complete; ++kind) {
        printf("# %-18s", slip_name[kind]);
        for (int severity = 0; severity < 3; ++severity) {
            printf("  %3d of %d", right[kind][severity], logs[kind][severity]);
        }
        putchar('\n');
    }
    printf("# right sentence: %d of %d\n", named, all);
    TEST_ASSERT_TRUE(10 * named >= 9 * all);
}

/* Clean logs: at most 2 % with an error or a warning. */
static void test_clean_logs_are_not_accused(void)
{
    int accused = 0, logs = 0;
    for (int strength = 0; strength < 3; ++strength) {
        for (int d = 0; d < 3; ++d) {
            int wrongly = 0, of = complete ? 45 : d == strength;
            for (int k = 0; k < of; ++k) {
                simulate(first_seed + 20 + (uint64_t)k, drivers[d], 0.5 * strength);
                examine(&clean);
                wrongly += accusations() > 0;
                judge_slow_warnings();
            }
            if (complete) {
                printf("# f %.1f, driver %d: %d of %d accused\n", 0.5 * strength, d, wrongly, of);
            }
            accused += wrongly;
            logs += of;
        }
    }
    printf("# wrong accusations: %d of %d logs\n", accused, logs);
    printf("# warnings of slow rows: %d, true %d\n", slow_warnings, slow_true);
    TEST_ASSERT_TRUE(50 * accused <= logs);
    TEST_ASSERT_TRUE(10 * slow_true >= 9 * slow_warnings);
}

/* Of two slips at once one is named at least. */
static void test_of_two_slips_one_is_named(void)
{
    int logs = complete ? 200 : 2, named = 0;
    for (int k = 0; k < logs; ++k) {
        uint64_t seed = first_seed + 100 + (uint64_t)k / 10;
        slip_t a, b;
        sim_rng_t rng;
        sim_rng_seed(&rng, seed, 77 + (uint64_t)k);
        slip_kind_t one = (slip_kind_t)(SLIPS * sim_rng_uniform(&rng));
        slip_kind_t other =
            (slip_kind_t)(((int)one + 1 + (int)((SLIPS - 1) * sim_rng_uniform(&rng))) % SLIPS);
        if (k % 10 == 0) {
            simulate(seed, complete ? drivers[seed % 3] : FIELD_EXCITED, 0.5);
        }
        dive_draw_slip(&a, one, k % 3, seed + 1000 * (uint64_t)k);
        dive_draw_slip(&b, other, k / 3 % 3, seed + 1000 * (uint64_t)k);
        dive_slip(&clean, &a, &wrong);
        dive_slip(&wrong, &b, &twice);
        examine(&twice);
        named += is_named(&a) || is_named(&b);
    }
    printf("# of two slips at least one named: %d of %d\n", named, logs);
    TEST_ASSERT_TRUE(10 * named >= 9 * logs);
}

int main(void)
{
    const char *seed = getenv("AUVID_TEST_SEED");
    complete = getenv("AUVID_TEST_LONG") != NULL;
    first_seed = seed != NULL ? strtoull(seed, NULL, 10) : 300001;
    UNITY_BEGIN();
    RUN_TEST(test_slips_are_named);
    RUN_TEST(test_clean_logs_are_not_accused);
    RUN_TEST(test_of_two_slips_one_is_named);
    return UNITY_END();
}
