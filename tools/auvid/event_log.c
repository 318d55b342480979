#include "event_log.h"

#include <stdarg.h>
#include <stdio.h>

void event_log_add(event_log_t *story, double t_s, const char *format, ...)
{
    char text[EVENT_LOG_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!story->silent) {
        printf("  %7.2f s  %s\n", t_s, text);
    }
    if (story->lines < EVENT_LOG_LINES) {
        story->line[story->lines].t_s = t_s;
        (void)snprintf(story->line[story->lines].text, EVENT_LOG_LENGTH, "%s", text);
        ++story->lines;
    }
}
