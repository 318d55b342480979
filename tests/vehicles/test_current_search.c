/* Tests that the search finds the optimum of a hull in a current: 15 parameters and the delay, not
 * linear. The oracle computes the same cost over the stored rows (metric_config.h) in double, from
 * Eq. 12-15 in moving water. It minimises it by Levenberg-Marquardt from many starts, at the delay
 * found. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metric/auvid_metric_evaluator_internal.h"
#include "binomial.h"
#include "finish.h"
#include "unity.h"
#include "current_world.h"

enum { SETS = 8, SET_ROWS = 60, HULL = 13, N = HULL + 2, NORTH = AUVID_G500_COUNT, DOFS = 4 };
enum { BUDGET = 1000 }; /* with less a search takes longer than a set, and rows are dropped */
enum { ROWS = SETS * SET_ROWS, TERMS = DOFS * ROWS, STARTS = 8 };

static auvid_row_t store[(SETS + 1) * SET_ROWS];
static auvid_current_t current;
static world_t world;
static const auvid_identifier_t *id;

/* The oracle's data. */
static double motion[ROWS][3 + 6 + 6]; /* attitude, nu, nu_dot */
static double tau[ROWS][DOFS];
static uint64_t t_us[ROWS];
static int rows;

static double term[TERMS], slope[N][TERMS];

void setUp(void)
{
}

void tearDown(void)
{
}

static void identify(uint64_t seed, const double c[2])
{
    const world_config_t config = {
        .seed = seed, .disturbance_N = 1.0, .sets = SETS, .current = {c[0], c[1]}};
    begin_current_world(&world, &config, &current, store);
    id = &world.node[1].id;
    while (id->metric.sets.recorded < SETS && world_time_s(&world) < 600.0) {
        world_tick(&world);
        (void)world_work(&world, BUDGET);
    }
    finish_work(&world.node[1].id, BUDGET);
    TEST_ASSERT_EQUAL_UINT32(SETS, id->estimate.sets);
    TEST_ASSERT_FALSE(id->estimate.not_converged);
}

/* Copies the stored rows, oldest first, with their wrench at the delay (a parabola through three).
 * */
static void take_rows(void)
{
    static const int dof[DOFS] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    double s = (double)id->work.delay_s / 0.3;
    const double l[3] = {0.5 * (s - 1.0) * (s - 2.0), s * (2.0 - s), 0.5 * s * (s - 1.0)};
    rows = 0;
    for (int age = SETS - 1; age >= 0; --age) {
        const auvid_row_t *row = auvid_metric_rows(&id->metric, age);
        for (int k = 0; k < SET_ROWS; ++k, ++row, ++rows) {
            const auvid_sample_t *sample = &row->sample;
            t_us[rows] = sample->t_us;
            motion[rows][0] = (double)sample->phi;
            motion[rows][1] = (double)sample->theta;
            motion[rows][2] = (double)sample->psi;
            for (int j = 0; j < 6; ++j) {
                motion[rows][3 + j] = (double)sample->nu[j];
                motion[rows][9 + j] = (double)sample->nu_dot[j];
            }
            for (int j = 0; j < DOFS; ++j) {
                tau[rows][j] = l[0] * (double)sample->tau[dof[j]] +
                               l[1] * (double)row->late[0][dof[j]] +
                               l[2] * (double)row->late[1][dof[j]];
            }
        }
    }
}

/* Eq. 12-15 with velocity and acceleration through the water, minus the wrench. */
static void residual(int k, const double *p, double e[DOFS])
{
    const double *angle = motion[k], *nu = motion[k] + 3, *nu_dot = motion[k] + 9;
    double r[3][3], c[3], a[3], v[3];
    sim_rotation(angle, r);
    for (int i = 0; i < 3; ++i) {
        c[i] = r[0][i] * p[HULL] + r[1][i] * p[HULL + 1];
        v[i] = nu[i] - c[i];
    }
    a[0] = nu_dot[0] + nu[4] * c[2] - nu[5] * c[1];
    a[1] = nu_dot[1] + nu[5] * c[0] - nu[3] * c[2];
    a[2] = nu_dot[2] + nu[3] * c[1] - nu[4] * c[0];
    e[0] = p[0] * a[0] - p[1] * v[1] * nu[5] + p[2] * v[2] * nu[4] + p[4] * sin(angle[1]) -
           p[5] * v[0] - p[6] * fabs(v[0]) * v[0];
    e[1] = p[1] * a[1] - p[2] * v[2] * nu[3] + p[0] * v[0] * nu[5] -
           p[4] * cos(angle[1]) * sin(angle[0]) - p[7] * v[1] - p[8] * fabs(v[1]) * v[1];
    e[2] = p[2] * a[2] - p[0] * v[0] * nu[4] + p[1] * v[1] * nu[3] -
           p[4] * cos(angle[1]) * cos(angle[0]) - p[9] * v[2] - p[10] * fabs(v[2]) * v[2];
    e[3] = p[3] * nu_dot[5] - (p[0] - p[1]) * v[0] * v[1] - p[11] * nu[5] -
           p[12] * fabs(nu[5]) * nu[5];
    for (int j = 0; j < DOFS; ++j) {
        e[j] -= tau[k][j];
    }
}

/* Computes the cost's terms: residuals smoothed by binomial weights over 7 rows, within each
 * sequence of consecutive rows. Returns J. */
static double cost(const double *p, double *terms)
{
    static const double binomial[7] = {1, 6, 15, 20, 15, 6, 1}, scale[DOFS] = {100, 100, 100, 40};
    static double e[ROWS][DOFS];
    double sum = 0.0;
    int run = 0;
    for (int k = 0; k < rows; ++k) {
        residual(k, p, e[k]);
        bool follows = k > 0 && llabs((long long)(t_us[k] - t_us[k - 1]) - 500000) < 60000;
        run = follows ? run + 1 : 1;
        for (int j = 0; j < DOFS; ++j) {
            double smooth = 0.0;
            for (int i = 0; i < 7 && run >= 7; ++i) {
                smooth += binomial[i] / 64.0 * e[k - i][j];
            }
            terms[DOFS * k + j] = smooth / (scale[j] * sqrt((double)rows));
            sum += terms[DOFS * k + j] * terms[DOFS * k + j];
        }
    }
    return sum;
}

/* Solves a x = b by Cholesky, a symmetric positive. Overwrites a; b is x on return. */
static void solve(double a[N][N], double b[N])
{
    for (int i = 0; i < N; ++i) {
        for (int k = 0; k <= i; ++k) {
            double sum = a[i][k];
            for (int m = 0; m < k; ++m) {
                sum -= a[i][m] * a[k][m];
            }
            a[i][k] = i == k ? sqrt(sum) : sum / a[k][k];
        }
    }
    for (int i = 0; i < N; ++i) {
        for (int m = 0; m < i; ++m) {
            b[i] -= a[i][m] * b[m];
        }
        b[i] /= a[i][i];
    }
    for (int i = N - 1; i >= 0; --i) {
        for (int m = i + 1; m < N; ++m) {
            b[i] -= a[m][i] * b[m];
        }
        b[i] /= a[i][i];
    }
}

/* Minimises from p by Levenberg-Marquardt, within the bounds of the signs. Returns J. */
static double optimise(double *p)
{
    double damping = 1e-3, best = cost(p, term);
    for (int round = 0; round < 60; ++round) {
        double a[N][N], b[N], next[N];
        for (int i = 0; i < N; ++i) {
            double h = i < HULL ? 1e-3 : 1e-6, kept = p[i];
            p[i] = kept + h;
            (void)cost(p, slope[i]);
            p[i] = kept;
            for (int k = 0; k < DOFS * rows; ++k) {
                slope[i][k] = (slope[i][k] - term[k]) / h;
            }
        }
        for (int i = 0; i < N; ++i) {
            b[i] = 0.0;
            for (int k = 0; k < DOFS * rows; ++k) {
                b[i] -= slope[i][k] * term[k];
            }
            for (int m = 0; m <= i; ++m) {
                a[i][m] = 0.0;
                for (int k = 0; k < DOFS * rows; ++k) {
                    a[i][m] += slope[i][k] * slope[m][k];
                }
            }
            a[i][i] *= 1.0 + damping;
        }
        solve(a, b);
        for (int i = 0; i < N; ++i) {
            next[i] = p[i] + b[i];
        }
        double found = cost(next, term);
        if (found < best) {
            bool settled = best - found < 1e-9 * best;
            memcpy(p, next, sizeof next);
            best = found;
            damping *= 0.2;
            if (settled) {
                break;
            }
        } else {
            damping *= 10.0;
            (void)cost(p, term);
        }
    }
    return best;
}

/* Returns the best of many starts: masses and drags 0.3 to 2 times the truth, c up to 1 m/s. */
static double oracle(uint64_t seed, double *best_p, int *reached)
{
    double best = INFINITY, all[STARTS];
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 7);
    for (int start = 0; start < STARTS; ++start) {
        double p[N];
        for (int i = 0; i < HULL; ++i) {
            p[i] = world.vehicle_sim.sim.cfg.parameter[i] * (0.3 + 1.7 * sim_rng_uniform(&rng));
        }
        p[HULL] = 2.0 * sim_rng_uniform(&rng) - 1.0;
        p[HULL + 1] = 2.0 * sim_rng_uniform(&rng) - 1.0;
        all[start] = optimise(p);
        if (all[start] < best) {
            best = all[start];
            memcpy(best_p, p, sizeof p);
        }
    }
    *reached = 0;
    for (int start = 0; start < STARTS; ++start) {
        *reached += all[start] < best * 1.001;
    }
    return best;
}

static void test_the_search_finds_the_optimum_of_levenberg_marquardt_from_many_starts(void)
{
    int seeds = campaign_is_long() ? 20 : 2;
    for (uint64_t seed = 1; seed <= (uint64_t)seeds; ++seed) {
        const double c[2] = {0.3 * cos(2.4 * (double)seed), 0.3 * sin(2.4 * (double)seed)};
        double p[N], best_p[N] = {0.0};
        int reached;
        identify(seed, c);
        take_rows();
        for (int i = 0; i < N; ++i) {
            p[i] = (double)id->estimate.pi[i < HULL ? i : NORTH + i - HULL];
        }
        double found = cost(p, term), best = oracle(seed, best_p, &reached);
        printf("seed %d: excess cost %.1e of the residual, %d of %d starts of the oracle there, "
               "%u + %u evaluations\n",
               (int)seed, found / best - 1.0, reached, STARTS,
               (unsigned)id->estimate.evaluations_crs, (unsigned)id->estimate.evaluations_line);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * found, found, (double)id->estimate.cost);
        TEST_ASSERT_TRUE(found < best * 1.001);
        for (int i = 0; i < N; ++i) { /* within 1 % of a parameter, or 1 mm/s */
            TEST_ASSERT_DOUBLE_WITHIN(i < HULL ? 0.01 * fabs(best_p[i]) : 1e-3, best_p[i], p[i]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_search_finds_the_optimum_of_levenberg_marquardt_from_many_starts);
    return UNITY_END();
}
