/**
 * @file report_error.h
 * Error messages of the program: one line on stderr.
 */
#ifndef PROGRAM_COMPLAIN_H
#define PROGRAM_COMPLAIN_H

/** Exit status of bad usage or data. */
#define EXIT_REFUSED 2

/** Prints "auvid: <message>" as exactly one line, whatever the arguments contain. */
void report_error_line(const char *format, ...);

/** Prints "auvid: warning: <message>" in the same way. The program continues. */
void report_warning(const char *format, ...);

/** As report_error_line, with the value EXIT_REFUSED: return report_error(...); */
#define report_error(...) (report_error_line(__VA_ARGS__), EXIT_REFUSED)

#endif
