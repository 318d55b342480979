/**
 * @file replay.h
 * Replays a recorded log through the library, as the identifier would have seen it on board.
 */
#ifndef PROGRAM_REPLAY_H
#define PROGRAM_REPLAY_H

#include "auvid/allocation.h"
#include "auvid/identifier.h"
#include "csv.h"

/** Kind of the inputs of a log. */
typedef enum { INPUT_WRENCH, INPUT_COMMAND } input_kind_t;

/** How to read a log. */
typedef struct {
    input_kind_t kind;
    uint8_t dofs; /**< bit j: the input of DoF j is used (its velocity exists) */
    const auvid_allocation_t *thrusters; /**< NULL: not known */
} replay_t;

/** First column of the inputs of a kind. */
int replay_inputs(input_kind_t kind);

/** Time of a row [us]; the first row is at one second. */
uint64_t replay_time_us(const csv_log_t *log, size_t row);

/** Feeds all rows to the identifier, with the thrusters' forces that make the wrench, if they are
 * known. */
void replay_identify(const csv_log_t *log, const replay_t *replay, auvid_identifier_t *id);

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
