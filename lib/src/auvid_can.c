/*
 * The codec: one loop over the tables that are generated from lib/can/auvid.dbc.
 *
 * Frame, little-endian bit numbers: 0-7 CRC, 8-11 counter, 12-63 signals.
 *   raw = round(value per_unit), value = raw / per_unit
 * per_unit and raw are integers, exact in float32, and |raw| <= 2^22: a value unpacked is the float
 * nearest to the decimal number of the DBC, and packs to the same raw again.
 */
#include "auvid/can.h"

#include <string.h>

#include "auvid_can_private.h"
#include "auvid_math.h"

#define COUNTER_MASK 15u
#define FIRST_PAYLOAD_BYTE 1
/* Finite in float32 with a margin for the decimal notation of the DBC. */
#define FLOAT_LIMIT AUVID_C(3.4e38)
#define FLOAT_ABSENT 0x7FC00000u

typedef union {
    auvid_real_t real;
    uint32_t integer;
} field_t;

/* CRC of the 16 values of a nibble in the upper half: polynomial x^8 + x^5 + x^3 + x^2 + x + 1. */
static const uint8_t crc_nibble[16] = {0x00, 0x2F, 0x5E, 0x71, 0xBC, 0x93, 0xE2, 0xCD,
                                       0x57, 0x78, 0x09, 0x26, 0xEB, 0xC4, 0xB5, 0x9A};

static uint32_t crc_step(uint32_t crc, uint32_t byte)
{
    crc ^= byte;
    crc = (crc << 4 & 0xFFu) ^ crc_nibble[crc >> 4];
    return (crc << 4 & 0xFFu) ^ crc_nibble[crc >> 4];
}

uint8_t auvid_can_crc(const uint8_t data[AUVID_CAN_BYTES], uint8_t data_id)
{
    uint32_t crc = 0xFFu;
    for (int i = FIRST_PAYLOAD_BYTE; i < AUVID_CAN_BYTES; ++i) {
        crc = crc_step(crc, data[i]);
    }
    return (uint8_t)(crc_step(crc, data_id) ^ 0xFFu);
}

/* The lower `length` bits, 1..32. */
static uint32_t mask(uint32_t length)
{
    return 0xFFFFFFFFu >> ((32u - length) & 31u);
}

static uint32_t sign_bit(uint32_t length)
{
    return (mask(length) >> 1) + 1u;
}

/* A bit at a time would be shorter, but four times slower. */
static void insert(uint8_t *data, uint32_t bit, uint32_t length, uint32_t raw)
{
    raw &= mask(length);
    for (uint32_t end = bit + length; bit < end;) {
        uint32_t shift = bit & 7u;
        data[bit >> 3] = (uint8_t)(data[bit >> 3] | raw << shift);
        raw >>= 8u - shift;
        bit += 8u - shift;
    }
}

static uint32_t extract(const uint8_t *data, uint32_t bit, uint32_t length)
{
    uint32_t raw = 0;
    for (uint32_t at = 0; at < length;) {
        uint32_t shift = (bit + at) & 7u;
        raw |= (uint32_t)(data[(bit + at) >> 3] >> shift) << at;
        at += 8u - shift;
    }
    return raw & mask(length);
}

/* Largest raw value of a fixed-point signal or an integer. */
static uint32_t largest(const auvid_can_type_t *type)
{
    return type->limit != 0 ? type->limit
                            : mask((uint32_t)type->length - (type->kind != AUVID_CAN_TYPE_UINT));
}

/* The smallest is 0, but the same as the largest where that is the only one. */
static uint32_t smallest_integer(const auvid_can_type_t *type, uint32_t high)
{
    return type->special != 0 ? high : 0u;
}

/* Limits of value per_unit. */
static auvid_real_t highest(const auvid_can_type_t *type)
{
    return type->kind == AUVID_CAN_TYPE_FLOAT ? FLOAT_LIMIT : (auvid_real_t)largest(type);
}

static auvid_real_t lowest(const auvid_can_type_t *type, auvid_real_t high)
{
    return type->special != 0 ? AUVID_C(0.0) : -high;
}

/* Half away from zero, to within the rounding of the sum. */
static int32_t round_nearest(auvid_real_t x)
{
    return (int32_t)(x < AUVID_C(0.0) ? x - AUVID_C(0.5) : x + AUVID_C(0.5));
}

/* @return AUVID_OK, AUVID_SATURATED, AUVID_ERR_NOT_FINITE */
static auvid_status_t encode(const auvid_can_type_t *type, field_t field, bool absent,
                             uint32_t *raw)
{
    if (type->kind == AUVID_CAN_TYPE_UINT) {
        uint32_t high = largest(type);
        uint32_t low = smallest_integer(type, high);
        uint32_t x = field.integer;
        *raw = x < low ? low : (x > high ? high : x);
        return *raw != x ? AUVID_SATURATED : AUVID_OK;
    }
    bool is_float = type->kind == AUVID_CAN_TYPE_FLOAT;
    *raw = is_float ? FLOAT_ABSENT : sign_bit(type->length);
    if (absent) {
        return AUVID_OK;
    }
    auvid_real_t x = field.real * (auvid_real_t)type->per_unit;
    if (x != x) {
        return AUVID_ERR_NOT_FINITE;
    }
    auvid_real_t high = highest(type);
    auvid_real_t y = auvid_clamp(x, lowest(type, high), high);
    float single = (float)y;
    if (is_float) {
        memcpy(raw, &single, sizeof single);
    } else {
        *raw = (uint32_t)round_nearest(y);
    }
    /* Less than half a step beyond the limit is rounding: a limit unpacked may be there. */
    return auvid_abs(x - y) >= AUVID_C(0.5) ? AUVID_SATURATED : AUVID_OK;
}

/* @return false: outside the signal's range. *absent: the value is not available. */
static bool decode(const auvid_can_type_t *type, uint32_t raw, field_t *field, bool *absent)
{
    *absent = false;
    if (type->kind == AUVID_CAN_TYPE_UINT) {
        uint32_t high = largest(type);
        field->integer = raw;
        return raw >= smallest_integer(type, high) && raw <= high;
    }
    bool is_float = type->kind == AUVID_CAN_TYPE_FLOAT;
    uint32_t sign = sign_bit(type->length);
    *absent = raw == (is_float ? FLOAT_ABSENT : sign);
    raw = *absent ? FLOAT_ABSENT : raw;
    float single;
    memcpy(&single, &raw, sizeof single);
    auvid_real_t x = is_float || *absent ? (auvid_real_t)single
                                         : (auvid_real_t)((int32_t)(raw ^ sign) - (int32_t)sign);
    auvid_real_t high = highest(type);
    field->real = x / (auvid_real_t)type->per_unit;
    return *absent || (x >= lowest(type, high) && x <= high);
}

/* Bytes of a member: real numbers may be longer than integers. */
static size_t size_of(const auvid_can_type_t *type)
{
    return type->kind == AUVID_CAN_TYPE_UINT ? sizeof(uint32_t) : sizeof(auvid_real_t);
}

void auvid_can_ids_defaults(auvid_can_ids_t *ids)
{
    if (ids != NULL) {
        ids->fast = AUVID_CAN_FAST_BASE;
        ids->slow = AUVID_CAN_SLOW_BASE;
    }
}

static const auvid_can_ids_t default_ids = {AUVID_CAN_FAST_BASE, AUVID_CAN_SLOW_BASE};

auvid_status_t auvid_can_ids_check(const auvid_can_ids_t *ids)
{
    if (ids == NULL) {
        return AUVID_ERR_NULL;
    }
    uint32_t fast = ids->fast;
    uint32_t slow = ids->slow;
    bool fit = fast + AUVID_CAN_FAST_KINDS <= 0x800u && slow + AUVID_CAN_SLOW_KINDS <= 0x800u;
    bool apart = fast + AUVID_CAN_FAST_KINDS <= slow || slow + AUVID_CAN_SLOW_KINDS <= fast;
    return fit && apart ? AUVID_OK : AUVID_ERR_RANGE;
}

auvid_can_kind_t auvid_can_kind(const auvid_can_ids_t *ids, uint16_t id)
{
    ids = ids != NULL ? ids : &default_ids;
    uint32_t fast = (uint32_t)id - ids->fast;
    uint32_t slow = (uint32_t)id - ids->slow;
    if (fast < AUVID_CAN_FAST_KINDS) {
        return (auvid_can_kind_t)fast;
    }
    return slow < AUVID_CAN_SLOW_KINDS ? (auvid_can_kind_t)(slow + AUVID_CAN_FAST_KINDS)
                                       : AUVID_CAN_KINDS;
}

uint16_t auvid_can_id(const auvid_can_ids_t *ids, auvid_can_kind_t kind)
{
    ids = ids != NULL ? ids : &default_ids;
    if ((uint32_t)kind >= AUVID_CAN_KINDS) {
        return UINT16_MAX;
    }
    uint32_t base = (uint32_t)kind < AUVID_CAN_FAST_KINDS
                        ? ids->fast
                        : (uint32_t)ids->slow - AUVID_CAN_FAST_KINDS;
    return (uint16_t)(base + (uint32_t)kind);
}

uint32_t auvid_can_cycle_us(auvid_can_kind_t kind)
{
    return (uint32_t)kind < AUVID_CAN_KINDS ? auvid_can_cycles_ms[kind] * 1000u : 0u;
}

auvid_status_t auvid_can_sender_init(auvid_can_sender_t *sender, const auvid_can_ids_t *ids)
{
    ids = ids != NULL ? ids : &default_ids;
    auvid_status_t status = sender == NULL ? AUVID_ERR_NULL : auvid_can_ids_check(ids);
    if (status == AUVID_OK) {
        memset(sender, 0, sizeof *sender);
        sender->ids = *ids;
    }
    return status;
}

/* The signals of a message into data. @return as encode. */
static auvid_status_t encode_all(const auvid_can_message_t *message, uint8_t *data,
                                 uint32_t *saturated)
{
    const auvid_can_entry_t *entry = &auvid_can_entries[message->kind];
    uint32_t absent = message->absent;
    auvid_status_t result = AUVID_OK;
    for (const auvid_can_signal_t *signal = &auvid_can_signals[entry->first];
         signal < &auvid_can_signals[entry->first + entry->signals]; ++signal) {
        const auvid_can_type_t *type = &auvid_can_types[signal->type];
        field_t field;
        uint32_t raw;
        memcpy(&field, (const uint8_t *)&message->as + signal->offset, size_of(type));
        auvid_status_t status = encode(type, field, (absent & 1u) != 0, &raw);
        if (status < 0) {
            return status;
        }
        if (status == AUVID_SATURATED) {
            ++*saturated;
            result = AUVID_SATURATED;
        }
        insert(data, signal->start, type->length, raw);
        absent >>= 1;
    }
    return result;
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
    uint8_t data[AUVID_CAN_BYTES] = {0};
    uint32_t saturated = sender->saturated;
    bool known = (uint32_t)message->kind < AUVID_CAN_KINDS;
    auvid_status_t status = known ? encode_all(message, data, &saturated) : AUVID_ERR_RANGE;
    if (status < 0) {
        ++sender->refused;
        return status;
    }
    uint8_t *counter = &sender->counter[message->kind];
    data[1] = (uint8_t)(data[1] | (*counter & COUNTER_MASK));
    data[0] = auvid_can_crc(data, auvid_can_entries[message->kind].data_id);
    *counter = (*counter + 1u) & COUNTER_MASK;
    sender->saturated = saturated;
    frame->id = auvid_can_id(&sender->ids, message->kind);
    frame->length = AUVID_CAN_BYTES;
    memcpy(frame->data, data, sizeof data);
    return status;
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
    const auvid_can_entry_t *entry = &auvid_can_entries[kind];
    if (frame->data[0] != auvid_can_crc(frame->data, entry->data_id)) {
        return AUVID_ERR_CHECKSUM;
    }
    auvid_can_message_t read;
    memset(&read, 0, sizeof read);
    read.kind = kind;
    read.counter = frame->data[1] & COUNTER_MASK;
    uint32_t bit = 1;
    for (const auvid_can_signal_t *signal = &auvid_can_signals[entry->first];
         signal < &auvid_can_signals[entry->first + entry->signals]; ++signal) {
        const auvid_can_type_t *type = &auvid_can_types[signal->type];
        field_t field;
        uint32_t raw = extract(frame->data, signal->start, type->length);
        bool absent;
        if (!decode(type, raw, &field, &absent)) {
            return AUVID_ERR_RANGE;
        }
        read.absent |= absent ? bit : 0u;
        memcpy((uint8_t *)&read.as + signal->offset, &field, size_of(type));
        bit <<= 1;
    }
    *message = read;
    return AUVID_OK;
}

uint64_t auvid_can_extend_us(uint64_t last_us, uint32_t wrapped_us)
{
    uint32_t ahead = wrapped_us - (uint32_t)last_us;
    return ahead < 0x80000000u ? last_us + ahead : last_us - (0u - ahead);
}
