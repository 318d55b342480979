/**
 * @file columns.h
 * Finds the known column of a log that an unknown name may stand for.
 */
#ifndef PROGRAM_COLUMNS_H
#define PROGRAM_COLUMNS_H

/** Returns the known column (csv.h) most similar to a name, or -1 if none is similar. */
int columns_like(const char *name);

#endif
