/*
 * The checkpoint: the address of a byte of the stream. The tables give it from the byte's position:
 * from the outermost struct inwards, find the row that contains the position, then the element of
 * the row.
 */
#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_math_internal.h"

typedef auvid_checkpoint_row_t row_t;
typedef auvid_checkpoint_sizes_t sizes_t;
typedef auvid_checkpoint_run_t run_t;

void auvid_checkpoint_measure(sizes_t *sizes, uint32_t parts)
{
    sizes->parts = parts;
    for (int t = 0; t < TABLE_COUNT; ++t) {
        const auvid_checkpoint_table_t *table = &auvid_checkpoint_table[t];
        uint32_t bytes = 0;
        for (uint32_t i = 0; i < table->rows; ++i) {
            bytes += auvid_checkpoint_bytes(sizes, &table->row[i]);
        }
        sizes->of[t] = bytes;
    }
}

run_t auvid_checkpoint_locate(const sizes_t *sizes, uint32_t at)
{
    run_t run = {TABLE_ROW, 0, 0, NULL, 0, 0};
    int root = 0;
    while (root < CHECKPOINT_ROOTS && at >= auvid_checkpoint_root_bytes(sizes, root)) {
        at -= auvid_checkpoint_root_bytes(sizes, root++);
    }
    if (root < CHECKPOINT_ROOTS) {
        run.root = auvid_checkpoint_root[root].table;
    } else {
        run.offset = at / sizes->of[TABLE_ROW] * sizeof(auvid_row_t);
        at %= sizes->of[TABLE_ROW];
    }
    int table = run.root;
    do {
        const row_t *row = auvid_checkpoint_table[table].row;
        for (;; ++row) {
            uint32_t bytes = auvid_checkpoint_bytes(sizes, row);
            if (at < bytes) {
                break;
            }
            at -= bytes;
        }
        uint32_t index = at / auvid_checkpoint_element(sizes, row);
        at %= auvid_checkpoint_element(sizes, row);
        run.offset += row->offset + (size_t)index * row->stride;
        run.row = row;
        run.count = row->count - index;
        run.table = (uint8_t)table;
        table = row->table;
    } while (run.row->width == 0);
    run.skip = at;
    return run;
}
