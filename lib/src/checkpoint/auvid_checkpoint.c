/*
 * The checkpoint. Little-endian words, then the blocks of auvid_checkpoint_layout.c as they are in
 * memory: of the identifier, of what is attached to it, and for a model on the residual path its
 * rows:
 *
 *     byte 0  "avc2"
 *          4  checksum of the layout and of the library's version
 *          8  checksum of the model
 *         12  checksum of the configuration
 *         16  parts that are present, PART_..
 *         20  rows
 *         24  number of bytes, all
 *         28  the blocks
 *   last four CRC-32 of all bytes before
 */
#include "auvid/checkpoint.h"

#include <string.h>

#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_checksum_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_internal.h"

#define HEAD_MAGIC 0x32637661u

enum {
    HEAD_LAYOUT = 4,
    HEAD_MODEL = 8,
    HEAD_CONFIGURATION = 12,
    HEAD_PARTS = 16,
    HEAD_ROWS = 20,
    HEAD_BYTES = 24
};

typedef auvid_checkpoint_block_t block_t;
typedef auvid_checkpoint_view_t view_t;

/* ---- the memory ---- */

static auvid_instruments_t *checkpoint_instruments(const auvid_identifier_t *id)
{
    return id->attached.uncertain != NULL ? id->attached.uncertain->instruments : NULL;
}

/* The memory of a root other than the identifier. */
static void *checkpoint_attached(const auvid_identifier_t *id, uint8_t root)
{
    return root == ROOT_ACTUATION     ? (void *)id->actuation
           : root == ROOT_ADAPTIVE    ? id->actuation->shape_context
           : root == ROOT_CHANGE      ? (void *)id->attached.change
           : root == ROOT_PRIOR       ? id->metric.prior_context
           : root == ROOT_PREDICTION  ? (void *)id->attached.prediction
           : root == ROOT_UNCERTAIN   ? (void *)id->attached.uncertain
           : root == ROOT_INSTRUMENTS ? (void *)checkpoint_instruments(id)
                                      : (void *)id->metric.cfg.rows;
}

/* The memory of any root, to read it. */
static const uint8_t *checkpoint_memory(const auvid_identifier_t *id, uint8_t root)
{
    return root == ROOT_IDENTIFIER ? (const uint8_t *)id : checkpoint_attached(id, root);
}

/* ---- the header ---- */

/* Of the library's version, of the layout with default sizes, and of these sizes. */
static uint32_t checkpoint_layout_checksum(void)
{
    uint32_t c = auvid_checksum_word(
        UINT32_MAX, AUVID_VERSION_MAJOR << 16 | AUVID_VERSION_MINOR << 8 | AUVID_VERSION_PATCH);
    c = auvid_checksum_word(c, AUVID_CHECKPOINT_LAYOUT);
    for (int k = 0; k < CHECKPOINT_BLOCKS; ++k) {
        c = auvid_checksum_word(c, auvid_checkpoint_block[k].bytes);
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
    parts |= id->attached.prediction != NULL && id->attached.prediction->vehicle != NULL
                 ? PART_SIMULATED
                 : 0u;
    parts |= id->actuation != NULL ? PART_ACTUATION : 0u;
    parts |= id->attached.change != NULL ? PART_CHANGE : 0u;
    parts |= id->metric.prior != NULL ? PART_PRIOR : 0u;
    parts |= checkpoint_adapts(id) ? PART_ADAPTIVE : 0u;
    parts |= id->attached.uncertain != NULL ? PART_UNCERTAIN : 0u;
    parts |= checkpoint_instruments(id) != NULL ? PART_INSTRUMENTS : 0u;
    bool linearises =
        id->work.phase == AUVID_WORK_PREPARE || id->work.phase == AUVID_WORK_LINEARISE;
    if ((parts & PART_RESIDUAL) != 0 && linearises) {
        parts |= PART_WINDOWS;
    } else if ((parts & PART_RESIDUAL) != 0 && id->work.phase == AUVID_WORK_MERGE &&
               id->work.spent > 0 && !id->work.searching) {
        parts |= PART_NEWTON;
    } else if (id->work.phase == AUVID_WORK_CONFIDENCE) {
        parts |= PART_CONFIDENCE;
    } else if (id->work.searching) {
        bool global = id->optimizer.state < AUVID_OPTIMIZER_START;
        parts |= global ? PART_GLOBAL : PART_LOCAL;
    } else if (id->work.seeks_optimum) {
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

static uint32_t checkpoint_configuration_checksum(const auvid_identifier_t *id)
{
    const auvid_uncertain_t *u = id->attached.uncertain;
    uint32_t c = UINT32_MAX;
    for (int k = 0; k < CHECKPOINT_CONFIGURED; ++k) {
        const block_t *block = &auvid_checkpoint_configured[k];
        const uint8_t *memory = checkpoint_memory(id, block->root);
        c = memory != NULL ? auvid_checksum(c, memory + block->offset, block->bytes) : c;
    }
    for (int i = 0; u != NULL && i < u->allocation->cfg.thrusters; ++i) {
        const auvid_thruster_t *t = &u->allocation->cfg.thruster[i];
        c = auvid_checksum(c, (const uint8_t *)t, offsetof(auvid_thruster_t, law));
    }
    return c;
}

/* Write the head of a checkpoint of *id that has these parts. */
static void checkpoint_write_head(const auvid_identifier_t *id, uint32_t parts, uint8_t *head)
{
    const view_t view = {.parts = parts, .rows = checkpoint_rows(id)};
    uint32_t bytes = AUVID_CHECKPOINT_HEAD + AUVID_CHECKPOINT_TAIL;
    for (int k = 0; k < CHECKPOINT_BLOCKS; ++k) {
        bytes += auvid_checkpoint_bytes(&view, &auvid_checkpoint_block[k]);
    }
    auvid_put_word(head, HEAD_MAGIC);
    auvid_put_word(head + HEAD_LAYOUT, checkpoint_layout_checksum());
    auvid_put_word(head + HEAD_MODEL, checkpoint_model_checksum(id));
    auvid_put_word(head + HEAD_CONFIGURATION, checkpoint_configuration_checksum(id));
    auvid_put_word(head + HEAD_PARTS, parts);
    auvid_put_word(head + HEAD_ROWS, view.rows);
    auvid_put_word(head + HEAD_BYTES, bytes);
}

/* The rest of the block that contains byte `at` of the body. */
static block_t checkpoint_locate(const view_t *v, uint32_t at)
{
    const block_t *block = auvid_checkpoint_block;
    for (; at >= auvid_checkpoint_bytes(v, block); ++block) {
        at -= auvid_checkpoint_bytes(v, block);
    }
    block_t rest = *block;
    rest.offset += at;
    rest.bytes = auvid_checkpoint_bytes(v, block) - at;
    return rest;
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
    checkpoint_write_head(id, checkpoint_parts(id), cursor->head);
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
    const view_t view = {.parts = auvid_get_word(cursor->head + HEAD_PARTS),
                         .rows = auvid_get_word(cursor->head + HEAD_ROWS)};
    while (*bytes < room && cursor->at < cursor->bytes) {
        uint8_t *to = chunk + *bytes;
        uint32_t at = cursor->at, done = 1;
        if (at < AUVID_CHECKPOINT_HEAD) {
            *to = cursor->head[at];
        } else if (at >= end) {
            *to = (uint8_t)(~cursor->checksum >> 8 * (at - end));
        } else {
            const block_t from = checkpoint_locate(&view, at - AUVID_CHECKPOINT_HEAD);
            done = from.bytes < room - *bytes ? from.bytes : room - *bytes;
            memcpy(to, checkpoint_memory(cursor->id, from.root) + from.offset, done);
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
                                       uint32_t bytes, view_t *v)
{
    uint8_t expected[AUVID_CHECKPOINT_HEAD];
    uint32_t end = bytes - AUVID_CHECKPOINT_TAIL;
    if (bytes < AUVID_CHECKPOINT_HEAD + AUVID_CHECKPOINT_TAIL ||
        auvid_get_word(checkpoint) != HEAD_MAGIC ||
        auvid_get_word(checkpoint + end) != ~auvid_checksum(UINT32_MAX, checkpoint, end)) {
        return AUVID_ERR_CHECKSUM;
    }
    v->parts = auvid_get_word(checkpoint + HEAD_PARTS);
    v->rows = checkpoint_rows(id);
    v->body = checkpoint + AUVID_CHECKPOINT_HEAD;
    checkpoint_write_head(id, v->parts, expected);
    if (memcmp(expected + HEAD_LAYOUT, checkpoint + HEAD_LAYOUT, 4) != 0) {
        return AUVID_ERR_SIZE;
    }
    if (memcmp(expected + HEAD_MODEL, checkpoint + HEAD_MODEL, 4) != 0) {
        return AUVID_ERR_MODEL;
    }
    if (memcmp(expected + HEAD_ROWS, checkpoint + HEAD_ROWS, 4) != 0) {
        return AUVID_ERR_SIZE;
    }
    const uint32_t attached = PART_ACTUATION | PART_ADAPTIVE | PART_CHANGE | PART_PRIOR |
                              PART_UNCERTAIN | PART_INSTRUMENTS;
    const uint32_t present = checkpoint_parts(id);
    if ((v->parts & ~present & attached) != 0 ||
        ((v->parts & PART_SIMULATED) != 0 && id->attached.prediction == NULL)) {
        return AUVID_ERR_DETACHED;
    }
    if ((present & ~v->parts & attached) != 0) {
        return AUVID_ERR_ATTACHED;
    }
    if (memcmp(expected + HEAD_CONFIGURATION, checkpoint + HEAD_CONFIGURATION, 4) != 0) {
        return AUVID_ERR_CONFIGURATION;
    }
    bool whole = auvid_get_word(expected + HEAD_BYTES) == bytes &&
                 auvid_get_word(checkpoint + HEAD_BYTES) == bytes;
    return whole ? AUVID_OK : AUVID_ERR_CHECKSUM;
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
    view_t view;
    auvid_status_t status = checkpoint_check(id, checkpoint, bytes, &view);
    if (status != AUVID_OK) {
        return status;
    }
    status = auvid_checkpoint_validate(id, &view);
    if (status != AUVID_OK) {
        return status;
    }
    uint32_t end = bytes - AUVID_CHECKPOINT_HEAD - AUVID_CHECKPOINT_TAIL;
    for (uint32_t at = 0; at < end;) {
        const block_t to = checkpoint_locate(&view, at);
        void *root = to.root == ROOT_IDENTIFIER ? id : checkpoint_attached(id, to.root);
        memcpy((uint8_t *)root + to.offset, view.body + at, to.bytes);
        at += to.bytes;
    }
    auvid_metric_order_columns(&id->metric);
    if (id->attached.prediction != NULL) {
        bool simulated = (view.parts & PART_SIMULATED) != 0;
        id->attached.prediction->vehicle = simulated ? identifier_vehicle(id) : NULL;
    }
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
