/*
 * Uncertain inputs: causes as English text.
 */
#include "auvid_uncertain_parts_internal.h"
#include "../metric/auvid_words_internal.h"

/* See AUVID_UNCERTAIN_TABLE. A program that says no sentence does not contain them. */
typedef struct {
    const char *finding, *unit, *remedy;
} causes_words_t;

#define WORDS(input, deviation, from, equations, prior, class, ...)                                \
    [UNCERTAIN_ROW(input)] = {__VA_ARGS__},
static const causes_words_t causes_words[] = {AUVID_UNCERTAIN_TABLE(WORDS)};

/* Append the words; of "{above|below}" among them one. */
static void causes_append_either(auvid_words_t *w, const char *words, bool above)
{
    bool skips = false;
    for (; *words != '\0'; ++words) {
        const char letter[2] = {*words, '\0'};
        switch (*words) {
        case '{':
            skips = !above;
            break;
        case '|':
            skips = above;
            break;
        case '}':
            skips = false;
            break;
        default:
            auvid_words_append(w, skips ? "" : letter);
            break;
        }
    }
}

static void causes_append(auvid_words_t *w, const auvid_cause_t *cause)
{
    const causes_words_t *words = &causes_words[UNCERTAIN_ROW(cause->input)];
    if (auvid_uncertain_row(cause->input)->from == INPUT_FROM_HULL) {
        auvid_words_append_dof(w, (auvid_dof_t)cause->dof);
    }
    causes_append_either(w, words->finding, cause->value > AUVID_C(0.0));
    if (words->unit != NULL) {
        bool part = words->unit[0] == '%';
        auvid_words_append_rough(w, (part ? AUVID_C(100.0) : AUVID_C(1.0)) * cause->value);
        auvid_words_append(w, words->unit[0] != '\0' ? " " : "");
        auvid_words_append(w, words->unit);
        auvid_words_append(w, cause->input == INPUT_FORCE && cause->dof >= AUVID_ROLL ? "m" : "");
        auvid_words_append(w, " or so");
    }
    auvid_words_append(w, "; ");
    auvid_words_append(w, words->remedy);
}

static void causes_append_differing(auvid_words_t *w, uint32_t differs,
                                    const auvid_vehicle_t *vehicle)
{
    const char *separator =
        "the estimate with exact inputs differs by more than both half-widths: ";
    for (int i = 0; i < vehicle->parameters; ++i) {
        if (differs >> i & 1u) {
            auvid_words_append(w, separator);
            auvid_words_append(w, vehicle->parameter[i].name);
            separator = ", ";
        }
    }
}

auvid_status_t auvid_causes_sentence(const auvid_causes_t *causes, const auvid_vehicle_t *vehicle,
                                     unsigned which, char *text, size_t size)
{
    if (causes == NULL || vehicle == NULL || text == NULL) {
        return AUVID_ERR_NULL;
    }
    if (size == 0) {
        return AUVID_ERR_RANGE;
    }
    auvid_words_t w = {.text = text, .size = size};
    text[0] = '\0';
    if (which == 0 && causes->thrust_differs) {
        auvid_words_append(&w,
                           "the thrusters' forces do not make the wrench; check commands, their "
                           "unit and the allocation");
        return AUVID_OK;
    }
    if (which == 0 && causes->contradicted) {
        auvid_words_append(&w, "thrust, time stamps or sensors are far less exact than configured; "
                               "measure them, or configure larger deviations");
        return AUVID_OK;
    }
    if (which < causes->named && which < AUVID_CAUSE_COUNT) {
        causes_append(&w, &causes->cause[causes->order[which] % AUVID_CAUSE_COUNT]);
        return AUVID_OK;
    }
    if (which == causes->named && causes->differs != 0) {
        causes_append_differing(&w, causes->differs, vehicle);
        return AUVID_OK;
    }
    return AUVID_FINISHED;
}
