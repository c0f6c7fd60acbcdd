"""Figures with matplotlib, which is not asked to show them: a notebook does, and ``savefig`` writes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._arguments import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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


def contact(x: Floats, y: Floats, heights: Floats, pressures: Floats, gaps: Floats) -> Figure:
    """A contact: curves along a profile, maps over a map."""
    from matplotlib.figure import Figure

    if len(y) == 1:
        rubber = ("rubber", x, (heights + gaps)[0])
        panels = [("height [m]", [rubber, ("surface", x, heights[0])]), ("pressure [Pa]", [("", x, pressures[0])])]
        return stacked("contact", "x [m]", panels)
    figure = Figure(figsize=(10.0, 4.0), layout="constrained")
    fields = (("pressure [Pa]", pressures), ("gap [m]", gaps))
    for axes, (title, values) in zip(figure.subplots(1, 2), fields, strict=True):
        extent = (x[0], x[-1], y[0], y[-1])
        image = axes.imshow(values, origin="lower", extent=extent, aspect="equal")
        figure.colorbar(image, ax=axes, label=title)
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    return figure
