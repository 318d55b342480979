#include "frames.h"

#include <string.h>

bus_frame_t frames_raw(const auvid_can_frame_t *frame)
{
    bus_frame_t raw = {.id = frame->id, .length = frame->length};
    memcpy(raw.data, frame->data, sizeof raw.data);
    return raw;
}

bool frames_convert(const bus_frame_t *from, auvid_can_frame_t *to)
{
    if (from->flags != 0) {
        return false;
    }
    memset(to, 0, sizeof *to);
    to->t_us = from->t_us;
    to->id = (uint16_t)from->id;
    to->length = from->length;
    memcpy(to->data, from->data, sizeof to->data);
    return true;
}

void frames_send(bus_memory_end_t *end, const auvid_can_frame_t *frame, int count)
{
    for (int i = 0; i < count; ++i) {
        bus_frame_t raw = frames_raw(&frame[i]);
        (void)end->bus.send(&end->bus, &raw);
    }
}

bool frames_receive(bus_memory_end_t *end, auvid_can_frame_t *frame)
{
    bus_frame_t raw;
    while (end->bus.receive(&end->bus, &raw, 1) > 0) {
        if (frames_convert(&raw, frame)) {
            return true;
        }
    }
    return false;
}

void frames_take(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim)
{
    auvid_can_frame_t frame;
    while (frames_receive(end, &frame)) {
        vehicle_sim_take(vehicle_sim, &frame);
    }
}

void frames_vehicle(bus_memory_end_t *end, vehicle_sim_t *vehicle_sim)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    frames_take(end, vehicle_sim);
    bus_memory_advance(end->hub, SIM_TICK_US);
    int count = vehicle_sim_tick(vehicle_sim, frame);
    frames_send(end, frame, count);
}
