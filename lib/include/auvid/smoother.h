/**
 * @file smoother.h
 * Savitzky-Golay smoother: the value or a derivative of the polynomial fitted by least squares to
 * a window of 2 h + 1 equally spaced samples; streaming, with the edges of the record included.
 *
 * Who calls it: whoever smooths a signal outside the recorder: once per sample auvid_smoother_push,
 * then auvid_smoother_take for as long as it gives something. The delay is h samples; the first h
 * outputs come together with the first full window, the last h after auvid_smoother_end, both from
 * the polynomial of the window at the edge of the record. auvid_smoother_coefficients alone serves
 * those who keep their own buffers.
 *
 * Cost (x86-64, -O2): push 41 instructions; take 16 per coefficient in the middle of the record,
 * 1.6k at h = 50. The coefficients of the edges are made when needed and not stored: 0.9k each at
 * order 5, so an edge output takes 90k at h = 50. Memory: sizeof(auvid_smoother_t), 840 bytes at
 * AUVID_MAX_HALF_WIDTH 50 in float; no large stack.
 *
 * Accuracy: an output differs from the exact one by less than 4 AUVID_EPSILON sum|c_k| max|x|, and
 * a coefficient from the exact one by less than 3 AUVID_EPSILON of itself (1.9 found among 109000):
 * the sum behind it is formed in integers (auvid_smoother.c), so that order 5 at h = 50 costs no
 * digits in float.
 *
 * Sources: Savitzky and Golay 1964; Gorry 1990 (edges, Gram polynomials); Karras et al. 2013, III-B
 * (the paper names the smoother, without order or width).
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

/** What to fit and what to give. Written by the caller; copied at init. */
typedef struct {
    uint8_t half_width; /**< h [samples], 1..AUVID_MAX_HALF_WIDTH; default 25; 0 is refused */
    uint8_t order;      /**< of the polynomial, 0..5 and <= 2 h; default 3; 0: moving average */
    uint8_t derivative; /**< 0..2 and <= order; default 0: the value itself */
    auvid_real_t dt_s;  /**< between samples [s], 1e-6..1e6; default 0.02; 0 is refused */
} auvid_smoother_config_t;

/** One signal's smoother. Fields are private: read them in a debugger, write them never. */
typedef struct {
    auvid_smoother_config_t config;                    /**< as given to init */
    auvid_real_t c[2 * AUVID_MAX_HALF_WIDTH + 1];      /**< for the middle, oldest first */
    auvid_real_t window[2 * AUVID_MAX_HALF_WIDTH + 1]; /**< ring of samples [their unit] */
    uint64_t pushed;                                   /**< samples so far */
    uint64_t next;                                     /**< sample of the next output */
    uint16_t oldest;                                   /**< index into window */
    bool ended;                                        /**< the record is complete */
} auvid_smoother_t;

#define auvid_smoother_coefficients AUVID_SIZED0(auvid_smoother_coefficients)
#define auvid_smoother_init AUVID_SIZED1(auvid_smoother_init, AUVID_MAX_HALF_WIDTH)

#define auvid_smoother_defaults AUVID_SIZED1(auvid_smoother_defaults, AUVID_MAX_HALF_WIDTH)
/** Fill *config with the defaults above, less where AUVID_MAX_HALF_WIDTH allows less. A null
 * pointer is ignored. */
void auvid_smoother_defaults(auvid_smoother_config_t *config);

/**
 * Coefficients c_k of one window: output = sum over k of c_k x_k.
 *
 * @param half_width  h, 1..AUVID_MAX_HALF_WIDTH
 * @param order       of the polynomial, 0..5 and <= 2 h
 * @param derivative  0..2 and <= order
 * @param dt_s        between samples [s], 1e-6..1e6
 * @param position    sample of the window where the output is wanted, -h (oldest)..h (newest)
 * @param c           out, 2 h + 1 values, oldest sample first [1 / s^derivative]
 * @return AUVID_OK; AUVID_ERR_NULL: c is null; AUVID_ERR_SIZE: half_width above
 *         AUVID_MAX_HALF_WIDTH; AUVID_ERR_NOT_FINITE, AUVID_ERR_TIME_SAME: dt_s not finite, zero;
 *         AUVID_ERR_SINGULAR: order > 2 h; AUVID_ERR_RANGE: any other value out of its range
 *
 * Cost: 0.9k instructions per coefficient at order 5, 0.6k at order 3.
 */
auvid_status_t auvid_smoother_coefficients(uint8_t half_width, uint8_t order, uint8_t derivative,
                                           auvid_real_t dt_s, int16_t position, auvid_real_t *c);

/**
 * Start a record.
 *
 * @param smoother  out, all of it written; unchanged when refused
 * @param config    what to fit; copied
 * @return AUVID_OK; AUVID_ERR_NULL; and what auvid_smoother_coefficients returns for the fields
 */
auvid_status_t auvid_smoother_init(auvid_smoother_t *smoother,
                                   const auvid_smoother_config_t *config);

#define auvid_smoother_reset AUVID_SIZED1(auvid_smoother_reset, AUVID_MAX_HALF_WIDTH)
/**
 * Forget all samples and start a new record with the same configuration.
 *
 * @return AUVID_OK; AUVID_ERR_NULL
 */
auvid_status_t auvid_smoother_reset(auvid_smoother_t *smoother);

#define auvid_smoother_push AUVID_SIZED1(auvid_smoother_push, AUVID_MAX_HALF_WIDTH)
/**
 * Give the next sample. Outputs that were ready and not taken are given up.
 *
 * @param x  the sample, finite; the output is finite as long as sum|c_k| max|x| is
 * @return AUVID_OK: an output is ready to take; AUVID_EMPTY: none yet, the first window is not
 *         full; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_STATE: after auvid_smoother_end
 */
auvid_status_t auvid_smoother_push(auvid_smoother_t *smoother, auvid_real_t x);

#define auvid_smoother_take AUVID_SIZED1(auvid_smoother_take, AUVID_MAX_HALF_WIDTH)
/**
 * Take one output, in the order of the samples.
 *
 * @param sample  out, which sample the output belongs to, 0 is the first pushed; may be null
 * @param y       out, the output [unit of the samples / s^derivative]
 * @return AUVID_OK; AUVID_EMPTY: nothing is ready, outputs unchanged; AUVID_ERR_NULL
 */
auvid_status_t auvid_smoother_take(auvid_smoother_t *smoother, uint64_t *sample, auvid_real_t *y);

#define auvid_smoother_end AUVID_SIZED1(auvid_smoother_end, AUVID_MAX_HALF_WIDTH)
/**
 * The record is complete: makes the last h outputs ready. Then only take and reset go on.
 *
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA: fewer than 2 h + 1 samples, nothing changes;
 *         AUVID_ERR_STATE: ended already
 */
auvid_status_t auvid_smoother_end(auvid_smoother_t *smoother);

#ifdef __cplusplus
}
#endif

#endif
