/*
 * Start-up of a RISC-V hart in machine mode: memory, trap, the timer of the CLINT at the address of
 * QEMU's `virt`.
 */
#if defined(__riscv)
#include "machine.h"

#define CLINT_COMPARE ((volatile uint32_t *)0x02004000u) /* 64 bits, in two halves */
#define CLINT_TIME ((volatile uint32_t *)0x0200BFF8u)
#define TIMER_INTERRUPT 0x80000007u

/* 0.2 ms at 10 MHz. */
#define PERIOD 2000u

int main(void);

static void (*timer_handler)(void);

/* The low half may wrap between the two reads. */
static uint64_t now(void)
{
    uint32_t high, low;
    do {
        high = CLINT_TIME[1];
        low = CLINT_TIME[0];
    } while (high != CLINT_TIME[1]);
    return (uint64_t)high << 32 | low;
}

/* In an order in which the comparison never sees a time earlier than the new one. */
static void set_compare(uint64_t time)
{
    CLINT_COMPARE[1] = UINT32_MAX;
    CLINT_COMPARE[0] = (uint32_t)time;
    CLINT_COMPARE[1] = (uint32_t)(time >> 32);
}

__attribute__((interrupt("machine"), aligned(4))) static void trap(void)
{
    uint32_t cause;
    __asm__ volatile(".option push\n.option arch, +zicsr\ncsrr %0, mcause\n.option pop"
                     : "=r"(cause));
    if (cause != TIMER_INTERRUPT) {
        machine_exit(120); /* a fault ends the run instead of hanging */
    }
    set_compare(now() + PERIOD);
    timer_handler();
}

static void start(void) __attribute__((noreturn, used));
static void start(void)
{
    machine_prepare();
    machine_exit(main());
}

__attribute__((naked, section(".vectors"))) void machine_reset(void)
{
    __asm__ volatile(".option push\n.option norelax\n"
                     "la gp, __global_pointer$\n"
                     ".option pop\n"
                     "la sp, stack_top\n"
                     "j start");
}

void machine_timer(void (*handler)(void))
{
    timer_handler = handler;
    set_compare(now() + PERIOD);
    __asm__ volatile(".option push\n.option arch, +zicsr\n"
                     "csrw mtvec, %0\n"
                     "csrs mie, %1\n"
                     "csrsi mstatus, 8\n"
                     ".option pop" ::"r"(trap),
                     "r"(1u << 7)
                     : "memory");
}

void machine_sleep(void)
{
    __asm__ volatile("wfi" ::: "memory");
}

/* Semihosting is marked by three uncompressed instructions in one page. */
uintptr_t machine_trap(uintptr_t operation, const void *argument)
{
    register uintptr_t a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n.option norvc\n.balign 16\n"
                     "slli x0, x0, 0x1f\n"
                     "ebreak\n"
                     "srai x0, x0, 7\n"
                     ".option pop"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
    return a0;
}

#else
typedef int machine_riscv_is_for_another_core;
#endif
