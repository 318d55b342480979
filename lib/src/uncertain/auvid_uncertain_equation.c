/*
 * Uncertain inputs: the equation of one DoF, from its R factors of both bands to one with changed
 * columns. The equations are in auvid_uncertain_solve.c.
 */
#include <string.h>

#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"

#define PROJECTED_NOISE AUVID_C(1.4)     /* of projected rows: disturbances are slow */
#define LARGEST_BAND_RATIO AUVID_C(30.0) /* of the residuals of the bands */
#define IN_ACCELERATION AUVID_C(0.7)     /* of h, see auvid_uncertain_solve.c */
#define IN_VELOCITY AUVID_C(0.5)         /* of 1 - h, of a force */
/* Parts of the supplied thrust that are delivered: gamma is 1 from the first to all of it, if the
 * rows are few, and constant below the second. */
#define FULL_THRUST AUVID_C(0.9)
#define LEAST_THRUST AUVID_C(0.5)
/* Squares of the residual over the noise that say where it belongs: as of four minutes. */
#define MOST_SQUARES AUVID_C(150.0)
/* Rows that count: those of four minutes. See auvid_uncertain_solve.c. */
#define MOST_ROWS AUVID_C(480.0)
/* Largest error of the thrust: its square, as a part of that of the thrust. */
#define LARGEST_THRUST_ERROR AUVID_C(0.25)
#define EARLY_ROW AUVID_C(0.0625)   /* weight of a row from before the first solution */
#define SMALL_CURRENT AUVID_C(0.03) /* [m/s]; a row from before the second one counts half */

typedef auvid_uncertain_t uncertain_t;

int auvid_uncertain_joint_column(const uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    if (k == e->order - 1) {
        return JOINT_ORDER - 1;
    }
    return k < e->inputs ? u->code[e->channel_at + k]
                         : PARAMETERS_AT + auvid_metric_row_parameters(m, j)[k - e->inputs];
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

static const auvid_real_t uncertain_both[AUVID_METRIC_BANDS] = {AUVID_C(1.0), AUVID_C(1.0)};

auvid_real_t auvid_uncertain_product(const uncertain_t *u, int j, int k, int l)
{
    return uncertain_product(u, j, k, l, uncertain_both);
}

/* Find the columns of DoF j's linear and quadratic drag. */
static void uncertain_find_drag(uncertain_t *u, const auvid_metric_t *m, int j)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_row_parameters(m, j);
    u->work.part.drag_at[0] = u->work.part.drag_at[1] = e->order;
    for (int k = e->inputs; k < e->order - 1; ++k) {
        const auvid_parameter_t *parameter = &m->cfg.vehicle->parameter[index[k - e->inputs]];
        bool linear = parameter->kind == AUVID_PARAMETER_LINEAR_DRAG;
        if ((int)parameter->dof == j &&
            (linear || parameter->kind == AUVID_PARAMETER_QUADRATIC_DRAG)) {
            u->work.part.drag_at[!linear] = (uint8_t)k;
        }
    }
}

/* Where the product of drag d with an own input k, or with drag, of forgotten rows is. */
static auvid_real_t *uncertain_forgotten(uncertain_t *u, int j, int d, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    int drag = AUVID_UNCERTAIN_OWN + 2 * j + (k == u->work.part.drag_at[1]);
    return &u->forgotten[d][k < e->own ? e->own_at + k : drag];
}

/* Product of drag d with an own input k, or with drag, over all rows. */
static auvid_real_t uncertain_drag_product(uncertain_t *u, int j, int d, int k)
{
    return auvid_uncertain_product(u, j, u->work.part.drag_at[d], k) +
           *uncertain_forgotten(u, j, d, k);
}

/* Products of linear and quadratic drag. */
typedef struct {
    auvid_real_t ll, qq, lq;
} uncertain_drags_t;

static uncertain_drags_t uncertain_drags(uncertain_t *u, int j)
{
    int l = u->work.part.drag_at[0], q = u->work.part.drag_at[1], none = u->equation[j].order;
    return (uncertain_drags_t){
        l == none ? AUVID_C(1.0) : uncertain_drag_product(u, j, 0, l),
        q == none ? AUVID_C(1.0) : uncertain_drag_product(u, j, 1, q),
        l == none || q == none ? AUVID_C(0.0) : uncertain_drag_product(u, j, 0, q)};
}

/* Parts of column k that are linear and quadratic drag. */
static void uncertain_project(uncertain_t *u, int j, int k, const uncertain_drags_t *drags)
{
    auvid_uncertain_part_t *p = &u->work.part;
    int l = p->drag_at[0], q = p->drag_at[1], none = u->equation[j].order;
    auvid_real_t ll = drags->ll, qq = drags->qq, lq = drags->lq;
    auvid_real_t lk = l == none ? AUVID_C(0.0) : uncertain_drag_product(u, j, 0, k);
    auvid_real_t qk = q == none ? AUVID_C(0.0) : uncertain_drag_product(u, j, 1, k);
    auvid_real_t determinant = ll * qq - lq * lq;
    if (determinant > AUVID_C(1e-4) * ll * qq) {
        p->drag[0][k] = (lk * qq - qk * lq) / determinant;
        p->drag[1][k] = (qk * ll - lk * lq) / determinant;
    }
}

void auvid_uncertain_drag_parts(uncertain_t *u, const auvid_metric_t *m, int j, int k,
                                auvid_real_t part[2])
{
    uncertain_find_drag(u, m, j);
    const uncertain_drags_t drags = uncertain_drags(u, j);
    for (int d = 0; d < 2; ++d) {
        u->work.part.drag[d][k] = AUVID_C(0.0);
    }
    uncertain_project(u, j, k, &drags);
    for (int d = 0; d < 2; ++d) {
        part[d] = u->work.part.drag[d][k];
    }
}

/* Coefficients of the columns in the residual. */
static void uncertain_prepare_values(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_row_parameters(m, j);
    const uncertain_drags_t drags = uncertain_drags(u, j);
    for (int k = 0; k < e->order; ++k) {
        p->value[k] = k < e->own         ? u->own[e->own_at + k]
                      : k < e->inputs    ? u->shared[u->code[e->channel_at + k]]
                      : k < e->order - 1 ? u->pi[index[k - e->inputs]]
                                         : AUVID_C(-1.0);
        p->residual[k] = -p->value[k];
    }
    p->sag_at = e->order;
    for (int k = 0; k < e->inputs; ++k) {
        if (u->code[e->channel_at + k] == AUVID_UNCERTAIN_SAG) {
            p->sag_at = (uint8_t)k;
            p->residual[e->order - 1] += u->work.sag_from * p->value[k];
        }
        if (!auvid_uncertain_of_hull(m, u->code[e->channel_at + k])) {
            continue;
        }
        uncertain_project(u, j, k, &drags);
        for (int d = 0; d < 2; ++d) {
            if (p->drag_at[d] < e->order) {
                p->residual[p->drag_at[d]] += p->drag[d][k] * p->value[k];
            }
        }
    }
}

/* Row i of one band. */
static const auvid_real_t *uncertain_row(const uncertain_t *u, int j, int band, int i)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    return u->factor[band] + e->factor_at + auvid_qr_row(e->order, i) - i;
}

/* Residual of a row that is zero before column `first`, at the last pass. */
static auvid_real_t uncertain_residual(const uncertain_t *u, int j, const auvid_real_t *r,
                                       int first)
{
    auvid_real_t sum = AUVID_C(0.0);
    for (int k = first; k < u->equation[j].order; ++k) {
        sum += r[k] * u->work.part.residual[k];
    }
    return sum;
}

/* Set the weight of the projected rows. Where they disagree among themselves by more than the noise
 * of the whole rows, the model is wrong, and they are less certain (Sargan 1958). */
static void uncertain_weigh_projected(uncertain_t *u, const auvid_metric_t *m, int j,
                                      auvid_real_t noise)
{
    auvid_uncertain_part_t *p = &u->work.part;
    int count = u->instruments->of[j].count, free = count - auvid_metric_equation(m, j).count;
    auvid_real_t squares = AUVID_C(0.0);
    for (int i = 0; i < count; ++i) {
        auvid_real_t e = uncertain_residual(u, j, auvid_instruments_row(u->instruments, j, i), 0);
        squares += e * e;
    }
    auvid_real_t expected = PROJECTED_NOISE * noise * noise;
    auvid_real_t variance = auvid_max(expected, squares / (auvid_real_t)free);
    p->scale[0] = AUVID_C(1.0) / auvid_sqrt(variance);
    p->squares = squares / variance;
}

/* Write which part of the supplied thrust each column of the thrust is; zz: its square. Returns
 * gamma, from the part that is delivered by the last pass. */
static auvid_real_t uncertain_gamma(const uncertain_t *u, int j, auvid_real_t zz,
                                    const auvid_real_t weight[AUVID_METRIC_BANDS],
                                    auvid_real_t *part)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t delivered = AUVID_C(1.0);
    for (int k = 0; k < e->inputs; ++k) {
        part[k] = AUVID_C(0.0);
        if (auvid_uncertain_of_thrust(u->code[e->channel_at + k])) {
            part[k] = zz > AUVID_C(0.0) ? uncertain_product(u, j, k, e->order - 1, weight) / zz
                                        : AUVID_C(0.0);
            part[k] -= k == u->work.part.sag_at ? u->work.sag_from : AUVID_C(0.0);
            delivered -= part[k] * u->work.part.value[k];
        }
    }
    if (delivered > AUVID_C(1.0)) {
        return delivered;
    }
    delivered = auvid_max(delivered, LEAST_THRUST);
    auvid_real_t full = auvid_min(delivered, FULL_THRUST) / FULL_THRUST;
    auvid_real_t counts = auvid_min(MOST_SQUARES / u->work.part.squares, AUVID_C(1.0));
    return delivered / (AUVID_C(1.0) - counts * (AUVID_C(1.0) - delivered / full));
}

/* Shares of the residual: in the acceleration, and in the velocity; what that one adds to the
 * columns of linear and quadratic drag, per unit of the residual. */
typedef struct {
    auvid_real_t accelerates, moves, drag[2];
} uncertain_shares_t;

/* Returns the shares of DoF j's residual with these squares in the bands; see
 * auvid_uncertain_solve.c. */
static uncertain_shares_t uncertain_find_shares(const uncertain_t *u, const auvid_metric_t *m,
                                                int j, auvid_real_t mass,
                                                const auvid_real_t squares[AUVID_METRIC_BANDS])
{
    const auvid_uncertain_part_t *p = &u->work.part;
    int l = p->drag_at[0], q = p->drag_at[1], none = u->equation[j].order;
    auvid_real_t speed = AUVID_C(0.0), drag = AUVID_C(0.0);
    uncertain_shares_t shares = {.moves = AUVID_C(0.0)};
    if (u->work.strong != 0) {
        return shares;
    }
    if (q != none) {
        speed = auvid_sqrt(auvid_sqrt(auvid_uncertain_product(u, j, q, q) / u->rows[j]));
    }
    if (l != none) {
        speed = auvid_sqrt(auvid_uncertain_product(u, j, l, l) / u->rows[j]);
        drag = p->value[l];
    }
    drag += q != none ? AUVID_C(2.0) * speed * p->value[q] : AUVID_C(0.0);
    auvid_real_t pair_s = AUVID_C(1e-6) * (auvid_real_t)auvid_metric_cell_us(m) *
                          (auvid_real_t)(m->cfg.row_cells * m->cfg.lag[j >= AUVID_ROLL]);
    auvid_real_t rate = AUVID_C(2.0) * squares[1] * mass;
    auvid_real_t all = rate + pair_s * squares[0] * auvid_abs(drag);
    bool known = mass > AUVID_C(0.0) && all > AUVID_C(0.0);
    auvid_real_t h = known ? auvid_sqrt(rate / all) : AUVID_C(1.0);
    shares.accelerates = IN_ACCELERATION * h;
    if (j < AUVID_ROLL && drag < AUVID_C(0.0)) {
        shares.moves = IN_VELOCITY * (AUVID_C(1.0) - h);
        shares.drag[0] = shares.moves / drag;
        shares.drag[1] = AUVID_C(2.0) * speed * shares.drag[0];
    }
    return shares;
}

/* What is left of the shares is an error of the thrust: at most this part of the residual. */
static void uncertain_limit_error(uncertain_shares_t *shares, auvid_real_t most)
{
    auvid_real_t motion = shares->accelerates + shares->moves;
    if (motion > AUVID_C(0.0) && AUVID_C(1.0) - motion > most) {
        auvid_real_t factor = (AUVID_C(1.0) - most) / motion;
        shares->accelerates *= factor;
        shares->moves *= factor;
        shares->drag[0] *= factor;
        shares->drag[1] *= factor;
    }
}

/* What the residual, with these squares in the bands, adds to each column, and the same for the
 * joint solution (side). */
static void uncertain_prepare_slopes(uncertain_t *u, const auvid_metric_t *m, int j,
                                     const auvid_real_t squares[AUVID_METRIC_BANDS],
                                     const auvid_real_t weight[AUVID_METRIC_BANDS])
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_row_parameters(m, j);
    auvid_real_t a[AUVID_MAX_PARAMETERS], mass = AUVID_C(0.0);
    auvid_real_t zz = uncertain_product(u, j, e->order - 1, e->order - 1, weight);
    auvid_real_t ee = weight[0] * squares[0] + weight[1] * squares[1];
    auvid_real_t most = auvid_metric_is_excited(m, j) ? LARGEST_THRUST_ERROR * zz : AUVID_C(0.0);
    auvid_real_t gamma = uncertain_gamma(u, j, zz, weight, p->slope);
    auvid_confidence_acceleration_row(m->cfg.vehicle, j, &p->regressor, a);
    auvid_zero(&p->regressor, sizeof p->regressor); /* the factor is there from now on */
    for (int k = 0; k < e->order - 1 - e->inputs; ++k) {
        mass += a[index[k]] * u->pi[index[k]];
        bool is_mass = auvid_abs(a[index[k]]) > AUVID_C(0.5); /* not one of coupling */
        p->mass_at = is_mass ? (uint8_t)(e->inputs + k) : p->mass_at;
    }
    uncertain_shares_t shares = uncertain_find_shares(u, m, j, mass, squares);
    uncertain_limit_error(&shares, ee > most ? most / ee : AUVID_C(1.0));
    auvid_real_t rest = AUVID_C(1.0) - shares.accelerates - shares.moves;
    auvid_clear(u->work.side[j], JOINT_ORDER);
    for (int k = 0; k < e->order - 1; ++k) {
        auvid_real_t side = AUVID_C(0.0);
        if (k >= e->inputs) {
            side = mass > AUVID_C(0.0) ? a[index[k - e->inputs]] / mass : AUVID_C(0.0);
            p->slope[k] = shares.accelerates * side;
        } else {
            int class = auvid_uncertain_row(u->code[e->channel_at + k])->class;
            side = class == AUVID_CAUSE_INFLOW ? AUVID_C(0.0) : p->slope[k] / gamma;
            p->slope[k] = -rest * side;
        }
        side *= auvid_min(p->squares, MOST_SQUARES);
        if (k < e->own) {
            p->own_side[k] = side;
        } else {
            u->work.side[j][auvid_uncertain_joint_column(u, m, j, k)] = side;
        }
    }
    for (int d = 0; d < 2; ++d) {
        if (p->drag_at[d] < e->order) {
            p->slope[p->drag_at[d]] += shares.drag[d];
        }
    }
}

/* Weights of the bands from their residuals' sums of squares. Let the residual be a first-order
 * autoregression e_k = rho e_(k-1) + white noise. With s and d half the sum and half the difference
 * of the two rows of a pair, the sum of squared innovations is, but for the ends,
 *
 *     sum (e_k - rho e_(k-1))^2 = sum (1 - rho)^2 s^2 + (1 + rho)^2 d^2,
 *
 * and sum s^2 / sum d^2 = (1 + rho) / (1 - rho). So the weights are as the squares of the other
 * band's residual: generalised least squares (Cochrane and Orcutt 1949). The metric's own weights
 * are as their first powers. Its residual contains the errors of the inputs, which are no noise. */
static void uncertain_weigh_bands(const auvid_real_t squares[AUVID_METRIC_BANDS],
                                  auvid_real_t weight[AUVID_METRIC_BANDS])
{
    bool known = squares[0] > AUVID_C(0.0) && squares[1] > AUVID_C(0.0);
    weight[0] = known ? auvid_clamp(squares[1] / squares[0], AUVID_C(1.0) / LARGEST_BAND_RATIO,
                                    LARGEST_BAND_RATIO)
                      : AUVID_C(1.0);
    weight[1] = AUVID_C(1.0) / weight[0];
}

/* Let DoF j's rows count as this many. */
static void uncertain_reweigh_rows(uncertain_t *u, int j, auvid_real_t rows)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t root = auvid_sqrt(rows / u->rows[j]);
    for (int k = 0; k < 2 * AUVID_QR_FACTOR(e->order); ++k) {
        u->factor[k % 2][e->factor_at + k / 2] *= root;
    }
    u->rows[j] = rows;
}

/* Keep this part of the products of DoF j's forgotten rows, and add one of those of the others. */
static void uncertain_change_forgotten(uncertain_t *u, int j, auvid_real_t keep, auvid_real_t add)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    for (int k = 0; k < e->own + 2; ++k) {
        int column = k < e->own ? k : u->work.part.drag_at[k - e->own];
        for (int d = 0; d < 2 && column < e->order; ++d) {
            int drag = u->work.part.drag_at[d];
            auvid_real_t *product = uncertain_forgotten(u, j, d, column);
            *product *= keep;
            if (add > AUVID_C(0.0) && drag < e->order) {
                *product += add * auvid_uncertain_product(u, j, drag, column);
            }
        }
    }
}

/* The rows hold about as much as the ring, but enough for a solution: older ones are forgotten. */
static void uncertain_forget(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_real_t full = auvid_max((auvid_real_t)m->cfg.sets * (auvid_real_t)m->cfg.set_rows,
                                  AUVID_UNCERTAIN_LEAST_ROWS);
    auvid_real_t keep = full / u->rows[j];
    if (keep < AUVID_C(1.0)) {
        uncertain_change_forgotten(u, j, keep, AUVID_C(0.0));
        uncertain_reweigh_rows(u, j, full);
    }
}

/* The columns of current, lever arm and late DVL are formed with the last estimate. Without one
 * they are zero, and drag takes what these inputs do: with a current of 0.1 m/s, one such set of
 * eight makes Y_v 33 % too large. The second set knows the vehicle, but no current, and its rows
 * lack the square of this. The rows do not vanish, as other DoF may be excited later; and what drag
 * takes of the hull's inputs is to be that of the whole motion. */
void auvid_uncertain_forget_early(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_real_t keep = EARLY_ROW;
    if (u->informed > 0) {
        auvid_real_t x = u->shared[AUVID_UNCERTAIN_CURRENT_X] / SMALL_CURRENT;
        auvid_real_t y = u->shared[AUVID_UNCERTAIN_CURRENT_Y] / SMALL_CURRENT;
        keep = auvid_max(keep, AUVID_C(1.0) / (AUVID_C(1.0) + x * x + y * y));
    }
    uncertain_find_drag(u, m, j);
    uncertain_change_forgotten(u, j, AUVID_C(1.0), AUVID_C(1.0) - keep);
    uncertain_reweigh_rows(u, j, keep * u->rows[j]);
}

/* Let DoF j's rows count as those of four minutes at most. */
static void uncertain_limit_rows(uncertain_t *u, int j)
{
    auvid_uncertain_part_t *p = &u->work.part;
    auvid_real_t part = auvid_min(MOST_ROWS / u->rows[j], AUVID_C(1.0)), root = auvid_sqrt(part);
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        p->scale[band] *= root;
    }
    p->squares *= part;
}

void auvid_uncertain_prepare(uncertain_t *u, const auvid_metric_t *m, int j)
{
    auvid_uncertain_part_t *p = &u->work.part;
    auvid_real_t squares[AUVID_METRIC_BANDS] = {AUVID_C(0.0)}, weight[AUVID_METRIC_BANDS];
    auvid_zero(p, sizeof *p);
    uncertain_find_drag(u, m, j);
    if (u->work.pass == 0) {
        uncertain_forget(u, m, j);
    }
    uncertain_prepare_values(u, m, j);
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        for (int i = 0; i < u->equation[j].order; ++i) {
            auvid_real_t e = uncertain_residual(u, j, uncertain_row(u, j, band, i), i);
            squares[band] += e * e;
        }
    }
    uncertain_weigh_bands(squares, weight);
    auvid_real_t noise = auvid_sqrt(AUVID_CONFIDENCE_SMOOTHED *
                                    (weight[0] * squares[0] + weight[1] * squares[1]) / u->rows[j]);
    auvid_real_t least = AUVID_C(1e-5) * m->cfg.tau_max[j];
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        p->scale[band] = auvid_sqrt(weight[band]) / auvid_max(noise, least);
    }
    p->squares = u->rows[j] / AUVID_CONFIDENCE_SMOOTHED;
    if (u->work.strong != 0) {
        auvid_real_t mean = (squares[0] + squares[1]) / u->rows[j];
        uncertain_weigh_projected(u, m, j,
                                  auvid_max(auvid_sqrt(AUVID_CONFIDENCE_SMOOTHED * mean), least));
    } else {
        uncertain_limit_rows(u, j);
    }
    uncertain_prepare_slopes(u, m, j, squares, weight);
}

void auvid_uncertain_add_row(uncertain_t *u, int j, int band, int i)
{
    auvid_uncertain_part_t *p = &u->work.part;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    bool projected = u->work.strong != 0;
    const auvid_real_t *r =
        projected ? auvid_instruments_row(u->instruments, j, i) : uncertain_row(u, j, band, i);
    int first = projected ? 0 : i;
    auvid_real_t row[AUVID_UNCERTAIN_ORDER], residual = uncertain_residual(u, j, r, first);
    auvid_real_t target = residual, scale = p->scale[band];
    for (int k = 0; k < e->order - 1; ++k) {
        row[k] = (k >= first ? r[k] : AUVID_C(0.0)) + p->slope[k] * residual;
        row[k] -= k == p->sag_at ? u->work.sag_from * r[e->order - 1] : AUVID_C(0.0);
        for (int d = 0; d < 2 && k < e->inputs; ++d) {
            int at = p->drag_at[d];
            row[k] -= at < e->order && at >= first ? p->drag[d][k] * r[at] : AUVID_C(0.0);
        }
        target += row[k] * p->value[k];
        row[k] *= scale;
    }
    row[e->order - 1] = scale * target;
    auvid_qr_update(p->factor, e->order, 0, row);
}

void auvid_uncertain_add_own_prior(uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t row[AUVID_UNCERTAIN_ORDER];
    auvid_real_t sigma = auvid_uncertain_sigma(u, m, u->code[e->channel_at + k], j);
    auvid_clear(row, AUVID_UNCERTAIN_ORDER);
    row[k] = AUVID_C(1.0) / auvid_max(sigma, AUVID_C(1e-6));
    auvid_qr_update(u->work.part.factor, e->order, k, row);
}

int auvid_uncertain_eliminated(const auvid_uncertain_t *u, int j)
{
    return auvid_uncertain_tilts(j) ? u->equation[j].inputs : u->equation[j].own;
}

/* Does column k of DoF j, with this value, make a force that would excite the DoF? Noise of a rate
 * makes every column of coupling differ from zero. */
static bool uncertain_acts(const uncertain_t *u, const auvid_metric_t *m, int j, int k,
                           auvid_real_t value)
{
    auvid_real_t least = m->cfg.excitation_threshold * m->cfg.tau_max[j];
    return value * value * auvid_uncertain_product(u, j, k, k) > least * least * u->rows[j];
}

bool auvid_uncertain_is_left_out(const uncertain_t *u, const auvid_metric_t *m, int j)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint8_t *index = auvid_metric_row_parameters(m, j);
    const auvid_real_t *pi = u->id->work.candidate; /* the passes change u->pi */
    bool own = false, known = false;
    if (auvid_metric_is_excited(m, j)) {
        return false;
    }
    for (int k = e->inputs; k < e->order - 1; ++k, ++index) {
        const auvid_parameter_t *parameter = &m->cfg.vehicle->parameter[*index];
        bool other = (int)parameter->dof != j;
        own |= !other;
        known |= other && parameter->kind == AUVID_PARAMETER_MASS &&
                 uncertain_acts(u, m, j, k, pi[*index]);
    }
    known |= (u->fixes >> j & 1u) != 0 && uncertain_acts(u, m, j, e->order - 1, AUVID_C(1.0));
    return auvid_uncertain_tilts(j) || !own || !known;
}

/* Is column k of a parameter of roll or pitch in another equation, or the other way round, or of an
 * equation that is not solved? Its value is that of the last pass, or its ratio to the mass. */
static bool uncertain_is_known(const uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    if (k < e->inputs || k == e->order - 1) {
        return false;
    }
    int parameter = auvid_metric_row_parameters(m, j)[k - e->inputs];
    int of = (int)m->cfg.vehicle->parameter[parameter].dof;
    return auvid_uncertain_tilts(j) != auvid_uncertain_tilts(of) ||
           (of != j && auvid_uncertain_is_left_out(u, m, of));
}

/* The side of column k. */
static auvid_real_t *uncertain_side(uncertain_t *u, const auvid_metric_t *m, int j, int k)
{
    return k < u->equation[j].own ? &u->work.part.own_side[k]
                                  : &u->work.side[j][auvid_uncertain_joint_column(u, m, j, k)];
}

void auvid_uncertain_keep_own(uncertain_t *u, const auvid_metric_t *m, int j)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t *factor = u->work.part.factor;
    memcpy(u->work.own_rows + e->own_rows_at, factor,
           (size_t)auvid_qr_row(e->order, e->own) * sizeof *factor);
    for (int i = 0; i < e->order - 1; ++i) {
        auvid_real_t *side = uncertain_side(u, m, j, i);
        if (i < auvid_uncertain_eliminated(u, j)) {
            const auvid_real_t *r = factor + auvid_qr_row(e->order, i) - i;
            auvid_real_t part = auvid_abs(r[i]) > AUVID_C(0.0) ? *side / r[i] : AUVID_C(0.0);
            for (int k = i + 1; k < e->order - 1; ++k) {
                *uncertain_side(u, m, j, k) -= r[k] * part;
            }
            *side = AUVID_C(0.0);
        } else if (uncertain_is_known(u, m, j, i)) {
            *side = AUVID_C(0.0);
        }
    }
}

void auvid_uncertain_transfer(uncertain_t *u, const auvid_metric_t *m, int j, int i)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    auvid_real_t row[JOINT_ORDER];
    const auvid_real_t *r = u->work.part.factor + auvid_qr_row(e->order, i) - i;
    const auvid_uncertain_part_t *p = &u->work.part;
    int mass_at = auvid_uncertain_joint_column(u, m, j, p->mass_at);
    auvid_real_t mass = p->mass_at >= e->inputs ? p->value[p->mass_at] : AUVID_C(0.0);
    auvid_clear(row, JOINT_ORDER);
    for (int k = i; k < e->order; ++k) {
        int column = auvid_uncertain_joint_column(u, m, j, k);
        if (uncertain_is_known(u, m, j, k)) {
            auvid_real_t known = r[k] * u->pi[column - PARAMETERS_AT];
            if (auvid_uncertain_tilts(j) || !(mass > AUVID_C(0.0))) {
                row[JOINT_ORDER - 1] -= known;
            } else {
                row[mass_at] += known / mass;
            }
        } else {
            row[column] += r[k];
        }
    }
    auvid_qr_update(u->work.joint, JOINT_ORDER, 0, row);
}
