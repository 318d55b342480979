#!/usr/bin/env bash
# AUVID_MAX_POPULATION 0: the library without the file of Algorithm 1 identifies a linear model, and
# refuses what needs Algorithm 1.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cat >"$scratch/small.c" <<'END_C'
#include <stdio.h>
#include <string.h>
#include "auvid/auvid.h"

enum { N = 3 };
static auvid_optimizer_t optimizer;
static auvid_identifier_t id;
static const auvid_real_t optimum[N] = {2, -3, 5};

static void report(const char *what, bool good)
{
    printf("%sok - %s\n", good ? "" : "not ", what);
}

static auvid_real_t cost(const auvid_real_t *x)
{
    auvid_real_t sum = 1;
    for (int i = 0; i < N; ++i) {
        sum += (x[i] - optimum[i]) * (x[i] - optimum[i]);
    }
    return sum;
}

/* Searches from `start`, certified to have cost `least`. Returns how it ended. */
static auvid_status_t search(const auvid_real_t *start, auvid_real_t least)
{
    auvid_search_config_t cfg;
    auvid_real_t x[AUVID_MAX_PARAMETERS];
    auvid_search_defaults(&cfg, N);
    auvid_status_t status = auvid_optimizer_init(&optimizer, &cfg, NULL);
    status = status < 0 ? status : auvid_optimizer_certify(&optimizer, start, least, 0.01f);
    while (status >= AUVID_OK && status <= AUVID_PENDING) {
        status = auvid_optimizer_ask(&optimizer, x);
        if (status == AUVID_OK) {
            auvid_optimizer_tell(&optimizer, cost(x));
        }
    }
    return status;
}

static auvid_status_t init(uint8_t phases, uint16_t population)
{
    auvid_identifier_config_t cfg;
    auvid_needs_t needs;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.search.phases = phases;
    cfg.search.population = population;
    auvid_status_t status = auvid_identifier_init(&id, &cfg);
    bool fits = auvid_identifier_needs(&cfg, &needs) == AUVID_OK;
    report("auvid_identifier_needs agrees with init", fits == (status == AUVID_OK) &&
           (needs.population == 0) == fits);
    return status;
}

int main(void)
{
    const auvid_real_t elsewhere[N] = {10, 10, 10}, *best;
    auvid_real_t least;
    auvid_search_config_t cfg;
    auvid_search_defaults(&cfg, N);
    report("the default is the local phase", cfg.phases == AUVID_SEARCH_LOCAL &&
           auvid_search_check(&cfg) == AUVID_OK);
    report("a certificate is confirmed by its cost and one poll", search(optimum, 1) ==
           AUVID_FINISHED && optimizer.work.line_search == 2 * N + 1 && optimizer.work.crs == 0);
    report("a wrong certificate does not hold the search", search(elsewhere, 1) == AUVID_FINISHED &&
           !optimizer.certified);
    best = auvid_optimizer_best(&optimizer, &least);
    report("it finds the minimum", least < 1.0001f && best[0] > 1.9f && best[0] < 2.1f);
    auvid_optimizer_init(&optimizer, &cfg, NULL);
    report("there is no population for a point",
           auvid_optimizer_add_point(&optimizer, optimum) == AUVID_ERR_STATE);
    report("the state has no room for one", sizeof(auvid_crs_t) < sizeof(auvid_line_search_t));

    report("an identifier starts", init(AUVID_SEARCH_LOCAL, 0) == AUVID_OK);
    for (uint8_t phases = AUVID_SEARCH_BOTH; phases < AUVID_SEARCH_LOCAL; ++phases) {
        report("Algorithm 1 is refused, by its name", init(phases, 0) == AUVID_ERR_POPULATION &&
               strcmp(id.refusal.part, "search") == 0 &&
               strcmp(id.refusal.field, "phases: AUVID_MAX_POPULATION") == 0 &&
               id.refusal.value == phases && id.refusal.limit == AUVID_SEARCH_LOCAL);
    }
    report("a population is refused", init(AUVID_SEARCH_LOCAL, 52) == AUVID_ERR_POPULATION &&
           strcmp(id.refusal.field, "population") == 0 && id.refusal.limit == 0);
    return 0;
}
END_C
printf '#include "%s"\n' "$PWD"/lib/src/{base,navigation,metric,search}/*.c \
    "$PWD"/lib/src/identifier/auvid_{identifier*,input}.c "$PWD"/lib/src/models/auvid_vehicle.c \
    "$scratch/small.c" |
    grep -v auvid_crs.c >"$scratch/unity.c"
gcc -std=c11 -ffp-contract=off -O1 -Wall -Wextra -Werror -Ilib/include -DAUVID_MAX_POPULATION=0 \
    -DAUVID_MAX_COMMANDS=0 -ffunction-sections -Wl,--gc-sections -o "$scratch/small" \
    "$scratch/unity.c" && echo "ok - it links without the file of Algorithm 1" ||
    echo "not ok - it does not link without the file of Algorithm 1"
"$scratch/small" || echo "not ok - ended with status $?"
