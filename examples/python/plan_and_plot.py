"""Plans paths on a map and draws them, with the trees of all robots in the colours of their robots.

python3 plan_and_plot.py [MAP] [PICTURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import LineCollection

import coppice

RADIUS = 5.0

map = coppice.Map(sys.argv[1]) if len(sys.argv) > 1 else coppice.Map.generate("room", 512, 512, seed=1)
starts, goals = coppice.random_tasks(map, 8, radius=RADIUS, least_share=0.4)
plan = coppice.plan(map, starts, goals, radius=RADIUS)

figure, axes = plt.subplots(figsize=(8, 8))
axes.imshow(map.blocked, cmap="Greys", origin="lower", extent=map.extent)
colours = plt.cm.tab10.colors
segments = plan.edges.reshape(-1, 2, 2)
axes.add_collection(
    LineCollection(segments, linewidths=0.4, colors=[colours[r % 10] if r >= 0 else "silver" for r in plan.edge_robots])
)
for robot, path in enumerate(plan.paths):
    axes.plot(path[:, 0], path[:, 1], color=colours[robot % 10], linewidth=2, label=f"{plan.lengths[robot]:.0f} m")
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
if not map.y_up:
    axes.invert_yaxis()
figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "plan.png", dpi=100, bbox_inches="tight")
