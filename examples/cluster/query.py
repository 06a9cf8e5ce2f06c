"""Asks a campaign's shares one question, by DuckDB and by Polars: which shares of the flights sink more than a metre, by turbulence.

python query.py RESULTS      RESULTS holds the folders shard=0001, shard=0002 and so on; needs duckdb and polars
"""
import sys

import duckdb
import polars as pl

FILES = f"{sys.argv[1]}/shard=*/flights/*.parquet"

by_duckdb = duckdb.sql(
    f"""
    SELECT floor("weather.turbulence.wind_at_20_ft_m_s") AS wind, count(*) AS flights, count(DISTINCT shard) AS shards,
           avg((altitude_least_m < -1)::DOUBLE) AS sunk, min(altitude_least_m) AS lowest
    FROM read_parquet('{FILES}', hive_partitioning = true) GROUP BY wind ORDER BY wind
    """
).fetchall()

by_polars = (
    pl.scan_parquet(FILES, hive_partitioning=True)
    .group_by(wind=pl.col("weather.turbulence.wind_at_20_ft_m_s").floor())
    .agg(
        flights=pl.len(),
        shards=pl.col("shard").n_unique(),
        sunk=(pl.col("altitude_least_m") < -1).mean(),
        lowest=pl.col("altitude_least_m").min(),
    )
    .sort("wind")
    .collect()
)

print(by_polars)
# Means are sums in another order: a rounding.
for one, other in zip(by_duckdb, by_polars.rows(), strict=True):
    assert all(abs(a - b) < 1e-9 for a, b in zip(one, other, strict=True)), (one, other)
print("DuckDB says the same")
