/*
 * The identifier: validation of estimates by sets that they have not seen.
 *
 *     PREPARE -> PREDICT -> COMPARE -> CHANGE_TEST, set by set, before the new sets are merged
 *
 * An estimate becomes the accepted one when the next set confirms it. If it predicts that set worse
 * than the accepted estimate does, it is withdrawn. Chow's F of all DoF (auvid_metric_change) with
 * the effective noise (estimate.h) decides whether the vehicle has changed. So neither a strong
 * disturbance nor a set with other motion raises an alarm. Drift is tested last, with the accepted
 * estimate (auvid_identifier_drift.c).
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../metric/auvid_metric_feedback_internal.h"

/* A prediction is worse only if its cost is larger by this factor. */
#define MARGIN AUVID_C(1.1)
/* An estimate is restored only if the variance of its residuals in each DoF of the set is below
 * this multiple of that in its own data. */
#define LIMIT_RESTORE AUVID_C(3.0)

/* Chow's F is about 1 in each DoF if nothing has changed. A payload affects all DoF, so there are
 * two criteria: the sum of F - 1 over the DoF exceeds LIMIT_ONE - 1 (LIMIT_TWO - 1 for two new
 * sets), or one F exceeds LIMIT_DOF. Both need ENOUGH sets. A few large F dominate the sum, so the
 * same limits hold for two DoF as for four. Of 17570 unchanged sets at disturbances of 1 and 3 N:
 * largest sum for any of the DoF 11.2 - 1 (10.7 - 1 for two), largest F 9.2. By the tails, one set
 * in 1e5 exceeds each limit. With four older sets one new set reached 20.8. The same holds for an
 * estimate of four sets, whose noise is used; it occurs if the search takes longer than a set. */
#define LIMIT_DOF AUVID_C(10.0)
#define LIMIT_ONE AUVID_C(12.0)
#define LIMIT_TWO AUVID_C(11.0)
/* Factor of the largest noise so far, per set: halved in 69 sets. */
#define NOISE_DECAY AUVID_C(0.99)
/* Bound of the ratio of residual variances. */
#define LARGEST_NOISE_RATIO AUVID_C(4.0)
enum { ENOUGH = 6 };

/* A set is validated, or was overwritten before: the next newer one, if there is one, counts. */
static void identifier_advance_set(auvid_identifier_t *id)
{
    if (--id->work.untested > 0) {
        auvid_metric_include_next(&id->metric);
    }
}

/* Test the oldest set not yet tested: it is the newest one that counts. */
static bool identifier_begin_test(auvid_identifier_t *id)
{
    auvid_metric_t *m = &id->metric;
    const auvid_estimate_t *e = &id->estimate;
    while (id->work.untested > 0 && auvid_metric_sets(m) == 0) { /* overwritten before its test */
        identifier_advance_set(id);
    }
    if (id->work.untested == 0) {
        return false;
    }
    auvid_metric_protect(m, m->cfg.sets >= ENOUGH ? ENOUGH : 0);
    if (id->attached.change->straddles_change) {
        (void)auvid_metric_drop(m, 1);
    }
    auvid_metric_linearise_begin(m, e->pi, auvid_identifier_common_delay(e), 1);
    id->work.phase = AUVID_WORK_PREPARE;
    return true;
}

static void identifier_begin_prediction(auvid_identifier_t *id, const auvid_estimate_t *e,
                                        uint8_t phase)
{
    auvid_metric_predict_begin(&id->metric, e->pi, auvid_identifier_common_delay(e));
    id->work.phase = phase;
}

static void identifier_begin_statistic(auvid_identifier_t *id, auvid_real_t sag)
{
    auvid_metric_change_begin(&id->metric, &id->attached.change->statistic, sag);
    id->work.phase = AUVID_WORK_CHANGE_TEST;
}

static void identifier_restart_change(auvid_identifier_t *id)
{
    identifier_begin_statistic(id, AUVID_C(0.0));
}

/* Cost of the prediction, over the DoF that both estimates identify. */
static auvid_real_t identifier_predicted_cost(const auvid_identifier_t *id)
{
    auvid_real_t cost = AUVID_C(0.0);
    uint8_t both = id->estimate.excited & id->attached.change->accepted.excited;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t scale = id->metric.cfg.tau_max[j];
        cost += (both >> j & 1) ? auvid_metric_predicted(&id->metric, j) / (scale * scale)
                                : AUVID_C(0.0);
    }
    return cost;
}

/* Record how the last estimate predicted the new set. */
static void identifier_record_prediction(auvid_identifier_t *id)
{
    auvid_change_test_t *test = &id->change_test;
    const auvid_metric_t *m = &id->metric;
    const auvid_set_t *set = auvid_metric_newest(m);
    test->set = set->number;
    test->estimate = id->estimate.number;
    test->excited = set->excited & id->estimate.excited;
    test->changed = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t residual = id->estimate.confidence.residual_rms[j];
        auvid_real_t rows = (auvid_real_t)set->rows_of[j];
        auvid_real_t ratio = auvid_metric_predicted(m, j) / (rows * residual * residual);
        test->variance_ratio[j] = auvid_is_finite(ratio) ? ratio : AUVID_C(0.0);
        test->change[j] = AUVID_C(0.0);
    }
    id->attached.change->predicted = identifier_predicted_cost(id);
}

/* Does the accepted estimate predict each DoF of the set about as well as its own data? Not if it
 * is from before a change of the vehicle, or a record without data. */
static bool identifier_explains_set(const auvid_identifier_t *id, const auvid_estimate_t *accepted)
{
    const auvid_set_t *set = auvid_metric_newest(&id->metric);
    bool explains = true;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t residual = accepted->confidence.residual_rms[j];
        auvid_real_t own = (auvid_real_t)set->rows_of[j] * residual * residual;
        bool counts = (set->excited & accepted->excited) >> j & 1;
        explains =
            explains && (!counts || auvid_metric_predicted(&id->metric, j) <= LIMIT_RESTORE * own);
    }
    return explains;
}

/* The accepted estimate's prediction is complete: keep one of the two. An estimate of other DoF is
 * no substitute: its parameters of the remaining DoF are not estimates. */
static void identifier_compare_estimates(auvid_identifier_t *id)
{
    bool worse = id->attached.change->predicted > MARGIN * identifier_predicted_cost(id);
    if (worse && (id->estimate.excited != id->attached.change->accepted.excited ||
                  id->estimate.coupled != id->attached.change->accepted.coupled ||
                  !identifier_explains_set(id, &id->attached.change->accepted))) {
        return;
    }
    if (worse) {
        uint32_t number = id->estimate.number;
        id->estimate = id->attached.change->accepted;
        id->estimate.number = number + 1;
        id->estimate.t_us = id->t_us;
        id->events |= AUVID_EVENT_RESTORED;
        identifier_simulate(id);
    } else {
        id->estimate.accepted = true;
        id->attached.change->accepted = id->estimate;
        identifier_accept_uncertain(id);
    }
}

/* Factor of the noise variance if the newest sets are noisier than the estimate's, each fitted by
 * itself: the ratio of their residual variances, squared, as few rows with much leverage (outliers
 * of the DVL) move the parameters more than the residuals. Bounded: far larger residuals are no
 * noise. */
static auvid_real_t identifier_noise_factor(const auvid_identifier_t *id, int newest, int j)
{
    auvid_real_t rows = AUVID_C(0.0), residual = id->estimate.confidence.residual_rms[j];
    for (int age = 0; age < newest; ++age) {
        const auvid_set_t *set = auvid_metric_set(&id->metric, age);
        rows += (set->excited >> j & 1) != 0 ? (auvid_real_t)set->rows_of[j] : AUVID_C(0.0);
    }
    auvid_real_t squares = id->attached.change->statistic.unexplained[newest - 1][j];
    auvid_real_t ratio =
        auvid_clamp(squares / (rows * residual * residual), AUVID_C(1.0), LARGEST_NOISE_RATIO);
    return ratio * ratio;
}

/* F - 1 of each DoF for the newest `newest` sets, relative to its limit; 0: no test possible.
 * @return the largest, or their sum relative to its limit, if that is larger */
static auvid_real_t identifier_weigh_evidence(const auvid_identifier_t *id, int newest,
                                              auvid_real_t evidence[AUVID_DOF_COUNT])
{
    const auvid_metric_t *m = &id->metric;
    const auvid_metric_change_t *statistic = &id->attached.change->statistic;
    bool enough = id->estimate.confidence.sets >= ENOUGH - 1;
    auvid_real_t max_evidence = AUVID_C(0.0), sum = AUVID_C(0.0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t noise = id->attached.change->noise[j];
        auvid_real_t f =
            statistic->change[newest - 1][j] / ((auvid_real_t)statistic->rank[j] * noise * noise *
                                                identifier_noise_factor(id, newest, j));
        bool known = enough && auvid_metric_excited_sets(m, j, newest) + newest >= ENOUGH &&
                     (id->change_test.excited >> j & 1) && auvid_is_finite(f);
        auvid_real_t excess = known ? f - AUVID_C(1.0) : AUVID_C(0.0);
        evidence[j] = excess / (LIMIT_DOF - AUVID_C(1.0));
        max_evidence = auvid_max(max_evidence, evidence[j]);
        sum += excess;
    }
    return auvid_max(max_evidence, sum / ((newest == 1 ? LIMIT_ONE : LIMIT_TWO) - AUVID_C(1.0)));
}

/* Noise with outliers varies from ring to ring. The largest of late counts. */
static void identifier_remember_noise(auvid_identifier_t *id)
{
    bool enough = id->estimate.confidence.sets >= ENOUGH - 1;
    for (int j = 0; enough && j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t *noise = &id->attached.change->noise[j];
        *noise = auvid_max(NOISE_DECAY * *noise, id->estimate.confidence.effective_noise[j]);
    }
}

/* Evidence decides at once in a set that auvid has excited. Other motion may be of another kind
 * than that of the older sets, and a controller answers what disturbs: both turn errors of the
 * model into evidence. Then the set is deleted, and the next one decides: the vehicle has changed
 * if it is evidence, too, or does not excite the same DoF. Figures: lib/README.md.
 * @param found bit j: evidence, most clearly in this DoF @return bit j: the vehicle has changed */
static uint8_t identifier_confirm(auvid_identifier_t *id, uint8_t found)
{
    auvid_change_detector_t *change = id->attached.change;
    const auvid_metric_config_t *cfg = &id->metric.cfg;
    uint8_t before = change->suspected;
    bool passive = 2 * change->passive_cells > (uint32_t)cfg->set_rows * cfg->row_cells;
    change->suspected = 0;
    if (found == 0) {
        return (uint8_t)(before & ~(unsigned)id->change_test.excited);
    }
    if (passive && before == 0) {
        change->suspected = found;
        (void)auvid_metric_drop(&id->metric, 0);
        return 0;
    }
    return found;
}

/* Is there evidence, and a sag of the thrust that may explain it? Then begin the statistic again,
 * with the sag. */
static bool identifier_begin_with_sag(auvid_identifier_t *id)
{
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    bool tried = !auvid_is_zero(id->attached.change->statistic.sag);
    auvid_real_t dof[AUVID_DOF_COUNT];
    if (uncertain == NULL || tried ||
        !(identifier_weigh_evidence(id, 1, dof) > AUVID_C(1.0) ||
          identifier_weigh_evidence(id, 2, dof) > AUVID_C(1.0))) {
        return false;
    }
    auvid_real_t sag = uncertain->sag(id);
    if (auvid_is_zero(sag)) {
        return false;
    }
    identifier_begin_statistic(id, sag);
    return true;
}

/* Decide whether the vehicle has changed. */
static void identifier_conclude_test(auvid_identifier_t *id)
{
    auvid_change_test_t *test = &id->change_test;
    auvid_real_t one[AUVID_DOF_COUNT], two[AUVID_DOF_COUNT];
    auvid_real_t by_one = identifier_weigh_evidence(id, 1, one),
                 by_two = identifier_weigh_evidence(id, 2, two);
    const auvid_real_t *evidence = by_one > by_two ? one : two;
    int clearest = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        test->change[j] = auvid_max(evidence[j], AUVID_C(0.0));
        clearest = evidence[j] > evidence[clearest] ? j : clearest;
    }
    test->change[clearest] = auvid_max(by_one, by_two);
    bool suspected = id->attached.change->suspected != 0;
    test->changed =
        identifier_confirm(id, (uint8_t)((test->change[clearest] > AUVID_C(1.0)) << clearest));
    id->attached.change->straddles_change = false;
    id->events |= AUVID_EVENT_VALIDATED;
    if (test->changed != 0) {
        /* The change may be in the middle of a set: of the deleted one, or of the newest, if that
         * set by itself raised the alarm, else of the one before. */
        for (int age = 1; age < auvid_metric_sets(&id->metric); ++age) {
            (void)auvid_metric_drop(&id->metric, (uint8_t)age);
        }
        id->attached.change->straddles_change = by_one > AUVID_C(1.0) && !suspected;
        id->work.cold_start = true;
        id->work.searching = false;
        id->events |= AUVID_EVENT_CHANGED;
        identifier_discard_uncertain(id);
        if (id->metric.prior != NULL) {
            id->metric.prior->change_vehicle(&id->metric);
        }
        auvid_identifier_restart_drift(id);
    } else if (id->estimate.accepted && id->estimate.confidence.sets >= ENOUGH - 1 &&
               auvid_metric_feedback_dofs(&id->metric) != AUVID_FEEDBACK_ALL) {
        auvid_identifier_test_drift(id);
    }
}

/* ---- the phases ---- */

static auvid_status_t identifier_prepare(auvid_identifier_t *id, uint32_t *budget)
{
    return auvid_metric_linearise(&id->metric, &id->linear.windows, budget);
}

static void identifier_begin_predict(auvid_identifier_t *id)
{
    identifier_begin_prediction(id, &id->estimate, AUVID_WORK_PREDICT);
}

static void identifier_begin_change(auvid_identifier_t *id)
{
    identifier_compare_estimates(id);
    identifier_remember_noise(id);
    identifier_restart_change(id);
}

static void identifier_begin_compare(auvid_identifier_t *id)
{
    identifier_record_prediction(id);
    if (id->attached.change->accepted.number > 0) {
        identifier_begin_prediction(id, &id->attached.change->accepted, AUVID_WORK_COMPARE);
    } else {
        identifier_begin_change(id);
    }
}

static auvid_status_t identifier_change(auvid_identifier_t *id, uint32_t *budget)
{
    return auvid_metric_change(&id->metric, &id->attached.change->statistic, budget);
}

static void identifier_end_test(auvid_identifier_t *id)
{
    if (!identifier_begin_with_sag(id)) {
        identifier_conclude_test(id);
        identifier_advance_set(id);
        auvid_identifier_begin_tests(id);
    }
}

static const auvid_change_functions_t identifier_change_functions = {
    identifier_begin_test,
    {{NULL, identifier_prepare, identifier_begin_predict, auvid_identifier_begin_tests},
     {auvid_metric_measure, NULL, identifier_begin_compare, auvid_identifier_begin_tests},
     {auvid_metric_measure, NULL, identifier_begin_change, auvid_identifier_begin_tests},
     {NULL, identifier_change, identifier_end_test, identifier_restart_change}}};

auvid_status_t auvid_identifier_attach_change_test(auvid_identifier_t *id,
                                                   auvid_change_detector_t *storage)
{
    if (id == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_identifier_check_attach(id, id->attached.change);
    if (status == AUVID_OK) {
        memset(storage, 0, sizeof *storage);
        id->attached.change = storage;
        id->attached.change_functions = &identifier_change_functions;
    }
    return status;
}
