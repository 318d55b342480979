#include "bus_identifier.h"

#include <stdio.h>

#include "../base/report_error.h"

int bus_identifier_begin(bus_identifier_t *to, const options_t *options, const char *replayed,
                         bool answer, bool excites)
{
    const vehicle_t *vehicle = options->vehicle;
    const world_config_t world = {.vehicle = vehicle, .seed = options->seed, .sets = options->sets};
    auvid_identifier_config_t identifier;
    auvid_node_config_t cfg;
    world_identifier(&identifier, &world);
    options_uncertainty(options, &identifier.uncertainty);
    identifier.exact_inputs = options->plain;
    identifier.metric.closed_loop = options->closed_loop;
    identifier.metric.open_loop = options->open_loop;
    auvid_status_t status = AUVID_OK;
    to->calibrations = vehicle_calibrations_of(vehicle, replayed, true, to->calibration);
    if (to->calibrations > 0) {
        status = vehicle_use_known_force(&identifier, &to->calibration[0].force, &to->calibrated);
    }
    if (status < 0) {
        return report_error("%s: known force: %s", options->command, auvid_status_str(status));
    }
    auvid_node_defaults(&cfg);
    cfg.answer = answer;
    status = auvid_node_init(&to->node, &cfg, vehicle->allocation, &identifier);
    if (status < 0) {
        return report_refused(options->command, status, &to->node.id.refusal, &identifier);
    }
    (void)auvid_identifier_attach_prediction(&to->node.id, &to->prediction);
    (void)auvid_identifier_attach_change_test(&to->node.id, &to->change);
    status = options->plain ? AUVID_OK : world_uncertain(&to->node, &to->uncertain, vehicle);
    if (status < 0) {
        return report_error("%s: uncertain inputs: %s", options->command, auvid_status_str(status));
    }
    status = excites ? world_excite(&to->node, &to->actuation, &world) : AUVID_OK;
    return status < 0 ? report_refused(options->command, status, &to->actuation.refusal, NULL) : 0;
}

auvid_status_t bus_identifier_take(bus_identifier_t *to, const auvid_can_frame_t *frame)
{
    auvid_status_t status = auvid_node_take(&to->node, frame);
    to->received |= status >= 0 ? UINT32_C(1) << (int)auvid_can_kind(NULL, frame->id) : 0;
    return status;
}

void bus_identifier_print_missing(const bus_identifier_t *from)
{
    static const struct {
        uint32_t kinds;
        const char *name;
    } needed[] = {
        {1u << AUVID_CAN_IMU_ATTITUDE, "imu_attitude"},
        {1u << AUVID_CAN_IMU_RATES, "imu_rates"},
        {1u << AUVID_CAN_DVL_BOTTOM | 1u << AUVID_CAN_DVL_WATER, "dvl_bottom (or dvl_water)"},
        {1u << AUVID_CAN_THRUSTER_FEEDBACK_A, "thruster_feedback_a"},
    };
    const char *before = "  never received, but needed: ";
    for (size_t k = 0; k < sizeof needed / sizeof needed[0]; ++k) {
        if ((from->received & needed[k].kinds) == 0) {
            printf("%s%s", before, needed[k].name);
            before = ", ";
        }
    }
    fputs(*before == ',' ? "\n" : "", stdout);
}

void bus_identifier_step(bus_identifier_t *to, const uint64_t *clock_us, auvid_can_frame_t *frame,
                         int *count)
{
    uint64_t now_us = clock_us != NULL ? *clock_us : to->node.tick_us;
    to->start_us = to->started ? to->start_us : now_us;
    to->started = true;
    if (to->calibrations > 0) {
        const auvid_known_force_t force = vehicle_known_force(
            to->calibration, to->calibrations, 1e-6 * (double)(now_us - to->start_us));
        (void)auvid_calibrated_force(&to->calibrated, now_us, &force);
    }
    (void)auvid_node_step(&to->node, clock_us, frame, count);
}

void bus_identifier_calibrate(const bus_identifier_t *from, result_t *result)
{
    if (from->calibrations > 0) {
        result->truth[from->calibrated.k] = 1.0;
        report_calibrate(result, &from->calibrated);
    }
}
