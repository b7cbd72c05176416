"""Plans and simulates fleets of robots.

A map in, paths out:

>>> import coppice
>>> map = coppice.Map.generate("room", 256, 256, seed=1)
>>> starts, goals = coppice.random_tasks(map, 5, radius=4, seed=1)
>>> plan = coppice.plan(map, starts, goals, radius=4)
>>> [path.shape[1] for path in plan.paths]
[2, 2, 2, 2, 2]

A fleet that drives, under faults:

>>> scenario = coppice.Scenario(map, starts, goals, radius=4, max_speed=10)
>>> run = coppice.simulate(scenario, faults=coppice.Faults(loss=0.1, delay=0.05))
>>> run.arrived, run.report.collisions
(True, 0)

Positions are in metres in the map frame, times in seconds. Points are rows of arrays of shape (n, 2).
"""

from ._core import InputError, version as __version__
from .grid_plans import plan_on_grid, read_grid_plan, write_grid_plan
from .maps import Map, random_tasks
from .planning import Plan, TimedPlan, TreeParameters, plan, plan_trajectories
from .report import Load, Report, RobotReport, Waits
from .simulation import Faults, Scenario, SimulatedRun, read_trajectories, simulate

InputError.__module__ = __name__

__all__ = [
    "Faults",
    "InputError",
    "Load",
    "Map",
    "Plan",
    "Report",
    "RobotReport",
    "Scenario",
    "SimulatedRun",
    "TimedPlan",
    "TreeParameters",
    "Waits",
    "__version__",
    "plan",
    "plan_on_grid",
    "plan_trajectories",
    "random_tasks",
    "read_grid_plan",
    "read_trajectories",
    "simulate",
    "write_grid_plan",
]
