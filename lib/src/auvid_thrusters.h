/**
 * @file auvid_thrusters.h
 * Private: what the files of the thrusters share.
 */
#ifndef AUVID_THRUSTERS_PRIVATE_H
#define AUVID_THRUSTERS_PRIVATE_H

#include "auvid/thrusters.h"
#include "auvid_math.h"

#endif
