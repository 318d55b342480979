/**
 * @file binomial.h
 * Exact binomial bounds for campaigns, and which form of a campaign is wanted.
 */
#ifndef BINOMIAL_H
#define BINOMIAL_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Is AUVID_TEST_LONG in the environment? */
bool campaign_is_long(void);

/** Runs of a campaign's short form: a quarter under the sanitizers and in double, which look at the
 * code; what the figures are is for the usual build to say. */
static inline uint32_t campaign_runs(uint32_t runs)
{
#if defined(__SANITIZE_ADDRESS__) || defined(AUVID_REAL_DOUBLE)
    return (runs + 3u) / 4u;
#else
    return runs;
#endif
}

/** Clopper-Pearson bounds of a probability of which k of n were seen: the largest one that would
 * show k or fewer, and the smallest that would show k or more, with probability `alpha`. */
double binomial_upper(double k, double n, double alpha);
double binomial_lower(double k, double n, double alpha);

#ifdef __cplusplus
}
#endif

#endif
