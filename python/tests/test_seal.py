"""Lips with a film."""

import copy
import pickle

import asperity
import numpy as np
import pytest
from conftest import SCENES

FILM = SCENES.parent / "tests" / "reference" / "film"


def test_a_rod_is_moved_out_and_in(tmp_path):
    seal = asperity.Seal(FILM / "film-strokes.toml", sealed_pressure=2e6)
    assert len(seal) == 96 and seal["F_x"] == 0.0 and "film.leak" in seal.names
    seal.advance(0.1, 2e-3)
    out = seal["F_x"]
    seal.advance(0.1, 0.0)
    # Friction is against the motion.
    assert out < 0.0 < seal["F_x"] and seal.u == 0.0 and seal.time == pytest.approx(0.2)
    assert seal.contents.shape == (96,) and np.all(seal.contents > 0.0)
    assert seal.units["film.leak_rate"] == "m3/s" and len(seal.values) == len(seal.names)
    with pytest.raises(KeyError, match="force: expected one of F_x"):
        seal["force"]
    assert "Vogel" not in seal.describe() and "96 cells" in seal.describe()
    assert seal.pack(tmp_path / "seal.fmu").stat().st_size > 1e5


def test_copies_and_states_go_on_bit_for_bit():
    seal = asperity.Seal(FILM / "film-strokes.toml", sealed_pressure=2e6)
    seal.advance(0.05, 1e-3)
    copies = [copy.copy(seal), pickle.loads(pickle.dumps(seal))]
    state = seal.state
    seal.advance(0.05, 0.0)
    for other in copies:
        other.advance(0.05, 0.0)
        assert np.array_equal(other.values, seal.values) and other.state == seal.state
    seal.state = state
    seal.advance(0.05, 0.0)
    assert np.array_equal(copies[0].values, seal.values)


def test_a_stribeck_curve():
    curve = asperity.Seal(FILM / "film-strokes.toml").sweep([1e-3, 1e-1], sealed=[0.0, 1e6])
    assert curve.stroke == ["out", "in"] * 4 and set(curve.status) == {"steady"}
    friction, film = curve["friction"], curve["thickness"]
    assert friction[2] < friction[0] and film[2] > film[0] and curve.units["speed"] == "m/s"
    assert len(curve.to_pandas()) == 8 and curve.plot() is not None
    with pytest.raises(ValueError, match="temperatures"):
        asperity.Seal(FILM / "film-strokes.toml").sweep([1e-3], temperatures=[300.0])
