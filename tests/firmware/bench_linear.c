/*
 * One search on 240 s of data for a linear model with AUVID_MAX_PARAMETERS parameters: 4 and 7 are
 * heave, and heave and yaw; 13 is Girona500; 20 are the default ones of Fossen's model (whose size
 * is 22), 26 and 32 all of them. Motion and wrench are sines and noise. For bench_linear.sh.
 */
#include "auvid/auvid.h"
#include "base/auvid_math_internal.h"
#include "machine.h"

#define TICK_US 20000u
#define TICKS (260u * 50u)

static auvid_identifier_t id;

#if AUVID_MAX_PARAMETERS <= 7
/* Inertia, linear and quadratic drag of heave and yaw, and a constant force in heave. */
static void regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                      auvid_regressor_t *y)
{
    (void)context;
    (void)pi;
    for (int k = 0; k < AUVID_MAX_PARAMETERS / 3; ++k) {
        int j = k == 0 ? AUVID_HEAVE : AUVID_YAW, at = k == 0 ? 1 : 4;
        y->row[j][at] = s->nu_dot[j];
        y->row[j][at + 1] = -s->nu[j];
        y->row[j][at + 2] = -s->nu[j] * auvid_abs(s->nu[j]);
    }
    y->row[AUVID_HEAVE][0] = -1;
}

static const auvid_parameter_t parameter[] = {
    {"W-B", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE},
    {"m_w", "kg", AUVID_HEAVE, AUVID_PARAMETER_MASS},
    {"Z_w", "N s/m", AUVID_HEAVE, AUVID_PARAMETER_LINEAR_DRAG},
    {"Z_ww", "N s2/m2", AUVID_HEAVE, AUVID_PARAMETER_QUADRATIC_DRAG},
    {"m_r", "kg m2", AUVID_YAW, AUVID_PARAMETER_INERTIA},
    {"N_r", "Nm s", AUVID_YAW, AUVID_PARAMETER_LINEAR_DRAG},
    {"N_rr", "Nm s2", AUVID_YAW, AUVID_PARAMETER_QUADRATIC_DRAG}};
static const auvid_vehicle_t vehicle = {
    .built_for = AUVID_BUILD,
    .path = &auvid_path_regressor,
    .name = "heave",
    .parameters = AUVID_MAX_PARAMETERS,
    .parameter = parameter,
    .columns = {[AUVID_HEAVE] = 0xFu, [AUVID_YAW] = AUVID_MAX_PARAMETERS == 7 ? 0x70u : 0u},
    .regressor = regressor,
    .reads = {[AUVID_HEAVE] = 1u << AUVID_HEAVE, [AUVID_YAW] = 1u << AUVID_YAW}};
#define VEHICLE vehicle
#define FREE ((1u << AUVID_MAX_PARAMETERS) - 1u)
#elif AUVID_MAX_PARAMETERS < 22
#define VEHICLE auvid_girona500
#define FREE auvid_girona500.free
#else
#define VEHICLE auvid_fossen
#define ALL (UINT32_MAX >> (32 - AUVID_MAX_PARAMETERS))
#define FREE (AUVID_MAX_PARAMETERS == 22 ? AUVID_FOSSEN_FREE : ALL)
#endif

/* Masses of 100, drags of -50, other forces of 10: in the bounds, and all different from zero. */
static auvid_real_t truth(int i)
{
    uint8_t kind = VEHICLE.parameter[i].kind;
    bool mass = kind == AUVID_PARAMETER_MASS || kind == AUVID_PARAMETER_INERTIA;
    bool drag = kind == AUVID_PARAMETER_LINEAR_DRAG || kind == AUVID_PARAMETER_QUADRATIC_DRAG;
    return (FREE >> i & 1u) == 0 ? 0 : (auvid_real_t)(mass ? 100 : drag ? -50 : 10);
}

/* Two sines in each velocity, and in roll and pitch; noise of 1 N on the wrench. */
static void make_tick(uint32_t tick, auvid_real_t *attitude, auvid_sample_t *s)
{
    static uint32_t random = 1;
    auvid_real_t t = AUVID_C(0.02) * (auvid_real_t)tick, unused;
    auvid_regressor_t y = {0};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s->nu[j] = s->nu_dot[j] = 0;
        for (int k = 0; k < 2; ++k) {
            auvid_real_t sine, cosine, w = (auvid_real_t)(150 + 43 * (j + 7 * k)) / 1000;
            auvid_sincos(w * t, &sine, &cosine);
            s->nu[j] += AUVID_C(0.4) * sine;
            s->nu_dot[j] += AUVID_C(0.4) * w * cosine;
        }
    }
    auvid_sincos(AUVID_C(0.31) * t, &s->phi, &unused);
    auvid_sincos(AUVID_C(0.22) * t, &s->theta, &unused);
    attitude[0] = s->phi *= AUVID_C(0.3);
    attitude[1] = s->theta *= AUVID_C(0.3);
    attitude[2] = 0;
    VEHICLE.regressor(VEHICLE.context, s, NULL, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        random = 1664525u * random + 1013904223u;
        s->tau[j] = (auvid_real_t)(random >> 16) / AUVID_C(32768.0) - 1;
        for (int i = 0; i < VEHICLE.parameters; ++i) {
            s->tau[j] += y.row[j][i] * truth(i);
        }
    }
}

static void print(const char *what, uint32_t number)
{
    machine_print(what);
    machine_print(" ");
    machine_print_number(number);
    machine_print("\n");
}

int main(void)
{
    auvid_identifier_config_t *cfg = &id.cfg;
    auvid_sample_t s = {0};
    auvid_real_t attitude[3];
    auvid_identifier_defaults(cfg, &VEHICLE);
    cfg->metric.free = FREE;
    cfg->exact_inputs = true;
    if (auvid_identifier_init(&id, cfg) < 0) {
        machine_print(id.refusal.field);
        return 1;
    }
    for (uint32_t tick = 1; tick <= TICKS && id.metric.sets.recorded < AUVID_MAX_SETS; ++tick) {
        make_tick(tick, attitude, &s);
        (void)auvid_identifier_motion(&id, (uint64_t)TICK_US * tick, attitude, s.nu);
        (void)auvid_identifier_applied(&id, (uint64_t)TICK_US * tick, s.tau, NULL);
    }
    while (auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET) == AUVID_PENDING) {
    }
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    int n = 0;
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        n += e != NULL && (e->identified >> i & 1u) != 0;
    }
    print("parameters", (uint32_t)n);
    print("not_converged", e == NULL || e->not_converged);
    print("evaluations", e == NULL ? 0 : e->evaluations_crs + e->evaluations_line);
    print("bytes", (uint32_t)sizeof id);
    return e == NULL || id.metric.sets.recorded < AUVID_MAX_SETS;
}
