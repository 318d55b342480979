/*
 * Metric: change test of the newest sets.
 *
 * U(A) is the part of the wrench in the sets A that no pi explains. A DoF's equation holds for the
 * old and the new sets with the same parameters if U(old and new) - U(old) - U(new) is only noise
 * (Chow 1960). It is then sigma^2 times a chi-square variable with as many degrees of freedom as
 * there are parameters. One chain of rotations, oldest set first, gives U of the old sets with and
 * without the set before the newest, and U of all. Then the newest set is rotated alone, and then
 * the two newest.
 *
 * Of thrust that sags by s in each set, an older set had more than the newest one: its wrench is
 * taken 1 + s k times, k the number of sets since then.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

void auvid_metric_change_begin(auvid_metric_t *metric, auvid_metric_change_t *change,
                               auvid_real_t sag)
{
    if (metric != NULL && change != NULL) {
        auvid_metric_restart_pass(metric, PASS_LAST);
        memset(change, 0, sizeof *change);
        change->sag = sag;
    }
}

/* DoF j has rotated in set number `step` of the chain: update the statistic. */
static void metric_record_change(auvid_metric_t *m, auvid_metric_change_t *to, int j, int step)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    int sets = auvid_metric_sets(m);
    auvid_metric_clear_dependent(m, j);
    auvid_real_t u = auvid_metric_unexplained(m, j);
    if (step == sets - 3 || step == sets - 2) {
        to->change[sets - 2 - step][j] -= u;
    } else if (step == sets - 1) {
        to->change[0][j] += u;
        to->change[1][j] += u;
        for (int i = 0; i < e.count; ++i) {
            bool usable = !auvid_is_zero(*auvid_equation_row(&e, i));
            to->rank[j] = (uint8_t)(to->rank[j] + usable);
        }
        memset(m->evaluator.merged + m->layout.factor_at[j], 0,
               (size_t)AUVID_QR_FACTOR(e.order) * sizeof u);
    } else if (step >= sets) {
        to->change[step - sets][j] -= u;
        to->unexplained[step - sets][j] = u;
    }
}

/* Rotate in one row of set number `step` of DoF j's chain. @return true if it has no more rows */
static bool metric_change_row(auvid_metric_t *m, auvid_real_t sag, int j, int step)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    int sets = auvid_metric_sets(m), n = auvid_metric_order(m, j);
    int age = step < sets ? sets - 1 - step : step - sets;
    const auvid_set_t *set = auvid_metric_set(m, age);
    if ((set->excited >> j & 1) == 0 || at->row >= AUVID_METRIC_BANDS * n) {
        return true;
    }
    auvid_real_t later = (auvid_real_t)(auvid_metric_newest(m)->number - set->number);
    auvid_metric_rotate(m, set, at->row / n, j, at->row % n, sag * later);
    ++at->row;
    return false;
}

auvid_status_t auvid_metric_change(auvid_metric_t *metric, auvid_metric_change_t *change,
                                   uint32_t *budget)
{
    if (metric == NULL || change == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    auvid_metric_cursor_t *at = &m->evaluator.at;
    int sets = auvid_metric_sets(m);
    int steps = sets < 3 ? 0 : sets + 2; /* fewer than three: nothing to compare with */
    for (; at->dof < AUVID_DOF_COUNT; ++at->dof, at->set = 0) {
        int j = at->dof;
        while (auvid_metric_order(m, j) > 0 && at->set < steps) {
            if (*budget == 0) {
                return AUVID_PENDING;
            }
            if (auvid_metric_spend(at, budget, AUVID_METRIC_ROTATION) &&
                metric_change_row(m, change->sag, j, at->set)) {
                metric_record_change(m, change, j, at->set++);
                at->row = 0;
            }
        }
    }
    return AUVID_OK;
}
