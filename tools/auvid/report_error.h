/**
 * @file report_error.h
 * Errors of the program: one line on stderr.
 */
#ifndef PROGRAM_COMPLAIN_H
#define PROGRAM_COMPLAIN_H

/** Exit status of bad usage or data. */
#define EXIT_REFUSED 2

/** Print "auvid: <message>" as exactly one line, whatever the arguments hold. */
void report_error_line(const char *format, ...);

/** Print "auvid: warning: <message>" likewise: the program goes on. */
void report_warning(const char *format, ...);

/** As report_error_line; its value is EXIT_REFUSED: return report_error(...); */
#define report_error(...) (report_error_line(__VA_ARGS__), EXIT_REFUSED)

#endif
