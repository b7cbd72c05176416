"""Joint plans on the cells of a map (multi-agent path finding, MAPF).

In each time step a robot goes to one of the four neighbouring cells, or waits. Cells are rows (x, y), counted from 0.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .maps import Map

Cells = NDArray[np.int32]


def _cells(name: str, value: ArrayLike) -> Cells:
    """An array of shape (n, 2)."""
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != 2 or not np.issubdtype(array.dtype, np.integer):
        raise _core.InputError(f"{name}: expected whole numbers in an array of shape (n, 2)")
    return array.astype(np.int32)


def _cells_of_robots(plan: Sequence[ArrayLike]) -> list[Cells]:
    return [_cells(f"plan[{robot}]", cells) for robot, cells in enumerate(plan)]


def plan_on_grid(map: Map, starts: ArrayLike, goals: ArrayLike, *, seed: int = 1) -> Optional[list[Cells]]:
    """Plans the moves of all robots together, by LaCAM. The plan is not optimal.

    Parameters
    ----------
    starts, goals: cells, shape (n, 2)

    Returns
    -------
    For each robot its cells, shape (steps, 2). None: no plan was found.

    Raises
    ------
    InputError: names the robot, and what was expected

    >>> import numpy as np
    >>> map = Map(np.zeros((2, 3), dtype=bool))
    >>> [cells[-1].tolist() for cells in plan_on_grid(map, [(0, 0), (2, 0)], [(2, 0), (0, 0)])]
    [[2, 0], [0, 0]]
    """
    first, last = _cells("starts", starts), _cells("goals", goals)
    if len(first) != len(last):
        raise _core.InputError(f"goals: expected {len(first)} rows, as many as starts, found {len(last)}")
    return _core.plan_on_grid(map._held, first, last, seed)


def read_grid_plan(path: Union[str, "os.PathLike[str]"]) -> list[Cells]:
    """Reads what LaCAM, PIBT, CBS, EECBS or MAPF-LNS wrote: for each robot its cells, shape (steps, 2).

    Raises
    ------
    InputError: names the file, the line, and what was expected
    """
    return _core.read_grid_plan(os.fspath(path))


def write_grid_plan(path: Union[str, "os.PathLike[str]"], plan: Sequence[ArrayLike], *, form: str = "steps") -> None:
    """Writes a plan. `form`: "steps" as LaCAM and PIBT do, or "agents" as CBS, EECBS and MAPF-LNS do."""
    _core.write_grid_plan(os.fspath(path), _cells_of_robots(plan), form)
