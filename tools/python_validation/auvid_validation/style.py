"""Style of all figures: labels, units, legible in grey (lines differ in lightness and dash)."""
import io

import matplotlib
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

BLACK, BLUE, ORANGE, LIGHT = "#1a1a1a", "#1f5f99", "#d9822b", "#b8bec6"
#: Compared lines: (colour, dashes, marker), with three lightnesses in grey.
KINDS = [dict(color=BLUE, linestyle="-", marker="o"),
         dict(color=ORANGE, linestyle="--", marker="s"),
         dict(color=BLACK, linestyle=":", marker="^"),
         dict(color="#7a8794", linestyle="-.", marker="D")]

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 100, "figure.constrained_layout.use": True,
    "font.size": 9, "axes.titlesize": 9.5, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.labelsize": 9,
    "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#e3e6ea", "grid.linewidth": 0.7, "axes.axisbelow": True,
    "xtick.direction": "out", "ytick.direction": "out",
    "lines.linewidth": 1.3, "lines.markersize": 3.5,
    "legend.frameon": False, "legend.fontsize": 8.5,
})


def figure(rows=1, columns=1, width=8.0, height=None, **options):
    """-> (figure, axes as an array of rows x columns)"""
    height = height or 0.6 + 1.9 * rows
    return plt.subplots(rows, columns, figsize=(width, height), squeeze=False, **options)


def png(fig):
    """The figure as bytes, reproducible. Closes the figure."""
    drawn, held = io.BytesIO(), io.BytesIO()
    fig.savefig(drawn, format="png")
    plt.close(fig)
    # 64 colours are enough, with a third of the bytes
    Image.open(drawn).convert("RGB").quantize(64, dither=Image.Dither.NONE).save(
        held, "png", optimize=True)
    return held.getvalue()


def save(fig, path):
    path.write_bytes(png(fig))
    return path
