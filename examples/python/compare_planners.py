"""Compares the planners on random tasks: time until all first paths, and length of the final paths.

python3 compare_planners.py [KIND] [ROBOTS]
"""

import sys

import numpy as np

import coppice

RADIUS = 5.0
SEEDS = range(1, 6)
kind = sys.argv[1] if len(sys.argv) > 1 else "room"
robots = int(sys.argv[2]) if len(sys.argv) > 2 else 10

print(f"{kind}, {robots} robots, medians of {len(SEEDS)} seeds")
print(f"{'planner':10} {'plan s':>8} {'length m':>9} {'nodes':>8}")
for planner in ("ma-rrdt", "rrdt", "rrt-star"):
    times, lengths, nodes = [], [], []
    for seed in SEEDS:
        map = coppice.Map.generate(kind, 512, 512, seed=seed)
        starts, goals = coppice.random_tasks(map, robots, radius=RADIUS, seed=seed)
        plan = coppice.plan(map, starts, goals, radius=RADIUS, planner=planner, seed=seed)
        times.append(plan.plan_time)
        lengths.append(np.nanmean(plan.lengths))
        nodes.append(sum(plan.valid_nodes) + plan.disjointed_nodes[0])
    print(f"{planner:10} {np.median(times):8.3f} {np.median(lengths):9.1f} {np.median(nodes):8.0f}")
