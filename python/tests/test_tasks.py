"""What users want to do, each in under fifteen lines."""

import inspect
import sys

import asperity
import numpy as np
import pandas as pd
import pytest
from conftest import names


def test_a_road_as_an_array(block):
    x = np.linspace(0.0, 2e-3, 201)
    z = 1e-5 * np.cos(2 * np.pi * x / 2e-3) + 3e-6 * np.cos(2 * np.pi * x / 4e-4)
    z[-1] = z[0]
    scene = block.with_profile(x, z, periodic=True)
    friction = scene.sweep([0.1], [2e5])["friction"]
    assert 0.0 < friction[0, 0, 0] < 2.0


def test_a_dma_as_a_data_frame(block):
    omega = np.geomspace(1e2, 1e7, 60)
    modulus = block.complex_modulus(omega)
    dma = pd.DataFrame({"frequency [Hz]": omega / (2 * np.pi), "E' [Pa]": modulus.real, "E'' [Pa]": modulus.imag})
    fit = asperity.fit(dma, fit_error=0.01)
    scene = block.with_fit(fit)
    assert fit.error <= 0.01 and names(fit.plot())[:2] == ["E' measured", "E' fitted"]
    np.testing.assert_allclose(abs(scene.complex_modulus(omega)), abs(modulus), rtol=0.03)


def test_a_curve_of_friction(block):
    table = block.sweep(speeds=np.geomspace(1e-3, 10.0, 9), pressures=[1e5, 2e5])
    curve = table.to_xarray()["friction"].sel(p=2e5).squeeze()
    figure = table.plot()
    assert curve.dims == ("v",) and float(curve.max()) > 0.5 and names(figure)[:2] == ["100 kPa", "200 kPa"]


def test_a_calibration(block):
    measured = block.sweep([1e-3, 1e-2, 0.1, 1.0], [1e5, 2e5]).to_pandas()
    data = measured.rename(
        columns={"speed": "speed [m/s]", "pressure": "pressure [Pa]", "temperature": "temperature [K]"}
    )
    data = data[["speed [m/s]", "pressure [Pa]", "temperature [K]", "friction"]]
    guess = block.with_keys({"friction.shear_strength": 3e6})
    found = guess.calibrate(data, {"friction.shear_strength": (1e6, 2e7)})
    # The data are the model's own.
    assert found["friction.shear_strength"] == pytest.approx(6.5e6, rel=1e-4) and found.is_whole
    assert found.scene["friction.shear_strength"] == found["friction.shear_strength"]
    assert found.to_pandas().loc["friction.shear_strength", "is_identifiable"]


def test_a_contact_pressure(block):
    contact = block.contact(pressure=2e5, speed=0.1)
    # In the mean the pressure is the one asked for.
    assert contact.pressure.mean() == pytest.approx(2e5, rel=1e-6) and contact.status == "steady"
    touching = contact.pressure > 0.0
    assert touching.mean() == pytest.approx(contact.area) and contact.gap[touching].max() < contact.gap.max()
    assert len(contact.plot().axes) == 2 and contact.leak_gap is None
    # A profile has the gaps of the effective medium, in which a fluid is carried less far than the mean gap, and no map.
    flow = block.contact(pressure=2e5, speed=0.1, flow=True)
    assert 0.0 < flow.leak_gap < flow.gap.mean() and 0.0 < flow.drag_gap < flow.gap.mean()
    assert flow.leak_gap_across is None and flow.leak is None


def test_frames_of_an_animation(small):
    from matplotlib.animation import FuncAnimation
    from matplotlib.figure import Figure

    result = small.simulate(rows=20, elements=True)
    x, z = result.elements["x"], result.elements["z"]
    axes = Figure().subplots()
    axes.plot(*result.profile)
    (masses,) = axes.plot([], [], "o")
    film = FuncAnimation(axes.figure, lambda i: masses.set_data(x[i], z[i]), frames=len(result), blit=False)
    film._draw_frame(len(result) - 1)
    np.testing.assert_array_equal(masses.get_xdata(), x[-1])


def test_a_master_of_ones_own_with_rates(small):
    simulation, mass, stiffness, u, v, dt = asperity.Simulation(small), 1e-3, 50.0, 0.0, 0.0, 1e-5
    simulation.advance(1e-3, w=-2e-5)
    for step in range(200):
        drive = 0.05 * step * dt
        force = stiffness * (drive - u) + simulation["F_x"]
        v += dt * force / mass
        simulation.advance(dt, u_rate=v)
        u += dt * v
    assert simulation.u == pytest.approx(u, rel=1e-9, abs=1e-15) and u != 0.0


def test_an_fmu(small, tmp_path):
    if sys.platform == "darwin":
        pytest.skip("FMI 2.0 names no platform of Apple's processors")
    motion = {"time": [0.0, 1e-3, 3e-3], "u": [0.0, 0.0, 2e-4], "w": [0.0, -2e-5, -2e-5]}
    fmu = small.pack(tmp_path / "small.fmu")
    driven = asperity.fmi.simulate(fmu, motion)
    own = small.simulate(motion=motion)
    # The same steps: the FMU's rates are rounded once more.
    np.testing.assert_allclose(driven["F_z"], own["F_z"], rtol=1e-9)


def test_a_sweep_by_dask(block):
    import dask
    import xarray as xr

    parts = [dask.delayed(block.sweep)([speed], [1e5, 2e5]) for speed in (0.01, 0.1, 1.0)]
    tables = dask.compute(*parts, scheduler="processes", num_workers=2)
    whole = xr.concat([table.to_xarray() for table in tables], dim="v")
    np.testing.assert_array_equal(whole["friction"], block.sweep([0.01, 0.1, 1.0], [1e5, 2e5])["friction"])


def test_a_parameter_study(block):
    from joblib import Parallel, delayed

    moduli = [3e6, 4.44e6, 6e6]
    scenes = [block.with_keys({"material.equilibrium_modulus": modulus}) for modulus in moduli]
    contacts = Parallel(n_jobs=2)(delayed(asperity.Scene.contact)(scene, 2e5, 0.1) for scene in scenes)
    areas = [contact.area for contact in contacts]
    # A stiffer compound touches less.
    assert areas == sorted(areas, reverse=True)


def test_each_task_takes_less_than_fifteen_lines():
    tasks = [task for name, task in globals().items() if name.startswith("test_a") and inspect.isfunction(task)]
    tasks.append(test_frames_of_an_animation)
    lengths = {task.__name__: len(inspect.getsource(task).rstrip().splitlines()) - 1 for task in tasks}
    assert len(lengths) == 10 and max(lengths.values()) < 15, lengths
