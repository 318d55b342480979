/*
 * For images whose instructions are counted. An interrupt must not occur during a count, so the
 * timer's handler is called where the loop sleeps. Linked with
 * --wrap=machine_timer,--wrap=machine_sleep.
 */
#include "machine.h"

static void (*timer_handler)(void);

void __wrap_machine_timer(void (*handler)(void));
void __wrap_machine_timer(void (*handler)(void))
{
    timer_handler = handler;
}

void __wrap_machine_sleep(void);
void __wrap_machine_sleep(void)
{
    timer_handler();
}
