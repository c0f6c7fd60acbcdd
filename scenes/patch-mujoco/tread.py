"""The table of a tread that is a bed of springs, for which the brush model has closed formulas: on standard output.

Pressure rises evenly with the approach, friction and stiffness are the same at every speed.
"""

# Pa/m, 1, N/m³
SLOPE, FRICTION, STIFFNESS = 5e7, 0.9, 8e7
# m², m
AREA, REST = 1e-4, 0.02
SPEEDS = (1e-4, 50.0)
PRESSURES = [1e3 * 10 ** (i / 10) for i in range(31)]
COLUMNS = (
    "speed [m/s]", "pressure [Pa]", "temperature [K]", "status", "friction [1]", "friction_standard_error [1]",
    "friction_hysteresis [1]", "friction_adhesion [1]", "mean_pressure [Pa]", "contact_ratio [1]", "P_damper [W]",
    "P_maxwell [W]", "P_friction [W]", "P_impact [W]", "separation [m]", "tangential_stiffness [N/m]", "w [m]", "runs [1]",
    "time [s]",
)  # fmt: skip


def row(speed, pressure):
    """A point of the sweep: all friction is adhesion."""
    separation, heat = -pressure / SLOPE, FRICTION * pressure * AREA * speed
    return [
        f"{speed:.9g}", f"{pressure:.9g}", "", "steady", FRICTION, 0, 0, FRICTION, pressure, pressure / 1e6, "", "", heat, "",
        separation, STIFFNESS * AREA, separation - REST, 1, 0.01,
    ]  # fmt: skip


def main():
    print("# asperity sweep = 1\n# scene = springs\n# fingerprint = 00")
    print(f"# nominal_area = {AREA} m2\n# rest_separation = {REST} m")
    print(f"# speeds = {','.join(f'{speed:.9g}' for speed in SPEEDS)} m/s")
    print(f"# pressures = {','.join(f'{pressure:.9g}' for pressure in PRESSURES)} Pa")
    print(",".join(COLUMNS))
    for pressure in PRESSURES:
        for speed in SPEEDS:
            print(",".join(str(value) for value in row(speed, pressure)))


if __name__ == "__main__":
    main()
