/*
 * libFuzzer: random frames into a node that excites on an arm frame. After each tick frame it runs
 * step, work and report, as `auvid node` does.
 */
#include "auvid/node.h"
#include "fuzz_frames.h"

enum { BUDGET = 50 };

static auvid_node_t fresh;
static auvid_actuation_t fresh_actuation;

/* Every frame of a node is authentic and in range. */
static void check_sent(const auvid_can_frame_t *frame, int count)
{
    REQUIRE(count >= 0 && count <= AUVID_NODE_FRAMES);
    for (int i = 0; i < count; ++i) {
        auvid_can_message_t message;
        REQUIRE(auvid_can_unpack(NULL, &frame[i], &message) == AUVID_OK);
    }
}

int LLVMFuzzerInitialize(int *argc, char ***argv);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    auvid_identifier_config_t identifier;
    auvid_actuation_config_t acting;
    auvid_node_config_t cfg;
    auvid_identifier_defaults(&identifier, &auvid_girona500);
    auvid_node_defaults(&cfg);
    cfg.answer = true;
    auvid_actuation_defaults(&acting);
    REQUIRE(auvid_node_init(&fresh, &cfg, &auvid_allocation_girona500, &identifier) == AUVID_OK);
    REQUIRE(auvid_node_attach_actuation(&fresh, &fresh_actuation, &acting) == AUVID_OK);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static auvid_node_t node;
    static auvid_actuation_t actuation;
    auvid_can_frame_t frame, sent[AUVID_NODE_FRAMES];
    uint64_t now_us = 0;
    int count = 0;
    node = fresh;
    actuation = fresh_actuation;
    node.id.actuation = &actuation;
    for (size_t at = 0; at + RECORD <= size && at < (size_t)FRAMES * RECORD; at += RECORD) {
        read_record(data + at, &frame, &now_us);
        if (auvid_node_take(&node, &frame) == AUVID_TICK) {
            (void)auvid_node_step(&node, NULL, sent, &count);
            check_sent(sent, count);
            (void)auvid_node_work(&node, BUDGET);
            (void)auvid_node_report(&node, data[at], sent, &count);
            check_sent(sent, count);
        }
    }
    return 0;
}
