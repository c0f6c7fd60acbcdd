"""Contact patches in MuJoCo: a pad on a body, which rubs on a geom.

    from asperity.mujoco import attach, step

    pad = attach(model, data, "pad.fmu", body="pad", geom="box")
    while data.time < 1.0:
        step(model, data, [pad])  # in place of mujoco.mj_step(model, data)

The body's axes are those of the patch: its face looks along -z. The geom is a plane or a box; of a box it is the face
that the pad looks at when it is attached, without its edges. What the body carries there must not collide with the
geom in MuJoCo too (contype, conaffinity or exclude): `attach` warns where it does. Units are SI, as in the model.

A step is implicit in the pads' loads. They belong to where the bodies are at its end: a stiff pad neither rings nor
asks for short steps, and one that sticks holds. MuJoCo knows no derivatives of forces that it has not made, and its
matrices have no place for those between two trees of bodies. So `step` finds the loads by Newton's method over MuJoCo's
own step, with all constraints in it, on a copy of the data, with the slope of the patches' whole law: friction that
rises with a speed of some µm/s is as a strong damper, so that what creeps does so evenly at any step. It is of first
order.
"""

from __future__ import annotations

import math
import shutil
import warnings
import weakref
from collections.abc import Mapping, Sequence
from ctypes import Array, c_double, c_int, c_uint
from os import PathLike
from typing import Any

import fmpy
import mujoco
import numpy as np
from fmpy.fmi2 import FMU2Slave
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

POSE = ("x", "y", "z", "roll", "pitch", "yaw")
WRENCH = ("force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z")
TREAD_SPEED, TREAD_FORCE = "transport.speed", "transport.force"

# Newton's method ends where what is left of the loads moves the bodies by this share of what the change of the loads in
# the step does, or by that of what the loads do. A share of the loads alone would leave small swings to an explicit step,
# which does not damp them.
OF_CHANGE, OF_LOADS = 2e-2, 1e-8
# It ends at a kink of the pads' law, too, where it is known as well how the bodies move, and no more than this share is
# left of the loads.
OF_KINK = 1e-5
# Corrections of the loads in a step. Where these do not suffice, those of which least was left are taken.
MOST_CORRECTIONS = 60
# A correction that has gone too far is taken back until no more than this share of the work is left along it.
LEFT_ALONG_LINE = 0.3
# The way by which the pads' slope is found, as a share of that of a pad in the step and, m, at least.
OF_WAY, LEAST_WAY = 1e-4, 1e-12


class PatchFmu:
    """The FMU of a patch, unpacked; what `Pad` needs of it.

    `inputs` are the pose and, with a tread, its speed; `loads` the wrench and the force on the tread.
    """

    def __init__(self, path: str | PathLike[str], parameters: Mapping[str, float] | None = None) -> None:
        description = fmpy.read_model_description(path)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        missing = [name for name in (*POSE, *WRENCH) if name not in self.references]
        if missing:
            raise ValueError(f"{path}: expected the FMU of a patch with the outputs `forces`, found none of {missing}")
        self.has_tread = TREAD_SPEED in self.references
        folder = fmpy.extract(path)
        self.fmu = FMU2Slave(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=folder,
            instanceName=description.modelName,
        )
        self.fmu.instantiate()
        weakref.finalize(self, _discard, self.fmu, folder)
        self.set(parameters or {})
        self._pose, self._wrench = self._numbers(POSE), self._numbers(WRENCH)
        self._inputs = self._numbers((*POSE, TREAD_SPEED) if self.has_tread else POSE)
        self._loads = self._numbers((*WRENCH, TREAD_FORCE) if self.has_tread else WRENCH)
        self._values = (c_double * len(self._inputs))()
        self._rates = (c_double * len(self._inputs))()
        self._orders = (c_int * len(self._inputs))(*[1] * len(self._inputs))
        self._state: Any = None

    def _numbers(self, names: Sequence[str]) -> Array[c_uint]:
        return (c_uint * len(names))(*[self.references[name] for name in names])

    def set(self, values: Mapping[str, float]) -> None:
        """Sets variables by their names."""
        self.fmu.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, *names: str) -> list[float]:
        """The values of variables by their names."""
        return list(self.fmu.getReal([self.references[name] for name in names]))

    def start(self, time: float, inputs: ArrayLike) -> None:
        """Begins a run, its springs relaxed."""
        self.fmu.setupExperiment(startTime=time)
        self.fmu.enterInitializationMode()
        self._values[:] = np.asarray(inputs, np.float64).tolist()
        self.fmu.fmi2SetReal(self.fmu.component, self._inputs, len(self._inputs), self._values)
        self.fmu.exitInitializationMode()

    def follow(self, time: float, h: float, start: ArrayLike, end: ArrayLike) -> Floats:
        """Steps along the straight way from one set of inputs to another; returns the loads at its end."""
        component, count = self.fmu.component, len(self._inputs)
        before, after = np.asarray(start, np.float64), np.asarray(end, np.float64)
        self._values[:], self._rates[:] = before.tolist(), ((after - before) / h).tolist()
        self.fmu.fmi2SetReal(component, self._inputs, count, self._values)
        self.fmu.fmi2SetRealInputDerivatives(component, self._inputs, count, self._orders, self._rates)
        self.fmu.doStep(time, h)
        return self.loads()

    def loads(self) -> Floats:
        """Force (N), moment (N m) and, with a tread, the force on it (N)."""
        values = (c_double * len(self._loads))()
        self.fmu.fmi2GetReal(self.fmu.component, self._loads, len(self._loads), values)
        return np.array(values)

    def tangent(self) -> Floats:
        """The change of the wrench (rows) with the pose's coordinates, what sticks and what slips held."""
        columns = [self.fmu.getDirectionalDerivative(self._wrench, [one], [1.0]) for one in self._pose]
        return np.array(columns).T

    def save(self) -> None:
        """Keeps the state."""
        if self._state is None:
            self._state = self.fmu.getFMUstate()
        else:
            self.fmu.fmi2GetFMUstate(self.fmu.component, self._state)

    def restore(self) -> None:
        """Goes back to the state kept."""
        self.fmu.setFMUstate(self._state)


def _discard(fmu: Any, folder: str) -> None:
    fmu.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


class Pad:
    """A patch on a body of a model that rubs on a geom. `attach` makes it.

    Attributes:
        pose: of the body in the geom's axes, z along the normal: x, y, z (m), roll, pitch, yaw (rad)
        loads: of the patch on the body in the geom's axes: force (N), moment (N m) about the body's origin and, with a
            tread, the force on it (N)
        patch: the patch itself
    """

    def __init__(
        self, model: Any, data: Any, patch: PatchFmu, body: int, geom: int, spin: tuple[int, float] | None
    ) -> None:
        self.patch = patch
        self._body, self._geom = body, geom
        self._joint: int | None = None if spin is None else spin[0]
        self._radius = 0.0 if spin is None else spin[1]
        self._origin, self._axes = _ground(model, data, body, geom)
        self.pose: Floats = np.zeros(6)
        self.pose = self._pose_of(data)
        self._inputs = self._inputs_of(data, self.pose)
        patch.start(data.time, self._inputs)
        self.loads = patch.loads()

    def _ground_of(self, data: Any) -> tuple[Floats, Floats]:
        """Origin and axes of the ground in the world."""
        axes = data.geom_xmat[self._geom].reshape(3, 3)
        return data.geom_xpos[self._geom] + axes @ self._origin, axes @ self._axes

    def _pose_of(self, data: Any) -> Floats:
        origin, axes = self._ground_of(data)
        place = axes.T @ (data.xpos[self._body] - origin)
        # Rows of the rotation: the ground's axes in the body's.
        x, y, z = (axes.T @ data.xmat[self._body].reshape(3, 3)).tolist()
        roll, yaw = math.atan2(z[1], z[2]), math.atan2(y[0], x[0])
        pitch = math.asin(min(max(-z[0], -1.0), 1.0))
        return np.array([*place, *map(_unwound, (roll, pitch, yaw), self.pose[3:].tolist())])

    def _inputs_of(self, data: Any, pose: Floats) -> Floats:
        if self._joint is None:
            return pose
        return np.append(pose, self._radius * data.qvel[self._joint])

    def jacobian(self, model: Any, data: Any) -> Floats:
        """From the velocities of the joints to those of the body over the ground, in the ground's axes, and, with a
        tread, to its speed."""
        _, axes = self._ground_of(data)
        point = data.xpos[self._body]
        body, ground = np.zeros((2, 3, model.nv)), np.zeros((2, 3, model.nv))
        mujoco.mj_jac(model, data, body[0], body[1], point, self._body)
        mujoco.mj_jac(model, data, ground[0], ground[1], point, model.geom_bodyid[self._geom])
        rows = np.concatenate(axes.T @ (body - ground))
        if self._joint is None:
            return rows
        tread = np.zeros(model.nv)
        tread[self._joint] = self._radius
        return np.vstack([rows, tread])

    def follow(self, time: float, h: float, data: Any) -> Floats:
        """Takes the patch to where the bodies of `data` are; returns its loads there."""
        pose = self._pose_of(data)
        inputs = self._inputs_of(data, pose)
        self._reached = pose, inputs, self.patch.follow(time, h, self._inputs, inputs)
        return self._reached[2]

    def accept(self) -> None:
        """Ends a step where `follow` has led."""
        self.pose, self._inputs, self.loads = self._reached

    def slope(self, time: float, h: float) -> Floats:
        """The change of the loads with the displacement and the turn of the body in this step, and with the way of its
        tread, where `follow` has led: of the patch's whole law, with its speed. The patch is as kept, before and
        after."""
        pose, inputs, loads = self._reached
        way = OF_WAY * float(np.linalg.norm(pose[:3] - self.pose[:3])) + LEAST_WAY
        columns = []
        for i in range(len(inputs)):
            shifted = inputs.copy()
            # The way of a tread is its speed times the step.
            shifted[i] += way if i < len(pose) else way / h
            columns.append((self.patch.follow(time, h, self._inputs, shifted) - loads) / way)
            self.patch.restore()
        slope: Floats = np.array(columns).T
        slope[:, 3:6] = slope[:, 3:6] @ _rates(pose)
        return slope

    def tangent(self) -> Floats:
        """The change of the loads with the displacement and the turn of the body along the ground's axes."""
        tangent = self.patch.tangent()
        tangent[:, 3:] = tangent[:, 3:] @ _rates(self.pose)
        if self._joint is None:
            return tangent
        # A tread that runs to the rear drags its springs as a body that moves ahead does, the other way round.
        ahead = np.array([np.cos(self.pose[5]), np.sin(self.pose[5]), 0.0])
        column = -tangent[:, :3] @ ahead
        row = -ahead @ tangent[:3]
        return np.block([[tangent, column[:, None]], [row, -ahead @ column[:3]]])


def attach(
    model: Any,
    data: Any,
    patch: str | PathLike[str] | PatchFmu,
    body: str | int,
    geom: str | int,
    spin: tuple[str, float] | None = None,
) -> Pad:
    """Gives a body a pad that rubs on a geom, where both are in `data` now; returns the pad.

    Args:
        patch: path of a patch's FMU (`asperity pack --patch`), or a `PatchFmu`, which takes parameters
        body: name or number of the body that carries the pad; its axes are the patch's
        geom: name or number of the geom on which it rubs, a plane or a box
        spin: of a patch with a tread, the name of the hinge that drives it and the radius of the tread (m)

    Raises:
        ValueError: of a geom of another type, a patch with a tread without `spin`, an integrator that `step` has not
    """
    carrier, ground = model.body(body).id, model.geom(geom).id
    if isinstance(patch, (str, PathLike)):
        patch = PatchFmu(patch)
    if patch.has_tread != (spin is not None):
        raise ValueError("`spin` is expected of a patch with a tread, and of no other")
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        raise ValueError("integrator: expected Euler, implicit or implicitfast, found RK4")
    mujoco.mj_kinematics(model, data)
    sharing = [_name(model, own) for own in _geoms_of(model, carrier) if _collide(model, own, ground)]
    if sharing:
        warnings.warn(
            f"geoms {', '.join(sharing)} of body {model.body(carrier).name!r} collide with {_name(model, ground)} in "
            "MuJoCo too and take a part of the pad's load: set contype and conaffinity to 0, or exclude the bodies",
            stacklevel=2,
        )
    driven = None if spin is None else (int(model.joint(spin[0]).dofadr[0]), spin[1])
    return Pad(model, data, patch, carrier, ground, driven)


def _name(model: Any, geom: int) -> str:
    name = model.geom(geom).name
    return repr(name) if name else str(geom)


def _geoms_of(model: Any, body: int) -> range:
    first = int(model.body_geomadr[body])
    return range(first, first + int(model.body_geomnum[body]))


def _collide(model: Any, a: int, b: int) -> bool:
    """Whether MuJoCo looks for contacts of two geoms (its chapter "Computation", "Selection")."""
    if any({a, b} == {int(first), int(second)} for first, second in zip(model.pair_geom1, model.pair_geom2)):
        return True
    bodies = sorted(int(model.geom_bodyid[geom]) for geom in (a, b))
    if (bodies[0] << 16) + bodies[1] in model.exclude_signature:
        return False
    # Geoms that move together do not collide, nor do those of a body and its parent, but for the world.
    welded = [int(model.body_weldid[body]) for body in bodies]
    parents = [int(model.body_weldid[model.body_parentid[body]]) for body in welded]
    is_family = 0 not in welded and (welded[0] == parents[1] or welded[1] == parents[0])
    filters_family = not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT
    if welded[0] == welded[1] or (is_family and filters_family):
        return False
    kinds = [(int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])) for geom in (a, b)]
    return bool(kinds[0][0] & kinds[1][1] or kinds[1][0] & kinds[0][1])


def step(model: Any, data: Any, pads: Pad | Sequence[Pad]) -> int:
    """A step of MuJoCo under the loads of its pads, in place of `mujoco.mj_step`; returns how often it corrected them.

    `pads` are all those of the model, or the only one: those that press on the same bodies are solved together.
    """
    pads = [pads] if isinstance(pads, Pad) else pads
    if not pads:
        mujoco.mj_step(model, data)
        return 0
    mujoco.mj_step1(model, data)
    trial = _Trial(model, data, np.vstack([pad.jacobian(model, data) for pad in pads]))
    loads, corrections = _solve(trial, pads)
    for pad in pads:
        pad.accept()
    # The step that was tried last once more, for good.
    applied = data.qfrc_applied.copy()
    data.qfrc_applied += trial.jacobian.T @ loads
    mujoco.mj_step2(model, data)
    data.qfrc_applied[:] = applied
    return corrections


def _solve(trial: _Trial, pads: Sequence[Pad]) -> tuple[Floats, int]:
    """The loads that belong to where they move the bodies, by Newton's method; leaves the patches there. Also returns
    how many corrections it took."""
    begin = loads = np.concatenate([pad.loads for pad in pads])
    for pad in pads:
        pad.patch.save()
    wanted = trial.follow(loads, pads)
    mobility = trial.mobility()
    line: _Line | None = None
    best, corrections = (math.inf, loads), 0
    while True:
        left = wanted - loads
        distance, change = _reach(mobility, left), _reach(mobility, wanted - begin)
        allowed = OF_CHANGE * change + OF_LOADS * _reach(mobility, wanted)
        best = min(best, (distance, loads), key=lambda found: found[0])
        # At a kink what is left leaps, while it is known where the bodies go.
        between = math.inf if line is None else line.enclose(left)
        is_kink = between <= allowed and distance <= OF_KINK * _reach(mobility, wanted)
        if corrections > 0 and (distance <= allowed or is_kink):
            return loads, corrections
        for pad in pads:
            pad.patch.restore()
        if corrections == MOST_CORRECTIONS:
            trial.follow(best[1], pads)
            return best[1], corrections
        slope = _diagonal([pad.slope(trial.time, trial.h) for pad in pads])
        share = None if line is None else line.next_share(slope)
        if share is None:
            line, share = _Line.along_correction(slope, mobility, left), 1.0
        assert line is not None
        loads = loads + share * line.correction
        wanted = trial.follow(loads, pads)
        corrections += 1


class _Line:
    """The way along a correction. The work that what is left of the loads does along it falls as bodies give way; where
    a correction has gone so far that it is negative, what is sought lies between: where a pad begins to stick, and
    where friction rises steeply with a speed of some µm/s, Newton's method alone goes to and fro."""

    def __init__(self, slope: Floats, mobility: Floats, left: Floats) -> None:
        correction = np.linalg.solve(np.eye(len(left)) - slope @ mobility, left)
        self.correction: Floats = np.asarray(correction, dtype=np.float64)
        self._moved = mobility @ self.correction
        self._reach = _reach(mobility, self.correction)
        self.first = self._work = float(left @ self._moved)
        # As shares of the correction: the last place, and those between which that work is 0.
        self._at, self._low, self._high = 1.0, 0.0, math.inf

    @classmethod
    def along_correction(cls, slope: Floats, mobility: Floats, left: Floats) -> _Line:
        """Along Newton's correction; where what is left does no work along it, as friction that follows the normal
        force may have it, along that by the symmetric part of the slope."""
        newton = cls(slope, mobility, left)
        return newton if newton.first > 0.0 else cls(0.5 * (slope + slope.T), mobility, left)

    def enclose(self, left: Floats) -> float:
        """Notes what is left of the loads at the last place; returns by how much the bodies move between the places
        that enclose what is sought."""
        self._work = float(left @ self._moved)
        if self._work > 0.0:
            self._low = self._at
        else:
            self._high = self._at
        return (self._high - self._low) * self._reach

    def next_share(self, slope: Floats) -> float | None:
        """The share of the correction to go on by, with this slope at the last place; `None` where the line has
        served."""
        if abs(self._work) <= LEFT_ALONG_LINE * abs(self.first) or self.first <= 0.0 or math.isinf(self._high):
            return None
        # By Newton's method too; where it leads beyond the places, to just inside.
        rate = float(self._moved @ self.correction - self._moved @ slope @ self._moved)
        to = self._at + self._work / rate if rate > 0.0 else math.copysign(math.inf, self._work)
        if not self._low < to < self._high:
            inside = 0.1 * (self._high - self._low)
            to = self._low + inside if to <= self._low else self._high - inside
        share, self._at = to - self._at, to
        return share


def _rates(pose: Floats) -> Floats:
    """The rates of roll, pitch and yaw of an angular velocity."""
    _, pitch, yaw = pose[3:]
    c, s = np.cos(yaw), np.sin(yaw)
    cosine, slope = np.cos(pitch), np.tan(pitch)
    return np.array([[c / cosine, s / cosine, 0.0], [-s, c, 0.0], [c * slope, s * slope, 1.0]])


def _unwound(angle: float, before: float) -> float:
    """An angle, but for whole turns, nearest to the one before, rad: it goes on where a turn is full."""
    change = before - angle
    return angle + (change - math.remainder(change, math.tau))


def _reach(mobility: Floats, loads: Floats) -> float:
    """How much loads move the bodies, as the root of twice their work."""
    return math.sqrt(max(float(loads @ mobility @ loads), 0.0))


class _Trial:
    """The second half of a step on a copy of the data."""

    _scratch: weakref.WeakKeyDictionary[Any, Any] = weakref.WeakKeyDictionary()

    def __init__(self, model: Any, data: Any, jacobian: Floats) -> None:
        self.model, self._data, self.jacobian = model, data, jacobian
        self.time, self.h = float(data.time), float(model.opt.timestep)
        if model not in self._scratch:
            self._scratch[model] = mujoco.MjData(model)
        self.data = self._scratch[model]

    def follow(self, loads: Floats, pads: Sequence[Pad]) -> Floats:
        """With these loads; returns those of the pads where it moves the bodies."""
        mujoco.mj_copyData(self.data, self.model, self._data)
        self.data.qfrc_applied += self.jacobian.T @ loads
        mujoco.mj_step2(self.model, self.data)
        mujoco.mj_kinematics(self.model, self.data)
        return np.concatenate([pad.follow(self.time, self.h, self.data) for pad in pads])

    def mobility(self) -> Floats:
        """How the displacements of the bodies over the grounds change with the loads: of the masses and of the
        constraints that were active."""
        constraints = _constraint_jacobian(self.model, self.data)
        active = (self.data.efc_state == _QUADRATIC) | (self.data.efc_state == _CONE)
        rows = np.vstack([self.jacobian, constraints[active]])
        solved = np.zeros_like(rows)
        mujoco.mj_solveM(self.model, self._data, solved, rows)
        inverse, count = rows @ solved.T, len(self.jacobian)
        free, across, within = inverse[:count, :count], inverse[:count, count:], inverse[count:, count:]
        held = across @ np.linalg.solve(within + np.diag(self.data.efc_R[active]), across.T)
        mobility: Floats = self.h**2 * (free - held)
        return mobility


_QUADRATIC = int(mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC)
_CONE = int(mujoco.mjtConstraintState.mjCNSTRSTATE_CONE)


def _constraint_jacobian(model: Any, data: Any) -> Floats:
    """One row a constraint."""
    rows = np.zeros((data.nefc, model.nv))
    if not mujoco.mj_isSparse(model):
        return np.asarray(data.efc_J).reshape(rows.shape)
    for i, (first, count) in enumerate(zip(data.efc_J_rowadr, data.efc_J_rownnz)):
        rows[i, data.efc_J_colind[first : first + count]] = data.efc_J[first : first + count]
    return rows


def _diagonal(blocks: Sequence[Floats]) -> Floats:
    size = sum(len(block) for block in blocks)
    matrix, first = np.zeros((size, size)), 0
    for block in blocks:
        matrix[first : first + len(block), first : first + len(block)] = block
        first += len(block)
    return matrix


def _ground(model: Any, data: Any, body: int, geom: int) -> tuple[Floats, Floats]:
    """Origin and axes of a geom's face in its own: a plane, or the side of a box at which the pad looks."""
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return np.zeros(3), np.eye(3)
    if kind != mujoco.mjtGeom.mjGEOM_BOX:
        name, found = model.geom(geom).name, mujoco.mjtGeom(kind).name
        raise ValueError(f"geom {name!r}: expected a plane or a box, found {found}")
    # The pad looks along -z of its body.
    normal = data.geom_xmat[geom].reshape(3, 3).T @ data.xmat[body].reshape(3, 3)[:, 2]
    axis = int(np.argmax(np.abs(normal)))
    z = np.sign(normal[axis]) * np.eye(3)[axis]
    x = np.eye(3)[(axis + 1) % 3]
    return model.geom_size[geom][axis] * z, np.column_stack([x, np.cross(z, x), z])
