/**
 * @file checkpoint.h
 * All of an identifier, to go on from after a restart as if there had been none: bit for bit.
 *
 * A checkpoint is a stream of bytes without pointers: little-endian, IEEE 754, widths that no
 * compiler chooses. It holds the configuration (but for what decides on forces, which stays that
 * of init), the record, the data sets, the search under way, at whatever point it is, and the state
 * of navigation, excitation and guard. Whoever needs but the parameters of the last dive takes the
 * warm record (prior.h), of 236 bytes.
 *
 * It is written in chunks of any size, so that no write to flash delays a tick. The identifier must
 * not change meanwhile: save from a copy, which a tick makes and later ticks write, or when nothing
 * steps any more:
 *
 *     static auvid_identifier_t copy;                 in one tick, after work:
 *     copy = id;
 *     auvid_checkpoint_begin(&saving, &copy);
 *                                                     in each of the following:
 *     uint32_t bytes = sizeof page;
 *     auvid_status_t status = auvid_checkpoint_next(&saving, page, &bytes);
 *     flash_write(page, bytes);                       until it is AUVID_OK
 *
 * For a model without regressor copy its storage (metric.rows), too, and set copy.metric.cfg.rows
 * to that.
 *
 * Called from the control task, between ticks. Cost: 42 instructions of a Cortex-M4F a byte to save
 * (17k a page of 256), 110 to restore, and 27k to begin. Size: 20 to 26 KB with default sizes,
 * by what is under way; cursor.bytes says it, AUVID_CHECKPOINT_MAX bounds it. Memory: the cursor,
 * 56 bytes; stack 0.6 KiB. Code: 13 KB on a Cortex-M4F (-Os), none where not called.
 * Not in the paper.
 */
#ifndef AUVID_CHECKPOINT_H
#define AUVID_CHECKPOINT_H

#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes before what is saved, and after it. */
enum { AUVID_CHECKPOINT_HEAD = 24, AUVID_CHECKPOINT_TAIL = 4 };

/** No checkpoint is longer, with `rows` rows of storage: (sets + 1) set_rows for a model without
 * regressor, else 0. */
#define AUVID_CHECKPOINT_MAX(rows)                                                                 \
    (AUVID_CHECKPOINT_HEAD + sizeof(auvid_identifier_t) + (rows) * sizeof(auvid_row_t) +           \
     AUVID_CHECKPOINT_TAIL)

/** Saving. Written by the functions below; `bytes` is public to read. */
typedef struct {
    const auvid_identifier_t *id; /* being saved */
    uint64_t t_us;                /* its last tick */
    uint32_t bytes;               /**< of the whole checkpoint */
    uint32_t at;                  /* bytes handed out */
    uint32_t checksum;            /* of these */
    uint8_t head[AUVID_CHECKPOINT_HEAD];
} auvid_checkpoint_t;

#define auvid_checkpoint_begin AUVID_SIZED(auvid_checkpoint_begin)
/** Begin to save.
 * @param id must outlive the saving, and must not change meanwhile
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_checkpoint_begin(auvid_checkpoint_t *cursor, const auvid_identifier_t *id);

/** Write the next bytes.
 * @param chunk [*bytes] written
 * @param bytes room; overwritten with how many have been written, less than the room only at the
 * end
 * @return AUVID_PENDING (there are more); AUVID_OK (that was the last of them); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not begun, or the identifier has stepped since: what was written is void; *bytes
 * is 0). */
auvid_status_t auvid_checkpoint_next(auvid_checkpoint_t *cursor, uint8_t *chunk, uint32_t *bytes);

#define auvid_checkpoint_restore AUVID_SIZED(auvid_checkpoint_restore)
/** Go on from a checkpoint: into an identifier that init has accepted for the same model, with the
 * same storage for its rows. Prior records are part of the checkpoint; so is the state of adaptive
 * excitation, and auvid_adaptive_begin must have been called here if it was there.
 *
 * Restoring never acts. A guard that was ARMED, EXCITING or SETTLING is DISARMED and the sequence
 * stopped; one that was ABORTED stays so. The identifier keeps its pointers (model, storage, what
 * is attached), and what decides on forces: the plan of the excitation, the thrusters and the
 * guard's limits are those of init. Everything else of the configuration is as it was when saved.
 *
 * The checksum tells damage from data, not auvid's data from somebody else's. So each number of the
 * checkpoint is held against the values that it may have, and those that belong together against
 * each other. What passes keeps the identifier within its memory and its budgets; whether the data
 * in it were ever measured, nobody can tell.
 *
 * Time must go on: a step before the saved `t_us` is refused.
 * @param checkpoint [bytes]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or auvid_adaptive_begin was
 * called either there or here); AUVID_ERR_CHECKSUM (damaged, cut, or no checkpoint); AUVID_ERR_SIZE
 * (of a library of another version or of other sizes, or of another number of rows of storage);
 * AUVID_ERR_MODEL (of another model, of other free parameters, or of other fixed values);
 * AUVID_ERR_RANGE (undamaged, and yet auvid has not written it: a number is not finite, out of its
 * range, or does not go with the others). Refused ones change nothing. */
auvid_status_t auvid_checkpoint_restore(auvid_identifier_t *id, const uint8_t *checkpoint,
                                        uint32_t bytes);

#define auvid_checkpoint_resume AUVID_SIZED(auvid_checkpoint_resume)
/** The same, and it may act: the guard and the excitation are as they were when saved. For replays
 * and tests, where no thruster listens. An excitation that was under way goes on if the next tick
 * comes within the guard's max_tick_us; else the guard aborts. */
auvid_status_t auvid_checkpoint_resume(auvid_identifier_t *id, const uint8_t *checkpoint,
                                       uint32_t bytes);

#ifdef __cplusplus
}
#endif

#endif
