/*
 * Uncertain inputs: the table of auvid_uncertain_table_internal.h, and what its names mean.
 */
#include <stddef.h>
#include <string.h>

#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_table_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../models/auvid_vehicle_internal.h"

#define GRAVITY AUVID_C(9.81)

/* ---- equations ---- */

/* What an equation is, a bit each; a row names those with a column. */
enum {
    SURGE = 1 << AUVID_SURGE,
    SWAY = 1 << AUVID_SWAY,
    HEAVE = 1 << AUVID_HEAVE,
    ROLL = 1 << AUVID_ROLL,
    PITCH = 1 << AUVID_PITCH,
    YAW = 1 << AUVID_YAW,
    PLANAR = AUVID_UNCERTAIN_PLANAR,
    ACTUATED = 1 << AUVID_DOF_COUNT,
    DRAGGED = ACTUATED << 1,
    UNFORCED = ACTUATED << 2
};

/* Those of a model of roll or pitch. */
#define TILTED_SHIFT (AUVID_DOF_COUNT + 3)
#define TILTED(equations) ((equations) << TILTED_SHIFT)

static bool table_acts(const auvid_uncertain_t *u, int thruster, int j)
{
    return auvid_abs(u->allocation->cfg.thruster[thruster].wrench[j]) > AUVID_C(0.0);
}

/* Returns the parameter of this kind in DoF j's equation, -1: there is none. */
static int table_parameter(const auvid_metric_t *m, auvid_parameter_kind_t kind, int j)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    for (int k = 0; k < e.count; ++k) {
        const auvid_parameter_t *p = &m->cfg.vehicle->parameter[e.index[k]];
        if (p->kind == kind && (int)p->dof == j) {
            return e.index[k];
        }
    }
    return -1;
}

/* Has the model an equation of roll or pitch? */
static bool table_tilts(const auvid_metric_t *m)
{
    return auvid_metric_order(m, AUVID_ROLL) > 0 || auvid_metric_order(m, AUVID_PITCH) > 0;
}

static int table_properties(const auvid_uncertain_t *u, const auvid_metric_t *m, int j)
{
    int is = 1 << j;
    is |= table_parameter(m, AUVID_PARAMETER_QUADRATIC_DRAG, j) >= 0 ? DRAGGED : 0;
    bool unforced = table_parameter(m, AUVID_PARAMETER_FORCE, j) < 0 && !auvid_uncertain_tilts(j);
    is |= unforced ? UNFORCED : 0;
    is |= table_tilts(m) ? TILTED(1 << j) : 0;
    for (int i = 0; i < u->allocation->cfg.thrusters; ++i) {
        is |= table_acts(u, i, j) ? ACTUATED : 0;
    }
    return is;
}

bool auvid_uncertain_has(const auvid_uncertain_t *u, const auvid_metric_t *m, int input, int j)
{
    const auvid_uncertain_row_t *row = auvid_uncertain_row(input);
    int i = input - AUVID_UNCERTAIN_GAIN;
    bool acts =
        row->from != INPUT_FROM_GAIN || (i < u->allocation->cfg.thrusters && table_acts(u, i, j));
    return acts && (row->equations & table_properties(u, m, j)) != 0 &&
           auvid_uncertain_configured(u, input) > AUVID_C(0.0);
}

uint8_t auvid_uncertain_moved(const auvid_uncertain_t *u, const auvid_metric_t *m, int input)
{
    uint32_t equations = auvid_uncertain_row(input)->equations;
    bool has = auvid_uncertain_configured(u, input) > AUVID_C(0.0);
    equations = (equations & PLANAR) | (table_tilts(m) ? equations >> TILTED_SHIFT : 0);
    return (uint8_t)(has ? equations : 0);
}

bool auvid_uncertain_of_hull(const auvid_metric_t *m, int input)
{
    int from = auvid_uncertain_row(input)->from;
    return from == INPUT_FROM_HULL || (from == INPUT_FROM_WEIGHT && !table_tilts(m));
}

/* ---- priors ---- */

/* Size of the last estimate of this kind in DoF j; drag that drives counts as none. */
static auvid_real_t table_size(const auvid_uncertain_t *u, const auvid_metric_t *m,
                               auvid_parameter_kind_t kind, int j)
{
    int p = table_parameter(m, kind, j);
    auvid_real_t value = p < 0 ? AUVID_C(0.0) : u->pi[p];
    return auvid_max(auvid_vehicle_is_drag(kind) ? -value : value, AUVID_C(0.0));
}

auvid_real_t auvid_uncertain_half_length(const auvid_uncertain_t *u, const auvid_metric_t *m)
{
    auvid_real_t inertia = table_size(u, m, AUVID_PARAMETER_INERTIA, AUVID_YAW);
    auvid_real_t mass = table_size(u, m, AUVID_PARAMETER_MASS, AUVID_SWAY);
    return mass > AUVID_C(0.0) ? AUVID_C(2.0) * auvid_sqrt(inertia / mass) : AUVID_C(0.0);
}

/* Half of the variance: of one of two laws whose sum is configured. */
static auvid_real_t table_half(const auvid_uncertain_t *u, const auvid_metric_t *m,
                               auvid_real_t deviation, int j)
{
    (void)u, (void)m, (void)j;
    return AUVID_C(0.70710678) * deviation;
}

/* Of the largest force of all thrusters. */
static auvid_real_t table_dead_band(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                    auvid_real_t deviation, int j)
{
    auvid_real_t max_N = AUVID_C(0.0);
    (void)m, (void)j;
    for (int i = 0; i < u->allocation->cfg.thrusters; ++i) {
        max_N = auvid_max(max_N, auvid_uncertain_largest(&u->allocation->cfg.thruster[i]));
    }
    return deviation * max_N;
}

/* Of the drag at 1 m/s or rad/s. */
static auvid_real_t table_asymmetry(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                    auvid_real_t deviation, int j)
{
    return deviation * (table_size(u, m, AUVID_PARAMETER_LINEAR_DRAG, j) +
                        table_size(u, m, AUVID_PARAMETER_QUADRATIC_DRAG, j));
}

auvid_real_t auvid_uncertain_linear_part(const auvid_uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_real_t linear = table_size(u, m, AUVID_PARAMETER_LINEAR_DRAG, j);
    auvid_real_t drag = linear + table_size(u, m, AUVID_PARAMETER_QUADRATIC_DRAG, j);
    return drag > AUVID_C(0.0) ? linear / drag : AUVID_C(0.0);
}

/* Of the largest wrench. */
static auvid_real_t table_force(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                auvid_real_t deviation, int j)
{
    (void)u;
    return deviation * m->cfg.tau_max[j];
}

/* Of the drag in sway, at half the length. */
static auvid_real_t table_cross(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                auvid_real_t deviation, int j)
{
    (void)j;
    return deviation * table_size(u, m, AUVID_PARAMETER_LINEAR_DRAG, AUVID_SWAY) *
           auvid_uncertain_half_length(u, m);
}

/* Of the quadratic drag. */
static auvid_real_t table_cross_flow(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                     auvid_real_t deviation, int j)
{
    return deviation * table_size(u, m, AUVID_PARAMETER_QUADRATIC_DRAG, j);
}

/* Of the drag in surge. */
static auvid_real_t table_lift(const auvid_uncertain_t *u, const auvid_metric_t *m,
                               auvid_real_t deviation, int j)
{
    return deviation * table_size(u, m, AUVID_PARAMETER_QUADRATIC_DRAG, AUVID_SURGE) *
           (j == AUVID_YAW ? AUVID_C(0.67) * auvid_uncertain_half_length(u, m) : AUVID_C(0.5));
}

/* The lever of the vehicle's weight. */
static auvid_real_t table_weight(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                 auvid_real_t deviation, int j)
{
    auvid_real_t dry = u->id->dry_mass_kg;
    (void)j;
    if (!(dry > AUVID_C(0.0))) {
        dry = AUVID_C(0.6) * table_size(u, m, AUVID_PARAMETER_MASS, AUVID_SURGE);
    }
    return deviation * GRAVITY * dry;
}

/* ---- the rows ---- */

#define AS_CONFIGURED NULL, false
#define COLUMN(prior) prior, false
#define RELATIVE(prior) prior, true
#define NUMBERS(input, deviation, from, equations, prior, class, ...)                              \
    [UNCERTAIN_ROW(input)] = {prior, offsetof(auvid_uncertain_config_t, deviation),                \
                              INPUT_FROM_##from, AUVID_CAUSE_##class, equations},

const auvid_uncertain_row_t auvid_uncertain_table[] = {AUVID_UNCERTAIN_TABLE(NUMBERS)};

_Static_assert(sizeof(auvid_uncertain_config_t) <= 255, "deviation_at");
_Static_assert(sizeof auvid_uncertain_table / sizeof auvid_uncertain_table[0] ==
                   UNCERTAIN_ROW(INPUTS),
               "a row for each input");

auvid_real_t auvid_uncertain_configured(const auvid_uncertain_t *u, int input)
{
    auvid_real_t deviation;
    memcpy(&deviation, (const char *)&u->cfg + auvid_uncertain_row(input)->deviation_at,
           sizeof deviation);
    return deviation;
}

auvid_real_t auvid_uncertain_sigma(const auvid_uncertain_t *u, const auvid_metric_t *m, int input,
                                   int j)
{
    const auvid_uncertain_row_t *row = auvid_uncertain_row(input);
    auvid_real_t deviation = auvid_uncertain_configured(u, input);
    return u->scale * (row->prior != NULL ? row->prior(u, m, deviation, j) : deviation);
}
