/*
 * Averages of all signals over cells of 0.1 s, from samples at any time and at any rate of each
 * signal. Between two samples a signal is linear; an input is held. A time of more than a second
 * without sample is not covered.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

#define GAP_S 1.0
#define LATE 12       /* cells after which one is complete; beyond GAP_S, less than the ring */
#define LONG_GAP 1000 /* cells: after a longer time without rows the windows start again */
#define COVERED 0.99  /* share of a complete cell */
#define TURN 6.283185307179586
#define DEGREE (TURN / 360.0)

static void clear_cell(doctor_cells_t *c, int64_t cell)
{
    int slot = (int)(cell % DOCTOR_RING);
    memset(c->sum[slot], 0, sizeof c->sum[slot]);
    memset(c->covered[slot], 0, sizeof c->covered[slot]);
}

void doctor_cells_init(doctor_t *d)
{
    doctor_cells_t *c = &d->cells;
    memset(c, 0, sizeof *c);
    for (int i = 0; i < CELL_SIGNALS; ++i) {
        c->last_s[i] = c->last[i] = NAN;
    }
}

/* Passes a complete cell on. */
static void emit_cell(doctor_t *d)
{
    doctor_cells_t *c = &d->cells;
    doctor_cell_t cell;
    int slot = (int)(c->next % DOCTOR_RING);
    for (int i = 0; i < CELL_SIGNALS; ++i) {
        bool whole = c->covered[slot][i] >= COVERED * DOCTOR_CELL_S;
        cell.mean[i] = whole ? c->sum[slot][i] / c->covered[slot][i] : NAN;
    }
    clear_cell(c, c->next++);
    doctor_window_add(d, &cell);
}

/* Adds the time from one sample of a signal to the next. */
static void cover(doctor_cells_t *c, int signal, double from_s, double to_s, double from, double to)
{
    bool held = (signal >= CELL_INPUT && signal < CELL_INPUT + 6) || signal >= CELL_THRUST;
    double slope = held ? 0.0 : (to - from) / (to_s - from_s);
    for (int64_t k = (int64_t)(from_s / DOCTOR_CELL_S); (double)k * DOCTOR_CELL_S < to_s; ++k) {
        double begin = fmax(from_s, (double)k * DOCTOR_CELL_S);
        double end = fmin(to_s, (double)(k + 1) * DOCTOR_CELL_S);
        int slot = (int)(k % DOCTOR_RING);
        if (end > begin && k >= c->next) {
            double middle = from + slope * (0.5 * (begin + end) - from_s);
            c->sum[slot][signal] += middle * (end - begin);
            c->covered[slot][signal] += end - begin;
        }
    }
}

/* Unwraps an angle beside its last value. */
static double unwrap(const doctor_cells_t *c, int signal, double value)
{
    double last = c->last[signal];
    return isfinite(last) ? last + remainder(value - last, TURN) : value;
}

void doctor_cells_add(doctor_t *d, double t, const double value[CELL_SIGNALS])
{
    doctor_cells_t *c = &d->cells;
    int64_t now = (int64_t)(t / DOCTOR_CELL_S);
    if (now - c->next > LONG_GAP) {
        doctor_cells_flush(d);
        for (int64_t k = 0; k < DOCTOR_HISTORY; ++k) {
            emit_cell(d); /* empty: no window spans the gap */
        }
        c->next = now;
    }
    while (c->next < now - LATE) {
        emit_cell(d);
    }
    for (int i = 0; i < CELL_SIGNALS; ++i) {
        bool degree = i >= CELL_DEGREE && i < CELL_ORDER;
        double x = value[i];
        if (!isfinite(x)) {
            continue;
        }
        if (i < CELL_NU) {
            x = unwrap(c, i, degree ? x * DEGREE : x);
        }
        if (t - c->last_s[i] <= GAP_S) {
            cover(c, i, c->last_s[i], t, c->last[i], x);
        }
        c->last_s[i] = t;
        c->last[i] = x;
    }
}

void doctor_cells_flush(doctor_t *d)
{
    for (int k = 0; k < DOCTOR_RING; ++k) {
        emit_cell(d);
    }
}
