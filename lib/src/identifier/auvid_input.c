/*
 * The samples of the identifier's input, by number.
 */
#include "auvid_input_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../navigation/auvid_sensors_internal.h"

#define INPUT_BYTES(values)                                                                        \
    (offsetof(auvid_input_sample_t, value) + (values) * sizeof(auvid_real_t))
#define INPUT_PLACE(name, input, event, kind, axis, axes, config, noise_mm, surface, start)        \
    [AUVID_NAV_##name] = {AUVID_EVENT_##event##_DROPPED, offsetof(auvid_input_t, input), axes},
const auvid_input_place_t auvid_input_places[AUVID_INPUT_SAMPLES] = {
    [AUVID_INPUT_ALTITUDE] = {AUVID_EVENT_ALTITUDE_DROPPED, offsetof(auvid_input_t, altitude), 1},
    AUVID_SENSORS(INPUT_PLACE)};

#define INPUT_FITS(name, input, event, kind, axis, axes, config, noise_mm, surface, start)         \
    _Static_assert(sizeof((auvid_input_t){0}.input) >= INPUT_BYTES(axes), #name);
AUVID_SENSORS(INPUT_FITS)

void auvid_input_set(auvid_input_t *in, int i, const auvid_input_sample_t *sample)
{
    const auvid_input_place_t *place = &auvid_input_places[i];
    memcpy((unsigned char *)in + place->at, sample, INPUT_BYTES(place->values));
}
