/*
 * Confidence: notes and missing motion as English text.
 */
#include "auvid/detail/confidence.h"

#include "auvid_confidence_notes_internal.h"
#include "auvid_words_internal.h"
#include "../base/auvid_math_internal.h"
#include "../models/auvid_vehicle_internal.h"

const char *auvid_note_str(auvid_note_t note)
{
    switch (note) {
    case AUVID_NOTE_NONE:
        return "";
    case AUVID_NOTE_FIXED:
        return "fixed by the configuration";
    case AUVID_NOTE_NOT_EXCITED:
        return "degree of freedom not excited";
    case AUVID_NOTE_COMBINATION:
        return "only a combination with another parameter is known";
    case AUVID_NOTE_SMALL:
        return "too small to matter";
    case AUVID_NOTE_NOISE:
        return "acceleration too noisy";
    case AUVID_NOTE_UNCERTAIN:
        return "too little motion";
    case AUVID_NOTE_IMPLAUSIBLE:
        return "implausible value";
    case AUVID_NOTE_AT_BOUND:
        return "at its bound";
    case AUVID_NOTE_BESIDE_BOUND:
        return "depends on a parameter at its bound";
    case AUVID_NOTE_NOT_CONVERGED:
        return "the search has not converged";
    case AUVID_NOTE_DISCREDITED:
        return "its equation has an impossible estimate";
    case AUVID_NOTE_THRUST_SCALE:
        return "known up to the thrust scale";
    case AUVID_NOTE_FEEDBACK:
        return "closed loop: the wrench is feedback";
    case AUVID_NOTE_UNCHECKED:
        return "not checked for errors of thrust and sensors";
    case AUVID_NOTE_INPUTS:
        return "known only if thrust and sensors are exact";
    case AUVID_NOTE_COUNT:
    default:
        return "unknown note";
    }
}

/* Is the force of parameter i's equation not explained? */
static bool confidence_is_unexplained(const auvid_confidence_t *c, int i)
{
    return c->note[i] == AUVID_NOTE_UNCERTAIN && c->partner[i] == UNEXPLAINED;
}

auvid_status_t auvid_confidence_note(const auvid_confidence_t *confidence,
                                     const auvid_vehicle_t *vehicle, int i, char *text, size_t size)
{
    if (confidence == NULL || vehicle == NULL || text == NULL) {
        return AUVID_ERR_NULL;
    }
    if (size == 0 || i < 0 || i >= vehicle->parameters || i >= AUVID_MAX_PARAMETERS) {
        return AUVID_ERR_RANGE;
    }
    auvid_words_t w = {.text = text, .size = size};
    uint8_t partner = confidence->partner[i];
    const char *name = partner < vehicle->parameters ? vehicle->parameter[partner].name : "";
    auvid_note_t note = (auvid_note_t)confidence->note[i];
    text[0] = '\0';
    if (note == AUVID_NOTE_COMBINATION) {
        auvid_words_append(&w, "only a combination with ");
        auvid_words_append(&w, name);
    } else if (note == AUVID_NOTE_BESIDE_BOUND) {
        auvid_words_append(&w, "depends on ");
        auvid_words_append(&w, name);
        auvid_words_append(&w, ", at its bound");
    } else if (note == AUVID_NOTE_DISCREDITED) {
        auvid_words_append(&w, name);
        auvid_words_append(&w, " is impossible");
    } else if (note == AUVID_NOTE_NOT_EXCITED && partner != IDLE) {
        auvid_words_append(&w, "unactuated");
    } else if (confidence_is_unexplained(confidence, i)) {
        auvid_words_append(&w, "most of the force is unexplained");
    } else {
        auvid_words_append(&w, auvid_note_str(note));
    }
    return AUVID_OK;
}

/* Append x as per cent, in tenths below one. */
static void confidence_append_percent(auvid_words_t *w, auvid_real_t x, bool up)
{
    auvid_words_append_steps(w, x, x < AUVID_C(1.0) ? AUVID_C(0.1) : AUVID_C(1.0), up);
    auvid_words_append(w, " %");
}

/* Append that parameter i is known relative to the thrust scale. With the thrust_scale in `bound`
 * its half-width would be the largest allowed. */
static void confidence_append_scale(auvid_words_t *w, const auvid_confidence_t *c,
                                    const auvid_parameter_t *parameter, int i)
{
    auvid_real_t sigma = c->sigma[i], thrust = c->thrust_error[i];
    auvid_real_t relative = auvid_sqrt(sigma * sigma - thrust * thrust);
    auvid_real_t limit = c->bound[i] / c->uncertainty.thrust_scale * thrust;
    auvid_real_t allowed = auvid_sqrt(relative * relative + limit * limit);
    auvid_words_append(w, parameter->name);
    auvid_words_append(w, " is known to ");
    if (parameter->kind == AUVID_PARAMETER_FORCE) {
        auvid_words_append_steps(w, AUVID_HALF_WIDTH * relative, AUVID_C(0.1), true);
        auvid_words_append(w, " ");
        auvid_words_append(w, parameter->unit);
    } else {
        confidence_append_percent(
            w, AUVID_C(100.0) * AUVID_CONFIDENCE_IDENTIFIABLE * relative / allowed, true);
    }
    auvid_words_append(w, " up to the thrust scale; calibrate thrust to ");
    confidence_append_percent(w, AUVID_C(100.0) * c->bound[i], false);
    auvid_words_append(w, " with a known force");
}

/* Append that parameter i's equation has an impossible estimate. */
static void confidence_append_impossible(auvid_words_t *w, const auvid_confidence_t *c,
                                         const auvid_vehicle_t *vehicle, int i)
{
    auvid_words_append(w, vehicle->parameter[c->partner[i]].name);
    auvid_words_append(w, " is impossible (");
    auvid_words_append(w, c->bound[i] > AUVID_C(0.0) ? "+" : "");
    (void)auvid_words_append_number(w, c->bound[i]);
    auvid_words_append(w, "): the equation is not trusted; check signs, units and the model");
}

/* Append that the force of parameter i's equation is not explained. */
static void confidence_append_unexplained(auvid_words_t *w, const auvid_confidence_t *c, int i)
{
    auvid_words_append(w, "only ");
    auvid_words_append_steps(w, AUVID_C(100.0) * auvid_max(c->bound[i], AUVID_C(0.0)), AUVID_C(1.0),
                             false);
    auvid_words_append(
        w, " % of the force is explained; check signs, thrust, time stamps, current and cable");
}

/* Append that parameter i is at its bound. */
static void confidence_append_bound(auvid_words_t *w, const auvid_confidence_t *c,
                                    const auvid_parameter_t *parameter, int i)
{
    auvid_words_append(w, parameter->name);
    auvid_words_append(w, c->partner[i] != 0 ? " is at its upper bound of "
                                             : " is at its lower bound of ");
    if (auvid_words_append_number(w, c->bound[i])) {
        auvid_words_append(w, " ");
    }
    auvid_words_append(w, parameter->unit);
    auvid_words_append(w, ": widen it");
}

/* Append all parameters that depend on the same parameter at its bound as parameter i. */
static void confidence_append_dependents(auvid_words_t *w, const auvid_confidence_t *c,
                                         const auvid_vehicle_t *vehicle, int i)
{
    const char *separator = " also changes ";
    auvid_words_append(w, vehicle->parameter[c->partner[i]].name);
    auvid_words_append(w, " at its bound");
    for (int k = i; k < vehicle->parameters; ++k) {
        if (c->note[k] == AUVID_NOTE_BESIDE_BOUND && c->partner[k] == c->partner[i]) {
            auvid_words_append(w, separator);
            auvid_words_append(w, vehicle->parameter[k].name);
            separator = ", ";
        }
    }
}

/* Append the motion that a parameter of its kind needs. */
static void confidence_append_need(auvid_words_t *w, const auvid_parameter_t *parameter)
{
    static const char *const lacks[] = {[AUVID_PARAMETER_OTHER] = "too little motion for ",
                                        [AUVID_PARAMETER_MASS] = "too little acceleration for ",
                                        [AUVID_PARAMETER_INERTIA] = "too little acceleration for ",
                                        [AUVID_PARAMETER_LINEAR_DRAG] =
                                            "too little slow motion for ",
                                        [AUVID_PARAMETER_QUADRATIC_DRAG] = "too little speed for ",
                                        [AUVID_PARAMETER_FORCE] = "too short a record for "};
    static const char *const needs[] = {
        [AUVID_PARAMETER_OTHER] = "; excite it more strongly, or for longer",
        [AUVID_PARAMETER_MASS] = "; sines of 0.1-0.3 Hz, stronger or for longer",
        [AUVID_PARAMETER_INERTIA] = "; sines of 0.1-0.3 Hz, stronger or for longer",
        [AUVID_PARAMETER_LINEAR_DRAG] = "; more steps held 4-8 s, some at a third of the strength",
        [AUVID_PARAMETER_QUADRATIC_DRAG] = "; steps held 4-8 s, stronger or more of them",
        [AUVID_PARAMETER_FORCE] = "; continue recording"};
    bool known = (unsigned)parameter->kind < sizeof lacks / sizeof lacks[0];
    auvid_parameter_kind_t kind = known ? parameter->kind : AUVID_PARAMETER_OTHER;
    auvid_words_append(w, lacks[kind]);
    auvid_words_append(w, parameter->name);
    auvid_words_append(w, needs[kind]);
}

static void confidence_append_pair(auvid_words_t *w, const auvid_parameter_t *one,
                                   const auvid_parameter_t *other)
{
    auvid_words_append(w, one->name);
    auvid_words_append(w, " and ");
    auvid_words_append(w, other->name);
    auvid_words_append(w, " cannot be distinguished; ");
    auvid_words_append(w, auvid_vehicle_is_drag(one->kind) && auvid_vehicle_is_drag(other->kind)
                              ? "steps held 4-8 s at two strengths"
                              : "fix one of them, or vary the motion");
}

/* Returns true if the sentence of parameter k < i also covers parameter i. */
static bool confidence_is_same_sentence(const auvid_confidence_t *c, const auvid_vehicle_t *vehicle,
                                        int k, int i)
{
    if (c == NULL || c->note[i] == AUVID_NOTE_NOT_EXCITED) {
        return vehicle->parameter[k].dof == vehicle->parameter[i].dof;
    }
    if (c->note[k] != c->note[i]) {
        return false;
    }
    return c->note[i] == AUVID_NOTE_NOT_CONVERGED ||
           (c->note[i] == AUVID_NOTE_FEEDBACK &&
            (c->partner[i] == OF_ALL || vehicle->parameter[k].dof == vehicle->parameter[i].dof)) ||
           c->note[i] == AUVID_NOTE_UNCHECKED || c->note[i] == AUVID_NOTE_INPUTS ||
           (confidence_is_unexplained(c, i) && confidence_is_unexplained(c, k) &&
            vehicle->parameter[k].dof == vehicle->parameter[i].dof) ||
           (c->note[i] == AUVID_NOTE_COMBINATION && c->partner[i] == k && c->partner[k] == i) ||
           (c->note[i] == AUVID_NOTE_DISCREDITED && c->partner[i] == c->partner[k]) ||
           (c->note[i] == AUVID_NOTE_BESIDE_BOUND && c->partner[i] == c->partner[k]);
}

/* Returns true if parameter i has a sentence and is the first parameter with that sentence. One
 * sentence covers: a DoF that was not excited, or that is not explained; a pair; all that depend on
 * a parameter at its bound; the equation of an impossible estimate; a search that has not
 * converged; a closed loop; inputs that were not checked, or are not exact.
 * @param wrong only equations that are not explained, or impossible; else only the others */
static bool confidence_has_sentence(const auvid_confidence_t *c, const auvid_vehicle_t *vehicle,
                                    uint32_t free, bool wrong, int i)
{
    _Static_assert(AUVID_NOTE_COUNT <= 32, "a bit of `with_sentence` for each note");
    static const uint32_t with_sentence =
        1u << AUVID_NOTE_NOT_EXCITED | 1u << AUVID_NOTE_COMBINATION | 1u << AUVID_NOTE_NOISE |
        1u << AUVID_NOTE_UNCERTAIN | 1u << AUVID_NOTE_AT_BOUND | 1u << AUVID_NOTE_BESIDE_BOUND |
        1u << AUVID_NOTE_NOT_CONVERGED | 1u << AUVID_NOTE_DISCREDITED |
        1u << AUVID_NOTE_THRUST_SCALE | 1u << AUVID_NOTE_FEEDBACK | 1u << AUVID_NOTE_UNCHECKED |
        1u << AUVID_NOTE_INPUTS;
    bool is_wrong =
        c != NULL && (c->note[i] == AUVID_NOTE_DISCREDITED || confidence_is_unexplained(c, i));
    if (wrong != is_wrong || (free != 0 && !(free >> i & 1u)) ||
        (c != NULL && !(with_sentence >> (c->note[i] & 31u) & 1u))) {
        return false;
    }
    for (int k = 0; k < i; ++k) {
        if ((free == 0 || (free >> k & 1u)) && confidence_is_same_sentence(c, vehicle, k, i)) {
            return false;
        }
    }
    return true;
}

/* Append what a DoF needs that was not excited. */
static void confidence_append_idle(auvid_words_t *w, uint8_t reason)
{
    static const char *const sentence[] = {
        [IDLE] = "not excited; apply steps held 4-8 s and sines of 0.1-0.3 Hz",
        [UNACTUATED] = "unactuated, and coupling does not suffice; excite it, or turn faster",
        [UNACTUATED_ROWS] = "unactuated; excite it if it has an actuator, else fix its parameters"};
    auvid_words_append(w, sentence[reason <= UNACTUATED_ROWS ? reason : IDLE]);
}

/* Append why the inputs were not checked. */
static void confidence_append_unchecked(auvid_words_t *w, uint8_t reason)
{
    if (reason == INEXACT_INPUTS) {
        auvid_words_append(w, "thrust, time stamps or sensors are far less exact than configured; "
                              "measure them, or configure larger deviations");
        return;
    }
    auvid_words_append(w, "not checked for errors of thrust and sensors; ");
    auvid_words_append(w, reason == TOO_FEW_ROWS
                              ? "the uncertain inputs have too few rows: excite each axis again"
                              : "estimate these errors (uncertain inputs), or correct those that "
                                "are named");
}

/* Append the sentence of parameter i. */
static void confidence_append_sentence(auvid_words_t *w, const auvid_confidence_t *c,
                                       const auvid_vehicle_t *vehicle, int i)
{
    const auvid_parameter_t *parameter = &vehicle->parameter[i];
    auvid_note_t note = c == NULL ? AUVID_NOTE_NOT_EXCITED : (auvid_note_t)c->note[i];
    if (note == AUVID_NOTE_NOT_CONVERGED) {
        auvid_words_append(w,
                           "the search has not converged; narrow the bounds, or give a good start");
        return;
    }
    if (note == AUVID_NOTE_FEEDBACK && c->partner[i] == OF_ALL) {
        auvid_words_append(w,
                           "closed loop: the wrench is feedback of a controller; excite the "
                           "vehicle, or drive it in open loop; if a pilot drives some axes, list "
                           "the others in closed_loop");
        return;
    }
    if (note == AUVID_NOTE_UNCHECKED) {
        confidence_append_unchecked(w, c->partner[i]);
        return;
    }
    if (note == AUVID_NOTE_INPUTS) {
        auvid_words_append(w, "some numbers are known only if thrust and sensors are exact; "
                              "record larger and other motion, or measure the thrusters, "
                              "also under way");
        return;
    }
    auvid_words_append_dof(w, parameter->dof);
    if (note == AUVID_NOTE_FEEDBACK) {
        auvid_words_append(w, "closed loop; drive it in open loop");
    } else if (note == AUVID_NOTE_NOT_EXCITED) {
        confidence_append_idle(w, c == NULL ? IDLE : c->partner[i]);
    } else if (note == AUVID_NOTE_COMBINATION) {
        confidence_append_pair(w, parameter, &vehicle->parameter[c->partner[i]]);
    } else if (note == AUVID_NOTE_AT_BOUND) {
        confidence_append_bound(w, c, parameter, i);
    } else if (note == AUVID_NOTE_BESIDE_BOUND) {
        confidence_append_dependents(w, c, vehicle, i);
    } else if (note == AUVID_NOTE_DISCREDITED) {
        confidence_append_impossible(w, c, vehicle, i);
    } else if (confidence_is_unexplained(c, i)) {
        confidence_append_unexplained(w, c, i);
    } else if (note == AUVID_NOTE_THRUST_SCALE) {
        confidence_append_scale(w, c, parameter, i);
    } else {
        confidence_append_need(w, parameter);
    }
}

/* Returns the DoF that lost the largest part of its rows. */
static int confidence_max_lost_dof(const auvid_confidence_t *c)
{
    int worst = 0;
    for (int j = 1; j < AUVID_DOF_COUNT; ++j) {
        worst = c->lost[j] > c->lost[worst] ? j : worst;
    }
    return worst;
}

static void confidence_append_lost(auvid_words_t *w, int dof, unsigned lost)
{
    const char number[3] = {(char)('0' + lost / 10 % 10), (char)('0' + lost % 10), '\0'};
    auvid_words_append_dof(w, (auvid_dof_t)dof);
    auvid_words_append(w, number);
    auvid_words_append(w, " % of the rows were lost to gaps in the record");
}

auvid_status_t auvid_confidence_missing(const auvid_confidence_t *confidence,
                                        const auvid_vehicle_t *vehicle, uint32_t free,
                                        unsigned which, char *text, size_t size)
{
    if (vehicle == NULL || text == NULL) {
        return AUVID_ERR_NULL;
    }
    if (size == 0) {
        return AUVID_ERR_RANGE;
    }
    auvid_words_t w = {.text = text, .size = size};
    text[0] = '\0';
    for (int wrong = 1; wrong >= 0; --wrong) { /* what is wrong comes first */
        for (int i = 0; i < vehicle->parameters && i < AUVID_MAX_PARAMETERS; ++i) {
            if (confidence_has_sentence(confidence, vehicle, free, wrong, i) && which-- == 0) {
                confidence_append_sentence(&w, confidence, vehicle, i);
                return AUVID_OK;
            }
        }
    }
    int dof = confidence == NULL ? 0 : confidence_max_lost_dof(confidence);
    if (confidence != NULL && confidence->lost[dof] >= AUVID_CONFIDENCE_LOST_PERCENT &&
        which == 0) {
        confidence_append_lost(&w, dof, confidence->lost[dof]);
        return AUVID_OK;
    }
    return AUVID_FINISHED;
}
