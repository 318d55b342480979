#include "velocity_times.h"

#include "auvid/detail/recorder.h"

/* Longest time between samples of a slow velocity sensor [s]. */
#define LONGEST_S 1.5
/* A velocity comes nearly as late as the limit from this part of it on. */
#define NEARLY 0.8
/* Rows are between the velocities if they are closer together than this part of their times. */
#define BETWEEN 0.5
/* What a gap costs beside itself [s]: the smoothing of the metric needs cells on both sides, and a
 * row takes half a second. Measured on logs of 600 s with 10 to 50 % of the samples lost. */
#define EDGE_S 4.0
/* Most of the gaps. */
#define MOST 0.8

void velocity_times_row(velocity_times_t *times, const csv_row_t *row)
{
    double t = row->value[CSV_T], no_row_s = t - times->last_s;
    times->no_rows_s += times->rows > 0 && no_row_s > VELOCITY_ROW_GAP_S + 1e-6 ? no_row_s : 0.0;
    times->first_s = times->rows == 0 ? t : times->first_s;
    times->last_s = t;
    ++times->rows;
    if (!csv_has(row, CSV_NU) && !csv_has(row, CSV_NU + 1) && !csv_has(row, CSV_NU + 2)) {
        return;
    }
    double since = t - times->velocity_s - times->no_rows_s;
    if (times->any && since > 0.0) {
        /* upwards, so that a time of exactly the limit is not above it */
        double k = fmin(ceil(1e3 * since - 1e-3), VELOCITY_TIMES_CLASSES);
        ++times->count[(int)k];
        ++times->times;
        times->longer_s += k < VELOCITY_TIMES_CLASSES ? 0.0 : since;
        times->longest_s = fmax(times->longest_s, since);
    }
    times->velocity_s = t;
    times->no_rows_s = 0.0;
    times->any = true;
}

double velocity_times_usual(const velocity_times_t *times)
{
    size_t below = 0;
    for (int k = 0; k <= VELOCITY_TIMES_CLASSES; ++k) {
        below += times->count[k];
        if (2 * below > times->times) {
            return 1e-3 * k;
        }
    }
    return 0.0;
}

double velocity_times_row_s(const velocity_times_t *times)
{
    return (times->last_s - times->first_s) / fmax((double)times->rows, 1.0);
}

double velocity_gap_s(double usual_s, double row_s, double max_gap_s)
{
    double gap_s = velocity_row_gap_s(max_gap_s);
    if (!(row_s < BETWEEN * usual_s)) {
        return gap_s;
    }
    if (usual_s > NEARLY * gap_s) {
        gap_s = fmax(gap_s, fmin(1.5 * usual_s, LONGEST_S));
    }
    return max_gap_s > 0.0
               ? gap_s
               : fmax(gap_s, 1e-6 * auvid_recorder_gap((uint32_t)(1e6 * usual_s + 0.5)));
}

/* Number of the times above a limit; *sum_s: their sum. */
static size_t above(const velocity_times_t *times, double limit_s, double *sum_s)
{
    size_t gaps = 0;
    *sum_s = times->longer_s;
    for (int k = (int)(1e3 * limit_s + 0.5) + 1; k <= VELOCITY_TIMES_CLASSES; ++k) {
        gaps += times->count[k];
        *sum_s += k < VELOCITY_TIMES_CLASSES ? 1e-3 * k * times->count[k] : 0.0;
    }
    return gaps;
}

void velocity_times_gaps(const velocity_times_t *times, double gap_s, velocity_gaps_t *gaps)
{
    double span_s = times->last_s - times->first_s, sum_s, rest_s;
    *gaps = (velocity_gaps_t){.usual_s = velocity_times_usual(times),
                              .gaps = above(times, gap_s, &sum_s)};
    if (gaps->gaps == 0 || !(span_s > 0.0)) {
        return;
    }
    /* records between gaps at random are distributed exponentially: of them, what is longer than
     * the edges */
    double whole_s = fmax(span_s - sum_s, 1e-3);
    gaps->lost = 1.0 - whole_s / span_s * exp(-EDGE_S * (double)gaps->gaps / whole_s);
    for (int tenths = 1; tenths <= (int)(10.0 * VELOCITY_LONGEST_GAP_S); ++tenths) {
        double bridge_s = 0.1 * tenths;
        size_t left = above(times, bridge_s, &rest_s);
        if (bridge_s > gap_s && (double)left < (1.0 - MOST) * (double)gaps->gaps) {
            gaps->bridge_s = bridge_s;
            return;
        }
    }
}
