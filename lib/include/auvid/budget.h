/**
 * @file budget.h
 * How many units of work fit into a control tick: the budget of auvid_identifier_work, from the
 * core's frequency. Call it once, at start-up or on a desk, and write the number into the firmware:
 * a log replays bit for bit only with the same budget.
 *
 *     auvid_budget(&auvid_cores[AUVID_CORE_M4F], 168e6f, 0.01f)     half a tick of 20 ms: 3029 units
 *
 * The costs are instructions of the full example of port/cortex_m: a node on a CAN bus, Girona500
 * with 13 parameters, five thrusters, excitation, guard, change test and simulation of velocity,
 * compiled with -Os. They are measured (tests/firmware/instructions.csv), but for the cycles of an
 * instruction, which are assumed: measure those of your board. A unit of work is the same for all
 * models, but one evaluation of a model on the residual path takes several units (vehicle.h).
 */
#ifndef AUVID_BUDGET_H
#define AUVID_BUDGET_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Costs of a core. For another one, or another firmware, fill it from `make bench-firmware`. */
typedef struct {
    const char *name; /**< as in port/cortex_m/boards.txt, e.g. "m4f"; not read by auvid_budget */
    uint32_t tick;    /**< reserved: most instructions of a tick without work. It is the sum of the
                        most that step, report and 16 received frames take, although these do not
                        coincide. A passive identifier takes less; uncertain inputs take a third more
                        on a Cortex-M4F */
    uint32_t unit; /**< most instructions of a unit of work: those of the heaviest call at a budget
                        of 150, divided by 150 */
    auvid_real_t cycles; /**< of an instruction, > 0; flash without wait states */
} auvid_core_t;

/** The cores of `auvid_cores`. Those with an FPU have one of single precision. */
typedef enum {
    AUVID_CORE_M0PLUS,  /**< Cortex-M0+ */
    AUVID_CORE_M3,      /**< Cortex-M3 */
    AUVID_CORE_M4F,     /**< Cortex-M4 with FPU */
    AUVID_CORE_M7,      /**< Cortex-M7 with FPU */
    AUVID_CORE_M33,     /**< Cortex-M33 with FPU */
    AUVID_CORE_RV32IMC, /**< RISC-V without floating point */
    AUVID_CORE_COUNT
} auvid_core_number_t;

#define auvid_cores AUVID_SIZED0(auvid_cores)
/** Costs of these cores. */
extern const auvid_core_t auvid_cores[AUVID_CORE_COUNT];

/** Largest budget that auvid_budget returns. */
#define AUVID_BUDGET_LARGEST 1000000u

#define auvid_budget AUVID_SIZED0(auvid_budget)
/** Returns the largest budget with which no tick takes longer than time_s, as far as `core` tells;
 * at most AUVID_BUDGET_LARGEST. 0: not one unit fits, and the tick may be too short even without
 * work; take a longer tick or a faster clock. Also 0 if core is NULL, or if one of its members or
 * of the arguments is not finite or not above 0.
 * @param frequency_hz of the core [Hz]
 * @param time_s what auvid may take of each tick [s] */
uint32_t auvid_budget(const auvid_core_t *core, auvid_real_t frequency_hz, auvid_real_t time_s);

#ifdef __cplusplus
}
#endif

#endif
