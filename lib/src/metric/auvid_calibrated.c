/*
 * A vehicle with a known force, which calibrates the thrust (estimate.h).
 *
 * Known wrench at a sample, with the force f at p and the mass m there (Fossen 2011, 3.3):
 *
 *     a = nu1' + omega x nu1 + omega' x p + omega x (omega x p)
 *     F = f_body + R' f_world - m a,    M = p x F
 *
 * The motion's kernel smooths its column, not that of the thrust, which is wider by the
 * interpolation of the velocity. Only at a step of the force, for a tenth of a second, is this not
 * the same.
 *
 * Conversion to SI. With x = (k pi, k), its covariance P given the thrust as supplied, the prior
 * 1 +- s of k, and v = P_kk,
 *
 *     q = max(s^2, (k - 1)^2 - v)                      what the data contradict is wider
 *     x <- x + P_k (1 - k) / (v + q)
 *     w = v q / (v + q)                                variance of k
 *     pi = (k pi) / k,  C = (P - P_k P_k' / v) / k^2   given k
 *     d = sqrt(w) (pi - P_k / v) / k                   change of pi by the error of k
 *
 * The total covariance C + d d' is that of the delta rule.
 */
#include <string.h>

#include "auvid/estimate.h"
#include "../base/auvid_linalg_internal.h"

#define LARGEST_FORCE AUVID_C(1e5)
#define LARGEST_ARM AUVID_C(100.0)
#define LARGEST_MASS AUVID_C(1e4)
/* Largest variance of k, relative to that of its prior: then its error is at least a tenth smaller
 * than without the data. */
#define LARGEST_VARIANCE AUVID_C(4.0)
#define LEAST_K AUVID_C(0.33333333)
#define LARGEST_K AUVID_C(3.0)

/* Steps by which the acceleration includes that of the weight: an error of m / M each. */
enum { CALIBRATED_STEPS = 8 };

static const auvid_known_force_t calibrated_none;

/* ---- the model ---- */

/* c += a x b */
static void calibrated_add_cross(const auvid_real_t a[3], const auvid_real_t b[3],
                                 auvid_real_t c[3])
{
    for (int i = 0; i < 3; ++i) {
        int p = (i + 1) % 3, q = (i + 2) % 3;
        c[i] += a[p] * b[q] - a[q] * b[p];
    }
}

/* The force at this time. Of older ones than are kept: the oldest. */
static const auvid_known_force_t *calibrated_at(const auvid_calibrated_t *c, uint64_t t_us)
{
    uint32_t kept = c->changes < AUVID_KNOWN_CHANGES ? c->changes : AUVID_KNOWN_CHANGES;
    const auvid_known_force_t *oldest = &calibrated_none;
    for (uint32_t back = 1; back <= kept; ++back) {
        const auvid_known_change_t *change = &c->change[(c->changes - back) % AUVID_KNOWN_CHANGES];
        if (change->t_us <= t_us) {
            return &change->force;
        }
        oldest = &change->force;
    }
    return c->changes > AUVID_KNOWN_CHANGES ? oldest : &calibrated_none;
}

static void calibrated_wrench(const auvid_known_force_t *f, const auvid_sample_t *s,
                              auvid_real_t wrench[AUVID_DOF_COUNT])
{
    const auvid_real_t *omega = s->nu + AUVID_ROLL;
    auvid_real_t r[3][3], a[3], arm[3] = {AUVID_C(0.0)};
    auvid_rotation(s->phi, s->theta, s->psi, r);
    memcpy(a, s->nu_dot, sizeof a);
    calibrated_add_cross(omega, s->nu, a);
    calibrated_add_cross(s->nu_dot + AUVID_ROLL, f->at, a);
    calibrated_add_cross(omega, f->at, arm);
    calibrated_add_cross(omega, arm, a);
    for (int i = 0; i < 3; ++i) {
        wrench[i] = f->body[i] - f->mass_kg * a[i] + r[0][i] * f->world[0] + r[1][i] * f->world[1] +
                    r[2][i] * f->world[2];
        wrench[AUVID_ROLL + i] = AUVID_C(0.0);
    }
    calibrated_add_cross(f->at, wrench, wrench + AUVID_ROLL);
}

static void calibrated_regressor(const void *context, const auvid_sample_t *sample,
                                 const auvid_real_t *pi, auvid_regressor_t *y)
{
    const auvid_calibrated_t *c = context;
    auvid_real_t wrench[AUVID_DOF_COUNT];
    c->other->regressor(c->other->context, sample, pi, y);
    calibrated_wrench(calibrated_at(c, sample->t_us), sample, wrench);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        y->row[j][c->k] = c->other->columns[j] != 0 ? -wrench[j] : AUVID_C(0.0);
    }
}

/* The supplied wrench and k times the known one act on a vehicle of k pi. A parameter whose place k
 * has is 0. */
static bool calibrated_acceleration(const void *context, const auvid_sample_t *sample,
                                    const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const auvid_calibrated_t *c = context;
    const auvid_known_force_t *force = calibrated_at(c, sample->t_us);
    int steps = force->mass_kg > AUVID_C(0.0) ? CALIBRATED_STEPS : 1;
    auvid_sample_t driven = *sample, moves = *sample;
    auvid_real_t hull[AUVID_MAX_PARAMETERS];
    bool possible = true;
    memcpy(hull, pi, c->vehicle.parameters * sizeof hull[0]);
    hull[c->k] = AUVID_C(0.0);
    for (int step = 0; step < steps && possible; ++step) {
        auvid_real_t wrench[AUVID_DOF_COUNT];
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            if (c->other->columns[j] != 0) {
                moves.nu_dot[j] = step == 0 ? AUVID_C(0.0) : nu_dot[j];
            }
        }
        calibrated_wrench(force, &moves, wrench);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            driven.tau[j] = sample->tau[j] + pi[c->k] * wrench[j];
        }
        possible = c->other->acceleration(c->other->context, &driven, hull, nu_dot);
    }
    return possible;
}

/* Place of k: behind the parameters, or else that of the last one that is not free; -1: none. */
static int calibrated_place(const auvid_vehicle_t *vehicle)
{
    int k = vehicle->parameters;
    if (k < AUVID_MAX_PARAMETERS) {
        return k;
    }
    do {
        --k;
    } while (k >= 0 && (vehicle->free == 0 || (vehicle->free >> k & 1u) != 0));
    return k;
}

auvid_status_t auvid_calibrated_init(auvid_calibrated_t *c, const auvid_vehicle_t *vehicle,
                                     auvid_dof_t dof)
{
    if (c == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_vehicle_check(vehicle);
    if (status < 0) {
        return status;
    }
    if (vehicle->regressor == NULL || vehicle->path != &auvid_path_regressor ||
        vehicle == &c->vehicle || (unsigned)dof >= AUVID_DOF_COUNT || vehicle->columns[dof] == 0) {
        return AUVID_ERR_MODEL;
    }
    int n = vehicle->parameters, k = calibrated_place(vehicle);
    if (k < 0) {
        return AUVID_ERR_PARAMETERS;
    }
    memset(c, 0, sizeof *c);
    c->other = vehicle;
    c->k = (uint8_t)k;
    memcpy(c->parameter, vehicle->parameter, (size_t)n * sizeof c->parameter[0]);
    c->parameter[k] = (auvid_parameter_t){"k_tau", "1", dof, AUVID_PARAMETER_OTHER};
    c->vehicle = *vehicle;
    c->vehicle.parameters = (uint8_t)(k < n ? n : n + 1);
    c->vehicle.parameter = c->parameter;
    c->vehicle.free |= vehicle->free != 0 ? 1u << k : 0u;
    c->vehicle.residual = NULL;
    c->vehicle.regressor = calibrated_regressor;
    c->vehicle.acceleration = vehicle->acceleration == NULL ? NULL : calibrated_acceleration;
    c->vehicle.context = c;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        c->vehicle.columns[j] |= vehicle->columns[j] != 0 ? 1u << k : 0u;
        c->vehicle.reads[j] = 0; /* the weight's inertia reads all velocities */
    }
    return AUVID_OK;
}

static bool calibrated_differ(const auvid_known_force_t *a, const auvid_known_force_t *b)
{
    bool differ = auvid_abs(a->mass_kg - b->mass_kg) > AUVID_C(0.0);
    for (int i = 0; i < 3; ++i) {
        differ = differ || auvid_abs(a->world[i] - b->world[i]) > AUVID_C(0.0) ||
                 auvid_abs(a->body[i] - b->body[i]) > AUVID_C(0.0) ||
                 auvid_abs(a->at[i] - b->at[i]) > AUVID_C(0.0);
    }
    return differ;
}

auvid_status_t auvid_calibrated_force(auvid_calibrated_t *c, uint64_t t_us,
                                      const auvid_known_force_t *force)
{
    const auvid_known_force_t *f = force != NULL ? force : &calibrated_none;
    if (c == NULL) {
        return AUVID_ERR_NULL;
    }
    if (c->other == NULL) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status = auvid_all_within(f->world, 3, LARGEST_FORCE);
    status = status == AUVID_OK ? auvid_all_within(f->body, 3, LARGEST_FORCE) : status;
    status = status == AUVID_OK ? auvid_all_within(f->at, 3, LARGEST_ARM) : status;
    status = status == AUVID_OK ? auvid_all_within(&f->mass_kg, 1, LARGEST_MASS) : status;
    if (status < 0 || f->mass_kg < AUVID_C(0.0)) {
        return status < 0 ? status : AUVID_ERR_RANGE;
    }
    auvid_known_change_t *last = &c->change[(c->changes - 1u) % AUVID_KNOWN_CHANGES];
    if (c->changes > 0 && t_us < last->t_us) {
        return AUVID_ERR_TIME_BACK;
    }
    bool close = c->changes > 0 && t_us - last->t_us < AUVID_KNOWN_SPACING_US;
    if (close) {
        last->force = *f;
    } else if (calibrated_differ(c->changes > 0 ? &last->force : &calibrated_none, f)) {
        c->change[c->changes++ % AUVID_KNOWN_CHANGES] =
            (auvid_known_change_t){.t_us = t_us, .force = *f};
    }
    return AUVID_OK;
}

void auvid_calibrated_clear(auvid_calibrated_t *c)
{
    if (c != NULL) {
        c->changes = 0;
    }
}

/* ---- conversion to SI ---- */

/* k and its errors. */
typedef struct {
    auvid_real_t k, sigma;                     /* with the prior */
    auvid_real_t prior;                        /* its variance */
    auvid_real_t shift;                        /* of x, per entry of P_k */
    auvid_real_t variance;                     /* P_kk */
    auvid_real_t column[AUVID_MAX_PARAMETERS]; /* P_k */
} calibrated_scale_t;

/* Index of an entry of a packed covariance of n parameters. */
static int calibrated_entry(int n, int i, int k)
{
    return i < k ? auvid_qr_row(n, i) + k - i : auvid_qr_row(n, k) + i - k;
}

/* Combines the k of the data with its prior. */
static void calibrated_combine(calibrated_scale_t *to, const auvid_estimate_t *estimate, int k)
{
    auvid_real_t prior = estimate->confidence.uncertainty.thrust_scale, v = to->column[k];
    auvid_real_t off = estimate->pi[k] - AUVID_C(1.0), q = auvid_max(prior * prior, off * off - v);
    to->variance = v;
    to->prior = q;
    to->shift = -off / (v + q);
    to->sigma = auvid_sqrt(v * q / (v + q));
    to->k = estimate->pi[k] + to->shift * v;
}

/* Half-width up to which a parameter was, or would have been, identifiable; 0: it has another
 * fault. */
static auvid_real_t calibrated_allowed(const auvid_estimate_t *estimate, int i)
{
    const auvid_confidence_t *c = &estimate->confidence;
    auvid_real_t sigma = c->sigma[i], thrust = c->thrust_error[i];
    if ((c->identifiable >> i & 1u) != 0) {
        return auvid_max(AUVID_CONFIDENCE_HALF_WIDTH * sigma,
                         AUVID_CONFIDENCE_IDENTIFIABLE * auvid_abs(estimate->pi[i]));
    }
    if (c->note[i] != AUVID_NOTE_THRUST_SCALE || c->unchecked) {
        return AUVID_C(0.0);
    }
    auvid_real_t most = c->bound[i] / c->uncertainty.thrust_scale * thrust;
    return AUVID_CONFIDENCE_HALF_WIDTH *
           auvid_sqrt(auvid_max(sigma * sigma - thrust * thrust, AUVID_C(0.0)) + most * most);
}

/* Sets the flag of parameter i, whose half-width may be as large as `allowed`. part: relative error
 * of k */
static void calibrated_judge(auvid_confidence_t *to, int i, auvid_real_t allowed, auvid_real_t part)
{
    auvid_real_t thrust = to->thrust_error[i], sigma = to->sigma[i];
    if (!(allowed > AUVID_C(0.0))) {
        return;
    }
    bool good = AUVID_CONFIDENCE_HALF_WIDTH * sigma <= allowed;
    to->identifiable &= ~(1u << i);
    to->identifiable |= (uint32_t)good << i;
    to->note[i] = (uint8_t)(good ? AUVID_NOTE_NONE : AUVID_NOTE_THRUST_SCALE);
    if (!good && auvid_abs(thrust) > AUVID_C(0.0)) {
        auvid_real_t most = allowed / AUVID_CONFIDENCE_HALF_WIDTH;
        auvid_real_t rest = most * most - sigma * sigma + thrust * thrust;
        to->bound[i] = part * (auvid_sqrt(auvid_max(rest, AUVID_C(0.0))) / auvid_abs(thrust));
    }
}

/* Converts parameter i. variance: given k */
static void calibrated_convert(auvid_estimate_t *si, const calibrated_scale_t *scale, int i,
                               auvid_real_t variance)
{
    const auvid_real_t *column = scale->column;
    auvid_confidence_t *c = &si->confidence;
    auvid_real_t allowed = calibrated_allowed(si, i) / scale->k;
    si->pi[i] = (si->pi[i] + column[i] * scale->shift) / scale->k;
    c->dvl_error[i] /= scale->k;
    if (!(c->sigma[i] < AUVID_LARGEST)) {
        return;
    }
    auvid_real_t thrust = scale->sigma * (si->pi[i] - column[i] / scale->variance) / scale->k;
    c->thrust_error[i] = thrust;
    c->sigma[i] = auvid_sqrt(variance + thrust * thrust + c->dvl_error[i] * c->dvl_error[i]);
    calibrated_judge(c, i, allowed, scale->sigma / scale->k);
}

/* Converts the covariance, and with it the parameters. */
static void calibrated_convert_all(auvid_estimate_t *si, const calibrated_scale_t *scale, int n,
                                   int k)
{
    auvid_real_t square = scale->k * scale->k, part = scale->sigma / scale->k;
    const auvid_real_t *column = scale->column;
    auvid_confidence_t *c = &si->confidence;
    for (int i = 0; i < n; ++i) {
        auvid_real_t *row = si->covariance + calibrated_entry(n, i, i);
        for (int l = i; l < n; ++l) { /* given k, its own entries are 0 */
            bool own = i == k || l == k;
            row[l - i] -= own ? row[l - i] : column[i] * column[l] / scale->variance;
            row[l - i] /= square;
        }
        row[0] = auvid_max(row[0], AUVID_C(0.0));
        if (i != k && (si->identified >> i & 1u) != 0) {
            calibrated_convert(si, scale, i, row[0]);
        }
    }
    bool shown = si->sets > 0 && scale->variance <= scale->prior &&
                 AUVID_CONFIDENCE_HALF_WIDTH * part <= AUVID_CONFIDENCE_IDENTIFIABLE;
    si->pi[k] = scale->k;
    c->sigma[k] = scale->sigma;
    c->thrust_error[k] = -scale->sigma;
    c->dvl_error[k] = AUVID_C(0.0);
    c->identifiable &= ~(1u << k);
    c->identifiable |= (uint32_t)(shown && !c->unchecked) << k;
    c->uncertainty.thrust_scale = part;
}

/* Is the force as given possible: is k, and are the masses in SI not below the dry mass? Their
 * half-widths are those of the supplied thrust's unit, with its considered scale. */
static bool calibrated_is_possible(const auvid_calibrated_t *c, const auvid_estimate_t *estimate,
                                   const calibrated_scale_t *scale)
{
    bool possible = scale->k >= LEAST_K && scale->k <= LARGEST_K;
    for (int i = 0; i < c->vehicle.parameters && possible; ++i) {
        auvid_real_t mass = estimate->pi[i] + scale->column[i] * scale->shift;
        auvid_real_t half = AUVID_CONFIDENCE_HALF_WIDTH * estimate->confidence.sigma[i];
        possible = c->parameter[i].kind != AUVID_PARAMETER_MASS ||
                   (estimate->identified >> i & 1u) == 0 ||
                   mass + half >= scale->k * c->dry_mass_kg;
    }
    return possible;
}

/* The data do not show k. A force that never changed is in the constant forces. */
static void calibrated_leave(const auvid_calibrated_t *c, auvid_estimate_t *si)
{
    auvid_confidence_t *to = &si->confidence;
    si->pi[c->k] = AUVID_C(1.0);
    to->sigma[c->k] = AUVID_LARGEST;
    for (int i = 0; i < c->vehicle.parameters && c->changes > 0; ++i) {
        if (c->parameter[i].kind == AUVID_PARAMETER_FORCE && (si->identified >> i & 1u) != 0) {
            to->identifiable &= ~(1u << i);
            to->note[i] = AUVID_NOTE_COMBINATION;
            to->partner[i] = c->k;
        }
    }
}

auvid_status_t auvid_calibrated_estimate(const auvid_calibrated_t *c,
                                         const auvid_estimate_t *estimate, auvid_estimate_t *si)
{
    if (c == NULL || estimate == NULL || si == NULL) {
        return AUVID_ERR_NULL;
    }
    if (c->other == NULL) {
        return AUVID_ERR_STATE;
    }
    if (estimate->number == 0) {
        return AUVID_ERR_NO_DATA;
    }
    const int n = c->vehicle.parameters, k = c->k;
    calibrated_scale_t scale = {.k = AUVID_C(1.0)};
    for (int i = 0; i < n && i < AUVID_MAX_PARAMETERS; ++i) { /* which n never exceeds */
        scale.column[i] = estimate->covariance[calibrated_entry(n, i, k)];
    }
    bool seen = (estimate->identified >> k & 1u) != 0 && scale.column[k] > AUVID_C(0.0) &&
                estimate->confidence.sigma[k] < AUVID_LARGEST;
    if (seen) {
        calibrated_combine(&scale, estimate, k);
        seen = scale.variance <= LARGEST_VARIANCE * scale.prior;
    }
    if (seen && !calibrated_is_possible(c, estimate, &scale)) {
        return AUVID_ERR_RANGE;
    }
    memmove(si, estimate, sizeof *si);
    if (!seen) {
        calibrated_leave(c, si);
        return AUVID_UNUSED;
    }
    calibrated_convert_all(si, &scale, n, k);
    return AUVID_OK;
}
