/*
 * Recorder (Karras et al. 2013, III-B, buffers of Eq. 9).
 *
 * Each stream is integrated over the cells that its segment [last sample, new sample] overlaps. The
 * integral of a straight line over an overlap is its midpoint value times the length. The cells
 * form a ring; a cell is zeroed when the first stream enters it. u, v and w are one stream each; a
 * lost one (not valid) continues from the next whole cell.
 */
#include "auvid_recorder_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

enum { ATTITUDE, VELOCITY, INPUT = VELOCITY + 3, STREAMS };
_Static_assert(INPUT - VELOCITY <= 8, "auvid_recorder_t.measured: a bit for each velocity");

/* Channels of each stream in a cell: phi theta psi p q r | u | v | w | tau, commands. */
static const uint8_t first_channel[STREAMS + 1] = {0, 6, 7, 8, 9, AUVID_RECORDER_CHANNELS};

/* A velocity component counts as lost after this many cells without it, while others are measured.
 * The rest of the ring is for the delay of the samples. */
enum { MAX_LAG = AUVID_RECORDER_CELLS - 8 };

/* Longest period of the velocity samples (metric_config.h). */
enum { MAX_PERIOD_US = 1000000 };

/* An outlier is this many spreads from its neighbours (Hampel 1974). The spread is a quantile that
 * grows by one factor and shrinks by the other (Robbins and Monro 1951): 27 % of the deviations are
 * larger. It begins with a large one [m/s], and is never below the resolution of a DVL. */
#define OUTLIER_SPREADS AUVID_C(5.0)
#define SPREAD_GROWS AUVID_C(1.15)
#define SPREAD_SHRINKS AUVID_C(0.95)
#define FIRST_SPREAD AUVID_C(0.1)
#define LEAST_SPREAD AUVID_C(0.001)

enum { PHI = 0, RATES = 3, VELOCITIES = 6, TAU = 9, COMMAND = 9 + AUVID_DOF_COUNT };

void auvid_recorder_defaults(auvid_recorder_config_t *cfg)
{
    if (cfg != NULL) {
        *cfg = (auvid_recorder_config_t){.cell_us = 100000};
    }
}

uint32_t auvid_recorder_gap(uint32_t velocity_us)
{
    if (velocity_us <= 200000) {
        return velocity_us > 100000 ? 5u * velocity_us : 500000;
    }
    bool slow = velocity_us > 666666 && velocity_us <= MAX_PERIOD_US;
    return slow ? velocity_us + velocity_us / 2u : 1000000;
}

static uint32_t recorder_gap_us(const auvid_recorder_config_t *cfg, uint32_t velocity_us)
{
    return cfg->gap_us == 0 ? auvid_recorder_gap(velocity_us) : cfg->gap_us;
}

void auvid_recorder_set_up(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg,
                           auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        WHOLE_IN(auvid_recorder_config_t, cell_us, 1, 1000, 1000000),
        WHOLE_IN(auvid_recorder_config_t, gap_us, 1, 0, AUVID_C(1e9)),
        WHOLE_IN(auvid_recorder_config_t, input, 1, AUVID_INPUT_HOLD, AUVID_INPUT_LINEAR),
    };
    uint32_t gap_us = recorder_gap_us(cfg, cfg->velocity_us);
    AUVID_CHECK_TABLE(why, cfg, fields);
    auvid_check_limit(why, gap_us >= cfg->cell_us, AUVID_ERR_RANGE, "gap_us", (auvid_real_t)gap_us,
                      (auvid_real_t)cfg->cell_us);
    if (why->status != AUVID_OK) {
        return;
    }
    memset(recorder, 0, sizeof *recorder);
    recorder->cfg = *cfg;
    recorder->cell_us = cfg->cell_us;
    recorder->velocity_us = cfg->velocity_us;
    recorder->gap_us = gap_us;
    for (int i = 0; i < 3; ++i) {
        recorder->spread[i] = FIRST_SPREAD;
    }
}

auvid_status_t auvid_recorder_init(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg)
{
    auvid_refusal_t why;
    if (recorder == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_recorder_set_up(recorder, cfg, &why);
    return why.status;
}

void auvid_recorder_set_cell(auvid_recorder_t *rec, uint32_t cell_us)
{
    rec->cell_us = cell_us;
    rec->running = false;
    rec->broken = true;
}

void auvid_recorder_break(auvid_recorder_t *recorder)
{
    if (recorder != NULL) {
        recorder->broken = recorder->broken || recorder->running;
        recorder->running = false;
    }
}

/* Is the period of the velocity samples still to be observed? */
static bool recorder_observes(const auvid_recorder_t *rec)
{
    return rec->velocity_us == AUVID_VELOCITY_OBSERVED;
}

/* Take an interval between velocity samples; the median of enough of them is their period. */
static void recorder_observe(auvid_recorder_t *rec, uint32_t interval_us)
{
    int i = rec->intervals++;
    for (; i > 0 && rec->interval_us[i - 1] > interval_us; --i) { /* sorted */
        rec->interval_us[i] = rec->interval_us[i - 1];
    }
    rec->interval_us[i] = interval_us < MAX_PERIOD_US ? interval_us : MAX_PERIOD_US;
    if (rec->intervals == AUVID_RECORDER_INTERVALS) {
        rec->intervals = 0;
        rec->velocity_us = rec->interval_us[AUVID_RECORDER_INTERVALS / 2];
        rec->gap_us = recorder_gap_us(&rec->cfg, rec->velocity_us);
    }
}

static bool recorder_is_velocity(int s)
{
    return s >= VELOCITY && s < INPUT;
}

/* Begin a record at the latest of the streams' last samples, unless one is running. All streams
 * need a sample not older than gap_us; one velocity component is enough. */
static void recorder_begin(auvid_recorder_t *rec)
{
    uint64_t origin = 0;
    bool has_velocity = false;
    if (rec->running) {
        return;
    }
    for (int s = 0; s < STREAMS; ++s) {
        if (rec->stream[s].valid) {
            origin = rec->stream[s].t_us > origin ? rec->stream[s].t_us : origin;
        } else if (!recorder_is_velocity(s)) {
            return;
        }
    }
    for (int s = 0; s < STREAMS; ++s) {
        auvid_recorder_stream_t *st = &rec->stream[s];
        st->valid = st->valid && origin - st->t_us <= rec->gap_us;
        has_velocity = has_velocity || (recorder_is_velocity(s) && st->valid);
        if (!st->valid && !recorder_is_velocity(s)) {
            return;
        }
    }
    if (!has_velocity) {
        return;
    }
    for (int s = 0; s < STREAMS; ++s) {
        rec->stream[s].filled_us = origin;
        rec->stream[s].cell = 0;
    }
    rec->origin_us = origin;
    rec->opened = 0;
    rec->next = 2; /* the first cell with two neighbours on each side */
    rec->running = true;
}

/* Add the segment from the stream's last sample to (t_us, value) to the cells it overlaps. Return
 * false if it reaches a cell beyond the ring. At most AUVID_RECORDER_CELLS passes. */
static bool recorder_integrate(auvid_recorder_t *rec, int s, uint64_t t_us,
                               const auvid_real_t *value)
{
    auvid_recorder_stream_t *st = &rec->stream[s];
    const auvid_real_t *last = &rec->last[first_channel[s]];
    int channels = first_channel[s + 1] - first_channel[s];
    bool hold = s == INPUT && rec->cfg.input == AUVID_INPUT_HOLD;
    auvid_real_t per_segment = AUVID_C(1.0) / (auvid_real_t)(uint32_t)(t_us - st->t_us);
    auvid_real_t per_cell = AUVID_C(1.0) / (auvid_real_t)rec->cell_us;
    auvid_real_t part[AUVID_DOF_COUNT + AUVID_MAX_COMMANDS]; /* value over an overlap */

    while (st->filled_us < t_us) {
        uint64_t cell_end = rec->origin_us + (uint64_t)(st->cell + 1) * rec->cell_us;
        uint64_t to = t_us < cell_end ? t_us : cell_end;
        if (st->cell - (rec->next - 2) >= AUVID_RECORDER_CELLS) {
            return false;
        }
        auvid_real_t *mean = rec->mean[st->cell % AUVID_RECORDER_CELLS];
        for (; rec->opened <= st->cell; ++rec->opened) { /* a stream that was lost may be ahead */
            auvid_zero(rec->mean[rec->opened % AUVID_RECORDER_CELLS], sizeof rec->mean[0]);
            rec->measured[rec->opened % AUVID_RECORDER_CELLS] = 0;
        }
        auvid_real_t weight = (auvid_real_t)(uint32_t)(to - st->filled_us) * per_cell;
        /* position of the middle of the overlap between the two samples, 0..1 */
        auvid_real_t middle =
            (auvid_real_t)(uint32_t)(to - st->t_us + (st->filled_us - st->t_us)) * AUVID_C(0.5);
        auvid_real_t fraction = hold ? AUVID_C(0.0) : middle * per_segment;
        for (int i = 0; i < channels; ++i) {
            part[i] = last[i] + fraction * (value[i] - last[i]);
            mean[first_channel[s] + i] += weight * part[i];
        }
        if (s == INPUT && rec->take_part != NULL) {
            bool opens = cell_end - st->filled_us == rec->cell_us;
            rec->take_part(rec->part_context, st->cell, opens, (uint32_t)(to - st->filled_us),
                           part);
        }
        st->filled_us = to;
        if (to == cell_end) {
            unsigned bit = recorder_is_velocity(s) ? 1u << (s - VELOCITY) : 0u;
            uint8_t *measured = &rec->measured[st->cell % AUVID_RECORDER_CELLS];
            *measured = (uint8_t)(*measured | bit);
            ++st->cell;
        }
    }
    return true;
}

/* Add a checked sample to a stream. */
static void recorder_add(auvid_recorder_t *rec, int s, uint64_t t_us, const auvid_real_t *value)
{
    auvid_recorder_stream_t *st = &rec->stream[s];
    if (rec->running && !st->valid) {         /* a velocity component that was lost */
        bool inside = t_us >= rec->origin_us; /* false: sampled before the record began */
        st->cell = inside ? (uint32_t)auvid_divide(t_us - rec->origin_us, rec->cell_us) + 1u : 0u;
        st->filled_us = rec->origin_us + (uint64_t)st->cell * rec->cell_us;
    } else if (rec->running &&
               (t_us - st->t_us > rec->gap_us || !recorder_integrate(rec, s, t_us, value))) {
        /* if the period is being observed, no cell was popped: the record begins again */
        rec->broken = !recorder_observes(rec) || rec->intervals == 0;
        rec->running = false;
    }
    memcpy(&rec->last[first_channel[s]], value,
           (size_t)(first_channel[s + 1] - first_channel[s]) * sizeof value[0]);
    st->t_us = t_us;
    st->valid = true;
}

/* By how much velocity i jumped to its last sample and came back with this one; zero or less: it
 * did not. */
static auvid_real_t recorder_jump(const auvid_recorder_t *rec, int i, auvid_real_t value)
{
    auvid_real_t last = rec->last[VELOCITIES + i];
    auvid_real_t to = last - rec->before[i], back = last - value;
    auvid_real_t bend = to - rec->slope[i] * (auvid_real_t)rec->before_us[i];
    auvid_real_t sign = to < AUVID_C(0.0) ? AUVID_C(-1.0) : AUVID_C(1.0);
    return auvid_min(sign * bend, auvid_min(sign * to, sign * back));
}

/* Move the last sample of velocity i. What it did to the stored cells since the sample before it
 * changes in proportion. At most AUVID_RECORDER_CELLS passes. */
static void recorder_move(auvid_recorder_t *rec, int i, auvid_real_t by)
{
    const auvid_recorder_stream_t *st = &rec->stream[VELOCITY + i];
    auvid_real_t per_segment = AUVID_C(1.0) / (auvid_real_t)rec->before_us[i];
    auvid_real_t per_cell = AUVID_C(1.0) / (auvid_real_t)rec->cell_us;
    uint64_t from_us = st->t_us - rec->before_us[i];

    for (uint32_t k = rec->next - 2; rec->running && k != rec->opened; ++k) {
        uint64_t begin = rec->origin_us + (uint64_t)k * rec->cell_us, end = begin + rec->cell_us;
        begin = begin > from_us ? begin : from_us;
        end = end < st->t_us ? end : st->t_us;
        if (begin < end) {
            auvid_real_t weight = (auvid_real_t)(uint32_t)(end - begin) * per_cell;
            auvid_real_t middle =
                (auvid_real_t)(uint32_t)(begin - from_us + (end - from_us)) * AUVID_C(0.5);
            rec->mean[k % AUVID_RECORDER_CELLS][VELOCITIES + i] +=
                weight * middle * per_segment * by;
        }
    }
    rec->last[VELOCITIES + i] += by;
}

/* If the last sample of velocity i is an outlier, now that the next one is there, put it on the
 * line between its neighbours: as if it had not been measured. */
static void recorder_correct(auvid_recorder_t *rec, int i, uint64_t t_us, auvid_real_t value)
{
    const auvid_recorder_stream_t *st = &rec->stream[VELOCITY + i];
    bool follows = st->valid && t_us - st->t_us <= rec->gap_us;
    uint32_t after_us = follows ? (uint32_t)(t_us - st->t_us) : 0;
    auvid_real_t slope = AUVID_C(0.0);
    if (follows && rec->before_us[i] > 0) {
        auvid_real_t before = (auvid_real_t)rec->before_us[i], after = (auvid_real_t)after_us;
        auvid_real_t line = (rec->before[i] * after + value * before) / (before + after);
        auvid_real_t off = rec->last[VELOCITIES + i] - line;
        if (recorder_jump(rec, i, value) > OUTLIER_SPREADS * rec->spread[i]) {
            recorder_move(rec, i, -off);
            ++rec->outliers;
        }
        rec->spread[i] *= auvid_abs(off) > rec->spread[i] ? SPREAD_GROWS : SPREAD_SHRINKS;
        rec->spread[i] = auvid_clamp(rec->spread[i], LEAST_SPREAD, AUVID_RECORDER_LARGEST);
        slope = (rec->last[VELOCITIES + i] - rec->before[i]) / before;
    }
    rec->before[i] = rec->last[VELOCITIES + i];
    rec->slope[i] = slope;
    rec->before_us[i] = after_us;
}

static AUVID_NOINLINE auvid_status_t recorder_check_time(const auvid_recorder_stream_t *st,
                                                         uint64_t t_us)
{
    if (st->valid && t_us <= st->t_us) {
        return t_us == st->t_us ? AUVID_ERR_TIME_SAME : AUVID_ERR_TIME_BACK;
    }
    return AUVID_OK;
}

static auvid_status_t recorder_feed(auvid_recorder_t *rec, int s, uint64_t t_us,
                                    const auvid_real_t *value)
{
    size_t channels = (size_t)(first_channel[s + 1] - first_channel[s]);
    auvid_status_t status = auvid_all_within(value, channels, AUVID_RECORDER_LARGEST);
    if (status == AUVID_OK) {
        status = recorder_check_time(&rec->stream[s], t_us);
    }
    if (status == AUVID_OK) {
        recorder_add(rec, s, t_us, value);
        recorder_begin(rec);
    }
    return status;
}

auvid_status_t auvid_recorder_attitude(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *rates)
{
    if (recorder == NULL || attitude == NULL || rates == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_real_t value[6];
    memcpy(value, attitude, 3 * sizeof value[0]);
    memcpy(value + 3, rates, 3 * sizeof value[0]);
    return recorder_feed(recorder, ATTITUDE, t_us, value);
}

auvid_status_t auvid_recorder_velocity(auvid_recorder_t *recorder, uint64_t t_us,
                                       const auvid_real_t *velocity, unsigned measured)
{
    auvid_recorder_t *rec = recorder;
    if (rec == NULL || velocity == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = measured > 7u ? AUVID_ERR_RANGE : AUVID_OK;
    uint32_t silence_us[3], min_us = UINT32_MAX;
    for (int i = 0; i < 3; ++i) {
        const auvid_recorder_stream_t *st = &rec->stream[VELOCITY + i];
        if (status == AUVID_OK && (measured >> i & 1u) != 0) {
            status = auvid_all_within(velocity + i, 1, AUVID_RECORDER_LARGEST);
        }
        if (status == AUVID_OK) {
            status = recorder_check_time(st, t_us);
        }
        uint64_t us = t_us - st->t_us;
        silence_us[i] = st->valid && us < UINT32_MAX ? (uint32_t)us : UINT32_MAX;
        min_us = silence_us[i] < min_us ? silence_us[i] : min_us;
    }
    if (status != AUVID_OK || measured == 0) {
        return status != AUVID_OK ? status : AUVID_UNUSED;
    }
    /* if all three components are missing for gap_us, the record breaks as for any stream */
    bool continues = rec->running && min_us <= rec->gap_us;
    for (int i = 0; i < 3; ++i) {
        bool is_measured = (measured >> i & 1u) != 0;
        bool lost = is_measured
                        ? silence_us[i] > rec->gap_us
                        : silence_us[i] >= rec->gap_us || silence_us[i] >= MAX_LAG * rec->cell_us;
        if (continues && lost) {
            rec->stream[VELOCITY + i].valid = false;
        }
        if (is_measured) {
            recorder_correct(rec, i, t_us, velocity[i]);
            recorder_add(rec, VELOCITY + i, t_us, velocity + i);
        }
    }
    if (recorder_observes(rec) && min_us < UINT32_MAX) {
        recorder_observe(rec, min_us);
    }
    recorder_begin(rec);
    return AUVID_OK;
}

auvid_status_t auvid_recorder_motion(auvid_recorder_t *recorder, uint64_t t_us,
                                     const auvid_real_t *attitude, const auvid_real_t *nu)
{
    if (recorder == NULL || attitude == NULL || nu == NULL) {
        return AUVID_ERR_NULL;
    }
    /* reject before the attitude is recorded if the velocity would be rejected */
    auvid_status_t status = auvid_all_within(nu, AUVID_DOF_COUNT, AUVID_RECORDER_LARGEST);
    for (int i = 0; i < 3 && status == AUVID_OK; ++i) {
        status = recorder_check_time(&recorder->stream[VELOCITY + i], t_us);
    }
    if (status == AUVID_OK) {
        status = auvid_recorder_attitude(recorder, t_us, attitude, nu + AUVID_ROLL);
    }
    return status == AUVID_OK ? auvid_recorder_velocity(recorder, t_us, nu, 7u) : status;
}

auvid_status_t auvid_recorder_input(auvid_recorder_t *recorder, uint64_t t_us,
                                    const auvid_real_t *tau, const auvid_real_t *command)
{
    if (recorder == NULL || tau == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_real_t value[AUVID_DOF_COUNT + AUVID_MAX_COMMANDS];
    memcpy(value, tau, AUVID_DOF_COUNT * sizeof value[0]);
    if (command != NULL) {
        memcpy(value + AUVID_DOF_COUNT, command, AUVID_MAX_COMMANDS * sizeof value[0]);
    } else {
        auvid_clear(value + AUVID_DOF_COUNT, AUVID_MAX_COMMANDS);
    }
    return recorder_feed(recorder, INPUT, t_us, value);
}

static const auvid_real_t *recorder_cell(const auvid_recorder_t *rec, uint32_t number)
{
    return rec->mean[number % AUVID_RECORDER_CELLS];
}

auvid_status_t auvid_recorder_pop(auvid_recorder_t *recorder, auvid_sample_t *sample)
{
    if (recorder == NULL || sample == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_recorder_t *rec = recorder;
    if (rec->broken) {
        rec->broken = false;
        return AUVID_GAP;
    }
    for (int s = 0; s < STREAMS; ++s) {
        bool lost = recorder_is_velocity(s) && !rec->stream[s].valid;
        if (!rec->running || recorder_observes(rec) ||
            (!lost && rec->stream[s].cell <= rec->next + 2)) {
            return AUVID_EMPTY;
        }
    }
    const auvid_real_t *mean = recorder_cell(rec, rec->next);
    const auvid_real_t *before2 = recorder_cell(rec, rec->next - 2),
                       *before = recorder_cell(rec, rec->next - 1);
    const auvid_real_t *after = recorder_cell(rec, rec->next + 1),
                       *after2 = recorder_cell(rec, rec->next + 2);

    auvid_zero(sample, sizeof *sample);
    sample->t_us = rec->origin_us + (uint64_t)rec->next * rec->cell_us + rec->cell_us / 2;
    sample->phi = mean[PHI];
    sample->theta = mean[PHI + 1];
    sample->psi = mean[PHI + 2];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int i = j < 3 ? VELOCITIES + j : RATES + j - 3;
        sample->nu[j] = mean[i];
        sample->nu_dot[j] = auvid_recorder_slope(rec, before2[i], before[i], after[i], after2[i]);
        sample->tau[j] = mean[TAU + j];
    }
    memcpy(sample->command, &mean[COMMAND], AUVID_MAX_COMMANDS * sizeof sample->command[0]);
    for (uint32_t k = rec->next - 2; k <= rec->next + 2; ++k) {
        sample->missing |= (uint8_t)(~rec->measured[k % AUVID_RECORDER_CELLS] & 7u);
    }
    ++rec->next;
    return AUVID_OK;
}
