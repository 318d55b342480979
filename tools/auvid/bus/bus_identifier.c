#include "bus_identifier.h"

#include "../base/report_error.h"

int bus_identifier_begin(bus_identifier_t *to, const options_t *options, bool answer, bool excites)
{
    const vehicle_t *vehicle = options->vehicle;
    const world_config_t world = {.vehicle = vehicle, .seed = options->seed, .sets = options->sets};
    auvid_identifier_config_t identifier;
    auvid_node_config_t cfg;
    world_identifier(&identifier, &world);
    options_uncertainty(options, &identifier.uncertainty);
    identifier.exact_inputs = options->plain;
    auvid_node_defaults(&cfg);
    cfg.answer = answer;
    auvid_status_t status = auvid_node_init(&to->node, &cfg, vehicle->allocation, &identifier);
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
