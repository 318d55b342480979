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

/* Norm of both losses with speed, whose columns are k and the next one; *code: of the larger. */
static auvid_real_t causes_loss_norm(const uncertain_t *u, int j, int k, int *code)
{
    auvid_real_t a = u->shared[AUVID_UNCERTAIN_INFLOW], b = u->shared[AUVID_UNCERTAIN_BILINEAR];
    auvid_real_t aa = a * a * auvid_uncertain_product(u, j, k, k);
    auvid_real_t bb = b * b * auvid_uncertain_product(u, j, k + 1, k + 1);
    auvid_real_t ab = a * b * auvid_uncertain_product(u, j, k, k + 1);
    *code = bb > aa ? AUVID_UNCERTAIN_BILINEAR : AUVID_UNCERTAIN_INFLOW;
    return auvid_sqrt(auvid_max(aa + AUVID_C(2.0) * ab + bb, AUVID_C(0.0)));
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

/* Standard deviation of the sum of DoF j's own input `own` and of a shared input; negative: none.
 * Both losses with speed are one. With J the joint R factor, and [R_o R_c] the rows of the DoF's
 * own inputs, the variance is
 *
 *     2 (||g||^2 + ||v||^2),   R_o' g = own,   J' v = shared - R_c' g
 */
static auvid_real_t causes_deviation(const uncertain_t *u, int j, int own, int shared)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t g[AUVID_UNCERTAIN_OWN], v[JOINT_ORDER], variance = AUVID_C(0.0);
    auvid_clear(g, AUVID_UNCERTAIN_OWN);
    auvid_clear(v, JOINT_ORDER);
    for (int i = own; i >= 0 && i < e->own; ++i) {
        const auvid_real_t *row = auvid_uncertain_own_row(u, e, i);
        g[i] = ((i == own ? AUVID_C(1.0) : AUVID_C(0.0)) - g[i]) / row[i];
        variance += g[i] * g[i];
        for (int k = i + 1; k < e->order - 1; ++k) {
            if (k < e->own) {
                g[k] += row[k] * g[i];
            } else {
                v[auvid_uncertain_joint_column(u, &u->id->metric, j, k)] -= row[k] * g[i];
            }
        }
    }
    if (shared >= 0) {
        v[shared] += AUVID_C(1.0);
    }
    if (shared == AUVID_UNCERTAIN_INFLOW) {
        v[AUVID_UNCERTAIN_BILINEAR] += AUVID_C(1.0);
    }
    auvid_qr_solve_transposed(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, v);
    for (int k = 0; k < JOINT_ORDER - 1; ++k) {
        variance += v[k] * v[k];
    }
    return auvid_sqrt(AUVID_UNCERTAIN_COVARIANCE * variance);
}

/* Has DoF j thrust of its own? An equation that only coupling moves has hardly any, and of that a
 * part is soon 3 %: a lever arm of 1 mm of a vehicle without thrusters in sway. */
static bool causes_has_thrust(const uncertain_t *u, int j, auvid_real_t thrust)
{
    auvid_real_t largest = thrust;
    int first = j < AUVID_ROLL ? AUVID_SURGE : AUVID_ROLL; /* forces, or moments */
    for (int i = first; i < first + 3; ++i) {
        int order = u->equation[i].order;
        largest = order > 0 ? auvid_max(largest, causes_norm(u, i, order - 1)) : largest;
    }
    return thrust >= AUVID_CAUSE_SHARE * largest;
}

/* An input as a cause: the value is that of an own input of the DoF, of a shared one, or their sum;
 * NO_INPUT: without it. */
typedef struct {
    auvid_real_t value, share;
    auvid_real_t margin; /* of the value: so much need not be an error */
    int code, own, shared;
} causes_finding_t;

/* Returns the finding of input k of DoF j, whose thrust has this norm. Delay and lag add up, and so
 * do both losses with speed, at full thrust. */
static causes_finding_t causes_find(const uncertain_t *u, int j, int k, auvid_real_t thrust)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const int code = u->code[e->channel_at + k];
    bool own = code >= OWN_INPUTS;
    causes_finding_t f = {.value = code < OWN_INPUTS ? u->shared[code] : u->own[e->own_at + k],
                          .code = code,
                          .own = own ? k : NO_INPUT,
                          .shared = own ? NO_INPUT : code};
    if (code == INPUT_DELAY || code == AUVID_UNCERTAIN_LAG) {
        f.shared = u->cfg.lag_s > AUVID_C(0.0) ? AUVID_UNCERTAIN_LAG : NO_INPUT;
        f.value += own ? u->shared[AUVID_UNCERTAIN_LAG] : AUVID_C(0.0);
        if (f.value < AUVID_C(0.0)) {
            f.value = auvid_min(f.value + u->cfg.nominal_lag_s, AUVID_C(0.0));
            f.margin = MAX_EARLY_S;
        }
    }
    f.share = auvid_abs(f.value) * causes_norm(u, j, k) / thrust;
    if (code == AUVID_UNCERTAIN_INFLOW) {
        f.value += u->shared[AUVID_UNCERTAIN_BILINEAR];
        f.share = causes_loss_norm(u, j, k, &f.code) / thrust;
    }
    return f;
}

/* Consider input k of DoF j. The asymmetry of the drag is kept of each DoF, whatever its share. */
static void causes_consider(uncertain_t *u, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    int code = u->code[e->channel_at + k];
    auvid_cause_class_t class = auvid_uncertain_row(code)->class;
    if (class == AUVID_CAUSE_COUNT || code == AUVID_UNCERTAIN_BILINEAR) { /* with the other law */
        return;
    }
    auvid_cause_t *best = &u->work.causes.cause[class];
    auvid_real_t thrust = causes_norm(u, j, e->order - 1);
    const causes_finding_t f = causes_find(u, j, k, thrust);
    bool each = code == INPUT_ASYMMETRY, matters = f.share >= AUVID_CAUSE_SHARE;
    bool large = matters && causes_has_thrust(u, j, thrust);
    bool less = best->sigma > AUVID_C(0.0) && !(f.share > best->share) && (best->named || !large);
    if (!each && ((matters && !large) || less)) {
        return;
    }
    auvid_real_t sigma = causes_deviation(u, j, f.own, f.shared);
    if (!(thrust > AUVID_C(0.0)) || !auvid_is_finite(f.share * sigma)) {
        return;
    }
    auvid_real_t unit =
        each ? auvid_uncertain_find_one_way(u, j, k, f.value) : causes_unit(u, f.code, j);
    if (each) {
        u->work.causes.asymmetry[j] = unit * f.value;
        u->work.causes.asymmetry_sigma[j] = unit * sigma;
    }
    bool named = large && auvid_abs(f.value) - f.margin > AUVID_CAUSE_SIGMAS * sigma;
    if (named < best->named ||
        (named == best->named && !(f.share > best->share) && best->sigma > AUVID_C(0.0))) {
        return;
    }
    *best = (auvid_cause_t){.value = unit * f.value,
                            .sigma = unit * sigma,
                            .share = f.share,
                            .input = (uint8_t)f.code,
                            .dof = (uint8_t)j,
                            .named = named};
}

/* How far a class moves masses and drag, roughly. In 598 simulated mixtures of two vehicles the
 * estimate with exact inputs moves by 0.4 to 0.8 of the share for mounting, inflow and current
 * (medians), and by 0.9 to 1.4 for the others (lag of the Girona500: 0.6). */
static auvid_real_t causes_effect(const auvid_causes_t *causes, int class)
{
    bool half = class == AUVID_CAUSE_MOUNTING || class == AUVID_CAUSE_INFLOW ||
                class == AUVID_CAUSE_CURRENT;
    return (half ? AUVID_C(0.5) : AUVID_C(1.0)) * causes->cause[class].share;
}

/* List the named classes, the largest effect first. */
static void causes_sort(auvid_causes_t *causes)
{
    for (int k = 0; k < AUVID_CAUSE_COUNT; ++k) {
        int at = causes->named;
        if (!causes->cause[k].named) {
            continue;
        }
        for (; at > 0 && causes_effect(causes, causes->order[at - 1]) < causes_effect(causes, k);
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
           one->confidence.note[i] != AUVID_NOTE_FEEDBACK && sigma < AUVID_LARGEST &&
           auvid_abs(one->pi[i] - other->pi[i]) > AUVID_HALF_WIDTH * sigma;
}

/* Does a bound move a parameter? Then the inputs take a part of what it forbids. */
static bool causes_are_bounded(const uncertain_t *u)
{
    bool bounded = false;
    for (int i = 0; i < u->id->metric.cfg.vehicle->parameters; ++i) {
        bounded = bounded || u->estimate.confidence.note[i] == AUVID_NOTE_BESIDE_BOUND;
    }
    return bounded;
}

void auvid_uncertain_consider(auvid_uncertain_t *u, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    bool delayed = e->own > 0 && u->code[e->channel_at] == INPUT_DELAY;
    bool of_others = k >= e->own && auvid_uncertain_tilts(j); /* moves no parameter here */
    if (!of_others && !(delayed && u->code[e->channel_at + k] == AUVID_UNCERTAIN_LAG)) {
        causes_consider(u, j, k);
    }
}

void auvid_uncertain_publish_causes(auvid_uncertain_t *u)
{
    const auvid_estimate_t *plain = &u->id->estimate;
    bool differs = auvid_uncertain_thrust_differs(u);
    memset(&u->causes, 0, sizeof u->causes);
    if (differs || u->contradicted) {
        u->causes.thrust_differs = differs;
        u->causes.contradicted = !differs;
    } else if (causes_are_bounded(u)) { /* the drag in one direction stays */
        u->causes = u->work.causes;
        memset(u->causes.cause, 0, sizeof u->causes.cause);
    } else {
        u->causes = u->work.causes;
        causes_sort(&u->causes);
        for (int i = 0; i < u->id->metric.cfg.vehicle->parameters; ++i) {
            u->causes.differs |= (uint32_t)causes_differ(&u->estimate, plain, i) << i;
        }
    }
    u->causes.number = plain->number;
}

auvid_status_t auvid_uncertain_causes(const auvid_uncertain_t *u, auvid_causes_t *causes)
{
    if (u == NULL || causes == NULL) {
        return AUVID_ERR_NULL;
    }
    if (u->causes.number == 0) {
        return AUVID_ERR_NO_DATA;
    }
    *causes = u->causes;
    return AUVID_OK;
}
