/*
 * Sensors of the simulated vehicle that hang: they send their last values again, on time. The
 * excitation ends, whichever of them it is.
 */
#include "identifier_guard.h"

typedef enum { HUNG_DVL, HUNG_RATES, HUNG_ATTITUDE, HUNG_DEPTH } hung_t;

static hung_t hung;
static auvid_input_t last;

static void hang(chain_t *c, auvid_input_t *in)
{
    spoil(c, in);
    bool hangs = c->t_us > (uint64_t)(1e6 * BEFORE_S);
    if (in->imu.present && hangs && hung == HUNG_RATES) {
        memcpy(in->imu.rates, last.imu.rates, sizeof in->imu.rates);
    } else if (in->imu.present && hangs && hung == HUNG_ATTITUDE) {
        memcpy(in->imu.attitude, last.imu.attitude, sizeof in->imu.attitude);
        memcpy(in->imu.quaternion, last.imu.quaternion, sizeof in->imu.quaternion);
    } else if (in->dvl.present && hangs && hung == HUNG_DVL) {
        memcpy(in->dvl.sample.velocity, last.dvl.sample.velocity, sizeof in->dvl.sample.velocity);
    } else if (in->depth.present && hangs && hung == HUNG_DEPTH) {
        in->depth.depth_m = last.depth.depth_m;
    }
    last.imu = in->imu.present ? in->imu : last.imu;
    last.dvl = in->dvl.present ? in->dvl : last.dvl;
    last.depth = in->depth.present ? in->depth : last.depth;
}

static void check_hung(hung_t sensor, auvid_guard_cause_t cause, double within_s)
{
    hung = sensor;
    cfg.before = hang;
    begin();
    (void)check_aborts(cause, within_s);
}

static void test_a_hung_dvl_ends_the_excitation(void)
{
    check_hung(HUNG_DVL, AUVID_GUARD_VELOCITY_STALE, 4);
}

static void test_hung_rates_end_the_excitation(void)
{
    check_hung(HUNG_RATES, AUVID_GUARD_IMU_STALE, 4);
}

static void test_a_hung_attitude_ends_the_excitation(void)
{
    check_hung(HUNG_ATTITUDE, AUVID_GUARD_IMU_STALE, 20);
}

static void test_a_hung_depth_ends_the_excitation(void)
{
    check_hung(HUNG_DEPTH, AUVID_GUARD_DEPTH_STALE, 20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hung_dvl_ends_the_excitation);
    RUN_TEST(test_hung_rates_end_the_excitation);
    RUN_TEST(test_a_hung_attitude_ends_the_excitation);
    RUN_TEST(test_a_hung_depth_ends_the_excitation);
    return UNITY_END();
}
