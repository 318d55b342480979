/*
 * Averages a model's rows over the time of which its velocities are averages.
 *
 * The mean is over a time t with zero mean and variance s^2, at constant acceleration. To second
 * order, the mean of a row Y is that of the two-point Gauss-Hermite rule with these moments:
 *
 *     E Y(nu + t nu') = (Y(nu - s nu') + Y(nu + s nu')) / 2.
 *
 * Linear interpolation between samples T apart is a triangular kernel of variance T^2 / 6 (see
 * auvid_metric_regressor.c). The mean over a cell adds cell^2 / 12.
 */
#include "auvid/vehicle.h"

#include "../base/auvid_math_internal.h"

static void averaged_regressor(const void *context, const auvid_sample_t *sample,
                               const auvid_real_t *pi, auvid_regressor_t *y)
{
    const auvid_averaged_t *a = context;
    const auvid_vehicle_t *vehicle = a->other;
    auvid_sample_t moved = *sample;
    auvid_regressor_t later;
    auvid_clear(&later.row[0][0], sizeof later / sizeof later.row[0][0]);
    for (int side = 0; side < 2; ++side) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            auvid_real_t step = a->spread_s[j >= AUVID_ROLL] * sample->nu_dot[j];
            moved.nu[j] = sample->nu[j] + (side == 0 ? -step : step);
        }
        vehicle->regressor(vehicle->context, &moved, pi, side == 0 ? y : &later);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < a->vehicle.parameters; ++i) {
            y->row[j][i] = AUVID_C(0.5) * (y->row[j][i] + later.row[j][i]);
        }
    }
}

static bool averaged_acceleration(const void *context, const auvid_sample_t *sample,
                                  const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const auvid_vehicle_t *vehicle = ((const auvid_averaged_t *)context)->other;
    return vehicle->acceleration(vehicle->context, sample, pi, nu_dot);
}

auvid_status_t auvid_averaged_init(auvid_averaged_t *a, const auvid_vehicle_t *vehicle,
                                   uint32_t cell_us, uint32_t velocity_us)
{
    if (a == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_vehicle_check(vehicle);
    if (status < 0) {
        return status;
    }
    if (vehicle->regressor == NULL || vehicle->path != &auvid_path_regressor ||
        vehicle == &a->vehicle) {
        return AUVID_ERR_MODEL;
    }
    if (cell_us < 1000 || cell_us > 1000000 || velocity_us > 1000000) {
        return AUVID_ERR_RANGE;
    }
    auvid_real_t cell_s = (auvid_real_t)cell_us * AUVID_C(1e-6);
    auvid_real_t velocity_s = (auvid_real_t)velocity_us * AUVID_C(1e-6);
    auvid_real_t variance = cell_s * cell_s / AUVID_C(12.0);
    a->other = vehicle;
    a->spread_s[0] = auvid_sqrt(variance + velocity_s * velocity_s / AUVID_C(6.0));
    a->spread_s[1] = auvid_sqrt(variance);
    a->vehicle = *vehicle;
    a->vehicle.residual = NULL;
    a->vehicle.regressor = averaged_regressor;
    a->vehicle.acceleration = vehicle->acceleration == NULL ? NULL : averaged_acceleration;
    a->vehicle.context = a;
    return AUVID_OK;
}
