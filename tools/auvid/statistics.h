/**
 * @file statistics.h
 * Error statistics over many runs, and the resampling that gives intervals.
 */
#ifndef PROGRAM_STATISTICS_H
#define PROGRAM_STATISTICS_H

#include "report.h"

/** Resamples behind every bootstrap interval. */
enum { RESAMPLES = 2000 };

/** Value at part 0..1 of n values, which are sorted; straight between neighbours. 0 for none. */
double statistics_quantile(double *value, size_t n, double part);

/** Values of every run. */
typedef struct {
    campaign_t sum; /**< what is reported, complete after tally_finish */
    size_t room;    /* runs */
    double *square; /* mean squared relative error of the run's parameters */
    double *evaluations;
    double *r2[AUVID_DOF_COUNT], *r2_truth[AUVID_DOF_COUNT];
    double *memory;
} tally_t;

/** Begin, for so many runs. False: no memory. */
bool tally_begin(tally_t *tally, uint32_t runs);
/** Add a run. */
void tally_add(tally_t *tally, const result_t *result);
/** Compute tally->sum; intervals by bootstrap over the runs, seeded. first: any run, whose truth is
 * that of all. */
void tally_finish(tally_t *tally, const result_t *first, uint64_t seed);
void tally_free(tally_t *tally);

#endif
