/**
 * @file columns.h
 * Finds the known column of a log that an unknown name may stand for.
 */
#ifndef PROGRAM_COLUMNS_H
#define PROGRAM_COLUMNS_H

/** Returns the known column (csv.h) most similar to a name, or -1 if none is similar. An angle or a
 * rate in degrees is similar to the one in radians. */
int columns_like(const char *name);

/** Returns where a name says that it is in degrees, or NULL. */
const char *columns_degrees(const char *name);

#endif
