/**
 * @file prior_file.h
 * The warm record (auvid/prior.h) as a file.
 */
#ifndef PROGRAM_WARM_FILE_H
#define PROGRAM_WARM_FILE_H

#include "auvid/identifier.h"

/** Start with the record in the file. False after one line on stderr: the identifier is cold. */
bool prior_file_read(auvid_identifier_t *id, const char *path);

/** Write a record of the last estimate, at once or not at all. False after one line on stderr. */
bool prior_file_write(const auvid_identifier_t *id, const char *path);

#endif
