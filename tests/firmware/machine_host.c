/*
 * machine.h on the host, where the firmware's example runs unchanged: the reference for the bits.
 * The timer's interrupt occurs while the loop sleeps.
 */
#include "machine.h"

#include <stdio.h>
#include <stdlib.h>

static FILE *files[2];
static void (*timer_handler)(void);

void machine_timer(void (*handler)(void))
{
    timer_handler = handler;
}

void machine_sleep(void)
{
    timer_handler();
}

uint32_t machine_stack_used(void)
{
    return 0;
}

void machine_exit(int status)
{
    exit(status);
}

void machine_print(const char *text)
{
    (void)fputs(text, stdout);
}

void machine_print_number(uint32_t number)
{
    (void)printf("%u", (unsigned)number);
}

int machine_open(const char *name, bool write)
{
    files[write] = fopen(name, write ? "w" : "r");
    return files[write] != NULL ? (int)write : -1;
}

size_t machine_read(int file, void *to, size_t bytes)
{
    return fread(to, 1, bytes, files[file]);
}

bool machine_write(int file, const void *from, size_t bytes)
{
    return fwrite(from, 1, bytes, files[file]) == bytes;
}
