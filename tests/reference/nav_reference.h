// What the reference filters of navigation share: matrices, the rotation, random numbers.
#ifndef NAV_REFERENCE_H
#define NAV_REFERENCE_H

#include <Eigen/Dense>

#include <random>

#include "auvid/nav.h"

extern "C" {
#include "unity.h"
}

using Eigen::Matrix;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
typedef Matrix<double, 6, 6> Matrix6d;
typedef Matrix<double, 6, 1> Vector6d;

static inline Matrix3d rotation(const Vector3d &e)
{
    return (Eigen::AngleAxisd(e[2], Vector3d::UnitZ()) *
            Eigen::AngleAxisd(e[1], Vector3d::UnitY()) * Eigen::AngleAxisd(e[0], Vector3d::UnitX()))
        .toRotationMatrix();
}

struct World {
    std::mt19937_64 generator{20130613};
    double normal(double sigma)
    {
        return std::normal_distribution<double>(0, sigma)(generator);
    }
    double uniform(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(generator);
    }
    bool chance(double p)
    {
        return uniform(0, 1) < p;
    }
};

#endif
