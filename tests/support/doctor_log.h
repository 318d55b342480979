/* A simulated vehicle without noise, for tests of the log doctor: its log, and slips in it. */
#ifndef SUPPORT_DOCTOR_LOG_H
#define SUPPORT_DOCTOR_LOG_H

#include "doctor/doctor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulator.h"
#include "unity.h"

#define PI 3.14159265358979323846
#define STEP_S 0.02

enum { ROWS = 6000 };

static csv_row_t rows[ROWS];
static bool has[CSV_COLUMNS];
static doctor_t doctor;

/* Mass, linear and quadratic drag, largest input; righting moment of roll and pitch. */
static const double mass[6] = {250, 370, 660, 80, 80, 75}, linear[6] = {42, 76, 44, 60, 60, 21},
                    quadratic[6] = {125, 450, 325, 40, 40, 61},
                    largest[6] = {100, 100, 100, 20, 20, 40}, righting[6] = {0, 0, 0, 150, 150, 0};

static inline void advance(double euler[3], double position[3], double nu[6], const double input[6],
                           double dot[6])
{
    double r[3][3];
    const double couple[6] = {370 * nu[1] * nu[5], -250 * nu[0] * nu[5], 0, 0, 0,
                              -120 * nu[0] * nu[1]};
    for (int j = 0; j < 6; ++j) {
        double restore = j == 3 || j == 4 ? righting[j] * sin(euler[j - 3]) : 0.0;
        dot[j] = (input[j] - linear[j] * nu[j] - quadratic[j] * fabs(nu[j]) * nu[j] + couple[j] -
                  restore) /
                 mass[j];
    }
    sim_rotation(euler, r);
    for (int i = 0; i < 3; ++i) {
        position[i] += STEP_S * (r[i][0] * nu[0] + r[i][1] * nu[1] + r[i][2] * nu[2]);
    }
    double across = nu[4] * sin(euler[0]) + nu[5] * cos(euler[0]);
    euler[1] += STEP_S * (nu[4] * cos(euler[0]) - nu[5] * sin(euler[0]));
    euler[0] += STEP_S * (nu[3] + across * tan(euler[1]));
    euler[2] += STEP_S * across / cos(euler[1]);
    for (int j = 0; j < 6; ++j) {
        nu[j] += STEP_S * dot[j];
    }
}

/* Two minutes of random steps in all degrees of freedom; held: a controller holds roll and pitch
 * level instead, against a disturbance. */
static inline void make_log_of(bool held)
{
    double euler[3] = {0}, position[3] = {0, 0, 20}, nu[6] = {0}, input[6] = {0}, kept[6];
    double force[6], disturbance[2] = {0};
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 1);
    memset(rows, 0, sizeof rows);
    memset(has, 0, sizeof has);
    for (int c = CSV_T; c < CSV_COMMAND; ++c) {
        has[c] = true;
    }
    for (int i = 0; i < 3; ++i) {
        has[CSV_POSITION + i] = has[CSV_SPECIFIC_FORCE + i] = true;
    }
    for (int k = 0; k < ROWS; ++k) {
        for (int j = 0; j < 6; ++j) {
            if (k % (60 + 17 * j) == 0) {
                input[j] = largest[j] * (2.0 * sim_rng_uniform(&rng) - 1.0);
            }
        }
        memcpy(force, input, sizeof force);
        for (int i = 0; i < 2 && held; ++i) {
            double seen = euler[i] + 0.003 * sim_rng_gauss(&rng);
            input[3 + i] = -300.0 * seen - 150.0 * nu[3 + i];
            disturbance[i] += 0.02 * (10.0 * sim_rng_gauss(&rng) - disturbance[i]);
            force[3 + i] = input[3 + i] + disturbance[i];
        }
        double *v = rows[k].value;
        v[CSV_T] = 100.0 + STEP_S * k;
        memcpy(&v[CSV_ATTITUDE], euler, sizeof euler);
        v[CSV_ATTITUDE + 2] = remainder(euler[2], 2.0 * PI);
        memcpy(&v[CSV_NU], nu, sizeof nu);
        memcpy(&v[CSV_WRENCH], input, sizeof input);
        memcpy(&v[CSV_POSITION], position, sizeof position);
        double dot[6], down[3] = {-sin(euler[1]), cos(euler[1]) * sin(euler[0]),
                                  cos(euler[1]) * cos(euler[0])};
        memcpy(kept, nu, sizeof kept);
        advance(euler, position, nu, force, dot);
        for (int i = 0; i < 3; ++i) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            v[CSV_SPECIFIC_FORCE + i] =
                dot[i] + kept[3 + a] * kept[b] - kept[3 + b] * kept[a] - 9.81 * down[i];
        }
    }
}

static inline void make_log(void)
{
    make_log_of(false);
}

static inline void examine(void)
{
    doctor_init(&doctor, has);
    for (int k = 0; k < ROWS; ++k) {
        doctor_feed(&doctor, &rows[k]);
    }
    doctor_finish(&doctor);
}

static inline void scale(int column, double factor)
{
    for (int k = 0; k < ROWS; ++k) {
        rows[k].value[column] *= factor;
    }
}

static inline void exchange(int a, int b)
{
    for (int k = 0; k < ROWS; ++k) {
        double kept = rows[k].value[a];
        rows[k].value[a] = rows[k].value[b];
        rows[k].value[b] = kept;
    }
}

/* Values of `cells` rows earlier, in some columns. */
static inline void delay(int first, int last, int by)
{
    for (int k = ROWS - 1; k > 0; --k) {
        for (int c = first; c <= last; ++c) {
            rows[k].value[c] = rows[k > by ? k - by : 0].value[c];
        }
    }
}

static inline const doctor_finding_t *finding(doctor_code_t code)
{
    for (int i = 0; i < doctor.findings; ++i) {
        if (doctor.finding[i].code == code) {
            return &doctor.finding[i];
        }
    }
    return NULL;
}

static inline int count(doctor_severity_t severity)
{
    int n = 0;
    for (int i = 0; i < doctor.findings; ++i) {
        n += doctor.finding[i].severity == severity;
    }
    return n;
}

/* The log has this error in this column, and its sentence contains this. */
static inline void assert_error(doctor_code_t code, int column, const char *words)
{
    const doctor_finding_t *f = finding(code);
    TEST_ASSERT_NOT_NULL_MESSAGE(f, words);
    TEST_ASSERT_EQUAL_MESSAGE(DOCTOR_ERROR, f->severity, f->text);
    TEST_ASSERT_EQUAL_MESSAGE(column, f->column, f->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f->text, words), f->text);
    TEST_ASSERT_FALSE(doctor.usable);
    TEST_ASSERT_EQUAL_STRING_LEN("not usable", doctor.verdict, 10);
}

/* Only this error. */
static inline void assert_only(doctor_code_t code, int column, const char *words)
{
    examine();
    assert_error(code, column, words);
    TEST_ASSERT_EQUAL_MESSAGE(1, count(DOCTOR_ERROR), doctor.finding[1].text);
}

static inline void assert_clean(void)
{
    examine();
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_ERROR), doctor.finding[0].text);
    TEST_ASSERT_EQUAL_MESSAGE(0, count(DOCTOR_WARNING), doctor.finding[0].text);
    TEST_ASSERT_TRUE(doctor.usable);
    TEST_ASSERT_EQUAL_STRING_LEN("usable", doctor.verdict, 6);
}

#endif
