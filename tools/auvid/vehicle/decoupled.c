#include "decoupled.h"

#include <stdio.h>
#include <string.h>

#include "auvid/fossen.h"

#if AUVID_MAX_PARAMETERS >= 22
bool decoupled_exists(const auvid_vehicle_t *model)
{
    return model->regressor == auvid_fossen.regressor;
}
#else
bool decoupled_exists(const auvid_vehicle_t *model)
{
    (void)model;
    return false;
}
#endif

/* Does the equation of DoF j keep this parameter? Weight and buoyancy depend on attitude only. */
static bool keeps(const auvid_parameter_t *p, int j)
{
    switch (p->kind) {
    case AUVID_PARAMETER_MASS:
    case AUVID_PARAMETER_INERTIA:
    case AUVID_PARAMETER_LINEAR_DRAG:
    case AUVID_PARAMETER_QUADRATIC_DRAG:
        return (int)p->dof == j;
    case AUVID_PARAMETER_FORCE:
        return true;
    case AUVID_PARAMETER_OTHER:
    case AUVID_PARAMETER_UNSCALED:
    default:
        return strcmp(p->unit, "Nm") == 0;
    }
}

/* Removes what the equations do not keep. */
static void mask(const decoupled_t *d, auvid_regressor_t *y)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < d->vehicle.parameters; ++i) {
            if (!(d->vehicle.columns[j] >> i & 1u)) {
                y->row[j][i] = 0;
            }
        }
    }
}

static void regressor(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                      auvid_regressor_t *y)
{
    const decoupled_t *d = context;
    d->rows->regressor(d->rows->context, sample, pi, y);
    mask(d, y);
}

/* Each equation contains one acceleration, times one mass. */
static bool acceleration(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                         auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const decoupled_t *d = context;
    auvid_sample_t steady = *sample;
    auvid_regressor_t y;
    bool any = false;
    memset(steady.nu_dot, 0, sizeof steady.nu_dot);
    memset(&y, 0, sizeof y);
    d->hull->regressor(d->hull->context, &steady, NULL, &y);
    mask(d, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t rest = sample->tau[j], mass = pi[d->mass[j]];
        for (int i = 0; i < d->vehicle.parameters; ++i) {
            rest -= y.row[j][i] * pi[i];
        }
        nu_dot[j] = rest / (mass > 0 ? mass : 0); /* no mass: not finite */
        any = any || mass > 0;
    }
    return any;
}

void decoupled_init(decoupled_t *d, const auvid_vehicle_t *rows, const auvid_vehicle_t *hull)
{
    *d = (decoupled_t){.vehicle = *rows, .rows = rows, .hull = hull};
    (void)snprintf(d->name, sizeof d->name, "%s, decoupled", rows->name);
    d->vehicle.name = d->name;
    d->vehicle.regressor = regressor;
    d->vehicle.acceleration = acceleration;
    d->vehicle.context = d;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        d->vehicle.reads[j] = (uint8_t)(1u << j);
        for (int i = 0; i < rows->parameters; ++i) {
            const auvid_parameter_t *p = &rows->parameter[i];
            bool is_mass = p->kind == AUVID_PARAMETER_MASS || p->kind == AUVID_PARAMETER_INERTIA;
            d->vehicle.columns[j] &= keeps(p, j) ? UINT32_MAX : ~(UINT32_C(1) << i);
            d->mass[j] = is_mass && (int)p->dof == j ? (uint8_t)i : d->mass[j];
        }
    }
}
