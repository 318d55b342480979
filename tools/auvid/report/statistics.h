/**
 * @file statistics.h
 * Error statistics over many runs, with bootstrap intervals.
 */
#ifndef PROGRAM_STATISTICS_H
#define PROGRAM_STATISTICS_H

#include "report.h"

/** Number of resamples of a bootstrap interval. */
enum { RESAMPLES = 2000 };

/** Quantile `part` 0..1 of n values, interpolated linearly; 0 if n is 0. Sorts the values. */
double statistics_quantile(double *value, size_t n, double part);

/** Values of every run. */
typedef struct {
    campaign_t sum; /**< reported results, complete after tally_finish */
    size_t room;    /* capacity in runs */
    double *square; /* mean squared relative error of the parameters of a run */
    double *evaluations;
    double *r2[AUVID_DOF_COUNT], *r2_truth[AUVID_DOF_COUNT];
    double *memory;
} tally_t;

/** Starts a tally of so many runs. Returns false if there is no memory. */
bool tally_begin(tally_t *tally, uint32_t runs);
/** Adds a run. */
void tally_add(tally_t *tally, const result_t *result);
/** Computes tally->sum, with seeded bootstrap intervals over the runs. first: any run; its truth is
 * that of all. */
void tally_finish(tally_t *tally, const result_t *first, uint64_t seed);
void tally_free(tally_t *tally);

#endif
