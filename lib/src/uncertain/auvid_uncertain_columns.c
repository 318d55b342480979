/*
 * Uncertain inputs: their columns.
 *
 * A column is the supplied thrust minus the true one, per unit of the input. The speed of a
 * propeller follows sqrt|f|, f the supplied force, with the nominal lag T. n is that speed, and
 * f_n = n |n|. The columns are summed over the thrusters, each with its column t of the allocation:
 *
 *     backward    min(f_n, 0)                    inflow   |f_n| (t . nu)
 *     dead band   f_n / sqrt(f_n^2 + d^2)        sag      f_n time / 240 s
 *     curve       -f_n ln|f_n / f_max|           gain     -f_n
 *     lag         (f_n - f_m) / b, m behind the lag T + b
 *     delay       d f_n / dt                     response -d^2 f_n / dt^2
 *
 * f_n and f_m are their means over a cell (auvid_uncertain_propellers.c), and d f_n / dt is the
 * difference of such means that gives the acceleration, too (auvid_recorder_slope).
 *
 * Whatever stands between the supplied thrust and the measured motion is a filter, of which only
 * the first moments matter, as the vehicle is slower: -m_1 d/dt of its delay, then +m_2/2 d^2/dt^2,
 * by which a delay differs from a lag of the same mean. A velocity that has been filtered is as
 * good as thrust that acts earlier, with a response of its own in the forces; rates are seldom
 * filtered, so the moments have another.
 *
 * The difference of the lag is taken up to its last estimate b, where the column is exact.
 *
 * Current, lever arm and mounting angle: the motion through the water is not the measured one. With
 * c the current in the body, a the arm and d the small angles by which the DVL is turned,
 *
 *     nu -> nu - c - omega x a + d x nu,   nu' -> nu' + omega x c - omega' x a + d x nu'.
 *
 * The rows are linearised about the last estimates b of c, a and d: the parameters' columns Y are
 * those of the motion through the water, and a column C of one of them is the derivative of the
 * wrench that the last estimate predicts there. Y pi + C (c - b) = z becomes Y pi + C c = z + C b.
 * About zero, current and arm would pass for linear drag, as the mean of |v + c| (v + c) is larger
 * than v |v|; with columns of the first, wrong drag they would still do so many sets later.
 *
 * Drag differs forward and backward: the column is the size of the drag, with the linear and the
 * quadratic part of the last solution. One of the square alone would leave what linear drag adds to
 * a constant force.
 *
 * Drag follows the whole speed, at least in part, not that of its axis alone: each element of a
 * hull has its own velocity. With l about half the length, by the last solution, the column of
 * cross-flow drag is (S - |nu_j|) nu_j, and S^2 is
 *
 *     |v|^2 + (1.5 l r)^2  in surge, sway,   |v|^2  in heave,   |v|^2 / l^2 + nu_j^2  of moments.
 *
 * (A strip that turns faster than it drifts has, with its counterpart at the other end, the drag
 * 2 |x r| v.) Where all axes move at once, this drag and the thrusters' forces vary together:
 * without the column it seems that thrust is lost with speed, and drag becomes too small.
 *
 * A filter in the world's axes, as that of an autopilot, has the velocity lag behind the body's
 * turns. With the time constant d of a filter whose own delay is d of below,
 *
 *     nu -> nu - d nu x omega.
 *
 * The DVL is late by d: for the forces thrust and rates are too early, rates by -d omega', and for
 * the moments the velocities are too late, by d nu'.
 */
#include <string.h>

#include "auvid_uncertain_parts_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "../base/auvid_checksum_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../metric/auvid_metric_rows_internal.h"

/* Width of the dead band's step, and smallest argument of the curve, relative to the force's limit.
 */
#define DEAD_BAND_WIDTH AUVID_C(0.03)
#define SMALLEST_CURVE AUVID_C(1e-4)
/* Step of current [m/s], lever arm [m] and times [s] for their differences. */
#define STEP AUVID_C(0.02)
/* Arm of the drag in turns, over half of the length: 1 of a point there, up to 2 of a strip. */
#define STRIP AUVID_C(1.5)

/* ---- which columns there are ---- */

/* Channels of one weight stand together (uncertain_accumulate). */
static void uncertain_place_channels(auvid_uncertain_t *u)
{
    uint16_t next = 0;
    for (unsigned section = 0; section < 4; ++section) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            const auvid_uncertain_equation_t *e = &u->equation[j];
            unsigned moment = j >= AUVID_ROLL;
            for (int k = 0; k < e->channels; ++k) {
                unsigned thrust =
                    k == e->inputs ||
                    (k < e->inputs && auvid_uncertain_of_thrust(u->code[e->channel_at + k]));
                if (section == 2u * moment + thrust) {
                    u->place[e->channel_at + k] = next++;
                }
            }
        }
        u->section[section + 1u] = next;
    }
}

/* Where the parts of the equations end; the largest order of one. */
typedef struct {
    uint32_t factor, row, channel, own, own_rows, order;
} uncertain_ends_t;

/* Returns the equations with a fixed parameter that is not 0, a bit each. */
static uint8_t uncertain_fixes(const auvid_metric_t *m)
{
    uint32_t dofs = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        uint32_t fixed = m->cfg.vehicle->columns[j] & ~auvid_metric_free_columns(m, j);
        for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
            bool acts = (fixed >> i & 1u) != 0 && auvid_abs(m->cfg.fixed[i]) > AUVID_C(0.0);
            dofs |= (acts ? 1u : 0u) << j;
        }
    }
    return (uint8_t)dofs;
}

/* Lay out DoF j's equation, from the ends of those before it. */
static void uncertain_lay_out_equation(auvid_uncertain_t *u, const auvid_metric_t *m, int j,
                                       uncertain_ends_t *end)
{
    auvid_uncertain_equation_t *e = &u->equation[j];
    *e = (auvid_uncertain_equation_t){.factor_at = (uint16_t)end->factor,
                                      .row_at = (uint16_t)end->row,
                                      .channel_at = (uint16_t)end->channel,
                                      .own_rows_at = (uint16_t)end->own_rows,
                                      .own_at = (uint8_t)end->own};
    for (int n = 0; n < INPUTS; ++n) { /* own inputs first */
        int code = n < INPUTS - OWN_INPUTS ? OWN_INPUTS + n : n - (INPUTS - OWN_INPUTS);
        if (!auvid_uncertain_has(u, m, code, j)) {
            continue;
        }
        if (end->channel + e->inputs < AUVID_UNCERTAIN_CHANNELS) { /* else it is refused */
            u->code[end->channel + e->inputs] = (uint8_t)code;
        }
        ++e->inputs;
        e->own = (uint8_t)(e->own + (code >= OWN_INPUTS));
    }
    e->order = (uint8_t)(e->inputs + auvid_metric_equation(m, j).count + 1);
    bool moves = (AUVID_UNCERTAIN_PLANAR & auvid_uncertain_moves(u)) >> j & 1u;
    e->channels = (uint8_t)(moves ? e->order : e->inputs + 1);
    end->factor += (uint32_t)AUVID_QR_FACTOR(e->order);
    end->row += e->order;
    end->channel += e->channels;
    end->own += e->own;
    end->own_rows += (uint32_t)auvid_qr_row(e->order, e->own);
    end->order = end->order > e->order ? end->order : e->order;
}

/* Check that there is room; AUVID_MAX_UNCERTAIN is to be as large as the value at least. */
static void uncertain_check_ends(const uncertain_ends_t *end, auvid_refusal_t *why)
{
    const uint32_t columns = AUVID_UNCERTAIN_COLUMNS - AUVID_MAX_UNCERTAIN;
    const uint32_t channels = AUVID_UNCERTAIN_CHANNELS - AUVID_MAX_UNCERTAIN;
    uint32_t need = end->row > columns ? end->row - columns : 0;
    need = end->channel > channels + need ? end->channel - channels : need;
    bool others = end->factor <= AUVID_UNCERTAIN_FACTOR && end->own <= AUVID_UNCERTAIN_OWN &&
                  end->own_rows <= AUVID_UNCERTAIN_OWN_ROWS;
    need = need <= AUVID_MAX_UNCERTAIN && !others ? AUVID_MAX_UNCERTAIN + 1 : need;
    auvid_check_limit(why, end->order <= AUVID_UNCERTAIN_ORDER, AUVID_ERR_SIZE,
                      "AUVID_UNCERTAIN_ORDER", (auvid_real_t)end->order,
                      (auvid_real_t)AUVID_UNCERTAIN_ORDER);
    auvid_check_limit(why, need <= AUVID_MAX_UNCERTAIN, AUVID_ERR_SIZE, "AUVID_MAX_UNCERTAIN",
                      (auvid_real_t)need, (auvid_real_t)AUVID_MAX_UNCERTAIN);
}

void auvid_uncertain_lay_out(auvid_uncertain_t *u, const auvid_metric_t *m, auvid_refusal_t *why)
{
    uncertain_ends_t end = {0};
    for (int k = 0; k < AUVID_UNCERTAIN_SHIFTS; ++k) {
        u->moved[k] = auvid_uncertain_moved(u, m, AUVID_UNCERTAIN_CURRENT_X + k);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (auvid_metric_order(m, j) > 0) {
            uncertain_lay_out_equation(u, m, j, &end);
        }
    }
    uncertain_check_ends(&end, why);
    if (why->status == AUVID_OK) {
        u->fixes = uncertain_fixes(m);
        uncertain_place_channels(u);
    }
}

/* ---- columns ---- */

/* Sums of a DoF's equation: those of shared inputs by their number, then d f / dt and f. */
enum { SUM_DELAY = AUVID_UNCERTAIN_GAIN, SUM_THRUST, SUMS };

/* Equations of the forces, a bit each. */
#define OF_FORCES 7u

/* ln x for x > 0, error below 1e-6: x = m 2^e, ln m = 2 atanh((m - 1) / (m + 1)). */
static auvid_real_t uncertain_ln(auvid_real_t x)
{
    int e = (int)(auvid_single_bits(x * AUVID_C(1.4142135)) >> 23) - 127;
    auvid_real_t m = x * auvid_from_single_bits((uint32_t)(127 - e) << 23);
    auvid_real_t s = (m - AUVID_C(1.0)) / (m + AUVID_C(1.0)), q = s * s;
    auvid_real_t series =
        AUVID_C(1.0) + q * (AUVID_C(0.33333333) + q * (AUVID_C(0.2) + q * AUVID_C(0.14285714)));
    return AUVID_C(2.0) * s * series + (auvid_real_t)e * AUVID_C(0.69314718);
}

void auvid_uncertain_compare(auvid_uncertain_t *u, const auvid_metric_t *m,
                             const auvid_sample_t *cell)
{
    const auvid_allocation_config_t *cfg = &u->allocation->cfg;
    auvid_real_t difference[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        difference[j] = -cell->tau[j];
    }
    for (int i = 0; i < cfg->thrusters; ++i) {
        auvid_metric_add_scaled(difference, auvid_uncertain_force(u, i, cell->command[i]),
                                cfg->thruster[i].wrench, AUVID_DOF_COUNT);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t max = m->cfg.tau_max[j];
        if (u->equation[j].order > 0 && max > AUVID_C(0.0)) {
            auvid_real_t wrench = cell->tau[j] / max, off = difference[j] / max;
            u->recorded.wrench += wrench * wrench;
            u->recorded.difference += off * off;
        }
    }
}

/* Sum the columns that are formed from the thrust over the thrusters. */
static void uncertain_thrust_columns(auvid_uncertain_t *u, const auvid_sample_t *water,
                                     auvid_real_t sum[][SUMS])
{
    const int motion = AUVID_UNCERTAIN_CURRENT_X, response = AUVID_UNCERTAIN_FORCE_RESPONSE;
    auvid_real_t value[SUMS]; /* from `motion` to `response` not written */
    for (int i = 0; i < u->allocation->cfg.thrusters; ++i) {
        const auvid_thruster_t *t = &u->allocation->cfg.thruster[i];
        auvid_real_t max_N = auvid_uncertain_largest(t), inflow = AUVID_C(0.0);
        auvid_real_t force = u->recorded.force[i];
        auvid_real_t size = auvid_abs(force), width = DEAD_BAND_WIDTH * max_N;
        if (!(max_N > AUVID_C(0.0))) {
            continue;
        }
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            inflow += t->wrench[j] * water->nu[j];
        }
        value[SUM_THRUST] = force;
        value[AUVID_UNCERTAIN_BACKWARD] = auvid_min(force, AUVID_C(0.0));
        value[AUVID_UNCERTAIN_DEAD_BAND] = force / auvid_sqrt(size * size + width * width);
        value[AUVID_UNCERTAIN_CURVE] =
            -force * uncertain_ln(auvid_max(size / max_N, SMALLEST_CURVE));
        value[AUVID_UNCERTAIN_INFLOW] = size * inflow;
        value[AUVID_UNCERTAIN_BILINEAR] = auvid_sqrt(size * max_N) * inflow;
        value[AUVID_UNCERTAIN_SAG] = force * u->recorded.elapsed;
        value[AUVID_UNCERTAIN_LAG] = u->recorded.lag_slope[i];
        value[SUM_DELAY] = u->recorded.rate[i];
        value[AUVID_UNCERTAIN_FORCE_RESPONSE] = value[AUVID_UNCERTAIN_MOMENT_RESPONSE] =
            -u->recorded.curvature[i];
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            if (auvid_abs(t->wrench[j]) > AUVID_C(0.0)) {
                auvid_metric_add_scaled(sum[j], t->wrench[j], value, motion);
                auvid_metric_add_scaled(sum[j] + response, t->wrench[j], value + response,
                                        SUMS - response);
            }
        }
    }
}

static void uncertain_evaluate(const auvid_metric_t *m, const auvid_sample_t *sample,
                               auvid_regressor_t *y)
{
    auvid_zero(y, sizeof *y);
    m->cfg.vehicle->regressor(m->cfg.vehicle->context, sample, NULL, y);
}

/* Returns what fixed parameters explain of DoF j's wrench. */
static auvid_real_t uncertain_fixed(const auvid_uncertain_t *u, const auvid_metric_t *m, int j,
                                    const auvid_regressor_t *y)
{
    return (u->fixes >> j & 1u) == 0 ? AUVID_C(0.0)
                                     : auvid_metric_explained_by_fixed(m, j, y->row[j]);
}

/* Write Y pi of the equations of these DoF, a bit each. */
static void uncertain_multiply(const auvid_uncertain_t *u, const auvid_metric_t *m,
                               const auvid_regressor_t *y, uint32_t dofs,
                               auvid_real_t wrench[AUVID_DOF_COUNT])
{
    for (int j = 0; dofs >> j != 0; ++j) {
        if ((dofs >> j & 1u) == 0) {
            continue;
        }
        const auvid_real_t *row = y->row[j], *pi = u->pi;
        const uint8_t *index = auvid_metric_row_parameters(m, j);
        auvid_real_t sum = uncertain_fixed(u, m, j, y);
        for (int k = u->equation[j].order - 1 - u->equation[j].inputs; k > 0; --k, ++index) {
            sum += row[*index] * pi[*index];
        }
        wrench[j] = sum;
    }
}

static void uncertain_predict(const auvid_uncertain_t *u, const auvid_metric_t *m,
                              const auvid_sample_t *sample, uint32_t dofs,
                              auvid_real_t wrench[AUVID_DOF_COUNT])
{
    auvid_regressor_t y;
    uncertain_evaluate(m, sample, &y);
    uncertain_multiply(u, m, &y, dofs, wrench);
}

/* c = a x b */
static void uncertain_cross(const auvid_real_t *a, const auvid_real_t *b, auvid_real_t *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Change of velocity and acceleration, per unit of current, lever arm, mounting angle or filter. */
typedef struct {
    auvid_real_t velocity[3], rate[3];
} uncertain_shift_t;

/* Write the change by input CURRENT_X + k. */
static void uncertain_shift(const auvid_sample_t *cell, auvid_real_t r[3][3], int k,
                            uncertain_shift_t *shift)
{
    auvid_real_t axis[3] = {AUVID_C(0.0), AUVID_C(0.0), AUVID_C(0.0)};
    const auvid_real_t *omega = cell->nu + AUVID_ROLL;
    int n = AUVID_UNCERTAIN_CURRENT_X + k;
    if (n <= (int)AUVID_UNCERTAIN_CURRENT_Y) {
        memcpy(shift->velocity, r[k], sizeof shift->velocity); /* the world's axis */
        uncertain_cross(r[k], omega, shift->rate);
        return;
    }
    if (n == (int)AUVID_UNCERTAIN_FILTER) {
        auvid_real_t turn[3];
        uncertain_cross(cell->nu, omega, shift->velocity);
        uncertain_cross(cell->nu_dot, omega, shift->rate);
        uncertain_cross(cell->nu, cell->nu_dot + AUVID_ROLL, turn);
        auvid_metric_add_scaled(shift->rate, AUVID_C(1.0), turn, 3);
        return;
    }
    bool arm = n <= (int)AUVID_UNCERTAIN_ARM_Z;
    const auvid_real_t *nu = arm ? omega : cell->nu;
    const auvid_real_t *nu_dot = arm ? cell->nu_dot + AUVID_ROLL : cell->nu_dot;
    axis[arm ? n - AUVID_UNCERTAIN_ARM_X : n - AUVID_UNCERTAIN_DVL_PITCH + 1] = AUVID_C(1.0);
    uncertain_cross(nu, axis, shift->velocity);
    uncertain_cross(nu_dot, axis, shift->rate);
}

/* Write the motion of a sample, less `step` of a current or lever arm. */
static void uncertain_move(auvid_sample_t *moved, const auvid_sample_t *sample,
                           const uncertain_shift_t *shift, auvid_real_t step)
{
    for (int i = 0; i < 3; ++i) {
        moved->nu[i] = sample->nu[i] - step * shift->velocity[i];
        moved->nu_dot[i] = sample->nu_dot[i] - step * shift->rate[i];
    }
}

/* The sum over the thrusters of d f / dt is part of the columns of the forces. */
static void uncertain_late_columns(const auvid_uncertain_t *u, const auvid_metric_t *m,
                                   const auvid_sample_t *water, const auvid_real_t *predicted,
                                   auvid_real_t sum[][SUMS])
{
    for (int first = AUVID_SURGE; first <= AUVID_ROLL; first += AUVID_ROLL) {
        auvid_real_t wrench[AUVID_DOF_COUNT];
        auvid_sample_t moved = *water;
        int other = AUVID_ROLL - first; /* moments, then forces */
        for (int i = first; i < first + 3; ++i) {
            moved.nu[i] += (first == AUVID_SURGE ? STEP : -STEP) * water->nu_dot[i];
        }
        uncertain_predict(u, m, &moved, OF_FORCES << other, wrench);
        for (int j = other; j < other + 3; ++j) {
            sum[j][AUVID_UNCERTAIN_DVL_LATE] =
                (other == AUVID_SURGE ? sum[j][SUM_DELAY] : AUVID_C(0.0)) +
                (wrench[j] - predicted[j]) / STEP;
        }
    }
}

/* Write the channels by which the columns of DoF j's parameters change; of fixed ones the thrust
 * does. */
static void uncertain_move_parameters(auvid_uncertain_t *u, const auvid_metric_t *m, int j,
                                      const auvid_regressor_t *measured,
                                      const auvid_regressor_t *water, auvid_real_t *thrust)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_row_parameters(m, j);
    const uint16_t *place = u->place + e->channel_at;
    for (int k = e->inputs + 1; k < e->channels; ++k, ++index) {
        u->recorded.channel[place[k]] = water->row[j][*index] - measured->row[j][*index];
    }
    if ((AUVID_UNCERTAIN_PLANAR >> j & 1u) != 0) {
        *thrust += uncertain_fixed(u, m, j, measured) - uncertain_fixed(u, m, j, water);
    }
}

/* The same of all DoF, and the wrench that the last estimate predicts in the water. A function of
 * its own: its regressors are not on the stack of the other predictions. */
static void uncertain_parameter_columns(auvid_uncertain_t *u, const auvid_metric_t *m,
                                        const auvid_sample_t *cell, const auvid_sample_t *water,
                                        auvid_real_t sum[][SUMS],
                                        auvid_real_t predicted[AUVID_DOF_COUNT])
{
    auvid_regressor_t y, y_water;
    uncertain_evaluate(m, cell, &y);
    uncertain_evaluate(m, water, &y_water);
    uncertain_multiply(u, m, &y_water, OF_FORCES | OF_FORCES << AUVID_ROLL, predicted);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        uncertain_move_parameters(u, m, j, &y, &y_water, &sum[j][SUM_THRUST]);
    }
}

static void uncertain_motion_columns(auvid_uncertain_t *u, const auvid_metric_t *m,
                                     const auvid_sample_t *cell, const auvid_sample_t *water,
                                     const uncertain_shift_t *shift, auvid_real_t sum[][SUMS])
{
    auvid_real_t predicted[AUVID_DOF_COUNT], after[AUVID_DOF_COUNT];
    auvid_sample_t moved = *water;
    uncertain_parameter_columns(u, m, cell, water, sum, predicted);
    if (u->cfg.dvl_late_s > AUVID_C(0.0)) {
        uncertain_late_columns(u, m, water, predicted, sum);
    }
    for (int k = 0; k < AUVID_UNCERTAIN_SHIFTS; ++k) {
        uint32_t dofs = u->moved[k];
        int n = AUVID_UNCERTAIN_CURRENT_X + k;
        if (dofs == 0) {
            continue;
        }
        uncertain_move(&moved, water, &shift[k], STEP);
        uncertain_predict(u, m, &moved, dofs, after);
        for (int j = 0; dofs >> j != 0; ++j) {
            if ((dofs >> j & 1u) != 0) {
                sum[j][n] = (after[j] - predicted[j]) / STEP;
            }
            if ((dofs & AUVID_UNCERTAIN_PLANAR) >> j & 1u) { /* about the last estimate */
                sum[j][SUM_THRUST] += sum[j][n] * u->shared[n];
            }
        }
    }
}

/* Returns DoF j's drag, relative to that at 1 m/s or rad/s. */
static auvid_real_t uncertain_relative_drag(const auvid_uncertain_t *u, const auvid_sample_t *cell,
                                            int j)
{
    auvid_real_t speed = auvid_abs(cell->nu[j]), linear = u->linear[j];
    return speed * (linear + (AUVID_C(1.0) - linear) * speed);
}

/* Returns DoF j's column of cross-flow drag; half_length_m: half of the length, 0: not known. */
static auvid_real_t uncertain_cross_flow(const auvid_real_t *nu, auvid_real_t half_length_m, int j)
{
    auvid_real_t square = AUVID_C(0.0), turn = AUVID_C(0.0);
    for (int i = AUVID_SURGE; i <= AUVID_HEAVE; ++i) {
        square += nu[i] * nu[i];
    }
    if (j < AUVID_HEAVE) {
        turn = STRIP * half_length_m * nu[AUVID_YAW];
    } else if (j >= AUVID_ROLL) {
        square =
            half_length_m > AUVID_C(0.0) ? square / (half_length_m * half_length_m) : AUVID_C(0.0);
        turn = nu[j];
    }
    return (auvid_sqrt(square + turn * turn) - auvid_abs(nu[j])) * nu[j];
}

/* Returns a column of DoF j that is formed from the motion. down: the vertical, in the body. */
static auvid_real_t uncertain_motion_column(const auvid_uncertain_t *u, const auvid_sample_t *cell,
                                            const auvid_real_t down[3], int code, int j)
{
    const auvid_real_t *nu = cell->nu;
    switch (code) {
    case INPUT_ASYMMETRY:
        return uncertain_relative_drag(u, cell, j);
    case INPUT_FORCE:
        return AUVID_C(1.0);
    case INPUT_CROSS:
        return j == AUVID_SWAY ? nu[AUVID_YAW] : nu[AUVID_SWAY];
    case INPUT_LIFT:
        return nu[AUVID_SURGE] * nu[j == AUVID_YAW ? AUVID_SWAY : AUVID_SURGE];
    case INPUT_CROSS_FLOW:
        return uncertain_cross_flow(nu, u->half_length_m, j);
    case INPUT_ASTERN:
        return j == AUVID_YAW ? down[1] : -down[2];
    default: /* INPUT_PORT */
        return j == AUVID_YAW ? -down[0] : down[2];
    }
}

/* Write the channels of DoF j's equation. */
static void uncertain_write_channels(auvid_uncertain_t *u, const auvid_sample_t *cell,
                                     const auvid_real_t down[3], const auvid_real_t *sum, int j)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint16_t *place = u->place + e->channel_at;
    const uint8_t *code = u->code + e->channel_at, *shared = code + e->own, *end = code + e->inputs;
    auvid_real_t *channel = u->recorded.channel;
    for (; code < shared; ++code) {
        channel[*place++] = *code == INPUT_DELAY ? sum[SUM_DELAY]
                                                 : uncertain_motion_column(u, cell, down, *code, j);
    }
    for (; code < end && *code < (int)AUVID_UNCERTAIN_GAIN; ++code) {
        channel[*place++] = sum[*code];
    }
    for (; code < end; ++code) {
        int i = *code - (int)AUVID_UNCERTAIN_GAIN;
        channel[*place++] = -u->allocation->cfg.thruster[i].wrench[j] * u->recorded.force[i];
    }
    channel[*place] = sum[SUM_THRUST];
}

void auvid_uncertain_channels(auvid_uncertain_t *u, const auvid_metric_t *m,
                              const auvid_sample_t *cell)
{
    auvid_real_t r[3][3], sum[AUVID_DOF_COUNT][SUMS];
    uncertain_shift_t shift[AUVID_UNCERTAIN_SHIFTS];
    auvid_sample_t water = *cell; /* the motion through the water, as last estimated */
    auvid_zero(sum, sizeof sum);
    auvid_rotation(cell->phi, cell->theta, cell->psi, r);
    for (int k = 0; k < AUVID_UNCERTAIN_SHIFTS; ++k) {
        if (u->moved[k] != 0) {
            uncertain_shift(cell, r, k, &shift[k]);
            uncertain_move(&water, &water, &shift[k], u->shared[AUVID_UNCERTAIN_CURRENT_X + k]);
        }
    }
    uncertain_thrust_columns(u, &water, sum);
    if (auvid_uncertain_moves(u) != 0 || u->cfg.dvl_late_s > AUVID_C(0.0)) {
        uncertain_motion_columns(u, m, cell, &water, shift, sum);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (u->equation[j].order > 0) {
            uncertain_write_channels(u, &water, r[2], sum[j], j);
        }
    }
}
