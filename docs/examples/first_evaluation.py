# %% [markdown]
# # A first evaluation, in a notebook
#
# Needs the Python package of Spool (`docs/python.md`). Open this file as a notebook with jupytext, or make one:
# `jupytext --to ipynb first_evaluation.py`. Run it in the folder that holds `dumps`.

# %%
import spool

dump = spool.open("dumps/tiny/chess.spool")
print(dump.width, "x", dump.height, "pixels,", dump.spp, "samples each")
dump

# %% [markdown]
# Eight samples a pixel: the same number everywhere, and where `multiscale` puts them.

# %%
uniform = spool.reconstruct(dump, spool.replay(dump, "uniform", spp=8), "box")
selection = spool.replay(dump, "multiscale", spp=8)
adaptive = spool.reconstruct(dump, selection, "directional")
selection

# %%
images = {"uniform + box": uniform, "multiscale + directional": adaptive}
spool.show(images, reference=dump)

# %% [markdown]
# A filter of your own beside others, at several budgets.

# %%
@spool.filter
def darker(statistics, share=0.9):
    return share * statistics.mean


spool.view(dump, sampler="multiscale", filter=["directional", darker])

# %% [markdown]
# One image proves little. An evaluation repeats both with samples that no other repetition had.

# %%
results = spool.evaluate({"recordings": [dump], "samplers": ["uniform", "multiscale"], "filters": ["box", "directional"],
                          "spp": [4, 8], "replicates": 4, "pictures": False})
results

# %%
errors = {name: spool.metrics(image, dump.pixel("reference"))["relmse"] for name, image in images.items()}
assert errors["multiscale + directional"] < errors["uniform + box"]
print(errors)
