/**
 * @file binomial.h
 * Exact binomial bounds for campaigns, and which form of a campaign is wanted.
 */
#ifndef BINOMIAL_H
#define BINOMIAL_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Is AUVID_TEST_LONG in the environment? */
bool campaign_is_long(void);

/** Clopper-Pearson bounds of a probability of which k of n were seen: the largest one that would
 * show k or fewer, and the smallest that would show k or more, with probability `alpha`. */
double binomial_upper(double k, double n, double alpha);
double binomial_lower(double k, double n, double alpha);

#ifdef __cplusplus
}
#endif

#endif
