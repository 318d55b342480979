#include "ini.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A line that is being read: its bytes within the text, without the line end. */
typedef struct {
    ini_t *ini;
    char *begin, *end;
    int number;
    const char *section; /* that it is in; NULL: none yet */
} line_t;

bool ini_refuse(ini_t *ini, int line, int column, const char *format, ...)
{
    if (ini->message[0] == '\0') {
        va_list arguments;
        int at = snprintf(ini->message, sizeof ini->message, "%s:%d:%d: ", ini->path, line, column);
        va_start(arguments, format);
        if (at > 0 && (size_t)at < sizeof ini->message) {
            (void)vsnprintf(ini->message + at, sizeof ini->message - (size_t)at, format, arguments);
        }
        va_end(arguments);
    }
    return false;
}

static bool refuse_at(const line_t *line, const char *at, const char *what)
{
    return ini_refuse(line->ini, line->number, (int)(at - line->begin) + 1, "%s", what);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool is_name(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
}

static char *skip_blanks(char *at)
{
    while (is_blank(*at)) {
        ++at;
    }
    return at;
}

static char *skip_name(char *at)
{
    while (is_name(*at)) {
        ++at;
    }
    return at;
}

ini_entry_t *ini_find(ini_t *ini, const char *section, const char *key)
{
    for (int i = 0; i < ini->entries; ++i) {
        ini_entry_t *e = &ini->entry[i];
        if (strcmp(e->section, section) == 0 && strcmp(e->key, key) == 0) {
            return e;
        }
    }
    return NULL;
}

int ini_line(ini_t *ini, const char *section)
{
    const ini_entry_t *e = ini_find(ini, section, "");
    return e != NULL ? e->line : 1;
}

bool ini_refuse_key(ini_t *ini, const char *section, const char *key, const char *what)
{
    const ini_entry_t *e = ini_find(ini, section, key);
    return ini_refuse(ini, e != NULL ? e->line : ini_line(ini, section),
                      e != NULL ? e->key_column : 1, "%s %s", key, what);
}

/* Adds a section (key "") or a key. Both names are terminated already. */
static bool add(const line_t *line, const char *section, const char *key, const char *value)
{
    ini_t *ini = line->ini;
    const char *at = key[0] == '\0' ? section : key;
    int column = (int)(at - line->begin) + 1;
    const ini_entry_t *before = ini_find(ini, section, key);
    if (before != NULL) {
        return ini_refuse(ini, line->number, column,
                          "duplicate %s '%s': it stands in line %d already; keep one of them",
                          key[0] == '\0' ? "section" : "key", at, before->line);
    }
    if (ini->entries == INI_ENTRIES) {
        return ini_refuse(ini, line->number, column,
                          "more than %d keys and sections; leave out what has its default",
                          INI_ENTRIES);
    }
    ini->entry[ini->entries++] = (ini_entry_t){.section = section,
                                               .key = key,
                                               .value = value,
                                               .line = line->number,
                                               .key_column = column,
                                               .value_column = (int)(value - line->begin) + 1};
    return true;
}

/* Ends the line where a comment begins, and before the blanks there. */
static void strip_comment(line_t *line)
{
    for (char *c = line->begin; c < line->end; ++c) {
        if ((*c == '#' || *c == ';') && (c == line->begin || is_blank(c[-1]))) {
            line->end = c;
        }
    }
    while (line->end > line->begin && is_blank(line->end[-1])) {
        --line->end;
    }
    *line->end = '\0';
}

static bool check_line(const line_t *line)
{
    if (line->end - line->begin > INI_LINE) {
        return ini_refuse(line->ini, line->number, INI_LINE + 1,
                          "the line has more than %d characters; shorten it", INI_LINE);
    }
    for (const char *c = line->begin; c < line->end; ++c) {
        if ((unsigned char)*c < ' ' && *c != '\t') {
            return refuse_at(line, c, "a control character; save the file as plain text");
        }
    }
    return true;
}

static bool take_section(line_t *line, char *at)
{
    char *name = skip_blanks(at + 1), *end = skip_name(name), *close = skip_blanks(end);
    if (end == name || *close != ']') {
        return refuse_at(line, close, "a section is [name], of letters, digits, _ - and .");
    }
    if (close + 1 != line->end) {
        return refuse_at(line, close + 1, "text after the ']' of a section; begin a new line");
    }
    *end = '\0';
    line->section = name;
    return add(line, name, "", close + 1);
}

static bool take_key(line_t *line, char *key)
{
    char *end = skip_name(key), *equals = skip_blanks(end);
    if (end == key || *equals != '=') {
        return refuse_at(line, equals, "expected [section] or key = value");
    }
    if (line->section == NULL) {
        return refuse_at(line, key, "a key before the first [section]; put it below one");
    }
    char *value = skip_blanks(equals + 1);
    if (*value == '\0') {
        return refuse_at(line, value, "the key has no value; write one, or delete the line");
    }
    *end = '\0';
    return add(line, line->section, key, value);
}

static bool take_line(line_t *line)
{
    if (!check_line(line)) {
        return false;
    }
    strip_comment(line);
    char *at = skip_blanks(line->begin);
    return at == line->end || (*at == '[' ? take_section(line, at) : take_key(line, at));
}

bool ini_parse(ini_t *ini, const char *path, const char *text, size_t length)
{
    line_t line = {.ini = ini, .number = 1};
    bool whole = length <= INI_BYTES;
    ini->path = path;
    ini->entries = 0;
    ini->message[0] = '\0';
    length = whole ? length : INI_BYTES;
    memcpy(ini->text, text, length);
    ini->text[length] = '\0';
    char *next = ini->text, *stop = ini->text + length;
    next += length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* byte order mark */
    for (; next < stop; ++line.number) {
        char *feed = memchr(next, '\n', (size_t)(stop - next));
        line.begin = next;
        line.end = feed != NULL ? feed : stop;
        next = line.end + 1;
        line.end -= line.end > line.begin && line.end[-1] == '\r';
        if (!take_line(&line)) {
            return false;
        }
    }
    return whole || ini_refuse(ini, line.number, 1, "the file has more than %d bytes; shorten it",
                               INI_BYTES);
}

int ini_word(const ini_entry_t *entry, size_t *at, char *word, size_t size)
{
    const char *begin = entry->value + *at;
    begin += strspn(begin, " \t");
    size_t length = *begin == ',' ? 1 : strcspn(begin, " \t,");
    *at = (size_t)(begin - entry->value) + length;
    length = length < size ? length : size - 1;
    memcpy(word, begin, length);
    word[length] = '\0';
    return entry->value_column + (int)(begin - entry->value);
}

bool ini_numbers(ini_t *ini, const ini_entry_t *entry, int least, int most, double *out, int *count)
{
    char word[64];
    size_t at = 0;
    int n = 0;
    for (int column = ini_word(entry, &at, word, sizeof word); word[0] != '\0';
         column = ini_word(entry, &at, word, sizeof word)) {
        char *end = NULL;
        double x = strtod(word, &end);
        bool cut = strlen(word) == sizeof word - 1;
        if (strcmp(word, ",") == 0) {
            return ini_refuse(ini, entry->line, column,
                              "%s: a comma: separate numbers by blanks, decimals by a point",
                              entry->key);
        }
        if (cut || end == word || *end != '\0' || word[strspn(word, "0123456789+-.eE")] != '\0') {
            return ini_refuse(ini, entry->line, column,
                              "%s: '%s' is not a finite decimal number such as -1.5e3", entry->key,
                              word);
        }
        if (!isfinite(x)) {
            return ini_refuse(ini, entry->line, column, "%s: '%s' is too large", entry->key, word);
        }
        if (n == most) {
            return ini_refuse(ini, entry->line, column, "%s: more than %d number%s", entry->key,
                              most, most == 1 ? "" : "s");
        }
        out[n++] = x;
    }
    if (n < least) {
        return ini_refuse(ini, entry->line, entry->value_column,
                          "%s: %d numbers, separated by blanks, but it needs %d", entry->key, n,
                          least);
    }
    if (count != NULL) {
        *count = n;
    }
    return true;
}
