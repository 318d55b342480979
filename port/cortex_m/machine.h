/**
 * @file machine.h
 * What start-up gives an image on the boards of boards.txt, all of which QEMU has: a timer
 * interrupt, sleep, how much stack was used, and semihosting (the debugger's, or QEMU's, way to
 * files and exit status of the host).
 *
 * machine_arm.c and machine_riscv.c are one file's two forms; which one is compiled to something,
 * the compiler's target decides. On a board of your own, its vendor's start-up takes their place.
 */
#ifndef MACHINE_H
#define MACHINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Where execution begins: memory, stack paint, FPU, then main(). */
void machine_reset(void);

/** For start-up: .data, .bss, and paint over the stack that is not in use yet. */
void machine_prepare(void);

/** Call `handler` from the timer's interrupt, some thousand times a second. */
void machine_timer(void (*handler)(void));

/** Until the next interrupt. */
void machine_sleep(void);

/** Bytes of the stack that were in use at any time since reset. */
uint32_t machine_stack_used(void);

/** One word of semihosting: `operation`, and its argument. */
uintptr_t machine_trap(uintptr_t operation, const void *argument);

/** End the run; `status` becomes QEMU's exit status. */
void machine_exit(int status) __attribute__((noreturn));

/** Text to the host's console. */
void machine_print(const char *text);
void machine_print_number(uint32_t number);

/** A file of the host, in the directory QEMU was started in. Negative: there is none. */
int machine_open(const char *name, bool write);
/** How many bytes came: 0 at the end of the file. */
size_t machine_read(int file, void *to, size_t bytes);
bool machine_write(int file, const void *from, size_t bytes);

#endif
