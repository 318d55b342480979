/**
 * @file config.h
 * Compile-time choices: the arithmetic and the sizes of every fixed array in auvid.
 *
 * Who includes it: every other header. Who changes it: nobody edits this file; define the macros on
 * the command line, or collect them in one header of your own and build everything with
 * -DAUVID_USER_CONFIG='"my_auvid_config.h"'. A wrong value stops the build with a sentence.
 *
 * The library and its caller must agree on all of this. They are checked: the sizes are part of the
 * link-time name of each function whose arguments depend on them, and of what a vehicle model
 * points to (AUVID_BUILD), so what was built with other sizes fails to link instead of corrupting
 * memory.
 *
 * Values must be plain decimal integers (no parentheses, no arithmetic): they become part of names.
 */
#ifndef AUVID_CONFIG_H
#define AUVID_CONFIG_H

#ifdef AUVID_USER_CONFIG
#include AUVID_USER_CONFIG
#endif

#define AUVID_VERSION_MAJOR 0
#define AUVID_VERSION_MINOR 1
#define AUVID_VERSION_PATCH 0
#define AUVID_VERSION_STRING "0.1.0"

#ifdef __FAST_MATH__
#error "auvid: build without -ffast-math: it removes the checks for NaN and changes the results"
#endif

/* AUVID_REAL_DOUBLE, when defined, makes auvid_real_t double instead of float (types.h). */

/** Parameters a vehicle model may have. Girona500 uses 17 (13 of Eq. 12-15 and 4 biases). 1..32. */
#ifndef AUVID_MAX_PARAMETERS
#define AUVID_MAX_PARAMETERS 17
#endif

/** Points the controlled random search may keep (m >= n + 1; 4 n is the default of the optimizer).
 * 2..1024. */
#ifndef AUVID_MAX_POPULATION
#define AUVID_MAX_POPULATION 68
#endif

/** Data sets in the ring of the metric. 1..64. */
#ifndef AUVID_MAX_SETS
#define AUVID_MAX_SETS 8
#endif

/** Thrusters of the allocation. 1..16. */
#ifndef AUVID_MAX_THRUSTERS
#define AUVID_MAX_THRUSTERS 8
#endif

/** 1 leaves out what smooths motion instead of rows, with its code and its memory: models without
 * regressor, and our literal reading of the paper, of Algorithm 2 too. 0 or 1. */
#ifndef AUVID_REGRESSOR_ONLY
#define AUVID_REGRESSOR_ONLY 0
#endif

/** Thruster commands recorded beside the wrench, for models without regressor that use them.
 * 1..16. */
#ifndef AUVID_MAX_COMMANDS
#if AUVID_REGRESSOR_ONLY
#define AUVID_MAX_COMMANDS 1
#else
#define AUVID_MAX_COMMANDS 8
#endif
#endif

/** Floats of one data set's triangular factors, all degrees of freedom together: a degree of
 * freedom whose equation has c parameters takes (c + 3)(c + 4) / 2. Girona500 with biases takes
 * 210. 10..8192. */
#ifndef AUVID_MAX_FACTOR
#define AUVID_MAX_FACTOR 210
#endif

/** Columns of all equations together, three for the wrench of each degree of freedom included: the
 * sum over the degrees of freedom of c + 3; Girona500 with biases takes 39. A model without
 * regressor takes 33 and three for each command: the least without AUVID_REGRESSOR_ONLY.
 * 33 + 3 AUVID_MAX_COMMANDS (10)..512. */
#ifndef AUVID_MAX_COLUMNS
#if AUVID_REGRESSOR_ONLY
#define AUVID_MAX_COLUMNS 39
#else
#define AUVID_MAX_COLUMNS 57
#endif
#endif

/** Taps of the filter through which rows and wrench pass, in cells of the recorder. 3..255. */
#ifndef AUVID_MAX_TAPS
#define AUVID_MAX_TAPS 51
#endif

/** Rows under construction at once: the filter's taps over the cells between two rows, rounded up.
 * 1..64. */
#ifndef AUVID_MAX_OVERLAP
#define AUVID_MAX_OVERLAP 9
#endif

/** Largest half-width of the stand-alone smoother, in samples. 1..127. */
#ifndef AUVID_MAX_HALF_WIDTH
#define AUVID_MAX_HALF_WIDTH 50
#endif

/** Sines in one sum of sines of the excitation. 1..16. */
#ifndef AUVID_MAX_SINES
#define AUVID_MAX_SINES 5
#endif

/** Segments in one excitation sequence. 1..64. */
#ifndef AUVID_MAX_SEGMENTS
#define AUVID_MAX_SEGMENTS 16
#endif

#if AUVID_MAX_PARAMETERS < 1 || AUVID_MAX_PARAMETERS > 32
#error "auvid: AUVID_MAX_PARAMETERS must be 1..32"
#endif
#if AUVID_MAX_POPULATION < 2 || AUVID_MAX_POPULATION > 1024
#error "auvid: AUVID_MAX_POPULATION must be 2..1024"
#endif
#if AUVID_MAX_SETS < 1 || AUVID_MAX_SETS > 64
#error "auvid: AUVID_MAX_SETS must be 1..64"
#endif
#if AUVID_MAX_THRUSTERS < 1 || AUVID_MAX_THRUSTERS > 16
#error "auvid: AUVID_MAX_THRUSTERS must be 1..16"
#endif
#if AUVID_MAX_FACTOR < 10 || AUVID_MAX_FACTOR > 8192
#error "auvid: AUVID_MAX_FACTOR must be 10..8192"
#endif
#if AUVID_REGRESSOR_ONLY != 0 && AUVID_REGRESSOR_ONLY != 1
#error "auvid: AUVID_REGRESSOR_ONLY must be 0 or 1"
#endif
#if AUVID_MAX_COLUMNS < 10 || AUVID_MAX_COLUMNS > 512
#error "auvid: AUVID_MAX_COLUMNS must be 10..512"
#endif
#if AUVID_MAX_COMMANDS < 1 || AUVID_MAX_COMMANDS > 16
#error "auvid: AUVID_MAX_COMMANDS must be 1..16"
#endif
#if !AUVID_REGRESSOR_ONLY && 33 + 3 * AUVID_MAX_COMMANDS > AUVID_MAX_COLUMNS
#error "auvid: AUVID_MAX_COLUMNS must be at least 33 + 3 AUVID_MAX_COMMANDS"
#endif
#if AUVID_MAX_TAPS < 3 || AUVID_MAX_TAPS > 255
#error "auvid: AUVID_MAX_TAPS must be 3..255"
#endif
#if AUVID_MAX_OVERLAP < 1 || AUVID_MAX_OVERLAP > 64
#error "auvid: AUVID_MAX_OVERLAP must be 1..64"
#endif
#if AUVID_MAX_HALF_WIDTH < 1 || AUVID_MAX_HALF_WIDTH > 127
#error "auvid: AUVID_MAX_HALF_WIDTH must be 1..127"
#endif
#if AUVID_MAX_SINES < 1 || AUVID_MAX_SINES > 16
#error "auvid: AUVID_MAX_SINES must be 1..16"
#endif
#if AUVID_MAX_SEGMENTS < 1 || AUVID_MAX_SEGMENTS > 64
#error "auvid: AUVID_MAX_SEGMENTS must be 1..64"
#endif

/* The link-time name of a function carries what its arguments depend on: tests/lint/sources.py
 * finds one that does not. AUVID_SIZED1(f, A) becomes f_f32_A or f_f64_A, and so on. */
#ifdef AUVID_REAL_DOUBLE
#define AUVID_SIZED0(name) name##_f64
#define AUVID_SIZED1_(name, a) name##_f64_##a
#define AUVID_SIZED2_(name, a, b) name##_f64_##a##_##b
#define AUVID_SIZED12_(name, a, b, c, d, e, f, g, h, i, j, k, l)                                   \
    name##_f64_##a##_##b##_##c##_##d##_##e##_##f##_##g##_##h##_##i##_##j##_##k##_##l
#else
#define AUVID_SIZED0(name) name##_f32
#define AUVID_SIZED1_(name, a) name##_f32_##a
#define AUVID_SIZED2_(name, a, b) name##_f32_##a##_##b
#define AUVID_SIZED12_(name, a, b, c, d, e, f, g, h, i, j, k, l)                                   \
    name##_f32_##a##_##b##_##c##_##d##_##e##_##f##_##g##_##h##_##i##_##j##_##k##_##l
#endif
#define AUVID_SIZED1(name, a) AUVID_SIZED1_(name, a)
#define AUVID_SIZED2(name, a, b) AUVID_SIZED2_(name, a, b)
#define AUVID_SIZED_ALL12(name, a, b, c, d, e, f, g, h, i, j, k, l)                                \
    AUVID_SIZED12_(name, a, b, c, d, e, f, g, h, i, j, k, l)
/** All sizes, for structs that hold several modules. */
#define AUVID_SIZED(name)                                                                          \
    AUVID_SIZED_ALL12(name, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION, AUVID_MAX_SETS,            \
                      AUVID_MAX_THRUSTERS, AUVID_MAX_FACTOR, AUVID_MAX_COLUMNS, AUVID_MAX_TAPS,    \
                      AUVID_MAX_OVERLAP, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES, AUVID_MAX_COMMANDS,  \
                      AUVID_REGRESSOR_ONLY)

#endif
