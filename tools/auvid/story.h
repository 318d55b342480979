/**
 * @file story.h
 * What happened in a scenario, and when (simulated time): lines on stdout, or kept for JSON.
 */
#ifndef PROGRAM_STORY_H
#define PROGRAM_STORY_H

#include <stdbool.h>

/** Most lines, and the longest one. */
enum { STORY_LINES = 120, STORY_LENGTH = 120 };

typedef struct {
    const char *name; /**< of the scenario */
    bool silent;      /**< lines are kept only */
    int lines;
    struct {
        double t_s;
        char text[STORY_LENGTH];
    } line[STORY_LINES];
} story_t;

/** Tell a line. The text must not hold quotes or backslashes. Lines beyond STORY_LINES are not
 * kept. */
void story_tell(story_t *story, double t_s, const char *format, ...);

#endif
