/*
 * Metric: is the wrench feedback of the motion?
 *
 * In open loop nothing that disturbs the vehicle tells what its wrench will be. A controller
 * answers each disturbance, so its wrench depends on the residual e = Y pi - tau before it. Each
 * block of half a second gives a row of a regression for each DoF,
 *
 *     tau(block) - tau_0 = c + a_0 (tau_0 - tau of the cell before)
 *                          + sum_k a_k (tau_0 - tau(k blocks before)) + b e + noise,   k = 1, 2, 3,
 *     e = e_1 + e_2 / 2 + e_3 / 4,
 *
 * tau_0 of the last cell before the block, e_k the mean residual of earlier blocks. Between e_1 and
 * tau lies a gap, because velocity is interpolated between its samples, and time stamps are late.
 * The wrench's own past keeps an error of the model, which also depends on it, from looking like
 * feedback; c keeps a constant in e from hiding it. Rows in which tau changes much count less: they
 * are changes of a reference. tau and e are relative to tau_max.
 *
 * F_j is the F statistic of b = 0 in DoF j (Granger's test of causality, 1969). The past of a sum
 * of sines tells its future, and an error of the model may tell what little is missing: so the
 * noise has at least the size FEEDBACK_RESOLUTION. A DoF counts only if e is more than
 * FEEDBACK_SMALL of what the wrench changes in three blocks: answers to less change the estimate
 * little. A sag of the thrust leaves a residual that is in proportion to the wrench. Where it is
 * certain, the identifier takes it out.
 *
 * The wrench is feedback if the sum over n DoF exceeds 6.5 sqrt(n). Simulated for 600 s in
 * mixtures of usual size: so it does in 292 of 300 surveys under a controller, in 147 of 150 runs
 * of one that keeps its place, and with a joystick in none of 150. In worlds whose thrusters and
 * hull differ more from their model (auvid-validate worlds --seeds 3001:3015) it does in 44 of 60
 * surveys, but also in 34 of 136 logs in open loop, most of them of sines and triangles; without
 * errors in 11.
 *
 * Roll and pitch are summed by themselves: an autopilot often holds them while the rest is driven
 * in open loop. They have one block of the wrench's past: such an autopilot is quick, and more of
 * the past hides its answers (found in 5 of 12 logs, not 10). DoF that are known to be in closed or
 * in open loop do not count. Older rows are forgotten: their weight halves while eleven sets enter
 * a ring of eight.
 */
#include "auvid_metric_feedback_internal.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_rows_internal.h"
#include "auvid_metric_sets_internal.h"

enum { EARLIER_BLOCKS = 3, RESIDUAL = AUVID_FEEDBACK_ORDER - 2, EARLIEST = RESIDUAL - 1 };

#define FEEDBACK_LIMIT AUVID_C(6.5)
/* Fewest rows of a DoF that counts. */
#define FEEDBACK_MIN_ROWS AUVID_C(40.0)
/* More rows count as so many, which eight sets of 30 s come to: an error of the model leaves
 * something in b that does not average out. */
#define FEEDBACK_MOST_ROWS AUVID_C(960.0)

/* Change of the wrench in a block, relative to tau_max, above which a row counts less: a change of
 * the reference is no answer to the motion, but a controller answers also while it is held. */
#define FEEDBACK_STEP AUVID_C(0.015)

/* Smallest residual whose answers matter, relative to the change of the wrench in three blocks. */
#define FEEDBACK_SMALL AUVID_C(0.2)

/* Least rms of the noise, relative to tau_max. */
#define FEEDBACK_RESOLUTION AUVID_C(0.003)

/* Returns the wrench, `ago` cells before the newest one. */
static const auvid_real_t *feedback_wrench(const auvid_metric_t *m, uint32_t ago)
{
    return m->rows.past_tau[(m->rows.cells + METRIC_PAST - 1u - ago) % METRIC_PAST];
}

/* Returns the number of cells in a block; *gap: between the last residual and the wrench. Longer
 * cells: together they need about the same time. */
static uint32_t feedback_block(const auvid_metric_t *m, uint32_t *gap)
{
    bool doubled = m->result.doublings > 0;
    *gap = doubled ? 1u : 2u;
    return doubled ? 3u : 5u;
}

/* A set has been stored since the last row: the older rows count less. */
static void feedback_forget(auvid_metric_feedback_t *f, const auvid_metric_t *m)
{
    auvid_real_t keep = AUVID_C(1.0) - AUVID_C(0.5) / (auvid_real_t)m->cfg.sets;
    for (int j = 0; f->stored != m->sets.stored && j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER); ++i) {
            f->factor[j][i] *= auvid_sqrt(keep);
        }
        f->rows[j] *= keep;
    }
    f->stored = m->sets.stored;
}

/* Returns e of DoF j, without blocks that contain the next sample of the velocity. */
static auvid_real_t feedback_residual(const auvid_metric_t *m, int j)
{
    uint32_t gap, block = feedback_block(m, &gap);
    auvid_real_t sum = AUVID_C(0.0), weight = AUVID_C(1.0);
    for (uint32_t k = 0; k < EARLIER_BLOCKS; ++k) {
        bool past = (gap + k * block) * auvid_metric_cell_us(m) >= m->cfg.velocity_us;
        sum += past ? weight * m->feedback.residual[k + 1u][j] : AUVID_C(0.0);
        weight *= AUVID_C(0.5);
    }
    return sum;
}

/* A block of the wrench is complete: add DoF j's row. */
static void feedback_add_row(auvid_metric_t *m, int j)
{
    auvid_metric_feedback_t *f = &m->feedback;
    uint32_t gap, block = feedback_block(m, &gap);
    auvid_real_t scale = AUVID_C(1.0) / m->cfg.tau_max[j], next = AUVID_C(0.0);
    auvid_real_t last = scale * feedback_wrench(m, block)[j];
    for (uint32_t ago = 0; ago < block; ++ago) {
        next += scale / (auvid_real_t)block * feedback_wrench(m, ago)[j];
    }
    auvid_real_t step = next - last;
    bool tilts = (AUVID_FEEDBACK_TILT >> j & 1u) != 0;
    auvid_real_t row[AUVID_FEEDBACK_ORDER] = {AUVID_C(1.0),
                                              last - scale * feedback_wrench(m, block + 1u)[j],
                                              last - f->wrench[0][j],
                                              tilts ? AUVID_C(0.0) : last - f->wrench[1][j],
                                              tilts ? AUVID_C(0.0) : last - f->wrench[2][j],
                                              scale * feedback_residual(m, j),
                                              step};
    auvid_real_t weight = AUVID_C(1.0) / auvid_sqrt(FEEDBACK_STEP * FEEDBACK_STEP + step * step);
    for (int k = 0; k < AUVID_FEEDBACK_ORDER; ++k) {
        row[k] *= weight;
    }
    f->wrench[2][j] = f->wrench[1][j];
    f->wrench[1][j] = f->wrench[0][j];
    f->wrench[0][j] = next;
    bool begun = f->cells >= block * (EARLIER_BLOCKS + 1u) + gap;
    if (begun && auvid_all_within(row, AUVID_FEEDBACK_ORDER, METRIC_LARGEST_ENTRY) == AUVID_OK) {
        auvid_qr_update(f->factor[j], AUVID_FEEDBACK_ORDER, 0, row);
        f->rows[j] += AUVID_C(1.0);
    }
}

void auvid_metric_watch(auvid_metric_t *m, const auvid_sample_t *cell, const auvid_real_t *pi,
                        uint8_t dofs, auvid_real_t lost)
{
    auvid_metric_feedback_t *f = &m->feedback;
    uint32_t gap, block = feedback_block(m, &gap);
    auvid_real_t e[AUVID_DOF_COUNT];
    if (pi == NULL || m->rows.cells <= 1 || cell->missing != 0) {
        memset(f->sum, 0, sizeof f->sum);
        f->cells = 0;
        return;
    }
    auvid_vehicle_residual(m->cfg.vehicle, cell, pi, e);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool known = (dofs >> j & 1) != 0 && auvid_is_finite(e[j]);
        auvid_real_t residual = e[j] + lost * cell->tau[j];
        f->sum[j] += known ? residual / (auvid_real_t)block : AUVID_C(0.0);
    }
    uint32_t phase = f->cells++ % block;
    if (phase == gap - 1u) {
        feedback_forget(f, m);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            if ((dofs >> j & 1) != 0) {
                feedback_add_row(m, j);
            }
        }
    } else if (phase == block - 1u) {
        for (int k = EARLIER_BLOCKS; k > 0; --k) {
            memcpy(f->residual[k], f->residual[k - 1], sizeof f->residual[k]);
        }
        memcpy(f->residual[0], f->sum, sizeof f->sum);
        memset(f->sum, 0, sizeof f->sum);
    }
}

/* Returns the sum of squares of a column of DoF j, less its mean. */
static auvid_real_t feedback_square(const auvid_metric_feedback_t *f, int j, int column)
{
    auvid_real_t sum = AUVID_C(0.0);
    for (int i = 1; i <= column; ++i) {
        auvid_real_t r = f->factor[j][auvid_qr_row(AUVID_FEEDBACK_ORDER, i) + column - i];
        sum += r * r;
    }
    return sum;
}

/* F statistic of b = 0 in DoF j, of at most so many rows; 0 if the residual is small. */
static auvid_real_t feedback_statistic(const auvid_metric_feedback_t *f, int j)
{
    if (feedback_square(f, j, RESIDUAL) <
        FEEDBACK_SMALL * FEEDBACK_SMALL * feedback_square(f, j, EARLIEST)) {
        return AUVID_C(0.0);
    }
    auvid_real_t part = f->factor[j][auvid_qr_row(AUVID_FEEDBACK_ORDER, RESIDUAL) + 1];
    auvid_real_t left = f->factor[j][AUVID_QR_FACTOR(AUVID_FEEDBACK_ORDER) - 1];
    const auvid_real_t least = FEEDBACK_RESOLUTION / FEEDBACK_STEP;
    auvid_real_t noise = left * left + least * least * f->rows[j];
    auvid_real_t rows = auvid_min(f->rows[j], FEEDBACK_MOST_ROWS);
    return part * part / noise * (rows - (auvid_real_t)(AUVID_FEEDBACK_ORDER - 1));
}

/* Is the wrench feedback in these DoF, a bit each? */
static bool feedback_in(const auvid_metric_feedback_t *f, uint32_t among)
{
    auvid_real_t sum = AUVID_C(0.0), dofs = AUVID_C(0.0);
    for (int j = 0; among >> j != 0; ++j) {
        if ((among >> j & 1u) != 0 && f->rows[j] >= FEEDBACK_MIN_ROWS) {
            sum += feedback_statistic(f, j);
            dofs += AUVID_C(1.0);
        }
    }
    return sum > FEEDBACK_LIMIT * auvid_sqrt(dofs);
}

uint32_t auvid_metric_feedback_dofs(const auvid_metric_t *m)
{
    const auvid_metric_feedback_t *f = &m->feedback;
    uint32_t known = m->cfg.closed_loop, tested = AUVID_FEEDBACK_ALL & ~known & ~m->cfg.open_loop;
    if (m->sets.stored - f->stored >= m->cfg.sets) { /* no set of the ring is watched */
        return known;
    }
    if (feedback_in(f, tested & ~AUVID_FEEDBACK_TILT)) {
        return AUVID_FEEDBACK_ALL;
    }
    return feedback_in(f, tested & AUVID_FEEDBACK_TILT) ? known | AUVID_FEEDBACK_TILT : known;
}
