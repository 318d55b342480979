/**
 * @file auvid.h
 * Includes every public header of auvid: all that a program needs.
 *
 * The headers in detail/ describe the modules inside of these structs. Programs have no need to
 * open them, and they may change in every version.
 */
#ifndef AUVID_AUVID_H
#define AUVID_AUVID_H

/* what every module uses */
#include "auvid/config.h"
#include "auvid/types.h"

/* vehicle models, and models that wrap another one */
#include "auvid/current.h"
#include "auvid/fossen.h"
#include "auvid/thrusters.h"
#include "auvid/vehicle.h"

/* the identifier, its configuration and its result */
#include "auvid/estimate.h"
#include "auvid/identifier.h"
#include "auvid/metric_config.h"
#include "auvid/nav.h"
#include "auvid/uncertain.h"

/* excitation */
#include "auvid/actuation.h"
#include "auvid/adaptive.h"
#include "auvid/allocation.h"
#include "auvid/excitation.h"
#include "auvid/guard.h"

/* from one dive to the next */
#include "auvid/checkpoint.h"
#include "auvid/prior.h"

/* useful alone */
#include "auvid/smoother.h"
#include "auvid/validation.h"

/* the bus */
#include "auvid/can.h"
#include "auvid/can_messages.h"
#include "auvid/node.h"

#endif
