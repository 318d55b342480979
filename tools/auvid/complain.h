/**
 * @file complain.h
 * Errors of the program: one line on stderr.
 */
#ifndef PROGRAM_COMPLAIN_H
#define PROGRAM_COMPLAIN_H

/** Exit status of bad usage or data. */
#define EXIT_REFUSED 2

/** Print "auvid: <message>" as exactly one line, whatever the arguments hold; returns
 * EXIT_REFUSED. */
int complain(const char *format, ...);

#endif
