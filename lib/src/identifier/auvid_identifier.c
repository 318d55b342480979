/*
 * The identifier (Karras et al. 2013, Fig. 2): its configuration. The tick is in
 * auvid_identifier_step.c, the optimization in auvid_identifier_work.c.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "auvid/selftest.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_internal.h"

void auvid_identifier_defaults(auvid_identifier_config_t *cfg, const auvid_vehicle_t *vehicle)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    cfg->vehicle = vehicle;
    auvid_nav_defaults(&cfg->nav);
    auvid_recorder_defaults(&cfg->recorder);
    auvid_metric_defaults(&cfg->metric, vehicle);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        cfg->search.lower[i] = AUVID_C(-1000.0);
        cfg->search.upper[i] = AUVID_C(1000.0);
    }
    cfg->search.seed = 1;
    cfg->uncertainty.thrust_scale = AUVID_C(0.05);
    cfg->uncertainty.dvl_scale = AUVID_C(0.005);
    cfg->uncertainty.delay_s = AUVID_C(0.1);
}

/* Check the search over all free parameters. A search over fewer of them is valid too. */
static auvid_status_t identifier_check_search(const auvid_identifier_config_t *cfg)
{
    const auvid_vehicle_t *vehicle = cfg->vehicle;
    uint32_t free = cfg->metric.free == 0 ? UINT32_MAX : cfg->metric.free;
    bool delay = auvid_path_stores_rows(vehicle->path) && cfg->metric.estimate_delay; /* searched */
    auvid_crs_config_t search;
    uint8_t n = 0;
    auvid_crs_defaults(&search, 0);
    for (int i = 0; i < vehicle->parameters; ++i) {
        if (free >> i & 1u) {
            if (cfg->search.has_good && !auvid_is_finite(cfg->search.good[i])) {
                return AUVID_ERR_NOT_FINITE;
            }
            bool mass = vehicle->parameter[i].kind == AUVID_PARAMETER_MASS;
            if (mass && cfg->dry_mass_kg > AUVID_C(0.0) &&
                cfg->search.upper[i] <= cfg->dry_mass_kg) {
                return AUVID_ERR_DRY_MASS;
            }
            search.lower[n] = cfg->search.lower[i];
            search.upper[n++] = cfg->search.upper[i];
        }
    }
    if (delay && n < AUVID_MAX_PARAMETERS) {
        search.upper[n] = AUVID_C(1.0);
    }
    search.n = (uint8_t)(n + delay);
    search.population = cfg->search.population;
    search.omega = cfg->search.omega;
    return auvid_crs_check(&search);
}

static auvid_status_t identifier_check_uncertainty(const auvid_uncertainty_t *uncertainty)
{
    const auvid_real_t all[] = {uncertainty->thrust_scale, uncertainty->dvl_scale,
                                uncertainty->delay_s};
    enum { ALL = sizeof all / sizeof all[0] };
    if (!auvid_all_finite(all, ALL)) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int i = 0; i < ALL; ++i) {
        if (!(all[i] >= AUVID_C(0.0) && all[i] <= AUVID_C(1.0))) {
            return AUVID_ERR_RANGE;
        }
    }
    return AUVID_OK;
}

static auvid_status_t identifier_check(const auvid_identifier_config_t *cfg)
{
    const auvid_listener_t *listener = cfg->listener;
    auvid_status_t status = auvid_selftest();
    if (listener != NULL && (listener->command == NULL || listener->set == NULL)) {
        status = AUVID_ERR_NULL;
    }
    if (status >= 0) {
        status = auvid_vehicle_check(cfg->vehicle);
    }
    if (status >= 0) {
        status = identifier_check_search(cfg);
    }
    bool velocity = cfg->velocity == AUVID_VELOCITY_GROUND || cfg->velocity == AUVID_VELOCITY_WATER;
    bool in_range = velocity && cfg->dry_mass_kg >= AUVID_C(0.0);
    if (status >= 0) {
        status = identifier_check_uncertainty(&cfg->uncertainty);
    }
    return status >= 0 && !in_range ? AUVID_ERR_RANGE : status;
}

static auvid_status_t identifier_init_metric(auvid_metric_t *metric,
                                             const auvid_identifier_config_t *cfg)
{
    metric->cfg = cfg->metric;
    metric->cfg.vehicle = cfg->vehicle;
    metric->cfg.cell_us = cfg->recorder.cell_us;
    metric->cfg.delay_sigma_s = cfg->uncertainty.delay_s;
    return auvid_metric_init(metric, &metric->cfg);
}

static auvid_status_t identifier_init_modules(auvid_identifier_t *id,
                                              const auvid_identifier_config_t *cfg)
{
    auvid_status_t status = auvid_nav_init(&id->nav, &cfg->nav);
    if (status >= 0) {
        auvid_recorder_config_t recorder = cfg->recorder;
        if (recorder.gap_us == 0) {
            recorder.gap_us = auvid_recorder_gap(cfg->metric.velocity_us);
        }
        status = auvid_recorder_init(&id->recorder, &recorder);
    }
    return status < 0 ? status : identifier_init_metric(&id->metric, cfg);
}

auvid_real_t auvid_estimate_covariance(const auvid_estimate_t *estimate,
                                       const auvid_vehicle_t *vehicle, int i, int k)
{
    int row = i < k ? i : k, column = i < k ? k : i;
    if (estimate == NULL || vehicle == NULL || row < 0 || column >= vehicle->parameters) {
        return AUVID_C(0.0);
    }
    return estimate->covariance[row * vehicle->parameters - row * (row - 1) / 2 + column - row];
}

auvid_status_t auvid_identifier_init(auvid_identifier_t *id, const auvid_identifier_config_t *cfg)
{
    if (id == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    memset(id, 0, offsetof(auvid_identifier_t, cfg)); /* cfg may be id->cfg */
    auvid_status_t status = identifier_check(cfg);
    if (status >= 0) {
        id->search = cfg->search;
        id->velocity = cfg->velocity;
        id->dry_mass_kg = cfg->dry_mass_kg;
        id->uncertainty = cfg->uncertainty;
        id->listener = cfg->listener;
        id->listener_context = cfg->listener_context;
        status = identifier_init_modules(id, cfg);
    }
    if (status < 0) {
        memset(id, 0, sizeof *id);
    }
    return status;
}
