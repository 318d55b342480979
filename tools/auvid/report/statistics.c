#include "statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulator.h"

/* A larger relative error of an identifiable parameter is misleading. */
#define MISLEADING 0.2

/* A larger relative error of a mass fails the run. */
#define MASS_TOLERANCE 0.1

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double statistics_quantile(double *value, size_t n, double part)
{
    if (n == 0) {
        return 0.0;
    }
    qsort(value, n, sizeof value[0], ascending);
    double at = part * (double)(n - 1);
    size_t low = (size_t)at, high = low + 1 < n ? low + 1 : low;
    return value[low] + (at - (double)low) * (value[high] - value[low]);
}

bool tally_begin(tally_t *tally, uint32_t runs)
{
    memset(tally, 0, sizeof *tally);
    tally->memory = calloc((size_t)runs * (2 + 2 * AUVID_DOF_COUNT), sizeof(double));
    if (tally->memory == NULL) {
        return false;
    }
    double *at = tally->memory;
    tally->room = runs;
    tally->square = at;
    tally->evaluations = at + runs;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        tally->r2[j] = at + (size_t)(2 + j) * runs;
        tally->r2_truth[j] = at + (size_t)(2 + AUVID_DOF_COUNT + j) * runs;
    }
    return true;
}

/* Compares errors with standard errors. The scales of thrust and DVL are exact here. */
static void count_coverage(campaign_t *c, const result_t *result)
{
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        double off = fabs((double)result->estimate.pi[i] - result->truth[i]);
        double sigma = report_sigma_told(result, i);
        bool sure = (result->estimate.confidence.identifiable >> i & 1u) != 0;
        c->known += isfinite(sigma);
        c->covered[0] += isfinite(sigma) && off <= sigma;
        c->covered[1] += isfinite(sigma) && off <= 2.0 * sigma;
        c->identifiable += sure;
        double tolerance =
            fabs(result->truth[i]) > 0.0 ? MISLEADING * fabs(result->truth[i]) : 4.0 * sigma;
        c->wrong += sure && !(off <= tolerance);
    }
}

void tally_add(tally_t *tally, const result_t *result)
{
    campaign_t *c = &tally->sum;
    const auvid_estimate_t *e = &result->estimate;
    bool not_converged = strcmp(report_status(result), "ok") != 0, failed = not_converged;
    double squares = 0.0;
    c->parameters = c->relative = 0;
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (!(result->free >> i & 1u)) {
            continue;
        }
        auvid_parameter_kind_t kind = result->vehicle->parameter[i].kind;
        bool mass = kind == AUVID_PARAMETER_MASS || kind == AUVID_PARAMETER_INERTIA;
        bool relative = fabs(result->truth[i]) > 0.0;
        double error =
            relative ? fabs((double)e->pi[i] / result->truth[i] - 1.0) : fabs((double)e->pi[i]);
        ++c->parameters;
        c->relative += relative;
        squares += relative ? error * error : 0.0;
        c->parameter_rms[i] += error * error;
        c->parameter_worst[i] = fmax(c->parameter_worst[i], relative ? 100.0 * error : error);
        c->worst_percent = fmax(c->worst_percent, relative ? 100.0 * error : 0.0);
        failed = failed || (mass && !(error <= MASS_TOLERANCE));
    }
    count_coverage(c, result);
    tally->square[c->runs] = squares / c->relative;
    tally->evaluations[c->runs] = (double)e->evaluations_crs + (double)e->evaluations_line;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        tally->r2[j][c->runs] = result->r2[j];
        tally->r2_truth[j][c->runs] = result->r2_truth[j];
    }
    c->failed += failed;
    c->not_converged = c->not_converged || not_converged;
    c->max_work = result->max_work > c->max_work ? result->max_work : c->max_work;
    ++c->runs;
}

/* 95 % interval of the rms error by bootstrap over the runs. */
static void bootstrap(const tally_t *tally, uint64_t seed, double interval[2])
{
    double rms[RESAMPLES];
    uint32_t runs = tally->sum.runs;
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 0);
    for (int k = 0; k < RESAMPLES; ++k) {
        double sum = 0.0;
        for (uint32_t i = 0; i < runs; ++i) {
            sum += tally->square[(size_t)(sim_rng_uniform(&rng) * runs)];
        }
        rms[k] = 100.0 * sqrt(sum / runs);
    }
    interval[0] = statistics_quantile(rms, RESAMPLES, 0.025);
    interval[1] = statistics_quantile(rms, RESAMPLES, 0.975);
}

void tally_finish(tally_t *tally, const result_t *first, uint64_t seed)
{
    campaign_t *c = &tally->sum;
    double sum = 0.0;
    for (uint32_t i = 0; i < c->runs; ++i) {
        sum += tally->square[i];
    }
    c->rms_percent = 100.0 * sqrt(sum / c->runs);
    bootstrap(tally, seed, c->interval);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        double unit = fabs(first->truth[i]) > 0.0 ? 100.0 : 1.0;
        c->parameter_rms[i] = unit * sqrt(c->parameter_rms[i] / c->runs);
    }
    c->evaluations_median = statistics_quantile(tally->evaluations, c->runs, 0.5);
    c->evaluations_p95 = statistics_quantile(tally->evaluations, c->runs, 0.95);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        c->r2_median[j] = statistics_quantile(tally->r2[j], c->runs, 0.5);
        c->r2_truth_median[j] = statistics_quantile(tally->r2_truth[j], c->runs, 0.5);
    }
}

void tally_free(tally_t *tally)
{
    free(tally->memory);
    tally->memory = NULL;
}
