/*
 * Start-up of a Cortex-M: vectors, memory, FPU, SysTick. Only the FPU goes beyond ARMv6-M.
 */
#if defined(__arm__)
#include "machine.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

/* 0.2 ms at 25 MHz, the clock of most boards. */
#define PERIOD 5000u

extern uint32_t stack_top[];
int main(void);

/* Provided by the C library in images that link one. */
extern void initialise_monitor_handles(void) __attribute__((weak));
extern void __libc_init_array(void) __attribute__((weak));
extern void exit(int status) __attribute__((weak));
void _init(void);
void _fini(void);
void _init(void)
{
}
void _fini(void)
{
}

static void (*timer_handler)(void);

static void start(void) __attribute__((noreturn, used));
static void start(void)
{
#if defined(__ARM_FP)
    CPACR |= 0xFu << 20; /* coprocessors 10 and 11: the FPU, before any of its instructions */
    __asm__ volatile("dsb\n isb" ::: "memory");
#endif
    machine_prepare();
    if (initialise_monitor_handles != NULL) {
        initialise_monitor_handles();
    }
    if (__libc_init_array != NULL) {
        __libc_init_array();
    }
    int status = main();
    if (exit != NULL) {
        exit(status); /* flushes stdout */
    }
    machine_exit(status);
}

__attribute__((naked)) void machine_reset(void)
{
    __asm__ volatile("bl start"); /* a plain branch does not reach far */
}

/* Ends the run with a distinct status instead of hanging. */
static void fault(void)
{
    machine_exit(120);
}

static void systick(void)
{
    if (timer_handler != NULL) {
        timer_handler();
    }
}

typedef void (*vector_t)(void);
__attribute__((section(".vectors"), used)) static const union {
    uint32_t *stack;
    vector_t handler;
} vectors[16] = {{.stack = stack_top}, {.handler = machine_reset},
                 {.handler = fault}, /* NMI */
                 {.handler = fault}, /* hard fault, and four that ARMv6-M reports as one */
                 {.handler = fault},   {.handler = fault},
                 {.handler = fault},   {.handler = fault},
                 {.stack = NULL},      {.stack = NULL},
                 {.stack = NULL},      {.handler = fault}, /* SVC */
                 {.handler = fault},                       /* debug monitor */
                 {.stack = NULL},      {.handler = fault}, /* PendSV */
                 {.handler = systick}};

void machine_timer(void (*handler)(void))
{
    timer_handler = handler;
    SYSTICK_RELOAD = PERIOD - 1u;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 7u; /* core clock, interrupt enabled */
}

void machine_sleep(void)
{
    __asm__ volatile("wfi" ::: "memory");
}

uintptr_t machine_trap(uintptr_t operation, const void *argument)
{
    register uintptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

/* Called by the C library at exit. */
void _exit(int status) __attribute__((noreturn));
void _exit(int status)
{
    machine_exit(status);
}

#else
typedef int machine_arm_is_for_another_core;
#endif
