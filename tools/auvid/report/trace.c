#include "trace.h"

#include <math.h>

void trace_begin(trace_t *trace, size_t cells, double cell_s)
{
    double longest = fmax(floor(TRACE_MAX_STEP_S / cell_s), 1.0);
    double wanted = ceil((double)cells / TRACE_POINTS);
    *trace = (trace_t){.every = (uint32_t)fmax(fmin(wanted, longest), 1.0)};
}

void trace_add(trace_t *trace, const auvid_validation_t *validation, const auvid_sample_t *cell,
               bool after_gap)
{
    trace->gap = trace->gap || after_gap;
    if (trace->cells++ % trace->every != 0 || trace->points == TRACE_POINTS) {
        return;
    }
    if (trace->points == 0) {
        trace->start_us = cell->t_us;
    }
    trace_point_t *to = &trace->point[trace->points++];
    to->t_s = 1e-6 * (double)(cell->t_us - trace->start_us);
    to->after_gap = trace->gap && trace->points > 1;
    trace->gap = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        to->measured[j] = (cell->missing >> j & 1u) != 0 ? NAN : (float)cell->nu[j];
        to->predicted[j] = (float)validation->predicted[j];
    }
}
