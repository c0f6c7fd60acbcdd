"""Brakes a wheel in MuJoCo, whose only contact is the patch, until it stands; with two communication steps.

    braking.py FOLDER

FOLDER has tread.fmu. It gets braking-STEP.csv, braking.csv (the stops side by side) and braking.svg.
"""

import csv
import sys
from pathlib import Path

import matplotlib
import mujoco

import brush
from patch import OUTPUTS, Patch

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

STEPS = (2e-3, 5e-4)
# s: between the rows that are drawn.
DRAWN = 8e-3
SPEED, MASS, INERTIA, GRAVITY = 15.0, 300.0, 1.0, 9.81
LOAD = MASS * GRAVITY
# s: by then it stands.
LONGEST = 5.0
# s, N m: the brake comes on evenly, holds, comes on more and locks the wheel.
BRAKE = ((0.1, 0.0), (0.3, 600.0), (0.8, 600.0), (0.9, 1200.0))
COLUMNS = ("time", "x", "speed", "tread", "slip", *OUTPUTS, "E_brake", "E_damper", "E_kinetic", "brush")


def brake(time):
    """The torque of the brake."""
    for (t0, a), (t1, b) in zip(BRAKE, BRAKE[1:]):
        if time < t1:
            return a + (b - a) * max(time - t0, 0.0) / (t1 - t0)
    return BRAKE[-1][1]


def pose(data):
    """What the patch takes: the carrier's pose and the speed of the tread."""
    x, y, z = data.body("carrier").xpos
    return [x, y, z, 0.0, 0.0, 0.0, brush.RADIUS * data.joint("spin").qvel[0]]


class Wheel:
    """The wheel in MuJoCo, rolling freely at the height at which springs bear it."""

    def __init__(self, h):
        self.model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("wheel.xml")))
        self.model.opt.timestep = h
        self.data = mujoco.MjData(self.model)
        self.data.joint("x").qvel[0] = SPEED
        self.data.joint("z").qpos[0] = brush.RADIUS - brush.approach(LOAD)
        self.data.joint("spin").qvel[0] = SPEED / brush.rolling_radius(LOAD)
        mujoco.mj_forward(self.model, self.data)
        self.lost_by_brake = self.lost_by_damper = 0.0

    def step(self, loads):
        """A step under the patch's forces: the wrench acts on the carrier, at its centre, and the tread's force on the wheel."""
        self.data.body("carrier").xfrc_applied[:] = [loads[name] for name in OUTPUTS[:6]]
        self.data.joint("spin").qfrc_applied[0] = brush.RADIUS * loads["transport.force"]
        # Dry friction in the hinge.
        spin = self.model.joint("spin").dofadr[0]
        self.model.dof_frictionloss[spin] = brake(self.data.time)
        mujoco.mj_step(self.model, self.data)
        h = self.model.opt.timestep
        self.lost_by_brake -= h * self.data.qfrc_constraint[spin] * self.data.qvel[spin]
        self.lost_by_damper -= h * float(self.data.qfrc_damper @ self.data.qvel)
        # Positions that belong to where the joints are now.
        mujoco.mj_kinematics(self.model, self.data)

    def row(self, loads):
        """Of the result file."""
        speed, spin = self.data.joint("x").qvel[0], self.data.joint("spin").qvel[0]
        tread = brush.rolling_radius(LOAD) * spin
        kinetic = 0.5 * MASS * speed**2 + 0.5 * INERTIA * spin**2 + 0.5 * MASS * self.data.joint("z").qvel[0] ** 2
        # With the tread at rest the slip is as large as one likes.
        slip = (speed - tread) / tread if tread > 1e-3 * SPEED else float("inf")
        closed = brush.force(max(slip, 0.0), loads["force.z"])
        lost = (self.lost_by_brake, self.lost_by_damper, kinetic)
        return [self.data.time, self.data.joint("x").qpos[0], speed, tread, slip, *loads.values(), *lost, closed]


def stop(fmu, h):
    """The rows of a stop. MuJoCo goes first, by a half-implicit step; the patch follows it straight to where it has gone."""
    wheel = Wheel(h)
    start = pose(wheel.data)
    patch = Patch(fmu, start)
    try:
        loads = patch.values()
        rows = [wheel.row(loads)]
        while wheel.data.joint("x").qvel[0] > 0 and wheel.data.time < LONGEST:
            time = wheel.data.time
            wheel.step(loads)
            end = pose(wheel.data)
            patch.follow(time, h, start, end)
            start, loads = end, patch.values()
            rows.append(wheel.row(loads))
        return rows
    finally:
        patch.close()


def write(path, names, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([repr(float(value)) for value in row] for row in rows)


def column(rows, name):
    index = COLUMNS.index(name)
    return [row[index] for row in rows]


def draw(path, stops, closed):
    figure, axes = pyplot.subplots(2, 2, figsize=(11, 8), layout="constrained")
    ((speeds, slips), (forces, law)) = axes
    for h, every in stops.items():
        rows = every[:: round(DRAWN / h)]
        time, label = column(rows, "time"), f"patch, {1e3 * h:g} ms"
        speeds.plot(time, column(rows, "speed"), label=f"carrier: {label}")
        speeds.plot(time, column(rows, "tread"), label=f"tread: {label}")
        slips.plot(time, column(rows, "slip"), label=label)
        forces.plot(time, [-value for value in column(rows, "force.x")], label=f"-force.x: {label}")
        forces.plot(time, column(rows, "force.z"), label=f"force.z: {label}")
        law.plot(column(rows, "slip"), [-value for value in column(rows, "force.x")], ".", markersize=3, label=label)
    closed = closed[::400]
    speeds.plot([row[0] for row in closed], [row[2] for row in closed], "k--", label="brush model")
    speeds.plot([row[0] for row in closed], [row[3] for row in closed], "k--")
    grid = [0.15 * i / 200 for i in range(201)]
    law.plot(grid, [brush.force(slip, LOAD) for slip in grid], "k--", label="brush model, even load")
    slips.set(xlabel="time in s", ylabel="slip", ylim=(-0.01, 0.2))
    speeds.set(xlabel="time in s", ylabel="speed in m/s")
    forces.set(xlabel="time in s", ylabel="force in N")
    law.set(xlabel="slip", ylabel="braking force in N", xlim=(-0.005, 0.15))
    for axis in axes.flat:
        axis.legend(fontsize="small")
        axis.grid(alpha=0.3)
    figure.savefig(path)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    stops = {h: stop(folder / "tread.fmu", h) for h in STEPS}
    closed = brush.stop(MASS, INERTIA, LOAD, SPEED, brake)
    table = []
    for h, rows in stops.items():
        write(folder / f"braking-{1e3 * h:g}ms.csv", COLUMNS, rows)
        table.append([h, rows[-1][0], rows[-1][1]])
    table.append([0.0, closed[-1][0], closed[-1][1]])
    write(folder / "braking.csv", ("step", "time", "distance"), table)
    for h, time, distance in table:
        print(f"{f'{1e3 * h:g} ms' if h else 'brush model':12} stands after {time:.4f} s and {distance:.4f} m")
    draw(folder / "braking.svg", stops, closed)


if __name__ == "__main__":
    main()
