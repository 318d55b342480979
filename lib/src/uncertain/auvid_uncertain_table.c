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
    SQUARE = ACTUATED << 2,
    UNFORCED = ACTUATED << 3
};

/* Those of a model of roll or pitch. */
#define TILTED_SHIFT (AUVID_DOF_COUNT + 4)
#define TILTED(equations) ((equations) << TILTED_SHIFT)

static bool table_acts(const auvid_uncertain_t *u, int thruster, int j)
{
    return auvid_abs(u->allocation->cfg.thruster[thruster].wrench[j]) > AUVID_C(0.0);
}

static bool table_is_free(const auvid_metric_t *m, int i, int j)
{
    return (auvid_metric_free_columns(m, j) >> i & 1u) != 0;
}

/* Returns the parameter of this kind in DoF j's equation that is free, or fixed at another value
 * than 0; -1: there is none. */
static int table_parameter(const auvid_metric_t *m, auvid_parameter_kind_t kind, int j)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    for (int i = 0; i < vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &vehicle->parameter[i];
        if ((vehicle->columns[j] >> i & 1u) != 0 && p->kind == kind && (int)p->dof == j &&
            (table_is_free(m, i, j) || auvid_abs(m->cfg.fixed[i]) > AUVID_C(0.0))) {
            return i;
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
    bool square = table_parameter(m, AUVID_PARAMETER_QUADRATIC_DRAG, j) >= 0;
    is |= square ? SQUARE : 0;
    is |= square || table_parameter(m, AUVID_PARAMETER_LINEAR_DRAG, j) >= 0 ? DRAGGED : 0;
    int force = table_parameter(m, AUVID_PARAMETER_FORCE, j);
    bool forced = (force >= 0 && table_is_free(m, force, j)) || auvid_uncertain_tilts(j);
    is |= forced ? 0 : UNFORCED;
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

/* Value of this kind in DoF j, last estimated or fixed. */
static auvid_real_t table_value(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                auvid_parameter_kind_t kind, int j)
{
    int p = table_parameter(m, kind, j);
    return p < 0 ? AUVID_C(0.0) : table_is_free(m, p, j) ? u->pi[p] : m->cfg.fixed[p];
}

/* Its size; drag that drives counts as none. */
static auvid_real_t table_size(const auvid_uncertain_t *u, const auvid_metric_t *m,
                               auvid_parameter_kind_t kind, int j)
{
    auvid_real_t value = table_value(u, m, kind, j);
    return auvid_max(auvid_vehicle_is_drag(kind) ? -value : value, AUVID_C(0.0));
}

auvid_real_t auvid_uncertain_mean_drag(const auvid_uncertain_t *u, const auvid_metric_t *m, int j)
{
    return -table_value(u, m, AUVID_PARAMETER_LINEAR_DRAG, j) -
           table_value(u, m, AUVID_PARAMETER_QUADRATIC_DRAG, j);
}

void auvid_uncertain_hull_drag(const auvid_uncertain_t *u, const auvid_metric_t *m, int j,
                               auvid_real_t size[2])
{
    static const auvid_parameter_kind_t kind[2] = {AUVID_PARAMETER_LINEAR_DRAG,
                                                   AUVID_PARAMETER_QUADRATIC_DRAG};
    for (int d = 0; d < 2; ++d) {
        size[d] = auvid_max(u->hidden[j][d] - table_value(u, m, kind[d], j), AUVID_C(0.0));
    }
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
    auvid_real_t size[2];
    auvid_uncertain_hull_drag(u, m, j, size);
    return deviation * (size[0] + size[1]);
}

auvid_real_t auvid_uncertain_linear_part(const auvid_uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_real_t size[2];
    auvid_uncertain_hull_drag(u, m, j, size);
    auvid_real_t drag = size[0] + size[1];
    return drag > AUVID_C(0.0) ? size[0] / drag : AUVID_C(0.0);
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
