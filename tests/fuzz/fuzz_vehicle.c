/*
 * libFuzzer: random bytes as a vehicle file. It is a vehicle whose configurations the library
 * accepts, or a message with a place.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_frames.h"
#include "base/ini.h"
#include "vehicle/vehicle_file.h"

static void check_message(const char *message)
{
    int line = 0, column = 0;
    REQUIRE(sscanf(message, "x.ini:%d:%d: ", &line, &column) == 2);
    REQUIRE(line >= 1 && column >= 1 && column <= INI_LINE + 1);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char message[INI_MESSAGE];
    vehicle_t *v =
        vehicle_file_parse("x.ini", (const char *)data, size, message, sizeof message);
    if (v == NULL) {
        check_message(message);
    } else {
        auvid_allocation_t allocation;
        auvid_guard_t guard;
        if (v->excitation_refusal[0] != '\0') {
            check_message(v->excitation_refusal);
        }
        REQUIRE(message[0] == '\0' && auvid_vehicle_check(v->model) == AUVID_OK);
        REQUIRE(auvid_allocation_init(&allocation, v->allocation) == AUVID_OK);
        REQUIRE(auvid_guard_init(&guard, &v->guard) == AUVID_OK);
        for (int i = 0; i < v->allocation->thrusters; ++i) {
            double full = v->map[v->thruster[i].map].full_command;
            double force = vehicle_file_thrust(v, v->map, i, full, 0);
            REQUIRE(force >= -1e7 && force <= 1e7);
        }
    }
    free(v);
    return 0;
}
