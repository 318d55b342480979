/**
 * @file vehicles_ready.h
 * The files of the ready vehicles. vehicles_ready.c is generated:
 *
 *     cd tools/auvid/vehicles && ../embed.py vehicles_ready girona500.ini bluerov2.ini \
 *         bluerov2_standard.ini torpedo.ini surface.ini >../vehicles_ready.c
 */
#ifndef PROGRAM_VEHICLES_READY_H
#define PROGRAM_VEHICLES_READY_H

#include "../base/embedded.h"

extern const embedded_t vehicles_ready[];

#endif
