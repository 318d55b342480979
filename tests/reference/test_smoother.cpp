// Compares the smoother with least squares by QR in long double: orders, widths, derivatives and
// positions in the window, single coefficients and whole records.
#include <Eigen/Dense>

#include <cmath>
#include <cstdio>
#include <vector>

extern "C" {
#include "auvid/smoother.h"
#include "unity.h"
}

using Long = long double;
using Matrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Long, Eigen::Dynamic, 1>;

static const Long eps = AUVID_EPSILON;

void setUp()
{
}

void tearDown()
{
}

// Row s + h: the coefficients for the derivative d at position s, from the pseudo-inverse of the
// Vandermonde matrix in z = i / h; one matrix per order and half-width.
class Fit
{
  public:
    Fit(int half_width, int order) : h(half_width), p(order)
    {
        Matrix a(2 * h + 1, p + 1);
        for (int i = -h; i <= h; ++i) {
            for (int j = 0; j <= p; ++j) {
                a(i + h, j) = std::pow(Long(i) / h, j);
            }
        }
        Matrix identity = Matrix::Identity(2 * h + 1, 2 * h + 1);
        pseudo_inverse = a.householderQr().solve(identity);
    }
    // d/dt: z = t / (h dt)
    Vector coefficients(int position, int d, Long dt) const
    {
        Vector basis(p + 1);
        for (int j = 0; j <= p; ++j) {
            Long factor = 1;
            for (int q = 0; q < d; ++q) {
                factor *= j - q;
            }
            basis(j) = j < d ? Long(0) : factor * std::pow(Long(position) / h, j - d);
        }
        return pseudo_inverse.transpose() * basis / std::pow(h * dt, d);
    }

  private:
    int h, p;
    Matrix pseudo_inverse;
};

// Calls f(fit, half_width, order, derivative) for all values that the smoother accepts.
template <typename F> static void for_all(int least_order, F f)
{
    for (int h : {1, 2, 3, 4, 5, 6, 7, 8, 10, 13, 17, 22, 25, 31, 37, 43, 49, 50, 100, 127}) {
        if (h > AUVID_MAX_HALF_WIDTH) {
            break;
        }
        for (int p = least_order; p <= 5 && p <= 2 * h; ++p) {
            Fit fit(h, p);
            for (int d = 0; d <= 2 && d <= p; ++d) {
                f(fit, h, p, d);
            }
        }
    }
}

static void test_each_coefficient_is_within_three_epsilon_of_itself()
{
    const auvid_real_t dt = AUVID_C(0.02);
    Long worst = 0;
    long count = 0;
    for_all(0, [&](const Fit &fit, int h, int p, int d) {
        for (int s = -h; s <= h; s += (s == -h || s >= h - 1 || h < 8) ? 1 : 3) {
            std::vector<auvid_real_t> c(2 * h + 1);
            TEST_ASSERT_EQUAL_INT(AUVID_OK,
                                  auvid_smoother_coefficients(uint8_t(h), uint8_t(p), uint8_t(d),
                                                              dt, int16_t(s), c.data()));
            Vector expected = fit.coefficients(s, d, Long(dt));
            Long noise = 1e-17L * expected.cwiseAbs().maxCoeff(); // rounding of the reference
            for (int k = 0; k < 2 * h + 1; ++k) {
                Long error = std::fabs(Long(c[k]) - expected(k));
                TEST_ASSERT_TRUE(error <= 3 * eps * std::fabs(expected(k)) + noise);
                if (std::fabs(expected(k)) > noise / eps) {
                    worst = std::max(worst, error / std::fabs(expected(k)));
                }
                ++count;
            }
        }
    });
    std::printf("%ld coefficients, worst relative error %.2Lf epsilon\n", count, worst / eps);
}

static void test_symmetric_zeros_are_exact()
{
    for_all(0, [&](const Fit &, int h, int p, int d) {
        std::vector<auvid_real_t> c(2 * h + 1);
        auvid_smoother_coefficients(uint8_t(h), uint8_t(p), uint8_t(d), AUVID_C(1.0), 0, c.data());
        for (int k = 0; k <= h; ++k) {
            TEST_ASSERT_TRUE(c[h + k] == (d == 1 ? -c[h - k] : c[h - k]));
        }
    });
}

static void test_outputs_are_within_four_epsilon_edges_included()
{
    Long worst = 0;
    uint32_t state = 1;
    for_all(1, [&](const Fit &fit, int h, int p, int d) {
        auvid_smoother_config_t cfg = {uint8_t(h), uint8_t(p), uint8_t(d), AUVID_C(0.02)};
        auvid_smoother_t smoother;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_init(&smoother, &cfg));
        const int n = 3 * h + 20;
        std::vector<auvid_real_t> x(n), y;
        Long largest = 0;
        for (int i = 0; i < n; ++i) { // half of the records have a large offset
            state = state * 1664525u + 1013904223u;
            x[i] = auvid_real_t(state >> 8) / AUVID_C(8388608.0) -
                   (p % 2 == 0 ? AUVID_C(0.0) : AUVID_C(1.0));
            largest = std::max(largest, std::fabs(Long(x[i])));
            auvid_smoother_push(&smoother, x[i]);
            if (i == n - 1) {
                auvid_smoother_end(&smoother);
            }
            auvid_real_t value;
            while (auvid_smoother_take(&smoother, nullptr, &value) == AUVID_OK) {
                y.push_back(value);
            }
        }
        TEST_ASSERT_EQUAL_INT(n, int(y.size()));
        for (int i = 0; i < n; ++i) {
            int first = std::min(std::max(i - h, 0), n - 2 * h - 1);
            Vector c = fit.coefficients(i - first - h, d, Long(cfg.dt_s));
            Long expected = 0;
            for (int k = 0; k < 2 * h + 1; ++k) {
                expected += c(k) * Long(x[first + k]);
            }
            Long ratio = std::fabs(Long(y[i]) - expected) / (c.cwiseAbs().sum() * largest);
            worst = std::max(worst, ratio);
        }
    });
    std::printf("worst output error %.2Lf epsilon sum|c| max|x|\n", worst / eps);
    TEST_ASSERT_TRUE(worst <= 4 * eps);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_each_coefficient_is_within_three_epsilon_of_itself);
    RUN_TEST(test_symmetric_zeros_are_exact);
    RUN_TEST(test_outputs_are_within_four_epsilon_edges_included);
    return UNITY_END();
}
