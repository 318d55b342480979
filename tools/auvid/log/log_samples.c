#include "log_samples.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../base/report_error.h"

/* The attitude is not propagated for longer [s]. */
#define PROPAGATION_S 1.0
/* Relative to a thruster's largest force: room for the noise of a command at its limit. */
#define MOST_THRUST 1.1
/* Room for a full battery, and for a measured speed: water that flows in speeds a propeller up. */
#define MOST_VARYING_THRUST 2.0
/* Beyond these the forces are in another unit, or commands. */
#define OTHER_UNIT 2.0
#define LEAST_THRUST 0.02
/* A voltage beyond these, relative to that of the map, is in another unit, or of a single cell. */
#define LARGEST_VOLTAGE 3.0
#define SMALLEST_VOLTAGE 0.4
/* A velocity counts as repeated before this part of the usual time between two new ones. */
#define HELD_PART 0.75

_Static_assert(AUVID_MAX_THRUSTERS >= AUVID_DOF_COUNT, "log_reader_t.input has a place for each");
_Static_assert(AUVID_MAX_THRUSTERS <= CSV_THRUSTERS, "a column for each thruster");

bool log_has_thrusters(const log_use_t *use)
{
    return use->kind == INPUT_THRUST || use->kind == INPUT_THRUSTER_COMMAND;
}

bool log_use_thrusters(log_use_t *use, const vehicle_t *vehicle, const bool has[CSV_COLUMNS])
{
    bool all = auvid_allocation_init(&use->allocation, vehicle->allocation) == AUVID_OK;
    use->vehicle = vehicle;
    use->kind = has[CSV_THRUSTER_N] ? INPUT_THRUST : INPUT_THRUSTER_COMMAND;
    for (int k = 0; all && k < log_inputs(use); ++k) {
        all = has[log_input(use, k)];
    }
    (void)log_use_map(use, THRUST_MAP_NEWTON);
    return all;
}

int log_check_thrusters(const log_use_t *use, const csv_log_t *log)
{
    int first = use->kind == INPUT_THRUST ? CSV_THRUSTER_N : CSV_THRUSTER;
    char why[80];
    (void)snprintf(why, sizeof why, ": %s has %d thrusters", use->vehicle->word, log_inputs(use));
    for (int k = 0; k < CSV_THRUSTERS; ++k) {
        if (k < log_inputs(use) && !log->has[log_input(use, k)]) {
            return csv_missing(log, log_input(use, k), why);
        }
        if (k >= log_inputs(use) && log->has[first + k]) {
            return report_error("%s:%zu:1: there is a column %s%s", log->path, log->header,
                                csv_name[first + k], why);
        }
    }
    return 0;
}

int log_no_thrusters(const log_use_t *use, const csv_log_t *log)
{
    log_use_t commands = *use;
    commands.kind = INPUT_THRUSTER_COMMAND;
    int first = log_input(&commands, 0), other = first == CSV_RPM ? CSV_THRUSTER : CSV_RPM;
    if (log->has[other]) {
        return report_error("%s:%zu:1: the log has %s .., but the thrusters of %s need %s ..: "
                            "correct map in their [group.NAME] (%s), or the names of the columns",
                            log->path, log->header, csv_name[other], use->vehicle->word,
                            csv_name[first],
                            other == CSV_RPM ? "map = rpm" : "linear, signed-square, table");
    }
    return report_error("%s:%zu:1: no input column of the thrusters of %s (%s .., or "
                        "thruster_1_N .. in newtons) in the header; if another file has them, "
                        "merge the files by t_s",
                        log->path, log->header, use->vehicle->word, csv_name[first]);
}

bool log_use_map(log_use_t *use, thrust_map_kind_t kind)
{
    bool any = false;
    use->square = use->kind == INPUT_COMMAND && kind == THRUST_MAP_SIGNED_SQUARE;
    if (use->vehicle != NULL) {
        memcpy(use->map, use->vehicle->map, sizeof use->map);
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS && use->kind == INPUT_THRUSTER_COMMAND; ++i) {
        any = (i < use->vehicle->maps && kind != THRUST_MAP_NEWTON &&
               thrust_map_replace(&use->map[i], kind)) ||
              any;
    }
    return any || use->kind == INPUT_COMMAND;
}

int log_inputs(const log_use_t *use)
{
    return log_has_thrusters(use) ? use->allocation.cfg.thrusters : AUVID_DOF_COUNT;
}

int log_input(const log_use_t *use, int k)
{
    static const int first[] = {CSV_WRENCH, CSV_COMMAND, CSV_THRUSTER_N, CSV_THRUSTER};
    bool speed = use->kind == INPUT_THRUSTER_COMMAND &&
                 use->vehicle->map[use->vehicle->thruster[k].map].kind == THRUST_MAP_RPM;
    return (speed ? CSV_RPM : first[use->kind]) + k;
}

void log_wrench(const log_use_t *use, const double *input, double voltage_V,
                double wrench[AUVID_DOF_COUNT], auvid_real_t *force_N)
{
    auvid_real_t total[AUVID_DOF_COUNT] = {0};
    for (int k = 0; k < log_inputs(use) && log_has_thrusters(use); ++k) {
        force_N[k] =
            (auvid_real_t)(use->kind == INPUT_THRUST ? input[k]
                                                     : vehicle_file_thrust(use->vehicle, use->map,
                                                                           k, input[k], voltage_V));
    }
    if (log_has_thrusters(use)) {
        (void)auvid_allocation_wrench(&use->allocation, force_N, total);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double gain = use->kind == INPUT_COMMAND && use->gain[j] > 0.0 ? use->gain[j] : 1.0;
        double force = use->square ? fabs(input[j]) * input[j] : input[j];
        wrench[j] = log_has_thrusters(use) ? (double)total[j] : gain * force;
    }
}

/* May a thruster exceed its largest force: does it depend on more than the command? */
static bool thrust_varies(const log_use_t *use)
{
    bool varies = false;
    for (int i = 0; i < use->vehicle->maps && use->kind == INPUT_THRUSTER_COMMAND; ++i) {
        const thrust_map_t *map = &use->vehicle->map[i];
        varies = varies || map->kind == THRUST_MAP_RPM || map->voltage_exponent > 0.0;
    }
    return varies;
}

static const char *thrust_remedy(const log_use_t *use, double relative)
{
    if (use->kind == INPUT_THRUST) {
        return relative > OTHER_UNIT || relative < 1.0
                   ? "are the columns thruster_1_N .. in newtons?"
                   : "correct forward_N and backward_N in the vehicle file, or the columns "
                     "thruster_1_N ..";
    }
    return relative < 1.0
               ? "the thrusters hardly run, or their commands are not those of the vehicle file"
           : relative > OTHER_UNIT
               ? "give zero_command and full_command of the commands in the vehicle file (of pulse "
                 "widths 1500 and 1900), or name forces thruster_1_N .."
               : "correct full_command, or forward_N and backward_N, in the vehicle file";
}

int log_voltage_judge(const log_use_t *use, char *text, size_t size)
{
    const thrust_map_t *map = NULL;
    for (int i = 0; i < AUVID_MAX_THRUSTERS && use->kind == INPUT_THRUSTER_COMMAND; ++i) {
        bool follows = i < use->vehicle->maps && use->map[i].voltage_exponent > 0.0 &&
                       use->map[i].voltage_V > 0.0;
        map = map == NULL && follows ? &use->map[i] : map;
    }
    if (map == NULL) {
        return 0;
    }
    double relative = use->voltage_V / map->voltage_V;
    if (!(relative > 0.0)) {
        (void)snprintf(text, size,
                       "voltage_V is missing, or always 0: the thrust is that of %g V, and not "
                       "corrected, though %s has voltage_exponent: log the voltage of the supply",
                       map->voltage_V, use->vehicle->word);
        return -1;
    }
    if (relative > LARGEST_VOLTAGE || relative < SMALLEST_VOLTAGE) {
        (void)snprintf(text, size,
                       "voltage_V is up to %.5g, but the thrust of %s belongs to %g V: give the "
                       "voltage of the supply in volts, or correct voltage_V in the vehicle file",
                       use->voltage_V, use->vehicle->word, map->voltage_V);
        return 1;
    }
    return 0;
}

int log_thrust_judge(const log_use_t *use, double largest_N, char *text, size_t size)
{
    if (log_voltage_judge(use, text, size) > 0) {
        return 1;
    }
    const auvid_allocation_config_t *cfg = &use->allocation.cfg;
    double capacity = 0.0, most = thrust_varies(use) ? MOST_VARYING_THRUST : MOST_THRUST;
    for (int k = 0; k < cfg->thrusters; ++k) {
        const auvid_thruster_t *t = &cfg->thruster[k];
        capacity = fmax(capacity, (double)fmaxf(t->max_N, -t->min_N));
    }
    int wrong = largest_N > most * capacity                              ? 1
                : largest_N > 0.0 && largest_N < LEAST_THRUST * capacity ? -1
                                                                         : 0;
    if (wrong != 0) {
        (void)snprintf(text, size,
                       "the largest force of a thruster is %.3g N, but those of %s have up to %.3g "
                       "N: %s",
                       largest_N, use->vehicle->word, capacity,
                       thrust_remedy(use, largest_N / capacity));
    }
    return wrong;
}

int log_reader_begin(log_reader_t *reader, log_t *log, const log_use_t *use)
{
    *reader = (log_reader_t){.log = log, .use = use};
    return csv_rewind(&log->csv);
}

/* Has a stream of columns a new value in this row? Keeps the new values. */
static bool take(log_reader_t *r, const csv_row_t *row, int first, int count, double *last)
{
    bool any = false;
    for (int k = 0; k < count; ++k) {
        if (csv_has(row, first + k)) {
            last[k] = row->value[first + k];
            r->known[first + k] = true;
            any = true;
        }
    }
    return any;
}

/* Does the log have one of these columns? */
static bool has(const log_reader_t *r, int first, int count)
{
    bool any = false;
    for (int k = 0; k < count; ++k) {
        any = any || r->log->csv.has[first + k];
    }
    return any;
}

/* Had every column of a stream a value yet? */
static bool complete(const log_reader_t *r, int first, int count)
{
    bool all = true;
    for (int k = 0; k < count; ++k) {
        all = all && (!r->log->csv.has[first + k] || r->known[first + k]);
    }
    return all;
}

/* Are all cells of a stream filled in this row? */
static bool full(const log_reader_t *r, const csv_row_t *row, int first, int count)
{
    bool all = true;
    for (int k = 0; k < count; ++k) {
        all = all && (!r->log->csv.has[first + k] || csv_has(row, first + k));
    }
    return all;
}

/* Propagates the angles by the rates (Fossen 2011, Eq. 2.28). */
static void propagate(log_reader_t *r, double t)
{
    const double *rate = r->nu + AUVID_ROLL;
    double dt = t - r->angle_s, s = sin(r->angle[0]), c = cos(r->angle[0]);
    double turn = (rate[1] * s + rate[2] * c) / fmax(cos(r->angle[1]), 1e-3);
    double change[3] = {rate[0] + turn * sin(r->angle[1]), rate[1] * c - rate[2] * s, turn};
    for (int k = 0; k < 3; ++k) {
        r->angle[k] += r->log->csv.has[CSV_ATTITUDE + k] ? dt * change[k] : 0.0;
    }
    r->angle_s = t;
}

/* Takes the angles of a row, unwrapped. Returns false if it has none. */
static bool take_angles(log_reader_t *r, const csv_row_t *row)
{
    const double revolution = 6.283185307179586;
    bool any = false;
    for (int k = 0; k < 3; ++k) {
        if (csv_has(row, CSV_ATTITUDE + k)) {
            double raw = row->value[CSV_ATTITUDE + k];
            bool first = !r->known[CSV_ATTITUDE + k];
            r->turns[k] -= floor((raw - (first ? raw : r->raw[k])) / revolution + 0.5);
            r->angle[k] = raw + r->turns[k] * revolution;
            r->raw[k] = raw;
            r->known[CSV_ATTITUDE + k] = true;
            any = true;
        }
    }
    return any;
}

/* Attitude and rates are one stream. It has a sample in each row with rates, to which the attitude
 * is propagated; if the log has no rates, in each row with an attitude. */
static bool take_attitude(log_reader_t *r, const csv_row_t *row)
{
    double t = row->value[CSV_T];
    bool angles = has(r, CSV_ATTITUDE, 3), rates = has(r, CSV_NU + AUVID_ROLL, 3);
    if (!full(r, row, CSV_ATTITUDE, 3) && complete(r, CSV_ATTITUDE, 3)) {
        propagate(r, t);
    }
    bool new_angles = take_angles(r, row);
    if (new_angles) {
        r->angle_s = r->measured_s = t;
    }
    bool new_rates = take(r, row, CSV_NU + AUVID_ROLL, 3, r->nu + AUVID_ROLL);
    bool known = complete(r, CSV_ATTITUDE, 3) && complete(r, CSV_NU + AUVID_ROLL, 3) &&
                 (!angles || t - r->measured_s <= PROPAGATION_S);
    return known && (rates ? new_rates : new_angles || !angles);
}

/* Is the velocity of this row only repeated? At rest, zeros are new samples at the usual rate. */
static bool repeats(const log_reader_t *r, const csv_row_t *row)
{
    bool same = true, zero = true;
    for (int i = 0; i < 3; ++i) {
        double now = csv_has(row, CSV_NU + i) ? row->value[CSV_NU + i] : r->nu[i];
        same = same && !(fabs(now - r->nu[i]) > 0.0);
        zero = zero && !(fabs(now) > 0.0);
    }
    bool early = row->value[CSV_T] - r->velocity_s < HELD_PART * r->log->held_s;
    return r->log->held_s > 0.0 && r->has_velocity && same && (!zero || early);
}

/* Returns the mask of the new components. Those without a column are zero. */
static unsigned take_velocity(log_reader_t *r, const csv_row_t *row, bool new_attitude)
{
    unsigned mask = 0;
    if (!has(r, CSV_NU, 3)) {
        return new_attitude ? 7u : 0u;
    }
    if (repeats(r, row) || !take(r, row, CSV_NU, 3, r->nu)) {
        return 0;
    }
    for (int i = 0; i < 3; ++i) {
        bool new = csv_has(row, CSV_NU + i) || !r->log->csv.has[CSV_NU + i];
        mask |= (unsigned)new << i;
    }
    r->velocity_s = row->value[CSV_T];
    r->has_velocity = true;
    return mask;
}

static void take_inputs(log_reader_t *r, const csv_row_t *row, log_sample_t *out)
{
    const log_use_t *use = r->use;
    double wrench[AUVID_DOF_COUNT];
    bool known = true;
    out->input_us += log_has_thrusters(use) ? use->delay_us : 0u;
    (void)take(r, row, CSV_VOLTAGE, 1, &r->voltage_V);
    for (int k = 0; k < log_inputs(use); ++k) {
        int column = log_input(use, k);
        out->has_input = take(r, row, column, 1, &r->input[k]) || out->has_input;
        known = known && complete(r, column, 1);
    }
    out->has_input = out->has_input && known;
    if (out->has_input) {
        log_wrench(use, r->input, r->voltage_V, wrench, out->force_N);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            out->wrench[j] = (auvid_real_t)((use->dofs >> j & 1u) ? wrench[j] : 0.0);
        }
    }
}

/* The known force: of the vehicle file, or the weight of the log. */
static void take_known_force(log_reader_t *r, const csv_row_t *row, log_sample_t *out)
{
    (void)take(r, row, CSV_WEIGHT, 1, &r->weight_N);
    out->known = vehicle_known_force(r->log->calibration, r->log->calibrations, row->value[CSV_T]);
    out->known.world[2] += (auvid_real_t)r->weight_N;
    out->has_known = true;
}

int log_reader_next(log_reader_t *r, log_sample_t *out)
{
    csv_row_t row;
    int status = csv_next(&r->log->csv, &row);
    if (status != 0) {
        return status;
    }
    *out = (log_sample_t){0};
    double since = row.value[CSV_T] - r->log->csv.first_s;
    int64_t shift_us = r->log->shift_us; /* of what is early: no sample moves back in time */
    uint64_t row_us = (uint64_t)(1e6 * since + 0.5) + r->log->start_us;
    out->t_us = row_us + (uint64_t)(shift_us < 0 ? -shift_us : 0);
    out->input_us = row_us + (uint64_t)(shift_us > 0 ? shift_us : 0);
    out->has_attitude = take_attitude(r, &row);
    out->velocity = take_velocity(r, &row, out->has_attitude);
    out->has_reference = r->use->reference && take(r, &row, CSV_REFERENCE, 6, r->reference);
    take_inputs(r, &row, out);
    take_known_force(r, &row, out);
    for (int k = 0; k < 3; ++k) {
        out->attitude[k] = (auvid_real_t)r->angle[k];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        out->nu[j] = (auvid_real_t)r->nu[j];
        out->reference[j] = (auvid_real_t)r->reference[j];
    }
    return 0;
}
