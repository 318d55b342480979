/*
 * Rates over windows of half a second. The difference of the means of two cells is the integral of
 * the rate, weighted by a trapezium: the rate's samples are averaged with the same weights.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

#define WINDOW_S (DOCTOR_WINDOW * DOCTOR_CELL_S)
#define RIGHT_ANGLE 1.5707963267948966
#define UPRIGHT 0.3    /* from a right angle [rad] */
#define ACTS 0.02      /* an input, relative to its largest so far */
#define REST_CELLS 150 /* without input, until a vehicle is at rest */

static const doctor_cell_t *cell_before(const doctor_t *d, int cells)
{
    return &d->past[(d->windows + DOCTOR_HISTORY - cells) % DOCTOR_HISTORY];
}

static double average(const doctor_t *d, int signal)
{
    double sum = 0.0;
    for (int k = 0; k <= DOCTOR_WINDOW; ++k) {
        double weight = k == 0 || k == DOCTOR_WINDOW ? 0.5 : 1.0;
        sum += weight * cell_before(d, k)->mean[signal];
    }
    return sum / DOCTOR_WINDOW;
}

static double slope(const doctor_t *d, int signal)
{
    return (cell_before(d, 0)->mean[signal] - cell_before(d, DOCTOR_WINDOW)->mean[signal]) /
           WINDOW_S;
}

/* Is pitch near a right angle in the window? There roll and heading turn by half a circle at once,
 * and their means are those of no attitude. */
static bool is_upright(const doctor_t *d, int pitch)
{
    bool upright = false;
    for (int k = 0; k <= DOCTOR_WINDOW; ++k) {
        double theta = fabs(cell_before(d, k)->mean[pitch]);
        upright = upright || fabs(theta - RIGHT_ANGLE) < UPRIGHT;
    }
    return upright;
}

/* Body rates of the attitude (Fossen 2011, Eq. 2.26 inverted). A log without psi has its rate from
 * q and r: roll and pitch of a tilted vehicle depend on it. The axis of r is not compared then. */
static void turn_rates(const doctor_t *d, int first, double side, double out[3])
{
    if (is_upright(d, first + 1)) {
        out[0] = out[1] = out[2] = NAN;
        return;
    }
    double phi = average(d, first), theta = average(d, first + 1);
    double roll = slope(d, first), pitch = slope(d, first + 1);
    bool has_psi = d->has[CSV_ATTITUDE + 2], has_rates = d->has[CSV_NU + 4] && d->has[CSV_NU + 5];
    double yaw = side * slope(d, first + 2);
    if (!has_psi) {
        double q = average(d, CELL_NU + 4), r = side * average(d, CELL_NU + 5);
        yaw = has_rates ? (q * sin(phi) + r * cos(phi)) / cos(theta) : NAN;
    }
    out[0] = roll - yaw * sin(theta);
    out[1] = pitch * cos(phi) + yaw * cos(theta) * sin(phi);
    out[2] = has_psi ? yaw * cos(theta) * cos(phi) - pitch * sin(phi) : NAN;
}

void doctor_to_body(const double a[3], const double world[3], double body[3])
{
    double ahead = cos(a[2]) * world[0] + sin(a[2]) * world[1];
    double side = cos(a[2]) * world[1] - sin(a[2]) * world[0];
    double down = sin(a[1]) * ahead + cos(a[1]) * world[2];
    body[0] = cos(a[1]) * ahead - sin(a[1]) * world[2];
    body[1] = cos(a[0]) * side + sin(a[0]) * down;
    body[2] = cos(a[0]) * down - sin(a[0]) * side;
}

/* Rates of depth and position, and what the velocity says of them. */
static void travel(const doctor_t *d, doctor_window_t *w)
{
    const double *a = w->angle, *v = w->nu;
    double psi = average(d, CELL_ANGLE + 2);
    double north = slope(d, CELL_POSITION), east = slope(d, CELL_POSITION + 1);
    w->depth_rate = slope(d, CELL_POSITION + 2);
    w->sink[0] = -v[0] * sin(a[1]);
    w->sink[1] = v[1] * cos(a[1]) * sin(a[0]);
    w->sink[2] = v[2] * cos(a[1]) * cos(a[0]);
    for (int k = 0; k < 2; ++k) {
        double s = k == 0 ? sin(psi) : -sin(psi);
        w->over_ground[k][0] =
            (cos(psi) * north + s * east) * cos(a[1]) - sin(a[1]) * w->depth_rate;
        w->over_ground[k][1] = -s * north + cos(psi) * east;
    }
    double ahead = w->over_ground[0][0] - v[0], side = w->over_ground[0][1] - v[1];
    w->travel[0] = north;
    w->travel[1] = east;
    w->drift[0] = cos(psi) * ahead - sin(psi) * side;
    w->drift[1] = sin(psi) * ahead + cos(psi) * side;
}

/* Specific force: acceleration in inertial axes less gravity. Without velocity, of a vehicle that
 * does not accelerate. */
static void specific_force(const doctor_t *d, doctor_window_t *w)
{
    const double *v = w->nu, *rate = w->nu + 3, *a = w->angle;
    const double down[3] = {-sin(a[1]), cos(a[1]) * sin(a[0]), cos(a[1]) * cos(a[0])};
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double inertial = w->acceleration[i] + rate[j] * v[k] - rate[k] * v[j];
        w->force[i] = average(d, CELL_FORCE + i);
        w->expected[i] = (isfinite(inertial) ? inertial : 0.0) - DOCTOR_GRAVITY * down[i];
        w->inertial[i] = inertial;
    }
}

/* Surge and sway, as DoF first and first + 1, if the velocities are in the world. */
static void turn_velocity(doctor_window_t *w, int first, double body[3])
{
    const double *rate = w->nu + 3, *v = w->nu, *dot = w->acceleration;
    bool enu = first == DOCTOR_ENU;
    const double ned[3] = {enu ? v[1] : v[0], enu ? v[0] : v[1], enu ? -v[2] : v[2]};
    const double ned_dot[3] = {enu ? dot[1] : dot[0], enu ? dot[0] : dot[1],
                               enu ? -dot[2] : dot[2]};
    double turned[3];
    doctor_to_body(w->angle, ned, body);
    doctor_to_body(w->angle, ned_dot, turned);
    for (int i = 0; i < 2; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        w->nu[first + i] = body[i];
        w->acceleration[first + i] = turned[i] - rate[j] * body[k] + rate[k] * body[j];
        w->input[first + i] = w->input[i];
    }
}

static void make_window(const doctor_t *d, doctor_window_t *w)
{
    turn_rates(d, CELL_ANGLE, 1.0, w->body_rate[0]);
    turn_rates(d, CELL_DEGREE, 1.0, w->body_rate[1]);
    turn_rates(d, CELL_ANGLE, -1.0, w->body_rate[2]);
    turn_rates(d, CELL_ORDER, 1.0, w->body_rate[3]);
    turn_rates(d, CELL_CONJUGATE, 1.0, w->body_rate[4]);
    for (int j = 0; j < 3; ++j) {
        w->angle[j] = average(d, CELL_ANGLE + j);
    }
    for (int j = 0; j < 6; ++j) {
        w->nu[j] = average(d, CELL_NU + j);
        w->acceleration[j] = slope(d, CELL_NU + j);
        w->input[j] = average(d, CELL_INPUT + j);
    }
    double body[3], enu[3];
    turn_velocity(w, DOCTOR_WORLD, body);
    turn_velocity(w, DOCTOR_ENU, enu);
    for (int j = 0; j < DOCTOR_AXES; ++j) {
        w->quadratic[j] = fabs(w->nu[j]) * w->nu[j];
    }
    const double *v = w->nu;
    const double couple[DOCTOR_AXES][2] = {
        {v[1] * v[5], v[2] * v[4]},       {v[0] * v[5], v[2] * v[3]},
        {v[0] * v[4], v[1] * v[3]},       {sin(w->angle[0]), v[1] * v[2]},
        {sin(w->angle[1]), v[0] * v[2]},  {v[0] * v[1], v[0] * v[3]},
        {body[1] * v[5], body[2] * v[4]}, {body[0] * v[5], body[2] * v[3]},
        {enu[1] * v[5], enu[2] * v[4]},   {enu[0] * v[5], enu[2] * v[3]}};
    memcpy(w->couple, couple, sizeof couple);
    for (int k = 0; k < AUVID_MAX_THRUSTERS; ++k) {
        w->thrust[k] = average(d, CELL_THRUST + k);
    }
    travel(d, w);
    specific_force(d, w);
}

/* Counts the time without input. Before the first one the vehicle rests. */
static void count_idle(doctor_t *d, const doctor_cell_t *cell)
{
    static const int axis[3] = {0, 1, 5};
    bool acts = d->inputs < 0;
    for (int i = 0; i < 3 && !acts; ++i) {
        int column = d->inputs + axis[i];
        double input = fabs(cell->mean[CELL_INPUT + axis[i]]);
        acts = d->has[column] && !(input <= ACTS * d->column[column].limit);
    }
    d->idle = acts ? 0 : d->idle < REST_CELLS ? d->idle + 1 : d->idle;
}

void doctor_window_add(doctor_t *d, const doctor_cell_t *cell)
{
    doctor_window_t *w = &d->window[d->windows % DOCTOR_HISTORY];
    if (d->windows == 0) {
        d->idle = REST_CELLS;
    }
    d->past[d->windows % DOCTOR_HISTORY] = *cell;
    count_idle(d, cell);
    make_window(d, w);
    w->rests = d->idle == REST_CELLS;
    doctor_sums_add(d);
    ++d->windows;
}
