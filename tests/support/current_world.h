/**
 * @file current_world.h
 * Shared by tests of the model of a current: a Girona500 in one, identified over the bus in memory.
 */
#ifndef CURRENT_WORLD_H
#define CURRENT_WORLD_H

#include "auvid/current.h"
#include "bus/world.h"
#include "unity.h"

/* rows: storage of the metric's rows. */
static inline void begin_current_world(world_t *world, const world_config_t *config,
                                       auvid_current_t *current, auvid_row_t *rows)
{
    auvid_identifier_config_t cfg;
    TEST_ASSERT_TRUE(world_begin(world, config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(current, &auvid_girona500, false));
    world_identifier(&cfg, config);
    cfg.vehicle = &current->vehicle;
    cfg.metric.free = current->vehicle.free;
    cfg.metric.rows = rows;
    cfg.metric.row_slots = (cfg.metric.sets + 1u) * cfg.metric.set_rows;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_current_bounds(current, 1, cfg.search.lower, cfg.search.upper));
    TEST_ASSERT_TRUE(world_listen(world, &cfg));
}

#endif
