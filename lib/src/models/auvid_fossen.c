/*
 * Vehicle model in six degrees of freedom (Fossen 2011, Eq. 3.46, 6.43, 4.6).
 *
 * With the parts of M nu in the equations of force and moment,
 *
 *     a = (m_u u + m_uq q,  m_v v + m_vp p + m_vr r,  m_w w + m_wq q)
 *     b = (m_p p + m_vp v,  m_q q + m_uq u + m_wq w,  m_r r + m_vr v)
 *
 *     C(nu) nu = (omega x a,  v x a + omega x b),   v = (u, v, w), omega = (p, q, r)       (3.46)
 *
 *     g(eta)   = ( (W-B) sin(theta)                                                         (4.6)
 *                 -(W-B) cos(theta) sin(phi)
 *                 -(W-B) cos(theta) cos(phi)
 *                 -y_G cos(theta) cos(phi) + z_G cos(theta) sin(phi)
 *                  z_G sin(theta)          + x_G cos(theta) cos(phi)
 *                 -x_G cos(theta) sin(phi) - y_G sin(theta) )
 *
 * Here x_G, y_G, z_G are short for x_G W - x_B B and so on. Drags and constants have the opposite
 * sign, as in Eq. 12-15.
 */
#include "auvid/fossen.h"

#include <string.h>

#include "../base/auvid_math_internal.h"

#if AUVID_MAX_PARAMETERS >= 22

#define AT(name) AUVID_FOSSEN_##name
#define ONE AUVID_C(1.0)

static const auvid_parameter_t fossen_parameter[AUVID_FOSSEN_COUNT] = {
    [AT(M_U)] = {"m-X_udot", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    [AT(M_V)] = {"m-Y_vdot", "kg", AUVID_SWAY, AUVID_PARAMETER_MASS},
    [AT(M_W)] = {"m-Z_wdot", "kg", AUVID_HEAVE, AUVID_PARAMETER_MASS},
    [AT(M_P)] = {"Ix-K_pdot", "kg m2", AUVID_ROLL, AUVID_PARAMETER_INERTIA},
    [AT(M_Q)] = {"Iy-M_qdot", "kg m2", AUVID_PITCH, AUVID_PARAMETER_INERTIA},
    [AT(M_R)] = {"Iz-N_rdot", "kg m2", AUVID_YAW, AUVID_PARAMETER_INERTIA},
    [AT(W_B)] = {"W-B", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE},
    [AT(X_G)] = {"xgW-xbB", "Nm", AUVID_PITCH, AUVID_PARAMETER_FORCE},
    [AT(Y_G)] = {"ygW-ybB", "Nm", AUVID_ROLL, AUVID_PARAMETER_FORCE},
    [AT(Z_G)] = {"zgW-zbB", "Nm", AUVID_PITCH, AUVID_PARAMETER_OTHER}, /* times a sine */
    [AT(X_U)] = {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(Y_V)] = {"Y_v", "N s/m", AUVID_SWAY, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(Z_W)] = {"Z_w", "N s/m", AUVID_HEAVE, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(K_P)] = {"K_p", "Nm s", AUVID_ROLL, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(M_Q_DRAG)] = {"M_q", "Nm s", AUVID_PITCH, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(N_R)] = {"N_r", "Nm s", AUVID_YAW, AUVID_PARAMETER_LINEAR_DRAG},
    [AT(X_UU)] = {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AT(Y_VV)] = {"Y_vv", "N s2/m2", AUVID_SWAY, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AT(Z_WW)] = {"Z_ww", "N s2/m2", AUVID_HEAVE, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AT(K_PP)] = {"K_pp", "Nm s2", AUVID_ROLL, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AT(M_QQ)] = {"M_qq", "Nm s2", AUVID_PITCH, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AT(N_RR)] = {"N_rr", "Nm s2", AUVID_YAW, AUVID_PARAMETER_QUADRATIC_DRAG},
#if AUVID_MAX_PARAMETERS >= 26
    [AT(M_UQ)] = {"mzg-X_qdot", "kg m", AUVID_PITCH, AUVID_PARAMETER_OTHER},
    [AT(M_VP)] = {"-mzg-Y_pdot", "kg m", AUVID_ROLL, AUVID_PARAMETER_OTHER},
    [AT(M_VR)] = {"mxg-Y_rdot", "kg m", AUVID_YAW, AUVID_PARAMETER_OTHER},
    [AT(M_WQ)] = {"-mxg-Z_qdot", "kg m", AUVID_PITCH, AUVID_PARAMETER_OTHER},
#endif
#if AUVID_MAX_PARAMETERS >= 32
    [AT(X_0)] = {"X_0", "N", AUVID_SURGE, AUVID_PARAMETER_FORCE},
    [AT(Y_0)] = {"Y_0", "N", AUVID_SWAY, AUVID_PARAMETER_FORCE},
    [AT(Z_0)] = {"Z_0", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE},
    [AT(K_0)] = {"K_0", "Nm", AUVID_ROLL, AUVID_PARAMETER_FORCE},
    [AT(M_0)] = {"M_0", "Nm", AUVID_PITCH, AUVID_PARAMETER_FORCE},
    [AT(N_0)] = {"N_0", "Nm", AUVID_YAW, AUVID_PARAMETER_FORCE},
#endif
};

#define ON_DIAGONAL(dof) (AUVID_FOSSEN_M_U + (dof))

/* The restoring terms g(eta). */
static void fossen_restoring(const auvid_sample_t *s, auvid_regressor_t *y)
{
    auvid_real_t s_phi, c_phi, s_theta, c_theta;
    auvid_sincos(s->phi, &s_phi, &c_phi);
    auvid_sincos(s->theta, &s_theta, &c_theta);
    auvid_real_t across = c_theta * s_phi, down = c_theta * c_phi;
    y->row[AUVID_SURGE][AT(W_B)] = s_theta;
    y->row[AUVID_SWAY][AT(W_B)] = -across;
    y->row[AUVID_HEAVE][AT(W_B)] = -down;
    y->row[AUVID_ROLL][AT(Y_G)] = -down;
    y->row[AUVID_ROLL][AT(Z_G)] = across;
    y->row[AUVID_PITCH][AT(Z_G)] = s_theta;
    y->row[AUVID_PITCH][AT(X_G)] = down;
    y->row[AUVID_YAW][AT(X_G)] = -across;
    y->row[AUVID_YAW][AT(Y_G)] = -s_theta;
}

#if AUVID_MAX_PARAMETERS >= 26
/* The couplings of M, and their part of C(nu) nu. */
static void fossen_couplings(const auvid_sample_t *s, auvid_regressor_t *y)
{
    const auvid_real_t *nu = s->nu, *nu_dot = s->nu_dot;
    auvid_real_t u = nu[AUVID_SURGE], v = nu[AUVID_SWAY], w = nu[AUVID_HEAVE];
    auvid_real_t p = nu[AUVID_ROLL], q = nu[AUVID_PITCH], r = nu[AUVID_YAW];

    y->row[AUVID_SURGE][AT(M_UQ)] = nu_dot[AUVID_PITCH];
    y->row[AUVID_SURGE][AT(M_VP)] = -p * r;
    y->row[AUVID_SURGE][AT(M_VR)] = -r * r;
    y->row[AUVID_SURGE][AT(M_WQ)] = q * q;

    y->row[AUVID_SWAY][AT(M_UQ)] = q * r;
    y->row[AUVID_SWAY][AT(M_VP)] = nu_dot[AUVID_ROLL];
    y->row[AUVID_SWAY][AT(M_VR)] = nu_dot[AUVID_YAW];
    y->row[AUVID_SWAY][AT(M_WQ)] = -p * q;

    y->row[AUVID_HEAVE][AT(M_UQ)] = -q * q;
    y->row[AUVID_HEAVE][AT(M_VP)] = p * p;
    y->row[AUVID_HEAVE][AT(M_VR)] = p * r;
    y->row[AUVID_HEAVE][AT(M_WQ)] = nu_dot[AUVID_PITCH];

    y->row[AUVID_ROLL][AT(M_UQ)] = -u * r;
    y->row[AUVID_ROLL][AT(M_VP)] = nu_dot[AUVID_SWAY] - w * p;
    y->row[AUVID_ROLL][AT(M_VR)] = q * v - w * r;
    y->row[AUVID_ROLL][AT(M_WQ)] = v * q - r * w;

    y->row[AUVID_PITCH][AT(M_UQ)] = nu_dot[AUVID_SURGE] + w * q;
    y->row[AUVID_PITCH][AT(M_VP)] = r * v;
    y->row[AUVID_PITCH][AT(M_VR)] = -p * v;
    y->row[AUVID_PITCH][AT(M_WQ)] = nu_dot[AUVID_HEAVE] - u * q;

    y->row[AUVID_YAW][AT(M_UQ)] = p * u - q * v;
    y->row[AUVID_YAW][AT(M_VP)] = u * p - q * v;
    y->row[AUVID_YAW][AT(M_VR)] = nu_dot[AUVID_SWAY] + u * r;
    y->row[AUVID_YAW][AT(M_WQ)] = p * w;
}
#endif

static void fossen_regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                             auvid_regressor_t *y)
{
    (void)context;
    (void)pi;
    const auvid_real_t *nu = s->nu;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        y->row[j][ON_DIAGONAL(j)] = s->nu_dot[j];
        y->row[j][AUVID_FOSSEN_X_U + j] = -nu[j];
        y->row[j][AUVID_FOSSEN_X_UU + j] = -auvid_abs(nu[j]) * nu[j];
#if AUVID_MAX_PARAMETERS >= 32
        y->row[j][AUVID_FOSSEN_X_0 + j] = -ONE;
#endif
    }
    /* omega x a, v x a and omega x b: j, `next` and `after` are cyclic in x y z. */
    for (int j = 0; j < 3; ++j) {
        int next = (j + 1) % 3, after = (j + 2) % 3;
        auvid_real_t *force = y->row[j], *moment = y->row[3 + j];
        force[ON_DIAGONAL(after)] = nu[3 + next] * nu[after];
        force[ON_DIAGONAL(next)] = -nu[3 + after] * nu[next];
        moment[ON_DIAGONAL(after)] = nu[next] * nu[after];
        moment[ON_DIAGONAL(next)] = -nu[after] * nu[next];
        moment[ON_DIAGONAL(3 + after)] = nu[3 + next] * nu[3 + after];
        moment[ON_DIAGONAL(3 + next)] = -nu[3 + after] * nu[3 + next];
    }
    fossen_restoring(s, y);
#if AUVID_MAX_PARAMETERS >= 26
    fossen_couplings(s, y);
#endif
}

/* M has two blocks, each with a middle DoF that is coupled to two others: pitch to surge and heave,
 * sway to roll and yaw. */
typedef struct {
    uint8_t middle, end[2];
    uint8_t coupling[2]; /* indices of parameters */
} fossen_block_t;

/* Solves one block in place by L D L' factorization, the ends first. A zero coupling has no effect,
 * even if the other DoF is not finite. */
static void fossen_solve_block(const fossen_block_t *block, const auvid_real_t *pi,
                               auvid_real_t *nu_dot)
{
    auvid_real_t pivot = pi[ON_DIAGONAL(block->middle)], rest = nu_dot[block->middle];
    auvid_real_t min_pivot = AUVID_EPSILON * auvid_max(pivot, AUVID_C(0.0)), c[2];
    for (int k = 0; k < 2; ++k) {
        auvid_real_t mass = auvid_max(pi[ON_DIAGONAL(block->end[k])], AUVID_C(0.0));
        c[k] = block->coupling[k] < AUVID_FOSSEN_COUNT ? pi[block->coupling[k]] : AUVID_C(0.0);
        nu_dot[block->end[k]] /= mass; /* no mass: not finite */
        if (!auvid_is_zero(c[k])) {
            c[k] /= mass;
            pivot -= c[k] * c[k] * mass;
            rest -= c[k] * mass * nu_dot[block->end[k]];
        }
    }
    nu_dot[block->middle] = rest / (pivot > min_pivot ? pivot : AUVID_C(0.0));
    for (int k = 0; k < 2; ++k) {
        if (!auvid_is_zero(c[k])) {
            nu_dot[block->end[k]] -= c[k] * nu_dot[block->middle];
        }
    }
}

#if AUVID_MAX_PARAMETERS >= 26
#define COUPLING(name) AT(name)
#else
#define COUPLING(name) AUVID_FOSSEN_COUNT
#endif
static const fossen_block_t fossen_block[2] = {
    {AUVID_PITCH, {AUVID_SURGE, AUVID_HEAVE}, {COUPLING(M_UQ), COUPLING(M_WQ)}},
    {AUVID_SWAY, {AUVID_ROLL, AUVID_YAW}, {COUPLING(M_VP), COUPLING(M_VR)}}};

/* M nu' = tau - C(nu) nu - D(nu) nu - g(eta). The right-hand side is tau minus the wrench at zero
 * acceleration. */
static bool fossen_acceleration(const void *context, const auvid_sample_t *sample,
                                const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    auvid_sample_t steady = *sample;
    auvid_regressor_t y;
    memset(steady.nu_dot, 0, sizeof steady.nu_dot);
    memset(&y, 0, sizeof y);
    fossen_regressor(context, &steady, NULL, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        nu_dot[j] = sample->tau[j];
        for (int i = 0; i < AUVID_FOSSEN_COUNT; ++i) {
            nu_dot[j] -= y.row[j][i] * pi[i];
        }
    }
    fossen_solve_block(&fossen_block[0], pi, nu_dot);
    fossen_solve_block(&fossen_block[1], pi, nu_dot);
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        any = any || auvid_is_finite(nu_dot[j]);
    }
    return any;
}

#define BIT(name) ((uint32_t)1 << AT(name))
#define FORCES (BIT(M_U) | BIT(M_V) | BIT(M_W) | BIT(W_B))
#define INERTIAS (BIT(M_P) | BIT(M_Q) | BIT(M_R))
#if AUVID_MAX_PARAMETERS >= 26
#define COUPLED (BIT(M_UQ) | BIT(M_VP) | BIT(M_VR) | BIT(M_WQ))
#else
#define COUPLED 0u
#endif
#if AUVID_MAX_PARAMETERS >= 32
#define CONSTANT(name) BIT(name)
#else
#define CONSTANT(name) 0u
#endif
/* A moment reads the linear velocities of its cross product; with couplings, it reads all three. */
#define ROTATES (1u << AUVID_ROLL | 1u << AUVID_PITCH | 1u << AUVID_YAW)
#define MOVES (1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE)
#define WITHOUT(dof) ((AUVID_MAX_PARAMETERS >= 26 ? MOVES : MOVES & ~(1u << (dof))) | ROTATES)
#define FOSSEN_MODEL(title)                                                                        \
    {                                                                                              \
        .built_for = AUVID_BUILD, .path = &auvid_path_regressor, .name = title,                    \
        .parameters = AUVID_FOSSEN_COUNT, .parameter = fossen_parameter,                           \
        .columns = {[AUVID_SURGE] = FORCES | BIT(X_U) | BIT(X_UU) | COUPLED | CONSTANT(X_0),       \
                    [AUVID_SWAY] = FORCES | BIT(Y_V) | BIT(Y_VV) | COUPLED | CONSTANT(Y_0),        \
                    [AUVID_HEAVE] = FORCES | BIT(Z_W) | BIT(Z_WW) | COUPLED | CONSTANT(Z_0),       \
                    [AUVID_ROLL] = BIT(M_V) | BIT(M_W) | INERTIAS | BIT(Y_G) | BIT(Z_G) |          \
                                   BIT(K_P) | BIT(K_PP) | COUPLED | CONSTANT(K_0),                 \
                    [AUVID_PITCH] = BIT(M_U) | BIT(M_W) | INERTIAS | BIT(X_G) | BIT(Z_G) |         \
                                    BIT(M_Q_DRAG) | BIT(M_QQ) | COUPLED | CONSTANT(M_0),           \
                    [AUVID_YAW] = BIT(M_U) | BIT(M_V) | INERTIAS | BIT(X_G) | BIT(Y_G) |           \
                                  BIT(N_R) | BIT(N_RR) | COUPLED | CONSTANT(N_0)},                 \
        .free = AUVID_FOSSEN_FREE, .regressor = fossen_regressor,                                  \
        .acceleration = fossen_acceleration, .reads = {                                            \
            [AUVID_SURGE] = MOVES | ROTATES,                                                       \
            [AUVID_SWAY] = MOVES | ROTATES,                                                        \
            [AUVID_HEAVE] = MOVES | ROTATES,                                                       \
            [AUVID_ROLL] = WITHOUT(AUVID_SURGE),                                                   \
            [AUVID_PITCH] = WITHOUT(AUVID_SWAY),                                                   \
            [AUVID_YAW] = WITHOUT(AUVID_HEAVE)                                                     \
        }                                                                                          \
    }

const auvid_vehicle_t auvid_fossen = FOSSEN_MODEL("Fossen, 6 DoF");
const auvid_vehicle_t auvid_bluerov2_heavy = FOSSEN_MODEL("BlueROV2 Heavy");

/* From m = 13.5 kg, I = (0.26, 0.23, 0.37) kg m2, volume 0.0134 m3, r_G = 0, r_B = (0, 0, -0.01) m,
 * 1000 kg/m3 and 9.82 m/s2. */
const auvid_real_t auvid_bluerov2_heavy_benzon[AUVID_FOSSEN_COUNT] = {
    [AT(M_U)] = AUVID_C(19.86),   [AT(M_V)] = AUVID_C(20.62),     [AT(M_W)] = AUVID_C(32.18),
    [AT(M_P)] = AUVID_C(0.449),   [AT(M_Q)] = AUVID_C(0.365),     [AT(M_R)] = AUVID_C(0.592),
    [AT(W_B)] = AUVID_C(0.982),   [AT(Z_G)] = AUVID_C(1.31588),   [AT(X_U)] = AUVID_C(-13.7),
    [AT(Z_W)] = AUVID_C(-33.0),   [AT(M_Q_DRAG)] = AUVID_C(-0.8), [AT(X_UU)] = AUVID_C(-141.0),
    [AT(Y_VV)] = AUVID_C(-217.0), [AT(Z_WW)] = AUVID_C(-190.0),   [AT(K_PP)] = AUVID_C(-1.19),
    [AT(M_QQ)] = AUVID_C(-0.47),  [AT(N_RR)] = AUVID_C(-1.5),
};

#endif
