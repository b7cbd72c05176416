"""Tests of the Python package: python3 -m unittest discover tests/python, with the package on PYTHONPATH."""

import dataclasses
import doctest
import inspect
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import coppice
import coppice.grid_plans
import coppice.maps
import coppice.planning
import coppice.report
import coppice.simulation

SOURCES = pathlib.Path(__file__).resolve().parents[2]
MODULES = [coppice, coppice.grid_plans, coppice.maps, coppice.planning, coppice.report, coppice.simulation]


def empty_map(width=30, height=20):
    return coppice.Map(np.zeros((height, width), dtype=bool))


class Docs(unittest.TestCase):
    def test_the_examples_in_docstrings_give_what_they_say(self):
        attempted = 0
        for module in MODULES:
            result = doctest.testmod(module)
            self.assertEqual(result.failed, 0, module.__name__)
            attempted += result.attempted
        self.assertGreater(attempted, 15)

    def test_each_public_name_has_a_docstring(self):
        for name in set(coppice.__all__) - {"__version__"}:
            value = getattr(coppice, name)
            self.assertTrue(inspect.getdoc(value), name)
            for member, part in vars(value).items() if inspect.isclass(value) else ():
                if not member.startswith("_") and (callable(part) or isinstance(part, property)):
                    self.assertTrue(inspect.getdoc(part), f"{name}.{member}")

    def test_each_field_of_a_dataclass_has_a_docstring(self):
        for kind in (getattr(coppice, name) for name in coppice.__all__):
            if not dataclasses.is_dataclass(kind):
                continue
            source = inspect.getsource(kind)
            for field in dataclasses.fields(kind):
                self.assertRegex(source, rf'\n    {field.name}: .*\n    """', f"{kind.__name__}.{field.name}")

    def test_reports_have_the_fields_of_the_schema(self):
        schema = (SOURCES / "idl/report.proto").read_text()
        schema = re.sub(r"//.*", "", schema)
        for message, kind in {
            "Load": coppice.Load,
            "Waits": coppice.Waits,
            "Robot": coppice.RobotReport,
        }.items():
            body = re.search(rf"message {message} {{(.*?)\n  }}", schema, re.S).group(1)
            names = set(re.findall(r"(\w+) = \d+;", body))
            self.assertEqual(names, {field.name for field in dataclasses.fields(kind)}, message)
        outer = re.sub(r"message \w+ {[^{}]*}", "", schema[schema.index("message Report {") + 16 :])
        names = set(re.findall(r"(\w+) = \d+;", outer))
        self.assertEqual(names, {field.name for field in dataclasses.fields(coppice.Report)})


class Maps(unittest.TestCase):
    def test_an_array_is_given_back(self):
        blocked = np.random.default_rng(1).random((7, 11)) < 0.4
        map = coppice.Map(blocked, resolution=0.5, origin=(3, -2), y_up=True)
        np.testing.assert_array_equal(map.blocked, blocked)
        self.assertEqual((map.resolution, map.origin, map.y_up), (0.5, (3, -2), True))
        self.assertEqual(map.bounds, ((3, -2), (8.5, 1.5)))

    def test_arrays_of_any_layout_are_read(self):
        blocked = np.random.default_rng(2).random((14, 22)) < 0.4
        for view in (blocked[::2, ::2], np.asfortranarray(blocked), blocked.T, blocked[::-1]):
            np.testing.assert_array_equal(coppice.Map(view).blocked, view)

    def test_a_file_holds_the_same_cells(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.map"
            map = coppice.Map.generate("maze", 128, 100, seed=3)
            map.write(path)
            np.testing.assert_array_equal(coppice.Map(path).blocked, map.blocked)
            np.testing.assert_array_equal(coppice.Map(str(path)).blocked, map.blocked)

    def test_clearance_is_the_distance_to_the_nearest_blocked_cell(self):
        blocked = np.zeros((9, 9), dtype=bool)
        blocked[4, 4] = True
        map = coppice.Map(blocked)
        np.testing.assert_allclose(map.clearance([(2, 4.5), (4.5, 4.5), (1, 1), (20, 1)]), [2, 0, 1, 0])


class Planning(unittest.TestCase):
    def test_paths_keep_clear_and_lead_from_start_to_goal(self):
        map = coppice.Map.generate("room", 256, 256, seed=2)
        starts, goals = coppice.random_tasks(map, 12, radius=4, seed=2)
        for planner in ("ma-rrdt", "rrdt", "rrt-star"):
            plan = coppice.plan(map, starts, goals, radius=4, planner=planner)
            self.assertTrue(plan.solved, plan.reasons)
            for path, start, goal, length in zip(plan.paths, starts, goals, plan.lengths):
                np.testing.assert_array_equal(path[[0, -1]], [start, goal])
                dense = np.concatenate([np.linspace(a, b, 50) for a, b in zip(path, path[1:])])
                self.assertGreaterEqual(map.clearance(dense).min(), 4 - 1e-9)
                self.assertGreaterEqual(length, np.linalg.norm(goal - start) - 1e-9)

    def test_the_same_seed_gives_the_same_paths(self):
        map = coppice.Map.generate("dense", 256, 256, seed=1)
        starts, goals = coppice.random_tasks(map, 5, radius=4)
        plans = [coppice.plan(map, starts, goals, radius=4, seed=seed) for seed in (7, 7)]
        for one, other in zip(plans[0].paths, plans[1].paths):
            np.testing.assert_array_equal(one, other)

    def test_a_goal_that_cannot_be_reached_has_a_reason(self):
        blocked = np.zeros((20, 40), dtype=bool)
        blocked[:, 20] = True
        plan = coppice.plan(coppice.Map(blocked), [(5, 10), (5, 10)], [(35, 10), (10, 15)], radius=1)
        self.assertEqual([len(path) > 0 for path in plan.paths], [False, True])
        self.assertEqual(plan.paths[0].shape, (0, 2))
        self.assertIn("cannot be reached", plan.reasons[0])
        self.assertTrue(np.isnan(plan.lengths[0]))

    def test_trajectories_do_not_touch(self):
        map = coppice.Map.generate("room", 256, 256, seed=4)
        starts, goals = coppice.random_tasks(map, 8, radius=5, seed=4)
        fleet = coppice.plan_trajectories(map, starts, goals, radius=5, max_speed=10)
        self.assertEqual(fleet.stranded, [])
        times = np.arange(0, max(fleet.arrivals) + 1, 0.02)
        tracks = np.array(
            [[np.interp(times, t[:, 0], t[:, column]) for column in (1, 2)] for t in fleet.trajectories]
        )
        for a in range(len(tracks)):
            for b in range(a):
                self.assertGreaterEqual(np.linalg.norm(tracks[a] - tracks[b], axis=0).min(), 10 - 1e-6)
        for trajectory, goal in zip(fleet.trajectories, goals):
            np.testing.assert_allclose(trajectory[-1, 1:], goal)

    def test_bad_arguments_are_named(self):
        map = empty_map()
        for expected, arguments in {
            r"starts: .*shape \(n, 2\), found \(2,\)": dict(starts=(1, 2)),
            r"starts: expected numbers": dict(starts=[("a", "b")]),
            r"goals: expected 1 rows": dict(goals=[(3, 3), (4, 4)]),
            r"starts\[0\]: \(nan": dict(starts=[(float("nan"), 2)]),
            r"goals\[0\]: .*outside of the map": dict(goals=[(300, 2)]),
            r"radius\[0\]: -1": dict(radius=-1),
            r"radius: expected a number": dict(radius="wide"),
            r"radius: expected a number, or 1": dict(radius=[1, 2]),
            r"planner: \"a-star\", expected ma-rrdt": dict(planner="a-star"),
        }.items():
            good = dict(starts=[(5, 5)], goals=[(20, 10)], radius=1)
            with self.assertRaisesRegex(coppice.InputError, expected):
                coppice.plan(map, **(good | arguments))
        with self.assertRaisesRegex(coppice.InputError, r"source: expected a boolean array"):
            coppice.Map(np.zeros((3, 3)))
        with self.assertRaisesRegex(coppice.InputError, r"source: expected a boolean array"):
            coppice.Map(np.zeros((0, 3), dtype=bool))
        with self.assertRaisesRegex(coppice.InputError, r"resolution: 0"):
            coppice.Map(np.zeros((3, 3), dtype=bool), resolution=0)
        with self.assertRaisesRegex(coppice.InputError, "nowhere.map"):
            coppice.Map("nowhere.map")
        with self.assertRaisesRegex(coppice.InputError, r"kind: \"castle\""):
            coppice.Map.generate("castle", 100, 100)
        with self.assertRaisesRegex(coppice.InputError, r"tasks\[1\]\.start: overlaps"):
            coppice.plan_trajectories(map, [(5, 5), (6, 5)], [(20, 5), (25, 5)], radius=1)
        with self.assertRaisesRegex(coppice.InputError, r"tasks\[0\]\.limits"):
            coppice.plan_trajectories(map, [(5, 5)], [(20, 5)], radius=1, max_speed=-1)


class Simulation(unittest.TestCase):
    def test_all_robots_arrive_under_faults_and_nothing_is_touched(self):
        scenario = coppice.Scenario.generate("circle", 8, seed=2)
        faults = coppice.Faults(loss=0.2, delay=0.05, jitter=0.02, kills=[("r3", 3.0)], restart_after=1)
        run = coppice.simulate(scenario, faults=faults)
        self.assertTrue(run.arrived)
        self.assertEqual((run.broken, run.report.collisions), ([], 0))
        self.assertEqual(list(run.trajectories), scenario.names)
        for rows, start, goal, tolerance in zip(
            run.trajectories.values(), scenario.starts, scenario.goals, scenario.goal_tolerance
        ):
            np.testing.assert_allclose(rows[0, 1:3], start, atol=1e-6)
            self.assertLessEqual(np.linalg.norm(rows[-1, 1:3] - goal), tolerance + 1e-9)

    def test_the_command_simulates_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            scenario = SOURCES / "scenarios/rooms-8.json"
            command = [os.environ["COPPICE"], "simulate", scenario, "--quiet", "--report", out / "r.json"]
            subprocess.run([*command, "--trajectory", out / "t.csv"], check=True, stdout=subprocess.DEVNULL)
            run = coppice.simulate(scenario)
            self.assertEqual(run.report.run_time, coppice.Report.read(out / "r.json").run_time)
            recorded = coppice.read_trajectories(out / "t.csv")
            for name, rows in run.trajectories.items():
                np.testing.assert_allclose(recorded[name], rows, atol=1e-6)

    def test_a_scenario_of_arrays_is_checked(self):
        map = empty_map(60, 40)
        good = dict(starts=[(5, 5), (50, 30)], goals=[(50, 5), (5, 30)], radius=2, max_speed=5)
        self.assertTrue(coppice.simulate(coppice.Scenario(map, **good)).arrived)
        for expected, arguments in {
            r"robots\[1\]\.start: r2 and r1 would overlap": dict(starts=[(5, 5), (6, 5)]),
            r"robots\[0\]\.goal: .*outside": dict(goals=[(90, 5), (5, 30)]),
            r"robots\[1\]\.radius: -2": dict(radius=[2, -2]),
            r"robots\[0\]\.max_speed: nan": dict(max_speed=float("nan")),
            r"names: expected 2": dict(names=["a"]),
            r"robots\[1\]\.name: \"a\" is also": dict(names=["a", "a"]),
            r"robots\[0\]\.goal_tolerance: 0": dict(goal_tolerance=0),
        }.items():
            with self.assertRaisesRegex(coppice.InputError, expected):
                coppice.Scenario(map, **(good | arguments))
        with self.assertRaisesRegex(coppice.InputError, "castle"):
            coppice.Scenario.generate("castle", 3)

    def test_bad_settings_are_named(self):
        scenario = coppice.Scenario.generate("circle", 3)
        for expected, faults in {
            r"faults\.loss: 2": dict(loss=2),
            r"faults\.delay: nan": dict(delay=float("nan")),
            r"faults\.kills: there is no robot \"r9\"": dict(kills=[("r9", 1)]),
            r"faults\.partitions: 3 is not before 2": dict(partitions=[(3, 2)]),
        }.items():
            with self.assertRaisesRegex(coppice.InputError, expected):
                coppice.simulate(scenario, faults=coppice.Faults(**faults))
        with self.assertRaisesRegex(coppice.InputError, r"timeout: -1"):
            coppice.simulate(scenario, timeout=-1)

    def test_a_trajectory_file_with_a_mistake_is_refused_with_its_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "t.csv"
            for text, expected in {
                "": r"t\.csv:1: expected time,robot",
                "time,robot,x,y,vx,vy,yaw,omega\n0,r1,1,2,3,4,5,6\n0,r1,1,2,3\n": r"t\.csv:3: expected a time",
                "time,robot,x,y,vx,vy,yaw,omega\n0,r1,1,2,3,4,5,fast\n": r"t\.csv:2: expected a time",
            }.items():
                path.write_text(text)
                with self.assertRaisesRegex(coppice.InputError, expected):
                    coppice.read_trajectories(path)


class Trees(unittest.TestCase):
    def setUp(self):
        self.map = coppice.Map.generate("maze", 200, 200, seed=1)
        self.starts, self.goals = coppice.random_tasks(self.map, 3, radius=4, seed=1)

    def plan(self, **parameters):
        trees = coppice.TreeParameters(**parameters)
        return coppice.plan(self.map, self.starts, self.goals, radius=4, improve=0, trees=trees)

    def test_no_edge_is_longer_than_epsilon(self):
        for epsilon in (8, 20):
            plan = self.plan(epsilon=epsilon)
            self.assertTrue(plan.solved)
            self.assertLessEqual(np.hypot(*(plan.edges[:, :2] - plan.edges[:, 2:]).T).max(), epsilon + 1e-9)

    def test_each_parameter_has_an_effect(self):
        usual = self.plan().edges
        for name, value in {
            "disjointed_trees": 5,
            "kappa": 20,
            "failure_factor": 0.3,
            "restart_weight": 5,
            "spacing": 0,
            "restarts": "random",
        }.items():
            self.assertFalse(np.array_equal(usual, self.plan(**{name: value}).edges), name)

    def test_bad_parameters_are_named(self):
        for name, value in {"epsilon": -1, "kappa": 200, "spacing": 2, "restarts": "odd"}.items():
            with self.assertRaisesRegex(coppice.InputError, f"^{name}: .*expected"):
                self.plan(**{name: value})

    def test_a_simulated_broker_may_grow_its_trees_together_with_the_missions(self):
        scenario = coppice.Scenario(self.map, self.starts, self.goals, radius=4)
        nodes = {}
        for forest in ("ahead", "together"):
            run = coppice.simulate(scenario, forest=forest, trees=coppice.TreeParameters(epsilon=30))
            self.assertTrue(run.arrived)
            nodes[forest] = sum(robot.nodes_valid for robot in run.report.robots)
        self.assertGreater(nodes["together"], nodes["ahead"])
        with self.assertRaisesRegex(coppice.InputError, '^forest: "later", expected ahead or together$'):
            coppice.simulate(scenario, forest="later")

    def test_a_simulated_fleet_drives_without_reservations_too(self):
        scenario = coppice.Scenario(self.map, self.starts, self.goals, radius=4)
        by_default = coppice.simulate(scenario)
        for rounds in (True, False):
            run = coppice.simulate(scenario, coordination="rvo", rounds=rounds)
            self.assertEqual(run.broken, [])
            self.assertNotEqual(run.report.run_time, by_default.report.run_time)
        with self.assertRaisesRegex(coppice.InputError, '^coordination: "none", expected reservations or rvo$'):
            coppice.simulate(scenario, coordination="none")
        with self.assertRaisesRegex(coppice.InputError, "^rounds: .* goes with"):
            coppice.simulate(scenario, rounds=False)


class GridPlans(unittest.TestCase):
    def setUp(self):
        blocked = np.zeros((4, 7), dtype=bool)
        blocked[:3, 3] = True
        self.map = coppice.Map(blocked)
        self.starts = np.array([(0, 0), (6, 0), (1, 0)])
        self.goals = np.array([(6, 0), (0, 0), (5, 2)])
        self.plan = coppice.plan_on_grid(self.map, self.starts, self.goals)

    def test_each_robot_goes_to_free_neighbouring_cells_only(self):
        for start, goal, cells in zip(self.starts, self.goals, self.plan):
            self.assertEqual((cells[0].tolist(), cells[-1].tolist()), (start.tolist(), goal.tolist()))
            self.assertLessEqual(np.abs(np.diff(cells, axis=0)).sum(axis=1).max(), 1)
            self.assertFalse(self.map.blocked[cells[:, 1], cells[:, 0]].any())

    def test_both_forms_are_read_as_they_were_written(self):
        with tempfile.TemporaryDirectory() as folder:
            for form in ("steps", "agents"):
                path = pathlib.Path(folder, form)
                coppice.write_grid_plan(path, self.plan, form=form)
                read = coppice.read_grid_plan(path)
                for written, again in zip(self.plan, read, strict=True):
                    self.assertTrue(np.array_equal(written, again[: len(written)]), form)
                    self.assertTrue((again[len(written) :] == written[-1]).all(), form)

    def test_a_simulated_fleet_drives_a_plan(self):
        scenario = coppice.Scenario(self.map, self.starts + 0.5, self.goals + 0.5, radius=0.4, max_speed=1)
        run = coppice.simulate(scenario, plan=self.plan)
        self.assertTrue(run.arrived)
        self.assertEqual(run.report.collisions, 0)
        for cells, rows in zip(self.plan, run.trajectories.values()):
            # The robot stays between neighbouring cells of its part of the plan.
            distances = np.hypot(*(rows[:, None, 1:3] - (cells[None] + 0.5)).transpose(2, 0, 1)).min(axis=1)
            self.assertLess(distances.max(), 0.75)

    def test_no_plan_is_none(self):
        walled = coppice.Map(np.array([[False, True, False]]))
        self.assertIsNone(coppice.plan_on_grid(walled, [(0, 0)], [(2, 0)]))

    def test_mistakes_are_named(self):
        for starts, goals, problem in [
            ([(0.5, 0)], [(1, 0)], "^starts: expected whole numbers"),
            ([(0, 0)], [(1, 0), (2, 0)], "^goals: expected 1 rows"),
            ([(3, 0)], [(1, 0)], r"tasks\[0\].start is blocked"),
            ([(0, 0), (1, 0)], [(2, 0), (2, 0)], r"tasks\[1\].goal is that of another"),
        ]:
            with self.assertRaisesRegex(coppice.InputError, problem):
                coppice.plan_on_grid(self.map, starts, goals)
        with self.assertRaisesRegex(coppice.InputError, '^form: "csv", expected steps or agents$'):
            coppice.write_grid_plan("plan", self.plan, form="csv")
        scenario = coppice.Scenario(self.map, self.starts[:2] + 0.5, self.goals[:2] + 0.5, radius=0.4)
        with self.assertRaisesRegex(coppice.InputError, "robots"):
            coppice.simulate(scenario, plan=self.plan)


class Threads(unittest.TestCase):
    def test_other_threads_run_during_work(self):
        ticks = []
        done = threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.005)

        thread = threading.Thread(target=tick)
        thread.start()
        try:
            begin = time.monotonic()
            coppice.simulate(coppice.Scenario.generate("circle", 40))
            end = time.monotonic()
        finally:
            done.set()
            thread.join()
        during = [t for t in ticks if begin < t < end]
        longest = max(b - a for a, b in zip([begin, *during], [*during, end]))
        self.assertLess(longest, 0.5 * (end - begin))

    def test_ctrl_c_ends_a_simulation(self):
        program = "import coppice; print('begun', flush=True); coppice.simulate(coppice.Scenario.generate('rooms', 50), lifelong=1e5, timeout=1e6)"
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            process.stdout.readline()
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            try:
                _, errors = process.communicate(timeout=60)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
        self.assertIn("KeyboardInterrupt", errors)


class Examples(unittest.TestCase):
    def run_example(self, name, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            script = SOURCES / "examples/python" / name
            done = subprocess.run([sys.executable, script, *arguments], cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for picture in pathlib.Path(folder).iterdir():
                self.assertGreater(picture.stat().st_size, 1000, picture)
            return done.stdout, [path.name for path in pathlib.Path(folder).iterdir()]

    def test_plan_and_plot(self):
        self.assertEqual(self.run_example("plan_and_plot.py")[1], ["plan.png"])

    def test_compare_planners(self):
        self.assertIn("rrt-star", self.run_example("compare_planners.py", "blank", "2")[0])

    def test_sweep_robots(self):
        output, files = self.run_example("sweep_robots.py", "20")
        self.assertIn("30 robots", output)
        self.assertEqual(files, ["throughput.png"])

    def test_replay_trajectory(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario = SOURCES / "scenarios/crossing.json"
            trajectory = pathlib.Path(folder) / "t.csv"
            command = [os.environ["COPPICE"], "simulate", scenario, "--robots", "2", "--quiet"]
            subprocess.run([*command, "--trajectory", trajectory], check=True, stdout=subprocess.DEVNULL)
            self.assertEqual(self.run_example("replay_trajectory.py", scenario, trajectory)[1], ["replay.gif"])


if __name__ == "__main__":
    unittest.main()
