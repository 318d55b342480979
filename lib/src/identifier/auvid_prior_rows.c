/*
 * The prior as rows of the merged sets: parameters estimated before the first set was recorded.
 *
 * With s_j^2 the effective noise in DoF j's rows, the prior pi_i = p_i +- sigma_i is one more row
 * of its equation, s_j / sigma_i (pi_i - p_i) = 0. These rows increase what the rows of a DoF leave
 * unexplained by T. If the prior and the sets are of the same vehicle, T / s_j^2 is a chi-square
 * variable (Chow 1960; auvid_metric_change.c). It has as many degrees of freedom as there are prior
 * rows.
 */
#include "auvid_prior_rows_internal.h"

#include "../metric/auvid_metric_evaluator_internal.h"

/* The prior is discarded above this F. A wrong discard costs little: a cold start. */
#define PRIOR_LIMIT AUVID_C(6.0)

/* Residual path: additional weight of the prior in a search. What the model does not contain leaves
 * residuals that are alike in all sets, and so count as few independent ones. Chosen with the
 * mixtures of tests/vehicles/test_thrusters_field.c, seeds 1 to 30. The R factors do without it:
 * they are for the standard errors. */
#define STORED_WEIGHT AUVID_C(15.0)

/* Larger values are not accepted as parameters (detail/optimizer.h). */
#define LARGEST_VALUE AUVID_C(1e18)
/* Standard errors and variance inflations are below this and above its inverse. */
#define LARGEST_ERROR AUVID_C(2e30)

/* Does parameter i have a prior in DoF j's equation? */
static bool prior_is_in(const auvid_metric_t *m, const auvid_prior_t *prior, int j, int i)
{
    return (int)m->cfg.vehicle->parameter[i].dof == j && (prior->known >> i & 1u) != 0;
}

/* Rotate the prior of column k into DoF j's R factor. */
static void prior_add_row(auvid_metric_t *m, const auvid_prior_t *prior, int j, int k,
                          auvid_real_t noise)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
    auvid_equation_t e = auvid_metric_equation(m, j);
    int i = e.index[k];
    row[k] = noise / prior->sigma[i];
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        row[e.count + d] = row[k] * prior->pi[i];
    }
    if (auvid_all_within(row + k, (size_t)(e.order - k), METRIC_LARGEST_ENTRY) != AUVID_OK) {
        return; /* its squares would not be finite */
    }
    auvid_metric_add_row(m, j, k, row);
}

/* Rotate the priors of DoF j in. @return true if they agree with the sets */
static bool prior_apply(auvid_metric_t *m, const auvid_prior_t *prior, int j)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    auvid_real_t before = auvid_metric_unexplained(m, j);
    auvid_real_t square = prior->variance_inflation[j] * before / auvid_metric_merged_rows(m, j);
    auvid_real_t degrees = AUVID_C(0.0);
    for (int k = 0; k < e.count; ++k) {
        if (prior_is_in(m, prior, j, e.index[k])) {
            prior_add_row(m, prior, j, k, auvid_sqrt(square));
            degrees += AUVID_C(1.0);
        }
    }
    auvid_real_t more = auvid_metric_unexplained(m, j) - before;
    auvid_metric_solve_again(m, j, before);
    auvid_real_t weight = auvid_metric_stores_rows(m) ? STORED_WEIGHT : AUVID_C(1.0);
    return more <= PRIOR_LIMIT * weight * degrees * square;
}

static auvid_status_t prior_add_rows(auvid_metric_t *m, uint32_t *budget)
{
    auvid_prior_t *prior = m->prior_context;
    auvid_metric_cursor_t *at = auvid_metric_cursor(m);
    if (prior->known == 0) {
        return AUVID_OK;
    }
    for (; at->dof < AUVID_DOF_COUNT; ++at->dof) {
        int j = at->dof;
        bool biased = (m->cfg.closed_loop >> j & 1) != 0; /* then its rows contradict nothing */
        if (!auvid_metric_is_excited(m, j)) {
            continue;
        }
        uint8_t price = (uint8_t)(AUVID_METRIC_ROTATION * (auvid_metric_equation(m, j).count + 2));
        if (!auvid_metric_spend(at, budget, price)) {
            return AUVID_PENDING;
        }
        if (!prior_apply(m, prior, j) && !biased) {
            prior->known = 0;
            auvid_metric_restart_pass(m, PASS_LAST);
            return AUVID_EMPTY;
        }
    }
    return AUVID_OK;
}

static auvid_real_t prior_weight(const auvid_metric_t *m, int j, int i, auvid_real_t *mean)
{
    const auvid_prior_t *prior = m->prior_context;
    *mean = prior->pi[i];
    return prior_is_in(m, prior, j, i)
               ? auvid_sqrt(STORED_WEIGHT * prior->variance_inflation[j]) / prior->sigma[i]
               : AUVID_C(0.0);
}

static void prior_change_vehicle(auvid_metric_t *m)
{
    if (!auvid_metric_stores_rows(m)) { /* there it is a data sheet, of the thrusters */
        ((auvid_prior_t *)m->prior_context)->known = 0;
    }
}

const auvid_metric_prior_t auvid_prior_functions = {
    .add_rows = prior_add_rows, .weight = prior_weight, .change_vehicle = prior_change_vehicle};

static bool prior_is_valid_error(auvid_real_t x)
{
    return x > AUVID_C(1.0) / LARGEST_ERROR && x < LARGEST_ERROR;
}

auvid_status_t auvid_prior_check(const auvid_metric_t *metric, const auvid_prior_t *prior)
{
    if (!auvid_all_finite(prior->pi, AUVID_MAX_PARAMETERS) ||
        !auvid_all_finite(prior->sigma, AUVID_MAX_PARAMETERS) ||
        !auvid_all_finite(prior->variance_inflation, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int i = 0; i < metric->cfg.vehicle->parameters; ++i) {
        int j = (int)metric->cfg.vehicle->parameter[i].dof;
        if ((prior->known >> i & 1u) && !(prior_is_valid_error(prior->sigma[i]) &&
                                          prior_is_valid_error(prior->variance_inflation[j]))) {
            return AUVID_ERR_RANGE;
        }
    }
    bool good = (prior->known & ~auvid_metric_free_of(metric, UINT8_MAX)) == 0 &&
                auvid_all_within(prior->pi, AUVID_MAX_PARAMETERS, LARGEST_VALUE) == AUVID_OK;
    return good ? AUVID_OK : AUVID_ERR_RANGE;
}
