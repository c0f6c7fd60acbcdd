"""Brakes a wheel in MuJoCo, whose only contact is the patch, from 5 m/s until it stands: at 10 % of slip and locked,
with the heat of slip and without, with two communication steps.

    braking.py FOLDER

FOLDER has tread.fmu. It gets BRAKE-HEAT-STEP.csv, braking.csv (the stops side by side) and braking.svg.
"""

import csv
import itertools
import sys
from pathlib import Path

import matplotlib
import mujoco

import contact
from library import PatchFmu

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

STEPS = (2e-3, 5e-4)
SPEED, MASS, INERTIA, GRAVITY = 5.0, 300.0, 1.0, 9.81
LOAD = MASS * GRAVITY
# By how much slower than the carrier the brake lets the tread run, as a share of the carrier's speed.
BRAKES = {"slip": 0.1, "locked": 1.0}
# The part of what slip loses that warms the tread; next to none of it.
HEATS = {"warm": 0.05, "cold": 1e-9}
# s: the wheel rolls freely, then the brake comes on evenly.
FREE, ON = 0.05, 0.1
# s: by then it stands.
LONGEST = 3.0
# m: this way the wheel has slid where friction is compared.
COMPARED = 1.0
WRENCH = ("force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z")
CONTACT = ("contact.nominal_area", "contact.temperature_largest", "contact.temperature_mean")
OUTPUTS = (*WRENCH, "transport.force", "E_diss", *CONTACT)
COLUMNS = ("time", "x", "speed", "tread", *OUTPUTS, "E_brake", "E_damper", "E_kinetic")


def slip(time, most):
    """What the brake holds: an anti-lock system, or blocked."""
    return most * min(max((time - FREE) / (ON - FREE), 0.0), 1.0)


class Wheel:
    """The wheel in MuJoCo, rolling freely at the height at which it is borne."""

    def __init__(self, h, most):
        self.most = most
        self.model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("wheel.xml")))
        self.model.opt.timestep = h
        self.data = mujoco.MjData(self.model)
        self.data.joint("x").qvel[0] = SPEED
        self.data.joint("z").qpos[0] = contact.RADIUS + contact.SEPARATION - contact.approach(LOAD)
        self.lost_by_brake = self.lost_by_damper = 0.0
        self.spin = SPEED / contact.rolling_radius(LOAD)
        self.data.joint("spin").qvel[0] = self.spin
        mujoco.mj_forward(self.model, self.data)

    def brake(self):
        """Gives the hinge the speed that the slip wants, and counts the work of the torque that this takes."""
        hinge, speed, before = self.data.joint("spin").qvel, self.data.joint("x").qvel[0], self.spin
        self.spin = (1 - slip(self.data.time, self.most)) * speed / contact.rolling_radius(LOAD)
        self.lost_by_brake += INERTIA * (hinge[0] - self.spin) * 0.5 * (before + self.spin)
        hinge[0] = self.spin

    def step(self, loads):
        """A step under the patch's forces: the wrench on the carrier, at its centre, and the tread's force on the wheel."""
        self.data.body("carrier").xfrc_applied[:] = [loads[name] for name in WRENCH]
        self.data.joint("spin").qfrc_applied[0] = contact.RADIUS * loads["transport.force"]
        mujoco.mj_step(self.model, self.data)
        self.lost_by_damper -= self.model.opt.timestep * float(self.data.qfrc_damper @ self.data.qvel)
        self.brake()
        # Positions that belong to where the joints are now.
        mujoco.mj_kinematics(self.model, self.data)

    def pose(self):
        """What the patch takes: the carrier's pose and the speed of the tread."""
        x, y, z = self.data.body("carrier").xpos
        return [x, y, z, 0.0, 0.0, 0.0, contact.RADIUS * self.data.joint("spin").qvel[0]]

    def row(self, loads):
        """Of the result file."""
        speed, spin = self.data.joint("x").qvel[0], self.data.joint("spin").qvel[0]
        tread = contact.rolling_radius(LOAD) * spin
        kinetic = 0.5 * MASS * speed**2 + 0.5 * INERTIA * spin**2 + 0.5 * MASS * self.data.joint("z").qvel[0] ** 2
        lost = (self.lost_by_brake, self.lost_by_damper, kinetic)
        return [self.data.time, self.data.joint("x").qpos[0], speed, tread, *loads.values(), *lost]


def stop(fmu, h, most, share):
    """The rows of a stop. MuJoCo goes first, by a half-implicit step; the patch follows straight to where it has gone."""
    wheel, patch = Wheel(h, most), PatchFmu(fmu, {"patch.heat.share": share})

    def loads_now():
        return dict(zip(OUTPUTS, patch.get(*OUTPUTS)))

    start = wheel.pose()
    patch.start(0.0, start)
    loads = loads_now()
    rows = [wheel.row(loads)]
    while wheel.data.joint("x").qvel[0] > 0 and wheel.data.time < LONGEST:
        time = wheel.data.time
        wheel.step(loads)
        end = wheel.pose()
        patch.follow(time, h, start, end)
        start, loads = end, loads_now()
        rows.append(wheel.row(loads))
    return rows


def write(path, names, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([value if isinstance(value, str) else repr(float(value)) for value in row] for row in rows)


def column(rows, name):
    index = COLUMNS.index(name)
    return [row[index] for row in rows]


def friction(rows):
    return [-x / z for x, z in zip(column(rows, "force.x"), column(rows, "force.z"))]


def draw(path, stops):
    figure, axes = pyplot.subplots(2, 2, figsize=(11, 8), layout="constrained")
    ((over_way, over_speed), (speeds, temperatures)) = axes
    labels = {"slip": "10 % slip", "locked": "locked", "warm": "with heat", "cold": "without"}
    for (brake, heat), rows in stops.items():
        style = {"color": "C0" if brake == "slip" else "C3", "linestyle": "-" if heat == "warm" else "--"}
        style["label"] = f"{labels[brake]}, {labels[heat]}"
        way, speed = column(rows, "x"), column(rows, "speed")
        over_way.plot(way, friction(rows), **style)
        over_speed.plot(speed, friction(rows), **style)
        speeds.plot(column(rows, "time"), speed, **style)
        celsius = [kelvin - 273.15 for kelvin in column(rows, "contact.temperature_mean")]
        temperatures.plot(way, celsius, **style)
    over_way.set(xlabel="way in m", ylabel="friction, -force.x over force.z", ylim=(0, 1))
    over_speed.set(xlabel="speed in m/s", ylabel="friction, -force.x over force.z", ylim=(0, 1))
    speeds.set(xlabel="time in s", ylabel="speed in m/s")
    temperatures.set(xlabel="way in m", ylabel="mean temperature of the tread in contact in °C")
    for axis in axes.flat:
        axis.legend(fontsize="small")
        axis.grid(alpha=0.3)
    figure.savefig(path)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    table, fine = [], {}
    for (brake, most), (heat, share), h in itertools.product(BRAKES.items(), HEATS.items(), STEPS):
        rows = stop(folder / "tread.fmu", h, most, share)
        write(folder / f"{brake}-{heat}-{1e3 * h:g}ms.csv", COLUMNS, rows)
        compared = friction(rows)[next(i for i, way in enumerate(column(rows, "x")) if way > COMPARED)]
        warmest = max(column(rows, "contact.temperature_largest")) - 273.15
        table.append([brake, heat, h, rows[-1][0], rows[-1][1], compared, warmest])
        fine[brake, heat] = rows
        print(
            f"{brake:6} {heat} {1e3 * h:3g} ms: stands after {rows[-1][0]:.4f} s and {rows[-1][1]:.4f} m, "
            f"friction {compared:.3f} after {COMPARED:g} m, {warmest:.1f} °C at most"
        )
    write(folder / "braking.csv", ("brake", "heat", "step", "time", "distance", "friction", "warmest"), table)
    draw(folder / "braking.svg", fine)


if __name__ == "__main__":
    main()
