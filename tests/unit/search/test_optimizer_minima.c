/*
 * Functions of the literature with many minima: how often each form of the search finds the global
 * one. `paper` is Algorithms 1 and 2 to the letter. The default search knows nothing. It may know a
 * local minimum, as from Gauss-Newton steps: as a point of its population (a model that is not
 * declared smooth), or as a certificate (a smooth one). A certificate of a local minimum ends the
 * search unless a random point is better; so it finds the global one less often, which vehicle.h
 * says. 20 seeds; with AUVID_TEST_LONG in the environment 200 others.
 *
 * The boxes are shifted, so that no global minimum is in the middle. Costs are divided by a typical
 * value.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/detail/optimizer.h"
#include "binomial.h"
#include "finish.h"
#include "unity.h"

static const double pi = 3.14159265358979;
static auvid_optimizer_t optimizer;

void setUp(void)
{
}

void tearDown(void)
{
}

static double rastrigin(const double *x, int n)
{
    double sum = 10.0 * n;
    for (int i = 0; i < n; ++i) {
        sum += x[i] * x[i] - 10.0 * cos(2.0 * pi * x[i]);
    }
    return sum;
}

static double ackley(const double *x, int n)
{
    double square = 0.0, wave = 0.0;
    for (int i = 0; i < n; ++i) {
        square += x[i] * x[i] / n;
        wave += cos(2.0 * pi * x[i]) / n;
    }
    return 20.0 + exp(1.0) - 20.0 * exp(-0.2 * sqrt(square)) - exp(wave);
}

static double griewank(const double *x, int n)
{
    double sum = 1.0, product = 1.0;
    for (int i = 0; i < n; ++i) {
        sum += x[i] * x[i] / 4000.0;
        product *= cos(x[i] / sqrt(i + 1.0));
    }
    return sum - product;
}

/* 18 global minima of -186.73091 */
static double shubert(const double *x, int n)
{
    double product = 1.0;
    for (int i = 0; i < n; ++i) {
        double sum = 0.0;
        for (int k = 1; k <= 5; ++k) {
            sum += k * cos((k + 1) * x[i] + k);
        }
        product *= sum;
    }
    return 186.73091 + product;
}

/* Three global minima of 0.397887 */
static double branin(const double *x, int n)
{
    (void)n;
    double y = x[1] - 5.1 / (4.0 * pi * pi) * x[0] * x[0] + 5.0 / pi * x[0] - 6.0;
    return y * y + 10.0 * (1.0 - 1.0 / (8.0 * pi)) * cos(x[0]) + 10.0 - 0.397887;
}

typedef struct {
    const char *name;
    double (*value)(const double *x, int n); /* minimum 0 */
    int n;
    double low, high, typical, reached; /* costs below `reached` are those of a global minimum */
} function_t;

static const function_t functions[] = {
    {"Rastrigin", rastrigin, 3, -4.1, 6.1, 50.0, 0.1},
    {"Ackley", ackley, 3, -20.0, 35.0, 20.0, 0.1},
    {"Griewank", griewank, 2, -40.0, 60.0, 1.0, 0.003},
    {"Shubert", shubert, 2, -10.0, 10.0, 200.0, 1.0},
    {"Branin", branin, 2, -5.0, 15.0, 50.0, 0.01},
};
enum { FUNCTIONS = sizeof functions / sizeof functions[0] };

typedef enum { PAPER, DEFAULT, KNOWN_POINT, CERTIFIED, FORMS } form_t;
static const char *const form_name[FORMS] = {"paper", "default", "known point", "certificate"};

static auvid_real_t evaluate(const function_t *f, const auvid_real_t *theta)
{
    double x[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < f->n; ++i) {
        x[i] = (double)theta[i];
    }
    return (auvid_real_t)(f->value(x, f->n) / f->typical);
}

/* Run the optimizer to its end. @return the lowest cost; theta[] its point */
static auvid_real_t run(const function_t *f, auvid_real_t *theta, uint32_t *evaluations)
{
    auvid_real_t cost = 0;
    for (uint32_t turns = 0;;) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        finish_turn(&turns, 10000000);
        if (status == AUVID_OK) {
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_tell(&optimizer, evaluate(f, theta)));
        } else if (status != AUVID_PENDING) {
            break;
        }
    }
    *evaluations += optimizer.work.crs + optimizer.work.line_search;
    memcpy(theta, auvid_optimizer_best(&optimizer, &cost), (size_t)f->n * sizeof *theta);
    return cost;
}

/* @return is it a global minimum? */
static bool search(const function_t *f, form_t form, uint64_t seed, uint32_t *evaluations)
{
    auvid_search_config_t cfg;
    auvid_real_t theta[AUVID_MAX_PARAMETERS], local = 0;
    auvid_search_defaults(&cfg, (uint8_t)f->n);
    cfg.seed = seed;
    cfg.population = (uint16_t)(20 * f->n);
    for (int i = 0; i < f->n; ++i) {
        cfg.lower[i] = (auvid_real_t)f->low;
        cfg.upper[i] = (auvid_real_t)f->high;
    }
    if (form >= KNOWN_POINT) { /* the local minimum that the middle of the box leads to */
        cfg.phases = AUVID_SEARCH_LOCAL;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, NULL));
        local = run(f, theta, evaluations);
    }
    cfg.phases = AUVID_SEARCH_BOTH;
    cfg.paper = form == PAPER;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, NULL));
    if (form == KNOWN_POINT) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_add_point(&optimizer, theta));
    } else if (form == CERTIFIED) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_certify(&optimizer, theta, local,
                                                                AUVID_C(1e-3) * local));
    }
    return (double)run(f, theta, evaluations) * f->typical < f->reached;
}

static void test_global_minima_are_found_nearly_as_often_as_by_the_paper(void)
{
    int seeds = campaign_is_long() ? 200 : 20, found[FORMS] = {0};
    int first = campaign_is_long() ? 100001 : 1;
    for (int k = 0; k < FUNCTIONS; ++k) {
        printf("%-10s", functions[k].name);
        for (int form = 0; form < FORMS; ++form) {
            uint32_t evaluations = 0;
            int count = 0;
            for (int seed = first; seed < first + seeds; ++seed) {
                count += search(&functions[k], (form_t)form, (uint64_t)seed, &evaluations);
            }
            found[form] += count;
            printf("  %s %d of %d, %.0f evaluations;", form_name[form], count, seeds,
                   (double)evaluations / seeds);
        }
        printf("\n");
    }
    printf("all: %d, %d, %d, %d of %d\n", found[PAPER], found[DEFAULT], found[KNOWN_POINT],
           found[CERTIFIED], seeds * FUNCTIONS);
    TEST_ASSERT_TRUE(10 * found[DEFAULT] >= 9 * found[PAPER]);
    TEST_ASSERT_TRUE(10 * found[KNOWN_POINT] >= 9 * found[PAPER]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_global_minima_are_found_nearly_as_often_as_by_the_paper);
    return UNITY_END();
}
