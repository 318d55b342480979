/*
 * Memory initialisation and semihosting, common to ARM and RISC-V except for the trap instruction.
 * Numbers of operations: Arm, "Semihosting for AArch32 and AArch64", release 2.0.
 */
#include "machine.h"

/* Defined in firmware.ld. */
extern uint32_t data_image[], data_begin[], data_end[], bss_begin[], bss_end[];
extern uint32_t stack_limit[], stack_top[];

/* Fills unused stack. Unlikely as data. */
#define PAINT 0xDEADBEEFu

/* The stack 32 words and more below this frame is not in use. */
void machine_prepare(void)
{
    uint32_t *below = (uint32_t *)__builtin_frame_address(0) - 32;
    for (uint32_t *p = stack_limit; p < below; ++p) {
        *p = PAINT;
    }
    const uint32_t *from = data_image;
    for (uint32_t *p = data_begin; p < data_end;) {
        *p++ = *from++;
    }
    for (uint32_t *p = bss_begin; p < bss_end;) {
        *p++ = 0;
    }
}

uint32_t machine_stack_used(void)
{
    const uint32_t *p = stack_limit;
    while (p < stack_top && *p == PAINT) {
        ++p;
    }
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)p);
}

enum { OPEN = 0x01, WRITE0 = 0x04, WRITE = 0x05, READ = 0x06, EXIT_EXTENDED = 0x20 };
enum { APPLICATION_EXIT = 0x20026 };

/* Without the attribute gcc calls strlen(), which has 220 bytes. */
__attribute__((optimize("no-tree-loop-distribute-patterns"))) static size_t length(const char *text)
{
    size_t n = 0;
    while (text[n] != '\0') {
        ++n;
    }
    return n;
}

void machine_exit(int status)
{
    const uintptr_t argument[2] = {APPLICATION_EXIT, (uintptr_t)status};
    for (;;) {
        (void)machine_trap(EXIT_EXTENDED, argument);
    }
}

void machine_print(const char *text)
{
    (void)machine_trap(WRITE0, text);
}

void machine_print_number(uint32_t number)
{
    char digits[11];
    char *first = &digits[sizeof digits - 1];
    *first = '\0';
    do {
        *--first = (char)('0' + number % 10u);
        number /= 10u;
    } while (number != 0);
    machine_print(first);
}

int machine_open(const char *name, bool write)
{
    const uintptr_t argument[3] = {(uintptr_t)name, write ? 4u : 0u, length(name)};
    return (int)machine_trap(OPEN, argument);
}

/* READ and WRITE return the number of bytes that were not transferred. */
size_t machine_read(int file, void *to, size_t bytes)
{
    const uintptr_t argument[3] = {(uintptr_t)file, (uintptr_t)to, bytes};
    return bytes - machine_trap(READ, argument);
}

bool machine_write(int file, const void *from, size_t bytes)
{
    const uintptr_t argument[3] = {(uintptr_t)file, (uintptr_t)from, bytes};
    return machine_trap(WRITE, argument) == 0;
}
