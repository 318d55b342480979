/**
 * @file options_reader.h
 * Between options.c and those who read a part of the options.
 */
#ifndef PROGRAM_OPTIONS_READER_H
#define PROGRAM_OPTIONS_READER_H

#include "options.h"

/** The arguments, and how far they have been read. */
typedef struct {
    int count, next;
    char **argument;
    const char *name;   /* option at hand, "--seed" */
    const char *value;  /* what follows "=" in it, or null */
    char name_text[32]; /* room for its name */
} reader_t;

/** The option's value: after "=", or the next argument. */
int take_value(reader_t *r, const char **value);

int take_flag(const reader_t *r, bool *flag);

/** A number from 0 to high. */
int take_number(reader_t *r, double high, double *out);

/** The options of demo in the field; -1: not one of them. */
int options_field_take(reader_t *r, options_t *options);

/** What does not go together with them, or is missing. */
int options_field_check(options_t *options);

#endif
