/*
 * The identifier: searches beside the end of another one, on the residual path.
 *
 * The cost of a model with kinks has several minima whose delays are within a cell: with the delay,
 * one command after the other leaves a row. Algorithm 2 ends in one of them. So it runs again from
 * delays that are 1.5 cells longer and shorter, with the other parameters of the best end, until
 * neither ends lower: it comes from both sides of these minima.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"

#if AUVID_MAX_COMMANDS > 0

/* A lower minimum is lower by this part. */
#define LOWER_BY AUVID_C(1e-4)
/* How far beside the best end the next search begins [cells], and the unit of its steps over that
 * of the last one. */
#define STEP_BESIDE AUVID_C(1.5)
#define SHORTER AUVID_C(0.3)

/* The delay at which the next search beside the best end begins [s]. */
static auvid_real_t identifier_delay_beside(const auvid_identifier_t *id)
{
    const auvid_search_config_t *search = &id->optimizer.cfg;
    int n = search->n - 1;
    auvid_real_t step_s = STEP_BESIDE * AUVID_C(1e-6) * (auvid_real_t)id->metric.cfg.cell_us;
    auvid_real_t at = search->good[n] + (id->work.sides_left == 2 ? step_s : -step_s);
    return auvid_clamp(at, search->lower[n], search->upper[n]);
}

/* Do the bounds leave room for it, at least a tenth of a cell? */
static bool identifier_has_room_beside(const auvid_identifier_t *id)
{
    auvid_real_t step =
        identifier_delay_beside(id) - id->optimizer.cfg.good[id->optimizer.cfg.n - 1];
    return auvid_abs(step) >= AUVID_C(1e-7) * (auvid_real_t)id->metric.cfg.cell_us;
}

/* The best end is search.good, its cost minimum.cost. */
auvid_status_t auvid_identifier_begin_beside(auvid_identifier_t *id)
{
    auvid_optimizer_t *o = &id->optimizer;
    auvid_real_t scale[AUVID_MAX_PARAMETERS], *delay_s = &o->cfg.good[o->cfg.n - 1];
    auvid_real_t end_s = *delay_s;
    for (int i = 0; i < o->cfg.n; ++i) {
        scale[i] = SHORTER * o->scale[i];
    }
    *delay_s = identifier_delay_beside(id);
    o->cfg.phases = AUVID_SEARCH_LOCAL;
    o->cfg.has_good = true;
    auvid_status_t status = auvid_optimizer_init(o, &o->cfg, scale);
    *delay_s = end_s;
    return status < 0 ? status
                      : auvid_optimizer_set_goal(o, (1 - LOWER_BY) * id->work.minimum.cost);
}

bool auvid_identifier_search_beside(auvid_identifier_t *id)
{
    auvid_optimizer_t *o = &id->optimizer;
    if (!identifier_searches_delay(id) || identifier_certifies(id) || id->search.paper) {
        return false;
    }
    if (id->work.beside == 0 || id->work.cost < (1 - LOWER_BY) * id->work.minimum.cost) {
        memcpy(o->cfg.good, auvid_optimizer_best(o, NULL), o->cfg.n * sizeof *o->cfg.good);
        id->work.minimum.cost = id->work.cost;
        id->work.sides_left = 2;
    } else {
        --id->work.sides_left;
    }
    while (id->work.sides_left > 0 && !identifier_has_room_beside(id)) {
        --id->work.sides_left;
    }
    if (id->work.sides_left == 0 || id->work.beside == WORK_SEARCHES_BESIDE) {
        auvid_identifier_expand(id, o->cfg.good, o->cfg.n);
        id->work.cost = id->work.minimum.cost;
        return false;
    }
    ++id->work.beside;
    id->work.spent = WORK_START;
    id->work.phase = AUVID_WORK_MERGE;
    return true;
}

#endif
