"""Measures what a call from Python costs more than its work: the median of 200 plans whose ways are straight lines.

PYTHONPATH=build/release/python python3 bench/python_call.py
"""

import time

import numpy as np

import coppice

CALLS = 200
ROBOTS = 50

map = coppice.Map(np.zeros((512, 512), dtype=bool))
starts, goals = coppice.random_tasks(map, ROBOTS, radius=5)
overheads = []
for _ in range(CALLS):
    begin = time.perf_counter()
    plan = coppice.plan(map, starts, goals, radius=5)
    overheads.append(time.perf_counter() - begin - plan.plan_time - plan.improve_time)
print(f"{ROBOTS} robots: a call costs {1e3 * np.median(overheads):.3f} ms more than its work")
