/*
 * Confidence: the note of each parameter, from its standard error.
 */
#include "auvid/detail/confidence.h"

#include <string.h>

#include "auvid_confidence_notes_internal.h"
#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_evaluator_internal.h"
#include "auvid_metric_feedback_internal.h"

/* Largest part of an equation's rms wrench that the impossible part of an estimate may explain. */
#define IMPOSSIBLE AUVID_C(0.1)
/* Largest rms variation of a constant wrench, relative to tau_max: rounding. */
#define ROUNDING AUVID_C(1e-4)

/* ---- bias of masses by the noise of the measured acceleration ---- */

/* Returns tap k of the filter from white velocity noise to the acceleration in a row. DVL samples
 * two cells variance are interpolated (0.5 1 0.5), rates come in every cell; the derivative is
 * (0.5 0 -0.5). */
static auvid_real_t confidence_noise_tap(const auvid_metric_t *m, int is_moment, int k)
{
    enum { LENGTH = 5 };
    static const auvid_real_t shape[2][LENGTH] = {
        {AUVID_C(0.25), AUVID_C(0.5), AUVID_C(0.0), AUVID_C(-0.5), AUVID_C(-0.25)},
        {AUVID_C(0.0), AUVID_C(0.5), AUVID_C(0.0), AUVID_C(-0.5), AUVID_C(0.0)}};
    auvid_real_t tap = AUVID_C(0.0);
    for (int i = 0; i < LENGTH; ++i) {
        bool inside = k - i >= 0 && k - i < m->layout.taps;
        tap += inside ? shape[is_moment][i] * m->layout.kernel[is_moment][k - i] : AUVID_C(0.0);
    }
    return tap;
}

/* Returns the correlation of this noise at the distance of the two rows of a band. */
static auvid_real_t confidence_noise_correlation(const auvid_metric_t *m, int j)
{
    int is_moment = j >= AUVID_ROLL, lag = m->cfg.lag[is_moment] * m->cfg.row_cells;
    auvid_real_t square = AUVID_C(0.0), product = AUVID_C(0.0);
    for (int k = 0; k < m->layout.taps + 4; ++k) {
        auvid_real_t tap = confidence_noise_tap(m, is_moment, k);
        square += tap * tap;
        product += tap * confidence_noise_tap(m, is_moment, k - lag);
    }
    return product / square;
}

void auvid_confidence_acceleration_row(const auvid_vehicle_t *vehicle, int j, auvid_regressor_t *y,
                                       auvid_real_t a[AUVID_MAX_PARAMETERS])
{
    auvid_sample_t sample;
    memset(&sample, 0, sizeof sample);
    memset(a, 0, AUVID_MAX_PARAMETERS * sizeof *a);
    for (int unit = 0; unit <= 1; ++unit) {
        memset(y, 0, sizeof *y);
        sample.nu_dot[j] = (auvid_real_t)unit;
        vehicle->regressor(vehicle->context, &sample, NULL, y);
        for (int i = 0; i < vehicle->parameters; ++i) {
            a[i] = y->row[j][i] - a[i];
        }
    }
}

void auvid_confidence_add_scores(auvid_confidence_job_t *c, int j)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    for (int i = 0; i < e.rows; ++i) {
        const auvid_real_t *r = auvid_equation_row(&e, i);
        for (int k = i; k < e.count; ++k) {
            int column = c->column_of[e.index[k]];
            if (column != NOWHERE) {
                c->influence.set[column] +=
                    auvid_metric_weight(c->metric, j) * r[k - i] * c->score[i];
            }
        }
    }
}

/* nu_j = high (low weight (1 + rho) / (1 - rho) + high weight): the high band is noise, and the low
 * band contains that noise times (1 + rho) / (1 - rho). */
void auvid_confidence_bias(auvid_confidence_job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    auvid_real_t a[AUVID_MAX_PARAMETERS], mass = AUVID_C(0.0);
    if (auvid_metric_stores_rows(m)) {
        return; /* the high band of other rows is not their noise */
    }
    auvid_confidence_acceleration_row(m->cfg.vehicle, j, &c->regressor, a);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        mass += a[i] * c->pi[i];
    }
    auvid_real_t rho = confidence_noise_correlation(m, j);
    auvid_real_t low = auvid_metric_band_weight(m, 0, j), high = auvid_metric_band_weight(m, 1, j);
    auvid_real_t noise = auvid_metric_band_squares(m, 1, j) *
                         (low * (AUVID_C(1.0) + rho) / (AUVID_C(1.0) - rho) + high);
    auvid_real_t scaled = auvid_metric_weight(m, j) * noise / mass;
    if (auvid_metric_is_coupled(m, j)) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        for (int k = 0; k < e.rows && auvid_is_finite(scaled); ++k) {
            c->score[k] = noise / mass * a[e.index[k]];
        }
        auvid_qr_solve_transposed(e.factor, e.order, e.rows, c->score);
        auvid_confidence_add_scores(c, j);
        memset(c->score, 0, sizeof c->score);
        return;
    }
    for (int k = 0; k < c->n && auvid_is_finite(scaled); ++k) {
        c->influence.set[k] += scaled * a[c->parameter_of[k]];
    }
}

/* ---- notes ---- */

/* Returns why nothing is known about DoF j: AUVID_NOTE_NOT_EXCITED in estimate.h. */
static uint8_t confidence_idle_reason(const auvid_metric_t *m, int j)
{
    auvid_real_t rounding = ROUNDING * m->cfg.tau_max[j];
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = auvid_metric_set(m, age);
        if (set->tau_m2[j] > rounding * rounding * (auvid_real_t)set->rows_of[j]) {
            return IDLE;
        }
    }
    return auvid_metric_stores_rows(m) ? UNACTUATED_ROWS : UNACTUATED;
}

void auvid_confidence_note_idle(auvid_confidence_job_t *c, int i)
{
    const auvid_metric_config_t *cfg = &c->metric->cfg;
    int j = (int)cfg->vehicle->parameter[i].dof;
    bool free = cfg->free == 0 || (cfg->free >> i & 1u) != 0;
    bool informative = auvid_metric_is_informative(c->metric, j);
    c->result.sigma[i] = AUVID_LARGEST;
    c->result.note[i] = !free         ? AUVID_NOTE_FIXED
                        : informative ? AUVID_NOTE_UNCERTAIN
                                      : AUVID_NOTE_NOT_EXCITED;
    if (c->result.note[i] == AUVID_NOTE_NOT_EXCITED) {
        c->result.partner[i] = confidence_idle_reason(c->metric, j);
    }
}

auvid_real_t auvid_confidence_column(const auvid_confidence_job_t *c, int j, int i)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    for (int k = 0; k < e.count; ++k) {
        if (e.index[k] == i) {
            return auvid_qr_column_norm(e.factor, e.order, k);
        }
    }
    return AUVID_C(0.0);
}

auvid_real_t auvid_confidence_allowed(const auvid_metric_config_t *cfg, int i, auvid_real_t value)
{
    const auvid_parameter_t *parameter = &cfg->vehicle->parameter[i];
    return parameter->kind == AUVID_PARAMETER_FORCE
               ? AUVID_CONFIDENCE_FORCE * cfg->tau_max[parameter->dof]
               : AUVID_CONFIDENCE_IDENTIFIABLE * auvid_abs(value);
}

/* Returns the smallest value of parameter i whose force is AUVID_CONFIDENCE_SMALL of the rms
 * wrench, over the informative equations. */
static auvid_real_t confidence_small_value(const auvid_confidence_job_t *c, int i)
{
    auvid_real_t smallest = AUVID_LARGEST;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t column = auvid_metric_is_informative(c->metric, j)
                                  ? auvid_confidence_column(c, j, i)
                                  : AUVID_C(0.0);
        if (column > AUVID_C(0.0)) {
            auvid_real_t rows, force = auvid_metric_force_squares(c->metric, j, &rows);
            auvid_real_t value =
                AUVID_CONFIDENCE_SMALL * auvid_sqrt(force / rows * c->spread.rows[j]) / column;
            smallest = value < smallest ? value : smallest;
        }
    }
    return smallest < AUVID_LARGEST ? smallest : AUVID_C(0.0);
}

/* Returns how far parameter i is beyond the possible range; 0: it is within. */
static auvid_real_t confidence_impossible_part(const auvid_confidence_job_t *c, int i)
{
    auvid_real_t value = c->pi[i], beyond = AUVID_C(0.0);
    switch (c->metric->cfg.vehicle->parameter[i].kind) {
    case AUVID_PARAMETER_MASS:
        beyond = c->dry_mass_kg - value;
        break;
    case AUVID_PARAMETER_INERTIA:
        beyond = -value;
        break;
    case AUVID_PARAMETER_LINEAR_DRAG:
    case AUVID_PARAMETER_QUADRATIC_DRAG:
        beyond = value;
        break;
    case AUVID_PARAMETER_FORCE:
    case AUVID_PARAMETER_OTHER:
    case AUVID_PARAMETER_UNSCALED:
    default:
        break;
    }
    return auvid_max(beyond, AUVID_C(0.0));
}

/* Returns the norm of DoF j's wrench at its delay, less what known parameters explain. */
static auvid_real_t confidence_wrench_norm(const auvid_confidence_job_t *c, int j)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    auvid_real_t square = auvid_metric_unexplained(c->metric, j);
    if (auvid_metric_is_coupled(c->metric, j)) {
        return auvid_sqrt(auvid_metric_force_squares(c->metric, j, &square));
    }
    for (int k = 0; k < e.count; ++k) {
        square += e.z[k] * e.z[k];
    }
    return auvid_sqrt(square);
}

bool auvid_confidence_is_known(const auvid_confidence_t *c, int p)
{
    return c->note[p] == AUVID_NOTE_NONE || c->note[p] == AUVID_NOTE_UNCHECKED ||
           c->note[p] == AUVID_NOTE_IMPLAUSIBLE || c->note[p] == AUVID_NOTE_THRUST_SCALE ||
           c->note[p] == AUVID_NOTE_INPUTS;
}

/* These parameters, a bit each, are not identifiable, because of an impossible one. */
static void confidence_blame(auvid_confidence_job_t *c, uint32_t parameters, uint8_t culprit)
{
    c->result.identifiable &= ~parameters;
    for (int k = 0; k < c->n; ++k) {
        int p = c->parameter_of[k];
        if ((parameters >> p & 1u) != 0) {
            c->result.note[p] = AUVID_NOTE_DISCREDITED;
            c->result.partner[p] = culprit;
            c->result.bound[p] = c->pi[culprit];
        }
    }
}

/* If an estimate of DoF j's equation is impossible, none of it is identifiable. */
static void confidence_discredit_equation(auvid_confidence_job_t *c, int j)
{
    auvid_confidence_t *to = &c->result;
    auvid_real_t max_force = IMPOSSIBLE * confidence_wrench_norm(c, j), worst = AUVID_C(0.0);
    uint32_t beyond = 0, known = 0;
    uint8_t culprit = NOWHERE;
    for (int k = 0; k < c->n; ++k) {
        int p = c->parameter_of[k];
        if ((int)c->metric->cfg.vehicle->parameter[p].dof != j) {
            continue;
        }
        auvid_real_t part = confidence_impossible_part(c, p);
        auvid_real_t force =
            part > AUVID_C(0.0) ? part * auvid_confidence_column(c, j, p) : AUVID_C(0.0);
        bool sure = part > AUVID_HALF_WIDTH * to->sigma[p];
        uint32_t bit = UINT32_C(1) << (p & 31);
        to->implausible |= sure ? bit : 0u;
        known |= auvid_confidence_is_known(to, p) ? bit : 0u;
        if (sure || force > max_force) {
            beyond |= bit;
            culprit = force > worst ? (uint8_t)p : culprit;
            worst = auvid_max(worst, force);
        }
    }
    if (culprit != NOWHERE && known != 0) {
        to->implausible |= beyond;
        confidence_blame(c, known, culprit);
    }
}

/* If two masses are impossible, nothing is identifiable: thrust or velocity in a wrong unit makes
 * every number wrong. */
static void confidence_discredit_all(auvid_confidence_job_t *c)
{
    uint32_t moved = 0;
    uint8_t culprit = NOWHERE;
    int masses = 0;
    for (int k = 0; k < c->n; ++k) {
        int p = c->parameter_of[k];
        bool sure = c->metric->cfg.vehicle->parameter[p].kind == AUVID_PARAMETER_MASS &&
                    (c->result.implausible >> p & 1u) != 0;
        moved |= c->result.note[p] != AUVID_NOTE_NOT_EXCITED ? UINT32_C(1) << (p & 31) : 0u;
        culprit = sure && masses == 0 ? (uint8_t)p : culprit;
        masses += sure;
    }
    if (masses > 1) {
        confidence_blame(c, moved, culprit);
    }
}

void auvid_confidence_discredit(auvid_confidence_job_t *c, uint32_t dofs)
{
    for (int j = 0; dofs >> j != 0; ++j) {
        if ((dofs >> j & 1u) != 0) {
            confidence_discredit_equation(c, j);
        }
    }
    confidence_discredit_all(c);
}

/* Returns the note if a bound, or a search that has not converged, determines the parameter; else
 * AUVID_NOTE_NONE. */
static auvid_note_t confidence_limiting_note(const auvid_confidence_job_t *c, int p,
                                             auvid_real_t half, const auvid_finding_t *found)
{
    auvid_real_t distance = auvid_abs(c->pi[p] - c->result.bound[p]);
    if (c->not_converged) {
        return AUVID_NOTE_NOT_CONVERGED;
    }
    if ((c->at_bound >> p & 1u) && !(distance > half)) {
        return AUVID_NOTE_AT_BOUND;
    }
    return found->bound_partner != NOWHERE && !(auvid_abs(found->bound_shift) <= half)
               ? AUVID_NOTE_BESIDE_BOUND
               : AUVID_NOTE_NONE;
}

void auvid_confidence_conclude(auvid_confidence_job_t *c, int i, const auvid_finding_t *found)
{
    int p = c->parameter_of[i];
    auvid_confidence_t *to = &c->result;
    if (to->note[p] == AUVID_NOTE_NOT_EXCITED) {
        return; /* its value is a by-product */
    }
    const auvid_metric_config_t *cfg = &c->metric->cfg;
    int j = (int)cfg->vehicle->parameter[p].dof;
    auvid_real_t sigma = found->sigma, bias = found->bias;
    auvid_real_t thrust = to->thrust_error[p], dvl = to->dvl_error[p];
    auvid_real_t relative = auvid_sqrt(sigma * sigma + dvl * dvl);
    auvid_real_t all = auvid_sqrt(relative * relative + thrust * thrust);
    auvid_real_t total = auvid_sqrt(all * all + bias * bias);
    auvid_real_t half = AUVID_HALF_WIDTH * all + bias;
    auvid_real_t allowed = auvid_confidence_allowed(cfg, p, c->pi[p]);
    auvid_real_t rows, force = auvid_metric_force_squares(c->metric, j, &rows);
    auvid_real_t unexplained = c->metric->result.sse[j];
    /* without the step of the delays, which would lead an estimate at a bound away from it */
    auvid_real_t variance =
        auvid_max(sigma * sigma - c->delay_step[i] * c->delay_step[i], AUVID_C(0.0));
    auvid_note_t limit =
        confidence_limiting_note(c, p, AUVID_HALF_WIDTH * auvid_sqrt(variance) + bias, found);
    bool known = total <= AUVID_LARGEST_SIGMA && limit == AUVID_NOTE_NONE;
    to->sigma[p] = known ? total : AUVID_LARGEST;
    to->note[p] = AUVID_NOTE_UNCERTAIN;
    if (limit != AUVID_NOTE_NONE) {
        to->note[p] = (uint8_t)limit;
        to->partner[p] = limit == AUVID_NOTE_BESIDE_BOUND ? found->bound_partner : to->partner[p];
    } else if (known && half <= allowed) {
        /* an optimum explains more than the mean of the wrench does, unless bounds or model errors
         * keep the search away from it */
        bool plausible = unexplained <= force;
        to->identifiable |= (uint32_t)!to->unchecked << p;
        to->implausible |= (uint32_t)!plausible << p;
        to->note[p] = !plausible      ? AUVID_NOTE_IMPLAUSIBLE
                      : to->unchecked ? AUVID_NOTE_UNCHECKED
                                      : AUVID_NOTE_NONE;
    } else if (auvid_abs(c->pi[p]) + half <= confidence_small_value(c, p)) {
        to->note[p] = AUVID_NOTE_SMALL;
    } else if (known && AUVID_HALF_WIDTH * relative + bias <= allowed) {
        auvid_real_t max_sigma = (allowed - bias) / AUVID_HALF_WIDTH;
        to->note[p] = AUVID_NOTE_THRUST_SCALE;
        to->bound[p] =
            to->uncertainty.thrust_scale *
            (auvid_sqrt(max_sigma * max_sigma - relative * relative) / auvid_abs(thrust));
    } else if (known && found->exact) {
        to->note[p] = AUVID_NOTE_INPUTS;
    } else if (!(unexplained <= (AUVID_C(1.0) - AUVID_CONFIDENCE_EXPLAINED) * force)) {
        to->partner[p] = UNEXPLAINED;
        to->bound[p] = auvid_r2(unexplained, force);
    } else if (found->partner != NOWHERE) {
        to->note[p] = AUVID_NOTE_COMBINATION;
        to->partner[p] = found->partner;
    } else if (AUVID_HALF_WIDTH * all <= allowed) {
        to->note[p] = AUVID_NOTE_NOISE;
    } else {
        to->partner[p] = FEW_DATA;
    }
}

void auvid_confidence_close_loop(auvid_confidence_job_t *c, const auvid_metric_t *m,
                                 uint32_t feedback, uint32_t strong)
{
    static const uint32_t kept = 1u << AUVID_NOTE_FIXED | 1u << AUVID_NOTE_NOT_EXCITED |
                                 1u << AUVID_NOTE_AT_BOUND | 1u << AUVID_NOTE_BESIDE_BOUND |
                                 1u << AUVID_NOTE_NOT_CONVERGED;
    uint32_t found = feedback & ~(m->cfg.closed_loop | AUVID_FEEDBACK_TILT);
    for (int k = 0; k < c->n; ++k) {
        int p = c->parameter_of[k];
        if ((feedback >> m->cfg.vehicle->parameter[p].dof & 1u) == 0 || (strong >> p & 1u) != 0) {
            continue;
        }
        if (!(kept >> c->result.note[p] & 1u)) {
            c->result.note[p] = AUVID_NOTE_FEEDBACK;
            c->result.partner[p] = found != 0 ? OF_ALL : OF_SOME;
        }
        c->result.identifiable &= ~(UINT32_C(1) << (p & 31));
    }
}
