"""Lifts, shakes, turns and holds a box between two pads in MuJoCo: on patches, and on MuJoCo's own contact.

    grip.py FOLDER [--short]

FOLDER has pad.fmu. It gets CONTACT.csv of each contact, drift.csv, order.csv, cost.csv, release.csv, grip.svg and,
where MuJoCo can render, frames.png. With --short the gripper stands for three seconds and shakes less.
"""

import csv
import os
import sys
from functools import cache
from pathlib import Path
from time import perf_counter

os.environ.setdefault("MUJOCO_GL", "egl")

import matplotlib
import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "patch-mujoco"))
from library import attach, step  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

H = 1e-3
# N: of each pad on the box; and of the box.
GRIP, WEIGHT = 25.0, 12.0
# m²: of a pad.
AREA = 4e-4
# m, 1/s: what shakes.
AMPLITUDE, FREQUENCY = 5e-3, 5.0
# m: by how much it lifts.
HEIGHT = 0.15
# m/s: the least of the table; whatever slips is faster.
LEAST_SPEED = 1e-6
# Steps from one row of the tables to the next.
EVERY = 20
# The pads' contact: a patch, or MuJoCo's own with so many iterations of NoSlip.
CONTACTS = {"patch": None, "mujoco": 0, "noslip": 10}
PADS = ("left_pad", "right_pad")
COLUMNS = ("time", "x", "y", "z", "slip", "normal", "tangential", "corrections")


class Plan:
    """When what happens, s."""

    def __init__(self, short=False):
        self.closed = 0.3
        self.lifted = self.closed + 0.5
        self.shaken = self.lifted + (2 if short else 10) / FREQUENCY
        self.turned = self.shaken + (0.6 if short else 1.5)
        self.end = self.turned + (3.0 if short else 11.0)

    def phases(self):
        """Their names and ends."""
        ends = (self.closed, self.lifted, self.shaken, self.turned, self.end)
        return tuple(zip(("close", "lift", "shake", "turn", "stand"), ends))

    def frames(self):
        """When pictures are taken."""
        return (self.closed, self.lifted, 0.6 * self.shaken + 0.4 * self.turned, self.turned, self.end)

    def control(self, time):
        """Height and angle of the hand, force of a finger."""

        def smooth(begin, end):
            t = min(max((time - begin) / (end - begin), 0.0), 1.0)
            return t**3 * (10 - 15 * t + 6 * t * t)

        height = HEIGHT * smooth(self.closed, self.lifted)
        if self.lifted < time < self.shaken:
            # It begins and ends without a leap of speed.
            gate = smooth(self.lifted, self.lifted + 0.1) * smooth(self.shaken, self.shaken - 0.1)
            height += AMPLITUDE * gate * np.sin(2 * np.pi * FREQUENCY * (time - self.lifted))
        return height, np.pi * smooth(self.shaken, self.turned), GRIP * smooth(0.0, 0.8 * self.closed)


class Grip:
    """The gripper with one of the contacts."""

    def __init__(self, fmu, contact, h=H):
        self.model = mujoco.MjModel.from_xml_path(str(HERE / "gripper.xml"))
        self.model.opt.timestep = h
        pads = [self.model.geom(name).id for name in PADS]
        if CONTACTS[contact] is None:
            self.model.geom_contype[pads] = self.model.geom_conaffinity[pads] = 0
        else:
            self.model.geom_friction[pads, 0] = friction(GRIP / AREA)
            self.model.opt.noslip_iterations = CONTACTS[contact]
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.pads = []
        if CONTACTS[contact] is None:
            self.pads = [attach(self.model, self.data, fmu, name, "box") for name in PADS]

    def step(self, control):
        """Returns how often the pads' loads were corrected."""
        height, angle, force = control
        self.data.ctrl[:] = height, angle, force, force
        if self.pads:
            return step(self.model, self.data, self.pads)
        mujoco.mj_step(self.model, self.data)
        return 0

    def place(self):
        """Where the pads are in the box's axes, in the mean of both: m."""
        mujoco.mj_kinematics(self.model, self.data)
        box = self.data.body("box")
        pads = np.mean([self.data.body(name).xpos for name in PADS], axis=0)
        return box.xmat.reshape(3, 3).T @ (pads - box.xpos)

    def slip(self):
        """How far the pads' faces have slipped along the box, without what their springs are stretched, in the mean."""
        slips = []
        for pad in self.pads:
            slips.append(pad.pose[:2] - np.linalg.pinv(pad.tangent()[:2, :2]) @ pad.loads[:2])
        # Both in the axes of the left pad's face: those of the other look the other way.
        (a, b), (c, d) = slips
        return np.array([0.5 * (a + c), 0.5 * (b - d)])

    def forces(self):
        """Of the pads on the box, in the mean: along the normal and along the face, N."""
        if self.pads:
            loads = [pad.loads for pad in self.pads]
            return np.mean([load[2] for load in loads]), np.mean([np.hypot(*load[:2]) for load in loads])
        normal, tangential = 0.0, 0.0
        for name in PADS:
            total = np.zeros(3)
            for i in range(self.data.ncon):
                contact = self.data.contact[i]
                if self.model.geom(name).id in (contact.geom1, contact.geom2):
                    force = np.zeros(6)
                    mujoco.mj_contactForce(self.model, self.data, i, force)
                    # Of frames that differ in their tangents.
                    sign = 1.0 if contact.geom2 == self.model.geom(name).id else -1.0
                    total += sign * contact.frame.reshape(3, 3).T @ force[:3]
                    normal += force[0] / len(PADS)
            along = self.data.body("box").xmat.reshape(3, 3).T @ total
            tangential += np.hypot(along[0], along[2]) / len(PADS)
        return normal, tangential


@cache
def friction(pressure):
    """Of the pads' table at its least speed: what holds."""
    with open(HERE / "pad.table.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    least = min(float(row["speed [m/s]"]) for row in rows)
    rows = [row for row in rows if float(row["speed [m/s]"]) == least]
    pressures = [np.log(float(row["pressure [Pa]"])) for row in rows]
    return float(np.interp(np.log(pressure), pressures, [float(row["friction [1]"]) for row in rows]))


def run(fmu, contact, plan):
    """The rows of a run, the pads' mean places in the box's axes in each second of standing, positions of frames."""
    grip, rows, frames = Grip(fmu, contact), [], []
    seconds = [[] for _ in range(int(plan.end - plan.turned))]
    pending = list(plan.frames())
    for k in range(round(plan.end / H)):
        control = plan.control(k * H)
        corrections = grip.step(control)
        time, place = (k + 1) * H, grip.place()
        second = int((k * H - plan.turned) / 1.0 + 1e-9)
        if k * H >= plan.turned and second < len(seconds):
            seconds[second].append(place)
        if pending and time >= pending[0] - 1e-9:
            frames.append((pending.pop(0), grip.data.qpos.copy()))
        if (k + 1) % EVERY == 0:
            slip = np.linalg.norm(grip.slip()) if grip.pads else np.nan
            rows.append([time, *place, slip, *grip.forces(), corrections])
    return np.array(rows), np.array([np.mean(places, axis=0) for places in seconds]), frames


def displacement(rows, plan):
    """How far the pads have moved along the box's faces since they were closed, m."""
    places = rows[:, [1, 3]]
    return np.linalg.norm(places - places[np.searchsorted(rows[:, 0], plan.closed - 1e-9)], axis=1)


def release(fmu):
    """Lets the fingers go slowly; returns the force of a pad at which the box begins to slip, and Coulomb's."""
    plan, grip = Plan(short=True), Grip(fmu, "patch")
    while grip.data.time < plan.lifted:
        grip.step(plan.control(grip.data.time))
    height, angle, force = plan.control(plan.lifted)
    before, expected = grip.place(), limit()
    while True:
        # Down to near the limit, and on slowly.
        force -= H * (20.0 if force > 1.1 * expected else 0.4)
        grip.step((height, angle, force))
        place = grip.place()
        if force < 1.05 * expected and np.hypot(*(place - before)[[0, 2]]) / H > 0.5 * LEAST_SPEED:
            return grip.forces()[0], expected
        before = place


def limit():
    """The force of a pad (N) at which two hold the box by Coulomb's law."""
    force = GRIP
    for _ in range(50):
        force = 0.5 * WEIGHT / friction(force / AREA)
    return force


def order(fmu, steps=(2e-3, 1e-3, 5e-4, 2.5e-4), reference=6.25e-5):
    """The largest errors of place (m) and force (N) of the pads while the box is lifted, by the step."""

    def lift(h):
        plan, grip, found = Plan(short=True), Grip(fmu, "patch", h), []
        for k in range(round(0.42 / h)):
            grip.step(plan.control(k * h))
            if round((k + 1) * h / 4e-3, 6).is_integer() and (k + 1) * h > plan.closed:
                found.append([grip.place()[2], grip.forces()[1]])
        return np.array(found)

    exact = lift(reference)
    return [[h, *np.abs(lift(h) - exact).max(axis=0)] for h in steps]


def cost(fmu, count=2000):
    """µs, medians of steps while the box is held, turn by turn: MuJoCo's own, the two patches, a step with them."""
    plan = Plan(short=True)
    held = plan.control(plan.lifted)
    grips = {contact: Grip(fmu, contact) for contact in CONTACTS}
    for grip in grips.values():
        while grip.data.time < plan.lifted + 0.5:
            grip.step(plan.control(grip.data.time) if grip.data.time < plan.lifted else held)
    times = {"patches": [], **{contact: [] for contact in CONTACTS}}
    within = []
    for pad in grips["patch"].pads:
        pad.patch.fmu.doStep = timed(pad.patch.fmu.doStep, within)
    for _ in range(count):
        for contact, grip in grips.items():
            begin = perf_counter()
            grip.step(held)
            times[contact].append(perf_counter() - begin)
        times["patches"].append(sum(within))
        within.clear()
    return {name: 1e6 * float(np.median(values)) for name, values in times.items()}


def timed(function, times):
    def call(*arguments):
        begin = perf_counter()
        function(*arguments)
        times.append(perf_counter() - begin)

    return call


def write(path, names, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([value if isinstance(value, str) else repr(float(value)) for value in row] for row in rows)


def draw(path, runs, plan):
    figure, (drift, forces) = pyplot.subplots(2, 1, figsize=(10, 8), sharex=True, layout="constrained")
    labels = {"patch": "patches", "mujoco": "MuJoCo, elliptic cones", "noslip": "the same with NoSlip"}
    for (contact, rows), color in zip(runs.items(), ("C0", "C3", "C1")):
        after = rows[:, 0] > plan.closed + 0.02
        drift.semilogy(rows[after, 0], 1e6 * displacement(rows, plan)[after], color=color, label=labels[contact])
    patch = runs["patch"]
    after = patch[:, 0] > plan.closed + 0.02
    slipped = np.abs(patch[:, 4] - patch[np.searchsorted(patch[:, 0], plan.closed - 1e-9), 4])
    label = "patches, without the springs' stretch"
    drift.semilogy(patch[after, 0], np.maximum(1e6 * slipped[after], 1e-4), color="C0", linestyle=":", label=label)
    drift.set(ylabel="pads along the box since closed in µm", ylim=(1e-3, 1e5))
    forces.plot(patch[:, 0], patch[:, 5], color="C2", label="normal")
    forces.plot(patch[:, 0], patch[:, 6], color="C0", label="along the face")
    coefficient = friction(GRIP / AREA)
    label = f"{coefficient:.3f} times the normal"
    forces.plot(patch[:, 0], coefficient * patch[:, 5], color="C2", linestyle="--", label=label)
    forces.set(xlabel="time in s", ylabel="force of a patch on the box in N", ylim=(0, None))
    begin = 0.0
    for name, end in plan.phases():
        for axis in (drift, forces):
            axis.axvline(end, color="0.8", linewidth=0.8)
        forces.text(0.5 * (begin + end), 27.5, name, ha="center", va="center", rotation=90, fontsize="small")
        begin = end
    forces.set_ylim(0, 30)
    for axis in (drift, forces):
        axis.legend(fontsize="small", loc="lower right" if axis is drift else "center right")
        axis.grid(alpha=0.3)
    figure.savefig(path)


def render(path, frames):
    """A row of pictures a contact."""
    model = mujoco.MjModel.from_xml_path(str(HERE / "gripper.xml"))
    data = mujoco.MjData(model)
    with mujoco.Renderer(model, 300, 230) as renderer:
        rows = []
        for pictures in frames.values():
            row = []
            for _, place in pictures:
                data.qpos[:] = place
                mujoco.mj_forward(model, data)
                renderer.update_scene(data, camera="front")
                row.append(renderer.render().copy())
            rows.append(np.hstack(row))
    pyplot.imsave(path, np.vstack(rows))


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--short"]
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder, short = Path(arguments[0]), "--short" in sys.argv
    plan, fmu = Plan(short), folder / "pad.fmu"
    runs, frames, drifts = {}, {}, []
    for contact in CONTACTS:
        rows, seconds, frames[contact] = run(fmu, contact, plan)
        runs[contact] = rows
        write(folder / f"{contact}.csv", COLUMNS, rows)
        for i, change in enumerate(np.linalg.norm(np.diff(seconds, axis=0), axis=1)):
            drifts.append([contact, i + 1, change])
        moved = 1e6 * displacement(rows, plan)[-1]
        print(f"{contact:7} moved by {moved:.4g} µm since closed, in the last second by {1e6 * drifts[-1][2]:.3g} µm")
    write(folder / "drift.csv", ("contact", "second", "change"), drifts)
    found, expected = release(fmu)
    write(folder / "release.csv", ("found", "expected"), [[found, expected]])
    print(f"slips at {found:.3f} N a pad, by Coulomb's law at {expected:.3f} N")
    errors = order(fmu)
    write(folder / "order.csv", ("step", "place", "force"), errors)
    for h, place, force in errors:
        print(f"step of {1e3 * h:g} ms: off by {1e6 * place:.3g} µm and {force:.3g} N")
    times = cost(fmu)
    write(folder / "cost.csv", times.keys(), [times.values()])
    print("µs a step: " + ", ".join(f"{name} {time:.0f}" for name, time in times.items()))
    draw(folder / "grip.svg", runs, plan)
    try:
        render(folder / "frames.png", {contact: frames[contact] for contact in ("patch", "mujoco")})
    except Exception as error:  # noqa: BLE001: whatever the driver of the display raises
        print(f"no frames.png, MuJoCo cannot render here: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
