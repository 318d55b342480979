/*
 * The identifier: the start of a search on the residual path. The linearised sets give Gauss-Newton
 * steps, which end near a minimum of the cost. The search confirms it (auvid_optimizer_certify). If
 * its poll finds a better point, the steps continue there, at most WORK_CONTINUATIONS times; then
 * the search goes on as without them.
 *
 * The steps begin at the better point, at the last estimate or, in a cold start, at the prior, the
 * good point or the middle of the bounds. There the first step finds the parameters in which the
 * model is affine, given the others.
 *
 * A prior, of weight w about the mean p, adds P = sum (w (pi_i - p))^2 mean squares of a DoF's
 * residual to the cost: S + P S / N, with S the sum of squares of its N rows. So it is the rows
 * sqrt(S / N) w (pi_i - p) = 0, S at the point of the linear model.
 */
#include <string.h>

#include "../search/auvid_gauss_newton_internal.h"
#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

#if AUVID_MAX_COMMANDS > 0

/* Rows of a prior come after those of a DoF: row PRIOR_ROWS + i is that of the i-th parameter. */
enum { PRIOR_ROWS = 64 };
_Static_assert(AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS <= PRIOR_ROWS, "rows of a DoF");

/* Number of parameters without the delay. */
static int identifier_newton_parameters(const auvid_identifier_t *id)
{
    return id->linear.newton.ls.n - identifier_searches_delay(id);
}

/* Begin to evaluate the trial. */
static void identifier_try_newton(auvid_identifier_t *id)
{
    auvid_identifier_expand(id, id->linear.newton.ls.x, id->linear.newton.ls.n);
    auvid_metric_cost_begin(&id->metric, id->work.candidate, id->work.delay_s);
}

/* Weight and mean of parameter p's prior in DoF j's equation; both 0: it has none. */
static auvid_real_t identifier_newton_prior(const auvid_identifier_t *id, int j, int p,
                                            auvid_real_t *mean)
{
    const auvid_metric_t *m = &id->metric;
    if (m->prior == NULL) {
        *mean = AUVID_C(0.0);
        return AUVID_C(0.0);
    }
    return m->prior->weight(m, j, p, mean);
}

static void identifier_begin_newton(auvid_identifier_t *id)
{
    const auvid_search_config_t *search = &id->search;
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    auvid_gauss_newton_t *gn = &id->linear.newton;
    auvid_real_t x[AUVID_MAX_PARAMETERS], lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];
    auvid_real_t delay_s = id->metric.cfg.delay_s[0];
    const auvid_real_t *known = auvid_identifier_known_point(id, &delay_s);
    uint32_t affine = 0;
    int n = 0;
    for (int p = 0; p < vehicle->parameters; ++p) {
        if ((id->work.active >> p & 1u) != 0) {
            auvid_real_t middle = AUVID_C(0.5) * (search->lower[p] + search->upper[p]), mean;
            middle = search->has_good ? search->good[p] : middle;
            if (identifier_newton_prior(id, (int)vehicle->parameter[p].dof, p, &mean) >
                AUVID_C(0.0)) {
                middle = mean;
            }
            lower[n] = search->lower[p];
            upper[n] = search->upper[p];
            x[n] = auvid_clamp(known != NULL ? known[p] : middle, lower[n], upper[n]);
            affine |= (uint32_t)(known == NULL && (vehicle->affine >> p & 1u) != 0) << n;
            id->work.parameter_of[n++] = (uint8_t)p;
        }
    }
    if (identifier_searches_delay(id)) {
        lower[n] = AUVID_C(0.0);
        upper[n] = auvid_metric_longest_delay(&id->metric);
        x[n] = auvid_clamp(delay_s, lower[n], upper[n]);
        ++n;
    }
    auvid_gauss_newton_begin(gn, n, x, affine);
    memcpy(gn->lower, lower, (size_t)n * sizeof *lower);
    memcpy(gn->upper, upper, (size_t)n * sizeof *upper);
    if (search->paper) {
        gn->state = NEWTON_DONE;
    }
    identifier_try_newton(id);
}

/* After the rows of a DoF: add the next row of its prior, or go to the next DoF. */
static void identifier_add_newton_prior(auvid_identifier_t *id)
{
    auvid_gauss_newton_t *gn = &id->linear.newton;
    const auvid_metric_t *m = &id->metric;
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1] = {AUVID_C(0.0)}, mean;
    int i = gn->ls.row > PRIOR_ROWS ? gn->ls.row - PRIOR_ROWS : 0, j = gn->ls.dof;
    auvid_real_t noise = auvid_metric_is_excited(m, j)
                             ? auvid_sqrt(gn->squares / auvid_metric_merged_rows(m, j))
                             : AUVID_C(0.0);
    for (; i < identifier_newton_parameters(id); ++i) {
        auvid_real_t weight = identifier_newton_prior(id, j, id->work.parameter_of[i], &mean);
        row[i] = noise * weight;
        row[gn->ls.n] = row[i] * mean;
        if (row[i] > AUVID_C(0.0) && row[i] < METRIC_LARGEST_ENTRY) {
            auvid_real_t squares = gn->squares;
            auvid_gauss_newton_add(gn, row);
            gn->squares = squares;
            gn->ls.row = (uint8_t)(PRIOR_ROWS + i + 1);
            return;
        }
        row[i] = AUVID_C(0.0);
    }
    gn->squares = AUVID_C(0.0);
    gn->ls.row = 0;
    ++gn->ls.dof;
}

/* Add the next row of the linear model, by the search's parameters. @return false if there is none
 * left */
static bool identifier_add_newton_row(auvid_identifier_t *id)
{
    auvid_gauss_newton_t *gn = &id->linear.newton;
    const auvid_metric_t *m = &id->metric;
    auvid_real_t by_parameter[AUVID_MAX_PARAMETERS + 1], row[AUVID_MAX_PARAMETERS + 1], slope;
    int n = identifier_newton_parameters(id), of = identifier_vehicle(id)->parameters;
    auvid_real_t delay_s = gn->ls.n > n ? gn->x[n] : m->cfg.delay_s[0];
    if (gn->ls.dof == AUVID_DOF_COUNT) {
        return false;
    }
    if (!auvid_metric_newton_row(m, gn->ls.dof, gn->ls.row, delay_s, by_parameter, &slope)) {
        identifier_add_newton_prior(id);
        return true;
    }
    ++gn->ls.row;
    auvid_real_t z = by_parameter[of];
    for (int p = 0; p < of; ++p) {
        z -= (id->work.active >> p & 1u) != 0 ? AUVID_C(0.0) : by_parameter[p] * m->cfg.fixed[p];
    }
    for (int i = 0; i < n; ++i) {
        row[i] = by_parameter[id->work.parameter_of[i]];
    }
    if (gn->ls.n > n) {
        row[n] = slope;
        z += slope * delay_s;
    }
    row[gn->ls.n] = z;
    auvid_gauss_newton_add(gn, row);
    return true;
}

static void identifier_step_newton(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_gauss_newton_t *gn = &id->linear.newton;
    while (gn->state == NEWTON_STEP && *budget > 0) {
        --*budget;
        if (!auvid_identifier_pays(&gn->ls)) {
            continue;
        }
        if (!identifier_add_newton_row(id)) {
            auvid_gauss_newton_step(gn);
        }
    }
    if (gn->state == NEWTON_COST) {
        identifier_try_newton(id);
    }
}

/* What the search has to confirm. */
static void identifier_end_newton(auvid_identifier_t *id)
{
    const auvid_gauss_newton_t *gn = &id->linear.newton;
    auvid_identifier_expand(id, gn->x, gn->ls.n);
    id->work.minimum = auvid_identifier_minimum(gn->cost, AUVID_C(0.0), gn->ls.zero);
}

static auvid_status_t identifier_newton(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_gauss_newton_t *gn = &id->linear.newton;
    auvid_metric_t *m = &id->metric;
    while (gn->state != NEWTON_DONE) {
        if (*budget == 0) {
            return AUVID_PENDING;
        }
        if (gn->state == NEWTON_STEP) {
            identifier_step_newton(id, budget);
        } else if (gn->state == NEWTON_ROWS) {
            if (auvid_metric_linearise(m, &id->linear.windows, budget) != AUVID_OK) {
                return AUVID_PENDING;
            }
            auvid_gauss_newton_begin_step(gn);
        } else {
            if (auvid_metric_cost(m, budget) != AUVID_OK) {
                return AUVID_PENDING;
            }
            auvid_gauss_newton_tell(gn, m->result.cost);
            if (gn->state == NEWTON_ROWS) { /* at the candidate, which is the best point now */
                auvid_metric_linearise_begin(m, id->work.candidate, id->work.delay_s, m->cfg.sets);
                auvid_metric_linearise_plain(m);
            }
        }
    }
    identifier_end_newton(id);
    return AUVID_OK;
}

static void identifier_scale_of_newton(const auvid_identifier_t *id, auvid_real_t *scale)
{
    const auvid_gauss_newton_t *gn = &id->linear.newton;
    int n = identifier_newton_parameters(id);
    for (int i = 0; i < gn->ls.n && gn->cost < AUVID_COST_FAILED; ++i) {
        int p = i < n ? id->work.parameter_of[i] : identifier_vehicle(id)->parameters;
        scale[p] = auvid_gauss_newton_scale(gn, i);
    }
}

const auvid_path_start_t auvid_start_newton = {.begin = identifier_begin_newton,
                                               .run = identifier_newton,
                                               .scale = identifier_scale_of_newton,
                                               .next_neighbour = auvid_identifier_next_neighbour,
                                               .begin_neighbour = auvid_identifier_begin_neighbour};

#endif
