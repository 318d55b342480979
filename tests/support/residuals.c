#include "residuals.h"

#include <math.h>

#include "metric/auvid_metric_evaluator_internal.h"

/* Those of the row that the window has taken last, which is of the set of that age. */
static int residuals_of_row(const auvid_metric_t *m, int age, double *residual, int room)
{
    const auvid_metric_evaluator_t *ev = &m->evaluator;
    int length = m->layout.window_length, count = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double sum = 0.0;
        if ((auvid_metric_set(m, age)->excited >> j & 1) == 0 || ev->window_of[j] != length) {
            continue;
        }
        for (int k = 0; k < length; ++k) {
            uint32_t at = (ev->window_rows + (uint32_t)k) % (uint32_t)length;
            sum += (double)m->layout.window_weight[k] * (double)ev->window[at][j];
        }
        if (count == room) {
            return -1;
        }
        residual[count++] = sqrt((double)ev->weight[j]) * sum;
    }
    return count;
}

int residuals_at(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s,
                 double *residual, int size)
{
    const auvid_metric_evaluator_t *ev = &metric->evaluator;
    auvid_status_t status = AUVID_PENDING;
    int count = 0;
    auvid_metric_cost_begin(metric, pi, delay_s);
    while (status == AUVID_PENDING) { /* one unit a call: at most one row */
        uint32_t budget = 1, set = ev->at.set, rows = ev->window_rows;
        status = auvid_metric_cost(metric, &budget);
        if (ev->window_rows != rows && ev->window_rows >= metric->layout.window_length) {
            int age = auvid_metric_sets(metric) - 1 - (int)set;
            int added = residuals_of_row(metric, age, residual + count, size - count);
            if (added < 0) {
                return -1;
            }
            count += added;
        }
    }
    return count;
}
