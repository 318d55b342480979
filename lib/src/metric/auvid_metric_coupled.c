/*
 * Metric: degrees of freedom (DoF) that only coupling moves.
 *
 * Sway of a vehicle without lateral thruster: 0 = m_v v' + m_u u r - Y_v v - Y_vv |v| v. Without a
 * wrench of its own the equation determines only ratios: its least-squares optimum is pi = 0. In a
 * joint search its noise would pull all its parameters to zero, m_u too. The scale comes from the
 * equations of the excited DoF. They contain m_u, and usually m_v: in surge as -m_v v r, in yaw as
 * (m_v - m_u) u v. So the excited DoF are searched first and without sway. Then
 *
 *     f = -(m_v v' + m_u u r)
 *
 * is a force that is known, and the equation is a regression of f on its own terms: on those whose
 * parameters are in no equation of an excited DoF. The columns of the merged R factor stand in this
 * order: own terms a, known terms b, wrench z:
 *
 *     | R_aa R_ab z_a |     R_aa pi_a = z_a - R_ab pi_b,
 *     |      R_bb z_b |     ||z_b - R_bb pi_b||^2 stays unexplained.
 *
 * The rows of R_aa are all that the equation contributes to the estimate and its covariance
 * (auvid_equation_t.rows). The equation is informative if m_u u r is as large as the wrench of an
 * excited DoF, and if its own terms explain f. The latter also limits the bias: noise of the own
 * terms makes pi_a too small by about the part of f^2 that stays unexplained.
 *
 * The equation also has an optimum of its own for m_v, given m_u. If that disagrees with the m_v of
 * the excited DoF, a force is missing or the velocity is wrong, and pi_a makes up for it. Simulated
 * with a 35 kg craft, the relative disagreement was 0.01 with a disturbance of 0.3 N and 0.03 to
 * 0.05 with 1 N. A DVL 2, 5 and 10 cm off its place gave 0.04, 0.11 and 0.22, and an error of
 * quadratic drag of 10, 25 and 55 %. A rudder whose side force was not supplied gave 0.55. So the
 * standard errors of pi_a contain twice the disagreement, and a large one makes the equation
 * useless.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

/* Largest part of f^2 that an informative equation leaves unexplained. */
#define COUPLED_UNEXPLAINED AUVID_C(0.05)
/* Largest disagreement. */
#define COUPLED_DISAGREEMENT AUVID_C(0.25)

/* Sums over the rows of DoF j's merged R factor. */
typedef struct {
    auvid_real_t driving;                /* squared force of the excited DoF's parameters */
    auvid_real_t explained, unexplained; /* squared parts of f */
    auvid_real_t shared, off;            /* squared force of the shared terms in their rows, and
                                            what another value of them would remove */
} coupled_sums_t;

/* Returns true if known parameters are part of DoF j's stored wrench. */
static bool metric_has_fixed_terms(const auvid_metric_t *m, int j)
{
    uint32_t fixed = m->cfg.vehicle->columns[j] & ~m->layout.columns[j];
    for (int i = 0; fixed != 0; ++i, fixed >>= 1) {
        if ((fixed & 1u) != 0 && !auvid_is_zero(m->cfg.fixed[i])) {
            return true;
        }
    }
    return false;
}

/* Compute the sums and the right-hand side x[rows] of the own terms. */
static coupled_sums_t metric_sum_coupled(const auvid_metric_t *m, int j, const auvid_real_t *pi,
                                         auvid_real_t *x)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    const auvid_parameter_t *of = m->cfg.vehicle->parameter;
    coupled_sums_t sum = {.unexplained = auvid_metric_unexplained(m, j)};
    bool fixed = metric_has_fixed_terms(m, j); /* else it is a constant wrench, or very small */
    sum.driving = fixed ? sum.unexplained : AUVID_C(0.0);
    for (int i = 0; i < e.count; ++i) {
        const auvid_real_t *r = auvid_equation_row(&e, i);
        auvid_real_t f = e.z[i], driving = fixed ? f : AUVID_C(0.0), shared = AUVID_C(0.0);
        for (int k = i < e.rows ? e.rows : i; k < e.count; ++k) {
            auvid_real_t force = r[k - i] * pi[e.index[k]];
            int dof = (int)of[e.index[k]].dof;
            f -= force;
            driving -= auvid_metric_is_excited(m, dof) ? force : AUVID_C(0.0);
            shared += dof == j ? force : AUVID_C(0.0);
        }
        sum.driving += driving * driving;
        *(i < e.rows ? &sum.explained : &sum.unexplained) += f * f;
        if (i < e.rows) {
            x[i] = f;
        } else if ((int)of[e.index[i]].dof == j) {
            sum.off += f * f;
            sum.shared += shared * shared;
        }
    }
    return sum;
}

/* Solve DoF j's equation for its own parameters, given the others.
 * @return is it informative? */
static bool metric_solve_coupled_dof(auvid_metric_t *m, int j, auvid_real_t *pi)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_real_t x[AUVID_MAX_PARAMETERS];
    auvid_real_t min_rms = m->cfg.excitation_threshold * m->cfg.tau_max[j];
    coupled_sums_t sum = metric_sum_coupled(m, j, pi, x);
    bool moved = sum.driving > min_rms * min_rms * (auvid_real_t)ev->coupled_rows[j];
    ev->coupled_squares[j] = sum.explained + sum.unexplained;
    ev->disagreement[j] =
        sum.shared > AUVID_C(0.0) ? auvid_sqrt(sum.off / sum.shared) : AUVID_C(0.0);
    if (!moved || !(sum.unexplained <= COUPLED_UNEXPLAINED * ev->coupled_squares[j]) ||
        !(ev->disagreement[j] <= COUPLED_DISAGREEMENT) ||
        auvid_qr_solve(e.factor, e.order, e.rows, AUVID_C(1e-4), x) > 0) {
        return false;
    }
    for (int i = 0; i < e.rows; ++i) {
        pi[e.index[i]] = x[i];
    }
    return true;
}

auvid_real_t auvid_metric_disagreement(const auvid_metric_t *m, int j, int parameter)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    for (int k = 0; k < e.rows && auvid_metric_is_coupled(m, j); ++k) {
        if (e.index[k] == parameter) {
            return AUVID_C(2.0) * m->evaluator.disagreement[j];
        }
    }
    return AUVID_C(0.0);
}

void auvid_metric_solve_coupled(auvid_metric_t *metric, auvid_real_t *pi)
{
    if (metric == NULL || pi == NULL) {
        return;
    }
    metric->result.coupled = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (auvid_metric_may_be_coupled(metric, j) && metric_solve_coupled_dof(metric, j, pi)) {
            metric->result.coupled |= (uint8_t)(1u << j);
            metric->result.dof_rows[j] = metric->evaluator.coupled_rows[j];
            auvid_metric_weigh_dof(metric, j);
        }
    }
}
