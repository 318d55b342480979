/*
 * The identifier: the minimum of the regressor path. Its cost is convex, and the merged R factor
 * gives the minimum within the bounds. The search confirms it (auvid_optimizer_certify). A search
 * that ends elsewhere has not converged, whatever its own criterion says.
 */
#include "../search/auvid_bounded_ls_internal.h"
#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

void auvid_identifier_begin_optimum(auvid_identifier_t *id, const auvid_real_t *pi)
{
    auvid_bounded_ls_t *ls = &id->optimum;
    int n = 0;
    for (int p = 0; p < identifier_vehicle(id)->parameters; ++p) {
        if ((id->work.active >> p & 1u) != 0) {
            id->work.parameter_of[n++] = (uint8_t)p;
        }
    }
    auvid_bounded_ls_begin(ls, n);
    id->work.seeks_optimum = true;
    for (int i = 0; i < n; ++i) {
        int p = id->work.parameter_of[i];
        ls->lower[i] = id->search.lower[p];
        ls->upper[i] = id->search.upper[p];
        ls->x[i] = auvid_clamp(pi[p], ls->lower[i], ls->upper[i]);
    }
}

auvid_minimum_t auvid_identifier_take_optimum(auvid_identifier_t *id, auvid_real_t constant,
                                              auvid_real_t *pi)
{
    const auvid_bounded_ls_t *ls = &id->optimum;
    id->work.seeks_optimum = false;
    for (int i = 0; i < ls->n; ++i) {
        pi[id->work.parameter_of[i]] = ls->x[i];
    }
    return auvid_identifier_minimum(ls->cost, constant, ls->zero);
}

static void identifier_begin_minimum(auvid_identifier_t *id)
{
    auvid_identifier_begin_optimum(id, id->estimate.pi);
}

static void identifier_scale_of_columns(const auvid_identifier_t *id, auvid_real_t *scale)
{
    auvid_metric_scale(&id->metric, scale);
}

const auvid_path_start_t auvid_start_optimum = {.begin = identifier_begin_minimum,
                                                .run = auvid_identifier_optimum,
                                                .scale = identifier_scale_of_columns};

bool auvid_identifier_pays(auvid_bounded_ls_t *ls)
{
    if (++ls->spent * 40 < ls->n * (ls->n + 24)) {
        return false;
    }
    ls->spent = 0;
    return true;
}

auvid_status_t auvid_identifier_optimum(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_bounded_ls_t *ls = &id->optimum;
    const auvid_metric_t *m = &id->metric;
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1];
    auvid_status_t status = AUVID_PENDING;
    while (status == AUVID_PENDING && *budget > 0) {
        --*budget;
        if (!auvid_identifier_pays(ls)) {
            continue;
        }
        if (ls->dof == AUVID_DOF_COUNT) {
            status = auvid_bounded_ls_step(ls, m->result.constant);
        } else if (auvid_metric_joint_row(m, ls->dof, ls->row, id->work.active, m->cfg.fixed,
                                          row)) {
            ++ls->row;
            auvid_bounded_ls_add(ls, row);
        } else {
            ++ls->dof;
            ls->row = 0;
        }
    }
    if (status == AUVID_PENDING) {
        return AUVID_PENDING;
    }
    id->work.minimum = auvid_identifier_take_optimum(id, m->result.constant, id->work.candidate);
    return AUVID_OK;
}
