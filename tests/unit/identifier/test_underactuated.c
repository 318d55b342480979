/*
 * Vehicles without lateral thruster: coupling with surge and yaw moves sway. Its equation has no
 * wrench of its own, and is identified where it determines its parameters.
 */
#include <stdio.h>

#include "binomial.h"
#include "underactuated.h"
#include "unity.h"

#define SWAY (1u << AUVID_G500_M_V | 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV)

static const under_world_t calm = {.disturbance_N = 0.3};

void setUp(void)
{
}

void tearDown(void)
{
}

static bool is_sway_flagged(void)
{
    return (under_id.estimate.confidence.identifiable & SWAY) == SWAY;
}

static int wrong_flags(const under_vehicle_t *vehicle)
{
    int wrong = 0;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        bool flagged = (under_id.estimate.confidence.identifiable >> i & 1u) != 0;
        wrong += flagged && under_is_wrong(vehicle, i);
    }
    return wrong;
}

/* Does a sentence on what is missing begin like this? */
static bool is_missing(const char *sentence)
{
    char text[160];
    for (unsigned k = 0;
         auvid_confidence_missing(&under_id.estimate.confidence, &auvid_girona500,
                                  under_id.metric.cfg.free, k, text, sizeof text) == AUVID_OK;
         ++k) {
        if (strncmp(text, sentence, strlen(sentence)) == 0) {
            return true;
        }
    }
    return false;
}

static void test_turns_of_a_surface_craft_identify_its_sway(void)
{
    for (uint64_t seed = 1; seed <= campaign_runs(4); ++seed) {
        under_identify(&under_craft, &calm, seed);
        const auvid_estimate_t *e = &under_id.estimate;
        TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SURGE | 1u << AUVID_YAW, e->excited);
        TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SWAY, e->coupled);
        TEST_ASSERT_EQUAL_HEX32(SWAY, e->identified & SWAY);
        TEST_ASSERT_TRUE(is_sway_flagged());
        TEST_ASSERT_EQUAL_INT(0, wrong_flags(&under_craft));
        TEST_ASSERT_TRUE(e->r2_force[AUVID_SWAY] > AUVID_C(0.99));
        TEST_ASSERT_FALSE(is_missing("sway"));
    }
}

static void test_the_drag_force_of_an_unactuated_dof_is_known(void)
{
    auvid_drag_t drag;
    under_identify(&under_craft, &calm, 1);
    auvid_real_t speed = AUVID_C(0.6) * under_id.estimate.speed[AUVID_SWAY][0];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(&under_id.estimate, &auvid_girona500,
                                                    AUVID_SWAY, speed, &drag));
    double v = (double)speed;
    double truth = under_craft.hull[SIM_Y_V] * v + under_craft.hull[SIM_Y_VV] * v * v;
    TEST_ASSERT_TRUE(v > 0.05 && drag.identifiable);
    TEST_ASSERT_DOUBLE_WITHIN((double)drag.half_width, truth, (double)drag.force);
}

/* Sway has other columns when its drag is not free, but surge and yaw must not see that. */
static void test_an_unactuated_dof_does_not_change_the_estimates_of_the_others(void)
{
    under_vehicle_t without = under_craft;
    under_identify(&under_craft, &calm, 3);
    auvid_estimate_t with = under_id.estimate;
    without.free &= ~(1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV);
    under_identify(&without, &calm, 3);
    TEST_ASSERT_EQUAL_HEX8(0, under_id.estimate.coupled);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        if ((without.free >> i & 1u) != 0) {
            TEST_ASSERT_EQUAL_MEMORY(&with.pi[i], &under_id.estimate.pi[i], sizeof with.pi[i]);
        }
    }
}

static void test_the_sway_of_a_craft_without_turns_is_called_unactuated(void)
{
    static const under_world_t straight = {.straight = true};
    under_identify(&under_craft, &straight, 1);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SURGE, under_id.estimate.excited);
    TEST_ASSERT_EQUAL_HEX8(0, under_id.estimate.coupled);
    TEST_ASSERT_EQUAL_HEX32(0, under_id.estimate.confidence.identifiable & SWAY);
    TEST_ASSERT_EQUAL_HEX32(0, under_id.estimate.identified & SWAY);
    TEST_ASSERT_TRUE(is_missing("sway: unactuated"));
    char note[32];
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_note(&under_id.estimate.confidence, &auvid_girona500,
                                            AUVID_G500_Y_V, note, sizeof note));
    TEST_ASSERT_EQUAL_STRING("unactuated", note);
}

static void test_a_torpedo_whose_side_force_is_supplied_has_no_wrong_flag(void)
{
    for (uint64_t seed = 1; seed <= campaign_runs(4); ++seed) {
        under_identify(&under_torpedo, &calm, seed);
        TEST_ASSERT_EQUAL_INT(0, wrong_flags(&under_torpedo));
        TEST_ASSERT_TRUE(is_sway_flagged());
    }
}

/* Sway contradicts surge and yaw, which stay as they are. */
static void test_a_side_force_that_is_not_supplied_is_noticed(void)
{
    static const under_world_t untold = {.disturbance_N = 0.3, .untold_side_force = true};
    for (uint64_t seed = 1; seed <= campaign_runs(4); ++seed) {
        under_identify(&under_torpedo, &untold, seed);
        TEST_ASSERT_EQUAL_INT(0, wrong_flags(&under_torpedo));
        TEST_ASSERT_EQUAL_HEX32(0, under_id.estimate.confidence.identifiable & SWAY);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * under_torpedo.hull[SIM_M_U], under_torpedo.hull[SIM_M_U],
                                  (double)under_id.estimate.pi[AUVID_G500_M_U]);
        TEST_ASSERT_TRUE(is_missing("sway: unactuated"));
    }
}

/* ---- campaign ---- */

typedef struct {
    const char *name;
    under_world_t world;
    double min_flagged; /* share of runs in which sway is flagged */
    bool may_be_wrong;  /* only printed */
} under_case_t;

static void run_case(const under_vehicle_t *vehicle, const under_case_t *of, uint32_t runs)
{
    uint32_t sway = 0, flags = 0, wrong = 0, wrong_runs = 0;
    for (uint64_t seed = 1001; seed < 1001 + runs; ++seed) {
        under_identify(vehicle, &of->world, seed);
        uint32_t wrong_now = (uint32_t)wrong_flags(vehicle);
        sway += is_sway_flagged();
        wrong += wrong_now;
        wrong_runs += wrong_now > 0;
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            flags += under_id.estimate.confidence.identifiable >> i & 1u;
        }
    }
    printf("  %-8s %-34s sway flagged %3u of %u  wrong %u of %u flags; runs with a wrong one "
           "<= %.1f %% (95 %%)\n",
           vehicle->name, of->name, sway, runs, wrong, flags,
           100.0 * binomial_upper(wrong_runs, runs, 0.05));
    TEST_ASSERT_TRUE((double)sway >= of->min_flagged * runs);
    TEST_ASSERT_TRUE(of->may_be_wrong || wrong == 0);
}

static void test_campaign_flags_sway_and_nothing_wrong(void)
{
    static const under_case_t perfect[] = {
        {"no disturbance", {.disturbance_N = 0.0}, 0.5, false},
        {"0.3 N", {.disturbance_N = 0.3}, 0.5, false},
        {"1 N", {.disturbance_N = 1.0}, 0.0, false},
    };
    static const under_case_t mismatched[] = {
        {"0.3 N, side force not supplied", {.disturbance_N = 0.3, .untold_side_force = true}, 0, 1},
        {"0.3 N, thruster lag 0.15 s", {.disturbance_N = 0.3, .lag_s = 0.15}, 0, true},
        {"0.3 N, thrust 5 % weaker", {.disturbance_N = 0.3, .thrust_gain = -0.05}, 0, true},
        {"0.3 N, DVL turned by 0.5 deg", {.disturbance_N = 0.3, .dvl_yaw_rad = 0.0087}, 0, true},
        {"0.3 N, DVL turned by 1 deg", {.disturbance_N = 0.3, .dvl_yaw_rad = 0.0175}, 0, true},
        {"0.3 N, DVL 2 cm ahead", {.disturbance_N = 0.3, .dvl_arm_m = 0.02}, 0, true},
        {"0.3 N, DVL 5 cm ahead", {.disturbance_N = 0.3, .dvl_arm_m = 0.05}, 0, true},
        {"0.3 N, DVL 5 cm astern", {.disturbance_N = 0.3, .dvl_arm_m = -0.05}, 0, true},
        {"0.3 N, current 3 cm/s", {.disturbance_N = 0.3, .current_m_s = 0.03}, 0, true},
    };
    static const under_vehicle_t *const vehicle[] = {&under_craft, &under_torpedo};
    uint32_t runs = campaign_is_long() ? 100 : 2;
    for (size_t v = 0; v < 2; ++v) {
        for (size_t k = 0; k < sizeof perfect / sizeof perfect[0]; ++k) {
            run_case(vehicle[v], &perfect[k], runs);
        }
        for (size_t k = 0; k < sizeof mismatched / sizeof mismatched[0]; ++k) {
            if (campaign_is_long()) {
                run_case(vehicle[v], &mismatched[k], runs);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_turns_of_a_surface_craft_identify_its_sway);
    RUN_TEST(test_the_drag_force_of_an_unactuated_dof_is_known);
    RUN_TEST(test_an_unactuated_dof_does_not_change_the_estimates_of_the_others);
    RUN_TEST(test_the_sway_of_a_craft_without_turns_is_called_unactuated);
    RUN_TEST(test_a_torpedo_whose_side_force_is_supplied_has_no_wrong_flag);
    RUN_TEST(test_a_side_force_that_is_not_supplied_is_noticed);
    RUN_TEST(test_campaign_flags_sway_and_nothing_wrong);
    return UNITY_END();
}
