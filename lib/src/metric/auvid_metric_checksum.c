/*
 * Metric: the checksum of its model, for records in non-volatile memory.
 */
#include "../base/auvid_checksum_internal.h"
#include "../base/auvid_math_internal.h"
#include "auvid_metric_internal.h"

/* Checksum of a string with its terminating zero. */
static uint32_t metric_checksum_name(uint32_t c, const char *name)
{
    const uint8_t none = 0;
    for (; name != NULL && *name != '\0'; ++name) { /* a model may have no name */
        uint8_t letter = (uint8_t)*name;
        c = auvid_checksum(c, &letter, 1);
    }
    return auvid_checksum(c, &none, 1);
}

uint32_t auvid_checksum_of_model(const auvid_metric_config_t *cfg)
{
    const auvid_vehicle_t *vehicle = cfg->vehicle;
    uint32_t all = UINT32_MAX >> (32 - vehicle->parameters);
    uint32_t free = cfg->free == 0 ? all : cfg->free & all,
             c = metric_checksum_name(UINT32_MAX, vehicle->name);
    for (int i = 0; i < vehicle->parameters; ++i) {
        c = metric_checksum_name(metric_checksum_name(c, vehicle->parameter[i].name),
                                 vehicle->parameter[i].unit);
        c = auvid_checksum_word(c, free >> i & 1u ? 0u : auvid_single_bits(cfg->fixed[i]));
    }
    return auvid_checksum_word(c, free);
}
