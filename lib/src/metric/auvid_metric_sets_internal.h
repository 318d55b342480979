/**
 * @file auvid_metric_sets_internal.h
 * Private: the ring of completed sets.
 * Ages start with 0 for the newest set that counts.
 */
#ifndef AUVID_METRIC_SETS_INTERNAL_H
#define AUVID_METRIC_SETS_INTERNAL_H

#include "auvid_metric_internal.h"

/** Binary digits of an entry of a stored R factor, without the sign; a double keeps all it has. */
enum { AUVID_METRIC_DIGITS = sizeof(auvid_packed_t) == sizeof(int16_t) ? 15 : 52 };

/** Number of sets of the ring that count. */
int auvid_metric_sets(const auvid_metric_t *m);

/** Index of the set that entered a ring of `sets` slots `back` sets before the last one; `stored`
 * sets have entered it. */
static inline uint32_t auvid_metric_ring_index(uint32_t stored, uint32_t sets, uint32_t back)
{
    return (stored + 2u * sets - 1u - back) % sets;
}

/** Index in the ring of the set of that age, age < auvid_metric_sets. */
int auvid_metric_slot(const auvid_metric_t *m, int age);

/** Returns the set of that age. */
const auvid_set_t *auvid_metric_set(const auvid_metric_t *m, int age);

/** Residual path: rows of the set of that age; age -1: rows of the set being recorded. */
static inline auvid_row_t *auvid_metric_rows(const auvid_metric_t *m, int age)
{
    uint32_t blocks = m->cfg.sets + 1u;
    uint32_t back = age < 0 ? 0u : (uint32_t)age + m->sets.from + 1u;
    uint32_t block = (m->sets.stored + 2u * blocks - back) % blocks;
    return m->cfg.rows + block * m->cfg.set_rows;
}

/** Pack m->rows.set.factor into *set. */
void auvid_metric_pack(const auvid_metric_t *m, auvid_set_t *set);

/** Write row i of one band of DoF j's R factor, of order n, to row[i..n-1]. */
void auvid_metric_unpack_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j,
                             int i, auvid_real_t *row);

/** Write row i of one band of DoF j's R factor in the order of the merged columns.
 * @param row [order] written from the returned column on
 * @return the first column that is not zero */
int auvid_metric_read_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i,
                          auvid_real_t *row);

/** Returns the sum of squares of DoF j's wrench about each set's mean, over the sets that excite
 * it; *rows: the rows of it. */
auvid_real_t auvid_metric_wrench_squares(const auvid_metric_t *m, int j, auvid_real_t *rows);

/** Take the rms residual [N, Nm] of an estimate from the sets in the ring. In later sets a DoF is
 * excited only if its wrench is well above it; see MIN_EXCITATION. Of a DoF in which the ring's own
 * sets are not above it either, any wrench above the threshold counts: a large residual of few sets
 * must not lock out all later ones. */
void auvid_metric_set_residual(auvid_metric_t *m, const auvid_real_t rms[AUVID_DOF_COUNT]);

/** Is no row stored of a cell at t_us, because the ring is held? */
static inline bool auvid_metric_drops_rows(const auvid_metric_t *m, uint64_t t_us)
{
    return m->sets.held && (m->sets.full || t_us > m->sets.until_us);
}

/** Residual path: may a row whose middle is at t_us be stored? */
static inline bool auvid_metric_takes_row(const auvid_metric_t *m, uint64_t t_us)
{
    return !m->sets.full && t_us >= m->sets.resume_us;
}

/** Record that the ring is held and the cells are now at t_us. @return is a row at t_us stored? */
static inline bool auvid_metric_takes_cell(auvid_metric_t *m, uint64_t t_us)
{
    m->sets.full = auvid_metric_drops_rows(m, t_us);
    return auvid_metric_takes_row(m, t_us);
}

/** While the ring is held: the newest `sets` sets of it do not count. */
static inline void auvid_metric_exclude(auvid_metric_t *m, uint8_t sets)
{
    m->sets.from = sets;
}

/** The oldest set that does not count counts from now on. */
static inline void auvid_metric_include_next(auvid_metric_t *m)
{
    --m->sets.from;
}

/** While the ring is held: sets that count are not overwritten if there are so many or fewer. */
static inline void auvid_metric_protect(auvid_metric_t *m, uint8_t sets)
{
    m->sets.least = sets;
}

/** Returns true once if a set has entered the ring while it is held. */
static inline bool auvid_metric_ring_changed(auvid_metric_t *m)
{
    bool changed = m->sets.changed;
    m->sets.changed = false;
    return changed;
}

/** A set has entered the ring: let auvid_metric_ring_changed return true once more. */
static inline void auvid_metric_change_ring(auvid_metric_t *m)
{
    m->sets.changed = true;
}

#endif
