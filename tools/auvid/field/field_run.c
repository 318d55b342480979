#include "field_run.h"

#include <math.h>
#include <string.h>

#include "../vehicle/vehicles.h"

/* Length of a set, and largest delay of the last one [s]. */
#define SET_S 30.0
#define LATE_S 60.0

/* Length of the motion after the excitation [s]. */
#define THEN_S 600.0

/* Start of the excitation [s]. */
#define BEGIN_S 1.0

/* Interval of the DVL samples. */
#define DVL_US 200000u

/* Interval in ticks at which the truth is sampled. */
#define LOOK 4

/* Work units per call where time does not matter. */
#define AT_EASE 1000000u

const double field_part[FIELD_PARTS] = {0.3, 0.6, 1.0};

void field_run_defaults(field_run_config_t *config)
{
    memset(config, 0, sizeof *config);
    field_defaults(&config->field, FIELD_GIRONA500, FIELD_EXCITED, 1);
    config->thrust_scale = config->dvl_scale = config->delay_s = -1.0;
    config->sets = 8;
    config->budget = AUVID_DEFAULT_BUDGET;
    config->uncertain = true;
}

/* The thrusters as known to the operator. */
static void allocate(const field_sheet_t *sheet, auvid_allocation_config_t *to)
{
    auvid_allocation_defaults(to);
    to->thrusters = (uint8_t)sheet->thrusters;
    for (int i = 0; i < to->thrusters; ++i) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            to->thruster[i].wrench[j] = (auvid_real_t)sheet->matrix[j][i];
        }
        to->thruster[i].max_N = (auvid_real_t)sheet->thruster_max_N;
        to->thruster[i].min_N = (auvid_real_t)-sheet->thruster_max_N;
    }
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        to->dofs |= AUVID_DOF_BIT(field_dof(e));
    }
}

void field_run_identifier(const field_run_config_t *config, auvid_averaged_t *averaged,
                          auvid_identifier_config_t *cfg)
{
    const field_config_t *field = &config->field;
    field_sheet_t sheet;
    const auvid_vehicle_t *model = config->model != NULL ? config->model : &auvid_girona500;
    auvid_identifier_defaults(cfg, model);
    cfg->exact_inputs = !config->uncertain;
    field_sheet(field->vehicle, field->seed, &sheet);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg->metric.tau_max[j] = (auvid_real_t)sheet.amplitude[j]; /* 0: auvid's choice */
    }
    if (field->driver == FIELD_ASSISTED) {
        cfg->metric.closed_loop = AUVID_DOF_BIT(AUVID_HEAVE) | AUVID_DOF_BIT(AUVID_YAW);
    }
    if (sheet.max_acceleration > 0.0) {
        cfg->nav.max_acceleration = (auvid_real_t)sheet.max_acceleration;
    }
    if (sheet.fast) {
        if (model->path == &auvid_path_regressor) {
            (void)auvid_averaged_init(averaged, model, cfg->recorder.cell_us, DVL_US);
            cfg->vehicle = cfg->metric.vehicle = &averaged->vehicle;
        }
        cfg->metric.half_width[1] = 4;
        cfg->metric.max_cell_us = 0; /* the average is over cells of this length */
    }
    if (sheet.largest_parameter > 0.0) {
        for (int i = 0; i < model->parameters; ++i) {
            cfg->search.upper[i] = (auvid_real_t)sheet.largest_parameter;
            cfg->search.lower[i] = -cfg->search.upper[i];
        }
    }
    cfg->search.seed = field->seed;
    const double given[] = {config->thrust_scale, config->dvl_scale, config->delay_s};
    auvid_real_t *to[] = {&cfg->uncertainty.thrust_scale, &cfg->uncertainty.dvl_scale,
                          &cfg->uncertainty.delay_s};
    for (int k = 0; k < 3; ++k) {
        *to[k] = given[k] >= 0.0 ? (auvid_real_t)given[k] : *to[k];
    }
}

static void copy(auvid_real_t *to, const double *from, int n)
{
    for (int i = 0; i < n; ++i) {
        to[i] = (auvid_real_t)from[i];
    }
}

static void sense(const field_output_t *seen, auvid_input_t *in)
{
    const sim_measurement_t *s = seen->sensor;
    memset(in, 0, sizeof *in);
    in->t_us = seen->t_us;
    in->imu.present = s[SIM_IMU].has;
    in->imu.t_us = s[SIM_IMU].t_us;
    copy(in->imu.attitude, s[SIM_IMU].value, 3);
    copy(in->imu.rates, s[SIM_IMU].value + 3, 3);
    in->dvl.present = s[SIM_DVL].has;
    in->dvl.sample.t_us = s[SIM_DVL].t_us;
    in->dvl.sample.lock = s[SIM_DVL].bottom ? AUVID_DVL_BOTTOM : AUVID_DVL_WATER;
    in->dvl.sample.valid = s[SIM_DVL].axes;
    copy(in->dvl.sample.velocity, s[SIM_DVL].value, 3);
    in->depth.present = s[SIM_DEPTH].has;
    in->depth.t_us = s[SIM_DEPTH].t_us;
    in->depth.depth_m = (auvid_real_t)s[SIM_DEPTH].value[0];
    in->gps.present = s[SIM_GPS].has;
    in->gps.t_us = s[SIM_GPS].t_us;
    in->gps.x_m = (auvid_real_t)s[SIM_GPS].value[0];
    in->gps.y_m = (auvid_real_t)s[SIM_GPS].value[1];
}

/* Arms and starts the excitation once the filter runs. */
static void begin(auvid_identifier_t *id)
{
    if (id->actuation->guard.state == AUVID_GUARD_DISARMED &&
        auvid_identifier_arm(id) == AUVID_OK) {
        (void)auvid_identifier_excite(id);
    }
}

void field_run_actuation(const field_run_config_t *config, auvid_actuation_config_t *cfg)
{
    const field_config_t *field = &config->field;
    field_sheet_t sheet;
    auvid_real_t peak[AUVID_DOF_COUNT];
    field_sheet(field->vehicle, field->seed, &sheet);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        peak[j] = (auvid_real_t)sheet.amplitude[j];
    }
    auvid_actuation_defaults(cfg);
    (void)auvid_excitation_plan(&cfg->excitation, peak, (auvid_real_t)SET_S, 1, field->seed);
    cfg->excitation.duration_s = (auvid_real_t)(SET_S * (double)config->sets);
    if (sheet.fast) {
        vehicle_use_fast_excitation(&cfg->excitation);
    }
    cfg->guard.off = AUVID_GUARD_SWITCHABLE;
}

/* Attaches the excitation and the uncertain inputs. Returns false if the library refuses them. */
static bool attach(field_run_t *run, const field_run_config_t *config)
{
    auvid_allocation_config_t thrusters;
    auvid_actuation_config_t cfg;
    field_run_actuation(config, &cfg);
    allocate(&run->field.sheet, &thrusters);
    if (auvid_allocation_init(&run->allocation, &thrusters) < 0 ||
        (config->field.driver == FIELD_EXCITED &&
         auvid_identifier_attach_actuation(&run->id, &run->actuation, &cfg, &run->allocation) <
             0)) {
        return false;
    }
    if (config->uncertain || config->reference) {
        auvid_uncertain_config_t inputs;
        auvid_uncertain_defaults(&inputs);
        if (!config->uncertain) {
            auvid_real_t lag_s = config->delay_s < 0.0 || config->delay_s > 0.0
                                     ? inputs.nominal_lag_s
                                     : AUVID_C(0.01);
            inputs = (auvid_uncertain_config_t){.nominal_lag_s = lag_s};
        }
        return auvid_identifier_attach_uncertain(&run->id, &run->uncertain, &inputs,
                                                 &run->allocation) >= 0 &&
               (!config->reference ||
                auvid_identifier_attach_instruments(&run->id, &run->instruments) >= 0);
    }
    return true;
}

/* Counts the alarms of the change test. */
static void count_alarms(uint32_t events, double t_s, field_record_t *record)
{
    record->changed += (events & AUVID_EVENT_CHANGED) != 0;
    if ((events & AUVID_EVENT_DRIFTED) != 0 && record->drifted++ == 0) {
        record->drifted_s = t_s;
    }
}

/* Records with the driver of run->field, of the excitation until all sets are complete, of others
 * for this time. */
static void record_motion(field_run_t *run, const field_run_config_t *config, double length_s,
                          field_record_t *record)
{
    bool excited = run->field.cfg.driver == FIELD_EXCITED;
    long ticks = lround(length_s * 1e6 / SIM_TICK_US),
         begin_at = lround(BEGIN_S * 1e6 / SIM_TICK_US);
    double thruster_N[SIM_THRUSTERS] = {0.0};
    auvid_identifier_t *id = &run->id;
    for (long k = 1; k <= ticks && !(excited && id->metric.sets.recorded >= config->sets); ++k) {
        field_output_t seen;
        auvid_input_t in;
        auvid_output_t out;
        field_step(&run->field, excited ? thruster_N : NULL, &seen);
        if (seen.reported) {
            auvid_real_t wrench[AUVID_DOF_COUNT], command[AUVID_MAX_COMMANDS] = {0};
            copy(wrench, seen.wrench, AUVID_DOF_COUNT);
            copy(command, seen.thruster_N, SIM_THRUSTERS);
            (void)auvid_identifier_applied(id, seen.reported_us, wrench, command);
        }
        if (excited && k >= begin_at) {
            begin(id);
        }
        sense(&seen, &in);
        if (config->reference) {
            auvid_real_t reference[AUVID_DOF_COUNT];
            copy(reference, seen.reference, AUVID_DOF_COUNT);
            (void)auvid_instruments_reference(&run->instruments, in.t_us, reference);
        }
        (void)auvid_identifier_step(id, &in, &out);
        count_alarms(out.events, 1e-6 * (double)in.t_us, record);
        (void)auvid_identifier_work(id, config->budget);
        for (int i = 0; i < SIM_THRUSTERS && i < AUVID_MAX_THRUSTERS; ++i) {
            thruster_N[i] = (double)out.thruster_N[i];
        }
        if (k % LOOK == 0) {
            field_built_t built;
            field_built(&run->field, &built);
            field_projection_add(&run->projection, field_truth(&run->field), &built);
        }
    }
}

/* Drag force of DoF e at this velocity, as reported by the library. causes: none, or with the
 * asymmetry. */
static void estimate_force(const auvid_identifier_t *id, const auvid_causes_t *causes, int e,
                           double velocity, field_force_t *to)
{
    const auvid_estimate_t *estimate = auvid_identifier_estimate(id);
    auvid_drag_t drag;
    to->half = HUGE_VAL;
    to->estimated = to->estimated && auvid_causes_drag(causes, estimate, id->metric.cfg.vehicle,
                                                       (auvid_dof_t)field_dof(e),
                                                       (auvid_real_t)velocity, &drag) == AUVID_OK;
    if (to->estimated) {
        to->value = (double)drag.force;
        to->half = drag.half_width < AUVID_LARGEST ? (double)drag.half_width : HUGE_VAL;
        to->flagged = drag.identifiable;
    }
}

static void estimate_forces(const auvid_identifier_t *id, field_record_t *record)
{
    const auvid_causes_t none = {.number = 0};
    for (int k = 0; k < FIELD_PARTS; ++k) {
        for (int d = 0; d < FIELD_DIRECTIONS; ++d) {
            int e = d / 2;
            double speed = field_part[k] * record->truth.speed[e][d % 2];
            double velocity = d % 2 == 0 ? speed : -speed;
            bool estimated = record->estimated[SIM_X_U + 2 * e];
            record->force[k][d].estimated = record->one_way[k][d].estimated = estimated;
            estimate_force(id, &none, e, velocity, &record->force[k][d]);
            estimate_force(id, &record->causes, e, velocity, &record->one_way[k][d]);
        }
    }
}

static void gather(const field_run_t *run, const field_run_config_t *config, field_record_t *record)
{
    const auvid_identifier_t *id = &run->id;
    const auvid_estimate_t *found = auvid_identifier_estimate(id);
    const auvid_estimate_t *estimate = found != NULL ? found : &id->estimate;
    field_built_t built;
    record->seed = config->field.seed;
    memcpy(record->size, config->field.size, sizeof record->size);
    record->not_converged = estimate->not_converged;
    record->sets = id->metric.sets.recorded;
    record->simulated_s = field_truth(&run->field)->t_s;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        auvid_real_t sigma = estimate->confidence.sigma[i];
        record->estimated[i] = estimate->number > 0 && (estimate->identified >> i & 1u) != 0;
        record->flagged[i] =
            record->estimated[i] && (estimate->confidence.identifiable >> i & 1u) != 0;
        record->note[i] =
            record->estimated[i] ? estimate->confidence.note[i] : (uint8_t)AUVID_NOTE_NOT_EXCITED;
        record->impossible[i] = record->note[i] != AUVID_NOTE_IMPLAUSIBLE &&
                                (estimate->confidence.implausible >> i & 1u) != 0;
        record->pi[i] = (double)estimate->pi[i];
        record->sigma[i] = record->estimated[i] && sigma < AUVID_LARGEST ? (double)sigma : HUGE_VAL;
    }
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        record->tau_max[e] = (double)id->metric.cfg.tau_max[field_dof(e)];
        record->delay_s[e] = (double)estimate->delay_s[field_dof(e)];
    }
    field_built(&run->field, &built);
    field_projection_solve(&run->projection, &built, &record->truth);
    estimate_forces(id, record);
}

bool field_run(field_run_t *run, const field_run_config_t *config, field_record_t *record)
{
    auvid_identifier_config_t *cfg = &run->id.cfg;
    memset(run, 0, sizeof *run);
    memset(record, 0, sizeof *record);
    field_run_identifier(config, &run->averaged, cfg);
    if (!field_init(&run->field, &config->field) ||
        (config->configure != NULL && !config->configure(cfg)) ||
        auvid_identifier_init(&run->id, cfg) < 0 ||
        auvid_identifier_attach_change_test(&run->id, &run->change) < 0 || !attach(run, config) ||
        (config->attach != NULL && !config->attach(&run->id))) {
        return false;
    }
    bool excited = config->field.driver == FIELD_EXCITED;
    record_motion(run, config,
                  excited ? (double)config->sets * SET_S + LATE_S : config->field.length_s, record);
    if (excited && config->then != FIELD_EXCITED) {
        (void)auvid_identifier_disarm(&run->id);
        run->field.cfg.driver = config->then;
        record_motion(run, config, THEN_S, record);
    }
    while (auvid_identifier_work(&run->id, AT_EASE) == AUVID_PENDING) {
    }
    if (run->id.attached.uncertain != NULL) {
        (void)auvid_uncertain_causes(&run->uncertain, &record->causes);
        record->prior_scale = (double)run->uncertain.scale;
    }
    gather(run, config, record);
    return true;
}
