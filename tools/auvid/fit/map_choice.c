/*
 * Which map from commands to forces fits a vehicle: each is identified with on one part of the
 * data, and judged by the error of simulated velocity on another part. This error has the same unit
 * for all maps, that of a force has not. Errors of the same time are compared, and their difference
 * has an interval by bootstrap: over blocks of time of another log; over the parts of the same
 * logs, because all blocks of a part depend on one estimate.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit.h"
#include "heldout.h"
#include "simulator.h"
#include "../base/report_error.h"
#include "../report/statistics.h"

/* Parts of the logs, each held out once, if there is no other log. */
enum { PARTS = 5 };
/* With fewer blocks no interval can be trusted. */
enum { MIN_BLOCKS = 8 };

/* A map that is tried. */
typedef struct {
    thrust_map_kind_t kind; /* THRUST_MAP_NEWTON: as configured */
    heldout_blocks_t *blocks;
    uint32_t dofs;    /* bit j: DoF j is predicted, in all parts */
    double *relative; /* [blocks] error, as a part of the variance of the velocity */
} candidate_t;

/* ---- the candidates ---- */

/* Name of the map as configured: that of the vehicle's groups, if it is the same for all. */
static const char *told_name(const log_use_t *use)
{
    if (use->kind == INPUT_COMMAND) {
        return thrust_map_name[THRUST_MAP_LINEAR];
    }
    int kind = -1;
    for (int i = 0; i < use->vehicle->maps; ++i) {
        bool other = kind >= 0 && use->vehicle->map[i].kind != kind;
        kind = other ? THRUST_MAPS : use->vehicle->map[i].kind;
        if (other) {
            break;
        }
    }
    return kind < 0 || kind == THRUST_MAPS ? "as in the vehicle file" : thrust_map_name[kind];
}

/* The signed square of a measured speed is what `rpm` says. */
static bool is_told(const char *told, thrust_map_kind_t kind)
{
    bool rpm =
        kind == THRUST_MAP_SIGNED_SQUARE && strcmp(told, thrust_map_name[THRUST_MAP_RPM]) == 0;
    return rpm || strcmp(told, thrust_map_name[kind]) == 0;
}

static int list_candidates(const log_use_t *use, candidate_t candidate[REPORT_MAPS],
                           report_maps_t *maps)
{
    static const thrust_map_kind_t others[] = {THRUST_MAP_LINEAR, THRUST_MAP_SIGNED_SQUARE};
    const char *told = told_name(use);
    int count = 0;
    candidate[count] = (candidate_t){.kind = THRUST_MAP_NEWTON};
    maps->map[count++].name = told;
    for (int i = 0; i < 2; ++i) {
        if (!is_told(told, others[i])) {
            candidate[count] = (candidate_t){.kind = others[i]};
            maps->map[count++].name = thrust_map_name[others[i]];
        }
    }
    maps->count = count;
    return count;
}

/* ---- their errors ---- */

/* Identifies with what is not held out, and simulates what is. */
static int judge_part(job_t *job, const log_set_t *held_out, candidate_t *c)
{
    fitted_t *fitted = fit_choose_model(job);
    if (fitted == NULL) {
        return EXIT_REFUSED;
    }
    job->use.calibrated = job->known_force ? &fitted->calibrated : NULL;
    const auvid_identifier_t *id = &fitted->id;
    const auvid_estimate_t *e = &id->estimate;
    c->blocks->impossible = c->blocks->impossible || e->number == 0;
    int status = heldout_simulate(held_out, &job->use, &id->recorder.cfg, id->metric.cfg.vehicle, e,
                                  NULL, c->blocks);
    c->dofs &= c->blocks->dofs;
    job->use.calibrated = NULL;
    fit_forget_models(job);
    job->same_cells = true;
    return status;
}

/* Judges a map on the other log, or on each part of the training logs. */
static int judge(job_t *job, candidate_t *c)
{
    uint64_t start_us = job->log[0].start_us, span_us = job->survey.end_us + 1 - start_us;
    int parts = job->test.logs > 0 ? 1 : PARTS, status = fit_use_map(job, c->kind);
    c->dofs = UINT32_MAX;
    c->blocks = heldout_blocks();
    if (c->blocks == NULL) {
        return EXIT_REFUSED;
    }
    for (int part = 0; part < parts && status == 0 && !c->blocks->impossible; ++part) {
        log_set_t held_out = job->test;
        if (parts > 1) {
            job->train.from_us = start_us + span_us * (uint64_t)part / PARTS;
            job->train.to_us = start_us + span_us * (uint64_t)(part + 1) / PARTS;
            held_out = job->train;
            held_out.only = true;
        }
        status = judge_part(job, &held_out, c);
    }
    job->train.from_us = job->train.to_us = 0;
    return status;
}

/* Squared error of a block: at most that of predicting no motion. A simulation that diverges once
 * would outweigh all other blocks. */
static double bounded_error(const heldout_sums_t *block)
{
    return block->ee < block->yy ? block->ee : block->yy; /* so is NaN */
}

/* Computes the error of each block, relative to the variance of the velocity, mean of the DoF. */
static bool scale_errors(candidate_t *c, uint32_t dofs)
{
    const heldout_blocks_t *b = c->blocks;
    double axes = 0.0;
    c->relative = calloc(b->used + 1, sizeof *c->relative);
    for (int j = 0; j < AUVID_DOF_COUNT && c->relative != NULL; ++j) {
        heldout_sums_t all = {0};
        for (size_t i = 0; i < b->used; ++i) {
            all.count += b->block[i][j].count;
            all.y += b->block[i][j].y;
            all.yy += b->block[i][j].yy;
        }
        double about_mean = all.yy - all.y * all.y / fmax(all.count, 1.0);
        if (!(dofs >> j & 1u) || !(about_mean > 0.0)) {
            continue;
        }
        axes += 1.0;
        for (size_t i = 0; i < b->used; ++i) {
            c->relative[i] += bounded_error(&b->block[i][j]) / about_mean;
        }
    }
    for (size_t i = 0; i < b->used && c->relative != NULL; ++i) {
        c->relative[i] /= fmax(axes, 1.0);
    }
    return c->relative != NULL;
}

/* Difference of the errors from those of the first map, and its interval. Parts are of equal time,
 * so each has as many blocks. */
static void compare(const candidate_t *first, const candidate_t *c, const report_maps_t *maps,
                    uint64_t seed, report_map_t *map)
{
    size_t blocks = maps->blocks, parts = maps->other_log ? blocks : PARTS;
    double drawn[RESAMPLES];
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 0);
    for (size_t i = 0; i < blocks; ++i) {
        map->error += c->relative[i];
        map->difference += c->relative[i] - first->relative[i];
    }
    for (int k = 0; k < RESAMPLES; ++k) {
        drawn[k] = 0.0;
        for (size_t i = 0; i < parts; ++i) {
            size_t part = (size_t)(sim_rng_uniform(&rng) * (double)parts);
            size_t end = (part + 1) * blocks / parts;
            for (size_t at = part * blocks / parts; at < end; ++at) {
                drawn[k] += c->relative[at] - first->relative[at];
            }
        }
    }
    map->low = statistics_quantile(drawn, RESAMPLES, 0.025);
    map->high = statistics_quantile(drawn, RESAMPLES, 0.975);
}

/* ---- the choice ---- */

static int compare_all(const job_t *job, candidate_t candidate[REPORT_MAPS], report_maps_t *maps)
{
    uint32_t dofs = UINT32_MAX;
    maps->blocks = 0;
    for (int i = 0; i < maps->count; ++i) {
        maps->map[i].judged = !candidate[i].blocks->impossible && candidate[i].blocks->used > 0;
        dofs &= maps->map[i].judged ? candidate[i].dofs : UINT32_MAX;
        bool fewer = maps->blocks == 0 || candidate[i].blocks->used < maps->blocks;
        maps->blocks = maps->map[i].judged && fewer ? candidate[i].blocks->used : maps->blocks;
    }
    for (int i = 0; i < maps->count; ++i) {
        const candidate_t *first = maps->map[0].judged ? &candidate[0] : &candidate[i];
        report_map_t *map = &maps->map[i];
        if (map->judged && !scale_errors(&candidate[i], dofs)) {
            return report_error("fit: not enough memory");
        }
        if (map->judged) {
            compare(first, &candidate[i], maps, job->options->seed, map);
        }
        bool better = map->judged &&
                      !(maps->map[maps->best].judged && maps->map[maps->best].error <= map->error);
        maps->best = better ? i : maps->best;
    }
    const report_map_t *best = &maps->map[maps->best];
    bool sure = maps->map[0].judged && maps->blocks >= MIN_BLOCKS && best->high < 0.0;
    maps->used = sure ? maps->best : 0;
    return 0;
}

static int choose(job_t *job)
{
    candidate_t candidate[REPORT_MAPS];
    report_maps_t *maps = &job->maps;
    int count = list_candidates(&job->use, candidate, maps), status = 0;
    maps->other_log = job->test.logs > 0;
    for (int i = 0; i < count && status == 0; ++i) {
        status = judge(job, &candidate[i]);
    }
    status = status != 0 ? status : compare_all(job, candidate, maps);
    for (int i = 0; i < count; ++i) {
        free(candidate[i].blocks);
        free(candidate[i].relative);
    }
    job->same_cells = false;
    job->cell_us = 0;
    return status != 0 ? status : fit_use_map(job, candidate[maps->used].kind);
}

bool fit_has_maps(const job_t *job)
{
    log_use_t trial = job->use;
    return log_use_map(&trial, THRUST_MAP_LINEAR);
}

int fit_choose_map(job_t *job)
{
    static const thrust_map_kind_t named[] = {
        [MAP_LINEAR] = THRUST_MAP_LINEAR, [MAP_SIGNED_SQUARE] = THRUST_MAP_SIGNED_SQUARE};
    const options_t *options = job->options;
    if (options->map == MAP_AS_TOLD) {
        return 0;
    }
    if (!fit_has_maps(job)) {
        return report_error(
            "%s: --map needs commands (cmd_*, thruster_1 ..), but %s", job->log[0].csv.path,
            job->use.kind == INPUT_THRUSTER_COMMAND ? "the vehicle's map says that they are newtons"
                                                    : "the log has forces");
    }
    return options->map == MAP_AUTO ? choose(job) : fit_use_map(job, named[options->map]);
}

/* ---- words ---- */

/* Are all others worse than the first map beyond doubt? */
static bool is_best(const report_maps_t *maps)
{
    bool best = maps->best == 0;
    for (int i = 1; i < maps->count; ++i) {
        best = best && (!maps->map[i].judged || maps->map[i].low > 0.0);
    }
    return best;
}

static void print_reason(const report_maps_t *maps)
{
    const char *own = maps->map[0].name, *best = maps->map[maps->best].name;
    if (maps->used > 0) {
        printf("%s instead of %s (as configured), because it predicts motion better", best, own);
    } else if (!maps->map[0].judged) {
        printf("%s, as configured: with it nothing can be predicted, so the maps do not compare",
               own);
    } else if (maps->blocks < MIN_BLOCKS) {
        printf("%s, as configured: the log is too short to compare maps", own);
    } else if (maps->best > 0) {
        printf("%s, as configured: %s has a smaller error, but not beyond doubt", own, best);
    } else {
        printf(is_best(maps) ? "%s, as configured, and the best"
                             : "%s, as configured: no other map is better beyond doubt",
               own);
    }
}

void fit_print_maps(const report_maps_t *maps)
{
    if (maps->count == 0) {
        return;
    }
    printf("  map      ");
    print_reason(maps);
    putchar('\n');
    if (maps->blocks > 0) {
        printf("           error of held-out velocity (1 - R2) in %zu blocks of 10 s of %s:\n",
               maps->blocks, maps->other_log ? "the other log" : "the same logs");
    }
    for (int i = 0; i < maps->count; ++i) {
        const report_map_t *map = &maps->map[i];
        if (!map->judged) {
            printf("           %-22s  nothing predicted: no force is explained\n", map->name);
        } else if (i == 0 || !maps->map[0].judged) {
            printf("           %-22s  %.4f\n", map->name, map->error);
        } else {
            printf("           %-22s  %.4f   difference %+.4f, 95 %% interval %+.4f to %+.4f\n",
                   map->name, map->error, map->difference, map->low, map->high);
        }
    }
}
