/**
 * @file commands.h
 * The sub-commands. Each returns the exit status of the program, after its report or after one line
 * on stderr.
 */
#ifndef PROGRAM_COMMANDS_H
#define PROGRAM_COMMANDS_H

#include "options/options.h"

int demo(const options_t *options);
int scenario(const options_t *options);   /**< demo --scenario */
int field_demo(const options_t *options); /**< demo --field, --mismatch, --matched */
int fit(const options_t *options);
int check(const options_t *options);

/* Only with the Linux port. */
int bus_node(const options_t *options);    /**< auvid node */
int bus_vehicle(const options_t *options); /**< auvid vehicle */
int bus_replay(const options_t *options);  /**< auvid replay */

#endif
