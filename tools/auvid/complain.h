/**
 * @file complain.h
 * Errors of the program: one line on stderr.
 */
#ifndef PROGRAM_COMPLAIN_H
#define PROGRAM_COMPLAIN_H

/** Exit status of bad usage or data. */
#define EXIT_REFUSED 2

/** Print "auvid: <message>" as exactly one line, whatever the arguments hold. */
void complain_line(const char *format, ...);

/** Print "auvid: warning: <message>" likewise: the program goes on. */
void complain_warning(const char *format, ...);

/** As complain_line; its value is EXIT_REFUSED: return complain(...); */
#define complain(...) (complain_line(__VA_ARGS__), EXIT_REFUSED)

#endif
