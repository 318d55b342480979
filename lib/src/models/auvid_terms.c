/*
 * A vehicle model as a table of terms. Equation j is
 *
 *     tau_j = sum of  sign f1 f2 f3 pi_i   over its terms,
 *
 * so the row entry of parameter i is the sum of its terms' sign f1 f2 f3. For the acceleration the
 * terms with a factor nu'_k form M_jk:
 *
 *     M nu' = tau - (all other terms)
 */
#include <string.h>

#include "auvid/vehicle.h"
#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

enum { TERM_FACTORS = sizeof(((auvid_term_t *)0)->factor) };

/* ---- the model's functions ---- */

/* The values of all factors that the table has; nu_dot: the accelerations. */
static void terms_values(const auvid_terms_t *terms, const auvid_sample_t *s,
                         const auvid_real_t *nu_dot, auvid_real_t value[AUVID_FACTOR_COUNT])
{
    const auvid_real_t angle[3] = {s->phi, s->theta, s->psi};
    value[AUVID_FACTOR_ONE] = AUVID_C(1.0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        value[AUVID_FACTOR_U + j] = s->nu[j];
        value[AUVID_FACTOR_ABS_U + j] = auvid_abs(s->nu[j]);
        value[AUVID_FACTOR_U_DOT + j] = nu_dot[j];
    }
    for (int i = 0; i < 3; ++i) {
        int at = AUVID_FACTOR_SIN_PHI + 2 * i;
        if ((terms->factors >> at & 3u) != 0) {
            auvid_sincos(angle[i], value + at, value + at + 1);
        }
    }
    /* in units of 1024 us: no conversion of 64 bits */
    int32_t elapsed = (int32_t)(uint32_t)((s->t_us - terms->begin_us) >> 10);
    value[AUVID_FACTOR_TIME] = AUVID_C(1.024e-3) * (auvid_real_t)elapsed;
}

static auvid_real_t terms_product(const auvid_term_t *term, const auvid_real_t *value)
{
    const uint8_t *f = term->factor;
    auvid_real_t product = value[f[0]] * value[f[1]] * value[f[2]];
    return term->sign < 0 ? -product : product;
}

static void terms_regressor(const void *context, const auvid_sample_t *sample,
                            const auvid_real_t *pi, auvid_regressor_t *y)
{
    const auvid_terms_t *terms = context;
    auvid_real_t value[AUVID_FACTOR_COUNT];
    (void)pi;
    terms_values(terms, sample, sample->nu_dot, value);
    const auvid_term_t *term = terms->table->term;
    for (int k = terms->table->terms; k > 0; --k, ++term) {
        y->row[term->dof][term->parameter] += terms_product(term, value);
    }
}

/* Returns the DoF of the acceleration in a term; -1: there is none. */
static int terms_accelerated(const auvid_term_t *term)
{
    int dof = -1;
    for (int i = 0; i < TERM_FACTORS; ++i) {
        int j = term->factor[i] - AUVID_FACTOR_U_DOT;
        dof = j >= 0 && j < AUVID_DOF_COUNT ? j : dof;
    }
    return dof;
}

/* Solves M x = b in place, b in x, by elimination in the order of the DoF. The pivots are positive
 * if the symmetric part of M is positive definite; x is not finite where they are not, and in the
 * DoF that are coupled to it. */
static void terms_solve(auvid_real_t m[AUVID_DOF_COUNT][AUVID_DOF_COUNT], auvid_real_t *x)
{
    auvid_real_t min_pivot[AUVID_DOF_COUNT];
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        min_pivot[i] = AUVID_EPSILON * auvid_max(m[i][i], AUVID_C(0.0));
    }
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        m[i][i] = m[i][i] > min_pivot[i] ? m[i][i] : AUVID_C(0.0);
        for (int j = i + 1; j < AUVID_DOF_COUNT; ++j) {
            if (auvid_is_zero(m[j][i])) {
                continue;
            }
            auvid_real_t part = m[j][i] / m[i][i];
            for (int k = i + 1; k < AUVID_DOF_COUNT; ++k) {
                m[j][k] -= part * m[i][k];
            }
            x[j] -= part * x[i];
        }
    }
    for (int i = AUVID_DOF_COUNT - 1; i >= 0; --i) {
        for (int k = i + 1; k < AUVID_DOF_COUNT; ++k) {
            x[i] -= auvid_is_zero(m[i][k]) ? AUVID_C(0.0) : m[i][k] * x[k];
        }
        x[i] /= m[i][i];
    }
}

static bool terms_acceleration(const void *context, const auvid_sample_t *sample,
                               const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const auvid_terms_t *terms = context;
    auvid_real_t value[AUVID_FACTOR_COUNT], unit[AUVID_DOF_COUNT];
    auvid_real_t m[AUVID_DOF_COUNT][AUVID_DOF_COUNT] = {{AUVID_C(0.0)}};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) { /* not modelled: written as 0 */
        bool modelled = terms->vehicle.columns[j] != 0;
        m[j][j] = modelled ? AUVID_C(0.0) : AUVID_C(1.0);
        nu_dot[j] = modelled ? sample->tau[j] : AUVID_C(0.0);
        unit[j] = modelled ? AUVID_C(1.0) : sample->nu_dot[j];
    }
    terms_values(terms, sample, unit, value);
    const auvid_term_t *term = terms->table->term;
    for (int k = terms->table->terms; k > 0; --k, ++term) {
        int j = terms_accelerated(term);
        auvid_real_t wrench = terms_product(term, value) * pi[term->parameter];
        if (j >= 0 && terms->vehicle.columns[j] != 0) {
            m[term->dof][j] += wrench;
        } else {
            nu_dot[term->dof] -= wrench;
        }
    }
    terms_solve(m, nu_dot);
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        any = any || (terms->vehicle.columns[j] != 0 && auvid_is_finite(nu_dot[j]));
    }
    return any;
}

/* ---- init ---- */

/* Returns a number that is equal for two terms if and only if their factors are, in any order. The
 * low bits say which factors there are, and the others sum them: a a b is not a b b. */
static uint32_t terms_factors(const auvid_term_t *term)
{
    uint32_t key = 0, sum = 0;
    for (int i = 0; i < TERM_FACTORS; ++i) {
        key |= (uint32_t)1 << term->factor[i];
        sum += term->factor[i];
    }
    return key | sum << AUVID_FACTOR_COUNT;
}

_Static_assert(AUVID_FACTOR_COUNT <= 27, "differences of two factors are below 2^(32 - COUNT)");

/* Checks term k. */
static void terms_check(const auvid_term_table_t *table, int k, auvid_refusal_t *why)
{
    static const auvid_field_t field[] = {
        WHOLE_IN(auvid_term_t, dof, 1, 0, AUVID_DOF_COUNT - 1),
        WHOLE_IN(auvid_term_t, factor, TERM_FACTORS, 0, AUVID_FACTOR_COUNT - 1)};
    const auvid_term_t *term = table->term + k;
    int accelerations = 0;
    auvid_check_element(why, k);
    auvid_check_in(why, "parameter", term->parameter, AUVID_C(0.0),
                   (auvid_real_t)(table->parameters - 1));
    auvid_check_that(why, term->sign == 1 || term->sign == -1, AUVID_ERR_RANGE, "sign");
    AUVID_CHECK_TABLE(why, term, field);
    for (int i = 0; i < TERM_FACTORS; ++i) {
        int f = term->factor[i];
        accelerations += f >= AUVID_FACTOR_U_DOT && f <= AUVID_FACTOR_R_DOT;
    }
    auvid_check_that(why, accelerations <= 1, AUVID_ERR_MODEL, "factor");
    for (int i = 0; i < k && why->status == AUVID_OK; ++i) {
        const auvid_term_t *other = table->term + i;
        bool same = other->parameter == term->parameter && other->dof == term->dof &&
                    terms_factors(other) == terms_factors(term);
        auvid_check_that(why, !same, AUVID_ERR_MODEL, "");
    }
}

/* Enters term k into the masks. */
static void terms_add(auvid_terms_t *terms, int k)
{
    const auvid_term_t *term = terms->table->term + k;
    auvid_vehicle_t *vehicle = &terms->vehicle;
    unsigned reads = 1u << term->dof;
    vehicle->columns[term->dof] |= (uint32_t)1 << term->parameter;
    for (int i = 0; i < TERM_FACTORS; ++i) {
        int f = term->factor[i];
        terms->factors |= (uint32_t)1 << f;
        if (f >= AUVID_FACTOR_U && f <= AUVID_FACTOR_R_DOT) {
            reads |= 1u << (f - AUVID_FACTOR_U) % AUVID_DOF_COUNT;
        }
    }
    vehicle->reads[term->dof] = (uint8_t)(vehicle->reads[term->dof] | reads);
}

/* Makes the model in *terms, as far as the checks succeed. */
static void terms_make(auvid_terms_t *terms, const auvid_term_table_t *table, auvid_refusal_t *why)
{
    if (table == NULL || table->parameter == NULL || table->term == NULL) {
        auvid_check_that(why, false, AUVID_ERR_NULL,
                         table == NULL              ? ""
                         : table->parameter == NULL ? "parameter"
                                                    : "term");
        return;
    }
    auvid_check_count(why, AUVID_ERR_PARAMETERS, "parameters", table->parameters,
                      AUVID_MAX_PARAMETERS);
    auvid_check_count(why, AUVID_ERR_SIZE, "terms", table->terms, UINT16_MAX);
    *terms = (auvid_terms_t){.vehicle = {.built_for = AUVID_BUILD,
                                         .path = &auvid_path_regressor,
                                         .name = table->name,
                                         .parameters = table->parameters,
                                         .parameter = table->parameter,
                                         .regressor = terms_regressor,
                                         .acceleration = terms_acceleration},
                             .table = table};
    auvid_check_part(why, "term");
    for (int k = 0; why->status == AUVID_OK && k < table->terms; ++k) {
        terms_check(table, k, why);
        if (why->status == AUVID_OK) {
            terms_add(terms, k);
        }
    }
    auvid_check_part(why, "parameter");
    for (int i = 0; why->status == AUVID_OK && i < table->parameters; ++i) {
        auvid_dof_t dof = table->parameter[i].dof;
        auvid_check_element(why, i);
        auvid_check_that(
            why, (unsigned)dof < AUVID_DOF_COUNT && (terms->vehicle.columns[dof] >> i & 1u) != 0,
            AUVID_ERR_MODEL, "dof");
    }
}

auvid_status_t auvid_terms_init(auvid_terms_t *terms, const auvid_term_table_t *table,
                                auvid_refusal_t *refusal)
{
    auvid_terms_t made;
    auvid_refusal_t why;
    auvid_check_begin(&why);
    auvid_check_that(&why, terms != NULL, AUVID_ERR_NULL, "");
    terms_make(&made, table, &why);
    if (terms != NULL && why.status == AUVID_OK) {
        *terms = made;
        terms->vehicle.context = terms;
    }
    if (refusal != NULL) {
        *refusal = why;
    }
    return why.status;
}
