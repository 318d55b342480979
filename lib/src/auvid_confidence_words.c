/*
 * Confidence in words.
 */
#include "auvid/confidence.h"

#include "auvid_math.h"

const char *auvid_note_str(auvid_note_t note)
{
    switch (note) {
    case AUVID_NOTE_NONE:
        return "";
    case AUVID_NOTE_FIXED:
        return "fixed by the configuration";
    case AUVID_NOTE_NOT_DRIVEN:
        return "nothing moved this degree of freedom";
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
    default:
        return "unknown note";
    }
}

/* A text under construction, always ended by zero. */
typedef struct {
    char *text;
    size_t size, used;
} writer_t;

static void add(writer_t *w, const char *words)
{
    for (; *words != '\0' && w->used + 1 < w->size; ++words) {
        w->text[w->used++] = *words;
    }
    w->text[w->used] = '\0';
}

static void add_dof(writer_t *w, auvid_dof_t dof)
{
    static const char *const name[AUVID_DOF_COUNT] = {
        "surge: ", "sway: ", "heave: ", "roll: ", "pitch: ", "yaw: "};
    add(w, name[dof]);
}

/* What a parameter of its kind needs. */
static void add_need(writer_t *w, const auvid_parameter_t *parameter)
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
        [AUVID_PARAMETER_FORCE] = "; go on recording"};
    bool known = (unsigned)parameter->kind < sizeof lacks / sizeof lacks[0];
    auvid_parameter_kind_t kind = known ? parameter->kind : AUVID_PARAMETER_OTHER;
    add(w, lacks[kind]);
    add(w, parameter->name);
    add(w, needs[kind]);
}

static bool is_drag(const auvid_parameter_t *parameter)
{
    return parameter->kind == AUVID_PARAMETER_LINEAR_DRAG ||
           parameter->kind == AUVID_PARAMETER_QUADRATIC_DRAG;
}

static void add_pair(writer_t *w, const auvid_parameter_t *one, const auvid_parameter_t *other)
{
    add(w, one->name);
    add(w, " and ");
    add(w, other->name);
    add(w, " cannot be told apart; ");
    add(w, is_drag(one) && is_drag(other) ? "steps held 4-8 s at two strengths"
                                          : "hold one of them fixed, or vary the motion");
}

/* Does parameter i get a sentence, and is it the first to give it? A DoF that was not driven has
 * one for all its parameters, a pair has one for both. */
static bool is_told(const auvid_confidence_t *c, const auvid_vehicle_t *vehicle, uint32_t free,
                    int i)
{
    auvid_note_t note = c == NULL ? AUVID_NOTE_NOT_DRIVEN : (auvid_note_t)c->note[i];
    if (free != 0 && !(free >> i & 1u)) {
        return false;
    }
    for (int k = 0; k < i; ++k) {
        bool same = vehicle->parameter[k].dof == vehicle->parameter[i].dof &&
                    (free == 0 || (free >> k & 1u));
        if ((note == AUVID_NOTE_NOT_DRIVEN && same) ||
            (note == AUVID_NOTE_COMBINATION && c->note[k] == AUVID_NOTE_COMBINATION &&
             c->partner[i] == k)) {
            return false;
        }
    }
    return note == AUVID_NOTE_NOT_DRIVEN || note == AUVID_NOTE_COMBINATION ||
           note == AUVID_NOTE_NOISE || note == AUVID_NOTE_UNCERTAIN;
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
    writer_t w = {.text = text, .size = size};
    text[0] = '\0';
    for (int i = 0; i < vehicle->parameters && i < AUVID_MAX_PARAMETERS; ++i) {
        const auvid_parameter_t *parameter = &vehicle->parameter[i];
        if (!is_told(confidence, vehicle, free, i) || which-- > 0) {
            continue;
        }
        add_dof(&w, parameter->dof);
        if (confidence == NULL || confidence->note[i] == AUVID_NOTE_NOT_DRIVEN) {
            add(&w, "nothing moved it; excite it with steps held 4-8 s and sines of 0.1-0.3 Hz");
        } else if (confidence->note[i] == AUVID_NOTE_COMBINATION) {
            add_pair(&w, parameter, &vehicle->parameter[confidence->partner[i]]);
        } else {
            add_need(&w, parameter);
        }
        return AUVID_OK;
    }
    return AUVID_FINISHED;
}
