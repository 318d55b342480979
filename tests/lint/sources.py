#!/usr/bin/env python3
"""Rules that hold for the text of the repository.

usage: sources.py [ROOT]
Prints one line a breach; exit status 1 when there is any.
  include     lib/ includes only stdint, stddef, stdbool, string.h and auvid headers
  dependency  the rooms of lib/ include each other only as ROOMS allows, those of tools/auvid as
              PROGRAM_ROOMS allows
  circle      no circle between the files of lib/src: X.c and X_internal.h are one; a file needs
              those whose headers it includes, and those whose functions and tables it names,
              except the path of a model
  arithmetic  every lib/src/*/*.c includes auvid_math_internal.h, directly or not (it switches
              contraction off)
  literal     no floating literal in lib/ outside AUVID_C(), which hides a double
  columns     no line of code over 100 columns
  length      no function over 60 lines
  path        no path of somebody's own machine
  version     config.h and the newest entry of CHANGELOG.md agree
  link name   what depends on config.h, in a public header, has the sizes in its link-time name
  word        no name that words.txt has replaced, no word of our own where the field has one
  public      at most 24 headers for users, all in auvid.h; no example in a README needs detail/
  object      members of the metric's rows, sets and evaluator, and of its layout, only in the files
              auvid_metric*; the checkpoint names where they are
  survivor    each entry of tests/mutation/survivors.txt is a line of its function
  target      every target of the Makefile is described for `make help`
"""
import os
import pathlib
import re
import sys

# The rooms of lib/src, each with those that it may include beside itself: of what stands below it,
# what it needs. The node counts as one of its own: it alone knows the codec and the identifier.
ROOMS = {
    "base": "",
    "models": "base",
    "navigation": "base",
    "metric": "base models",
    "search": "base",  # never sees the metric: the identifier carries candidates and costs
    "excitation": "base",
}
for room in "identifier", "checkpoint", "uncertain":  # each may include all before it
    ROOMS[room] = " ".join(ROOMS)
ROOMS["can"] = "base"
ROOMS["node"] = " ".join(ROOMS)
# Headers of lib/include/auvid, and of detail/ in it; auvid.h is above all.
PUBLIC = {
    "base": "config types smoother",
    "models": "vehicle fossen current thrusters",
    "navigation": "nav recorder",
    "metric": "metric_config metric confidence estimate validation",
    "search": "optimizer",
    "excitation": "excitation allocation guard",
    "identifier": "identifier actuation adaptive prior uncertain",
    "checkpoint": "checkpoint",
    "can": "can can_messages",
    "node": "node",
}

# The rooms of tools/auvid, each after those that it may include.
PROGRAM_ROOMS = "base vehicle options log report doctor fit bus field demo check".split()

# The paths of the metric. A model names one by its address, so that the linker drops the other.
PATHS = {"auvid_path_regressor", "auvid_path_residual"}

# A private member of an object of the metric. The exceptions are public.
OBJECT = re.compile(
    r"(?:->|\.)((?:evaluator\.|layout\.(?!taps|kernel)|sets\.(?!recorded|rows_dropped|waiting)"
    r"|rows\.(?!set\.rows\b|set\b(?!\.)))\w+)")

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


def room_of(path):
    """The room of a file in lib/; None: it has none."""
    if path.parent.name in ("auvid", "detail"):
        return next((room for room in PUBLIC if path.stem in PUBLIC[room].split()), None)
    if path.parent.name == "can" and path.stem.startswith("auvid_node"):
        return "node"
    return path.parent.name if path.parent.name in ROOMS else None


def included(path, name):
    """What a file of lib/ includes by this name."""
    if name.startswith("auvid/"):
        return root / "lib/include" / name
    return pathlib.Path(os.path.normpath(path.parent / name))


def check_includes(path, text):
    here = room_of(path)
    if here is None and path.name != "auvid.h":  # which is of all rooms
        yield "dependency", "is in no room"
        return
    for kind, name in INCLUDE.findall(text):
        if kind == "<":
            if name not in STANDARD:
                yield "include", f"<{name}>"
            continue
        other = included(path, name)
        if root / "lib" not in other.parents:
            yield "include", f'"{name}"'
        elif here is not None and room_of(other) not in [here, *ROOMS[here].split()]:
            yield "dependency", f"{here} must not use {name} ({room_of(other)})"


def check_program_rooms(path, text):
    if path.parent.name not in PROGRAM_ROOMS:
        yield "dependency", "is in no room"
        return
    allowed = PROGRAM_ROOMS[:PROGRAM_ROOMS.index(path.parent.name)]
    for room in re.findall(r'#include "\.\./(\w+)/', text):
        if room not in allowed:
            yield "dependency", f"{path.parent.name} must not use {room}"


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


TABLE = pathlib.Path(__file__).resolve().parent / "words.txt"
OLD = [line.split()[1] for line in TABLE.read_text().splitlines() if line.startswith("word ")]
DROPPED = re.compile(r"(?<!\w)(?:" + "|".join(OLD) + r")(?!\w)")
# The plural of the first is the unit of speed.
PRIVATE = re.compile(
    r"\b(knot|leash(?:es|ed)?|foret[eo]l[dl]s?|ties?|tied|anew|nobody told)\b", re.I)


def check_words(path, text):
    if path.parent.name == "lint" or path.name == "CHANGELOG.md":
        return
    for pattern in (DROPPED, PRIVATE):
        for match in pattern.finditer(text):
            yield "word", f"line {text.count(chr(10), 0, match.start()) + 1}: {match[0]}"


def check_file(path, text):
    parts = path.relative_to(root).parts
    yield from check_words(path, text)
    code = path.suffix in CODE or path.name == "Makefile" or parts[0] == ".ci"
    if code:
        for number, line in enumerate(text.splitlines(), 1):
            if len(line.expandtabs(8)) > 100:
                yield "columns", f"line {number} has {len(line.expandtabs(8))}"
    if path.suffix in {".c", ".cpp", ".h"}:
        yield from check_lengths(text)
    for match in MACHINE.finditer(text):
        yield "path", match[0]
    if parts[:2] in {("lib", "src"), ("tools", "simulator"), ("tools", "auvid")} and \
            not path.name.startswith(("auvid_metric", "auvid_checkpoint")):
        for match in OBJECT.finditer(without_comments(text)):
            yield "object", match[1]
    if parts[:2] == ("tools", "auvid") and len(parts) > 3 and path.suffix in {".c", ".h"}:
        yield from check_program_rooms(path, text)
    if parts[0] == "lib" and path.suffix in {".c", ".h"}:
        yield from check_includes(path, text)
        if path.name != "types.h":  # where AUVID_C() and its like are defined
            yield from check_literals(text)
        if path.suffix == ".c" and not reaches_math(path, set()):
            yield "arithmetic", "does not include auvid_math_internal.h"


def needs(sources):
    """{file: the other files of lib/src that it needs}, by their stems."""
    code = {path: without_comments(path.read_text()) for path in sources}
    stem = {path: path.stem.removesuffix("_internal") for path in sources}
    definition = re.compile(r"^(?!static)[a-z][\w *]*?\b(auvid_\w+)(?:\([^;{}]*\)\n\{|[\w[\]]* =)",
                            re.M)
    owner = {name: stem[path] for path in sources if path.suffix == ".c"
             for name in definition.findall(code[path])}
    found = {name: set() for name in stem.values()}
    for path in sources:
        words = set(re.findall(r"\bauvid_\w+", code[path])) if path.suffix == ".c" else set()
        words -= PATHS
        found[stem[path]] |= {owner[word] for word in words & owner.keys()}
        found[stem[path]] |= {stem[other] for kind, name in INCLUDE.findall(path.read_text())
                              if (other := included(path, name)) in stem}
    return {name: others - {name} for name, others in found.items()}


def check_circles(sources):
    left = needs(sources)
    while free := [name for name, others in left.items() if not others & left.keys()]:
        for name in free:
            del left[name]
    while free := left.keys() - set().union(*left.values()):  # above the circles
        for name in free:
            del left[name]
    if left:
        yield "circle", " ".join(sorted(left))


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


SIZE = re.compile(r"^#ifndef (AUVID_MAX_\w+)$", re.M)


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
    """Functions and variables of types that depend on config.h: which lack sizes in their name?"""
    types = dependencies(headers)
    named = re.findall(r"define AUVID_SIZED\(name\)(.*?)\n\n", headers["config.h"], re.S)
    sizes = set(re.findall(r"AUVID_\w+", " ".join(named).replace("AUVID_TOKEN_", "AUVID_MAX_")))
    for size in sorted(set(SIZE.findall(headers["config.h"])) - sizes if named else ()):
        yield "link name", f"AUVID_SIZED lacks {size}"
    for text in headers.values():
        code = without_comments(text)
        sized = re.compile(r"^#define (auvid_\w+)\s+\\?\s*(AUVID_SIZED.*\))$", re.M)
        macros = dict(sized.findall(code))
        for declaration, name in re.findall(
                r"^(?!typedef|static)([a-z][^;{}#]*?\b(auvid_\w+)(?:[(\[][^;{}]*)?;)", code, re.M):
            macro = macros.get(name, "")
            needs = set().union(*(types.get(word, ()) for word in re.findall(r"\w+", declaration)))
            if needs and not macro or needs - {"auvid_real_t"} and "AUVID_SIZED(" not in macro:
                yield "link name", f"{name} depends on {', '.join(sorted(needs))}"


MAX_PUBLIC = 24


def check_public(folder):
    """What a user reads: few headers, one that has all of them, and examples that need no other."""
    public = {path.name: path.read_text() for path in sorted(folder.glob("*.h"))}
    if len(public) > MAX_PUBLIC:
        yield "public", f"{len(public)} headers, more than {MAX_PUBLIC}"
    for name in sorted(public.keys() - {"auvid.h"}) if "auvid.h" in public else ():
        if f'#include "auvid/{name}"' not in public["auvid.h"]:
            yield "public", f"auvid.h does not include {name}"
    words = [set(re.findall(r"\w+", without_comments("\n".join(texts)))) for texts in (
        public.values(), [path.read_text() for path in folder.glob("detail/*.h")])]
    for page in [path for path in files() if path.name == "README.md"]:
        for block in re.findall(r"^```c\n(.*?)^```", page.read_text(), re.M | re.S):
            used = set(re.findall(r"\bauvid_\w+|\bAUVID_\w+|\bauvid/detail/", block, re.I))
            for name in sorted(used & (words[1] - words[0] | {"auvid/detail/"})):
                yield "public", f"{name}, in an example of {page.relative_to(root)}, is in detail/"


def check_survivors(survivors):
    """Does each listed survivor's line stand in its function's file?"""
    texts = {path.name: " ".join(path.read_text().split()) for path in root.glob("lib/src/*/*.c")}
    here = function = ""
    for number, line in enumerate(survivors.splitlines(), 1):
        if line.startswith("@ "):
            name, function = line.split()[1:]
            here = texts.get(name, "")
        known = f" {function}(" in here or f"*{function}(" in here
        if line.startswith("- ") and not (known and " ".join(line[2:].split()) in here):
            yield "survivor", f"line {number} is not in {function}"


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
    note(root / "lib/src", check_circles(sorted(root.glob("lib/src/*/*.[ch]"))))
    headers = {path.name: path.read_text() for path in sorted(config.parent.rglob("*.h"))}
    if config.exists():
        note(config.parent, check_public(config.parent))
        note(config.parent, check_link_names(headers))
    if config.exists() and changelog.exists():
        note(changelog, check_version(config.read_text(), changelog.read_text()))
    if (root / "Makefile").exists():
        note(root / "Makefile", check_targets((root / "Makefile").read_text()))
    survivors = root / "tests/mutation/survivors.txt"
    if survivors.exists():
        note(survivors, check_survivors(survivors.read_text()))
    print("\n".join(breaches), end="\n" if breaches else "")
    sys.exit(1 if breaches else 0)


main()
