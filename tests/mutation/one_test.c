/* For mutate.py: a Unity program linked with --wrap=UnityDefaultTestRun runs the test that
 * MUTATION_TEST names; without that variable it prints the names of its tests. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

void __real_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line);
void __wrap_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line);

void __wrap_UnityDefaultTestRun(UnityTestFunction test, const char *name, int line)
{
    const char *chosen = getenv("MUTATION_TEST");
    if (chosen == NULL) {
        printf("test: %s\n", name);
    } else if (strcmp(chosen, name) == 0) {
        __real_UnityDefaultTestRun(test, name, line);
    }
}
