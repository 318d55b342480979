/*
 * The identifier (Karras et al. 2013, Fig. 2): its configuration. The tick is in
 * auvid_identifier_step.c, the optimization in auvid_identifier_work.c.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "auvid/types.h"
#include "../base/auvid_linalg_internal.h"
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

/* Check the search over all free parameters, and the delay if it is searched too. A search over
 * fewer of them is valid too. */
static void identifier_check_search(const auvid_identifier_config_t *cfg, auvid_refusal_t *why)
{
    const auvid_vehicle_t *vehicle = cfg->vehicle;
    const uint32_t all = UINT32_MAX >> (32 - vehicle->parameters);
    const uint32_t free = cfg->metric.free == 0 ? all : cfg->metric.free & all;
    const uint32_t delay = auvid_path_stores_rows(vehicle->path) && cfg->metric.estimate_delay;
    auvid_search_config_t search = cfg->search;
    uint8_t of[AUVID_MAX_PARAMETERS];
    auvid_identifier_select(&search, free, of);
    auvid_check_part(why, "metric");
    auvid_check_count(why, AUVID_ERR_PARAMETERS, "free", free == 0 ? 0u : search.n + delay,
                      AUVID_MAX_PARAMETERS);
    auvid_check_part(why, "");
    for (int i = 0; i < search.n; ++i) {
        bool mass = vehicle->parameter[of[i]].kind == AUVID_PARAMETER_MASS;
        auvid_real_t dry = mass ? cfg->dry_mass_kg : AUVID_C(0.0);
        auvid_check_element(why, of[i]);
        auvid_check_limit(why, !(dry > AUVID_C(0.0) && search.upper[i] <= dry), AUVID_ERR_DRY_MASS,
                          "dry_mass_kg", dry, search.upper[i]);
    }
    if (why->status < 0) {
        return;
    }
    if (delay) {
        search.lower[search.n] = search.good[search.n] = AUVID_C(0.0);
        search.upper[search.n++] = AUVID_C(1.0);
    }
    auvid_check_part(why, "search");
    auvid_search_check_fields(&search, why);
    if (why->status < 0 && why->element >= 0) {
        why->element = of[why->element];
    }
}

static void identifier_check(const auvid_identifier_config_t *cfg, auvid_refusal_t *why)
{
#define UP_TO_1(name) REALS_IN(auvid_uncertainty_t, name, 1, AUVID_C(0.0), AUVID_C(1.0))
    static const auvid_field_t uncertainty[] = {UP_TO_1(thrust_scale), UP_TO_1(dvl_scale),
                                                UP_TO_1(delay_s)};
    static const auvid_field_t velocity[] = {WHOLE_IN(auvid_identifier_config_t, velocity, 1,
                                                      AUVID_VELOCITY_GROUND, AUVID_VELOCITY_WATER)};
    const auvid_listener_t *listener = cfg->listener;
    auvid_check_that(why, auvid_selftest() == AUVID_OK, AUVID_ERR_ARITHMETIC, "selftest");
    auvid_check_part(why, "listener");
    auvid_check_that(why, listener == NULL || listener->command != NULL, AUVID_ERR_NULL, "command");
    auvid_check_that(why, listener == NULL || listener->set != NULL, AUVID_ERR_NULL, "set");
    auvid_check_part(why, "vehicle");
    auvid_vehicle_check_fields(cfg->vehicle, why);
    if (why->status < 0) {
        return;
    }
    identifier_check_search(cfg, why);
    auvid_check_part(why, "uncertainty");
    AUVID_CHECK_TABLE(why, &cfg->uncertainty, uncertainty);
    auvid_check_part(why, "");
    AUVID_CHECK_TABLE(why, cfg, velocity);
    auvid_check_limit(why, cfg->dry_mass_kg >= AUVID_C(0.0), AUVID_ERR_RANGE, "dry_mass_kg",
                      cfg->dry_mass_kg, AUVID_C(0.0));
}

/* Complete the configuration of the metric. */
static void identifier_configure_metric(auvid_identifier_t *id,
                                        const auvid_identifier_config_t *cfg)
{
    auvid_metric_t *metric = &id->metric;
    metric->cfg = cfg->metric;
    metric->cfg.vehicle = cfg->vehicle;
    metric->cfg.cell_us = cfg->recorder.cell_us;
    metric->cfg.delay_sigma_s = cfg->uncertainty.delay_s;
    if (cfg->metric.velocity_us == AUVID_VELOCITY_OBSERVED) {
        metric->cfg.velocity_us = 200000; /* until it is known, before the first cell */
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (auvid_is_zero(metric->cfg.tau_max[j])) {
            metric->cfg.tau_max[j] = j < AUVID_ROLL ? AUVID_C(100.0) : AUVID_C(40.0);
            id->default_scale = (uint8_t)(id->default_scale | AUVID_DOF_BIT(j));
        }
    }
}

/* auvid_nav_set_up; NULL for another navigation. A program that calls only
 * auvid_identifier_init_motion does not reference it, so the linker drops it. */
typedef void identifier_nav_t(auvid_nav_t *nav, const auvid_nav_config_t *cfg,
                              auvid_refusal_t *why);

static void identifier_init_modules(auvid_identifier_t *id, const auvid_identifier_config_t *cfg,
                                    identifier_nav_t *set_up_nav, auvid_refusal_t *why)
{
    auvid_recorder_config_t recorder = cfg->recorder;
    recorder.velocity_us = cfg->metric.velocity_us;
    identifier_configure_metric(id, cfg);
    if (set_up_nav != NULL) {
        auvid_check_part(why, "nav");
        set_up_nav(&id->nav, &cfg->nav, why);
    }
    auvid_check_part(why, "recorder");
    auvid_recorder_set_up(&id->recorder, &recorder, why);
    auvid_metric_set_up(&id->metric, &id->metric.cfg, why);
}

auvid_status_t auvid_identifier_check_attach(const auvid_identifier_t *id, const void *attached)
{
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    if (attached != NULL) {
        return AUVID_ERR_ATTACHED;
    }
    return id->started || id->applied.known ? AUVID_ERR_STARTED : AUVID_OK;
}

const auvid_estimate_t *auvid_identifier_estimate(const auvid_identifier_t *id)
{
    const auvid_estimate_t *other = id != NULL && id->attached.uncertain_functions != NULL
                                        ? id->attached.uncertain_functions->estimate(id)
                                        : NULL;
    return other != NULL ? other : id != NULL && id->estimate.number > 0 ? &id->estimate : NULL;
}

auvid_real_t auvid_estimate_covariance(const auvid_estimate_t *estimate,
                                       const auvid_vehicle_t *vehicle, int i, int k)
{
    int row = i < k ? i : k, column = i < k ? k : i;
    if (estimate == NULL || vehicle == NULL || row < 0 || column >= vehicle->parameters) {
        return AUVID_C(0.0);
    }
    return estimate->covariance[auvid_qr_row(vehicle->parameters, row) + column - row];
}

static auvid_status_t identifier_init(auvid_identifier_t *id, const auvid_identifier_config_t *cfg,
                                      identifier_nav_t *set_up_nav)
{
    if (id == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_refusal_t why;
    memset(id, 0, offsetof(auvid_identifier_t, cfg)); /* cfg may be id->cfg */
    auvid_check_begin(&why);
    identifier_check(cfg, &why);
    if (why.status == AUVID_OK) {
        id->search = cfg->search;
        id->velocity = (uint8_t)cfg->velocity;
        id->dry_mass_kg = cfg->dry_mass_kg;
        id->uncertainty = cfg->uncertainty;
        id->exact_inputs = cfg->exact_inputs;
        id->attached.listener = cfg->listener;
        id->attached.listener_context = cfg->listener_context;
        identifier_init_modules(id, cfg, set_up_nav, &why);
    }
    if (why.status < 0) {
        memset(id, 0, sizeof *id);
        id->refusal = why;
    }
    return why.status;
}

auvid_status_t auvid_identifier_init(auvid_identifier_t *id, const auvid_identifier_config_t *cfg)
{
    return identifier_init(id, cfg, auvid_nav_set_up);
}

auvid_status_t auvid_identifier_init_motion(auvid_identifier_t *id,
                                            const auvid_identifier_config_t *cfg)
{
    return identifier_init(id, cfg, NULL);
}
