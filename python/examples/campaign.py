"""A campaign in pandas: which of the dispersed parameters cost altitude.

    python campaign.py [FLIGHTS]
"""

import sys

import alula

flown = alula.campaign("dispersed", flights=int(sys.argv[1]) if len(sys.argv) > 1 else 200)
flights = flown.flights.pandas()
print(flown, len(flights), "flights,", int(flights["departed"].sum()), "departed")
print(flights[["altitude_least_m", "altitude_most_m", "forward_most_m"]].describe())

drawn = [name for name in flights.columns if "." in name]
correlations = flights[drawn].corrwith(flights["altitude_least_m"])
print("correlation with the least altitude:")
print(correlations.sort_values(key=abs, ascending=False).head(5))

# The course of all flights: the altitudes between which nine of ten are.
samples = flown.samples.pandas()
band = samples.groupby("t_s")["altitude_m"].quantile([0.05, 0.95]).unstack()
print("widest band:", f"{(band[0.95] - band[0.05]).max():.2f} m")

# The worst one again, with its record.
worst = int(flights["altitude_least_m"].idxmin())
again = flown.refly(int(flights["flight"][worst]))
print("flight", worst, "again:", f"{again.figures['altitude_least_m']:.2f} m")
