#!/usr/bin/env python3
"""An operator's day: keeps a standing fleet busy with orders, kills its processes, ends it and starts it again, holds robots, and judges it.

    bench/orders.py SITE [--orders 500] [--kills 20] [--restarts 5] [--faults] [--time-scale 1] [--domain 60] [--seed 1] [--keep FOLDER]

A site is a scenario without goals. Orders come from the command, from HTTP, and from Cyclone DDS. Two monitors that take orders are left
running through all restarts of the fleet. KILLS is of each kind of process: service, broker, agents, and the monitor that HTTP uses. An
operator pauses, resumes, stops and releases robots, one and all, also across restarts. With --faults, which needs root and libfaketime, the
disk of the fleet's state is full for a while, all its processes are killed and a byte of the journal is damaged, and the host's clock and
address change; all of this in namespaces of its own. What must hold:

  - each order that was answered has ended once: by orders.jsonl, and by the API if that knows it;
  - each hold is ended by its own command only: by the API, and a robot that is held does not move;
  - robots go on where they stand: nobody jumps, by what the agents publish;
  - nothing touches: by the reports of all runs;
  - while the disk is full, orders are refused with 503; a damaged journal stops the start, and is named.

Exit code 1 if something is wrong. `Day.events` is the list of what befalls the fleet; each is a function of the day.
"""
import argparse
import itertools
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
TOKEN = "0123456789abcdef0123456789abcdef"
JUMP = 0.1  # metres that a robot may be elsewhere after a restart
FAKETIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1"
INSIDE = "COPPICE_DAY_INSIDE"  # set in the namespaces


class Monitor:
    """A monitor that takes orders. It is no child of the fleet."""

    def __init__(self, day, name):
        self.day = day
        self.name = name
        self.start("0")

    def start(self, port):
        self.process = subprocess.Popen(
            [BIN / "coppice", "monitor", "--domain", str(self.day.options.domain), "--port", port, "--control", "--token-file",
             self.day.folder / "token"], stdout=subprocess.PIPE, stderr=open(self.day.folder / f"{self.name}.log", "a"), text=True)
        self.url = self.process.stdout.readline().strip()

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.start(self.url.rstrip("/").rsplit(":", 1)[1])

    def http(self, method, path, body=None):
        request = urllib.request.Request(self.url + path, method=method, data=None if body is None else json.dumps(body).encode())
        request.add_header("Authorization", f"Bearer {TOKEN}")
        with urllib.request.urlopen(request, timeout=30) as reply:
            return json.load(reply)


class Holds:
    """What the operator has told robots, as it should be: a pause and a stop beside each other."""

    def __init__(self, robots):
        self.paused = dict.fromkeys(robots, False)
        self.stopped = dict.fromkeys(robots, False)

    def apply(self, action, robots):
        which = self.paused if action in ("pause", "resume") else self.stopped
        for robot in robots or which:
            which[robot] = action in ("pause", "stop")

    def of(self, robot):
        return "stopped" if self.stopped[robot] else "paused" if self.paused[robot] else "none"


class Day:
    def __init__(self, options, folder):
        self.options = options
        self.folder = folder
        self.site = json.loads(pathlib.Path(options.site).read_text())
        self.robots = [robot["name"] for robot in self.site["robots"]]
        self.places = [(robot["start"]["x"], robot["start"]["y"]) for robot in self.site["robots"]]
        self.random = random.Random(options.seed)
        self.holds = Holds(self.robots)
        self.problems = []
        self.runs = 0
        self.kills = {}
        self.is_over = False
        self.operating = threading.Lock()  # one thing at a time is done to the fleet as a whole
        (folder / "token").write_text(TOKEN)
        if options.faults:
            prepare_faults(folder)
        self.start()
        self.monitor = Monitor(self, "monitor")
        self.other_monitor = Monitor(self, "other")
        kinds = ["planner_service", "tree_broker", "robot_agent", "monitor"]
        self.events = [lambda day, kind=kind: day.kill(kind) for kind in kinds for _ in range(options.kills)]
        self.random.shuffle(self.events)
        for k in range(options.restarts):  # spread over the day
            self.events.insert((k + 1) * len(self.events) // (options.restarts + 1), Day.restart)
        for fault in (Day.fill_disk, Day.damage_journal, Day.step_clock, Day.change_address) if options.faults else ():
            self.events.insert(self.random.randrange(len(self.events) + 1), fault)

    def wrong(self, problem):
        print("WRONG:", problem, flush=True)
        self.problems.append(problem)

    def start(self):
        self.runs += 1
        self.serve()

    def serve(self):
        self.process = subprocess.Popen(
            [BIN / "coppice", "serve", self.options.site, "--domain", str(self.options.domain), "--time-scale",
             str(self.options.time_scale), "--state", self.folder / "state", "--report", self.folder / f"report{self.runs}.json"],
            stdout=open(self.folder / f"fleet{self.runs}.log", "a"), stderr=subprocess.STDOUT, start_new_session=True)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        if self.process.wait(120) != 0:
            self.wrong(f"run {self.runs} ended with code {self.process.returncode}")

    def children(self, name):
        listed = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(self.process.pid)], capture_output=True, text=True)
        rows = [line.split(None, 1) for line in listed.stdout.splitlines()]
        return [int(pid) for pid, command in rows if command.strip().startswith(name[:15])]

    def seen(self):
        """The robots as the other monitor sees them; it is never killed."""
        try:
            return {robot["name"]: robot for robot in self.other_monitor.http("GET", "api/robots")["robots"]}
        except OSError:
            return {}

    def wait_for_robots(self, patience=120):
        until = time.time() + patience
        while time.time() < until:
            robots = self.seen()
            if len(robots) == len(self.robots) and all(r["x"] is not None for r in robots.values()):
                return robots
            time.sleep(0.5)
        self.wrong("not all robots are seen")
        return self.seen()

    # What befalls the fleet.

    def kill(self, kind):
        self.kills[kind] = self.kills.get(kind, 0) + 1
        if kind == "monitor":
            return self.monitor.kill()
        for _ in range(100):  # it may just be started again
            victims = self.children(kind)
            if victims:
                return os.kill(self.random.choice(victims), signal.SIGKILL)
            time.sleep(0.1)
        self.wrong(f"no {kind} runs")

    def restart(self):
        with self.operating:
            self.hold()  # some holds are on as the fleet ends
            self.end_and_start()
            self.check_holds("after a restart")

    def end_and_start(self):
        self.end()
        before = self.seen()  # where they stood at last
        time.sleep(self.random.uniform(0, 3))
        self.start()
        after = self.wait_for_robots()
        time.sleep(2)
        after = self.seen()
        if self.options.verbose:
            print(f"restart {self.runs - 1}", flush=True)
        for name, robot in after.items():
            was = before.get(name)
            # The monitor shows what it heard last until the new run speaks; robots may have set out since.
            if was is None or robot["order"] is not None or robot["phase"] == "driving":
                continue
            moved = math.hypot(robot["x"] - was["x"], robot["y"] - was["y"])
            if moved > JUMP:
                self.wrong(f"{name} stood at ({was['x']}, {was['y']}), and is at ({robot['x']}, {robot['y']}) after a restart")

    def give(self, name):
        """The code of the answer to an order for any robot."""
        try:
            x, y = self.places[0]
            self.other_monitor.http("POST", "api/orders", {"id": name, "goal": {"x": x, "y": y}})
            return 200
        except urllib.error.HTTPError as error:
            return error.code
        except (OSError, ValueError):
            return 0

    def expect_answer(self, expected, names, patience=40):
        """Gives orders with these names until one is answered as expected, and returns its name."""
        until = time.time() + patience
        for name in names:
            code = self.give(name)
            if code == expected:
                return name
            if time.time() > until:
                break
            time.sleep(1)
        self.wrong(f"an order is answered with {code}, expected {expected}")
        return name

    def fill_disk(self):
        with self.operating:
            ballast = self.folder / "state" / "ballast"
            with open(ballast, "wb", buffering=0) as file:
                try:
                    while True:
                        file.write(bytes(4096))
                except OSError:
                    pass
            # The service looks at the disk four times a second, and has room for what it answers meanwhile.
            refused = self.expect_answer(503, (f"full-{k}" for k in itertools.count()))
            self.kill("planner_service")
            time.sleep(3)
            self.expect_answer(503, (f"full-after-a-kill-{k}" for k in itertools.count()))
            ballast.unlink()
            self.expect_answer(200, itertools.repeat(refused))

    def damage_journal(self):
        """As after a loss of power: all processes are gone. The operator has a copy of the file."""
        with self.operating:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            journal = self.folder / "state" / "planner_service.journal"
            whole = journal.read_bytes()
            middle = len(whole) // 3
            journal.write_bytes(whole[:middle] + bytes([whole[middle] ^ 0x20]) + whole[middle + 1:])
            self.serve()
            if self.process.wait(60) != 2 or "planner_service.journal" not in (self.folder / f"fleet{self.runs}.log").read_text():
                self.wrong(f"a damaged journal: code {self.process.returncode}, expected 2 and the file's name")
            journal.write_bytes(whole)
            self.serve()
            self.wait_for_robots()
            self.check_holds("after a loss of power")

    def step_clock(self):
        (self.folder / "offset").write_text("-3600\n")

    def change_address(self):
        for words in ("addr flush dev d0", "addr add 192.0.2.77/24 dev d0", "route add default via 192.0.2.1 dev d0"):
            subprocess.run(["ip", *words.split()], check=True)
            time.sleep(1)

    # The operator.

    def command(self, action, robots):
        done = subprocess.run([BIN / "coppice", action, *robots, "--domain", str(self.options.domain), "--patience", "60", "--by",
                               "operator"], capture_output=True, text=True)
        expected = 1 if action == "resume" and any(self.holds.stopped[r] for r in robots or self.robots) else 0
        self.holds.apply(action, robots)
        if done.returncode != expected:
            self.wrong(f"{action} {robots}: code {done.returncode}, expected {expected}: {done.stdout}{done.stderr}")

    def hold(self):
        """Changes some holds. Seldom are all robots stopped."""
        action = self.random.choice(["pause", "stop", "resume", "release", "resume", "release", "stop all", "release all"])
        if action.endswith(" all"):
            return self.command(action.split()[0], [])
        self.command(action, self.random.sample(self.robots, 2))

    def check_holds(self, when):
        expected = {name: self.holds.of(name) for name in self.robots}
        until = time.time() + 30
        while time.time() < until:
            found = {name: robot["halt"] for name, robot in self.seen().items()}
            if found == expected:
                return
            time.sleep(0.3)
        self.wrong(f"{when}: holds are {found}, expected {expected}")

    def operate(self):
        while not self.is_over:
            time.sleep(self.options.hold_every)
            with self.operating:
                if not self.is_over:
                    self.hold_and_look()

    def hold_and_look(self):
        self.hold()
        self.check_holds("after a hold")
        time.sleep(3)
        before = self.seen()
        time.sleep(2)
        for name, robot in self.seen().items():
            was = before.get(name)
            if self.holds.of(name) != "none" and was and math.hypot(robot["x"] - was["x"], robot["y"] - was["y"]) > 1e-3:
                self.wrong(f"{name} moved though it is {self.holds.of(name)}")
        # Nobody works if all stay held.
        if sum(self.holds.of(name) != "none" for name in self.robots) > len(self.robots) // 3:
            self.command("release", [])
            self.command("resume", [])


def prepare_faults(folder):
    """In the namespaces: a network with one address, a small disk, and a clock that can be set."""
    for words in ("link set lo up", "link add d0 type veth peer name d1", "link set d0 up", "link set d1 up",
                  "addr add 192.0.2.5/24 dev d0", "route add default via 192.0.2.1 dev d0"):
        subprocess.run(["ip", *words.split()], check=True)
    (folder / "state").mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64M", "tmpfs", folder / "state"], check=True)
    (folder / "offset").write_text("+0\n")
    os.environ.update(LD_PRELOAD=FAKETIME, FAKETIME_TIMESTAMP_FILE=str(folder / "offset"), FAKETIME_NO_CACHE="1",
                      FAKETIME_DONT_FAKE_MONOTONIC="1", DONT_FAKE_MONOTONIC="1")


class Clients:
    """Each client keeps some orders under way. It draws places where robots started."""

    def __init__(self, day):
        self.day = day
        self.random = random.Random(day.options.seed + 1)
        self.lock = threading.Lock()
        self.given = {}  # by id: who gave it
        self.answered = set()
        self.latencies = []

    def draw(self, client):
        with self.lock:
            number = len(self.given) + 1
            if number > self.day.options.orders:
                return None
            x, y = self.random.choice(self.day.places)
            robot = self.random.choice(self.day.robots) if number % 4 == 0 else None
            name = f"{client}-{number}"
            self.given[name] = client
            return name, robot, x, y

    def by_command(self):
        while drawn := self.draw("command"):
            name, robot, x, y = drawn
            done = subprocess.run([BIN / "coppice", "send", *([robot] if robot else ["--any"]), "--to", f"{x},{y}", "--json", "--domain",
                                   str(self.day.options.domain), "--patience", "120"], capture_output=True, text=True)
            for line in done.stdout.splitlines():
                status = json.loads(line)
                if status["state"] != "failed":  # it was refused, or has failed later
                    self.answered.add(status["id"])
            self.wait_for_capacity()

    def by_http(self):
        while drawn := self.draw("http"):
            name, robot, x, y = drawn
            for _ in range(60):  # a client repeats what was not answered
                began = time.time()
                try:
                    self.day.monitor.http("POST", "api/orders", {"id": name, "robot": robot, "goal": {"x": x, "y": y}, "by": "http"})
                    self.latencies.append(time.time() - began)
                    self.answered.add(name)
                    break
                except urllib.error.HTTPError as error:
                    if error.code == 422:
                        self.day.wrong(f"{name} was refused: {error.read()}")
                        break
                except (OSError, ValueError):
                    pass  # the monitor is down
                time.sleep(1)
            if self.random.random() < 0.1:
                try:
                    self.day.monitor.http("DELETE", f"api/orders/{name}")
                except (OSError, ValueError):
                    pass  # it has ended already, or the monitor is down
            self.wait_for_capacity()

    def by_dds(self):
        while drawn := self.draw("dds"):
            name, robot, x, y = drawn
            arguments = [str(self.day.options.domain), name, robot or self.random.choice(self.day.robots), str(x), str(y), "60"]
            try:
                subprocess.run([CYCLONE, *arguments], capture_output=True, check=False, timeout=70)
            except subprocess.TimeoutExpired:
                pass  # Cyclone DDS waits by the wall clock: once that is set back, for as long as it was set

    def wait_for_capacity(self):
        """The fleet always has a little more to do than it can."""
        while len(self.open()) > 1.5 * len(self.day.robots):
            time.sleep(1)

    def open(self):
        try:
            return [order["id"] for order in self.day.other_monitor.http("GET", "api/orders")["orders"]
                    if order["ended_at"] is None and order["action"] == "go"]
        except (OSError, ValueError):
            return self.day.robots


def watch_motion(day):
    """No robot is ever farther from where it was than it can drive."""
    speed = {robot["name"]: robot.get("max_speed", day.site.get("max_speed", 20)) for robot in day.site["robots"]}
    last = {}
    while not day.is_over:
        now = time.time()
        for name, robot in day.seen().items():
            if robot["x"] is None:
                continue
            if name in last:
                at, x, y = last[name]
                moved = math.hypot(robot["x"] - x, robot["y"] - y)
                # What is shown goes on by the last promise; a robot whose agent was killed has braked meanwhile.
                most = speed[name] * day.options.time_scale * (now - at + 0.5) + JUMP
                if moved > most:
                    day.wrong(f"{name} jumped {moved:.2f} m in {now - at:.2f} s")
            last[name] = (now, robot["x"], robot["y"])
        time.sleep(0.25)


def print_latencies(what, latencies):
    latencies = sorted(latencies) or [math.nan]
    print(f"HTTP POST, {what}: median {1000 * latencies[len(latencies) // 2]:.1f} ms, longest {1000 * latencies[-1]:.1f} ms")


def measure_idle(day, orders=100):
    """Before the clients begin: each order sends a robot to its place, and is cancelled."""
    latencies = []
    for _ in range(orders):
        x, y = day.places[0]
        began = time.time()
        order = day.monitor.http("POST", "api/orders", {"robot": day.robots[0], "goal": {"x": x, "y": y, "wait": 60}})
        latencies.append(time.time() - began)
        day.monitor.http("DELETE", f"api/orders/{order['id']}")
    print_latencies("while the fleet stands", latencies)


def history(folder):
    """Lines of all files of the history, which is rotated."""
    for file in sorted((folder / "state").glob("orders*.jsonl*")):
        for line in file.read_text().splitlines():
            yield json.loads(line)


def judge(day, clients):
    ends, last = {}, {}
    for status in history(day.folder):
        ends[status["id"]] = ends.get(status["id"], 0) + (status["ended_at"] is not None)
        last[status["id"]] = status
    for order, count in ends.items():
        if count != 1:
            day.wrong(f"{order} ended {count} times")
    for order in clients.answered - set(ends):
        day.wrong(f"{order} was answered, and is not in the history")
    for order in day.final_orders:
        if order["ended_at"] is None:
            day.wrong(f"{order['id']} has not ended by the API")
        elif order["id"] in last and last[order["id"]]["state"] != order["state"]:
            day.wrong(f"{order['id']} is {order['state']} by the API, and {last[order['id']]['state']} by the history")
    separations = []
    for run in range(1, day.runs + 1):
        report = json.loads((day.folder / f"report{run}.json").read_text())
        separations.append(report.get("least_separation", math.inf))
        if report.get("collisions", 0):
            day.wrong(f"run {run}: {report['collisions']} collisions")
    states = {}
    for status in last.values():
        if status["action"] == "go":
            states[status["state"]] = states.get(status["state"], 0) + 1
    reasons = {status["reason"] for status in last.values() if status["state"] == "failed"}
    done = [s["ended_at"] - s["accepted_at"] for s in last.values() if s["state"] == "done" and s["action"] == "go"] or [math.nan]
    print(f"orders by state: {states}; clients: { {c: list(clients.given.values()).count(c) for c in ('command', 'http', 'dds')} }")
    print(f"reasons of failures: {sorted(map(str, reasons))[:10]}")
    print(f"seconds from order to done: median {sorted(done)[len(done) // 2]:.1f}, longest {max(done):.1f}")
    print_latencies("while processes are killed", clients.latencies)
    print(f"least separation of {day.runs} runs: {min(separations)}")


def carry_out(day):
    day.wait_for_robots()
    time.sleep(10)  # processes that start keep the machine busy
    measure_idle(day)
    clients = Clients(day)
    workers = [threading.Thread(target=run) for run in (clients.by_command, clients.by_http, clients.by_http, clients.by_dds)]
    watchers = [threading.Thread(target=day.operate), threading.Thread(target=watch_motion, args=(day,))]
    for thread in workers + watchers:
        thread.start()
    while any(thread.is_alive() for thread in workers) or day.events:
        time.sleep(day.options.event_every)
        if day.events:
            day.events.pop(0)(day)
    day.is_over = True
    for thread in watchers:
        thread.join()
    day.command("release", [])
    day.command("resume", [])
    patience = time.time() + 600
    while clients.open() and time.time() < patience:
        time.sleep(1)
    day.final_orders = day.other_monitor.http("GET", "api/orders")["orders"]
    return clients


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site")
    for name, value in (("orders", 500), ("kills", 20), ("restarts", 5), ("domain", 60), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=value)
    for name, value in (("time-scale", 1), ("event-every", 6), ("hold-every", 20)):
        parser.add_argument(f"--{name}", type=float, default=value)
    parser.add_argument("--faults", action="store_true")
    parser.add_argument("--keep", help="folder for logs, reports and state; default: a temporary one")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    if options.faults and INSIDE not in os.environ:
        os.environ[INSIDE] = "1"
        os.execvp("unshare", ["unshare", "--net", "--mount", sys.executable, *sys.argv])
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(options.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        began = time.time()
        day = Day(options, folder)
        clients = None
        try:
            clients = carry_out(day)
        finally:
            day.is_over = True
            if day.process.poll() is None:
                day.end()
            for monitor in (day.monitor, day.other_monitor):
                monitor.process.terminate()
                monitor.process.wait(10)
        print(f"{(time.time() - began) / 60:.0f} minutes, {len(day.robots)} robots, kills {day.kills}, {day.runs - 1} restarts")
        judge(day, clients)
    for problem in day.problems:
        print("WRONG:", problem)
    return 1 if day.problems else 0


if __name__ == "__main__":
    sys.exit(main())
