#!/usr/bin/env python3
"""Rules that hold for the compiled library, checked on its objects.

usage: objects.py [--float] OBJECT.o...
Beside an OBJECT.o may lie OBJECT.ci, the call graph that gcc writes with -fcallgraph-info.
Prints one line a breach; exit status 1 when there is any.
  data        no writable statics: .data + .bss == 0
  symbol      undefined are only memcpy, memset, memmove, memcmp and auvid_*; the latter must be
              defined by another of the objects. So no heap, no libm, no soft double.
  name        what other files can see begins with auvid_
  double      with --float: no instruction on doubles (x86-64)
  recursion   no cycle in the call graph (calls through pointers are not followed)
"""
import pathlib
import re
import subprocess
import sys

ALLOWED = {"memcpy", "memset", "memmove", "memcmp"}
# Arithmetic and conversions, not moves: compilers move pairs of floats with movsd. The x87 too.
DOUBLE = re.compile(
    r"\t(v?(add|sub|mul|div|sqrt|min|max|ucomi|comi|cmp\w*)[sp]d|v?f\w*(add|sub)\w*[sp]d"
    r"|v?cvt\w*[sp]d\w*|f(ld|st|add|sub|mul|div|ild|ist|com|ucom|sqrt|xch)\w*)\s"
)


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check_data(path):
    text, data, bss = run("size", path).splitlines()[1].split()[:3]
    if int(data) + int(bss) != 0:
        yield f"data: {path}: .data {data}, .bss {bss} bytes"


def symbols(path):
    """(defined by other objects' needs, undefined) names."""
    defined, undefined = set(), set()
    for line in run("nm", "-g", path).splitlines():
        *_, kind, name = line.split()
        (undefined if kind in "Uw" else defined).add(name)
    return defined, undefined


def check_symbols(paths):
    table = {path: symbols(path) for path in paths}
    everywhere = set().union(*(defined for defined, _ in table.values()))
    for path, (defined, undefined) in table.items():
        for name in sorted(undefined - ALLOWED - everywhere):
            yield f"symbol: {path}: needs {name}"
        for name in sorted(defined):
            if not name.startswith("auvid_"):
                yield f"name: {path}: defines {name}"


def check_double(path):
    for line in run("objdump", "-d", "--no-show-raw-insn", path).splitlines():
        if DOUBLE.search(line + " "):
            yield f"double: {path}: {line.strip()}"


def check_recursion(paths):
    calls = {}
    for path in paths:
        graph = pathlib.Path(path).with_suffix(".ci")
        if graph.exists():
            for edge in re.finditer(
                r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', graph.read_text()
            ):
                calls.setdefault(edge[1], set()).add(edge[2])
    done = set()

    def visit(name, stack):
        if name in stack:
            yield "recursion: " + " -> ".join(stack[stack.index(name):] + [name])
        elif name not in done:
            for callee in sorted(calls.get(name, ())):
                yield from visit(callee, stack + [name])
            done.add(name)

    for name in sorted(calls):
        yield from visit(name, [])


def main():
    paths = [argument for argument in sys.argv[1:] if argument != "--float"]
    breaches = list(check_symbols(paths)) + list(check_recursion(paths))
    for path in paths:
        breaches += check_data(path)
        if "--float" in sys.argv:
            breaches += check_double(path)
    print("\n".join(breaches), end="\n" if breaches else "")
    sys.exit(1 if breaches else 0)


main()
