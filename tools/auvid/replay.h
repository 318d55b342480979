/**
 * @file replay.h
 * Replays a recorded log through the library, as the identifier would have seen it on board.
 */
#ifndef PROGRAM_REPLAY_H
#define PROGRAM_REPLAY_H

#include "auvid/allocation.h"
#include "auvid/identifier.h"
#include "auvid/uncertain.h"
#include "csv.h"
#include "vehicle_file.h"

/** Kind of the inputs of a log. */
typedef enum { INPUT_WRENCH, INPUT_COMMAND } input_kind_t;

/** How to read a log. */
typedef struct {
    input_kind_t kind;
    uint8_t dofs;   /**< bit j: the input of DoF j is used (its velocity exists) */
    bool reference; /**< the log has the reference of a controller (ref_*) */
    const vehicle_t *thrusters; /**< the vehicle of this log; NULL: not known */
} replay_t;

/** First column of the inputs of a kind. */
int replay_inputs(input_kind_t kind);

/** Time of a row [us]; the first row is at one second. */
uint64_t replay_time_us(const csv_log_t *log, size_t row);

/** Uncertain inputs of a log, and instruments (uncertain.h). */
typedef struct {
    auvid_allocation_t allocation;
    auvid_uncertain_t uncertain;
    auvid_instruments_t instruments;
} replay_inputs_t;

/** Attaches uncertain inputs if the thrusters are known, and instruments if there is a reference:
 * of unknown thrusters without errors, each DoF as one of them. Returns the library's status. */
auvid_status_t replay_attach(const replay_t *replay, replay_inputs_t *inputs,
                             auvid_identifier_t *id);

/** Feeds all rows to the identifier. With uncertain inputs it works during the log, because only an
 * estimate shows feedback. */
void replay_identify(const csv_log_t *log, const replay_t *replay, replay_inputs_t *inputs,
                     auvid_identifier_t *id);

/** A cell of the record. */
typedef struct {
    auvid_sample_t sample;
    bool after_gap; /**< a gap precedes this cell */
} cell_t;

/** All cells of a log. */
typedef struct {
    cell_t *cell;
    size_t cells;
} cells_t;

/** Records all rows with a separate recorder. Returns false if there is no memory. */
bool replay_record(const csv_log_t *log, const replay_t *replay,
                   const auvid_recorder_config_t *recorder, cells_t *cells);
void cells_free(cells_t *cells);

#endif
