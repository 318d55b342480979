/**
 * @file options_reader.h
 * The interface between options.c and the files that read part of the options.
 */
#ifndef PROGRAM_OPTIONS_READER_H
#define PROGRAM_OPTIONS_READER_H

#include "options.h"

/** The arguments and the position in them. */
typedef struct {
    int count, next;
    char **argument;
    const char *name;   /* current option, "--seed" */
    const char *value;  /* text after its "=", or NULL */
    char name_text[32]; /* storage of its name */
} reader_t;

/** Takes the option's value: after "=", or the next argument. */
int take_value(reader_t *r, const char **value);

int take_flag(const reader_t *r, bool *flag);

/** Takes a number from 0 to high. */
int take_number(reader_t *r, double high, double *out);

/** Takes a whole number from low to high. */
int take_count32(reader_t *r, uint32_t low, uint32_t high, uint32_t *out);

/** Takes a budget: units of work per tick, or auto[:CORE:MHZ]. */
int take_budget(reader_t *r, uint32_t *budget);

/** Reads an option of field statistics. Returns -1 if it is another one. */
int options_field_take(reader_t *r, options_t *options);

/** Checks for combinations that are not allowed, and for missing options. */
int options_field_check(options_t *options);

#endif
