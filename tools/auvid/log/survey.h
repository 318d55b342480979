/**
 * @file survey.h
 * The first pass over logs: is every row valid, how large are the inputs, how often does the
 * velocity come, is it held in the rows, are the units right?
 */
#ifndef PROGRAM_SURVEY_H
#define PROGRAM_SURVEY_H

#include "log_samples.h"

/** What was found in all logs together. */
typedef struct {
    size_t rows, gaps;
    size_t input_gaps;               /**< inputs further apart than gap_s */
    double input_s;                  /**< longest time between inputs */
    double span_s;                   /**< sum of the logs' lengths */
    double largest[AUVID_DOF_COUNT]; /**< of the inputs, as wrench */
    double largest_thrust;           /**< of a thruster [N], if these are the inputs */
    double voltage_V;                /**< largest voltage; 0: none */
    uint64_t end_us;                 /**< time of the last row in the replay */
    double gap_s;                    /**< longest time between rows without a gap */
    uint32_t *intervals;             /**< private: counts of the times between velocities [us] */
} survey_t;

/** Starts. Returns 0, or EXIT_REFUSED after one line on stderr. */
int survey_begin(survey_t *survey, double gap_s);

/** Reads a log, says what is ignored or held, and places it behind those before it. Returns 0, or
 * EXIT_REFUSED after one line on stderr. */
int survey_read(survey_t *survey, log_t *log, const log_use_t *use);

/** Finds the largest inputs of a log again, for another map. Returns 0, or EXIT_REFUSED after one
 * line on stderr. */
int survey_inputs(survey_t *survey, log_t *log, const log_use_t *use);

/** Median time between velocities [us], up to a second. */
double survey_velocity_us(const survey_t *survey);

/** Time between velocities [us] whose interpolation has the variance of all that are bridged, up to
 * gap_us: a gap of twice the time smooths four times as much, for twice as long. */
double survey_bridged_us(const survey_t *survey, double gap_us);

void survey_end(survey_t *survey);

#endif
