"""Scenarios, and simulated fleets that drive them."""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arguments import Array, of_each, starts_and_goals
from .grid_plans import _cells_of_robots
from .maps import Map
from .planning import _RADIUS_CELLS, _SPEED_CELLS, TreeParameters
from .report import Report


class Scenario:
    """The input of a run: a map, and a task for each robot.

    `Scenario(map, starts, goals)` makes one. `Scenario.read(path)` reads a file, `Scenario.generate(kind, robots)` makes
    one of the scenarios on which robots that only avoid each other block each other.

    Parameters
    ----------
    starts, goals: shape (n, 2)
    radius: metres, of all robots or of each; default: 5 cells
    max_speed: metres per second; default: 20 cells per second
    max_acceleration: metres per second squared; default: full speed within half a second
    goal_tolerance: metres from its goal at which a robot has arrived; default: one cell
    names: default: r1, r2, ...
    seed: of everything random in the run

    Raises
    ------
    InputError: names the robot, the field, and what was expected
    """

    _held: _core.Scenario
    _map: Optional[Map]

    def __init__(
        self,
        map: Map,
        starts: ArrayLike,
        goals: ArrayLike,
        *,
        radius: Optional[ArrayLike] = None,
        max_speed: Optional[ArrayLike] = None,
        max_acceleration: Optional[ArrayLike] = None,
        goal_tolerance: Optional[float] = None,
        names: Optional[Sequence[str]] = None,
        seed: int = 1,
    ) -> None:
        self._map = map
        first, last = starts_and_goals(starts, goals)
        robots = len(first)
        called = [f"r{k + 1}" for k in range(robots)] if names is None else list(names)
        if len(called) != robots:
            raise _core.InputError(f"names: expected {robots}, as many as starts, found {len(called)}")
        speeds = of_each("max_speed", max_speed, _SPEED_CELLS * map.resolution, robots)
        self._held = _core.Scenario(
            map._held,
            called,
            first,
            last,
            of_each("radius", radius, _RADIUS_CELLS * map.resolution, robots),
            speeds,
            of_each("max_acceleration", max_acceleration, 2 * speeds, robots),
            map.resolution if goal_tolerance is None else goal_tolerance,
            seed,
        )

    @classmethod
    def _of(cls, core: _core.Scenario) -> "Scenario":
        self = cls.__new__(cls)
        self._held = core
        self._map = None
        return self

    @classmethod
    def read(
        cls,
        path: Union[str, "os.PathLike[str]"],
        *,
        robots: Optional[int] = None,
        radius: Optional[float] = None,
        max_speed: Optional[float] = None,
        seed: Optional[int] = None,
    ) -> "Scenario":
        """Reads Coppice's JSON or a Moving AI `.scen`, and the map that it names. Other arguments override the file."""
        return cls._of(_core.read_scenario(os.fspath(path), robots, radius, max_speed, seed))

    @classmethod
    def generate(cls, kind: str, robots: int, *, seed: int = 1) -> "Scenario":
        """A scenario of a kind, such as circle, rooms, corridor-40 or warehouse (`coppice map --help` lists all).

        >>> Scenario.generate("circle", 3).names
        ['r1', 'r2', 'r3']
        """
        return cls._of(_core.make_scenario(kind, robots, seed))

    @property
    def map(self) -> Map:
        """The map."""
        if self._map is None:
            self._map = Map._of(self._held.map)
        return self._map

    @property
    def names(self) -> list[str]:
        """The robots' names."""
        return self._held.names

    @property
    def starts(self) -> Array:
        """Shape (n, 2), metres."""
        return self._held.starts

    @property
    def goals(self) -> Array:
        """Shape (n, 2), metres."""
        return self._held.goals

    @property
    def radius(self) -> Array:
        """Shape (n,), metres."""
        return self._held.radius

    @property
    def max_speed(self) -> Array:
        """Shape (n,), metres per second."""
        return self._held.max_speed

    @property
    def max_acceleration(self) -> Array:
        """Shape (n,), metres per second squared."""
        return self._held.max_acceleration

    @property
    def goal_tolerance(self) -> Array:
        """Shape (n,), metres."""
        return self._held.goal_tolerance

    @property
    def seed(self) -> int:
        """Of everything random in the run."""
        return self._held.seed

    def __repr__(self) -> str:
        return f"<coppice.Scenario of {len(self.names)} robots on {self.map!r}>"


@dataclass(frozen=True)
class Faults:
    """The faults that a simulated run is to suffer. They are drawn from the scenario's seed."""

    loss: float = 0.0
    """Share of lost samples; reliable ones are sent again."""
    delay: float = 0.0
    """Seconds that each sample takes in addition."""
    jitter: float = 0.0
    """Seconds by which the delay may be longer or shorter."""
    duplicate: float = 0.0
    """Share of the samples that arrive twice."""
    reorder: bool = False
    """Whether samples of one sender may overtake each other."""
    partitions: Sequence[tuple[float, float]] = ()
    """Intervals (from, until) in which the network is split in two, seconds."""
    kill_rate: float = 0.0
    """Agents killed, per robot and hour."""
    kills: Sequence[tuple[str, float]] = ()
    """Agents to kill (robot, time), seconds."""
    restart_after: float = float("inf")
    """Seconds after which a killed agent is restarted; inf: never."""
    pause_rate: float = 0.0
    """Pauses of agents, per robot and hour."""
    pause: float = 1.0
    """Duration of a pause, seconds."""
    clock_skew: float = 0.0
    """Greatest error of an agent's clock, seconds."""


@dataclass(frozen=True)
class SimulatedRun:
    """What happened in a simulated run."""

    report: Report
    """The figures of `coppice simulate --report`."""
    trajectories: dict[str, Array]
    """Where each robot's body was: shape (n, 7), a row for each control period.

    Time, x, y, velocity x, velocity y, yaw (radians), angular velocity; the last two of differential robots.
    """
    broken: list[str]
    """A line for each broken promise: robots that touched, left their limits, or jumped. Empty in every run."""

    @property
    def arrived(self) -> bool:
        """Whether each robot stands at its goal."""
        return self.report.outcome == "arrived"


def simulate(
    scenario: Union[Scenario, str, "os.PathLike[str]"],
    *,
    faults: Faults = Faults(),
    timeout: float = 3600.0,
    planner: str = "ma-rrdt",
    plan_budget: float = 1.0,
    lifelong: float = 0.0,
    trees: TreeParameters = TreeParameters(),
    forest: str = "ahead",
    plan: Optional[Sequence[ArrayLike]] = None,
    coordination: str = "reservations",
    rounds: bool = True,
) -> SimulatedRun:
    """Simulates service, broker and agents on a virtual clock. The same arguments give the same run, bit for bit.

    Parameters
    ----------
    scenario: a Scenario, or the path of its file
    timeout: seconds after which the run ends
    planner: ma-rrdt, rrdt or rrt-star
    plan_budget: seconds for shorter paths, of virtual time
    lifelong: seconds in which robots that arrive get new goals
    trees: what the paper leaves open
    forest: ahead (disjointed trees cover the map before missions go out), or together (they grow with the root trees)
    plan: a joint plan on the cells, as of `plan_on_grid`, that the fleet is to drive; each robot then starts and ends in
        the middle of a cell
    coordination: reservations (robots reserve trajectories around each other), or rvo (they set off along their paths, and
        avoid each other by reciprocal velocity obstacles)
    rounds: with coordination rvo, whether robots that get stuck make joint plans

    Raises
    ------
    InputError: names the field, and what was expected
    """
    which = scenario if isinstance(scenario, Scenario) else Scenario.read(scenario)
    suffered = _core.Faults(
        faults.loss,
        faults.delay,
        faults.jitter,
        faults.duplicate,
        faults.reorder,
        list(faults.partitions),
        faults.kill_rate,
        list(faults.kills),
        faults.restart_after,
        faults.pause_rate,
        faults.pause,
        faults.clock_skew,
    )
    report, tracks, broken = _core.simulate(
        which._held,
        suffered,
        timeout,
        planner,
        plan_budget,
        lifelong,
        trees._core(),
        forest,
        None if plan is None else _cells_of_robots(plan),
        coordination,
        rounds,
    )
    return SimulatedRun(Report.from_json(report), dict(zip(which.names, tracks)), broken)


_COLUMNS = ["time", "robot", "x", "y", "vx", "vy", "yaw", "omega"]


def read_trajectories(path: Union[str, "os.PathLike[str]"]) -> dict[str, Array]:
    """Reads the file that `--trajectory` wrote: for each robot the rows that SimulatedRun.trajectories has.

    Raises
    ------
    InputError: names the file, the line, and what was expected
    """
    rows: dict[str, list[list[float]]] = {}
    with open(path, encoding="utf-8", newline="") as file:
        lines = csv.reader(file)
        if next(lines, None) != _COLUMNS:
            raise _core.InputError(f"{os.fspath(path)}:1: expected {','.join(_COLUMNS)}")
        for fields in lines:
            try:
                time, robot, *motion = fields
                row = [float(time), *map(float, motion)]
                if len(row) != 7:
                    raise ValueError
            except ValueError as problem:
                expected = "expected a time, a robot and six numbers"
                raise _core.InputError(f"{os.fspath(path)}:{lines.line_num}: {expected}") from problem
            rows.setdefault(robot, []).append(row)
    return {robot: np.array(of_robot) for robot, of_robot in rows.items()}
