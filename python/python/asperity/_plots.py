"""Pictures with matplotlib, which is not asked to show them: a notebook does, and ``savefig`` writes them.

A picture is plain data, which the command draws too: rows of panels, each with two axes and marks, all sizes in pixels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Data = dict[str, Any]
Colour = tuple[float, float, float]

# Pixels of a picture in an inch, and one in points: its text is then as large as matplotlib's own.
_INCH = 128.0
_POINT = 72.0 / _INCH
# Of titles, of text, and of what stands beside points, points.
_TITLE, _TEXT, _LABEL = 12.0, 10.0, 8.0
# The height of a line of text and of a title, and the space left of a panel, right of it and below it, pixels.
_LINE, _HEAD, _LEFT, _RIGHT, _BELOW = 26.0, 36.0, 84.0, 28.0, 62.0
# The width of a scale, the space left of it and that of its numbers, pixels.
_BAR, _GAP, _NUMBERS = 16.0, 14.0, 64.0
_INK = (0.16, 0.16, 0.16)
_SYMBOLS = {"Disc": "o", "Square": "s", "Triangle": "^", "Diamond": "D", "Cross": "x"}
_STROKES: dict[str, Any] = {"Solid": "-", "Dashed": (0, (4.0, 2.5)), "Dotted": (0, (1.2, 2.4))}


def drawn(picture: _native.Picture, title: str = "") -> Figure:
    """Draws a picture, with this title where it has none."""
    from matplotlib.figure import Figure

    data = picture.data()
    title = data["title"] or title
    bars: list[Data] = []
    rows = [_Row(row, bars) for row in data["rows"]]
    width = max((row.width for row in rows), default=_LEFT)
    named: set[str] = set()
    for row in rows:
        row.name(width, named)
    head = _HEAD if title else 0.0
    height = head + sum(row.height for row in rows)
    figure = Figure(figsize=(width / _INCH, height / _INCH))
    if title:
        figure.suptitle(title, fontsize=_TITLE, y=1.0 - head / 2.0 / height, va="center")
    page, top, scales = _Page(figure, width, height), head, []
    for row in rows:
        scales += row.draw(page, top)
        top += row.height
    for left, top, up, scale in scales:
        _scale(page.axes(left, top, (_BAR, up)), scale)
    return figure


@dataclass(frozen=True)
class _Page:
    """A figure on which places are pixels from its upper left corner."""

    figure: Figure
    width: float
    height: float

    def axes(self, left: float, top: float, size: tuple[float, float]) -> Axes:
        across, up = size
        x, y = left / self.width, 1.0 - (top + up) / self.height
        return self.figure.add_axes((x, y, across / self.width, up / self.height))

    def text(self, left: float, top: float, text: str, **how: Any) -> None:
        how = {"va": "center", "fontsize": _TEXT, **how}
        self.figure.text(left / self.width, 1.0 - top / self.height, text, **how)


class _Row:
    """Panels side by side, and what stands above them."""

    def __init__(self, row: Data, bars: list[Data]) -> None:
        self.row, self.panels = row, row["panels"]
        # A scale stands beside the last of the panels that it belongs to.
        self.with_bar: list[bool] = []
        for panel in reversed(self.panels):
            scale = panel["scale"]
            self.with_bar.insert(0, scale is not None and scale not in bars)
            bars += [scale] if self.with_bar[0] else []
        self.sides = [self._sides(panel, bar) for panel, bar in zip(self.panels, self.with_bar, strict=True)]
        self.width = sum(map(sum, self.sides)) + sum(panel["size"][0] for panel in self.panels)
        self.tall = max((panel["size"][1] for panel in self.panels), default=0.0)
        self.has_title = any(panel["title"] for panel in self.panels) or any(self.with_bar)
        self.has_axes = any(panel["frame"] == "Axes" for panel in self.panels)
        self.legend: list[list[tuple[str, Any]]] = []

    def _sides(self, panel: Data, bar: bool) -> tuple[float, float]:
        """The space on the left and on the right of a panel."""
        names = max((_width(tick["name"]) for tick in panel["y"]["named"]), default=0.0)
        beside = max((_width(tick["name"]) for tick in panel["beside"]), default=0.0)
        left = {"Axes": max(_LEFT, names + _RIGHT), "Line": 8.0, "None": 0.0}[panel["frame"]]
        right = {"Axes": _RIGHT, "Line": 8.0, "None": 0.0}[panel["frame"]]
        title = _width(panel["scale"]["axis"]["title"]) if bar else 0.0
        return left, max(right, beside + 16.0 if beside else 0.0) + (_GAP + max(title, _BAR + _NUMBERS) if bar else 0.0)

    def name(self, width: float, named: set[str]) -> None:
        """Lines of a legend of what is not `named` above, within a width."""
        room = 0.0
        for name, handle in _legend(self.panels, named):
            wide = _width(name) + 60.0
            if not self.legend or wide > room:
                self.legend.append([])
                room = width - _LEFT
            self.legend[-1].append((name, handle))
            room -= wide

    @property
    def above(self) -> float:
        lines = bool(self.row["note"]) + len(self.legend) + self.has_title
        return (_HEAD if self.row["title"] else 0.0) + _LINE * lines + 8.0

    @property
    def height(self) -> float:
        return self.above + self.tall + (_BELOW if self.has_axes else 8.0)

    def draw(self, page: _Page, top: float) -> list[tuple[float, float, float, Data]]:
        """Draws the row; returns its scales, each with its place and height."""
        line = top
        if self.row["title"]:
            page.text(page.width / 2.0, line + _HEAD / 2.0, self.row["title"], fontsize=_TITLE, ha="center")
            line += _HEAD
        first = min(_LEFT, self.sides[0][0]) if self.sides else 0.0
        if self.row["note"]:
            page.text(first, line + _LINE / 2.0, self.row["note"])
            line += _LINE
        for entries in self.legend:
            names, handles = [name for name, _ in entries], [handle for _, handle in entries]
            place = (first / page.width, 1.0 - (line + _LINE / 2.0) / page.height)
            close = {"borderpad": 0.0, "borderaxespad": 0.0, "handletextpad": 0.5, "columnspacing": 1.4}
            page.figure.legend(
                handles, names, loc="center left", bbox_to_anchor=place, ncols=len(names), frameon=False, **close
            )
            line += _LINE
        top, left, scales = top + self.above, 0.0, []
        for panel, bar, (before, behind) in zip(self.panels, self.with_bar, self.sides, strict=True):
            across, up = panel["size"]
            _panel(page.axes(left + before, top, (across, up)), panel)
            left += before + across + behind
            if bar:
                wide = behind - max(_width(panel["scale"]["axis"]["title"]), _BAR + _NUMBERS)
                scales.append((left - behind + wide, top, up, panel["scale"]))
        return scales


def _width(text: str) -> float:
    """The width of a text, pixels."""
    from matplotlib.textpath import TextPath

    return float(TextPath((0.0, 0.0), text, size=_TEXT).get_extents().width) / _POINT if text.strip() else 0.0


def _rgb(colour: Iterable[int]) -> Colour:
    red, green, blue = (part / 255.0 for part in colour)
    return red, green, blue


def _legend(panels: list[Data], named: set[str]) -> list[tuple[str, Any]]:
    """The names that are new, each with all that has it; in ink where that has several colours."""
    marks: dict[str, list[Data]] = {}
    for panel in panels:
        for mark in panel["marks"]:
            if mark["name"] and mark["name"] not in named:
                marks.setdefault(mark["name"], []).append(mark)
    named |= set(marks)
    found = []
    for name, its in marks.items():
        colours = {tuple(mark["colour"]) for mark in its}
        kinds: dict[str, Data] = {}
        for mark in its:
            kinds.setdefault(next(iter(mark["shape"])), mark)
        found.append((name, tuple(_key(mark, _INK if len(colours) > 1 else None) for mark in kinds.values())))
    return found


def _key(mark: Data, colour: Colour | None) -> Any:
    """What stands for a mark in a legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    ((kind, shape),) = mark["shape"].items()
    colour = colour or _rgb(mark["colour"])
    if kind == "Line":
        return Line2D([], [], **_stroke(shape, colour))
    if kind == "Points":
        return Line2D([], [], **_look(shape, colour))
    if kind == "Arrows":
        return Line2D([], [], color=colour, marker=">", markevery=[1])
    return Patch(color=colour, alpha=shape.get("opacity"), linewidth=0.0)


def _panel(axes: Axes, panel: Data) -> None:
    """Draws a panel into axes of its size."""
    for which in "xy":
        _axis(axes, which, panel[which])
    if panel["title"]:
        axes.set_title(panel["title"], fontsize=_TEXT, pad=5.0)
    axes.spines[["top", "right"]].set_visible(panel["frame"] == "Line")
    if panel["frame"] == "Axes":
        axes.grid(color="#e1e1e1", linewidth=0.6, axis="x" if panel["y"]["named"] else "both")
        axes.set_axisbelow(True)
    elif panel["frame"] == "Line":
        axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
    else:
        axes.set_axis_off()
    room = _Room(axes)
    for mark in panel["marks"]:
        ((kind, shape),) = mark["shape"].items()
        _KINDS[kind](_Pen(axes, panel, _rgb(mark["colour"]), room), shape)
    for tick in panel["beside"]:
        axes.text(
            1.0 + 8.0 / panel["size"][0], tick["at"], tick["name"], transform=axes.get_yaxis_transform(), va="center"
        )


def _axis(axes: Axes, which: str, axis: Data) -> None:
    """The scale, the ends, the title and the ticks of an axis."""
    scale = "log" if axis["is_logarithmic"] else "linear"
    axes.set(**{f"{which}scale": scale, f"{which}lim": (axis["low"], axis["high"]), f"{which}label": axis["title"]})
    _ticks(axes.xaxis if which == "x" else axes.yaxis, axis)


def _ticks(of: Any, axis: Data) -> None:
    """Names of ticks: as given, in the prefixed unit of a linear axis, as plain numbers on a short logarithmic one."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    factor = axis["factor"]
    if axis["named"]:
        of.set_ticks([tick["at"] for tick in axis["named"]], labels=[tick["name"] for tick in axis["named"]])
    elif not axis["is_logarithmic"]:
        of.set_major_formatter(FuncFormatter(lambda value, _: f"{value / factor:.6g}"))
    elif axis["high"] <= 101.0 * axis["low"] and 1e-3 <= axis["low"] and axis["high"] < 1e5:
        of.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        of.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        of.set_minor_formatter(NullFormatter())


def _scale(axes: Axes, scale: Data) -> None:
    """A bar of colours."""
    from matplotlib.cm import ScalarMappable

    figure = axes.get_figure()
    assert figure is not None
    bar = figure.colorbar(ScalarMappable(**_colours(scale)), cax=axes)
    _ticks(bar.ax.yaxis, scale["axis"])
    axes.set_title(scale["axis"]["title"], loc="left", fontsize=_TEXT, pad=5.0)


def _colours(scale: Data | None, without: Colour = _INK) -> Data:
    """The colours of a scale and what they stand for; what has no value has the colour `without`."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize

    if scale is None:
        return {}
    ends = {"Blues": ["white", "#0072b2"], "Greys": ["#5a5a5a", "white"]}.get(scale["colours"])
    colours = LinearSegmentedColormap.from_list("", ends) if ends else colormaps["viridis"]
    axis = scale["axis"]
    norm = (LogNorm if axis["is_logarithmic"] else Normalize)(axis["low"], axis["high"])
    return {"cmap": colours.with_extremes(bad=without), "norm": norm}


class _Room:
    """Where labels stand in a panel: none where another one is."""

    def __init__(self, axes: Axes) -> None:
        self._axes = axes
        self._taken: list[tuple[float, float, float, float]] = []

    def has(self, x: float, y: float, text: str) -> bool:
        """Whether there is room around a place for a text, which then takes it."""
        across, up = (float(number) for number in self._axes.transData.transform((x, y)))
        dots = self._axes.figure.dpi / _INCH
        half, high = dots * (_width(text) / 2.0 + 4.0), dots * _LINE / 2.0
        box = (across - half, up - high, across + half, up + high)
        left, low, right, top = self._axes.bbox.extents
        inside = left < box[0] and box[2] < right and low < box[1] and box[3] < top
        if not inside or any(
            box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3] for other in self._taken
        ):
            return False
        self._taken.append(box)
        return True


@dataclass(frozen=True)
class _Pen:
    """What draws the marks of a panel."""

    axes: Axes
    panel: Data
    colour: Colour
    room: _Room

    def shown(self, points: Any, numbers: int = 2) -> tuple[Floats, Any]:
        """The points, of so many numbers, that the axes can show, and which they are."""
        places = np.array(points, dtype=np.float64).reshape(-1, numbers)
        is_shown = np.isfinite(places).all(axis=1)
        for column in range(places.shape[1]):
            if self.panel["xy"[column % 2]]["is_logarithmic"]:
                is_shown &= places[:, column] > 0.0
        return places[is_shown], is_shown


def _look(shape: Data, colour: Colour) -> Data:
    """How symbols look: full, white within, or open."""
    face = {"Full": colour, "Hollow": "white", "Ring": "none"}[shape["fill"]]
    width = 0.0 if shape["radius"] < 3.0 and shape["fill"] == "Full" else 1.1
    width = 1.5 if shape["symbol"] == "Cross" else width
    size = 2.0 * shape["radius"] * _POINT
    return {
        "linestyle": "none",
        "color": colour,
        "marker": _SYMBOLS[shape["symbol"]],
        "markersize": size,
        "markerfacecolor": face,
        "markeredgewidth": width,
    }


def _stroke(shape: Data, colour: Colour) -> Data:
    """How lines look."""
    return {"color": colour, "linestyle": _STROKES[shape["stroke"]], "linewidth": 1.2 * shape["width"] * _POINT}


def _line(pen: _Pen, shape: Data) -> None:
    points, _ = pen.shown(shape["points"])
    pen.axes.plot(*points.T, **_stroke(shape, pen.colour))


def _area(pen: _Pen, shape: Data) -> None:
    outline, _ = pen.shown(shape["outline"])
    pen.axes.fill(*outline.T, color=pen.colour, alpha=shape["opacity"], linewidth=0.0)


def _points(pen: _Pen, shape: Data) -> None:
    points, is_shown = pen.shown(shape["points"])
    if shape["values"]:
        values = np.array(shape["values"], dtype=np.float64)[is_shown]
        size = (2.0 * shape["radius"] * _POINT) ** 2
        colours = _colours(pen.panel["scale"])
        marker = _SYMBOLS[shape["symbol"]]
        x, y = points.T
        pen.axes.scatter(x, y, size, values, marker=marker, edgecolors=[pen.colour], zorder=2.5, **colours)
    else:
        pen.axes.plot(*points.T, clip_on=False, zorder=2.5, **_look(shape, pen.colour))
    labels = np.array(shape["labels"], dtype=object)[is_shown] if shape["labels"] else []
    for (x, y), label in zip(points, labels, strict=False):
        if label and pen.room.has(x, y, label):
            above = (0.0, shape["radius"] * _POINT + 1.0)
            pen.axes.annotate(
                label, (x, y), above, textcoords="offset points", ha="center", color=pen.colour, fontsize=_LABEL
            )


def _boxes(pen: _Pen, shape: Data) -> None:
    from matplotlib.collections import PolyCollection

    corners, is_shown = pen.shown(shape["boxes"], 4)
    x, y, to_x, to_y = corners.T
    outlines = list(np.array([[x, y], [to_x, y], [to_x, to_y], [x, to_y]]).transpose(2, 0, 1))
    values = np.array(shape["values"], dtype=np.float64)[is_shown] if shape["values"] else None
    how: Data = {"facecolors": [pen.colour]} if values is None else {"array": values, **_colours(pen.panel["scale"])}
    pen.axes.add_collection(PolyCollection(outlines, linewidths=0.0, **how), autolim=False)


def _heat(pen: _Pen, shape: Data) -> None:
    values = np.array(shape["values"], dtype=np.float64).reshape(-1, shape["columns"])
    between = [np.geomspace if pen.panel[which]["is_logarithmic"] else np.linspace for which in "xy"]
    x, y = (
        edges(pen.panel[which]["low"], pen.panel[which]["high"], count + 1)
        for edges, which, count in zip(between, "xy", values.shape[::-1], strict=True)
    )
    colours = _colours(pen.panel["scale"], pen.colour)
    if between == [np.linspace, np.linspace]:
        extent = (x[0], x[-1], y[0], y[-1])
        pen.axes.imshow(values, origin="lower", extent=extent, aspect="auto", zorder=0.6, **colours)
    else:
        pen.axes.pcolormesh(x, y, np.ma.masked_invalid(values), rasterized=True, zorder=0.6, **colours)


def _contours(pen: _Pen, lines: list[Data]) -> None:
    for line in lines:
        points, _ = pen.shown(line["points"])
        behind = _colours(pen.panel["scale"])
        shade = behind["cmap"](behind["norm"](line["value"])) if behind else (1.0, 1.0, 1.0)
        colour = _INK if np.dot(shade[:3], (0.299, 0.587, 0.114)) > 0.55 else (1.0, 1.0, 1.0)
        pen.axes.plot(*points.T, color=colour, linewidth=0.8)
        x, y = points[len(points) // 2].tolist()
        if pen.room.has(x, y, line["label"]):
            # As a gap in the line.
            box = {"facecolor": shade, "edgecolor": "none", "pad": 1.0}
            pen.axes.text(x, y, line["label"], ha="center", va="center", color=colour, fontsize=9.0, bbox=box)


def _arrows(pen: _Pen, shape: Data) -> None:
    x, y, to_x, to_y = pen.shown(shape["arrows"], 4)[0].T
    how: Data = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 2.0, "units": "dots"}
    pen.axes.quiver(x, y, to_x - x, to_y - y, color=pen.colour, edgecolor="white", linewidth=0.5, zorder=3.0, **how)


_KINDS: dict[str, Callable[[_Pen, Any], None]] = {
    "Line": _line,
    "Area": _area,
    "Points": _points,
    "Boxes": _boxes,
    "Heat": _heat,
    "Contours": _contours,
    "Arrows": _arrows,
}
