"""auvid-validate: a subcommand is a module with arguments(parser) and run(options).

Exit status: 0 if all is correct; 1 if a check failed; 2 for a user error, with one line on the
standard error.
"""
import argparse
import importlib
import os
import sys

from auvid_validation.user_error import UserError

#: Subcommand, which is also the name of its module, and its description.
COMMANDS = {
    "references": "compare every module with independent tools",
    "optimizer": "compare the optimizer with others, on the same cost",
    "peers": "compare whole searches with other optimizers: evaluations and time",
    "paper": "the paper's experiment in simulation: figures, tables, initialisation",
    "campaign": "many simulated runs: errors and the Cramer-Rao bound",
    "residuals": "identify a vehicle from your own log: have the residuals a pattern?",
    "worlds": "dives of another simulator: which identifiable numbers are wrong?",
}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def main(argv=None):
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrices are small: threads only wait
    argv = sys.argv[1:] if argv is None else argv
    parser = Parser(prog="auvid-validate", description="Comparison of auvid with other tools.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    try:
        for name, about in COMMANDS.items():
            command = commands.add_parser(name, help=about, description=about)
            if name in argv[:1]:  # avoids the import of all other modules
                module = importlib.import_module(f"auvid_validation.{name}")
                module.arguments(command)
        options = parser.parse_args(argv)
        sys.exit(module.run(options))
    except UserError as error:
        sys.exit(parser.error(str(error)))
    except KeyboardInterrupt:
        sys.exit(130)
