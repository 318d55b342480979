/**
 * @file checkpoint.h
 * Save and restore the complete identifier, so that it continues after a restart bit for bit.
 *
 * A checkpoint is the memory of the state: the record, the data sets, the search at any point,
 * navigation, excitation, guard, uncertain inputs and instruments. The state has no pointers,
 * enumerations or gaps, so the bytes are the same on every little-endian machine; there is no
 * checkpoint on others. The configuration is not part of it: the restored identifier must have the
 * same one. What decides on forces (the plan of the excitation, the thrusters, the guard's limits)
 * may differ and stays that of init. If only the parameters of the last dive are needed, the prior
 * record (prior.h) of 236 bytes suffices.
 *
 * It is written in chunks of any size, straight from the identifier, which must not change during
 * that time. Save when nothing steps any more. During a dive save a copy: one tick makes it, later
 * ticks write it:
 *
 *     static auvid_identifier_t copy;                 in one tick, after work:
 *     copy = id;
 *     auvid_checkpoint_begin(&saving, &copy);
 *                                                     in each of the following:
 *     uint32_t bytes = sizeof page;
 *     auvid_status_t status = auvid_checkpoint_next(&saving, page, &bytes);
 *     flash_write(page, bytes);                       while it is AUVID_PENDING; < 0: begin again
 *
 * Also copy what is attached: the acting half (actuation.h), the storage of adaptive excitation, of
 * the change test, of the prior, of the prediction, of uncertain inputs and of instruments. Set
 * copy.actuation, its shape_context, copy.attached.change, copy.metric.prior_context,
 * copy.attached.prediction, copy.attached.uncertain and its `instruments` to the copies. On the
 * residual path also copy the model's storage (metric.rows), and set copy.metric.cfg.rows to the
 * copy.
 *
 * Called from the control task, between ticks. Cost on a Cortex-M4F (-O2): 29 instructions a byte
 * to save (7.4k a page of 256), 70 to restore, and 13k to begin. Size: 20 to 26 KB with default
 * sizes, depending on what is under way; 36 KB more with uncertain inputs, and 27 KB with
 * instruments. cursor.bytes is the size, AUVID_CHECKPOINT_MAX its bound. Memory: the cursor, 56
 * bytes; stack 0.6 KiB. Code: 11 KB on a Cortex-M4F (-Os), none if it is not called.
 * Not in the paper.
 */
#ifndef AUVID_CHECKPOINT_H
#define AUVID_CHECKPOINT_H

#include "auvid/actuation.h"
#include "auvid/adaptive.h"
#include "auvid/identifier.h"
#include "auvid/prior.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes before and after the saved data. */
enum { AUVID_CHECKPOINT_HEAD = 28, AUVID_CHECKPOINT_TAIL = 4 };

/** Upper bound of the size with `rows` rows of storage: (sets + 1) set_rows for a model without
 * regressor, else 0. With uncertain inputs add sizeof(auvid_uncertain_t), with instruments also
 * sizeof(auvid_instruments_t). */
#define AUVID_CHECKPOINT_MAX(rows)                                                                 \
    (AUVID_CHECKPOINT_HEAD + sizeof(auvid_identifier_t) + sizeof(auvid_actuation_t) +              \
     sizeof(auvid_adaptive_t) + sizeof(auvid_change_detector_t) + sizeof(auvid_prior_t) +          \
     sizeof(auvid_validation_t) + (rows) * sizeof(auvid_row_t) + AUVID_CHECKPOINT_TAIL)

/** Cursor of a checkpoint being saved. Only the functions below write it; `bytes` is public to
 * read. */
typedef struct {
    const auvid_identifier_t *id; /* being saved */
    uint64_t t_us;                /* its last tick */
    uint32_t bytes;               /**< of the whole checkpoint */
    uint32_t at;                  /* bytes written so far */
    uint32_t checksum;            /* of these */
    uint8_t head[AUVID_CHECKPOINT_HEAD];
} auvid_checkpoint_t;

#define auvid_checkpoint_begin AUVID_SIZED(auvid_checkpoint_begin)
/** Begin to save a checkpoint.
 * @param id must outlive the saving, and must not change until it is complete
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_checkpoint_begin(auvid_checkpoint_t *cursor, const auvid_identifier_t *id);

/** Write the next bytes of the checkpoint started by auvid_checkpoint_begin.
 * @param chunk [*bytes] written
 * @param bytes in: size of chunk; out: number of bytes written, less than the size only at the end
 * @return AUVID_PENDING (more to come); AUVID_OK (that was the last chunk); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not begun, or the time of the identifier has advanced since then: *bytes is 0,
 * and the bytes written so far are useless). A call of auvid_identifier_work or
 * auvid_identifier_applied in between is not noticed: the checkpoint is then a mixture. */
auvid_status_t auvid_checkpoint_next(auvid_checkpoint_t *cursor, uint8_t *chunk, uint32_t *bytes);

#define auvid_checkpoint_restore AUVID_SIZED(auvid_checkpoint_restore)
/** Restore a checkpoint into an identifier that init has accepted for the same model, with the same
 * storage for its rows. Prior records are part of the checkpoint. If an acting half, adaptive
 * excitation, uncertain inputs or instruments are part of it, the same must be attached to *id.
 * Uncertain inputs must have the same configuration, and thrusters with the same positions and
 * limits.
 *
 * Restoring never acts. A guard that was ARMED, EXCITING or SETTLING becomes DISARMED, and the
 * sequence stops; a guard that was ABORTED stays so. The identifier keeps its pointers (model,
 * storage, attached validation) and its configuration, which must be that of the saved one, except
 * for the plan of the excitation and the guard's limits. Thrusters that set metric.tau_max (0 in
 * the configuration) must give as much as the saved ones.
 *
 * The checksum detects damage; it does not prove that auvid wrote the data. So each number is
 * checked against its range, and related numbers against each other. An accepted checkpoint keeps
 * the identifier within its memory and its budgets. Nothing can prove that its data were measured.
 *
 * Time must advance: a step before the saved id->t_us is rejected.
 * @param checkpoint [bytes]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_DETACHED (it has
 * an acting half, adaptive excitation, uncertain inputs, instruments, a change test, or memory for
 * a prior, which is not attached to *id; or a prediction was under way, and none is attached);
 * AUVID_ERR_ATTACHED (*id has one of these, but for the prediction, and the checkpoint has not);
 * AUVID_ERR_CHECKSUM (damaged, truncated, or no checkpoint); AUVID_ERR_SIZE (of a library of
 * another version or of other sizes, or of another number of rows of storage); AUVID_ERR_MODEL (of
 * another model, of other free parameters, or of other fixed values); AUVID_ERR_CONFIGURATION (the
 * rest of the configuration differs); AUVID_ERR_RANGE (undamaged, but
 * not written by auvid: a number is not finite, out of its range, or contradicts another). A
 * rejected checkpoint changes nothing. */
auvid_status_t auvid_checkpoint_restore(auvid_identifier_t *id, const uint8_t *checkpoint,
                                        uint32_t bytes);

#define auvid_checkpoint_resume AUVID_SIZED(auvid_checkpoint_resume)
/** Restore a checkpoint as auvid_checkpoint_restore does, but with the guard and the excitation as
 * they were when saved. For replays and tests without thrusters. An excitation that was under way
 * continues if the next tick comes within the guard's max_tick_us; otherwise the guard aborts.
 * @return as auvid_checkpoint_restore. */
auvid_status_t auvid_checkpoint_resume(auvid_identifier_t *id, const uint8_t *checkpoint,
                                       uint32_t bytes);

#ifdef __cplusplus
}
#endif

#endif
