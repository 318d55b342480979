/*
 * Truth of a run in the field: least squares of the true hull force on the two drag columns.
 */
#include "field_projection.h"

#include <math.h>
#include <string.h>

/* Columns after those of the parameters. */
enum { HULL = SIM_PARAMETERS, TOLD, DELIVERED };

/* The two drag columns determine a pair when they are less alike than this (1 - cosine squared). */
#define ALIKE 1e-6

static const int dof_of[FIELD_EQUATIONS] = {0, 1, 2, 5};

/* Linear drag of each equation; the quadratic one follows. */
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

/* Columns of Eq. 12-15, with m_w w p in Eq. 13. */
static void fill_columns(const field_truth_t *t, double c[FIELD_EQUATIONS][FIELD_COLUMNS])
{
    const double u = t->nu[0], v = t->nu[1], w = t->nu[2];
    const double p = t->nu[3], q = t->nu[4], r = t->nu[5];
    memset(c, 0, FIELD_EQUATIONS * sizeof c[0]);
    c[0][SIM_M_V] = -v * r;
    c[0][SIM_M_W] = w * q;
    c[0][SIM_WB] = sin(t->euler[1]);
    c[1][SIM_M_U] = u * r;
    c[1][SIM_M_W] = -w * p;
    c[1][SIM_WB] = -cos(t->euler[1]) * sin(t->euler[0]);
    c[2][SIM_M_U] = -u * q;
    c[2][SIM_M_V] = v * p;
    c[2][SIM_WB] = -cos(t->euler[1]) * cos(t->euler[0]);
    c[3][SIM_M_U] = -u * v;
    c[3][SIM_M_V] = u * v;
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        int j = dof_of[e];
        c[e][SIM_M_U + e] = t->nu_dot[j];
        c[e][drag_of[e]] = -t->nu[j];
        c[e][drag_of[e] + 1] = -fabs(t->nu[j]) * t->nu[j];
        c[e][HULL] = t->hull[j];
        c[e][TOLD] = t->told[j];
        c[e][DELIVERED] = t->delivered[j];
    }
}

void field_projection_add(field_projection_t *projection, const field_truth_t *truth)
{
    double c[FIELD_EQUATIONS][FIELD_COLUMNS];
    fill_columns(truth, c);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        int j = dof_of[e];
        double *speed = projection->speed[e];
        for (int a = 0; a < FIELD_COLUMNS; ++a) {
            for (int b = 0; b < FIELD_COLUMNS; ++b) {
                projection->product[e][a][b] += c[e][a] * c[e][b];
            }
        }
        speed[0] = fmax(speed[0], truth->nu[j]);
        speed[1] = fmax(speed[1], -truth->nu[j]);
        projection->acceleration[e] = fmax(projection->acceleration[e], fabs(truth->nu_dot[j]));
    }
    ++projection->samples;
}

/* The two drags of equation e into parameter, which has the rest. */
static void project(const double (*s)[FIELD_COLUMNS], int e, double *parameter)
{
    int d = drag_of[e];
    double right[2];
    for (int k = 0; k < 2; ++k) {
        right[k] = s[d + k][HULL];
        for (int i = SIM_M_U; i <= SIM_WB; ++i) {
            right[k] -= s[d + k][i] * parameter[i];
        }
    }
    double square = s[d][d] * s[d + 1][d + 1], cross = s[d][d + 1];
    double determinant = square - cross * cross;
    if (determinant > ALIKE * square) {
        parameter[d] = (right[0] * s[d + 1][d + 1] - right[1] * cross) / determinant;
        parameter[d + 1] = (right[1] * s[d][d] - right[0] * cross) / determinant;
    }
}

/* Sum of the squares of hull - columns . parameter. */
static double squares_left(const double (*s)[FIELD_COLUMNS], const double *parameter)
{
    double sum = s[HULL][HULL];
    for (int a = 0; a < SIM_PARAMETERS; ++a) {
        sum -= 2.0 * parameter[a] * s[a][HULL];
        for (int b = 0; b < SIM_PARAMETERS; ++b) {
            sum += parameter[a] * parameter[b] * s[a][b];
        }
    }
    return fmax(sum, 0.0);
}

void field_projection_solve(const field_projection_t *projection, const field_built_t *built,
                            field_reference_t *reference)
{
    field_reference_t *to = reference;
    memcpy(to->si, built->parameter, sizeof to->si);
    memcpy(to->speed, projection->speed, sizeof to->speed);
    memcpy(to->acceleration, projection->acceleration, sizeof to->acceleration);
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        const double(*s)[FIELD_COLUMNS] = projection->product[e];
        double n = (double)(projection->samples > 0 ? projection->samples : 1);
        project(s, e, to->si);
        to->gain[e] = s[TOLD][TOLD] > 0.0 ? s[DELIVERED][TOLD] / s[TOLD][TOLD] : 1.0;
        to->residual[e] = sqrt(squares_left(s, to->si) / n);
    }
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        to->told[i] = to->si[i] / to->gain[field_equation(i)];
    }
}

double field_drag(const double *parameter, int equation, double velocity)
{
    const double *drag = parameter + drag_of[equation];
    return (drag[0] + drag[1] * fabs(velocity)) * velocity;
}
