/*
 * The header of a log: which columns it has.
 */
#include "csv.h"

#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "../base/report_error.h"

const char *const csv_name[CSV_COLUMNS] = {
    "t_s",          "phi_rad",      "theta_rad",    "psi_rad",      "u_mps",        "v_mps",
    "w_mps",        "p_radps",      "q_radps",      "r_radps",      "X_N",          "Y_N",
    "Z_N",          "K_Nm",         "M_Nm",         "N_Nm",         "cmd_surge",    "cmd_sway",
    "cmd_heave",    "cmd_roll",     "cmd_pitch",    "cmd_yaw",      "ref_surge",    "ref_sway",
    "ref_heave",    "ref_roll",     "ref_pitch",    "ref_yaw",      "qw",           "qx",
    "qy",           "qz",           "north_m",      "east_m",       "depth_m",      "fx_mps2",
    "fy_mps2",      "fz_mps2",      "thruster_1",   "thruster_2",   "thruster_3",   "thruster_4",
    "thruster_5",   "thruster_6",   "thruster_7",   "thruster_8",   "thruster_1_N", "thruster_2_N",
    "thruster_3_N", "thruster_4_N", "thruster_5_N", "thruster_6_N", "thruster_7_N", "thruster_8_N",
    "rpm_1",        "rpm_2",        "rpm_3",        "rpm_4",        "rpm_5",        "rpm_6",
    "rpm_7",        "rpm_8",        "voltage_V",    "weight_N"};

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
    const char *but = columns_degrees(like) != NULL ? ", but is in degrees" : "";
    return report_error("%s:%zu:1: no column %s in the header%s%s%s%s%s", log->path, log->header,
                        csv_name[column], why, like[0] != '\0' ? "; " : "", like,
                        like[0] != '\0' ? " resembles it" : "", but);
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

static int read_name(csv_log_t *log, const char *field, int *column)
{
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
        return report_error("%s:%zu:%zu: duplicate column %s", log->path, log->header,
                            csv_field_column(&log->lines, field), field);
    }
    log->has[*column] = true;
    return 0;
}

/* A quaternion is the attitude unless the log has the angles, too. */
static int read_quaternion(csv_log_t *log)
{
    bool angles =
        log->has[CSV_ATTITUDE] || log->has[CSV_ATTITUDE + 1] || log->has[CSV_ATTITUDE + 2];
    int components = 0, missing = -1;
    for (int c = CSV_QUATERNION; c < CSV_QUATERNION + 4; ++c) {
        components += log->has[c];
        missing = log->has[c] ? missing : c;
        if (angles && log->has[c]) {
            csv_ignore(log, c);
            log->has[c] = false;
        }
    }
    if (angles || components == 0) {
        return 0;
    }
    if (missing >= 0) {
        return csv_missing(log, missing, ": a quaternion needs qw, qx, qy and qz");
    }
    log->quaternion = true;
    log->has[CSV_ATTITUDE] = log->has[CSV_ATTITUDE + 1] = log->has[CSV_ATTITUDE + 2] = true;
    return 0;
}

/* Have the numbers of the first row, whose separator is not the comma, decimal commas? */
static bool has_decimal_commas(csv_log_t *log)
{
    return csv_lines_next(&log->lines) == 0 && strchr(log->lines.start, ',') != NULL &&
           strchr(log->lines.start, '.') == NULL;
}

static int no_time(csv_log_t *log, const char *separator)
{
    char why[sizeof(csv_list_t) + 80];
    if (separator != NULL) {
        (void)snprintf(why, sizeof why, ": its columns are separated by %s%s", separator,
                       has_decimal_commas(log) ? ", its numbers have decimal commas: write points, "
                                                 "then separate the columns by commas"
                                               : "; separate them by commas");
    } else {
        (void)snprintf(why, sizeof why,
                       ", time in s (auvid-log --map converts others); its columns are: %s",
                       log->columns);
    }
    return csv_missing(log, CSV_T, why);
}

/* Reads the line of the header, past comments. *line: the header; some programs begin it with #,
 * as if it were a comment. */
static int find_header(csv_log_t *log, char **line)
{
    static const char blanks[] = " \t#";
    bool comment = false;
    int status = csv_lines_next(&log->lines);
    while (status == 0 && log->lines.start[0] == '#') {
        char *name = log->lines.start + strspn(log->lines.start, blanks);
        size_t length = strlen(csv_name[CSV_T]);
        if (strncmp(name, csv_name[CSV_T], length) == 0 && name[length] == ',') {
            *line = name;
            return 0;
        }
        comment = true;
        status = csv_lines_next(&log->lines);
    }
    *line = log->lines.start;
    return status != CSV_END ? status
           : comment
               ? report_error("%s:%zu:1: no header after the comments", log->path, log->lines.line)
               : report_error("%s:1:1: the file is empty", log->path);
}

int csv_read_header(csv_log_t *log)
{
    char *rest = NULL;
    int status = find_header(log, &rest);
    if (status != 0) {
        return status;
    }
    const char *separator = other_separator(rest);
    log->header = log->lines.line;
    log->fields = 1;
    for (const char *c = rest; *c != '\0'; ++c) {
        log->fields += *c == ',';
    }
    log->column = malloc((size_t)log->fields * sizeof log->column[0]);
    if (log->column == NULL) {
        return report_error("%s: not enough memory", log->path);
    }
    for (int i = 0; i < log->fields; ++i) {
        if (read_name(log, csv_field(&rest), &log->column[i]) != 0) {
            return EXIT_REFUSED;
        }
    }
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        log->like[c][0] = log->has[c] ? '\0' : log->like[c][0];
    }
    return log->has[CSV_T] ? read_quaternion(log) : no_time(log, separator);
}
