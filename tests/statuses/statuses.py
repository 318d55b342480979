#!/usr/bin/env python3
"""Does each public function return to the unit tests exactly the statuses that its header lists?

usage: statuses.py record        print the C header that records them, see statuses.h
       statuses.py check FILE... compare what the unit tests have recorded with lib/include/auvid
`check` prints "ok" or "not ok" lines. A header lists a status by its name, after @return; "as F",
"those of F" and "the statuses of F" stand for all of another function's, "the errors of F" for
those below zero.
  undocumented  a test saw a status that the header does not list
  unasserted    no test asserts a status that the header lists
"""
import pathlib
import re
import sys

HEADERS = sorted(pathlib.Path("lib/include").glob("auvid/**/*.h"))
# What only a library of other sizes returns.
ELSEWHERE = {
    ("auvid_excitation_plan", "AUVID_ERR_SIZE"),  # AUVID_MAX_SEGMENTS below 12
    ("auvid_excitation_schedule", "AUVID_ERR_SIZE"),
    ("auvid_adaptive_begin", "AUVID_ERR_SIZE"),
}
DECLARATION = re.compile(
    r"/\*\*((?:(?!\*/).)*)\*/\s*(?:static inline )?auvid_status_t\s+(auvid_\w+)\s*\(", re.S
)
REFERENCE = re.compile(r"\b(as|those of|statuses of|errors of) (auvid_\w+)")


def values():
    """The statuses' numbers, by name."""
    text = pathlib.Path("lib/include/auvid/types.h").read_text()
    text = text[: text.index("} auvid_status_t;")]
    return {name: int(number) for name, number in re.findall(r"\b(AUVID_\w+) = (-?\d+)", text)}


def functions():
    """The text after @return of each function that returns a status, by name."""
    found = {}
    for header in HEADERS:
        for text, name in DECLARATION.findall(header.read_text()):
            text = re.sub(r"\s*\n\s*\*?\s*", " ", text)
            found[name] = text[text.find("@return") :].split(" @param")[0]
    return found


def listed(name, texts, number):
    """The statuses in the header, as numbers."""
    text = texts[name]
    own = {number[word] for word in re.findall(r"\bAUVID_\w+", text) if word in number}
    for how, other in REFERENCE.findall(text):
        if other in texts:
            own |= {s for s in listed(other, texts, number) if s < 0 or how != "errors of"}
    return own


def print_header(texts):
    """One macro a function: the tests' calls pass through statuses_note."""
    headers = "".join(header.read_text() for header in HEADERS)
    print("#ifndef _POSIX_C_SOURCE /* some tests need it */")
    print("#define _POSIX_C_SOURCE 200809L")
    print("#endif")
    for header in HEADERS:
        print(f'#include "{header.relative_to("lib/include")}"')
    print(f"#define STATUSES_FUNCTIONS {len(texts)}")
    print("static const char *const statuses_name[] = {")
    print("".join(f'    "{name}",\n' for name in texts) + "};")
    print('#include "tests/statuses/statuses.h"')
    for at, name in enumerate(texts):
        sized = re.search(rf"#define {name}\b[\s\\]*(AUVID_SIZED\w*\([^)]*\))", headers)
        real = sized[1] if sized else name
        print(f"#undef {name}")
        print(f"#define {name}(...) statuses_note({at}, {real}(__VA_ARGS__))")


def check(texts, files):
    """Compare, and count what fails."""
    number = values()
    name_of = {value: name for name, value in number.items()}
    seen, asserted = ({name: set() for name in texts} for _ in range(2))
    for file in files:
        if not pathlib.Path(file).exists():
            print(f"not ok {file} was written")
            continue
        for line in pathlib.Path(file).read_text().splitlines():
            name, status, compared = line.split()
            seen[name].add(int(status))
            if compared == "1":
                asserted[name].add(int(status))
    pairs = undocumented = unasserted = 0
    for name in texts:
        expected = listed(name, texts, number)
        pairs += len(expected)
        for status in sorted(seen[name] - expected):
            undocumented += 1
            print(f"# undocumented: {name} returns {name_of.get(status, status)}")
        elsewhere = {number[s] for f, s in ELSEWHERE if f == name}
        for status in sorted(expected - asserted[name] - elsewhere):
            unasserted += 1
            how = "not asserted" if status in seen[name] else "never returned"
            print(f"# unasserted: {name} {name_of[status]} ({how})")
    print(f"# {len(texts)} functions, {pairs} statuses")
    print(f"{'not ok' if undocumented else 'ok'} no status that its header does not list")
    print(f"{'not ok' if unasserted else 'ok'} every status that a header lists is asserted")


if sys.argv[1] == "record":
    print_header(functions())
else:
    check(functions(), sys.argv[2:])
