/*
 * A vehicle in six degrees of freedom, as Fossen (2011) writes it:
 *   M nu' + C(nu) nu + D(nu) nu + g(eta) = tau,                          (6.1)
 *   M = M_RB + M_A,  M_RB = [ m E, -m S(r_g); m S(r_g), I ]           (3.44)
 *   C(nu) = [ 0, -S(a); -S(a), -S(b) ],  [a; b] = M nu                (3.46, of M as a whole)
 *   D(nu) = diag(d_i + dd_i |nu_i|)
 *   g(eta) = -[ f_g + f_b; r_g x f_g + r_b x f_b ],                   (4.5)
 *   f_g = R' (0, 0, W), f_b = -R' (0, 0, B)
 */
#include "simulator.h"

#include <math.h>
#include <string.h>

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void sim_fossen_matrix(const sim_fossen_t *v, double m[6][6])
{
    const double *g = v->r_g;
    const double skew[3][3] = {{0.0, -g[2], g[1]}, {g[2], 0.0, -g[0]}, {-g[1], g[0], 0.0}};
    memcpy(m, v->added, sizeof v->added);
    for (int i = 0; i < 3; ++i) {
        m[i][i] += v->mass_kg;
        m[3 + i][3 + i] += v->inertia[i];
        for (int j = 0; j < 3; ++j) {
            m[i][3 + j] -= v->mass_kg * skew[i][j];
            m[3 + i][j] += v->mass_kg * skew[i][j];
        }
    }
}

/* Elimination without pivoting: all pivots of a symmetric matrix are positive if and only if it is
 * positive definite. */
bool sim_solve(double a[6][6], double x[6])
{
    for (int k = 0; k < 6; ++k) {
        if (!(a[k][k] > 1e-9)) {
            return false;
        }
        for (int i = k + 1; i < 6; ++i) {
            double part = a[i][k] / a[k][k];
            for (int j = k; j < 6; ++j) {
                a[i][j] -= part * a[k][j];
            }
            x[i] -= part * x[k];
        }
    }
    for (int k = 5; k >= 0; --k) {
        for (int j = k + 1; j < 6; ++j) {
            x[k] -= a[k][j] * x[j];
        }
        x[k] /= a[k][k];
    }
    return true;
}

void sim_fossen_acceleration(const sim_fossen_t *v, const double euler[3], const double nu[6],
                             const double wrench[6], double nu_dot[6])
{
    double m[6][6], momentum[6] = {0}, r[3][3], turn[3], pull[3], moment[3], push[3], slip[3];
    sim_fossen_matrix(v, m);
    sim_rotation(euler, r);
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            momentum[i] += m[i][j] * nu[j];
        }
        nu_dot[i] = wrench[i] - (v->linear[i] + v->quadratic[i] * fabs(nu[i])) * nu[i];
    }
    for (int i = 0; i < 3; ++i) { /* the third row of R is the world's down in body axes */
        pull[i] = v->weight_N * r[2][i];
        push[i] = -v->buoyancy_N * r[2][i];
        nu_dot[i] += pull[i] + push[i];
    }
    cross(v->r_g, pull, moment);
    cross(v->r_b, push, turn);
    for (int i = 0; i < 3; ++i) {
        nu_dot[3 + i] += moment[i] + turn[i];
    }
    cross(momentum, nu + 3, turn); /* -C nu: S(a) w, and S(a) v + S(b) w */
    cross(momentum, nu, slip);
    cross(momentum + 3, nu + 3, moment);
    for (int i = 0; i < 3; ++i) {
        nu_dot[i] += turn[i];
        nu_dot[3 + i] += slip[i] + moment[i];
    }
    (void)sim_solve(m, nu_dot); /* positive definite: sim_init has checked it */
}

void sim_fossen_parameters(const sim_fossen_t *v, double p[SIM_FOSSEN_PARAMETERS])
{
    double m[6][6], all[SIM_FOSSEN_PARAMETERS] = {0};
    sim_fossen_matrix(v, m);
    for (int i = 0; i < 6; ++i) {
        all[i] = m[i][i];
        all[10 + i] = 0.0 - v->linear[i]; /* no negative zero */
        all[16 + i] = 0.0 - v->quadratic[i];
    }
    all[6] = v->weight_N - v->buoyancy_N;
    for (int i = 0; i < 3; ++i) {
        all[7 + i] = v->r_g[i] * v->weight_N - v->r_b[i] * v->buoyancy_N;
    }
    all[22] = m[0][4];
    all[23] = m[1][3];
    all[24] = m[1][5];
    all[25] = m[2][4];
    memcpy(p, all, sizeof all);
}

/* Eight T200s at 16 V: positions and forward directions. The first four lie in a plane below the
 * origin and push inwards, the front ones ahead and the rear ones astern. The others push up and
 * down alternately. In both groups: front starboard, front port, rear starboard, rear port. */
static void bluerov2_thrusters(sim_config_t *cfg)
{
    static const double at[8][3] = {{0.156, 0.111, 0.085},  {0.156, -0.111, 0.085},
                                    {-0.156, 0.111, 0.085}, {-0.156, -0.111, 0.085},
                                    {0.120, 0.218, 0.0},    {0.120, -0.218, 0.0},
                                    {-0.120, 0.218, 0.0},   {-0.120, -0.218, 0.0}};
    const double h = sqrt(0.5);
    const double along[8][3] = {{h, -h, 0.0},    {h, h, 0.0},      {-h, -h, 0.0},
                                {-h, h, 0.0},    {0.0, 0.0, -1.0}, {0.0, 0.0, 1.0},
                                {0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}};
    cfg->thrusters = 8;
    cfg->thruster_max_N = 51.5;
    cfg->thruster_back_N = 40.2;
    for (int j = 0; j < 8; ++j) {
        double moment[3];
        cross(at[j], along[j], moment);
        for (int i = 0; i < 3; ++i) {
            cfg->thruster_matrix[i][j] = along[j][i];
            cfg->thruster_matrix[3 + i][j] = moment[i];
        }
    }
}

void sim_bluerov2(sim_config_t *cfg)
{
    static const sim_fossen_t heavy = {.mass_kg = 13.5,
                                       .inertia = {0.26, 0.23, 0.37},
                                       .weight_N = 13.5 * 9.82,
                                       .buoyancy_N = 0.0134 * 1000.0 * 9.82,
                                       .r_b = {0.0, 0.0, -0.01},
                                       .added = {{6.36},
                                                 {0.0, 7.12},
                                                 {0.0, 0.0, 18.68},
                                                 {0.0, 0.0, 0.0, 0.189},
                                                 {0.0, 0.0, 0.0, 0.0, 0.135},
                                                 {0.0, 0.0, 0.0, 0.0, 0.0, 0.222}},
                                       .linear = {13.7, 0.0, 33.0, 0.0, 0.8, 0.0},
                                       .quadratic = {141.0, 217.0, 190.0, 1.19, 0.47, 1.5}};
    sim_defaults(cfg);
    cfg->model = SIM_FOSSEN;
    cfg->fossen = heavy;
    cfg->hold_Nm_rad = 8;
    cfg->hold_Nms_rad = 2;
    memset(cfg->thruster_matrix, 0, sizeof cfg->thruster_matrix);
    bluerov2_thrusters(cfg);
}
