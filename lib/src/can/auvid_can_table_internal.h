/**
 * @file auvid_can_table_internal.h
 * Private: the tables of the codec. `make can` writes them from lib/can/auvid.dbc.
 */
#ifndef AUVID_CAN_TABLE_INTERNAL_H
#define AUVID_CAN_TABLE_INTERNAL_H

#include "auvid/can.h"

/** Kinds of auvid_can_type_t. Odd kinds: the minimum is not minus the maximum. */
typedef enum {
    AUVID_CAN_TYPE_UINT = 0,          /**< unsigned integer, 0..number; number 0: all bits */
    AUVID_CAN_TYPE_CONSTANT = 1,      /**< unsigned integer, always `number` */
    AUVID_CAN_TYPE_REAL = 2,          /**< signed fixed point, all bits, step 1/number; the
                                           most negative raw value: not available */
    AUVID_CAN_TYPE_REAL_POSITIVE = 3, /**< the same, not negative */
    AUVID_CAN_TYPE_REAL_UNIT = 4,     /**< the same, -1..1 */
    AUVID_CAN_TYPE_FLOAT = 6,         /**< float32, number 1; NaN: not available */
    AUVID_CAN_TYPE_FLOAT_POSITIVE = 7 /**< the same, not negative */
} auvid_can_type_kind_t;

/** Type of a signal. Several signals share one. */
typedef struct {
    uint16_t number; /**< see the kinds; exact in float */
    uint8_t unused;  /**< 32 - bits of the signal, which has 1..24 or 32; of fixed point <= 23 */
    uint8_t kind;    /**< auvid_can_type_kind_t */
} auvid_can_type_t;

/** A signal. Messages with the same layout share their signals. */
typedef struct {
    uint16_t start : 6; /**< first bit in the frame, little-endian as in the DBC */
    uint16_t type : 5;  /**< index into auvid_can_types */
    uint16_t word : 3;  /**< offset of the member in its struct [4 bytes] */
    uint16_t last : 1;  /**< the last signal of its message */
} auvid_can_signal_t;

/** Data id of a message for E2E profile 2: 1 to 6 for the first six of the first block, 7.. for the
 * second block, 246.. for what joins the first block. So a message at the end of either block moves
 * no other. */
#define AUVID_CAN_DATA_ID(kind)                                                                    \
    ((uint8_t)((uint32_t)(kind) >= AUVID_CAN_FAST_KINDS                                            \
                   ? (uint32_t)(kind)-AUVID_CAN_FAST_KINDS + 7u                                    \
                   : (uint32_t)(kind) + ((uint32_t)(kind) < 6u ? 1u : 240u)))

_Static_assert(AUVID_CAN_KINDS < 245, "AUVID_CAN_DATA_ID");

extern const auvid_can_type_t auvid_can_types[];
extern const auvid_can_signal_t auvid_can_signals[];
extern const uint8_t auvid_can_first[AUVID_CAN_KINDS];      /**< first signal of each message */
extern const uint8_t auvid_can_node_kinds[AUVID_CAN_KINDS]; /**< auvid_can_node_kind_t */

#endif
