/* The vehicle of the simulator in six degrees of freedom against physics. */
#include <math.h>
#include <string.h>

#include "sim_run.h"
#include "unity.h"

enum { X, Y, Z, K, M, N };

/* The BlueROV2 without noise and without stabilisation. */
void setUp(void)
{
    sim_bluerov2(&cfg);
    without_noise();
    cfg.hold_Nm_rad = cfg.hold_Nms_rad = 0;
}

void tearDown(void)
{
}

/* A vehicle in which all degrees of freedom are coupled. */
static void asymmetric(void)
{
    const double r_g[3] = {0.03, -0.02, 0.05}, r_b[3] = {-0.01, 0.02, -0.04};
    memcpy(cfg.fossen.r_g, r_g, sizeof r_g);
    memcpy(cfg.fossen.r_b, r_b, sizeof r_b);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < i; ++j) {
            cfg.fossen.added[i][j] = cfg.fossen.added[j][i] = 0.01 * (i + 2 * j);
        }
    }
}

static void start_tumbling(void)
{
    const double nu[6] = {0.6, -0.4, 0.3, 0.3, -0.2, 0.5}, euler[3] = {0.3, -0.2, 1.0};
    memcpy(cfg.nu, nu, sizeof nu);
    memcpy(cfg.euler, euler, sizeof euler);
    begin();
}

/* nu' M nu / 2. */
static double kinetic(const double nu[6])
{
    double m[6][6], sum = 0;
    sim_fossen_matrix(&cfg.fossen, m);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            sum += 0.5 * nu[i] * m[i][j] * nu[j];
        }
    }
    return sum;
}

/* Kinetic energy plus the potential energies of weight and buoyancy at their centres. */
static double energy(void)
{
    const sim_fossen_t *f = &cfg.fossen;
    double r[3][3], weight = sim.truth.position[2], buoyancy = weight;
    sim_rotation(sim.truth.euler, r);
    for (int i = 0; i < 3; ++i) {
        weight += r[2][i] * f->r_g[i];
        buoyancy += r[2][i] * f->r_b[i];
    }
    return kinetic(sim.truth.nu) - f->weight_N * weight + f->buoyancy_N * buoyancy;
}

static void without_drag(void)
{
    memset(cfg.fossen.linear, 0, sizeof cfg.fossen.linear);
    memset(cfg.fossen.quadratic, 0, sizeof cfg.fossen.quadratic);
}

/* ---- the vehicle ---- */

static void test_energy_is_conserved_without_drag(void)
{
    asymmetric();
    without_drag();
    start_tumbling();
    double before = energy(), moving = kinetic(sim.truth.nu);
    for (int i = 0; i < 20; ++i) {
        run(0.5, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * moving, before, energy());
    }
}

static void test_drag_only_dissipates_energy(void)
{
    asymmetric();
    start_tumbling();
    for (int i = 0; i < 200; ++i) {
        double before = energy();
        run(0.02, NULL);
        TEST_ASSERT_TRUE(energy() < before);
    }
}

static void test_coriolis_forces_do_no_work(void)
{
    const double none[6] = {0};
    asymmetric();
    without_drag();
    cfg.fossen.weight_N = cfg.fossen.buoyancy_N = 0;
    start_tumbling();
    double m[6][6], nu_dot[6], power = 0, max_term = 0;
    sim_fossen_matrix(&cfg.fossen, m);
    sim_fossen_acceleration(&cfg.fossen, cfg.euler, cfg.nu, none, nu_dot);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            power += cfg.nu[i] * m[i][j] * nu_dot[j];
            max_term = fmax(max_term, fabs(cfg.nu[i] * m[i][j] * nu_dot[j]));
        }
    }
    TEST_ASSERT_TRUE(max_term > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0, power);
}

/* Momentum in world axes, by central differences: d/dt of R p is R f, also for the moment about the
 * origin of the world. This is independent of the form of C. */
static void test_momentum_changes_by_the_acting_forces(void)
{
    const double force[6] = {30, -10, 20, 2, -1, 3}, h = 1e-4;
    asymmetric();
    without_drag();
    cfg.fossen.weight_N = cfg.fossen.buoyancy_N = 0;
    start_tumbling();
    double state[12] = {0}, momentum[2][6], r[3][3], m[6][6];
    memcpy(state + 3, cfg.euler, sizeof cfg.euler);
    memcpy(state + 6, cfg.nu, sizeof cfg.nu);
    sim_fossen_matrix(&cfg.fossen, m);
    for (int side = 0; side < 2; ++side) {
        double at[12], p[6] = {0};
        memcpy(at, state, sizeof at);
        sim_rk4(&cfg, at, force, side == 0 ? -h : h);
        sim_rotation(at + 3, r);
        for (int i = 0; i < 36; ++i) {
            p[i / 6] += m[i / 6][i % 6] * at[6 + i % 6];
        }
        for (int i = 0; i < 3; ++i) {
            momentum[side][i] = momentum[side][3 + i] = 0;
            for (int j = 0; j < 3; ++j) {
                momentum[side][i] += r[i][j] * p[j];
                momentum[side][3 + i] += r[i][j] * p[3 + j];
            }
        }
        double *l = momentum[side] + 3, *q = momentum[side]; /* about the origin of the world */
        l[0] += at[1] * q[2] - at[2] * q[1];
        l[1] += at[2] * q[0] - at[0] * q[2];
        l[2] += at[0] * q[1] - at[1] * q[0];
    }
    sim_rotation(cfg.euler, r);
    for (int i = 0; i < 6; ++i) {
        double acts = 0;
        for (int j = 0; j < 3; ++j) {
            acts += r[i % 3][j] * force[i < 3 ? j : 3 + j];
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, acts, (momentum[1][i] - momentum[0][i]) / (2 * h));
    }
}

static void test_it_rests_upright_and_sinks_by_its_excess_weight(void)
{
    double hover[6] = {0};
    hover[Z] = cfg.fossen.buoyancy_N - cfg.fossen.weight_N;
    cfg.euler[0] = 0.5;
    cfg.euler[1] = -0.4;
    begin();
    run(200, hover);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0, sim.truth.euler[0]); /* quadratic drag alone decays slowly */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sim.truth.euler[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, sim.truth.nu[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.982, -hover[Z]);
}

static void test_a_pitch_moment_is_balanced_by_the_righting_moment(void)
{
    double wrench[6] = {0};
    cfg.fossen.weight_N = cfg.fossen.buoyancy_N;
    wrench[M] = 0.01 * cfg.fossen.buoyancy_N * sin(0.4);
    begin();
    run(100, wrench);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sim.truth.euler[1]);
}

static void test_a_constant_force_is_finally_balanced_by_drag(void)
{
    double surge[6] = {0}, yaw[6] = {0};
    surge[X] = 30;
    yaw[N] = 6;
    cfg.fossen.weight_N = cfg.fossen.buoyancy_N;
    begin();
    run(60, surge);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (sqrt(13.7 * 13.7 + 4 * 141.0 * 30) - 13.7) / 282,
                              sim.truth.nu[0]);
    begin();
    run(60, yaw);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2, sim.truth.nu[5]); /* 1.5 r^2 = 6 */
}

static void test_a_current_carries_it_and_changes_nothing_else(void)
{
    const double wrench[6] = {20, -10, 15, 0.5, 0.4, 2};
    asymmetric();
    start_tumbling();
    run(10, wrench);
    sim_truth_t still = sim.truth;
    cfg.current[0] = 0.3;
    start_tumbling();
    run(10, wrench);
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, still.nu[i], sim.truth.nu[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, still.position[0] + 3, sim.truth.position[0]);
}

static void test_parameters_are_the_identifiable_sums(void)
{
    double p[SIM_FOSSEN_PARAMETERS];
    cfg.fossen.r_g[2] = 0.02;
    cfg.fossen.added[0][4] = cfg.fossen.added[4][0] = 0.3;
    sim_fossen_parameters(&cfg.fossen, p);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 13.5 + 6.36, p[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.26 + 0.189, p[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.982, p[6]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.02 * 13.5 * 9.82 + 0.01 * 13.4 * 9.82, p[9]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -13.7, p[10]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1.5, p[21]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 13.5 * 0.02 + 0.3, p[22]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -13.5 * 0.02, p[23]);
}

/* ---- thrusters and hold ---- */

static void test_thrusters_push_as_published(void)
{
    /* X Y Z K M N per newton, von Benzon et al. 2022, rounded to a millimetre. */
    static const double published[6][8] = {
        {0.707, 0.707, -0.707, -0.707, 0, 0, 0, 0},
        {-0.707, 0.707, -0.707, 0.707, 0, 0, 0, 0},
        {0, 0, 0, 0, -1, 1, 1, -1},
        {0.060, -0.060, 0.060, -0.060, -0.218, -0.218, 0.218, 0.218},
        {0.060, 0.060, -0.060, -0.060, 0.120, -0.120, 0.120, -0.120},
        {-0.189, 0.189, 0.189, -0.189, 0, 0, 0, 0}};
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 8; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(5e-4, published[i][j], cfg.thruster_matrix[i][j]);
        }
    }
}

static void test_thrusters_are_weaker_backward(void)
{
    double force[SIM_THRUSTERS] = {100, -100, NAN};
    begin();
    sim_step(&sim, force, NULL, &out);
    TEST_ASSERT_EQUAL_DOUBLE(51.5, out.thruster_N[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-40.2, out.thruster_N[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0, out.thruster_N[2]);
}

static void test_stabilisation_rights_the_vehicle_and_is_in_the_feedback(void)
{
    const double push[6] = {0, 0, 0, 2, 0, 0};
    cfg.hold_Nm_rad = 8;
    cfg.hold_Nms_rad = 2;
    cfg.fossen.weight_N = cfg.fossen.buoyancy_N;
    begin();
    run(20, push);
    double phi = sim.truth.euler[0];
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2, 8 * phi + 0.01 * cfg.fossen.buoyancy_N * sin(phi));
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, i == K ? 2 - 8 * phi : 0, out.wrench[i]);
        TEST_ASSERT_EQUAL_DOUBLE(out.wrench[i], sim.truth.wrench[i]);
    }
}

/* ---- disturbance and configuration ---- */

static void test_disturbance_acts_in_all_six_degrees_of_freedom(void)
{
    double square[6] = {0};
    cfg.disturbance_N = 0.2;
    cfg.disturbance_Nm = 0.08;
    cfg.disturbance_s = 0.01; /* nearly white: 4000 samples give the rms within 4 % */
    begin();
    for (int k = 0; k < 4000; ++k) {
        run(0.02, NULL);
        for (int i = 0; i < 6; ++i) {
            square[i] += sim.truth.disturbance[i] * sim.truth.disturbance[i] / 4000;
        }
    }
    for (int i = 0; i < 6; ++i) {
        double rms = i < 3 ? 0.2 : 0.08;
        TEST_ASSERT_DOUBLE_WITHIN(0.08 * rms, rms, sqrt(square[i]));
    }
}

static void refuse(double *field, double value)
{
    double before = *field;
    *field = value;
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
    *field = before;
    TEST_ASSERT_TRUE(sim_init(&sim, &cfg));
}

static void test_init_refuses_invalid_values(void)
{
    refuse(&cfg.fossen.mass_kg, -10);
    refuse(&cfg.fossen.mass_kg, NAN);
    refuse(&cfg.fossen.inertia[0], -0.2);
    refuse(&cfg.fossen.added[0][4], 1);
    refuse(&cfg.fossen.weight_N, INFINITY);
    refuse(&cfg.fossen.r_b[2], NAN);
    refuse(&cfg.fossen.linear[3], NAN);
    refuse(&cfg.thruster_back_N, -1);
    refuse(&cfg.hold_Nm_rad, -1);
    cfg.thrusters = SIM_THRUSTERS + 1;
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
    cfg.thrusters = 5;
    begin();
    cfg.hold_Nm_rad = 1; /* five thrusters do not actuate all six */
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_energy_is_conserved_without_drag);
    RUN_TEST(test_drag_only_dissipates_energy);
    RUN_TEST(test_coriolis_forces_do_no_work);
    RUN_TEST(test_momentum_changes_by_the_acting_forces);
    RUN_TEST(test_it_rests_upright_and_sinks_by_its_excess_weight);
    RUN_TEST(test_a_pitch_moment_is_balanced_by_the_righting_moment);
    RUN_TEST(test_a_constant_force_is_finally_balanced_by_drag);
    RUN_TEST(test_a_current_carries_it_and_changes_nothing_else);
    RUN_TEST(test_parameters_are_the_identifiable_sums);
    RUN_TEST(test_thrusters_push_as_published);
    RUN_TEST(test_thrusters_are_weaker_backward);
    RUN_TEST(test_stabilisation_rights_the_vehicle_and_is_in_the_feedback);
    RUN_TEST(test_disturbance_acts_in_all_six_degrees_of_freedom);
    RUN_TEST(test_init_refuses_invalid_values);
    return UNITY_END();
}
