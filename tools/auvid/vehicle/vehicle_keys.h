/**
 * @file vehicle_keys.h
 * The keys of a vehicle file: one table a section. Reader, `auvid check --json` and `--header` go
 * through these tables.
 */
#ifndef PROGRAM_VEHICLE_KEYS_H
#define PROGRAM_VEHICLE_KEYS_H

#include "../base/ini.h"
#include "vehicle_file.h"

/** What a value is, and the type of its member. */
typedef enum {
    KEY_REAL,   /**< auvid_real_t */
    KEY_DOUBLE, /**< double */
    KEY_WHOLE,  /**< uint32_t */
    KEY_YES,    /**< bool: yes or no */
    KEY_WORD,   /**< char[VEHICLE_WORD]: a name in C, in lower case */
    KEY_TITLE,  /**< char[VEHICLE_TITLE]: text */
    KEY_CHOICE, /**< int: index of one of `words` */
    KEY_BITS,   /**< uint8_t: a bit for each of `words` */
    KEY_CAUSES  /**< uint32_t: bits of the guard's causes, from AUVID_GUARD_DEPTH_MIN on */
} key_kind_t;

typedef struct {
    const char *key;
    key_kind_t kind;
    int least, most; /**< numbers; 0: one */
    bool required;
    size_t offset; /**< of its member */
    double low, high;
    double factor;            /**< from the file's unit to the member's; 0: 1 */
    const char *const *words; /**< of KEY_CHOICE and KEY_BITS, the last one NULL */
    size_t count_offset;      /**< of the int that counts the numbers; 0: none */
    const char *member;       /**< in C, if it is not the key */
} vehicle_key_t;

/** A table of keys. */
typedef struct {
    /** "thruster", "group", "calibration": those of [thruster.1], [group.NAME], [calibration.1] */
    const char *section;
    const vehicle_key_t *key;
    int keys;
} vehicle_keys_t;

/** Tables by section. Offsets are in vehicle_t; those of THRUSTER, GROUP and CALIBRATION in
 * vehicle_thruster_t, thrust_map_t and vehicle_calibration_t. TRUTH_x: [truth] of each model, and
 * of all. */
typedef enum {
    KEYS_VEHICLE,
    KEYS_THRUSTER,
    KEYS_GROUP,
    KEYS_ALLOCATION,
    KEYS_EXCITATION,
    KEYS_GUARD,
    KEYS_MOUNT,
    KEYS_UNCERTAINTY,
    KEYS_UNCERTAIN,
    KEYS_CALIBRATION,
    KEYS_TRUTH,
    KEYS_TRUTH_GIRONA500,
    KEYS_TRUTH_FOSSEN,
    KEYS_SECTIONS
} vehicle_section_t;

extern const vehicle_keys_t vehicle_keys[KEYS_SECTIONS];

/** Names of the degrees of freedom; the last one NULL. */
extern const char *const vehicle_dofs[AUVID_DOF_COUNT + 1];

/** Reads the keys of a table in a section of the file. Members of absent keys stay as they are.
 * @return false after a message: a required key is missing, or a value is refused */
bool vehicle_keys_read(ini_t *ini, const char *section, const vehicle_keys_t *keys, void *to);

/** Refuses a key of the section that nobody has read. The names are those of the tables.
 * @param tables their number; other: further names, or "" */
bool vehicle_keys_unknown(ini_t *ini, const char *section, const vehicle_keys_t *const *table,
                          int tables, const char *other);

/** Refuses a word of a value, and lists those that are possible; the last one NULL. */
bool vehicle_keys_not_one_of(ini_t *ini, const ini_entry_t *e, int column, const char *word,
                             const char *const *words);

/** Reads a section by its table, and refuses keys that are not in it. @return false after a message
 */
bool vehicle_keys_section(ini_t *ini, const char *section, vehicle_section_t keys, void *to);

#endif
