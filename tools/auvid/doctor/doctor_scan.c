/*
 * Sums over ranges of blocks, and the search for the range in which a slip explains the log best.
 */
#include <math.h>
#include <string.h>

#include "doctor.h"

static void add_sums(doctor_sums_t *to, const doctor_sums_t *block)
{
    double *a = (double *)to;
    const double *b = (const double *)block;
    for (size_t i = 0; i < sizeof *to / sizeof *a; ++i) {
        a[i] += b[i];
    }
}

void doctor_sum(const doctor_t *d, int first, int last, doctor_sums_t *sum)
{
    memset(sum, 0, sizeof *sum);
    for (int k = first; k <= last; ++k) {
        add_sums(sum, &d->block[k].sums);
    }
}

doctor_range_t doctor_scan(const doctor_t *d, doctor_score_t *score, int axis)
{
    doctor_range_t best = {.last = d->blocks - 1};
    for (int first = 0; first < d->blocks; ++first) {
        doctor_sums_t sum = {0};
        for (int last = first; last < d->blocks; ++last) {
            int which = 0;
            add_sums(&sum, &d->block[last].sums);
            double llr = score(d, &sum, axis, &which);
            bool longer = first == best.first && llr > 0.0 && !(llr < best.llr);
            if (llr > best.llr || longer) { /* also by a block that shows nothing */
                best = (doctor_range_t){llr, first, last, which};
            }
        }
    }
    return best;
}

double doctor_ratio(double windows, double without, double with)
{
    bool enough = windows >= DOCTOR_MIN_WINDOWS && with > 0.0;
    return enough ? 0.5 * windows * log(without / with) : 0.0;
}

bool doctor_overlap(const doctor_range_t *a, const doctor_range_t *b)
{
    return a->llr > 0.0 && b->llr > 0.0 && a->first <= b->last && b->first <= a->last;
}

double doctor_discord(const doctor_pair_t *p, double gain)
{
    double n = fmax(p->n, 1.0), aa = p->aa - p->a * p->a / n, bb = p->bb - p->b * p->b / n;
    double both = aa + gain * gain * bb, ab = p->ab - p->a * p->b / n;
    return both > 0.0 ? fmax(1.0 - 2.0 * gain * ab / both, 1e-9) : 1.0;
}

double doctor_correlation(const doctor_pair_t *p)
{
    double n = fmax(p->n, 1.0), aa = p->aa - p->a * p->a / n, bb = p->bb - p->b * p->b / n;
    double ab = p->ab - p->a * p->b / n;
    return aa * bb > 0.0 ? ab / sqrt(aa * bb) : 0.0;
}

bool doctor_sweep(double *m, int size, int k, double before)
{
    double pivot = m[k * size + k];
    if (!(pivot > 1e-9 * before)) {
        return false;
    }
    for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
            if (i != k && j != k) {
                m[i * size + j] -= m[i * size + k] * m[k * size + j] / pivot;
            }
        }
    }
    for (int i = 0; i < size; ++i) {
        if (i != k) {
            m[i * size + k] /= -pivot;
            m[k * size + i] /= pivot; /* of the last column: the coefficient */
        }
    }
    m[k * size + k] = 1.0 / pivot;
    return true;
}
