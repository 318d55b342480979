/**
 * @file json_string.h
 * Strings of JSON, of text from outside: names of files, vehicles, parameters and units.
 */
#ifndef PROGRAM_JSON_STRING_H
#define PROGRAM_JSON_STRING_H

#include <stdio.h>

/** Writes text, of any bytes but 0, with its quotation marks. What is not UTF-8 (RFC 3629) becomes
 * U+FFFD. "<" is escaped, so that the string can stand inside HTML. */
void json_string(FILE *out, const char *text);

#endif
