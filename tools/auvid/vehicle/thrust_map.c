#include "thrust_map.h"

#include <math.h>

const char *const thrust_map_name[THRUST_MAPS] = {"newton", "linear", "signed-square", "rpm",
                                                  "table"};

/* Finds the scale of commands in a table: its zero and its end. */
static bool scale_of_table(thrust_map_t *map)
{
    const double *command = map->command, *force_N = map->force_N;
    for (int k = 1; k < map->commands; ++k) {
        double step = force_N[k] - force_N[k - 1];
        if (force_N[k - 1] * step < 0.0 && force_N[k] * step >= 0.0) {
            double part = -force_N[k - 1] / step;
            int end = step > 0.0 ? map->commands - 1 : 0;
            map->zero_command = command[k - 1] + part * (command[k] - command[k - 1]);
            map->full_command = command[end];
            return fabs(map->full_command - map->zero_command) > 0.0;
        }
    }
    return false;
}

bool thrust_map_replace(thrust_map_t *map, thrust_map_kind_t kind)
{
    if (map->kind == THRUST_MAP_NEWTON || (map->kind == THRUST_MAP_TABLE && !scale_of_table(map))) {
        return false;
    }
    map->kind = (int)kind;
    return true;
}

/* The force at a command, from the table. */
static double interpolate(const thrust_map_t *map, double command)
{
    int last = map->commands - 1, k = 1;
    if (!(command > map->command[0])) {
        return map->force_N[0];
    }
    if (command >= map->command[last]) {
        return map->force_N[last];
    }
    while (command > map->command[k]) {
        ++k;
    }
    double part = (command - map->command[k - 1]) / (map->command[k] - map->command[k - 1]);
    return map->force_N[k - 1] + part * (map->force_N[k] - map->force_N[k - 1]);
}

/* A command relative to the full one, without the dead zone. */
static double relative(const thrust_map_t *map, double command)
{
    double span = map->full_command - map->zero_command, dead = map->dead_zone / fabs(span);
    double n = (command - map->zero_command) / span;
    return fabs(n) <= dead ? 0.0 : copysign((fabs(n) - dead) / (1.0 - dead), n);
}

double thrust_map_force(const thrust_map_t *map, double forward_N, double backward_N,
                        double command, double voltage_V)
{
    double force = command;
    if (map->kind == THRUST_MAP_TABLE) {
        force = interpolate(map, command);
    } else if (map->kind != THRUST_MAP_NEWTON) {
        double n = relative(map, command);
        force = (n < 0.0 ? backward_N : forward_N) * n;
        force *= map->kind == THRUST_MAP_LINEAR ? 1.0 : fabs(n);
    }
    if (voltage_V > 0.0 && map->voltage_V > 0.0) {
        force *= pow(voltage_V / map->voltage_V, map->voltage_exponent);
    }
    return force;
}
