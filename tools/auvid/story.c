#include "story.h"

#include <stdarg.h>
#include <stdio.h>

void story_tell(story_t *story, double t_s, const char *format, ...)
{
    char text[STORY_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!story->silent) {
        printf("  %7.2f s  %s\n", t_s, text);
    }
    if (story->lines < STORY_LINES) {
        story->line[story->lines].t_s = t_s;
        (void)snprintf(story->line[story->lines].text, STORY_LENGTH, "%s", text);
        ++story->lines;
    }
}
