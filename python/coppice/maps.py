"""Maps, and random tasks on them."""

from __future__ import annotations

import os
from typing import Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import Array, points


class Map:
    """A grid of square cells, each blocked or free.

    `Map(array)` takes a boolean array of shape (height, width); True: blocked. Cell [j, i] covers the square from
    origin + (i, j) * resolution to origin + (i + 1, j + 1) * resolution.

    `Map(path)` reads a file: Moving AI `.map`, or ROS map_server `.yaml`.

    Parameters
    ----------
    source: the array or the path
    resolution: metres a cell; for an array only
    origin: lower corner of cell [0, 0], metres; for an array only
    y_up: whether y grows upwards in a picture; for an array only

    >>> import numpy as np
    >>> blocked = np.zeros((3, 4), dtype=bool)
    >>> blocked[1, 2] = True
    >>> map = Map(blocked, resolution=0.5)
    >>> map.bounds
    ((0.0, 0.0), (2.0, 1.5))
    >>> map.clearance([(0.5, 0.5), (1.25, 0.75)]).tolist()
    [0.5, 0.0]
    """

    _held: _core.Map

    def __init__(
        self,
        source: Union[ArrayLike, str, "os.PathLike[str]"],
        *,
        resolution: float = 1.0,
        origin: tuple[float, float] = (0.0, 0.0),
        y_up: bool = False,
    ) -> None:
        if isinstance(source, (str, os.PathLike)):
            self._held = _core.read_map(os.fspath(source))
            return
        cells = np.asarray(source)
        if cells.ndim != 2 or cells.size == 0 or cells.dtype != np.bool_:
            raise _core.InputError(
                f"source: expected a boolean array of shape (height, width), found {cells.dtype} of shape {cells.shape}"
            )
        self._held = _core.Map(cells, resolution, origin[0], origin[1], y_up)

    @classmethod
    def _of(cls, core: _core.Map) -> "Map":
        self = cls.__new__(cls)
        self._held = core
        return self

    @classmethod
    def generate(cls, kind: str, width: int, height: int, *, seed: int = 1) -> "Map":
        """A random map with cells of 1 m. `kind`: blank, dense, maze or room."""
        return cls._of(_core.generate_map(kind, width, height, seed))

    @property
    def blocked(self) -> NDArray[np.bool_]:
        """A copy of the cells, shape (height, width); True: blocked."""
        return self._held.blocked

    @property
    def resolution(self) -> float:
        """Metres a cell."""
        return self._held.resolution

    @property
    def origin(self) -> tuple[float, float]:
        """Lower corner of cell [0, 0], metres."""
        return self._held.origin

    @property
    def y_up(self) -> bool:
        """Whether y grows upwards in a picture of the map."""
        return self._held.y_up

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The lower and the upper corner of the grid, metres."""
        (x, y), (height, width) = self.origin, self._held.shape
        return (x, y), (x + width * self.resolution, y + height * self.resolution)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """The bounds as matplotlib's imshow takes them, with origin="lower": left, right, bottom, top."""
        (left, bottom), (right, top) = self.bounds
        return left, right, bottom, top

    def clearance(self, at: ArrayLike) -> Array:
        """The distance from each point to the nearest obstacle, metres; exact. 0 inside of obstacles and outside."""
        return self._held.clearance(points("at", at))

    def write(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a Moving AI `.map`, which holds the cells alone."""
        self._held.write(os.fspath(path))

    def __repr__(self) -> str:
        height, width = self._held.shape
        return f"<coppice.Map of {width} x {height} cells of {self.resolution} m>"


def random_tasks(
    map: Map, robots: int, *, radius: float, least_share: float = 0.2, seed: int = 1
) -> tuple[Array, Array]:
    """Random starts and goals, two arrays of shape (robots, 2).

    All lie in the largest part of the map that a disc of `radius` can reach. Starts keep apart from each other, and so
    do goals. Each goal is at least `least_share` of that part's diagonal from its start, or less if there are too many
    robots for that.
    """
    return _core.random_tasks(map._held, robots, radius, least_share, seed)
