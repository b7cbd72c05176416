#!/usr/bin/env python3
"""Keeps a standing fleet busy with orders of three clients, kills its processes, and judges the result.

    bench/orders.py SITE [--minutes 10] [--time-scale 1] [--kill-every 20] [--stop-every 60] [--domain 60] [--seed 1]

A site is a scenario without goals. The clients are the command, HTTP, and Cyclone DDS. Every order must end once, done,
cancelled or failed. Nothing may touch, by the recorded trajectories. After a stop every robot must stand. Exit code 1 if
something is wrong.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = ROOT / "build/release/bin"
CYCLONE = ROOT / "build/release/tests/cyclone_dispatcher"


class Fleet:
    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.site = json.loads(pathlib.Path(options.site).read_text())
        self.robots = [robot["name"] for robot in self.site["robots"]]
        self.starts = [(robot["start"]["x"], robot["start"]["y"]) for robot in self.site["robots"]]
        self.process = subprocess.Popen(
            [BIN / "coppice", "serve", options.site, "--domain", str(options.domain), "--time-scale", str(options.time_scale),
             "--state", folder / "state", "--report", folder / "report.json", "--trajectory", folder / "trajectory.csv"],
            stdout=open(folder / "fleet.log", "w"), stderr=subprocess.STDOUT)
        (folder / "token").write_text("0123456789abcdef0123456789abcdef")
        self.monitor = subprocess.Popen(
            [BIN / "coppice", "monitor", "--domain", str(options.domain), "--port", "0", "--control", "--token-file",
             folder / "token"], stdout=subprocess.PIPE, stderr=open(folder / "monitor.log", "w"), text=True)
        self.url = self.monitor.stdout.readline().strip()

    def http(self, method, path, body=None):
        request = urllib.request.Request(self.url + path, method=method,
                                         data=None if body is None else json.dumps(body).encode())
        request.add_header("Authorization", "Bearer 0123456789abcdef0123456789abcdef")
        with urllib.request.urlopen(request, timeout=30) as reply:
            return json.load(reply)

    def children(self, name):
        listed = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(self.process.pid)], capture_output=True, text=True)
        rows = [line.split(None, 1) for line in listed.stdout.splitlines()]
        return [int(pid) for pid, command in rows if command.strip().startswith(name[:15])]


class Clients:
    """Each client keeps some orders under way. It draws places where robots started."""

    def __init__(self, fleet, end):
        self.fleet = fleet
        self.end = end
        self.random = random.Random(fleet.options.seed)
        self.lock = threading.Lock()
        self.number = 0
        self.given = {}
        self.latencies = []

    def draw(self):
        with self.lock:
            self.number += 1
            x, y = self.random.choice(self.fleet.starts)
            robot = self.random.choice(self.fleet.robots) if self.number % 4 == 0 else None
            return f"order-{self.number}", robot, x, y

    def by_command(self):
        while time.time() < self.end:
            _, robot, x, y = self.draw()
            words = [robot] if robot else ["--any"]
            done = subprocess.run([BIN / "coppice", "send", *words, "--to", f"{x},{y}", "--json", "--domain",
                                   str(self.fleet.options.domain), "--patience", "60"], capture_output=True, text=True)
            for line in done.stdout.splitlines():
                self.given[json.loads(line)["id"]] = "command"
            self.wait_for_capacity()

    def by_http(self):
        while time.time() < self.end:
            name, robot, x, y = self.draw()
            began = time.time()
            try:
                self.given[name] = "http"
                self.fleet.http("POST", "api/orders", {"id": name, "robot": robot, "goal": {"x": x, "y": y}})
                self.latencies.append(time.time() - began)
            except (urllib.error.HTTPError, OSError):
                pass  # the service was killed: the order waits for the next one, or was refused
            if self.random.random() < 0.1:
                try:
                    self.fleet.http("DELETE", f"api/orders/{name}")
                except (urllib.error.HTTPError, OSError):
                    pass  # it has ended already
            self.wait_for_capacity()

    def by_dds(self):
        while time.time() < self.end:
            name, robot, x, y = self.draw()
            self.given[name] = "dds"
            subprocess.run([CYCLONE, str(self.fleet.options.domain), name, robot or self.fleet.robots[0], str(x), str(y), "60"],
                           capture_output=True, check=False)

    def wait_for_capacity(self):
        """The fleet always has a little more to do than it can."""
        while len(self.open()) > 1.5 * len(self.fleet.robots) and time.time() < self.end:
            time.sleep(1)

    def open(self):
        try:
            return [order for order in self.fleet.http("GET", "api/orders")["orders"] if order["ended_at"] is None]
        except (urllib.error.HTTPError, OSError):
            return self.fleet.robots


def print_latencies(what, latencies):
    latencies = sorted(latencies) or [math.nan]
    print(f"HTTP POST, {what}: median {1000 * latencies[len(latencies) // 2]:.1f} ms, longest {1000 * latencies[-1]:.1f} ms")


def measure_idle(fleet, orders=100):
    """Before the clients begin: each order sends a robot to its place, and is cancelled."""
    latencies = []
    for _ in range(orders):
        x, y = fleet.starts[0]
        began = time.time()
        order = fleet.http("POST", "api/orders", {"robot": fleet.robots[0], "goal": {"x": x, "y": y, "wait": 60}})
        latencies.append(time.time() - began)
        fleet.http("DELETE", f"api/orders/{order['id']}")
    print_latencies("while the fleet stands", latencies)


def stop_and_release(fleet, problems):
    """After a stop nobody moves until the release."""
    fleet.http("POST", "api/stop", {"by": "bench"})
    time.sleep(3)
    before = {robot["name"]: (robot["x"], robot["y"]) for robot in fleet.http("GET", "api/robots")["robots"]}
    time.sleep(3)
    for robot in fleet.http("GET", "api/robots")["robots"]:
        x, y = before.get(robot["name"], (robot["x"], robot["y"]))
        if math.hypot(robot["x"] - x, robot["y"] - y) > 1e-3:
            problems.append(f"{robot['name']} moved though it was stopped")
    fleet.http("POST", "api/release", {"by": "bench"})


def least_separation(fleet):
    """Of the recorded trajectories, metres; by interpolation at the points of all robots."""
    radius = {robot["name"]: robot.get("radius", fleet.site.get("radius", 0)) for robot in fleet.site["robots"]}
    at = {}
    with open(fleet.folder / "trajectory.csv", newline="") as file:
        for row in csv.DictReader(file):
            at.setdefault(round(float(row["time"]) * 20), {})[row["robot"]] = (float(row["x"]), float(row["y"]))
    last = {}
    least = math.inf
    for tick in sorted(at):
        last.update(at[tick])
        for name in at[tick]:
            x, y = last[name]
            for other, (u, v) in last.items():
                if other != name:
                    least = min(least, math.hypot(x - u, y - v) - radius[name] - radius[other])
    return least


def judge(fleet, clients, problems):
    ends, last = {}, {}
    for line in (fleet.folder / "state/orders.jsonl").read_text().splitlines():
        status = json.loads(line)
        last[status["id"]] = status
        ends[status["id"]] = ends.get(status["id"], 0) + (status["ended_at"] is not None)
    for order, count in ends.items():
        if count != 1:
            problems.append(f"{order} ended {count} times")
    states = {}
    for status in last.values():
        if status["action"] == "go":
            states[status["state"]] = states.get(status["state"], 0) + 1
    reasons = {status["reason"] for status in last.values() if status["state"] == "failed"}
    done = [s["ended_at"] - s["accepted_at"] for s in last.values() if s["state"] == "done" and s["action"] == "go"]
    separation = least_separation(fleet)
    if separation <= 0:
        problems.append(f"robots touched: separation {separation:.4f} m")
    print(f"orders by state: {states}; clients: { {c: list(clients.given.values()).count(c) for c in ('command', 'http', 'dds')} }")
    print(f"reasons of failures: {sorted(reasons)}")
    print(f"seconds from order to done: median {sorted(done)[len(done) // 2]:.1f}, longest {max(done):.1f}")
    print_latencies("while processes are killed", clients.latencies)
    print(f"least separation {separation:.4f} m")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site")
    for name, value in (("minutes", 10), ("time-scale", 1), ("kill-every", 20), ("stop-every", 60)):
        parser.add_argument(f"--{name}", type=float, default=value)
    for name, value in (("domain", 60), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=value)
    options = parser.parse_args()
    problems = []
    with tempfile.TemporaryDirectory() as name:
        fleet = Fleet(options, pathlib.Path(name))
        kills = 0
        try:
            while len(fleet.http("GET", "api/robots")["robots"]) < len(fleet.robots):
                time.sleep(0.5)
            time.sleep(10)  # processes that start keep the machine busy
            measure_idle(fleet)
            end = time.time() + 60 * options.minutes
            clients = Clients(fleet, end)
            threads = [threading.Thread(target=run) for run in (clients.by_command, clients.by_http, clients.by_http, clients.by_dds)]
            for thread in threads:
                thread.start()
            next_kill = time.time() + options.kill_every
            next_stop = time.time() + options.stop_every
            while time.time() < end:
                time.sleep(0.2)
                if time.time() > next_kill:
                    victims = fleet.children(clients.random.choice(["planner_service", "robot_agent", "robot_agent", "tree_broker"]))
                    if victims:
                        os.kill(clients.random.choice(victims), signal.SIGKILL)
                        kills += 1
                    next_kill = time.time() + options.kill_every
                if time.time() > next_stop:
                    try:
                        stop_and_release(fleet, problems)
                    except (urllib.error.HTTPError, OSError) as error:
                        print(f"stop or release was not answered: {error}")
                        fleet.http("POST", "api/release", {"by": "bench"})
                    next_stop = time.time() + options.stop_every
            for thread in threads:
                thread.join()
            patience = time.time() + 600
            while clients.open() and time.time() < patience:
                time.sleep(1)
            for order in clients.open():
                problems.append(f"{order} has not ended")
        finally:
            fleet.process.send_signal(signal.SIGINT)
            fleet.process.wait(120)
            fleet.monitor.terminate()
            fleet.monitor.wait(10)
        print(f"{options.minutes:g} minutes, {len(fleet.robots)} robots, {kills} kills")
        judge(fleet, clients, problems)
    for problem in problems:
        print("WRONG:", problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
