"""Which recordings have rare bright samples ("fireflies"): there the mean of squared errors says most about a few pixels."""
import measured

# The worst 0.1 % of the pixels of uniform samples without a filter bear more than a quarter of relMSE. Of the recordings of POOLS.toml
# the shares are below 0.15 or above 0.3: the limit lies between.
LIMIT = 0.25
UNIFORM = {"sampler": "uniform", "filter": "box"}


def shares(sources, least_spp=4):
    """{recording: share of relMSE that the worst 0.1 % of the pixels bear}, mean over plans and budgets; sources: files of measured.py."""
    found = {}
    for path in sources:
        _, statistics = measured.load(path)
        for entry in statistics["results"]:
            quantities = entry["quantities"]
            if entry["spp"] >= least_spp and UNIFORM.items() <= entry.items() and {"relmse", "relmse_trimmed"} <= quantities.keys():
                found.setdefault(entry["dump"], []).append(1.0 - quantities["relmse_trimmed"][0] / quantities["relmse"][0])
    return {recording: sum(values) / len(values) for recording, values in found.items()}
