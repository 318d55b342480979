/*
 * Sentences: text of limited size, without the C library.
 */
#include "auvid_words_internal.h"

#include "../base/auvid_math_internal.h"

void auvid_words_append(auvid_words_t *w, const char *words)
{
    for (; *words != '\0' && w->used + 1 < w->size; ++words) {
        w->text[w->used++] = *words;
    }
    w->text[w->used] = '\0';
}

void auvid_words_append_dof(auvid_words_t *w, auvid_dof_t dof)
{
    static const char *const name[AUVID_DOF_COUNT] = {
        "surge: ", "sway: ", "heave: ", "roll: ", "pitch: ", "yaw: "};
    auvid_words_append(w, name[dof]);
}

bool auvid_words_append_number(auvid_words_t *w, auvid_real_t x)
{
    enum { PLACES = 14, DECIMALS = 3 };
    char text[PLACES + 1] = {0}, *c = text + PLACES;
    auvid_real_t size = auvid_abs(x);
    if (!(size < AUVID_C(1e9)) || (size > AUVID_C(0.0) && size < AUVID_C(1e-3))) {
        return false;
    }
    uint32_t whole = (uint32_t)size;
    uint32_t rest = (uint32_t)((size - (auvid_real_t)whole) * AUVID_C(1000.0) + AUVID_C(0.5));
    whole += rest / 1000u;
    rest %= 1000u;
    for (int k = 0; k < DECIMALS; ++k, rest /= 10u) {
        if (rest % 10u != 0 || *c != '\0') {
            *--c = (char)('0' + rest % 10u);
        }
    }
    if (*c != '\0') {
        *--c = '.';
    }
    do {
        *--c = (char)('0' + whole % 10u);
        whole /= 10u;
    } while (whole > 0);
    auvid_words_append(w, x < AUVID_C(0.0) ? "-" : "");
    auvid_words_append(w, c);
    return true;
}

void auvid_words_append_steps(auvid_words_t *w, auvid_real_t x, auvid_real_t step, bool up)
{
    auvid_real_t steps = x / step;
    if (steps < AUVID_C(1e9)) {
        uint32_t whole = (uint32_t)steps;
        whole += up && (auvid_real_t)whole < steps;
        (void)auvid_words_append_number(w, (auvid_real_t)whole * step);
    }
}

void auvid_words_append_rough(auvid_words_t *w, auvid_real_t x)
{
    auvid_real_t size = auvid_abs(x), step = AUVID_C(1e-3);
    for (int i = 0; i < 9 && size >= AUVID_C(9.5) * step; ++i) {
        step *= AUVID_C(10.0);
    }
    auvid_words_append_steps(w, size + AUVID_C(0.5) * step, step, false);
}
