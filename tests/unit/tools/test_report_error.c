/*
 * Messages of the program about a configuration that was refused.
 */
#include <stdio.h>
#include <string.h>

#include "base/report_error.h"
#include "unity.h"

static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static char text[256];

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    memset(text, 'x', sizeof text);
}

void tearDown(void)
{
}

static void test_of_what_fits_no_size_is_named(void)
{
    report_sizes(text, sizeof text, &cfg);
    TEST_ASSERT_EQUAL_STRING("", text);
}

static void test_each_size_that_is_too_small_is_a_compiler_flag(void)
{
    cfg.metric.half_width[0] = 20;
    report_sizes(text, sizeof text, &cfg);
    TEST_ASSERT_EQUAL_STRING(" -DAUVID_MAX_TAPS=83 -DAUVID_MAX_OVERLAP=17", text);
    cfg.search.population = AUVID_MAX_POPULATION + 32;
    report_sizes(text, sizeof text, &cfg);
    TEST_ASSERT_EQUAL_STRING(
        " -DAUVID_MAX_TAPS=83 -DAUVID_MAX_POPULATION=100 -DAUVID_MAX_OVERLAP=17", text);
    report_sizes(text, 8, &cfg);
    TEST_ASSERT_EQUAL_STRING(" -DAUVI", text);
}

/* What report_refused prints about a configuration that init refuses. */
static void refused(const auvid_identifier_config_t *of, char *line, int size)
{
    auvid_status_t status = auvid_identifier_init(&id, &cfg);
    FILE *file = freopen("/dev/null", "w", stderr);
    TEST_ASSERT_NOT_NULL(file);
    (void)setvbuf(stderr, line, _IOFBF, (size_t)size);
    memset(line, 0, (size_t)size);
    TEST_ASSERT_EQUAL_INT(EXIT_REFUSED, report_refused("fit", status, &id.refusal, of));
}

static void test_message_names_the_field_and_then_the_sizes(void)
{
    static char line[2][512];
    cfg.metric.half_width[0] = 20;
    refused(&cfg, line[0], sizeof line[0]);
    TEST_ASSERT_EQUAL_STRING(
        "auvid: fit: configuration refused: metric.half_width is 83, limit 43: "
        "a count exceeds its size in config.h; build with "
        "-DAUVID_MAX_TAPS=83 -DAUVID_MAX_OVERLAP=17\n",
        line[0]);
    refused(NULL, line[1], sizeof line[1]);
    TEST_ASSERT_EQUAL_STRING(
        "auvid: fit: configuration refused: metric.half_width is 83, limit 43: "
        "a count exceeds its size in config.h\n",
        line[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_of_what_fits_no_size_is_named);
    RUN_TEST(test_each_size_that_is_too_small_is_a_compiler_flag);
    RUN_TEST(test_message_names_the_field_and_then_the_sizes);
    return UNITY_END();
}
