/*
 * Metric, width of the smoother: it follows the vehicle and the noise of its sensors.
 *
 * The equations of smoothed rows hold for any smoother (auvid_metric_regressor.c). The best one
 * passes the frequencies at which the wrench moves the vehicle more than the noise seems to. Its
 * width is a number of cells. All that was measured for cells of 0.1 s (distance of the two rows of
 * a band, f of auvid_confidence.c, rows in a set) holds for longer ones: only the unit of time is
 * another.
 *
 * The high band of the rows decides. If its residual exceeds its wrench, then at least half of it
 * is noise: of the acceleration, or of waves. With cells of twice the length a row contains an
 * eighth of the squares of white velocity noise.
 */
#include <string.h>

#include "auvid_metric_evaluator_internal.h"

/* Smallest time constant, in cells: half of the smoother's half-width. */
#define METRIC_TIME_CONSTANT AUVID_C(5.0)

/* Merged sets after which the cells are kept. In one set a slow vehicle may hardly have moved. */
enum { ENOUGH_SETS = 3 };

/* auvid_metric_evaluator_t.noise: in some DoF the high band is noise; and this DoF is slow. */
enum { NOISY = 1, SLOW = 2 };

/* Returns the time constant of DoF j at the least-squares candidate, for the largest speed of the
 * newest set [s]; 0: it has no mass or no drag. */
static auvid_real_t metric_time_constant(const auvid_metric_t *m, int j)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    const uint16_t *fastest = auvid_metric_newest(m)->fastest[j];
    const auvid_real_t *x = m->evaluator.candidate + auvid_metric_equation(m, j).at;
    auvid_real_t speed = AUVID_C(0.001) * (auvid_real_t)fastest[fastest[1] > fastest[0]];
    auvid_real_t mass = AUVID_C(0.0), drag = AUVID_C(0.0);
    for (int i = 0; i < vehicle->parameters; ++i) {
        auvid_real_t value = (m->layout.columns[j] >> i & 1u) != 0 ? *x++ : m->cfg.fixed[i];
        const auvid_parameter_t *of = &vehicle->parameter[i];
        if (of->dof != (auvid_dof_t)j) {
            continue;
        }
        bool is_mass = of->kind == AUVID_PARAMETER_MASS || of->kind == AUVID_PARAMETER_INERTIA;
        mass += is_mass ? value : AUVID_C(0.0);
        drag -= of->kind == AUVID_PARAMETER_LINEAR_DRAG      ? value
                : of->kind == AUVID_PARAMETER_QUADRATIC_DRAG ? value * speed
                                                             : AUVID_C(0.0);
    }
    return drag > AUVID_C(0.0) ? mass / drag : AUVID_C(0.0);
}

void auvid_metric_judge_width(auvid_metric_t *m, int j)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    if (auvid_metric_is_excited(m, j) && !auvid_metric_stores_rows(m) &&
        ev->band_sse[1][j] > ev->high_wrench[j]) {
        auvid_real_t cells_s =
            METRIC_TIME_CONSTANT * AUVID_C(2e-6) * (auvid_real_t)auvid_metric_cell_us(m);
        unsigned slow = metric_time_constant(m, j) > cells_s ? SLOW : 0u;
        ev->noise = (uint8_t)(ev->noise | NOISY | slow);
    }
}

bool auvid_metric_lengthen(auvid_metric_t *m)
{
    uint8_t sets = m->evaluator.sets_merged;
    m->result.width_chosen =
        m->result.width_chosen || 2u * auvid_metric_cell_us(m) > m->cfg.max_cell_us ||
        (m->evaluator.noise == 0 && (sets >= ENOUGH_SETS || sets == m->cfg.sets));
    if (m->result.width_chosen || (m->evaluator.noise & SLOW) == 0) {
        return false;
    }
    ++m->result.doublings;
    m->sets.waiting = 0;
    memset(m->sets.set, 0, sizeof m->sets.set);
    auvid_metric_gap(m);
    memset(&m->rows.set, 0, sizeof m->rows.set);
    return true;
}
