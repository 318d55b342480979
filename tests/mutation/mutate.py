#!/usr/bin/env python3
"""Mutation test of one C file of the library: change it in one place, see whether a unit test fails.

usage: mutate.py FILE [--lines A-B] --compile COMMAND --link COMMAND --objects OBJECT...
Run from the root, by `make mutate`, which builds what it needs: the OBJECTS of the library and of
what the tests share, and build/release/tests/unit/*.o. Every test runs once, to learn which lines of
FILE it executes. A changed file (a mutant) is compiled by COMMAND and linked with the other objects;
the tests that execute the changed line run, quickest first, until one fails. The mutant is one of:
  killed          a test fails
  timed out       a test needs more than 4 times its processor time, and 2 s: neither of the two
  survived        no test fails
  equivalent      it compiles to the object code of the original
  same            it compiles to the object code of another mutant, which is tested in its place
  not C           it does not compile
Survivors that no caller can tell stand in tests/mutation/survivors.txt with the reason. Exit status
1 when a survivor is not listed, or when a listed one does not survive (any longer).
"""
import argparse
import collections
import concurrent.futures
import hashlib
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import threading

import tree_sitter
import tree_sitter_c

LIST = pathlib.Path("tests/mutation/survivors.txt")
UNIT = pathlib.Path("build/release/tests/unit")
WRAP = "-Wl,--wrap=UnityDefaultTestRun" # see one_test.c
SCRATCH = pathlib.Path("build/mutation")
JOBS = 2
# The short form of every test, whatever the form of the test that runs this.
ENVIRONMENT = {k: v for k, v in os.environ.items() if k != "AUVID_TEST_LONG"}

RELATIONAL = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
              "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<",
              "&": "|", "|": "&", "^": "|", "++": "--", "--": "++", "+=": "-=", "-=": "+=",
              "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "<<=": ">>=", ">>=": "<<="}
LOGICAL = {"&&": "||", "||": "&&"}
CONDITIONED = ("if_statement", "while_statement", "do_statement", "for_statement",
               "conditional_expression")
REMOVED = ("expression_statement", "return_statement", "break_statement", "continue_statement")
# Not code that runs, or without a meaning of its own.
SKIPPED = ("sizeof_expression", "preproc_include", "static_assert_declaration", "comment")

Mutant = collections.namedtuple("Mutant", "kind line function before after text lines")


# ---- mutants ----

def parse(text):
    """Syntax tree; macros for attributes, which the grammar does not know, are blanked."""
    plain = re.sub(rb"\bAUVID_[A-Z_]+(?=\s+[a-z]\w*[\s*]+\w)", lambda m: b" " * len(m[0]), text)
    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_c.language())).parse(plain).root_node


def constants(literal):
    """Other values than that of a number as C writes it."""
    whole = re.fullmatch(r"(0[xX][0-9a-fA-F]+|[0-9]+)([uUlL]*)", literal)
    if whole:
        value = int(whole[1], 0 if whole[1][:2] in ("0x", "0X") else 10)
        return [f"{other}{whole[2]}" for other in (value + 1, value - 1) if other >= 0]
    value = float(literal.rstrip("fFlL"))
    suffix = literal[len(literal.rstrip("fFlL")):]
    return [f"{other!r}{suffix}" for other in ((2 * value, value / 2) if value else (1.0, -1.0))]


def changes(node):
    """(kind, node, replacement) for what stands at this node of the tree itself."""
    def of(field):
        return node.child_by_field_name(field)

    def text(field):
        return of(field).text.decode()

    operator = text("operator") if of("operator") else None
    if node.type == "binary_expression":
        left, right = text("left"), text("right")
        for other in RELATIONAL.get(operator, ()):
            yield "relational", of("operator"), other
        if operator in ARITHMETIC:
            other = ARITHMETIC[operator]
            if operator in "&|":
                yield "arithmetic", node, f"({left} {other} {right})"
            else:
                yield "arithmetic", of("operator"), other
        if operator in LOGICAL:
            yield "logical", node, f"({left} {LOGICAL[operator]} {right})"
            yield "operand", node, left
            yield "operand", node, right
    elif node.type in ("assignment_expression", "update_expression") and operator in ARITHMETIC:
        yield "arithmetic", of("operator"), ARITHMETIC[operator]
    elif node.type == "unary_expression":
        if operator == "!":
            yield "logical", node, text("argument")
        elif operator in "-~" and of("argument").type != "number_literal":
            yield "arithmetic", node, text("argument")
    elif node.type == "number_literal":
        for other in constants(node.text.decode()):
            yield "constant", node, other
    elif node.type in ("true", "false"):
        yield "constant", node, {"true": "false", "false": "true"}[node.type]
    elif node.type in REMOVED and not last_return(node):
        yield "statement", node, ";"
    if node.type in CONDITIONED:
        condition = of("condition")
        while condition is not None and condition.type == "parenthesized_expression":
            condition = condition.named_children[0]
        if condition is not None and not negated_elsewhere(condition):
            yield "negation", condition, f"!({condition.text.decode()})"


def negated_elsewhere(condition):
    """Is the condition's contrary among the relational or logical mutants, or a constant's?"""
    operator = condition.child_by_field_name("operator")
    return operator is not None and (operator.text.decode() in RELATIONAL or operator.text == b"!")


def last_return(node):
    """The return of a value at a function's end: without it nothing is returned."""
    return (node.type == "return_statement" and node.named_child_count > 0 and
            node.parent.parent.type == "function_definition")


def walk(node, function=""):
    """(node, the function's name) for everything that can be changed."""
    if node.type in SKIPPED or node.text.startswith(b"_Static_assert"):
        return
    if node.type == "function_definition":
        name = node.child_by_field_name("declarator")
        while name.type != "identifier":
            name = name.child_by_field_name("declarator")
        function = name.text.decode()
    yield node, function
    for i, child in enumerate(node.children):
        if node.type.startswith("preproc_") and node.field_name_for_child(i) == "condition":
            continue
        if node.type == "array_declarator" and node.field_name_for_child(i) == "size":
            continue
        yield from walk(child, function)


def in_macro(node):
    """Constants in the text of a #define, which the tree holds as one piece."""
    for number in re.finditer(rb"(?<![\w.])(0[xX][0-9a-fA-F]+|[0-9][0-9.]*([eE][-+]?[0-9]+)?)[uUlLfF]*"
                              rb"(?![\w.])", node.text):
        for other in constants(number[0].decode()):
            yield node.start_byte + number.start(), node.start_byte + number.end(), other


def line_sets(node):
    """Lines of the node, of what it stands in, and so on, outwards."""
    while node is not None and node.type != "translation_unit":
        yield range(node.start_point.row + 1, node.end_point.row + 2)
        node = node.parent


def mutants(text):
    """Every mutant of a C file, in the order of the text."""
    found = []

    def add(kind, function, start, end, other, node):
        first, last = text.rfind(b"\n", 0, start) + 1, text.find(b"\n", end)
        one_line = (b" ".join(part.split()).decode() for part in
                    (text[first:last], text[first:start] + other.encode() + text[end:last]))
        found.append(Mutant(kind, text.count(b"\n", 0, start) + 1, function, *one_line,
                            text[:start] + other.encode() + text[end:], list(line_sets(node))))

    for node, function in walk(parse(text)):
        if node.type == "preproc_arg":
            for start, end, other in in_macro(node):
                add("constant", "", start, end, other, node)
        for kind, place, other in changes(node):
            add(kind, function, place.start_byte, place.end_byte, other, place)
    return found


# ---- which test executes which line ----

def run_test(program, name, limit_s=10**6, **more):
    """(exit status, processor time in s) of one test of a program."""
    run = subprocess.Popen(["prlimit", f"--cpu={limit_s}", "--core=0", program], env=ENVIRONMENT |
                           {"MUTATION_TEST": name} | more, stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    # By the clock only a test that waits comes to an end: no busy machine makes another verdict.
    watch = threading.Timer(60 + 20 * limit_s, run.kill)
    watch.start()
    _, status, usage = os.wait4(run.pid, 0)
    watch.cancel()
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime


class Tests:
    """The unit tests that execute anything of a file, one by one, quickest first."""

    def __init__(self, arguments, pool):
        self.arguments, self.source = arguments, arguments.file
        self.folder = SCRATCH / self.source.stem
        self.others = [o for o in arguments.objects
                       if o != f"build/release/{self.source.with_suffix('.o')}"]
        counting = self.folder / "counting"
        compile_object(arguments.compile + " --coverage", self.source, self.source.read_bytes(),
                       counting)
        told = [t for of in pool.map(self.measure, sorted(UNIT.glob("test_*.o"))) for t in of]
        self.every = sorted(told, key=lambda test: test["cpu_s"])
        self.known = {int(line) for test in told for line in test["lines"]}

    def link(self, unit, folder, *options):
        program = folder / unit.stem
        subprocess.run([*shlex.split(self.arguments.link), *options, "-o", program, unit,
                        folder / "mutant.o", *self.others, WRAP, "-lm"], check=True)
        return program

    def measure(self, unit):
        """Tests of a program with their processor times and how often each line is executed; kept
        until the program changes."""
        counting = self.folder / "counting"
        program = self.link(unit, counting, "--coverage")
        digest = hashlib.sha256(program.read_bytes()).hexdigest()
        kept = SCRATCH / "measured" / self.source.stem / (unit.stem + ".json")
        if kept.exists() and json.loads(kept.read_text())["program"] == digest:
            return json.loads(kept.read_text())["tests"]
        names = subprocess.run([program], env=ENVIRONMENT, check=True, capture_output=True,
                               text=True).stdout
        tests = [self.measure_test(program, name) | {"unit": str(unit), "name": name}
                 for name in re.findall(r"^test: (\w+)$", names, re.M)]
        failed = [test["name"] for test in tests if test["failed"]]
        if failed:
            sys.exit(f"mutate: {program.name}: without a change, and alone, fail: {', '.join(failed)}")
        tests = [test for test in tests if any(test["lines"].values())]
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps({"program": digest, "tests": tests}))
        return tests

    def measure_test(self, program, name):
        counts = program.with_suffix(".counts")
        status, cpu_s = run_test(program, name, GCOV_PREFIX=str(counts.resolve()),
                                 GCOV_PREFIX_STRIP="99")
        shutil.copy(program.parent / "mutant.gcno", counts)
        told = json.loads(subprocess.run(
            ["gcov", "--json-format", "--stdout", counts / "mutant.gcda"], check=True,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)
        shutil.rmtree(counts)
        return {"cpu_s": cpu_s, "failed": status != 0, "lines": {line["line_number"]: line["count"] for part in told["files"]
                                          if part["file"].endswith(self.source.name)
                                          for line in part["lines"]}}

    def of(self, mutant):
        """The tests that execute the changed place, or else what it stands in."""
        place = next((lines for lines in mutant.lines if self.known.intersection(lines)), self.known)
        return [t for t in self.every if any(t["lines"].get(str(line)) for line in place)]

    def verdict(self, mutant, folder):
        """What becomes of a mutant whose object stands in the folder, and the test that tells."""
        verdict, name, programs = "survived", "", {}
        for test in self.of(mutant):
            name, unit = test["name"], pathlib.Path(test["unit"])
            programs[unit] = programs.get(unit) or self.link(unit, folder)
            status, _ = run_test(programs[unit], name, math.ceil(2 + 4 * test["cpu_s"]))
            if status != 0:
                verdict = "timed out" if status in (-9, -24) else "killed"
                break
        shutil.rmtree(folder)
        return verdict, name if verdict == "timed out" else ""


# ---- verdicts ----

def compile_object(command, source, text, folder):
    """Object code of the changed file, None when it does not compile."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / source.name).write_bytes(text)
    done = subprocess.run([*shlex.split(command), "-Werror=return-type", f"-I{source.parent}", "-c",
                           "-o", folder / "mutant.o", folder / source.name], capture_output=True)
    return None if done.returncode else (folder / "mutant.o").read_bytes()


def listed_survivors(source):
    """Survivors of the file in the list: (function, before, after)."""
    place, before, found = "", "", set()
    for line in LIST.read_text().splitlines() if LIST.exists() else []:
        if line.startswith("@ "):
            place = line[2:].split()
        elif line.startswith("- "):
            before = line[2:]
        elif line.startswith("+ ") and place[0] == source.name:
            found.add((place[1] if len(place) > 1 else "", before, line[2:]))
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--lines", metavar="A-B")
    for name in ("--compile", "--link"):
        parser.add_argument(name, required=True)
    parser.add_argument("--objects", required=True, nargs="+")
    arguments = parser.parse_args()
    source, text = arguments.file, arguments.file.read_bytes()
    every = mutants(text)
    first, last = map(int, (arguments.lines or f"1-{10**9}").split("-"))
    chosen = [m for m in every if first <= m.line <= last]
    os.nice(10)
    folder = SCRATCH / source.stem
    shutil.rmtree(folder, ignore_errors=True)
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        tests = Tests(arguments, pool)

        def compiled(number, changed):
            code = compile_object(arguments.compile, source, changed, folder / str(number))
            return code and hashlib.sha256(code).digest()

        seen = {compiled("original", text): "equivalent"}
        work, verdicts = {}, [""] * len(chosen)
        for i, code in enumerate(pool.map(compiled, range(len(chosen)), (m.text for m in chosen))):
            verdicts[i] = "not C" if code is None else seen.get(code, "")
            if code is not None and seen.setdefault(code, "same") == "same" and not verdicts[i]:
                work[i] = pool.submit(tests.verdict, chosen[i], folder / str(i))
        for i, verdict in work.items():
            verdicts[i], name = verdict.result()
            if verdicts[i] in ("survived", "timed out"):
                show(source, chosen[i], verdicts[i] + (f" ({name})" if name else ""))
    shutil.rmtree(folder)
    sys.exit(judge(source, chosen, verdicts, bool(arguments.lines)))


def show(source, mutant, verdict):
    print(f"{source}:{mutant.line}: {verdict}: {mutant.kind}\n@ {source.name} {mutant.function}\n"
          f"- {mutant.before}\n+ {mutant.after}", flush=True)


def judge(source, chosen, verdicts, part):
    """Compare with the list; exit status."""
    survived = {(m.function, m.before, m.after) for m, v in zip(chosen, verdicts) if v == "survived"}
    listed = listed_survivors(source)
    unlisted, stale = survived - listed, set() if part else listed - survived
    for where, before, after in sorted(stale):
        print(f"stale in {LIST}: this does not survive\n@ {source.name} {where}\n- {before}\n+ {after}")
    count = collections.Counter(verdicts)
    print(f"{source}: {len(chosen)} mutants: {count['killed']} killed, {count['survived']} survived "
          f"({len(unlisted)} not listed, {len(stale)} stale), {count['timed out']} timed out, "
          f"{count['equivalent']} equivalent, {count['same']} same, {count['not C']} not C")
    return 1 if unlisted or stale else 0


if __name__ == "__main__":
    main()
