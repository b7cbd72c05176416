from typing import Optional

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]
_Cells = NDArray[np.int32]

version: str

class InputError(ValueError): ...

class Map:
    def __init__(self, blocked: NDArray[np.bool_], resolution: float, x: float, y: float, y_up: bool) -> None: ...
    @property
    def blocked(self) -> NDArray[np.bool_]: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    @property
    def resolution(self) -> float: ...
    @property
    def origin(self) -> tuple[float, float]: ...
    @property
    def y_up(self) -> bool: ...
    def clearance(self, points: _Array) -> _Array: ...
    def write(self, path: str) -> None: ...

def read_map(path: str) -> Map: ...
def generate_map(kind: str, width: int, height: int, seed: int) -> Map: ...
def random_tasks(map: Map, count: int, radius: float, least_share: float, seed: int) -> tuple[_Array, _Array]: ...

class TreeParameters:
    def __init__(
        self,
        epsilon: float,
        disjointed_trees: int,
        kappa: float,
        failure_factor: float,
        restart_weight: float,
        spacing: float,
        restarts: str,
    ) -> None: ...

class PathPlan:
    def __init__(self, *args: object, **kwargs: object) -> None: ...
    @property
    def paths(self) -> list[_Array]: ...
    @property
    def reasons(self) -> list[str]: ...
    @property
    def solved_after(self) -> list[float]: ...
    @property
    def valid_nodes(self) -> list[int]: ...
    @property
    def invalid_nodes(self) -> list[int]: ...
    @property
    def grafted_trees(self) -> list[int]: ...
    @property
    def disjointed_nodes(self) -> tuple[int, int]: ...
    @property
    def frozen_trees(self) -> int: ...
    @property
    def edges(self) -> tuple[_Array, NDArray[np.int32]]: ...
    @property
    def plan_time(self) -> float: ...
    @property
    def improve_time(self) -> float: ...

def plan(
    map: Map,
    starts: _Array,
    goals: _Array,
    radii: _Array,
    planner: str,
    seed: int,
    timeout: float,
    improve: float,
    trees: TreeParameters,
) -> PathPlan: ...
def plan_trajectories(
    map: Map, starts: _Array, goals: _Array, radii: _Array, speeds: _Array, accelerations: _Array, seed: int
) -> tuple[list[_Array], list[int]]: ...

def plan_on_grid(map: Map, starts: _Cells, goals: _Cells, seed: int) -> Optional[list[_Cells]]: ...
def read_grid_plan(path: str) -> list[_Cells]: ...
def write_grid_plan(path: str, plan: list[_Cells], form: str) -> None: ...

class Scenario:
    def __init__(
        self,
        map: Map,
        names: list[str],
        starts: _Array,
        goals: _Array,
        radii: _Array,
        speeds: _Array,
        accelerations: _Array,
        tolerance: float,
        seed: int,
    ) -> None: ...
    @property
    def map(self) -> Map: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def starts(self) -> _Array: ...
    @property
    def goals(self) -> _Array: ...
    @property
    def radius(self) -> _Array: ...
    @property
    def max_speed(self) -> _Array: ...
    @property
    def max_acceleration(self) -> _Array: ...
    @property
    def goal_tolerance(self) -> _Array: ...
    @property
    def seed(self) -> int: ...

def read_scenario(
    path: str, robots: Optional[int], radius: Optional[float], max_speed: Optional[float], seed: Optional[int]
) -> Scenario: ...
def make_scenario(kind: str, robots: int, seed: int) -> Scenario: ...

class Faults:
    def __init__(
        self,
        loss: float,
        delay: float,
        jitter: float,
        duplicate: float,
        reorder: bool,
        partitions: list[tuple[float, float]],
        kill_rate: float,
        kills: list[tuple[str, float]],
        restart_after: float,
        pause_rate: float,
        pause: float,
        clock_skew: float,
    ) -> None: ...

def simulate(
    scenario: Scenario,
    faults: Faults,
    timeout: float,
    planner: str,
    plan_budget: float,
    lifelong: float,
    trees: TreeParameters,
    forest: str,
    plan: Optional[list[_Cells]],
    coordination: str,
    rounds: bool,
) -> tuple[str, list[_Array], list[str]]: ...
