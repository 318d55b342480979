/*
 * The identifier's work with a user's model, without a regressor: it keeps to the budget and ends,
 * and the search keeps the rows with which it began.
 */
#include <math.h>
#include <string.h>

#include "finish.h"
#include "identifier_work.h"
#include "unity.h"

static chain_t recorded;

void setUp(void)
{
}

void tearDown(void)
{
}

enum { USER_M, USER_X_U, USER_X_UU, USER_PARAMETERS };

static const auvid_parameter_t user_parameter[USER_PARAMETERS] = {
    {"m", "kg", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_OTHER}};

/* It has no coupling, tilt and weight: only surge is excited. */
static uint32_t residual_calls;

static void user_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                          auvid_real_t *e)
{
    auvid_real_t u = s->nu[AUVID_SURGE], speed = u > 0 ? u : -u;
    (void)context;
    ++residual_calls;
    e[AUVID_SURGE] = pi[USER_M] * s->nu_dot[AUVID_SURGE] - pi[USER_X_U] * u -
                     pi[USER_X_UU] * speed * u - s->tau[AUVID_SURGE];
}

static void failing_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                             auvid_real_t *e)
{
    user_residual(context, s, pi, e);
    e[AUVID_SURGE] = (auvid_real_t)NAN;
}

static auvid_vehicle_t user_vehicle = {.built_for = AUVID_BUILD,
                                       .path = &auvid_path_residual,
                                       .name = "surge",
                                       .parameters = USER_PARAMETERS,
                                       .parameter = user_parameter,
                                       .columns = {[AUVID_SURGE] = 7},
                                       .residual = user_residual};

enum { USER_SETS = 2, USER_ROWS = 60 };
static auvid_row_t store[(USER_SETS + 1) * USER_ROWS];

static void configure_user(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 0};
    chain_defaults(&cfg, 9, USER_SETS, 0.0);
    auvid_excitation_config_t excitation = cfg.acting.excitation;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&excitation, amplitude, CHAIN_SET_S, USER_SETS, 9));
    auvid_identifier_defaults(&cfg.id, &user_vehicle);
    cfg.id.search.seed = 9;
    cfg.acting.excitation = excitation;
    cfg.id.metric.rows = store;
    cfg.id.metric.row_slots = sizeof store / sizeof store[0];
    cfg.id.metric.sets = USER_SETS;
    cfg.id.metric.set_rows = USER_ROWS;
}

/* As finish(). The user's function takes the time: a call of it is at least one unit. */
static void finish_counting(uint32_t budget, uint32_t units)
{
    uint32_t turns = 0;
    auvid_status_t status = AUVID_PENDING;
    while (status == AUVID_PENDING) {
        residual_calls = 0;
        finish_turn(&turns, units / budget + 1);
        status = auvid_identifier_work(&chain.id, budget);
        TEST_ASSERT_TRUE(chain.id.work.last_units <= budget);
        TEST_ASSERT_TRUE(residual_calls <= chain.id.work.last_units);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, status);
}

static void test_a_users_model_keeps_to_the_budget_and_ends(void)
{
    auvid_estimate_t once;
    configure_user();
    record(USER_SETS);
    recorded = chain; /* the rows stay in place: nothing is recorded from now on */
    for (int k = 0; k < BUDGETS; ++k) {
        chain = recorded;
        finish_counting(budgets[k], units_at_most(4, 16, USER_SETS * USER_ROWS));
        if (k == 0) {
            once = chain.id.estimate;
        }
        TEST_ASSERT_EQUAL_MEMORY(&once, &chain.id.estimate, sizeof once);
    }
    TEST_ASSERT_EQUAL_HEX32(7, once.identified);
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_SURGE, once.excited);
    TEST_ASSERT_FALSE(once.not_converged);
    TEST_ASSERT_DOUBLE_WITHIN(12.0, cfg.sim.parameter[SIM_M_U], (double)once.pi[USER_M]);
    TEST_ASSERT_TRUE(once.r2_force[AUVID_SURGE] > AUVID_C(0.98));
    TEST_ASSERT_TRUE((double)once.cost == cost_of(once.pi));
}

/* The rows that a search began with, and the index of those recorded meanwhile. */
static auvid_row_t began_rows[sizeof store / sizeof store[0]];

static void watch_rows(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    watch_t *w = c->cfg.context;
    const auvid_identifier_t *id = &c->id;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    w->drops += (out->events & AUVID_EVENT_ROWS_DROPPED) != 0;
    w->restored += (out->events & AUVID_EVENT_RESTORED) != 0;
    if (id->work.searches > w->begun) {
        w->begun = id->work.searches;
        w->newest = id->metric.sets.stored % (USER_SETS + 1) * USER_ROWS;
        memcpy(began_rows, store, sizeof store);
    }
    if (out->events & AUVID_EVENT_ESTIMATE) {
        ++w->ended;
        TEST_ASSERT_EQUAL_UINT32(w->begun, w->ended);
        for (uint32_t k = 0; k < sizeof store / sizeof store[0]; ++k) {
            if (k < w->newest || k >= w->newest + USER_ROWS) {
                TEST_ASSERT_EQUAL_MEMORY(&began_rows[k], &store[k], sizeof store[k]);
            }
        }
    }
}

static void test_rows_that_come_while_a_full_set_waits_are_dropped_and_counted(void)
{
    enum { LONG = 12 };
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 0};
    watch_t watch = {0};
    configure_user();
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, LONG, 9));
    cfg.budget = 1;
    cfg.after = watch_rows;
    cfg.context = &watch;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, LONG));
    uint32_t kept = chain.id.metric.sets.recorded * USER_ROWS + chain.id.metric.rows.set.rows;
    TEST_ASSERT_TRUE(watch.ended >= 1);
    TEST_ASSERT_TRUE(chain.id.metric.sets.recorded < LONG);
    TEST_ASSERT_EQUAL_UINT32(watch.drops, chain.id.metric.sets.rows_dropped);
    TEST_ASSERT_UINT32_WITHIN(2 * USER_ROWS / 10, LONG * USER_ROWS,
                              kept + chain.id.metric.sets.rows_dropped);
    finish(1000, 3 * units_at_most(4, 16, USER_SETS * USER_ROWS));
    watch.restored += (chain.id.events & AUVID_EVENT_RESTORED) != 0;
    TEST_ASSERT_EQUAL_UINT32(chain.id.work.searches + watch.restored, chain.id.estimate.number);
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
    TEST_ASSERT_DOUBLE_WITHIN(12.0, cfg.sim.parameter[SIM_M_U],
                              (double)chain.id.estimate.pi[USER_M]);
}

static void test_a_model_that_fails_everywhere_ends_and_is_reported(void)
{
    user_vehicle.residual = failing_residual;
    configure_user();
    record(USER_SETS);
    finish(7, units_at_most(4, 16, USER_SETS * USER_ROWS));
    user_vehicle.residual = user_residual;
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_TRUE(chain.id.estimate.not_converged);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)chain.id.estimate.r2_force[AUVID_SURGE]); /* no NaN */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_users_model_keeps_to_the_budget_and_ends);
    RUN_TEST(test_rows_that_come_while_a_full_set_waits_are_dropped_and_counted);
    RUN_TEST(test_a_model_that_fails_everywhere_ends_and_is_reported);
    return UNITY_END();
}
