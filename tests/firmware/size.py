#!/usr/bin/env python3
"""Flash, RAM and stack of the firmware's examples, from the output of `make firmware`.

usage: size.py BOARD... >FIGURES.csv
       size.py --readme|--rooms [write]  the table of README, or of port/cortex_m/README.md, from
                                        tests/firmware/size.csv
Prints lines "what/board/name,bytes", and the same as tables on stderr. Exit status 1 if a maximum
stack is unknown (recursion, a frame of unknown size, a call through a pointer that is not in
POINTERS), or exceeds the RAM that is left for it.
  image   text, data and bss of the example, and of the two passive ones (port/cortex_m/passive)
  rooms   flash of each image on m4f: by the folder of lib/src, `example` (with start-up and
          driver), and `compiler` for its libraries
  flash   of each module as linked into the example. A module is a public header and the objects
          named after it, or a single object; `library` is all of lib/, `library whole` its objects
          before linking
  sizeof  public structs, and parts of the identifier (regressors: without the memory of non-linear
          models, and with a population for 13 parameters; thirteen: all sizes for the 13
          parameters of Girona500)
  stack   the deepest chain of calls below each public function, without the functions of the user's
          model; `all` is the maximum over the cores. `main` and `interrupt` are those of the
          example, with Girona500's model: their sum is the stack of the image
Frames and calls of compiled functions come from gcc (-fcallgraph-info=su), those of its libraries
from the disassembly.
"""
import functools
import pathlib
import re
import subprocess
import sys
import tempfile

BOARD = "port/cortex_m/board.sh"
HEADERS = sorted(pathlib.Path("lib/include/auvid").glob("**/*.h"))
API = "".join(path.read_text() for path in HEADERS)
CALLED = set(re.findall(r"\w+(?=\()", API))
MODULES = {path.stem for path in HEADERS} | {"can_fifo", "can_receiver"}
# The functions of the metric's paths, by member of auvid_path_t, and of the phases of the work.
PATHS = {
    r"path->check\(": r":metric_check_(regressor|residual)$",
    r"path->make_filter\(": r":metric_make_(smoother|mean)$",
    r"path\(\w+\)->add_cell\(": r":metric_add_(equations|motion)$",
    r"path\(\w+\)->finish_row\(": r":metric_(take|store)_row$",
    r"path\(\w+\)->rotate_row\(": r":metric_rotate_dofs$",
    r"path\(\w+\)->begin\(": r":metric_begin_samples$",
    r"start->begin\(": r":identifier_begin_(minimum|newton)$",
    r"start->run\(": r"^auvid_identifier_optimum$|:identifier_newton$",
    r"start->scale\(": r":identifier_scale_of_(columns|newton)$",
    r"start->(next|begin)_neighbour\(": r"^auvid_identifier_(next|begin)_neighbour$",
    r"path\(\w+\)->evaluate\(": r":metric_(evaluate_factor|sample_cost)$",
    r"path->merge\(": r"auvid_metric_merge_sets$",
    r"path\(\w+\)->linearise\(": r"auvid_metric_linearise_sets$",
    r"change_functions->begin\(": r"_validate\.c:identifier_begin_test$",
    r"phase->(metric|run)\(": r"auvid_metric_(cost|measure|linearise)(?!_begin)|"
    r"_(work|validate)\.c:identifier_(merge|ask|linearise|confidence|change)$",
    r"(phase->next|\)->restart)\(": r"auvid_identifier_begin_tests$|"
    r"_(work|validate)\.c:identifier_(begin|end|restart|publish)_\w+$",
}
NOTHING = r"(?!)"  # the example has no uncertain inputs, known forces or thrusters' model
# What calls through pointers lead to in the example, by a pattern of the line of source: functions
# of auvid_girona500, the metric's prior, the thrusters' log, and the driver's interrupt.
POINTERS = PATHS | {
    r"\b(v(ehicle)?|hull)->(regressor|residual)\(": r":vehicle_g500_(?!acceleration)",
    r"\bv(ehicle)?->acceleration\(": r":vehicle_g500_acceleration",
    r"\? auvid_metric_delay_slopes : auvid_metric_delay_weights\)": r"^auvid_metric_delay_(s|w)",
    r"simulate->cell\(": r"auvid_identifier_simulate\.c:simulate_cell$",
    r"simulate->advance\(": r"auvid_identifier_simulate\.c:simulate_advance$",
    r"simulate->restart\(": r"auvid_identifier_simulate\.c:simulate_restart$",
    r"simulate->finish\(": r"auvid_identifier_simulate\.c:simulate_finish$",
    r"functions->step\(": r"auvid_actuation\.c:actuation_step$",
    r"functions->refuse\(": r"auvid_actuation\.c:actuation_refuse$",
    r"a->shape\(": r"auvid_adaptive\.c:adaptive_shape$",
    r"\bc->other->\w+\(": NOTHING,
    r"\bvehicle->thrust\(": NOTHING,
    r"node->arm\(": r"auvid_actuation\.c:auvid_identifier_arm",
    r"(\bextra->|uncertain_extra\.)(finish|cell|take)\(": NOTHING,
    r"\badd\(context, slot": NOTHING,
    r"rec->take_part\(": NOTHING,
    r"(u->strong|row->prior)\(": NOTHING,
    r"node->report_causes\(": NOTHING,
    r"part->check\(": NOTHING,
    r"uncertain(_functions)?->(add_cell|rotate|begin|solve|publish)\(": NOTHING,
    r"uncertain_functions->(estimate|accept|change_vehicle)\(": NOTHING,
    r"uncertain->(sag|drag)\(": NOTHING,
    r"\bprior->(add_rows|weight|change_vehicle)\(":
        r"auvid_prior_rows\.c:prior_(add_rows|weight|change_vehicle)$",
    r"listener->command\(": r"auvid_thrusters\.c:thrusters_listen$",
    r"listener->set\(": r"auvid_thrusters\.c:thrusters_drop_lost_sets$",
    r"listener->lead_us\(": r"auvid_thrusters\.c:thrusters_lead_us$",
    r"set_up_nav\(": r"^auvid_nav_set_up",
    r"timer_handler\(": r"driver_qemu\.c:interrupt$",
}
START = r"machine_\w+\.c:start$"
INTERRUPT = r"machine_\w+\.c:(systick|trap)$"
IMAGES = {"node": "example", "with_filter": "with_filter", "own_navigation": "own_navigation"}
PARTS = ("nav", "metric", "optimizer", "guard")  # of a line in the tables: the regressor path
OTHERS = ("start-up and driver", "compiler's")
CORE = "nav smoother metric optimizer crs line_search identifier excitation guard can".split()


class NoBound(Exception):
    """The stack has no known bound."""


def run(*command, **options):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def module_of(path):
    if "lib/src/" in path:
        stem = pathlib.Path(path).stem.removeprefix("auvid_")
        return max((m for m in MODULES if re.match(m + "(_|$)", stem)), key=len, default=stem)
    return OTHERS["/port/" not in path]


def room_of(path):
    room = re.search(r"lib/src/(\w+)/", path)
    return room[1] if room else ("compiler", "example")["/port/" in path]


def flash(map_file, group):
    """{group(path): bytes of flash}, from the linker's map."""
    linked = map_file.read_text().split("Linker script and memory map")[1]
    sizes = {}
    for name, size, path in re.findall(
        r"^ (\.[\w.$]+)\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S+\.(?:o|a\(.*\)))$", linked, re.M
    ):
        if re.match(r"\.(text|s?rodata|vectors|ARM\.ex|s?data)", name):
            sizes[group(path)] = sizes.get(group(path), 0) + int(size, 16)
    return sizes


def compiled(folder, ending):
    """What the compiler made of the example's sources. Optional objects are not part of it."""
    return [path for source in ("lib/src/*/*", "port/cortex_m/*", "port/cortex_m/example/*")
            for path in sorted(folder.glob(source + ending))]


@functools.cache
def target(path, line):
    """The pattern of POINTERS that matches a line of source."""
    source = pathlib.Path(path).read_text().splitlines()[int(line) - 1]
    for pattern in POINTERS:
        if re.search(pattern, source):
            return pattern
    raise NoBound(f"{path}:{line}: {source.strip()}: unknown target; add it to POINTERS")


def library_frames(board, folder, known):
    """{name: (frame, callees)} of the compiler's libraries, for all functions auvid may call. Not
    those that are known."""
    tools, link = (run(BOARD, board, what).split() for what in ("tools", "link"))
    with tempfile.TemporaryDirectory() as scratch:
        image = scratch + "/whole.elf"
        objects = map(str, compiled(folder, ".o"))
        run(*link, "-Wl,--no-gc-sections,--defsym=FLASH_LENGTH=0x400000",
            "-Wl,--defsym=RAM_LENGTH=0x200000", "-o", image, *objects)
        names = {}
        for line in run(tools[0] + "nm", image).splitlines():
            address, kind, name = line.split()
            if kind in "TtWw":
                names.setdefault(int(address, 16) & ~1, []).append(name)
        text = run(tools[0] + "objdump", "-d", "--no-show-raw-insn", image)
    found = {}
    for block in re.split(r"\n\n(?=[0-9a-f]+ <)", text):
        head = re.match(r"([0-9a-f]+) <([^>]+)>:", block)
        if head is None or head[2] in known:
            continue
        frame, callees = 0, set()
        for line in block.splitlines()[1:]:
            words = line.split("\t", 1)[-1].strip()
            if pushed := re.match(r"(push|stmdb\s+sp!,)\s*(?:\.w)?\s*\{(.*)\}", words):
                frame += 4 * len(pushed[2].split(","))
            elif moved := re.match(r"(?:sub(?:\.w|w)?\s+sp,(?: sp,)? #(\d+)"
                                   r"|str\S*\s.*\[sp, #-(\d+)\]!|addi?\s+sp,sp,-(\d+))", words):
                frame += int(next(filter(None, moved.groups())))
            elif re.match(r"(sub|add)\S*\s+sp, (sp, )?r\d|vpush|blx\s+r|jalr\s", words):
                frame = None
                break
            if call := re.search(r"^[bj].*<(\w+)(\+0x[0-9a-f]+)?>$", words):
                callees.add(call[1])
        for name in names.get(int(head[1], 16), [head[2]]):
            found[name] = (frame, callees - set(names.get(int(head[1], 16), [])))
    return found


class Graph:
    """Call graph of one board, and the maximum stack."""

    def __init__(self, board):
        folder = pathlib.Path(f"build/firmware/{board}-Os")
        self.board, self.frames, self.calls, self.done = board, {}, {}, {}
        for path in compiled(folder, ".ci"):
            text = path.read_text()
            for title, label in re.findall(r'^node: \{ title: "([^"]+)" label: "([^"]+)"', text,
                                           re.M):
                if size := re.search(r"(\d+) bytes \((static|dynamic,bounded)\)", label):
                    self.frames[title] = int(size[1])
            for caller, callee, where in re.findall(
                r'sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]+)")?', text
            ):
                self.calls.setdefault(caller, set()).add(
                    target(*where.split(":")[:2]) if callee == "__indirect_call" else callee)
        known = {title.rsplit(":", 1)[-1] for title in self.frames}
        for name, (frame, callees) in library_frames(board, folder, known).items():
            if name not in self.frames:
                self.frames[name] = frame
                self.calls[name] = callees

    def worst(self, name, above=(), model=True):
        """(bytes, chain) below and with `name`."""
        if name in above:
            raise NoBound("recursion: " + " -> ".join((*above, name)))
        if (name, model) not in self.done:
            if name in POINTERS:
                targets = filter(re.compile(POINTERS[name]).search, self.frames)
                frame, callees = 0, targets if model or name in PATHS else ()
            elif self.frames.get(name) is None:
                raise NoBound(f"{self.board}: the frame of {name} is not known")
            else:
                frame, callees = self.frames[name], self.calls.get(name, ())
            below = [self.worst(callee, (*above, name), model) for callee in sorted(callees)]
            size, chain = max(below, key=lambda found: found[0], default=(0, ()))
            self.done[name, model] = frame + size, ((name, frame), *chain)
        return self.done[name, model]

    def public(self):
        """{name in the headers: (bytes, chain)}."""
        found = {}
        for name in self.frames:
            plain = re.sub(r"_f(32|64)(_(\d+|none))*$", "", name)
            if plain.startswith("auvid_") and plain in CALLED:
                found[plain] = self.worst(name, model=False)
        return found

    def root(self, pattern):
        return max(self.worst(name) for name in self.frames if re.search(pattern, name))

    def frame(self, pattern):
        return max(self.frames[name] for name in self.frames if re.search(pattern, name))


def exception(board):
    """Bytes that the core pushes before a handler runs, aligned to 8."""
    flags = run(BOARD, board, "compile")
    return 0 if "riscv" in flags else 112 if "float-abi=hard" in flags else 40


def room(prefix, folder):
    """Bytes of RAM left for the stack."""
    at = dict(re.findall(r"^(\w+) \w (stack_top|bss_end)$", run(
        prefix + "nm", str(folder / "example.elf")), re.M))
    at = {name: int(address, 16) for address, name in at.items()}
    return at["stack_top"] - at["bss_end"]


def structs(board, more):
    """{type: sizeof} of all public structs except single messages and those of fossen.h, which the
    sizes of the boards exclude."""
    folder = pathlib.Path("lib/include/auvid")
    others = (folder / "can_messages.h").read_text() + (folder / "fossen.h").read_text()
    of, left_out = (set(re.findall(r"^\} (auvid_\w+_t);", text, re.M)) for text in (API, others))
    names = sorted(of - left_out)
    source = '#include "auvid/auvid.h"\n'
    source += "".join(f"char size_of_{name}[sizeof({name})];\n" for name in names)
    with tempfile.NamedTemporaryFile(suffix=".o") as made:
        run(*run(BOARD, board, "compile").split(), *more, "-std=c11", "-Ilib/include",
            "-Iport/cortex_m", "-fno-common", "-xc", "-c", "-o", made.name, "-", input=source)
        table = run(run(BOARD, board, "tools").strip() + "nm", "-S", made.name)
    return {name: int(size, 16) for size, name in re.findall(r"(\S+) [BS] size_of_(\w+)", table)}


def main():
    boards, figures, chains = sys.argv[1:], {}, {}
    for board in boards:
        folder = pathlib.Path(f"build/firmware/{board}-Os")
        prefix = run(BOARD, board, "tools").strip()
        for image, file in IMAGES.items():
            totals = run(prefix + "size", str(folder / f"{file}.elf")).splitlines()[1].split()
            for name, size in zip(("text", "data", "bss"), totals):
                figures[f"image/{board}/{image} {name}"] = int(size)
        sizes = flash(folder / "example.map", module_of)
        sizes["library"] = sum(size for name, size in sizes.items() if name not in OTHERS)
        sizes["library whole"] = sum(
            int(line.split()[0]) for line in run(
                prefix + "size", *map(str, folder.glob("lib/src/*/*.o"))).splitlines()[1:])
        sizes[" ".join(CORE)] = sum(sizes.get(name, 0) for name in CORE)
        for name in sorted(sizes):
            figures[f"flash/{board}/{name}"] = sizes[name]
        graph = Graph(board)
        public = graph.public()
        for name, (size, chain) in public.items():
            key = f"stack/all/{name}"
            if size > figures.get(key, -1):
                figures[key], chains[name] = size, (size, board, chain)
        worst = max(public, key=lambda name: public[name][0])
        figures[f"stack/{board}/all public functions"] = public[worst][0]
        for name, pattern, more in (("main", "^main$", graph.frame(START)),
                                    ("interrupt", INTERRUPT, exception(board))):
            size, chain = graph.root(pattern)
            chains[f"{name} {board}"] = size + more, board, chain
            figures[f"stack/{board}/{name}"] = size + more
        needed = figures[f"stack/{board}/main"] + figures[f"stack/{board}/interrupt"]
        if needed > room(prefix, folder):
            raise NoBound(f"{board}: stack {needed}, but {room(prefix, folder)} bytes are left")
    for image, file in IMAGES.items():
        rooms = flash(pathlib.Path(f"build/firmware/m4f-Os/{file}.map"), room_of)
        figures |= {f"rooms/{image}/{room}": size for room, size in rooms.items()}
    for config, board, more in (
        ("default", "m4f", ()), ("m3_20k", "m3_20k", ()),
        ("regressors", "m4f", ("-DAUVID_MAX_COMMANDS=0", "-DAUVID_MAX_POPULATION=52")),
        ("thirteen", "m4f", ("-DAUVID_MAX_COMMANDS=0", "-DAUVID_MAX_PARAMETERS=13"))
    ):
        for name, size in structs(board, more).items():
            figures[f"sizeof/{config}/{name}"] = size
        figures[f"sizeof/{config}/{' '.join(PARTS)}"] = sum(
            figures[f"sizeof/{config}/auvid_{part}_t"] for part in PARTS)
    print("key,bytes")
    for key in sorted(figures):
        print(f"{key},{figures[key]}")
    return figures, chains


def tables(figures, chains):
    """Prints the figures as tables on stderr."""
    out = sys.stderr
    for what in ("image", "rooms", "flash", "sizeof", "stack"):
        rows = {}
        for key, size in figures.items():
            kind, column, name = key.split("/")
            if kind == what and (kind, column) != ("stack", "all"):
                rows.setdefault(name, {})[column] = size
        columns = sorted({column for row in rows.values() for column in row})
        print(f"{what:<36}" + "".join(f"{column:>11}" for column in columns), file=out)
        for name, row in rows.items():
            cells = "".join(f"{row.get(column, '-'):>11}" for column in columns)
            print(f"  {name:<34}" + cells, file=out)
    print("deepest: bytes, core, chain of calls with their frames", file=out)
    for name, (size, board, chain) in sorted(chains.items(), key=lambda item: -item[1][0])[:24]:
        path = " ".join(f"{re.sub('.*:|_f32_.*', '', step)} {frame}," for step, frame in chain
                        if step not in POINTERS)
        print(f"  {size:>5} {board:<8} {name}: {path[:-1]}", file=out)


def committed():
    lines = pathlib.Path("tests/firmware/size.csv").read_text().splitlines()
    return {key: int(number) for key, number in (line.split(",") for line in lines[1:])}


def rooms():
    """Flash by room of the three images on m4f."""
    size = committed()
    table = [f"{'flash of m4f':<16}" + "".join(f"{image:>16}" for image in IMAGES)]
    for room in dict.fromkeys(key.split("/")[2] for key in size if key.startswith("rooms/")):
        table.append(f"{room:<16}" + "".join(
            f"{size.get(f'rooms/{image}/{room}', 0):>16}" for image in IMAGES))
    return "\n".join(table) + "\n"


def readme():
    """README's table."""
    size = committed()
    boards = run(BOARD, "list").split()
    table = [f"{'bytes':<28}" + "".join(f"{board:>9}" for board in boards)]
    rows = [(f"{what}: {image}", [f"image/{{}}/{image.replace(' ', '_')} {name}" for name in names])
            for what, names in (("flash", ["text"]), ("RAM", ["data", "bss"]))
            for image in ("own navigation", "with filter", "node")]
    for title, keys in (*rows,
                        ("node: auvid's part of flash", ["flash/{}/library"]),
                        ("      stack, at most", ["stack/{}/main", "stack/{}/interrupt"])):
        table.append(f"{title:<28}" + "".join(
            f"{sum(size[key.format(board)] for key in keys):>9}" for board in boards))
    return "\n".join(table) + "\n"


PAGES = {"--readme": ("README.md", readme), "--rooms": ("port/cortex_m/README.md", rooms)}


def write(option):
    page, table = PAGES[option]
    page = pathlib.Path(page)
    head = f"<!-- output of: tests/firmware/size.py {option} -->\n```text\n"
    before, rest = page.read_text().split(head)
    page.write_text(before + head + table() + rest[rest.index("```"):])


if __name__ == "__main__":
    if sys.argv[1] in PAGES:
        sys.exit(write(sys.argv[1]) if sys.argv[2:] else print(PAGES[sys.argv[1]][1](), end=""))
    try:
        tables(*main())
    except NoBound as why:
        sys.exit(f"size.py: {why}")
