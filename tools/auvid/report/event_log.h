/**
 * @file event_log.h
 * Events of a scenario with their simulated times: printed on stdout, or stored for JSON.
 */
#ifndef PROGRAM_STORY_H
#define PROGRAM_STORY_H

#include <stdbool.h>

/** Largest number of lines; longest line. */
enum { EVENT_LOG_LINES = 120, EVENT_LOG_LENGTH = 120 };

typedef struct {
    const char *name; /**< of the scenario */
    bool silent;      /**< lines are stored and not printed */
    int lines;
    struct {
        double t_s;
        char text[EVENT_LOG_LENGTH];
    } line[EVENT_LOG_LINES];
} event_log_t;

/** Adds a line. The text must not contain quotes or backslashes. Lines after the first
 * EVENT_LOG_LINES are not stored. */
void event_log_add(event_log_t *events, double t_s, const char *format, ...);

#endif
