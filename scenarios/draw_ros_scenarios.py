#!/usr/bin/env python3
"""Draws the ROS maps of a storehouse and an office, at 5 cm, and scenarios with robots like TurtleBots.

The files lie beside this one, so that nobody needs to run it. The same seed gives the same files.
"""
import json
import math
import pathlib
import random
import struct
import zlib

FOLDER = pathlib.Path(__file__).parent
RESOLUTION = 0.05  # metres a cell
RADIUS = 0.22      # metres
ROOM = 0.33        # metres from a start or goal to the nearest obstacle
APART = 0.75       # metres between two starts, or two goals


class Site:
    def __init__(self, width, height):
        self.columns, self.rows = round(width / RESOLUTION), round(height / RESOLUTION)
        self.blocked = [bytearray(self.columns) for _ in range(self.rows)]
        for x, y, w, h in ((0, 0, width, 0.15), (0, height - 0.15, width, 0.15),
                           (0, 0, 0.15, height), (width - 0.15, 0, 0.15, height)):
            self.block(x, y, w, h)

    def block(self, x, y, width, height, free=False):
        """Metres; row 0 is the lowest one."""
        for j in range(round(y / RESOLUTION), round((y + height) / RESOLUTION)):
            for i in range(round(x / RESOLUTION), round((x + width) / RESOLUTION)):
                self.blocked[j][i] = 0 if free else 1

    def is_free(self, x, y, room):
        reach = math.ceil(room / RESOLUTION)
        column, row = int(x / RESOLUTION), int(y / RESOLUTION)
        for j in range(row - reach, row + reach + 1):
            for i in range(column - reach, column + reach + 1):
                outside = not (0 <= i < self.columns and 0 <= j < self.rows)
                if outside or self.blocked[j][i]:
                    dx = max(abs((i + 0.5) * RESOLUTION - x) - RESOLUTION / 2, 0)
                    dy = max(abs((j + 0.5) * RESOLUTION - y) - RESOLUTION / 2, 0)
                    if math.hypot(dx, dy) < room:
                        return False
        return True

    def write(self, name):
        """As map_server reads it: a grey picture whose first row is the highest one."""
        rows = b"".join(b"\0" + bytes(0 if cell else 254 for cell in row) for row in reversed(self.blocked))

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        header = struct.pack(">IIBBBBB", self.columns, self.rows, 8, 0, 0, 0, 0)
        picture = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                   + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
        (FOLDER / f"{name}.png").write_bytes(picture)
        (FOLDER / f"{name}.yaml").write_text(
            f"image: {name}.png\nresolution: {RESOLUTION}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n")


def storehouse():
    """Shelves of 4.5 x 1 m with aisles of 1.6 m, and an open strip at either end."""
    site = Site(24, 16)
    for y in (2.2, 4.8, 7.4, 10.0, 12.6):
        for x in (3.5, 9.75, 16.0):
            site.block(x, y, 4.5, 1.0)
    return site


def office():
    """Twelve rooms at both sides of a hall, with doors of 1.2 m, and desks."""
    site = Site(24, 14)
    for y in (5.2, 8.6):
        site.block(0, y, 24, 0.15)
    for x in (4, 8, 12, 16, 20):
        site.block(x, 0, 0.15, 5.2)
        site.block(x, 8.6, 0.15, 5.4)
    for k in range(6):
        site.block(4 * k + 1.4, 5.2, 1.2, 0.15, free=True)
        site.block(4 * k + 1.4, 8.6, 1.2, 0.15, free=True)
        site.block(4 * k + 0.9, 2.0, 1.4, 0.7)
        site.block(4 * k + 0.9, 11.4, 1.4, 0.7)
    return site


def places(site, count, draw):
    found = []
    while len(found) < count:
        x = draw.uniform(0, site.columns * RESOLUTION)
        y = draw.uniform(0, site.rows * RESOLUTION)
        if all(math.dist((x, y), p) >= APART for p in found) and site.is_free(x, y, ROOM):
            found.append((x, y))
    return found


def write_scenario(name, map_name, site, count, seed, mixed=False):
    """`mixed`: every third robot is a smaller holonomic one."""
    draw = random.Random(seed)
    starts, goals = places(site, count, draw), places(site, count, draw)
    robots = []
    for k, ((x, y), (goal_x, goal_y)) in enumerate(zip(starts, goals)):
        robot = {"name": f"r{k + 1}", "start": {"x": round(x, 3), "y": round(y, 3)},
                 "goal": {"x": round(goal_x, 3), "y": round(goal_y, 3)}}
        if mixed and k % 3 == 2:
            robot |= {"kinematics": "holonomic", "radius": 0.15, "max_speed": 0.8}
        else:
            robot["start"]["yaw"] = round(draw.uniform(-math.pi, math.pi), 3)
            robot["goal"]["yaw"] = round(draw.uniform(-math.pi, math.pi), 3)
        robots.append(robot)
    scenario = {"map": f"{map_name}.yaml", "kinematics": "differential", "radius": RADIUS, "max_speed": 0.5,
                "max_acceleration": 1.0, "max_angular_speed": 1.9, "max_angular_acceleration": 4.0,
                "goal_tolerance": 0.1, "seed": seed, "robots": robots}
    (FOLDER / f"{name}.json").write_text(json.dumps(scenario, indent=1) + "\n")


def main():
    for name, site in (("storehouse", storehouse()), ("office", office())):
        site.write(name)
        write_scenario(f"{name}-10", name, site, 10, 1)
        write_scenario(f"{name}-20", name, site, 20, 2)
        write_scenario(f"{name}-mixed-20", name, site, 20, 3, mixed=True)


if __name__ == "__main__":
    main()
