#include "binomial.h"

#include <math.h>
#include <stdlib.h>

bool campaign_is_long(void)
{
    return getenv("AUVID_TEST_LONG") != NULL;
}

/* P(K <= k) of n draws with probability p, 0 < p < 1. */
static double at_most(double k, double n, double p)
{
    double sum = 0.0;
    for (double i = 0.0; i <= k; i += 1.0) {
        sum += exp(lgamma(n + 1.0) - lgamma(i + 1.0) - lgamma(n - i + 1.0) + i * log(p) +
                   (n - i) * log1p(-p));
    }
    return sum;
}

/* Where P(K <= k) falls through `level` as p grows. */
static double falls_through(double k, double n, double level)
{
    double low = 0.0, high = 1.0;
    for (int step = 0; step < 60; ++step) {
        double p = 0.5 * (low + high);
        if (at_most(k, n, p) > level) {
            low = p;
        } else {
            high = p;
        }
    }
    return 0.5 * (low + high);
}

double binomial_upper(double k, double n, double alpha)
{
    return k >= n ? 1.0 : falls_through(k, n, alpha);
}

double binomial_lower(double k, double n, double alpha)
{
    return k <= 0.0 ? 0.0 : falls_through(k - 1.0, n, 1.0 - alpha);
}
