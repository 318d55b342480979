/*
 * Units of work that fit into a tick.
 *
 *     budget = (frequency time / cycles - tick) / unit
 *
 * The costs follow from tests/firmware/instructions.csv, BOARD-Os, rounded up to three digits:
 *     tick = most of auvid_node_step + most of auvid_node_report + 16 most of auvid_node_take
 *     unit = most of auvid_identifier_work / 150
 * tests/firmware/test_budget.sh compares them.
 */
#include "auvid/identifier.h"

#include "../base/auvid_math_internal.h"

const auvid_core_t auvid_cores[AUVID_CORE_COUNT] = {
    [AUVID_CORE_M0PLUS] = {"m0plus", 472000, 6800, AUVID_C(1.33)},
    [AUVID_CORE_M3] = {"m3", 226000, 3130, AUVID_C(1.5)},
    [AUVID_CORE_M4F] = {"m4f", 67300, 320, AUVID_C(1.5)},
    [AUVID_CORE_M7] = {"m7", 67200, 320, AUVID_C(1.5)},
    [AUVID_CORE_M33] = {"m33", 67200, 320, AUVID_C(1.5)},
    [AUVID_CORE_RV32IMC] = {"rv32imc", 398000, 6170, AUVID_C(1.5)},
};

uint32_t auvid_budget(const auvid_core_t *core, auvid_real_t frequency_hz, auvid_real_t time_s)
{
    if (core == NULL || core->tick == 0 || core->unit == 0 || !(core->cycles > AUVID_C(0.0)) ||
        !(frequency_hz > AUVID_C(0.0)) || !(time_s > AUVID_C(0.0))) {
        return 0;
    }
    auvid_real_t instructions = frequency_hz * time_s / core->cycles;
    auvid_real_t units = (instructions - (auvid_real_t)core->tick) / (auvid_real_t)core->unit;
    if (!auvid_is_finite(units) || !(units >= AUVID_C(1.0))) {
        return 0;
    }
    return units < (auvid_real_t)AUVID_BUDGET_LARGEST ? (uint32_t)units : AUVID_BUDGET_LARGEST;
}
