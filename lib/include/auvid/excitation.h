/**
 * @file excitation.h
 * The excitation module: a body wrench as a function of time (paper III-A).
 *
 * Each degree of freedom plays its own sequence of segments (step, ramp, sine, sum of sines, random
 * steps, pause), all of them at once; the sequence repeats until the run is over. The run as a
 * whole fades in and out, and so does each segment where asked. Random segments draw their levels,
 * holds, frequencies and phases from a seed as time goes on, afresh in each repetition: no table.
 *
 * Who calls it: the control tick, once a tick, and adds the wrench to the controller's own. There
 * is no arming and no limit on the vehicle's motion here: see guard.h. Until it is stopped, the
 * wrench depends on the seed and on t - start only, not on the tick rate or on ticks left out; with
 * a leash also on the displacement that auvid_excitation_set_displacement tells.
 *
 * Net drift: random signs make the vehicle wander. Beyond its leash a degree of freedom is led
 * back: random steps take the sign that does so, and a steady pull is added, up to the segment's
 * amplitude at twice the leash. The peak is kept: what would exceed it is cut. It keeps a vehicle
 * only where the amplitude overcomes the current. Girona500, the plan's leash (5 m in surge and
 * sway) and amplitudes, 8 sets of 30 s, 40 seeds, farthest horizontal distance, median (worst):
 *     disturbance 3 N, still water:     14 m (37 m) without, 10 m (16 m) by signs, 8 m (13 m)
 *     disturbance 3 N, current 0.3 m/s: 74 m (93 m) without, 52 m (73 m) by signs, 11 m (15 m)
 *
 * Cost of a step: per DoF about 40 operations, one sine per sinusoid and two for fades. In the tick
 * in which a sum of sines begins: also up to 8 points per period of its highest frequency (at most
 * AUVID_EXCITATION_SCAN) times its sines, 3 multiplications of integers each, to find its peak.
 * Memory: sizeof(auvid_excitation_t), 1.6 KiB with the default sizes in float; no pointer is kept.
 *
 * Source: Karras et al. 2013, III-A. Deviation: the paper names steps, ramps, sines and sums of
 * sines and gives no figures; those of auvid_excitation_plan are auvid's own.
 */
#ifndef AUVID_EXCITATION_H
#define AUVID_EXCITATION_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Longest segment and longest fade [s]. */
#define AUVID_EXCITATION_LONGEST_S AUVID_C(3600.0)
/** Longest run [s]. */
#define AUVID_EXCITATION_LONGEST_RUN_S AUVID_C(86400.0)
/** Largest amplitude [N or Nm]. */
#define AUVID_EXCITATION_LARGEST AUVID_C(1e6)
/** Highest frequency [Hz]. */
#define AUVID_EXCITATION_HIGHEST_HZ AUVID_C(5.0)
/** Most random steps in one segment: duration_s <= this * hold_min_s. */
#define AUVID_EXCITATION_HOLDS 256
/** Most points at which the peak of a sum of sines is looked for. */
#define AUVID_EXCITATION_SCAN 256

/** What a segment plays. s is the time since its start, T its duration, A its amplitude. */
typedef enum {
    AUVID_SEGMENT_PAUSE = 0, /**< zero */
    AUVID_SEGMENT_STEP,      /**< A, held */
    AUVID_SEGMENT_RAMP,      /**< from + (A - from) s / T */
    AUVID_SEGMENT_SINE,      /**< A sin(2 pi frequency_hz s + phase) */
    /** Sum of `sines` sines of equal amplitude and random phase, geometrically spaced between
     * frequency_hz and frequency_high_hz, each frequency then changed at random by up to 12 %; the
     * sum is scaled so that its peak within the segment, before fades, is A: never more; with the
     * plan's sines at least 0.93 A. Less is reached in segments of more than
     * AUVID_EXCITATION_SCAN / 8 periods of the highest, and by sines that cancel. */
    AUVID_SEGMENT_SINES,
    /** Steps to A or 0.3 A at random (two speeds tell linear from quadratic drag), each held
     * hold_min_s..hold_max_s; the first sign is random, the sign then changes with probability
     * 3/4, or always and with equal level and hold within a pair when `pairs` is set. The last
     * hold is cut where the fade to zero must begin. */
    AUVID_SEGMENT_STEPS,
    AUVID_SEGMENT_KIND_COUNT
} auvid_segment_kind_t;

/** One segment of one degree of freedom. Segments of the same DoF follow one another in the order
 * of the table; different DoFs run side by side. All zero is a pause of no length. Written by the
 * user or by auvid_excitation_plan. Fields a kind does not name are ignored (but must be finite).
 */
typedef struct {
    auvid_dof_t dof;           /**< which degree of freedom */
    auvid_segment_kind_t kind; /**< what it plays */
    auvid_real_t pause_s;    /**< zero wrench for so long before it [s], 0..LONGEST_S; zero: none */
    auvid_real_t duration_s; /**< T [s], 0..AUVID_EXCITATION_LONGEST_S; zero skips it */
    auvid_real_t amplitude;  /**< A [N or Nm], within +-EXCITATION_LARGEST; never exceeded */
    auvid_real_t from;       /**< RAMP: value at its start [N or Nm], likewise */
    /** Raised-cosine fade [s], 0..T/2; zero: none, jumps are jumps. STEPS: every change of level,
     * and the one to zero at the end, takes this long (0..hold_min_s). Others: fade-in at the
     * start, fade-out at the end of the segment. */
    auvid_real_t fade_s;
    auvid_real_t frequency_hz;      /**< SINE; lowest of SINES [Hz], > 0..HIGHEST_HZ */
    auvid_real_t frequency_high_hz; /**< highest of SINES [Hz], >= frequency_hz, ..HIGHEST_HZ */
    auvid_real_t phase;             /**< SINE: phase at its start [rad], -100..100 */
    auvid_real_t hold_min_s;        /**< STEPS: shortest hold [s], > 0, >= T / EXCITATION_HOLDS */
    auvid_real_t hold_max_s;        /**< STEPS: longest hold [s], >= hold_min_s, ..LONGEST_S */
    uint8_t sines;                  /**< SINES: how many, 1..AUVID_MAX_SINES */
    /** STEPS: +- pairs, so that the impulse of the segment is zero; a pair that no longer fits is
     * left out. Zero (false): no pairs. */
    bool pairs;
} auvid_segment_t;

/** Configuration; copied at init. Written by the user; _defaults gives an empty sequence. */
typedef struct {
    auvid_segment_t segment[AUVID_MAX_SEGMENTS]; /**< the table */
    uint8_t segments; /**< entries of it in use, 1..AUVID_MAX_SEGMENTS; default 0: not valid yet */
    /** Length of the run [s], 0..AUVID_EXCITATION_LONGEST_RUN_S; the sequence (as long as its
     * longest DoF) repeats until then. Default 0: the sequence once. */
    auvid_real_t duration_s;
    /** Raised-cosine fade at the start and the end of the run, and after stop [s],
     * 0..AUVID_EXCITATION_LONGEST_S, at most half the run. Default 2; zero: none. */
    auvid_real_t fade_s;
    uint64_t seed; /**< of all random choices; default 1; zero is a seed like any other */
    /** How far each degree of freedom may wander before it is led back [m, rad], >= 0; default 0:
     * never. No effect until auvid_excitation_set_displacement is called. */
    auvid_real_t excursion_limit[AUVID_DOF_COUNT];
} auvid_excitation_config_t;

/** What one degree of freedom is doing. Written by auvid_excitation_step only. */
typedef struct {
    uint32_t rng[4];       /**< state of the random generator */
    uint32_t hold_from_us; /**< STEPS: when this hold began, since the segment's start [us] */
    uint32_t hold_to_us;   /**< STEPS: when it ends [us] */
    uint32_t hold_us;      /**< STEPS: length drawn [us] */
    uint32_t repetition;   /**< repetition of the sequence in play */
    auvid_real_t level;    /**< STEPS: level, -1..1 of the amplitude */
    auvid_real_t before;   /**< STEPS: value from which it fades to the level */
    auvid_real_t scale;    /**< SINES: 1 / peak of the sum */
    auvid_real_t frequency_hz[AUVID_MAX_SINES]; /**< SINES [Hz] */
    auvid_real_t cycles[AUVID_MAX_SINES];       /**< SINES: phases at the start, 0..1 cycles */
    uint8_t segment;                            /**< index + 1 of the one in play; 0: none */
    bool second;                                /**< STEPS: second of a pair */
    bool negative;                              /**< STEPS: sign of the last one drawn */
} auvid_excitation_channel_t;

/** State. The caller owns it; all fields are written by the functions below. */
typedef struct {
    auvid_excitation_config_t config;
    auvid_excitation_channel_t channel[AUVID_DOF_COUNT];
    uint32_t duration_us[AUVID_MAX_SEGMENTS];   /**< length of each segment [us] */
    uint32_t pause_us[AUVID_MAX_SEGMENTS];      /**< and of the pause before it [us] */
    auvid_real_t displacement[AUVID_DOF_COUNT]; /**< told last [m, rad]; zero at start */
    uint32_t fade_us;                           /**< fade of the run [us] */
    uint32_t repetition;                        /**< repetition of the sequence in play, from 0 */
    uint64_t repeated_us;                       /**< its beginning since start [us] */
    uint64_t sequence_us;                       /**< length of the sequence [us] */
    uint64_t run_us;                            /**< length of the run [us] */
    uint64_t start_us;                          /**< time of start */
    uint64_t last_us;                           /**< time of the last start, step or stop */
    uint64_t stop_us;                           /**< time of stop */
    bool running;                               /**< started and not finished */
    bool stopping;                              /**< stop was called in this run */
    bool finished;                              /**< a run has ended, and none was begun since */
    bool heaves;                                /**< some segment excites heave */
} auvid_excitation_t;

#define auvid_excitation_init                                                                      \
    AUVID_SIZED2(auvid_excitation_init, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)

#define auvid_excitation_defaults                                                                  \
    AUVID_SIZED2(auvid_excitation_defaults, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/** Fill *config with the defaults named at its fields. config: not null, else nothing is done. */
void auvid_excitation_defaults(auvid_excitation_config_t *config);

#define auvid_excitation_plan                                                                      \
    AUVID_SIZED2(auvid_excitation_plan, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * Fill a sequence for identification: sets of set_s seconds, in turn random steps and a sum of
 * sines, independently per DoF. Steps: held 4-8 s (shorter, set_s / 4 to set_s / 2, when
 * set_s < 16); sines: AUVID_MAX_SINES or five of them, whichever is less, 0.03-0.25 Hz (not below
 * 1 / set_s). Roll and pitch, which are righted and swing in seconds: held 1-2 s, 0.1-0.8 Hz.
 * Segment fades 0.2 s, no pairs; leash 5 m in surge and sway, 3 m in heave, 2 pi in yaw, none in
 * roll and pitch; change all of it afterwards as you like. All degrees of freedom play at once.
 * @param config    written: segment, segments, duration_s = sets * set_s, leash, seed; the rest
 *                  stays. Call _defaults first.
 * @param amplitude 6: peak per DoF [N, Nm], >= 0; zero leaves that DoF out. Girona500: 100 N in X,
 *                  Y, Z and 40 Nm in N.
 * @param set_s     length of a set [s], 5..600; 30 is usual.
 * @param sets      how many sets, 1..1000, the first one steps; the run must not be longer than
 *                  AUVID_EXCITATION_LONGEST_RUN_S.
 * @param seed      any.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a value outside the
 *         above, or no amplitude > 0); AUVID_ERR_SIZE (twice the DoFs exceed AUVID_MAX_SEGMENTS).
 */
auvid_status_t auvid_excitation_plan(auvid_excitation_config_t *config,
                                     const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                     auvid_real_t set_s, uint32_t sets, uint64_t seed);

#define auvid_excitation_schedule                                                                  \
    AUVID_SIZED2(auvid_excitation_schedule, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * The same with pauses, and with one degree of freedom after the other where asked: steps of each
 * in turn, then sines of each in turn.
 * @param sets       per degree of freedom, if one by one; the run lasts sets (set_s + pause_s), one
 *                   by one as many times as there are degrees of freedom with an amplitude.
 * @param pause_s    before each set, the first one too [s], 0..600; zero: none.
 * @param one_by_one one after the other; false: all at once, as auvid_excitation_plan.
 * @return as auvid_excitation_plan.
 */
auvid_status_t auvid_excitation_schedule(auvid_excitation_config_t *config,
                                         const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                         auvid_real_t set_s, uint32_t sets, uint64_t seed,
                                         auvid_real_t pause_s, bool one_by_one);

/**
 * Check the configuration, copy it, and be idle.
 * @param config may be e->config
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_SIZE (segments is 0 or > AUVID_MAX_SEGMENTS, or sines
 *         is 0 or > AUVID_MAX_SINES in a SINES); AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a field
 *         outside its range, or a sequence without length). On < 0 *e is as before.
 */
auvid_status_t auvid_excitation_init(auvid_excitation_t *e,
                                     const auvid_excitation_config_t *config);

#define auvid_excitation_start                                                                     \
    AUVID_SIZED2(auvid_excitation_start, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * Begin the run at t_us, from its first segment and with the random choices of the seed. A run in
 * progress is begun anew, without a fade-out.
 * @return AUVID_OK; AUVID_ERR_NULL.
 */
auvid_status_t auvid_excitation_start(auvid_excitation_t *e, uint64_t t_us);

#define auvid_excitation_stop                                                                      \
    AUVID_SIZED2(auvid_excitation_stop, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * Fade out from t_us on, over fade_s, and end. Without effect when idle or already stopping.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_TIME_BACK (t_us before the last call's: ignored).
 */
auvid_status_t auvid_excitation_stop(auvid_excitation_t *e, uint64_t t_us);

#define auvid_excitation_step                                                                      \
    AUVID_SIZED2(auvid_excitation_step, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * The wrench at t_us.
 * @param t_us   not before the last call's time; the same time (and displacement) gives the same
 *               wrench.
 * @param wrench 6, written always unless null: body wrench [N, Nm]; zero on every status but
 *               AUVID_OK.
 * @return AUVID_OK; AUVID_FINISHED (the run is over, or none was begun); AUVID_ERR_NULL;
 *         AUVID_ERR_TIME_BACK (time as before the call; a later step goes on).
 */
auvid_status_t auvid_excitation_step(auvid_excitation_t *e, uint64_t t_us,
                                     auvid_real_t wrench[AUVID_DOF_COUNT]);

#define auvid_excitation_set_displacement                                                          \
    AUVID_SIZED2(auvid_excitation_set_displacement, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * Tell where the vehicle is, before the step; until told again it is taken to stay there.
 * @param displacement 6: from where the run began, turned into present body axes [m]; for roll,
 *                     pitch, yaw the angle turned since [rad], yaw unwrapped.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE (the last one stays).
 */
auvid_status_t auvid_excitation_set_displacement(auvid_excitation_t *e,
                                                 const auvid_real_t displacement[AUVID_DOF_COUNT]);

#define auvid_excitation_progress                                                                  \
    AUVID_SIZED2(auvid_excitation_progress, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/** Part of the run that is over at the last step, 0..1; 0 before the first start, 1 when finished.
 * 0 for null. */
auvid_real_t auvid_excitation_progress(const auvid_excitation_t *e);

#define auvid_excitation_peak                                                                      \
    AUVID_SIZED2(auvid_excitation_peak, AUVID_MAX_SEGMENTS, AUVID_MAX_SINES)
/**
 * Largest |wrench| per DoF that the sequence may reach.
 * @param peak 6, written [N, Nm], >= 0.
 * @return AUVID_OK; AUVID_ERR_NULL.
 */
auvid_status_t auvid_excitation_peak(const auvid_excitation_t *e,
                                     auvid_real_t peak[AUVID_DOF_COUNT]);

#ifdef __cplusplus
}
#endif

#endif
