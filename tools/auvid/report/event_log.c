#include "event_log.h"

#include <stdarg.h>
#include <stdio.h>

void event_log_add(event_log_t *events, double t_s, const char *format, ...)
{
    char text[EVENT_LOG_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!events->silent) {
        printf("  %7.2f s  %s\n", t_s, text);
    }
    if (events->lines < EVENT_LOG_LINES) {
        events->line[events->lines].t_s = t_s;
        (void)snprintf(events->line[events->lines].text, EVENT_LOG_LENGTH, "%s", text);
        ++events->lines;
    }
}
