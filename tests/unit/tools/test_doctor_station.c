/* The log doctor on a vehicle that keeps its station: the inputs follow the motion and explain
 * little of it, so neither a lag nor a mass follows from them. */
#include "doctor_log.h"

void setUp(void)
{
    memset(rows, 0, sizeof rows);
    memset(has, 0, sizeof has);
    for (int c = CSV_T; c < CSV_COMMAND; ++c) {
        has[c] = true;
    }
}

void tearDown(void)
{
}

/* A vehicle of 3 kg that holds surge and heave against waves and turns to headings: a controller of
 * position and velocity, thrusters with a lag, sensors with noise. */
static void keep_station(uint64_t seed)
{
    static const double m[6] = {4.7, 6, 7, 1, 1, 0.065}, drag[6] = {1.5, 2.5, 2.5, 1, 1, 0.05},
                        stiff[6] = {8, 0, 4, 0, 0, 1.0}, damp[6] = {10, 0, 6, 0, 0, 0.7},
                        wave[6] = {0.3, 0.1, 0.3, 0, 0, 0.003},
                        noise[6] = {0.004, 0.004, 0.004, 0, 0, 0.002};
    double x[6] = {0}, v[6] = {0}, force[6] = {0}, push[6] = {0}, heading = 0.0;
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 1);
    for (int k = 0; k < ROWS; ++k) {
        double *row = rows[k].value;
        if (k % 300 == 0) {
            heading = sim_rng_uniform(&rng) - 0.5;
        }
        row[CSV_T] = STEP_S * k;
        row[CSV_ATTITUDE + 2] = x[5];
        for (int j = 0; j < 6; ++j) {
            double seen = v[j] + noise[j] * sim_rng_gauss(&rng);
            double want = stiff[j] * (j == 5 ? heading - x[j] : -x[j]) - damp[j] * v[j];
            row[CSV_NU + j] = j < 3 && k % 10 != 0 ? (double)NAN : seen; /* a DVL of 5 Hz */
            row[CSV_WRENCH + j] = want;
            force[j] += (want - force[j]) * STEP_S / 0.1;
            push[j] += -push[j] * STEP_S / 2.0 + wave[j] * sqrt(STEP_S) * sim_rng_gauss(&rng);
            v[j] += STEP_S * (force[j] + push[j] - drag[j] * v[j]) / m[j];
            x[j] += STEP_S * v[j];
        }
        row[CSV_POSITION + 2] = 5.0 + x[2];
    }
}

static void test_neither_a_late_dvl_nor_large_forces_follow_from_station_keeping(void)
{
    for (uint64_t seed = 1; seed <= 8; ++seed) {
        keep_station(seed);
        doctor_init(&doctor, has);
        doctor_dry_mass(&doctor, 3.2, false);
        for (int k = 0; k < ROWS; ++k) {
            doctor_feed(&doctor, &rows[k]);
        }
        doctor_finish(&doctor);
        const doctor_finding_t *late = finding(DOCTOR_VELOCITY_SHIFT),
                               *large = finding(DOCTOR_SCALE);
        TEST_ASSERT_NULL_MESSAGE(late, late != NULL ? late->text : "");
        TEST_ASSERT_NULL_MESSAGE(large, large != NULL ? large->text : "");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_neither_a_late_dvl_nor_large_forces_follow_from_station_keeping);
    return UNITY_END();
}
