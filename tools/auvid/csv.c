#include "csv.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "report_error.h"

#define LARGEST 1e6      /* largest value: its square must fit a float */
#define LARGEST_TIME 1e9 /* largest time since the first row [s] */

const char *const csv_name[CSV_COLUMNS] = {
    "t_s",     "phi_rad",   "theta_rad", "psi_rad",   "u_mps",     "v_mps",     "w_mps",
    "p_radps", "q_radps",   "r_radps",   "X_N",       "Y_N",       "Z_N",       "K_Nm",
    "M_Nm",    "N_Nm",      "cmd_surge", "cmd_sway",  "cmd_heave", "cmd_roll",  "cmd_pitch",
    "cmd_yaw", "ref_surge", "ref_sway",  "ref_heave", "ref_roll",  "ref_pitch", "ref_yaw"};

/* State of the reader. A field is the text between commas, without blanks and quotes. */
typedef struct {
    csv_log_t *log;
    char *text, *at; /* the file; start of the next line */
    size_t line;     /* number of the current line, from 1 */
    char *start;     /* start of the current line */
    size_t length;   /* its length */
    bool whole;      /* it has a line end */
    int fields;      /* number of fields in the header */
    int *column;     /* [fields] column of the log, or -1 */
    size_t room;     /* capacity in rows */
} reader_t;

static int out_of_memory(const char *path)
{
    return report_error("%s: not enough memory", path);
}

/* Reads the whole file, with a terminating zero. */
static int slurp(const char *path, char **out, size_t *size)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    size_t used = 0, room = 0;
    if (file == NULL) {
        return report_error("%s: %s", path, strerror(errno));
    }
    for (;;) {
        if (used + 1 >= room) {
            room = room == 0 ? 65536 : 2 * room;
            char *more = realloc(text, room);
            if (more == NULL) {
                free(text);
                (void)fclose(file);
                return out_of_memory(path);
            }
            text = more;
        }
        errno = 0;
        size_t got = fread(text + used, 1, room - used - 1, file);
        used += got;
        if (got == 0) {
            break;
        }
    }
    int problem = ferror(file) ? (errno != 0 ? errno : EIO) : 0;
    (void)fclose(file);
    if (problem != 0) {
        free(text);
        return report_error("%s: %s", path, strerror(problem));
    }
    text[used] = '\0';
    *out = text;
    *size = used;
    return 0;
}

/* Takes the next line of the text; NULL at the end. Empty lines are skipped. */
static char *next_line(reader_t *r)
{
    while (*r->at != '\0') {
        r->start = r->at;
        ++r->line;
        char *end = r->at + strcspn(r->at, "\n");
        r->whole = *end == '\n';
        r->at = r->whole ? end + 1 : end;
        *end = '\0';
        if (end > r->start && end[-1] == '\r') {
            end[-1] = '\0';
        }
        r->length = strlen(r->start);
        if (r->start[strspn(r->start, " \t")] != '\0') {
            return r->start;
        }
    }
    return NULL;
}

/* Takes the next field from *rest; NULL after the last one. */
static char *next_field(char **rest)
{
    char *field = *rest;
    if (field == NULL) {
        return NULL;
    }
    char *end = field + strcspn(field, ",");
    *rest = *end == ',' ? end + 1 : NULL;
    *end = '\0';
    field += strspn(field, " \t\"");
    for (end = field + strlen(field); end > field && strchr(" \t\"", end[-1]) != NULL; --end) {
        end[-1] = '\0';
    }
    return field;
}

static size_t column_of(const reader_t *r, const char *field)
{
    return (size_t)(field - r->start) + 1;
}

static int known_column(const char *name)
{
    for (int i = 0; i < CSV_COLUMNS; ++i) {
        if (strcmp(name, csv_name[i]) == 0) {
            return i;
        }
    }
    return -1;
}

static void add_name(csv_list_t list, const char *name)
{
    static const char rest[] = ", ...";
    size_t used = strlen(list), end = sizeof rest - 1;
    const char *comma = used > 0 ? ", " : "";
    bool full = used >= end && strcmp(list + used - end, rest) == 0;
    bool fits = used + strlen(comma) + strlen(name) + sizeof rest <= sizeof(csv_list_t);
    if (!full) {
        (void)snprintf(list + used, sizeof(csv_list_t) - used, "%s%s", fits ? comma : rest,
                       fits ? name : "");
    }
}

int csv_missing(const csv_log_t *log, int column, const char *why)
{
    const char *like = log->like[column];
    return report_error("%s:%zu:1: no column %s in the header%s%s%s%s", log->path, log->header,
                        csv_name[column], why, like[0] != '\0' ? "; " : "", like,
                        like[0] != '\0' ? " resembles it" : "");
}

void csv_ignore(csv_log_t *log, int column)
{
    add_name(log->ignored, csv_name[column]);
}

void csv_notes(const csv_log_t *log)
{
    csv_list_t like = "";
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        if (log->like[c][0] != '\0') {
            char pair[64];
            (void)snprintf(pair, sizeof pair, "%s resembles %s", log->like[c], csv_name[c]);
            add_name(like, pair);
        }
    }
    if (log->cut > 0) {
        report_warning("%s:%zu: the last line has no line end and may be truncated: it is ignored",
                       log->path, log->cut);
    }
    if (log->ignored[0] != '\0') {
        report_error_line("%s: ignored columns: %s%s%s%s", log->path, log->ignored,
                          like[0] != '\0' ? " (" : "", like, like[0] != '\0' ? ")" : "");
    }
}

/* Name of the separator of the columns if it is not the comma; else NULL. */
static const char *other_separator(const char *line)
{
    int commas = 0, semicolons = 0, tabs = 0;
    for (; *line != '\0'; ++line) {
        commas += *line == ',';
        semicolons += *line == ';';
        tabs += *line == '\t';
    }
    return semicolons > commas ? "semicolons" : tabs > commas ? "tabs" : NULL;
}

static int read_name(reader_t *r, const char *field, int *column)
{
    csv_log_t *log = r->log;
    int like = columns_like(field);
    *column = known_column(field);
    add_name(log->columns, field);
    if (*column < 0) {
        add_name(log->ignored, field);
        if (like >= 0) {
            (void)snprintf(log->like[like], sizeof log->like[like], "%s", field);
        }
        return 0;
    }
    if (log->has[*column]) {
        return report_error("%s:%zu:%zu: duplicate column %s", log->path, r->line,
                            column_of(r, field), field);
    }
    log->has[*column] = true;
    return 0;
}

static int read_header(reader_t *r)
{
    csv_log_t *log = r->log;
    if (strncmp(r->at, "\xef\xbb\xbf", 3) == 0) {
        r->at += 3; /* a byte order mark */
    }
    char *rest = next_line(r);
    if (rest == NULL) {
        return report_error("%s:1:1: the file is empty", log->path);
    }
    const char *separator = other_separator(rest);
    log->header = r->line;
    r->fields = 1;
    for (const char *c = rest; *c != '\0'; ++c) {
        r->fields += *c == ',';
    }
    r->column = malloc((size_t)r->fields * sizeof r->column[0]);
    if (r->column == NULL) {
        return out_of_memory(log->path);
    }
    for (int i = 0; i < r->fields; ++i) {
        if (read_name(r, next_field(&rest), &r->column[i]) != 0) {
            return EXIT_REFUSED;
        }
    }
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        log->like[c][0] = log->has[c] ? '\0' : log->like[c][0];
    }
    if (!log->has[CSV_T]) {
        char why[sizeof(csv_list_t) + 64];
        (void)snprintf(why, sizeof why,
                       separator != NULL ? ": its columns are separated by %s; "
                                           "separate them by commas"
                                         : "; its columns are: %s",
                       separator != NULL ? separator : log->columns);
        return csv_missing(log, CSV_T, why);
    }
    return 0;
}

/* Parses one field into the row. */
static int read_value(const reader_t *r, const char *field, int column, double *value)
{
    char *end = NULL;
    *value = strtod(field, &end);
    bool plain = field[0] != '\0' && field[strspn(field, "0123456789+-.eE")] == '\0';
    const char *trouble = NULL;
    if (field[0] == '\0') {
        trouble = "is empty";
    } else if (end == field || *end != '\0' || (!plain && isfinite(*value))) {
        trouble = "is not a number";
    } else if (!isfinite(*value)) {
        trouble = "is not a finite number";
    } else if (column != CSV_T && fabs(*value) > LARGEST) {
        trouble = "is beyond +-1e6";
    }
    return trouble == NULL ? 0
                           : report_error("%s:%zu:%zu: %s: '%.24s' %s", r->log->path, r->line,
                                          column_of(r, field), csv_name[column], field, trouble);
}

static int check_time(const reader_t *r, const char *field, const csv_row_t *row)
{
    const csv_log_t *log = r->log;
    double t = row->value[CSV_T];
    const char *trouble = NULL;
    if (log->rows > 0 && t <= log->row[log->rows - 1].value[CSV_T]) {
        trouble =
            t < log->row[log->rows - 1].value[CSV_T] ? "time goes back" : "time does not advance";
    } else if (log->rows > 0 && t - log->row[0].value[CSV_T] > LARGEST_TIME) {
        trouble = "more than 1e9 s after the first row";
    }
    return trouble == NULL ? 0
                           : report_error("%s:%zu:%zu: t_s: %s: '%.24s'", log->path, r->line,
                                          column_of(r, field), trouble, field);
}

static int read_row(reader_t *r, char *rest, csv_row_t *row)
{
    const char *time_field = r->start;
    memset(row, 0, sizeof *row);
    for (int i = 0; i < r->fields; ++i) {
        char *field = next_field(&rest);
        if (field == NULL) {
            return report_error("%s:%zu:%zu: the row ends after %d of %d columns", r->log->path,
                                r->line, r->length + 1, i, r->fields);
        }
        int column = r->column[i];
        if (column >= 0 && read_value(r, field, column, &row->value[column]) != 0) {
            return EXIT_REFUSED;
        }
        time_field = column == CSV_T ? field : time_field;
    }
    if (rest != NULL) {
        return report_error("%s:%zu:%zu: the row has more than %d columns", r->log->path, r->line,
                            column_of(r, rest), r->fields);
    }
    return check_time(r, time_field, row);
}

static int read_rows(reader_t *r)
{
    csv_log_t *log = r->log;
    for (char *line = next_line(r); line != NULL; line = next_line(r)) {
        if (!r->whole) {
            log->cut = r->line;
            break;
        }
        if (log->rows == r->room) {
            r->room = r->room == 0 ? 1024 : 2 * r->room;
            csv_row_t *more = realloc(log->row, r->room * sizeof *more);
            if (more == NULL) {
                return out_of_memory(log->path);
            }
            log->row = more;
        }
        if (read_row(r, line, &log->row[log->rows]) != 0) {
            return EXIT_REFUSED;
        }
        ++log->rows;
    }
    if (log->rows < 2) {
        return report_error("%s:%zu:1: %s", log->path, r->line,
                            log->rows == 0 ? "no row after the header"
                                           : "only one row: at least two are needed");
    }
    return 0;
}

int csv_read(csv_log_t *log, const char *path)
{
    reader_t r = {.log = log};
    size_t size = 0;
    memset(log, 0, sizeof *log);
    log->path = path;
    if (slurp(path, &r.text, &size) != 0) {
        return EXIT_REFUSED;
    }
    r.at = r.text;
    int status = 0;
    if (strlen(r.text) != size) {
        status = report_error("%s: not a text file", path);
    }
    if (status == 0) {
        status = read_header(&r);
    }
    if (status == 0) {
        status = read_rows(&r);
    }
    free(r.column);
    free(r.text);
    if (status != 0) {
        csv_free(log);
    }
    return status;
}

void csv_free(csv_log_t *log)
{
    free(log->row);
    log->row = NULL;
    log->rows = 0;
}

int csv_create(csv_writer_t *writer, const char *path)
{
    const char *suffix = ".part";
    size_t length = strlen(path);
    *writer = (csv_writer_t){.path = path};
    if (strncmp(path, "/dev/", 5) != 0) { /* a device cannot be replaced */
        writer->temporary = malloc(length + strlen(suffix) + 1);
        if (writer->temporary == NULL) {
            return out_of_memory(path);
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
        fprintf(writer->file, ",%.9g", row->value[i]);
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
