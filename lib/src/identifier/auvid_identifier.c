/*
 * The identifier (Karras et al. 2013, Fig. 2): the tick. What acts is in auvid_identifier_act.c,
 * optimizing in auvid_identifier_work.c.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "auvid/selftest.h"
#include "../base/auvid_math_internal.h"

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
    auvid_allocation_defaults(&cfg->allocation);
    auvid_excitation_defaults(&cfg->excitation);
    auvid_guard_defaults(&cfg->guard);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        cfg->search.lower[i] = AUVID_C(-1000.0);
        cfg->search.upper[i] = AUVID_C(1000.0);
    }
    cfg->search.seed = 1;
    cfg->uncertainty.thrust_scale = AUVID_C(0.05);
    cfg->uncertainty.dvl_scale = AUVID_C(0.005);
    cfg->uncertainty.delay_s = AUVID_C(0.1);
}

void auvid_identifier_literal(auvid_identifier_config_t *cfg)
{
    if (cfg != NULL) {
        cfg->velocity_every_tick = true;
        cfg->metric.cell_us = cfg->recorder.cell_us;
        auvid_metric_literal(&cfg->metric);
    }
}

/* Would the search over all free parameters be taken? One over fewer of them is, too. */
static auvid_status_t check_search(const auvid_identifier_config_t *cfg)
{
    const auvid_vehicle_t *vehicle = cfg->vehicle;
    uint32_t free = cfg->metric.free == 0 ? UINT32_MAX : cfg->metric.free;
    bool delay = vehicle->regressor == NULL && cfg->metric.estimate_delay; /* searched too */
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
    if (AUVID_REGRESSOR_ONLY && cfg->search.literal_search) {
        return AUVID_ERR_MODEL;
    }
    if (delay && n < AUVID_MAX_PARAMETERS) {
        search.upper[n] = AUVID_C(1.0);
    }
    search.n = (uint8_t)(n + delay);
    search.population = cfg->search.population;
    search.omega = cfg->search.omega;
    return auvid_crs_check(&search);
}

static auvid_status_t check_uncertainty(const auvid_uncertainty_t *told)
{
    const auvid_real_t all[] = {told->thrust_scale, told->dvl_scale, told->delay_s};
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

static auvid_status_t check(const auvid_identifier_config_t *cfg)
{
    auvid_status_t status = auvid_selftest();
    if (status >= 0) {
        status = auvid_vehicle_check(cfg->vehicle);
    }
    if (status >= 0) {
        status = check_search(cfg);
    }
    /* in every tick there is the filter's velocity only, and that is over ground */
    bool velocity = cfg->velocity == AUVID_VELOCITY_GROUND ||
                    (cfg->velocity == AUVID_VELOCITY_WATER && !cfg->velocity_every_tick);
    bool in_range = velocity && cfg->dry_mass_kg >= AUVID_C(0.0);
    if (status >= 0) {
        status = check_uncertainty(&cfg->uncertainty);
    }
    return status >= 0 && !in_range ? AUVID_ERR_RANGE : status;
}

static auvid_status_t init_excitation(auvid_identifier_t *id, const auvid_identifier_config_t *cfg)
{
    auvid_status_t status = AUVID_OK;
    if (cfg->allocation.thrusters > 0) {
        status = auvid_allocation_init(&id->allocation, &cfg->allocation);
    }
    if (status >= 0 && cfg->excitation.segments > 0) {
        status = auvid_excitation_init(&id->excitation, &cfg->excitation);
        if (status >= 0 && cfg->allocation.thrusters > 0) {
            auvid_real_t peak[AUVID_DOF_COUNT];
            (void)auvid_excitation_peak(&id->excitation, peak);
            status = auvid_allocation_check(&id->allocation, peak, NULL);
        }
    }
    return status;
}

static auvid_status_t init_metric(auvid_metric_t *metric, const auvid_identifier_config_t *cfg)
{
    metric->cfg = cfg->metric;
    metric->cfg.vehicle = cfg->vehicle;
    metric->cfg.cell_us = cfg->recorder.cell_us;
    metric->cfg.delay_sigma_s = cfg->uncertainty.delay_s;
    return auvid_metric_init(metric, &metric->cfg);
}

static auvid_status_t init_modules(auvid_identifier_t *id, const auvid_identifier_config_t *cfg)
{
    auvid_status_t status = auvid_nav_init(&id->nav, &cfg->nav);
    if (status >= 0) {
        auvid_recorder_config_t recorder = cfg->recorder;
        if (recorder.gap_us == 0) {
            recorder.gap_us = auvid_recorder_gap(cfg->metric.velocity_us);
        }
        status = auvid_recorder_init(&id->recorder, &recorder);
    }
    if (status >= 0) {
        status = init_metric(&id->metric, cfg);
    }
    if (status >= 0) {
        status = auvid_guard_init(&id->guard, &cfg->guard);
    }
    return status < 0 ? status : init_excitation(id, cfg);
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
    memset(id, 0, offsetof(auvid_identifier_t, config)); /* where cfg may be */
    auvid_status_t status = check(cfg);
    if (status >= 0) {
        id->search = cfg->search;
        id->velocity = cfg->velocity;
        id->velocity_every_tick = cfg->velocity_every_tick;
        id->dry_mass_kg = cfg->dry_mass_kg;
        id->uncertainty = cfg->uncertainty;
        id->listener = cfg->listener;
        id->listening = cfg->listening;
        status = init_modules(id, cfg);
    }
    if (status < 0) {
        memset(id, 0, sizeof *id);
    }
    return status;
}

/* Cells that have become complete, `most` of them, go to the metric and to whoever is attached. */
static void take_cells(auvid_identifier_t *id, int most)
{
    auvid_sample_t cell;
    uint32_t dropped = id->metric.rows_dropped;
    for (int i = 0; i < most; ++i) {
        auvid_status_t status = auvid_recorder_pop(&id->recorder, &cell);
        if (status == AUVID_GAP) {
            auvid_metric_gap(&id->metric);
            auvid_validation_gap(id->validation);
            auvid_validation_gap(&id->prediction);
            id->events |= AUVID_EVENT_GAP;
        } else if (status != AUVID_OK) {
            return;
        } else {
            if (id->validation != NULL) {
                (void)auvid_validation_add(id->validation, &cell);
            }
            if (id->prediction.vehicle != NULL) {
                (void)auvid_validation_add(&id->prediction, &cell);
            }
            identifier_take_set(id, auvid_metric_add(&id->metric, &cell));
            bool drops = id->metric.rows_dropped != dropped;
            id->events |= drops ? AUVID_EVENT_ROWS_DROPPED : 0u;
        }
    }
}

/* Velocity goes into the recorder when a DVL update has just corrected it: between updates a
 * constant-velocity filter lags. */
static void record_velocity(auvid_identifier_t *id)
{
    bool water = id->velocity == AUVID_VELOCITY_WATER;
    const auvid_nav_knot_t *knot = water ? &id->nav.water : &id->nav.ground;
    if (!id->velocity_every_tick && knot->sequence != id->knot) {
        id->knot = knot->sequence;
        (void)auvid_recorder_velocity(&id->recorder, knot->t_us, knot->velocity, knot->measured);
    }
}

static void note(auvid_identifier_t *id, auvid_status_t status, uint32_t event)
{
    id->events |= status < 0 || status == AUVID_GATED ? event : 0u;
}

/* What became of samples that were held for the IMU. */
static void note_held(auvid_identifier_t *id)
{
    const unsigned dvl = 1u << AUVID_NAV_DVL_BOTTOM | 1u << AUVID_NAV_DVL_WATER;
    unsigned refused = id->nav.held_refused;
    id->events |= (refused & dvl) != 0 ? AUVID_EVENT_DVL_DROPPED : 0u;
    id->events |= (refused >> AUVID_NAV_DEPTH & 1u) != 0 ? AUVID_EVENT_DEPTH_DROPPED : 0u;
    id->events |= (refused >> AUVID_NAV_GPS & 1u) != 0 ? AUVID_EVENT_GPS_DROPPED : 0u;
    record_velocity(id); /* another one may follow in this step */
}

/* Sensors into the filter; what it refuses becomes an event. */
static void navigate(auvid_identifier_t *id, const auvid_input_t *in)
{
    id->nav.until_us = in->t_us + id->nav.future_us;
    if (in->imu.present) {
        /* The filter follows the IMU's time: one sample far ahead would shut out all others. */
        if (in->imu.t_us > id->nav.until_us ||
            auvid_nav_imu(&id->nav, in->imu.t_us, in->imu.attitude, in->imu.rates) < 0) {
            id->events |= AUVID_EVENT_IMU_DROPPED;
        } else {
            note_held(id);
        }
    }
    if (in->dvl.present) {
        note(id, auvid_nav_dvl(&id->nav, &in->dvl.sample), AUVID_EVENT_DVL_DROPPED);
    }
    if (in->dvl_water.present) {
        note(id, auvid_nav_dvl(&id->nav, &in->dvl_water.sample), AUVID_EVENT_DVL_DROPPED);
    }
    if (in->depth.present) {
        note(id, auvid_nav_depth(&id->nav, in->depth.t_us, in->depth.depth_m),
             AUVID_EVENT_DEPTH_DROPPED);
    }
    if (in->gps.present) {
        note(id, auvid_nav_gps(&id->nav, in->gps.t_us, in->gps.x_m, in->gps.y_m),
             AUVID_EVENT_GPS_DROPPED);
    }
}

/* The filter's state into the recorder: attitude in every tick. */
static void record(auvid_identifier_t *id, const auvid_input_t *in)
{
    auvid_nav_state_t state;
    if (auvid_nav_state(&id->nav, &state) != AUVID_OK) {
        return;
    }
    bool water = id->velocity == AUVID_VELOCITY_WATER;
    uint32_t fresh = water ? AUVID_NAV_FRESH_WATER : AUVID_NAV_FRESH_BOTTOM;
    if (in->imu.present) {
        (void)auvid_recorder_attitude(&id->recorder, state.t_us, state.attitude, state.rates);
    }
    if (id->velocity_every_tick && (state.flags & fresh)) {
        (void)auvid_recorder_velocity(&id->recorder, state.t_us, state.velocity,
                                      id->nav.ground.measured);
    }
    record_velocity(id);
    if (!(state.flags & fresh)) {
        id->events |= AUVID_EVENT_VELOCITY_STALE;
    }
}

/* Are rows of this time dropped? */
static bool is_deaf(const auvid_identifier_t *id, uint64_t t_us)
{
    const auvid_metric_t *m = &id->metric;
    return identifier_residual_path(id) && m->held && (m->full || t_us > m->until_us);
}

/* The wrench recorded is known from t_us on. */
static auvid_status_t record_input(auvid_identifier_t *id, uint64_t t_us,
                                   const auvid_real_t *wrench, const auvid_real_t *command)
{
    auvid_status_t status = auvid_recorder_input(&id->recorder, t_us, wrench, command);
    if (status >= 0) {
        id->applied.t_us = t_us;
        id->applied.known = true;
        if (!AUVID_REGRESSOR_ONLY && id->listener != NULL && !is_deaf(id, t_us)) {
            id->listener->command(id->listening, t_us, command);
        }
    }
    return status;
}

auvid_status_t auvid_identifier_step(auvid_identifier_t *id, const auvid_input_t *in,
                                     auvid_output_t *out)
{
    if (out != NULL) {
        memset(out, 0, sizeof *out);
    }
    if (id == NULL || in == NULL || out == NULL) {
        auvid_identifier_refused(id, in, out);
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    if (id->started && in->t_us <= id->t_us) {
        auvid_identifier_refused(id, in, out);
        out->events |= AUVID_EVENT_TIME;
        return in->t_us == id->t_us ? AUVID_ERR_TIME_SAME : AUVID_ERR_TIME_BACK;
    }
    id->started = true;
    id->t_us = in->t_us;
    navigate(id, in);
    record(id, in);
    if (in->applied.present &&
        record_input(id, in->t_us, in->applied.wrench, in->applied.command) < 0) {
        id->events |= AUVID_EVENT_INPUT_DROPPED;
    }
    take_cells(id, AUVID_CELLS_PER_STEP);
    auvid_identifier_act(id, in, out);
    out->events = id->events;
    id->events = 0;
    return AUVID_OK;
}

auvid_status_t auvid_identifier_motion(auvid_identifier_t *id, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *nu)
{
    if (id == NULL || attitude == NULL || nu == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status = auvid_recorder_motion(&id->recorder, t_us, attitude, nu);
    if (status == AUVID_OK) {
        take_cells(id, AUVID_RECORDER_CELLS);
    }
    return status;
}

auvid_status_t auvid_identifier_applied(auvid_identifier_t *id, uint64_t t_us,
                                        const auvid_real_t *wrench, const auvid_real_t *command)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status = record_input(id, t_us, wrench, command);
    take_cells(id, AUVID_CELLS_PER_STEP);
    return status;
}

auvid_status_t auvid_identifier_close(auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    take_cells(id, AUVID_RECORDER_CELLS);
    auvid_status_t status = auvid_metric_close(&id->metric);
    identifier_take_set(id, status);
    return status;
}

void auvid_identifier_attach(auvid_identifier_t *id, auvid_validation_t *validation)
{
    if (id != NULL) {
        id->validation = validation;
    }
}
