/**
 * @file auvid_can_private.h
 * Private: the tables that `make can` writes from lib/can/auvid.dbc and the codec reads.
 */
#ifndef AUVID_CAN_PRIVATE_H
#define AUVID_CAN_PRIVATE_H

#include "auvid/can.h"

typedef enum {
    AUVID_CAN_TYPE_UINT = 0, /**< unsigned integer */
    AUVID_CAN_TYPE_REAL = 1, /**< signed fixed point; the most negative value: not available */
    AUVID_CAN_TYPE_FLOAT = 2 /**< float32; NaN: not available */
} auvid_can_type_kind_t;

/** What several signals have in common. */
typedef struct {
    uint16_t per_unit; /**< raw = value per_unit; an integer, so it is exact in float */
    uint16_t limit;    /**< largest raw value, the smallest being 0 or minus this; 0: all that its
                            bits can hold */
    uint8_t length;    /**< bits: 1..24, or 32; of REAL at most 23 */
    uint8_t kind;      /**< auvid_can_type_kind_t */
    uint8_t special;   /**< UINT: a constant, `limit`; REAL, FLOAT: not negative */
} auvid_can_type_t;

typedef struct {
    uint8_t start;  /**< bit of the frame, counted as DBC does for little-endian signals */
    uint8_t type;   /**< index into auvid_can_types */
    uint8_t offset; /**< of the member in its struct [bytes] */
} auvid_can_signal_t;

/** A message. Those with the same signals share them. */
typedef struct {
    uint8_t data_id; /**< of E2E profile 2 */
    uint8_t first;   /**< its first signal */
    uint8_t signals; /**< how many */
} auvid_can_entry_t;

extern const auvid_can_type_t auvid_can_types[];
extern const auvid_can_signal_t auvid_can_signals[];
extern const auvid_can_entry_t auvid_can_entries[AUVID_CAN_KINDS];
extern const uint16_t auvid_can_cycles_ms[AUVID_CAN_KINDS]; /**< 0: on event */

#endif
