#!/usr/bin/env python3
"""Rules that hold for the text of the repository.

usage: sources.py [ROOT]
Prints one line a breach; exit status 1 when there is any.
  include     lib/ includes only stdint, stddef, stdbool, string.h and auvid headers
  dependency  modules of lib/ include each other only as USES allows
  arithmetic  every lib/src/*.c includes auvid_math_internal.h, directly or not (it switches contraction off)
  literal     no floating literal in lib/ outside AUVID_C(), which hides a double
  columns     no line of code over 100 columns
  length      no function over 60 lines
  path        no path of somebody's own machine
  version     config.h and the newest entry of CHANGELOG.md agree
  link name   what depends on config.h, in a public header, has the sizes in its link-time name
  target      every target of the Makefile is described for `make help`
"""
import pathlib
import re
import sys

# Who may include whom. Dependencies point one way; a module not named here is a breach. A file
# belongs to the module with the longest name that its own name begins with (auvid_crs_tell.c: crs).
BASE = "config types math linalg"
USES = {
    "config": "",
    "types": "config",
    "sqrt_soft": "config types",
    "math": "config types sqrt_soft",
    "status": BASE,
    "linalg": "config types math",
    "selftest": BASE,
    "nav": BASE,
    "excitation": BASE,
    "guard": BASE,
    "allocation": BASE,
    "smoother": BASE,
    "vehicle": BASE,
    "fossen": BASE + " vehicle",
    "averaged": BASE + " vehicle",
    "current": BASE + " vehicle",
    "recorder": BASE,
    "crs": BASE,
    "line_search": BASE,
    "metric": BASE + " smoother vehicle",
    "validation": BASE + " smoother vehicle",
    "confidence": BASE + " metric vehicle",
    "optimizer": BASE + " crs line_search",
    "bounded_ls": BASE + " optimizer",
}
USES["identifier"] = " ".join(USES)
USES["can"] = BASE  # beside the identifier: neither knows the other
USES["checksum"] = BASE + " metric vehicle"  # of records: the control tick does without
USES["adaptive"] = " ".join(USES)
USES["warm"] = " ".join(USES)
USES["checkpoint"] = " ".join(USES)
USES["thrusters"] = " ".join(USES)
USES["node"] = " ".join(USES)
USES["auvid"] = " ".join(USES)

STANDARD = {"stdint.h", "stddef.h", "stdbool.h", "string.h"}
SKIPPED = {".git", "build", "third_party", "__pycache__"}
CODE = {".c", ".h", ".cpp", ".hpp", ".py", ".sh"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)
LITERAL = re.compile(
    r"(?<![\w.])(\d+\.\d*|\.\d+|\d+(?=[eE][-+]?\d))([eE][-+]?\d+)?[fFlL]?(?![\w.])"
)
MACHINE = re.compile(r"(?<![\w.$}])/(home|root|Users|work)/")

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()


def files():
    """Everything that is ours."""
    for path in sorted(root.rglob("*")):
        if path.is_file() and not SKIPPED & set(path.relative_to(root).parts):
            yield path


def without_comments(text):
    """The same lines, comments and strings blanked."""
    pattern = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.S)
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def module_of(name):
    stem = pathlib.Path(name).stem
    stem = stem if stem == "auvid" else stem.removeprefix("auvid_")
    found = [m for m in USES if stem == m or stem.startswith(m + "_")]
    return max(found, key=len, default=None)


def check_includes(path, text):
    here = module_of(path.name)
    if here is None:
        yield "dependency", f"module of {path.name} is not in the table"
        return
    for kind, name in INCLUDE.findall(text):
        if kind == "<":
            if name not in STANDARD:
                yield "include", f"<{name}>"
            continue
        other = module_of(name)
        if other is None or not (name.startswith("auvid/") or name.startswith("auvid_")):
            yield "include", f'"{name}"'
        elif other != here and other not in USES[here].split():
            yield "dependency", f"{here} must not use {other} ({name})"


def reaches_math(path, seen):
    if path.name == "auvid_math_internal.h":
        return True
    if path in seen or not path.exists():
        return False
    seen.add(path)
    names = [name for kind, name in INCLUDE.findall(path.read_text()) if kind == '"']
    return any(reaches_math(path.parent / name, seen) for name in names)


def check_literals(text):
    code = re.sub(r"AUVID_C\(\s*[-+.\deE]+\s*\)", "", without_comments(text))
    for number, line in enumerate(code.splitlines(), 1):
        for match in LITERAL.finditer(line):
            yield "literal", f"line {number}: {match[0]}"


def check_lengths(text):
    start, previous = None, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line == "{" and previous.endswith(")"):
            start = number
        elif line.startswith("}") and start is not None:
            if number - start > 61:
                yield "length", f"function at line {start} has {number - start - 1} lines"
            start = None
        previous = line


def check_file(path, text):
    parts = path.relative_to(root).parts
    code = path.suffix in CODE or path.name == "Makefile" or parts[0] == ".ci"
    if code:
        for number, line in enumerate(text.splitlines(), 1):
            if len(line.expandtabs(8)) > 100:
                yield "columns", f"line {number} has {len(line.expandtabs(8))}"
    if path.suffix in {".c", ".cpp", ".h"}:
        yield from check_lengths(text)
    for match in MACHINE.finditer(text):
        yield "path", match[0]
    if parts[0] == "lib" and path.suffix in {".c", ".h"}:
        yield from check_includes(path, text)
        if path.name != "types.h":  # where AUVID_C() and its like are defined
            yield from check_literals(text)
        if path.suffix == ".c" and not reaches_math(path, set()):
            yield "arithmetic", "does not include auvid_math_internal.h"


def check_version(config, changelog):
    version = re.search(r'AUVID_VERSION_STRING "([^"]+)"', config)[1]
    numbers = re.findall(r"AUVID_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", config)
    if version != ".".join(numbers):
        yield "version", f"AUVID_VERSION_STRING {version}, numbers {'.'.join(numbers)}"
    entry = re.search(r"^## \[(\d[^\]]*)\]", changelog, re.M)
    if entry is None or entry[1] != version:
        yield "version", f"config.h {version}, CHANGELOG.md {entry and entry[1]}"


def check_targets(makefile):
    targets = " ".join(re.findall(r"^\.PHONY:(.*)$", makefile, re.M)).split()
    targets += re.findall(r"^([a-z][a-z-]*):", makefile, re.M)
    for target in sorted(set(targets)):
        if not re.search(rf"^{target}:.*## \S", makefile, re.M):
            yield "target", f"`{target}` has no ## comment"


SIZE = re.compile(r"^#ifndef (AUVID_\w+)$", re.M)


def dependencies(headers):
    """{type: the sizes of config.h, and auvid_real_t, that its own size depends on}"""
    code = without_comments("\n".join(headers.values()))
    sizes = set(SIZE.findall(headers["config.h"])) | {"auvid_real_t"}
    bodies = dict(re.findall(r"^#define (AUVID_\w+) ((?:[^\n]*\\\n)*[^\n]*)", code, re.M))
    struct = re.compile(r"^typedef (?:struct|union)(?: \w+)? \{\n(.*?)^\} (\w+);", re.M | re.S)
    bodies |= {name: body for body, name in struct.findall(code)}
    bodies |= {size: "" for size in sizes}
    held = {}  # a pointer's target does not count
    for name, body in bodies.items():
        members = [m for m in body.split(";") if "*" not in re.sub(r"\[[^]]*\]", "", m)]
        words = re.findall(r"\w+", body if name.startswith("AUVID_") else " ".join(members))
        held[name] = set(words) & bodies.keys()
    found = {name: {name} & sizes for name in bodies}
    while True:
        more = {name: found[name].union(*(found[inner] for inner in held[name])) for name in bodies}
        if more == found:
            return {name: found[name] for name in bodies if name.startswith("auvid_")}
        found = more


def check_link_names(headers):
    """Functions and variables of types that depend on config.h: which lack a size in their name?"""
    types = dependencies(headers)
    every = re.findall(r"define AUVID_SIZED\(name\)(.*?)\n\n", headers["config.h"], re.S)
    for text in headers.values():
        code = without_comments(text)
        sized = re.compile(r"^#define (auvid_\w+)\s+\\?\s*(AUVID_SIZED.*\))$", re.M)
        macros = dict(sized.findall(code))
        for declaration, name in re.findall(
                r"^(?!typedef|static)([a-z][^;{}#]*?\b(auvid_\w+)(?:[(\[][^;{}]*)?;)", code, re.M):
            macro = macros.get(name, "")
            has = set(re.findall(r"\w+", every[0] if "AUVID_SIZED(" in macro else macro))
            needs = set().union(*(types.get(word, ()) for word in re.findall(r"\w+", declaration)))
            if needs - {"auvid_real_t"} - has or (needs and not macro):
                yield "link name", f"{name} depends on {', '.join(sorted(needs))}"


def main():
    breaches = []

    def note(path, found):
        breaches.extend(f"{rule}: {path.relative_to(root)}: {what}" for rule, what in found)

    for path in files():
        try:
            text = path.read_text()
        except UnicodeDecodeError:
            continue
        note(path, check_file(path, text))
    config, changelog = root / "lib/include/auvid/config.h", root / "CHANGELOG.md"
    headers = {path.name: path.read_text() for path in sorted(config.parent.glob("*.h"))}
    if config.exists():
        note(config.parent, check_link_names(headers))
    if config.exists() and changelog.exists():
        note(changelog, check_version(config.read_text(), changelog.read_text()))
    if (root / "Makefile").exists():
        note(root / "Makefile", check_targets((root / "Makefile").read_text()))
    print("\n".join(breaches), end="\n" if breaches else "")
    sys.exit(1 if breaches else 0)


main()
