/**
 * @file event_log.h
 * What happened in a scenario, and when (simulated time): lines on stdout, or kept for JSON.
 */
#ifndef PROGRAM_STORY_H
#define PROGRAM_STORY_H

#include <stdbool.h>

/** Most lines, and the longest one. */
enum { EVENT_LOG_LINES = 120, EVENT_LOG_LENGTH = 120 };

typedef struct {
    const char *name; /**< of the scenario */
    bool silent;      /**< lines are kept only */
    int lines;
    struct {
        double t_s;
        char text[EVENT_LOG_LENGTH];
    } line[EVENT_LOG_LINES];
} event_log_t;

/** Tell a line. The text must not hold quotes or backslashes. Lines beyond EVENT_LOG_LINES are not
 * kept. */
void event_log_add(event_log_t *events, double t_s, const char *format, ...);

#endif
