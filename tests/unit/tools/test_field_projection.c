/* The truth of a field run, for known motions with known answers. */
#include "field_projection.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static const field_built_t built = {
    .parameter = {250, 370, 660, 75, -37, -42, -125, -76, -448, -44, -325, -21, -61}};
static field_projection_t run;
static field_reference_t truth;

void setUp(void)
{
    memset(&run, 0, sizeof run);
}

void tearDown(void)
{
}

/* Eq. 12-15 with m_w w p, written explicitly. */
static void model_force(const double *m, const field_truth_t *t, double force[6])
{
    double u = t->nu[0], v = t->nu[1], w = t->nu[2], p = t->nu[3], q = t->nu[4], r = t->nu[5];
    double sp = sin(t->euler[0]), cp = cos(t->euler[0]), st = sin(t->euler[1]),
           ct = cos(t->euler[1]);
    memset(force, 0, 6 * sizeof force[0]);
    force[0] = m[SIM_M_U] * t->nu_dot[0] - m[SIM_M_V] * v * r + m[SIM_M_W] * w * q +
               m[SIM_WB] * st - m[SIM_X_U] * u - m[SIM_X_UU] * fabs(u) * u;
    force[1] = m[SIM_M_V] * t->nu_dot[1] - m[SIM_M_W] * w * p + m[SIM_M_U] * u * r -
               m[SIM_WB] * ct * sp - m[SIM_Y_V] * v - m[SIM_Y_VV] * fabs(v) * v;
    force[2] = m[SIM_M_W] * t->nu_dot[2] - m[SIM_M_U] * u * q + m[SIM_M_V] * v * p -
               m[SIM_WB] * ct * cp - m[SIM_Z_W] * w - m[SIM_Z_WW] * fabs(w) * w;
    force[5] = m[SIM_M_R] * t->nu_dot[5] - (m[SIM_M_U] - m[SIM_M_V]) * u * v - m[SIM_N_R] * r -
               m[SIM_N_RR] * fabs(r) * r;
}

/* Sines of different periods in all degrees of freedom; amplitude[j] in nu[j]. */
static void move(double t_s, const double amplitude[6], field_truth_t *t)
{
    memset(t, 0, sizeof *t);
    t->t_s = t_s;
    t->euler[0] = 0.1 * sin(0.61 * t_s);
    t->euler[1] = 0.08 * cos(0.47 * t_s);
    for (int j = 0; j < 6; ++j) {
        double omega = 0.3 + 0.11 * j;
        t->nu[j] = amplitude[j] * sin(omega * t_s);
        t->nu_dot[j] = amplitude[j] * omega * cos(omega * t_s);
    }
}

static const double usual[6] = {0.6, 0.3, 0.2, 0.1, 0.1, 0.5};

/* A run of 240 s. The hull force is that of the model with parameters m, plus `extra` unless it is
 * NULL. */
static void record(const double *m, const double amplitude[6],
                   void (*extra)(field_truth_t *t, double force[6]))
{
    field_truth_t t;
    for (int k = 0; k < 3000; ++k) {
        move(0.08 * k, amplitude, &t);
        model_force(m, &t, t.hull);
        if (extra != NULL) {
            extra(&t, t.hull);
        }
        field_projection_add(&run, &t, &built);
    }
    field_projection_solve(&run, &built, &truth);
}

static void assert_parameters(const double *wanted, const double *got)
{
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * fabs(wanted[i]), wanted[i], got[i]);
    }
}

static void test_a_hull_as_built_has_the_built_parameters(void)
{
    record(built.parameter, usual, NULL);
    assert_parameters(built.parameter, truth.si);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, truth.residual[e]);
    }
}

static void more_drag(field_truth_t *t, double force[6])
{
    static const int dofs[] = {0, 1, 2, 5};
    for (int e = 0; e < 4; ++e) {
        double v = t->nu[dofs[e]];
        force[dofs[e]] += 3.0 * v + 5.0 * fabs(v) * v;
    }
}

static void test_drag_of_the_model_s_form_is_found_in_each_equation(void)
{
    double wanted[SIM_PARAMETERS];
    memcpy(wanted, built.parameter, sizeof wanted);
    for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
        wanted[i] -= (i - SIM_X_U) % 2 == 0 ? 3.0 : 5.0;
    }
    record(built.parameter, usual, more_drag);
    assert_parameters(wanted, truth.si);
}

/* 20 u^2 forward and 10 u^2 backward: 15 |u| u + 5 u^2, whose second part is even. */
static void asymmetric(field_truth_t *t, double force[6])
{
    double u = t->nu[0];
    force[0] += (u > 0 ? 20.0 : 10.0) * fabs(u) * u;
}

static void test_asymmetric_drag_gives_its_mean_for_a_symmetric_motion(void)
{
    record(built.parameter, usual, asymmetric);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, built.parameter[SIM_X_U], truth.si[SIM_X_U]);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, built.parameter[SIM_X_UU] - 15.0, truth.si[SIM_X_UU]);
    TEST_ASSERT_TRUE(truth.residual[0] > 0.5);
}

static void test_masses_and_weight_are_as_built_whatever_the_force(void)
{
    double heavier[SIM_PARAMETERS];
    memcpy(heavier, built.parameter, sizeof heavier);
    heavier[SIM_M_U] *= 1.2;
    heavier[SIM_WB] *= 0.5;
    record(heavier, usual, NULL);
    for (int i = SIM_M_U; i <= SIM_WB; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(built.parameter[i], truth.si[i]);
    }
}

static void test_ballast_in_mid_run_does_not_change_the_drag(void)
{
    field_built_t now = built;
    field_truth_t t;
    for (int k = 0; k < 3000; ++k) {
        if (k == 1500) {
            now.parameter[SIM_M_U] += 5;
            now.parameter[SIM_M_V] += 5;
            now.parameter[SIM_M_W] += 5;
            now.parameter[SIM_WB] += 45;
        }
        move(0.08 * k, usual, &t);
        model_force(now.parameter, &t, t.hull);
        field_projection_add(&run, &t, &now);
    }
    field_projection_solve(&run, &now, &truth);
    assert_parameters(now.parameter, truth.si);
}

static void overstated(field_truth_t *t, double force[6])
{
    for (int j = 0; j < 6; ++j) {
        t->delivered[j] = force[j];
        t->reported[j] = force[j] / (j == 0 ? 0.8 : 1.1);
    }
}

static void test_the_truth_for_reported_thrust_divides_each_equation_by_delivered_on_reported(void)
{
    record(built.parameter, usual, overstated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.8, truth.gain[0]);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double gain = field_equation(i) == 0 ? 0.8 : 1.1;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(truth.si[i]), truth.si[i] / gain, truth.reported[i]);
    }
}

static void test_without_reported_thrust_both_truths_are_equal(void)
{
    record(built.parameter, usual, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(1, truth.gain[3]);
    TEST_ASSERT_EQUAL_DOUBLE(truth.si[SIM_N_R], truth.reported[SIM_N_R]);
}

static void test_a_degree_of_freedom_at_rest_has_the_built_drag(void)
{
    static const double straight[6] = {0.6, 0, 0.2, 0, 0, 0};
    record(built.parameter, straight, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(built.parameter[SIM_Y_V], truth.si[SIM_Y_V]);
    TEST_ASSERT_EQUAL_DOUBLE(built.parameter[SIM_N_RR], truth.si[SIM_N_RR]);
}

static void test_largest_motion_is_stored_by_direction(void)
{
    field_truth_t t = {.nu = {0.7, 0, 0, 0, 0, -0.4}, .nu_dot = {0, -0.2, 0, 0, 0, 0.1}};
    field_projection_add(&run, &t, &built);
    t.nu[0] = -0.5;
    t.nu_dot[1] = 0.15;
    field_projection_add(&run, &t, &built);
    field_projection_solve(&run, &built, &truth);
    TEST_ASSERT_EQUAL_DOUBLE(0.7, truth.speed[0][0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, truth.speed[0][1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, truth.speed[3][0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.4, truth.speed[3][1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, truth.acceleration[1]);
}

static void test_drag_force_has_the_sign_of_the_pair(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -(42 * 0.5 + 125 * 0.25), field_drag(built.parameter, 0, 0.5));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 21 * 0.3 + 61 * 0.09, field_drag(built.parameter, 3, -0.3));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hull_as_built_has_the_built_parameters);
    RUN_TEST(test_drag_of_the_model_s_form_is_found_in_each_equation);
    RUN_TEST(test_asymmetric_drag_gives_its_mean_for_a_symmetric_motion);
    RUN_TEST(test_masses_and_weight_are_as_built_whatever_the_force);
    RUN_TEST(test_ballast_in_mid_run_does_not_change_the_drag);
    RUN_TEST(test_the_truth_for_reported_thrust_divides_each_equation_by_delivered_on_reported);
    RUN_TEST(test_without_reported_thrust_both_truths_are_equal);
    RUN_TEST(test_a_degree_of_freedom_at_rest_has_the_built_drag);
    RUN_TEST(test_largest_motion_is_stored_by_direction);
    RUN_TEST(test_drag_force_has_the_sign_of_the_pair);
    return UNITY_END();
}
