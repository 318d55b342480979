/**
 * @file golden.h
 * A golden vector: lines of text that a test program writes, compared with the file of the same
 * name in this folder. GOLDEN=write in the environment writes the file instead.
 *
 * Numbers are exact: a real number is written as hexadecimal, like C's %a. One test program
 * includes it once; it runs in the top folder of the repository.
 */
#ifndef GOLDEN_H
#define GOLDEN_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

/** Raise it when the lines get another meaning. */
enum { GOLDEN_FORMAT = 1, GOLDEN_BYTES = 1 << 15 };

static char golden_now[GOLDEN_BYTES], golden_recorded[GOLDEN_BYTES];
static size_t golden_length;

/** Append to the vector; lines end with \n. */
static inline void golden_put(const char *format, ...)
{
    va_list arguments;
    size_t room = sizeof golden_now - golden_length;
    va_start(arguments, format);
    int length = vsnprintf(golden_now + golden_length, room, format, arguments);
    va_end(arguments);
    TEST_ASSERT_TRUE_MESSAGE(length >= 0 && (size_t)length < room, "GOLDEN_BYTES are too few");
    golden_length += (size_t)length;
}

/** Append " key value". Without %a: small C libraries do not have it. */
static inline void golden_number(const char *key, float x)
{
    uint32_t bits;
    char digits[7];
    memcpy(&bits, &x, sizeof bits);
    int exponent = (int)(bits >> 23 & 255u);
    uint32_t fraction = bits & 0x7fffffu;
    golden_put(" %s %s", key, bits >> 31 ? "-" : "");
    if (exponent == 255) {
        golden_put(fraction != 0 ? "nan" : "inf");
        return;
    }
    snprintf(digits, sizeof digits, "%06x", (unsigned)(fraction << 1));
    for (int i = 6; i > 0 && digits[i - 1] == '0'; --i) {
        digits[i - 1] = '\0';
    }
    int power = exponent != 0 ? exponent - 127 : fraction != 0 ? -126 : 0;
    golden_put("0x%d%s%sp%+d", exponent != 0, digits[0] != '\0' ? "." : "", digits, power);
}

/** Add to a hash, which begins with 0; as FNV-1a. */
static inline uint32_t golden_hash(uint32_t hash, const void *data, size_t bytes)
{
    hash ^= 2166136261u;
    for (size_t i = 0; i < bytes; ++i) {
        hash = (hash ^ ((const uint8_t *)data)[i]) * 16777619u;
    }
    return hash;
}

static inline void golden_begin(uint64_t seed)
{
    golden_length = 0;
    golden_put("format %d\nseed %u\n", GOLDEN_FORMAT, (unsigned)seed);
}

static inline size_t golden_read(const char *path)
{
    FILE *file = fopen(path, "rb");
    size_t length = file == NULL ? 0 : fread(golden_recorded, 1, GOLDEN_BYTES - 1, file);
    if (file != NULL) {
        fclose(file);
    }
    golden_recorded[length] = '\0';
    return length;
}

/* The largest relative difference of the real numbers of two lines, up to where their words differ.
 */
static inline double golden_difference(const char *a, const char *b)
{
    double largest = 0.0;
    while (*a != '\0' && *b != '\0') {
        size_t m = strcspn(a, " "), n = strcspn(b, " ");
        bool real = strncmp(a + (*a == '-'), "0x", 2) == 0;
        if (real) {
            double x = strtod(a, NULL), y = strtod(b, NULL);
            double scale = x * x > y * y ? x : y, part = x == y ? 0.0 : (x - y) / scale;
            largest = part * part > largest * largest ? part : largest;
        } else if (m != n || memcmp(a, b, m) != 0) {
            break;
        }
        a += m + (a[m] == ' ');
        b += n + (b[n] == ' ');
    }
    return largest < 0.0 ? -largest : largest;
}

/* Cuts the next line off *at; empty at the end. */
static inline char *golden_line(char **at)
{
    char *line = *at, *end = strchr(line, '\n');
    *at = end == NULL ? line + strlen(line) : end + 1;
    if (end != NULL) {
        *end = '\0';
    }
    return line;
}

/* Prints the first line that differs and how much differs. @return lines that differ */
static inline int golden_compare(const char *path)
{
    char *now = golden_now, *recorded = golden_recorded;
    int differing = 0;
    double largest = 0.0;
    for (int line = 1; *now != '\0' || *recorded != '\0'; ++line) {
        const char *is = golden_line(&now), *was = golden_line(&recorded);
        if (strcmp(is, was) != 0 && differing++ == 0) {
            printf("%s:%d:\n  recorded: %s\n  now:      %s\n", path, line, was, is);
        }
        double difference = golden_difference(is, was);
        largest = difference > largest ? difference : largest;
    }
    if (differing > 0) {
        printf("%s: %d lines differ, real numbers by up to %.3g of their value\n", path, differing,
               largest);
    }
    return differing;
}

/** Compare with tests/golden/NAME.txt, or write it. */
static inline void golden_end(const char *name)
{
    const char *mode = getenv("GOLDEN");
    char path[80];
    snprintf(path, sizeof path, "tests/golden/%s.txt", name);
    size_t length = golden_read(path);
    if (mode != NULL && strcmp(mode, "write") == 0) {
        FILE *file = fopen(path, "wb");
        TEST_ASSERT_NOT_NULL(file);
        TEST_ASSERT_TRUE(fwrite(golden_now, 1, golden_length, file) == golden_length);
        TEST_ASSERT_EQUAL(0, fclose(file));
        (void)golden_compare(path);
        return;
    }
    TEST_ASSERT_TRUE_MESSAGE(length > 0, "the recorded vector cannot be read");
    TEST_ASSERT_EQUAL_MESSAGE(0, golden_compare(path), path);
}

#endif
