/*
 * Rates over windows of half a second, and the sums of their products. The difference of the means
 * of two cells is the integral of the rate, weighted by a trapezium: the rate's samples are
 * averaged with the same weights.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

#define WINDOW_S (DOCTOR_WINDOW * DOCTOR_CELL_S)
#define HISTORY (2 * DOCTOR_LAGS + 2 * DOCTOR_WINDOW) /* cells that a product looks back */
#define BLOCK_CELLS 100                               /* of a block at the start */

static const doctor_cell_t *cell_before(const doctor_t *d, int cells)
{
    return &d->past[(d->windows + DOCTOR_HISTORY - cells) % DOCTOR_HISTORY];
}

static const doctor_window_t *window_before(const doctor_t *d, int cells)
{
    return &d->window[(d->windows + DOCTOR_HISTORY - cells) % DOCTOR_HISTORY];
}

static double average(const doctor_t *d, int signal)
{
    double sum = 0.0;
    for (int k = 0; k <= DOCTOR_WINDOW; ++k) {
        double weight = k == 0 || k == DOCTOR_WINDOW ? 0.5 : 1.0;
        sum += weight * cell_before(d, k)->mean[signal];
    }
    return sum / DOCTOR_WINDOW;
}

static double slope(const doctor_t *d, int signal)
{
    return (cell_before(d, 0)->mean[signal] - cell_before(d, DOCTOR_WINDOW)->mean[signal]) /
           WINDOW_S;
}

/* Body rates of the attitude (Fossen 2011, Eq. 2.26 inverted). */
static void turn_rates(const doctor_t *d, int first, double side, double out[3])
{
    double phi = average(d, first), theta = average(d, first + 1);
    double roll = slope(d, first), pitch = slope(d, first + 1);
    double yaw = side * slope(d, first + 2);
    out[0] = roll - yaw * sin(theta);
    out[1] = pitch * cos(phi) + yaw * cos(theta) * sin(phi);
    out[2] = yaw * cos(theta) * cos(phi) - pitch * sin(phi);
}

/* Rates of depth and position, and what the velocity says of them. */
static void travel(const doctor_t *d, doctor_window_t *w)
{
    const double *a = w->angle, *v = w->nu;
    double psi = average(d, CELL_ANGLE + 2);
    double north = slope(d, CELL_POSITION), east = slope(d, CELL_POSITION + 1);
    w->depth_rate = slope(d, CELL_POSITION + 2);
    w->sink[0] = -v[0] * sin(a[1]);
    w->sink[1] = v[1] * cos(a[1]) * sin(a[0]);
    w->sink[2] = v[2] * cos(a[1]) * cos(a[0]);
    for (int k = 0; k < 2; ++k) {
        double s = k == 0 ? sin(psi) : -sin(psi);
        w->over_ground[k][0] =
            (cos(psi) * north + s * east) * cos(a[1]) - sin(a[1]) * w->depth_rate;
        w->over_ground[k][1] = -s * north + cos(psi) * east;
    }
}

static void make_window(const doctor_t *d, doctor_window_t *w)
{
    turn_rates(d, CELL_ANGLE, 1.0, w->body_rate[0]);
    turn_rates(d, CELL_DEGREE, 1.0, w->body_rate[1]);
    turn_rates(d, CELL_ANGLE, -1.0, w->body_rate[2]);
    for (int j = 0; j < 6; ++j) {
        w->nu[j] = average(d, CELL_NU + j);
        w->quadratic[j] = fabs(w->nu[j]) * w->nu[j];
        w->acceleration[j] = slope(d, CELL_NU + j);
        w->input[j] = average(d, CELL_INPUT + j);
    }
    for (int j = 0; j < 3; ++j) {
        w->angle[j] = average(d, CELL_ANGLE + j);
    }
    const double *v = w->nu;
    const double couple[6][2] = {{v[1] * v[5], v[2] * v[4]},      {v[0] * v[5], v[2] * v[3]},
                                 {v[0] * v[4], v[1] * v[3]},      {sin(w->angle[0]), v[1] * v[2]},
                                 {sin(w->angle[1]), v[0] * v[2]}, {v[0] * v[1], v[0] * v[3]}};
    memcpy(w->couple, couple, sizeof couple);
    travel(d, w);
}

static void add_pair(doctor_pair_t *p, double a, double b)
{
    if (isfinite(a) && isfinite(b)) {
        p->n += 1.0;
        p->a += a;
        p->b += b;
        p->aa += a * a;
        p->bb += b * b;
        p->ab += a * b;
    }
}

static void add_attitude(const doctor_t *d, doctor_sums_t *s)
{
    const doctor_window_t *now = window_before(d, DOCTOR_LAGS);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k) {
                add_pair(&s->turn[k][i][j], now->body_rate[k][i], now->nu[3 + j]);
            }
        }
        for (int k = 0; k <= 2 * DOCTOR_LAGS; ++k) { /* the rate k - DOCTOR_LAGS cells earlier */
            add_pair(&s->lag[k][i], now->body_rate[0][i], window_before(d, k)->nu[3 + i]);
        }
    }
}

/* Products of the acceleration of DoF j, its drag, its coupling, and the inputs. */
static void add_input(const doctor_t *d, doctor_sums_t *s, int j)
{
    const doctor_window_t *now = window_before(d, DOCTOR_EARLY);
    double x[GAIN_TERMS] = {
        0.0, now->nu[j],          now->quadratic[j], now->couple[j][0], now->couple[j][1],
        1.0, now->acceleration[j]};
    double check = 0.0, lagged[DOCTOR_EARLY + DOCTOR_LATE + 1];
    for (int k = 0; k < GAIN_TERMS; ++k) {
        check += x[k];
    }
    for (int k = 0; k <= DOCTOR_EARLY + DOCTOR_LATE; ++k) {
        lagged[k] = window_before(d, k)->input[j];
        check += lagged[k];
    }
    if (!isfinite(check)) {
        return;
    }
    s->count[j] += 1.0;
    for (int a = 1; a < GAIN_TERMS; ++a) {
        for (int b = 1; b < GAIN_TERMS; ++b) {
            s->fixed[j][a][b] += x[a] * x[b];
        }
    }
    for (int k = 0; k <= DOCTOR_EARLY + DOCTOR_LATE; ++k) {
        s->own[j][k][0] += lagged[k] * lagged[k];
        for (int a = 1; a < GAIN_TERMS; ++a) {
            s->own[j][k][a] += lagged[k] * x[a];
        }
    }
    for (int i = 0; i < 6; ++i) {
        double other = window_before(d, DOCTOR_EARLY + 2)->input[i];
        for (int a = 1; a < GAIN_TERMS && isfinite(other); ++a) {
            s->cross[j][i][a] += other * x[a];
        }
        s->cross[j][i][0] += isfinite(other) ? other * other : 0.0;
    }
}

/* A window of one second, because depth is noisy. */
static void add_travel(const doctor_t *d, doctor_sums_t *s)
{
    const doctor_window_t *now = window_before(d, 0), *before = window_before(d, DOCTOR_WINDOW);
    double x[6] = {1.0}, check = 0.0;
    for (int k = 0; k < 3; ++k) {
        x[1 + k] = 0.5 * (now->sink[k] + before->sink[k]);
    }
    x[4] = 0.5 * (now->depth_rate + before->depth_rate);
    x[5] = x[1] + x[2] + x[3];
    check = x[4] + x[5];
    for (int a = 0; a < 6 && isfinite(check); ++a) {
        for (int b = 0; b < 6; ++b) {
            s->depth[a][b] += x[a] * x[b];
        }
    }
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < 2; ++i) {
            double moved = 0.5 * (now->over_ground[k][i] + before->over_ground[k][i]);
            for (int j = 0; j < 2; ++j) {
                add_pair(&s->ground[k][i][j], moved, 0.5 * (now->nu[j] + before->nu[j]));
            }
        }
    }
}

/* Halves the number of blocks by adding neighbours. */
static void merge_blocks(doctor_t *d)
{
    for (int k = 0; k < DOCTOR_BLOCKS / 2; ++k) {
        double to_s = d->block[2 * k + 1].to_s;
        doctor_sums_t sum;
        doctor_sum(d, 2 * k, 2 * k + 1, &sum);
        d->block[k].from_s = d->block[2 * k].from_s;
        d->block[k].to_s = to_s;
        d->block[k].sums = sum;
    }
    d->blocks = DOCTOR_BLOCKS / 2;
    d->block_cells *= 2;
}

static doctor_block_t *present_block(doctor_t *d)
{
    double now = (double)(d->cells.next - 1) * DOCTOR_CELL_S;
    if (d->blocks == 0 || d->cells_in_block == d->block_cells) {
        if (d->block_cells == 0) {
            d->block_cells = BLOCK_CELLS;
        }
        if (d->blocks == DOCTOR_BLOCKS) {
            merge_blocks(d);
        }
        memset(&d->block[d->blocks], 0, sizeof d->block[0]);
        d->block[d->blocks++].from_s = now;
        d->cells_in_block = 0;
    }
    ++d->cells_in_block;
    d->block[d->blocks - 1].to_s = now + DOCTOR_CELL_S;
    return &d->block[d->blocks - 1];
}

void doctor_window_add(doctor_t *d, const doctor_cell_t *cell)
{
    d->past[d->windows % DOCTOR_HISTORY] = *cell;
    make_window(d, &d->window[d->windows % DOCTOR_HISTORY]);
    doctor_sums_t *s = &present_block(d)->sums;
    if (d->windows > HISTORY) {
        add_attitude(d, s);
        for (int j = 0; j < 6; ++j) {
            add_input(d, s, j);
        }
        add_travel(d, s);
    }
    ++d->windows;
}
