"""Simulates fleets of growing size that get new goals all the time, and draws their throughput.

python3 sweep_robots.py [SECONDS] [PICTURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import coppice

seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 120.0
sizes = [5, 10, 20, 30]
rates = []
for robots in sizes:
    run = coppice.simulate(coppice.Scenario.generate("rooms", robots), lifelong=seconds)
    assert not run.broken, run.broken
    rates.append(run.report.missions / seconds)
    print(f"{robots} robots: {rates[-1]:.2f} goals per second")

figure, axes = plt.subplots()
axes.plot(sizes, rates, "o-")
axes.set(xlabel="robots", ylabel="goals per second", ylim=(0, None))
figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "throughput.png")
