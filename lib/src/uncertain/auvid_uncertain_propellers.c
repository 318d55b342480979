/*
 * Uncertain inputs: the propellers. The speed of a propeller, as the root of its force, follows
 * that of the supplied force with a first-order lag. Force and speed are not proportional, so it
 * follows each command, not the mean of a cell: thrusters that keep a vehicle level are reversed
 * many times in one. The lag smooths their forces; the columns are formed from the mean of these.
 */
#include "auvid_uncertain_parts_internal.h"
#include "../navigation/auvid_recorder_internal.h"

/* Smallest lag, and smallest step of the lag's difference [s]. */
#define LEAST_LAG AUVID_C(0.01)
#define LEAST_STEP AUVID_C(0.02)

/* 1 - exp(-x), 0 <= x <= 50, relative error below 1e-6: 1 - y^2 = d (2 - d), d = 1 - y. */
static auvid_real_t propellers_part(auvid_real_t x)
{
    auvid_real_t d = x / AUVID_C(1024.0) * (AUVID_C(1.0) - x / AUVID_C(2048.0));
    for (int i = 0; i < 10; ++i) {
        d *= AUVID_C(2.0) - d;
    }
    return d;
}

/* Advance a propeller's speed towards that of a constant force; part = 1 - exp(-t / (2 lag)).
 * Returns the mean force, by Simpson's rule. */
static auvid_real_t propellers_advance(auvid_real_t *speed, auvid_real_t to, auvid_real_t part)
{
    auvid_real_t a = *speed, b = a + part * (to - a), c = b + part * (to - b);
    *speed = c;
    return (a * auvid_abs(a) + AUVID_C(4.0) * b * auvid_abs(b) + c * auvid_abs(c)) / AUVID_C(6.0);
}

/* Step of the lag's difference: to the last estimate, but not too small, and the lag stays above
 * zero. */
static auvid_real_t propellers_lag_step(const auvid_uncertain_t *u)
{
    auvid_real_t lowest = LEAST_LAG - u->cfg.nominal_lag_s, step = u->shared[AUVID_UNCERTAIN_LAG];
    step = step < AUVID_C(0.0) ? auvid_min(step, -LEAST_STEP) : auvid_max(step, LEAST_STEP);
    return step > lowest ? step : lowest < -LEAST_STEP ? lowest : LEAST_STEP;
}

void auvid_uncertain_advance_propellers(void *context, uint32_t cell, bool opens, uint32_t us,
                                        const auvid_real_t *value)
{
    auvid_uncertain_t *u = context;
    auvid_uncertain_rows_t *r = &u->recorded;
    auvid_real_t(*response)[2] = r->response[cell % AUVID_RECORDER_CELLS];
    auvid_real_t part_s = (auvid_real_t)us * AUVID_C(1e-6), lag_s = u->cfg.nominal_lag_s;
    auvid_real_t weight = (auvid_real_t)us / (auvid_real_t)u->id->recorder.cell_us;
    auvid_real_t step = propellers_lag_step(u);
    auvid_real_t part = propellers_part(AUVID_C(0.5) * part_s / lag_s);
    auvid_real_t later = propellers_part(AUVID_C(0.5) * part_s / (lag_s + step));
    if (opens) {
        auvid_zero(response, sizeof r->response[0]);
    }
    for (int i = 0; i < u->allocation->cfg.thrusters; ++i) {
        auvid_real_t supplied = auvid_uncertain_force(u, i, value[AUVID_DOF_COUNT + i]);
        auvid_real_t to = auvid_sqrt_here(auvid_abs(supplied));
        to = supplied < AUVID_C(0.0) ? -to : to;
        if (cell == 0) { /* of the record: the mean of what is asked for */
            r->speed[i] = (opens ? AUVID_C(0.0) : r->speed[i]) + weight * to;
            r->lagged[i] = r->speed[i];
            response[i][0] += weight * supplied;
            continue;
        }
        auvid_real_t force = propellers_advance(&r->speed[i], to, part);
        auvid_real_t late = propellers_advance(&r->lagged[i], to, later);
        response[i][0] += weight * force;
        response[i][1] += weight * ((force - late) / step);
    }
}

void auvid_uncertain_take_forces(auvid_uncertain_t *u)
{
    auvid_uncertain_rows_t *r = &u->recorded;
    const auvid_recorder_t *recorder = &u->id->recorder;
    auvid_real_t(*of[5])[2]; /* of the cell that was popped last, in the middle */
    for (uint32_t k = 0; k < 5u; ++k) {
        of[k] = r->response[(recorder->next - 3u + k) % AUVID_RECORDER_CELLS];
    }
    for (int i = 0; i < u->allocation->cfg.thrusters; ++i) {
        r->force[i] = of[2][i][0];
        r->lag_slope[i] = of[2][i][1];
        r->rate[i] =
            auvid_recorder_slope(recorder, of[0][i][0], of[1][i][0], of[3][i][0], of[4][i][0]);
        r->curvature[i] = auvid_recorder_curvature(recorder, of[0][i][0], of[1][i][0], of[2][i][0],
                                                   of[3][i][0], of[4][i][0]);
    }
}
