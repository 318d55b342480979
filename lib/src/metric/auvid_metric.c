/*
 * Metric (Karras et al. 2013, III-B): its configuration, its filter and its layout.
 *
 * The smoother is a finite impulse response. A smoother of taps c_i applied to the rows Y and the
 * wrench tau alike,
 *
 *     sum_i c_i Y_i pi = sum_i c_i tau_i,
 *
 * holds for the true pi exactly, so the choice of c is only a matter of noise. Savitzky-Golay of
 * order 2 and half-width 1 s, applied twice, passes the excitation (< 0.3 Hz) and attenuates the
 * noise of the DVL.
 *
 * Velocity that is interpolated between samples T apart has passed a triangular filter. Its
 * variance is T^2 / 6, averaged over the position of the sample within T. At 0.25 Hz and 5 Hz its
 * gain is 0.8 % low, and masses become too large by as much. So the wrench of forces also passes
 * (a, 1 - 2 a, a), a = T^2 / (12 cell^2), which has the same variance.
 *
 * auvid_metric_record.c forms rows from cells, auvid_metric_close.c sets from rows.
 * auvid_metric_merge.c merges sets to one weighted R factor. auvid_metric_cost.c evaluates costs.
 */
#include "auvid/metric.h"

#include <string.h>

#include "auvid/smoother.h"
#include "../base/auvid_linalg_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../models/auvid_vehicle_internal.h"
#include "auvid_metric_internal.h"

/* Standard deviation of the weights that smooth the residuals in the residual path. */
#define RESIDUAL_SMOOTHING_S AUVID_C(0.6)

void auvid_metric_defaults(auvid_metric_config_t *cfg, const auvid_vehicle_t *vehicle)
{
    if (cfg == NULL) {
        return;
    }
    *cfg = (auvid_metric_config_t){
        .vehicle = vehicle,
        .free = vehicle == NULL ? 0 : vehicle->free,
        .excitation_threshold = AUVID_C(0.02),
        .cell_us = 100000,
        .velocity_us = 200000,
        .row_cells = 5,
        .set_rows = 60,
        .sets = AUVID_MAX_SETS,
        .half_width = {10, 7},
        .order = 2,
        .passes = 2,
        .lag = {2, 1},
        .estimate_delay = true,
    };
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg->tau_max[j] = j < 3 ? AUVID_C(100.0) : AUVID_C(40.0);
    }
}

#define METRIC_WHOLE(name, n, low, high) WHOLE_IN(auvid_metric_config_t, name, n, low, high)
#define METRIC_REALS(name, n, low, high) REALS_IN(auvid_metric_config_t, name, n, low, high)
static const auvid_field_t metric_fields[] = {
    METRIC_REALS(fixed, AUVID_MAX_PARAMETERS, -AUVID_LARGEST, AUVID_LARGEST),
    REALS_ABOVE(auvid_metric_config_t, tau_max, AUVID_DOF_COUNT, AUVID_C(0.0), AUVID_LARGEST),
    METRIC_REALS(excitation_threshold, 1, AUVID_C(0.0), AUVID_C(1.0)),
    METRIC_WHOLE(cell_us, 1, 1000, 1000000),
    METRIC_WHOLE(velocity_us, 1, 0, 1000000),
    METRIC_WHOLE(row_cells, 1, 1, 65535),
    METRIC_WHOLE(set_rows, 1, 1, 65535),
    METRIC_WHOLE(sets, 1, 1, AUVID_MAX_SETS),
    METRIC_WHOLE(half_width, 2, 1, 255),
    METRIC_WHOLE(lag, 2, 1, AUVID_METRIC_LAGS),
    METRIC_WHOLE(passes, 1, 1, 2),
    METRIC_REALS(delay_s, AUVID_DOF_COUNT, -AUVID_LARGEST, AUVID_LARGEST),
    METRIC_REALS(delay_sigma_s, 1, AUVID_C(0.0), AUVID_C(1.0)),
};

/* Check the delays: a cell is their unit. */
static auvid_status_t metric_check_delays(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_real_t cell_s = (auvid_real_t)cfg->cell_us * AUVID_C(1e-6);
    auvid_real_t longest =
        cell_s * (auvid_real_t)(AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1));
    auvid_real_t earliest = /* accepts a rounded delay of the metric */
        -cell_s * ((auvid_real_t)AUVID_METRIC_EARLY_CELLS + AUVID_C(0.001));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t delay_s = cfg->delay_s[j];
        if (!(delay_s >= earliest && delay_s <= longest)) {
            (void)auvid_refuse(why, AUVID_ERR_RANGE, "delay_s", delay_s,
                               delay_s < earliest ? earliest : longest);
            return auvid_refuse_element(why, AUVID_ERR_RANGE, j);
        }
    }
    return AUVID_OK;
}

/* Check each field by itself, then what the fields require of each other. */
static auvid_status_t metric_check_ranges(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_status_t status =
        auvid_check_fields(cfg, metric_fields, sizeof metric_fields / sizeof metric_fields[0], why);
    if (status == AUVID_OK) {
        status = metric_check_delays(cfg, why);
    }
    if (status < 0) {
        return status;
    }
    if ((uint32_t)cfg->set_rows * cfg->sets > 60000) {
        return auvid_refuse(why, AUVID_ERR_RANGE, "set_rows", (auvid_real_t)cfg->set_rows,
                            (auvid_real_t)(60000 / cfg->sets));
    }
    uint32_t mask = (uint32_t)(((uint64_t)1 << cfg->vehicle->parameters) - 1);
    if (cfg->free != 0 && (cfg->free & mask) == 0) {
        return auvid_refuse(why, AUVID_ERR_PARAMETERS, "free", (auvid_real_t)cfg->free,
                            (auvid_real_t)mask);
    }
    bool stored = !AUVID_REGRESSOR_ONLY && cfg->rows != NULL;
    return cfg->vehicle->regressor != NULL || stored
               ? AUVID_OK
               : auvid_refuse(why, AUVID_ERR_MODEL, "rows", AUVID_C(0.0), AUVID_C(0.0));
}

/* Write Savitzky-Golay, as often as `passes` says, to the middle of the kernel. */
static void metric_make_kernel(const auvid_metric_t *m, auvid_real_t *kernel, uint8_t half_width)
{
    auvid_real_t dt_s = (auvid_real_t)m->cfg.cell_us * AUVID_C(1e-6);
    auvid_real_t *first = kernel + m->taps / 2 - m->cfg.passes * half_width;
    (void)auvid_smoother_coefficients(half_width, m->cfg.order, 0, dt_s, 0,
                                      first); /* they exist: metric_check_filter */
    int n = 2 * half_width + 1;
    for (int t = 2 * n - 2; m->cfg.passes == 2 && t >= 0; --t) { /* in place, from the end */
        auvid_real_t sum = AUVID_C(0.0);
        for (int i = t < n ? 0 : t - n + 1; i <= t && i < n; ++i) {
            sum += first[i] * first[t - i];
        }
        first[t] = sum;
    }
}

/* Make binomial weights over an odd number of rows: n weights have a variance of (n - 1) / 4. */
static void metric_make_window(auvid_metric_t *m, auvid_real_t deviation_s)
{
    auvid_real_t rows = deviation_s * AUVID_C(1e6) /
                        ((auvid_real_t)m->cfg.cell_us * (auvid_real_t)m->cfg.row_cells);
    int pairs = (int)auvid_min(AUVID_C(2.0) * rows * rows + AUVID_C(0.5),
                               (auvid_real_t)AUVID_METRIC_WINDOW);
    pairs = pairs < AUVID_METRIC_WINDOW / 2 ? pairs : AUVID_METRIC_WINDOW / 2;
    m->window_length = (uint8_t)(2 * pairs + 1);
    memset(m->window_weight, 0, sizeof m->window_weight);
    m->window_weight[0] = AUVID_C(1.0);
    for (int n = 1; n < m->window_length; ++n) {
        for (int k = n; k >= 0; --k) { /* Pascal's triangle, each line halved */
            auvid_real_t left = k > 0 ? m->window_weight[k - 1] : AUVID_C(0.0);
            m->window_weight[k] = AUVID_C(0.5) * (m->window_weight[k] + left);
        }
    }
}

static uint32_t metric_max_half_width(const auvid_metric_config_t *cfg)
{
    return cfg->half_width[0] > cfg->half_width[1] ? cfg->half_width[0] : cfg->half_width[1];
}

static uint32_t metric_taps(const auvid_metric_config_t *cfg)
{
    uint32_t ends = cfg->velocity_us > 0 ? 2u : 0u;
    return auvid_metric_is_linear(cfg) ? 2 * metric_max_half_width(cfg) * cfg->passes + 1 + ends
                                       : cfg->row_cells;
}

static uint32_t metric_overlap(const auvid_metric_config_t *cfg)
{
    return (metric_taps(cfg) + cfg->row_cells - 1) / cfg->row_cells;
}

/* Check that the filter exists (smoother.h) and fits. */
static auvid_status_t metric_check_filter(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    bool linear = auvid_metric_is_linear(cfg);
    uint32_t max_half = metric_max_half_width(cfg);
    uint32_t min_half = (uint32_t)cfg->half_width[0] + cfg->half_width[1] - max_half;
    if (metric_taps(cfg) > AUVID_MAX_TAPS) {
        return auvid_refuse(why, AUVID_ERR_SIZE, linear ? "half_width" : "row_cells",
                            (auvid_real_t)metric_taps(cfg), AUVID_MAX_TAPS);
    }
    if (metric_overlap(cfg) > AUVID_MAX_OVERLAP) {
        return auvid_refuse(
            why, AUVID_ERR_SIZE, "row_cells", (auvid_real_t)cfg->row_cells,
            (auvid_real_t)((metric_taps(cfg) + AUVID_MAX_OVERLAP - 1) / AUVID_MAX_OVERLAP));
    }
    if (!linear) {
        return AUVID_OK;
    }
    if (max_half > AUVID_MAX_HALF_WIDTH) {
        return auvid_refuse(why, AUVID_ERR_SIZE, "half_width", (auvid_real_t)max_half,
                            AUVID_MAX_HALF_WIDTH);
    }
    if (cfg->order > AUVID_SMOOTHER_MAX_ORDER) {
        return auvid_refuse(why, AUVID_ERR_RANGE, "order", (auvid_real_t)cfg->order,
                            AUVID_SMOOTHER_MAX_ORDER);
    }
    return cfg->order <= 2 * min_half
               ? AUVID_OK
               : auvid_refuse(why, AUVID_ERR_SINGULAR, "order", (auvid_real_t)cfg->order,
                              (auvid_real_t)(2 * min_half));
}

/* Check that all channels and R factors fit. */
static auvid_status_t metric_check_columns(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    uint32_t free = cfg->free == 0 ? UINT32_MAX : cfg->free, channels = 0, factor = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        uint32_t order = cfg->vehicle->columns[j] == 0 ? 0 : AUVID_METRIC_DELAYS;
        for (uint32_t left = cfg->vehicle->columns[j] & free; left != 0; left &= left - 1) {
            ++order;
        }
        channels += order;
        factor += AUVID_QR_FACTOR(order);
    }
    if (channels > AUVID_MAX_COLUMNS) {
        return auvid_refuse(why, AUVID_ERR_SIZE, "free: AUVID_MAX_COLUMNS", (auvid_real_t)channels,
                            AUVID_MAX_COLUMNS);
    }
    return factor <= AUVID_MAX_FACTOR ? AUVID_OK
                                      : auvid_refuse(why, AUVID_ERR_SIZE, "free: AUVID_MAX_FACTOR",
                                                     (auvid_real_t)factor, AUVID_MAX_FACTOR);
}

auvid_status_t auvid_metric_check(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_status_t status = auvid_vehicle_check_fields(cfg->vehicle, why);
    status = status == AUVID_OK ? metric_check_ranges(cfg, why) : status;
    status = status == AUVID_OK ? metric_check_filter(cfg, why) : status;
    return status == AUVID_OK ? metric_check_columns(cfg, why) : status;
}

static void metric_make_filter(auvid_metric_t *m)
{
    const auvid_metric_config_t *cfg = &m->cfg;
    m->taps = (uint8_t)metric_taps(cfg);
    m->overlap = (uint8_t)metric_overlap(cfg);
    if (!auvid_metric_is_linear(cfg)) { /* means over the row time */
        for (int i = 0; i < m->taps; ++i) {
            m->kernel[0][i] = AUVID_C(1.0) / (auvid_real_t)m->taps;
        }
        metric_make_window(m, RESIDUAL_SMOOTHING_S);
        return;
    }
    metric_make_window(m, AUVID_C(0.0));
    auvid_real_t cells = (auvid_real_t)cfg->velocity_us / (auvid_real_t)cfg->cell_us;
    m->interpolation_spread = auvid_min(cells * cells / AUVID_C(12.0), AUVID_C(0.5));
    metric_make_kernel(m, m->kernel[0], cfg->half_width[0]);
    metric_make_kernel(m, m->kernel[1], cfg->half_width[1]);
}

/* Assign channels and an R factor to each modelled DoF. In the residual path the model linearised
 * at an estimate uses them. */
static void metric_lay_out(auvid_metric_t *m)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    uint32_t free = m->cfg.free == 0 ? UINT32_MAX : m->cfg.free;
    uint32_t factor = 0, channel = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        m->columns[j] = vehicle->columns[j] & free;
        m->factor_at[j] = (uint16_t)factor;
        m->channel_at[j] = (uint16_t)channel;
        if (vehicle->columns[j] == 0) {
            continue;
        }
        for (int i = 0; i < vehicle->parameters; ++i) {
            if (m->columns[j] >> i & 1u) {
                m->index[channel + m->count[j]++] = (uint8_t)i;
            }
        }
        uint32_t order = m->count[j] + (uint32_t)AUVID_METRIC_DELAYS;
        channel += order;
        factor += AUVID_QR_FACTOR(order);
    }
    m->channel_at[AUVID_DOF_COUNT] = (uint16_t)channel;
}

auvid_status_t auvid_metric_init(auvid_metric_t *metric, const auvid_metric_config_t *cfg)
{
    if (metric == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_metric_check(cfg, NULL);
    if (status < 0) {
        return status;
    }
    metric->cfg = *cfg;
    memset((unsigned char *)metric + sizeof metric->cfg, 0, sizeof *metric - sizeof metric->cfg);
    metric_make_filter(metric);
    metric_lay_out(metric);
    memcpy(metric->delay_s, metric->cfg.delay_s, sizeof metric->delay_s);
    metric->first_order_lag = metric->cfg.first_order_lag;
    return AUVID_OK;
}

int auvid_metric_slot(const auvid_metric_t *m, int age)
{
    return (int)auvid_metric_ring_index(m->sets_stored, m->cfg.sets, m->from + (uint32_t)age);
}
