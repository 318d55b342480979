/**
 * @file auvid_checkpoint_layout_internal.h
 * Private: the contents of a checkpoint, struct by struct.
 */
#ifndef AUVID_CHECKPOINT_LAYOUT_INTERNAL_H
#define AUVID_CHECKPOINT_LAYOUT_INTERNAL_H

#include <string.h>

#include "auvid/adaptive.h"
#include "auvid/checkpoint.h"

/** Parts that are saved only sometimes: a row with some of these bits is present if one of them is
 * set. Otherwise its memory is unused. */
enum {
    PART_RESIDUAL = 1,    /**< a model on the residual path */
    PART_SIMULATED = 2,   /**< the estimate simulates the set being recorded */
    PART_GLOBAL = 4,      /**< a search is under way, global phase */
    PART_LOCAL = 8,       /**< the same, local phase */
    PART_CONFIDENCE = 16, /**< the confidence of a result is being computed */
    PART_ADAPTIVE = 32,   /**< the excitation is adaptive */
    PART_OPTIMUM = 64,    /**< the minimum cost is being found */
    PART_ACTUATION = 128, /**< an acting half is attached */
    PART_END              /**< the last part + 1 */
};
_Static_assert(PART_END - 1 <= UINT8_MAX, "auvid_checkpoint_row_t.parts");

/** Adjacent members, all of scalars of one width: `count` scalars of `width` bytes, each the lower
 * bytes of `stride` bytes in memory. Width 0: structs of another table. */
typedef struct {
    uint32_t offset; /**< of the first, in its struct */
    uint32_t count;
    uint32_t stride;
    uint8_t width;
    uint8_t table; /**< of a struct */
    uint8_t parts; /**< 0: always */
    bool finite;   /**< reals; none may be infinite or NaN */
} auvid_checkpoint_row_t;

/** A struct's rows, in the order of the stream. */
typedef struct {
    const auvid_checkpoint_row_t *row;
    uint32_t rows;
} auvid_checkpoint_table_t;

/** The tables. A table contains only structs of earlier tables. */
enum {
    TABLE_SEARCH,
    TABLE_VELOCITY_SAMPLE,
    TABLE_DIAGNOSTICS,
    TABLE_NAV,
    TABLE_STREAM,
    TABLE_RECORDER,
    TABLE_SET,
    TABLE_METRIC,
    TABLE_CHANNEL,
    TABLE_EXCITATION,
    TABLE_ADAPTIVE,
    TABLE_TRIP,
    TABLE_GUARD,
    TABLE_CONFIDENCE,
    TABLE_ESTIMATE,
    TABLE_CHANGE_TEST,
    TABLE_SAMPLE,
    TABLE_VALIDATION,
    TABLE_CRS,
    TABLE_LINE_SEARCH,
    TABLE_OPTIMIZER,
    TABLE_OPTIMUM,
    TABLE_JOB,
    TABLE_SEEN,
    TABLE_IDENTIFIER,
    TABLE_ACTUATION,
    TABLE_ROW, /**< of the storage of a model on the residual path */
    TABLE_COUNT
};
_Static_assert(TABLE_COUNT - 1 <= UINT8_MAX, "auvid_checkpoint_row_t.table");
extern const auvid_checkpoint_table_t auvid_checkpoint_table[TABLE_COUNT];

/** Bytes of each struct in the stream. */
typedef struct {
    uint32_t parts;
    uint32_t of[TABLE_COUNT];
} auvid_checkpoint_sizes_t;

/** Compute the sizes for a checkpoint with these parts (PART_...). */
void auvid_checkpoint_measure(auvid_checkpoint_sizes_t *sizes, uint32_t parts);

/** Bytes of one element of a row. */
static inline uint32_t auvid_checkpoint_element(const auvid_checkpoint_sizes_t *sizes,
                                                const auvid_checkpoint_row_t *row)
{
    return row->width != 0 ? row->width : sizes->of[row->table];
}

/** Bytes of a row; 0: it is absent. */
static inline uint32_t auvid_checkpoint_bytes(const auvid_checkpoint_sizes_t *sizes,
                                              const auvid_checkpoint_row_t *row)
{
    bool there = row->parts == 0 || (row->parts & sizes->parts) != 0;
    return there ? row->count * auvid_checkpoint_element(sizes, row) : 0u;
}

/** The structs that are saved, in the order of the stream: each one, if it is attached, then the
 * rows. */
typedef struct {
    uint8_t table;
    uint8_t part; /**< 0: always */
} auvid_checkpoint_root_t;
enum { CHECKPOINT_ROOTS = 4 };
extern const auvid_checkpoint_root_t auvid_checkpoint_root[CHECKPOINT_ROOTS];

/** Bytes of a root; 0: it is absent. */
static inline uint32_t auvid_checkpoint_root_bytes(const auvid_checkpoint_sizes_t *sizes, int root)
{
    uint8_t part = auvid_checkpoint_root[root].part;
    return part == 0 || (part & sizes->parts) != 0 ? sizes->of[auvid_checkpoint_root[root].table]
                                                   : 0u;
}

/** Scalars at equal distances in memory. */
typedef struct {
    uint8_t root;  /**< the table of the outermost struct */
    uint8_t table; /**< the table of the struct that contains them */
    size_t offset;
    const auvid_checkpoint_row_t *row;
    uint32_t count;
    uint32_t skip; /**< bytes of the first scalar that are already processed */
} auvid_checkpoint_run_t;

/** The run of scalars that begins with byte `at` of the body. */
auvid_checkpoint_run_t auvid_checkpoint_locate(const auvid_checkpoint_sizes_t *sizes, uint32_t at);

/** Index of byte k of a scalar, from the lowest, among its `stride` bytes in memory. */
static inline uint32_t auvid_checkpoint_byte(uint32_t stride, uint32_t k)
{
    const uint16_t one = 1;
    uint8_t lowest;
    memcpy(&lowest, &one, 1);
    return lowest == 1 ? k : stride - 1u - k;
}

/** Range of the scalars of a struct. */
typedef struct {
    uint8_t table;
    bool same;              /**< must equal the identifier's; low and high are not read */
    uint32_t first, end;    /**< bytes of the struct */
    auvid_real_t low, high; /**< low < 0 of integers: they are signed */
} auvid_checkpoint_limit_t;
extern const auvid_checkpoint_limit_t auvid_checkpoint_limit[];
extern const size_t auvid_checkpoint_limits;

/** Check that a body with these sizes could be of an identifier of id's model with id's storage:
 * every number is finite, every index, enumeration, flag, count and size is in range, and they are
 * consistent with each other. @return AUVID_OK; AUVID_ERR_RANGE. */
auvid_status_t auvid_checkpoint_validate(const auvid_identifier_t *id,
                                         const auvid_checkpoint_sizes_t *sizes, const uint8_t *body,
                                         uint32_t bytes);

#endif
