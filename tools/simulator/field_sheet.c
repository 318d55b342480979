/*
 * The data sheets: two vehicles, and any number of vehicles drawn at random.
 *
 * A drawn vehicle has the thrusters of one of the two, moved to its length. Mass, added mass,
 * length, force, top speed and shape of the drag are drawn independently of each other, from ranges
 * that contain both vehicles: most drawn vehicles are like neither of the two. Drag follows from
 * force and top speed. In one of ten vehicles it is more than three times that of the Girona500 in
 * surge, relative to the volume. The time constant, mass times top speed over force, is 0.33 to
 * 4.8 s in surge, 0.26 to 6.5 s in sway, 0.32 to 10.4 s in heave, and 0.06 to 4.4 s in yaw, in 98
 * of 100 vehicles.
 */
#include "field_parts.h"

#include <math.h>

enum { U, V, W, P, Q, R };

#define C45 0.70710678118654752

/* Largest acceleration of Girona500, with rotation: 100 N on 250 kg, and 0.7 m/s at 0.7 rad/s. For
 * all others the user leaves the default of the filter, 3 m/s2. */
#define GIRONA500_M_S2 1.0

static const field_sheet_t sheets[FIELD_ANY] = {
    [FIELD_GIRONA500] = {.parameter = {249.5384, 367.7126, 659.9799, 74.9024, -37.3058, -42.4181,
                                       -125.3578, -75.7673, -447.6195, -44.0561, -325.0138,
                                       -20.5833, -60.9373},
                         .dry_kg = 160.0,
                         .tilt_inertia = 80.0,
                         .rigid_share = 0.6,
                         .tilt_linear = 60.0,
                         .tilt_quadratic = 40.0,
                         .cb_above_m = 0.3,
                         .length_m = 1.5,
                         .noise_arm_m = 0.4,
                         .amplitude = {[U] = 100.0, [V] = 100.0, [W] = 100.0, [R] = 40.0},
                         .max_acceleration = GIRONA500_M_S2,
                         .speed_m_s = 0.4,
                         .bandwidth = 0.4,
                         .thrusters = 5,
                         .thruster_max_N = 153.8,
                         .matrix = {[U] = {-1.0, -1.0},
                                    [V] = {[4] = 1.0},
                                    [W] = {[2] = -1.0, [3] = -1.0},
                                    [P] = {[4] = 0.05},
                                    [Q] = {0.08, 0.08, -0.35, 0.35},
                                    [R] = {-0.4, 0.4}}},
    /* Between BlueROV2 (Wu 2018) and BlueROV2 Heavy (von Benzon et al. 2022), scaled to 20 kg; no
     * drag is zero. Four thrusters at (+-0.2, +-0.15, 0.02) m and 45 degrees, two vertical ones. */
    [FIELD_ROV20] = {.parameter = {25.5, 32.0, 35.0, 0.5, -2.0, -5.0, -25.0, -8.0, -40.0, -10.0,
                                   -50.0, -0.5, -1.5},
                     .dry_kg = 20.0,
                     .tilt_inertia = 0.6,
                     .rigid_share = 0.6,
                     .tilt_linear = 1.5,
                     .tilt_quadratic = 1.5,
                     .cb_above_m = 0.15,
                     .length_m = 0.6,
                     .noise_arm_m = 0.4,
                     .amplitude = {[U] = 30.0, [V] = 30.0, [W] = 30.0, [R] = 6.0},
                     .fast = true,
                     .speed_m_s = 0.4,
                     .bandwidth = 0.8,
                     .thrusters = 6,
                     .thruster_max_N = 40.0,
                     .matrix = {[U] = {C45, C45, C45, C45},
                                [V] = {-C45, C45, C45, -C45},
                                [W] = {[4] = -1.0, [5] = -1.0},
                                [P] = {0.02 * C45, -0.02 * C45, -0.02 * C45, 0.02 * C45, -0.12,
                                       0.12},
                                [Q] = {0.02 * C45, 0.02 * C45, 0.02 * C45, 0.02 * C45},
                                [R] = {-0.35 * C45, 0.35 * C45, -0.35 * C45, 0.35 * C45}}},
};

/* Smallest and largest of what is drawn. */
typedef struct {
    double low, high;
} range_t;

static const range_t dry_kg = {8.0, 450.0};
/* Mass with added mass, relative to the dry mass. That of surge stays at 1 or above if the hull
 * varies by the 20 % that field_set allows. */
static const range_t mass[3] = {{1.25, 1.6}, {1.3, 2.4}, {1.3, 4.2}};
/* Length relative to 0.22 m at 1 kg times the cube root of the mass; moment of inertia of yaw, with
 * added mass, relative to that of a rod. */
static const range_t length = {0.8, 1.4}, inertia = {0.8, 2.6};
/* Buoyancy in excess of the weight, relative to it. */
static const range_t buoyancy = {-0.003, 0.025};
/* Force of the excitation: in surge relative to the mass there [m/s2]; in sway and heave relative
 * to that in surge; moment of yaw relative to that in surge times the length. */
static const range_t acceleration = {0.25, 1.5}, side = {0.5, 1.0}, arm = {0.12, 0.4};
/* Top speeds at these forces: surge [m/s]; sway and heave relative to surge; yaw [rad/s]. */
static const range_t speed = {0.4, 1.5}, side_speed = {0.4, 0.8}, yaw_speed = {0.4, 2.0};
/* Share of linear drag in the drag at the top speed. */
static const range_t linear = {0.05, 0.6};

/* Moment of inertia of roll and pitch relative to that of yaw: between those of the two. */
#define TILT_INERTIA 1.1
/* Largest force of the thrusters relative to what excitation and hovering need, as of the two. */
#define RESERVE 1.5
/* Time constant of surge at the top speed below which rows must be averaged. That of the Girona500
 * is 1.1 s, that of the ROV 0.5 s. */
#define FAST_S 1.0
/* Of the position controllers [rad/s], as of the ROV. */
#define BANDWIDTH 0.8
/* Bounds of the parameters: beyond those of 450 kg at 0.16 m/s. */
#define LARGEST_PARAMETER 100000.0

static double uniform(sim_rng_t *rng, range_t of)
{
    return of.low + (of.high - of.low) * sim_rng_uniform(rng);
}

static double log_uniform(sim_rng_t *rng, range_t of)
{
    return of.low * pow(of.high / of.low, sim_rng_uniform(rng));
}

static void draw_body(sim_rng_t *rng, field_sheet_t *to)
{
    double *p = to->parameter;
    to->dry_kg = log_uniform(rng, dry_kg);
    to->length_m = 0.22 * cbrt(to->dry_kg) * uniform(rng, length);
    for (int i = 0; i < 3; ++i) {
        p[SIM_M_U + i] = to->dry_kg * uniform(rng, mass[i]);
    }
    p[SIM_M_R] = to->dry_kg * to->length_m * to->length_m / 12.0 * uniform(rng, inertia);
    p[SIM_WB] = -to->dry_kg * FIELD_GRAVITY * uniform(rng, buoyancy);
    to->tilt_inertia = TILT_INERTIA * p[SIM_M_R];
    to->cb_above_m = 0.2 * to->length_m;
    to->noise_arm_m = 0.4 * to->length_m;
}

/* Forces of the excitation, and the drag that they meet at the top speeds [m/s, rad/s]. */
static void draw_motion(sim_rng_t *rng, field_sheet_t *to, double top[4])
{
    double *force = to->amplitude, *p = to->parameter;
    force[U] = p[SIM_M_U] * log_uniform(rng, acceleration);
    force[V] = force[U] * uniform(rng, side);
    force[W] = force[U] * uniform(rng, side);
    force[R] = force[U] * to->length_m * uniform(rng, arm);
    top[0] = log_uniform(rng, speed);
    top[1] = top[0] * uniform(rng, side_speed);
    top[2] = top[0] * uniform(rng, side_speed);
    top[3] = log_uniform(rng, yaw_speed);
    for (int e = 0; e < 4; ++e) {
        double at_top = force[e < 3 ? e : R], share = uniform(rng, linear);
        p[SIM_X_U + 2 * e] = -at_top * share / top[e];
        p[SIM_X_U + 2 * e + 1] = -at_top * (1.0 - share) / (top[e] * top[e]);
    }
    to->tilt_linear = -1.2 * p[SIM_N_R];
    to->tilt_quadratic = -1.2 * p[SIM_N_RR];
}

/* The part of thruster j in a force or moment [N]. All thrusters that act on it produce equal
 * parts, as by the pseudo-inverse of either arrangement. */
static double share_of(const field_sheet_t *sheet, int dof, int j, double wanted)
{
    const double *row = sheet->matrix[dof];
    int acting = 0;
    for (int k = 0; k < sheet->thrusters; ++k) {
        acting += fabs(row[k]) > 0.0;
    }
    return fabs(row[j]) > 0.0 ? wanted / (acting * fabs(row[j])) : 0.0;
}

/* Scales the lever arms of the thrusters. All thrusters are equally strong: the one with the
 * largest load can produce its part of all forces of the excitation at once, and of hovering. */
static void fit_thrusters(field_sheet_t *sheet, double scale)
{
    const double *force = sheet->amplitude;
    double max_N = 0.0;
    for (int j = 0; j < sheet->thrusters; ++j) {
        for (int i = P; i <= R; ++i) {
            sheet->matrix[i][j] *= scale;
        }
    }
    for (int j = 0; j < sheet->thrusters; ++j) {
        double needed = share_of(sheet, U, j, force[U]) + share_of(sheet, V, j, force[V]) +
                        share_of(sheet, W, j, force[W] + fabs(sheet->parameter[SIM_WB])) +
                        share_of(sheet, R, j, force[R]);
        max_N = fmax(max_N, needed);
    }
    sheet->thruster_max_N = RESERVE * max_N;
}

static void draw(uint64_t seed, field_sheet_t *to)
{
    double top[4];
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, FIELD_STREAM_SHEET);
    *to = sheets[sim_rng_uniform(&rng) < 0.5 ? FIELD_GIRONA500 : FIELD_ROV20];
    double drawn_for_m = to->length_m;
    draw_body(&rng, to);
    draw_motion(&rng, to, top);
    fit_thrusters(to, to->length_m / drawn_for_m);
    const double *p = to->parameter;
    to->fast = p[SIM_M_U] < -FAST_S * (p[SIM_X_U] + 2.0 * p[SIM_X_UU] * top[0]);
    to->max_acceleration = 0.0;
    to->speed_m_s = fmin(0.4, 0.5 * top[0]);
    to->bandwidth = BANDWIDTH;
    to->largest_parameter = LARGEST_PARAMETER;
}

void field_sheet(field_vehicle_t vehicle, uint64_t seed, field_sheet_t *sheet)
{
    if (vehicle == FIELD_ANY) {
        draw(seed, sheet);
    } else {
        *sheet = sheets[vehicle];
    }
}
