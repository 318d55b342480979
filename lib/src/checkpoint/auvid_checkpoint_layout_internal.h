/**
 * @file auvid_checkpoint_layout_internal.h
 * Private: the contents of a checkpoint, block by block.
 */
#ifndef AUVID_CHECKPOINT_LAYOUT_INTERNAL_H
#define AUVID_CHECKPOINT_LAYOUT_INTERNAL_H

#include <string.h>

#include "auvid/adaptive.h"
#include "auvid/checkpoint.h"
#include "auvid/uncertain.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "auvid: a checkpoint is the memory of a little-endian machine"
#endif

/** Parts that are saved only sometimes: a block with some of these bits is present if one of them
 * is set. Otherwise its memory is unused. */
enum {
    PART_RESIDUAL = 1,       /**< a model on the residual path */
    PART_SIMULATED = 2,      /**< the estimate simulates the set being recorded */
    PART_GLOBAL = 4,         /**< a search is under way, global phase */
    PART_LOCAL = 8,          /**< the same, local phase */
    PART_CONFIDENCE = 16,    /**< the confidence of a result is being computed */
    PART_ADAPTIVE = 32,      /**< the excitation is adaptive */
    PART_OPTIMUM = 64,       /**< the minimum cost is being found */
    PART_ACTUATION = 128,    /**< an acting half is attached */
    PART_CHANGE = 256,       /**< a change test is attached */
    PART_PRIOR = 512,        /**< memory for a prior is attached */
    PART_UNCERTAIN = 1024,   /**< uncertain inputs are attached */
    PART_INSTRUMENTS = 2048, /**< instruments are attached to these */
    PART_NEWTON = 4096,      /**< Gauss-Newton steps are made, or wait to be confirmed */
    PART_WINDOWS = 8192,     /**< the sets are linearised otherwise */
    PART_END                 /**< the last part + 1 */
};
_Static_assert(PART_END - 1 <= UINT16_MAX, "auvid_checkpoint_block_t.parts");

/** The structs that are saved: the identifier, and what is attached to it. */
enum {
    ROOT_IDENTIFIER,
    ROOT_ACTUATION,
    ROOT_ADAPTIVE,
    ROOT_CHANGE,
    ROOT_PRIOR,
    ROOT_PREDICTION,
    ROOT_UNCERTAIN,
    ROOT_INSTRUMENTS,
    ROOT_ROWS
};

/** Adjacent members without gaps, and without pointers. */
typedef struct {
    uint8_t root;   /**< ROOT_..., the struct that contains them */
    uint16_t parts; /**< PART_..., see above; 0: always */
    uint32_t offset;
    uint32_t bytes; /**< ROOT_ROWS: of each row */
} auvid_checkpoint_block_t;

/** The state, in the order of the stream; what of the identifier is configured. */
enum { CHECKPOINT_BLOCKS = 26, CHECKPOINT_CONFIGURED = 7 };
extern const auvid_checkpoint_block_t auvid_checkpoint_block[CHECKPOINT_BLOCKS];
extern const auvid_checkpoint_block_t auvid_checkpoint_configured[CHECKPOINT_CONFIGURED];

/** Checksum of the layout with default sizes, float: tests/validation/layout.py computes it. */
#define AUVID_CHECKPOINT_LAYOUT 0x5b590178u

/** The body of a checkpoint. */
typedef struct {
    uint32_t parts;      /**< of those that are present */
    uint32_t rows;       /**< of the caller's storage */
    const uint8_t *body; /**< only to read it */
} auvid_checkpoint_view_t;

/** Bytes of a block; 0: it is absent. */
static inline uint32_t auvid_checkpoint_bytes(const auvid_checkpoint_view_t *v,
                                              const auvid_checkpoint_block_t *block)
{
    bool there = block->parts == 0 || (block->parts & v->parts) != 0;
    return !there ? 0u : block->root == ROOT_ROWS ? block->bytes * v->rows : block->bytes;
}

/** Kinds of structs: TABLE_x is of auvid_x_t. */
enum {
    TABLE_nav_velocity_sample,
    TABLE_nav_diagnostics,
    TABLE_nav,
    TABLE_recorder_stream,
    TABLE_recorder,
    TABLE_set,
    TABLE_metric,
    TABLE_excitation_channel,
    TABLE_excitation,
    TABLE_adaptive,
    TABLE_guard_trip,
    TABLE_guard,
    TABLE_confidence,
    TABLE_estimate,
    TABLE_change_test,
    TABLE_change_detector,
    TABLE_prior,
    TABLE_sample,
    TABLE_validation,
    TABLE_search_config,
    TABLE_crs,
    TABLE_line_search,
    TABLE_optimizer,
    TABLE_bounded_ls,
    TABLE_gauss_newton,
    TABLE_confidence_job,
    TABLE_guard_seen,
    TABLE_identifier,
    TABLE_actuation,
    TABLE_row,
    TABLE_uncertain,
    TABLE_cause,
    TABLE_reference,
    TABLE_instruments,
};

/** Where structs of a kind are: `count` of them, `size` bytes each. */
typedef struct {
    uint8_t table;  /**< TABLE_... */
    uint8_t root;   /**< ROOT_... */
    uint16_t parts; /**< PART_...; 0: always */
    uint8_t count;  /**< ROOT_ROWS: one in each row */
    uint32_t offset;
    uint32_t size;
} auvid_checkpoint_struct_t;
extern const auvid_checkpoint_struct_t auvid_checkpoint_struct[];
extern const size_t auvid_checkpoint_structs;

/** Kinds of scalars. */
enum { KIND_UNSIGNED, KIND_SIGNED, KIND_REAL };

/** Range of adjacent scalars of a struct. */
typedef struct {
    uint8_t table; /**< TABLE_... */
    uint8_t kind;  /**< KIND_... */
    uint8_t width; /**< bytes of a scalar */
    uint32_t first, count;
    auvid_real_t low, high;
} auvid_checkpoint_limit_t;
extern const auvid_checkpoint_limit_t auvid_checkpoint_limit[];
extern const size_t auvid_checkpoint_limits;

/** What is checked of the uncertain inputs, or of the instruments. Attaching them sets the pointer
 * to it, so a program without them does not contain it. */
typedef struct auvid_checkpoint_part {
    const auvid_checkpoint_limit_t *limit;
    size_t limits;
    /** Do its members agree? @param state its block @param parts of the checkpoint @param phase of
     * the work, auvid_work_phase_t */
    bool (*check)(const auvid_identifier_t *id, const uint8_t *state, uint32_t parts,
                  uint32_t phase);
} auvid_checkpoint_part_t;

/** An unsigned number of up to eight bytes. */
static inline uint64_t auvid_checkpoint_whole(const uint8_t *at, size_t width)
{
    uint64_t x = 0;
    memcpy(&x, at, width);
    return x;
}

/** Check that the body could be of an identifier of id's model and configuration with id's storage:
 * every number is finite, every index, enumeration, flag and count is in range, and they are
 * consistent with each other. @return AUVID_OK; AUVID_ERR_RANGE. */
auvid_status_t auvid_checkpoint_validate(const auvid_identifier_t *id,
                                         const auvid_checkpoint_view_t *v);

#endif
