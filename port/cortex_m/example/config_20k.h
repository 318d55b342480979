/**
 * @file config_20k.h
 * Sizes of auvid (auvid/config.h) for 20 KiB of RAM. They suffice for the 13 parameters and six
 * thrusters of Girona500, with two sets of two minutes instead of eight of 30 s.
 */
#define AUVID_MAX_COMMANDS 0
#define AUVID_MAX_PARAMETERS 13
#define AUVID_MAX_POPULATION 33
#define AUVID_MAX_SETS 2
#define AUVID_MAX_THRUSTERS 6
#define AUVID_MAX_SEGMENTS 8
