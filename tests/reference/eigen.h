/* What tests with Eigen include, precompiled: see the Makefile. */
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>
