/* A known force: the model that has it, the conversion of its estimate to SI, and calibration dives
 * in the simulation of `auvid demo`. There, the thrust is 20 % too strong as told, and a weight
 * hangs on the vehicle for one minute of four. Node 0 excites; node 1 has the model with a known
 * force and uncertain inputs.
 *
 * Long form (AUVID_TEST_LONG): 50 seeds. With arguments: FIRST seed and COUNT. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/estimate.h"
#include "auvid/fossen.h"
#include "finish.h"
#include "unity.h"
#include "bus/world.h"

#ifdef __SANITIZE_ADDRESS__
enum { SEEDS = 1 };
#else
enum { SEEDS = 3 };
#endif
enum { N = AUVID_G500_COUNT, SETS = 8, BUDGET = 1000, SEEDS_LONG = 50 };
#define TOO_STRONG 1.2
#define WEIGHT_N 20.0
#define WEIGHT_KG 2.3

static struct {
    uint64_t first;
    int count;
} seeds = {1, SEEDS};

static auvid_calibrated_t model;
static auvid_uncertain_t uncertain;
static world_t world;
static auvid_estimate_t si;

void setUp(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_init(&model, &auvid_girona500, AUVID_HEAVE));
}

void tearDown(void)
{
}

/* ---- the model ---- */

static double draw(sim_rng_t *rng, double limit)
{
    return limit * (2.0 * sim_rng_uniform(rng) - 1.0);
}

/* Draws a sample in motion, a known force, and parameters. */
static void draw_sample(sim_rng_t *rng, auvid_sample_t *sample, auvid_known_force_t *force,
                        auvid_real_t pi[AUVID_MAX_PARAMETERS])
{
    memset(sample, 0, sizeof *sample);
    sample->t_us = 1000;
    sample->phi = (auvid_real_t)draw(rng, 0.5);
    sample->theta = (auvid_real_t)draw(rng, 0.5);
    sample->psi = (auvid_real_t)draw(rng, 3.0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        sample->nu[j] = (auvid_real_t)draw(rng, 0.8);
        sample->nu_dot[j] = (auvid_real_t)draw(rng, 0.5);
        sample->tau[j] = (auvid_real_t)draw(rng, 100.0);
    }
    for (int i = 0; i < 3; ++i) {
        force->world[i] = (auvid_real_t)draw(rng, 30.0);
        force->body[i] = (auvid_real_t)draw(rng, 30.0);
        force->at[i] = (auvid_real_t)draw(rng, 1.0);
    }
    force->mass_kg = (auvid_real_t)(5.0 + draw(rng, 5.0));
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        pi[i] = i < N ? auvid_girona500_paper[i] : AUVID_C(1.2);
    }
}

/* Velocity in the world of the point `at` of the vehicle, h seconds from the sample. */
static void point_velocity(const auvid_sample_t *s, const auvid_real_t at[3], double h,
                           double world_m_s[3])
{
    double euler[3] = {(double)s->phi, (double)s->theta, (double)s->psi}, nu[6], v[3], r[3][3];
    double turn = (double)s->nu[4] * sin(euler[0]) + (double)s->nu[5] * cos(euler[0]);
    double rate[3] = {(double)s->nu[3] + tan(euler[1]) * turn,
                      (double)s->nu[4] * cos(euler[0]) - (double)s->nu[5] * sin(euler[0]),
                      turn / cos(euler[1])};
    for (int i = 0; i < 6; ++i) {
        nu[i] = (double)s->nu[i] + h * (double)s->nu_dot[i];
    }
    for (int i = 0; i < 3; ++i) {
        euler[i] += h * rate[i];
    }
    v[0] = nu[0] + nu[4] * (double)at[2] - nu[5] * (double)at[1];
    v[1] = nu[1] + nu[5] * (double)at[0] - nu[3] * (double)at[2];
    v[2] = nu[2] + nu[3] * (double)at[1] - nu[4] * (double)at[0];
    sim_rotation(euler, r);
    for (int i = 0; i < 3; ++i) {
        world_m_s[i] = r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
    }
}

/* Force and yaw moment of a known force: its mass by Newton's law in the world. */
static void expected_wrench(const auvid_sample_t *s, const auvid_known_force_t *force,
                            double wrench[4])
{
    const double h = 1e-4, euler[3] = {(double)s->phi, (double)s->theta, (double)s->psi};
    double before[3], after[3], r[3][3], net[3];
    point_velocity(s, force->at, -h, before);
    point_velocity(s, force->at, h, after);
    sim_rotation(euler, r);
    for (int i = 0; i < 3; ++i) {
        double a = (after[i] - before[i]) / (2.0 * h);
        net[i] = (double)force->world[i] - (double)force->mass_kg * a;
    }
    for (int i = 0; i < 3; ++i) {
        wrench[i] = (double)force->body[i] + r[0][i] * net[0] + r[1][i] * net[1] + r[2][i] * net[2];
    }
    wrench[3] = (double)force->at[0] * wrench[1] - (double)force->at[1] * wrench[0];
}

static void test_the_last_column_is_the_known_wrench_turned_round(void)
{
    static const int equation[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 0);
    for (int trial = 0; trial < 200; ++trial) {
        auvid_real_t pi[AUVID_MAX_PARAMETERS];
        auvid_known_force_t force;
        auvid_regressor_t y, hull;
        auvid_sample_t sample;
        double wrench[4];
        draw_sample(&rng, &sample, &force, pi);
        auvid_calibrated_clear(&model);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_force(&model, 0, &force));
        expected_wrench(&sample, &force, wrench);
        memset(&y, 0, sizeof y);
        memset(&hull, 0, sizeof hull);
        model.vehicle.regressor(model.vehicle.context, &sample, NULL, &y);
        auvid_girona500.regressor(auvid_girona500.context, &sample, NULL, &hull);
        for (int k = 0; k < 4; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-4, -wrench[k], (double)y.row[equation[k]][model.k]);
            y.row[equation[k]][model.k] = 0;
        }
        TEST_ASSERT_EQUAL_MEMORY(&hull, &y, sizeof y); /* roll and pitch have no equation */
    }
}

static void test_the_acceleration_leaves_no_residual(void)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, 2, 0);
    for (int trial = 0; trial < 200; ++trial) {
        const auvid_vehicle_t *vehicle = &model.vehicle;
        auvid_real_t pi[AUVID_MAX_PARAMETERS], nu_dot[AUVID_DOF_COUNT] = {0}, e[AUVID_DOF_COUNT];
        auvid_known_force_t force;
        auvid_sample_t sample;
        draw_sample(&rng, &sample, &force, pi);
        auvid_calibrated_clear(&model);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_force(&model, 0, &force));
        sample.nu_dot[AUVID_ROLL] = sample.nu_dot[AUVID_PITCH] = 0;
        TEST_ASSERT_TRUE(vehicle->acceleration(vehicle->context, &sample, pi, nu_dot));
        memcpy(sample.nu_dot, nu_dot, sizeof nu_dot);
        auvid_vehicle_residual(vehicle, &sample, pi, e);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.0, (double)e[j]);
        }
    }
}

static void test_k_follows_the_parameters_in_every_equation(void)
{
    const auvid_vehicle_t *vehicle = &model.vehicle;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(vehicle));
    TEST_ASSERT_EQUAL(N + 1, vehicle->parameters);
    TEST_ASSERT_EQUAL(N, model.k);
    TEST_ASSERT_EQUAL_STRING("k_tau", vehicle->parameter[N].name);
    TEST_ASSERT_EQUAL(AUVID_HEAVE, vehicle->parameter[N].dof);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE | 1u << N, vehicle->free);
    TEST_ASSERT_EQUAL_HEX32(0, vehicle->columns[AUVID_ROLL]);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool modelled = auvid_girona500.columns[j] != 0;
        TEST_ASSERT_EQUAL(modelled, vehicle->columns[j] >> N & 1u);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_init(&model, &auvid_girona500, AUVID_SURGE));
    TEST_ASSERT_EQUAL(AUVID_SURGE, model.vehicle.parameter[N].dof);
}

static void test_k_takes_the_place_of_a_parameter_that_is_not_free(void)
{
    sim_rng_t rng;
    auvid_real_t pi[AUVID_MAX_PARAMETERS], nu_dot[AUVID_DOF_COUNT] = {0}, e[AUVID_DOF_COUNT];
    auvid_known_force_t force;
    auvid_sample_t sample;
    TEST_ASSERT_EQUAL(AUVID_MAX_PARAMETERS, auvid_fossen.parameters);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_init(&model, &auvid_fossen, AUVID_HEAVE));
    TEST_ASSERT_EQUAL(AUVID_FOSSEN_COUNT - 1, model.k);
    TEST_ASSERT_EQUAL(AUVID_MAX_PARAMETERS, model.vehicle.parameters);
    TEST_ASSERT_EQUAL_STRING("k_tau", model.vehicle.parameter[model.k].name);
    sim_rng_seed(&rng, 3, 0);
    draw_sample(&rng, &sample, &force, pi);
    memcpy(pi, auvid_bluerov2_heavy_benzon, sizeof auvid_bluerov2_heavy_benzon);
    pi[model.k] = AUVID_C(1.2);
    force.mass_kg = AUVID_C(1.0);
    force.at[0] = force.at[1] = force.at[2] = AUVID_C(0.1);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_force(&model, 0, &force));
    const auvid_vehicle_t *vehicle = &model.vehicle;
    TEST_ASSERT_TRUE(vehicle->acceleration(vehicle->context, &sample, pi, nu_dot));
    memcpy(sample.nu_dot, nu_dot, sizeof nu_dot);
    auvid_vehicle_residual(vehicle, &sample, pi, e);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.0, (double)e[j]);
    }
}

/* Force in heave at a time. */
static double down_at(uint64_t t_us)
{
    auvid_regressor_t y;
    auvid_sample_t level = {.t_us = t_us};
    memset(&y, 0, sizeof y);
    model.vehicle.regressor(model.vehicle.context, &level, NULL, &y);
    return -(double)y.row[AUVID_HEAVE][model.k];
}

static void set_down(uint64_t t_us, double force_N)
{
    const auvid_known_force_t force = {.world = {0, 0, (auvid_real_t)force_N}};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_calibrated_force(&model, t_us, force_N > 0.0 ? &force : NULL));
}

static void test_a_cell_gets_the_force_of_its_time(void)
{
    TEST_ASSERT_TRUE(down_at(5) == 0.0);
    set_down(1000000, 8.0);
    set_down(2000000, 0.0);
    set_down(3000000, 4.0);
    set_down(3040000, 5.0); /* replaces it: too close */
    set_down(4000000, 5.0); /* no change */
    TEST_ASSERT_TRUE(down_at(999999) == 0.0 && down_at(1000000) == 8.0);
    TEST_ASSERT_TRUE(down_at(1999999) == 8.0 && down_at(2000000) == 0.0);
    TEST_ASSERT_TRUE(down_at(3000000) == 5.0 && down_at(9000000) == 5.0);
    TEST_ASSERT_EQUAL_UINT32(3, model.changes);
    auvid_calibrated_clear(&model);
    TEST_ASSERT_TRUE(down_at(9000000) == 0.0);
    set_down(1, 2.0);
    TEST_ASSERT_TRUE(down_at(0) == 0.0 && down_at(1) == 2.0);
}

static void test_the_newest_changes_are_kept(void)
{
    for (unsigned k = 0; k < AUVID_KNOWN_CHANGES; ++k) {
        set_down(100000u * (k + 1), 1.0 + k);
        TEST_ASSERT_TRUE(down_at(0) == 0.0); /* before the first one */
    }
    auvid_calibrated_clear(&model);
    for (unsigned k = 0; k < AUVID_KNOWN_CHANGES + 3u; ++k) {
        set_down(100000u * k, 1.0 + k);
    }
    for (unsigned k = 3; k < AUVID_KNOWN_CHANGES + 3u; ++k) {
        TEST_ASSERT_TRUE(down_at(100000u * k) == 1.0 + k);
    }
    TEST_ASSERT_TRUE(down_at(0) == 4.0); /* the oldest that is known */
}

static void check_refused(auvid_status_t status, const auvid_vehicle_t *vehicle, auvid_dof_t dof)
{
    static auvid_calibrated_t before;
    before = model;
    TEST_ASSERT_EQUAL(status, auvid_calibrated_init(&model, vehicle, dof));
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof before);
}

static void test_an_unsuitable_model_is_refused(void)
{
    static const auvid_parameter_t parameter[AUVID_MAX_PARAMETERS]; /* of surge */
    auvid_vehicle_t hull = auvid_girona500;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_calibrated_init(NULL, &hull, AUVID_HEAVE));
    check_refused(AUVID_ERR_NULL, NULL, AUVID_HEAVE);
    hull.built_for = NULL;
    check_refused(AUVID_ERR_SIZE, &hull, AUVID_HEAVE);
    check_refused(AUVID_ERR_MODEL, &model.vehicle, AUVID_HEAVE);  /* it would call itself */
    check_refused(AUVID_ERR_MODEL, &auvid_girona500, AUVID_ROLL); /* not modelled */
    check_refused(AUVID_ERR_MODEL, &auvid_girona500, AUVID_DOF_COUNT);
    hull = auvid_girona500;
    hull.path = &auvid_path_residual;
    hull.residual = model.vehicle.residual;
    check_refused(AUVID_ERR_MODEL, &hull, AUVID_HEAVE);
    hull = auvid_girona500;
    hull.parameter = parameter;
    hull.parameters = AUVID_MAX_PARAMETERS;
    hull.columns[AUVID_SURGE] = UINT32_MAX >> (32 - AUVID_MAX_PARAMETERS);
    hull.free = UINT32_MAX;
    check_refused(AUVID_ERR_PARAMETERS, &hull, AUVID_HEAVE);
    hull.free = 0; /* all are */
    check_refused(AUVID_ERR_PARAMETERS, &hull, AUVID_HEAVE);
}

static void check_force(auvid_status_t status, uint64_t t_us, const auvid_known_force_t *force)
{
    static auvid_calibrated_t before;
    before = model;
    TEST_ASSERT_EQUAL(status, auvid_calibrated_force(&model, t_us, force));
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof before);
}

static void test_a_wrong_force_is_refused(void)
{
    const auvid_real_t nan = (auvid_real_t)NAN;
    const auvid_known_force_t wrong[] = {{.world = {0, 0, AUVID_C(1.1e5)}},
                                         {.body = {AUVID_C(-1.1e5)}},
                                         {.at = {0, AUVID_C(101.0)}},
                                         {.mass_kg = AUVID_C(-0.1)},
                                         {.mass_kg = AUVID_C(1.1e4)}};
    const auvid_known_force_t not_finite[] = {
        {.world = {nan}}, {.body = {0, nan}}, {.at = {0, 0, nan}}, {.mass_kg = nan}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
        check_force(AUVID_ERR_RANGE, 5, &wrong[k]);
    }
    for (size_t k = 0; k < sizeof not_finite / sizeof not_finite[0]; ++k) {
        check_force(AUVID_ERR_NOT_FINITE, 5, &not_finite[k]);
    }
    set_down(1000000, 1.0);
    check_force(AUVID_ERR_TIME_BACK, 999999, NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_calibrated_force(NULL, 5, NULL));
    memset(&model, 0, sizeof model);
    check_force(AUVID_ERR_STATE, 5, NULL);
    auvid_calibrated_clear(NULL);
}

/* ---- the conversion ---- */

static double *entry(double p[3][3], int i, int k)
{
    return &p[i < k ? i : k][i < k ? k : i];
}

static auvid_real_t *packed(auvid_estimate_t *e, int i, int k)
{
    return e->covariance + i * (N + 1) - i * (i - 1) / 2 + k - i;
}

/* An estimate of two parameters and k, with covariance p and no error of the DVL. */
static void make_estimate(auvid_estimate_t *e, const double pi[3], double p[3][3], double prior)
{
    static const int at[3] = {AUVID_G500_M_W, AUVID_G500_Z_W, N};
    memset(e, 0, sizeof *e);
    e->number = 1;
    e->sets = 1;
    e->confidence.uncertainty.thrust_scale = (auvid_real_t)prior;
    for (int i = 0; i < 3; ++i) {
        double thrust = prior * pi[i];
        e->pi[at[i]] = (auvid_real_t)pi[i];
        e->identified |= 1u << at[i];
        e->confidence.thrust_error[at[i]] = (auvid_real_t)thrust;
        e->confidence.sigma[at[i]] = (auvid_real_t)sqrt(p[i][i] + thrust * thrust);
        for (int k = i; k < 3; ++k) {
            *packed(e, at[i], at[k]) = (auvid_real_t)p[i][k];
        }
    }
}

/* Checks the converted estimate against Bayes' rule and the delta rule. */
static void check_conversion(const double pi[3], double p[3][3], double prior_variance)
{
    static const int at[3] = {AUVID_G500_M_W, AUVID_G500_Z_W, N};
    double x[3], q[3][3], jacobian[2][3] = {{0}};
    double innovation = 1.0 - pi[2], s = p[2][2] + prior_variance, k;
    for (int i = 0; i < 3; ++i) {
        x[i] = pi[i] + *entry(p, i, 2) * innovation / s;
        for (int l = 0; l < 3; ++l) {
            q[i][l] = *entry(p, i, l) - *entry(p, i, 2) * *entry(p, l, 2) / s;
        }
    }
    k = x[2];
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, k, (double)si.pi[N]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, sqrt(q[2][2]), (double)si.confidence.sigma[N]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, sqrt(q[2][2]) / k,
                              (double)si.confidence.uncertainty.thrust_scale);
    for (int i = 0; i < 2; ++i) {
        jacobian[i][i] = 1.0 / k;
        jacobian[i][2] = -x[i] / (k * k);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs(x[i]), x[i] / k, (double)si.pi[at[i]]);
    }
    for (int i = 0; i < 2; ++i) {
        for (int l = i; l < 2; ++l) {
            double total = 0.0;
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    total += jacobian[i][a] * q[a][b] * jacobian[l][b];
                }
            }
            double found =
                (double)*packed(&si, at[i], at[l]) + (double)si.confidence.thrust_error[at[i]] *
                                                         (double)si.confidence.thrust_error[at[l]];
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(total), total, found);
            if (i == l) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-3 * total, total,
                                          pow((double)si.confidence.sigma[at[i]], 2.0));
            }
        }
    }
}

static void test_the_conversion_is_bayes_rule_and_the_delta_rule(void)
{
    double p[3][3] = {{64.0, -6.0, 0.1}, {0.0, 25.0, -0.03}, {0.0, 0.0, 6e-4}};
    const double pi[3] = {720.0, -55.0, 1.03};
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.05);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    check_conversion(pi, p, 0.05 * 0.05);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &told)); /* in place */
    TEST_ASSERT_EQUAL_MEMORY(&si, &told, sizeof si);
}

static void test_a_prior_that_the_data_contradict_is_widened(void)
{
    double p[3][3] = {{64.0, -6.0, 0.1}, {0.0, 25.0, -0.03}, {0.0, 0.0, 6e-4}};
    const double pi[3] = {720.0, -55.0, 1.2};
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.05);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    check_conversion(pi, p, 0.2 * 0.2 - 6e-4);
}

static void test_flags_follow_the_half_width_in_si(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 4e-4}};
    const double pi[3] = {720.0, -80.0, 1.0};
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.15); /* 2.1 * 15 % are too much for each */
    auvid_confidence_t *c = &told.confidence;
    c->note[AUVID_G500_M_W] = c->note[AUVID_G500_Z_W] = AUVID_NOTE_THRUST_SCALE;
    c->bound[AUVID_G500_M_W] = AUVID_C(0.09);
    c->bound[AUVID_G500_Z_W] = AUVID_C(0.01); /* less than k's error leaves */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_G500_M_W | 1u << N, si.confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, si.confidence.note[AUVID_G500_M_W]);
    told.sets = 0; /* of a prior record: no data have shown k */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_HEX32(0, si.confidence.identifiable >> N & 1u);
    told.sets = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL(AUVID_NOTE_THRUST_SCALE, si.confidence.note[AUVID_G500_Z_W]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.01, (double)si.confidence.bound[AUVID_G500_Z_W]);
    c->note[AUVID_G500_M_W] = AUVID_NOTE_COMBINATION; /* another fault stays */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_HEX32(1u << N, si.confidence.identifiable);
    c->note[AUVID_G500_M_W] = AUVID_NOTE_THRUST_SCALE;
    c->unchecked = true; /* so does one of all */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_HEX32(0, si.confidence.identifiable);
    c->unchecked = false;
}

static void test_data_that_hardly_show_the_scale_do_not_convert(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 0.0891}};
    const double pi[3] = {720.0, -80.0, 1.1};
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.15);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_HEX32(0, si.confidence.identifiable >> N); /* the prior says more */
    *packed(&told, N, N) = AUVID_C(0.0909);                      /* more than (2 * 0.15)^2 */
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)si.pi[N]);
    TEST_ASSERT_TRUE(si.confidence.sigma[N] >= AUVID_LARGEST);
    TEST_ASSERT_EQUAL_HEX32(0, si.confidence.identifiable >> N);
    TEST_ASSERT_EQUAL_DOUBLE((double)told.pi[AUVID_G500_M_W], (double)si.pi[AUVID_G500_M_W]);
}

static void test_without_a_known_force_the_estimate_stays(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 0.0}};
    const double pi[3] = {720.0, -80.0, 0.0};
    auvid_estimate_t told, expected;
    make_estimate(&told, pi, p, 0.05);
    expected = told;
    expected.pi[N] = 1;
    expected.confidence.sigma[N] = AUVID_LARGEST;
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_MEMORY(&expected, &si, sizeof si);
}

static void test_estimates_that_cannot_be_converted_are_refused(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 1e-4}};
    const double pi[3] = {720.0, -80.0, -1.0}; /* the weight pulled up */
    auvid_estimate_t told, before;
    make_estimate(&told, pi, p, 0.05);
    memset(&si, 7, sizeof si);
    before = si;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_calibrated_estimate(&model, NULL, &si));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_calibrated_estimate(NULL, &told, &si));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_calibrated_estimate(&model, &told, NULL));
    told.number = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_calibrated_estimate(&model, &told, &si));
    memset(&model, 0, sizeof model);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_calibrated_estimate(&model, &told, &si));
    TEST_ASSERT_EQUAL_MEMORY(&before, &si, sizeof si);
}

static void test_a_force_in_another_unit_is_refused(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 1e-4}};
    double pi[3] = {720.0, -80.0, 3.1}; /* it is k */
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.05);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_calibrated_estimate(&model, &told, &si));
    pi[2] = 0.32;
    make_estimate(&told, pi, p, 0.05);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_calibrated_estimate(&model, &told, &si));
    pi[2] = 2.9;
    make_estimate(&told, pi, p, 0.05);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
}

static void test_a_mass_in_si_below_the_dry_mass_refutes_the_force(void)
{
    double p[3][3] = {{64.0, 0.0, 0.0}, {0.0, 25.0, 0.0}, {0.0, 0.0, 1e-4}};
    const double pi[3] = {720.0, -80.0, 1.6}; /* 450 kg +- 11 kg in SI */
    auvid_estimate_t told;
    make_estimate(&told, pi, p, 0.05);
    model.dry_mass_kg = AUVID_C(450.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
    model.dry_mass_kg = AUVID_C(500.0);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_calibrated_estimate(&model, &told, &si));
    told.identified = 1u << AUVID_G500_Z_W | 1u << N; /* a mass that is not known */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_estimate(&model, &told, &si));
}

/* ---- calibration dives ---- */

/* Hangs the force on, or takes it off: in the simulation, and for the model. */
static void hang(const auvid_known_force_t *force, bool on)
{
    sim_config_t *sim = &world.vehicle_sim.sim.cfg;
    double mass = (double)force->mass_kg;
    uint64_t now_us = world.vehicle_sim.seen.t_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_calibrated_force(&model, now_us, on ? force : NULL));
    for (int i = 0; i < 3; ++i) {
        sim->load_N[i] = on ? (double)force->world[i] : 0.0;
        sim->load_at_m[i] = (double)force->at[i];
        sim->parameter[SIM_M_U + i] += on ? mass : -mass;
    }
}

/* Excites for SETS sets, with the force on from `on_s` to `off_s`. Writes si. expected: status of
 * the conversion. @return the estimate before it */
static const auvid_estimate_t *dive(uint64_t seed, const auvid_known_force_t *force, double on_s,
                                    double off_s, auvid_status_t expected)
{
    const world_config_t config = {.seed = seed, .disturbance_N = 1.0, .sets = SETS};
    static auvid_identifier_config_t cfg;
    auvid_identifier_t *id = &world.node[1].id;
    bool is_on = false;
    auvid_calibrated_clear(&model);
    TEST_ASSERT_TRUE(world_begin(&world, &config));
    world_identifier(&cfg, &config);
    cfg.vehicle = &model.vehicle;
    cfg.metric.free = model.vehicle.free;
    cfg.metric.fixed[model.k] = 1;
    cfg.exact_inputs = false;
    TEST_ASSERT_TRUE(world_listen(&world, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, world_uncertain(&world.node[1], &uncertain, vehicle_default()));
    sim_config_t *sim = &world.vehicle_sim.sim.cfg;
    for (int i = 0; i < 6 * SIM_THRUSTERS; ++i) {
        sim->thruster_matrix[i / SIM_THRUSTERS][i % SIM_THRUSTERS] /= TOO_STRONG;
    }
    while (id->metric.sets.recorded < SETS && world_time_s(&world) < 600.0) {
        double t = world_time_s(&world);
        if ((t >= on_s && t < off_s) != is_on) {
            is_on = !is_on;
            hang(force, is_on);
        }
        world_tick(&world);
        (void)world_work(&world, BUDGET);
        TEST_ASSERT_EQUAL_HEX32(0, world.node[1].events & AUVID_EVENT_CHANGED);
    }
    finish_work(id, BUDGET);
    TEST_ASSERT_NOT_EQUAL(AUVID_GUARD_ABORTED, world.actuation.guard.state);
    const auvid_estimate_t *told = auvid_identifier_estimate(id);
    TEST_ASSERT_NOT_NULL(told);
    TEST_ASSERT_EQUAL(expected, auvid_calibrated_estimate(&model, told, &si));
    return told;
}

/* Relative error of parameter i. */
static double off(const auvid_estimate_t *e, int i)
{
    const double truth = vehicle_default()->sim.parameter[i];
    return ((double)e->pi[i] - truth) / fabs(truth);
}

static void test_a_weight_corrects_thrust_that_is_told_20_percent_too_strong(void)
{
    const auvid_known_force_t weight = {.world = {0, 0, (auvid_real_t)WEIGHT_N},
                                        .mass_kg = (auvid_real_t)WEIGHT_KG};
    double largest[2] = {0.0, 0.0}, squares[2] = {0.0, 0.0}, told_mass = 0.0, ratio = 0.0, k = 0.0;
    for (int run = 0; run < seeds.count; ++run) {
        static const int watched[2] = {AUVID_G500_W_B, AUVID_G500_M_W};
        const auvid_estimate_t *told =
            dive(seeds.first + (uint64_t)run, &weight, 90.0, 150.0, AUVID_OK);
        for (int n = 0; n < 2; ++n) {
            double e = off(&si, watched[n]);
            largest[n] = fmax(largest[n], fabs(e));
            squares[n] += e * e / seeds.count;
            TEST_ASSERT_TRUE(fabs(e) < 0.08);
        }
        told_mass += off(told, AUVID_G500_M_W) / seeds.count;
        k += (double)si.pi[N] / seeds.count;
        ratio +=
            (double)(si.confidence.sigma[AUVID_G500_M_W] / si.pi[AUVID_G500_M_W]) / seeds.count;
        TEST_ASSERT_TRUE(off(told, AUVID_G500_M_W) > 0.12);
        TEST_ASSERT_EQUAL_HEX32(0, ~si.confidence.identifiable & (1u << AUVID_G500_M_W | 1u << N));
    }
    printf("%d runs: W-B rms %.1f %%, largest %.1f %%; m_w rms %.1f %%, largest %.1f %%, standard "
           "error %.1f %%; m_w as told %+.1f %%; k %.3f\n",
           seeds.count, 100.0 * sqrt(squares[0]), 100.0 * largest[0], 100.0 * sqrt(squares[1]),
           100.0 * largest[1], 100.0 * ratio, 100.0 * told_mass, k);
}

static void test_a_pull_calibrates_the_thrusters_of_its_axis(void)
{
    /* to the north, by a spring scale; the vehicle turns */
    const auvid_known_force_t pull = {.world = {AUVID_C(25.0)}};
    (void)dive(seeds.first, &pull, 60.0, 180.0, AUVID_OK);
    TEST_ASSERT_TRUE(fabs(off(&si, AUVID_G500_M_U)) < 0.08);
    TEST_ASSERT_TRUE(fabs((double)si.pi[N] / TOO_STRONG - 1.0) < 0.08);
    TEST_ASSERT_TRUE((double)(si.confidence.sigma[AUVID_G500_M_U] / si.pi[AUVID_G500_M_U]) < 0.05);
}

static void test_a_weight_that_never_changes_is_not_separable_from_the_trim(void)
{
    const auvid_known_force_t weight = {.world = {0, 0, (auvid_real_t)WEIGHT_N}};
    (void)dive(seeds.first, &weight, 0.0, 1e9, AUVID_UNUSED);
    TEST_ASSERT_EQUAL(AUVID_NOTE_COMBINATION, si.confidence.note[AUVID_G500_W_B]);
    TEST_ASSERT_EQUAL(N, si.confidence.partner[AUVID_G500_W_B]);
    TEST_ASSERT_EQUAL_HEX32(0, si.confidence.identifiable & (1u << AUVID_G500_W_B | 1u << N));
}

int main(int argc, char **argv)
{
    seeds.count = getenv("AUVID_TEST_LONG") != NULL ? SEEDS_LONG : SEEDS;
    if (argc == 3) {
        seeds.first = strtoull(argv[1], NULL, 10);
        seeds.count = atoi(argv[2]);
    }
    UNITY_BEGIN();
    RUN_TEST(test_the_last_column_is_the_known_wrench_turned_round);
    RUN_TEST(test_the_acceleration_leaves_no_residual);
    RUN_TEST(test_k_follows_the_parameters_in_every_equation);
    RUN_TEST(test_k_takes_the_place_of_a_parameter_that_is_not_free);
    RUN_TEST(test_a_cell_gets_the_force_of_its_time);
    RUN_TEST(test_the_newest_changes_are_kept);
    RUN_TEST(test_an_unsuitable_model_is_refused);
    RUN_TEST(test_a_wrong_force_is_refused);
    RUN_TEST(test_the_conversion_is_bayes_rule_and_the_delta_rule);
    RUN_TEST(test_a_prior_that_the_data_contradict_is_widened);
    RUN_TEST(test_flags_follow_the_half_width_in_si);
    RUN_TEST(test_data_that_hardly_show_the_scale_do_not_convert);
    RUN_TEST(test_without_a_known_force_the_estimate_stays);
    RUN_TEST(test_estimates_that_cannot_be_converted_are_refused);
    RUN_TEST(test_a_force_in_another_unit_is_refused);
    RUN_TEST(test_a_mass_in_si_below_the_dry_mass_refutes_the_force);
    RUN_TEST(test_a_weight_corrects_thrust_that_is_told_20_percent_too_strong);
    RUN_TEST(test_a_pull_calibrates_the_thrusters_of_its_axis);
    RUN_TEST(test_a_weight_that_never_changes_is_not_separable_from_the_trim);
    return UNITY_END();
}
