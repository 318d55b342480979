/*
 * The codec. It loops over the tables generated from lib/can/auvid.dbc.
 *
 * Frame, little-endian bit numbers: 0-7 CRC, 8-11 counter, 12-63 signals.
 *   raw = round(value per_unit), value = raw / per_unit
 * per_unit and raw are integers, exact in float32, and |raw| <= 2^22. So an unpacked value is the
 * float nearest to the decimal number of the DBC, and packs to the same raw value.
 */
#include "auvid/can.h"

#include <string.h>

#include "auvid_can_table_internal.h"
#include "../base/auvid_checksum_internal.h"
#include "../base/auvid_math_internal.h"

#define COUNTER_START 8
#define COUNTER_MASK 15u
#define FIRST_PAYLOAD_BYTE 1
/* Finite in float32 with a margin for the decimal notation of the DBC. */
#define FLOAT_LIMIT AUVID_C(3.4e38)
#define FLOAT_LIMIT_BITS 0x7F7FC99Eu
#define FLOAT_ABSENT 0x7FC00000u
/* Sign bit of a 32-bit number. That of a shorter one is `unused` bits lower. */
#define SIGN 0x80000000u

typedef union {
    auvid_real_t real;
    uint32_t integer;
} can_field_t;

/* Four bits at a time. The table: what x^8 + x^5 + x^3 + x^2 + x + 1 makes of them. */
uint8_t auvid_can_crc(const uint8_t data[AUVID_CAN_BYTES], uint8_t data_id)
{
    static const uint8_t four[16] = {0x00, 0x2F, 0x5E, 0x71, 0xBC, 0x93, 0xE2, 0xCD,
                                     0x57, 0x78, 0x09, 0x26, 0xEB, 0xC4, 0xB5, 0x9A};
    uint32_t crc = 0xFFu;
    for (int i = FIRST_PAYLOAD_BYTE; i <= AUVID_CAN_BYTES; ++i) {
        crc ^= i < AUVID_CAN_BYTES ? data[i] : data_id;
        crc = (crc << 4 & 0xFFu) ^ four[crc >> 4];
        crc = (crc << 4 & 0xFFu) ^ four[crc >> 4];
    }
    return (uint8_t)(crc ^ 0xFFu);
}

static bool can_type_is_integer(const auvid_can_type_t *type)
{
    return type->kind <= AUVID_CAN_TYPE_CONSTANT;
}

static bool can_type_is_float(const auvid_can_type_t *type)
{
    return type->kind >= AUVID_CAN_TYPE_FLOAT;
}

/* Size of a member in bytes: real numbers may be longer than integers. */
static size_t can_type_size(const auvid_can_type_t *type)
{
    return can_type_is_integer(type) ? sizeof(uint32_t) : sizeof(auvid_real_t);
}

static uint32_t can_limit_integer(const auvid_can_type_t *type, uint32_t x)
{
    uint32_t high = type->number != 0 ? type->number : UINT32_MAX >> type->unused;
    return x > high || type->kind == AUVID_CAN_TYPE_CONSTANT ? high : x;
}

/* Field to raw value. A value out of range is limited and counted; NaN or an absent value becomes
 * "not available". Returns false if the value is NaN or absent. */
static bool can_encode_signal(const auvid_can_type_t *type, can_field_t field, bool absent,
                              uint32_t *raw, uint32_t *saturated)
{
    if (can_type_is_integer(type)) {
        *raw = can_limit_integer(type, field.integer);
        *saturated += *raw != field.integer;
        return true;
    }
    uint32_t sign = SIGN >> type->unused;
    *raw = can_type_is_float(type) ? FLOAT_ABSENT : sign;
    auvid_real_t x = field.real * (auvid_real_t)type->number;
    if (absent || auvid_is_nan(x)) {
        return false;
    }
    uint32_t limit = type->kind == AUVID_CAN_TYPE_REAL_UNIT ? type->number : sign - 1u;
    auvid_real_t high = can_type_is_float(type) ? FLOAT_LIMIT : (auvid_real_t)limit;
    auvid_real_t y = auvid_clamp_here(x, (type->kind & 1u) != 0 ? AUVID_C(0.0) : -high, high);
    if (can_type_is_float(type)) {
        *raw = auvid_single_bits(y);
    } else {
        *raw = (uint32_t)(int32_t)auvid_half_further(y) & UINT32_MAX >> type->unused;
    }
    /* Less than half a step beyond the limit is rounding: an unpacked limit may lie there. */
    *saturated += (x - y) * (x - y) >= AUVID_C(0.25);
    return true;
}

/* Is a raw value one that packing gives? "Not available" is. */
static bool can_raw_is_valid(const auvid_can_type_t *type, uint32_t raw)
{
    uint32_t sign = SIGN >> type->unused, number = type->number;
    switch (type->kind) {
    case AUVID_CAN_TYPE_UINT:
        return raw <= number || number == 0;
    case AUVID_CAN_TYPE_CONSTANT:
        return raw == number;
    case AUVID_CAN_TYPE_REAL:
        return true;
    case AUVID_CAN_TYPE_REAL_POSITIVE:
        return raw <= sign;
    case AUVID_CAN_TYPE_REAL_UNIT:
        return raw <= number || 2u * sign - raw <= number || raw == sign;
    default: /* FLOAT, FLOAT_POSITIVE; the latter may be -0 */
        return raw == FLOAT_ABSENT || (raw << 1 <= FLOAT_LIMIT_BITS << 1 &&
                                       (type->kind == AUVID_CAN_TYPE_FLOAT || raw <= SIGN));
    }
}

/* Raw value to field, without checks. "Not available" becomes NaN. @return is it available? */
static bool can_decode_signal(const auvid_can_type_t *type, uint32_t raw, can_field_t *field)
{
    uint32_t sign = SIGN >> type->unused;
    if (can_type_is_integer(type)) {
        field->integer = raw;
        return true;
    }
    if (can_type_is_float(type) || raw == sign) {
        raw = can_type_is_float(type) ? raw : FLOAT_ABSENT;
        field->real = auvid_from_single_bits(raw);
        return raw != FLOAT_ABSENT;
    }
    field->real =
        (auvid_real_t)((int32_t)(raw ^ sign) - (int32_t)sign) / (auvid_real_t)type->number;
    return true;
}

static const auvid_can_ids_t can_default_ids = {AUVID_CAN_FAST_BASE, AUVID_CAN_SLOW_BASE};

void auvid_can_ids_defaults(auvid_can_ids_t *ids)
{
    if (ids != NULL) {
        *ids = can_default_ids;
    }
}

auvid_status_t auvid_can_ids_check(const auvid_can_ids_t *ids)
{
    if (ids == NULL) {
        return AUVID_ERR_NULL;
    }
    uint32_t fast = ids->fast;
    uint32_t slow = ids->slow;
    bool fit = fast <= 0x800u - AUVID_CAN_FAST_KINDS && slow <= 0x800u - AUVID_CAN_SLOW_KINDS;
    /* Not -SLOW_KINDS < slow - fast < FAST_KINDS, unsigned. */
    bool disjoint =
        slow - fast + AUVID_CAN_SLOW_KINDS - 1u >= AUVID_CAN_FAST_KINDS + AUVID_CAN_SLOW_KINDS - 1u;
    return fit && disjoint ? AUVID_OK : AUVID_ERR_RANGE;
}

auvid_can_kind_t auvid_can_kind(const auvid_can_ids_t *ids, uint16_t id)
{
    ids = ids != NULL ? ids : &can_default_ids;
    uint32_t fast = (uint32_t)id - ids->fast;
    uint32_t slow = (uint32_t)id - ids->slow;
    if (fast < AUVID_CAN_FAST_KINDS) {
        return (auvid_can_kind_t)fast;
    }
    return slow < AUVID_CAN_SLOW_KINDS ? (auvid_can_kind_t)(slow + AUVID_CAN_FAST_KINDS)
                                       : AUVID_CAN_KINDS;
}

auvid_can_node_kind_t auvid_can_node_kind(auvid_can_kind_t kind)
{
    return (uint32_t)kind < AUVID_CAN_KINDS ? (auvid_can_node_kind_t)auvid_can_node_kinds[kind]
                                            : AUVID_CAN_NODE_KINDS;
}

uint16_t auvid_can_id(const auvid_can_ids_t *ids, auvid_can_kind_t kind)
{
    ids = ids != NULL ? ids : &can_default_ids;
    if ((uint32_t)kind >= AUVID_CAN_KINDS) {
        return UINT16_MAX;
    }
    uint32_t base = (uint32_t)kind < AUVID_CAN_FAST_KINDS
                        ? ids->fast
                        : (uint32_t)ids->slow - AUVID_CAN_FAST_KINDS;
    return (uint16_t)(base + (uint32_t)kind);
}

auvid_status_t auvid_can_sender_init(auvid_can_sender_t *sender, const auvid_can_ids_t *ids)
{
    ids = ids != NULL ? ids : &can_default_ids;
    auvid_status_t status = sender == NULL ? AUVID_ERR_NULL : auvid_can_ids_check(ids);
    if (status == AUVID_OK) {
        memset(sender, 0, sizeof *sender);
        sender->ids = *ids;
    }
    return status;
}

/* Packs the signals of a message into *bits. Returns false if one is NaN and not marked absent. */
static bool can_encode_message(const auvid_can_message_t *message, uint64_t *bits,
                               uint32_t *saturated)
{
    const auvid_can_signal_t *signal = &auvid_can_signals[auvid_can_first[message->kind]];
    for (uint32_t absent = message->absent;; absent >>= 1, ++signal) {
        const auvid_can_type_t *type = &auvid_can_types[signal->type];
        can_field_t field;
        uint32_t raw;
        memcpy(&field, (const uint32_t *)&message->as + signal->word, can_type_size(type));
        if (!can_encode_signal(type, field, (absent & 1u) != 0, &raw, saturated) &&
            (absent & 1u) == 0) {
            return false;
        }
        *bits |= (uint64_t)raw << signal->start;
        if (signal->last) {
            return true;
        }
    }
}

auvid_status_t auvid_can_pack(auvid_can_sender_t *sender, const auvid_can_message_t *message,
                              auvid_can_frame_t *frame)
{
    if (sender == NULL || message == NULL || frame == NULL) {
        return AUVID_ERR_NULL;
    }
    if (sender->ids.fast == sender->ids.slow) {
        return AUVID_ERR_STATE;
    }
    uint32_t saturated = 0;
    uint64_t bits = 0;
    bool known = (uint32_t)message->kind < AUVID_CAN_KINDS;
    if (!known || !can_encode_message(message, &bits, &saturated)) {
        ++sender->refused;
        return known ? AUVID_ERR_NOT_FINITE : AUVID_ERR_RANGE;
    }
    uint8_t *counter = &sender->counter[message->kind];
    bits |= (uint64_t)(*counter & COUNTER_MASK) << COUNTER_START;
    *counter = (*counter + 1u) & COUNTER_MASK;
    sender->saturated += saturated;
    frame->id = auvid_can_id(&sender->ids, message->kind);
    frame->length = AUVID_CAN_BYTES;
    for (int i = 0; i < AUVID_CAN_BYTES; ++i) {
        frame->data[i] = (uint8_t)bits;
        bits >>= 8;
    }
    frame->data[0] = auvid_can_crc(frame->data, AUVID_CAN_DATA_ID(message->kind));
    return saturated != 0 ? AUVID_SATURATED : AUVID_OK;
}

auvid_status_t auvid_can_unpack(const auvid_can_ids_t *ids, const auvid_can_frame_t *frame,
                                auvid_can_message_t *message)
{
    if (frame == NULL || message == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_can_kind_t kind = auvid_can_kind(ids, frame->id);
    if (kind == AUVID_CAN_KINDS) {
        return AUVID_UNUSED;
    }
    if (frame->length != AUVID_CAN_BYTES) {
        return AUVID_ERR_LENGTH;
    }
    if (frame->data[0] != auvid_can_crc(frame->data, AUVID_CAN_DATA_ID(kind))) {
        return AUVID_ERR_CHECKSUM;
    }
    auvid_can_message_t unpacked;
    auvid_zero(&unpacked, sizeof unpacked);
    unpacked.kind = kind;
    unpacked.counter = frame->data[1] & COUNTER_MASK;
    uint64_t bits = 0;
    for (int i = AUVID_CAN_BYTES - 1; i >= 0; --i) {
        bits = bits << 8 | frame->data[i];
    }
    const auvid_can_signal_t *signal = &auvid_can_signals[auvid_can_first[kind]];
    for (uint32_t bit = 1;; bit <<= 1, ++signal) {
        const auvid_can_type_t *type = &auvid_can_types[signal->type];
        uint32_t raw = (uint32_t)(bits >> signal->start) & UINT32_MAX >> type->unused;
        can_field_t field;
        if (!can_raw_is_valid(type, raw)) {
            return AUVID_ERR_RANGE;
        }
        unpacked.absent |= can_decode_signal(type, raw, &field) ? 0u : bit;
        memcpy((uint32_t *)&unpacked.as + signal->word, &field, can_type_size(type));
        if (signal->last) {
            break;
        }
    }
    *message = unpacked;
    return AUVID_OK;
}

uint64_t auvid_can_extend_us(uint64_t last_us, uint32_t wrapped_us)
{
    uint32_t ahead = wrapped_us - (uint32_t)last_us;
    uint32_t behind = 0u - ahead;
    return ahead < 0x80000000u || behind > last_us ? last_us + ahead : last_us - behind;
}
