"""One line of progress on a terminal; nothing otherwise."""
import sys
import time


class Progress:
    def __init__(self, total, begun=0):
        self.total, self.count, self.begun = total, begun, begun
        self.start, self.shown = time.monotonic(), sys.stderr.isatty()

    def __call__(self, what=""):
        self.count += 1
        if not self.shown:
            return
        spent = time.monotonic() - self.start
        left = spent / max(1, self.count - self.begun) * max(0, self.total - self.count)
        bar = "#" * (30 * self.count // max(1, self.total))
        print(f"\r[{bar:<30}] {self.count}/{self.total}, {left:4.0f} s left  {what:<24}",
              end="", file=sys.stderr, flush=True)

    def done(self):
        if self.shown:
            print("\r" + " " * 90 + "\r", end="", file=sys.stderr)
