"""The contact model by scipy's solve_ivp, event driven: Radau or BDF with the sparsity of the Jacobian.

    scipy_contact.py SCENE.json OUT.csv RTOL [--method Radau|BDF] [--points N]

SCENE.json is what `asperity describe --json` prints. OUT.csv holds time, F_x, F_z, E_diss at the start and at N (50)
even times a phase; on standard output one line of what the run took. Equation numbers are the paper's.

The state is a structure of arrays over the masses in the carrier's frame, as in cvode/layer.h, and E_diss without the
impacts:

    e_x | e_z | r_x | r_z | a_j of the vertical, horizontal, lateral x, lateral z links | E_diss
"""

import argparse
import csv
import json

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.sparse import lil_matrix

import flatten

FREE, STICKING = 0, 2  # and 1, -1: slipping in that direction
LENGTH = 1e-6  # m, absolute tolerance of an elongation over the relative one, as in sundials_contact


class Profile:
    """The rigid profile z_r, its slope and curvature."""

    def __init__(self, surface):
        self.periodic, x, z = surface["periodic"], np.array(surface["x"]), np.array(surface["z"])
        self.start, self.end = x[0], x[-1]
        self.spline = CubicSpline(x, z, bc_type="periodic" if self.periodic else "natural")
        self.derivatives = [self.spline, self.spline.derivative(), self.spline.derivative(2)]

    def at(self, x):
        """z_r, s, κ; a natural spline goes on straight beyond its ends."""
        if self.periodic:
            return [part(x) for part in self.derivatives]
        inside = np.clip(x, self.start, self.end)
        z, s, kappa = (part(inside) for part in self.derivatives)
        return [z + s * (x - inside), s, np.where(x == inside, kappa, 0.0)]


class Motion:
    """What follows from a state at an instant. Arrays have masses along their first axis, and a second axis where
    several states are given at once, as for the Jacobian."""


class Layer:
    """The layer under its carrier; modes stand fixed between events."""

    def __init__(self, scene):
        flatten.check(scene)
        layer = scene["layer"]
        self.k, self.mass, self.relaxed = layer["masses"], layer["mass"], layer["initial"] == "relaxed"
        self.rest_x, self.rest_z = (np.array(places) for places in flatten.rest_places(layer))
        self.mu, self.shear = flatten.friction_of(scene)
        self.has_friction = self.mu > 0 or self.shear > 0
        self.profile = Profile(scene["surface"])
        self.links = []  # c, d, c_j, 1/τ_j, where the elements stand in the state, number of links
        start = 4 * self.k
        for name in flatten.LINKS:
            c, d, elements = flatten.link_constants(layer[name])
            count = self.k - 1 if name.startswith("lateral") else self.k
            end = start + count * len(elements)
            pairs = np.array(elements).reshape(-1, 2)
            self.links.append((c, d, pairs[:, 0], 1 / pairs[:, 1], slice(start, end), count))
            start = end
        self.order = start + 1
        self.mode = np.zeros(self.k, dtype=int)
        self.stuck_at = np.zeros(self.k)
        self.enter_phase(0.0, 0.0, 0.0, scene["excitation"][0])

    def enter_phase(self, t, u, w, phase):
        self.phase_start, self.phase_u, self.phase_w, self.phase = t, u, w, phase

    def carrier(self, t):
        """u, w, their rates and accelerations."""
        s, parts = t - self.phase_start, []
        for start, path in ((self.phase_u, self.phase["u"]), (self.phase_w, self.phase["w"])):
            omega, swing = 2 * np.pi * path["frequency"], path["amplitude"]
            sine, cosine = np.sin(omega * s), np.cos(omega * s)
            parts.append(
                (
                    start + path["rate"] * s + swing * sine,
                    path["rate"] + swing * omega * cosine,
                    -swing * omega**2 * sine,
                )
            )
        return [value for pair in zip(*parts) for value in pair]

    def motion(self, t, y):
        """Motion with the constraints put in, forces of the links."""
        k, m = self.k, Motion()
        m.u, m.w, m.u_rate, m.w_rate, m.u_acceleration, m.w_acceleration = self.carrier(t)
        shape = (k,) + (1,) * (y.ndim - 1)
        mode, rest_x, rest_z = self.mode.reshape(shape), self.rest_x.reshape(shape), self.rest_z.reshape(shape)
        m.sticks, m.contact, m.direction = mode == STICKING, mode != FREE, np.where(mode == STICKING, 0, mode)
        m.e_x = np.where(m.sticks, self.stuck_at.reshape(shape) - m.u, y[:k])
        m.r_x = np.where(m.sticks, -m.u_rate, y[2 * k : 3 * k])
        m.v_x = m.r_x + m.u_rate
        m.z_r, m.s, m.kappa = self.profile.at(rest_x + m.e_x + m.u)
        m.e_z = np.where(m.contact, m.z_r - rest_z - m.w, y[k : 2 * k])
        m.r_z = np.where(m.contact, m.s * m.v_x - m.w_rate, y[3 * k : 4 * k])
        m.gap = rest_z + m.e_z + m.w - m.z_r
        self.link_forces(m, y)
        return m

    def elements(self, y, index):
        """The elongations a_j of a kind of link: elements, links and what else y has."""
        *_, c_j, _, where, count = self.links[index]
        return y[where].reshape((len(c_j), count) + y.shape[1:])

    def link_forces(self, m, y):
        """(3), (4) and rows 21, 22 of (13)-(15)."""
        m.elongation = [m.e_z, m.e_x, np.diff(m.e_x, axis=0), np.diff(m.e_z, axis=0)]
        m.rate = [m.r_z, m.r_x, np.diff(m.r_x, axis=0), np.diff(m.r_z, axis=0)]
        m.force = [
            c * e + d * r + np.tensordot(c_j, self.elements(y, i), 1)
            for i, ((c, d, c_j, *_), e, r) in enumerate(zip(self.links, m.elongation, m.rate))
        ]
        vertical, horizontal, lateral_x, lateral_z = m.force
        m.f_x, m.f_z = -horizontal, -vertical
        for f, lateral in ((m.f_x, lateral_x), (m.f_z, lateral_z)):
            f[:-1] += lateral
            f[1:] -= lateral
        m.q = np.sqrt(1 + m.s**2)
        m.F_N = (self.mass * m.kappa * m.v_x**2 - m.f_z + m.s * m.f_x) / m.q  # (9)
        m.f_t = (m.f_x + m.s * m.f_z) / m.q
        m.T = self.mu * m.F_N + self.shear

    def derivatives(self, t, y):
        k, m, f = self.k, self.motion(t, y), np.empty_like(y)
        slips, moves = m.contact & ~m.sticks, ~m.sticks
        f[:k] = moves * m.r_x
        f[k : 2 * k] = ~m.contact * m.r_z
        # m q² x'' = f_x + s f_z - F_T q - m s κ x'²
        F_T = m.direction * m.T
        slip = ((m.f_t - F_T) / m.q - self.mass * m.s * m.kappa * m.v_x**2 / m.q**2) / self.mass
        f[2 * k : 3 * k] = np.where(slips, slip, m.f_x / self.mass) * moves - moves * m.u_acceleration
        f[3 * k : 4 * k] = ~m.contact * (m.f_z / self.mass - m.w_acceleration)
        loss = (slips * F_T * m.v_x * m.q).sum(axis=0)
        for i, ((_, d, c_j, per_tau, where, _), rate) in enumerate(zip(self.links, m.rate)):
            a = self.elements(y, i)
            relaxing = per_tau.reshape((-1,) + (1,) * (a.ndim - 1)) * a
            f[where] = (rate - relaxing).reshape((-1,) + y.shape[1:])
            loss = loss + d * (rate**2).sum(axis=0) + np.tensordot(c_j, (relaxing * a).sum(axis=1), 1)
        f[-1] = loss
        return f

    def sparsity(self):
        """What may depend on what in any mode. The last row is left out: nothing depends on E_diss, and with it no two
        columns could be found together."""
        k, pattern = self.k, lil_matrix((self.order, self.order), dtype=bool)
        columns = [[] for _ in range(k)]  # what the force on a mass depends on
        for i in range(k):
            near = range(max(i - 1, 0), min(i + 2, k))
            columns[i] += [part * k + j for part in range(4) for j in near]
        for _, _, c_j, _, where, count in self.links:
            for j in range(len(c_j)):
                for i in range(count):
                    row = where.start + j * count + i
                    ends = [i] if count == k else [i, i + 1]
                    pattern[row, row] = True
                    pattern[row, [part * k + end for part in range(4) for end in ends]] = True
                    for end in ends:
                        columns[end].append(row)
        for i in range(k):
            pattern[[2 * k + i, 3 * k + i], np.array(columns[i])[:, None]] = True
            pattern[i, [i, 2 * k + i]] = pattern[k + i, [k + i, 3 * k + i]] = True
        return pattern.tocsc()


class Run:
    """The run: restarts after events, and what they change."""

    def __init__(self, scene, rtol, method):
        self.layer = layer = Layer(scene)
        c, _, c_j, *_ = layer.links[0]
        stiffness = c + c_j.sum()
        frequency = np.sqrt(stiffness / layer.mass)
        self.method, self.rtol = method, rtol
        self.atol = np.full(layer.order, rtol * LENGTH)
        self.atol[2 * layer.k : 4 * layer.k] *= frequency
        self.atol[-1] = rtol * layer.k * stiffness * LENGTH**2
        # Margins well inside the tolerances keep a mass from meeting its own event again.
        self.gap_margin = rtol * LENGTH
        self.force_margin, self.speed_margin = 1e-3 * self.gap_margin * stiffness, 1e-3 * self.gap_margin * frequency
        self.margin = np.full(layer.k, self.gap_margin)
        self.pattern = layer.sparsity()
        self.impact, self.steps, self.events = 0.0, 0, 0
        self.rows = []

    def roots(self, t, y):
        """The root functions: gap, F_N; and σx', T(0) - |f.t|; each falls through 0 at its event, scaled to metres."""
        m, mode = self.layer.motion(t, y), self.layer.mode
        force_scale, speed_scale = self.force_margin / self.gap_margin, self.speed_margin / self.gap_margin
        first = np.where(mode == FREE, m.gap + self.margin, m.F_N / force_scale + self.gap_margin)
        if not self.layer.has_friction:
            return first, np.full_like(first, np.inf)
        stop = mode * m.v_x / speed_scale + self.gap_margin
        breaks = (m.T - np.abs(m.f_t)) / force_scale + self.gap_margin
        return first, np.where(mode == FREE, np.inf, np.where(mode == STICKING, breaks, stop))

    def start(self):
        """At rest under the carrier; what lies under the profile is lifted onto it."""
        layer = self.layer
        y, k = np.zeros(layer.order), layer.k
        u, w, u_rate, w_rate, *_ = layer.carrier(0.0)
        z_r, s, _ = layer.profile.at(layer.rest_x + u)
        lift = z_r - layer.rest_z - w
        under = lift > 0
        v = (u_rate + s * w_rate) / (1 + s**2)
        y[k : 2 * k][under] = lift[under]
        y[2 * k : 3 * k][under] = (v - u_rate)[under]
        for i in np.flatnonzero(under):
            if v[i] == 0 and layer.has_friction:
                self.stick(i, u)
            else:
                layer.mode[i] = -1 if v[i] < 0 else 1
        if not layer.relaxed:
            m = layer.motion(0.0, y)
            for (_, _, c_j, _, where, _), e in zip(layer.links, m.elongation):
                y[where] = np.tile(e, len(c_j))
        return y

    def stick(self, i, place):
        self.layer.mode[i], self.layer.stuck_at[i] = STICKING, place

    def store(self, y, m):
        """Puts the motion of the masses in contact into the state."""
        k = self.layer.k
        for part, values in enumerate((m.e_x, m.e_z, m.r_x, m.r_z)):
            y[part * k : (part + 1) * k] = np.where(self.layer.mode != FREE, values, y[part * k : (part + 1) * k])

    def settle(self, t, y, decided):
        """Decides the contacts anew; `decided`: 1 just stopped, 2 just set."""
        layer, m = self.layer, self.layer.motion(t, y)
        self.store(y, m)
        margin = np.where(decided == 0, self.force_margin, 0.0)
        lifts = (layer.mode != FREE) & (m.F_N < -margin)
        slips = (layer.mode == STICKING) & ~lifts & (decided != 2) & (np.abs(m.f_t) > m.T + margin)
        layer.mode[lifts] = FREE
        layer.mode[slips] = np.where(m.f_t[slips] < 0, -1, 1)

    def touch(self, y, m, i):
        """Impact: v_n = 0 after it, along t Coulomb. Returns what has been decided of the mass."""
        layer, k = self.layer, self.layer.k
        s, q, v_x, v_z = m.s[i], m.q[i], m.v_x[i], m.r_z[i] + m.w_rate
        v_n, v_t = (v_z - s * v_x) / q, (v_x + s * v_z) / q
        after = np.sign(v_t) * max(abs(v_t) - layer.mu * max(-v_n, 0.0), 0.0)
        self.impact += layer.mass * (v_n**2 + v_t**2 - after**2) / 2
        y[2 * k + i] = after / q - m.u_rate
        if after == 0 and layer.has_friction:
            self.stick(i, m.e_x[i] + m.u)
            return 1
        layer.mode[i] = -1 if after < 0 else 1
        return 2

    def change(self, t, y):
        """The events at an instant: everything whose root function has come to 0."""
        layer, m = self.layer, self.layer.motion(t, y)
        first, second = self.roots(t, y)
        level = min(first.min(), second.min()) + 1e-3 * self.gap_margin
        apart = (layer.mode == FREE) & (first <= level) & (m.r_z + m.w_rate > m.s * m.v_x)
        self.margin[apart] *= 4  # a gap closed by rounding: no touch
        self.store(y, m)
        decided = np.zeros(layer.k, dtype=int)
        for i in np.flatnonzero(((first <= level) & ~apart) | (second <= level)):
            self.events += 1
            if layer.mode[i] == FREE:
                decided[i] = self.touch(y, m, i)
            elif first[i] <= level:
                layer.mode[i], decided[i] = FREE, 2
            elif layer.mode[i] == STICKING:
                layer.mode[i], decided[i] = (-1 if m.f_t[i] < 0 else 1), 2
            else:
                self.stick(i, m.e_x[i] + m.u)
                decided[i] = 1
        self.settle(t, y, decided)
        gap = layer.motion(t, y).gap
        self.margin[(layer.mode != FREE) | (gap > 2 * self.margin)] = self.gap_margin

    def row(self, t, y):
        m = self.layer.motion(t, y)
        self.rows.append([t, m.force[1].sum(), m.force[0].sum(), y[-1] + self.impact])

    def follow(self, t, end, y, times):
        """One phase; `times` of its rows."""

        def first_event(t, y):
            return min(part.min() for part in self.roots(t, y))

        first_event.terminal, first_event.direction = True, -1
        self.settle(t, y, np.zeros(self.layer.k, dtype=int))
        while t < end:
            solution = solve_ivp(
                self.layer.derivatives,
                (t, end),
                y,
                self.method,
                dense_output=True,
                events=first_event,
                vectorized=True,
                rtol=self.rtol,
                atol=self.atol,
                jac_sparsity=self.pattern,
            )
            if solution.status < 0:
                raise SystemExit(f"scipy_contact: {solution.message} at t = {solution.t[-1]}")
            self.steps += len(solution.t) - 1
            for time in times[(times > t) & (times <= solution.t[-1])]:
                self.row(time, solution.sol(time))
            t, y = solution.t[-1], solution.y[:, -1].copy()
            if solution.status == 1:
                self.change(t, y)
        return y

    def simulate(self, phases, points):
        layer, t, y = self.layer, 0.0, self.start()
        self.row(0.0, y)
        for i, phase in enumerate(phases):
            if i > 0:
                before, k = layer.carrier(t), layer.k
                self.store(y, layer.motion(t, y))
                layer.enter_phase(t, before[0], before[1], phase)
                after = layer.carrier(t)
                y[2 * k : 3 * k] += before[2] - after[2]
                y[3 * k : 4 * k] += before[3] - after[3]
            end = t + phase["duration"]
            times = t + phase["duration"] * np.arange(1, points + 1) / points
            times[-1] = end
            y, t = self.follow(t, end, y, times), end


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("rtol", type=float)
    parser.add_argument("--method", default="Radau", choices=("Radau", "BDF"))
    parser.add_argument("--points", type=int, default=50)
    options = parser.parse_args()
    with open(options.scene) as file:
        scene = json.load(file)
    run = Run(scene, options.rtol, options.method)
    run.simulate(scene["excitation"], options.points)
    with open(options.output, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "F_x", "F_z", "E_diss"])
        writer.writerows(run.rows)
    print(f"steps={run.steps} events={run.events}")


if __name__ == "__main__":
    main()
