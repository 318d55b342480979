/**
 * @file config_20k.h
 * Sizes of auvid (auvid/config.h) for 20 KiB of RAM. They suffice for the 13 parameters and five
 * thrusters of Girona500, with three sets of 80 s instead of eight of 30 s, rows of 0.8 s
 * instead of 0.5 s, and no Algorithm 1.
 */
#define AUVID_MAX_COMMANDS 0
#define AUVID_MAX_PARAMETERS 13
#define AUVID_MAX_POPULATION 0
#define AUVID_MAX_SETS 3
#define AUVID_MAX_OVERLAP 6
#define AUVID_MAX_THRUSTERS 5
#define AUVID_MAX_SEGMENTS 8
