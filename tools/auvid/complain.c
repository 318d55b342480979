#include "complain.h"

#include <stdarg.h>
#include <stdio.h>

void complain_line(const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (char *c = line; *c != '\0'; ++c) {
        if ((unsigned char)*c < ' ' || *c == 127) {
            *c = '?'; /* a line break in a file's name or in a field */
        }
    }
    (void)fflush(stdout);
    fprintf(stderr, "auvid: %s\n", line);
}
