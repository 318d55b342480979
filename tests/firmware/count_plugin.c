/*
 * A plugin of QEMU that counts the instructions of every function of an image, call by call. The
 * count of a call includes the functions it calls. The image is not modified.
 *
 *     -plugin count_plugin.so,functions=FILE,out=FILE
 *
 * functions: lines "address T name" of all functions, as `nm --defined-only` prints them.
 * out: lines "name calls total max longest". The line "tick" is the sum over one tick of a node:
 * calls of auvid_node_take, _step, _work and _report, up to the end of the last. `longest` is the
 * function's part of the longest tick.
 *
 * A function has returned when the instruction after its call is executed. The plugin does not
 * depend on the core. A jump to the first instruction of a function counts as a call. It ends with
 * the function that contains the jump. Recursion and interrupts are not supported.
 *
 * Debian ships no qemu-plugin.h, so this file declares the functions used of the interface (version
 * 1, QEMU 4.2 to 8.2).
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
typedef struct qemu_info_t qemu_info_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { NO_REGISTERS = 0 };
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t,
                                           void (*)(qemu_plugin_id_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, void (*)(unsigned int, void *),
                                          int, void *);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, void *), void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn *);
#define EXPORTED __attribute__((visibility("default")))
EXPORTED int qemu_plugin_version = 1;
EXPORTED int qemu_plugin_install(qemu_plugin_id_t, const qemu_info_t *, int, char **);

typedef struct {
    uint64_t at, calls, total, most;
    uint64_t before_tick, in_longest;
    char name[100];
} function_t;

/* A block of instructions executed from its first to its last. */
typedef struct {
    uint64_t begin, end, count;
    function_t *function; /* that begins here; or NULL */
} block_t;

typedef struct {
    function_t *function;
    uint64_t back, before; /* return address; instructions before the call */
} call_t;

enum { FUNCTIONS = 20000, DEPTH = 1000 };
static function_t functions[FUNCTIONS], tick = {.name = "tick"};
static call_t calls[DEPTH];
static size_t n_functions, depth;
static uint64_t executed, in_tick;
static const block_t *last;
static const char *out;

static void record(function_t *f, uint64_t count)
{
    ++f->calls;
    f->total += count;
    f->most = count > f->most ? count : f->most;
}

static bool is_in_tick(const char *name)
{
    return !strcmp(name, "auvid_node_take") || !strcmp(name, "auvid_node_step") ||
           !strcmp(name, "auvid_node_work") || !strcmp(name, "auvid_node_report");
}

/* A tick ends: what did each function take of it? */
static void end_tick(void)
{
    bool longest = in_tick > tick.most;
    record(&tick, in_tick);
    in_tick = 0;
    for (size_t i = 0; i < n_functions; ++i) {
        function_t *f = &functions[i];
        f->in_longest = longest ? f->total - f->before_tick : f->in_longest;
        f->before_tick = f->total;
    }
}

static void returned(function_t *f, uint64_t count)
{
    record(f, count);
    if (is_in_tick(f->name)) {
        in_tick += count;
        if (!strcmp(f->name, "auvid_node_report")) {
            end_tick();
        }
    }
}

static void execute(unsigned int cpu, void *data)
{
    const block_t *block = data;
    (void)cpu;
    /* The innermost call that returns here, and the functions it jumped to. */
    for (size_t i = depth; i-- > 0;) {
        if (calls[i].back == block->begin) {
            while (depth > i) {
                --depth;
                returned(calls[depth].function, executed - calls[depth].before);
            }
            break;
        }
    }
    if (block->function != NULL && last != NULL &&
        (depth == 0 || calls[depth - 1].function != block->function)) { /* otherwise a loop */
        if (depth == DEPTH) {
            fprintf(stderr, "count_plugin: calls too deep, in %s\n", block->function->name);
            exit(1);
        }
        calls[depth++] = (call_t){block->function, last->end, executed};
    }
    executed += block->count;
    last = block;
}

static int by_address(const void *a, const void *b)
{
    const function_t *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    block_t *block = malloc(sizeof *block); /* never freed: QEMU may translate the block again */
    size_t n = qemu_plugin_tb_n_insns(tb);
    const struct qemu_plugin_insn *end = qemu_plugin_tb_get_insn(tb, n - 1);
    function_t key = {.at = qemu_plugin_tb_vaddr(tb)};
    if (block == NULL) {
        exit(1);
    }
    *block = (block_t){key.at, qemu_plugin_insn_vaddr(end) + qemu_plugin_insn_size(end), n,
                       bsearch(&key, functions, n_functions, sizeof key, by_address)};
    qemu_plugin_register_vcpu_tb_exec_cb(tb, execute, NO_REGISTERS, block);
}

static void at_exit(qemu_plugin_id_t id, void *data)
{
    FILE *file = fopen(out, "w");
    (void)id;
    (void)data;
    if (file == NULL) {
        perror(out);
        exit(1);
    }
    tick.in_longest = tick.most;
    functions[n_functions++] = tick; /* there is space: see read_functions */
    for (size_t i = 0; i < n_functions; ++i) {
        const function_t *f = &functions[i];
        if (f->calls > 0) {
            fprintf(file, "%s %llu %llu %llu %llu\n", f->name, (unsigned long long)f->calls,
                    (unsigned long long)f->total, (unsigned long long)f->most,
                    (unsigned long long)f->in_longest);
        }
    }
    fclose(file);
}

static bool read_functions(const char *name)
{
    FILE *file = fopen(name, "r");
    char kind;
    unsigned long long at;
    function_t f = {0};
    while (file != NULL && fscanf(file, "%llx %c %99s%*[^\n]", &at, &kind, f.name) == 3) {
        char *sizes = strstr(f.name, "_f32"); /* of AUVID_SIZED() */
        if (sizes != NULL && !strncmp(f.name, "auvid_", 6)) {
            *sizes = '\0';
        }
        f.at = at & ~1ull; /* clears the Thumb bit */
        if (strchr("tTwW", kind) != NULL && f.name[0] != '$' && n_functions < FUNCTIONS - 1) {
            functions[n_functions++] = f;
        }
    }
    qsort(functions, n_functions, sizeof functions[0], by_address);
    return file != NULL && fclose(file) == 0;
}

int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t *info, int argc, char **argv)
{
    bool read = false;
    (void)info;
    for (int i = 0; i < argc; ++i) {
        if (!strncmp(argv[i], "functions=", 10)) {
            read = read_functions(argv[i] + 10);
        } else if (!strncmp(argv[i], "out=", 4)) {
            out = strdup(argv[i] + 4);
        }
    }
    if (!read || out == NULL) {
        fprintf(stderr, "count_plugin: functions=FILE,out=FILE are needed\n");
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, at_exit, NULL);
    return 0;
}
