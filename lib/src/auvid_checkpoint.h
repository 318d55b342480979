/**
 * @file auvid_checkpoint.h
 * Private: what a checkpoint holds of each struct.
 */
#ifndef AUVID_CHECKPOINT_PRIVATE_H
#define AUVID_CHECKPOINT_PRIVATE_H

#include "auvid/checkpoint.h"

/** What is saved at some times only: a row with some of these bits is there when one of them is.
 * What is not there is dead memory, and zero after restoring. */
enum {
    PART_RESIDUAL = 1,   /**< a model without regressor */
    PART_SIMULATED = 2,  /**< the estimate simulates the set that is being recorded */
    PART_GLOBAL = 4,     /**< a search is under way, global, */
    PART_LOCAL = 8,      /**< or local */
    PART_CONFIDENCE = 16, /**< a result is being assessed */
    PART_ADAPTIVE = 32,   /**< marks it only: the excitation is adaptive */
    PART_OPTIMUM = 64     /**< the least cost is being found */
};

/** Members that lie side by side, all of scalars of one width: `count` times `width` bytes, each
 * the lower ones of `stride` bytes in memory. With width 0: structs, of another table. */
typedef struct {
    uint32_t offset; /**< of the first, in its struct */
    uint32_t count;
    uint32_t stride;
    uint8_t width;
    uint8_t table; /**< of a struct */
    uint8_t parts; /**< 0: always */
} auvid_checkpoint_row_t;

/** A struct's rows, in the order of the stream. */
typedef struct {
    const auvid_checkpoint_row_t *row;
    uint32_t rows;
} auvid_checkpoint_table_t;

/** The tables. One holds structs of earlier ones only. */
enum {
    TABLE_SEARCH,
    TABLE_KNOT,
    TABLE_DIAGNOSTICS,
    TABLE_NAV,
    TABLE_STREAM,
    TABLE_RECORDER,
    TABLE_SET,
    TABLE_METRIC,
    TABLE_THRUSTER,
    TABLE_ALLOCATION,
    TABLE_SEGMENT,
    TABLE_CHANNEL,
    TABLE_EXCITATION,
    TABLE_ADAPTIVE,
    TABLE_TRIP,
    TABLE_GUARD,
    TABLE_CONFIDENCE,
    TABLE_ESTIMATE,
    TABLE_JUDGEMENT,
    TABLE_SAMPLE,
    TABLE_VALIDATION,
    TABLE_CRS,
    TABLE_LINE_CONFIG,
    TABLE_LINE_SEARCH,
    TABLE_OPTIMIZER,
    TABLE_OPTIMUM,
    TABLE_JOB,
    TABLE_SEEN,
    TABLE_IDENTIFIER,
    TABLE_ROW, /**< of the storage of a model without regressor */
    TABLE_COUNT
};
extern const auvid_checkpoint_table_t auvid_checkpoint_table[TABLE_COUNT];

#endif
