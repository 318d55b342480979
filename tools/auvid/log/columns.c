#include "columns.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"

enum { LETTERS = 16 }; /* longest compared name, plus one */

/* Extracts the letters and digits of a name, and how many precede the first other character. A unit
 * after the name ("u [m/s]") is skipped. Returns false if the name is too long for any column. */
static bool letters(const char *name, char out[LETTERS], size_t *stem)
{
    size_t count = 0, i = 0, length = strcspn(name, " [(/");
    *stem = strcspn(name, "_.- [(/");
    for (; i < length && count < LETTERS - 1; ++i) {
        if (isalnum((unsigned char)name[i])) {
            out[count++] = name[i];
        }
    }
    out[count] = '\0';
    return i == length && count > 0;
}

/* Levenshtein distance of two names. */
static int distance(const char *a, const char *b)
{
    int row[LETTERS], columns = (int)strlen(b);
    for (int j = 0; j <= columns; ++j) {
        row[j] = j;
    }
    for (int i = 0; a[i] != '\0'; ++i) {
        int diagonal = row[0];
        row[0] = i + 1;
        for (int j = 0; j < columns; ++j) {
            int replaced = diagonal + (a[i] != b[j]);
            int moved = 1 + (row[j] < row[j + 1] ? row[j] : row[j + 1]);
            diagonal = row[j + 1];
            row[j + 1] = replaced < moved ? replaced : moved;
        }
    }
    return row[columns];
}

static bool same_without_case(const char *a, const char *b)
{
    while (*a != '\0' && tolower((unsigned char)*a) == tolower((unsigned char)*b)) {
        ++a;
        ++b;
    }
    return *a == *b;
}

/* Distance of a name from a column name, relative to its letters [%]; 100: not similar. One letter
 * in three may differ, but not the first. The word before the unit is enough, and so is a name
 * without unit. */
static int unlikeness(const char *name, const char *column)
{
    char a[LETTERS], b[LETTERS];
    size_t stem_a = 0, stem_b = 0;
    if (!letters(name, a, &stem_a) || !letters(column, b, &stem_b)) {
        return 100;
    }
    int length = (int)strlen(b), unlike = 100 * distance(a, b) / length;
    bool same_stem = stem_a == stem_b && strncmp(name, column, stem_a) == 0 &&
                     (stem_a == strlen(a) || (stem_a > 1 && strncmp(name, "cmd", 3) != 0));
    if (same_without_case(a, b)) {
        return 0;
    }
    return a[0] == b[0] && (unlike <= 34 || same_stem) ? unlike : 100;
}

/* A position whose frame is not named: north, east and down only if z points down. */
static int position(const char *name)
{
    static const char *const names[3] = {"x_m", "y_m", "z_m"};
    for (int i = 0; i < 3; ++i) {
        if (strcmp(name, names[i]) == 0) {
            return CSV_POSITION + i;
        }
    }
    return -1;
}

const char *columns_degrees(const char *name)
{
    return strstr(name, "deg");
}

int columns_like(const char *name)
{
    if (position(name) >= 0) {
        return position(name);
    }
    char radians[2 * LETTERS];
    const char *degrees = columns_degrees(name);
    int before = degrees != NULL ? (int)(degrees - name) : (int)strlen(name);
    int length = snprintf(radians, sizeof radians, "%.*s%s%s", before, name,
                          degrees != NULL ? "rad" : "", degrees != NULL ? degrees + 3 : "");
    int found = -1, min_distance = 100;
    for (int c = 0; c < CSV_COLUMNS && length < (int)sizeof radians; ++c) {
        int unlike = unlikeness(radians, csv_name[c]);
        if (unlike < min_distance) {
            min_distance = unlike;
            found = c;
        }
    }
    return found;
}
