/*
 * The identifier (Karras et al. 2013, Fig. 2): its configuration. The tick is in
 * auvid_identifier_step.c, the optimization in auvid_identifier_work.c.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "auvid/types.h"
#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../metric/auvid_metric_internal.h"
#include "../models/auvid_vehicle_internal.h"
#include "../navigation/auvid_nav_internal.h"
#include "../navigation/auvid_recorder_internal.h"
#include "../search/auvid_search_internal.h"

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
    auvid_clear(cfg->metric.tau_max, AUVID_DOF_COUNT);
    cfg->metric.velocity_us = AUVID_VELOCITY_OBSERVED;
    auvid_search_defaults(&cfg->search, 0);
    cfg->uncertainty.thrust_scale = AUVID_C(0.05);
    cfg->uncertainty.dvl_scale = AUVID_C(0.005);
    cfg->uncertainty.delay_s = AUVID_C(0.1);
}

void auvid_identifier_select(auvid_search_config_t *search, uint32_t active, uint8_t *of)
{
    search->n = 0;
    for (uint8_t i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        if (active >> i & 1u) {
            search->lower[search->n] = search->lower[i];
            search->upper[search->n] = search->upper[i];
            search->good[search->n] = search->good[i];
            of[search->n++] = i;
        }
    }
}

static auvid_status_t identifier_check_dry_mass(const auvid_identifier_config_t *cfg, uint32_t free,
                                                auvid_refusal_t *why)
{
    for (int i = 0; i < cfg->vehicle->parameters; ++i) {
        auvid_real_t upper = cfg->search.upper[i], dry = cfg->dry_mass_kg;
        bool mass = cfg->vehicle->parameter[i].kind == AUVID_PARAMETER_MASS;
        if ((free >> i & 1u) && mass && dry > AUVID_C(0.0) && upper <= dry) {
            (void)auvid_refuse(why, AUVID_ERR_DRY_MASS, "dry_mass_kg", dry, upper);
            return auvid_refuse_element(why, AUVID_ERR_DRY_MASS, i);
        }
    }
    return AUVID_OK;
}

/* Check the search over all free parameters, and the delay if it is searched too. A search over
 * fewer of them is valid too. */
static auvid_status_t identifier_check_search(const auvid_identifier_config_t *cfg,
                                              auvid_refusal_t *why)
{
    const auvid_vehicle_t *vehicle = cfg->vehicle;
    const uint32_t all = UINT32_MAX >> (32 - vehicle->parameters);
    const uint32_t free = cfg->metric.free == 0 ? all : cfg->metric.free & all;
    const int delay = auvid_path_stores_rows(vehicle->path) && cfg->metric.estimate_delay;
    auvid_search_config_t search = cfg->search;
    uint8_t of[AUVID_MAX_PARAMETERS];
    auvid_identifier_select(&search, free, of);
    if (search.n == 0 || search.n + delay > AUVID_MAX_PARAMETERS) {
        (void)auvid_refuse(why, AUVID_ERR_PARAMETERS, "free", (auvid_real_t)(search.n + delay),
                           (auvid_real_t)(search.n == 0 ? 1 : AUVID_MAX_PARAMETERS));
        return auvid_refuse_part(why, AUVID_ERR_PARAMETERS, "metric");
    }
    auvid_status_t status = identifier_check_dry_mass(cfg, free, why);
    if (status < 0) {
        return auvid_refuse_part(why, status, "");
    }
    if (delay) {
        search.lower[search.n] = search.good[search.n] = AUVID_C(0.0);
        search.upper[search.n++] = AUVID_C(1.0);
    }
    status = auvid_search_check_fields(&search, why);
    if (status < 0 && why->element >= 0) {
        why->element = of[why->element];
    }
    return auvid_refuse_part(why, status, "search");
}

/* Check the fields that are of no module. */
static auvid_status_t identifier_check_fields(const auvid_identifier_config_t *cfg,
                                              auvid_refusal_t *why)
{
#define UP_TO_1(name) REALS_IN(auvid_uncertainty_t, name, 1, AUVID_C(0.0), AUVID_C(1.0))
    static const auvid_field_t uncertainty[] = {UP_TO_1(thrust_scale), UP_TO_1(dvl_scale),
                                                UP_TO_1(delay_s)};
    static const auvid_field_t velocity = WHOLE_IN(auvid_identifier_config_t, velocity, 1,
                                                   AUVID_VELOCITY_GROUND, AUVID_VELOCITY_WATER);
    auvid_status_t status = auvid_check_fields(&cfg->uncertainty, uncertainty,
                                               sizeof uncertainty / sizeof uncertainty[0], why);
    if (status < 0) {
        return auvid_refuse_part(why, status, "uncertainty");
    }
    status = auvid_check_fields(cfg, &velocity, 1, why);
    if (status < 0) {
        return status;
    }
    return cfg->dry_mass_kg >= AUVID_C(0.0)
               ? AUVID_OK
               : auvid_refuse(why, AUVID_ERR_RANGE, "dry_mass_kg", cfg->dry_mass_kg, AUVID_C(0.0));
}

static auvid_status_t identifier_check(const auvid_identifier_config_t *cfg, auvid_refusal_t *why)
{
    auvid_status_t status = auvid_selftest();
    if (status < 0) {
        return auvid_refuse(why, status, "selftest", AUVID_C(0.0), AUVID_C(0.0));
    }
    const auvid_listener_t *listener = cfg->listener;
    if (listener != NULL && (listener->command == NULL || listener->set == NULL)) {
        (void)auvid_refuse(why, AUVID_ERR_NULL, listener->command == NULL ? "command" : "set",
                           AUVID_C(0.0), AUVID_C(0.0));
        return auvid_refuse_part(why, AUVID_ERR_NULL, "listener");
    }
    status = auvid_vehicle_check_fields(cfg->vehicle, why);
    if (status < 0) {
        return auvid_refuse_part(why, status, "vehicle");
    }
    status = identifier_check_search(cfg, why);
    if (status >= 0) {
        status = identifier_check_fields(cfg, why);
    }
    return status;
}

static auvid_status_t identifier_init_metric(auvid_identifier_t *id,
                                             const auvid_identifier_config_t *cfg,
                                             auvid_refusal_t *why)
{
    auvid_metric_t *metric = &id->metric;
    metric->cfg = cfg->metric;
    metric->cfg.vehicle = cfg->vehicle;
    metric->cfg.cell_us = cfg->recorder.cell_us;
    metric->cfg.delay_sigma_s = cfg->uncertainty.delay_s;
    if (cfg->metric.velocity_us == AUVID_VELOCITY_OBSERVED) {
        metric->cfg.velocity_us = 1000000; /* until it is known, before the first cell */
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (auvid_is_zero(metric->cfg.tau_max[j])) {
            metric->cfg.tau_max[j] = j < AUVID_ROLL ? AUVID_C(100.0) : AUVID_C(40.0);
            id->default_scale = (uint8_t)(id->default_scale | AUVID_DOF_BIT(j));
        }
    }
    auvid_status_t status = auvid_metric_check(&metric->cfg, why);
    return status < 0 ? auvid_refuse_part(why, status, "metric")
                      : auvid_metric_init(metric, &metric->cfg);
}

static auvid_status_t identifier_init_modules(auvid_identifier_t *id,
                                              const auvid_identifier_config_t *cfg,
                                              auvid_refusal_t *why)
{
    auvid_recorder_config_t recorder = cfg->recorder;
    auvid_status_t status = auvid_nav_check(&cfg->nav, why);
    if (status < 0) {
        return auvid_refuse_part(why, status, "nav");
    }
    recorder.velocity_us = cfg->metric.velocity_us;
    status = auvid_recorder_check(&recorder, why);
    if (status < 0) {
        return auvid_refuse_part(why, status, "recorder");
    }
    (void)auvid_nav_init(&id->nav, &cfg->nav);
    (void)auvid_recorder_init(&id->recorder, &recorder);
    return identifier_init_metric(id, cfg, why);
}

const auvid_estimate_t *auvid_identifier_estimate(const auvid_identifier_t *id)
{
    return id != NULL && id->estimate.number > 0 ? &id->estimate : NULL;
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
    auvid_refusal_t why = {0};
    memset(id, 0, offsetof(auvid_identifier_t, cfg)); /* cfg may be id->cfg */
    auvid_status_t status = identifier_check(cfg, &why);
    if (status >= 0) {
        id->search = cfg->search;
        id->velocity = cfg->velocity;
        id->dry_mass_kg = cfg->dry_mass_kg;
        id->uncertainty = cfg->uncertainty;
        id->listener = cfg->listener;
        id->listener_context = cfg->listener_context;
        status = identifier_init_modules(id, cfg, &why);
    }
    if (status < 0) {
        memset(id, 0, sizeof *id);
        id->refusal = why;
        id->refusal.part = why.part == NULL ? "" : why.part;
    }
    return status;
}
