"""auvid-validate references: every module, in single and in double precision, against
independent tools. One row per comparison; ends with "N passed, N failed"."""
import dataclasses
import importlib
import json

import numpy as np

from auvid_validation.compare import Row
from auvid_validation.user_error import UserError, output
from auvid_validation.library import load

#: Each name stands for a module reference_NAME with comparisons(lib).
PARTS = ("smoother", "nav", "dynamics", "allocation", "metric", "can", "signals")


def arguments(parser):
    parser.add_argument("--only", metavar="PART", choices=PARTS, help=", ".join(PARTS))
    parser.add_argument("--precision", choices=("float", "double"), help="default: both")
    parser.add_argument("--json", metavar="FILE", type=output, help="write the rows there")


def rows_of(part, precision):
    """All rows. A failed row replaces those lost by an exception."""
    try:
        module = importlib.import_module(f"auvid_validation.reference_{part}")
        yield from module.comparisons(load(precision))
    except UserError:
        raise
    except Exception as error:  # noqa: BLE001  the other modules continue after any exception
        where = error.__traceback__
        while where.tb_next:
            where = where.tb_next
        yield Row(part, f"line {where.tb_lineno}", np.nan, 0, type(error).__name__, str(error))


def show(row, precision):
    print(f"{'PASS' if row.passed else 'FAIL'}  {precision:<6s}  {row.quantity:<47s}  "
          f"{row.reference:<32s}  {row.difference:8.2e} <= {row.bound:8.2e}  {row.unit} "
          f"({row.why})", flush=True)


def run(options):
    told = []
    print(f"      {'':<6s}  {'quantity':<47s}  {'reference':<32s}  largest difference <= bound")
    for precision in [options.precision] if options.precision else ["float", "double"]:
        load(precision)  # or the message that it is not built
        for part in [options.only] if options.only else PARTS:
            for row in rows_of(part, precision):
                show(row, precision)
                told.append({"precision": precision, "passed": row.passed,
                             **dataclasses.asdict(row)})
    failed = sum(not row["passed"] for row in told)
    print(f"{len(told) - failed} passed, {failed} failed")
    if options.json:
        json.dump(told, options.json, indent=1, default=float)
    return 1 if failed else 0
