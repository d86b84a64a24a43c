"""The path of the tool's centre along a contour, element by element, with bounded look-ahead.

Each element gives its parallel. At an outer corner the tool goes around the corner; at an inner one both parallels are
cut where they cross. An element that the tool cannot reach, because it is shorter than the corner needs, vanishes: the
parallels beside it are cut where they cross. One that is longer than the tool's diameter does not vanish, as something
of the part would be missing. Nothing is handed out before so many elements behind it are known; a place where no
parallels cross, or where the path comes nearer to an element than the radius, is a fault. Overruns of a closed contour
bound nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

from cnc_ptp.nc.radius.corners import around_by_arc, around_by_lines, corner_between, join
from cnc_ptp.nc.radius.entries import Entry
from cnc_ptp.nc.radius.overruns import closing
from cnc_ptp.nc.radius.shapes import Arc, Line, Point, Shape, comes_nearer, intersections, nearest

TOO_NEAR: Final = 1e-6
"""mm: a path that comes nearer to the contour than the radius less this is a fault."""
SHORTEST: Final = 1e-7
"""mm: a shorter piece is none."""


class Element(NamedTuple):
    """An element of the contour, of a block; `by_lines`: the tool gets around an outer corner before it by lines."""

    shape: Shape
    entry: Entry
    by_lines: bool = False


@dataclass(slots=True)
class Piece:
    """A piece of the path.

    shape     as far as it is cut until now
    element   on whose account it is there
    own       the parallel of the element; else it belongs to the corner before it
    open      it does not begin where the piece before it ends: the parallels of an inner corner have not been cut yet
    """

    shape: Shape
    element: Element
    own: bool = True
    open: bool = False


class ArcTooSmall(Exception):
    """The tool does not fit into an arc whose inner side it follows."""


class TooNarrow(Exception):
    """The tool does not fit between two elements; `apart`: how near it would come to the second, None: unknown."""

    def __init__(self, first: Entry, second: Entry, apart: float | None) -> None:
        super().__init__()
        self.first, self.second, self.apart = first, second, apart


class ContourPath:
    """The path along one contour; `left`: distance of the centre to the left of the contour, mm."""

    def __init__(self, left: float, look_ahead: int) -> None:
        self.left, self.look_ahead = left, look_ahead
        self._pieces: list[Piece] = []
        """Not handed out yet."""
        self._elements: list[Element] = []
        """Those that a piece may come too near: of the pieces, and as many before them."""
        self._known = 0
        """Elements of `_elements` that are not handed out yet."""
        self._first: Shape | None = None
        self._gone = 0
        """Elements that are no longer in `_elements`."""
        self._unless_it_ends: TooNarrow | None = None
        """What counts if a further element comes: the contour has closed, so the last one should be an overrun."""

    def add(self, element: Element) -> None:
        """The next element. Raises ArcTooSmall, TooNarrow."""
        if self._unless_it_ends is not None:
            raise self._unless_it_ends
        if self._first is None:
            self._first = element.shape
        parallel = self._parallel(element.shape)
        if self._pieces:
            self._turn_corner(element, parallel)
        else:
            self._pieces.append(Piece(parallel, element))
        self._elements.append(element)
        self._known += 1
        self._close()

    def finished(self, *, all_known: bool) -> Iterator[tuple[Entry, Shape, bool]]:
        """Block and shape of each piece that will not change, own or of a corner; all of them at the end.

        Raises TooNarrow.
        """
        if all_known:
            self._close(at_end=True)
        while self._pieces and (all_known or self._is_certain()):
            piece = self._pieces.pop(0)
            if not self._pieces or self._pieces[0].element is not piece.element:
                self._known -= self._passed(piece.element)
            self._check(piece, all_known=all_known)
            if piece.shape.length > SHORTEST:
                yield piece.element.entry, piece.shape, piece.own
        if all_known:
            self._elements.clear()
            self._known = 0

    @property
    def start(self) -> Point:
        """Where the path begins, as soon as an element is known."""
        return self._pieces[0].shape.start

    def _parallel(self, shape: Shape) -> Shape:
        if isinstance(shape, Arc) and shape.radius - shape.turn * self.left < SMALLEST_RADIUS:
            raise ArcTooSmall
        return shape.parallel(self.left)

    # corners

    def _turn_corner(self, element: Element, parallel: Shape) -> None:
        last = self._pieces[-1]
        corner = corner_between(last.element.shape, element.shape, self.left)
        if corner.is_joined:
            last.shape, parallel = join(last.shape, parallel, corner)
            self._pieces.append(Piece(parallel, element))
        elif corner.turn < 0.0:
            self._pieces.append(Piece(parallel, element, open=True))
        elif element.by_lines:
            last.shape, between, parallel = around_by_lines(last.shape, parallel, corner)
            self._pieces += [Piece(shape, element, own=False) for shape in between]
            self._pieces.append(Piece(parallel, element))
        else:
            self._pieces.append(Piece(around_by_arc(last.shape, corner), element, own=False))
            self._pieces.append(Piece(parallel, element))

    def _close(self, *, at_end: bool = False) -> None:
        """Cuts the parallels of inner corners. Raises TooNarrow for one that cannot be cut with all that is known."""
        while (place := self._first_open()) is not None:
            if self._cut_beside(place):
                continue
            if not at_end and self._elements_behind(place) < self.look_ahead:
                return
            if not self._cut_further(place):
                before, behind = self._pieces[place - 1].element, self._pieces[place].element
                raise TooNarrow(before.entry, behind.entry, None)

    def _first_open(self) -> int | None:
        return next((place for place, piece in enumerate(self._pieces) if piece.open), None)

    def _elements_behind(self, place: int) -> int:
        return sum(piece.own for piece in self._pieces[place:])

    def _cut_beside(self, place: int) -> bool:
        """Whether the two pieces of the corner cross."""
        return self._cut(place - 1, place)

    def _cut_further(self, place: int) -> bool:
        """Whether pieces further away cross, so that those between them vanish; as few as possible."""
        pairs = [(i, j) for i in range(place) for j in range(place, len(self._pieces))]
        pairs.sort(key=lambda pair: (pair[1] - pair[0], -pair[0]))
        return any(self._may_vanish(i, j) and self._cut(i, j) for i, j in pairs[1:])

    def _may_vanish(self, first: int, second: int) -> bool:
        """Whether the elements between two pieces are no longer than the tool's diameter."""
        between = (piece.element.shape for piece in self._pieces[first + 1 : second] if piece.own)
        return all(shape.length <= 2.0 * abs(self.left) for shape in between)

    def _cut(self, first: int, second: int) -> bool:
        """Cuts two pieces where they cross, if the tool fits there; what is between them vanishes."""
        before, behind = self._pieces[first], self._pieces[second]
        if min(before.shape.length, behind.shape.length) <= SHORTEST:
            return False
        found = sorted(intersections(before.shape, behind.shape), key=lambda places: (-places[0], places[1]))
        for end, begin in found:
            point = before.shape.point(end)
            if self._fits(point, first, second):
                before.shape, behind.shape = before.shape.part(0.0, end), behind.shape.part(begin, 1.0)
                behind.open = False
                self._pieces[first + 1 : second] = []
                return True
        return False

    def _fits(self, point: Point, first: int, second: int) -> bool:
        """Whether the tool at this point is clear of the elements of the pieces from one to another."""
        least = abs(self.left) - TOO_NEAR
        return all(piece.element.shape.distance(point) >= least for piece in self._pieces[first : second + 1])

    # what is certain

    def _is_certain(self) -> bool:
        """Whether the first piece will not change: enough elements are known behind it, no corner is open."""
        return self._first_open() is None and self._known > self.look_ahead

    def _passed(self, element: Element) -> int:
        """Elements that are handed out with this one: those that have vanished before it too."""
        unknown = len(self._elements) - self._known
        place = place_of(element, self._elements)
        gone = max(0, place + 1 - self.look_ahead)
        del self._elements[:gone]
        self._gone += gone
        return place + 1 - unknown

    def _check(self, piece: Piece, *, all_known: bool) -> None:
        """Raises TooNarrow for a piece that comes too near to one of the elements that are known."""
        if abs(self.left) - TOO_NEAR <= 0.0 or piece.shape.length <= SHORTEST:
            return
        for element in self._elements:
            if (piece.own and element is piece.element) or not self._too_near(piece.shape, element.shape):
                continue
            fault = TooNarrow(piece.element.entry, element.entry, nearest(piece.shape, element.shape))
            if not self._is_overrun(piece, element):
                raise fault
            if not all_known:
                self._unless_it_ends = fault

    def _too_near(self, shape: Shape, other: Shape) -> bool:
        least = abs(self.left) - TOO_NEAR
        return may_meet(shape, other, least) and comes_nearer(shape, other, least)

    def _is_overrun(self, piece: Piece, element: Element) -> bool:
        """Whether the piece comes near to a part of the element alone that is an overrun of a closed contour."""
        shapes = [each.shape for each in self._elements]
        if self._gone and self._first is not None:
            shapes.insert(0, self._first)
        found = closing(shapes, complete=not self._gone)
        if found is None:
            return False
        before = len(shapes) - len(self._elements)
        owner, other = (place_of(each, self._elements) + before for each in (piece.element, element))
        edge = found.edge(owner, other, shapes)
        return edge is None or not self._too_near(piece.shape, edge)


SMALLEST_RADIUS: Final = 1e-4
"""mm: the path has no arc with a smaller radius (the vendor's position increment)."""


def place_of(element: Element, elements: list[Element]) -> int:
    return next(place for place, each in enumerate(elements) if each is element)


def may_meet(a: Shape, b: Shape, least: float) -> bool:
    """Whether the rectangles around two shapes are nearer to each other than `least`."""
    (left, low, right, high), (other_left, other_low, other_right, other_high) = extent(a), extent(b)
    across = other_left - right < least and left - other_right < least
    return across and other_low - high < least and low - other_high < least


def extent(shape: Shape) -> tuple[float, float, float, float]:
    """Smallest and largest coordinates, of an arc those of its circle."""
    if isinstance(shape, Line):
        (x, y), (u, v) = shape
        return min(x, u), min(y, v), max(x, u), max(y, v)
    (x, y), r = shape.centre, shape.radius
    return x - r, y - r, x + r, y + r
