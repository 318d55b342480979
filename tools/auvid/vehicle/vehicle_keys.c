#include "vehicle_keys.h"

#include <stdio.h>
#include <string.h>

/* Smallest value of what must be positive, largest of what has no other limit. */
#define POSITIVE 1e-6
#define LARGE 1e6
#define DEGREE (3.14159265358979323846 / 180.0)

#define AT(member) offsetof(vehicle_t, member)
#define REAL(name, of, from, to)                                                                   \
    {                                                                                              \
        .key = #name, .kind = KEY_REAL, .offset = AT(of.name), .low = from, .high = to             \
    }
#define WHOLE(name, of, to)                                                                        \
    {                                                                                              \
        .key = #name, .kind = KEY_WHOLE, .offset = AT(of.name), .high = to                         \
    }
#define NUMBER(name, at, from, to)                                                                 \
    {                                                                                              \
        .key = name, .kind = KEY_DOUBLE, .offset = at, .low = from, .high = to                     \
    }
#define NUMBERS(name, at, n, from, to)                                                             \
    {                                                                                              \
        .key = name, .kind = KEY_DOUBLE, .offset = at, .least = n, .most = n, .low = from,         \
        .high = to                                                                                 \
    }
/* The same keys, which must be given. */
#define MUST_NUMBER(name, at, from, to)                                                            \
    {                                                                                              \
        .key = name, .kind = KEY_DOUBLE, .offset = at, .low = from, .high = to, .required = true   \
    }
#define MUST_NUMBERS(name, at, n, from, to)                                                        \
    {                                                                                              \
        .key = name, .kind = KEY_DOUBLE, .offset = at, .least = n, .most = n, .low = from,         \
        .high = to, .required = true                                                               \
    }

const char *const vehicle_dofs[AUVID_DOF_COUNT + 1] = {"surge", "sway", "heave", "roll",
                                                       "pitch", "yaw",  NULL};
static const char *const models[] = {"girona500", "fossen", "terms", NULL};
static const char *const maps[] = {"newton", "linear", "signed-square", "rpm", "table", NULL};
static const char *const limits[] = {"depth_min", "depth_max",  "altitude", "roll",
                                     "pitch",     "speed",      "yaw_rate", "distance",
                                     "run_time",  "saturation", NULL};

static const vehicle_key_t of_vehicle[] = {
    {.key = "name", .kind = KEY_WORD, .offset = AT(word), .required = true},
    {.key = "title", .kind = KEY_TITLE, .offset = AT(title), .required = true},
    {.key = "model", .kind = KEY_CHOICE, .offset = AT(kind), .words = models, .required = true},
    {.key = "fast", .kind = KEY_YES, .offset = AT(fast)},
    {.key = "dry_mass_kg",
     .kind = KEY_REAL,
     .offset = AT(dry_mass_kg),
     .low = 1e-3,
     .high = LARGE}};

#define T(member) offsetof(vehicle_thruster_t, member)
static const vehicle_key_t of_thruster[] = {MUST_NUMBERS("position_m", T(position_m), 3, -100, 100),
                                            MUST_NUMBERS("direction", T(direction), 3, -1000, 1000),
                                            MUST_NUMBER("forward_N", T(forward_N), 1e-3, LARGE),
                                            MUST_NUMBER("backward_N", T(backward_N), 1e-3, LARGE),
                                            {.key = "group", .kind = KEY_WORD, .offset = T(group)}};

#define G(member) offsetof(thrust_map_t, member)
static const vehicle_key_t of_group[] = {
    {.key = "map", .kind = KEY_CHOICE, .offset = G(kind), .words = maps, .required = true},
    NUMBER("zero_command", G(zero_command), -LARGE, LARGE),
    NUMBER("full_command", G(full_command), -LARGE, LARGE),
    NUMBER("dead_zone", G(dead_zone), 0, LARGE),
    NUMBER("voltage_V", G(voltage_V), 0.1, 2000),
    NUMBER("voltage_exponent", G(voltage_exponent), 0, 4),
    NUMBER("delay_s", G(delay_s), 0, 1),
    NUMBER("uncertainty", G(uncertainty), 0, 1),
    {.key = "command",
     .kind = KEY_DOUBLE,
     .offset = G(command),
     .least = 2,
     .most = THRUST_MAP_POINTS,
     .low = -LARGE,
     .high = LARGE,
     .count_offset = G(commands)},
    {.key = "force_N",
     .kind = KEY_DOUBLE,
     .offset = G(force_N),
     .least = 2,
     .most = THRUST_MAP_POINTS,
     .low = -LARGE,
     .high = LARGE,
     .count_offset = G(forces)}};

static const vehicle_key_t of_allocation[] = {
    {.key = "dofs", .kind = KEY_BITS, .offset = AT(allocation_cfg.dofs), .words = vehicle_dofs},
    {.key = "priority",
     .kind = KEY_BITS,
     .offset = AT(allocation_cfg.priority),
     .words = vehicle_dofs}};

#define AMPLITUDE(name, dof)                                                                       \
    {                                                                                              \
        .key = name, .kind = KEY_REAL, .offset = AT(amplitude[dof]), .low = 0, .high = LARGE       \
    }
static const vehicle_key_t of_excitation[] = {
    AMPLITUDE("surge_N", AUVID_SURGE),  AMPLITUDE("sway_N", AUVID_SWAY),
    AMPLITUDE("heave_N", AUVID_HEAVE),  AMPLITUDE("roll_Nm", AUVID_ROLL),
    AMPLITUDE("pitch_Nm", AUVID_PITCH), AMPLITUDE("yaw_Nm", AUVID_YAW)};

#define LONGEST_US 4e9
static const vehicle_key_t of_guard[] = {
    REAL(depth_min_m, guard, 0, 12000),
    REAL(depth_max_m, guard, 0, 12000),
    REAL(altitude_min_m, guard, 0, 1000),
    REAL(roll_max_rad, guard, 0, 4),
    REAL(pitch_max_rad, guard, 0, 1.5),
    REAL(speed_max, guard, 0, 100),
    REAL(yaw_rate_max, guard, 0, 100),
    REAL(distance_max_m, guard, 0, LARGE),
    WHOLE(run_max_s, guard, 1e6),
    WHOLE(imu_stale_us, guard, LONGEST_US),
    WHOLE(velocity_stale_us, guard, LONGEST_US),
    WHOLE(depth_stale_us, guard, LONGEST_US),
    WHOLE(altitude_stale_us, guard, LONGEST_US),
    WHOLE(applied_stale_us, guard, LONGEST_US),
    WHOLE(saturation_us, guard, LONGEST_US),
    WHOLE(repeat_us, guard, LONGEST_US),
    WHOLE(max_tick_us, guard, LONGEST_US),
    WHOLE(heartbeat_timeout_us, guard, LONGEST_US),
    REAL(rest_speed, guard, 0, 100),
    REAL(rest_rate, guard, 0, 100),
    WHOLE(rest_dwell_us, guard, LONGEST_US),
    WHOLE(settle_timeout_us, guard, LONGEST_US),
    {.key = "off", .kind = KEY_CAUSES, .offset = AT(guard.off), .words = limits},
    {.key = "altitude_required", .kind = KEY_YES, .offset = AT(guard.altitude_required)},
    {.key = "surface", .kind = KEY_YES, .offset = AT(guard.surface)},
    {.key = "water_lock", .kind = KEY_YES, .offset = AT(guard.water_lock)}};

#define MOUNT(name, of, size, by)                                                                  \
    {                                                                                              \
        .key = name, .kind = KEY_REAL, .offset = AT(mount.of), .least = 3, .most = 3,              \
        .low = -(size), .high = size, .factor = by, .member = #of                                  \
    }
static const vehicle_key_t of_mount[] = {MOUNT("dvl_lever_m", dvl_lever, 100, 1),
                                         MOUNT("dvl_euler_deg", dvl_euler, 360, DEGREE),
                                         MOUNT("imu_euler_deg", imu_euler, 360, DEGREE)};

static const vehicle_key_t of_uncertainty[] = {REAL(thrust_scale, uncertainty, 0, 1),
                                               REAL(dvl_scale, uncertainty, 0, 1),
                                               REAL(delay_s, uncertainty, 0, 1)};

static const vehicle_key_t of_uncertain[] = {
    REAL(backward, uncertain, 0, 1),
    REAL(dead_band, uncertain, 0, 1),
    REAL(curve, uncertain, 0, 1),
    REAL(inflow, uncertain, 0, 10),
    REAL(sag, uncertain, 0, 1),
    REAL(gain, uncertain, 0, 1),
    REAL(lag_s, uncertain, 0, 1),
    REAL(delay_s, uncertain, 0, 1),
    REAL(current, uncertain, 0, 10),
    REAL(asymmetry, uncertain, 0, 1),
    REAL(cross, uncertain, 0, 1),
    REAL(force, uncertain, 0, 1),
    REAL(arm_m, uncertain, 0, 1),
    REAL(mount_rad, uncertain, 0, 1),
    REAL(dvl_late_s, uncertain, 0, 1),
    REAL(filter_s, uncertain, 0, 1),
    REAL(response_s2, uncertain, 0, 1),
    REAL(gravity_m, uncertain, 0, 1),
    REAL(cross_flow, uncertain, 0, 1),
    REAL(nominal_lag_s, uncertain, 0.01, 1),
    {.key = "fractions", .kind = KEY_YES, .offset = AT(uncertain.fractions)}};

#define C(member) offsetof(vehicle_calibration_t, member)
#define FORCE(name, at, n, limit)                                                                  \
    {                                                                                              \
        .key = name, .kind = KEY_REAL, .offset = C(force.at), .least = n, .most = n,               \
        .low = -(limit), .high = limit                                                             \
    }
static const vehicle_key_t of_calibration[] = {
    FORCE("weight_N", world[2], 0, 1e5),
    FORCE("pull_N", body, 3, 1e5),
    FORCE("pull_north_east_N", world, 2, 1e5),
    FORCE("position_m", at, 3, 100),
    {.key = "mass_kg", .kind = KEY_REAL, .offset = C(force.mass_kg), .high = 1e4},
    MUST_NUMBER("from_s", C(from_s), -VEHICLE_TIME_S, VEHICLE_TIME_S),
    NUMBER("to_s", C(to_s), -VEHICLE_TIME_S, VEHICLE_TIME_S),
    {.key = "log", .kind = KEY_TITLE, .offset = C(log)}};

/* Of all models; the tilt where the model has no roll and pitch. */
static const vehicle_key_t of_truth[] = {
    NUMBER("depth_m", AT(sim.position[2]), 0, 12000),
    NUMBER("seabed_m", AT(sim.seabed_m), 0, 12000),
    NUMBER("hold_Nm_rad", AT(sim.hold_Nm_rad), 0, LARGE),
    NUMBER("hold_Nms_rad", AT(sim.hold_Nms_rad), 0, LARGE),
    NUMBER("tilt_inertia", AT(sim.tilt_inertia), POSITIVE, LARGE),
    NUMBER("tilt_linear", AT(sim.tilt_linear), 0, LARGE),
    NUMBER("tilt_quadratic", AT(sim.tilt_quadratic), 0, LARGE),
    NUMBER("tilt_righting", AT(sim.tilt_righting), 0, LARGE),
    NUMBER("roll_arm_m", AT(sim.roll_arm_m), -100, 100),
    NUMBER("pitch_arm_m", AT(sim.pitch_arm_m), -100, 100)};

#define P(index) AT(sim.parameter[index])
static const vehicle_key_t of_truth_girona500[] = {
    MUST_NUMBER("m_u", P(SIM_M_U), POSITIVE, 1e8), MUST_NUMBER("m_v", P(SIM_M_V), POSITIVE, 1e8),
    MUST_NUMBER("m_w", P(SIM_M_W), POSITIVE, 1e8), MUST_NUMBER("m_r", P(SIM_M_R), POSITIVE, 1e8),
    MUST_NUMBER("W-B", P(SIM_WB), -LARGE, LARGE),  MUST_NUMBER("X_u", P(SIM_X_U), -LARGE, 0),
    MUST_NUMBER("X_uu", P(SIM_X_UU), -LARGE, 0),   MUST_NUMBER("Y_v", P(SIM_Y_V), -LARGE, 0),
    MUST_NUMBER("Y_vv", P(SIM_Y_VV), -LARGE, 0),   MUST_NUMBER("Z_w", P(SIM_Z_W), -LARGE, 0),
    MUST_NUMBER("Z_ww", P(SIM_Z_WW), -LARGE, 0),   MUST_NUMBER("N_r", P(SIM_N_R), -LARGE, 0),
    MUST_NUMBER("N_rr", P(SIM_N_RR), -LARGE, 0)};

#define F(member) AT(sim.fossen.member)
static const vehicle_key_t of_truth_fossen[] = {
    MUST_NUMBER("mass_kg", F(mass_kg), POSITIVE, 1e8),
    MUST_NUMBERS("inertia", F(inertia), 3, POSITIVE, 1e8),
    MUST_NUMBER("weight_N", F(weight_N), 0, 1e9), MUST_NUMBER("buoyancy_N", F(buoyancy_N), 0, 1e9),
    NUMBERS("r_g", F(r_g), 3, -100, 100), NUMBERS("r_b", F(r_b), 3, -100, 100),
    /* the diagonal, which the reader spreads, and what is below it */
    MUST_NUMBERS("added", F(added), 6, 0, 1e8), NUMBER("added_uq", F(added[4][0]), -1e8, 1e8),
    NUMBER("added_vp", F(added[3][1]), -1e8, 1e8), NUMBER("added_vr", F(added[5][1]), -1e8, 1e8),
    NUMBER("added_wq", F(added[4][2]), -1e8, 1e8), MUST_NUMBERS("linear", F(linear), 6, 0, LARGE),
    MUST_NUMBERS("quadratic", F(quadratic), 6, 0, LARGE)};

#define TABLE(section, keys)                                                                       \
    {                                                                                              \
        section, keys, (int)(sizeof keys / sizeof keys[0])                                         \
    }
const vehicle_keys_t vehicle_keys[KEYS_SECTIONS] = {
    [KEYS_VEHICLE] = TABLE("vehicle", of_vehicle),
    [KEYS_THRUSTER] = TABLE("thruster", of_thruster),
    [KEYS_GROUP] = TABLE("group", of_group),
    [KEYS_ALLOCATION] = TABLE("allocation", of_allocation),
    [KEYS_EXCITATION] = TABLE("excitation", of_excitation),
    [KEYS_GUARD] = TABLE("guard", of_guard),
    [KEYS_MOUNT] = TABLE("mount", of_mount),
    [KEYS_UNCERTAINTY] = TABLE("uncertainty", of_uncertainty),
    [KEYS_UNCERTAIN] = TABLE("uncertain", of_uncertain),
    [KEYS_CALIBRATION] = TABLE("calibration", of_calibration),
    [KEYS_TRUTH] = TABLE("truth", of_truth),
    [KEYS_TRUTH_GIRONA500] = TABLE("truth", of_truth_girona500),
    [KEYS_TRUTH_FOSSEN] = TABLE("truth", of_truth_fossen)};

/* ---- values ---- */

/* Writes "a, b, c" of words, cut with "..." where it does not fit. */
static void list_word(char *list, size_t size, const char *word)
{
    size_t at = strlen(list);
    bool fits = at + strlen(word) + 8 < size;
    if (at > 4 && strcmp(list + at - 3, "...") == 0) {
        return;
    }
    (void)snprintf(list + at, size - at, "%s%s", at > 0 ? ", " : "", fits ? word : "...");
}

static int word_index(const char *const *words, const char *word)
{
    for (int i = 0; words[i] != NULL; ++i) {
        if (strcmp(words[i], word) == 0) {
            return i;
        }
    }
    return -1;
}

bool vehicle_keys_not_one_of(ini_t *ini, const ini_entry_t *e, int column, const char *word,
                             const char *const *words)
{
    char list[200] = "";
    for (int i = 0; words[i] != NULL; ++i) {
        list_word(list, sizeof list, words[i]);
    }
    return ini_refuse(ini, e->line, column, "%s: '%s' is not one of %s", e->key, word, list);
}

static bool take_numbers(ini_t *ini, const ini_entry_t *e, const vehicle_key_t *key, char *base)
{
    void *to = base + key->offset;
    double x[THRUST_MAP_POINTS], factor = key->factor > 0.0 ? key->factor : 1.0;
    int count = 0, most = key->most > 0 ? key->most : 1;
    if (!ini_numbers(ini, e, key->least > 0 ? key->least : 1, most, x, &count)) {
        return false;
    }
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= key->low && x[i] <= key->high)) {
            return ini_refuse(ini, e->line, e->value_column, "%s: %.9g is not from %g to %g",
                              e->key, x[i], key->low, key->high);
        }
        if (key->kind == KEY_WHOLE && x[i] > (double)(uint32_t)x[i]) {
            return ini_refuse(ini, e->line, e->value_column, "%s: %.9g is not a whole number",
                              e->key, x[i]);
        }
        if (key->kind == KEY_REAL) {
            ((auvid_real_t *)to)[i] = (auvid_real_t)(factor * x[i]);
        } else if (key->kind == KEY_WHOLE) {
            ((uint32_t *)to)[i] = (uint32_t)x[i];
        } else {
            ((double *)to)[i] = x[i];
        }
    }
    if (key->count_offset > 0) {
        *(int *)(void *)(base + key->count_offset) = count;
    }
    return true;
}

static bool take_name(ini_t *ini, const ini_entry_t *e, char *to)
{
    size_t good = strspn(e->value, "abcdefghijklmnopqrstuvwxyz0123456789_");
    if (e->value[good] != '\0' || good >= VEHICLE_WORD ||
        (e->value[0] >= '0' && e->value[0] <= '9')) {
        return ini_refuse(ini, e->line, e->value_column,
                          "%s: '%s' is not a name of up to %d lower-case letters, digits and _ "
                          "that begins with a letter",
                          e->key, e->value, VEHICLE_WORD - 1);
    }
    memcpy(to, e->value, good + 1);
    return true;
}

static bool take_title(ini_t *ini, const ini_entry_t *e, char *to)
{
    size_t length = strlen(e->value);
    if (length >= VEHICLE_TITLE || strpbrk(e->value, "\"\\*?") != NULL) { /* it is in C, too */
        return ini_refuse(ini, e->line, e->value_column,
                          "%s: at most %d characters, none of them \" \\ * or ?", e->key,
                          VEHICLE_TITLE - 1);
    }
    memcpy(to, e->value, length + 1);
    return true;
}

static bool take_words(ini_t *ini, const ini_entry_t *e, const vehicle_key_t *key, void *to)
{
    char word[VEHICLE_WORD];
    size_t at = 0;
    uint32_t bits = 0;
    for (int column = ini_word(e, &at, word, sizeof word); word[0] != '\0';
         column = ini_word(e, &at, word, sizeof word)) {
        int i = word_index(key->words, word);
        if (i < 0) {
            return vehicle_keys_not_one_of(ini, e, column, word, key->words);
        }
        bits |= (uint32_t)1 << i;
    }
    if (key->kind == KEY_CAUSES) {
        *(uint32_t *)to = bits << AUVID_GUARD_DEPTH_MIN;
    } else {
        *(uint8_t *)to = (uint8_t)bits;
    }
    return true;
}

static bool take_value(ini_t *ini, const ini_entry_t *e, const vehicle_key_t *key, char *base)
{
    void *to = base + key->offset;
    static const char *const answers[] = {"no", "yes", NULL};
    const char *const *words = key->kind == KEY_YES ? answers : key->words;
    switch (key->kind) {
    case KEY_WORD:
        return take_name(ini, e, to);
    case KEY_TITLE:
        return take_title(ini, e, to);
    case KEY_YES:
    case KEY_CHOICE: {
        int i = word_index(words, e->value);
        if (i < 0) {
            return vehicle_keys_not_one_of(ini, e, e->value_column, e->value, words);
        }
        if (key->kind == KEY_YES) {
            *(bool *)to = i == 1;
        } else {
            *(int *)to = i;
        }
        return true;
    }
    case KEY_BITS:
    case KEY_CAUSES:
        return take_words(ini, e, key, to);
    case KEY_REAL:
    case KEY_DOUBLE:
    case KEY_WHOLE:
        break;
    }
    return take_numbers(ini, e, key, base);
}

/* Names all keys that must be given and are not, and a key that may be one of them misspelt. */
static bool refuse_missing(ini_t *ini, const char *section, const vehicle_keys_t *keys)
{
    const ini_entry_t *head = ini_find(ini, section, ""), *unknown = NULL;
    char list[240] = "", rest[80] = "";
    int missing = 0;
    for (int k = 0; k < keys->keys; ++k) {
        if (keys->key[k].required && ini_find(ini, section, keys->key[k].key) == NULL) {
            char word[VEHICLE_WORD + 2];
            (void)snprintf(word, sizeof word, "'%s'", keys->key[k].key);
            list_word(list, sizeof list, word);
            ++missing;
        }
    }
    for (int i = 0; i < ini->entries && unknown == NULL; ++i) {
        const ini_entry_t *e = &ini->entry[i];
        bool known = e->used || e->key[0] == '\0' || strcmp(e->section, section) != 0;
        for (int k = 0; k < keys->keys && !known; ++k) {
            known = strcmp(e->key, keys->key[k].key) == 0;
        }
        unknown = known ? NULL : e;
    }
    if (unknown != NULL) {
        (void)snprintf(rest, sizeof rest, "; '%.40s' in line %d is unknown", unknown->key,
                       unknown->line);
    }
    return ini_refuse(ini, head != NULL ? head->line : 1, 1, "[%s] has no key%s %s: add %s%s",
                      section, missing == 1 ? "" : "s", list, missing == 1 ? "it" : "them", rest);
}

bool vehicle_keys_read(ini_t *ini, const char *section, const vehicle_keys_t *keys, void *to)
{
    for (int k = 0; k < keys->keys; ++k) {
        const vehicle_key_t *key = &keys->key[k];
        ini_entry_t *e = ini_find(ini, section, key->key);
        if (e != NULL) {
            e->used = true;
            if (!take_value(ini, e, key, to)) {
                return false;
            }
        } else if (key->required) {
            return refuse_missing(ini, section, keys);
        }
    }
    return true;
}

bool vehicle_keys_unknown(ini_t *ini, const char *section, const vehicle_keys_t *const *table,
                          int tables, const char *other)
{
    for (int i = 0; i < ini->entries; ++i) {
        const ini_entry_t *e = &ini->entry[i];
        if (e->used || e->key[0] == '\0' || strcmp(e->section, section) != 0) {
            continue;
        }
        char list[240] = "";
        for (int t = 0; t < tables; ++t) {
            for (int k = 0; k < table[t]->keys; ++k) {
                list_word(list, sizeof list, table[t]->key[k].key);
            }
        }
        return ini_refuse(ini, e->line, e->key_column, "unknown key '%s' in [%s]; known: %s%s",
                          e->key, section, other, list);
    }
    return true;
}

bool vehicle_keys_section(ini_t *ini, const char *section, vehicle_section_t keys, void *to)
{
    const vehicle_keys_t *table = &vehicle_keys[keys];
    return vehicle_keys_read(ini, section, table, to) &&
           vehicle_keys_unknown(ini, section, &table, 1, "");
}
