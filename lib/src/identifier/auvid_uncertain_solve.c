/*
 * Uncertain inputs: the joint solution. Per DoF j, X = [C R] and theta = (b, pi):
 *
 *     e    = z - X theta                                 at the last pass
 *     s^2  = 2.6 ||e||^2 / rows                          bands weighted by their residuals
 *     X~   = X, with u' + lambda e / m in the column of the mass, and c - (1 - lambda) k e in a
 *            column c of the thrust, k = c'z / z'z
 *     min sum_j ||(e + X~ theta_0 - X~ theta) / s||^2 + sum_k (b_k / sigma_k)^2
 *
 * (Gauss-Newton.) lambda = 1: the noise moves the vehicle; 0: it is an error of the thrust. It is 1
 * for forces, and 1/2 for moments, which are small differences of the thrusters' forces.
 *
 * Columns c of the hull's inputs become c - D a, a = (D'D)^-1 D'c, D the columns of the DoF's drag
 * in unweighted bands. So pi contains the best drag for the motion that was seen.
 *
 * A DoF's own inputs are eliminated in its R factor. What is left of its rows is rotated into the
 * joint factor of shared inputs and parameters.
 *
 * Covariance: 1.43 P + 0.05 sum_j d_j d_j', P the inverse of the joint normal matrix. d_j is the
 * derivative of the solution by lambda_j: P X_j' times the change of X~_j's columns,
 * e'e / s^2 = rows / 2.6.
 *
 * After each pass the priors get the common scale c with the largest likelihood (MacKay 1992) of
 * the shared inputs, as if three of them had been seen to be right,
 *     c^2 = (3 + sum_k (b_k / sigma_k)^2) / (3 + sum_k (1 - P_kk / (c sigma_k)^2)).
 */
#include <string.h>

#include "auvid_uncertain_parts_internal.h"

#define SMOOTHED AUVID_C(2.6) /* see auvid_confidence.c */
#define COVARIANCE_FACTOR AUVID_C(1.43)
#define SIDE_VARIANCE AUVID_C(0.05)
#define LARGEST_BAND_RATIO AUVID_C(1e3) /* of the weights of the bands */

#define SEEN_RIGHT AUVID_C(3.0)    /* prior of the scale, as a number of inputs */
#define LARGEST_SCALE AUVID_C(2.0) /* and its inverse the smallest */

enum { SOLVE_PASSES = 3 };
enum {
    SOLVE_PREPARE,
    SOLVE_ROWS,
    SOLVE_OWN,
    SOLVE_TRANSFER,
    SOLVE_SHARED,
    SOLVE_FINISH,
    SOLVE_SCALE,
    SOLVE_SIDES,
    SOLVE_SIGMA,
    SOLVE_DONE
};

/* Where a parameter is in the joint factor; the last column is the thrust. */
enum { PARAMETERS_AT = AUVID_UNCERTAIN_SHARED, JOINT_ORDER = AUVID_UNCERTAIN_JOINT };

typedef auvid_uncertain_t uncertain_t;

/* ---- one DoF ---- */

/* Column of the joint factor of column k of a DoF, k >= own. */
static int uncertain_joint_column(const uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    if (k == e->order - 1) {
        return JOINT_ORDER - 1;
    }
    return k < e->inputs ? u->code[e->column_at + k]
                         : PARAMETERS_AT + auvid_metric_equation(m, j).index[k - e->inputs];
}

/* Sum over the bands of the product of two columns. */
static auvid_real_t uncertain_product(const uncertain_t *u, int j, int k, int l,
                                      const auvid_real_t weight[AUVID_METRIC_BANDS])
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t sum = AUVID_C(0.0);
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        const auvid_real_t *factor = u->factor[band] + e->factor_at;
        auvid_real_t product = AUVID_C(0.0);
        for (int i = 0; i <= k && i <= l; ++i) {
            const auvid_real_t *r = factor + auvid_qr_row(e->order, i);
            product += r[k - i] * r[l - i];
        }
        sum += weight[band] * product;
    }
    return sum;
}

/* Parts of column k that are linear and quadratic drag. */
static void uncertain_project(uncertain_t *u, int j, int k)
{
    static const auvid_real_t both[AUVID_METRIC_BANDS] = {AUVID_C(1.0), AUVID_C(1.0)};
    auvid_uncertain_part_t *p = &u->work.part;
    int l = p->drag_at[0], q = p->drag_at[1], none = u->equation[j].order;
    auvid_real_t ll = l == none ? AUVID_C(1.0) : uncertain_product(u, j, l, l, both);
    auvid_real_t qq = q == none ? AUVID_C(1.0) : uncertain_product(u, j, q, q, both);
    auvid_real_t lq = l == none || q == none ? AUVID_C(0.0) : uncertain_product(u, j, l, q, both);
    auvid_real_t lk = l == none ? AUVID_C(0.0) : uncertain_product(u, j, l, k, both);
    auvid_real_t qk = q == none ? AUVID_C(0.0) : uncertain_product(u, j, q, k, both);
    auvid_real_t determinant = ll * qq - lq * lq;
    if (determinant > AUVID_C(1e-4) * ll * qq) {
        p->drag[0][k] = (lk * qq - qk * lq) / determinant;
        p->drag[1][k] = (qk * ll - lk * lq) / determinant;
    }
}

/* Coefficients of the columns in the residual. */
static void uncertain_prepare_values(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_equation(m, j).index;
    p->drag_at[0] = p->drag_at[1] = e->order;
    for (int k = 0; k < e->order; ++k) {
        p->value[k] = k < e->own         ? u->own[e->own_at + k]
                      : k < e->inputs    ? u->shared[u->code[e->column_at + k]]
                      : k < e->order - 1 ? u->pi[index[k - e->inputs]]
                                         : AUVID_C(-1.0);
        p->residual[k] = -p->value[k];
        if (k >= e->inputs && k < e->order - 1) {
            const auvid_parameter_t *parameter = &m->cfg.vehicle->parameter[index[k - e->inputs]];
            bool linear = parameter->kind == AUVID_PARAMETER_LINEAR_DRAG;
            if ((int)parameter->dof == j &&
                (linear || parameter->kind == AUVID_PARAMETER_QUADRATIC_DRAG)) {
                p->drag_at[!linear] = (uint8_t)k;
            }
        }
    }
    for (int k = 0; k < e->inputs; ++k) {
        if (!auvid_uncertain_of_hull(u->code[e->column_at + k])) {
            continue;
        }
        uncertain_project(u, j, k);
        for (int d = 0; d < 2; ++d) {
            if (p->drag_at[d] < e->order) {
                p->residual[p->drag_at[d]] += p->drag[d][k] * p->value[k];
            }
        }
    }
}

/* Residual of row i of one band, at the last pass. */
static auvid_real_t uncertain_residual(const uncertain_t *u, int j, int band, int i)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const auvid_real_t *r = u->factor[band] + e->factor_at + auvid_qr_row(e->order, i);
    auvid_real_t sum = AUVID_C(0.0);
    for (int k = i; k < e->order; ++k) {
        sum += r[k - i] * u->work.part.residual[k];
    }
    return sum;
}

/* What the residual adds to each column, and the same for the joint solution (side). */
static void uncertain_prepare_slopes(uncertain_t *u, const auvid_metric_t *m, int j,
                                     const auvid_real_t weight[AUVID_METRIC_BANDS])
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_equation_t equation = auvid_metric_equation(m, j);
    auvid_real_t lambda = j < AUVID_ROLL ? AUVID_C(1.0) : AUVID_C(0.5), mass = AUVID_C(0.0);
    auvid_real_t a[AUVID_MAX_PARAMETERS];
    auvid_real_t zz = uncertain_product(u, j, e->order - 1, e->order - 1, weight);
    auvid_confidence_acceleration_row(m->cfg.vehicle, j, &p->regressor, a);
    memset(&p->regressor, 0, sizeof p->regressor); /* the factor is there from now on */
    for (int k = 0; k < equation.count; ++k) {
        mass += a[equation.index[k]] * u->pi[equation.index[k]];
    }
    auvid_clear(u->work.side[j], JOINT_ORDER);
    for (int k = 0; k < e->order - 1; ++k) {
        auvid_real_t side = AUVID_C(0.0), share = AUVID_C(1.0) - lambda;
        if (k >= e->inputs) {
            share = lambda;
            side = mass > AUVID_C(0.0) ? a[equation.index[k - e->inputs]] / mass : AUVID_C(0.0);
            p->slope[k] = share * side;
        } else if (auvid_uncertain_of_thrust(u->code[e->column_at + k])) {
            side = zz > AUVID_C(0.0) ? uncertain_product(u, j, k, e->order - 1, weight) / zz
                                     : AUVID_C(0.0);
            p->slope[k] = -share * side;
        }
        side *= u->rows[j] / SMOOTHED;
        if (k < e->own) {
            p->own_side[k] = side;
        } else {
            u->work.side[j][uncertain_joint_column(u, m, j, k)] = side;
        }
    }
}

/* The rows hold about as much as the ring: older ones fade. */
static void uncertain_fade(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_real_t full = (auvid_real_t)m->cfg.sets * (auvid_real_t)m->cfg.set_rows;
    auvid_real_t keep = full / u->rows[j], root = auvid_sqrt(keep);
    const auvid_uncertain_equation_t *e = &u->equation[j];
    if (keep < AUVID_C(1.0)) {
        for (int k = 0; k < 2 * AUVID_QR_FACTOR(e->order); ++k) {
            u->factor[k % 2][e->factor_at + k / 2] *= root;
        }
        u->rows[j] = full;
    }
}

static void uncertain_prepare(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_uncertain_part_t *p = &u->work.part;
    auvid_real_t squares[AUVID_METRIC_BANDS] = {AUVID_C(0.0)}, weight[AUVID_METRIC_BANDS];
    memset(p, 0, sizeof *p);
    if (u->work.pass == 0) {
        uncertain_fade(u, m, j);
    }
    uncertain_prepare_values(u, m, j);
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        for (int i = 0; i < u->equation[j].order; ++i) {
            auvid_real_t e = uncertain_residual(u, j, band, i);
            squares[band] += e * e;
        }
    }
    auvid_real_t ratio = squares[0] > AUVID_C(0.0) ? squares[1] / squares[0] : AUVID_C(1.0);
    ratio = auvid_clamp(ratio, AUVID_C(1.0) / LARGEST_BAND_RATIO, LARGEST_BAND_RATIO);
    weight[0] = auvid_sqrt(ratio);
    weight[1] = AUVID_C(1.0) / weight[0];
    auvid_real_t noise =
        auvid_sqrt(SMOOTHED * (weight[0] * squares[0] + weight[1] * squares[1]) / u->rows[j]);
    auvid_real_t least = AUVID_C(1e-5) * m->cfg.tau_max[j];
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        p->scale[band] = auvid_sqrt(weight[band]) / auvid_max(noise, least);
    }
    uncertain_prepare_slopes(u, m, j, weight);
}

/* Rotate row i of one band, with its changed columns, into the DoF's factor. */
static void uncertain_add_row(uncertain_t *u, int j, int band, int i)
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const auvid_real_t *r = u->factor[band] + e->factor_at + auvid_qr_row(e->order, i) - i;
    auvid_real_t row[AUVID_UNCERTAIN_ORDER], residual = uncertain_residual(u, j, band, i);
    auvid_real_t target = residual, scale = p->scale[band];
    for (int k = 0; k < e->order - 1; ++k) {
        row[k] = (k >= i ? r[k] : AUVID_C(0.0)) + p->slope[k] * residual;
        for (int d = 0; d < 2 && k < e->inputs; ++d) {
            int at = p->drag_at[d];
            row[k] -= at < e->order && at >= i ? p->drag[d][k] * r[at] : AUVID_C(0.0);
        }
        target += row[k] * p->value[k];
        row[k] *= scale;
    }
    row[e->order - 1] = scale * target;
    auvid_qr_update(p->factor, e->order, 0, row);
}

static void uncertain_add_own_prior(uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t row[AUVID_UNCERTAIN_ORDER] = {AUVID_C(0.0)};
    auvid_real_t sigma = auvid_uncertain_sigma(u, m, u->code[e->column_at + k], j);
    row[k] = AUVID_C(1.0) / auvid_max(sigma, AUVID_C(1e-6));
    auvid_qr_update(u->work.part.factor, e->order, k, row);
}

/* Keep the rows of the own inputs; eliminate these from the side. */
static void uncertain_keep_own(uncertain_t *u, const auvid_metric_t *m, int j)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t *factor = u->work.part.factor, *side = u->work.part.own_side;
    for (int i = 0; i < e->own; ++i) {
        const auvid_real_t *r = factor + auvid_qr_row(e->order, i) - i;
        auvid_real_t *to = u->work.own_rows[e->own_at + i];
        memcpy(to + i, r + i, (size_t)(e->order - i) * sizeof *r);
        side[i] = auvid_abs(r[i]) > AUVID_C(0.0) ? side[i] / r[i] : AUVID_C(0.0);
        for (int k = i + 1; k < e->order - 1; ++k) {
            auvid_real_t *from =
                k < e->own ? &side[k] : &u->work.side[j][uncertain_joint_column(u, m, j, k)];
            *from -= r[k] * side[i];
        }
    }
}

static void uncertain_transfer(uncertain_t *u, const auvid_metric_t *m, int j, int i)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t row[JOINT_ORDER] = {AUVID_C(0.0)};
    const auvid_real_t *r = u->work.part.factor + auvid_qr_row(e->order, i) - i;
    for (int k = i; k < e->order; ++k) {
        row[uncertain_joint_column(u, m, j, k)] = r[k];
    }
    auvid_qr_update(u->work.joint, JOINT_ORDER, 0, row);
}

/* ---- all DoF ---- */

static void uncertain_add_shared_prior(uncertain_t *u, const auvid_metric_t *m, int code)
{
    auvid_real_t row[JOINT_ORDER] = {AUVID_C(0.0)}, sigma = auvid_uncertain_sigma(u, m, code, 0);
    row[code] = AUVID_C(1.0) / auvid_max(sigma, AUVID_C(1e-6));
    auvid_qr_update(u->work.joint, JOINT_ORDER, code, row);
}

/* Solve for shared inputs and parameters, then for the own inputs of each DoF. */
static void uncertain_finish(uncertain_t *u, const auvid_metric_t *m)
{
    auvid_real_t x[JOINT_ORDER];
    for (int i = 0; i < JOINT_ORDER - 1; ++i) {
        x[i] = u->work.joint[auvid_qr_row(JOINT_ORDER, i) + JOINT_ORDER - 1 - i];
    }
    x[JOINT_ORDER - 1] = AUVID_C(-1.0);
    (void)auvid_qr_solve(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, AUVID_C(1e-6), x);
    if (!auvid_all_finite(x, JOINT_ORDER)) {
        return;
    }
    memcpy(u->shared, x, sizeof u->shared);
    memcpy(u->pi, x + PARAMETERS_AT, sizeof u->pi);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_uncertain_equation_t *e = &u->equation[j];
        for (int i = auvid_uncertain_has_rows(u, j) ? e->own - 1 : -1; i >= 0; --i) {
            const auvid_real_t *r = u->work.own_rows[e->own_at + i];
            auvid_real_t sum = AUVID_C(0.0);
            for (int k = i + 1; k < e->order; ++k) {
                sum += r[k] *
                       (k < e->own ? u->own[e->own_at + k] : x[uncertain_joint_column(u, m, j, k)]);
            }
            u->own[e->own_at + i] = auvid_abs(r[i]) > AUVID_C(0.0) ? -sum / r[i] : AUVID_C(0.0);
        }
    }
}

/* Count shared input k for the scale of the priors; set it after the last one. */
static void uncertain_scale(uncertain_t *u, const auvid_metric_t *m, int k)
{
    auvid_uncertain_solution_t *w = &u->work;
    auvid_real_t x[JOINT_ORDER] = {AUVID_C(0.0)}, variance = AUVID_C(0.0);
    auvid_real_t sigma = auvid_uncertain_sigma(u, m, k, 0);
    if (sigma > AUVID_C(0.0)) {
        auvid_real_t ratio = u->scale * u->shared[k] / sigma;
        x[k] = AUVID_C(1.0) / sigma;
        auvid_qr_solve_transposed(w->joint, JOINT_ORDER, JOINT_ORDER - 1, x);
        for (int i = k; i < JOINT_ORDER - 1; ++i) {
            variance += x[i] * x[i];
        }
        w->squares += ratio * ratio;
        w->known += AUVID_C(1.0) - auvid_min(variance, AUVID_C(1.0));
    }
    if (k == AUVID_UNCERTAIN_SHARED - 1) {
        auvid_real_t scale = auvid_sqrt((SEEN_RIGHT + w->squares) / (SEEN_RIGHT + w->known));
        u->scale = auvid_clamp(scale, AUVID_C(1.0) / LARGEST_SCALE, LARGEST_SCALE);
        w->squares = w->known = AUVID_C(0.0);
    }
}

static void uncertain_solve_side(uncertain_t *u, int j)
{
    auvid_qr_solve_transposed(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, u->work.side[j]);
    (void)auvid_qr_solve(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, AUVID_C(1e-6),
                         u->work.side[j]);
}

/* Row i of the covariance of the parameters, packed, where the DoF's factor was. */
static void uncertain_find_covariance(uncertain_t *u, const auvid_metric_t *m, int i)
{
    int n = m->cfg.vehicle->parameters;
    auvid_real_t x[JOINT_ORDER] = {AUVID_C(0.0)}, *row = u->work.part.factor + auvid_qr_row(n, i);
    x[PARAMETERS_AT + i] = AUVID_C(1.0);
    auvid_qr_solve_transposed(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, x);
    (void)auvid_qr_solve(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, AUVID_C(1e-6), x);
    for (int k = i; k < n; ++k) {
        auvid_real_t sides = AUVID_C(0.0);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            sides += u->work.side[j][PARAMETERS_AT + i] * u->work.side[j][PARAMETERS_AT + k];
        }
        row[k - i] = COVARIANCE_FACTOR * x[PARAMETERS_AT + k] + SIDE_VARIANCE * sides;
    }
}

/* ---- the steps ---- */

/* The next DoF with rows, from j on. */
static uint8_t uncertain_next_dof(const uncertain_t *u, int j)
{
    while (j < AUVID_DOF_COUNT && !auvid_uncertain_has_rows(u, j)) {
        ++j;
    }
    return (uint8_t)j;
}

void auvid_uncertain_begin(auvid_uncertain_t *u)
{
    if (u->estimate.number == 0) {
        memcpy(u->pi, u->id->estimate.pi, sizeof u->pi);
        auvid_clear(u->shared, AUVID_UNCERTAIN_SHARED);
        auvid_clear(u->own, AUVID_UNCERTAIN_OWN);
        u->scale = AUVID_C(1.0);
    }
    memset(&u->work, 0, sizeof u->work);
    u->work.solving = true;
    u->work.dof = uncertain_next_dof(u, 0);
}

bool auvid_uncertain_reads(const auvid_uncertain_t *u, int j)
{
    return u->work.solving && u->work.phase <= SOLVE_ROWS && u->work.dof == j;
}

/* Returns the cost of the present step [units]. */
static uint32_t uncertain_price(const uncertain_t *u)
{
    uint32_t order = u->work.dof < AUVID_DOF_COUNT ? u->equation[u->work.dof].order : JOINT_ORDER;
    switch (u->work.phase) {
    case SOLVE_PREPARE:
        return order * order / 8u;
    case SOLVE_TRANSFER:
    case SOLVE_FINISH:
    case SOLVE_SCALE:
    case SOLVE_SIDES:
    case SOLVE_SIGMA:
        return JOINT_ORDER * JOINT_ORDER / 50u;
    default:
        return order * order / 50u;
    }
}

/* Do one step. @return number of steps of the phase */
static uint32_t uncertain_step(uncertain_t *u, const auvid_metric_t *m)
{
    uint32_t i = u->work.row;
    int j = u->work.dof;
    const auvid_uncertain_equation_t *e = &u->equation[j < AUVID_DOF_COUNT ? j : 0];
    switch (u->work.phase) {
    case SOLVE_PREPARE:
        uncertain_prepare(u, m, j);
        return 1;
    case SOLVE_ROWS:
        uncertain_add_row(u, j, (int)i / e->order, (int)i % e->order);
        return 2u * e->order;
    case SOLVE_OWN:
        if (i < e->own) {
            uncertain_add_own_prior(u, m, j, (int)i);
        } else {
            uncertain_keep_own(u, m, j);
        }
        return e->own + 1u;
    case SOLVE_TRANSFER:
        uncertain_transfer(u, m, j, e->own + (int)i);
        return (uint32_t)(e->order - e->own);
    case SOLVE_SHARED:
        uncertain_add_shared_prior(u, m, (int)i);
        return AUVID_UNCERTAIN_SHARED;
    case SOLVE_FINISH:
        uncertain_finish(u, m);
        return 1;
    case SOLVE_SCALE:
        uncertain_scale(u, m, (int)i);
        return AUVID_UNCERTAIN_SHARED;
    case SOLVE_SIDES:
        uncertain_solve_side(u, (int)i);
        return AUVID_DOF_COUNT;
    default:
        uncertain_find_covariance(u, m, (int)i);
        return m->cfg.vehicle->parameters;
    }
}

/* Begin the next phase. */
static void uncertain_next_phase(uncertain_t *u)
{
    auvid_uncertain_solution_t *w = &u->work;
    w->row = 0;
    if (w->phase == SOLVE_TRANSFER) {
        w->dof = uncertain_next_dof(u, w->dof + 1);
        w->phase = w->dof < AUVID_DOF_COUNT ? SOLVE_PREPARE : SOLVE_SHARED;
    } else if (w->phase == SOLVE_SCALE && ++w->pass < SOLVE_PASSES) {
        auvid_clear(w->joint, sizeof w->joint / sizeof w->joint[0]);
        w->dof = uncertain_next_dof(u, 0);
        w->phase = SOLVE_PREPARE;
    } else {
        ++w->phase;
    }
}

auvid_status_t auvid_uncertain_solve(auvid_uncertain_t *u, const auvid_metric_t *m,
                                     uint32_t *budget)
{
    while (u->work.phase != SOLVE_DONE && *budget > 0) {
        --*budget;
        if (++u->work.spent < uncertain_price(u)) {
            continue;
        }
        u->work.spent = 0;
        uint32_t steps = uncertain_step(u, m);
        if (++u->work.row >= steps) {
            uncertain_next_phase(u);
        }
    }
    return u->work.phase == SOLVE_DONE ? AUVID_OK : AUVID_PENDING;
}
