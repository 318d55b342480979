/**
 * @file auvid_excitation_init_internal.h
 * Private: functions shared by the files of the excitation, the inits of this folder, and what the
 * identifier changes of excitation and guard.
 */
#ifndef AUVID_EXCITATION_INIT_INTERNAL_H
#define AUVID_EXCITATION_INIT_INTERNAL_H

#include "auvid/allocation.h"
#include "auvid/excitation.h"
#include "auvid/guard.h"
#include "../base/auvid_math_internal.h"

/** auvid_excitation_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_excitation_set_up(auvid_excitation_t *e, const auvid_excitation_config_t *cfg,
                             auvid_refusal_t *why);
/** The same of auvid_guard_init. */
void auvid_guard_set_up(auvid_guard_t *g, const auvid_guard_config_t *cfg, auvid_refusal_t *why);
/** The same of auvid_allocation_init. */
void auvid_allocation_set_up(auvid_allocation_t *a, const auvid_allocation_config_t *cfg,
                             auvid_refusal_t *why);

/** Low level of steps: two speeds separate linear from quadratic drag. */
#define EXCITATION_LOW_LEVEL AUVID_C(0.3)
/** Fade of steps [s]. */
#define EXCITATION_STEP_FADE_S AUVID_C(0.2)
/** Excursion limits by default [m, rad]. */
extern const auvid_real_t auvid_excitation_limit[AUVID_DOF_COUNT];

/** Excursion of a degree of freedom beyond its limit, -1..1; 0 within it or without one. */
auvid_real_t auvid_excitation_excursion(const auvid_excitation_t *e, int dof);

/** For holds that the caller chooses, of a sequence of one segment of STEPS in each of its degrees
 * of freedom, without pauses: call it before each step, with the same time. Begins a hold if the
 * current one of segment `index` is over.
 * @return its channel: set level, -1..1, and hold_to_us [us from the start]; rng may be used. NULL:
 *         the current hold continues */
auvid_excitation_channel_t *auvid_excitation_due(auvid_excitation_t *e, uint32_t index,
                                                 uint64_t t_us);

/** End the current hold of a degree of freedom: auvid_excitation_due begins the next one. */
static inline void auvid_excitation_end_hold(auvid_excitation_t *e, int dof)
{
    e->channel[dof].hold_to_us = 0;
}

/** Until the next displacement is set, do not bring a degree of freedom back. */
static inline void auvid_excitation_clear_displacement(auvid_excitation_t *e, int dof)
{
    e->displacement[dof] = AUVID_C(0.0);
}

/** The same, but bring it back as if only this part of the displacement were there, 0..1. */
static inline void auvid_excitation_reduce_displacement(auvid_excitation_t *e, int dof,
                                                        auvid_real_t part)
{
    e->displacement[dof] *= part;
}

/** After auvid_guard_arm: must the next step be later than that, or may it have the same time? */
static inline void auvid_guard_require_later(auvid_guard_t *g, bool later)
{
    g->stepped = later;
}

/** Convert s [s], 0..86400, to microseconds. */
uint64_t auvid_excitation_us(auvid_real_t s);

#endif
