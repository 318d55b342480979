/**
 * @file columns.h
 * Which known column of a log an unknown name may stand for.
 */
#ifndef PROGRAM_COLUMNS_H
#define PROGRAM_COLUMNS_H

/** The known column (csv.h) that a name resembles most; -1: it resembles none. */
int columns_like(const char *name);

#endif
