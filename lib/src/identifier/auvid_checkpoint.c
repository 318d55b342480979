/*
 * The checkpoint. Little-endian words, then the members listed in the tables of
 * auvid_checkpoint_layout.c, in their order: of the identifier, of what is attached to it, and for
 * a model on the residual path its rows:
 *
 *     byte 0  "avc1"
 *          4  checksum of the tables and of the library's version
 *          8  checksum of the model
 *         12  parts that are present, PART_..
 *         16  rows
 *         20  number of bytes, all
 *         24  the identifier, the acting half, the adaptive excitation, the simulated
 *             velocity, the rows
 *   last four CRC-32 of all bytes before
 *
 * The tables give the address of each byte of the stream from its position
 * (auvid_checkpoint_locate.c), so the cursor holds only its position.
 */
#include "auvid/checkpoint.h"

#include <string.h>

#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_checksum_internal.h"
#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_internal.h"

#define HEAD_MAGIC 0x31637661u

enum { HEAD_LAYOUT = 4, HEAD_MODEL = 8, HEAD_PARTS = 12, HEAD_ROWS = 16, HEAD_BYTES = 20 };

typedef auvid_checkpoint_row_t row_t;

typedef auvid_checkpoint_sizes_t sizes_t;
typedef auvid_checkpoint_run_t run_t;

/* ---- the header ---- */

/* Of the library's version and the tables, without offsets, which a compiler chooses. */
static uint32_t checkpoint_layout_checksum(void)
{
    uint32_t c = auvid_checksum_word(
        UINT32_MAX, AUVID_VERSION_MAJOR << 16 | AUVID_VERSION_MINOR << 8 | AUVID_VERSION_PATCH);
    for (int t = 0; t < TABLE_COUNT; ++t) {
        const auvid_checkpoint_table_t *table = &auvid_checkpoint_table[t];
        for (uint32_t i = 0; i < table->rows; ++i) {
            const row_t *row = &table->row[i];
            const uint8_t kind[] = {row->width, row->table, row->parts};
            c = auvid_checksum_word(auvid_checksum(c, kind, sizeof kind), row->count);
        }
    }
    return c;
}

static bool checkpoint_adapts(const auvid_identifier_t *id)
{
    return id->actuation != NULL && id->actuation->shape != NULL;
}

static uint32_t checkpoint_parts(const auvid_identifier_t *id)
{
    uint32_t parts = auvid_metric_stores_rows(&id->metric) ? PART_RESIDUAL : 0u;
    parts |= id->prediction != NULL && id->prediction->vehicle != NULL ? PART_SIMULATED : 0u;
    parts |= id->actuation != NULL ? PART_ACTUATION : 0u;
    parts |= checkpoint_adapts(id) ? PART_ADAPTIVE : 0u;
    if (id->phase == AUVID_WORK_CONFIDENCE) {
        parts |= PART_CONFIDENCE;
    } else if (id->searching) {
        bool global = id->optimizer.state < AUVID_OPTIMIZER_START;
        parts |= global ? PART_GLOBAL : PART_LOCAL;
    } else if (id->phase == AUVID_WORK_LINEARISE) {
        parts |= PART_OPTIMUM;
    }
    return parts;
}

static uint32_t checkpoint_rows(const auvid_identifier_t *id)
{
    const auvid_metric_config_t *cfg = &id->metric.cfg;
    return auvid_metric_stores_rows(&id->metric) ? (cfg->sets + 1u) * cfg->set_rows : 0u;
}

static uint32_t checkpoint_model_checksum(const auvid_identifier_t *id)
{
    uint32_t c = auvid_checksum_of_model(&id->metric.cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        c = auvid_checksum_word(c, id->metric.layout.columns[j]);
    }
    return auvid_checksum_word(c, auvid_metric_stores_rows(&id->metric));
}

/* Write the head of a checkpoint of *id that has these parts. */
static void checkpoint_write_head(const auvid_identifier_t *id, uint32_t parts, sizes_t *sizes,
                                  uint8_t *head)
{
    uint32_t rows = checkpoint_rows(id), bytes = AUVID_CHECKPOINT_HEAD + AUVID_CHECKPOINT_TAIL;
    auvid_checkpoint_measure(sizes, parts);
    for (int root = 0; root < CHECKPOINT_ROOTS; ++root) {
        bytes += auvid_checkpoint_root_bytes(sizes, root);
    }
    auvid_put_word(head, HEAD_MAGIC);
    auvid_put_word(head + HEAD_LAYOUT, checkpoint_layout_checksum());
    auvid_put_word(head + HEAD_MODEL, checkpoint_model_checksum(id));
    auvid_put_word(head + HEAD_PARTS, parts);
    auvid_put_word(head + HEAD_ROWS, rows);
    auvid_put_word(head + HEAD_BYTES, bytes + rows * sizes->of[TABLE_ROW]);
}

/* ---- the body ---- */

/* The memory of an outermost struct other than the identifier. */
static void *checkpoint_attached(const auvid_identifier_t *id, uint8_t root)
{
    return root == TABLE_ACTUATION    ? (void *)id->actuation
           : root == TABLE_ADAPTIVE   ? id->actuation->shape_context
           : root == TABLE_VALIDATION ? (void *)id->prediction
                                      : (void *)id->metric.cfg.rows;
}

/* Save up to max_bytes bytes of the body from `at` on. @return how many, >= 1 */
static uint32_t checkpoint_save(const auvid_identifier_t *id, const sizes_t *sizes, uint32_t at,
                                uint32_t max_bytes, uint8_t *to)
{
    run_t run = auvid_checkpoint_locate(sizes, at);
    const row_t *row = run.row;
    const void *from = run.root == TABLE_IDENTIFIER ? id : checkpoint_attached(id, run.root);
    const uint8_t *memory = (const uint8_t *)from + run.offset;
    uint32_t done = 0;
    for (uint32_t i = 0; i < run.count && done < max_bytes; ++i, memory += row->stride) {
        for (uint32_t k = run.skip; k < row->width && done < max_bytes; ++k, ++done) {
            to[done] = memory[auvid_checkpoint_byte(row->stride, k)];
        }
        run.skip = 0;
    }
    return done;
}

/* Load up to max_bytes bytes of the body from `at` on, whole scalars. @return how many, >= 1 */
static AUVID_NOINLINE uint32_t checkpoint_load(auvid_identifier_t *id, const sizes_t *sizes,
                                               uint32_t at, uint32_t max_bytes, const uint8_t *from)
{
    run_t run = auvid_checkpoint_locate(sizes, at);
    const row_t *row = run.row;
    void *to = run.root == TABLE_IDENTIFIER ? id : checkpoint_attached(id, run.root);
    uint8_t *memory = (uint8_t *)to + run.offset;
    uint32_t done = 0;
    for (uint32_t i = 0; i < run.count && done < max_bytes; ++i, memory += row->stride) {
        memset(memory, 0, row->stride); /* an enumeration is wider than in the stream */
        for (uint32_t k = run.skip; k < row->width && done < max_bytes; ++k, ++done) {
            memory[auvid_checkpoint_byte(row->stride, k)] = from[done];
        }
        run.skip = 0;
    }
    return done;
}

/* ---- saving ---- */

auvid_status_t auvid_checkpoint_begin(auvid_checkpoint_t *cursor, const auvid_identifier_t *id)
{
    if (cursor == NULL || id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    sizes_t sizes;
    checkpoint_write_head(id, checkpoint_parts(id), &sizes, cursor->head);
    cursor->id = id;
    cursor->t_us = id->t_us;
    cursor->bytes = auvid_get_word(cursor->head + HEAD_BYTES);
    cursor->at = 0;
    cursor->checksum = UINT32_MAX;
    return AUVID_OK;
}

auvid_status_t auvid_checkpoint_next(auvid_checkpoint_t *cursor, uint8_t *chunk, uint32_t *bytes)
{
    if (cursor == NULL || chunk == NULL || bytes == NULL) {
        return AUVID_ERR_NULL;
    }
    uint32_t room = *bytes, end = cursor->bytes - AUVID_CHECKPOINT_TAIL;
    *bytes = 0;
    if (cursor->id == NULL || cursor->t_us != cursor->id->t_us) {
        return AUVID_ERR_STATE;
    }
    sizes_t sizes;
    auvid_checkpoint_measure(&sizes, cursor->head[HEAD_PARTS]);
    while (*bytes < room && cursor->at < cursor->bytes) {
        uint8_t *to = chunk + *bytes;
        uint32_t at = cursor->at, done = 1;
        if (at < AUVID_CHECKPOINT_HEAD) {
            *to = cursor->head[at];
        } else if (at >= end) {
            *to = (uint8_t)(~cursor->checksum >> 8 * (at - end));
        } else {
            uint32_t left = end - at, max_bytes = room - *bytes;
            done = checkpoint_save(cursor->id, &sizes, at - AUVID_CHECKPOINT_HEAD,
                                   max_bytes < left ? max_bytes : left, to);
        }
        cursor->checksum = at < end ? auvid_checksum(cursor->checksum, to, done) : cursor->checksum;
        cursor->at += done;
        *bytes += done;
    }
    return cursor->at < cursor->bytes ? AUVID_PENDING : AUVID_OK;
}

/* ---- restoring ---- */

/* Is it an undamaged checkpoint of this library and of this identifier's model? */
static auvid_status_t checkpoint_check(const auvid_identifier_t *id, const uint8_t *checkpoint,
                                       uint32_t bytes, sizes_t *sizes)
{
    uint8_t expected[AUVID_CHECKPOINT_HEAD];
    uint32_t end = bytes - AUVID_CHECKPOINT_TAIL;
    if (bytes < AUVID_CHECKPOINT_HEAD + AUVID_CHECKPOINT_TAIL ||
        auvid_get_word(checkpoint) != HEAD_MAGIC ||
        auvid_get_word(checkpoint + end) != ~auvid_checksum(UINT32_MAX, checkpoint, end)) {
        return AUVID_ERR_CHECKSUM;
    }
    checkpoint_write_head(id, auvid_get_word(checkpoint + HEAD_PARTS), sizes, expected);
    if (memcmp(expected + HEAD_LAYOUT, checkpoint + HEAD_LAYOUT, 4) != 0) {
        return AUVID_ERR_SIZE;
    }
    if (memcmp(expected + HEAD_MODEL, checkpoint + HEAD_MODEL, 4) != 0) {
        return AUVID_ERR_MODEL;
    }
    if (memcmp(expected + HEAD_ROWS, checkpoint + HEAD_ROWS, 4) != 0) {
        return AUVID_ERR_SIZE;
    }
    bool whole = auvid_get_word(expected + HEAD_BYTES) == bytes &&
                 auvid_get_word(checkpoint + HEAD_BYTES) == bytes;
    const uint32_t attached = PART_ACTUATION | PART_ADAPTIVE;
    bool same = ((sizes->parts ^ checkpoint_parts(id)) & attached) == 0 &&
                ((sizes->parts & PART_SIMULATED) == 0 || id->prediction != NULL);
    return !whole ? AUVID_ERR_CHECKSUM : same ? AUVID_OK : AUVID_ERR_STATE;
}

auvid_status_t auvid_checkpoint_resume(auvid_identifier_t *id, const uint8_t *checkpoint,
                                       uint32_t bytes)
{
    if (id == NULL || checkpoint == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    sizes_t sizes;
    auvid_status_t status = checkpoint_check(id, checkpoint, bytes, &sizes);
    if (status != AUVID_OK) {
        return status;
    }
    auvid_metric_t *m = &id->metric;
    uint32_t body = bytes - AUVID_CHECKPOINT_HEAD - AUVID_CHECKPOINT_TAIL;
    status = auvid_checkpoint_validate(id, &sizes, checkpoint + AUVID_CHECKPOINT_HEAD, body);
    if (status != AUVID_OK) {
        return status;
    }
    for (uint32_t at = 0; at < body;) {
        at += checkpoint_load(id, &sizes, at, body - at, checkpoint + AUVID_CHECKPOINT_HEAD + at);
    }
    if (id->prediction != NULL) {
        bool simulated = (sizes.parts & PART_SIMULATED) != 0;
        id->prediction->vehicle = simulated ? identifier_vehicle(id) : NULL;
    }
    (void)auvid_metric_set_prior(m, &m->prior); /* sets the function pointer */
    return AUVID_OK;
}

auvid_status_t auvid_checkpoint_restore(auvid_identifier_t *id, const uint8_t *checkpoint,
                                        uint32_t bytes)
{
    auvid_status_t status = auvid_checkpoint_resume(id, checkpoint, bytes);
    auvid_actuation_t *a = status == AUVID_OK ? id->actuation : NULL;
    if (a != NULL) {
        if (a->guard.state != AUVID_GUARD_DONE && a->guard.state != AUVID_GUARD_ABORTED) {
            (void)auvid_guard_disarm(&a->guard);
        }
        a->excitation.running = a->excitation.stopping = a->starting = false;
    }
    return status;
}
