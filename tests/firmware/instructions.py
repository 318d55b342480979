#!/usr/bin/env python3
"""A table of instructions from the counts of count_plugin.c. Called by bench.sh.

usage: instructions.py FOLDER CSV NAME...
FOLDER/NAME/counted/count and FOLDER/NAME/rows/count have lines "function calls total most".
"""
import pathlib
import re
import sys

folder, csv, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
HEADERS = "".join(path.read_text() for path in pathlib.Path("lib/include").glob("**/*.h"))
DECLARED = set(re.findall(r"\b(auvid_[a-z0-9_]+)\(", HEADERS))
ONCE = re.compile(r"_(init|defaults|check|schedule|plan)$")  # not called in a tick


def read(path):
    """{function: (calls, total, maximum)}; AUVID_SIZED() names without their sizes."""
    count = {}
    for line in path.read_text().split("\n")[:-1]:
        name, *numbers = line.split()
        count[re.sub(r"_f(32|64)(_\d+)*$", "", name)] = tuple(map(int, numbers))
    return count


def figures(name):
    """{line of the table: (mean, maximum or None)}"""
    run, rows = (read(folder / name / image / "count") for image in ("counted", "rows"))
    calls, total, most = ({f: c[k] for f, c in run.items()} for k in range(3))

    def together(per, *functions):
        return sum(total[f"auvid_{f}"] for f in functions) / per

    searches = calls["auvid_optimizer_init"]
    search = "optimizer_ask", "optimizer_tell", "metric_cost_begin", "metric_cost"
    # the identifier gives a depth to auvid_nav_update, which also takes the DVL
    kinds = [f"auvid_nav_update_{kind}" for kind in ("position", "velocity")]
    around = (total["auvid_nav_update"] - sum(map(total.get, kinds))) / calls["auvid_nav_update"]
    depth = around + total[kinds[0]] / calls[kinds[0]]
    own = rows["auvid_metric_cost"][1] - rows["residual"][1]
    table = {
        "a tick: take, step, work, report": (total["tick"] / calls["tick"], most["tick"]),
        "navigation step: imu, depth, dvl": (
            sum(together(calls[f"auvid_nav_{f}"], f"nav_{f}") for f in ("imu", "dvl")) + depth,
            None),
        "smoothing, a tick": (
            together(calls["tick"], "metric_take_cell", "metric_continue"), None),
        "cost of a point, R": (
            together(calls["auvid_metric_cost_begin"], "metric_cost_begin", "metric_cost"), None),
        "cost of a point, 240 rows": (rows["auvid_metric_cost"][1], None),
        "  without the user's model": (own, None),
        "CRS: a trial point, ask and tell": (
            together(calls["auvid_crs_take"], "crs_next", "crs_take"), None),
        "line search: a point, ask and tell": (
            together(calls["auvid_line_search_take"], "line_search_next", "line_search_take"),
            None),
        "a search: optimizer and costs": (together(searches, *search), None),
    }
    for function in sorted(DECLARED & run.keys()):
        if not ONCE.search(function):
            table[function] = (total[function] / calls[function], most[function])
    return table


columns = {name: figures(name) for name in names}
lines = list(dict.fromkeys(line for table in columns.values() for line in table))
print("instructions, mean / maximum per call" + "".join(f"{name:>18}" for name in names))
with csv.open("w") as file:
    file.write("key,number\n")
    for line in lines:
        cells = ""
        for name in names:
            mean, most = columns[name].get(line, (None, None))
            cell = "-" if mean is None else f"{mean:.0f}" + (f" / {most}" if most else "")
            cells += f"{cell:>18}"
            for kind, number in (("mean", mean), ("most", most)):
                if number is not None:
                    key = line.strip().replace(",", "")
                    file.write(f"{name} {key} {kind},{number:.1f}\n")
        print(f"{line:35}{cells}")
