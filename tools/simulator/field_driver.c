/*
 * The drivers. All except the excitation use only what the sensors measure: depth, attitude and
 * rates, velocity of the last DVL sample, dead-reckoned position. They command a wrench in surge,
 * sway, heave and yaw, added to hover thrust. The pseudo-inverse distributes it to the thrusters,
 * each of which saturates.
 *
 * Hover thrust balances the initial weight in water, in reported thrust.
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

enum { X, Y, Z, N, WANTED };

#define TICK_S (SIM_TICK_US * 1e-6)
/* Excited: distance from the initial depth [m] beyond which thrust acts back, and its gain as a
 * fraction of the amplitude per metre. Stronger near the bottom, and damped. */
#define EXCITED_DEPTH_M 3.0
#define EXCITED_LEAD 0.05
#define NEAR_DEPTH_M 0.1
#define NEAR_LEAD 2.0
/* Depth errors [m] at which the pilot starts and ends a correction; smaller near the bottom. */
#define PILOT_FAR_M 2.0
#define PILOT_NEAR_M 0.5
#define PILOT_NEAR_BOTTOM 0.15
#define PILOT_HAND_S 0.3
/* What a full stick asks of the holds of depth and heading. */
#define DIVE_M_S 0.2
#define TURN_RAD_S 0.4
#define LEG_M 18.0
#define LANE_M 3.0
#define LANES 6
#define ALTERNATE_S 0.5
/* Change between DVL samples above which the new one is rejected. */
#define VELOCITY_JUMP_M_S 0.6

void field_pilot_init(field_t *field)
{
    static const int axis[WANTED] = {0, 1, 2, 5};
    const field_sheet_t *sheet = &field->sheet;
    field_pilot_t *p = &field->pilot;
    memset(p, 0, sizeof *p);
    p->position[2] = field->truth.position[2];
    p->reference[2] = FIELD_START_M;
    sim_rng_seed(&p->rng, field->cfg.seed, FIELD_STREAM_PILOT);
    sim_rng_seed(&p->aside_rng, field->cfg.seed, FIELD_STREAM_ALTERNATE);
    for (int i = 0; i < WANTED; ++i) { /* T' (T T')^-1 */
        double square[6][6] = {{0}}, x[6] = {0};
        for (int k = 0; k < 6; ++k) {
            square[k][k] = k < WANTED ? 0.0 : 1.0;
        }
        for (int k = 0; k < WANTED; ++k) {
            for (int l = 0; l < WANTED; ++l) {
                for (int j = 0; j < sheet->thrusters; ++j) {
                    square[k][l] += sheet->matrix[axis[k]][j] * sheet->matrix[axis[l]][j];
                }
            }
        }
        x[i] = 1.0;
        (void)sim_solve(square, x); /* full rank: all vehicles actuate all four */
        for (int j = 0; j < sheet->thrusters; ++j) {
            for (int k = 0; k < WANTED; ++k) {
                p->mix[j][i] += sheet->matrix[axis[k]][j] * x[k];
            }
        }
    }
    for (int j = 0; j < sheet->thrusters; ++j) {
        p->hover_N[j] = -p->mix[j][Z] * (field->hull.weight_N - field->hull.buoyancy_N);
    }
}

void field_pilot_observe(field_t *field, const field_output_t *out)
{
    field_pilot_t *p = &field->pilot;
    const sim_measurement_t *imu = &out->sensor[SIM_IMU], *dvl = &out->sensor[SIM_DVL];
    double r[3][3], over[3];
    if (imu->has) {
        memcpy(p->euler, imu->value, sizeof p->euler);
        memcpy(p->rates, imu->value + 3, sizeof p->rates);
    }
    if (dvl->has && dvl->axes == 7) {
        double jump = 0.0;
        for (int i = 0; i < 3; ++i) {
            jump = fmax(jump, fabs(dvl->value[i] - p->velocity[i]));
        }
        if (!p->has_velocity || jump < VELOCITY_JUMP_M_S) {
            memcpy(p->velocity, dvl->value, sizeof p->velocity);
        }
        p->has_velocity = jump < VELOCITY_JUMP_M_S; /* the second such sample is accepted */
    }
    sim_rotation(p->euler, r);
    field_rotate(r, p->velocity, over);
    for (int i = 0; i < 2; ++i) {
        p->position[i] += over[i] * TICK_S;
    }
    p->position[2] = out->sensor[SIM_DEPTH].has ? out->sensor[SIM_DEPTH].value[0] : p->position[2];
}

/* ---- the excitation, and a pilot with a joystick ---- */

static void excited(field_t *field, double want[WANTED])
{
    const field_sheet_t *sheet = &field->sheet;
    bool near = field->cfg.size[FIELD_WALL] > 0.0;
    double low = field->pilot.position[2] - FIELD_START_M;
    double beyond = copysign(fmax(fabs(low) - (near ? NEAR_DEPTH_M : EXCITED_DEPTH_M), 0.0), low);
    double lead = (near ? NEAR_LEAD : EXCITED_LEAD) * sheet->amplitude[2];
    want[Z] = -lead * fmax(-4.0, fmin(4.0, beyond));
    if (near && fabs(beyond) > 0.0) {
        want[Z] -= 2.0 * sqrt(lead * sheet->parameter[SIM_M_W]) * field->pilot.velocity[2];
    }
}

/* Each stick moves to a new position at random times, usually away from the centre. */
static void move_sticks(field_t *field)
{
    field_pilot_t *p = &field->pilot;
    double now = 1e-6 * (double)field->t_us, low = p->position[2] - FIELD_START_M;
    double care = field->cfg.size[FIELD_WALL] > 0.0 ? PILOT_NEAR_BOTTOM : 1.0;
    p->deep = fabs(low) > care * (p->deep ? PILOT_NEAR_M : PILOT_FAR_M);
    for (int i = 0; i < WANTED; ++i) {
        if (now >= p->stick_s[i]) {
            bool away = sim_rng_uniform(&p->rng) < 0.65;
            double far = 0.3 + 0.7 * sim_rng_uniform(&p->rng);
            far = sim_rng_uniform(&p->rng) < 0.5 ? far : -far;
            p->stick_to[i] = away ? far : 0.0;
            p->stick_s[i] = now + 2.0 + 6.0 * sim_rng_uniform(&p->rng);
        }
        double to = i == Z && p->deep ? copysign(0.6, -low) : p->stick_to[i];
        p->stick[i] += (to - p->stick[i]) * TICK_S / PILOT_HAND_S;
    }
}

static void joystick(field_t *field, double want[WANTED])
{
    static const int axis[WANTED] = {0, 1, 2, 5};
    move_sticks(field);
    for (int i = 0; i < WANTED; ++i) {
        want[i] = field->pilot.stick[i] * field->sheet.amplitude[axis[i]];
    }
}

/* ---- controllers ---- */

/* PID of a body with mass m: poles at `bandwidth`, the integral slower. */
static double pid(double *sum, double error, double error_rate, double m, double bandwidth,
                  double limit)
{
    double gain = m * bandwidth * bandwidth, damping = 2.0 * m * bandwidth;
    *sum += gain * bandwidth / 6.0 * error * TICK_S;
    *sum = fmax(-limit, fmin(limit, *sum));
    return fmax(-limit, fmin(limit, gain * error + damping * error_rate + *sum));
}

/* Moves the reference about its path: to one side, then to the other, at random times. */
static void alternate(field_t *field)
{
    field_pilot_t *p = &field->pilot;
    double now = 1e-6 * (double)field->t_us;
    for (int i = 0; i < WANTED && field->cfg.alternate_m > 0.0; ++i) {
        double size = field->cfg.alternate_m * (i == N ? 0.5 : 1.0), most = 0.5 * size;
        if (now >= p->aside_s[i]) {
            p->aside_to[i] = p->aside_to[i] > 0.0 ? -size : size;
            p->aside_s[i] = now + 3.0 + 9.0 * sim_rng_uniform(&p->aside_rng);
        }
        double wanted = fmax(-most, fmin(most, p->aside_to[i] - p->aside[i]));
        p->aside_rate[i] += (wanted - p->aside_rate[i]) * TICK_S / ALTERNATE_S;
        p->aside[i] += p->aside_rate[i] * TICK_S;
    }
}

/* Holds the reference position, depth and heading.
 * rate, turn: velocity of the reference, north and east; rate of its heading */
static void hold(field_t *field, const double rate[2], double turn, double want[WANTED])
{
    const field_sheet_t *sheet = &field->sheet;
    const double *mass = sheet->parameter + SIM_M_U, *limit = sheet->amplitude;
    field_pilot_t *p = &field->pilot;
    double c = cos(p->reference_heading), s = sin(p->reference_heading), b = sheet->bandwidth;
    const double *d = p->aside, *v = p->aside_rate;
    alternate(field);
    double north = p->reference[0] + c * d[X] - s * d[Y] - p->position[0];
    double east = p->reference[1] + s * d[X] + c * d[Y] - p->position[1];
    const double over[2] = {rate[0] + c * v[X] - s * v[Y] - turn * (s * d[X] + c * d[Y]),
                            rate[1] + s * v[X] + c * v[Y] + turn * (c * d[X] - s * d[Y])};
    double heading = p->reference_heading + d[N];
    p->reference_nu[0] = cos(heading) * over[0] + sin(heading) * over[1];
    p->reference_nu[1] = cos(heading) * over[1] - sin(heading) * over[0];
    p->reference_nu[2] = v[Z];
    p->reference_nu[5] = turn + v[N];
    double off = remainder(heading - p->euler[2], 2.0 * FIELD_PI);
    double down = p->reference[2] + d[Z] - p->position[2];
    c = cos(p->euler[2]), s = sin(p->euler[2]);
    want[X] = pid(&p->sum[X], c * north + s * east, c * over[0] + s * over[1] - p->velocity[0],
                  mass[0], b, limit[0]);
    want[Y] = pid(&p->sum[Y], c * east - s * north, c * over[1] - s * over[0] - p->velocity[1],
                  mass[1], b, limit[1]);
    want[Z] = pid(&p->sum[Z], down, v[Z] - p->velocity[2], mass[2], b, limit[2]);
    want[N] = pid(&p->sum[N], off, v[N] - p->rates[2], mass[3], 2.0 * b, limit[5]);
}

/* Sticks act as thrust in surge and sway, and move the references of depth and heading. */
static void assisted(field_t *field, double want[WANTED])
{
    const field_sheet_t *sheet = &field->sheet;
    const double *mass = sheet->parameter + SIM_M_U, *limit = sheet->amplitude;
    double b = sheet->bandwidth;
    field_pilot_t *p = &field->pilot;
    move_sticks(field);
    double dive = DIVE_M_S * p->stick[Z], turn = TURN_RAD_S * p->stick[N];
    p->reference[2] += dive * TICK_S;
    p->reference_heading += turn * TICK_S;
    double off = remainder(p->reference_heading - p->euler[2], 2.0 * FIELD_PI);
    want[X] = p->stick[X] * limit[0];
    want[Y] = p->stick[Y] * limit[1];
    want[Z] = pid(&p->sum[Z], p->reference[2] - p->position[2], dive - p->velocity[2], mass[2], b,
                  limit[2]);
    want[N] = pid(&p->sum[N], off, turn - p->rates[2], mass[3], 2.0 * b, limit[5]);
}

static void station(field_t *field, double want[WANTED])
{
    const double still[2] = {0};
    hold(field, still, 0.0, want);
}

/* The reference moves along the leg, then to the next leg while the heading turns. */
static void lawnmower(field_t *field, double want[WANTED])
{
    const field_sheet_t *sheet = &field->sheet;
    field_pilot_t *p = &field->pilot;
    bool across = p->leg % 2 == 1;
    int lane = p->leg / 2;
    double back = lane % 2 == 0 ? 1.0 : -1.0, side = lane / LANES % 2 == 0 ? 1.0 : -1.0;
    double length = across ? LANE_M : LEG_M, rate[2];
    double to =
        across ? (side > 0.0 ? FIELD_PI / 2.0 : -FIELD_PI / 2.0) : (back > 0.0 ? 0.0 : FIELD_PI);
    double gone = hypot(p->reference[0] - p->from[0], p->reference[1] - p->from[1]);
    double wanted = fmin(sheet->speed_m_s * (across ? 0.5 : 1.0), 0.3 * (length - gone) + 0.03);
    p->reference_speed += (wanted - p->reference_speed) * TICK_S / 1.5;
    rate[0] = p->reference_speed * cos(to);
    rate[1] = p->reference_speed * sin(to);
    p->reference[0] += rate[0] * TICK_S;
    p->reference[1] += rate[1] * TICK_S;
    double heading = across ? (back > 0.0 ? FIELD_PI : 0.0) : to;
    double turn = remainder(heading - p->reference_heading, 2.0 * FIELD_PI);
    turn = fmax(-0.3, fmin(0.3, turn));
    p->reference_heading += turn * TICK_S;
    if (gone >= length) {
        ++p->leg;
        memcpy(p->from, p->reference, sizeof p->from);
    }
    hold(field, rate, turn, want);
}

void field_pilot_drive(field_t *field, const double *thruster_N, double command_N[SIM_THRUSTERS])
{
    static void (*const drive[FIELD_DRIVERS])(field_t *,
                                              double[WANTED]) = {[FIELD_EXCITED] = excited,
                                                                 [FIELD_JOYSTICK] = joystick,
                                                                 [FIELD_ASSISTED] = assisted,
                                                                 [FIELD_LAWNMOWER] = lawnmower,
                                                                 [FIELD_STATION] = station};
    const field_sheet_t *sheet = &field->sheet;
    const field_pilot_t *p = &field->pilot;
    bool added = field->cfg.driver == FIELD_EXCITED && thruster_N != NULL;
    double want[WANTED] = {0};
    drive[field->cfg.driver](field, want);
    for (int j = 0; j < sheet->thrusters; ++j) {
        double asked = added && isfinite(thruster_N[j]) ? thruster_N[j] : 0.0;
        command_N[j] = p->hover_N[j] + asked;
        for (int i = 0; i < WANTED; ++i) {
            command_N[j] += p->mix[j][i] * want[i];
        }
    }
}
