/**
 * @file auvid_input_internal.h
 * Private: the samples of auvid_input_t by number. Those of navigation have the numbers of
 * auvid_nav_sensor_t; see auvid_sensors_internal.h.
 */
#ifndef AUVID_INPUT_INTERNAL_H
#define AUVID_INPUT_INTERNAL_H

#include "auvid/identifier.h"

/** The altitude is the guard's. */
enum { AUVID_INPUT_ALTITUDE = AUVID_NAV_SENSOR_COUNT, AUVID_INPUT_SAMPLES };

/** How the member of each sensor begins; `value` has as many elements as the sensor has axes. */
typedef struct {
    bool present;
    uint64_t t_us;
    auvid_real_t value[3];
} auvid_input_sample_t;

/** Place of a sample. */
typedef struct {
    uint32_t event; /* AUVID_EVENT_..., if it is rejected */
    uint16_t at;    /* offset of the member in auvid_input_t */
    uint8_t values;
} auvid_input_place_t;

extern const auvid_input_place_t auvid_input_places[AUVID_INPUT_SAMPLES];

/** Address of a member of sample i, in place: most ticks have one sample or none. */
#define INPUT_AT(in, i, member)                                                                    \
    ((const void *)((const unsigned char *)(in) + auvid_input_places[i].at +                       \
                    offsetof(auvid_input_sample_t, member)))

static inline bool auvid_input_has(const auvid_input_t *in, int i)
{
    const bool *present = INPUT_AT(in, i, present);
    return *present;
}

/** Write a sample. Lock and valid axes of a DVL are left as they are. */
void auvid_input_set(auvid_input_t *in, int i, const auvid_input_sample_t *sample);

#endif
