#!/usr/bin/env python3
"""Mutation test of a C file of the library: change it in one place, see whether a unit test fails.

usage: mutate.py FILE [--lines A-B] [--part] --objects OBJECT... --tests OBJECT...
                 --compile COMMAND --link COMMAND [--sanitize OPTIONS]
Run from the root, by `make mutate`, which builds what it needs: the objects of the library and of
what the tests share, and those of the tests. Every test runs once, to learn which lines of FILE it
executes. A changed file (a mutant, see mutants.py) is compiled by a command and linked with the
other objects. The tests that execute the changed line run, quickest first, until one fails. When
none does, they run once more with the mutant sanitized, by what is added to both commands: so a
place too far that is read or written is found though nothing comes of it. The mutant is one of:
  killed          a test fails
  timed out       a test needs more than 4 times its processor time, and 2 s: neither of the two
  survived        no test fails
  equivalent      it compiles to the object code of the original
  same            it compiles to the object code of another mutant, which is tested in its place
  not C           it does not compile
Survivors that no caller can tell stand in tests/mutation/survivors.txt with the reason. Exit status
1 when a survivor is not listed, or when a listed one does not survive (any longer); --part: the
list's other entries are left alone.
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

import mutants

LIST = pathlib.Path("tests/mutation/survivors.txt")
WRAP = "-Wl,--wrap=UnityDefaultTestRun" # see one_test.c
SCRATCH = pathlib.Path("build/mutation")
JOBS = 2
# The short form of every test, whatever the form of the test that runs this.
ENVIRONMENT = {k: v for k, v in os.environ.items() if k != "AUVID_TEST_LONG"}


# ---- which test executes which line ----

def run_test(program, name, limit_s=10**6, **more):
    """(exit status, processor time in s) of one test of a program."""
    run = subprocess.Popen(["prlimit", f"--cpu={limit_s}", "--core=0", program], env=ENVIRONMENT |
                           {"MUTATION_TEST": name} | more, stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    # By the clock only a test that waits comes to an end: no busy machine makes another verdict.
    watch = threading.Timer(60 + 20 * limit_s, run.kill)
    watch.daemon = True
    watch.start()
    _, status, usage = os.wait4(run.pid, 0)
    watch.cancel()
    run.returncode = os.waitstatus_to_exitcode(status)
    return run.returncode, usage.ru_utime + usage.ru_stime


class Tests:
    """The unit tests that execute anything of a file, one by one, quickest first."""

    def __init__(self, arguments, pool):
        self.arguments, self.source = arguments, arguments.file
        self.folder = SCRATCH / self.source.stem
        self.others = [o for o in arguments.objects
                       if o != f"build/release/{self.source.with_suffix('.o')}"]
        counting = self.folder / "counting"
        # The optimizer leaves out lines, or tells of them as others.
        compile_object(arguments.compile + " -O0 --coverage -frandom-seed=0", self.source,
                       self.source.read_bytes(), counting)
        told = [test for tests in pool.map(self.measure, arguments.tests) for test in tests]
        self.every = sorted(told, key=lambda test: test["cpu_s"])
        self.known = {int(line) for test in told for line in test["lines"]}

    def link(self, unit, folder, *options):
        program = folder / unit.stem # with .c or .cpp: a reference may have a unit test's name
        linked = subprocess.run([*shlex.split(self.arguments.link), *options, "-o", program, unit,
                                 folder / "mutant.o", *self.others, WRAP, "-lm"])
        if linked.returncode != 0:
            sys.exit(f"mutate: {program.name} does not link; is a make under way beside this?")
        return program

    def measure(self, unit):
        """Tests of a program with their processor times and how often each line is executed; kept
        until the program changes."""
        counting = self.folder / "counting"
        program = self.link(unit, counting, "--coverage")
        digest = hashlib.sha256(program.read_bytes()).hexdigest()
        kept = SCRATCH / "measured" / self.source.stem / (program.name + ".json")
        if kept.exists() and json.loads(kept.read_text())["program"] == digest:
            return [test | {"unit": unit} for test in json.loads(kept.read_text())["tests"]]
        names = subprocess.run([program], env=ENVIRONMENT, check=True, capture_output=True,
                               text=True).stdout
        tests = [self.measure_test(program, name) | {"name": name}
                 for name in re.findall(r"^test: (\w+)$", names, re.M)]
        failed = [test["name"] for test in tests if test["failed"]]
        if failed:
            sys.exit(f"mutate: {program.name}: without a change, alone, fail: {', '.join(failed)}")
        tests = [test for test in tests if any(test["lines"].values())]
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps({"program": digest, "tests": tests}))
        return [test | {"unit": unit} for test in tests]

    def measure_test(self, program, name):
        counts = program.with_name(program.name + ".counts")
        status, cpu_s = run_test(program, name, GCOV_PREFIX=str(counts.resolve()),
                                 GCOV_PREFIX_STRIP="99")
        shutil.copy(program.parent / "mutant.gcno", counts)
        told = json.loads(subprocess.run(
            ["gcov", "--json-format", "--stdout", counts / "mutant.gcda"], check=True,
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)
        shutil.rmtree(counts)
        lines = {str(line["line_number"]): line["count"] for part in told["files"]
                 if part["file"].endswith(self.source.name) for line in part["lines"]}
        return {"cpu_s": cpu_s, "failed": status != 0, "lines": lines}

    def of(self, mutant):
        """The tests that execute the changed place, or else what it stands in."""
        place = next((p for p in mutant.lines if self.known.intersection(p)), self.known)
        return [t for t in self.every if any(t["lines"].get(str(line)) for line in place)]

    def first_failure(self, tests, folder, *options):
        """Verdict of the tests on the object in the folder, and the one of them that fails."""
        programs = {}
        for test in tests:
            name, unit = test["name"], test["unit"]
            programs[unit] = programs.get(unit) or self.link(unit, folder, *options)
            status, _ = run_test(programs[unit], name, math.ceil(2 + 4 * test["cpu_s"]))
            if status != 0:
                return "timed out" if status in (-9, -24) else "killed", test
        return "survived", None

    def first_failure_sanitized(self, tests, text, folder):
        options = self.arguments.sanitize.split()
        compile_object(f"{self.arguments.compile} {self.arguments.sanitize}", self.source, text,
                       folder)
        return self.first_failure(tests, folder, *options)

    def verdict(self, mutant, folder):
        """What becomes of a mutant whose object stands in the folder, and the test that tells."""
        tests = self.of(mutant)
        verdict, test = self.first_failure(tests, folder)
        if verdict == "survived" and self.arguments.sanitize:
            found, by = self.first_failure_sanitized(tests, mutant.text, folder)
            # It is the change that fails, not the test in this way, nor its time.
            if found == "killed" and self.first_failure_sanitized(
                    [by], self.source.read_bytes(), folder)[0] == "survived":
                verdict = found
        shutil.rmtree(folder)
        return verdict, f" ({test['name']})" if verdict == "timed out" else ""


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
    parser.add_argument("--part", action="store_true")
    for name in ("--compile", "--link"):
        parser.add_argument(name, required=True)
    parser.add_argument("--sanitize", default="")
    parser.add_argument("--objects", required=True, nargs="+")
    parser.add_argument("--tests", required=True, nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    source, text = arguments.file, arguments.file.read_bytes()
    every = mutants.of(text)
    first, last = map(int, (arguments.lines or f"1-{10**9}").split("-"))
    chosen = [m for m in every if first <= m.line <= last]
    os.nice(max(0, 5 - os.nice(0)))
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
        survived, listed = set(), listed_survivors(source)
        for i, verdict in work.items():
            verdicts[i], name = verdict.result()
            entry = chosen[i].function, chosen[i].before, chosen[i].after
            if verdicts[i] == "survived":
                survived.add(entry)
            if verdicts[i] == "timed out" or verdicts[i] == "survived" and entry not in listed:
                show(source, entry, f"{source}:{chosen[i].line}: {verdicts[i]}{name}: "
                     f"{chosen[i].kind}")
    shutil.rmtree(folder)
    sys.exit(judge(source, verdicts, survived - listed,
                   set() if arguments.part else listed - survived))


def show(source, entry, what):
    function, before, after = entry
    print(f"{what}\n@ {source.name} {function}\n- {before}\n+ {after}", flush=True)


def judge(source, verdicts, unlisted, stale):
    """Say how many there were of each kind; exit status."""
    for entry in sorted(stale):
        show(source, entry, f"stale in {LIST}: this does not survive")
    count = collections.Counter(verdicts)
    print(f"{source}: {len(verdicts)} mutants: {count['killed']} killed, "
          f"{count['survived']} survived ({len(unlisted)} not listed, {len(stale)} stale), "
          f"{count['timed out']} timed out, "
          f"{count['equivalent']} equivalent, {count['same']} same, {count['not C']} not C")
    return 1 if unlisted or stale else 0


if __name__ == "__main__":
    main()
