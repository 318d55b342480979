/*
 * The log doctor on a file: auvid check LOG.csv, and the lines before the result of fit.
 */
#include <stdio.h>
#include <stdlib.h>

#include "auvid/config.h"
#include "doctor.h"
#include "doctor_report.h"
#include "../base/json_string.h"
#include "../base/report_error.h"
#include "../log/velocity_times.h"
#include "../vehicle/vehicle_calibration.h"

/* Part of a log that gaps between velocities cost. */
#define MUCH_LOST 0.1
#define ALL_LOST 0.95
/* Usual time between velocities beyond which fit bridges none of them [s]. */
#define SLOWEST_S 1.0

static const char *const severity_name[] = {"note", "warning", "error"};

/* Of the codes, in JSON. */
static const char *const code_name[DOCTOR_CODES] = {
    [DOCTOR_ANGLE_DEGREES] = "angle_degrees",
    [DOCTOR_RATE_DEGREES] = "rate_degrees",
    [DOCTOR_ANGLE_SIGN] = "angle_sign",
    [DOCTOR_RATE_SIGN] = "rate_sign",
    [DOCTOR_RATE_EXCHANGED] = "rate_exchanged",
    [DOCTOR_FRAME] = "frame",
    [DOCTOR_WORLD_FRAME] = "world_frame",
    [DOCTOR_MOUNTING] = "mounting",
    [DOCTOR_QUATERNION] = "quaternion_order",
    [DOCTOR_ATTITUDE_SHIFT] = "attitude_shift",
    [DOCTOR_ATTITUDE] = "attitude",
    [DOCTOR_INPUT_SIGN] = "input_sign",
    [DOCTOR_VELOCITY_SIGN] = "velocity_sign",
    [DOCTOR_EITHER_SIGN] = "either_sign",
    [DOCTOR_INPUT_EXCHANGED] = "input_exchanged",
    [DOCTOR_VELOCITY_EXCHANGED] = "velocity_exchanged",
    [DOCTOR_EITHER_EXCHANGED] = "either_exchanged",
    [DOCTOR_INPUT_SHIFT] = "input_shift",
    [DOCTOR_VELOCITY_SHIFT] = "velocity_shift",
    [DOCTOR_INPUT_WITHOUT_EFFECT] = "input_without_effect",
    [DOCTOR_DEPTH_SIGN] = "depth_sign",
    [DOCTOR_DEPTH] = "depth",
    [DOCTOR_POSITION] = "position",
    [DOCTOR_FORCE_UNIT] = "force_unit",
    [DOCTOR_FORCE_SIGN] = "force_sign",
    [DOCTOR_FORCE_EXCHANGED] = "force_exchanged",
    [DOCTOR_NO_GRAVITY] = "no_gravity",
    [DOCTOR_THRUSTER_SIGN] = "thruster_sign",
    [DOCTOR_THRUSTER_SWAP] = "thruster_exchanged",
    [DOCTOR_THRUSTER_HIDDEN] = "thruster_unchecked",
    [DOCTOR_SCALE] = "scale",
    [DOCTOR_OFFSET] = "offset",
    [DOCTOR_HELD] = "held",
    [DOCTOR_OUTAGE] = "outage",
    [DOCTOR_OUTLIER] = "outlier",
    [DOCTOR_STUCK] = "stuck",
    [DOCTOR_MISSING] = "missing",
    [DOCTOR_QUANTISED] = "quantised",
    [DOCTOR_SATURATED] = "saturated",
    [DOCTOR_VOLTAGE] = "voltage",
    [DOCTOR_TIME] = "time",
    [DOCTOR_GAPS] = "gaps",
    [DOCTOR_VELOCITY_GAPS] = "velocity_gaps",
    [DOCTOR_SLOW] = "slow",
    [DOCTOR_SHORT] = "short",
    [DOCTOR_MOTION] = "motion",
};

/* Names velocities that are further apart than fit bridges. Sets the part of the log that this
 * costs. */
static void find_velocity_gaps(doctor_t *d, const velocity_times_t *times, log_t *log)
{
    velocity_gaps_t gaps;
    char remedy[80];
    double usual_s = velocity_times_usual(times);
    double gap_s =
        log->gap_s > 0.0 ? log->gap_s : velocity_gap_s(usual_s, velocity_times_row_s(times), 0.0);
    velocity_times_gaps(times, gap_s, &gaps);
    log->lost = gaps.lost;
    if (gaps.gaps == 0) {
        return;
    }
    (void)snprintf(remedy, sizeof remedy, "fit --max-gap %g bridges most of them", gaps.bridge_s);
    doctor_finding_t *f = doctor_add(
        d,
        gaps.lost > ALL_LOST    ? DOCTOR_ERROR
        : gaps.lost > MUCH_LOST ? DOCTOR_WARNING
                                : DOCTOR_NOTE,
        DOCTOR_VELOCITY_GAPS, CSV_NU, -1, NULL,
        "the velocity (u_mps ..) has %zu gap%s over %.2g s (usually a sample each "
        "%.2g s; the longest gap %.1f s): each one ends a record, and about %.0f %% "
        "of the log is lost: %s",
        gaps.gaps, gaps.gaps > 1 ? "s" : "", gap_s, usual_s, times->longest_s, 100.0 * gaps.lost,
        gaps.bridge_s > 0.0   ? remedy
        : usual_s > SLOWEST_S ? "log the velocity at 1 Hz or faster"
                              : "log the velocity without dropouts");
    if (f != NULL) {
        f->value = gaps.lost;
    }
}

/* Names a voltage that the vehicle file needs, but the log does not have. One in another unit is
 * named with the thrust. */
static void find_voltage(doctor_t *d, log_use_t *use, double largest_V)
{
    char text[LOG_THRUST_TEXT];
    if (use != NULL) {
        use->voltage_V = largest_V;
        if (log_voltage_judge(use, text, sizeof text) < 0) {
            (void)doctor_add(d, DOCTOR_WARNING, DOCTOR_VOLTAGE, CSV_VOLTAGE, -1, NULL, "%s", text);
        }
    }
}

/* Reads a whole open log. dry_mass_kg, known_force: see doctor_dry_mass. Returns 0, or EXIT_REFUSED
 * after one line on stderr. */
static int examine(doctor_t *doctor, log_t *of, log_use_t *use, double dry_mass_kg,
                   bool known_force)
{
    csv_row_t row;
    csv_log_t *log = &of->csv;
    velocity_times_t times = {0};
    double largest_V = 0.0;
    int status = csv_rewind(log);
    if (status != 0) {
        return status;
    }
    doctor_init(doctor, log->has);
    doctor->log = log;
    doctor_dry_mass(doctor, dry_mass_kg, known_force);
    if (use != NULL) {
        doctor_use(doctor, use);
    }
    while ((status = csv_next(log, &row)) == 0) {
        doctor_feed(doctor, &row);
        velocity_times_row(&times, &row);
        largest_V =
            csv_has(&row, CSV_VOLTAGE) ? fmax(largest_V, row.value[CSV_VOLTAGE]) : largest_V;
    }
    if (status == CSV_END) {
        find_velocity_gaps(doctor, &times, of);
        find_voltage(doctor, use, largest_V);
        doctor_finish(doctor);
        status = 0;
    }
    return status;
}

static void print_column(const char *key, int column)
{
    printf(", \"%s\": ", key);
    if (column >= 0) {
        json_string(stdout, csv_name[column]);
    } else {
        fputs("null", stdout);
    }
}

static void print_json(const doctor_t *d, const csv_log_t *log)
{
    static const char *const dof[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};
    printf("{\"version\": \"%s\", \"log\": ", AUVID_VERSION_STRING);
    json_string(stdout, log->path);
    printf(", \"rows\": %.0f, \"seconds\": %.6g, \"usable\": %s, \"verdict\": ", d->rows,
           d->last_s - d->start_s, d->usable ? "true" : "false");
    json_string(stdout, d->verdict);
    fputs(", \"usable_motion_s\": {", stdout);
    for (int j = 0; j < 6; ++j) {
        printf("%s\"%s\": %.4g", j > 0 ? ", " : "", dof[j], d->usable_s[j]);
    }
    fputs("}, \"findings\": [", stdout);
    for (int i = 0; i < d->findings; ++i) {
        const doctor_finding_t *f = &d->finding[i];
        printf("%s\n  {\"severity\": \"%s\", \"code\": \"%s\"", i > 0 ? "," : "",
               severity_name[f->severity], code_name[f->code]);
        print_column("column", f->column);
        print_column("other", f->other);
        printf(", \"value\": %.6g, \"from_s\": %.9g, \"to_s\": %.9g, \"sentence\": ", f->value,
               f->from_s, f->to_s);
        json_string(stdout, f->text);
        putchar('}');
    }
    puts("]}");
}

static void print_text(const doctor_t *d, const csv_log_t *log)
{
    printf("auvid %s check: %s\n  %.0f rows in %.0f s\n", AUVID_VERSION_STRING, log->path, d->rows,
           d->last_s - d->start_s);
    for (int i = 0; i < d->findings; ++i) {
        const doctor_finding_t *f = &d->finding[i];
        printf("  %-8s %s\n", severity_name[f->severity], f->text);
    }
    printf("%s\n", d->verdict);
}

/* A force that is known at no time of the log has no effect: refused, as by fit. */
static int check_known_forces(const csv_log_t *log, const options_t *options)
{
    vehicle_calibration_t known[VEHICLE_CALIBRATIONS];
    char text[300];
    int count =
        options->whole ? vehicle_calibrations_of(options->vehicle, log->path, true, known) : 0;
    return vehicle_calibrations_miss(known, count, log->first_s, log->last_s, text, sizeof text)
               ? report_error("%s: %s", log->path, text)
               : 0;
}

/* Takes the thrusters of the vehicle as inputs, if the log has them: all of them, as for fit. */
static int take_thrusters(const csv_log_t *log, const vehicle_t *vehicle, log_use_t *use,
                          bool *thrusters)
{
    bool any = false;
    *thrusters = log_use_thrusters(use, vehicle, log->has);
    for (int k = 0; k < log_inputs(use); ++k) {
        any = any || log->has[log_input(use, k)];
    }
    return any ? log_check_thrusters(use, log) : 0;
}

static bool has_wrench(const csv_log_t *log)
{
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        any = any || log->has[CSV_WRENCH + j];
    }
    return any;
}

/* The same with the vehicle of the options, if there is one. */
static int examine_whole(doctor_t *doctor, log_t *log, log_use_t *use, const options_t *options)
{
    const vehicle_t *v = options->whole ? options->vehicle : NULL;
    bool known_force = log->csv.has[CSV_WEIGHT] || (v != NULL && v->calibrations > 0);
    return examine(doctor, log, use, v != NULL ? (double)v->dry_mass_kg : 0.0, known_force);
}

int doctor_check(const char *file, const options_t *options)
{
    log_t log = {0};
    log_use_t use = {0};
    doctor_t *doctor = malloc(sizeof *doctor);
    if (doctor == NULL) {
        return report_error("check: not enough memory");
    }
    bool thrusters = false;
    int status = csv_open(&log.csv, file);
    log.csv.hold_inputs = options->hold_inputs;
    if (status == 0 && options->whole) {
        status = take_thrusters(&log.csv, options->vehicle, &use, &thrusters);
    }
    if (status == 0 && options->whole && !thrusters && has_wrench(&log.csv)) {
        report_warning("%s: no columns thruster_1 ..: forces and moments are examined instead",
                       file);
    } else if (status == 0 && options->whole && !thrusters) {
        status = log_no_thrusters(&use, &log.csv);
    }
    status = status != 0 ? status : examine_whole(doctor, &log, thrusters ? &use : NULL, options);
    status = status != 0 ? status : check_known_forces(&log.csv, options);
    if (status == 0) {
        csv_notes(&log.csv);
        (options->json ? print_json : print_text)(doctor, &log.csv);
        status = doctor->usable ? 0 : 1;
        if (status != 0 && options->whole) {
            vehicle_warn_mount(options->vehicle, file);
        }
    } else if (options->json) {
        report_error_json();
    }
    csv_close(&log.csv);
    free(doctor);
    return status;
}

int doctor_tell(const doctor_t *doctor, const char *path, report_findings_t *findings)
{
    int status = 0;
    for (int i = 0; status == 0 && i < doctor->findings; ++i) {
        const doctor_finding_t *f = &doctor->finding[i];
        bool error = f->severity == DOCTOR_ERROR;
        if (error) {
            report_error_line("%s: %s", path, f->text);
        } else if (f->severity == DOCTOR_WARNING) {
            report_warning("%s: %s", path, f->text);
        } else {
            continue;
        }
        status = report_add_finding(findings, path, code_name[f->code], error, f->text);
    }
    return status;
}

/* Has it errors that further logs do not mend? */
static bool is_wrong(const doctor_t *doctor)
{
    bool wrong = false;
    for (int i = 0; i < doctor->findings; ++i) {
        const doctor_finding_t *f = &doctor->finding[i];
        bool few = f->code == DOCTOR_SHORT || f->code == DOCTOR_GAPS || f->code == DOCTOR_SLOW ||
                   f->code == DOCTOR_VELOCITY_GAPS;
        wrong = wrong || (f->severity == DOCTOR_ERROR && !few);
    }
    return wrong;
}

int doctor_warn(log_t *log, log_use_t *use, double dry_mass_kg, bool known_force,
                report_findings_t *findings)
{
    doctor_t *doctor = malloc(sizeof *doctor);
    if (doctor == NULL) {
        return report_error("%s: not enough memory", log->csv.path);
    }
    int status = examine(doctor, log, use, dry_mass_kg, known_force);
    status = status != 0 ? status : doctor_tell(doctor, log->csv.path, findings);
    log->wrong = status == 0 && is_wrong(doctor);
    log->shift_us = status == 0 ? (int64_t)(1e6 * doctor->shift_s) : 0;
    log->left_out = status == 0 ? (uint8_t)doctor->left_out : 0u;
    free(doctor);
    return status;
}
