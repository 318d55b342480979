/*
 * Writes logs as comma-separated values.
 */
#include "csv.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"

int csv_create(csv_writer_t *writer, const char *path)
{
    const char *suffix = ".part";
    size_t length = strlen(path);
    *writer = (csv_writer_t){.path = path};
    if (strncmp(path, "/dev/", 5) != 0) { /* a device cannot be replaced */
        writer->temporary = malloc(length + strlen(suffix) + 1);
        if (writer->temporary == NULL) {
            return report_error("%s: not enough memory", path);
        }
        memcpy(writer->temporary, path, length);
        memcpy(writer->temporary + length, suffix, strlen(suffix) + 1);
    }
    writer->file = fopen(writer->temporary == NULL ? path : writer->temporary, "w");
    if (writer->file == NULL) {
        int problem = errno;
        free(writer->temporary);
        writer->temporary = NULL;
        return report_error("%s: cannot be written: %s", path, strerror(problem));
    }
    return 0;
}

void csv_write_header(csv_writer_t *writer)
{
    for (int i = 0; i < CSV_COMMAND; ++i) {
        fprintf(writer->file, "%s%s", i == 0 ? "" : ",", csv_name[i]);
    }
    fputc('\n', writer->file);
}

void csv_write_row(csv_writer_t *writer, const csv_row_t *row)
{
    fprintf(writer->file, "%.6f", row->value[CSV_T]);
    for (int i = CSV_T + 1; i < CSV_COMMAND; ++i) {
        fprintf(writer->file, csv_has(row, i) ? ",%.9g" : ",", row->value[i]);
    }
    fputc('\n', writer->file);
}

int csv_commit(csv_writer_t *writer)
{
    errno = 0;
    bool bad = ferror(writer->file) != 0;
    bad = fclose(writer->file) != 0 || bad;
    writer->file = NULL;
    if (!bad && writer->temporary != NULL) {
        bad = rename(writer->temporary, writer->path) != 0;
    }
    if (bad) {
        int problem = errno != 0 ? errno : EIO;
        (void)report_error("%s: cannot be written: %s", writer->path, strerror(problem));
        csv_discard(writer);
        return EXIT_REFUSED;
    }
    free(writer->temporary);
    writer->temporary = NULL;
    return 0;
}

void csv_discard(csv_writer_t *writer)
{
    if (writer->file != NULL) {
        (void)fclose(writer->file);
        writer->file = NULL;
    }
    if (writer->temporary != NULL) {
        (void)remove(writer->temporary);
        free(writer->temporary);
        writer->temporary = NULL;
    }
}
