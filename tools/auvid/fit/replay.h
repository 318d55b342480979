/**
 * @file replay.h
 * Replays recorded logs through the library, as the identifier would have seen them on board. Every
 * replay reads the files again, so that no log is held in memory.
 */
#ifndef PROGRAM_REPLAY_H
#define PROGRAM_REPLAY_H

#include "auvid/allocation.h"
#include "auvid/identifier.h"
#include "auvid/uncertain.h"
#include "../log/log_samples.h"

/** Uncertain inputs of a log, and instruments (uncertain.h). */
typedef struct {
    auvid_allocation_t allocation;
    auvid_uncertain_t uncertain;
    auvid_instruments_t instruments;
    uint64_t set_us[2];   /* end of the set before the newest, and of the newest */
    uint32_t sets;        /* completed so far */
    uint32_t changed_set; /* the one that showed the last change; 0: none did */
    uint64_t changed_us;  /**< its start: what precedes is not in the estimate; 0: all is */
} replay_inputs_t;

/** Attaches uncertain inputs if the thrusters are known, and instruments if there is a reference:
 * of unknown thrusters without errors, each DoF as one of them. Returns the library's status. */
auvid_status_t replay_attach(const log_use_t *use, replay_inputs_t *inputs, auvid_identifier_t *id);

/** Feeds all rows of the logs, or of their part, to the identifier.
 * @param works it also works during the logs, because only an estimate shows feedback
 * @return 0, or EXIT_REFUSED after one line on stderr */
int replay_identify(const log_set_t *logs, const log_use_t *use, replay_inputs_t *inputs,
                    bool works, auvid_identifier_t *id);

/** Notes a change of the vehicle that the identifier has found. Call it after work.
 * @param t_us of the newest sample */
void replay_note_change(replay_inputs_t *inputs, const auvid_identifier_t *id, uint64_t t_us);

/** Takes a cell of the record. after_gap: a gap precedes it. */
typedef void replay_take_t(void *context, const auvid_sample_t *cell, bool after_gap);

/** Records all rows with a separate recorder. Returns 0, or EXIT_REFUSED after one line on stderr.
 */
int replay_cells(const log_set_t *logs, const log_use_t *use, const auvid_recorder_config_t *cfg,
                 replay_take_t *take, void *context);

#endif
