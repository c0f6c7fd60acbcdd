"""Turns `asperity describe SCENE.toml --json` into the flat text that sundials_contact reads.

    asperity describe SCENE.toml --json | flatten.py > SCENE.txt

Names and numbers, one after another, in SI units:

    mass M  relaxed 0|1
    vertical C D N  C_1 TAU_1 ... C_N TAU_N         and alike horizontal, lateral_x, lateral_z
    masses K  X_1 Z_1 ... X_K Z_K
    friction MU SHEAR_FORCE
    profile PERIODIC N  x_1 z_1 ... x_N z_N
    phases N, each: DURATION  U_RATE U_AMPLITUDE U_FREQUENCY  W_RATE W_AMPLITUDE W_FREQUENCY
"""

import json
import sys

LINKS = ("vertical", "horizontal", "lateral_x", "lateral_z")
# What the peers know; a scene with more in it is refused, not run without.
KNOWN = {
    "layer": {"masses", "spacing", "origin", "clearance", "mass", "initial", "roughness", *LINKS},
    "surface": {"x", "z", "periodic"},
    "friction": {"coulomb", "shear_force"},
    "phase": {"duration", "u", "w"},
    "carrier": set(),
}


def check(scene):
    """Refuses what is not null and not known."""
    tables = [("layer", scene["layer"]), ("surface", scene["surface"]), ("friction", scene["friction"] or {})]
    tables += [("phase", phase) for phase in scene["excitation"]]
    tables.append(("carrier", scene["carrier"]))
    for name, table in tables:
        more = sorted(key for key, value in table.items() if value is not None and key not in KNOWN[name])
        if more:
            sys.exit(f"the peers do not know {name}: {', '.join(more)}")


def link_constants(link):
    """Stiffness, damping and the pairs of stiffness and relaxation time; zeros for a link that is left out."""
    link = link or {"stiffness": None, "damping": None, "maxwell": []}
    elements = [(element["stiffness"], element["relaxation_time"]) for element in link["maxwell"]]
    return link["stiffness"] or 0.0, link["damping"] or 0.0, elements


def rest_places(layer):
    """Places X_i and heights Z_i of the masses at rest."""
    heights = layer["roughness"] or [0.0] * layer["masses"]
    x = [layer["origin"] + i * layer["spacing"] for i in range(layer["masses"])]
    return x, [layer["clearance"] + height for height in heights]


def friction_of(scene):
    friction = scene["friction"] or {}
    return friction.get("coulomb") or 0.0, friction.get("shear_force") or 0.0


def lines(scene):
    layer, surface = scene["layer"], scene["surface"]
    yield "mass", layer["mass"], "relaxed", int(layer["initial"] == "relaxed")
    for name in LINKS:
        stiffness, damping, elements = link_constants(layer[name])
        yield name, stiffness, damping, len(elements), *(number for element in elements for number in element)
    yield "masses", layer["masses"]
    yield from zip(*rest_places(layer))
    yield "friction", *friction_of(scene)
    yield "profile", int(surface["periodic"]), len(surface["x"])
    yield from zip(surface["x"], surface["z"])
    yield "phases", len(scene["excitation"])
    for phase in scene["excitation"]:
        paths = (phase["u"], phase["w"])
        yield phase["duration"], *(path[key] for path in paths for key in ("rate", "amplitude", "frequency"))


def flatten(scene):
    """The text of a scene."""
    check(scene)
    return "".join(" ".join(str(word) for word in line) + "\n" for line in lines(scene))


if __name__ == "__main__":
    sys.stdout.write(flatten(json.load(sys.stdin)))
