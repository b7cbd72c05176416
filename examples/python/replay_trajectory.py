"""Replays a trajectory that `coppice run --trajectory FILE` or `coppice simulate --trajectory FILE` recorded.

python3 replay_trajectory.py SCENARIO.json TRAJECTORY.csv [MOVIE.gif]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

import coppice

FRAMES_A_SECOND = 5

scenario = coppice.Scenario.read(sys.argv[1])
trajectories = coppice.read_trajectories(sys.argv[2])
end = max(rows[-1, 0] for rows in trajectories.values())

figure, axes = plt.subplots(figsize=(5, 5))
axes.imshow(scenario.map.blocked, cmap="Greys", origin="lower", extent=scenario.map.extent)
if not scenario.map.y_up:
    axes.invert_yaxis()
discs = {
    name: axes.add_patch(plt.Circle(start, radius, color=plt.cm.tab20.colors[k % 20]))
    for k, (name, start, radius) in enumerate(zip(scenario.names, scenario.starts, scenario.radius))
}


def draw(time):
    axes.set_title(f"{time:.1f} s")
    for name, rows in trajectories.items():
        discs[name].center = tuple(np.interp(time, rows[:, 0], rows[:, column]) for column in (1, 2))


movie = FuncAnimation(figure, draw, frames=np.arange(0, end, 1 / FRAMES_A_SECOND))
movie.save(sys.argv[3] if len(sys.argv) > 3 else "replay.gif", writer=PillowWriter(fps=FRAMES_A_SECOND))
