/*
 * Sums over windows of the products of two signals, for each block of time.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

#define HISTORY (2 * DOCTOR_LAGS + 2 * DOCTOR_WINDOW) /* cells that a product looks back */
#define BLOCK_CELLS 100                               /* of a block at the start */

const doctor_window_t *doctor_window_before(const doctor_t *d, int cells)
{
    return &d->window[(d->windows + DOCTOR_HISTORY - cells) % DOCTOR_HISTORY];
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
    const doctor_window_t *now = doctor_window_before(d, DOCTOR_LAGS);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < DOCTOR_READINGS; ++k) {
                add_pair(&s->turn[k][i][j], now->body_rate[k][i], now->nu[3 + j]);
            }
        }
        for (int k = 0; k <= 2 * DOCTOR_LAGS; ++k) { /* the rate k - DOCTOR_LAGS cells earlier */
            add_pair(&s->lag[k][i], now->body_rate[0][i], doctor_window_before(d, k)->nu[3 + i]);
        }
    }
}

static void add_force(const doctor_t *d, doctor_sums_t *s)
{
    const doctor_window_t *now = doctor_window_before(d, 0);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            add_pair(&s->force[i][j], now->expected[i], now->force[j]);
        }
        double gravity = now->expected[i] - now->inertial[i];
        add_pair(&s->inertial[i], now->inertial[i], now->force[i] - gravity);
    }
}

/* Products of the force of each thruster with the terms of DoF j. */
static void add_thrusters(const doctor_t *d, doctor_sums_t *s, int j, const double x[GAIN_TERMS])
{
    const double *thrust = doctor_window_before(d, DOCTOR_EARLY + DOCTOR_USUAL)->thrust;
    for (int k = 0; k < AUVID_MAX_THRUSTERS; ++k) {
        for (int a = 1; a < GAIN_TERMS; ++a) {
            s->thrust[j][k][a] += thrust[k] * x[a];
        }
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            s->both[j][k][i] += thrust[k] * thrust[i];
        }
    }
}

/* Products of the acceleration of DoF j, its drag, its coupling, and the inputs. */
static void add_input(const doctor_t *d, doctor_sums_t *s, int j)
{
    const doctor_window_t *now = doctor_window_before(d, DOCTOR_EARLY);
    double x[GAIN_TERMS] = {
        0.0, now->nu[j],          now->quadratic[j], now->couple[j][0], now->couple[j][1],
        1.0, now->acceleration[j]};
    double check = 0.0, lagged[DOCTOR_EARLY + DOCTOR_LATE + 1];
    for (int k = 0; k < GAIN_TERMS; ++k) {
        check += x[k];
    }
    for (int k = 0; k <= DOCTOR_EARLY + DOCTOR_LATE; ++k) {
        lagged[k] = doctor_window_before(d, k)->input[j];
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
    if (j >= 6) {
        return;
    }
    if (d->use != NULL &&
        isfinite(doctor_window_before(d, DOCTOR_EARLY + DOCTOR_USUAL)->thrust[0])) {
        add_thrusters(d, s, j, x);
    }
    for (int i = 0; i < 6; ++i) {
        double other = doctor_window_before(d, DOCTOR_EARLY + DOCTOR_USUAL)->input[i];
        for (int a = 1; a < GAIN_TERMS && isfinite(other); ++a) {
            s->cross[j][i][a] += other * x[a];
        }
        s->cross[j][i][0] += isfinite(other) ? other * other : 0.0;
    }
}

/* Surge and sway together. */
static void add_mounting(const doctor_t *d, doctor_sums_t *s)
{
    const doctor_window_t *now = doctor_window_before(d, DOCTOR_EARLY);
    const double *force = doctor_window_before(d, DOCTOR_EARLY + DOCTOR_USUAL)->input;
    const double *v = now->nu;
    double speed = hypot(v[0], v[1]), check = 0.0;
    const double x[DOCTOR_MOUNT_TERMS] = {force[0],
                                          force[1],
                                          v[0],
                                          v[1],
                                          speed * v[0],
                                          speed * v[1],
                                          v[0] * v[5],
                                          v[1] * v[5],
                                          1.0,
                                          now->acceleration[0],
                                          now->acceleration[1]};
    for (int a = 0; a < DOCTOR_MOUNT_TERMS; ++a) {
        check += x[a];
    }
    for (int a = 0; a < DOCTOR_MOUNT_TERMS && isfinite(check); ++a) {
        for (int b = 0; b < DOCTOR_MOUNT_TERMS; ++b) {
            s->mount[a][b] += x[a] * x[b];
        }
    }
}

/* A window of one second, because depth is noisy. */
static void add_travel(const doctor_t *d, doctor_sums_t *s)
{
    const doctor_window_t *now = doctor_window_before(d, 0),
                          *before = doctor_window_before(d, DOCTOR_WINDOW);
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
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 2; ++k) {
            int j = k == 0 ? i : 1 - i;
            add_pair(&s->world[k][i], 0.5 * (now->travel[i] + before->travel[i]),
                     0.5 * (now->nu[j] + before->nu[j]));
        }
    }
    add_pair(&s->drift, now->drift[0], now->drift[1]);
    if (now->rests) {
        add_pair(&s->rest, now->nu[0], now->nu[1]);
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

void doctor_sums_add(doctor_t *d)
{
    doctor_sums_t *s = &present_block(d)->sums;
    if (d->windows <= HISTORY) {
        return;
    }
    add_attitude(d, s);
    add_force(d, s);
    for (int j = 0; j < DOCTOR_AXES; ++j) {
        add_input(d, s, j);
    }
    add_mounting(d, s);
    add_travel(d, s);
}
