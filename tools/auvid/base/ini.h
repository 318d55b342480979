/**
 * @file ini.h
 * A reader of INI files: sections, keys and values, each with its line and column.
 *
 *     [section]          # a comment begins with # or ; at the start of a line or after a blank
 *     key = value        ; a key stands once in a section, a section once in the file
 *
 * Everything else is refused: other characters than printable ones and blanks, a key outside of a
 * section, an empty value, a line that is too long.
 */
#ifndef PROGRAM_INI_H
#define PROGRAM_INI_H

#include <stdbool.h>
#include <stddef.h>

/** Longest line, largest file [bytes], largest number of keys and sections, longest message. */
enum { INI_LINE = 512, INI_BYTES = 65535, INI_ENTRIES = 512, INI_MESSAGE = 400 };

/** A key, or if its key is "" a section. */
typedef struct {
    const char *section, *key, *value;
    int line, key_column, value_column; /**< from 1 */
    bool used;                          /**< set by whoever has read it */
} ini_entry_t;

typedef struct {
    const char *path; /**< in messages */
    ini_entry_t entry[INI_ENTRIES];
    int entries;
    char message[INI_MESSAGE]; /**< why it was refused: "FILE:LINE:COLUMN: ..." */
    char text[INI_BYTES + 1];
} ini_t;

/** Reads a text. @return false if it is refused: see ini->message */
bool ini_parse(ini_t *ini, const char *path, const char *text, size_t length);

/** The entry of a section (key "") or of a key in it; NULL: none. */
ini_entry_t *ini_find(ini_t *ini, const char *section, const char *key);

/** Writes the message for a place; the first message stays. @return false */
bool ini_refuse(ini_t *ini, int line, int column, const char *format, ...);

/** The line of a section; 1 if there is none. */
int ini_line(ini_t *ini, const char *section);

/** Writes the message "KEY WHAT" for the place of a key, or else of its section. @return false */
bool ini_refuse_key(ini_t *ini, const char *section, const char *key, const char *what);

/** Reads finite decimal numbers, separated by blanks. At least `least` of them, at most `most`.
 * @param count written: how many; NULL: not wanted
 * @return false after a message */
bool ini_numbers(ini_t *ini, const ini_entry_t *entry, int least, int most, double *out,
                 int *count);

/** The next word of a value, up to a blank or a comma; a comma is a word.
 * @param at where to look; moved behind the word
 * @param word [size] written, cut if too long; "": there is none
 * @return its column */
int ini_word(const ini_entry_t *entry, size_t *at, char *word, size_t size);

#endif
