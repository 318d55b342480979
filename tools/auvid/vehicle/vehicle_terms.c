#include "vehicle_terms.h"

#include <math.h>
#include <string.h>

#include "vehicle_keys.h"

/* Beyond this a parameter of the simulation is a slip. */
#define LARGEST 1e8

const char *const vehicle_kinds[] = {"other",          "mass",  "inertia", "linear_drag",
                                     "quadratic_drag", "force", NULL};
const char *const vehicle_factors[] = {
    "1",     "u",       "v",       "w",         "p",         "q",       "r",       "|u|",   "|v|",
    "|w|",   "|p|",     "|q|",     "|r|",       "u_dot",     "v_dot",   "w_dot",   "p_dot", "q_dot",
    "r_dot", "sin_phi", "cos_phi", "sin_theta", "cos_theta", "sin_psi", "cos_psi", "t",     NULL};

/* A place within a value. */
typedef struct {
    ini_t *ini;
    const ini_entry_t *entry;
    size_t at;
} place_t;

/* Takes the next word, which must be one of `words`. @return its index; -1 after a message */
static int take_one_of(place_t *p, const char *const *words)
{
    char word[VEHICLE_WORD];
    int column = ini_word(p->entry, &p->at, word, sizeof word);
    for (int i = 0; words[i] != NULL; ++i) {
        if (strcmp(words[i], word) == 0) {
            return i;
        }
    }
    (void)vehicle_keys_not_one_of(p->ini, p->entry, column, word, words);
    return -1;
}

static bool refuse(const place_t *p, const char *what)
{
    return ini_refuse(p->ini, p->entry->line, p->entry->value_column, "%s: %s", p->entry->key,
                      what);
}

/* NAME = KIND DOF UNIT */
static bool take_parameter(place_t *p, vehicle_terms_t *t)
{
    int i = t->table.parameters;
    auvid_parameter_t *parameter = &t->parameter[i];
    if (i == AUVID_MAX_PARAMETERS || strlen(p->entry->key) >= VEHICLE_WORD) {
        return refuse(p, "too many parameters, or a name that is too long");
    }
    int kind = take_one_of(p, vehicle_kinds);
    int dof = kind < 0 ? -1 : take_one_of(p, vehicle_dofs);
    if (dof < 0) {
        return false;
    }
    const char *unit = p->entry->value + p->at;
    unit += strspn(unit, " \t");
    if (*unit == '\0' || strlen(unit) >= VEHICLE_UNIT || strpbrk(unit, "\"\\") != NULL) {
        return refuse(p, "a parameter is KIND DOF UNIT, e.g. mass surge kg");
    }
    memcpy(t->name[i], p->entry->key, strlen(p->entry->key) + 1);
    memcpy(t->unit[i], unit, strlen(unit) + 1);
    parameter->name = t->name[i];
    parameter->unit = t->unit[i];
    parameter->dof = (auvid_dof_t)dof;
    parameter->kind = (auvid_parameter_kind_t)kind;
    t->table.parameters = (uint8_t)(i + 1);
    return true;
}

/* The sign of a term in the equation of its parameter's degree of freedom; 0: any. A drag opposes
 * its own velocity with a negative parameter, a mass its own acceleration with a positive one. */
static int own_sign(const auvid_parameter_t *parameter, const auvid_term_t *term)
{
    bool drag = parameter->kind == AUVID_PARAMETER_LINEAR_DRAG ||
                parameter->kind == AUVID_PARAMETER_QUADRATIC_DRAG;
    bool mass =
        parameter->kind == AUVID_PARAMETER_MASS || parameter->kind == AUVID_PARAMETER_INERTIA;
    int moves = (drag ? AUVID_FACTOR_U : AUVID_FACTOR_U_DOT) + (int)term->dof, own = 0, others = 0;
    for (int k = 0; k < 3; ++k) {
        int f = term->factor[k];
        bool positive =
            f == AUVID_FACTOR_ONE || (f >= AUVID_FACTOR_ABS_U && f < AUVID_FACTOR_U_DOT);
        own += f == moves;
        others += f != moves && !positive;
    }
    bool known = (drag || mass) && term->dof == parameter->dof && own == 1 && others == 0;
    return !known ? 0 : drag ? -1 : 1;
}

/* DOF SIGN FACTOR .. of parameter i, up to a comma or the end. */
static bool take_term(place_t *p, vehicle_terms_t *t, int i)
{
    static const char *const signs[] = {"-", "+", NULL};
    auvid_term_t term = {.parameter = (uint8_t)i};
    int dof = take_one_of(p, vehicle_dofs);
    int sign = dof < 0 ? -1 : take_one_of(p, signs);
    if (sign < 0) {
        return false;
    }
    const char *rest = p->entry->value;
    for (int k = 0; rest[p->at + strspn(rest + p->at, " \t")] != ','; ++k) {
        if (rest[p->at + strspn(rest + p->at, " \t")] == '\0') {
            break;
        }
        int factor = take_one_of(p, vehicle_factors);
        if (factor < 0 || k == 3) {
            return factor >= 0 ? refuse(p, "more than three factors in a term") : false;
        }
        term.factor[k] = (uint8_t)factor;
    }
    if (t->table.terms == VEHICLE_MAX_TERMS) {
        return refuse(p, "too many terms");
    }
    term.dof = (uint8_t)dof;
    term.sign = sign == 1 ? 1 : -1;
    if (own_sign(&t->parameter[i], &term) * term.sign < 0) {
        return refuse(p,
                      term.sign > 0
                          ? "a drag has the sign - in its own equation: its parameter is negative"
                          : "a mass or an inertia has the sign + before its own acceleration");
    }
    t->term[t->table.terms++] = term;
    return true;
}

/* NAME = TERM , TERM .. */
static bool take_terms(place_t *p, vehicle_terms_t *t)
{
    int i = 0;
    while (i < t->table.parameters && strcmp(t->name[i], p->entry->key) != 0) {
        ++i;
    }
    if (i == t->table.parameters) {
        return refuse(p, "is no key of [parameters]; add it there");
    }
    for (bool more = true; more;) {
        if (!take_term(p, t, i)) {
            return false;
        }
        p->at += strspn(p->entry->value + p->at, " \t");
        more = p->entry->value[p->at] == ',';
        p->at += more;
    }
    return true;
}

static bool take_section(ini_t *ini, const char *section, vehicle_terms_t *t,
                         bool (*take)(place_t *, vehicle_terms_t *))
{
    if (ini_find(ini, section, "") == NULL) {
        return ini_refuse(ini, 1, 1, "no section [%s], which the model 'terms' needs: add it",
                          section);
    }
    for (int i = 0; i < ini->entries; ++i) {
        ini_entry_t *e = &ini->entry[i];
        place_t place = {ini, e, 0};
        if (strcmp(e->section, section) == 0 && e->key[0] != '\0') {
            e->used = true;
            if (!take(&place, t)) {
                return false;
            }
        }
    }
    return true;
}

/* Names the parameter that auvid_terms_init refused, and the reason. */
static bool refuse_terms(ini_t *ini, const vehicle_terms_t *terms, const auvid_refusal_t *why)
{
    bool of_term = strcmp(why->part, "term") == 0;
    int i = why->element < 0 ? 0 : of_term ? terms->term[why->element].parameter : why->element;
    const ini_entry_t *e = ini_find(ini, "terms", terms->name[i]);
    e = e != NULL ? e : ini_find(ini, "parameters", terms->name[i]);
    if (!of_term) {
        return ini_refuse(ini, e->line, e->key_column,
                          "%s: [terms] has no term of it in the equation of its degree of freedom, "
                          "%s: add it",
                          terms->name[i], vehicle_dofs[terms->parameter[i].dof]);
    }
    return ini_refuse(ini, e->line, e->key_column, "%s: %s", terms->name[i],
                      strcmp(why->field, "factor") == 0
                          ? "a term has two accelerations, but at most one is possible"
                          : "a term stands twice in the same equation: keep one");
}

bool vehicle_terms_read(ini_t *ini, const char *title, vehicle_terms_t *terms)
{
    auvid_refusal_t why = {0};
    if (!take_section(ini, "parameters", terms, take_parameter) ||
        !take_section(ini, "terms", terms, take_terms)) {
        return false;
    }
    terms->table.name = title;
    terms->table.parameter = terms->parameter;
    terms->table.term = terms->term;
    const ini_entry_t *head = ini_find(ini, "terms", "");
    if (terms->table.parameters == 0 || terms->table.terms == 0) {
        return ini_refuse(ini, head->line, 1, "no %s: add a key for each",
                          terms->table.parameters == 0 ? "parameter in [parameters]" : "term");
    }
    auvid_status_t status = auvid_terms_init(&terms->terms, &terms->table, &why);
    terms->terms.vehicle.free = UINT32_MAX >> (32 - terms->table.parameters);
    if (status < 0) {
        return refuse_terms(ini, terms, &why);
    }
    return true;
}

bool vehicle_terms_truth(ini_t *ini, const vehicle_terms_t *terms,
                         double value[SIM_VEHICLE_PARAMETERS])
{
    const ini_entry_t *head = ini_find(ini, "truth", "");
    for (int i = 0; i < terms->table.parameters; ++i) {
        ini_entry_t *e = ini_find(ini, "truth", terms->name[i]);
        if (e == NULL) {
            return ini_refuse(ini, head->line, 1, "[truth] has no key '%s': add its value",
                              terms->name[i]);
        }
        e->used = true;
        if (!ini_numbers(ini, e, 1, 1, &value[i], NULL)) {
            return false;
        }
        bool mass = terms->parameter[i].kind == AUVID_PARAMETER_MASS ||
                    terms->parameter[i].kind == AUVID_PARAMETER_INERTIA;
        if (!(fabs(value[i]) <= LARGEST) || (mass && !(value[i] > 0.0))) {
            return ini_refuse(ini, e->line, e->value_column, "%s: %.9g is not %s", e->key, value[i],
                              mass ? "above 0, as a mass or an inertia is" : "within +-1e8");
        }
    }
    return true;
}
