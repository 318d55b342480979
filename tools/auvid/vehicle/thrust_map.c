#include "thrust_map.h"

#include <math.h>

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
