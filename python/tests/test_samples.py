"""Sweeps with samples."""

from __future__ import annotations

import pickle

import asperity
import numpy as np
import pytest

SCENE = """
name = "rough"
layer = { foundation = "half_space", masses = 32, spacing = 1e-4, width = 1e-2 }
friction = { rate_shear = { strength = 6e6, reference_speed = 1.0, sharpness = 0.1 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = [{ relaxation_time = 1e-6, modulus = 5e7 }]
[surface]
kind = "self_affine"
length = 0.02
points = 256
hurst = 0.8
rms = 1e-5
roll_off_wavelength = 5e-3
cut_off_wavelength = 5e-4
seed = 7
fine = { shortest = 1e-5 }
"""
SECTION = """
[uncertainty]
"friction.rate_shear.strength" = { relative = 0.1 }
"surface.fine.shortest" = { factor = 2.0 }
"""


def test_samples_are_those_of_the_table() -> None:
    scene = asperity.Scene(SCENE + SECTION)
    table = scene.sweep([0.1, 1.0], [2e5, 4e5], samples=16, seed=3)
    samples = table.samples
    assert samples.friction.dims == ("sample", "v", "p", "T") and samples.friction.shape == (16, 2, 2, 1)
    assert samples["friction.rate_shear.strength"].shape == (16,)
    low, high = table["friction_q05"], table["friction_q95"]
    assert np.all(low < table["friction_q50"]) and np.all(table["friction_q50"] < high)
    assert np.all(samples.friction.min("sample").values <= low) and np.all(table["samples"] == 16)
    matters = table.matters
    mean = matters[matters.speed.isna()].set_index("key").share
    assert mean["surface.fine.shortest"] > 0.2 and mean.sum() == pytest.approx(1.0, abs=0.1)
    again = pickle.loads(pickle.dumps(table))
    assert again.samples.equals(samples) and again.matters.equals(matters)
    assert asperity.Table(table.text).samples.friction.equals(samples.friction)


def test_a_quantile_is_one_sample() -> None:
    scene = asperity.Scene(SCENE + SECTION)
    table = scene.sweep([0.1, 1.0], [2e5, 4e5], samples=16)
    low = table.quantile(0.05, scene)
    of_samples = table.samples.friction.mean(("v", "p", "T"))
    number = int(of_samples.argmin())
    assert np.array_equal(low["friction"], table.samples.friction[number].values)
    with pytest.raises(asperity.SceneError, match="another sweep"):
        table.quantile(0.05, scene.with_keys({"friction.rate_shear.sharpness": 0.2}))


def test_a_table_without_samples_has_none() -> None:
    scene = asperity.Scene(SCENE)
    with pytest.raises(asperity.SceneError, match="section"):
        scene.sweep([0.1], [2e5], samples=16)
    with pytest.raises(ValueError, match="samples"):
        _ = scene.sweep([0.1], [2e5]).samples
