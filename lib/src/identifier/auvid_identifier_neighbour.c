/*
 * The identifier: neighbouring minima of the cost, on the residual path.
 *
 * As the delay changes, the commands leave the mean of a row one by one. If the model has kinks,
 * each makes a kink of the cost, so it has several minima whose delays differ by a part of a cell.
 * Algorithm 2 ends in any of them. It therefore runs again from delays that are 1.5 cells longer
 * and shorter, outside of these minima on both sides, with the other parameters of the best end,
 * until neither ends lower. The first two times its first steps are shorter, so that it takes
 * other ways.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"

#if AUVID_MAX_COMMANDS > 0

/* A lower minimum is lower by this part. */
#define NEIGHBOUR_GAIN AUVID_C(1e-4)
/* From the best end to where a search of its neighbours begins, and the least [cells]. */
#define NEIGHBOUR_STEP AUVID_C(1.5)
#define NEIGHBOUR_LEAST AUVID_C(0.1)
/* Unit of the steps over that of the last search, for the first two of its neighbours. */
#define NEIGHBOUR_RATIO AUVID_C(0.3)

/* From the best end's delay to that at which the next search begins [cells]. */
static auvid_real_t identifier_step_to_neighbour(const auvid_identifier_t *id)
{
    const auvid_search_config_t *search = &id->optimizer.cfg;
    int n = search->n - 1;
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)auvid_metric_cell_us(&id->metric);
    auvid_real_t at =
        search->good[n] + (id->work.sides_left == 2 ? NEIGHBOUR_STEP : -NEIGHBOUR_STEP) * cell_s;
    return (auvid_clamp(at, search->lower[n], search->upper[n]) - search->good[n]) / cell_s;
}

auvid_status_t auvid_identifier_begin_neighbour(auvid_identifier_t *id)
{
    auvid_optimizer_t *o = &id->optimizer;
    auvid_real_t scale[AUVID_MAX_PARAMETERS], *delay_s = &o->cfg.good[o->cfg.n - 1];
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)auvid_metric_cell_us(&id->metric);
    auvid_real_t end_s = *delay_s;
    for (int i = 0; i < o->cfg.n; ++i) {
        scale[i] = (id->work.neighbours <= 2 ? NEIGHBOUR_RATIO : AUVID_C(1.0)) * o->scale[i];
    }
    *delay_s += identifier_step_to_neighbour(id) * cell_s;
    o->cfg.phases = AUVID_SEARCH_LOCAL;
    o->cfg.has_good = true;
    auvid_status_t status = auvid_optimizer_init(o, &o->cfg, scale);
    *delay_s = end_s;
    return status < 0 ? status
                      : auvid_optimizer_set_goal(o, (1 - NEIGHBOUR_GAIN) * id->work.minimum.cost);
}

/* Are there neighbours to search? */
static bool identifier_has_neighbours(const auvid_identifier_t *id)
{
    return identifier_searches_delay(id) && !identifier_certifies(id) && !id->search.paper &&
           id->search.phases != AUVID_SEARCH_GLOBAL && id->work.minimum.cost < AUVID_COST_FAILED;
}

/* The end of a search is the best one so far. */
static void identifier_take_end(auvid_identifier_t *id, bool converged)
{
    auvid_optimizer_t *o = &id->optimizer;
    memcpy(o->cfg.good, auvid_optimizer_best(o, NULL), o->cfg.n * sizeof *o->cfg.good);
    id->work.minimum.cost = id->work.cost;
    id->work.not_converged = !converged;
    id->work.sides_left = 2;
}

bool auvid_identifier_next_neighbour(auvid_identifier_t *id, bool converged)
{
    const auvid_search_config_t *search = &id->optimizer.cfg;
    if (id->work.neighbours == 0 || id->work.cost < (1 - NEIGHBOUR_GAIN) * id->work.minimum.cost) {
        identifier_take_end(id, converged);
    } else {
        --id->work.sides_left;
    }
    while (id->work.sides_left > 0 &&
           auvid_abs(identifier_step_to_neighbour(id)) < NEIGHBOUR_LEAST) {
        --id->work.sides_left;
    }
    if (!identifier_has_neighbours(id) || id->work.sides_left == 0 ||
        id->work.neighbours == WORK_NEIGHBOURS) {
        auvid_identifier_expand(id, search->good, search->n);
        id->work.cost = id->work.minimum.cost;
        id->work.neighbours = 0;
        return false;
    }
    ++id->work.neighbours;
    id->work.spent = WORK_START;
    id->work.phase = AUVID_WORK_MERGE;
    return true;
}

#endif
