"""Figures with matplotlib, which is not asked to show them: a notebook does, and ``savefig`` writes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ._moment import Moment

Curve = tuple[str, Any, Any]


def stacked(title: str, x_title: str, panels: Sequence[tuple[str, Sequence[Curve]]], log: bool = False) -> Figure:
    """Panels of curves above each other, over one axis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 1.0 + 2.2 * len(panels)), layout="constrained")
    figure.suptitle(title)
    all_axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (y_title, curves) in zip(all_axes, panels, strict=True):
        for name, x, y in curves:
            axes.plot(x, y, label=name, marker="o" if len(x) < 40 and log else None)
        axes.set_ylabel(y_title)
        axes.grid(alpha=0.3)
        if log:
            axes.set_xscale("log")
        if len(curves) > 1:
            axes.legend()
    all_axes[-1].set_xlabel(x_title)
    return figure


def swept(y_title: str, curves: Sequence[tuple[str, Floats, Floats, Any]]) -> Figure:
    """Curves over the speed: name, speeds, values, and which of them are steady; the others are hollow."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    axes = figure.subplots()
    for name, speeds, values, steady in curves:
        (line,) = axes.plot(speeds, values, label=name, marker="o")
        if not np.all(steady):
            axes.plot(speeds[~steady], values[~steady], "o", color=line.get_color(), markerfacecolor="white")
    axes.set(xscale="log", xlabel="speed [m/s]", ylabel=y_title)
    axes.grid(alpha=0.3)
    if len(curves) > 1:
        axes.legend()
    return figure


Side = tuple[str, Floats, bool]


def maps(title: str, sides: tuple[Side, Side], panels: Sequence[tuple[str, Floats]]) -> Figure:
    """Values over two sides (title, values, whether logarithmic) in colours, with contour lines and the largest of each
    row."""
    from matplotlib.figure import Figure

    (x_title, x, x_log), (y_title, y, y_log) = sides
    values = np.concatenate([panel.ravel() for _, panel in panels])
    values = values[np.isfinite(values)]
    low, high = (values.min(), values.max()) if len(values) else (0.0, 1.0)
    levels = np.linspace(low, high if high > low else low + 1.0, 65)
    figure = Figure(figsize=(1.0 + 4.0 * len(panels), 3.6), layout="constrained")
    all_axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for axes, (name, panel) in zip(all_axes, panels, strict=True):
        known = np.ma.masked_invalid(panel)
        colours = axes.contourf(x, y, known, levels=levels)
        lines = axes.contour(x, y, known, levels=levels[8:-1:8], colors="black", linewidths=0.8)
        axes.clabel(lines, fontsize="small")
        tops = [(top, at) for top, at in zip((_top(np.log(x) if x_log else x, row) for row in panel), y, strict=True)]
        ridge = np.array([(np.exp(top) if x_log else top, at) for top, at in tops if top is not None])
        if len(ridge):
            axes.plot(*ridge.T, "o", color="#d55e00", markeredgecolor="white", label=f"largest over {x_title}")
        axes.set(xlabel=x_title, ylabel=y_title, title=name, xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        axes.set_xscale("log" if x_log else "linear")
        axes.set_yscale("log" if y_log else "linear")
    figure.colorbar(colours, ax=list(all_axes), label=title, format="%.3g")
    return figure


def _top(x: Floats, row: Floats) -> float | None:
    """The vertex of the parabola through the largest value and its neighbours; None at an end, or beside a gap."""
    if not np.isfinite(row).any():
        return None
    i = int(np.nanargmax(row))
    if i in (0, len(row) - 1) or not np.isfinite(row[i - 1 : i + 2]).all():
        return None
    rise, fall = (row[i] - row[i - 1]) / (x[i] - x[i - 1]), (row[i] - row[i + 1]) / (x[i + 1] - x[i])
    part = rise / (rise + fall) if rise + fall > 0.0 else 0.5
    return float((x[i - 1] + x[i]) / 2.0 + part * (x[i + 1] - x[i - 1]) / 2.0)


def contact(x: Floats, y: Floats, heights: Floats, pressures: Floats, gaps: Floats) -> Figure:
    """A contact: curves along a profile, maps over a map."""
    from matplotlib.figure import Figure

    if len(y) == 1:
        rubber = ("rubber", x, (heights + gaps)[0])
        panels = [("height [m]", [rubber, ("surface", x, heights[0])]), ("pressure [Pa]", [("", x, pressures[0])])]
        figure = stacked("contact", "x [m]", panels)
        _caption(figure.axes[0], 1.0)
        return figure
    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    figure.suptitle("the rubber slides along x", fontsize="medium")
    fields = (("pressure [Pa]", pressures), ("gap [m]", gaps))
    for axes, (title, values) in zip(figure.subplots(1, 2), fields, strict=True):
        extent = (x[0], x[-1], y[0], y[-1])
        image = axes.imshow(values, origin="lower", extent=extent, aspect="equal")
        figure.colorbar(image, ax=axes, label=title)
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    return figure


def _caption(axes: Axes, slides: float) -> None:
    """Says above a contact which way it slides, and how many times as large as lengths its heights are drawn."""
    from matplotlib.figure import Figure

    figure = axes.get_figure()
    # It takes its room from the axes.
    axes.set_title("heights", loc="left", fontsize="medium")
    if isinstance(figure, Figure):
        figure.draw_without_rendering()
    box = axes.get_window_extent()
    scales = [
        size / (high - low) for size, (low, high) in ((box.width, axes.get_xlim()), (box.height, axes.get_ylim()))
    ]
    way = {1.0: ", the rubber slides \N{RIGHTWARDS ARROW}", -1.0: ", the rubber slides \N{LEFTWARDS ARROW}"}
    text = f"heights drawn {scales[1] / scales[0]:.2g} times as large as lengths"
    axes.set_title(text + way.get(float(np.sign(slides)), ""), loc="left", fontsize="medium")


# Entries of a legend beside a title.
_CLOSE = {"handlelength": 1.0, "columnspacing": 0.8, "handletextpad": 0.4}

# How a mass is drawn by what it does: colour, marker, and whether it is full.
_TOUCHES = {"sticks": ("#0072b2", "s", True), "slips": ("#d55e00", "o", True), "free": ("#8c8c8c", "o", False)}


def moment(found: Moment) -> Figure:
    """The masses of a layer on its profile, and their loads and flash temperatures below."""
    from matplotlib.figure import Figure

    rows = 2 + (found.flash is not None)
    figure = Figure(figsize=(9.0, 1.0 + 2.0 * rows), layout="constrained")
    figure.suptitle(f"{found.name}, t = {found.time:.4g} s")
    layer, *bars = figure.subplots(rows, 1, sharex=True)
    low, high = found.heights
    x, z = found.profile
    layer.fill_between(found.x, np.clip(found.z, low, high), high, color="#cfd6de", label="rubber")
    layer.fill_between(x, low, np.clip(z, low, high), color="#b9b4ab", label="profile")
    layer.plot(x, z, color="#282828", linewidth=0.8)
    colours = np.array([_TOUCHES[touch][0] for touch in found.touch])
    for touch, (colour, marker, full) in _TOUCHES.items():
        its = found.touch == touch
        face = colour if full else "none"
        layer.plot(found.x[its], found.z[its], marker, color=colour, markerfacecolor=face, markersize=3, label=touch)
    layer.set(ylim=(low, high), xlim=(x[0], x[-1]), ylabel="z [m]")
    layer.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, fontsize="small", frameon=False, **_CLOSE)
    width = 0.8 * found.spacing
    bars[0].bar(found.x, found.load, width, color=colours)
    bars[0].set_ylabel(f"{found.load_name} [{found.load_unit}]")
    if found.flash is not None:
        bars[1].bar(found.x, found.flash, width, color="#cc79a7")
        bars[1].set_ylabel("flash [K]")
    bars[-1].set_xlabel("x [m]")
    _caption(layer, found.slides)
    return figure


def compared(
    title: str, curves: Sequence[tuple[str, Sequence[tuple[float, float]], Sequence[tuple[float, float, float]]]]
) -> Figure:
    """Friction of a table over the speed, and the measurements on each curve with bars of a standard deviation."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axes = figure.subplots()
    for name, swept, measured in curves:
        (line,) = axes.plot(*np.array(swept).T, label=name)
        speeds, friction, sigma = np.array(measured).T
        axes.errorbar(speeds, friction, sigma, fmt="o", color=line.get_color(), markerfacecolor="white")
    axes.set(xscale="log", xlabel="speed [m/s]", ylabel="friction [1]", title=title)
    axes.grid(alpha=0.3)
    axes.legend()
    return figure


# Columns of Persson's theory: of friction and of area.
_THEORIES = {
    "friction": {
        "Persson's hysteresis, ridges": "persson_friction_1d",
        "Persson's hysteresis, isotropic": "persson_friction_2d",
    },
    "area": {"Persson, ridges": "persson_area_1d", "Persson, isotropic": "persson_area_2d"},
}


def studied(columns: dict[str, Floats]) -> Figure:
    """Friction and area of a study over the spacing."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    doubled, split, seeds = columns["length_factor"] != 1, columns["split_factor"] != 1, columns["seed_shift"] != 0
    ladder = ~(doubled | split | seeds)
    spacing = columns["spacing"]
    all_axes = figure.subplots(2, 1, sharex=True)
    for axes, name in zip(all_axes, ("friction", "area"), strict=True):
        axes.plot(spacing[ladder], columns[name][ladder], "o-", label="this scene")
        others = (("twice the length", doubled), ("another split", split), ("other seeds", seeds))
        for label, runs in others:
            if np.any(runs):
                axes.plot(spacing[runs], columns[name][runs], "o", markerfacecolor="none", label=label)
        for label, column in _THEORIES[name].items():
            axes.plot(spacing[ladder], columns[column][ladder], "--", label=label)
        axes.set(xscale="log", yscale="log", ylabel=f"{name} [1]")
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small")
    all_axes[-1].set_xlabel("spacing [m]")
    return figure


def surface(
    name: str, used: tuple[Floats, Floats], read: tuple[Floats, Floats] | None, spectrum: Floats, law: Floats
) -> Figure:
    """A profile, also as it was read, and its power spectrum with the power law."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    figure.suptitle(name)
    above, below = figure.subplots(2, 1)
    if read is not None:
        above.plot(*read, ".", markersize=2, color="#e69f00", label="as read")
    above.plot(*used, label="profile" if read is None else "smoothed")
    above.set(xlabel="x [m]", ylabel="z [m]")
    # Beyond a cut-off there are rounding errors alone.
    drawn = spectrum[spectrum[:, 1] > 1e-16 * np.max(spectrum[:, 1], initial=0.0)]
    below.plot(*drawn.T, label="power spectrum")
    if len(law):
        below.plot(*law.T, "--", label="power law")
    below.set(xscale="log", yscale="log", xlabel="wave number [rad/m]", ylabel="power spectrum [m³]")
    for axes in (above, below):
        axes.grid(alpha=0.3)
        axes.legend()
    return figure
