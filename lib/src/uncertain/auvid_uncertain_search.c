/*
 * Uncertain inputs: the search of the parameters, when the inputs are eliminated. The rows of the
 * parameters in the joint factor, [R | z], are what is left, and
 *
 *     J(pi) = ||R pi - z||^2 / ||z||^2
 *
 * is searched within the bounds by both phases of the optimizer. It is convex: the optimizer gets
 * its minimum as a certificate, as for the sets (auvid_identifier_optimum.c).
 */
#include <string.h>

#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"
#include "../search/auvid_bounded_ls_internal.h"

typedef auvid_uncertain_t uncertain_t;

/* Norm of parameter p's column in the reduced factor. */
static auvid_real_t uncertain_reduced_norm(const uncertain_t *u, int p)
{
    auvid_real_t squares = AUVID_C(0.0);
    for (int i = 0; i <= p; ++i) {
        auvid_real_t r = auvid_uncertain_joint_row(u, PARAMETERS_AT + i)[PARAMETERS_AT + p];
        squares += r * r;
    }
    return auvid_sqrt(squares);
}

/* Cost that no parameters explain. */
static auvid_real_t uncertain_constant(const uncertain_t *u)
{
    auvid_real_t left = auvid_uncertain_joint_row(u, JOINT_ORDER - 1)[JOINT_ORDER - 1];
    return u->work.weight * left * left;
}

/* Begin to find the minimum of what is left within the bounds. */
static void uncertain_begin_optimum(uncertain_t *u)
{
    auvid_identifier_t *id = u->id;
    auvid_real_t squares = AUVID_C(0.0);
    id->work.active = 0;
    for (int p = 0; p < id->metric.cfg.vehicle->parameters; ++p) {
        auvid_real_t z = auvid_uncertain_joint_row(u, PARAMETERS_AT + p)[JOINT_ORDER - 1];
        id->work.active |= (uint32_t)(uncertain_reduced_norm(u, p) > AUVID_C(0.0)) << p;
        squares += z * z;
    }
    u->work.weight = squares > AUVID_C(0.0) ? AUVID_C(1.0) / squares : AUVID_C(1.0);
    auvid_identifier_begin_optimum(id, u->pi);
    id->optimum.dof = AUVID_DOF_COUNT;
}

void auvid_uncertain_reduce(uncertain_t *u, int i)
{
    auvid_bounded_ls_t *ls = &u->id->optimum;
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1];
    if (i == 0) {
        uncertain_begin_optimum(u);
    }
    const auvid_real_t *r = auvid_uncertain_joint_row(u, PARAMETERS_AT + i) + PARAMETERS_AT;
    auvid_real_t scale = auvid_sqrt(u->work.weight);
    for (int k = 0; k < ls->n; ++k) {
        int p = u->id->work.parameter_of[k];
        row[k] = p < i ? AUVID_C(0.0) : scale * r[p];
    }
    row[ls->n] = scale * r[AUVID_MAX_PARAMETERS];
    auvid_bounded_ls_add(ls, row);
}

bool auvid_uncertain_find_optimum(uncertain_t *u)
{
    return auvid_bounded_ls_step(&u->id->optimum, uncertain_constant(u)) != AUVID_PENDING;
}

void auvid_uncertain_begin_search(uncertain_t *u)
{
    auvid_identifier_t *id = u->id;
    auvid_real_t unit[SCALES], scale = auvid_sqrt(u->work.weight);
    auvid_minimum_t minimum = auvid_identifier_take_optimum(id, uncertain_constant(u), u->pi);
    for (int p = 0; p < AUVID_MAX_PARAMETERS; ++p) {
        auvid_real_t norm = uncertain_reduced_norm(u, p);
        unit[p] = norm > AUVID_C(0.0) ? AUVID_C(1.0) / (scale * norm) : AUVID_C(0.0);
    }
    id->work.searching =
        auvid_identifier_begin_search(id, unit, NULL, &minimum, u->pi, AUVID_C(0.0)) == AUVID_OK;
}

void auvid_uncertain_free(const uncertain_t *u, auvid_real_t pi[AUVID_MAX_PARAMETERS])
{
    auvid_real_t x[JOINT_ORDER];
    for (int i = PARAMETERS_AT; i < JOINT_ORDER - 1; ++i) {
        x[i] = auvid_uncertain_joint_row(u, i)[JOINT_ORDER - 1];
    }
    (void)auvid_qr_solve_from(u->work.joint, JOINT_ORDER, PARAMETERS_AT, JOINT_ORDER - 1,
                              AUVID_C(1e-6), x);
    memcpy(pi, x + PARAMETERS_AT, AUVID_MAX_PARAMETERS * sizeof *pi);
}

/* Cost of a point: squares of the parameters' rows. */
static auvid_real_t uncertain_cost(const uncertain_t *u, const auvid_real_t *pi)
{
    const int n = u->id->metric.cfg.vehicle->parameters;
    auvid_real_t sum = AUVID_C(0.0);
    for (int i = 0; i < n; ++i) {
        const auvid_real_t *r = auvid_uncertain_joint_row(u, PARAMETERS_AT + i) + PARAMETERS_AT;
        auvid_real_t e = r[AUVID_MAX_PARAMETERS];
        for (int k = i; k < n; ++k) {
            e -= r[k] * pi[k];
        }
        sum += e * e;
    }
    return u->work.weight * sum;
}

/* Write a point of the optimizer to the parameters. */
static void uncertain_expand(const auvid_identifier_t *id, const auvid_real_t *theta,
                             auvid_real_t *pi)
{
    for (int i = 0; i < id->optimizer.cfg.n; ++i) {
        pi[id->work.parameter_of[i]] = theta[i];
    }
}

bool auvid_uncertain_search(uncertain_t *u)
{
    auvid_identifier_t *id = u->id;
    auvid_real_t theta[AUVID_MAX_PARAMETERS], pi[AUVID_MAX_PARAMETERS];
    if (!id->work.searching) { /* no parameter is left */
        return true;
    }
    auvid_status_t status = auvid_optimizer_ask(&id->optimizer, theta);
    if (status == AUVID_OK) {
        memcpy(pi, u->pi, sizeof pi);
        uncertain_expand(id, theta, pi);
        (void)auvid_optimizer_tell(&id->optimizer, uncertain_cost(u, pi));
    } else if (status != AUVID_PENDING) {
        uncertain_expand(id, auvid_optimizer_best(&id->optimizer, NULL), u->pi);
        u->work.searched = id->optimizer.work;
        u->work.not_converged = status != AUVID_FINISHED;
        id->work.searching = false;
    }
    return !id->work.searching;
}
