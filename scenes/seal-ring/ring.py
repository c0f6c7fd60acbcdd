"""The ring's points and its motion, as CSV on standard output.

    ring.py points | motion

The shaft is set down, starts to turn, and turns steadily. Its axis leans on the face by a small angle that keeps its direction
while the shaft turns, and the shaft moves to and fro along itself.
"""

import math
import sys

RADIUS, WIDTH, AROUND, ACROSS = 20e-3, 0.6e-3, 72, 2
# m: the height over the face that bears some 2 bar, the one from which the shaft is set down, the stroke to and fro.
HEIGHT, CLEAR, STROKE = -0.5e-6, 2e-6, 0.4e-6
# rad, Hz, revolutions a second.
LEAN, STROKES, TURNS = 3.5e-5, 2.5, 1.0
# s: set down, then up to speed, then steady for some revolutions; a row.
SET_DOWN, STARTED, END, STEP = 0.1, 0.5, 4.5, 5e-3


def points():
    """Places (m) and areas (m²), even around the ring."""
    yield "x,y,z,area"
    for i in range(AROUND):
        angle = 2 * math.pi * i / AROUND
        for j in range(ACROSS):
            radius = RADIUS + WIDTH * ((j + 0.5) / ACROSS - 0.5)
            area = 2 * math.pi * radius * WIDTH / (AROUND * ACROSS)
            yield f"{radius * math.cos(angle):.10g},{radius * math.sin(angle):.10g},0,{area:.10g}"


def turned(time):
    """The angle of the shaft: at rest, evenly faster, steady."""
    since, starting = max(time - SET_DOWN, 0.0), STARTED - SET_DOWN
    turns = 0.5 * TURNS * since**2 / starting if since < starting else TURNS * (since - 0.5 * starting)
    return 2 * math.pi * turns


def height(time):
    """The height of the ring's middle over the face."""
    if time < SET_DOWN:
        return CLEAR + (HEIGHT - CLEAR) * time / SET_DOWN
    return HEIGHT + STROKE * math.sin(2 * math.pi * STROKES * max(time - STARTED, 0.0))


def motion():
    """A row for each communication step. Roll and pitch are about axes that turn with the shaft; together they lean towards x."""
    yield "time,x,y,z,roll,pitch,yaw"
    for i in range(round(END / STEP) + 1):
        time = i * STEP
        yaw = turned(time)
        roll, pitch = LEAN * math.sin(yaw), LEAN * math.cos(yaw)
        yield f"{time:.10g},0,0,{height(time):.10g},{roll:.10g},{pitch:.10g},{yaw:.10g}"


def main():
    parts = {"points": points, "motion": motion}
    if len(sys.argv) != 2 or sys.argv[1] not in parts:
        sys.exit(__doc__)
    print("\n".join(parts[sys.argv[1]]()))


if __name__ == "__main__":
    main()
