/*
 * The sizes of config.h that a configuration needs. Reads no array whose length depends on them, so
 * it also works for a model that does not fit.
 */
#include "auvid_identifier_internal.h"

#include "../metric/auvid_metric_internal.h"

auvid_status_t auvid_identifier_needs(const auvid_identifier_config_t *cfg, auvid_needs_t *needs)
{
    if (cfg == NULL || needs == NULL || cfg->vehicle == NULL || cfg->vehicle->path == NULL) {
        return AUVID_ERR_NULL;
    }
    const auvid_metric_config_t *metric = &cfg->metric;
    uint32_t parameters = cfg->vehicle->parameters;
    if (parameters < 1 || parameters > 32) {
        return AUVID_ERR_PARAMETERS;
    }
    bool rows = auvid_path_is_residual(cfg->vehicle->path);
    uint32_t searched = rows && metric->estimate_delay ? 1 : 0;
    for (uint32_t i = 0; i < parameters; ++i) {
        searched += metric->free == 0 || (metric->free >> i & 1u) != 0 ? 1 : 0;
    }
    bool local = cfg->search.phases == AUVID_SEARCH_LOCAL;
    uint32_t taps = auvid_metric_taps(metric, rows);
    uint32_t apart = metric->row_cells > 0 ? metric->row_cells : 1;
    *needs = (auvid_needs_t){
        .parameters = searched > parameters ? searched : parameters,
        .population = cfg->search.population > 0 ? cfg->search.population
                      : local && !rows           ? 0
                                                 : searched + 1,
        .sets = metric->sets,
        .commands = rows ? 1 : 0,
        .taps = taps,
        .overlap = (taps + apart - 1) / apart,
        .half_width = rows ? 1 : auvid_metric_max_half(metric),
    };
    auvid_metric_count(cfg->vehicle, metric->free, &needs->columns, &needs->factor);
    if (rows && needs->columns < 33 + 3) {
        needs->columns = 33 + 3;
    }
    bool fits = needs->parameters <= AUVID_MAX_PARAMETERS &&
                needs->population <= AUVID_MAX_POPULATION && needs->sets <= AUVID_MAX_SETS &&
                needs->commands <= AUVID_MAX_COMMANDS && needs->taps <= AUVID_MAX_TAPS &&
                needs->overlap <= AUVID_MAX_OVERLAP && needs->half_width <= AUVID_MAX_HALF_WIDTH &&
                needs->columns <= AUVID_MAX_COLUMNS && needs->factor <= AUVID_MAX_FACTOR;
    return fits ? AUVID_OK : AUVID_ERR_SIZE;
}
