#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"

const char *const report_dof_name[AUVID_DOF_COUNT] = {"surge", "sway",  "heave",
                                                      "roll",  "pitch", "yaw"};

int report_dofs(const auvid_vehicle_t *model, auvid_dof_t dof[AUVID_DOF_COUNT])
{
    int count = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (model->columns[j] != 0) {
            dof[count++] = (auvid_dof_t)j;
        }
    }
    return count;
}

const char *report_status(const result_t *result)
{
    if (result->estimate.number == 0 || result->estimate.identified == 0) {
        return "not_excited";
    }
    return result->estimate.not_converged ? "not_converged" : "ok";
}

int report_exit(const result_t *result)
{
    return strcmp(report_status(result), "ok") == 0 ? 0 : 1;
}

void report_gather(result_t *result, const auvid_identifier_t *id, uint64_t seed)
{
    const auvid_actuation_t *a = id->actuation;
    const auvid_estimate_t *estimate = auvid_identifier_estimate(id);
    *result = (result_t){.seed = seed,
                         .vehicle = id->metric.cfg.vehicle,
                         .free = id->metric.cfg.free,
                         .estimate = estimate != NULL ? *estimate : id->estimate,
                         .budget = AUVID_DEFAULT_BUDGET,
                         .max_work = id->work.max_units,
                         .change_test = id->change_test,
                         .closed_loop = id->metric.cfg.closed_loop,
                         .open_loop = id->metric.cfg.open_loop,
                         .cell_s = 1e-6 * id->recorder.cell_us,
                         .has_guard = a != NULL && a->excitation.cfg.segments > 0,
                         .guard = a != NULL ? a->guard.state : AUVID_GUARD_DISARMED};
    if (a != NULL) {
        result->trip = a->guard.trip;
    }
    result->inputs_estimated = id->attached.uncertain != NULL;
    if (id->attached.uncertain != NULL) {
        (void)auvid_uncertain_causes(id->attached.uncertain, &result->causes);
        result->over_priors =
            result->causes.contradicted ? 0.0 : (double)id->attached.uncertain->scale;
    }
}

void report_add_truth(result_t *result, const vehicle_sim_t *vehicle_sim)
{
    double truth[VEHICLE_SIM_PARAMETERS];
    vehicle_sim_truth(vehicle_sim, truth);
    result->has_truth = true;
    if (vehicle_sim->causes.number > 0) { /* what the bus says, which has no asymmetry */
        const auvid_causes_t own = result->causes;
        result->causes = vehicle_sim->causes;
        result->causes.number = own.number;
        memcpy(result->causes.asymmetry, own.asymmetry, sizeof own.asymmetry);
        memcpy(result->causes.asymmetry_sigma, own.asymmetry_sigma, sizeof own.asymmetry_sigma);
        memcpy(result->causes.one_way, own.one_way, sizeof own.one_way);
    }
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        result->truth[i] = truth[i];
        if (vehicle_sim->estimated >> i & 1u) {
            result->estimate.pi[i] = (auvid_real_t)vehicle_sim->estimate[i];
            result->estimate.confidence.sigma[i] =
                (auvid_real_t)fmin(vehicle_sim->sigma[i], (double)AUVID_LARGEST);
        }
    }
}

void report_calibrate(result_t *result, const auvid_calibrated_t *calibrated)
{
    auvid_estimate_t *e = &result->estimate;
    auvid_status_t status = auvid_calibrated_estimate(calibrated, e, e);
    result->calibration = status == AUVID_OK          ? REPORT_CALIBRATED
                          : status == AUVID_ERR_RANGE ? REPORT_CONTRADICTED
                                                      : REPORT_UNSEEN;
    result->k_tau = calibrated->k;
    if (status == AUVID_ERR_RANGE) {
        e->confidence.identifiable = 0;
        result->remedy = result->remedy != NULL
                             ? result->remedy
                             : "the known force: check its sign, size and time first";
    }
}

#define LARGE_OFF 25.0 /* of the thrust [%]: data sheets are seldom so wrong */

bool report_thrust(const result_t *result, char *text, size_t size)
{
    const auvid_estimate_t *e = &result->estimate;
    double k = (double)e->pi[result->k_tau];
    double half = 210.0 * (double)e->confidence.sigma[result->k_tau] / fmax(k, 1e-3);
    double off = 100.0 * fabs(1.0 / fmax(k, 1e-3) - 1.0);
    switch (result->calibration) {
    case REPORT_CALIBRATED:
        if (off > half) {
            (void)snprintf(
                text, size,
                "the known force says that thrust is %.1f %% %s than supplied (+- %.1f %%): "
                "parameters are in SI%s",
                off, k > 1.0 ? "weaker" : "stronger", half,
                off > LARGE_OFF ? "; check the force and the thrusters' data: so much is rare"
                                : "");
        } else {
            (void)snprintf(text, size,
                           "the known force agrees with the supplied thrust (+- %.1f %%): "
                           "parameters are in SI",
                           half);
        }
        return true;
    case REPORT_CONTRADICTED:
        (void)snprintf(text, size,
                       "the known force contradicts the motion (k_tau %.2f): check its sign, size "
                       "in newtons, and time",
                       k);
        return true;
    case REPORT_UNSEEN:
        (void)snprintf(text, size,
                       "the known force does not show the scale of the thrust: excite its axis, "
                       "with the force and without it");
        return true;
    case REPORT_UNCALIBRATED:
        break;
    }
    return false;
}

double report_rms_percent(const auvid_estimate_t *estimate, const double *truth)
{
    double squares = 0.0;
    int count = 0;
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        if ((estimate->identified >> i & 1u) && fabs(truth[i]) > 0.0) {
            double error = (double)estimate->pi[i] / truth[i] - 1.0;
            squares += error * error;
            ++count;
        }
    }
    return count > 0 ? 100.0 * sqrt(squares / count) : 0.0;
}

int report_identifiable(const auvid_estimate_t *estimate)
{
    int count = 0;
    for (int i = 0; i < AUVID_MAX_PARAMETERS && estimate->number > 0; ++i) {
        count += (int)(estimate->confidence.identifiable >> i & 1u);
    }
    return count;
}

/* Units for inputs that are commands: a force is measured in commands. */
static const char *unit_in_commands(const auvid_parameter_t *parameter)
{
    bool moment = parameter->dof >= AUVID_ROLL;
    switch (parameter->kind) {
    case AUVID_PARAMETER_MASS:
        return "cmd s2/m";
    case AUVID_PARAMETER_LINEAR_DRAG:
        return moment ? "cmd s" : "cmd s/m";
    case AUVID_PARAMETER_QUADRATIC_DRAG:
        return moment ? "cmd s2" : "cmd s2/m2";
    case AUVID_PARAMETER_FORCE:
        return "cmd";
    case AUVID_PARAMETER_INERTIA:
    case AUVID_PARAMETER_OTHER:
    case AUVID_PARAMETER_UNSCALED:
    default:
        return strcmp(parameter->unit, "Nm") == 0    ? "cmd"
               : strcmp(parameter->unit, "m/s") == 0 ? parameter->unit
                                                     : "cmd s2";
    }
}

const char *report_unit(const result_t *result, int i)
{
    const auvid_parameter_t *parameter = &result->vehicle->parameter[i];
    return result->in_commands ? unit_in_commands(parameter) : parameter->unit;
}

bool report_is_identified(const result_t *result, int i)
{
    return result->estimate.number > 0 && (result->estimate.identified >> i & 1u) != 0;
}

bool report_is_driven(const result_t *result, auvid_dof_t j)
{
    return result->estimate.number > 0 && (result->estimate.excited >> j & 1u) != 0;
}

bool report_is_modelled(const result_t *result, auvid_dof_t j)
{
    return result->vehicle->columns[j] != 0;
}

bool report_is_at_bound(const result_t *result, int i)
{
    return result->estimate.confidence.note[i] == AUVID_NOTE_AT_BOUND;
}

double report_sigma(const result_t *result, int i)
{
    auvid_real_t sigma = result->estimate.confidence.sigma[i];
    return report_is_identified(result, i) && sigma < AUVID_LARGEST ? (double)sigma : HUGE_VAL;
}

double report_sigma_told(const result_t *result, int i)
{
    auvid_real_t variance = auvid_estimate_covariance(&result->estimate, result->vehicle, i, i);
    return isfinite(report_sigma(result, i)) ? sqrt((double)variance) : HUGE_VAL;
}

const double report_drag_part[REPORT_DRAG_PARTS] = {0.3, 0.6, 1.0};

bool report_drag(const result_t *result, auvid_dof_t j, bool backward, int part, auvid_drag_t *drag)
{
    double largest = (double)result->estimate.speed[j][backward] * (backward ? -1.0 : 1.0);
    auvid_real_t speed = (auvid_real_t)(report_drag_part[part] * largest);
    bool known =
        fabs(largest) > 0.0 && auvid_causes_drag(&result->causes, &result->estimate,
                                                 result->vehicle, j, speed, drag) == AUVID_OK;
    drag->identifiable = known && drag->identifiable && !result->wrong_log &&
                         result->calibration != REPORT_CONTRADICTED;
    return known;
}

int report_known_drag(const result_t *result, char *text, size_t size)
{
    int count = 0;
    text[0] = '\0';
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool known = false;
        auvid_drag_t drag;
        for (int i = 0; i < 2 * REPORT_DRAG_PARTS; ++i) {
            known = known || (report_drag(result, (auvid_dof_t)j, i >= REPORT_DRAG_PARTS,
                                          i % REPORT_DRAG_PARTS, &drag) &&
                              drag.identifiable);
        }
        if (known) {
            size_t used = strlen(text);
            (void)snprintf(text + used, size - used, "%s%s", count++ > 0 ? ", " : "",
                           report_dof_name[j]);
        }
    }
    return count;
}

double report_true_drag(const result_t *result, auvid_dof_t j, double speed)
{
    double force = 0.0;
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &result->vehicle->parameter[i];
        if (p->dof == j && p->kind == AUVID_PARAMETER_LINEAR_DRAG) {
            force += result->truth[i] * speed;
        } else if (p->dof == j && p->kind == AUVID_PARAMETER_QUADRATIC_DRAG) {
            force += result->truth[i] * speed * fabs(speed);
        }
    }
    return force;
}

bool report_is_contradicted(const result_t *result)
{
    bool feedback = false;
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        feedback = feedback || result->estimate.confidence.note[i] == AUVID_NOTE_FEEDBACK;
    }
    return result->causes.contradicted && !feedback;
}

void report_note(const result_t *result, int i, char *text, size_t size)
{
    const auvid_parameter_t *parameter = &result->vehicle->parameter[i];
    const char *why = result->why[parameter->dof];
    const auvid_confidence_t *c = &result->estimate.confidence;
    bool unactuated = c->note[i] == AUVID_NOTE_NOT_EXCITED && c->partner[i] != 0;
    if (!report_is_identified(result, i) && (why != NULL || !unactuated)) {
        (void)snprintf(text, size, "%s", why != NULL ? why : "not excited");
    } else if (result->wrong_log) {
        (void)snprintf(text, size, "the log has an error");
    } else if (report_is_contradicted(result)) {
        (void)snprintf(text, size, "the motion contradicts the inputs");
    } else if (result->calibration == REPORT_CONTRADICTED) {
        (void)snprintf(text, size, "the known force contradicts the motion");
    } else {
        (void)auvid_confidence_note(&result->estimate.confidence, result->vehicle, i, text, size);
    }
}

/* Where a closed loop was recognised: the option for one that was not there. */
static void add_loop_option(const result_t *result, char *text, size_t size)
{
    const char *axis = "AXIS,..";
    size_t used = strlen(text);
    bool told = strstr(text, "closed loop") == NULL;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (strncmp(text, report_dof_name[j], strlen(report_dof_name[j])) == 0) {
            axis = report_dof_name[j];
            told = told || (result->closed_loop >> j & 1u) != 0;
        }
    }
    if (!told) {
        (void)snprintf(text + used, size - used, "; if no controller drove it: --open-loop %s",
                       axis);
    }
}

/* What would be configured, where a better thrust scale is asked for: auvid enlarges it by the
 * square of over_priors, if that is above 1. */
static void add_scale_option(const result_t *result, char *text, size_t size)
{
    static const char before[] = "calibrate thrust to ";
    const char *asked = strstr(text, before);
    if (asked != NULL && result->over_priors > 0.0) {
        double wanted = 0.01 * strtod(asked + sizeof before - 1, NULL);
        double enlarged = fmax(result->over_priors, 1.0);
        double scale = wanted / (enlarged * enlarged);
        size_t used = strlen(text);
        (void)snprintf(text + used, size - used,
                       " (1 sigma), or measure it and give --thrust-scale %g",
                       1e-4 * floor(1e4 * scale));
    }
}

bool report_missing(const result_t *result, unsigned which, char *text, size_t size)
{
    const auvid_estimate_t *e = &result->estimate;
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS];
    if (result->remedy != NULL) {
        (void)snprintf(text, size, "%s", which == 0 ? result->remedy : "");
        return which == 0;
    }
    auvid_vehicle_t vehicle = *result->vehicle;
    uint32_t wanted = result->free;
    for (int i = 0; i < vehicle.parameters; ++i) {
        parameter[i] = result->vehicle->parameter[i];
        parameter[i].unit = report_unit(result, i);
        wanted &= ~((uint32_t)(result->left_out >> parameter[i].dof & 1u) << i);
    }
    vehicle.parameter = parameter;
    bool any = auvid_confidence_missing(e->number > 0 ? &e->confidence : NULL, &vehicle, wanted,
                                        which, text, size) == AUVID_OK;
    if (any && result->has_loop_option) {
        add_loop_option(result, text, size);
        add_scale_option(result, text, size);
    }
    return any;
}

/* Is the first sentence that of all inputs? Then no class is named. */
static bool all_are_wrong(const auvid_causes_t *causes)
{
    return causes->contradicted || causes->thrust_differs;
}

uint32_t report_differs(const result_t *result)
{
    return all_are_wrong(&result->causes) ? 0 : result->causes.differs;
}

bool report_cause(const result_t *result, unsigned which, char *text, size_t size)
{
    /* the library's last sentence names no cause: see report_differs */
    unsigned causes = all_are_wrong(&result->causes) ? 1 : result->causes.named;
    text[0] = '\0';
    return which < causes &&
           auvid_causes_sentence(&result->causes, result->vehicle, which, text, size) == AUVID_OK;
}

const char *report_cause_unit(auvid_guard_cause_t cause)
{
    static const char *const unit[AUVID_GUARD_CAUSE_COUNT] = {
        [AUVID_GUARD_TIME] = "s",           [AUVID_GUARD_TICK] = "s",
        [AUVID_GUARD_LINK] = "s",           [AUVID_GUARD_IMU_STALE] = "s",
        [AUVID_GUARD_VELOCITY_STALE] = "s", [AUVID_GUARD_DEPTH_STALE] = "s",
        [AUVID_GUARD_ALTITUDE_STALE] = "s", [AUVID_GUARD_APPLIED_STALE] = "s",
        [AUVID_GUARD_DEPTH_MIN] = "m",      [AUVID_GUARD_DEPTH_MAX] = "m",
        [AUVID_GUARD_ALTITUDE] = "m",       [AUVID_GUARD_ROLL] = "rad",
        [AUVID_GUARD_PITCH] = "rad",        [AUVID_GUARD_SPEED] = "m/s",
        [AUVID_GUARD_YAW_RATE] = "rad/s",   [AUVID_GUARD_DISTANCE] = "m",
        [AUVID_GUARD_RUN_TIME] = "s",       [AUVID_GUARD_SATURATION] = "s"};
    const char *found = (unsigned)cause < AUVID_GUARD_CAUSE_COUNT ? unit[cause] : NULL;
    return found == NULL ? "" : found;
}

int report_add_finding(report_findings_t *findings, const char *log, const char *code, bool error,
                       const char *sentence)
{
    size_t count = (size_t)findings->count + 1;
    report_finding_t *at = realloc(findings->at, count * sizeof *at);
    if (at == NULL) {
        return report_error("%s: not enough memory", log);
    }
    findings->at = at;
    at += findings->count++;
    *at = (report_finding_t){.log = log, .code = code, .error = error};
    (void)snprintf(at->sentence, sizeof at->sentence, "%s", sentence);
    return 0;
}

void report_free_findings(report_findings_t *findings)
{
    free(findings->at);
    *findings = (report_findings_t){0};
}

int report_finish(int status)
{
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout)) {
        return report_error("standard output: cannot be written: %s", strerror(errno));
    }
    return status;
}
