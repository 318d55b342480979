/**
 * @file report_error.h
 * Error messages of the program: one line on stderr, with --json also an object on stdout.
 */
#ifndef PROGRAM_COMPLAIN_H
#define PROGRAM_COMPLAIN_H

#include "auvid/identifier.h"

/** Exit status of bad usage or data. */
#define EXIT_REFUSED 2

/** Prints "auvid: <message>" as exactly one line, whatever the arguments contain. */
void report_error_line(const char *format, ...);

/** Prints "auvid: warning: <message>" in the same way. The program continues. */
void report_warning(const char *format, ...);

/** As report_error_line, with the value EXIT_REFUSED: return report_error(...); */
#define report_error(...) (report_error_line(__VA_ARGS__), EXIT_REFUSED)

/** Prints the last error as a JSON object on stdout: what --json says of a file that is refused. */
void report_error_json(void);

/** Prints which field of its configuration the identifier refused, and the sizes that it needs if
 * they exceed those of this build. @return EXIT_REFUSED
 * @param who the command
 * @param cfg the refused configuration; NULL: of the acting half */
int report_refused(const char *who, auvid_status_t status, const auvid_refusal_t *why,
                   const auvid_identifier_config_t *cfg);

/** Writes the compiler flags for sizes that a configuration needs beyond those of this build; ""
 * if there are none. */
void report_sizes(char *text, size_t size, const auvid_identifier_config_t *cfg);

#endif
