/**
 * @file adaptive.h
 * Adaptive excitation: what moves the vehicle is chosen while it is being identified, and it ends
 * when everything is known that can be.
 *
 * Instead of a sequence of segments (excitation.h) each degree of freedom plays steps, one hold
 * after the other, and the newest estimate and its confidence (confidence.h) decide on each:
 * - how long: four time constants m / (|X_u| + 2 |X_uu| u) of the vehicle, at the speed that the
 *   step leads to, 1.5-20 s; 4.5-7.5 s as long as they are not known; in roll and pitch, which are
 *   righted and swing in seconds, 1.1-1.9 s;
 * - how strong: the amplitude or 0.3 of it, two speeds, which tell linear from quadratic drag. Two
 *   thirds of the time are for the low one while a linear drag is missing, else 0.4;
 * - whose turn it is: where the thrusters do not suffice for all degrees of freedom at once, those
 *   play of which most is missing, until the next estimate. The others go on, at no cost in time.
 * A data set is completed early when it has brought, by what the last estimate foretells, what is
 * missing; not when the ring of sets is full.
 *
 * The run ends by itself, with a fade, when every parameter is identifiable, known to be small, or
 * given up: one in a degree of freedom that is not excited, or one that after three sets would be
 * more than 1.5 times too uncertain even with all data that fit into the run and the ring. What was
 * given up is in auvid_identifier_t.adaptive; why, in estimate.confidence.
 *
 * Girona500, 100 N and 40 Nm, disturbance 1 N, 100 runs: all 13 parameters are identifiable after
 * 93 s; with the plan of excitation.h, all at once, after 110 s, one by one after 425 s. The
 * signals themselves differ little in what they are worth. It is for ending when it is enough, for
 * vehicles whose time constants nobody knows, and for weak thrusters. Begun with a warm record
 * (prior.h) it is over after 62 s instead of 104 s, mean of ten dives.
 *
 * All else is as with a sequence: arm, excite, stop, abort and guard of identifier.h, peak within
 * the thrusters, amplitude never exceeded, leash.
 *
 * A checkpoint (checkpoint.h) taken after auvid_adaptive_begin is restored into an identifier for
 * which that has been called, too, and is refused by others; one taken before it ends it.
 *
 * Called from the control task. Not linked unless auvid_adaptive_begin is called. Cost in a tick:
 * 20 operations for each DoF; in one that follows an estimate 40 for each parameter. Memory:
 * sizeof(auvid_adaptive_t) within auvid_identifier_t.
 *
 * Source: auvid's own.
 */
#ifndef AUVID_ADAPTIVE_H
#define AUVID_ADAPTIVE_H

#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Configuration. Copied. */
typedef struct {
    /** Peak of each DoF [N, Nm], 0..AUVID_EXCITATION_LARGEST; zero leaves it out. Each must be
     * within the thrusters, all at once need not. Default 0: not valid yet. */
    auvid_real_t amplitude[AUVID_DOF_COUNT];
    /** How far each DoF may wander before it is led back [m, rad], >= 0; zero: never. Default 5 m
     * in surge and sway, 3 m in heave, 2 pi in yaw. In surge and sway at most 0.3 of the guard's
     * distance_max_m, unless that is off: else it would wander until the guard aborts. */
    auvid_real_t excursion_limit[AUVID_DOF_COUNT];
    auvid_real_t max_s;  /**< longest run [s], 30..AUVID_EXCITATION_LONGEST_S; default 480 */
    uint64_t seed;       /**< of signs and holds; default 1; zero is a seed like any other */
} auvid_adaptive_config_t;

#define auvid_adaptive_defaults AUVID_SIZED0(auvid_adaptive_defaults)
/** Fill *cfg with the defaults named at its fields. Null is ignored. */
void auvid_adaptive_defaults(auvid_adaptive_config_t *cfg);

#define auvid_adaptive_begin AUVID_SIZED(auvid_adaptive_begin)
/**
 * Excite adaptively from the next auvid_identifier_excite on: takes the place of the sequence that
 * was configured, if any. A DoF that no thruster moves is left out.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or the guard is neither
 * DISARMED nor DONE); AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a field out of its range, or no
 * amplitude > 0 that a thruster can make); AUVID_ERR_LIMIT (an amplitude is more than the thrusters
 * give); AUVID_ERR_SIZE (more DoF than AUVID_MAX_SEGMENTS). On < 0 nothing is changed.
 */
auvid_status_t auvid_adaptive_begin(auvid_identifier_t *id, const auvid_adaptive_config_t *cfg);

#ifdef __cplusplus
}
#endif

#endif
