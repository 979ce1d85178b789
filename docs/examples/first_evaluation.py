# %% [markdown]
# # A first evaluation, in a notebook
#
# Needs the Python package of Spool (`docs/python.md`) and matplotlib. Open this file as a notebook with jupytext, or make one:
# `jupytext --to ipynb first_evaluation.py`. Run it in the folder that holds `dumps`.

# %%
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import spool

dump = spool.open("dumps/tiny/chess.spool")
print(dump.width, "x", dump.height, "pixels,", dump.spp, "samples each")

# %% [markdown]
# Eight samples a pixel: the same number everywhere, and where `multiscale` wants them.

# %%
reference = dump.pixel("reference")
uniform = spool.reconstruct(dump, spool.replay(dump, "uniform", spp=8), "box")
selection = spool.replay(dump, "multiscale", spp=8)
adaptive = spool.reconstruct(dump, selection, "directional")
errors = {name: spool.metrics(image, reference)["relmse"] for name, image in
          {"uniform + box": uniform, "multiscale + directional": adaptive}.items()}
print(errors)

# %%
def shown(image):
    return np.clip(image / (image + reference.mean()), 0, 1) ** (1 / 2.2)


figure, axes = plt.subplots(1, 4, figsize=(12, 3.4))
for axis, (name, image) in zip(axes, [("uniform + box", shown(uniform)), ("multiscale + directional", shown(adaptive)),
                                      ("reference", shown(reference)), ("samples of each pixel", selection.counts)]):
    axis.imshow(image)
    axis.set_title(name)
    axis.axis("off")
figure.savefig("first_evaluation.png")

# %% [markdown]
# One image proves little. An evaluation repeats both with samples that no other repetition had.

# %%
results = spool.evaluate({"recordings": [dump], "samplers": ["uniform", "multiscale"], "filters": ["box", "directional"],
                          "spp": [4, 8], "replicates": 4, "pictures": False})
for mean in results.means:
    value, low, high = mean["quantities"]["relmse"]
    print(f"{mean['sampler']:10} {mean['filter']:12} {value:.3f} [{low:.3f}, {high:.3f}]")

# %%
assert errors["multiscale + directional"] < errors["uniform + box"]
