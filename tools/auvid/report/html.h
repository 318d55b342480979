/**
 * @file html.h
 * The report as a page: one HTML file that needs no network.
 */
#ifndef PROGRAM_HTML_H
#define PROGRAM_HTML_H

#include "../options/options.h"
#include "report.h"

/** Writes the file of --report: report.html with the JSON object of report_json inside, completely
 * or not at all. Does nothing without --report. second may be NULL. Returns 0, or EXIT_REFUSED
 * after one line on stderr. */
int report_html(const options_t *options, const result_t *result, const second_result_t *second);

#endif
