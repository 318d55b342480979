#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200112L /* isatty, fileno */
#include <unistd.h>
#define IS_TERMINAL(file) (isatty(fileno(file)) == 1)
#else
#define IS_TERMINAL(file) false
#endif

#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>

enum { WIDTH = 30 };

static double wall_clock_s(void)
{
    struct timespec now = {0};
    (void)timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_begin(progress_t *progress, bool lines)
{
    *progress = (progress_t){.terminal = IS_TERMINAL(stderr), .shown = -1};
    progress->quiet = !lines && !progress->terminal;
    progress->started_s = wall_clock_s();
}

void progress_bar(progress_t *progress, double part, const char *format, ...)
{
    int hundredths = (int)(100.0 * part);
    if (!progress->terminal || hundredths == progress->shown) {
        return;
    }
    progress->shown = hundredths;
    char bar[WIDTH + 1], note[60];
    for (int i = 0; i < WIDTH; ++i) {
        bar[i] = i < (int)(part * WIDTH) ? '#' : '.';
    }
    bar[WIDTH] = '\0';
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(note, sizeof note, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\r[%s] %3d %%  %s\x1b[K", bar, hundredths, note);
    (void)fflush(stderr);
}

void progress_line(const progress_t *progress, const char *format, ...)
{
    if (progress->quiet || progress->terminal) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

double progress_end(const progress_t *progress)
{
    if (progress->terminal && progress->shown >= 0) {
        fputs("\r\x1b[K", stderr);
        (void)fflush(stderr);
    }
    return wall_clock_s() - progress->started_s;
}
