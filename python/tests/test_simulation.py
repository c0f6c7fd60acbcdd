"""Simulations that are advanced from Python: states, copies, derivatives, signals."""

import copy
import pickle
import signal
import subprocess
import sys
import threading

import asperity
import numpy as np
import pytest
from conftest import SCENES


def pressed(scene):
    simulation = asperity.Simulation(scene, w_rate=-2e-2)
    simulation.advance(1e-3, w=-2e-5)
    return simulation


def test_steps_are_those_of_a_run(small):
    simulation, result = pressed(small), small.simulate(rows=1)
    assert simulation["F_z"] == result["F_z"][1]
    simulation.advance(2e-3, u_rate=0.1)
    assert simulation["F_z"] == result["F_z"][2] and simulation.time == result.time[2]
    assert simulation.values[simulation.names.index("F_z")] == simulation["F_z"] and simulation.units["F_z"] == "N"
    assert (simulation.u, simulation.w) == pytest.approx((2e-4, -2e-5), rel=1e-12)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_goes_on_bit_for_bit(small, copied):
    first = pressed(small)
    second = copied(first)
    for simulation in (first, second):
        simulation.advance(1e-3, u=1e-4)
    assert np.array_equal(first.values, second.values) and first.state == second.state


def test_a_state_is_put_back(small):
    simulation = pressed(small)
    state = pickle.loads(pickle.dumps(simulation.state))
    simulation.advance(1e-3, u=1e-4)
    there = simulation.values
    simulation.state = state
    assert simulation.time == 1e-3
    simulation.advance(1e-3, u=1e-4)
    np.testing.assert_array_equal(simulation.values, there)
    other = asperity.Simulation(small.with_keys({"layer.masses": 9}))
    with pytest.raises(ValueError, match="9"):
        other.state = state


def test_a_derivative_is_that_of_differences(small):
    simulation = pressed(small)
    tangents = simulation.tangents
    name = next(name for name in tangents if "F_z" in name and name.endswith("w"))
    moved, h = [], 1e-10
    for sign in (1.0, -1.0):
        other = asperity.Simulation(small, w_rate=-2e-2)
        other.advance(1e-3, w=-2e-5 + sign * h)
        moved.append(other["F_z"])
    # A tangent holds the steps, which differ between the runs: to the tolerance of 1e-6 of F_z over the difference.
    scale = 1e-6 * abs(simulation["F_z"]) / h
    assert tangents[name] == pytest.approx((moved[0] - moved[1]) / (2 * h), rel=1e-2, abs=scale)
    # With the state held springs do not give: a damper's and a spring's force changes by the stiffness alone.
    assert simulation.derivative("F_z", w=1.0) == pytest.approx(-8 * (2e3 + 1.5e3), rel=1e-9)


def test_a_motion_that_is_refused_leaves_the_run(small):
    simulation = pressed(small)
    before = simulation.state
    with pytest.raises(ValueError, match="dt"):
        simulation.advance(0.0)
    with pytest.raises(ValueError, match="one of them"):
        simulation.advance(1e-3, u=1.0, u_rate=1.0)
    with pytest.raises(ValueError, match="out of range"):
        simulation.advance(1e-3, u=float("nan"))
    with pytest.raises(KeyError, match="expected one of F_x"):
        simulation["nothing"]
    assert simulation.state == before


def test_steps_that_are_used_up_are_an_error(small):
    small["solver.max_steps"] = 3
    with pytest.raises(asperity.SimulationError, match="max_steps"):
        small.simulate()


def test_inputs_that_the_scene_does_not_have_are_refused(small):
    simulation = asperity.Simulation(small)
    for given in ({"load": 1.0}, {"load_rate": 1.0}, {"pull": 1.0}, {"temperature": 300.0}):
        with pytest.raises(ValueError, match="the scene has no such input; it has u, w"):
            simulation.advance(1e-3, **given)
    with pytest.raises(ValueError, match="load: the scene has no such input"):
        asperity.Simulation(small, load=1.0)


def test_runs_in_threads_do_not_wait_for_each_other(small):
    found = [None] * 4

    def run(i):
        found[i] = small.simulate()["F_z"]

    threads = [threading.Thread(target=run, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for values in found[1:]:
        np.testing.assert_array_equal(values, found[0])


# Each would take minutes or more.
LONG = {
    "simulate": "scene.with_keys({'solver.relative_tolerance': 1e-9}).simulate()",
    "advance": "asperity.Simulation(scene).advance(1e3, w=-1e-5, u_rate=0.1)",
    "sweep": "scene.sweep([1e-3, 1e-2], [1e5], method='layer', friction_error=1e-9, distance=1e3)",
}


@pytest.mark.parametrize("what", LONG)
@pytest.mark.skipif(sys.platform == "win32", reason="a process is not sent Ctrl-C there")
def test_ctrl_c_ends_what_is_going_on(what):
    file = SCENES / "road" / ("slide.toml" if what == "simulate" else "road.toml")
    code = (
        f"import asperity\nscene = asperity.Scene.from_toml({str(file)!r})\nprint('begun', flush=True)\n{LONG[what]}\n"
    )
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begun\n"
    with pytest.raises(subprocess.TimeoutExpired):
        child.wait(timeout=1.0)
    child.send_signal(signal.SIGINT)
    _, error = child.communicate(timeout=60)
    assert error.rstrip().endswith("KeyboardInterrupt"), error


@pytest.mark.skipif(sys.platform == "win32", reason="a process is not sent Ctrl-C there")
def test_the_command_is_the_program(tmp_path):
    command = [sys.executable, "-m", "asperity"]
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
    assert version.stdout.split() == ["asperity", asperity.__version__]
    refused = subprocess.run([*command, "simulate", "nothing.toml"], capture_output=True, text=True, check=False)
    assert refused.returncode == 1 and "nothing.toml" in refused.stderr
    file = SCENES / "road" / "slide.toml"
    child = subprocess.Popen([*command, "simulate", file, "-o", "out.csv"], cwd=tmp_path, stderr=subprocess.PIPE)
    while not list(tmp_path.iterdir()):
        assert child.poll() is None
    # The file may be there before the program is ready to remove it.
    with pytest.raises(subprocess.TimeoutExpired):
        child.wait(timeout=1.0)
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=60)
    # What it had begun to write is gone.
    assert child.returncode == 130 and not list(tmp_path.iterdir())
