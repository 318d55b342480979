/**
 * @file ls_problem.h
 * Test support: least-squares problems as in a recorded identification, one per seed.
 *
 * A Girona500-like vehicle (paper, Eq. 12-15 with m_w w p in sway; the 13 parameters of the paper,
 * each varied by +-20 %) is excited with steps and sums of sines of 100 N and 40 Nm in surge, sway,
 * heave and yaw for 120-240 s. A coloured force of 1 N rms (0.4 Nm, 2 s) disturbs it. Noise
 * enters attitude (0.2 deg), rates (0.1 deg/s) and velocity (7 mm/s at 5 Hz, interpolated);
 * accelerations are central differences of the noisy velocity. Rows and wrench pass the same
 * smoother (2 s triangle), are kept at 2 Hz and factorised (QR) in double:
 *     J(pi) = |R pi - z|^2 + constant,  weights such that J(0) ~ 1.
 * It shares no code with the library: double, libm, other random numbers.
 */
#ifndef LS_PROBLEM_H
#define LS_PROBLEM_H

#include <stdint.h>

enum { LS_N = 13 };

typedef struct {
    double r[LS_N][LS_N];            /**< upper triangular */
    double z[LS_N];                  /**< right-hand side */
    double constant;                 /**< residual of the optimum, J* */
    double optimum[LS_N];            /**< least-squares parameters */
    double column[LS_N];             /**< norms of the columns of R */
    float rf[LS_N * (LS_N + 1) / 2]; /**< r packed by rows, as in an embedded metric */
    float zf[LS_N];
    unsigned long evaluations; /**< calls of ls_problem_cost so far */
} ls_problem_t;

/** Build the problem of this seed; about 3 ms. Returns 0, or -1 if the data are degenerate. */
int ls_problem_make(ls_problem_t *p, uint64_t seed);

/** |R theta - z|^2 in float32, without the constant. */
float ls_problem_cost(ls_problem_t *p, const float *theta);

/** The same in double. */
double ls_problem_cost_double(const ls_problem_t *p, const double *theta);

#endif
