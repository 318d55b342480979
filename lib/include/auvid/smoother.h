/**
 * @file smoother.h
 * Streaming Savitzky-Golay smoother. Least squares fits a polynomial to a window of 2 h + 1 equally
 * spaced samples; the output is its value or a derivative. The edges of the record are included.
 *
 * Use it to smooth a signal outside the recorder. For each sample, call auvid_smoother_push once,
 * then auvid_smoother_take until it returns AUVID_EMPTY. The delay is h samples. The first h
 * outputs become ready with the first full window, the last h after auvid_smoother_end. These edge
 * outputs use the polynomial of the window at the edge of the record. To filter your own buffers,
 * use only auvid_smoother_coefficients.
 *
 * Cost (x86-64, -O2): push 41 instructions; take 16 per coefficient in the middle of the record,
 * 1.6k at h = 50. The coefficients of the edges are computed when needed and not stored: 0.9k each
 * at order 5, so an edge output takes 90k at h = 50. Memory: sizeof(auvid_smoother_t), 840 bytes at
 * AUVID_MAX_HALF_WIDTH 50 in float; no large stack.
 *
 * Accuracy: The error of an output is below 4 AUVID_EPSILON sum|c_k| max|x|. The relative error of
 * a coefficient is below 3 AUVID_EPSILON (largest of 109000: 1.9). The coefficient's sum is formed
 * in integers (auvid_smoother.c), so order 5 at h = 50 loses no digits in float.
 *
 * Sources: Savitzky and Golay 1964; Gorry 1990 (edges, Gram polynomials); Karras et al. 2013, III-B
 * (the paper names the smoother, but gives neither order nor width).
 */
#ifndef AUVID_SMOOTHER_H
#define AUVID_SMOOTHER_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Largest order of the polynomial. */
#define AUVID_SMOOTHER_MAX_ORDER 5
/** Largest derivative. */
#define AUVID_SMOOTHER_MAX_DERIVATIVE 2

/** Configuration. Written by the caller; copied at init. */
typedef struct {
    uint8_t half_width; /**< h [samples], 1..AUVID_MAX_HALF_WIDTH; default 25; 0 is refused */
    uint8_t order;      /**< polynomial order, 0..5 and <= 2 h; default 3; 0: moving average */
    uint8_t derivative; /**< 0..2 and <= order; default 0: the value itself */
    auvid_real_t dt_s;  /**< sample interval [s], 1e-6..1e6; default 0.02; 0 is refused */
} auvid_smoother_config_t;

/** The smoother of one signal. Its members are private. */
typedef struct {
    auvid_smoother_config_t cfg;                       /**< as given to init */
    auvid_real_t c[2 * AUVID_MAX_HALF_WIDTH + 1];      /**< centre weights, oldest first */
    auvid_real_t window[2 * AUVID_MAX_HALF_WIDTH + 1]; /**< ring of samples [their unit] */
    uint64_t pushed;                                   /**< number of samples so far */
    uint64_t next;                                     /**< index of the next output */
    uint16_t oldest;                                   /**< index into window */
    bool ended;                                        /**< the record is complete */
} auvid_smoother_t;

#define auvid_smoother_coefficients AUVID_SIZED0(auvid_smoother_coefficients)
#define auvid_smoother_init AUVID_SIZED(auvid_smoother_init)

#define auvid_smoother_defaults AUVID_SIZED(auvid_smoother_defaults)
/** Sets *cfg to the defaults above, or to smaller ones if AUVID_MAX_HALF_WIDTH is smaller. NULL
 * is a no-op. */
void auvid_smoother_defaults(auvid_smoother_config_t *cfg);

/**
 * Computes the coefficients c_k of one window: output = sum over k of c_k x_k.
 *
 * @param half_width  h, 1..AUVID_MAX_HALF_WIDTH
 * @param order       polynomial order, 0..5 and <= 2 h
 * @param derivative  order of the derivative, 0..2 and <= order
 * @param dt_s        sample interval [s], 1e-6..1e6
 * @param position    sample of the window for which the output is computed, -h (oldest)..h (newest)
 * @param c           out, 2 h + 1 values, oldest sample first [1 / s^derivative]
 * @return AUVID_OK; AUVID_ERR_NULL (c is NULL); AUVID_ERR_SIZE (half_width above
 *         AUVID_MAX_HALF_WIDTH); AUVID_ERR_NOT_FINITE (dt_s is not finite); AUVID_ERR_TIME_SAME
 *         (dt_s is zero); AUVID_ERR_SINGULAR (order > 2 h); AUVID_ERR_RANGE (any other value is out
 *         of its range)
 *
 * Cost: 0.9k instructions per coefficient at order 5, 0.6k at order 3.
 */
auvid_status_t auvid_smoother_coefficients(uint8_t half_width, uint8_t order, uint8_t derivative,
                                           auvid_real_t dt_s, int16_t position, auvid_real_t *c);

/**
 * Initialises a smoother and starts a record.
 *
 * @param smoother  out, completely written; unchanged if refused
 * @param cfg    copied; may lie inside *smoother
 * @return AUVID_OK; AUVID_ERR_NULL; the errors of auvid_smoother_coefficients for the fields
 */
auvid_status_t auvid_smoother_init(auvid_smoother_t *smoother, const auvid_smoother_config_t *cfg);

#define auvid_smoother_reset AUVID_SIZED(auvid_smoother_reset)
/**
 * Discards all samples and starts a new record with the same configuration.
 *
 * @return AUVID_OK; AUVID_ERR_NULL
 */
auvid_status_t auvid_smoother_reset(auvid_smoother_t *smoother);

#define auvid_smoother_push AUVID_SIZED(auvid_smoother_push)
/**
 * Appends the next sample. Outputs that were ready and not taken are lost.
 *
 * @param x  the sample, finite; the output is finite if sum|c_k| max|x| is finite
 * @return AUVID_OK (an output is ready); AUVID_EMPTY (no output yet, the first window is not full);
 *         AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_STATE (after auvid_smoother_end)
 */
auvid_status_t auvid_smoother_push(auvid_smoother_t *smoother, auvid_real_t x);

#define auvid_smoother_take AUVID_SIZED(auvid_smoother_take)
/**
 * Takes one output, in the order of the samples.
 *
 * @param sample  out, index of the sample to which the output belongs, from 0 on; may be NULL
 * @param y       out, the output [unit of the samples / s^derivative]
 * @return AUVID_OK; AUVID_EMPTY (no output is ready; *sample and *y are unchanged); AUVID_ERR_NULL
 */
auvid_status_t auvid_smoother_take(auvid_smoother_t *smoother, uint64_t *sample, auvid_real_t *y);

#define auvid_smoother_end AUVID_SIZED(auvid_smoother_end)
/**
 * Ends the record and makes the last h outputs ready. Then only take and reset are accepted.
 *
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (fewer than 2 h + 1 samples; nothing
 * changes); AUVID_ERR_STATE (the record has ended already)
 */
auvid_status_t auvid_smoother_end(auvid_smoother_t *smoother);

#ifdef __cplusplus
}
#endif

#endif
