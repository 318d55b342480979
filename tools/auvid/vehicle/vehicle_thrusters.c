#include "vehicle_thrusters.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "vehicle_keys.h"

/* Thrusters whose lines of action differ by less, relative to their size, are parallel. */
#define PARALLEL 1e-9

/* No thruster is farther from the origin than so many edges of a cube of water of the dry mass: a
 * torpedo of 31 kg has one at 2.2 of them, in centimetres they are 220. */
#define FAR 10.0
#define FAR_M 20.0 /* if the dry mass is not known */
#define WATER_KG_M3 1000.0

/* ---- thrusters ---- */

/* The unit vector's components by their squares: exact where the vector has one component. */
static bool set_wrench(ini_t *ini, const char *section, const vehicle_thruster_t *t,
                       double wrench[6])
{
    const double *r = t->position_m, *d = t->direction;
    double sum = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], e[3];
    if (!(sum > 0.0)) {
        const ini_entry_t *at = ini_find(ini, section, "direction");
        return ini_refuse(ini, at->line, at->value_column,
                          "direction: its length is 0; give the direction of forward thrust");
    }
    for (int i = 0; i < 3; ++i) {
        e[i] = copysign(sqrt(d[i] * d[i] / sum), d[i]);
        wrench[i] = e[i] + 0.0; /* no negative zero */
    }
    wrench[3] = r[1] * e[2] - r[2] * e[1] + 0.0;
    wrench[4] = r[2] * e[0] - r[0] * e[2] + 0.0;
    wrench[5] = r[0] * e[1] - r[1] * e[0] + 0.0;
    return true;
}

/* Do two thrusters act along the same line? */
static bool are_parallel(const double a[6], const double b[6])
{
    double aa = 0.0, bb = 0.0, ab = 0.0;
    for (int i = 0; i < 6; ++i) {
        aa += a[i] * a[i];
        bb += b[i] * b[i];
        ab += a[i] * b[i];
    }
    return aa * bb - ab * ab <= PARALLEL * aa * bb;
}

/* The law of the library's allocation, where it can express the map: command 0 gives no force. */
static void set_law(const vehicle_thruster_t *from, const thrust_map_t *map, auvid_thruster_t *to)
{
    double full = map->full_command, square = full * full;
    bool plain = fabs(map->zero_command) + map->dead_zone <= 0.0 && full > 0.0;
    bool is_square = map->kind == THRUST_MAP_SIGNED_SQUARE || map->kind == THRUST_MAP_RPM;
    to->gain_forward = AUVID_C(1.0);
    if (plain && (is_square || map->kind == THRUST_MAP_LINEAR)) {
        double unit = is_square ? square : full;
        to->law = is_square ? AUVID_THRUST_SQUARE : AUVID_THRUST_LINEAR;
        to->gain_forward = (auvid_real_t)(from->forward_N / unit);
        to->gain_backward = (auvid_real_t)(from->backward_N / unit);
    }
}

/* Takes the thruster into allocation and simulator. */
static bool take_thruster(ini_t *ini, vehicle_t *v, int i)
{
    const vehicle_thruster_t *t = &v->thruster[i];
    auvid_thruster_t *to = &v->allocation_cfg.thruster[i];
    char section[VEHICLE_WORD];
    double wrench[6] = {0}, other[6] = {0};
    (void)snprintf(section, sizeof section, "thruster.%d", i + 1);
    if (!set_wrench(ini, section, t, wrench)) {
        return false;
    }
    for (int k = 0; k < i; ++k) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            other[j] = v->sim.thruster_matrix[j][k];
        }
        if (are_parallel(wrench, other)) {
            return ini_refuse(ini, ini_line(ini, section), 1,
                              "[%s] acts along the same line as [thruster.%d]: no motion tells "
                              "them apart; correct one, or make them one thruster of their sum",
                              section, k + 1);
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        v->sim.thruster_matrix[j][i] = wrench[j];
        to->wrench[j] = (auvid_real_t)wrench[j];
    }
    to->max_N = (auvid_real_t)t->forward_N;
    to->min_N = (auvid_real_t)-t->backward_N;
    set_law(t, &v->map[t->map], to);
    v->sim.thruster_limit_N[i][0] = t->forward_N;
    v->sim.thruster_limit_N[i][1] = t->backward_N;
    v->sim.thruster_max_N = fmax(v->sim.thruster_max_N, t->forward_N);
    v->sim.thruster_back_N = fmax(v->sim.thruster_back_N, t->backward_N);
    return true;
}

/* ---- groups ---- */

static bool check_table(ini_t *ini, const char *section, const thrust_map_t *map)
{
    if (map->commands == 0 || map->commands != map->forces) {
        return ini_refuse_key(ini, section, map->commands == 0 ? "command" : "force_N",
                              "must have as many numbers as the other row of the table");
    }
    for (int k = 1; k < map->commands; ++k) {
        if (!(map->command[k] > map->command[k - 1])) {
            return ini_refuse_key(ini, section, "command", "must increase from number to number");
        }
    }
    return !(map->force_N[0] * map->force_N[map->forces - 1] > 0.0) ||
           ini_refuse_key(ini, section, "force_N",
                          "pushes the same way at both ends of the table: backward is negative");
}

/* Refuses keys that the kind of map does not use. */
static bool check_map(ini_t *ini, const char *section, thrust_map_t *map)
{
    static const char *const scale[] = {"zero_command", "full_command", "dead_zone"};
    static const char *const table[] = {"command", "force_N"};
    static const char *const supply[] = {"voltage_V", "voltage_exponent"};
    bool of_table = map->kind == THRUST_MAP_TABLE, newton = map->kind == THRUST_MAP_NEWTON;
    const ini_entry_t *full = ini_find(ini, section, "full_command");
    for (int k = 0; k < 3 && (of_table || newton); ++k) {
        if (ini_find(ini, section, scale[k]) != NULL) {
            return ini_refuse_key(ini, section, scale[k], "has no meaning for this map: delete it");
        }
    }
    for (int k = 0; k < 2; ++k) {
        if (!of_table && ini_find(ini, section, table[k]) != NULL) {
            return ini_refuse_key(ini, section, table[k], "belongs to 'map = table'");
        }
        if ((newton || map->kind == THRUST_MAP_RPM) && ini_find(ini, section, supply[k]) != NULL) {
            return ini_refuse_key(ini, section, supply[k],
                                  "has no meaning for this map, whose force needs no voltage");
        }
    }
    if ((map->voltage_exponent > 0.0) != (map->voltage_V > 0.0)) {
        return ini_refuse_key(ini, section, map->voltage_V > 0.0 ? "voltage_exponent" : "voltage_V",
                              "is missing: voltage_V and voltage_exponent belong together");
    }
    if (full == NULL && map->kind == THRUST_MAP_RPM) {
        return ini_refuse_key(ini, section, "full_command",
                              "is missing: add the speed of the largest force");
    }
    map->full_command = full == NULL ? map->zero_command + 1.0 : map->full_command;
    if (!(map->dead_zone < fabs(map->full_command - map->zero_command))) {
        return ini_refuse_key(ini, section, full != NULL ? "full_command" : "dead_zone",
                              "must be further from zero_command than the dead zone");
    }
    return !of_table || check_table(ini, section, map);
}

/* The map of a group, which is read when its first thruster is. @return -1 after a message */
static int map_of(ini_t *ini, vehicle_t *v, const char *group)
{
    char section[VEHICLE_WORD + 8];
    int i = 0;
    while (i < v->maps && strcmp(v->group[i], group) != 0) {
        ++i;
    }
    if (i < v->maps) {
        return i;
    }
    thrust_map_t *map = &v->map[v->maps++];
    memcpy(v->group[i], group, strlen(group) + 1);
    if (group[0] == '\0') { /* in newtons */
        return i;
    }
    (void)snprintf(section, sizeof section, "group.%s", group);
    return vehicle_keys_section(ini, section, KEYS_GROUP, map) && check_map(ini, section, map) ? i
                                                                                               : -1;
}

/* Refuses a group without thruster. */
static bool check_groups(ini_t *ini, const vehicle_t *v)
{
    for (int i = 0; i < ini->entries; ++i) {
        const ini_entry_t *e = &ini->entry[i];
        bool found = e->key[0] != '\0' || strncmp(e->section, "group.", 6) != 0;
        for (int k = 0; k < v->maps && !found; ++k) {
            found = strcmp(v->group[k], e->section + 6) == 0;
        }
        if (!found) {
            return ini_refuse(ini, e->line, e->key_column,
                              "no thruster has the group of [%s]; add 'group = %s' to one",
                              e->section, e->section + 6);
        }
    }
    return true;
}

bool vehicle_thrusters_read(ini_t *ini, vehicle_t *v)
{
    char section[VEHICLE_WORD] = "thruster.1";
    int n = 0;
    v->sim.thruster_max_N = v->sim.thruster_back_N = 0.0;
    memset(v->sim.thruster_matrix, 0, sizeof v->sim.thruster_matrix);
    for (int i = 0; i < VEHICLE_THRUSTERS; ++i) {
        vehicle_thruster_t *t = &v->thruster[i];
        (void)snprintf(section, sizeof section, "thruster.%d", i + 1);
        if (ini_find(ini, section, "") == NULL) {
            continue;
        }
        if (n < i) {
            return ini_refuse(ini, ini_line(ini, section), 1,
                              "[%s] without [thruster.%d]; number them 1, 2, 3, ..", section,
                              n + 1);
        }
        if (!vehicle_keys_section(ini, section, KEYS_THRUSTER, t)) {
            return false;
        }
        const ini_entry_t *group = ini_find(ini, section, "group");
        char name[VEHICLE_WORD + 8];
        (void)snprintf(name, sizeof name, "group.%s", t->group);
        if (group != NULL && ini_find(ini, name, "") == NULL) {
            return ini_refuse(ini, group->line, group->value_column,
                              "group: there is no section [%s]; add it", name);
        }
        t->map = map_of(ini, v, t->group);
        if (t->map < 0 || !take_thruster(ini, v, i)) {
            return false;
        }
        v->allocation_cfg.thrusters = (uint8_t)++n;
        v->sim.thrusters = n;
    }
    return n > 0 ? check_groups(ini, v)
                 : ini_refuse(ini, 1, 1, "no section [thruster.1]: add one for each thruster");
}

/* ---- excitation ---- */

static const char *excitation_key(int dof)
{
    return vehicle_keys[KEYS_EXCITATION].key[dof].key;
}

/* [allocation] names only degrees of freedom in which a thruster acts, and priority only those. */
bool vehicle_allocation_check(ini_t *ini, const vehicle_t *v)
{
    const auvid_allocation_config_t *cfg = &v->allocation_cfg;
    auvid_allocation_t allocation;
    unsigned acts = 0;
    for (int i = 0; i < cfg->thrusters; ++i) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            acts |= (unsigned)(fabs((double)cfg->thruster[i].wrench[j]) > 0.0) << j;
        }
    }
    if ((cfg->dofs & ~acts) != 0) {
        return ini_refuse_key(ini, "allocation", "dofs",
                              "names a degree of freedom in which no thruster acts");
    }
    if (ini_find(ini, "allocation", "priority") != NULL &&
        (cfg->priority & ~(cfg->dofs != 0 ? cfg->dofs : acts)) != 0) {
        return ini_refuse_key(ini, "allocation", "priority",
                              "names a degree of freedom that the thrusters do not control");
    }
    return auvid_allocation_init(&allocation, cfg) >= 0 ||
           ini_refuse(ini, ini_line(ini, "allocation"), 1,
                      "no thruster acts in any of the controlled degrees of freedom");
}

/* The wrenches one by one and together. */
static bool check_excitation(ini_t *ini, const vehicle_t *v)
{
    auvid_allocation_t allocation;
    auvid_allocation_fit_t fit = {0};
    (void)auvid_allocation_init(&allocation, v->allocation); /* vehicle_allocation_check did */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const char *key = excitation_key(j);
        if (v->amplitude[j] > 0 && v->model->columns[j] == 0) {
            return ini_refuse_key(ini, "excitation", key,
                                  "is of a degree of freedom that the model "
                                  "has no equation of; delete it");
        }
        if (v->amplitude[j] > 0 && (allocation.actuated >> j & 1u) == 0) {
            return ini_refuse_key(ini, "excitation", key,
                                  "is a wrench that the thrusters cannot give without another one; "
                                  "check positions and directions, or [allocation] dofs");
        }
    }
    if (auvid_allocation_check(&allocation, v->amplitude, NULL, &fit) < 0) {
        char what[160];
        (void)snprintf(what, sizeof what,
                       "is more than the thrusters give in all degrees of freedom at once: "
                       "multiply all amplitudes by %.2f or less",
                       floor(100.0 * (double)fit.factor) / 100.0);
        return ini_refuse_key(ini, "excitation", excitation_key(fit.dof >= 0 ? fit.dof : 0), what);
    }
    return true;
}

void vehicle_excitation_check(ini_t *ini, vehicle_t *v)
{
    bool good = false;
    v->has_excitation = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        v->has_excitation = v->has_excitation || v->amplitude[j] > 0;
    }
    if (ini_find(ini, "excitation", "") == NULL) {
        (void)ini_refuse(ini, 1, 1, "no section [excitation]: add it");
    } else if (!v->has_excitation) {
        (void)ini_refuse(ini, ini_line(ini, "excitation"), 1,
                         "[excitation] needs a wrench above 0: add e.g. surge_N");
    } else {
        good = check_excitation(ini, v);
    }
    (void)snprintf(v->excitation_refusal, sizeof v->excitation_refusal, "%s",
                   good ? "" : ini->message);
    ini->message[0] = '\0'; /* the file is not refused */
}

bool vehicle_far_thruster(const vehicle_t *v, double dry_mass_kg, char *text, size_t size)
{
    double limit = dry_mass_kg > 0.0 ? FAR * cbrt(dry_mass_kg / WATER_KG_M3) : FAR_M, most = 0.0;
    char of[48] = "";
    int farthest = 0;
    for (int i = 0; i < v->allocation->thrusters; ++i) {
        const double *r = v->thruster[i].position_m;
        double distance = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
        farthest = distance > most ? i : farthest;
        most = fmax(most, distance);
    }
    if (!(most > limit)) {
        return false;
    }
    if (dry_mass_kg > 0.0) {
        (void)snprintf(of, sizeof of, " of %.3g kg", dry_mass_kg);
    }
    (void)snprintf(text, size,
                   "[thruster.%d] position_m: it is %.3g m from the origin, too far for a "
                   "vehicle%s: give metres",
                   farthest + 1, most, of);
    return true;
}
