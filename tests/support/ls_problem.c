#include "ls_problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi_ = 3.14159265358979323846;
static const double dt = 0.05; /* simulation step and grid of the rows [s] */
enum {
    MAX_STEPS = 4800,
    HALF = 10,
    COLUMNS = LS_N + 1,
    DOFS = 4,
    PER_DVL = 4,
    KEEP = 10,
    PIECE = 600
};

/* Parameters: the paper's estimates for Girona500 (m_u m_v m_w m_r W-B X_u X_uu Y_v Y_vv ...). */
static const double girona[LS_N] = {249.5384,  367.7126,  659.9799, 74.9024,   -37.3058,
                                    -42.4181,  -125.3578, -75.7673, -447.6195, -44.0561,
                                    -325.0138, -20.5833,  -60.9373};

/* ---- random numbers: splitmix64, Gauss by Box-Muller ---- */
static double uniform(uint64_t *s)
{
    uint64_t x = (*s += 0x9e3779b97f4a7c15u);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return ((double)(x >> 11) + 0.5) / 9007199254740992.0;
}

static double gauss(uint64_t *s)
{
    double r = sqrt(-2.0 * log(uniform(s)));
    return r * cos(2.0 * pi_ * uniform(s));
}

/* ---- vehicle: s = [phi theta p q u v w r] ---- */
enum { PHI, THETA, P, Q, U, V, W, R, STATES };

static void derivative(const double *pi, const double *s, const double *tau, double *ds)
{
    double u = s[U], v = s[V], w = s[W], p = s[P], q = s[Q], r = s[R];
    double sp = sin(s[PHI]), cp = cos(s[PHI]), st = sin(s[THETA]), ct = cos(s[THETA]);
    ds[PHI] = p + (sp * q + cp * r) * st / ct;
    ds[THETA] = cp * q - sp * r;
    /* roll and pitch: a damped pendulum pushed by sway and surge */
    ds[P] = (-100.0 * p - 80.0 * fabs(p) * p - 180.0 * sp * ct + 0.10 * tau[1]) / 120.0;
    ds[Q] = (-100.0 * q - 80.0 * fabs(q) * q - 180.0 * st + 0.10 * tau[0]) / 120.0;
    ds[U] =
        (tau[0] + pi[1] * v * r - pi[2] * w * q - pi[4] * st + pi[5] * u + pi[6] * fabs(u) * u) /
        pi[0];
    ds[V] = (tau[1] + pi[2] * w * p - pi[0] * u * r + pi[4] * ct * sp + pi[7] * v +
             pi[8] * fabs(v) * v) /
            pi[1];
    ds[W] = (tau[2] + pi[0] * u * q - pi[1] * v * p + pi[4] * ct * cp + pi[9] * w +
             pi[10] * fabs(w) * w) /
            pi[2];
    ds[R] = (tau[3] + (pi[0] - pi[1]) * u * v + pi[11] * r + pi[12] * fabs(r) * r) / pi[3];
}

static void rk4(const double *pi, double *s, const double *tau)
{
    double k[4][STATES], t[STATES];
    derivative(pi, s, tau, k[0]);
    for (int stage = 1; stage < 4; ++stage) {
        double h = stage == 3 ? dt : 0.5 * dt;
        for (int i = 0; i < STATES; ++i) {
            t[i] = s[i] + h * k[stage - 1][i];
        }
        derivative(pi, t, tau, k[stage]);
    }
    for (int i = 0; i < STATES; ++i) {
        s[i] += dt / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
}

/* One row of Eq. 12-15 per DoF, the wrench in the last column. nu_dot = [u v w r]'. */
static void rows_of(const double *s, const double *nu_dot, const double *tau,
                    double row[DOFS][COLUMNS])
{
    double u = s[U], v = s[V], w = s[W], p = s[P], q = s[Q], r = s[R];
    double sp = sin(s[PHI]), cp = cos(s[PHI]), st = sin(s[THETA]), ct = cos(s[THETA]);
    memset(row, 0, sizeof(double) * DOFS * COLUMNS);
    row[0][0] = nu_dot[0], row[0][1] = -v * r, row[0][2] = w * q, row[0][4] = st;
    row[0][5] = -u, row[0][6] = -fabs(u) * u;
    row[1][1] = nu_dot[1], row[1][2] = -w * p, row[1][0] = u * r, row[1][4] = -ct * sp;
    row[1][7] = -v, row[1][8] = -fabs(v) * v;
    row[2][2] = nu_dot[2], row[2][0] = -u * q, row[2][1] = v * p, row[2][4] = -ct * cp;
    row[2][9] = -w, row[2][10] = -fabs(w) * w;
    row[3][3] = nu_dot[3], row[3][0] = -u * v, row[3][1] = u * v;
    row[3][11] = -r, row[3][12] = -fabs(r) * r;
    for (int d = 0; d < DOFS; ++d) {
        row[d][LS_N] = tau[d];
    }
}

typedef struct {
    double tau[MAX_STEPS][DOFS];
    double truth[MAX_STEPS][STATES];
    double seen[MAX_STEPS][STATES];
    double rows[MAX_STEPS][DOFS][COLUMNS];
    double sum[MAX_STEPS][DOFS][COLUMNS];
} work_t;

/* Pieces of 30 s: alternately steps held 4-8 s and five sines of 0.03-0.25 Hz. */
static void excite(work_t *w, int steps, uint64_t *rng)
{
    static const double peak[DOFS] = {100.0, 100.0, 100.0, 40.0};
    static const double hover[DOFS] = {0.0, 0.0, 37.3, 0.0};
    for (int d = 0; d < DOFS; ++d) {
        double f[5], a[5], level = 0.0;
        int until = 0;
        for (int k = 0; k < steps; ++k) {
            double sines = 0.0;
            for (int j = 0; j < 5; ++j) {
                if (k % PIECE == 0) {
                    f[j] = 0.03 + 0.22 * uniform(rng);
                    a[j] = 2.0 * pi_ * uniform(rng);
                }
                sines += sin(2.0 * pi_ * f[j] * dt * k + a[j]) / 3.0;
            }
            if (k >= until) {
                until = k + (int)((4.0 + 4.0 * uniform(rng)) / dt);
                level = 2.0 * uniform(rng) - 1.0;
            }
            w->tau[k][d] = hover[d] + peak[d] * (k / PIECE % 2 ? sines : level);
        }
    }
}

static void simulate(work_t *w, int steps, const double *pi, uint64_t *rng)
{
    static const double rms[DOFS] = {1.0, 1.0, 1.0, 0.4};
    double s[STATES] = {0}, force[DOFS], a = exp(-dt / 2.0);
    for (int d = 0; d < DOFS; ++d) {
        force[d] = rms[d] * gauss(rng);
    }
    for (int k = 0; k < steps; ++k) {
        double tau[DOFS];
        memcpy(w->truth[k], s, sizeof s);
        for (int d = 0; d < DOFS; ++d) {
            force[d] = a * force[d] + rms[d] * sqrt(1.0 - a * a) * gauss(rng);
            tau[d] = w->tau[k][d] + force[d];
        }
        rk4(pi, s, tau);
    }
}

static void measure(work_t *w, int steps, uint64_t *rng)
{
    static const double noise[STATES] = {0.0035, 0.0035, 0.00175, 0.00175,
                                         0.007,  0.007,  0.007,   0.00175};
    for (int k = 0; k < steps; ++k) {
        for (int i = 0; i < STATES; ++i) {
            w->seen[k][i] = w->truth[k][i] + noise[i] * gauss(rng);
        }
    }
    for (int k = 0; k + PER_DVL < steps; k += PER_DVL) { /* velocity comes at 5 Hz */
        for (int j = 1; j < PER_DVL; ++j) {
            double f = (double)j / PER_DVL;
            for (int i = U; i <= W; ++i) {
                w->seen[k + j][i] = (1.0 - f) * w->seen[k][i] + f * w->seen[k + PER_DVL][i];
            }
        }
    }
}

/* Moving average over 2 HALF + 1, valid for [first, last). */
static void smooth(double (*in)[DOFS][COLUMNS], double (*out)[DOFS][COLUMNS], int first, int last)
{
    double acc[DOFS * COLUMNS] = {0};
    for (int k = first - HALF; k < last + HALF; ++k) {
        for (int j = 0; j < DOFS * COLUMNS; ++j) {
            acc[j] += (&in[k][0][0])[j];
            if (k - 2 * HALF - 1 >= first - HALF) {
                acc[j] -= (&in[k - 2 * HALF - 1][0][0])[j];
            }
            if (k - HALF >= first) {
                (&out[k - HALF][0][0])[j] = acc[j] / (2 * HALF + 1);
            }
        }
    }
}

/* Rotate one row into the R factor (Givens). */
static void absorb(double t[COLUMNS][COLUMNS], double *row)
{
    for (int i = 0; i < COLUMNS; ++i) {
        double h = hypot(t[i][i], row[i]);
        if (!(h > 0.0)) {
            continue;
        }
        double c = t[i][i] / h, s = row[i] / h;
        for (int j = i; j < COLUMNS; ++j) {
            double x = t[i][j];
            t[i][j] = c * x + s * row[j];
            row[j] = c * row[j] - s * x;
        }
    }
}

static int finish(ls_problem_t *p, double t[COLUMNS][COLUMNS])
{
    for (int i = LS_N - 1; i >= 0; --i) {
        if (!(fabs(t[i][i]) > 1e-12)) {
            return -1;
        }
        double x = p->z[i] = t[i][LS_N];
        for (int j = i; j < LS_N; ++j) {
            p->r[i][j] = t[i][j];
            x -= j > i ? t[i][j] * p->optimum[j] : 0.0;
        }
        p->optimum[i] = x / t[i][i];
    }
    p->constant = t[LS_N][LS_N] * t[LS_N][LS_N];
    for (int i = 0, k = 0; i < LS_N; ++i) {
        p->zf[i] = (float)p->z[i];
        for (int j = 0; j < LS_N; ++j) {
            p->column[j] += p->r[i][j] * p->r[i][j];
            if (j >= i) {
                p->rf[k++] = (float)p->r[i][j];
            }
        }
    }
    for (int j = 0; j < LS_N; ++j) {
        p->column[j] = sqrt(p->column[j]);
    }
    return 0;
}

int ls_problem_make(ls_problem_t *p, uint64_t seed)
{
    uint64_t rng = seed * 1000003u + 17u;
    double pi[LS_N], t[COLUMNS][COLUMNS] = {{0}}, weight[DOFS] = {0};
    int steps = (int)((120.0 + 120.0 * uniform(&rng)) / dt);
    work_t *w = calloc(1, sizeof *w);
    if (w == NULL) {
        return -1;
    }
    memset(p, 0, sizeof *p);
    for (int i = 0; i < LS_N; ++i) {
        pi[i] = girona[i] * (0.8 + 0.4 * uniform(&rng));
    }
    excite(w, steps, &rng);
    simulate(w, steps, pi, &rng);
    measure(w, steps, &rng);
    for (int k = 1; k < steps - 1; ++k) {
        double acceleration[DOFS];
        for (int d = 0; d < DOFS; ++d) {
            acceleration[d] = (w->seen[k + 1][U + d] - w->seen[k - 1][U + d]) / (2.0 * dt);
        }
        rows_of(w->seen[k], acceleration, w->tau[k], w->rows[k]);
    }
    smooth(w->rows, w->sum, 1 + HALF, steps - 1 - HALF);
    smooth(w->sum, w->rows, 1 + 2 * HALF, steps - 1 - 2 * HALF);
    for (int k = 1 + 2 * HALF; k < steps - 1 - 2 * HALF; k += KEEP) {
        for (int d = 0; d < DOFS; ++d) {
            weight[d] += DOFS * w->rows[k][d][LS_N] * w->rows[k][d][LS_N];
        }
    }
    for (int k = 1 + 2 * HALF; k < steps - 1 - 2 * HALF; k += KEEP) {
        for (int d = 0; d < DOFS; ++d) {
            for (int j = 0; j < COLUMNS; ++j) {
                w->rows[k][d][j] /= sqrt(weight[d]);
            }
            absorb(t, w->rows[k][d]);
        }
    }
    free(w);
    return finish(p, t);
}

float ls_problem_cost(ls_problem_t *p, const float *theta)
{
    float sum = 0.0f;
    ++p->evaluations;
    for (int i = 0, k = 0; i < LS_N; ++i) {
        float e = -p->zf[i];
        for (int j = i; j < LS_N; ++j) {
            e += p->rf[k++] * theta[j];
        }
        sum += e * e;
    }
    return sum;
}

double ls_problem_cost_double(const ls_problem_t *p, const double *theta)
{
    double sum = 0.0;
    for (int i = 0; i < LS_N; ++i) {
        double e = -p->z[i];
        for (int j = i; j < LS_N; ++j) {
            e += p->r[i][j] * theta[j];
        }
        sum += e * e;
    }
    return sum;
}
