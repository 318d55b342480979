"""auvid-log: from the log of a dive to the CSV that `auvid fit` reads."""
import argparse
import importlib
import pathlib
import sys

from auvid import column_map
from auvid.log_error import LogError, UsageError

#: Readers by the suffix of the file: module and function.
READERS = {".bin": "dataflash.read", ".tlog": "tlog.read", ".ulg": "ulog.read",
           ".db3": "bag.read", ".mcap": "bag.read", "": "bag.read", ".csv": "column_map.read_csv"}
#: Options that only these modules know.
OPTIONS = {"map": ("bag", "column_map"), "only": ("bag", "tlog"), "frames": ("bag",),
           "clock": ("bag",), "vehicle": ("bag", "dataflash", "tlog", "ulog")}

#: What to do instead of an option that a reader does not know.
REMEDIES = {("vehicle", ".csv"): ": give a thruster that pushes against its direction in the file "
            "sign = -1 in the map"}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def _resample(text):
    """Type of --resample."""
    if text == "velocity":
        return text
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not 0.1 <= rate <= 1000:
        raise argparse.ArgumentTypeError(f"'{text}' is neither velocity nor a rate of 0.1 to 1000")
    return rate


def _parser():
    parser = Parser(prog="auvid-log", description="Converts the log of a dive to the CSV of auvid "
                    "fit, and says what the log lacks.",
                    epilog="exit status: 0 converted; 1 this log cannot be converted; 2 bad usage")
    parser.add_argument("dive", type=pathlib.Path, metavar="DIVE", help=".BIN or .tlog (ArduSub), "
                        ".ulg (PX4), .db3, .mcap or folder (ROS 2, BlueOS), .csv with --map")
    parser.add_argument("-o", dest="output", type=pathlib.Path, required=True, metavar="DIVE.csv")
    parser.add_argument("--vehicle", type=pathlib.Path, metavar="FILE.ini", help="give thruster_1 "
                        ".. the directions of this vehicle file, for auvid fit --vehicle; not of a "
                        ".csv")
    parser.add_argument("--resample", type=_resample, metavar="HZ|velocity", help="rows at this "
                        "rate, or at the times of the velocity: motion is interpolated, commands "
                        "are held. Default: a row per sample; an empty cell means no new sample")
    parser.add_argument("--map", metavar="COLUMNS.ini", help="which column or field is which "
                        "column of auvid, with unit, sign and frame")
    parser.add_argument("--only", metavar="NAME", help="of several vehicles, this one: the system "
                        "id of a .tlog, or prefixes of topics, separated by commas")
    parser.add_argument("--frames", choices=("enu", "ned"), help="axes of messages of a bag whose "
                        "frame does not name them; default enu (REP 103), and ned for a Dvl")
    parser.add_argument("--clock", choices=("stamp", "recording"), help="times of "
                        "messages of a bag: their stamps (default), or when they were recorded")
    return parser


def _reader(options):
    dive = options.dive
    if not dive.exists():
        raise UsageError(f"{dive}: no such file")
    suffix = "" if dive.is_dir() else dive.suffix.lower() or "none"
    if suffix not in READERS:
        raise UsageError(f"{dive}: unknown suffix; it must be .BIN, .tlog, .ulg, .db3, .mcap or "
                         ".csv")
    module, function = READERS[suffix].split(".")
    for name, modules in OPTIONS.items():
        if getattr(options, name) is not None and module not in modules:
            remedy = REMEDIES.get((name, suffix), "")
            raise UsageError(f"{dive}: --{name} is not for a {suffix}{remedy}")
    return getattr(importlib.import_module(f"auvid.{module}"), function)


def convert(options):
    """Reads, writes, and prints what was found."""
    from auvid import advice, streams, vehicle_file, write_csv
    reader = _reader(options)
    if options.dive.suffix.lower() == ".csv" and options.map is None:
        raise UsageError(f"{options.dive}: a .csv needs --map, which names its columns")
    if options.output.exists() and options.output.samefile(options.dive):
        raise UsageError(f"{options.output} is the log itself: choose another name for the CSV")
    options.map = column_map.load(options.map) if options.map else None
    try:
        recording = reader(options.dive, options)
        if options.vehicle:
            vehicle_file.turn(recording, options.vehicle)
        found = streams.streams_of(recording)
        said = advice.advise(recording, found) + recording.notes
        rows = write_csv.write(found, options.output, options.resample)
    except LogError as error:
        raise LogError(f"{options.dive}: {error}") from error
    except OSError as error:
        raise UsageError(f"{options.dive}: cannot be read: {error.strerror}") from error
    begin = min(s.series.first for s in found)
    print(f"{options.dive}: {recording.kind}, "
          f"{max(s.series.last for s in found) - begin:.1f} s from {begin:.3f} s")
    for stream in found:
        print(f"  {stream.series.label} at {stream.series.rate_hz:.3g} Hz: "
              f"{' '.join(stream.columns)}")
    print(f"velocity: {streams.source(recording)}")
    for sentence in said:
        print(f"note: {sentence}")
    print(f"{options.output}: {rows} rows")


def main(argv=None):
    """The command."""
    parser = _parser()
    try:
        convert(parser.parse_args(argv))
    except UsageError as error:
        parser.error(str(error))
    except LogError as error:
        parser.exit(1, f"auvid-log: {error}\n")
    except KeyboardInterrupt:
        parser.exit(130)


if __name__ == "__main__":
    sys.exit(main())
