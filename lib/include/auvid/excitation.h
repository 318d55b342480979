/**
 * @file excitation.h
 * The excitation module: a body wrench as a function of time (paper III-A).
 *
 * Each degree of freedom plays its own sequence of segments (step, ramp, sine, sum of sines, random
 * steps, pause); all degrees of freedom play at the same time. The sequence repeats until the run
 * ends. The run fades in and out, and so does each segment with a fade. Random segments draw
 * levels, holds, frequencies and phases from a seed as they play, in each repetition: no table.
 *
 * The control tick calls it once a tick and adds the wrench to that of the controller. This module
 * does not arm and does not limit the vehicle's motion: see guard.h. Until it is stopped, the
 * wrench depends only on the seed and on t - start, not on the tick rate or on missed ticks. With
 * an excursion limit it also depends on the displacement set by auvid_excitation_set_displacement.
 *
 * Net drift: random signs make the vehicle wander. Beyond its excursion limit the excitation brings
 * a degree of freedom back: random steps take the sign that does so, and a bias is added. The
 * bias grows to the segment's amplitude at twice the limit; the sum is clipped to the peak.
 * This holds a vehicle only if the amplitude overcomes the current. Girona500, excursion limit of
 * the plan (5 m in surge and sway) and its amplitudes, 8 sets of 30 s, 40 seeds, largest horizontal
 * distance, median (worst):
 *     disturbance 3 N, still water:     14 m (37 m) without, 10 m (16 m) by signs, 8 m (13 m) both
 *     disturbance 3 N, current 0.3 m/s: 74 m (93 m) without, 52 m (73 m) by signs, 11 m (15 m) both
 *
 * Cost of a step: per DoF about 40 operations, one sine per sinusoid and two for fades. The tick in
 * which a sum of sines begins also searches its peak: up to 8 points per period of the highest
 * frequency (at most AUVID_EXCITATION_SCAN) times its sines, 3 integer multiplications each.
 * Memory: sizeof(auvid_excitation_t), 1.5 KiB with the default sizes in float; no pointer is kept.
 *
 * Source: Karras et al. 2013, III-A. Deviation: the paper names steps, ramps, sines and sums of
 * sines without amplitudes or frequencies; those of auvid_excitation_plan are auvid's own.
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
/** Largest number of random steps in one segment: duration_s <= this * hold_min_s. */
#define AUVID_EXCITATION_HOLDS 256
/** Largest number of points at which the peak of a sum of sines is searched. */
#define AUVID_EXCITATION_SCAN 256

/** Signal of a segment. s is the time since its start, T its duration, A its amplitude. */
typedef enum {
    AUVID_SEGMENT_PAUSE = 0, /**< zero */
    AUVID_SEGMENT_STEP,      /**< A, constant */
    AUVID_SEGMENT_RAMP,      /**< from + (A - from) s / T */
    AUVID_SEGMENT_SINE,      /**< A sin(2 pi frequency_hz s + phase) */
    /** Sum of `sines` sines of equal amplitude and random phase. The frequencies are geometrically
     * spaced between frequency_hz and frequency_high_hz, each then changed at random by up to 12 %.
     * The sum is scaled so that its peak within the segment, before fades, is at most A. With the
     * plan's sines in sets of 30 s it is at least 0.93 A, in roll and pitch 0.9 A (2000 seeds). The
     * peak is lower in segments of more than AUVID_EXCITATION_SCAN / 8 periods of the highest
     * frequency, and in short ones, where close frequencies cancel: 0.8 A in sets of 10 s, 0.24 A
     * in those of 5 s. */
    AUVID_SEGMENT_SINES,
    /** Steps to A or 0.3 A at random (two speeds separate linear from quadratic drag), each held
     * hold_min_s..hold_max_s. The first sign is random; the sign then changes with probability 3/4.
     * With `pairs` the second step of a pair has the opposite sign and equal level and hold. The
     * last hold ends when the fade to zero must begin. */
    AUVID_SEGMENT_STEPS,
    AUVID_SEGMENT_KIND_COUNT
} auvid_segment_kind_t;

/** One segment of one degree of freedom. Segments of the same DoF follow one another in the order
 * of the table; different DoFs run in parallel. All zero is a pause of length zero. Written by the
 * user or by auvid_excitation_plan. Fields that a kind does not use are ignored, but must be
 * finite. */
typedef struct {
    auvid_dof_t dof;           /**< which degree of freedom */
    auvid_segment_kind_t kind; /**< its signal */
    auvid_real_t pause_s;      /**< zero wrench before the segment [s], 0..LONGEST_S */
    auvid_real_t duration_s;   /**< T [s], 0..AUVID_EXCITATION_LONGEST_S; zero skips the segment */
    auvid_real_t amplitude;    /**< A [N or Nm], within +-EXCITATION_LARGEST; never exceeded */
    auvid_real_t from;         /**< RAMP: initial value [N or Nm], within +-EXCITATION_LARGEST */
    /** Raised-cosine fade [s], 0..T/2; zero: jumps. STEPS: duration of each change of level and of
     * the final one to zero, 0..hold_min_s. Others: fade-in at the start and fade-out at the end of
     * the segment. */
    auvid_real_t fade_s;
    auvid_real_t frequency_hz;      /**< SINE; lowest of SINES [Hz], > 0..HIGHEST_HZ */
    auvid_real_t frequency_high_hz; /**< highest of SINES [Hz], >= frequency_hz, ..HIGHEST_HZ */
    auvid_real_t phase;             /**< SINE: phase at its start [rad], -100..100 */
    auvid_real_t hold_min_s;        /**< STEPS: shortest hold [s], > 0, >= T / EXCITATION_HOLDS */
    auvid_real_t hold_max_s;        /**< STEPS: longest hold [s], >= hold_min_s, ..LONGEST_S */
    uint8_t sines;                  /**< SINES: number of sines, 1..AUVID_MAX_SINES */
    /** STEPS: pairs of opposite sign, so that the impulse of the segment is zero; a pair that no
     * longer fits is omitted. Zero (false): no pairs. */
    bool pairs;
} auvid_segment_t;

/** Configuration; copied at init. Written by the user; _defaults gives an empty sequence. */
typedef struct {
    auvid_segment_t segment[AUVID_MAX_SEGMENTS]; /**< the table */
    uint8_t segments; /**< entries in use, 1..AUVID_MAX_SEGMENTS; default 0, which init rejects */
    /** Length of the run [s], 0..AUVID_EXCITATION_LONGEST_RUN_S; the sequence (as long as its
     * longest DoF) repeats until then. Default 0: the sequence once. */
    auvid_real_t duration_s;
    /** Raised-cosine fade at the start and the end of the run, and after stop [s],
     * 0..AUVID_EXCITATION_LONGEST_S, at most half the run. Default 2; zero: none. */
    auvid_real_t fade_s;
    uint64_t seed; /**< of all random choices, any value; default 1 */
    /** Excursion limit: displacement of each degree of freedom beyond which it is brought back
     * [m, rad], >= 0; default 0: no limit. No effect until auvid_excitation_set_displacement is
     * called. */
    auvid_real_t excursion_limit[AUVID_DOF_COUNT];
} auvid_excitation_config_t;

/** State of one degree of freedom. Written only by auvid_excitation_step. */
typedef struct {
    auvid_real_t level;  /**< STEPS: level, -1..1 of the amplitude */
    auvid_real_t before; /**< STEPS: initial value of the fade to the level */
    auvid_real_t scale;  /**< SINES: 1 / peak of the sum */
    auvid_real_t frequency_hz[AUVID_MAX_SINES]; /**< SINES [Hz] */
    auvid_real_t cycles[AUVID_MAX_SINES];       /**< SINES: phases at the start, 0..1 cycles */
    uint32_t rng[4];                            /**< state of the random generator */
    uint32_t hold_from_us; /**< STEPS: start of this hold, from the segment's start [us] */
    uint32_t hold_to_us;   /**< STEPS: its end [us] */
    uint32_t hold_us;      /**< STEPS: drawn length [us] */
    uint32_t repetition;   /**< current repetition of the sequence */
    uint8_t segment;       /**< index + 1 of the current one; 0: none */
    bool second;           /**< STEPS: second of a pair */
    bool negative;         /**< STEPS: last drawn sign */
    uint8_t reserved[sizeof(auvid_real_t) - 3];
} auvid_excitation_channel_t;

/** State. The caller owns it; all fields are written by the functions below. */
typedef struct {
    auvid_excitation_config_t cfg;
    uint64_t sequence_us;                     /**< length of the sequence [us] */
    uint64_t run_us;                          /**< length of the run [us] */
    uint32_t duration_us[AUVID_MAX_SEGMENTS]; /**< length of each segment [us] */
    uint32_t pause_us[AUVID_MAX_SEGMENTS];    /**< and of the pause before it [us] */
    uint32_t fade_us;                         /**< fade of the run [us] */
    bool heaves;                              /**< some segment excites heave */
    /* state: from here on, see checkpoint.h */
    uint64_t repeated_us;                       /**< beginning of `repetition` from start [us] */
    uint64_t start_us;                          /**< time of start */
    uint64_t last_us;                           /**< time of the last start, step or stop */
    uint64_t stop_us;                           /**< time of stop */
    auvid_real_t displacement[AUVID_DOF_COUNT]; /**< last one set [m, rad]; zero at start */
    auvid_excitation_channel_t channel[AUVID_DOF_COUNT];
    uint32_t repetition; /**< current repetition of the sequence, from 0 */
    bool running;        /**< started and not finished */
    bool stopping;       /**< stop was called in this run */
    bool finished;       /**< a run has ended and no new one has started */
    uint8_t reserved[1];
} auvid_excitation_t;

#define auvid_excitation_init AUVID_SIZED(auvid_excitation_init)

#define auvid_excitation_defaults AUVID_SIZED(auvid_excitation_defaults)
/** Fill *cfg with the defaults stated at its fields.
 * @param cfg written whole; NULL is a no-op. */
void auvid_excitation_defaults(auvid_excitation_config_t *cfg);

#define auvid_excitation_plan AUVID_SIZED(auvid_excitation_plan)
/**
 * Fill a sequence for identification: sets of set_s seconds, alternating random steps and a sum of
 * sines, independently per DoF, all degrees of freedom at the same time. Steps are held 4-8 s
 * (set_s / 4 to set_s / 2 if that is shorter, set_s < 16). Sines: five or AUVID_MAX_SINES,
 * whichever is less, 0.03-0.25 Hz (not below 1 / set_s). Roll and pitch have restoring moments and
 * periods of seconds: steps of 1-2 s (not below set_s / AUVID_EXCITATION_HOLDS), 0.1-0.8 Hz.
 * Segment fades 0.2 s, no pairs. Excursion limit 5 m in surge and sway, 3 m in heave, 2 pi in yaw,
 * none in roll and pitch. The caller may change all of this afterwards.
 * @param cfg    written: segment, segments, duration_s = sets * set_s, excursion_limit, seed;
 *                  the rest is unchanged. Call auvid_excitation_defaults first.
 * @param amplitude 6: peak per DoF [N, Nm], >= 0; zero omits that DoF. Girona500: 100 N in X, Y, Z
 *                  and 40 Nm in N.
 * @param set_s     length of a set [s], 5..600; 30 is usual.
 * @param sets      number of sets, 1..1000, of which the first has steps; the run must not be
 *                  longer than AUVID_EXCITATION_LONGEST_RUN_S.
 * @param seed      any.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if a value is outside its
 *         range or no amplitude is > 0; AUVID_ERR_SIZE if twice the DoFs exceed AUVID_MAX_SEGMENTS.
 */
auvid_status_t auvid_excitation_plan(auvid_excitation_config_t *cfg,
                                     const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                     auvid_real_t set_s, uint32_t sets, uint64_t seed);

#define auvid_excitation_schedule AUVID_SIZED(auvid_excitation_schedule)
/**
 * Fill a sequence like auvid_excitation_plan, with pauses and optionally one degree of freedom
 * after the other: first the steps of each DoF, then the sines of each DoF.
 * @param cfg, amplitude, set_s, seed as auvid_excitation_plan.
 * @param sets       number of sets, per degree of freedom if one_by_one. The run lasts
 *                   sets (set_s + pause_s), times the degrees of freedom with an amplitude if
 *                   one_by_one.
 * @param pause_s    pause before each set, including the first [s], 0..600; zero: none.
 * @param one_by_one true: one DoF after the other; false: all at once.
 * @return as auvid_excitation_plan.
 */
auvid_status_t auvid_excitation_schedule(auvid_excitation_config_t *cfg,
                                         const auvid_real_t amplitude[AUVID_DOF_COUNT],
                                         auvid_real_t set_s, uint32_t sets, uint64_t seed,
                                         auvid_real_t pause_s, bool one_by_one);

/**
 * Check the configuration and copy it; *e is then idle.
 * @param cfg may be &e->cfg.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_SIZE if segments is 0 or > AUVID_MAX_SEGMENTS, or if
 *         sines of a SINES segment is 0 or > AUVID_MAX_SINES; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE
 *         if a field is outside its range, or the sequence or the run is shorter than a
 *         millisecond. On an error *e is unchanged.
 */
auvid_status_t auvid_excitation_init(auvid_excitation_t *e, const auvid_excitation_config_t *cfg);

#define auvid_excitation_start AUVID_SIZED(auvid_excitation_start)
/**
 * Start the run with its first segment and the random choices of the seed. A run in progress is
 * restarted without a fade-out.
 * @param t_us start of the run [us], any.
 * @return AUVID_OK; AUVID_ERR_NULL.
 */
auvid_status_t auvid_excitation_start(auvid_excitation_t *e, uint64_t t_us);

#define auvid_excitation_stop AUVID_SIZED(auvid_excitation_stop)
/**
 * Fade out over fade_s, then end the run. A no-op if idle or already stopping.
 * @param t_us start of the fade [us].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_TIME_BACK if t_us is before the last call's; *e is
 *         then unchanged.
 */
auvid_status_t auvid_excitation_stop(auvid_excitation_t *e, uint64_t t_us);

#define auvid_excitation_step AUVID_SIZED(auvid_excitation_step)
/**
 * Compute the wrench at t_us.
 * @param t_us   time [us], not before the last call's. The same time and displacement give the same
 *               wrench.
 * @param wrench 6: body wrench [N, Nm]; zero on every status but AUVID_OK. Always written, unless
 *               NULL.
 * @return AUVID_OK; AUVID_FINISHED if the run has ended or none was started; AUVID_ERR_NULL;
 *         AUVID_ERR_TIME_BACK if t_us is before the last call's; *e is then unchanged, and a later
 *         step continues the run.
 */
auvid_status_t auvid_excitation_step(auvid_excitation_t *e, uint64_t t_us,
                                     auvid_real_t wrench[AUVID_DOF_COUNT]);

#define auvid_excitation_set_displacement AUVID_SIZED(auvid_excitation_set_displacement)
/**
 * Set the displacement for the next steps; it applies until it is set again.
 * @param displacement 6: surge, sway, heave: displacement since the start of the run, in current
 *                     body axes [m]; roll, pitch, yaw: rotation since the start [rad], yaw
 *                     unwrapped.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE. On an error the last one remains.
 */
auvid_status_t auvid_excitation_set_displacement(auvid_excitation_t *e,
                                                 const auvid_real_t displacement[AUVID_DOF_COUNT]);

#define auvid_excitation_progress AUVID_SIZED(auvid_excitation_progress)
/** Return the completed fraction of the run at the last step, 0..1: 0 before the first start, 1
 * when finished. NULL gives 0. */
auvid_real_t auvid_excitation_progress(const auvid_excitation_t *e);

#define auvid_excitation_peak AUVID_SIZED(auvid_excitation_peak)
/**
 * Compute the largest |wrench| per DoF that the sequence can reach.
 * @param peak 6, written [N, Nm], >= 0.
 * @return AUVID_OK; AUVID_ERR_NULL.
 */
auvid_status_t auvid_excitation_peak(const auvid_excitation_t *e,
                                     auvid_real_t peak[AUVID_DOF_COUNT]);

#ifdef __cplusplus
}
#endif

#endif
