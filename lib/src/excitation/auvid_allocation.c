/*
 * Thruster allocation (Fossen 2011, 12.3; Karras et al. 2013, III-A).
 *
 *   tau = T f        wrench of the forces; B: the controlled rows of T, r its rank
 *   f   = B+ tau     the solution of minimum |f|
 * B+ comes from a complete orthogonal decomposition by Gram-Schmidt. Each vector is orthogonalised
 * twice ("twice is enough"), which makes it as accurate as Householder's method:
 *   B = L Q,  L = U S    Q (r x n): orthonormal rows, chosen with pivoting; L = B Q' (6 x r);
 *                        U (6 x r): orthonormal columns; S (r x r): upper triangular
 *   B+ = Q' S^-1 U'
 * U U' projects onto the wrenches that the thrusters can produce: e_i is one iff (U U')_ii = 1.
 */
#include "auvid_excitation_init_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

#define DOFS AUVID_DOF_COUNT

/* A row of T is dependent if its component outside the span of the others, relative to its length,
 * is below this; and zero if its length is, relative to the longest row of forces or moments: the
 * cosine of a right angle is not zero. Also the tolerance of (U U')_ii from 1. T is measured with a
 * tape: 0.1 %. */
#define DEPENDENT AUVID_C(1e-3)
#define LARGEST_ENTRY AUVID_C(1e6)
#define SHORTEST_ROW AUVID_C(1e-6) /* of T, of forces or moments: below it T+ is out of range */
#define LARGEST_WRENCH AUVID_C(1e9)

#if AUVID_MAX_THRUSTERS >= 5
#define GIRONA500_N AUVID_C(153.8)
#define GIRONA500(...)                                                                             \
    {                                                                                              \
        .wrench = {__VA_ARGS__}, .min_N = -GIRONA500_N, .max_N = GIRONA500_N,                      \
        .law = AUVID_THRUST_SQUARE, .gain_forward = GIRONA500_N, .gain_backward = GIRONA500_N      \
    }
const auvid_allocation_config_t auvid_allocation_girona500 = {
    .thruster = {GIRONA500(AUVID_C(-1.0), 0, 0, 0, 0, AUVID_C(-0.4)),
                 GIRONA500(AUVID_C(-1.0), 0, 0, 0, 0, AUVID_C(0.4)),
                 GIRONA500(0, 0, AUVID_C(-1.0), 0, AUVID_C(-0.35), 0),
                 GIRONA500(0, 0, AUVID_C(-1.0), 0, AUVID_C(0.35), 0),
                 GIRONA500(0, AUVID_C(1.0), 0, 0, 0, 0)},
    .thrusters = 5,
    .dofs = 0,
    .priority = 1u << AUVID_YAW};
#endif

#if AUVID_MAX_THRUSTERS >= 8
#define T200(...)                                                                                  \
    {                                                                                              \
        .wrench = {__VA_ARGS__}, .min_N = AUVID_C(-40.2), .max_N = AUVID_C(51.5),                  \
        .law = AUVID_THRUST_SQUARE, .gain_forward = AUVID_C(51.5), .gain_backward = AUVID_C(40.2)  \
    }
/* r x e of a direction e at the position r: (y e_z - z e_y, z e_x - x e_z, x e_y - y e_x). */
#define HALF AUVID_C(0.70710678)  /* cos 45 degrees */
#define TILT AUVID_C(0.060104076) /* 0.085 of it */
#define TURN AUVID_C(0.18879751)  /* 0.156 + 0.111 of it */
#define AHEAD AUVID_C(0.120)
#define ASIDE AUVID_C(0.218)
const auvid_allocation_config_t auvid_allocation_bluerov2_heavy = {
    .thruster = {T200(HALF, -HALF, 0, TILT, TILT, -TURN), T200(HALF, HALF, 0, -TILT, TILT, TURN),
                 T200(-HALF, -HALF, 0, TILT, -TILT, TURN),
                 T200(-HALF, HALF, 0, -TILT, -TILT, -TURN),
                 T200(0, 0, AUVID_C(-1.0), -ASIDE, AHEAD, 0),
                 T200(0, 0, AUVID_C(1.0), -ASIDE, -AHEAD, 0),
                 T200(0, 0, AUVID_C(1.0), ASIDE, AHEAD, 0),
                 T200(0, 0, AUVID_C(-1.0), ASIDE, -AHEAD, 0)},
    .thrusters = 8,
    .dofs = 0,
    .priority = 1u << AUVID_YAW};
#endif

/* ---- pseudo-inverse ---- */

typedef struct {
    const auvid_allocation_config_t *cfg;
    auvid_real_t q[DOFS][AUVID_MAX_THRUSTERS]; /* rows, orthonormal */
    auvid_real_t u[DOFS][DOFS];                /* rows of this: columns of U */
    auvid_real_t s[DOFS][DOFS];                /* S[i][j], j >= i */
    int rank;
} decomposition_t;

static auvid_real_t allocation_dot(const auvid_real_t *a, const auvid_real_t *b, int n)
{
    auvid_real_t sum = AUVID_C(0.0);
    for (int i = 0; i < n; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Compute row i of B: zero for a thruster that does not work or a row that is not controlled. */
static void allocation_row(const auvid_allocation_config_t *cfg, int i, auvid_real_t *row)
{
    bool controlled = cfg->dofs == 0 || (cfg->dofs & AUVID_DOF_BIT(i)) != 0;
    for (int j = 0; j < cfg->thrusters; ++j) {
        const auvid_thruster_t *t = &cfg->thruster[j];
        bool works = t->min_N < AUVID_C(0.0) || t->max_N > AUVID_C(0.0);
        row[j] = works && controlled ? t->wrench[i] : AUVID_C(0.0);
    }
}

/* Subtract from v its components along `count` orthonormal vectors (`stride` apart), twice; add
 * them to along[] unless it is NULL. */
static void allocation_orthogonalise(auvid_real_t *v, const auvid_real_t *basis, int stride,
                                     int count, int n, auvid_real_t along[DOFS])
{
    for (int pass = 0; pass < 2; ++pass) {
        for (int k = 0; k < count; ++k) {
            const auvid_real_t *b = basis + k * stride;
            auvid_real_t c = allocation_dot(v, b, n);
            for (int j = 0; j < n; ++j) {
                v[j] -= c * b[j];
            }
            if (along != NULL) {
                along[k] += c;
            }
        }
    }
}

/* Compute the shortest length of a row that counts: for forces, and for moments. */
static void allocation_shortest_rows(const auvid_allocation_config_t *cfg, auvid_real_t shortest[2])
{
    auvid_real_t row[AUVID_MAX_THRUSTERS];
    shortest[0] = shortest[1] = AUVID_C(0.0);
    for (int i = 0; i < DOFS; ++i) {
        auvid_real_t *longest = &shortest[i >= AUVID_ROLL];
        allocation_row(cfg, i, row);
        *longest = auvid_max(*longest, auvid_sqrt(allocation_dot(row, row, cfg->thrusters)));
    }
    shortest[0] = auvid_max(shortest[0] * DEPENDENT, SHORTEST_ROW);
    shortest[1] = auvid_max(shortest[1] * DEPENDENT, SHORTEST_ROW);
}

/* Compute orthonormal rows Q that span the rows of B. Pivoting takes the row with the largest
 * component outside the span, relative to its length, since rows have different units. */
static void allocation_span_rows(decomposition_t *d)
{
    int n = d->cfg->thrusters;
    auvid_real_t shortest[2];
    allocation_shortest_rows(d->cfg, shortest);
    d->rank = 0;
    while (d->rank < DOFS) {
        auvid_real_t best = DEPENDENT;
        auvid_real_t row[AUVID_MAX_THRUSTERS];
        for (int i = 0; i < DOFS; ++i) {
            allocation_row(d->cfg, i, row);
            auvid_real_t length = auvid_sqrt(allocation_dot(row, row, n));
            allocation_orthogonalise(row, &d->q[0][0], AUVID_MAX_THRUSTERS, d->rank, n, NULL);
            auvid_real_t left = auvid_sqrt(allocation_dot(row, row, n));
            if (length > shortest[i >= AUVID_ROLL] && left > best * length) {
                best = left / length;
                for (int j = 0; j < n; ++j) {
                    d->q[d->rank][j] = row[j] / left;
                }
            }
        }
        if (!(best > DEPENDENT)) {
            return;
        }
        ++d->rank;
    }
}

/* Compute L = B Q' column by column, and factor L = U S. */
static void allocation_orthogonalise_columns(decomposition_t *d)
{
    int n = d->cfg->thrusters;
    memset(d->s, 0, sizeof d->s);
    for (int k = 0; k < d->rank; ++k) {
        auvid_real_t along[DOFS] = {0}, row[AUVID_MAX_THRUSTERS];
        for (int i = 0; i < DOFS; ++i) {
            allocation_row(d->cfg, i, row);
            d->u[k][i] = allocation_dot(row, d->q[k], n);
        }
        allocation_orthogonalise(d->u[k], &d->u[0][0], DOFS, k, DOFS, along);
        auvid_real_t left = auvid_sqrt(allocation_dot(d->u[k], d->u[k], DOFS));
        for (int i = 0; i < DOFS; ++i) {
            d->u[k][i] /= left; /* > 0: the columns of L are independent */
        }
        for (int i = 0; i < k; ++i) {
            d->s[i][k] = along[i];
        }
        d->s[k][k] = left;
    }
}

/* Compute B+ = Q' S^-1 U' for one wrench e_dof at a time. */
static void allocation_invert(const decomposition_t *d,
                              auvid_real_t inverse[AUVID_MAX_THRUSTERS][DOFS])
{
    int n = d->cfg->thrusters;
    for (int dof = 0; dof < DOFS; ++dof) {
        auvid_real_t x[DOFS] = {AUVID_C(0.0)};
        auvid_real_t largest = AUVID_C(0.0);
        for (int i = d->rank - 1; i >= 0; --i) {
            x[i] = d->u[i][dof];
            for (int k = i + 1; k < d->rank; ++k) {
                x[i] -= d->s[i][k] * x[k];
            }
            x[i] /= d->s[i][i];
        }
        for (int j = 0; j < n; ++j) {
            inverse[j][dof] = AUVID_C(0.0);
            for (int i = 0; i < d->rank; ++i) {
                inverse[j][dof] += d->q[i][j] * x[i];
            }
            largest = auvid_max(largest, auvid_abs(inverse[j][dof]));
        }
        /* Rounding errors become zero: a thruster at its limit must not block a DoF on which it has
         * no effect. */
        for (int j = 0; j < n; ++j) {
            if (auvid_abs(inverse[j][dof]) < AUVID_C(32.0) * AUVID_EPSILON * largest) {
                inverse[j][dof] = AUVID_C(0.0);
            }
        }
    }
}

/* ---- configuration ---- */

void auvid_allocation_defaults(auvid_allocation_config_t *cfg)
{
    if (cfg != NULL) {
        memset(cfg, 0, sizeof *cfg);
        cfg->priority = AUVID_DOF_BIT(AUVID_YAW);
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            cfg->thruster[i].gain_forward = AUVID_C(1.0);
        }
    }
}

static void allocation_check_config(const auvid_allocation_config_t *cfg, auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        REALS_IN(auvid_thruster_t, wrench, DOFS, -LARGEST_ENTRY, LARGEST_ENTRY),
        REALS_IN(auvid_thruster_t, min_N, 1, -AUVID_LARGEST, AUVID_C(0.0)),
        REALS_IN(auvid_thruster_t, max_N, 1, AUVID_C(0.0), AUVID_LARGEST),
        WHOLE_IN(auvid_thruster_t, law, 1, AUVID_THRUST_LINEAR, AUVID_THRUST_SQUARE),
        REALS_ABOVE(auvid_thruster_t, gain_forward, 1, AUVID_C(0.0), AUVID_LARGEST),
        REALS_IN(auvid_thruster_t, gain_backward, 1, AUVID_C(0.0), AUVID_LARGEST),
    };
    auvid_check_part(why, "allocation");
    auvid_check_count(why, AUVID_ERR_SIZE, "thrusters", cfg->thrusters, AUVID_MAX_THRUSTERS);
    for (int j = 0; j < cfg->thrusters && why->status == AUVID_OK; ++j) {
        auvid_check_part(why, "allocation.thruster");
        auvid_check_element(why, j);
        AUVID_CHECK_TABLE(why, &cfg->thruster[j], fields);
    }
}

void auvid_allocation_set_up(auvid_allocation_t *a, const auvid_allocation_config_t *cfg,
                             auvid_refusal_t *why)
{
    decomposition_t d;
    allocation_check_config(cfg, why);
    if (why->status != AUVID_OK) {
        return;
    }
    d.cfg = cfg;
    allocation_span_rows(&d);
    auvid_check_part(why, "allocation");
    auvid_check_that(why, d.rank > 0, AUVID_ERR_SINGULAR, "thruster.wrench");
    if (why->status != AUVID_OK) {
        return;
    }
    allocation_orthogonalise_columns(&d);
    a->cfg = *cfg; /* which may be the same */
    memset(a->inverse, 0, sizeof a->inverse);
    a->actuated = 0;
    a->rank = (uint8_t)d.rank;
    allocation_invert(&d, a->inverse);
    for (int i = 0; i < DOFS; ++i) {
        auvid_real_t projected = AUVID_C(0.0);
        for (int k = 0; k < d.rank; ++k) {
            projected += d.u[k][i] * d.u[k][i];
        }
        if (projected > AUVID_C(1.0) - DEPENDENT) {
            a->actuated = (uint8_t)(a->actuated | AUVID_DOF_BIT(i));
        }
    }
}

auvid_status_t auvid_allocation_init(auvid_allocation_t *a, const auvid_allocation_config_t *cfg)
{
    auvid_refusal_t why;
    if (a == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_allocation_set_up(a, cfg, &why);
    return why.status;
}

/* ---- every tick ---- */

/* Does the rest add more than rounding to the force of a thruster? */
static bool allocation_adds(const auvid_thruster_t *t, auvid_real_t rest)
{
    return auvid_abs(rest) > AUVID_EPSILON * (t->max_N - t->min_N);
}

/* Return the largest k in 0..1 for which k first is within the limits of the thrusters to which the
 * rest adds only rounding. */
static auvid_real_t allocation_scale_alone(const auvid_allocation_t *a, const auvid_real_t *first,
                                           const auvid_real_t *rest)
{
    auvid_real_t k = AUVID_C(1.0);
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        auvid_real_t limit =
            first[j] > AUVID_C(0.0) ? a->cfg.thruster[j].max_N : a->cfg.thruster[j].min_N;
        if (!allocation_adds(&a->cfg.thruster[j], rest[j]) &&
            auvid_abs(k * first[j]) > auvid_abs(limit)) {
            k = limit / first[j];
        }
    }
    return k;
}

/* A bound of k2 as a function of k1. */
typedef struct {
    auvid_real_t value, slope;
} allocation_bound_t;

/* Compute the bounds of k2, within 0..1, so that k1 first + k2 rest is within the limits. */
static void allocation_bound_rest(const auvid_allocation_t *a, const auvid_real_t *first,
                                  const auvid_real_t *rest, auvid_real_t k1,
                                  allocation_bound_t *low, allocation_bound_t *high)
{
    *low = (allocation_bound_t){AUVID_C(0.0), AUVID_C(0.0)};
    *high = (allocation_bound_t){AUVID_C(1.0), AUVID_C(0.0)};
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        const auvid_thruster_t *t = &a->cfg.thruster[j];
        if (!allocation_adds(t, rest[j])) {
            continue;
        }
        auvid_real_t size = auvid_abs(rest[j]), done = k1 * first[j];
        bool forward = rest[j] > AUVID_C(0.0);
        auvid_real_t to = forward ? t->max_N - done : done - t->min_N;
        auvid_real_t from = forward ? t->min_N - done : done - t->max_N;
        if (to < high->value * size) {
            *high = (allocation_bound_t){to / size, -first[j] / rest[j]};
        }
        if (from > low->value * size) {
            *low = (allocation_bound_t){from / size, -first[j] / rest[j]};
        }
    }
}

/* Find the largest k1, then the largest k2, both in 0..1, for which k1 first + k2 rest is within
 * the limits. The room for k2, high - low, is a concave function of k1 in straight pieces, and not
 * negative at k1 = 0. Newton's method finds its root from above, a piece each step. */
static void allocation_scale(const auvid_allocation_t *a, const auvid_real_t *first,
                             const auvid_real_t *rest, auvid_real_t *k1, auvid_real_t *k2)
{
    allocation_bound_t low, high;
    *k1 = allocation_scale_alone(a, first, rest);
    allocation_bound_rest(a, first, rest, *k1, &low, &high);
    for (int i = 0; i < 2 * AUVID_MAX_THRUSTERS && low.value > high.value; ++i) {
        auvid_real_t next = *k1 - (low.value - high.value) / (low.slope - high.slope);
        if (!(next < *k1)) {
            break; /* only rounding is left */
        }
        *k1 = auvid_max(next, AUVID_C(0.0));
        allocation_bound_rest(a, first, rest, *k1, &low, &high);
    }
    *k2 = auvid_max(high.value, AUVID_C(0.0));
}

static auvid_status_t allocation_given(const auvid_allocation_t *a, const void *from,
                                       const void *to)
{
    if (a == NULL || from == NULL || to == NULL) {
        return AUVID_ERR_NULL;
    }
    return a->cfg.thrusters == 0 ? AUVID_ERR_STATE : AUVID_OK;
}

auvid_status_t auvid_allocation_solve(const auvid_allocation_t *a, const auvid_real_t wrench[DOFS],
                                      auvid_allocation_result_t *result)
{
    auvid_real_t first[AUVID_MAX_THRUSTERS], rest[AUVID_MAX_THRUSTERS];
    if (result == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_zero(result, sizeof *result);
    auvid_clear(first, AUVID_MAX_THRUSTERS);
    auvid_clear(rest, AUVID_MAX_THRUSTERS);
    auvid_status_t given = allocation_given(a, wrench, result);
    if (given != AUVID_OK) {
        return given;
    }
    auvid_status_t status = auvid_all_within(wrench, DOFS, LARGEST_WRENCH);
    if (status != AUVID_OK) {
        return status;
    }
    for (int i = 0; i < DOFS; ++i) {
        auvid_real_t *f = (a->cfg.priority & AUVID_DOF_BIT(i)) != 0 ? first : rest;
        if ((a->actuated & AUVID_DOF_BIT(i)) == 0) {
            bool asked = wrench[i] < AUVID_C(0.0) || wrench[i] > AUVID_C(0.0);
            result->dropped = (uint8_t)(result->dropped | (asked ? AUVID_DOF_BIT(i) : 0));
            continue;
        }
        for (int j = 0; j < a->cfg.thrusters; ++j) {
            f[j] += a->inverse[j][i] * wrench[i];
        }
    }
    allocation_scale(a, first, rest, &result->scale_priority, &result->scale);
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        auvid_real_t f = result->scale_priority * first[j] + result->scale * rest[j];
        result->force_N[j] = auvid_clamp_here(f, /* against rounding */
                                              a->cfg.thruster[j].min_N, a->cfg.thruster[j].max_N);
    }
    (void)auvid_allocation_wrench(a, result->force_N, result->wrench);
    return result->dropped != 0 || result->scale_priority < AUVID_C(1.0) ||
                   result->scale < AUVID_C(1.0)
               ? AUVID_SATURATED
               : AUVID_OK;
}

auvid_status_t auvid_allocation_wrench(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                       auvid_real_t wrench[DOFS])
{
    auvid_status_t given = allocation_given(a, force_N, wrench);
    if (given != AUVID_OK) {
        return given;
    }
    if (!auvid_all_finite(force_N, a->cfg.thrusters)) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int i = 0; i < DOFS; ++i) {
        wrench[i] = AUVID_C(0.0);
        for (int j = 0; j < a->cfg.thrusters; ++j) {
            wrench[i] += a->cfg.thruster[j].wrench[i] * force_N[j];
        }
    }
    return AUVID_OK;
}

static auvid_real_t allocation_gain(const auvid_thruster_t *t, bool backward)
{
    return backward && t->gain_backward > AUVID_C(0.0) ? t->gain_backward : t->gain_forward;
}

static auvid_real_t allocation_command(const auvid_thruster_t *t, auvid_real_t force_N)
{
    bool backward = force_N < AUVID_C(0.0);
    auvid_real_t n = auvid_abs(force_N) / allocation_gain(t, backward);
    n = t->law == AUVID_THRUST_SQUARE ? auvid_sqrt(n) : n;
    return backward ? -n : n;
}

auvid_status_t auvid_allocation_command(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                        auvid_real_t *command)
{
    auvid_status_t given = allocation_given(a, force_N, command);
    if (given != AUVID_OK) {
        return given;
    }
    if (!auvid_all_finite(force_N, a->cfg.thrusters)) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        if (!auvid_is_finite(allocation_command(&a->cfg.thruster[j], force_N[j]))) {
            return AUVID_ERR_NOT_FINITE;
        }
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        command[j] = allocation_command(&a->cfg.thruster[j], force_N[j]);
    }
    return AUVID_OK;
}

static auvid_real_t allocation_force_of(const auvid_thruster_t *t, auvid_real_t n)
{
    auvid_real_t size = t->law == AUVID_THRUST_SQUARE ? auvid_abs(n) * n : n;
    return allocation_gain(t, n < AUVID_C(0.0)) * size;
}

auvid_status_t auvid_allocation_force(const auvid_allocation_t *a, const auvid_real_t *command,
                                      auvid_real_t *force_N)
{
    auvid_status_t given = allocation_given(a, command, force_N);
    if (given != AUVID_OK) {
        return given;
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        if (!auvid_is_finite(allocation_force_of(&a->cfg.thruster[j], command[j]))) {
            return AUVID_ERR_NOT_FINITE;
        }
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        force_N[j] = allocation_force_of(&a->cfg.thruster[j], command[j]);
    }
    return AUVID_OK;
}

/* ---- planning ---- */

auvid_status_t auvid_allocation_capacity(const auvid_allocation_t *a, auvid_dof_t dof,
                                         auvid_real_t *negative, auvid_real_t *positive)
{
    auvid_real_t limit[2] = {AUVID_LARGEST, AUVID_LARGEST}; /* negative, positive */
    auvid_status_t given = allocation_given(a, negative, positive);
    if (given != AUVID_OK) {
        return given;
    }
    if ((unsigned)dof >= DOFS) {
        return AUVID_ERR_RANGE;
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        auvid_real_t c = a->inverse[j][dof];
        auvid_real_t up = a->cfg.thruster[j].max_N;
        auvid_real_t down = -a->cfg.thruster[j].min_N;
        auvid_real_t size = auvid_abs(c);
        if (size * limit[1] > (c > AUVID_C(0.0) ? up : down)) {
            limit[1] = (c > AUVID_C(0.0) ? up : down) / size;
        }
        if (size * limit[0] > (c > AUVID_C(0.0) ? down : up)) {
            limit[0] = (c > AUVID_C(0.0) ? down : up) / size;
        }
    }
    bool actuated = (a->actuated & AUVID_DOF_BIT(dof)) != 0;
    *negative = actuated ? -limit[0] : AUVID_C(0.0);
    *positive = actuated ? limit[1] : AUVID_C(0.0);
    return AUVID_OK;
}

/* Reduce the fit to what thruster j allows. */
static void allocation_fit_thruster(const auvid_allocation_t *a, int j, const auvid_real_t *peak,
                                    const auvid_real_t *hold, auvid_allocation_fit_t *fit)
{
    const auvid_thruster_t *t = &a->cfg.thruster[j];
    auvid_real_t middle = hold != NULL ? allocation_dot(a->inverse[j], hold, DOFS) : AUVID_C(0.0);
    auvid_real_t reach = AUVID_C(0.0), largest = AUVID_C(0.0);
    int dof = -1;
    for (int i = 0; i < DOFS; ++i) {
        auvid_real_t part = auvid_abs(a->inverse[j][i]) * peak[i];
        dof = part > largest ? i : dof;
        largest = auvid_max(largest, part);
        reach += part;
    }
    if (middle + reach <= t->max_N && middle - reach >= t->min_N) {
        return;
    }
    auvid_real_t margin = auvid_min(t->max_N - middle, middle - t->min_N);
    auvid_real_t factor = reach > AUVID_C(0.0) ? margin / reach : AUVID_C(0.0);
    factor = auvid_max(factor - AUVID_C(16.0) * AUVID_EPSILON, AUVID_C(0.0)); /* for rounding */
    if (factor < fit->factor) {
        fit->factor = factor;
        fit->dof = (int8_t)(margin < AUVID_C(0.0) ? -1 : dof);
    }
}

auvid_status_t auvid_allocation_check(const auvid_allocation_t *a, const auvid_real_t peak[DOFS],
                                      const auvid_real_t hold[DOFS], auvid_allocation_fit_t *fit)
{
    auvid_allocation_fit_t found = {AUVID_C(1.0), -1};
    auvid_status_t given = allocation_given(a, peak, peak);
    if (given != AUVID_OK) {
        return given;
    }
    if (!auvid_all_finite(peak, DOFS) || (hold != NULL && !auvid_all_finite(hold, DOFS))) {
        return AUVID_ERR_NOT_FINITE;
    }
    for (int i = 0; i < DOFS; ++i) {
        if (peak[i] < AUVID_C(0.0)) {
            return AUVID_ERR_RANGE;
        }
    }
    for (int j = 0; j < a->cfg.thrusters; ++j) {
        allocation_fit_thruster(a, j, peak, hold, &found);
    }
    for (int i = DOFS - 1; i >= 0; --i) {
        if (peak[i] > AUVID_C(0.0) && (a->actuated & AUVID_DOF_BIT(i)) == 0) {
            found = (auvid_allocation_fit_t){AUVID_C(0.0), (int8_t)i};
        }
    }
    if (fit != NULL) {
        *fit = found;
    }
    return found.factor < AUVID_C(1.0) ? AUVID_ERR_CAPACITY : AUVID_OK;
}
