"""Paths and trajectories for many robots at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import Array, of_each, starts_and_goals
from .maps import Map

_RADIUS_CELLS = 5.0
_SPEED_CELLS = 20.0


@dataclass(frozen=True)
class TreeParameters:
    """What the paper leaves open in MA-RRdT*."""

    epsilon: float = 0.0
    """Metres: the longest step, and the largest distance over which trees meet. 0: it follows from the map."""
    disjointed_trees: int = 0
    """Number of disjointed trees that grow at a time. 0: it follows from the map and epsilon."""
    kappa: float = 2.0
    """Concentration of samples around the last success, from 0 (none) to 100."""
    failure_factor: float = 0.7
    """A failed sample multiplies the weight of its tree, 10 at first, by this factor."""
    restart_weight: float = 0.1
    """A tree of a smaller weight restarts."""
    spacing: float = 0.25
    """In units of epsilon, from 0 to 1. A node this close to others of its kind teaches little."""
    restarts: str = "even"
    """At even or random points."""

    def _core(self) -> _core.TreeParameters:
        return _core.TreeParameters(
            self.epsilon,
            self.disjointed_trees,
            self.kappa,
            self.failure_factor,
            self.restart_weight,
            self.spacing,
            self.restarts,
        )


@dataclass(frozen=True)
class Plan:
    """The paths of a fleet, and what they cost. Lists are in the order of the robots."""

    paths: list[Array]
    """Arrays of shape (n, 2), from start to goal; shape (0, 2): no path."""
    reasons: list[str]
    """Why there is no path; empty if there is one."""
    plan_time: float
    """Seconds until all first paths."""
    improve_time: float
    """Seconds after that, for shorter paths."""
    solved_after: list[float]
    """Seconds until each first path."""
    valid_nodes: list[int]
    """Nodes of each robot's two root trees."""
    invalid_nodes: list[int]
    """Samples of each robot that hit an obstacle."""
    grafted_trees: list[int]
    """Disjointed trees that each robot grafted onto its root trees."""
    disjointed_nodes: tuple[int, int]
    """Valid nodes and invalid samples of the disjointed trees."""
    frozen_trees: int
    """Disjointed trees that became inactive."""
    edges: Array
    """Edges of all trees, shape (m, 4): x and y of one end, x and y of the other."""
    edge_robots: NDArray[np.int32]
    """For each edge the robot whose root tree it belongs to; -1: a disjointed tree."""

    @property
    def solved(self) -> bool:
        """Whether each robot has a path."""
        return all(len(path) > 0 for path in self.paths)

    @property
    def lengths(self) -> Array:
        """The length of each path, metres; nan: no path."""
        return np.array(
            [np.linalg.norm(np.diff(path, axis=0), axis=1).sum() if len(path) > 0 else np.nan for path in self.paths]
        )


def plan(
    map: Map,
    starts: ArrayLike,
    goals: ArrayLike,
    *,
    radius: Optional[ArrayLike] = None,
    planner: str = "ma-rrdt",
    seed: int = 1,
    timeout: float = float("inf"),
    improve: float = float("inf"),
    trees: TreeParameters = TreeParameters(),
) -> Plan:
    """Plans a path for each robot past the map's obstacles. The paths of two robots may cross.

    Parameters
    ----------
    starts, goals: shape (n, 2)
    radius: metres, of all robots or of each; default: 5 cells
    planner: ma-rrdt (all robots share disjointed trees), rrdt (each robot has its own), or rrt-star
    seed: the same seed gives the same paths, if no time limit ends the search
    timeout: seconds after which robots without a path get none
    improve: seconds for shorter paths after all first paths; by default until no shorter one turns up
    trees: what the paper leaves open; rrt-star uses epsilon alone

    Raises
    ------
    InputError: names the argument, the robot, and what was expected

    >>> import numpy as np
    >>> map = Map(np.zeros((20, 30), dtype=bool))
    >>> plan(map, [(2, 2)], [(28, 18)], radius=1).paths[0].tolist()
    [[2.0, 2.0], [28.0, 18.0]]
    >>> plan(map, [(2, 2)], [(28, 19.5)], radius=1)
    Traceback (most recent call last):
    ...
    coppice.InputError: goals[0]: (28, 19.5) is inside of an obstacle or too near to one: clearance 0.5, radius 1
    """
    first, last = starts_and_goals(starts, goals)
    radii = of_each("radius", radius, _RADIUS_CELLS * map.resolution, len(first))
    found = _core.plan(map._held, first, last, radii, planner, seed, timeout, improve, trees._core())
    edges, robots = found.edges
    return Plan(
        paths=found.paths,
        reasons=found.reasons,
        plan_time=found.plan_time,
        improve_time=found.improve_time,
        solved_after=found.solved_after,
        valid_nodes=found.valid_nodes,
        invalid_nodes=found.invalid_nodes,
        grafted_trees=found.grafted_trees,
        disjointed_nodes=found.disjointed_nodes,
        frozen_trees=found.frozen_trees,
        edges=edges,
        edge_robots=robots,
    )


@dataclass(frozen=True)
class TimedPlan:
    """Trajectories on which no two robots touch. Lists are in the order of the robots."""

    trajectories: list[Array]
    """Arrays of shape (n, 3): time, x, y. Straight at constant speed from row to row; after the last row the robot stands."""
    stranded: list[int]
    """Robots that do not reach their goals."""

    @property
    def arrivals(self) -> Array:
        """When each robot stands at its end, seconds."""
        return np.array([trajectory[-1, 0] for trajectory in self.trajectories])


def plan_trajectories(
    map: Map,
    starts: ArrayLike,
    goals: ArrayLike,
    *,
    radius: Optional[ArrayLike] = None,
    max_speed: Optional[ArrayLike] = None,
    max_acceleration: Optional[ArrayLike] = None,
    seed: int = 1,
) -> TimedPlan:
    """Plans trajectories for all robots at once, centrally, so that no two touch.

    Parameters
    ----------
    starts, goals: shape (n, 2)
    radius: metres, of all robots or of each; default: 5 cells
    max_speed: metres per second; default: 20 cells per second
    max_acceleration: metres per second squared; default: full speed within half a second

    Raises
    ------
    InputError: names the argument, the robot, and what was expected

    >>> import numpy as np
    >>> map = Map(np.zeros((20, 30), dtype=bool))
    >>> swap = plan_trajectories(map, [(4, 10), (26, 10)], [(26, 10), (4, 10)], radius=2, max_speed=5)
    >>> swap.stranded, bool(max(swap.arrivals) < 10)
    ([], True)
    """
    first, last = starts_and_goals(starts, goals)
    radii = of_each("radius", radius, _RADIUS_CELLS * map.resolution, len(first))
    speeds = of_each("max_speed", max_speed, _SPEED_CELLS * map.resolution, len(first))
    accelerations = of_each("max_acceleration", max_acceleration, 2 * speeds, len(first))
    return TimedPlan(*_core.plan_trajectories(map._held, first, last, radii, speeds, accelerations, seed))
