"""The paper's flight: from hover to 20 m/s by the robust law, with wrong parameters.

At 8 s the equilibrium that the law follows is lost; |F_p| says so before.
"""

import numpy as np

import alula

flight = alula.fly("hover-to-cruise")
print(flight)

record = flight.record
lowest = int(np.argmin(record["fp_n"]))
print(f"least |F_p|: {record['fp_n'][lowest]:.1f} N at {record['t_s'][lowest]:.3f} s")

# What the controller believes knows of that jump: level flight that gains 2 m/s² folds near this airspeed.
folds = alula.envelope("paper-belief", accel=2.0).summary["folds"]
for fold in folds:
    print(f"fold at {fold['alpha_deg']:.1f}° and {fold['speed_m_s']:.1f} m/s")

# The law itself, at the state of that moment.
law = alula.Law(alula.Vehicle.load("paper-belief"))
command = law.command(
    velocity=(record["told_v_down_m_s"][lowest], record["told_v_north_m_s"][lowest]),
    theta=record["theta_rad"][lowest],
    reference_velocity=(record["told_vr_down_m_s"][lowest], record["told_vr_north_m_s"][lowest]),
    reference_acceleration=(record["told_ar_down_m_s2"][lowest], record["told_ar_north_m_s2"][lowest]),
)
print(f"there the law commands {command.thrust_n:.1f} N and {command.rate_rad_s:.2f} rad/s")
