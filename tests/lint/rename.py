#!/usr/bin/env python3
"""Rename what the language table says, everywhere, by what the compiler understands.

usage: rename.py TABLE [--members-only|--words-only]      (run from the root)
Lines of TABLE:
  word OLD NEW            an identifier, the same everywhere: every whole word of every text file
  member TYPE OLD NEW     a member of struct TYPE (TYPE: as the compiler names it)
  file OLD NEW            git mv, and its mentions
  # comment
A member is renamed in its declaration; then every translation unit is compiled, and every place at
which the compiler misses the old name in that type gets the new one, until none is missed.
"""

import concurrent.futures, pathlib, re, subprocess, sys


def tracked():
    for name in subprocess.check_output(["git", "ls-files"], text=True).splitlines():
        p = pathlib.Path(name)
        if (
            p.is_file()
            and not name.startswith("tests/fuzz/corpus")
            and name != "CHANGELOG.md"
            and not name.startswith("tests/lint/words")
        ):
            try:
                yield p, p.read_text()
            except UnicodeDecodeError:
                pass


def read_table(path):
    words, members, files = {}, {}, []
    for line in open(path):
        part = line.split("#")[0].split()
        if not part:
            continue
        if part[0] == "word":
            assert part[1] not in words, part
            words[part[1]] = part[2]
        elif part[0] == "member":
            members.setdefault(part[1], {})[part[2]] = part[3]
        elif part[0] == "file":
            files.append((part[1], part[2]))
        else:
            raise SystemExit(f"?? {line}")
    return words, members, files


def rename_words(words):
    if not words:
        return
    every = re.compile(
        r"(?<![A-Za-z0-9_])("
        + "|".join(sorted(map(re.escape, words), key=len, reverse=True))
        + r")(?![A-Za-z0-9_])"
    )
    for p, text in tracked():
        new = every.sub(lambda m: words[m[1]], text)
        if new != text:
            p.write_text(new)


def rename_files(files):
    for old, new in files:
        pathlib.Path(new).parent.mkdir(parents=True, exist_ok=True)
        subprocess.check_call(["git", "mv", old, new])
    for p, text in tracked():
        fresh = text
        for old, new in files:
            fresh = fresh.replace(old, new)
            a, b = pathlib.Path(old).name, pathlib.Path(new).name
            fresh = re.sub(r"(?<![\w.])" + re.escape(a) + r"(?!\w)", b, fresh)
            if a.endswith(".h"):
                for pre in ("AUVID_", ""):
                    fresh = re.sub(
                        r"\b"
                        + pre
                        + re.sub(r"\W", "_", a.removeprefix("auvid_") if pre else a).upper()
                        + r"\b",
                        pre + re.sub(r"\W", "_", b.removeprefix("auvid_") if pre else b).upper(),
                        fresh,
                    )
            sa, sb = pathlib.Path(old).stem, pathlib.Path(new).stem
            if sa.startswith("test_"):
                fresh = re.sub(r"\b" + sa + r"\b", sb, fresh)
        if fresh != text:
            p.write_text(fresh)


def blank(text):
    return re.sub(r"/\*.*?\*/|//[^\n]*", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)


def declare(members):
    """Rename in the definitions. The doc comment of a member is left to people."""
    left = {(t, o) for t, m in members.items() for o in m}
    for p, text in tracked():
        if p.suffix not in (".h", ".c", ".cpp"):
            continue
        code = blank(text)
        out = text
        spans = []
        for m in re.finditer(r"(?:typedef\s+)?(?:struct|union)\s*(\w*)\s*\{", code):
            depth, i = 1, m.end()
            while depth and i < len(code):
                depth += {"{": 1, "}": -1}.get(code[i], 0)
                i += 1
            tail = re.match(r"\s*(\w*)", code[i:])
            for name in {m[1], tail[1]} - {""}:
                if name in members:
                    spans.append((m.end(), i, name))
        edits = []
        for a, b, name in spans:
            for old, new in members[name].items():
                for m in re.finditer(
                    r"(?<![\w.>])" + old + r"(?=\s*(?:\[[^;]*\])?\s*(?:[,;:]|\[|\)\s*\())",
                    code[a:b],
                ):
                    edits.append((a + m.start(), old, new))
                    left.discard((name, old))
        for at, old, new in sorted(set(edits), reverse=True):
            assert out[at : at + len(old)] == old
            out = out[:at] + new + out[at + len(old) :]
        if out != text:
            p.write_text(out)
    if left:
        print("not declared:", sorted(left))
        sys.exit(1)


INC = (
    "-Ilib/include -Ilib/src -Itools/simulator -Itools/auvid -Iport/linux_socketcan "
    "-Itests/support -Itests/port -Iport/cortex_m -Itests/fuzz -Itests/golden "
    "-isystem third_party/unity/src "
    "-DUNITY_INCLUDE_DOUBLE= -w -fsyntax-only -ferror-limit=0 -fno-caret-diagnostics "
    "-fno-color-diagnostics"
).split()
WIDE = (
    "-DAUVID_MAX_PARAMETERS=32 -DAUVID_MAX_POPULATION=128 -DAUVID_MAX_FACTOR=1024 "
    "-DAUVID_MAX_COLUMNS=160"
).split()


def compile_unit(p):
    cxx = p.suffix == ".cpp"
    cmd = (
        ["clang++" if cxx else "clang", "-std=c++17" if cxx else "-std=c11"]
        + INC
        + (["-isystem", "/usr/include/eigen3"] if cxx else [])
    )
    if "vehicles" in str(p) or str(p).startswith("tools/auvid") or "golden" in str(p):
        cmd += WIDE
    if not cxx:
        cmd.append("-D_GNU_SOURCE")
    return p, subprocess.run(cmd + [str(p)], capture_output=True, text=True).stderr


NO_MEMBER = re.compile(
    r"^(\S+?):(\d+):(\d+): (?:fatal )?error: "
    r"(?:no member named '(\w+)' in '([^']*)'|field designator '(\w+)' does not refer to any "
    r"(?:non-static data member|field) in type '([^']*)')",
    re.M,
)


def rename_members(members, skip=("tests/fuzz/corpus",)):
    declare(members)
    units = [p for p, _ in tracked() if p.suffix in (".c", ".cpp") and "count_plugin" not in p.name]
    for turn in range(12):
        edits, rest, touched = {}, {}, set()
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for p, err in pool.map(compile_unit, units):
                if "error:" in err:
                    touched.add(str(p))
                for m in NO_MEMBER.finditer(err):
                    name, kind = m[4] or m[6], m[5] or m[7] or ""
                    kind = (
                        kind.replace("const ", "")
                        .replace("struct ", "")
                        .replace("union ", "")
                        .split(" (aka")[0]
                        .rstrip(" *&")
                    )
                    if kind not in members and kind + "_t" in members:
                        kind += "_t"
                    if kind == "":
                        line = pathlib.Path(m[1]).read_text().split("\n")[int(m[2]) - 1]
                        owners = [t for t in members if name in members[t] and t in line] or [
                            t for t in members if name in members[t]
                        ]
                        kind = (
                            owners[0]
                            if owners and len({members[t][name] for t in owners}) == 1
                            else kind
                        )
                    if kind in members and name in members[kind]:
                        edits.setdefault(str(pathlib.Path(m[1]).resolve()), set()).add(
                            (int(m[2]), int(m[3]), name, members[kind][name])
                        )
                    else:
                        rest.setdefault(str(p), []).append(m[0])
                if "error:" in err and not NO_MEMBER.search(err):
                    rest.setdefault(str(p), []).append(
                        next(l for l in err.splitlines() if "error:" in l)
                    )
        print("turn", turn, "edits", sum(map(len, edits.values())), "other errors in", len(rest))
        for name, places in edits.items():
            p = pathlib.Path(name)
            lines = p.read_text().split("\n")
            for line, col, old, new in sorted(places, reverse=True):
                text = lines[line - 1]
                at = col - 1
                if text[at : at + len(old)] != old:  # the place is the dot of a designator
                    found = re.compile(r"\b" + old + r"\b").search(text, at)
                    if not found:
                        print("where?", name, line, col, old)
                        continue
                    at = found.start()
                lines[line - 1] = text[:at] + new + text[at + len(old) :]
            p.write_text("\n".join(lines))
        units = [p for p in units if str(p) in touched]
        if not edits:
            for p, e in rest.items():
                print(p, e[:3])
            return
    raise SystemExit("no end")


words, members, files = read_table(sys.argv[1])
if "--members-only" not in sys.argv:
    rename_files(files)
    rename_words(words)
if "--words-only" not in sys.argv and members:
    rename_members(members)
