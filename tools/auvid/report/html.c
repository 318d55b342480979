/*
 * The report as one HTML file: report.html, with the result as JSON inside, and as text for readers
 * without JavaScript.
 */
#include "html.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../log/csv.h"
#include "../base/embedded.h"
#include "../base/report_error.h"

/* Longest note and sentence. */
enum { WORDS = 300 };

extern const embedded_t report_template[]; /* generated from report.html */

/* Writes text that HTML does not read as markup. */
static void escaped(FILE *out, const char *text)
{
    for (; *text != '\0'; ++text) {
        switch (*text) {
        case '<':
            fputs("&lt;", out);
            break;
        case '&':
            fputs("&amp;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc(*text, out);
            break;
        }
    }
}

/* The command line; an argument with other than plain characters stands in quotes. */
static void write_command(FILE *out, const options_t *options)
{
    fprintf(out, "auvid %s", options->command);
    for (int i = 0; i < options->arguments; ++i) {
        const char *word = options->argument[i];
        static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                    "0123456789+-_=,./:@%";
        bool quoted = word[0] == '\0' || word[strspn(word, plain)] != '\0';
        fputs(quoted ? " '" : " ", out);
        for (; *word != '\0'; ++word) {
            const char one[2] = {*word, '\0'};
            escaped(out, *word == '\'' ? "'\\''" : one);
        }
        fputs(quoted ? "'" : "", out);
    }
    fputc('\n', out);
}

static void write_parameter(FILE *out, const result_t *result, int i)
{
    char note[WORDS];
    report_note(result, i, note, sizeof note);
    fputs("  ", out);
    escaped(out, result->vehicle->parameter[i].name);
    fputs(" ", out);
    if (report_is_identified(result, i)) {
        fprintf(out, "%.5g", (double)result->estimate.pi[i]);
    } else {
        fputc('-', out);
    }
    if (isfinite(report_sigma(result, i))) {
        fprintf(out, " +- %.2g", HALF_WIDTH * report_sigma(result, i));
    }
    fputc(' ', out);
    escaped(out, report_unit(result, i));
    fputs(note[0] != '\0' ? "; not identifiable: " : "", out);
    escaped(out, note);
    fputc('\n', out);
}

static void write_sentences(FILE *out, const result_t *result, const char *none,
                            bool (*sentence)(const result_t *, unsigned, char *, size_t))
{
    char text[WORDS];
    unsigned k = 0;
    for (; sentence(result, k, text, sizeof text); ++k) {
        fputs("  ", out);
        escaped(out, text);
        fputc('\n', out);
    }
    if (k == 0) {
        fprintf(out, "  %s\n", none);
    }
}

/* What is wrong with the logs. */
static void write_findings(FILE *out, const report_findings_t *findings)
{
    if (findings == NULL) {
        return;
    }
    fputs("What is wrong with the log?\n", out);
    for (int i = 0; i < findings->count; ++i) {
        const report_finding_t *f = &findings->at[i];
        fprintf(out, "  %s: ", f->error ? "error" : "warning");
        escaped(out, f->log);
        fputs(": ", out);
        escaped(out, f->sentence);
        fputc('\n', out);
    }
    fputs(findings->count == 0 ? "  nothing was found\n" : "", out);
}

/* The four questions, answered in text. */
static void write_text(FILE *out, const result_t *result)
{
    int parameters = 0;
    fputs("How well is motion predicted?\n", out);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (result->has_validation && report_is_modelled(result, (auvid_dof_t)j) &&
            (result->validated >> j & 1u)) {
            fprintf(out, "  %s: R2 of held-out velocity %.4f\n", report_dof_name[j], result->r2[j]);
        } else if (report_is_driven(result, (auvid_dof_t)j)) {
            fprintf(out, "  %s: R2 of the force %.4f\n", report_dof_name[j],
                    (double)result->estimate.r2_force[j]);
        }
    }
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        parameters += (int)(result->free >> i & 1u);
    }
    fprintf(out, "What is known? %d of %d parameters are identifiable (+-: 95 %%)\n",
            report_identifiable(&result->estimate), parameters);
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        if (result->free >> i & 1u) {
            write_parameter(out, result, i);
        }
    }
    write_findings(out, result->findings);
    fputs("What is wrong with the inputs?\n", out);
    write_sentences(out, result,
                    result->estimate.confidence.unchecked ? "their errors were not examined"
                    : result->inputs_estimated
                        ? "no error of thrust, time stamps or sensors was found"
                        : "not examined: they were taken as exact",
                    report_cause);
    fputs("What is missing?\n", out);
    write_sentences(out, result, "nothing", report_missing);
}

int report_html(const options_t *options, const result_t *result, const second_result_t *second)
{
    csv_writer_t writer;
    if (options->report == NULL) {
        return 0;
    }
    if (csv_create(&writer, options->report) != 0) {
        return EXIT_REFUSED;
    }
    for (const char *const *piece = report_template[0].piece; *piece != NULL; ++piece) {
        if (strcmp(*piece, "<!--text-->\n") == 0) {
            write_text(writer.file, result);
        } else if (strcmp(*piece, "<!--command-->\n") == 0) {
            write_command(writer.file, options);
        } else if (strcmp(*piece, "<!--json-->\n") == 0) {
            report_json(writer.file, result, NULL, second, NULL); /* has no "<" */
        } else {
            fputs(*piece, writer.file);
        }
    }
    return csv_commit(&writer);
}
