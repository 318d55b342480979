/*
 * --budget: a number of units, or what a microcontroller can do in half of a tick of 20 ms.
 */
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"
#include "auvid/identifier.h"
#include "options_reader.h"

#define HALF_A_TICK_S AUVID_C(0.01)

/* CORE:MHZ; NULL: no such core, or no frequency. */
static const auvid_core_t *core_of(const char *text, double *mhz)
{
    size_t length = strcspn(text, ":");
    char *end = NULL;
    const char *digits = text[length] == ':' ? text + length + 1 : "";
    *mhz = strtod(digits, &end);
    if (*digits == '\0' || digits[strspn(digits, "0123456789.")] != '\0' || *end != '\0') {
        return NULL;
    }
    for (int i = 0; i < AUVID_CORE_COUNT; ++i) {
        const char *name = auvid_cores[i].name;
        if (strlen(name) == length && memcmp(name, text, length) == 0) {
            return &auvid_cores[i];
        }
    }
    return NULL;
}

int take_budget(reader_t *r, uint32_t *budget)
{
    const char *text = NULL;
    double mhz = 0.0;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if (strncmp(text, "auto", 4) != 0) {
        return take_count32(r, 1, AUVID_BUDGET_LARGEST, budget);
    }
    const auvid_core_t *core = text[4] == '\0'  ? core_of("m4f:168", &mhz)
                               : text[4] == ':' ? core_of(text + 5, &mhz)
                                                : NULL;
    if (core == NULL) {
        return report_error("%s: '%s' is not auto or auto:CORE:MHZ, with a core m0plus, m3, m4f, "
                            "m7, m33 or rv32imc, e.g. auto:m4f:168",
                            r->name, text);
    }
    *budget = auvid_budget(core, (auvid_real_t)(mhz * 1e6), HALF_A_TICK_S);
    if (*budget == 0) {
        return report_error("%s: '%s' leaves no time for a search in half of a tick of 20 ms; "
                            "give a higher frequency",
                            r->name, text);
    }
    return 0;
}
