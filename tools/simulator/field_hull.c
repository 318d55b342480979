/*
 * The body in the water, in six degrees of freedom and nu through the water:
 *   M nu' = external - C(nu) nu - drag(nu) + restoring(attitude) + cable(position, attitude),
 *   M = [ m E, -m S(r_g); m S(r_g), I - m S(r_g)^2 ] + A,
 *   C(nu) nu = [ w x a; w x b + v x a ], [a; b] = M nu         (Kirchhoff; Lamb 1932, 124),
 * v and w the linear and angular parts of nu. The body's origin is the centre of gravity of the
 * data sheet, so that there M is diagonal, and surge, sway, heave and yaw follow Eq. 12-15.
 *
 * Near the bottom added mass depends on its distance h, A (1 + k(h)): with the kinetic energy
 * T = nu' M nu / 2 this gives the force -dM/dh nu h' and, along the gradient of h, dT/dh.
 */
#include "field_parts.h"

#include <math.h>
#include <string.h>

enum { U, V, W, P, Q, R };

void field_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void field_rotate(double r[3][3], const double v[3], double x[3])
{
    for (int i = 0; i < 3; ++i) {
        x[i] = r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
    }
}

void field_rotate_back(double r[3][3], const double v[3], double x[3])
{
    for (int i = 0; i < 3; ++i) {
        x[i] = r[0][i] * v[0] + r[1][i] * v[1] + r[2][i] * v[2];
    }
}

/* ---- construction of the vehicle ---- */

/* Computes mass and its inverse from the parts. */
static void assemble(field_hull_t *h)
{
    const double *g = h->r_g, m = h->dry_kg;
    const double s[3][3] = {{0.0, -g[2], g[1]}, {g[2], 0.0, -g[0]}, {-g[1], g[0], 0.0}};
    memcpy(h->mass, h->added, sizeof h->mass);
    for (int i = 0; i < 3; ++i) {
        h->mass[i][i] += m;
        h->mass[3 + i][3 + i] += h->inertia[i];
        for (int j = 0; j < 3; ++j) {
            h->mass[i][3 + j] -= m * s[i][j];
            h->mass[3 + i][j] += m * s[i][j];
            for (int k = 0; k < 3; ++k) {
                h->mass[3 + i][3 + j] -= m * s[i][k] * s[k][j];
            }
        }
    }
    for (int j = 0; j < 6; ++j) {
        double left[6][6], column[6] = {0};
        memcpy(left, h->mass, sizeof left);
        column[j] = 1.0;
        (void)sim_solve(left, column); /* positive definite, as is the rigid body by itself */
        for (int i = 0; i < 6; ++i) {
            h->inverse[i][j] = column[i];
        }
    }
}

/* Masses and drag of the data sheet, each varied by up to the size of "hull". */
static void build(field_hull_t *h, const field_sheet_t *sheet, double variety, uint64_t seed)
{
    static const int axis[4] = {U, V, W, R};
    double p[SIM_PARAMETERS], rigid = sheet->rigid_share;
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, FIELD_STREAM_HULL);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double off = variety * (2.0 * sim_rng_uniform(&rng) - 1.0);
        p[i] = sheet->parameter[i] * (i == SIM_WB ? 1.0 : 1.0 + off);
    }
    h->dry_kg = sheet->dry_kg;
    h->weight_N = sheet->dry_kg * FIELD_GRAVITY;
    h->buoyancy_N = h->weight_N - p[SIM_WB];
    h->r_b[2] = -sheet->cb_above_m;
    for (int i = 0; i < 3; ++i) {
        h->inertia[i] = rigid * (i < 2 ? sheet->tilt_inertia : sheet->parameter[SIM_M_R]);
        h->added[i][i] = p[SIM_M_U + i] - sheet->dry_kg;
        h->added[P + i][P + i] = (i < 2 ? sheet->tilt_inertia : p[SIM_M_R]) - h->inertia[i];
    }
    for (int i = 0; i < 4; ++i) {
        h->linear[axis[i]] = -p[SIM_X_U + 2 * i];
        h->quadratic[axis[i]] = -p[SIM_X_U + 2 * i + 1];
    }
    h->linear[P] = h->linear[Q] = sheet->tilt_linear;
    h->quadratic[P] = h->quadratic[Q] = sheet->tilt_quadratic;
}

/* Effects outside the model, scaled by drag and length. */
static void shape(field_hull_t *h, const field_sheet_t *sheet, const field_config_t *c)
{
    double cross = c->size[FIELD_CROSS], asymmetry = c->size[FIELD_DRAG_ASYMMETRY];
    sim_rng_t rng;
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_ASYMMETRY);
    for (int i = 0; i < 6; ++i) {
        h->asymmetry[i] = sim_rng_uniform(&rng) < 0.5 ? asymmetry : -asymmetry;
    }
    h->exponent_loss = c->size[FIELD_DRAG_EXPONENT];
    h->cross_flow = c->size[FIELD_CROSS_FLOW];
    h->half_m = sheet->length_m / 2.0;
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_CROSS);
    h->side_centre_m = cross * sim_rng_gauss(&rng) * sheet->length_m / 2.0;
    h->lift_sway = cross * fabs(sim_rng_gauss(&rng)) * h->quadratic[U];
    h->lift_yaw = cross / 3.0 * sim_rng_gauss(&rng) * h->quadratic[U] * sheet->length_m;
    h->lift_heave = cross / 2.0 * sim_rng_gauss(&rng) * h->quadratic[U];
}

/* A cable at the stern. For half of the seeds it pulls towards a point, a winch. */
static void fasten(field_hull_t *h, const field_sheet_t *sheet, const field_config_t *c)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_CABLE);
    double to = 2.0 * FIELD_PI * sim_rng_uniform(&rng), far = 20.0 + 20.0 * sim_rng_uniform(&rng);
    double up = 0.3 * sim_rng_uniform(&rng);
    h->cable_point = sim_rng_uniform(&rng) < 0.5;
    h->cable_N = c->size[FIELD_CABLE];
    h->cable_arm[0] = -sheet->length_m / 2.0;
    h->cable_to[0] = cos(to);
    h->cable_to[1] = sin(to);
    h->cable_to[2] = -up;
    for (int i = 0; i < 3; ++i) {
        h->cable_to[i] = h->cable_point ? far * h->cable_to[i] + (i == 2 ? FIELD_START_M : 0.0)
                                        : h->cable_to[i] / sqrt(1.0 + up * up);
    }
}

void field_hull_init(field_t *field)
{
    const field_config_t *c = &field->cfg;
    const field_sheet_t *sheet = &field->sheet;
    field_hull_t *h = &field->hull;
    sim_rng_t rng;
    memset(h, 0, sizeof *h);
    build(h, sheet, c->size[FIELD_HULL], c->seed);
    shape(h, sheet, c);
    fasten(h, sheet, c);
    h->r_g[0] = c->size[FIELD_CG_X];
    h->r_g[1] = c->size[FIELD_CG_Y];
    h->wall = c->size[FIELD_WALL];
    h->seabed_m = h->wall > 0.0 ? FIELD_START_M + 1.0 : FIELD_SEABED_M;
    sim_rng_seed(&rng, c->seed, FIELD_STREAM_CURRENT);
    double set = 2.0 * FIELD_PI * sim_rng_uniform(&rng);
    h->current[0] = c->size[FIELD_CURRENT] * cos(set);
    h->current[1] = c->size[FIELD_CURRENT] * sin(set);
    assemble(h);
}

/* Adds lead, which also displaces water. At the origin it has no moment: both centres shift. */
void field_hull_ballast(field_hull_t *h, double kg)
{
    const double weight_N = kg * FIELD_GRAVITY, buoyancy_N = weight_N / 11.34;
    for (int i = 0; i < 3; ++i) {
        h->r_g[i] *= h->weight_N / (h->weight_N + weight_N);
        h->r_b[i] *= h->buoyancy_N / (h->buoyancy_N + buoyancy_N);
    }
    h->dry_kg += kg;
    h->weight_N += weight_N;
    h->buoyancy_N += buoyancy_N;
    assemble(h);
}

void field_built(const field_t *field, field_built_t *built)
{
    const field_hull_t *h = &field->hull;
    static const int axis[4] = {U, V, W, R};
    for (int i = 0; i < 4; ++i) {
        built->parameter[SIM_M_U + i] = h->mass[axis[i]][axis[i]];
        built->parameter[SIM_X_U + 2 * i] = -h->linear[axis[i]];
        built->parameter[SIM_X_U + 2 * i + 1] = -h->quadratic[axis[i]];
    }
    built->parameter[SIM_WB] = h->weight_N - h->buoyancy_N;
    built->dry_kg = h->dry_kg;
}

/* ---- forces ---- */

/* p = m x, with m stored by rows. */
static void multiply(const double *m, const double x[6], double p[6])
{
    for (int i = 0; i < 6; ++i) {
        p[i] = 0.0;
        for (int j = 0; j < 6; ++j) {
            p[i] += m[6 * i + j] * x[j];
        }
    }
}

/* Drag, lift, and side drag that does not act at the origin. Fouling increases both drags. */
static void add_drag(const field_hull_t *h, const double nu[6], double more, double force[6])
{
    double fouled = more * (1.0 + h->fouling), turn = h->half_m * nu[R];
    double whole = sqrt(nu[U] * nu[U] + nu[V] * nu[V] + nu[W] * nu[W] + turn * turn);
    for (int i = 0; i < 6; ++i) {
        double x = nu[i], a = fabs(x);
        double square =
            fabs(h->exponent_loss) > 0.0 && a > 0.0 ? pow(a, 1.0 - h->exponent_loss) : a;
        square += h->cross_flow * (whole / (i < P ? 1.0 : h->half_m) - a);
        force[i] -= fouled * (h->linear[i] + h->quadratic[i] * square) * x *
                    (1.0 + (x > 0.0 ? h->asymmetry[i] : -h->asymmetry[i]));
    }
    /* The centre of side drag at x moves with v + x r: force -Y (v + x r), moment x times that. */
    double side = h->linear[V] * h->side_centre_m;
    force[V] -= fouled * side * nu[R];
    force[R] -= fouled * side * (nu[V] + h->side_centre_m * nu[R]);
    force[V] -= more * h->lift_sway * fabs(nu[U]) * nu[V];
    force[R] += more * h->lift_yaw * nu[U] * nu[V];
    force[W] += more * h->lift_heave * nu[U] * nu[U];
}

/* Adds a force given in world axes that acts at a point of the body. */
static void add_pull(double r[3][3], const double arm[3], const double world[3], double force[6])
{
    double body[3], moment[3];
    field_rotate_back(r, world, body);
    field_cross(arm, body, moment);
    for (int i = 0; i < 3; ++i) {
        force[i] += body[i];
        force[3 + i] += moment[i];
    }
}

static void add_cable(const field_hull_t *h, const double position[3], double r[3][3],
                      double force[6])
{
    double at[3], pull[3], length = 0.0;
    field_rotate(r, h->cable_arm, at);
    for (int i = 0; i < 3; ++i) {
        pull[i] = h->cable_to[i] - (h->cable_point ? position[i] + at[i] : 0.0);
        length += pull[i] * pull[i];
    }
    length = fmax(sqrt(length), 1e-3);
    for (int i = 0; i < 3; ++i) {
        pull[i] *= h->cable_N / length;
    }
    add_pull(r, h->cable_arm, pull, force);
}

/* Relative rise k of added mass and drag at distance h from the bottom, and dk/dh. It is constant
 * below FIELD_NEAR_M; there is no contact. */
static double near_wall(const field_hull_t *hull, double h, double *slope)
{
    double at = h > FIELD_NEAR_M ? h : FIELD_NEAR_M;
    double part = FIELD_NEAR_M / at, k = hull->wall * part * part * part;
    *slope = h > FIELD_NEAR_M ? -3.0 * k / at : 0.0;
    return k;
}

/* Adds the forces of a mass that depends on the distance to the bottom. */
static void add_wall(const field_hull_t *h, const double nu[6], double r[3][3], double slope,
                     double force[6])
{
    double added[6], energy = 0.0;
    double rate = -(r[2][0] * nu[U] + r[2][1] * nu[V] + r[2][2] * nu[W]); /* rate of the distance */
    multiply(&h->added[0][0], nu, added);
    for (int i = 0; i < 6; ++i) {
        energy += 0.5 * nu[i] * added[i];
        force[i] -= slope * rate * added[i];
    }
    for (int i = 0; i < 3; ++i) {
        force[i] -= slope * energy * r[2][i];
    }
}

/* -C(nu) nu */
static void add_coriolis(const double *m, const double nu[6], double force[6])
{
    double p[6], turn[3], spin[3], shift[3];
    multiply(m, nu, p);
    field_cross(nu + 3, p, turn);
    field_cross(nu + 3, p + 3, spin);
    field_cross(nu, p, shift);
    for (int i = 0; i < 3; ++i) {
        force[i] -= turn[i];
        force[3 + i] -= spin[i] + shift[i];
    }
}

/* Velocity over ground, and rates of the Euler angles (Fossen 2011, Eq. 2.39). */
static void kinematics(const field_hull_t *h, double r[3][3], const double nu[6], double rate[6])
{
    double s_phi_c = r[2][1], c_phi_c = r[2][2]; /* times cos(theta) */
    double c_theta = sqrt(s_phi_c * s_phi_c + c_phi_c * c_phi_c);
    double turn = (s_phi_c * nu[Q] + c_phi_c * nu[R]) / c_theta;
    field_rotate(r, nu, rate);
    for (int i = 0; i < 3; ++i) {
        rate[i] += h->current[i];
    }
    rate[3] = nu[P] - turn * r[2][0] / c_theta;
    rate[4] = (c_phi_c * nu[Q] - s_phi_c * nu[R]) / c_theta;
    rate[5] = turn / c_theta;
}

void field_hull_derivative(const field_hull_t *h, const double state[12], const double external[6],
                           double derivative[12])
{
    const double weight[3] = {0.0, 0.0, h->weight_N}, buoyancy[3] = {0.0, 0.0, -h->buoyancy_N};
    const double *nu = state + 6;
    double m[6][6], r[3][3], force[6], k = 0.0, slope = 0.0;

    sim_rotation(state + 3, r);
    kinematics(h, r, nu, derivative);
    memcpy(m, h->mass, sizeof m);
    memcpy(force, external, sizeof force);
    if (h->wall > 0.0) {
        k = near_wall(h, h->seabed_m - state[2], &slope);
        for (int i = 0; i < 6; ++i) {
            m[i][i] += k * h->added[i][i];
        }
        add_wall(h, nu, r, slope, force);
    }
    add_coriolis(&m[0][0], nu, force);
    add_drag(h, nu, 1.0 + k, force);
    add_pull(r, h->r_g, weight, force);
    add_pull(r, h->r_b, buoyancy, force);
    if (fabs(h->cable_N) > 0.0) {
        add_cable(h, state, r, force);
    }
    if (h->wall > 0.0) {
        memcpy(derivative + 6, force, sizeof force);
        (void)sim_solve(m, derivative + 6);
    } else {
        multiply(&h->inverse[0][0], force, derivative + 6);
    }
}
