/**
 * @file options_reader.h
 * What reads the command line, for the files that know a command's options: options_demo.c,
 * options_fit.c, options_bus.c, options_field.c.
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

/** Arguments that are no options. */
typedef struct {
    const char *word[OPTIONS_LOGS];
    int count, room;
} words_t;

/** Reads all arguments of a command: common options, own_option's, and words. words: NULL if the
 * command takes none. Each function here returns 0, or EXIT_REFUSED after one line on stderr, if it
 * says nothing else. */
int options_read(options_t *options, int count, char **argument, const char *command,
                 int (*own_option)(reader_t *, options_t *), words_t *words);

/** Is the current option this one? */
bool option_is(const reader_t *r, const char *name);

/** Takes the option's value: after "=", or the next argument. */
int take_value(reader_t *r, const char **value);

int take_flag(const reader_t *r, bool *flag);

/** Reads a number, and where it ends. Returns false if there is none. */
bool to_real(const char *text, const char **end, double *out);

/** Takes a number from 0 to high. */
int take_number(reader_t *r, double high, double *out);

/** Takes a whole number from low to high. */
int take_count(reader_t *r, uint64_t low, uint64_t high, uint64_t *out);
int take_count32(reader_t *r, uint32_t low, uint32_t high, uint32_t *out);

/** Takes a budget: units of work per tick, or auto[:CORE:MHZ]. */
int take_budget(reader_t *r, uint32_t *budget);

/** Takes one of `count` words, as its index. */
int take_word(reader_t *r, const char *const *words, int count, int *out);

/** Takes the bounds of the search. */
int take_bounds(reader_t *r, options_t *options);

/** The axis whose name has this length, surge .. yaw; -1: there is none. */
int take_axis(const char *text, size_t length);

/** --closed-loop or --open-loop AXIS,AXIS,.. Repeated, they add up. */
int take_loop(reader_t *r, options_t *options);

/** Takes a vehicle, a ready one's word or a file. in_field: those of the field simulator, too. */
int take_vehicle(reader_t *r, options_t *options, bool in_field);
int take_thrusters(reader_t *r, options_t *options);
int take_model(reader_t *r, options_t *options);

/** Has the vehicle possible wrenches of the excitation, if this command excites? Returns 0, or
 * EXIT_REFUSED after one line on stderr. */
int options_check_excitation(const options_t *options, bool excites);

/** Can the vehicle of this command be simulated? */
int options_check_truth(const options_t *options, const char *command);

/** Reads an option of field statistics. Returns -1 if it is another one. */
int options_field_take(reader_t *r, options_t *options);

/** Checks for combinations that are not allowed, and for missing options. */
int options_field_check(options_t *options);

#endif
