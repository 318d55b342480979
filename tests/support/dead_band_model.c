#include "dead_band_model.h"

#include <string.h>

const auvid_vehicle_t *dead_band_vehicle(void)
{
    return &vehicle;
}

void dead_band_bounds(auvid_real_t *lower, auvid_real_t *upper)
{
    memcpy(lower, low, sizeof low);
    memcpy(upper, high, sizeof high);
}

double dead_band_force(double command, double speed)
{
    auvid_real_t pi[PARAMETERS];
    (void)speed;
    for (int i = 0; i < PARAMETERS; ++i) {
        pi[i] = (auvid_real_t)truth[i];
    }
    return 2.0 * (double)thrust((auvid_real_t)command, pi);
}
