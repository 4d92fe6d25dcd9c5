"""The curves of a sweep as a picture."""

from itertools import pairwise
from math import nan
from typing import TYPE_CHECKING

from .figure import MARKED, check_file, page

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .curves import Curve, Picture


def save(picture: "Picture", title: str, path: str, force: bool) -> None:
    """Draw the curves of a sweep to a file, whose suffix is its format. Raises SceneError, OSError."""
    check_file(path, force)
    with page(path, force) as figure:
        axes = figure.subplots()
        axes.set_xlabel(picture.x)
        axes.set_ylabel(picture.y)
        axes.set_xscale("log" if picture.log else "linear")
        axes.spines[["top", "right"]].set_visible(False)
        for curve in picture.curves:
            _draw_curve(axes, curve)
        if min(curve.xs) < max(curve.xs):
            axes.set_xlim(min(curve.xs), max(curve.xs))  # where the curve has gaps, too
        if len(picture.curves) > 1:
            axes.legend(frameon=False)
        figure.suptitle(title, fontsize=10)


def _draw_curve(axes: "Axes", curve: "Curve") -> None:
    ys = [nan if y is None else y for y in curve.ys]
    (line,) = axes.plot(curve.xs, ys, marker="." if len(ys) <= MARKED else "", label=curve.label)
    for i, regimes in zip(curve.changes, pairwise(curve.regimes), strict=True):
        axes.axvline(curve.xs[i], color=line.get_color(), lw=1, ls="--")
        label = ", ".join([*regimes, *filter(None, [curve.label])])
        place = axes.get_xaxis_transform()  # the height is a share of the axes'
        axes.text(curve.xs[i], 0.98, f" {label}", transform=place, rotation=90, ha="right", va="top", size=9)
