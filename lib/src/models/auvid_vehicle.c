/*
 * Vehicle model interface (Eq. 2), kinematics (Eq. 1) and the Girona500 model (Eq. 12-15).
 *
 *   X = m_u u' - m_v v r + m_w w q + (W-B) sin(theta)          - X_u u - X_uu |u|u - X_0     (12)
 *   Y = m_v v' - m_w w p + m_u u r - (W-B) cos(theta) sin(phi) - Y_v v - Y_vv |v|v - Y_0     (13)
 *   Z = m_w w' - m_u u q + m_v v p - (W-B) cos(theta) cos(phi) - Z_w w - Z_ww |w|w - Z_0     (14)
 *   N = m_r r' - (m_u - m_v) u v                               - N_r r - N_rr |r|r - N_0     (15)
 *
 * Eq. 13 is printed with m_w w q; the Coriolis matrix (Fossen 2011, Eq. 3.57) has m_w w p.
 */
#include "auvid_vehicle_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

const uint8_t auvid_build = 1;

/* Check that the masks agree with each other and with the parameters. */
static void vehicle_check_masks(const auvid_vehicle_t *vehicle, auvid_refusal_t *why)
{
    uint32_t all = 0, mask = UINT32_MAX >> (32 - vehicle->parameters);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        unsigned reads = vehicle->reads[j];
        all |= vehicle->columns[j];
        auvid_check_element(why, j);
        auvid_check_that(why,
                         reads == 0 || (reads >> AUVID_DOF_COUNT == 0 && (reads >> j & 1u) != 0),
                         AUVID_ERR_MODEL, "reads");
        auvid_check_that(why, (vehicle->columns[j] & ~mask) == 0, AUVID_ERR_MODEL, "columns");
    }
    auvid_check_element(why, -1);
    auvid_check_that(why, all != 0, AUVID_ERR_MODEL, "columns");
    auvid_check_that(why, (vehicle->affine & ~mask) == 0, AUVID_ERR_MODEL, "affine");
    for (int i = 0; i < vehicle->parameters; ++i) {
        auvid_dof_t dof = vehicle->parameter[i].dof;
        auvid_check_element(why, i);
        uint32_t columns = (unsigned)dof < AUVID_DOF_COUNT ? vehicle->columns[dof] : 0u;
        bool elsewhere = ((all & ~columns) >> i & 1u) != 0;
        auvid_check_that(why, columns != 0 && !elsewhere, AUVID_ERR_MODEL, "parameter.dof");
    }
}

void auvid_vehicle_check_fields(const auvid_vehicle_t *vehicle, auvid_refusal_t *why)
{
    auvid_check_that(why, vehicle != NULL, AUVID_ERR_NULL, "");
    if (vehicle == NULL) {
        return;
    }
    auvid_check_that(why, vehicle->parameter != NULL, AUVID_ERR_NULL, "parameter");
    auvid_check_that(why, vehicle->built_for == AUVID_BUILD, AUVID_ERR_SIZE, "built_for");
    auvid_check_count(why, AUVID_ERR_PARAMETERS, "parameters", vehicle->parameters,
                      AUVID_MAX_PARAMETERS);
    auvid_check_that(why, vehicle->path != NULL, AUVID_ERR_MODEL, "path");
    auvid_check_that(
        why, vehicle->residual != NULL || (vehicle->regressor != NULL && vehicle->thrust == NULL),
        AUVID_ERR_MODEL, "residual");
    auvid_check_that(why, vehicle->thrust == NULL || vehicle->ignores_inputs, AUVID_ERR_MODEL,
                     "thrust");
    if (why->status == AUVID_OK) {
        vehicle_check_masks(vehicle, why);
    }
}

auvid_status_t auvid_vehicle_check(const auvid_vehicle_t *vehicle)
{
    auvid_refusal_t why;
    auvid_check_begin(&why);
    auvid_vehicle_check_fields(vehicle, &why);
    return why.status;
}

uint8_t auvid_vehicle_unmeasured(const auvid_vehicle_t *vehicle, uint8_t missing)
{
    unsigned dofs = 0;
    for (int j = 0; j < AUVID_DOF_COUNT && missing != 0; ++j) {
        unsigned reads = vehicle->reads[j];
        dofs |= (unsigned)(reads == 0 || (reads & missing) != 0) << j;
    }
    return (uint8_t)dofs;
}

void auvid_vehicle_residual(const auvid_vehicle_t *vehicle, const auvid_sample_t *sample,
                            const auvid_real_t *pi, auvid_real_t residual[AUVID_DOF_COUNT])
{
    auvid_clear(residual, AUVID_DOF_COUNT);
    if (vehicle->thrust != NULL) {
        auvid_sample_t s = *sample;
        if (vehicle->thrust(vehicle->context, sample, pi, s.tau)) {
            vehicle->residual(vehicle->context, &s, pi, residual);
        }
        return;
    }
    if (vehicle->residual != NULL) {
        vehicle->residual(vehicle->context, sample, pi, residual);
        return;
    }
    auvid_regressor_t y;
    auvid_zero(&y, sizeof y);
    vehicle->regressor(vehicle->context, sample, pi, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (vehicle->columns[j] != 0) {
            auvid_real_t predicted = AUVID_C(0.0);
            for (int i = 0; i < vehicle->parameters; ++i) {
                predicted += y.row[j][i] * pi[i];
            }
            residual[j] = predicted - sample->tau[j];
        }
    }
}

auvid_status_t auvid_kinematics(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi,
                                const auvid_real_t *nu, auvid_real_t *eta_dot)
{
    if (nu == NULL || eta_dot == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!auvid_is_finite(phi) || !auvid_is_finite(theta) || !auvid_is_finite(psi) ||
        !auvid_all_finite(nu, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    const auvid_real_t max_angle = AUVID_C(1e4); /* range of auvid_sincos */
    if (auvid_abs(phi) > max_angle || auvid_abs(theta) > max_angle || auvid_abs(psi) > max_angle) {
        return AUVID_ERR_RANGE;
    }
    auvid_real_t s_phi, c_phi, s_theta, c_theta, r[3][3];
    auvid_sincos(phi, &s_phi, &c_phi);
    auvid_sincos(theta, &s_theta, &c_theta);
    if (!(auvid_abs(c_theta) > AUVID_C(1e-3))) {
        return AUVID_ERR_SINGULAR;
    }
    auvid_rotation(phi, theta, psi, r);
    for (int i = 0; i < 3; ++i) {
        eta_dot[i] = r[i][0] * nu[0] + r[i][1] * nu[1] + r[i][2] * nu[2];
    }
    /* phi' = p + tan(theta) (q sin(phi) + r cos(phi)), and so on (Fossen 2011, Eq. 2.39). */
    auvid_real_t turn = nu[AUVID_PITCH] * s_phi + nu[AUVID_YAW] * c_phi;
    eta_dot[AUVID_ROLL] = nu[AUVID_ROLL] + s_theta / c_theta * turn;
    eta_dot[AUVID_PITCH] = nu[AUVID_PITCH] * c_phi - nu[AUVID_YAW] * s_phi;
    eta_dot[AUVID_YAW] = turn / c_theta;
    return AUVID_OK;
}

#if AUVID_MAX_PARAMETERS >= 13

/* Selects one of the three variants of the model. */
typedef struct {
    bool coupled; /* includes the terms of C(nu) nu */
    bool printed; /* Eq. 13 with w q instead of w p */
} g500_form_t;

static const auvid_parameter_t g500_parameter[AUVID_G500_COUNT] = {
    [AUVID_G500_M_U] = {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    [AUVID_G500_M_V] = {"m_v", "kg", AUVID_SWAY, AUVID_PARAMETER_MASS},
    [AUVID_G500_M_W] = {"m_w", "kg", AUVID_HEAVE, AUVID_PARAMETER_MASS},
    [AUVID_G500_M_R] = {"m_r", "kg m2", AUVID_YAW, AUVID_PARAMETER_INERTIA},
    [AUVID_G500_W_B] = {"W-B", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE},
    [AUVID_G500_X_U] = {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    [AUVID_G500_X_UU] = {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AUVID_G500_Y_V] = {"Y_v", "N s/m", AUVID_SWAY, AUVID_PARAMETER_LINEAR_DRAG},
    [AUVID_G500_Y_VV] = {"Y_vv", "N s2/m2", AUVID_SWAY, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AUVID_G500_Z_W] = {"Z_w", "N s/m", AUVID_HEAVE, AUVID_PARAMETER_LINEAR_DRAG},
    [AUVID_G500_Z_WW] = {"Z_ww", "N s2/m2", AUVID_HEAVE, AUVID_PARAMETER_QUADRATIC_DRAG},
    [AUVID_G500_N_R] = {"N_r", "Nm s", AUVID_YAW, AUVID_PARAMETER_LINEAR_DRAG},
    [AUVID_G500_N_RR] = {"N_rr", "Nm s2", AUVID_YAW, AUVID_PARAMETER_QUADRATIC_DRAG},
#if AUVID_MAX_PARAMETERS >= 17
    [AUVID_G500_X_0] = {"X_0", "N", AUVID_SURGE, AUVID_PARAMETER_FORCE},
    [AUVID_G500_Y_0] = {"Y_0", "N", AUVID_SWAY, AUVID_PARAMETER_FORCE},
    [AUVID_G500_Z_0] = {"Z_0", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE},
    [AUVID_G500_N_0] = {"N_0", "Nm", AUVID_YAW, AUVID_PARAMETER_FORCE},
#endif
};

const auvid_real_t auvid_girona500_paper[AUVID_G500_COUNT] = {
    [AUVID_G500_M_U] = AUVID_C(249.5384),   [AUVID_G500_M_V] = AUVID_C(367.7126),
    [AUVID_G500_M_W] = AUVID_C(659.9799),   [AUVID_G500_M_R] = AUVID_C(74.9024),
    [AUVID_G500_W_B] = AUVID_C(-37.3058),   [AUVID_G500_X_U] = AUVID_C(-42.4181),
    [AUVID_G500_X_UU] = AUVID_C(-125.3578), [AUVID_G500_Y_V] = AUVID_C(-75.7673),
    [AUVID_G500_Y_VV] = AUVID_C(-447.6195), [AUVID_G500_Z_W] = AUVID_C(-44.0561),
    [AUVID_G500_Z_WW] = AUVID_C(-325.0138), [AUVID_G500_N_R] = AUVID_C(-20.5833),
    [AUVID_G500_N_RR] = AUVID_C(-60.9373),
};

static void vehicle_g500_regressor(const void *context, const auvid_sample_t *s,
                                   const auvid_real_t *pi, auvid_regressor_t *y)
{
    (void)pi;
    const g500_form_t *form = context;
    auvid_real_t s_phi, c_phi, s_theta, c_theta;
    auvid_sincos(s->phi, &s_phi, &c_phi);
    auvid_sincos(s->theta, &s_theta, &c_theta);
    auvid_real_t u = s->nu[AUVID_SURGE], v = s->nu[AUVID_SWAY], w = s->nu[AUVID_HEAVE];
    auvid_real_t p = s->nu[AUVID_ROLL], q = s->nu[AUVID_PITCH], r = s->nu[AUVID_YAW];
    auvid_real_t *x_row = y->row[AUVID_SURGE], *y_row = y->row[AUVID_SWAY];
    auvid_real_t *z_row = y->row[AUVID_HEAVE], *n_row = y->row[AUVID_YAW];

    x_row[AUVID_G500_M_U] = s->nu_dot[AUVID_SURGE];
    x_row[AUVID_G500_W_B] = s_theta;
    x_row[AUVID_G500_X_U] = -u;
    x_row[AUVID_G500_X_UU] = -auvid_abs(u) * u;

    y_row[AUVID_G500_M_V] = s->nu_dot[AUVID_SWAY];
    y_row[AUVID_G500_W_B] = -c_theta * s_phi;
    y_row[AUVID_G500_Y_V] = -v;
    y_row[AUVID_G500_Y_VV] = -auvid_abs(v) * v;

    z_row[AUVID_G500_M_W] = s->nu_dot[AUVID_HEAVE];
    z_row[AUVID_G500_W_B] = -c_theta * c_phi;
    z_row[AUVID_G500_Z_W] = -w;
    z_row[AUVID_G500_Z_WW] = -auvid_abs(w) * w;

    n_row[AUVID_G500_M_R] = s->nu_dot[AUVID_YAW];
    n_row[AUVID_G500_N_R] = -r;
    n_row[AUVID_G500_N_RR] = -auvid_abs(r) * r;
#if AUVID_MAX_PARAMETERS >= 17
    x_row[AUVID_G500_X_0] = AUVID_C(-1.0);
    y_row[AUVID_G500_Y_0] = AUVID_C(-1.0);
    z_row[AUVID_G500_Z_0] = AUVID_C(-1.0);
    n_row[AUVID_G500_N_0] = AUVID_C(-1.0);
#endif

    if (form->coupled) {
        x_row[AUVID_G500_M_V] = -v * r;
        x_row[AUVID_G500_M_W] = w * q;
        y_row[AUVID_G500_M_W] = -w * (form->printed ? q : p);
        y_row[AUVID_G500_M_U] = u * r;
        z_row[AUVID_G500_M_U] = -u * q;
        z_row[AUVID_G500_M_V] = v * p;
        n_row[AUVID_G500_M_U] = -u * v;
        n_row[AUVID_G500_M_V] = u * v;
    }
}

/* An equation: its DoF, the mass of its acceleration, and its other n parameters. */
typedef struct {
    uint8_t dof, mass, n, other[6];
} g500_equation_t;

#define G500(name) AUVID_G500_##name
#if AUVID_MAX_PARAMETERS >= 17
#define G500_EQUATION(dof, mass, n, bias, ...)                                                     \
    {                                                                                              \
        AUVID_##dof, G500(mass), (n) + 1,                                                          \
        {                                                                                          \
            __VA_ARGS__, G500(bias)                                                                \
        }                                                                                          \
    }
#else
#define G500_EQUATION(dof, mass, n, bias, ...)                                                     \
    {                                                                                              \
        AUVID_##dof, G500(mass), n,                                                                \
        {                                                                                          \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#endif
static const g500_equation_t g500_equation[] = {
    G500_EQUATION(SURGE, M_U, 5, X_0, G500(M_V), G500(M_W), G500(W_B), G500(X_U), G500(X_UU)),
    G500_EQUATION(SWAY, M_V, 5, Y_0, G500(M_U), G500(M_W), G500(W_B), G500(Y_V), G500(Y_VV)),
    G500_EQUATION(HEAVE, M_W, 5, Z_0, G500(M_U), G500(M_V), G500(W_B), G500(Z_W), G500(Z_WW)),
    G500_EQUATION(YAW, M_R, 4, N_0, G500(M_U), G500(M_V), G500(N_R), G500(N_RR))};

/* Solves the equations for nu_dot. Each contains one acceleration, times one mass. So it divides
 * tau minus all other terms by this mass. */
static bool vehicle_g500_acceleration(const void *context, const auvid_sample_t *sample,
                                      const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    auvid_regressor_t y;
    bool solved = false;
    auvid_zero(&y, sizeof y);
    vehicle_g500_regressor(context, sample, NULL, &y);
    for (size_t k = 0; k < sizeof g500_equation / sizeof g500_equation[0]; ++k) {
        const g500_equation_t *equation = &g500_equation[k];
        const auvid_real_t *row = y.row[equation->dof];
        auvid_real_t rest = sample->tau[equation->dof], mass = pi[equation->mass];
        for (const uint8_t *i = equation->other, *end = i + equation->n; i < end; ++i) {
            rest -= row[*i] * pi[*i];
        }
        nu_dot[equation->dof] = rest / auvid_max(mass, AUVID_C(0.0)); /* no mass: not finite */
        solved = solved || mass > AUVID_C(0.0);
    }
    return solved;
}

#define G500_BIT(name) (1u << AUVID_G500_##name)
#define G500_FORCES (G500_BIT(M_U) | G500_BIT(M_V) | G500_BIT(M_W) | G500_BIT(W_B))
#if AUVID_MAX_PARAMETERS >= 17
#define BIAS(name) G500_BIT(name)
#else
#define BIAS(name) 0u
#endif
/* The velocities that the coupled and the decoupled equations read (top of the file). */
#define READ(dof) (1u << AUVID_##dof)
#define G500_MOVES (READ(SURGE) | READ(SWAY))
#define READS_COUPLED                                                                              \
    .reads = {[AUVID_SURGE] = G500_MOVES | READ(HEAVE) | READ(PITCH) | READ(YAW),                  \
              [AUVID_SWAY] = G500_MOVES | READ(HEAVE) | READ(ROLL) | READ(PITCH) | READ(YAW),      \
              [AUVID_HEAVE] = G500_MOVES | READ(HEAVE) | READ(ROLL) | READ(PITCH),                 \
              [AUVID_YAW] = G500_MOVES | READ(YAW)}
#define READS_OWN                                                                                  \
    .reads = {[AUVID_SURGE] = READ(SURGE),                                                         \
              [AUVID_SWAY] = READ(SWAY),                                                           \
              [AUVID_HEAVE] = READ(HEAVE),                                                         \
              [AUVID_YAW] = READ(YAW)}
#define G500_MODEL(title, form_, reads_)                                                           \
    {                                                                                              \
        .built_for = AUVID_BUILD, .path = &auvid_path_regressor, .name = title,                    \
        .parameters = AUVID_G500_COUNT, .parameter = g500_parameter,                               \
        .columns = {[AUVID_SURGE] = G500_FORCES | G500_BIT(X_U) | G500_BIT(X_UU) | BIAS(X_0),      \
                    [AUVID_SWAY] = G500_FORCES | G500_BIT(Y_V) | G500_BIT(Y_VV) | BIAS(Y_0),       \
                    [AUVID_HEAVE] = G500_FORCES | G500_BIT(Z_W) | G500_BIT(Z_WW) | BIAS(Z_0),      \
                    [AUVID_YAW] = G500_BIT(M_U) | G500_BIT(M_V) | G500_BIT(M_R) | G500_BIT(N_R) |  \
                                  G500_BIT(N_RR) | BIAS(N_0)},                                     \
        .free = AUVID_G500_FREE, .regressor = vehicle_g500_regressor,                              \
        .acceleration = vehicle_g500_acceleration, .context = &(form_), reads_                     \
    }

static const g500_form_t g500_fossen = {.coupled = true, .printed = false};
static const g500_form_t g500_as_printed = {.coupled = true, .printed = true};
static const g500_form_t g500_decoupled = {.coupled = false, .printed = false};

const auvid_vehicle_t auvid_girona500 =
    G500_MODEL("Girona500, Eq. 12-15", g500_fossen, READS_COUPLED);
const auvid_vehicle_t auvid_girona500_printed =
    G500_MODEL("Girona500, Eq. 12-15 as printed", g500_as_printed, READS_COUPLED);
const auvid_vehicle_t auvid_girona500_decoupled =
    G500_MODEL("Girona500, decoupled", g500_decoupled, READS_OWN);

#endif
