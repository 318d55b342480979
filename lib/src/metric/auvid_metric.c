/*
 * Metric (Karras et al. 2013, III-B): its configuration and its layout.
 *
 * auvid_metric_rows.c forms rows from cells, auvid_metric_sets.c collects them in sets.
 * auvid_metric_merge.c merges sets to one weighted R factor. auvid_metric_cost.c evaluates costs.
 */
#include "auvid/detail/metric.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../models/auvid_vehicle_internal.h"
#include "auvid_metric_internal.h"

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
        .max_cell_us = 800000,
        .velocity_us = 200000,
        .row_cells = 5,
        .set_rows = 60,
        .sets = AUVID_MAX_SETS,
        .half_width = {10, 7},
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
    REALS_IN(auvid_metric_config_t, tau_max, AUVID_DOF_COUNT, AUVID_C(1e-9), AUVID_C(1e9)),
    METRIC_REALS(excitation_threshold, 1, AUVID_C(0.0), AUVID_C(1.0)),
    METRIC_WHOLE(cell_us, 1, 1000, 1000000),
    METRIC_WHOLE(max_cell_us, 1, 0, 1000000),
    METRIC_WHOLE(velocity_us, 1, 0, 1000000),
    METRIC_WHOLE(row_cells, 1, 1, 65535),
    METRIC_WHOLE(set_rows, 1, 1, 65535),
    METRIC_WHOLE(sets, 1, 1, 255),
    METRIC_WHOLE(half_width, 2, 1, 255),
    METRIC_WHOLE(lag, 2, 1, AUVID_METRIC_LAGS),
    METRIC_WHOLE(passes, 1, 1, 2),
    METRIC_WHOLE(closed_loop, 1, 0, (1 << AUVID_DOF_COUNT) - 1),
    METRIC_WHOLE(open_loop, 1, 0, (1 << AUVID_DOF_COUNT) - 1),
    METRIC_REALS(delay_sigma_s, 1, AUVID_C(0.0), AUVID_C(1.0)),
};

/* Check the delays: a cell is their unit. */
static void metric_check_delays(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_real_t cell_s = (auvid_real_t)cfg->cell_us * AUVID_C(1e-6);
    auvid_real_t longest =
        cell_s * (auvid_real_t)(AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1));
    auvid_real_t earliest = /* accepts a rounded delay of the metric */
        -cell_s * ((auvid_real_t)AUVID_METRIC_EARLY_CELLS + AUVID_C(0.001));
    const auvid_field_t delays = METRIC_REALS(delay_s, AUVID_DOF_COUNT, earliest, longest);
    auvid_check_fields(why, cfg, &delays, 1);
}

void auvid_metric_count(const auvid_vehicle_t *vehicle, uint32_t free, uint32_t *columns,
                        uint32_t *factor)
{
    *columns = *factor = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        uint32_t left = vehicle->columns[j] & (free == 0 ? UINT32_MAX : free);
        uint32_t order =
            vehicle->columns[j] == 0 ? 0 : auvid_count_bits(left) + AUVID_METRIC_DELAYS;
        *columns += order;
        *factor += AUVID_QR_FACTOR(order);
    }
}

/* Check that all channels and R factors fit. */
static void metric_check_columns(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    uint32_t channels, factor;
    auvid_metric_count(cfg->vehicle, cfg->free, &channels, &factor);
    auvid_check_count(why, AUVID_ERR_SIZE, "free: AUVID_MAX_COLUMNS", channels, AUVID_MAX_COLUMNS);
    auvid_check_count(why, AUVID_ERR_SIZE, "free: AUVID_MAX_FACTOR", factor, AUVID_MAX_FACTOR);
}

uint32_t auvid_metric_taps(const auvid_metric_config_t *cfg, bool rows)
{
    uint32_t smoother =
        2 * auvid_metric_max_half(cfg) * cfg->passes + 1 + (cfg->velocity_us > 0 ? 2u : 0u);
    return rows ? cfg->row_cells : smoother;
}

/* Check that the filter's taps, and the rows that they overlap, fit. */
static void metric_check_taps(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    bool mean = auvid_path_stores_rows(cfg->vehicle->path);
    uint32_t taps = auvid_metric_taps(cfg, mean);
    const char *field = mean ? "row_cells" : "half_width";
    uint32_t rows = (taps + AUVID_MAX_OVERLAP - 1) / AUVID_MAX_OVERLAP; /* cells between rows */
    auvid_check_count(why, AUVID_ERR_SIZE, field, taps, AUVID_MAX_TAPS);
    auvid_check_limit(why, cfg->row_cells >= rows, AUVID_ERR_SIZE, "row_cells",
                      (auvid_real_t)cfg->row_cells, (auvid_real_t)rows);
}

static void metric_check(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_vehicle_check_fields(cfg->vehicle, why);
    auvid_check_part(why, "metric");
    AUVID_CHECK_TABLE(why, cfg, metric_fields);
    metric_check_delays(cfg, why);
    if (why->status != AUVID_OK) {
        return;
    }
    auvid_check_count(why, AUVID_ERR_SIZE, "sets", cfg->sets, AUVID_MAX_SETS);
    uint32_t max_rows = 60000u / cfg->sets;
    uint32_t mask = (uint32_t)(((uint64_t)1 << cfg->vehicle->parameters) - 1);
    auvid_check_limit(why, cfg->set_rows <= max_rows, AUVID_ERR_RANGE, "set_rows",
                      (auvid_real_t)cfg->set_rows, (auvid_real_t)max_rows);
    auvid_check_limit(why, cfg->free == 0 || (cfg->free & mask) != 0, AUVID_ERR_PARAMETERS, "free",
                      (auvid_real_t)cfg->free, (auvid_real_t)mask);
    auvid_check_limit(why, (cfg->open_loop & cfg->closed_loop) == 0, AUVID_ERR_RANGE, "open_loop",
                      (auvid_real_t)cfg->open_loop,
                      (auvid_real_t)((1u << AUVID_DOF_COUNT) - 1u - cfg->closed_loop));
    cfg->vehicle->path->check(cfg, why);
    metric_check_taps(cfg, why);
    metric_check_columns(cfg, why);
}

uint32_t auvid_metric_free_of(const auvid_metric_t *m, uint8_t excited)
{
    uint32_t free = 0;
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        if (excited >> m->cfg.vehicle->parameter[i].dof & 1) {
            free |= 1u << i;
        }
    }
    return m->cfg.free == 0 ? free : free & m->cfg.free;
}

/* Terms of an equation: its parameters are of this DoF and in no equation of an excited DoF; of
 * this DoF; of others. */
enum { OWN, SHARED, OTHER, CLASSES };

void auvid_metric_order_columns(auvid_metric_t *m)
{
    auvid_metric_layout_t *layout = &m->layout;
    const auvid_parameter_t *of = m->cfg.vehicle->parameter;
    uint32_t known = auvid_metric_free_of(m, m->result.excited);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        known |= auvid_metric_is_excited(m, j) ? layout->columns[j] : 0u;
    }
    memcpy(layout->merged_index, layout->index, sizeof layout->index);
    memcpy(layout->leading, layout->count, sizeof layout->count);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        uint8_t *to = layout->merged_index + layout->channel_at[j];
        const uint8_t *from = layout->index + layout->channel_at[j];
        int at = 0;
        for (int class = 0; class < CLASSES && !auvid_metric_is_excited(m, j); ++class) {
            for (int k = 0; k < layout->count[j]; ++k) {
                int of_term = (int)of[from[k]].dof != j ? OTHER
                              : known >> from[k] & 1u   ? SHARED
                                                        : OWN;
                if (of_term == class) {
                    to[at++] = from[k];
                }
            }
            layout->leading[j] = (uint8_t)(class == OWN ? at : layout->leading[j]);
        }
    }
}

/* Assign channels and an R factor to each modelled DoF, and the filter's taps. In the residual path
 * the model linearised at an estimate uses the channels. */
static void metric_lay_out(auvid_metric_t *m)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    uint32_t free = m->cfg.free == 0 ? UINT32_MAX : m->cfg.free;
    uint32_t factor = 0, channel = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        m->layout.columns[j] = vehicle->columns[j] & free;
        m->layout.factor_at[j] = (uint16_t)factor;
        m->layout.channel_at[j] = (uint16_t)channel;
        if (vehicle->columns[j] == 0) {
            continue;
        }
        for (int i = 0; i < vehicle->parameters; ++i) {
            if (m->layout.columns[j] >> i & 1u) {
                m->layout.index[channel + m->layout.count[j]++] = (uint8_t)i;
            }
        }
        uint32_t order = m->layout.count[j] + (uint32_t)AUVID_METRIC_DELAYS;
        channel += order;
        factor += AUVID_QR_FACTOR(order);
    }
    m->layout.channel_at[AUVID_DOF_COUNT] = (uint16_t)channel;
    uint32_t taps = auvid_metric_taps(&m->cfg, auvid_metric_stores_rows(m));
    m->layout.taps = (uint8_t)taps;
    m->layout.overlap = (uint8_t)((taps + m->cfg.row_cells - 1u) / m->cfg.row_cells);
    auvid_metric_order_columns(m);
}

void auvid_metric_set_up(auvid_metric_t *metric, const auvid_metric_config_t *cfg,
                         auvid_refusal_t *why)
{
    metric_check(cfg, why);
    if (why->status != AUVID_OK) {
        return;
    }
    metric->cfg = *cfg;
    memset((unsigned char *)metric + sizeof metric->cfg, 0, sizeof *metric - sizeof metric->cfg);
    metric_lay_out(metric);
    if (auvid_metric_stores_rows(metric)) { /* a checkpoint contains those that are not written */
        memset(cfg->rows, 0, (size_t)(cfg->sets + 1) * cfg->set_rows * sizeof *cfg->rows);
    }
    metric->cfg.vehicle->path->make_filter(metric);
    memcpy(metric->result.delay_s, metric->cfg.delay_s, sizeof metric->result.delay_s);
    metric->result.first_order_lag = metric->cfg.first_order_lag;
}

auvid_status_t auvid_metric_init(auvid_metric_t *metric, const auvid_metric_config_t *cfg)
{
    auvid_refusal_t why;
    if (metric == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_metric_set_up(metric, cfg, &why);
    return why.status;
}
