/**
 * @file prior_file.h
 * The prior record (auvid/prior.h) as a file.
 */
#ifndef PROGRAM_PRIOR_FILE_H
#define PROGRAM_PRIOR_FILE_H

#include "auvid/prior.h"

/** Attaches `storage`, and sets the prior from the file. Returns false, without a prior, after one
 * line on stderr. */
bool prior_file_read(auvid_identifier_t *id, auvid_prior_t *storage, const char *path);

/** Warns on stderr if the data contradicted the prior of the file, so that it was discarded. */
void prior_file_judge(const auvid_prior_t *storage, const char *path);

/** Can the file be written? What it holds stays. Returns 0, or EXIT_REFUSED after one line on
 * stderr. */
int prior_file_check(const char *path);

/** Writes the last estimate, completely or not at all. Returns false after one line on stderr. */
bool prior_file_write(const auvid_identifier_t *id, const char *path);

#endif
