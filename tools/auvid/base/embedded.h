/**
 * @file embedded.h
 * Text files inside the program. `embed.py` writes them as C; the result is committed, and a test
 * compares it with the files.
 */
#ifndef PROGRAM_EMBEDDED_H
#define PROGRAM_EMBEDDED_H

/** A text file. Its pieces, one after the other, are its text; the last one is NULL. A piece ends
 * at a line feed, or inside a long line. */
typedef struct {
    const char *name; /**< of the file, without its folder; NULL ends an array of files */
    const char *const *piece;
} embedded_t;

#endif
