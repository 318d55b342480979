/*
 * Elementary functions: the error bounds of auvid_math.c, compared with libm in long double, and
 * the same bits with every compiler. AUVID_TEST_LONG tests the software square root for every
 * float.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/auvid_math_internal.h"
#include "base/auvid_sqrt_soft_internal.h"
#include "unity.h"

/* The bounds of auvid_math.c, in AUVID_EPSILON. */
#define SINCOS_BOUND 0.75L
#define SIN_RELATIVE_BOUND 1.25L
#define ATAN2_BOUND 2.0L

#define EPS ((long double)AUVID_EPSILON)
#define SWEEP 1000000

static auvid_rng_t rng;

void setUp(void)
{
    auvid_rng_seed(&rng, 1);
}

void tearDown(void)
{
}

static uint32_t bits_32(float x)
{
    uint32_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

static uint64_t bits_64(double x)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

static bool same(auvid_real_t a, auvid_real_t b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Uniform in [-limit, limit]. Every third angle is within 1e-3 of a multiple of pi/2, where the
 * reduction is most difficult. */
static auvid_real_t some_angle(int i, auvid_real_t limit)
{
    auvid_real_t x = (AUVID_C(2.0) * auvid_rng_uniform(&rng) - AUVID_C(1.0)) * limit;
    if (i % 3 == 0) {
        double near = floor((double)x / 1.5707963267948966) * 1.5707963267948966;
        x = (auvid_real_t)(near + 1e-3 * ((double)auvid_rng_uniform(&rng) - 0.5));
    }
    return auvid_clamp(x, -limit, limit);
}

static void test_software_sqrt_of_a_float_is_the_correctly_rounded_one(void)
{
    uint64_t step = getenv("AUVID_TEST_LONG") != NULL ? 1u : 997u;
    for (uint64_t i = 0; i <= UINT32_MAX; i += step) {
        uint32_t b = (uint32_t)i;
        float x;
        memcpy(&x, &b, sizeof x);
        uint32_t expected = x > 0.0f ? bits_32(sqrtf(x)) : 0u;
        if (auvid_sqrt_soft_32(b) != expected) {
            TEST_ASSERT_EQUAL_HEX32(expected, auvid_sqrt_soft_32(b));
        }
    }
}

static void test_software_sqrt_of_a_double_is_the_correctly_rounded_one(void)
{
    for (int i = 0; i < SWEEP; ++i) {
        uint64_t b = ((uint64_t)auvid_rng_next(&rng) << 32) | auvid_rng_next(&rng);
        if (i % 4 == 0) { /* denormals of all sizes */
            b = (b & ((UINT64_C(1) << 52) - 1u)) >> auvid_rng_below(&rng, 52);
        } else if (i % 4 == 1) { /* one below, at or above a square: hardest to round */
            double r = ldexp((double)(b >> 38), (int)(b & 63u) - 30);
            b = bits_64(r * r) - 1u + b % 3u;
        }
        double x;
        memcpy(&x, &b, sizeof x);
        uint64_t expected = x > 0.0 ? bits_64(sqrt(x)) : 0u;
        if (auvid_sqrt_soft_64(b) != expected) {
            TEST_ASSERT_EQUAL_HEX64(expected, auvid_sqrt_soft_64(b));
        }
    }
}

static void test_software_sqrt_is_correct_at_the_ends_of_the_range(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x7f800000u, auvid_sqrt_soft_32(0x7f800000u));
    TEST_ASSERT_EQUAL_HEX32(0u, auvid_sqrt_soft_32(0x7fc00000u));
    TEST_ASSERT_EQUAL_HEX32(0u, auvid_sqrt_soft_32(0x80000000u));
    TEST_ASSERT_EQUAL_HEX32(bits_32(sqrtf(1e-45f)), auvid_sqrt_soft_32(1u));
    TEST_ASSERT_EQUAL_HEX32(bits_32(sqrtf(3.4028235e38f)), auvid_sqrt_soft_32(0x7f7fffffu));
    TEST_ASSERT_EQUAL_HEX64(bits_64(sqrt(5e-324)), auvid_sqrt_soft_64(1u));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x7ff) << 52, auvid_sqrt_soft_64(UINT64_C(0x7ff) << 52));
    TEST_ASSERT_EQUAL_HEX64(0u, auvid_sqrt_soft_64(UINT64_MAX));
}

static void test_sqrt_is_the_correctly_rounded_one(void)
{
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t x = auvid_rng_uniform(&rng) * (auvid_real_t)(i + 1);
#ifdef AUVID_REAL_DOUBLE
        auvid_real_t expected = sqrt(x);
#else
        auvid_real_t expected = sqrtf(x);
#endif
        if (!same(expected, auvid_sqrt(x))) {
            TEST_FAIL_MESSAGE("sqrt differs from the instruction");
        }
    }
}

static void test_sqrt_of_negative_or_nan_is_zero_and_does_not_set_errno(void)
{
    volatile auvid_real_t zero = AUVID_C(0.0);
    errno = 0;
    TEST_ASSERT_TRUE(same(AUVID_C(0.0), auvid_sqrt(AUVID_C(-1.0))));
    TEST_ASSERT_TRUE(same(AUVID_C(0.0), auvid_sqrt(-zero)));
    TEST_ASSERT_TRUE(same(AUVID_C(0.0), auvid_sqrt(zero / zero)));
    TEST_ASSERT_EQUAL_INT(0, errno);
}

static void test_sincos_meet_their_bound_up_to_ten_thousand(void)
{
    long double worst = 0.0L;
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t x = some_angle(i, i % 2 == 0 ? AUVID_C(10000.0) : AUVID_C(10.0));
        auvid_real_t s, c;
        auvid_sincos(x, &s, &c);
        worst = fmaxl(worst, fabsl((long double)s - sinl((long double)x)));
        worst = fmaxl(worst, fabsl((long double)c - cosl((long double)x)));
    }
    TEST_ASSERT_TRUE(worst <= SINCOS_BOUND * EPS);
}

static void test_sin_meets_its_relative_bound_up_to_pi(void)
{
    long double worst = 0.0L;
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t x = some_angle(i, AUVID_PI);
        auvid_real_t s;
        long double exact = sinl((long double)x);
        auvid_sincos(x, &s, NULL);
        worst = fmaxl(worst, fabsl(((long double)s - exact) / exact));
    }
    TEST_ASSERT_TRUE(worst <= SIN_RELATIVE_BOUND * EPS);
}

static void test_sincos_is_odd_and_even_to_the_bit(void)
{
    for (int i = 0; i < 10000; ++i) {
        auvid_real_t x = some_angle(i, AUVID_C(10000.0));
        auvid_real_t s, c, s_minus, c_minus;
        auvid_sincos(x, &s, &c);
        auvid_sincos(-x, &s_minus, &c_minus);
        TEST_ASSERT_TRUE(same(s, -s_minus) && same(c, c_minus));
    }
}

static void test_single_sine_or_cosine_has_the_bits_of_sincos(void)
{
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t s, c, x = AUVID_C(2e4) * auvid_rng_uniform(&rng) - AUVID_C(1e4);
        x = i % 2 ? x * AUVID_C(1e-4) : x;
        auvid_sincos(x, &s, &c);
        TEST_ASSERT_TRUE(auvid_sin_turned(x, 0) == s && auvid_sin_turned(x, 1) == c);
    }
    TEST_ASSERT_FALSE(auvid_is_finite(auvid_sin_turned(AUVID_C(1.1e9), 0)));
    TEST_ASSERT_FALSE(auvid_is_finite(auvid_sin_turned((auvid_real_t)NAN, 1)));
}

static void test_all_finite_detects_a_value_that_is_not_at_any_index(void)
{
    const auvid_real_t bad[] = {(auvid_real_t)NAN, (auvid_real_t)INFINITY, (auvid_real_t)-INFINITY};
    auvid_real_t x[5] = {AUVID_C(0.0), AUVID_LARGEST, -AUVID_LARGEST, AUVID_C(-0.0),
                         AUVID_C(1e-40)};
    TEST_ASSERT_TRUE(auvid_all_finite(x, 5));
    for (int i = 0; i < 15; ++i) {
        auvid_real_t good = x[i % 5];
        x[i % 5] = bad[i / 5];
        TEST_ASSERT_FALSE(auvid_all_finite(x, 5));
        TEST_ASSERT_TRUE(auvid_all_finite(x, (size_t)(i % 5)));
        x[i % 5] = good;
    }
}

static void test_clear_writes_exactly_n_zeros(void)
{
    for (size_t n = 0; n < 20; ++n) {
        auvid_real_t x[21];
        for (size_t i = 0; i < 21; ++i) {
            x[i] = AUVID_C(1.0);
        }
        auvid_clear(x, n);
        for (size_t i = 0; i < 21; ++i) {
            TEST_ASSERT_TRUE(x[i] == (i < n ? AUVID_C(0.0) : AUVID_C(1.0)));
        }
    }
}

static void test_sincos_accepts_null_for_either_output(void)
{
    auvid_real_t s = AUVID_C(5.0);
    auvid_real_t c = AUVID_C(5.0);
    auvid_sincos(AUVID_C(0.0), &s, NULL);
    auvid_sincos(AUVID_C(0.0), NULL, &c);
    TEST_ASSERT_TRUE(s == AUVID_C(0.0) && c == AUVID_C(1.0));
}

/* A heading counts its revolutions: after a long dive it is only as exact as its last digit. */
static void test_sincos_of_many_revolutions_is_as_exact_as_the_angle(void)
{
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t s, c, x = AUVID_C(1e4) + AUVID_C(1e6) * auvid_rng_uniform(&rng);
        x = i % 2 ? -x : x;
        auvid_sincos(x, &s, &c);
        double digit = 4.0 * (double)AUVID_EPSILON * fabs((double)x);
        TEST_ASSERT_TRUE(fabs((double)s - sin((double)x)) < digit);
        TEST_ASSERT_TRUE(fabs((double)c - cos((double)x)) < digit);
    }
}

static void test_sincos_is_nan_out_of_range(void)
{
    volatile auvid_real_t zero = AUVID_C(0.0);
    const auvid_real_t bad[] = {AUVID_C(1.1e9), AUVID_C(-1e30), AUVID_C(1.0) / zero, zero / zero};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        auvid_real_t s, c;
        auvid_sincos(bad[i], &s, &c);
        TEST_ASSERT_TRUE(s != s && c != c);
    }
}

static void test_atan2_meets_its_bound_in_all_quadrants(void)
{
    long double worst = 0.0L;
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t y = AUVID_C(2.0) * auvid_rng_uniform(&rng) - AUVID_C(1.0);
        auvid_real_t x = AUVID_C(2.0) * auvid_rng_uniform(&rng) - AUVID_C(1.0);
        for (uint32_t shrink = i % 2 == 0 ? 0u : auvid_rng_below(&rng, 30); shrink > 0u; --shrink) {
            y *= AUVID_C(0.5);
        }
        if (i % 4 == 3) {
            auvid_real_t swap = x;
            x = y;
            y = swap;
        }
        long double exact = atan2l((long double)y, (long double)x);
        if (exact != 0.0L) {
            long double error = (long double)auvid_atan2(y, x) - exact;
            worst = fmaxl(worst, fabsl(error / exact));
        }
    }
    TEST_ASSERT_TRUE(worst <= ATAN2_BOUND * EPS);
}

static void test_atan2_is_exact_on_the_axes_and_zero_at_the_origin(void)
{
    const auvid_real_t half_pi = AUVID_C(0.5) * AUVID_PI;
    TEST_ASSERT_TRUE(same(AUVID_C(0.0), auvid_atan2(AUVID_C(0.0), AUVID_C(0.0))));
    TEST_ASSERT_TRUE(same(AUVID_C(0.0), auvid_atan2(AUVID_C(0.0), AUVID_C(3.0))));
    TEST_ASSERT_TRUE(same(AUVID_PI, auvid_atan2(AUVID_C(0.0), AUVID_C(-3.0))));
    TEST_ASSERT_TRUE(same(half_pi, auvid_atan2(AUVID_C(3.0), AUVID_C(0.0))));
    TEST_ASSERT_TRUE(same(-half_pi, auvid_atan2(AUVID_C(-3.0), AUVID_C(0.0))));
    TEST_ASSERT_TRUE(same(-AUVID_PI, auvid_atan2(AUVID_C(-1e-30), AUVID_C(-3.0))));
}

/* R = Rz(psi) Ry(theta) Rx(phi), multiplied out from the three elementary rotations. */
static void expected_rotation(double phi, double theta, double psi, double r[3][3])
{
    const double x[3][3] = {{1, 0, 0}, {0, cos(phi), -sin(phi)}, {0, sin(phi), cos(phi)}};
    const double y[3][3] = {{cos(theta), 0, sin(theta)}, {0, 1, 0}, {-sin(theta), 0, cos(theta)}};
    const double z[3][3] = {{cos(psi), -sin(psi), 0}, {sin(psi), cos(psi), 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            r[i][j] = 0.0;
            for (int k = 0; k < 3; ++k) {
                for (int l = 0; l < 3; ++l) {
                    r[i][j] += z[i][k] * y[k][l] * x[l][j];
                }
            }
        }
    }
}

static void test_rotation_is_the_product_of_yaw_pitch_and_roll(void)
{
    for (int n = 0; n < 1000; ++n) {
        auvid_real_t phi = some_angle(n, AUVID_PI);
        auvid_real_t theta = some_angle(n, AUVID_PI);
        auvid_real_t psi = some_angle(n, AUVID_C(100.0));
        auvid_real_t r[3][3];
        double expected[3][3];
        auvid_rotation(phi, theta, psi, r);
        expected_rotation((double)phi, (double)theta, (double)psi, expected);
        for (int i = 0; i < 9; ++i) {
            double error = fabs((double)r[i / 3][i % 3] - expected[i / 3][i % 3]);
            TEST_ASSERT_TRUE(error <= 4.0 * (double)AUVID_EPSILON);
        }
    }
}

static void test_rng_gives_the_published_sequence_of_its_authors(void)
{
    const uint32_t expected[] = {11520u,      0u,          5927040u,    70819200u,  2031721883u,
                                 1637235492u, 1287239034u, 3734860849u, 3729100597u};
    auvid_rng_t r = {{1u, 2u, 3u, 4u}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; ++i) {
        TEST_ASSERT_EQUAL_HEX32(expected[i], auvid_rng_next(&r));
    }
}

static void test_rng_seed_is_expanded_by_splitmix64(void)
{
    auvid_rng_t r;
    auvid_rng_seed(&r, 1234567u); /* first outputs 6457827717110365317, 3203168211198807973 */
    TEST_ASSERT_EQUAL_HEX32((uint32_t)UINT64_C(6457827717110365317), r.s[0]);
    TEST_ASSERT_EQUAL_HEX32((uint32_t)(UINT64_C(6457827717110365317) >> 32), r.s[1]);
    TEST_ASSERT_EQUAL_HEX32((uint32_t)UINT64_C(3203168211198807973), r.s[2]);
    TEST_ASSERT_EQUAL_HEX32((uint32_t)(UINT64_C(3203168211198807973) >> 32), r.s[3]);
}

static void test_rng_uniform_and_below_stay_in_range_and_have_the_right_mean(void)
{
    double sum = 0.0;
    double sum_below = 0.0;
    for (int i = 0; i < SWEEP; ++i) {
        auvid_real_t x = auvid_rng_uniform(&rng);
        uint32_t k = auvid_rng_below(&rng, 7u);
        TEST_ASSERT_TRUE(x >= AUVID_C(0.0) && x < AUVID_C(1.0) && k < 7u);
        sum += (double)x;
        sum_below += (double)k;
    }
    /* 4.5 standard errors of the mean of 1e6 draws: sigma 0.2887 and 2; false alarm 1e-5 */
    TEST_ASSERT_TRUE(fabs(sum / SWEEP - 0.5) < 4.5 * 0.2887 / 1000.0);
    TEST_ASSERT_TRUE(fabs(sum_below / SWEEP - 3.0) < 4.5 * 2.0 / 1000.0);
    TEST_ASSERT_EQUAL_UINT32(0u, auvid_rng_below(&rng, 1u));
}

static void test_all_functions_give_the_recorded_bits(void)
{
#ifdef AUVID_REAL_DOUBLE
    const uint32_t golden = 0x8b103983u;
#else
    const uint32_t golden = 0xd3e790ffu;
#endif
    uint32_t hash = 2166136261u;
    for (int i = 0; i < 100000; ++i) {
        auvid_real_t x = (auvid_rng_uniform(&rng) - AUVID_C(0.5)) * AUVID_C(20000.0);
        auvid_real_t out[4];
        auvid_sincos(x, &out[0], &out[1]);
        out[2] = auvid_atan2(x, auvid_rng_uniform(&rng) * AUVID_C(1000.0) - AUVID_C(500.0));
        out[3] = auvid_sqrt(auvid_abs(x));
        for (int j = 0; j < 4; ++j) {
            uint64_t b = 0;
            memcpy(&b, &out[j], sizeof out[j]); /* little endian */
            hash = (((hash << 5) | (hash >> 27)) ^ (uint32_t)b) * 16777619u;
            hash = (((hash << 5) | (hash >> 27)) ^ (uint32_t)(b >> 32)) * 16777619u;
        }
    }
    TEST_ASSERT_EQUAL_HEX32(golden, hash);
}

/* ---- conversion of integers ---- */

/* Of all magnitudes: random ones, and those next to half-way between two neighbours. */
static void test_an_integer_of_64_bits_is_converted_with_one_rounding(void)
{
    const uint64_t edge[] = {0, 1, UINT32_MAX, (uint64_t)UINT32_MAX + 1, UINT64_MAX};
    for (size_t i = 0; i < sizeof edge / sizeof edge[0]; ++i) {
        TEST_ASSERT_TRUE(auvid_real_of(edge[i]) == (auvid_real_t)edge[i]);
    }
    for (int i = 0; i < 100000; ++i) {
        uint64_t n = (uint64_t)auvid_rng_next(&rng) << 32 | auvid_rng_next(&rng);
        uint64_t half = n >> 40 << 40 | (uint64_t)1 << 39;
        for (unsigned shift = (unsigned)i % 40, step = 0; step < 3; ++step) {
            uint64_t near = (half >> shift) + step - 1;
            TEST_ASSERT_TRUE(auvid_real_of(near) == (auvid_real_t)near);
        }
        n >>= i % 64;
        TEST_ASSERT_TRUE(auvid_real_of(n) == (auvid_real_t)n);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_software_sqrt_of_a_float_is_the_correctly_rounded_one);
    RUN_TEST(test_software_sqrt_of_a_double_is_the_correctly_rounded_one);
    RUN_TEST(test_software_sqrt_is_correct_at_the_ends_of_the_range);
    RUN_TEST(test_sqrt_is_the_correctly_rounded_one);
    RUN_TEST(test_sqrt_of_negative_or_nan_is_zero_and_does_not_set_errno);
    RUN_TEST(test_sincos_meet_their_bound_up_to_ten_thousand);
    RUN_TEST(test_sin_meets_its_relative_bound_up_to_pi);
    RUN_TEST(test_sincos_is_odd_and_even_to_the_bit);
    RUN_TEST(test_single_sine_or_cosine_has_the_bits_of_sincos);
    RUN_TEST(test_all_finite_detects_a_value_that_is_not_at_any_index);
    RUN_TEST(test_clear_writes_exactly_n_zeros);
    RUN_TEST(test_sincos_accepts_null_for_either_output);
    RUN_TEST(test_sincos_of_many_revolutions_is_as_exact_as_the_angle);
    RUN_TEST(test_sincos_is_nan_out_of_range);
    RUN_TEST(test_atan2_meets_its_bound_in_all_quadrants);
    RUN_TEST(test_atan2_is_exact_on_the_axes_and_zero_at_the_origin);
    RUN_TEST(test_rotation_is_the_product_of_yaw_pitch_and_roll);
    RUN_TEST(test_rng_gives_the_published_sequence_of_its_authors);
    RUN_TEST(test_rng_seed_is_expanded_by_splitmix64);
    RUN_TEST(test_rng_uniform_and_below_stay_in_range_and_have_the_right_mean);
    RUN_TEST(test_all_functions_give_the_recorded_bits);
    RUN_TEST(test_an_integer_of_64_bits_is_converted_with_one_rounding);
    return UNITY_END();
}
