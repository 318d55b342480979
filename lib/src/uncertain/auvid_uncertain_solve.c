/*
 * Uncertain inputs: the joint solution. Per DoF j, X = [C R] and theta = (b, pi):
 *
 *     e    = z - X theta                                 at the last pass
 *     s^2  = 2.6 ||e||^2 / rows                          bands weighted (uncertain_weigh_bands)
 *     X~   = X, with u' + lambda e / m in the column of the mass,
 *            c + mu e |dc/dv| / D in a column c of drag, D = X_u + 2 v X_uu, and
 *            c - (1 - lambda - mu) k e / gamma in a column c of the thrust, k = c'z / z'z, but
 *            not in those of its losses with speed
 *     min sum_j ||(e + X~ theta_0 - X~ theta) / s||^2 + sum_k (b_k / sigma_k)^2
 *
 * (Gauss-Newton.) The shares of the noise e: lambda accelerates the vehicle, mu changes its
 * velocity, and the rest is an error of the thrust. A force of bandwidth a accelerates a vehicle of
 * mass m and drag D with its part eta = a / (a + |D| / m); the rest moves the velocity. Noise of
 * the measured velocity is in the acceleration with all of it. h = sqrt(eta) is between both,
 *
 *     lambda = 0.7 h,   mu = 0.5 (1 - h) for forces, 0 for moments,
 *
 * as the residual contains what the inputs leave of their own errors, too. v is the rms speed (of a
 * model without linear drag, the fourth root of the mean of v^4), and drag that is not estimated
 * does not count. a follows from the squares s, d of both bands, as in uncertain_weigh_bands: of
 * two rows T apart a first-order autoregression has d / s = tanh(a T / 2), and a is taken as
 * 2 d / (T s). For slow vehicles h is near 1. Both shares are 0 for rows that are projected onto
 * instruments (auvid_instruments.c): their motion is without noise.
 *
 * The error of the thrust is at most half of it: its share of e'e is at most z'z / 4, and what is
 * more belongs to the motion. In an equation without thrust, as sway of a craft with two propellers
 * astern, it has none (its z is what the last estimate of a current makes of the motion): nothing
 * else scales with the parameters there, and such a share pulls all masses and drags towards zero,
 * by 10 % in still water, and in a current of 8 cm/s by 24 % (tests/program/test_unactuated.sh).
 *
 * The losses of thrust with speed are columns of the thrust, but e is not in them like that: they
 * contain the measured velocity. With -(1 - lambda) k e in it, too, the loss becomes too small, or
 * a gain, and the drag too large: at 0.6 of the largest speed by 4 to 18 % on average in a quick
 * ROV of 9 kg, where 45 of 331 such forces were wrongly identifiable (60 fresh logs of an
 * independent simulator). Now none of 395 is, and the mean error is -2 to 5 %. With a share mu of
 * moments, too, its drag in yaw is 15 to 25 % too large; with mu = 0 drag is 2 to 6 % too small in
 * mixtures of usual errors.
 *
 * No motion shows the scale of thrust, masses and drag together. With v its direction, and d the
 * part of the thrust that is delivered, 1 - sum_k k b_k, X v = -e, and X~ v = 0 if gamma = d. If
 * gamma = 1, the residual pulls towards less thrust, by (1 - lambda - mu) (1 - d) e'e / s^2. Losses
 * have one sign, so some of this is right: estimates are less often 20 % too large (in the worlds
 * of auvid-validate 8 % of what is identifiable is wrong, with gamma = d 11 %). But where the model
 * leaves much of the force, it exceeds what the priors hold, and the solution ran off to no thrust
 * and no mass (in a fifth of a joystick's logs, from an independent simulator). So the pull is that
 * of g = d / 0.9, at most 1, with d at least 0.5; above 1 it is none: it would be towards more
 * thrust, away from the priors. And it grows with each row, as the priors do not: five dives gave
 * 21 % too little mass where one gave 8 %. So e'e / s^2 counts 150 at most, that of four minutes,
 *
 *     gamma = d / (1 - (1 - d / g) min(1, 150 s^2 / e'e)).
 *
 * More than 480 rows, of four minutes, count as 480: s^2 is larger by rows / 480. Most of e is no
 * noise but what model and inputs lack. It depends on the motion, and more of the same motion does
 * not average it out, however long a log is. A likelihood that is only about right counts as that
 * of a sample too small to tell it from the truth (coarsening, Miller and Dunson 2019). With all
 * rows the inputs took what the hull had, far beyond their priors, and half-widths shrank below the
 * errors: in half an hour of the simulated ROV 23 % of the drag forces were off by more than 20 %,
 * in four minutes none. Rows that are projected onto instruments all count: there e is mostly
 * noise, and Sargan's test sees the rest.
 *
 * Columns c of the hull's inputs, and of its weight, become c - D a, a = (D'D)^-1 D'c, D the
 * columns of the DoF's drag in unweighted bands. So pi contains the best drag for the motion that
 * was seen. (A light vehicle tilts by 10 degrees if its centre of gravity is 2 cm off, and its tilt
 * changes with the rate of yaw.) In a model of roll or pitch the columns of the weight stay as they
 * are: there the tilt has thrust of its own, and 2 cm would make N_rr a fifth too small.
 *
 * The column c of sag becomes c - t_0 z: in a long dive sag counts from t_0, an hour ago. What is
 * lost before belongs to the thrust scale.
 *
 * A DoF's own inputs are eliminated in its R factor. What is left of its rows is rotated into the
 * joint factor of shared inputs and parameters.
 *
 * Moments of roll and pitch are small differences of forces, and most often an autopilot's. Their
 * equations determine parameters of roll and pitch only: each has all inputs of its own, with their
 * priors, which are eliminated, too, and parameters of other DoF are those of the last pass, as if
 * exact. (The residual, and the own inputs that are kept, are those with the shared inputs of the
 * other equations.) With a part in the rest they made masses and drag 3 to 9 % too small (means of
 * 160 mixtures of a simulated ROV in six DoF). In the other equations a parameter of roll or pitch,
 * as in (I_y - I_x) p q, has the ratio to the mass that it had at the last pass. With its value the
 * scale would be that of the last pass, whatever the priors say, and drift: without noise masses of
 * a torpedo became 12 % too small (means of 15 logs, auvid-validate worlds --perfect; now 2 %).
 *
 * An equation of roll or pitch without a moment is left out, and parameters of its DoF in others
 * are those of the last pass. It says how its terms compare, and nothing of their scale: noise of
 * the angle would only make the righting moment smaller, which pitch has in common with roll, and
 * with it all that is coupled (I_y by 31 %, simulated torpedo, tests/vehicles/test_torpedo.c). So
 * is any other equation without thrust in which no parameter of its own is free, or no force is
 * known: the masses of other DoF, as the search found them, and the fixed parameters make less
 * than would excite the DoF. All of a decoupled sway can be zero, and with it W-B. In the heave of
 * a surface craft the column of m_u is u q, noise of the gyro: 0 = m_u u q pulls m_u to zero, and
 * all that scales with it (tests/unit/uncertain/test_uncertain_few_dofs.c).
 *
 * Covariance: 1.9 P + 0.05 sum_j d_j d_j', P the inverse of the joint normal matrix. d_j is the
 * derivative of the solution by lambda_j: P X_j' times the change of X~_j's columns,
 * e'e / s^2 = rows / 2.6, of four minutes at most: else the half-widths would grow with each row,
 * along the scale that only the priors hold, ten times in ten dives.
 *
 * After the last pass the rows of the parameters in the joint factor are what is left when the
 * uncertain inputs are eliminated, and the optimizer searches their cost within the bounds. It is
 * convex: the search gets its minimum, with a certificate.
 *
 * After each pass the priors get the common scale c with the largest likelihood (MacKay 1992) of
 * the shared inputs, as if three of them had been seen to be right,
 *     c^2 = (3 + sum_k (b_k / sigma_k)^2) / (3 + sum_k (1 - P_kk / (c sigma_k)^2)).
 */
#include <string.h>

#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"
#include "../metric/auvid_metric_feedback_internal.h"

#define SIDE_VARIANCE AUVID_C(0.05)
#define LONGEST_SAG AUVID_C(15.0) /* an hour, over AUVID_UNCERTAIN_SAG_S */
#define LARGEST_SOLUTION AUVID_C(1e18) /* its square is a number */
#define SEEN_RIGHT AUVID_C(3.0)   /* prior of the scale, as a number of inputs */

typedef auvid_uncertain_t uncertain_t;

static void uncertain_add_shared_prior(uncertain_t *u, const auvid_metric_t *m, int code)
{
    auvid_real_t row[JOINT_ORDER], sigma = auvid_uncertain_sigma(u, m, code, 0);
    auvid_clear(row, JOINT_ORDER);
    row[code] = AUVID_C(1.0) / auvid_max(sigma, AUVID_C(1e-6));
    auvid_qr_update(u->work.joint, JOINT_ORDER, code, row);
}

/* Take shared inputs and parameters, and solve for the own inputs of each DoF. */
static void uncertain_take_solution(uncertain_t *u, const auvid_metric_t *m, const auvid_real_t *x)
{
    memcpy(u->shared, x, sizeof u->shared);
    memcpy(u->pi, x + PARAMETERS_AT, sizeof u->pi);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_uncertain_equation_t *e = &u->equation[j];
        for (int i = auvid_uncertain_has_rows(u, j) ? e->own - 1 : -1; i >= 0; --i) {
            const auvid_real_t *r = auvid_uncertain_own_row(u, e, i);
            auvid_real_t sum = AUVID_C(0.0);
            for (int k = i + 1; k < e->order; ++k) {
                sum += r[k] * (k < e->own ? u->own[e->own_at + k]
                                          : x[auvid_uncertain_joint_column(u, m, j, k)]);
            }
            auvid_real_t input = auvid_abs(r[i]) > AUVID_C(0.0) ? -sum / r[i] : AUVID_C(0.0);
            bool good = auvid_all_within(&input, 1, LARGEST_SOLUTION) == AUVID_OK;
            u->own[e->own_at + i] = good ? input : AUVID_C(0.0);
        }
    }
}

/* Solve for shared inputs and parameters, or for the inputs beside known parameters; then for the
 * own inputs of each DoF. */
static void uncertain_back_solve(uncertain_t *u, const auvid_metric_t *m, bool known)
{
    auvid_real_t x[JOINT_ORDER];
    const int n = known ? PARAMETERS_AT : JOINT_ORDER - 1;
    memcpy(x + PARAMETERS_AT, u->pi, sizeof u->pi);
    x[JOINT_ORDER - 1] = AUVID_C(-1.0);
    for (int i = 0; i < n; ++i) {
        const auvid_real_t *r = auvid_uncertain_joint_row(u, i);
        x[i] = r[JOINT_ORDER - 1];
        for (int k = n; k < JOINT_ORDER - 1; ++k) {
            x[i] -= r[k] * x[k];
        }
    }
    (void)auvid_qr_solve(u->work.joint, JOINT_ORDER, n, AUVID_C(1e-6), x);
    if (auvid_all_within(x, JOINT_ORDER, LARGEST_SOLUTION) == AUVID_OK) {
        uncertain_take_solution(u, m, x);
    }
}

/* Count shared input k for the scale of the priors; set it after the last one. */
static void uncertain_scale(uncertain_t *u, const auvid_metric_t *m, int k)
{
    auvid_uncertain_solution_t *w = &u->work;
    auvid_real_t x[JOINT_ORDER], variance = AUVID_C(0.0);
    auvid_real_t sigma = auvid_uncertain_sigma(u, m, k, 0);
    auvid_clear(x, JOINT_ORDER);
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
        u->contradicted = !(scale <= AUVID_UNCERTAIN_CONTRADICTED);
        /* it may be NaN */
        scale = u->contradicted ? AUVID_UNCERTAIN_LARGEST_SCALE : scale;
        u->scale = auvid_clamp(scale, AUVID_C(1.0) / AUVID_UNCERTAIN_LARGEST_SCALE,
                               AUVID_UNCERTAIN_LARGEST_SCALE);
        w->squares = w->known = AUVID_C(0.0);
    }
}

static void uncertain_solve_side(uncertain_t *u, int j)
{
    auvid_qr_solve_transposed(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, u->work.side[j]);
    (void)auvid_qr_solve_from(u->work.joint, JOINT_ORDER, PARAMETERS_AT, JOINT_ORDER - 1,
                              AUVID_C(1e-6), u->work.side[j]);
}

/* Row i of the covariance of the parameters, packed, where the DoF's factor was. */
static void uncertain_find_covariance(uncertain_t *u, const auvid_metric_t *m, int i)
{
    int n = m->cfg.vehicle->parameters;
    auvid_real_t x[JOINT_ORDER], *row = u->work.part.factor + auvid_qr_row(n, i);
    auvid_clear(x, JOINT_ORDER);
    x[PARAMETERS_AT + i] = AUVID_C(1.0);
    auvid_qr_solve_transposed(u->work.joint, JOINT_ORDER, JOINT_ORDER - 1, x);
    (void)auvid_qr_solve_from(u->work.joint, JOINT_ORDER, PARAMETERS_AT + i, JOINT_ORDER - 1,
                              AUVID_C(1e-6), x);
    for (int k = i; k < n; ++k) {
        auvid_real_t sides = AUVID_C(0.0);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            sides += u->work.side[j][PARAMETERS_AT + i] * u->work.side[j][PARAMETERS_AT + k];
        }
        row[k - i] = AUVID_UNCERTAIN_COVARIANCE * x[PARAMETERS_AT + k] + SIDE_VARIANCE * sides;
    }
}

/* ---- the steps ---- */

/* The next DoF whose equation is solved, from j on. */
static uint8_t uncertain_next_dof(const uncertain_t *u, int j)
{
    while (j < AUVID_DOF_COUNT &&
           (!auvid_uncertain_has_rows(u, j) || auvid_uncertain_is_left_out(u, &u->id->metric, j))) {
        ++j;
    }
    return (uint8_t)j;
}

void auvid_uncertain_begin(auvid_uncertain_t *u)
{
    if (u->estimate.number == 0 && !u->given) {
        memcpy(u->pi, u->id->work.candidate, sizeof u->pi);
        auvid_clear(u->shared, AUVID_UNCERTAIN_SHARED);
        auvid_clear(u->own, AUVID_UNCERTAIN_OWN);
        u->scale = AUVID_C(1.0);
    }
    u->given = false;
    auvid_zero(&u->work, sizeof u->work);
    u->work.solving = true;
    u->work.sag_from = auvid_max(u->recorded.elapsed - LONGEST_SAG, AUVID_C(0.0));
    if (u->instruments != NULL && !u->excited &&
        auvid_metric_feedback_dofs(&u->id->metric) == AUVID_FEEDBACK_ALL) {
        u->work.strong = u->strong(u, &u->id->metric);
    }
    u->work.dof = uncertain_next_dof(u, 0);
}

bool auvid_uncertain_reads(const auvid_uncertain_t *u, int j)
{
    return u->work.solving && u->work.phase <= SOLVE_ROWS && u->work.dof == j;
}

/* Returns the cost of rotating a row of n columns into a factor [units]. */
static uint32_t uncertain_rotation(int n)
{
    return (uint32_t)(n * (n + 8)) / 36u;
}

/* Is input i of DoF j the last to read its rows before the early ones are forgotten? Those of a
 * passive vehicle stay: a controller moves it so little that each set counts. */
static bool uncertain_forgets(const uncertain_t *u, int j, int i)
{
    const auvid_uncertain_equation_t *e = &u->equation[j];
    bool moves = false; /* has it a column that is formed with the last solution? */
    if (!u->excited || u->informed == 2 || i != e->inputs - 1) {
        return false;
    }
    for (int k = e->own; k < e->inputs; ++k) {
        int code = u->code[e->channel_at + k];
        moves = moves ||
                (code >= (int)AUVID_UNCERTAIN_CURRENT_X && code <= (int)AUVID_UNCERTAIN_DVL_LATE);
    }
    return moves;
}

/* Returns the cost of the present step [units]: about 250 instructions each on a Cortex-M4F. */
static uint32_t uncertain_price(const uncertain_t *u)
{
    const auvid_metric_t *m = &u->id->metric;
    int i = u->work.row, j = u->work.dof < AUVID_DOF_COUNT ? u->work.dof : 0;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const uint32_t joint = JOINT_ORDER * JOINT_ORDER;
    int eliminated = auvid_uncertain_eliminated(u, j);
    switch (u->work.phase) {
    case SOLVE_PREPARE:
        return (uint32_t)(e->order * e->order) / 6u;
    case SOLVE_ROWS:
        return uncertain_rotation(e->order);
    case SOLVE_OWN: /* the side of the shared inputs that are eliminated, with the last one */
        return uncertain_rotation(e->order) +
               (i < eliminated ? 0u : (uint32_t)((eliminated - e->own) * e->order) / 12u);
    case SOLVE_TRANSFER:
        i += eliminated;
        return uncertain_rotation(JOINT_ORDER - auvid_uncertain_joint_column(u, m, j, i));
    case SOLVE_SHARED:
        return uncertain_rotation(JOINT_ORDER - i);
    case SOLVE_REDUCE:
        return uncertain_rotation(m->cfg.vehicle->parameters);
    case SOLVE_START:
        return SEARCH_START_COST;
    case SOLVE_OPTIMUM:
    case SOLVE_SEARCH:
        return uncertain_rotation(m->cfg.vehicle->parameters) / 2u + 4u;
    case SOLVE_FINISH:
    case SOLVE_KEEP:
        return joint / 10u;
    case SOLVE_SCALE:
        return joint / 55u;
    case SOLVE_SIDES:
    case SOLVE_SIGMA:
        return joint / 15u;
    default: /* SOLVE_CAUSES */
        return joint / 24u +
               (uncertain_forgets(u, j, i) ? (uint32_t)(e->order * e->order) / 7u : 0u);
    }
}

/* Returns the number of steps of a phase, of DoF j where it is of one. */
static int uncertain_steps(const uncertain_t *u, const auvid_metric_t *m, int phase, int j,
                           bool projected)
{
    const auvid_uncertain_equation_t *e = &u->equation[j < AUVID_DOF_COUNT ? j : 0];
    int eliminated = auvid_uncertain_eliminated(u, j < AUVID_DOF_COUNT ? j : 0);
    switch (phase) {
    case SOLVE_ROWS:
        return projected ? u->instruments->of[j].count : AUVID_METRIC_BANDS * e->order;
    case SOLVE_OWN:
        return eliminated + 1;
    case SOLVE_TRANSFER:
        return e->order - eliminated;
    case SOLVE_SHARED:
    case SOLVE_SCALE:
        return AUVID_UNCERTAIN_SHARED;
    case SOLVE_SIDES:
        return AUVID_DOF_COUNT;
    case SOLVE_CAUSES:
        return e->inputs;
    case SOLVE_REDUCE:
    case SOLVE_SIGMA:
        return m->cfg.vehicle->parameters;
    default:
        return 1;
    }
}

bool auvid_uncertain_is_step(const auvid_uncertain_t *u, const auvid_metric_t *m, int phase, int j,
                             int i, bool projected)
{
    bool one = phase <= SOLVE_TRANSFER || phase == SOLVE_CAUSES;
    bool right = one ? j < AUVID_DOF_COUNT : j == AUVID_DOF_COUNT;
    return phase < SOLVE_DONE && right && i < uncertain_steps(u, m, phase, j, projected);
}

/* Do one step. @return must it be repeated? */
static bool uncertain_step(uncertain_t *u, const auvid_metric_t *m)
{
    int i = u->work.row, j = u->work.dof;
    const auvid_uncertain_equation_t *e = &u->equation[j < AUVID_DOF_COUNT ? j : 0];
    switch (u->work.phase) {
    case SOLVE_PREPARE:
        auvid_uncertain_prepare(u, m, j);
        break;
    case SOLVE_ROWS:
        if (u->work.strong != 0) {
            auvid_uncertain_add_row(u, j, 0, i);
        } else {
            auvid_uncertain_add_row(u, j, i % 2, e->order - 1 - i / 2); /* short rows first */
        }
        break;
    case SOLVE_OWN:
        if (i < auvid_uncertain_eliminated(u, j)) {
            auvid_uncertain_add_own_prior(u, m, j, i);
        } else {
            auvid_uncertain_keep_own(u, m, j);
        }
        break;
    case SOLVE_TRANSFER:
        auvid_uncertain_transfer(u, m, j, auvid_uncertain_eliminated(u, j) + i);
        break;
    case SOLVE_SHARED:
        uncertain_add_shared_prior(u, m, i);
        break;
    case SOLVE_FINISH:
        uncertain_back_solve(u, m, false);
        break;
    case SOLVE_SCALE:
        uncertain_scale(u, m, i);
        break;
    case SOLVE_REDUCE:
        auvid_uncertain_reduce(u, i);
        break;
    case SOLVE_OPTIMUM:
        return !auvid_uncertain_find_optimum(u);
    case SOLVE_START:
        auvid_uncertain_begin_search(u);
        break;
    case SOLVE_SEARCH:
        return !auvid_uncertain_search(u);
    case SOLVE_KEEP:
        uncertain_back_solve(u, m, true);
        break;
    case SOLVE_SIDES:
        uncertain_solve_side(u, i);
        break;
    case SOLVE_SIGMA:
        uncertain_find_covariance(u, m, i);
        break;
    default: /* SOLVE_CAUSES */
        auvid_uncertain_consider(u, j, i);
        if (uncertain_forgets(u, j, i)) {
            auvid_uncertain_forget_early(u, m, j);
        }
        break;
    }
    return false;
}

/* Steps of Gauss-Newton. During an excitation, a later solution continues from the last one. */
static int uncertain_passes(const uncertain_t *u)
{
    return u->excited && u->estimate.number > 0 ? 1 : 3;
}

/* Begin the next phase. */
static void uncertain_next_phase(uncertain_t *u)
{
    auvid_uncertain_solution_t *w = &u->work;
    w->row = 0;
    if (w->phase == SOLVE_TRANSFER) {
        w->dof = uncertain_next_dof(u, w->dof + 1);
        w->phase = w->dof < AUVID_DOF_COUNT ? SOLVE_PREPARE : SOLVE_SHARED;
    } else if (w->phase == SOLVE_SCALE && ++w->pass < uncertain_passes(u)) {
        auvid_clear(w->joint, sizeof w->joint / sizeof w->joint[0]);
        w->dof = uncertain_next_dof(u, 0);
        w->phase = SOLVE_PREPARE;
    } else if (w->phase >= SOLVE_SIGMA) {
        int j = w->phase == SOLVE_SIGMA ? 0 : w->dof + 1;
        do {
            w->dof = uncertain_next_dof(u, j);
            j = w->dof + 1;
        } while (w->dof < AUVID_DOF_COUNT && u->equation[w->dof].inputs == 0);
        w->phase = w->dof < AUVID_DOF_COUNT ? SOLVE_CAUSES : SOLVE_DONE;
    } else {
        ++w->phase;
    }
}

auvid_status_t auvid_uncertain_solve(auvid_uncertain_t *u, const auvid_metric_t *m,
                                     uint32_t *budget)
{
    while (u->work.phase != SOLVE_DONE && *budget > 0) {
        uint32_t price = uncertain_price(u), spent = u->work.spent;
        uint32_t left = price > spent ? price - spent : 1u;
        if (*budget < left) {
            u->work.spent = (uint16_t)(spent + *budget);
            *budget = 0;
            break;
        }
        *budget -= left;
        *budget -= spent < *budget ? spent : *budget; /* no call does more than it is given */
        u->work.spent = 0;
        bool again = uncertain_step(u, m);
        if (!again && ++u->work.row >=
                          uncertain_steps(u, m, u->work.phase, u->work.dof, u->work.strong != 0)) {
            uncertain_next_phase(u);
        }
    }
    return u->work.phase == SOLVE_DONE ? AUVID_OK : AUVID_PENDING;
}
