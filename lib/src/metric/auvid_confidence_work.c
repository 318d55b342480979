/*
 * Confidence: the steps of an assessment in their order, a few units at a time. What is computed in
 * them is in auvid_confidence.c, _judge.c and _notes.c.
 */
#include "auvid/confidence.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_confidence_internal.h"
#include "auvid_metric_internal.h"

#define NEAR AUVID_C(1e-3) /* a bound, in distances of the two */

typedef auvid_confidence_job_t job_t;

/* All sets are through: s_j^2, and DoF j's part of the bias' right-hand side into influence. */
static void find_bias(job_t *c, int j)
{
    auvid_real_t residual = c->result.residual[j];
    bool several = c->freedom[j] > AUVID_C(1e-4);
    auvid_real_t scatter = several ? c->scatter[j] : AUVID_C(0.0);
    auvid_real_t freedom = several ? c->freedom[j] : AUVID_C(0.0);
    c->result.noise[j] = auvid_sqrt((CONFIDENCE_SMOOTHED * residual * residual + scatter) /
                                    (AUVID_C(1.0) + freedom));
    auvid_confidence_bias(c, j);
}

/* The first driven DoF from j on. @return there is one */
static bool seek_dof(job_t *c, int j)
{
    while (j < AUVID_DOF_COUNT && !confidence_is_driven(c, j)) {
        ++j;
    }
    c->at_dof = (uint8_t)j;
    return j < AUVID_DOF_COUNT;
}

/* One step of the present phase. */
static void work_step(job_t *c)
{
    int j = c->at_dof, i = c->at_row,
        n = j < AUVID_DOF_COUNT ? auvid_metric_order(c->metric, j) : 1;
    const auvid_set_t *set = &c->metric->set[auvid_metric_slot(c->metric, c->at_set)];
    switch (c->phase) {
    case OWN:
        auvid_confidence_find_own(c, j);
        break;
    case ROTATE:
        auvid_confidence_rotate(c, j, i);
        break;
    case BOUND:
        auvid_confidence_bound_pivot(c, i);
        break;
    case INVERT:
        auvid_confidence_invert(c, i);
        break;
    case SCATTER:
        if (i == AUVID_METRIC_BANDS * n) {
            auvid_confidence_finish_dof(c, j);
        } else if (c->at_set < auvid_metric_sets(c->metric) && (set->driven >> j & 1)) {
            auvid_confidence_take_row(c, set, j, i / n, i % n);
        }
        break;
    case BIAS:
        find_bias(c, j);
        break;
    case JUDGE:
        auvid_confidence_judge(c, i);
        break;
    default:
        auvid_confidence_scale(c, i);
        for (j = 0; j < AUVID_DOF_COUNT && i == c->n - 1; ++j) {
            if (confidence_is_driven(c, j)) {
                auvid_confidence_discredit(c, j);
            }
        }
        break;
    }
}

/* How often work_step is due before the next DoF, or the end of a phase that has none. */
static int steps_of(const job_t *c)
{
    switch (c->phase) {
    case OWN:
    case BIAS:
        return 1;
    case ROTATE:
        return c->metric->count[c->at_dof];
    case SCATTER:
        return AUVID_METRIC_BANDS * auvid_metric_order(c->metric, c->at_dof) + 1;
    default:
        return c->n;
    }
}

static void end_phase(job_t *c)
{
    if (c->phase == INVERT && c->delayed) {
        c->delayed = false; /* once more, for given delays */
        memset(c->joint, 0, sizeof c->joint);
        memset(c->influence, 0, sizeof c->influence);
        c->phase = ROTATE;
    } else {
        ++c->phase;
    }
    if (c->phase <= JUDGE) { /* from then on the covariance stands there */
        memset(c->part, 0, sizeof c->part);
    }
    (void)seek_dof(c, 0);
}

/* What the next step costs beside its phase's price. */
static int price_of_border(const job_t *c)
{
    bool due = c->phase == ROTATE && c->delayed && c->at_row == 0;
    return due ? AUVID_METRIC_ROTATION * (auvid_metric_order(c->metric, c->at_dof) + 2) : 0;
}

/* Go on to the next step. */
static void move_on(job_t *c)
{
    bool by_dof = c->phase != BOUND && c->phase != INVERT && c->phase < JUDGE;
    if (++c->at_row < steps_of(c)) {
        return;
    }
    c->at_row = 0;
    if (by_dof && seek_dof(c, c->at_dof + 1)) {
        return;
    }
    if (c->phase == SCATTER) {
        auvid_confidence_finish_set(c);
        if (++c->at_set < auvid_metric_sets(c->metric)) {
            (void)seek_dof(c, 0);
            return;
        }
        c->at_set = 0;
    }
    end_phase(c);
}

void auvid_confidence_begin(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                            const auvid_real_t *pi, auvid_real_t dry_mass_kg,
                            const auvid_uncertainty_t *uncertainty)
{
    if (job == NULL || metric == NULL || pi == NULL) {
        return;
    }
    job_t *c = job;
    memset(c, 0, sizeof *c);
    c->metric = metric; /* for this call only: a job may be copied */
    c->dry_mass_kg = dry_mass_kg;
    if (uncertainty != NULL) {
        c->result.uncertainty = *uncertainty;
    }
    bool linear = auvid_metric_has_regressor(metric);
    uint32_t searched = linear ? auvid_metric_searched(metric) : auvid_metric_active(metric);
    for (int i = 0; i < metric->cfg.vehicle->parameters; ++i) {
        c->pi[i] = pi[i];
        c->widening[i] = AUVID_C(1.0);
        c->place[i] = NOWHERE;
        if (searched >> i & 1u) {
            c->index[c->n] = (uint8_t)i;
            c->place[i] = c->n++;
        }
    }
    for (int age = 0; age < auvid_metric_sets(metric); ++age) {
        bool driven = metric->set[auvid_metric_slot(metric, age)].driven != 0;
        c->result.sets = (uint8_t)(c->result.sets + driven);
    }
    /* with delays taken or uncertain, first what they cost: INVERT comes back here for the plain
     * triangle */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        c->delayed = c->delayed || confidence_is_considered(c, j) || confidence_is_estimated(c, j);
    }
    for (int i = 0; i < metric->cfg.vehicle->parameters; ++i) {
        auvid_confidence_note_idle(c, i);
    }
    (void)seek_dof(c, 0);
    c->metric = NULL;
}

void auvid_confidence_limits(auvid_confidence_job_t *job, const auvid_real_t *lower,
                             const auvid_real_t *upper, bool capped)
{
    if (job == NULL || lower == NULL || upper == NULL) {
        return;
    }
    for (int k = 0; k < job->n; ++k) {
        int p = job->index[k];
        bool high = job->pi[p] - lower[p] > upper[p] - job->pi[p];
        auvid_real_t bound = high ? upper[p] : lower[p];
        if (auvid_abs(job->pi[p] - bound) < NEAR * (upper[p] - lower[p])) {
            job->at_bound |= 1u << p;
            job->result.partner[p] = high;
            job->result.bound[p] = bound;
        }
    }
    job->capped = capped;
}

auvid_status_t auvid_confidence_work(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                                     uint32_t *budget)
{
    static const uint8_t price[] = {
        [OWN] = 16,     [ROTATE] = 8, [BOUND] = 8,  [INVERT] = 6,
        [SCATTER] = 10, [BIAS] = 45,  [JUDGE] = 80, [CONCLUDE] = 12}; /* [units] */
    if (job == NULL || metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    job->metric = metric;
    while (job->phase != DONE && *budget > 0) {
        --*budget;
        if (++job->paid < price[job->phase] + price_of_border(job)) {
            continue;
        }
        job->paid = 0;
        work_step(job);
        move_on(job);
    }
    job->metric = NULL;
    return job->phase == DONE ? AUVID_OK : AUVID_PENDING;
}
