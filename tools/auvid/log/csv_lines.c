#include "csv_lines.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"
#include "../base/report_error.h"

enum { ROOM = 65536 }; /* the longest line */

static int cannot_read(const csv_lines_t *lines, int problem)
{
    return report_error("%s: %s", lines->path, strerror(problem != 0 ? problem : EIO));
}

/* Copies the rest of a stream to a temporary file, which replaces it. */
static int spool(csv_lines_t *lines)
{
    FILE *copy = tmpfile();
    size_t got = 0;
    if (copy == NULL) {
        return report_error("%s: cannot be read twice, and there is no temporary file: %s",
                            lines->path, strerror(errno));
    }
    errno = 0;
    do {
        got = fread(lines->block, 1, ROOM, lines->file);
    } while (got > 0 && fwrite(lines->block, 1, got, copy) == got);
    int problem = errno;
    bool bad = ferror(lines->file) || ferror(copy);
    (void)fclose(lines->file);
    lines->file = copy;
    return bad ? cannot_read(lines, problem) : csv_lines_rewind(lines);
}

int csv_lines_open(csv_lines_t *lines, const char *path)
{
    *lines = (csv_lines_t){.path = path, .file = fopen(path, "rb")};
    if (lines->file == NULL) {
        return cannot_read(lines, errno);
    }
    lines->block = malloc(ROOM + 1);
    int status = lines->block == NULL ? report_error("%s: not enough memory", path)
                 : fseek(lines->file, 0, SEEK_SET) != 0 ? spool(lines)
                                                        : 0;
    if (status != 0) {
        csv_lines_close(lines);
    }
    return status;
}

int csv_lines_rewind(csv_lines_t *lines)
{
    errno = 0;
    if (fseek(lines->file, 0, SEEK_SET) != 0) {
        return cannot_read(lines, errno);
    }
    lines->at = lines->used = lines->line = 0;
    lines->ended = false;
    return 0;
}

void csv_lines_close(csv_lines_t *lines)
{
    free(lines->block);
    if (lines->file != NULL) {
        (void)fclose(lines->file);
    }
    *lines = (csv_lines_t){0};
}

/* Fills the block behind the part that is not read yet. */
static int fill(csv_lines_t *lines)
{
    bool start = lines->line == 0 && lines->used == 0;
    lines->used -= lines->at;
    memmove(lines->block, lines->block + lines->at, lines->used);
    lines->at = 0;
    if (lines->used == ROOM) {
        return report_error("%s:%zu:1: the line is longer than %d characters: not a log",
                            lines->path, lines->line + 1, ROOM - 1);
    }
    errno = 0;
    size_t got = fread(lines->block + lines->used, 1, ROOM - lines->used, lines->file);
    if (got == 0 && ferror(lines->file)) {
        return cannot_read(lines, errno);
    }
    lines->used += got;
    lines->ended = got == 0;
    if (start && lines->used >= 3 && memcmp(lines->block, "\xef\xbb\xbf", 3) == 0) {
        lines->at = 3; /* a byte order mark */
    }
    return 0;
}

/* Reads the next line, which may be empty. */
static int next_line(csv_lines_t *lines)
{
    char *end = NULL;
    while ((end = memchr(lines->block + lines->at, '\n', lines->used - lines->at)) == NULL &&
           !lines->ended) {
        if (fill(lines) != 0) {
            return EXIT_REFUSED;
        }
    }
    if (lines->at == lines->used) {
        return CSV_END;
    }
    lines->start = lines->block + lines->at;
    lines->whole = end != NULL;
    end = lines->whole ? end : lines->block + lines->used;
    lines->at = (size_t)(end - lines->block) + (lines->whole ? 1u : 0u);
    lines->length = (size_t)(end - lines->start);
    ++lines->line;
    if (memchr(lines->start, '\0', lines->length) != NULL) {
        return report_error("%s: not a text file", lines->path);
    }
    if (lines->length > 0 && end[-1] == '\r') {
        --lines->length;
    }
    lines->start[lines->length] = '\0';
    return 0;
}

int csv_lines_next(csv_lines_t *lines)
{
    int status = 0;
    do {
        status = next_line(lines);
    } while (status == 0 && lines->start[strspn(lines->start, " \t")] == '\0');
    return status;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '"';
}

char *csv_field(char **rest)
{
    char *field = *rest, *end = field;
    if (field == NULL) {
        return NULL;
    }
    while (*end != ',' && *end != '\0') {
        ++end;
    }
    *rest = *end == ',' ? end + 1 : NULL;
    *end = '\0';
    while (is_blank(*field)) {
        ++field;
    }
    while (end > field && is_blank(end[-1])) {
        *--end = '\0';
    }
    return field;
}

size_t csv_field_column(const csv_lines_t *lines, const char *field)
{
    return (size_t)(field - lines->start) + 1;
}
