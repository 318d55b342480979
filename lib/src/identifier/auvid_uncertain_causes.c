/*
 * Uncertain inputs: which of them are certainly not zero, and matter.
 */
#include <string.h>

#include "auvid_uncertain_parts_internal.h"

/* The thrust acts for a whole tick: it may seem this much early [s]. */
#define MAX_EARLY_S AUVID_C(0.02)

enum { NO_INPUT = -1 };

typedef auvid_uncertain_t uncertain_t;

/* Norm of column k of DoF j, over all rows. */
static auvid_real_t causes_norm(const uncertain_t *u, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t low = auvid_qr_column_norm(u->factor[0] + e->factor_at, e->order, k);
    auvid_real_t high = auvid_qr_column_norm(u->factor[1] + e->factor_at, e->order, k);
    return auvid_sqrt(low * low + high * high);
}

/* The unit of an input's value: that of its configuration, per unit of its column. */
static auvid_real_t causes_unit(const uncertain_t *u, int code, int j)
{
    auvid_real_t sigma = auvid_uncertain_sigma(u, &u->id->metric, code, j);
    if (!auvid_uncertain_row(code)->relative) {
        return AUVID_C(1.0);
    }
    return sigma > AUVID_C(0.0) ? u->scale * auvid_uncertain_configured(u, code) / sigma
                                : AUVID_C(0.0);
}

/* Consider input k of DoF j. */
static void causes_consider(const uncertain_t *u, auvid_causes_t *causes, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    int code = u->code[e->channel_at + k], shared = k < e->own ? NO_INPUT : code;
    auvid_cause_class_t class = auvid_uncertain_row(code)->class;
    auvid_real_t value = code < OWN_INPUTS ? u->shared[code] : u->own[e->own_at + k];
    auvid_real_t margin = AUVID_C(0.0);
    if (class == AUVID_CAUSE_COUNT) {
        return;
    }
    auvid_cause_t *best = &causes->cause[class];
    if (class == AUVID_CAUSE_TIMING) { /* delay and lag add up */
        shared = u->cfg.lag_s > AUVID_C(0.0) ? AUVID_UNCERTAIN_LAG : NO_INPUT;
        value += k < e->own ? u->shared[AUVID_UNCERTAIN_LAG] : AUVID_C(0.0);
        if (value < AUVID_C(0.0)) {
            value = auvid_min(value + u->cfg.nominal_lag_s, AUVID_C(0.0));
            margin = MAX_EARLY_S;
        }
    }
    auvid_real_t thrust = causes_norm(u, j, e->order - 1);
    auvid_real_t share = auvid_abs(value) * causes_norm(u, j, k) / thrust;
    bool large = share >= AUVID_CAUSE_SHARE;
    if (best->sigma > AUVID_C(0.0) && !(share > best->share) && (best->named || !large)) {
        return;
    }
    auvid_real_t sigma = auvid_uncertain_deviation(u, j, k < e->own ? k : NO_INPUT, shared);
    if (!(thrust > AUVID_C(0.0)) || !auvid_is_finite(share * sigma)) {
        return;
    }
    bool named = large && auvid_abs(value) - margin > AUVID_CAUSE_SIGMAS * sigma;
    if (named < best->named ||
        (named == best->named && !(share > best->share) && best->sigma > AUVID_C(0.0))) {
        return;
    }
    auvid_real_t unit = causes_unit(u, code, j);
    *best = (auvid_cause_t){.value = unit * value,
                            .sigma = unit * sigma,
                            .share = share,
                            .input = (uint8_t)code,
                            .dof = (uint8_t)j,
                            .named = named};
}

/* List the named classes, the largest share first. */
static void causes_sort(auvid_causes_t *causes)
{
    for (int k = 0; k < AUVID_CAUSE_COUNT; ++k) {
        int at = causes->named;
        if (!causes->cause[k].named) {
            continue;
        }
        for (; at > 0 && causes->cause[causes->order[at - 1]].share < causes->cause[k].share;
             --at) {
            causes->order[at] = causes->order[at - 1];
        }
        causes->order[at] = (uint8_t)k;
        ++causes->named;
    }
}

/* Do both estimates of parameter i differ by more than both half-widths? */
static bool causes_differ(const auvid_estimate_t *one, const auvid_estimate_t *other, int i)
{
    auvid_real_t sigma = auvid_max(one->confidence.sigma[i], other->confidence.sigma[i]);
    return one->number == other->number && (one->identified >> i & 1u) != 0 &&
           sigma < AUVID_LARGEST && auvid_abs(one->pi[i] - other->pi[i]) > AUVID_HALF_WIDTH * sigma;
}

auvid_status_t auvid_uncertain_causes(const auvid_uncertain_t *u, auvid_causes_t *causes)
{
    if (u == NULL || causes == NULL) {
        return AUVID_ERR_NULL;
    }
    if (u->work.solving) {
        return AUVID_PENDING;
    }
    bool differs = auvid_uncertain_thrust_differs(u);
    if (u->estimate.number == 0 && !u->contradicted && !differs) {
        return AUVID_ERR_NO_DATA;
    }
    memset(causes, 0, sizeof *causes);
    causes->thrust_differs = differs;
    causes->contradicted = u->contradicted && !differs;
    if (u->contradicted || differs) {
        return AUVID_OK;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_uncertain_equation_t *e = &u->equation[j];
        bool delayed = e->own > 0 && u->code[e->channel_at] == INPUT_DELAY;
        for (int k = 0; k < e->inputs && auvid_uncertain_has_rows(u, j); ++k) {
            if (!delayed || u->code[e->channel_at + k] != AUVID_UNCERTAIN_LAG) {
                causes_consider(u, causes, j, k);
            }
        }
    }
    causes_sort(causes);
    for (int i = 0; i < u->id->metric.cfg.vehicle->parameters; ++i) {
        causes->differs |= (uint32_t)causes_differ(&u->estimate, &u->id->estimate, i) << i;
    }
    return AUVID_OK;
}
