/*
 * The node: uncertain inputs, and what is wrong with them.
 */
#include <string.h>

#include "../uncertain/auvid_uncertain_parts_internal.h"
#include "auvid_node_step_internal.h"

/* Returns the number of an input in the DBC: that of auvid_uncertain_input_t without those that
 * have no class, then those that belong to one DoF, then the filter, which is younger. */
static uint32_t node_input(int input)
{
    int code = input < OWN_INPUTS ? input : input - OWN_INPUTS + AUVID_UNCERTAIN_FORCE_RESPONSE;
    return input == (int)AUVID_UNCERTAIN_FILTER
               ? (uint32_t)AUVID_CAN_INPUT_TIMING_FILTER
               : (uint32_t)(code > (int)AUVID_UNCERTAIN_FILTER ? code - 1 : code);
}

/* Returns the input that has a number; INPUTS: none. */
static int node_input_of(uint32_t number)
{
    int input = 0;
    while (input < INPUTS && (auvid_uncertain_row(input)->class == AUVID_CAUSE_COUNT ||
                              node_input(input) != number)) {
        ++input;
    }
    return input;
}

_Static_assert((int)AUVID_UNCERTAIN_DVL_YAW == AUVID_CAN_INPUT_MOUNTING_DVL_YAW, "node_input");
_Static_assert((int)AUVID_UNCERTAIN_DVL_LATE - 1 == AUVID_CAN_INPUT_TIMING_DVL, "node_input");
_Static_assert((int)INPUT_CROSS_FLOW - OWN_INPUTS + 1 ==
                   AUVID_CAN_INPUT_INFLOW_CROSS_FLOW - AUVID_CAN_INPUT_TIMING_DVL,
               "node_input");
_Static_assert(AUVID_CAUSE_COUNT == 7, "wrong_inputs.named, wrong_input.rank");
_Static_assert((int)AUVID_YAW == AUVID_CAN_DOF_YAW, "wrong_input.dof");

/* Bits of wrong_inputs.flags. */
enum { CAUSES_CONTRADICTED = 1, CAUSES_THRUST_DIFFERS = 2 };

/* Each call reports the next class. */
static void node_report_causes(auvid_node_t *node, auvid_can_frame_t *frame, int *count)
{
    const auvid_causes_t *causes = &node->id.attached.uncertain->causes;
    auvid_can_message_t m = {.kind = AUVID_CAN_WRONG_INPUTS};
    m.as.wrong_inputs.flags = (causes->contradicted ? CAUSES_CONTRADICTED : 0u) |
                              (causes->thrust_differs ? CAUSES_THRUST_DIFFERS : 0u);
    m.as.wrong_inputs.number = auvid_node_number(causes->number);
    m.as.wrong_inputs.named = causes->named;
    m.as.wrong_inputs.differs = causes->differs;
    auvid_node_send(node, &m, frame, count);
    if (causes->named == 0) {
        return;
    }
    uint32_t rank = node->next.cause % causes->named;
    const auvid_cause_t *cause = &causes->cause[causes->order[rank]];
    node->next.cause = (uint8_t)(rank + 1);
    m = (auvid_can_message_t){.kind = AUVID_CAN_WRONG_INPUT};
    m.as.wrong_input.number = auvid_node_number(causes->number) % 4u;
    m.as.wrong_input.rank = rank;
    m.as.wrong_input.input = node_input(cause->input);
    m.as.wrong_input.dof = cause->dof;
    m.as.wrong_input.share =
        (uint32_t)(auvid_min(AUVID_C(100.0) * cause->share, AUVID_C(127.0)) + AUVID_C(0.5));
    m.as.wrong_input.value = cause->value;
    auvid_node_send(node, &m, frame, count);
}

auvid_status_t auvid_node_attach_uncertain(auvid_node_t *node, auvid_uncertain_t *storage,
                                           const auvid_uncertain_config_t *cfg)
{
    if (node == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_uncertain_config_t of_bus = *cfg;
    of_bus.fractions = true;
    auvid_status_t status =
        auvid_identifier_attach_uncertain(&node->id, storage, &of_bus, &node->allocation);
    if (status == AUVID_OK) {
        node->report_causes = node_report_causes;
    }
    return status;
}

static auvid_status_t causes_take_all(auvid_causes_t *causes, const auvid_can_wrong_inputs_t *m)
{
    if (causes->number != m->number) {
        memset(causes, 0, sizeof *causes);
    }
    causes->number = m->number;
    causes->contradicted = (m->flags & CAUSES_CONTRADICTED) != 0;
    causes->thrust_differs = (m->flags & CAUSES_THRUST_DIFFERS) != 0;
    causes->differs = m->differs;
    causes->named = causes->named < m->named ? causes->named : (uint8_t)m->named;
    return AUVID_OK;
}

auvid_status_t auvid_causes_take(auvid_causes_t *causes, const auvid_can_message_t *message)
{
    if (causes == NULL || message == NULL) {
        return AUVID_ERR_NULL;
    }
    if (message->kind == AUVID_CAN_WRONG_INPUTS) {
        return causes_take_all(causes, &message->as.wrong_inputs);
    }
    const auvid_can_wrong_input_t *m = &message->as.wrong_input;
    const int input = node_input_of(m->input);
    if (message->kind != AUVID_CAN_WRONG_INPUT || message->absent != 0 ||
        m->number != causes->number % 4u || m->rank > causes->named ||
        m->rank >= AUVID_CAUSE_COUNT || input == INPUTS || m->dof > AUVID_CAN_DOF_YAW) {
        return AUVID_UNUSED;
    }
    auvid_cause_class_t class = auvid_uncertain_row(input)->class;
    causes->order[m->rank] = (uint8_t) class;
    causes->named = (uint8_t)(causes->named + (m->rank == causes->named));
    causes->cause[class] = (auvid_cause_t){.value = m->value,
                                           .share = AUVID_C(0.01) * (auvid_real_t)m->share,
                                           .input = (uint8_t)input,
                                           .dof = (uint8_t)m->dof,
                                           .named = true};
    return AUVID_OK;
}
