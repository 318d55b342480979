/**
 * @file field_identify.h
 * Shared by the tests of uncertain inputs: an identification in the field simulator. Prepare it,
 * choose its mismatches, identify.
 */
#ifndef FIELD_IDENTIFY_H
#define FIELD_IDENTIFY_H

#include "auvid/uncertain.h"
#include "field/field_run.h"
#include "unity.h"

static field_run_t run;
static field_run_config_t field;
static field_record_t record;

static inline void prepare(field_vehicle_t vehicle, field_driver_t driver, uint64_t seed)
{
    field_run_defaults(&field);
    field_defaults(&field.field, vehicle, driver, seed);
}

static inline void choose(const char *name, double size)
{
    TEST_ASSERT_TRUE_MESSAGE(field_set(&field.field, name, size), name);
}

static inline void identify(void)
{
    TEST_ASSERT_TRUE(field_run(&run, &field, &record));
}

/* Relative to the truth. */
static inline double error(int i)
{
    return record.pi[i] / record.truth.si[i] - 1.0;
}

#endif
