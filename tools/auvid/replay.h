/**
 * @file replay.h
 * A recorded log through the library: what the identifier would have seen on board.
 */
#ifndef PROGRAM_REPLAY_H
#define PROGRAM_REPLAY_H

#include "auvid/identifier.h"
#include "csv.h"

/** What the inputs of a log are. */
typedef enum { INPUT_WRENCH, INPUT_COMMAND } input_kind_t;

/** How a log is to be read. */
typedef struct {
    input_kind_t kind;
    uint8_t dofs; /**< bit j: the input of DoF j is used (its velocity is there too) */
} replay_t;

/** First column of the inputs of a kind. */
int replay_inputs(input_kind_t kind);

/** Time of a row since the first [us], beginning at one second. */
uint64_t replay_time_us(const csv_log_t *log, size_t row);

/** Feed all rows. */
void replay_identify(const csv_log_t *log, const replay_t *replay, auvid_identifier_t *id);

/** A cell of a record. */
typedef struct {
    auvid_sample_t sample;
    bool after_gap; /**< the record was broken before this cell */
} cell_t;

/** The log as cells of a record. */
typedef struct {
    cell_t *cell;
    size_t cells;
} cells_t;

/** Record all rows with a recorder of its own. False: no memory. */
bool replay_record(const csv_log_t *log, const replay_t *replay,
                   const auvid_recorder_config_t *recorder, cells_t *cells);
void cells_free(cells_t *cells);

#endif
