/*
 * Confidence: covariance, standard errors, and considered parameters.
 *
 * The supplied thrust and the DVL's velocity may each be wrong by a common scale, which no motion
 * shows. It is never estimated: a column proportional to the wrench would explain everything with
 * pi = 0. One standard deviation e of a scale changes the parameters by e s, s = d pi / d scale:
 *
 *     thrust:  s_i = pi_i + h_i             the wrench is larger, and so is all that explains it
 *     DVL:     s_i = -(degree_i pi_i + h_i) degree 1 in the velocity: masses and linear drag; 2:
 *                                           quadratic drag; 0: what acts on rotation, W-B
 *
 * A known parameter does not change, so the others take over its share of the change, h_i. Its
 * column is not stored. The column of a known drag is nearly proportional to that of the other drag
 * of the same DoF, which takes its part: h_i = c (degree) pi_known, c from the rms of column i. A
 * known mass or constant force has a column nearly orthogonal to the others: h = 0. (A known m_u is
 * also in sway, as m_u u r: in coupled motion sway's s were 12 % too small to 50 % too large.) The
 * yaw equation's (m_u - m_v) u v is of degree 2. The terms of the forces are of degree 1. The
 * masses are treated as the forces determine them, because most of the information is there (in
 * coupled motion 15 % off).
 */
#include "auvid/detail/confidence.h"

#include <string.h>

#include "auvid_confidence_notes_internal.h"
#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_evaluator_internal.h"

#define POOLED AUVID_C(10.0) /* nu, see auvid_confidence.c */
#define WIDENED AUVID_C(1.3) /* m */

typedef auvid_confidence_job_t job_t;

/* y = Q x, Q = sum_j w_j^2 s_j^2 R_j'R_j. @return x'Q x */
static auvid_real_t confidence_pooled_product(const job_t *c, const auvid_real_t *x,
                                              auvid_real_t *y)
{
    const auvid_metric_t *m = c->metric;
    auvid_real_t sum = AUVID_C(0.0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t equation = auvid_metric_equation(m, j);
        const uint8_t *index = equation.index;
        int count = equation.count, rows = auvid_metric_is_informative(m, j) ? equation.rows : 0;
        auvid_real_t scale = auvid_metric_weight(m, j) * c->result.effective_noise[j];
        for (int i = 0; i < rows; ++i) {
            const auvid_real_t *r = auvid_equation_row(&equation, i);
            auvid_real_t e = AUVID_C(0.0);
            for (int k = i; k < count; ++k) {
                int column = c->column_of[index[k]];
                e += column == NOWHERE ? AUVID_C(0.0) : r[k - i] * x[column];
            }
            sum += scale * scale * e * e;
            for (int k = i; k < count; ++k) {
                int column = c->column_of[index[k]];
                if (column != NOWHERE) {
                    y[column] += scale * scale * e * r[k - i];
                }
            }
        }
    }
    return sum;
}

/* x = P x */
static void confidence_invert(const job_t *c, auvid_real_t *x)
{
    auvid_qr_solve_transposed(c->joint_factor, c->n, c->n, x);
    (void)auvid_qr_solve(c->joint_factor, c->n, c->n, AUVID_C(0.0), x);
}

/* ---- considered parameters ---- */

auvid_real_t auvid_confidence_thrust_degree(const auvid_vehicle_t *vehicle, int i)
{
    bool linear = !auvid_path_stores_rows(vehicle->path);
    bool scales =
        linear || (!vehicle->own_thrust && vehicle->parameter[i].kind != AUVID_PARAMETER_UNSCALED);
    return scales ? AUVID_C(1.0) : AUVID_C(0.0);
}

auvid_real_t auvid_confidence_dvl_degree(const auvid_vehicle_t *vehicle, int i)
{
    if (vehicle->parameter[i].dof >= AUVID_ROLL) {
        return AUVID_C(0.0);
    }
    switch (vehicle->parameter[i].kind) {
    case AUVID_PARAMETER_MASS:
    case AUVID_PARAMETER_INERTIA:
    case AUVID_PARAMETER_LINEAR_DRAG:
        return AUVID_C(-1.0);
    case AUVID_PARAMETER_QUADRATIC_DRAG:
        return AUVID_C(-2.0);
    case AUVID_PARAMETER_FORCE:
    case AUVID_PARAMETER_OTHER:
    case AUVID_PARAMETER_UNSCALED:
    default:
        return AUVID_C(0.0);
    }
}

/* Returns the rms of the column of parameter p in DoF j's equation; most of the motion is in the
 * low band. */
static auvid_real_t confidence_column_rms(const job_t *c, int j, int p)
{
    auvid_real_t rows = c->spread.rows[j] * auvid_metric_band_weight(c->metric, 0, j);
    auvid_real_t norm = auvid_confidence_column(c, j, p);
    return rows > AUVID_C(0.0) ? norm / auvid_sqrt(rows) : AUVID_C(0.0);
}

/* Returns the coefficient of the regression of the known drag f's column on that of drag p, of the
 * same DoF. The mean of u^2 is at most the root of that of u^4. For Gaussian u,
 * E|u|^3 / E u^2 = 1.6 sigma. */
static auvid_real_t confidence_drag_regression(const job_t *c, int p, int f)
{
    const auvid_parameter_t *of = c->metric->cfg.vehicle->parameter;
    if (of[p].dof != of[f].dof) {
        return AUVID_C(0.0);
    }
    auvid_real_t rms = confidence_column_rms(c, (int)of[p].dof, p);
    if (of[p].kind == AUVID_PARAMETER_LINEAR_DRAG && of[f].kind == AUVID_PARAMETER_QUADRATIC_DRAG) {
        return AUVID_C(1.6) * rms;
    }
    bool quadratic =
        of[p].kind == AUVID_PARAMETER_QUADRATIC_DRAG && of[f].kind == AUVID_PARAMETER_LINEAR_DRAG;
    return quadratic && rms > AUVID_C(0.0) ? AUVID_C(1.0) / auvid_sqrt(rms) : AUVID_C(0.0);
}

static void confidence_consider(job_t *c, int p)
{
    const auvid_vehicle_t *vehicle = c->metric->cfg.vehicle;
    auvid_confidence_t *to = &c->result;
    auvid_real_t thrust = auvid_confidence_thrust_degree(vehicle, p) * c->pi[p];
    auvid_real_t dvl = auvid_confidence_dvl_degree(vehicle, p) * c->pi[p];
    for (int f = 0; f < vehicle->parameters; ++f) {
        if (c->column_of[f] == NOWHERE && auvid_abs(c->pi[f]) > AUVID_C(0.0)) {
            auvid_real_t part = confidence_drag_regression(c, p, f) * c->pi[f];
            thrust += auvid_confidence_thrust_degree(vehicle, f) * part;
            dvl += auvid_confidence_dvl_degree(vehicle, f) * part;
        }
    }
    to->thrust_error[p] = auvid_clamp(to->uncertainty.thrust_scale * thrust, -AUVID_LARGEST_SIGMA,
                                      AUVID_LARGEST_SIGMA);
    to->dvl_error[p] =
        auvid_clamp(to->uncertainty.dvl_scale * dvl, -AUVID_LARGEST_SIGMA, AUVID_LARGEST_SIGMA);
}

/* ---- covariance ---- */

/* Returns the diagonal entry of row p of the covariance. */
static auvid_real_t *confidence_diagonal(job_t *c, int p)
{
    return c->covariance + auvid_qr_row(c->metric->cfg.vehicle->parameters, p);
}

/* Write row i, not scaled, from its diagonal and y = Q P e_i, which is overwritten. */
static void confidence_write_row(job_t *c, int i, auvid_real_t variance, auvid_real_t *y)
{
    int p = c->parameter_of[i];
    confidence_invert(c, y);
    y[i] = variance;
    for (int k = i; k < c->n; ++k) {
        confidence_diagonal(c, p)[c->parameter_of[k] - p] =
            auvid_is_finite(y[k]) ? y[k] : AUVID_C(0.0);
    }
}

void auvid_confidence_scale(job_t *c, int i)
{
    int p = c->parameter_of[i];
    auvid_real_t *row = confidence_diagonal(c, p);
    for (int k = c->n - 1; k >= i; --k) { /* auvid_confidence_judge left the scales in widening */
        auvid_real_t *entry = row + (c->parameter_of[k] - p);
        auvid_real_t max =
            auvid_sqrt(*row) * auvid_sqrt(*confidence_diagonal(c, c->parameter_of[k]));
        *entry = c->widening[i] * c->widening[k] * auvid_clamp(*entry, -max, max);
    }
}

void auvid_confidence_revise(job_t *job, const auvid_real_t *pi)
{
    memcpy(job->pi, pi, sizeof job->pi);
    job->at_bound = 0;
    job->result.identifiable = job->result.implausible = 0;
}

void auvid_confidence_revise_parameter(job_t *job, const auvid_metric_t *metric, int i,
                                       const auvid_finding_t *found)
{
    job->metric = metric;
    job->delay_step[i] = AUVID_C(0.0);
    if (found->sigma > AUVID_C(0.0)) {
        confidence_consider(job, job->parameter_of[i]);
        auvid_confidence_conclude(job, i, found);
    } else {
        auvid_confidence_note_idle(job, job->parameter_of[i]);
    }
    if (i == job->n - 1) {
        uint32_t dofs = 0;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool some = auvid_metric_equation(metric, j).count > 0;
            dofs |= (uint32_t)(auvid_metric_is_informative(metric, j) && some) << j;
        }
        auvid_confidence_discredit(job, dofs);
    }
    job->metric = NULL;
}

void auvid_confidence_judge(job_t *c, int i)
{
    auvid_real_t x[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, y[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)};
    auvid_real_t delta = AUVID_C(0.0), largest = AUVID_C(0.0), nearest = AUVID_C(0.0);
    auvid_real_t sets = (auvid_real_t)c->result.sets, widening = c->widening[i];
    auvid_finding_t found = {.bound_shift = c->influence.sum[i], .bound_partner = NOWHERE};
    int partner = i, p = c->parameter_of[i];
    c->widening[i] = AUVID_C(0.0);          /* no covariance unless its error is known */
    if (!(c->variance[i] > AUVID_C(0.0))) { /* zero column: a constant sensor */
        auvid_confidence_note_idle(c, p);
        return;
    }
    x[i] = AUVID_C(1.0);
    confidence_invert(c, x);
    for (int k = 0; k < c->n; ++k) {
        auvid_real_t correlation =
            k == i ? AUVID_C(0.0) : auvid_abs(x[k]) / auvid_sqrt(c->variance[i] * c->variance[k]);
        if ((c->at_bound >> c->parameter_of[k] & 1u) && correlation > nearest) {
            found.bound_partner = c->parameter_of[k];
            nearest = correlation;
        }
        delta -= x[k] * c->influence.set[k];
        partner = correlation > largest ? k : partner;
        largest = auvid_max(largest, correlation);
    }
    auvid_real_t plain = confidence_pooled_product(c, x, y), variance = plain;
    if (c->result.sets > 1) {
        auvid_real_t scatter =
            sets * c->influence.squares[i] - c->influence.sum[i] * c->influence.sum[i];
        /* include the sets that left the ring */
        scatter *= (auvid_real_t)auvid_metric_sets_merged(c->metric) / sets;
        variance =
            (POOLED * variance + auvid_max(scatter, AUVID_C(0.0))) / (POOLED + sets - AUVID_C(1.0));
    }
    int j = (int)c->metric->cfg.vehicle->parameter[p].dof;
    auvid_real_t disagreement = auvid_metric_disagreement(c->metric, j, p) * c->pi[p];
    found.sigma = auvid_sqrt(WIDENED * variance * widening + c->delay_step[i] * c->delay_step[i] +
                             disagreement * disagreement);
    found.bias = auvid_abs(delta);
    found.partner = largest > AUVID_CORRELATED ? c->parameter_of[partner] : NOWHERE;
    confidence_consider(c, p);
    auvid_confidence_conclude(c, i, &found);
    confidence_write_row(c, i, plain, y);
    if (c->result.sigma[p] < AUVID_LARGEST && plain > AUVID_C(0.0)) {
        c->widening[i] = auvid_sqrt((found.sigma * found.sigma + found.bias * found.bias) / plain);
    }
}
