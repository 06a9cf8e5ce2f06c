"""The paper's flight: from hover to 20 m/s by the robust law, with wrong parameters.

At 8 s the equilibrium that the law follows is lost; |F_p| says so before.
"""

import numpy as np

import alula

flight = alula.fly("hover-to-cruise")
print(flight)

record = flight.record
lowest = int(np.argmin(record["fp_n"]))
print(f"apparent force, smallest: {record['fp_n'][lowest]:.1f} N at {record['t_s'][lowest]:.3f} s")

# What the controller believes knows of that jump: level flight that gains 2 m/s² folds near this airspeed.
folds = alula.envelope("paper-belief", accel=2.0).summary["folds"]
for fold in folds:
    print(f"fold at {fold['alpha_deg']:.1f}° and {fold['speed_m_s']:.1f} m/s")

# The law itself, at the state of that moment.
law = alula.Law(alula.Vehicle.load("paper-belief"))
told = lambda name, unit: [record[f"told_{name}_{axis}_{unit}"][lowest] for axis in ("north", "east", "down")]
command = law.command(
    velocity=told("v", "m_s"),
    theta=record["theta_rad"][lowest],
    reference_velocity=told("vr", "m_s"),
    reference_acceleration=told("ar", "m_s2"),
)
print(f"there the law commands {command.thrust_n:.1f} N and {command.rate_rad_s:.2f} rad/s")
