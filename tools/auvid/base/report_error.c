#include "report_error.h"

#include <stdarg.h>
#include <stdio.h>

#include "auvid/config.h"
#include "json_string.h"

enum { LINE = 512 };

static char last_error[LINE];

static void print_line(const char *kind, char line[LINE], const char *format, va_list arguments)
{
    (void)vsnprintf(line, LINE, format, arguments);
    for (char *c = line; *c != '\0'; ++c) {
        if ((unsigned char)*c < ' ' || *c == 127) {
            *c = '?'; /* a line break in a file name or in a field */
        }
    }
    (void)fflush(stdout);
    fprintf(stderr, "auvid: %s%s\n", kind, line);
}

void report_error_line(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line("", last_error, format, arguments);
    va_end(arguments);
}

void report_warning(const char *format, ...)
{
    char line[LINE];
    va_list arguments;
    va_start(arguments, format);
    print_line("warning: ", line, format, arguments);
    va_end(arguments);
}

void report_error_json(void)
{
    printf("{\n  \"version\": \"%s\",\n  \"error\": ", AUVID_VERSION_STRING);
    json_string(stdout, last_error);
    puts("\n}");
}

void report_sizes(char *text, size_t size, const auvid_identifier_config_t *cfg)
{
    auvid_needs_t needs = {0};
    (void)auvid_identifier_needs(cfg, &needs);
#define SIZE(name, member)                                                                         \
    {                                                                                              \
#name, needs.member, AUVID_MAX_##name                                                      \
    }
    const struct {
        const char *name;
        uint32_t needed, size;
    } all[] = {SIZE(PARAMETERS, parameters), SIZE(SETS, sets),
               SIZE(COMMANDS, commands),     SIZE(TAPS, taps),
               SIZE(HALF_WIDTH, half_width), SIZE(POPULATION, population),
               SIZE(FACTOR, factor),         SIZE(COLUMNS, columns),
               SIZE(OVERLAP, overlap)};
    text[0] = '\0';
    for (size_t i = 0, at = 0; i < sizeof all / sizeof all[0] && at < size; ++i) {
        if (all[i].needed > all[i].size) {
            at += (size_t)snprintf(text + at, size - at, " -DAUVID_MAX_%s=%u", all[i].name,
                                   (unsigned)all[i].needed);
        }
    }
}

int report_refused(const char *who, auvid_status_t status, const auvid_refusal_t *why,
                   const auvid_identifier_config_t *cfg)
{
    char element[16] = "", sizes[256] = "";
    if (cfg != NULL) {
        report_sizes(sizes, sizeof sizes, cfg);
    }
    if (why->element >= 0) {
        (void)snprintf(element, sizeof element, "[%d]", why->element);
    }
    return report_error("%s: configuration refused: %s%s%s%s is %g, limit %g: %s%s%s", who,
                        why->part, why->part[0] == '\0' ? "" : ".", why->field, element,
                        (double)why->value, (double)why->limit, auvid_status_str(status),
                        sizes[0] == '\0' ? "" : "; build with", sizes);
}
