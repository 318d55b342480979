/**
 * @file adaptive.h
 * Adaptive excitation: chooses the excitation during the identification and ends it when all
 * identifiable parameters are known.
 *
 * Instead of a sequence of segments (excitation.h) each degree of freedom plays steps. The newest
 * estimate and its confidence (estimate.h) determine each step:
 * - hold time: four time constants m / (|X_u| + 2 |X_uu| u) of the vehicle, at the speed that the
 *   step leads to, 1.5-20 s; 4.5-7.5 s until they are known; 1.1-1.9 s in roll and pitch, whose
 *   restoring moments give periods of seconds;
 * - level: the amplitude or 0.3 of it, since two speeds separate linear from quadratic drag. Two
 *   thirds of the time use the low amplitude while a linear drag is missing, else 0.4 of it;
 * - degree of freedom: if the thrusters do not suffice for all DoFs at the same time, those with
 *   the largest lack of information play until the next estimate. If they suffice, known DoFs also
 *   continue to play, at no cost in time.
 * A data set is completed early when, predicted from the last estimate, it contains the missing
 * information, unless the ring of sets is full. A DoF that the thrusters can excite plays, even if
 * coupling has determined its parameters: then an unknown force on it does less harm.
 *
 * The run ends by itself, with a fade, when every parameter is identifiable, known to be small, or
 * abandoned. A parameter is abandoned if its degree of freedom is not excited. It is also abandoned
 * after three sets if its uncertainty would remain more than 1.5 times too large at the end: with
 * all data that fit into the run and the ring; or once the ring is full. If sets are dropped, for a
 * change of the vehicle or longer cells, all is open again.
 * auvid_adaptive_t.abandoned lists the abandoned parameters; estimate.confidence holds the reason.
 * The estimate that decides is that of auvid_identifier_estimate: with uncertain inputs attached it
 * is known later, mostly by the end of the ring.
 *
 * Girona500, 100 N and 40 Nm, disturbance 1 N, 100 runs: all 13 parameters are identifiable after
 * 97 s. With the plan of excitation.h it takes 110 s with all DoFs at the same time, 425 s one by
 * one. The signals carry nearly the same information. Use the adaptive excitation to end the run as
 * soon as the data suffice, for vehicles with unknown time constants, and for weak thrusters.
 * Started with a prior record (prior.h) it ends after 68 s instead of 110 s, mean of ten dives.
 *
 * All else is as with a sequence: arm, excite, stop, abort and guard of actuation.h, peak within
 * the limits of the thrusters, amplitude never exceeded, excursion limit.
 *
 * A checkpoint (checkpoint.h) taken after auvid_adaptive_begin can only be restored into an
 * identifier for which auvid_adaptive_begin was also called; one taken before, only without it.
 *
 * The control task calls it. It is linked only if auvid_adaptive_begin is called. Cost in a tick:
 * 20 operations for each DoF; in a tick after an estimate 40 for each parameter. Memory:
 * sizeof(auvid_adaptive_t), 56 bytes.
 *
 * Source: auvid's own.
 */
#ifndef AUVID_ADAPTIVE_H
#define AUVID_ADAPTIVE_H

#include "auvid/actuation.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Configuration; copied by auvid_adaptive_begin. */
typedef struct {
    /** Peak of each DoF [N, Nm], 0..AUVID_EXCITATION_LARGEST; zero omits the DoF. The thrusters
     * must be able to produce each of them, but not all at the same time. Default 0, which
     * auvid_adaptive_begin rejects. */
    auvid_real_t amplitude[AUVID_DOF_COUNT];
    /** Excursion limit: displacement of each DoF beyond which it is brought back [m, rad], >= 0;
     * zero: no limit. Default 5 m in surge and sway, 3 m in heave, 2 pi in yaw. In surge and sway
     * at most 0.3 of the guard's distance_max_m is used, unless that limit is off, and in heave 0.3
     * of half the way from depth_min_m to depth_max_m, 0.1 m at least: otherwise the vehicle would
     * wander until the guard aborts. Begin in the middle of the depths. */
    auvid_real_t excursion_limit[AUVID_DOF_COUNT];
    auvid_real_t max_s; /**< longest run [s], 30..AUVID_EXCITATION_LONGEST_S; default 480 */
    uint64_t seed;      /**< of signs and holds, any value; default 1 */
} auvid_adaptive_config_t;

/** State of the adaptive excitation. The caller owns it; only the functions write. */
typedef struct {
    uint64_t run_us;                        /* start of the run of this state */
    auvid_real_t low_owed[AUVID_DOF_COUNT]; /* time by which low levels are behind their part [s] */
    uint32_t missing;   /**< bit i: parameter i is excited for, and not identified yet */
    uint32_t abandoned; /**< bit i: parameter i is not identified, and nothing is done about it: its
                             DoF is not excited, or all data of the run would not suffice */
    uint32_t estimate;  /* number of the last estimate evaluated */
    uint32_t sets;      /* recorded by then */
    uint16_t close_rows; /* complete the set at so many rows; 0: when full */
    uint8_t playing;     /**< bit j: DoF j is excited at present */
    uint8_t reserved[5];
} auvid_adaptive_t;

#define auvid_adaptive_defaults AUVID_SIZED0(auvid_adaptive_defaults)
/** Fill *cfg with the defaults stated at its fields.
 * @param cfg written whole; NULL is a no-op. */
void auvid_adaptive_defaults(auvid_adaptive_config_t *cfg);

#define auvid_adaptive_begin AUVID_SIZED(auvid_adaptive_begin)
/**
 * Use the adaptive excitation from the next auvid_identifier_excite on. It replaces the configured
 * sequence, if any. A DoF that is not actuated is omitted.
 * @param storage written; must outlive the identifier
 * @param cfg copied; need not outlive the call.
 * @param refusal written: what is refused, e.g. field "amplitude", element 2; NULL: not wanted
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not initialised, or if the guard is neither
 *         DISARMED nor DONE; AUVID_ERR_DETACHED without acting half (actuation.h);
 *         AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if a field is outside its range, or no amplitude
 *         > 0 is in an actuated DoF; AUVID_ERR_CAPACITY if an amplitude exceeds the thrusters;
 *         AUVID_ERR_SIZE if there are more DoFs than AUVID_MAX_SEGMENTS. On an error nothing
 *         changes.
 */
auvid_status_t auvid_adaptive_begin(auvid_identifier_t *id, auvid_adaptive_t *storage,
                                    const auvid_adaptive_config_t *cfg, auvid_refusal_t *refusal);

#ifdef __cplusplus
}
#endif

#endif
