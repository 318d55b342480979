/* The log of doctor_log.h with the inputs of single thrusters. */
#ifndef SUPPORT_DOCTOR_THRUSTER_LOG_H
#define SUPPORT_DOCTOR_THRUSTER_LOG_H

#include "doctor_log.h"
#include "vehicle/vehicles.h"

static log_use_t use;

/* The wrench as thrust of this vehicle, in newtons. */
static inline void to_thrusters_of(const vehicle_t *vehicle)
{
    auvid_allocation_t allocation;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, vehicle->allocation));
    for (int j = 0; j < 6; ++j) {
        has[CSV_WRENCH + j] = false;
    }
    for (int k = 0; k < ROWS; ++k) {
        auvid_real_t wrench[AUVID_DOF_COUNT];
        auvid_allocation_result_t result;
        for (int j = 0; j < 6; ++j) {
            wrench[j] = (auvid_real_t)rows[k].value[CSV_WRENCH + j];
            rows[k].value[CSV_WRENCH + j] = 0.0;
        }
        (void)auvid_allocation_solve(&allocation, wrench, &result);
        for (int i = 0; i < allocation.cfg.thrusters; ++i) {
            rows[k].value[CSV_THRUSTER_N + i] = (double)result.force_N[i];
            has[CSV_THRUSTER_N + i] = true;
        }
    }
    TEST_ASSERT_TRUE(log_use_thrusters(&use, vehicle, has));
}

static inline void to_thrusters(void)
{
    to_thrusters_of(vehicle_default());
}

static inline void examine_thrusters(void)
{
    doctor_init(&doctor, has);
    doctor_use(&doctor, &use);
    for (int k = 0; k < ROWS; ++k) {
        doctor_feed(&doctor, &rows[k]);
    }
    doctor_finish(&doctor);
}

#endif
