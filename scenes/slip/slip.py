"""The slip curves of run.sh in Python: a tread on two roads, the Magic Formula fitted, peaks and stiffnesses printed.

    python scenes/slip/slip.py
"""

from pathlib import Path

import asperity
import numpy as np

here = Path(__file__).parent
slips, angles = np.linspace(-0.3, 0.3, 41), np.radians(np.linspace(-20, 20, 41))
for road in ("asphalt", "smooth"):
    tread = asperity.Patch(here / f"{road}.toml")
    curves = tread.slip([2e3, 4e3, 6e3], slips, angles, temperatures=["10 °C", "40 °C"])
    formula = curves.magic_formula()
    rows = formula.to_pandas()
    over_loads = rows[rows["coefficient"].isin(["PDX1", "PKX1", "PDY1", "PKY1"])]
    print(road, over_loads.pivot(index="temperature", columns="coefficient", values="value"), sep="\n")
