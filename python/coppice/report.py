"""The report of a run, as `coppice run --report` and `coppice simulate --report` write it."""

from __future__ import annotations

import dataclasses
import json
import os
import types
from dataclasses import dataclass
from typing import Any, Optional, Union, get_args, get_origin, get_type_hints

import numpy as np

from ._arguments import Array
from ._core import InputError


def _value(kind: Any, value: Any) -> Any:
    if get_origin(kind) in (Union, types.UnionType):
        kind = next(one for one in get_args(kind) if one is not type(None))
    if get_origin(kind) is list:
        return [_value(get_args(kind)[0], one) for one in value]
    if dataclasses.is_dataclass(kind):
        return _made(kind, value)
    if kind is Array:  # a list of positions
        return np.array([(p["x"], p["y"]) for p in value], dtype=np.float64).reshape(-1, 2)
    return float(value) if kind is float else value  # Protobuf writes 64-bit integers and NaN as strings


def _made(kind: Any, fields: dict[str, Any]) -> Any:
    hints = get_type_hints(kind)
    unknown = fields.keys() - hints.keys()
    if unknown:
        raise InputError(f"report: unknown field {sorted(unknown)[0]}")
    return kind(**{name: _value(hints[name], value) for name, value in fields.items()})


@dataclass(frozen=True)
class Load:
    """The load of an agent's process since it began."""

    samples_received: int = 0
    """Of all topics."""
    states_received: int = 0
    """Among these, states of other robots, copies included."""
    periods: int = 0
    """Control periods."""
    periods_missed: int = 0
    """Control periods that ended before the agent decided for them."""
    agents_matched: int = 0
    """Agents that it met."""
    matched_at: float = 0.0
    """When it met the last one, seconds since the Unix epoch."""
    bytes_sent: int = 0
    """In UDP datagrams."""
    bytes_received: int = 0
    """In UDP datagrams."""
    state_age_p50: float = 0.0
    """Median age at use of a state of a robot that might be touched soon, seconds."""
    state_age_p99: float = 0.0
    """The same, 99th percentile."""
    state_age_max: float = 0.0
    """The same, largest."""
    processor_seconds: float = 0.0
    """Processor time."""


@dataclass(frozen=True)
class Waits:
    """Seconds for which a robot was slower than a tenth of its maximum speed, by cause."""

    startup: float = 0.0
    """The missions of all robots, and to hear where all are."""
    planning: float = 0.0
    """Its first path."""
    joint_plan: float = 0.0
    """A joint plan, or others to finish theirs."""
    gate: float = 0.0
    """A robot that goes first by the reservations or the joint plan."""
    promise: float = 0.0
    """Other robots might have come where it wanted to go."""
    connection: float = 0.0
    """It was cut off, or its agent was restarted."""
    odometry: float = 0.0
    """Odometry, or its robot to come to where it should be."""
    reservation: float = 0.0
    """Its turn to reserve, or room in space and time."""


@dataclass(frozen=True)
class RobotReport:
    """What happened to one robot."""

    name: str
    """Of the robot."""
    planned: bool = False
    """It has a path."""
    arrived: bool = False
    """It stands at its goal."""
    reason: str = ""
    """Why it did not arrive, or why it got no new goal."""
    plan_time: float = 0.0
    """Seconds from its mission to its path."""
    run_time: float = 0.0
    """Seconds from the start of the run until it stood at its goal."""
    yaw: Optional[float] = None
    """Radians, where it stands in the end. None: it is holonomic."""
    path_length: float = 0.0
    """Metres."""
    driven_length: float = 0.0
    """Metres."""
    points_missing: int = 0
    """Points of its track that never came, or too late to be counted."""
    path: Array = dataclasses.field(default_factory=lambda: np.empty((0, 2)))
    """Shape (n, 2), metres."""
    nodes_valid: int = 0
    """Nodes of its two root trees."""
    nodes_invalid: int = 0
    """Its samples that hit an obstacle."""
    grafted_trees: int = 0
    """Trees that it grafted onto its root trees."""
    load: Optional[Load] = None
    """None: its agent was never heard."""
    periods_missed: float = 0.0
    """Share of its control periods that it missed for lack of processor time."""
    free_flow_time: float = 0.0
    """Seconds for its path with nobody in its way."""
    waited: float = 0.0
    """Sum of `waits`, seconds."""
    waits: Optional[Waits] = None
    """In its last mission."""
    missions: int = 0
    """Goals that it has reached."""


@dataclass(frozen=True)
class Report:
    """What happened in a run."""

    outcome: str
    """arrived, incomplete, interrupted or timeout; planned, of `coppice plan`."""
    plan_time: float = 0.0
    """Seconds until the last path was found."""
    run_time: float = 0.0
    """Seconds until the last robot stood at its goal."""
    path_length: float = 0.0
    """Metres, mean over the robots with a path."""
    nodes_valid: int = 0
    """Nodes of all trees."""
    nodes_invalid: int = 0
    """Samples that hit an obstacle."""
    collisions: int = 0
    """Pairs of robots that overlapped, plus robots that overlapped an obstacle."""
    least_separation: Optional[float] = None
    """Metres, over time and pairs: distance minus both radii. None: there is one robot."""
    least_clearance: Optional[float] = None
    """Metres, over time and robots: distance to obstacles minus the radius."""
    margin: float = 0.0
    """Metres that robots keep from obstacles beyond their radius, and from each other where there is room."""
    least_separation_with_margin: Optional[float] = None
    """`least_separation` minus the margin."""
    least_clearance_with_margin: Optional[float] = None
    """`least_clearance` minus the margin."""
    trees_published: int = 0
    """Trees that the broker gave to all."""
    trees_grafted: int = 0
    """Sum of the robots' grafted trees."""
    improve_time: float = 0.0
    """Seconds after plan_time, for shorter paths."""
    seed: int = 0
    """Of every random choice."""
    map: str = ""
    """The map's name."""
    robots: list[RobotReport] = dataclasses.field(default_factory=list)
    """In the scenario's order."""
    missions: int = 0
    """Goals that all robots together have reached."""
    last_path_at: float = 0.0
    """When the last robot found its first path, seconds since the Unix epoch."""
    robots_without_goal: int = 0
    """Robots that arrived, were to get a new goal, and got none."""
    periods_missed: float = 0.0
    """Share of all robots' control periods that were missed for lack of processor time."""
    goals_refused: int = 0
    """Goals over ROS that were refused."""

    @classmethod
    def from_json(cls, text: str) -> "Report":
        """Makes a report from its JSON text. Raises InputError if it is none."""
        try:
            fields = json.loads(text)
        except json.JSONDecodeError as problem:
            raise InputError(f"report: {problem}") from problem
        if not isinstance(fields, dict) or "outcome" not in fields:
            raise InputError("report: expected an object with the field outcome")
        report: Report = _made(cls, fields)
        return report

    @classmethod
    def read(cls, path: Union[str, "os.PathLike[str]"]) -> "Report":
        """Reads the file that `--report` wrote."""
        with open(path, encoding="utf-8") as file:
            return cls.from_json(file.read())
