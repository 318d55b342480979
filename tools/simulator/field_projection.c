/*
 * Truth of a field run: least squares of the true hull force on the two drag columns.
 */
#include "field_projection.h"

#include <math.h>
#include <string.h>

enum { LINEAR, QUADRATIC, DRAG, TOLD, DELIVERED };

/* Smallest 1 - cosine squared of the two drag columns at which they determine a pair. */
#define ALIKE 1e-6

static const int dof_of[FIELD_EQUATIONS] = {0, 1, 2, 5};

/* Index of the linear drag of each equation; the quadratic drag follows. */
static const int drag_of[FIELD_EQUATIONS] = {SIM_X_U, SIM_Y_V, SIM_Z_W, SIM_N_R};

int field_equation(int i)
{
    static const int equation[SIM_PARAMETERS] = {
        [SIM_M_U] = 0,  [SIM_M_V] = 1,  [SIM_M_W] = 2, [SIM_M_R] = 3,  [SIM_WB] = 2,
        [SIM_X_U] = 0,  [SIM_X_UU] = 0, [SIM_Y_V] = 1, [SIM_Y_VV] = 1, [SIM_Z_W] = 2,
        [SIM_Z_WW] = 2, [SIM_N_R] = 3,  [SIM_N_RR] = 3};
    return equation[i];
}

int field_dof(int equation)
{
    return dof_of[equation];
}

/* Hull force minus masses, Coriolis and W-B of Eq. 12-15, with m_w w p in Eq. 13. */
static void find_drag(const field_truth_t *t, const double *m, double drag[FIELD_EQUATIONS])
{
    const double u = t->nu[0], v = t->nu[1], w = t->nu[2];
    const double p = t->nu[3], q = t->nu[4], r = t->nu[5];
    const double *dot = t->nu_dot, phi = t->euler[0], theta = t->euler[1];
    drag[0] = t->hull[0] - (m[SIM_M_U] * dot[0] - m[SIM_M_V] * v * r + m[SIM_M_W] * w * q +
                            m[SIM_WB] * sin(theta));
    drag[1] = t->hull[1] - (m[SIM_M_V] * dot[1] - m[SIM_M_W] * w * p + m[SIM_M_U] * u * r -
                            m[SIM_WB] * cos(theta) * sin(phi));
    drag[2] = t->hull[2] - (m[SIM_M_W] * dot[2] - m[SIM_M_U] * u * q + m[SIM_M_V] * v * p -
                            m[SIM_WB] * cos(theta) * cos(phi));
    drag[3] = t->hull[5] - (m[SIM_M_R] * dot[5] - (m[SIM_M_U] - m[SIM_M_V]) * u * v);
}

void field_projection_add(field_projection_t *projection, const field_truth_t *truth,
                          const field_built_t *built)
{
    double drag[FIELD_EQUATIONS];
    find_drag(truth, built->parameter, drag);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        int j = dof_of[e];
        double nu = truth->nu[j], *speed = projection->speed[e];
        const double c[FIELD_COLUMNS] = {-nu, -fabs(nu) * nu, drag[e], truth->reported[j],
                                         truth->delivered[j]};
        for (int a = 0; a < FIELD_COLUMNS; ++a) {
            for (int b = 0; b < FIELD_COLUMNS; ++b) {
                projection->product[nu < 0.0][e][a][b] += c[a] * c[b];
            }
        }
        speed[0] = fmax(speed[0], nu);
        speed[1] = fmax(speed[1], -nu);
        projection->acceleration[e] = fmax(projection->acceleration[e], fabs(truth->nu_dot[j]));
    }
    ++projection->samples;
}

/* The two drags. */
static void project(const double (*s)[FIELD_COLUMNS], double drag[2])
{
    double square = s[LINEAR][LINEAR] * s[QUADRATIC][QUADRATIC], cross = s[LINEAR][QUADRATIC];
    double determinant = square - cross * cross;
    if (determinant > ALIKE * square) {
        drag[0] = s[LINEAR][DRAG] * s[QUADRATIC][QUADRATIC] - s[QUADRATIC][DRAG] * cross;
        drag[1] = s[QUADRATIC][DRAG] * s[LINEAR][LINEAR] - s[LINEAR][DRAG] * cross;
        drag[0] /= determinant;
        drag[1] /= determinant;
    }
}

/* Sum of the squared residuals. */
static double squares_left(const double (*s)[FIELD_COLUMNS], const double drag[2])
{
    double sum = s[DRAG][DRAG];
    for (int a = 0; a < 2; ++a) {
        sum -= 2.0 * drag[a] * s[a][DRAG];
        for (int b = 0; b < 2; ++b) {
            sum += drag[a] * drag[b] * s[a][b];
        }
    }
    return fmax(sum, 0.0);
}

/* The products of an equation in both directions. */
static void add_directions(const field_projection_t *projection, int e,
                           double sum[FIELD_COLUMNS][FIELD_COLUMNS])
{
    for (int a = 0; a < FIELD_COLUMNS; ++a) {
        for (int b = 0; b < FIELD_COLUMNS; ++b) {
            sum[a][b] = projection->product[0][e][a][b] + projection->product[1][e][a][b];
        }
    }
}

void field_projection_solve(const field_projection_t *projection, const field_built_t *built,
                            field_reference_t *reference)
{
    field_reference_t *to = reference;
    memcpy(to->si, built->parameter, sizeof to->si);
    memcpy(to->speed, projection->speed, sizeof to->speed);
    memcpy(to->acceleration, projection->acceleration, sizeof to->acceleration);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        double sum[FIELD_COLUMNS][FIELD_COLUMNS];
        add_directions(projection, e, sum);
        const double(*s)[FIELD_COLUMNS] = (const double(*)[FIELD_COLUMNS])sum;
        double n = (double)(projection->samples > 0 ? projection->samples : 1);
        project(s, to->si + drag_of[e]);
        to->gain[e] = s[TOLD][TOLD] > 0.0 ? s[DELIVERED][TOLD] / s[TOLD][TOLD] : 1.0;
        to->residual[e] = sqrt(squares_left(s, to->si + drag_of[e]) / n);
    }
    for (int back = 0; back < 2; ++back) {
        memcpy(to->one_way[back], to->si, sizeof to->si);
        for (int e = 0; e < FIELD_EQUATIONS; ++e) {
            project(projection->product[back][e], to->one_way[back] + drag_of[e]);
        }
    }
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        to->reported[i] = to->si[i] / to->gain[field_equation(i)];
    }
}

double field_drag(const double *parameter, int equation, double velocity)
{
    const double *drag = parameter + drag_of[equation];
    return (drag[0] + drag[1] * fabs(velocity)) * velocity;
}
