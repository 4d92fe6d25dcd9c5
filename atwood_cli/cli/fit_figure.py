"""Runs and their line as a picture."""

from typing import TYPE_CHECKING, Any

from .figure import BLUE, GREY, INK, check_file, page
from .labels import Label, write_labels
from .text import wrapped

if TYPE_CHECKING:
    from ..fit.fitting import Fit

TITLE_WIDTH = 130  # characters: more do not fit the page
NAMED = 60  # runs: of more, none is named


def save(fit: "Fit", head: str, path: str, force: bool) -> None:
    """Draw runs and their line to a file, whose suffix is its format. Raises SceneError, OSError."""
    from ..fit.line import points
    from ..fit.sentences import shown, verdict

    check_file(path, force)
    at = points(fit)
    with page(path, force) as figure:
        line, rest = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
        end = 1.06 * float(max(at.x))
        line.plot([0, end], [at.intercept, at.intercept + at.slope * end], color=BLUE, lw=1.5)
        bars: Any = {"fmt": "o", "ms": 5, "capsize": 3, "lw": 1.2, "color": INK}
        line.errorbar(at.x, at.y, yerr=at.u_y, xerr=at.u_x, **bars)
        rest.axhline(0, color=BLUE, lw=1.5)
        rest.errorbar(at.x, at.residual, yerr=at.u_residual, **bars)
        said = []
        for name, label, unit in (("rim_mass", "slope $c$", "kg"), ("axle", "intercept $f$", "N")):
            spread = fit.uncertainty(name) if name in fit.values else None
            why = (
                "" if name in fit.values else ", given" if name in fit.known.values else ", as none is needed"
            )
            said.append(f"{label} = {shown(fit.estimate.values[name], spread)} {unit}{why}")
        line.text(0.03, 0.95, "\n".join(said), transform=line.transAxes, va="top", color=BLUE)
        line.set_ylabel("$T_h - T_l = (m_h - m_l)\\,g - a\\,(m_h + m_l)$  (N)")
        rest.set_ylabel("residual (N)")
        rest.set_xlabel("acceleration $a$ (m/s²)")
        line.set_xlim(0, end)
        low, high = min(0.0, float(min(at.y - at.u_y)), at.intercept), float(max(at.y + at.u_y))
        line.set_ylim(low, high + 0.2 * (high - low))
        for axes in (line, rest):
            axes.spines[["top", "right"]].set_visible(False)
        figure.suptitle("\n".join([head, *wrapped(verdict(fit), TITLE_WIDTH)]), fontsize=10)
        runs = zip(fit.used, at.x, at.y, strict=True) if len(fit.used) <= NAMED else ()
        rows = [
            (f"row{'s' * (len(run.rows) > 1)} {','.join(map(str, run.rows))}", x, y) for run, x, y in runs
        ]
        write_labels(line, [Label(words, float(x), float(y), GREY) for words, x, y in rows])
