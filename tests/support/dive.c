#include "dive.h"

#include <math.h>
#include <string.h>

#include "field_parts.h"

#define TICKS 32000
#define DEGREES (180.0 / FIELD_PI)
#define KNOTS 1.9438 /* in a metre per second */

enum { STREAM = 5000 }; /* of the random numbers of this file */

const char *const slip_name[SLIPS] = {"angles in degrees", "rates in degrees", "angle reversed",
                                      "velocity reversed", "axes exchanged",   "ENU or FLU",
                                      "shifted in time",   "input reversed",   "inputs exchanged",
                                      "held, zero, PWM",   "accelerometer",    "kgf, knots",
                                      "world axes",        "quaternion"};

/* ---- the vehicle ---- */

/* Scales hull and thrust of an initialised vehicle; W - B remains, so that it hovers. */
static void scale_vehicle(field_t *field, sim_rng_t *rng)
{
    field_hull_t *h = &field->hull;
    double mass = exp(0.5 * (2.0 * sim_rng_uniform(rng) - 1.0));
    double drag = exp(0.5 * (2.0 * sim_rng_uniform(rng) - 1.0));
    double heavy = h->weight_N - h->buoyancy_N;
    h->dry_kg *= mass;
    h->weight_N *= mass;
    h->buoyancy_N = h->weight_N - heavy;
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            h->added[i][j] *= mass;
        }
        h->linear[i] *= drag;
        h->quadratic[i] *= drag;
    }
    for (int i = 0; i < 3; ++i) {
        h->inertia[i] *= mass;
    }
    h->lift_sway *= drag;
    h->lift_yaw *= drag;
    h->lift_heave *= drag;
    field_hull_ballast(h, 0.0); /* forms the matrices again */
}

/* Steps and sines of all four DoF, to thrusters. */
typedef struct {
    sim_rng_t rng;
    double level[4], until_s[4], rad_s[4];
    double amplitude[4];
} excitation_t;

static void excite(excitation_t *e, const field_t *field, double t_s, double thruster_N[])
{
    memset(thruster_N, 0, SIM_THRUSTERS * sizeof *thruster_N);
    for (int i = 0; i < 4; ++i) {
        if (t_s >= e->until_s[i]) {
            e->until_s[i] = t_s + 1.0 + 4.0 * sim_rng_uniform(&e->rng);
            e->level[i] = 2.0 * sim_rng_uniform(&e->rng) - 1.0;
            e->rad_s[i] = sim_rng_uniform(&e->rng) < 0.5 ? 0.0 : 1.0 + sim_rng_uniform(&e->rng);
        }
        double wanted = e->amplitude[i] * e->level[i];
        wanted *= e->rad_s[i] > 0.0 ? sin(e->rad_s[i] * t_s) : 1.0;
        for (int j = 0; j < SIM_THRUSTERS; ++j) {
            thruster_N[j] += field->pilot.mix[j][i] * wanted;
        }
    }
}

/* ---- the log ---- */

/* Samples of the instruments, each at its time. */
typedef struct {
    double t_s[TICKS], value[TICKS][9];
    int count;
} series_t;

static void append(series_t *s, double t_s, const double *value, int n)
{
    if (s->count < TICKS && (s->count == 0 || t_s > s->t_s[s->count - 1])) {
        s->t_s[s->count] = t_s;
        memcpy(s->value[s->count++], value, (size_t)n * sizeof *value);
    }
}

/* Interpolates linearly; false outside, or in a gap over half a second. */
static bool interpolate(const series_t *s, int *at, double t_s, int n, double *out)
{
    while (*at + 1 < s->count && s->t_s[*at + 1] <= t_s) {
        ++*at;
    }
    if (*at + 1 >= s->count || s->t_s[*at] > t_s || s->t_s[*at + 1] - s->t_s[*at] > 0.5) {
        return false;
    }
    double part = (t_s - s->t_s[*at]) / (s->t_s[*at + 1] - s->t_s[*at]);
    for (int i = 0; i < n; ++i) {
        out[i] = s->value[*at][i] + part * (s->value[*at + 1][i] - s->value[*at][i]);
    }
    return true;
}

static series_t imu, dvl, depth, wrench;

/* Specific force where the accelerometer is: acceleration less gravity, with bias and noise, in the
 * axes of the instrument. The water does not accelerate. */
static void specific_force(const field_t *field, sim_rng_t *rng, double out[3])
{
    static const double arm_m[3] = {0.1, 0.05, -0.05}, bias[3] = {0.05, -0.05, 0.1};
    const field_truth_t *t = &field->truth;
    const double *nu = t->nu, *rate = t->nu + 3, *turn = t->nu_dot + 3;
    const double down[3] = {-sin(t->euler[1]), cos(t->euler[1]) * sin(t->euler[0]),
                            cos(t->euler[1]) * cos(t->euler[0])};
    double spin[3], body[3];
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        spin[i] = rate[j] * arm_m[k] - rate[k] * arm_m[j];
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        body[i] = t->nu_dot[i] + rate[j] * nu[k] - rate[k] * nu[j] + turn[j] * arm_m[k] -
                  turn[k] * arm_m[j] + rate[j] * spin[k] - rate[k] * spin[j] - 9.81 * down[i];
    }
    for (int i = 0; i < 3; ++i) {
        out[i] = bias[i] + 0.05 * sim_rng_gauss(rng);
        for (int j = 0; j < 3; ++j) {
            out[i] += field->sensing.imu_mount[j][i] * body[j];
        }
    }
}

static void record(field_t *field, const dive_config_t *cfg, sim_rng_t *rng)
{
    double thruster_N[SIM_THRUSTERS];
    const double *amplitude = field->sheet.amplitude;
    excitation_t e = {.rng = *rng};
    sim_rng_t noise;
    for (int i = 0; i < 4; ++i) {
        e.amplitude[i] = amplitude[i < 3 ? i : 5] * (0.4 + 0.6 * sim_rng_uniform(&e.rng));
    }
    sim_rng_seed(&noise, cfg->field.seed, STREAM - 1);
    imu.count = dvl.count = depth.count = wrench.count = 0;
    for (long k = 0; k < lround(cfg->field.length_s * 50.0) && k < TICKS; ++k) {
        field_output_t out;
        excite(&e, field, 0.02 * (double)k, thruster_N);
        field_step(field, thruster_N, &out);
        const sim_measurement_t *m = out.sensor;
        if (m[SIM_IMU].has) {
            double value[9];
            memcpy(value, m[SIM_IMU].value, 6 * sizeof *value);
            specific_force(field, &noise, value + 6);
            append(&imu, 1e-6 * (double)m[SIM_IMU].t_us, value, 9);
        }
        if (m[SIM_DVL].has && m[SIM_DVL].axes == 7) {
            append(&dvl, 1e-6 * (double)m[SIM_DVL].t_us, m[SIM_DVL].value, 3);
        }
        if (m[SIM_DEPTH].has) {
            append(&depth, 1e-6 * (double)m[SIM_DEPTH].t_us, m[SIM_DEPTH].value, 1);
        }
        if (out.reported) {
            append(&wrench, 1e-6 * (double)out.reported_us, out.wrench, 6);
        }
    }
}

/* Writes rows at the times of the IMU, or at some of them. */
static void write_rows(dive_t *dive, const dive_config_t *cfg, sim_rng_t *rng)
{
    int at_dvl = 0, at_depth = 0, at_wrench = 0;
    double next_s = 0.0;
    dive->rows = 0;
    for (int k = 0; k < imu.count && dive->rows < DIVE_ROWS; ++k) {
        double t = imu.t_s[k];
        csv_row_t *row = &dive->row[dive->rows];
        if (t < next_s) {
            continue;
        }
        memset(row, 0, sizeof *row);
        while (at_wrench + 1 < wrench.count && wrench.t_s[at_wrench + 1] <= t + 1e-6) {
            ++at_wrench;
        }
        row->value[CSV_T] = t;
        memcpy(&row->value[CSV_ATTITUDE], imu.value[k], 3 * sizeof(double));
        memcpy(&row->value[CSV_NU + 3], imu.value[k] + 3, 3 * sizeof(double));
        memcpy(&row->value[CSV_SPECIFIC_FORCE], imu.value[k] + 6, 3 * sizeof(double));
        memcpy(&row->value[CSV_WRENCH], wrench.value[at_wrench], 6 * sizeof(double));
        if (interpolate(&dvl, &at_dvl, t, 3, &row->value[CSV_NU]) &&
            interpolate(&depth, &at_depth, t, 1, &row->value[CSV_POSITION + 2])) {
            ++dive->rows;
            double step = sim_rng_uniform(rng) < 0.5 ? 0.1 : 0.2;
            step = sim_rng_uniform(rng) < 0.01 ? 0.8 : step;
            next_s = cfg->coarse ? t + step - 1e-3 : 0.0;
        }
    }
}

bool dive_simulate(dive_t *dive, const dive_config_t *cfg)
{
    sim_rng_t rng;
    memset(dive->has, 0, sizeof dive->has);
    for (int c = CSV_T; c < CSV_COMMAND; ++c) {
        dive->has[c] = true;
    }
    for (int i = 0; i < 3; ++i) {
        dive->has[CSV_SPECIFIC_FORCE + i] = true;
    }
    dive->has[CSV_POSITION + 2] = cfg->depth;
    if (!field_init(&dive->field, &cfg->field)) {
        return false;
    }
    sim_rng_seed(&rng, cfg->field.seed, STREAM);
    scale_vehicle(&dive->field, &rng);
    record(&dive->field, cfg, &rng);
    write_rows(dive, cfg, &rng);
    return true;
}

/* ---- slips ---- */

void dive_draw_slip(slip_t *slip, slip_kind_t kind, int severity, uint64_t seed)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, STREAM + 1 + (uint64_t)kind);
    *slip = (slip_t){.kind = kind,
                     .which = (int)(6.0 * sim_rng_uniform(&rng)),
                     .severity = severity,
                     .column = -1,
                     .other = -1};
}

static void negate(csv_row_t *row, int column)
{
    row->value[column] = -row->value[column];
}

static void exchange(csv_row_t *row, int a, int b)
{
    double kept = row->value[a];
    row->value[a] = row->value[b];
    row->value[b] = kept;
}

/* Axes that move in every dive: surge, sway, heave, yaw. */
static int moving(int which)
{
    static const int axis[4] = {0, 1, 2, 5};
    return axis[which % 4];
}

/* Names the columns of a slip. */
static void name_columns(slip_t *s)
{
    static const int pair[3][2] = {{0, 1}, {0, 2}, {0, 5}};
    switch (s->kind) {
    case SLIP_ANGLE_DEGREES:
        s->column = s->which < 3 ? CSV_ATTITUDE + 2 : CSV_ATTITUDE; /* heading, or all */
        break;
    case SLIP_RATE_DEGREES:
        s->column = CSV_NU + 5;
        break;
    case SLIP_ANGLE_SIGN:
        s->column = CSV_ATTITUDE + s->which % 3;
        break;
    case SLIP_VELOCITY_SIGN:
        s->column = CSV_NU + moving(s->which);
        break;
    case SLIP_EXCHANGED:
        s->column = s->which % 2 == 0 ? CSV_NU : CSV_NU + 3;
        s->other = s->column + 1;
        break;
    case SLIP_SHIFT:
        s->column = s->which % 2 == 0 ? CSV_ATTITUDE : CSV_WRENCH;
        break;
    case SLIP_INPUT_SIGN:
        s->column = CSV_WRENCH + moving(s->which);
        break;
    case SLIP_INPUT_EXCHANGED:
        s->column = CSV_WRENCH + pair[s->which % 3][0];
        s->other = CSV_WRENCH + pair[s->which % 3][1];
        break;
    case SLIP_LOGGING:
        s->column = s->which % 3 == 0 ? CSV_NU : s->which % 3 == 1 ? CSV_NU + 1 : CSV_COMMAND;
        break;
    case SLIP_ACCELEROMETER:
        s->column = CSV_SPECIFIC_FORCE;
        break;
    case SLIP_UNIT:
        s->column = s->which % 2 == 0 ? CSV_WRENCH : CSV_NU;
        break;
    case SLIP_WORLD:
        s->column = CSV_NU;
        break;
    case SLIP_QUATERNION:
        s->column = CSV_QUATERNION;
        break;
    case SLIP_FRAME:
    case SLIPS:
    default:
        break;
    }
}

/* The accelerometer in g, without gravity, in FLU axes, with one axis reversed, axes exchanged. */
static void change_force(const slip_t *s, csv_row_t *row)
{
    double *f = &row->value[CSV_SPECIFIC_FORCE];
    int i = s->which == 4 ? 0 : 1;
    switch (s->which) {
    case 0:
        f[0] /= 9.81, f[1] /= 9.81, f[2] /= 9.81;
        break;
    case 1:
        f[2] += 9.81;
        break;
    case 2:
        f[1] = -f[1], f[2] = -f[2];
        break;
    case 3:
        f[2] = -f[2];
        break;
    default: /* x or y with z */
        exchange(row, CSV_SPECIFIC_FORCE + i, CSV_SPECIFIC_FORCE + 2);
        break;
    }
}

/* Slips that concern single rows. */
static void change_row(const slip_t *s, csv_row_t *row)
{
    double *v = row->value;
    switch (s->kind) {
    case SLIP_ANGLE_DEGREES:
        for (int i = s->which < 3 ? 2 : 0; i < 3; ++i) {
            v[CSV_ATTITUDE + i] *= DEGREES;
        }
        break;
    case SLIP_RATE_DEGREES:
        for (int i = 3; i < 6; ++i) {
            v[CSV_NU + i] *= DEGREES;
        }
        break;
    case SLIP_ANGLE_SIGN:
    case SLIP_VELOCITY_SIGN:
    case SLIP_INPUT_SIGN:
        negate(row, s->column);
        break;
    case SLIP_EXCHANGED:
    case SLIP_INPUT_EXCHANGED:
        exchange(row, s->column, s->other);
        break;
    case SLIP_FRAME:
        if (s->which % 2 == 0) { /* the attitude in ENU and FLU */
            negate(row, CSV_ATTITUDE + 1);
            v[CSV_ATTITUDE + 2] = remainder(0.5 * FIELD_PI - v[CSV_ATTITUDE + 2], 2.0 * FIELD_PI);
        } else { /* velocities and rates in FLU */
            negate(row, CSV_NU + 1);
            negate(row, CSV_NU + 2);
            negate(row, CSV_NU + 4);
            negate(row, CSV_NU + 5);
        }
        break;
    case SLIP_ACCELEROMETER:
        change_force(s, row);
        break;
    case SLIP_UNIT:
    case SLIP_WORLD:
    case SLIP_QUATERNION:
    case SLIP_SHIFT:
    case SLIP_LOGGING:
    case SLIPS:
    default:
        break;
    }
}

/* Delays columns by their values of an earlier row. */
static void delay(const dive_t *from, int first, int last, double by_s, dive_t *to)
{
    int at = 0;
    for (int k = 0; k < to->rows; ++k) {
        double t = from->row[k].value[CSV_T] - by_s;
        while (at + 1 < from->rows && from->row[at + 1].value[CSV_T] <= t) {
            ++at;
        }
        for (int c = first; c <= last; ++c) {
            to->row[k].value[c] = from->row[at].value[c];
        }
    }
}

/* Holds the velocities for a time. */
static void hold(dive_t *dive, double for_s)
{
    double until = -1.0;
    const double *held = NULL;
    for (int k = 0; k < dive->rows; ++k) {
        double *v = dive->row[k].value;
        if (held == NULL || v[CSV_T] >= until) {
            until = v[CSV_T] + for_s;
            held = &v[CSV_NU];
        } else {
            memcpy(&v[CSV_NU], held, 3 * sizeof *held);
        }
    }
}

/* Thrust as pulse widths. */
static void to_pulses(dive_t *dive)
{
    double largest[6] = {0};
    for (int k = 0; k < dive->rows; ++k) {
        for (int j = 0; j < 6; ++j) {
            largest[j] = fmax(largest[j], fabs(dive->row[k].value[CSV_WRENCH + j]));
        }
    }
    for (int j = 0; j < 6; ++j) {
        for (int k = 0; k < dive->rows; ++k) {
            double *v = dive->row[k].value, part = v[CSV_WRENCH + j] / fmax(largest[j], 1e-9);
            v[CSV_COMMAND + j] = 1500.0 + floor(400.0 * part + 0.5);
        }
        dive->has[CSV_WRENCH + j] = false;
        dive->has[CSV_COMMAND + j] = true;
    }
}

static void to_knots(dive_t *dive)
{
    for (int k = 0; k < dive->rows; ++k) {
        dive->row[k].value[CSV_NU] *= KNOTS;
        dive->row[k].value[CSV_NU + 1] *= KNOTS;
    }
}

static void to_kgf(dive_t *dive)
{
    for (int k = 0; k < dive->rows; ++k) {
        for (int j = 0; j < 6; ++j) {
            dive->row[k].value[CSV_WRENCH + j] /= 9.81;
        }
    }
}

static void to_world(dive_t *dive)
{
    for (int k = 0; k < dive->rows; ++k) {
        double *v = dive->row[k].value, r[3][3], nu[3];
        memcpy(nu, &v[CSV_NU], sizeof nu);
        sim_rotation(&v[CSV_ATTITUDE], r);
        for (int i = 0; i < 3; ++i) {
            v[CSV_NU + i] = r[i][0] * nu[0] + r[i][1] * nu[1] + r[i][2] * nu[2];
        }
    }
}

static void to_quaternion(dive_t *dive, const int order[4])
{
    for (int k = 0; k < dive->rows; ++k) {
        double *v = dive->row[k].value, *q = &v[CSV_QUATERNION], c[3], s[3];
        for (int i = 0; i < 3; ++i) {
            c[i] = cos(0.5 * v[CSV_ATTITUDE + i]);
            s[i] = sin(0.5 * v[CSV_ATTITUDE + i]);
        }
        q[order[0]] = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
        q[order[1]] = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
        q[order[2]] = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
        q[order[3]] = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
        csv_attitude(q[0], q[1], q[2], q[3], &v[CSV_ATTITUDE]);
    }
    for (int i = 0; i < 4; ++i) {
        dive->has[CSV_QUATERNION + i] = true;
    }
}

static void change_columns(const dive_t *from, const slip_t *s, dive_t *to)
{
    static const double attitude_s[3] = {0.6, 0.3, 0.15}, input_s[3] = {1.5, 1.0, 0.8},
                        held_s[3] = {1.0, 0.5, 0.2};
    if (s->kind == SLIP_SHIFT && s->column == CSV_ATTITUDE) {
        delay(from, CSV_ATTITUDE, CSV_ATTITUDE + 2, attitude_s[s->severity], to);
    } else if (s->kind == SLIP_SHIFT) { /* motion and attitude are late */
        delay(from, CSV_ATTITUDE, CSV_NU + 5, input_s[s->severity], to);
    } else if (s->kind == SLIP_LOGGING && s->column == CSV_NU) {
        hold(to, held_s[s->severity]);
    } else if (s->kind == SLIP_LOGGING && s->column == CSV_COMMAND) {
        to_pulses(to);
    } else if (s->kind == SLIP_UNIT) {
        (s->column == CSV_NU ? to_knots : to_kgf)(to);
    } else if (s->kind == SLIP_WORLD) {
        to_world(to);
    } else if (s->kind == SLIP_QUATERNION) {
        static const int last[4] = {3, 0, 1, 2};
        to_quaternion(to, last);
    } else if (s->kind == SLIP_LOGGING) {
        for (int k = 0; k < to->rows; ++k) {
            to->row[k].value[s->column] = 0.0;
        }
    }
}

void dive_slip(const dive_t *from, slip_t *slip, dive_t *to)
{
    static const double begin[3] = {0.0, 1.0 / 2.0, 2.0 / 3.0};
    name_columns(slip);
    memcpy(to->has, from->has, sizeof to->has);
    to->rows = from->rows;
    memcpy(to->row, from->row, (size_t)from->rows * sizeof from->row[0]);
    change_columns(from, slip, to);
    for (int k = 0; k < to->rows; ++k) {
        if ((double)k >= begin[slip->severity] * to->rows) {
            change_row(slip, &to->row[k]);
        }
    }
}
