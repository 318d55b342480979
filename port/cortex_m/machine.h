/**
 * @file machine.h
 * Services of the start-up code for the boards of boards.txt, all emulated by QEMU: a timer
 * interrupt, sleep, the stack used, and semihosting. Semihosting is the access of an image to files
 * and exit status of the host, through the debugger or QEMU.
 *
 * machine_arm.c and machine_riscv.c implement the same functions; the compiler's target selects
 * one. On your own board, use the start-up code of its vendor instead.
 */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Entry point: prepares memory, stack pattern and FPU, then calls main(). */
void machine_reset(void);

/** For start-up: initialises .data and .bss, and fills the unused stack with a pattern. */
void machine_prepare(void);

/** Calls `handler` from the timer interrupt, some thousand times per second. */
void machine_timer(void (*handler)(void));

/** Sleeps until the next interrupt. */
void machine_sleep(void);

/** Returns the maximum stack used since reset [bytes]. */
uint32_t machine_stack_used(void);

/** Calls one semihosting operation with its argument. */
uintptr_t machine_trap(uintptr_t operation, const void *argument);

/** Ends the run; `status` becomes the exit status of QEMU. */
void machine_exit(int status) __attribute__((noreturn));

/** Prints to the console of the host. */
void machine_print(const char *text);
void machine_print_number(uint32_t number);

/** Opens a file of the host, in the current directory of QEMU. Returns a negative number on error.
 * */
int machine_open(const char *name, bool write);
/** Returns the number of bytes read; 0 at the end of the file. */
size_t machine_read(int file, void *to, size_t bytes);
bool machine_write(int file, const void *from, size_t bytes);

#endif
