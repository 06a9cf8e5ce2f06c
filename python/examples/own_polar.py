"""The envelope of your own polar: where the equilibria of a vehicle with measured coefficients fold and jump.

    python own_polar.py [POLAR.csv]

Columns alpha_deg, cl, cd; from 0 to 180° for a symmetric section, else from -180 to 180°.
"""

import sys

import numpy as np

import alula

if len(sys.argv) > 1:
    model = alula.Model.load(sys.argv[1])
else:
    # A flat plate that stalls at 12°, as if it had been measured.
    alpha = np.array([0, 4, 8, 12, 15, 20, 30, 45, 60, 90, 120, 135, 150, 165, 172, 180.0])
    a = np.radians(alpha)
    cl, cd = 0.95 * np.sin(2 * a), 0.02 + 1.9 * np.sin(a) ** 2
    cl[:4], cd[:4] = 5.5 * a[:4], 0.02 + 0.3 * a[:4] ** 2
    cl[-1] = 0.0
    model = alula.Model.table(alpha, cl, cd)

vehicle = alula.Vehicle(model, mass_kg=3.0, k_a_kg_m=0.2, thrust_max_n=60.0)
envelope = alula.envelope(vehicle)
for fold in envelope.summary["folds"]:
    print(f"fold at {fold['alpha_deg']:6.2f}°, {fold['speed_m_s']:5.2f} m/s")
for way in ("jump_up", "jump_down"):
    jump = envelope.summary[way]
    if jump:
        ends = f"{jump['from_alpha_deg']:.1f}° to {jump['to_alpha_deg']:.1f}°"
        print(f"{way}: {ends} at {jump['speed_m_s']:.2f} m/s")

# The orientations at one airspeed, as the flight computer finds them.
for e in alula.equilibria(vehicle, (12.0, 0.0, 0.0)):
    print(f"12 m/s: α {np.degrees(e.alpha_rad):7.2f}°, thrust {e.thrust_n:7.2f} N, branch {e.branch}")
print(f"{len(envelope.curve)} points of the curve: {', '.join(envelope.curve.names)}")
