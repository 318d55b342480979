/**
 * @file dropper.h
 * A listener that ignores the commands and deletes all sets: a search then has no data.
 */
#ifndef DROPPER_H
#define DROPPER_H

#include "auvid/identifier.h"

static inline void dropper_ignore(void *context, uint64_t t_us, const auvid_real_t *command)
{
    (void)context, (void)t_us, (void)command;
}

static inline void dropper_drop(void *context, auvid_metric_t *metric)
{
    (void)context;
    while (auvid_metric_drop(metric, 0) == AUVID_OK) {
    }
}

static const auvid_listener_t dropper = {.command = dropper_ignore, .set = dropper_drop};

#endif
