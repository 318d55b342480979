/*
 * Uncertain inputs: causes as English text.
 */
#include "auvid_uncertain_parts_internal.h"
#include "../metric/auvid_words_internal.h"

/* The sentence of an input: what its value means above and below zero; the unit of its size, "" for
 * a number, NULL for no size; the remedy; the size per value. */
typedef struct {
    const char *above, *below, *unit, *remedy;
    auvid_real_t scale;
    bool of_dof; /* it begins with the name of the DoF */
} causes_words_t;

#define PER_CENT AUVID_C(100.0)
#define ITSELF AUVID_C(1.0)
#define MOUNT "check lever arms and mounting of DVL and IMU"
#define WATER_LOCK "use the DVL's water lock, or look for a cable"
#define TRIM "check the trim and the IMU's mounting"

static const causes_words_t causes_words[] = {
    [AUVID_UNCERTAIN_BACKWARD] = {"backward thrust is weaker than told, by ",
                                  "backward thrust is stronger than told, by ", " %",
                                  "measure the thrusters astern", PER_CENT, false},
    [AUVID_UNCERTAIN_DEAD_BAND] = {"the dead band is wider than told, by ",
                                   "the dead band is narrower than told, by ", " N",
                                   "measure the thrusters at small commands", ITSELF, false},
    [AUVID_UNCERTAIN_CURVE] = {"the thrust curve's exponent is higher than told, by ",
                               "the thrust curve's exponent is lower than told, by ", "",
                               "measure thrust at half command", ITSELF, false},
    [AUVID_UNCERTAIN_INFLOW] = {"thrust falls with speed, by ", "thrust rises with speed, by ",
                                " % per m/s", "measure it under way, or check the drag's law",
                                PER_CENT, false},
    [AUVID_UNCERTAIN_SAG] = {"thrust falls with time, by ", "thrust rises with time, by ",
                             " % in 4 minutes", "watch the battery, look for fouling", PER_CENT,
                             false},
    [AUVID_UNCERTAIN_LAG] = {"thrust acts later than told, by ",
                             "thrust acts earlier than told, by ", " s",
                             "check time stamps and the propellers' lag", ITSELF, false},
    [AUVID_UNCERTAIN_CURRENT_X] = {"a current sets to the north, with ",
                                   "a current sets to the south, with ", " m/s", WATER_LOCK, ITSELF,
                                   false},
    [AUVID_UNCERTAIN_CURRENT_Y] = {"a current sets to the east, with ",
                                   "a current sets to the west, with ", " m/s", WATER_LOCK, ITSELF,
                                   false},
    [INPUT_ASYMMETRY] = {"drag is larger forward, by ", "drag is smaller forward, by ", " %",
                         "the model has one drag for both directions", PER_CENT, true},
    [INPUT_FORCE] = {"a constant force acts, of ", "a constant force acts, of -", " N", MOUNT,
                     ITSELF, true},
    [INPUT_CROSS] = {"sway and yaw act on each other", "sway and yaw act on each other", NULL,
                     MOUNT, ITSELF, true},
    [INPUT_LIFT] = {"the hull has lift", "the hull has lift", NULL, MOUNT, ITSELF, true},
    [INPUT_ROLL] = {"the centre of gravity is astern, by ", "the centre of gravity is ahead, by ",
                    " m", TRIM, ITSELF, false},
    [INPUT_PITCH] = {"the centre of gravity is to port, by ",
                     "the centre of gravity is to starboard, by ", " m", TRIM, ITSELF, false}};

static void causes_append(auvid_words_t *w, const auvid_cause_t *cause)
{
    bool timing = cause->input == INPUT_DELAY;
    const causes_words_t *words = &causes_words[timing ? AUVID_UNCERTAIN_LAG : cause->input];
    if (words->of_dof) {
        auvid_words_append_dof(w, (auvid_dof_t)cause->dof);
    }
    auvid_words_append(w, cause->value > AUVID_C(0.0) ? words->above : words->below);
    if (words->unit != NULL) {
        auvid_words_append_rough(w, words->scale * cause->value);
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
    const char *separator = "uncertain inputs change, beyond both half-widths: ";
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
        auvid_words_append(&w,
                           "thrust, time stamps or sensors are far less exact than told; measure "
                           "them, or tell larger uncertainties");
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
