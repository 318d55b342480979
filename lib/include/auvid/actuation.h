/**
 * @file actuation.h
 * The acting half of the identifier: excitation (excitation.h), guard (guard.h) and allocation
 * (allocation.h). One call attaches it. Without that call the identifier is passive, and its
 * program does not contain the code of these modules.
 *
 *     static auvid_allocation_t thrusters;
 *     static auvid_actuation_t actuation;
 *     auvid_identifier_init(&id, &cfg);
 *     auvid_allocation_init(&thrusters, &auvid_allocation_girona500);
 *     auvid_actuation_defaults(&acting);
 *     auvid_excitation_plan(&acting.excitation, amplitude, 30, 8, 1);
 *     auvid_identifier_attach_actuation(&id, &actuation, &acting, &thrusters);
 *
 * The excitation acts only while the guard permits it: auvid_identifier_arm, then
 * auvid_identifier_excite. After a breach of a limit, a sensor timeout or a rejected step, the
 * excitation is zero in that same tick. It stays zero until auvid_identifier_disarm. Recording and
 * searching continue. The guard does not see what enters through auvid_identifier_motion, so
 * excitation needs sensors. There is no excitation without a guard.
 *
 * The control task calls it. auvid_identifier_step runs it as the last part of a tick. Memory:
 * sizeof(auvid_actuation_t), 1.8 KiB with default sizes.
 */
#ifndef AUVID_ACTUATION_H
#define AUVID_ACTUATION_H

#include "auvid/allocation.h"
#include "auvid/excitation.h"
#include "auvid/guard.h"
#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Configuration; copied by auvid_identifier_attach_actuation. */
typedef struct {
    auvid_excitation_config_t excitation; /**< see excitation.h; no segments: arming is refused
                                               until auvid_adaptive_begin */
    auvid_guard_config_t guard;           /**< limits, see guard.h; set them for your site */
} auvid_actuation_config_t;

/** The acting half. The caller owns it; only the functions write. */
typedef struct auvid_actuation {
    const struct auvid_actuation_functions *functions; /* a pointer, so that a passive program does
                                                          not contain them */
    const auvid_allocation_t *allocation;              /**< as attached; NULL: no thruster limits */
    union {
        auvid_excitation_t excitation;
        auvid_refusal_t refusal; /**< what attaching was refused for; not after AUVID_OK */
    };
    /** state, trip and refused are public; auvid_guard_heartbeat may be called */
    auvid_guard_t guard;
    void (*shape)(auvid_identifier_t *id); /* called before each step of the excitation, to choose
                                              its holds (adaptive.h); NULL: as configured */
    void *shape_context;
    /* state: from here on, see checkpoint.h */
    auvid_guard_seen_t altitude; /* last sample taken */
    auvid_real_t altitude_m;
    auvid_real_t home[AUVID_DOF_COUNT]; /* position and attitude where the excitation began */
    bool starting;                      /* the excitation begins with the next step */
    bool saturated;                     /* the excitation's own allocation, in the last step */
    uint8_t reserved[AUVID_GAP(8, 7 * sizeof(auvid_real_t) + 2)];
} auvid_actuation_t;

#define auvid_actuation_defaults AUVID_SIZED(auvid_actuation_defaults)
/** Fill *cfg with the defaults of excitation and guard: no segment.
 * @param cfg written whole; NULL is a no-op. */
void auvid_actuation_defaults(auvid_actuation_config_t *cfg);

#define auvid_identifier_attach_actuation AUVID_SIZED(auvid_identifier_attach_actuation)
/** Attach the acting half, once, after auvid_identifier_init and before the first step or recorded
 * wrench. The guard is DISARMED: nothing acts yet. A scale of the wrench that is left to auvid
 * (metric.tau_max 0) becomes what the thrusters give.
 * After an error the identifier is as before. storage->refusal then names the refused field of *cfg
 * (part "allocation": of the allocation), its value and its limit, except after AUVID_ERR_NULL,
 * AUVID_ERR_STATE, AUVID_ERR_ATTACHED and AUVID_ERR_STARTED, which leave *storage as it was.
 * @param storage written; must outlive the identifier
 * @param cfg copied
 * @param allocation the thrusters; must outlive the identifier. NULL: no thruster limits
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_ATTACHED (it has
 * an acting half already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench); AUVID_ERR_SIZE
 * (also an allocation without thrusters: not initialised); AUVID_ERR_CAPACITY (the excitation
 * exceeds what the thrusters give); the errors of auvid_guard_init, the errors of
 * auvid_excitation_init. */
auvid_status_t auvid_identifier_attach_actuation(auvid_identifier_t *id, auvid_actuation_t *storage,
                                                 const auvid_actuation_config_t *cfg,
                                                 const auvid_allocation_t *allocation);

#define auvid_identifier_arm AUVID_SIZED(auvid_identifier_arm)
/** Arm the guard: from now on it aborts on a breach. Arming needs a previous step with fresh
 * sensors: call it until it returns AUVID_OK, then call auvid_identifier_excite. Nothing acts by
 * itself later.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, no excitation configured, or
 * the guard is neither DISARMED nor DONE); AUVID_ERR_DETACHED (no acting half); AUVID_ERR_STALE,
 * AUVID_ERR_LIMIT (see auvid_guard_arm; the reason is in guard.refused). */
auvid_status_t auvid_identifier_arm(auvid_identifier_t *id);

#define auvid_identifier_excite AUVID_SIZED(auvid_identifier_excite)
/** Begin the excitation with the next step.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or the guard is not ARMED);
 * AUVID_ERR_DETACHED (no acting half). */
auvid_status_t auvid_identifier_excite(auvid_identifier_t *id);

#define auvid_identifier_stop AUVID_SIZED(auvid_identifier_stop)
/** End the excitation normally: it fades out, then the guard is SETTLING and finally DONE.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or not exciting);
 * AUVID_ERR_DETACHED (no acting half). */
auvid_status_t auvid_identifier_stop(auvid_identifier_t *id);

#define auvid_identifier_abort AUVID_SIZED(auvid_identifier_abort)
/** Emergency stop from any state: zero from the next step on, without a fade, latched.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_DETACHED (no
 * acting half). */
auvid_status_t auvid_identifier_abort(auvid_identifier_t *id);

#define auvid_identifier_disarm AUVID_SIZED(auvid_identifier_disarm)
/** Return to DISARMED from any state and clear the latch. A running excitation ends without a fade.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_DETACHED (no
 * acting half). */
auvid_status_t auvid_identifier_disarm(auvid_identifier_t *id);

#ifdef __cplusplus
}
#endif

#endif
