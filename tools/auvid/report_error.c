#include "report_error.h"

#include <stdarg.h>
#include <stdio.h>

static void print_line(const char *kind, const char *format, va_list arguments)
{
    char line[512];
    (void)vsnprintf(line, sizeof line, format, arguments);
    for (char *c = line; *c != '\0'; ++c) {
        if ((unsigned char)*c < ' ' || *c == 127) {
            *c = '?'; /* a line break in a file name or in a field */
        }
    }
    (void)fflush(stdout);
    fprintf(stderr, "auvid: %s%s\n", kind, line);
}

void report_error_line(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("", format, arguments);
    va_end(arguments);
}

void report_warning(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("warning: ", format, arguments);
    va_end(arguments);
}

int report_refused(const char *who, auvid_status_t status, const auvid_refusal_t *why)
{
    char element[16] = "";
    if (why->element >= 0) {
        (void)snprintf(element, sizeof element, "[%d]", why->element);
    }
    return report_error("%s: configuration refused: %s%s%s%s is %g, limit %g: %s", who, why->part,
                        why->part[0] == '\0' ? "" : ".", why->field, element, (double)why->value,
                        (double)why->limit, auvid_status_str(status));
}
