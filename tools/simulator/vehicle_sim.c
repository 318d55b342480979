#include "vehicle_sim.h"

#include <math.h>
#include <string.h>

#include "auvid/guard.h"

/* Ticks in a second. */
#define SECOND (1000000u / SIM_TICK_US)

/* Frames of one tick that are being collected. */
typedef struct {
    vehicle_sim_t *vehicle;
    auvid_can_frame_t *frame;
    int count;
} sending_t;

void vehicle_sim_defaults(vehicle_sim_config_t *cfg)
{
    memset(cfg, 0, sizeof *cfg);
    sim_defaults(&cfg->sim);
    cfg->allocation = &auvid_allocation_girona500;
}

void vehicle_sim_truth(const vehicle_sim_t *vehicle, double truth[VEHICLE_SIM_PARAMETERS])
{
    const sim_config_t *c = &vehicle->sim.cfg;
    memset(truth, 0, VEHICLE_SIM_PARAMETERS * sizeof truth[0]);
    if (c->model == SIM_FOSSEN) {
        sim_fossen_parameters(&c->fossen, truth);
    } else if (c->model == SIM_VEHICLE) {
        memcpy(truth, c->vehicle_parameter, sizeof c->vehicle_parameter);
    } else {
        memcpy(truth, c->parameter, sizeof c->parameter);
    }
}

/* The wrench that holds the vehicle at rest. */
static void hover_wrench(const sim_config_t *c, auvid_real_t wrench[AUVID_DOF_COUNT])
{
    if (c->model == SIM_VEHICLE) {
        const auvid_sample_t rest = {0};
        auvid_real_t pi[SIM_VEHICLE_PARAMETERS];
        for (int i = 0; i < SIM_VEHICLE_PARAMETERS; ++i) {
            pi[i] = (auvid_real_t)c->vehicle_parameter[i];
        }
        auvid_vehicle_residual(c->vehicle, &rest, pi, wrench);
    } else {
        wrench[AUVID_HEAVE] =
            (auvid_real_t)(c->model == SIM_FOSSEN ? c->fossen.buoyancy_N - c->fossen.weight_N
                                                  : -c->parameter[SIM_WB]);
    }
}

static bool init_hover(vehicle_sim_t *vehicle, const auvid_allocation_config_t *cfg)
{
    const sim_config_t *c = &vehicle->sim.cfg;
    auvid_allocation_t allocation;
    auvid_allocation_result_t result;
    auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    hover_wrench(c, wrench);
    if (auvid_allocation_init(&allocation, cfg) < 0 ||
        auvid_allocation_solve(&allocation, wrench, &result) < 0) {
        return false;
    }
    for (int i = 0; i < c->thrusters; ++i) {
        vehicle->hover_N[i] = (double)result.force_N[i];
    }
    return true;
}

bool vehicle_sim_init(vehicle_sim_t *vehicle, const vehicle_sim_config_t *cfg)
{
    memset(vehicle, 0, sizeof *vehicle);
    vehicle->no_arm = cfg->no_arm;
    vehicle->arm_again = cfg->arm_again;
    return sim_init(&vehicle->sim, &cfg->sim) && init_hover(vehicle, cfg->allocation) &&
           auvid_can_sender_init(&vehicle->sender, NULL) >= 0 &&
           auvid_can_command_init(&vehicle->command, (uint8_t)cfg->sim.thrusters, NULL) >= 0;
}

static void take_message(vehicle_sim_t *vehicle, const auvid_can_message_t *m)
{
    if (m->kind == AUVID_CAN_TICK_DONE) {
        vehicle->done = m->as.tick_done.sequence;
    } else if (m->kind == AUVID_CAN_NAV_POSITION) {
        vehicle->navigates = true;
    } else if (m->kind == AUVID_CAN_ESTIMATE && m->absent == 0 &&
               m->as.estimate.index < VEHICLE_SIM_PARAMETERS) {
        vehicle->estimate[m->as.estimate.index] = (double)m->as.estimate.value;
        vehicle->estimated |= 1u << m->as.estimate.index;
    } else if (m->kind == AUVID_CAN_ESTIMATE_SIGMA &&
               m->as.estimate_sigma.index < VEHICLE_SIM_PARAMETERS) {
        vehicle->sigma[m->as.estimate_sigma.index] =
            m->absent == 0 ? (double)m->as.estimate_sigma.sigma : HUGE_VAL;
    } else if (m->kind == AUVID_CAN_PROGRESS) {
        vehicle->guard = (uint8_t)m->as.progress.guard;
        vehicle->work = (uint8_t)m->as.progress.work;
        vehicle->sets = m->as.progress.sets;
        vehicle->searches = m->as.progress.searches;
        vehicle->armed = vehicle->armed || vehicle->guard != AUVID_GUARD_DISARMED;
    } else {
        (void)auvid_causes_take(&vehicle->causes, m);
    }
}

void vehicle_sim_take(vehicle_sim_t *vehicle, const auvid_can_frame_t *frame)
{
    auvid_can_frame_t now = *frame;
    auvid_can_message_t message;
    now.t_us = vehicle->seen.t_us;
    if (auvid_can_command_take(&vehicle->command, &now) != AUVID_UNUSED) {
        ++vehicle->frames;
    } else if (auvid_can_unpack(NULL, &now, &message) == AUVID_OK) {
        ++vehicle->frames;
        take_message(vehicle, &message);
    }
}

double vehicle_sim_rms_percent(const vehicle_sim_t *vehicle)
{
    double truth[VEHICLE_SIM_PARAMETERS], sum = 0.0;
    int count = 0;
    vehicle_sim_truth(vehicle, truth);
    for (int i = 0; i < VEHICLE_SIM_PARAMETERS; ++i) {
        if (fabs(truth[i]) <= 0.0) {
            continue;
        }
        if (!(vehicle->estimated >> i & 1u)) {
            return -1.0;
        }
        double e = vehicle->estimate[i] / truth[i] - 1.0;
        sum += e * e;
        ++count;
    }
    return 100.0 * sqrt(sum / count);
}

static void send(sending_t *s, const auvid_can_message_t *message)
{
    if (s->count < VEHICLE_SIM_FRAMES &&
        auvid_can_pack(&s->vehicle->sender, message, &s->frame[s->count]) >= 0) {
        s->frame[s->count++].t_us = s->vehicle->seen.t_us;
    }
}

static void copy(auvid_real_t *to, const double *from, int n)
{
    for (int i = 0; i < n; ++i) {
        to[i] = (auvid_real_t)from[i];
    }
}

static uint32_t age_ms(const vehicle_sim_t *vehicle, const sim_measurement_t *sample)
{
    uint64_t age = (vehicle->seen.t_us - sample->t_us + 500u) / 1000u;
    return age < AUVID_CAN_AGE_UNKNOWN ? (uint32_t)age : AUVID_CAN_AGE_UNKNOWN;
}

static void send_imu(sending_t *s, const sim_measurement_t *imu)
{
    auvid_can_message_t attitude = {.kind = AUVID_CAN_IMU_ATTITUDE};
    auvid_can_message_t rates = {.kind = AUVID_CAN_IMU_RATES};
    auvid_can_imu_attitude_t *a = &attitude.as.imu_attitude;
    auvid_can_imu_rates_t *r = &rates.as.imu_rates;
    a->phi = (auvid_real_t)imu->value[0];
    a->theta = (auvid_real_t)imu->value[1];
    a->psi = (auvid_real_t)imu->value[2];
    r->p = (auvid_real_t)imu->value[3];
    r->q = (auvid_real_t)imu->value[4];
    r->r = (auvid_real_t)imu->value[5];
    a->age = r->age = age_ms(s->vehicle, imu);
    send(s, &attitude);
    send(s, &rates);
}

static void send_dvl(sending_t *s, const sim_measurement_t *dvl)
{
    auvid_can_message_t m = {.kind = dvl->bottom ? AUVID_CAN_DVL_BOTTOM : AUVID_CAN_DVL_WATER};
    auvid_real_t v[3];
    copy(v, dvl->value, 3);
    if (dvl->bottom) {
        auvid_can_dvl_bottom_t bottom = {v[0], v[1], v[2], age_ms(s->vehicle, dvl)};
        auvid_can_message_t height = {.kind = AUVID_CAN_DVL_ALTITUDE};
        m.as.dvl_bottom = bottom;
        height.as.dvl_altitude.altitude = (auvid_real_t)dvl->value[3];
        height.as.dvl_altitude.age = bottom.age;
        send(s, &height);
    } else {
        auvid_can_dvl_water_t water = {v[0], v[1], v[2], age_ms(s->vehicle, dvl)};
        m.as.dvl_water = water;
    }
    send(s, &m);
}

#define KIND(name, input, event, kind, ...) SIM_IF_##kind([SIM_##name] = AUVID_CAN_##name, )
static const auvid_can_kind_t position_kind[SIM_SENSORS] = {AUVID_SENSORS(KIND)};

/* A message of the axes and their age. */
static void send_position(sending_t *s, int sensor)
{
    const sim_measurement_t *position = &s->vehicle->seen.sensor[sensor];
    auvid_can_message_t m = {.kind = position_kind[sensor]};
    auvid_real_t value[3];
    uint32_t age = age_ms(s->vehicle, position);
    size_t bytes = (size_t)sim_positions[sensor].axes * sizeof value[0];
    copy(value, position->value, sim_positions[sensor].axes);
    memcpy(&m.as, value, bytes);
    memcpy((char *)&m.as + bytes, &age, sizeof age);
    send(s, &m);
}

static void send_sensors(sending_t *s)
{
    const sim_measurement_t *sensor = s->vehicle->seen.sensor;
    if (sensor[SIM_IMU].has) {
        send_imu(s, &sensor[SIM_IMU]);
    }
    if (sensor[SIM_DVL].has) {
        send_dvl(s, &sensor[SIM_DVL]);
    }
    for (int i = 0; i < SIM_SENSORS; ++i) {
        if (sim_positions[i].axes > 0 && sensor[i].has) {
            send_position(s, i);
        }
    }
}

static void send_feedback(sending_t *s)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_A};
    auvid_can_message_t b = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_B};
    double part[AUVID_CAN_THRUSTERS] = {0};
    for (int i = 0; i < s->vehicle->sim.cfg.thrusters; ++i) {
        double force = s->vehicle->seen.thruster_N[i];
        part[i] = force / sim_thruster_limit(&s->vehicle->sim.cfg, i, force);
    }
    copy(a.as.thruster_feedback_a.thrust, part, 4);
    copy(b.as.thruster_feedback_b.thrust, part + 4, 4);
    send(s, &a);
    send(s, &b);
}

static void send_orders(sending_t *s)
{
    vehicle_sim_t *vehicle = s->vehicle;
    vehicle->ticks_navigated += vehicle->navigates;
    bool due = vehicle->ticks_navigated > 0 && vehicle->ticks_navigated % SECOND == 0;
    bool aborted = vehicle->arm_again && vehicle->guard == AUVID_GUARD_ABORTED;
    vehicle->armed =
        vehicle->armed && !(vehicle->arm_again && vehicle->guard == AUVID_GUARD_DISARMED);
    if (vehicle->order_arm || (due && !vehicle->no_arm && (!vehicle->armed || aborted))) {
        auvid_can_message_t m = {.kind = AUVID_CAN_ARM};
        m.as.arm.action = aborted ? AUVID_CAN_ACTION_DISARM : AUVID_CAN_ACTION_ARM;
        m.as.arm.key = AUVID_CAN_ARM_KEY;
        send(s, &m);
    }
    if (vehicle->order_abort) {
        auvid_can_message_t m = {.kind = AUVID_CAN_ABORT};
        m.as.abort.cause = AUVID_CAN_CAUSE_OPERATOR;
        send(s, &m);
    }
    vehicle->order_arm = vehicle->order_abort = false;
}

bool vehicle_sim_commanded(vehicle_sim_t *vehicle, double force_N[SIM_THRUSTERS])
{
    auvid_real_t thrust[AUVID_CAN_THRUSTERS];
    auvid_status_t status = auvid_can_command_thrust(&vehicle->command, vehicle->seen.t_us, thrust);
    for (int i = 0; i < vehicle->sim.cfg.thrusters; ++i) {
        double part = (double)thrust[i];
        force_N[i] = part * sim_thruster_limit(&vehicle->sim.cfg, i, part);
    }
    return status == AUVID_OK;
}

static void drive(vehicle_sim_t *vehicle)
{
    double asked[SIM_THRUSTERS];
    bool before = vehicle->commanded;
    vehicle->commanded = vehicle_sim_commanded(vehicle, asked);
    if (before && !vehicle->commanded) {
        ++vehicle->cuts;
        vehicle->cut_us = vehicle->seen.t_us - vehicle->command.half[0].good_us;
    }
    for (int i = 0; i < vehicle->sim.cfg.thrusters; ++i) {
        vehicle->force_N[i] = vehicle->hover_N[i] + asked[i];
    }
}

int vehicle_sim_tick(vehicle_sim_t *vehicle, auvid_can_frame_t *frame)
{
    sending_t s = {vehicle, frame, 0};
    auvid_can_message_t tick = {.kind = AUVID_CAN_TICK};
    drive(vehicle);
    sim_step(&vehicle->sim, vehicle->force_N, NULL, &vehicle->seen);
    send_sensors(&s);
    send_feedback(&s);
    send_orders(&s);
    vehicle->sequence = (vehicle->sequence + 1u) & 0xFFFFFu;
    tick.as.tick.sequence = vehicle->sequence;
    tick.as.tick.time = (uint32_t)vehicle->seen.t_us;
    send(&s, &tick);
    return s.count;
}
