/*
 * Validation through its header, against a vehicle integrated here in double in steps of a
 * millisecond, with a separate implementation of Eq. 12-15.
 */
#include <math.h>
#include <string.h>

#include "auvid/validation.h"
#include "unity.h"

enum { N = AUVID_G500_COUNT, CELLS = 1200, STEPS = 100, WARM_UP = 8 };
#define CELL_S 0.1
#define DOFS (1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE | 1u << AUVID_YAW)

static auvid_validation_t validation;
static auvid_real_t pi[AUVID_MAX_PARAMETERS];
static auvid_sample_t cell[CELLS];

/* ---- the vehicle ---- */

typedef struct {
    double pi[N];
    double late_cells; /* of the wrench */
    double lag_s;
} world_t;

static double tau_of(int j, int k)
{
    static const double scale[6] = {60, 60, 50, 0, 0, 20};
    static const int period[6] = {47, 61, 53, 1, 1, 39};
    int step = k < 12 ? 0 : k / period[j];
    double level = (step * 7 % 5 - 2) / 2.0;
    return (double)(auvid_real_t)(scale[j] * level - (j == AUVID_HEAVE ? 37 : 0));
}

/* Recorded attitude and p, q: linear between the middles of cells. */
static double straight(double t, double (*signal)(double))
{
    double k = floor(t / CELL_S - 0.5 + 1e-9), part = t / CELL_S - 0.5 - k;
    double a = (double)(auvid_real_t)signal(k), b = (double)(auvid_real_t)signal(k + 1);
    return a + part * (b - a);
}

static double phi_at(double k)
{
    return 0.05 * sin(0.21 * k);
}

static double theta_at(double k)
{
    return 0.06 * cos(0.13 * k);
}

static double p_at(double k)
{
    return 0.10 * sin(0.33 * k + 1);
}

static double q_at(double k)
{
    return 0.12 * cos(0.29 * k);
}

static void accelerations(const double *x, double t, const double *nu, const double *tau, double *d)
{
    double u = nu[0], v = nu[1], w = nu[2], r = nu[5];
    double phi = straight(t, phi_at), theta = straight(t, theta_at);
    double p = straight(t, p_at), q = straight(t, q_at), mu = x[0], mv = x[1], mw = x[2];
    d[0] =
        (tau[0] + mv * v * r - mw * w * q - x[4] * sin(theta) + x[5] * u + x[6] * fabs(u) * u) / mu;
    d[1] = (tau[1] + mw * w * p - mu * u * r + x[4] * cos(theta) * sin(phi) + x[7] * v +
            x[8] * fabs(v) * v) /
           mv;
    d[2] = (tau[2] + mu * u * q - mv * v * p + x[4] * cos(theta) * cos(phi) + x[9] * w +
            x[10] * fabs(w) * w) /
           mw;
    d[5] = (tau[5] + (mu - mv) * u * v + x[11] * r + x[12] * fabs(r) * r) / x[3];
    d[3] = d[4] = 0;
}

/* Heun's method in steps of a millisecond: the error is 1e-7 of a second's motion. */
static void step(const world_t *w, double t, double h, double *nu, const double *tau)
{
    double a[6], b[6], mid[6];
    accelerations(w->pi, t, nu, tau, a);
    for (int j = 0; j < 6; ++j) {
        mid[j] = nu[j] + h * a[j];
    }
    accelerations(w->pi, t + h, mid, tau, b);
    for (int j = 0; j < 6; ++j) {
        nu[j] += 0.5 * h * (a[j] + b[j]);
    }
}

/* Write cell[] from cell `from` on, with the velocities nu[6] at its beginning. The velocity of a
 * cell is that in its middle. */
static void simulate(const world_t *w, int from, int to, double *nu)
{
    double thrust[6], h = CELL_S / STEPS;
    for (int j = 0; j < 6; ++j) {
        thrust[j] = tau_of(j, from);
    }
    for (int k = from; k < to; ++k) {
        memset(&cell[k], 0, sizeof cell[k]);
        cell[k].t_us = 100000ull * (uint64_t)k;
        cell[k].phi = (auvid_real_t)phi_at(k);
        cell[k].theta = (auvid_real_t)theta_at(k);
        for (int j = 0; j < 6; ++j) {
            cell[k].tau[j] = (auvid_real_t)tau_of(j, k);
        }
        for (int i = 0; i < STEPS; ++i) {
            double t = (k + (double)i / STEPS) * CELL_S;
            if (i == STEPS / 2) {
                for (int j = 0; j < 6; ++j) {
                    cell[k].nu[j] = (auvid_real_t)nu[j];
                }
                cell[k].nu[AUVID_ROLL] = (auvid_real_t)p_at(k);
                cell[k].nu[AUVID_PITCH] = (auvid_real_t)q_at(k);
            }
            for (int j = 0; j < 6; ++j) {
                double target = tau_of(j, (int)floor(t / CELL_S - w->late_cells + 1e-9));
                double part = w->lag_s > 0 ? 1 - exp(-h / w->lag_s) : 1;
                thrust[j] += part * (target - thrust[j]);
            }
            step(w, t, h, nu, thrust);
        }
    }
}

static world_t truth;

void setUp(void)
{
    double nu[6] = {0};
    memset(&truth, 0, sizeof truth);
    memset(pi, 0, sizeof pi);
    memcpy(pi, auvid_girona500_paper, sizeof auvid_girona500_paper);
    for (int i = 0; i < N; ++i) {
        truth.pi[i] = (double)pi[i];
    }
    simulate(&truth, 0, CELLS, nu);
}

void tearDown(void)
{
}

static void start(uint32_t dofs, const auvid_real_t *delay_s, uint32_t first_order_lag)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&validation, &auvid_girona500, pi, dofs, delay_s,
                                            first_order_lag, (auvid_real_t)CELL_S));
}

static void play(int from, int to)
{
    for (int k = from; k < to; ++k) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_add(&validation, &cell[k]));
    }
}

/* 1 - R2 of the worst integrated DoF. */
static double worst(void)
{
    auvid_real_t r2[6];
    double max_off = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    for (int j = 0; j < 6; ++j) {
        if (DOFS >> j & 1u) {
            max_off = fmax(max_off, 1 - (double)r2[j]);
        } else {
            TEST_ASSERT_EQUAL_DOUBLE(0, (double)r2[j]);
        }
    }
    return max_off;
}

/* ---- prediction ---- */

/* Rounding of eps in each of 50 half cells within a time constant is 1e-5 of a velocity at most. */
static void test_true_parameters_follow_the_vehicle_for_two_minutes(void)
{
    start(0, NULL, 0);
    for (int k = 0; k < CELLS; ++k) {
        play(k, k + 1);
        for (int j = 0; j < 6 && k >= WARM_UP; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, (double)cell[k].nu[j], (double)validation.predicted[j]);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(CELLS - WARM_UP + 1, validation.cells);
    TEST_ASSERT_TRUE(worst() < 1e-7);
}

/* With wrong parameters the prediction is the motion of that other vehicle; R2 is its formula. */
static void test_wrong_parameters_predict_the_other_vehicle_and_r2_is_its_formula(void)
{
    static auvid_sample_t measured[CELLS];
    double mean[6] = {0}, sse[6] = {0}, total[6] = {0}, nu[6];
    auvid_real_t r2[6];
    memcpy(measured, cell, sizeof cell);
    pi[AUVID_G500_M_U] *= AUVID_C(1.2);
    pi[AUVID_G500_Y_VV] *= AUVID_C(0.7);
    pi[AUVID_G500_N_R] *= AUVID_C(1.5);
    pi[AUVID_G500_W_B] += 5;
    start(0, NULL, 0);
    for (int i = 0; i < N; ++i) {
        truth.pi[i] = (double)pi[i];
    }
    /* integrated from the middle of cell 7, from the velocity measured there */
    for (int j = 0; j < 6; ++j) {
        nu[j] = (double)measured[WARM_UP - 1].nu[j];
    }
    static double other[CELLS][6];
    double tau[6];
    for (int k = WARM_UP - 1; k < CELLS; ++k) {
        memcpy(other[k], nu, sizeof nu);
        for (int i = 0; i < STEPS; ++i) {
            for (int j = 0; j < 6; ++j) {
                tau[j] = tau_of(j, i < STEPS / 2 ? k : k + 1);
            }
            step(&truth, (k + 0.5 + (double)i / STEPS) * CELL_S, CELL_S / STEPS, nu, tau);
        }
    }
    int count = CELLS - WARM_UP + 1;
    for (int k = 0; k < CELLS; ++k) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_add(&validation, &measured[k]));
        for (int j = 0; j < 6 && k >= WARM_UP - 1; ++j) {
            if (DOFS >> j & 1u) {
                TEST_ASSERT_DOUBLE_WITHIN(3e-5, other[k][j], (double)validation.predicted[j]);
            }
            mean[j] += (double)measured[k].nu[j] / count;
        }
    }
    for (int k = WARM_UP - 1; k < CELLS; ++k) {
        for (int j = 0; j < 6; ++j) {
            sse[j] += pow((double)measured[k].nu[j] - other[k][j], 2);
            total[j] += pow((double)measured[k].nu[j] - mean[j], 2);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    for (int j = 0; j < 6; ++j) {
        double expected = DOFS >> j & 1u ? 1 - sse[j] / total[j] : 0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (1 - expected) + 1e-5, expected, (double)r2[j]);
    }
    TEST_ASSERT_TRUE((double)r2[AUVID_HEAVE] < 0.99);
}

static void test_dof_that_is_not_integrated_comes_from_the_record(void)
{
    auvid_real_t r2[6];
    pi[AUVID_G500_Y_V] = 100; /* wrong, and without effect */
    pi[AUVID_G500_N_RR] = 100;
    start(1u << AUVID_SURGE, NULL, 0);
    for (int k = 0; k < CELLS; ++k) {
        play(k, k + 1);
        for (int j = 1; j < 6 && k >= WARM_UP - 1; ++j) {
            TEST_ASSERT_EQUAL_DOUBLE((double)cell[k].nu[j], (double)validation.predicted[j]);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    /* v r is linear between cells here, and a curve in the vehicle */
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1, (double)r2[AUVID_SURGE]);
    for (int j = 1; j < 6; ++j) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)r2[j]);
    }
}

static void test_delay_shifts_the_wrench(void)
{
    const auvid_real_t delay[6] = {AUVID_C(0.2), AUVID_C(0.2), AUVID_C(0.2),
                                   AUVID_C(0.2), AUVID_C(0.2), AUVID_C(0.2)};
    double nu[6] = {0};
    truth.late_cells = 2;
    simulate(&truth, 0, CELLS, nu);
    start(0, delay, 0);
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() < 1e-7);
    start(0, NULL, 0);
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() > 1e-4);
}

static void test_longest_delay_is_six_cells(void)
{
    auvid_real_t delay[6];
    double nu[6] = {0};
    for (int j = 0; j < 6; ++j) {
        delay[j] = AUVID_C(0.6);
    }
    truth.late_cells = 6;
    simulate(&truth, 0, CELLS, nu);
    start(0, delay, 0);
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() < 1e-7);
}

/* The mean wrench is linear between cells: a step half a cell late becomes two half steps. */
static void test_delay_of_a_part_of_a_cell_lies_between_its_neighbours(void)
{
    double nu[6] = {0}, off[3];
    truth.late_cells = 1.5;
    simulate(&truth, 0, CELLS, nu);
    for (int i = 0; i < 3; ++i) {
        auvid_real_t delay[6];
        for (int j = 0; j < 6; ++j) {
            delay[j] = (auvid_real_t)(0.1 + 0.05 * i);
        }
        start(0, delay, 0);
        play(0, CELLS);
        off[i] = worst();
    }
    TEST_ASSERT_TRUE(off[1] < 0.05 * off[0] && off[1] < 0.05 * off[2]);
}

static void test_lag_passes_the_wrench_through_a_first_order_element(void)
{
    double nu[6] = {0};
    auvid_real_t delay[6];
    for (int j = 0; j < 6; ++j) {
        delay[j] = AUVID_C(0.3);
    }
    truth.lag_s = 0.3;
    simulate(&truth, 0, CELLS, nu);
    start(0, delay, DOFS);
    play(0, CELLS);
    double as_lag = worst();
    TEST_ASSERT_TRUE(as_lag < 1e-5);
    start(0, delay, 0);
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() > 20 * as_lag);
    start(0, delay, DOFS & ~(1u << AUVID_YAW));
    play(0, CELLS);
    auvid_real_t r2[6];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    TEST_ASSERT_TRUE(1 - (double)r2[AUVID_YAW] > 20 * as_lag);
}

static void test_after_a_gap_the_prediction_starts_again_from_the_measured_velocity(void)
{
    double nu[6] = {AUVID_C(0.8), AUVID_C(-0.4), AUVID_C(0.3), 0, 0, AUVID_C(0.5)};
    simulate(&truth, 600, CELLS, nu); /* another place, another state */
    start(0, NULL, 0);
    play(0, 600);
    auvid_validation_gap(&validation);
    play(600, CELLS);
    TEST_ASSERT_EQUAL_UINT32(CELLS - 2 * (WARM_UP - 1), validation.cells);
    TEST_ASSERT_TRUE(worst() < 1e-7);

    start(0, NULL, 0); /* without the call, the jump makes the prediction fail */
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() > 1e-2);
    auvid_validation_gap(NULL);
}

/* Wrong values replace what was not measured: where it would start, and while it runs. */
static void test_velocities_that_were_not_measured_are_neither_started_from_nor_compared(void)
{
    for (int k = 0; k < CELLS; ++k) {
        if (k < 40 || k % 10 == 0) {
            cell[k].nu[AUVID_SWAY] = 3;
            cell[k].missing = 1u << AUVID_SWAY;
        }
    }
    start(0, NULL, 0);
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() < 1e-7);
    TEST_ASSERT_EQUAL_UINT32(CELLS - 41, validation.cells); /* cell 40 is a tenth one, too */
    for (int k = 0; k < CELLS; ++k) {
        cell[k].missing = 0;
    }
    start(0, NULL, 0); /* without the mark, they are used */
    play(0, CELLS);
    TEST_ASSERT_TRUE(worst() > 1e-2);
}

/* Sway comes from the record; surge reads it. */
static void test_simulation_starts_again_after_a_velocity_from_the_record_is_missing(void)
{
    for (int k = 300; k < 320; ++k) {
        cell[k].nu[AUVID_SWAY] = 3;
        cell[k].missing = 1u << AUVID_SWAY;
    }
    start(1u << AUVID_SURGE, NULL, 0);
    play(0, CELLS);
    auvid_real_t r2[6];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    TEST_ASSERT_TRUE(1 - (double)r2[AUVID_SURGE] < 1e-5);
    TEST_ASSERT_EQUAL_UINT32(CELLS - WARM_UP + 1 - 20, validation.cells);
}

static void test_parameters_that_make_the_simulation_diverge_give_no_nan(void)
{
    static const double bad[3] = {1e3, 1e8, 1e30};
    for (int b = 0; b < 3; ++b) {
        auvid_real_t r2[6];
        setUp();
        pi[AUVID_G500_X_U] = (auvid_real_t)bad[b];
        pi[AUVID_G500_X_UU] = (auvid_real_t)bad[b];
        pi[AUVID_G500_N_RR] = (auvid_real_t)bad[b];
        pi[AUVID_G500_M_W] = AUVID_C(1e-6);
        start(0, NULL, 0);
        play(0, CELLS);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_TRUE(isfinite((double)r2[j]));
            TEST_ASSERT_TRUE(fabs((double)validation.predicted[j]) <= 100);
        }
        TEST_ASSERT_TRUE(r2[AUVID_SURGE] < 0);
    }
}

/* A model that reads commands gets those of the same half cell as the wrench. */
static bool by_command(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                       auvid_real_t *nu_dot)
{
    (void)context;
    nu_dot[AUVID_SURGE] = p[0] * s->command[0];
    return true;
}

static void nothing(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                    auvid_real_t *residual)
{
    (void)context;
    (void)s;
    (void)p;
    residual[0] = 0;
}

static void test_commands_act_in_their_own_half_of_the_step(void)
{
    static const auvid_parameter_t parameter[1] = {
        {"gain", "1", AUVID_SURGE, AUVID_PARAMETER_OTHER}};
    const auvid_vehicle_t model = {.built_for = AUVID_BUILD,
                                   .path = &auvid_path_residual,
                                   .name = "integrator",
                                   .parameters = 1,
                                   .parameter = parameter,
                                   .columns = {1},
                                   .residual = nothing,
                                   .acceleration = by_command};
    const auvid_real_t gain[1] = {2};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&validation, &model, gain, 0, NULL, 0, AUVID_C(0.5)));
    double expected = 0, last = 0;
    for (int k = 0; k < 40; ++k) {
        auvid_sample_t s;
        memset(&s, 0, sizeof s);
        double command = k * k % 7;
        s.command[0] = (auvid_real_t)command;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_add(&validation, &s));
        expected = k < WARM_UP ? 0 : expected + 2 * 0.25 * (last + command);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, expected, (double)validation.predicted[0]);
        last = command;
    }
}

/* ---- refusals ---- */

static void refuse(auvid_status_t expected, const auvid_vehicle_t *vehicle, uint32_t dofs,
                   double delay_s, double cell_s)
{
    static auvid_validation_t before;
    auvid_real_t delay[6] = {0};
    delay[5] = (auvid_real_t)delay_s;
    memset(&validation, 0x5A, sizeof validation);
    before = validation;
    TEST_ASSERT_EQUAL(expected, auvid_validation_init(&validation, vehicle, pi, dofs, delay, 0,
                                                      (auvid_real_t)cell_s));
    TEST_ASSERT_EQUAL_MEMORY(&before, &validation, sizeof validation);
}

static void test_init_refuses_what_it_cannot_use_and_changes_nothing(void)
{
    auvid_vehicle_t model = auvid_girona500;
    const auvid_vehicle_t *good = &auvid_girona500;
    refuse(AUVID_ERR_NULL, NULL, 0, 0, 0.1);
    refuse(AUVID_ERR_RANGE, good, 0, 0, 0);
    refuse(AUVID_ERR_RANGE, good, 0, 0, -0.1);
    refuse(AUVID_ERR_RANGE, good, 0, 0, NAN);
    refuse(AUVID_ERR_RANGE, good, 0, 0.61, 0.1);
    refuse(AUVID_ERR_RANGE, good, 0, -0.3, 0.1);
    refuse(AUVID_ERR_RANGE, good, 0, NAN, 0.1);
    refuse(AUVID_ERR_RANGE, good, 1u << AUVID_ROLL, 0, 0.1);
    model.acceleration = NULL;
    refuse(AUVID_ERR_MODEL, &model, 0, 0, 0.1);
    model = auvid_girona500;
    model.built_for = NULL;
    refuse(AUVID_ERR_SIZE, &model, 0, 0, 0.1);
    model = auvid_girona500;
    model.parameters = 0;
    refuse(AUVID_ERR_PARAMETERS, &model, 0, 0, 0.1);
    pi[3] = 0;
    refuse(AUVID_ERR_MODEL, good, 0, 0, 0.1);
    pi[3] = (auvid_real_t)NAN;
    refuse(AUVID_ERR_NOT_FINITE, good, 0, 0, 0.1);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_validation_init(NULL, good, pi, 0, NULL, 0, AUVID_C(0.1)));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_validation_init(&validation, good, NULL, 0, NULL, 0, AUVID_C(0.1)));
}

static void test_cell_that_is_not_finite_is_ignored(void)
{
    static auvid_validation_t before;
    start(0, NULL, 0);
    play(0, 20);
    before = validation;
    auvid_sample_t s = cell[20];
    auvid_real_t *field[] = {&s.phi, &s.theta, &s.psi, &s.nu[2], &s.tau[5], &s.command[0]};
    for (size_t i = 0; i < sizeof field / sizeof field[0]; ++i) {
        auvid_real_t keep = *field[i];
        *field[i] = (auvid_real_t)(i % 2 ? NAN : -INFINITY);
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_validation_add(&validation, &s));
        TEST_ASSERT_EQUAL_MEMORY(&before, &validation, sizeof validation);
        *field[i] = keep;
    }
    memset(&validation, 0, sizeof validation);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_validation_add(&validation, &s)); /* no init */
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_validation_add(NULL, &s));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_validation_add(&validation, NULL));
}

static void test_r2_needs_two_cells(void)
{
    auvid_real_t r2[6];
    start(0, NULL, 0);
    play(0, WARM_UP);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_validation_r2(&validation, r2));
    play(WARM_UP, WARM_UP + 1);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&validation, r2));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_validation_r2(NULL, r2));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_validation_r2(&validation, NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_true_parameters_follow_the_vehicle_for_two_minutes);
    RUN_TEST(test_wrong_parameters_predict_the_other_vehicle_and_r2_is_its_formula);
    RUN_TEST(test_dof_that_is_not_integrated_comes_from_the_record);
    RUN_TEST(test_delay_shifts_the_wrench);
    RUN_TEST(test_longest_delay_is_six_cells);
    RUN_TEST(test_delay_of_a_part_of_a_cell_lies_between_its_neighbours);
    RUN_TEST(test_lag_passes_the_wrench_through_a_first_order_element);
    RUN_TEST(test_after_a_gap_the_prediction_starts_again_from_the_measured_velocity);
    RUN_TEST(test_velocities_that_were_not_measured_are_neither_started_from_nor_compared);
    RUN_TEST(test_simulation_starts_again_after_a_velocity_from_the_record_is_missing);
    RUN_TEST(test_parameters_that_make_the_simulation_diverge_give_no_nan);
    RUN_TEST(test_commands_act_in_their_own_half_of_the_step);
    RUN_TEST(test_init_refuses_what_it_cannot_use_and_changes_nothing);
    RUN_TEST(test_cell_that_is_not_finite_is_ignored);
    RUN_TEST(test_r2_needs_two_cells);
    return UNITY_END();
}
