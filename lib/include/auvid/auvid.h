/**
 * @file auvid.h
 * Includes every header of auvid. Firmware that only identifies needs identifier.h. Each module
 * can also be used separately through its own header.
 */
#ifndef AUVID_AUVID_H
#define AUVID_AUVID_H

#include "auvid/types.h"
#include "auvid/selftest.h"

#include "auvid/current.h"
#include "auvid/nav.h"
#include "auvid/excitation.h"
#include "auvid/averaged.h"
#include "auvid/fossen.h"
#include "auvid/guard.h"
#include "auvid/allocation.h"
#include "auvid/smoother.h"
#include "auvid/vehicle.h"
#include "auvid/recorder.h"
#include "auvid/metric.h"
#include "auvid/confidence.h"
#include "auvid/crs.h"
#include "auvid/line_search.h"
#include "auvid/optimizer.h"
#include "auvid/validation.h"
#include "auvid/identifier.h"
#include "auvid/actuation.h"
#include "auvid/adaptive.h"
#include "auvid/prior.h"
#include "auvid/checkpoint.h"
#include "auvid/thrusters.h"
#include "auvid/node.h"

#include "auvid/can.h"
#include "auvid/can_receiver.h"
#include "auvid/can_fifo.h"

#endif
