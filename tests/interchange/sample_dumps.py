"""Dumps with every kind of layer, and how their arrays are compared bit for bit."""
import numpy as np
import spool


def random_bits(rng, shape, dtype):
    count = int(np.prod(shape)) * np.dtype(dtype).itemsize
    return rng.integers(0, 256, count, np.uint8).view(dtype).reshape(shape)


def rich(path, seed=0, size=(5, 9), spp=6, finite=False):
    """Layers of all scopes and types; every bit pattern unless `finite`."""
    rng = np.random.default_rng(seed)
    height, width = size
    draw = (lambda shape, dtype: rng.random(shape).astype(dtype)) if finite else (lambda shape, dtype: random_bits(rng, shape, dtype))
    layers = {"radiance": ("f4", "RGB", "sample"), "albedo": ("f2", "RGB", "sample"), "depth": ("f4", "Z", "sample"),
              "path": ("u4", ["flags"], "sample"), "film": ("f4", "XY", "pass"), "seed": ("u4", "S", "pass"),
              "reference": ("f4", "RGB", "pixel"), "reference_variance": ("f4", "RGB", "pixel")}
    shapes = {"sample": (height, width, spp), "pixel": (height, width), "pass": (spp,)}
    arrays = {}
    for name, (dtype, components, scope) in layers.items():
        shape = shapes[scope] + ((len(components),) if len(components) > 1 else ())
        arrays[name] = rng.integers(0, 2**32, shape, np.uint32) if dtype == "u4" else draw(shape, dtype)
    arrays["reference_variance"] = (arrays["reference_variance"].view(np.uint32) & 0x3FFFFFFF).view(np.float32)  # below 2
    radiance = arrays.pop("radiance")
    spool.write(path, radiance, tile_size=8, block_spp=4, sample_order="exchangeable", meta={"renderer": {"name": "test"}},
                scope={name: layers[name][2] for name in arrays}, **arrays)
    return {"radiance": radiance, **arrays}


def assert_same(path, arrays, layers=None):
    assert spool.check(path).ok
    with spool.open(path) as dump:
        names = set(dump.layers)
        for name in layers or arrays:
            assert name in names, (name, names)
            scope = {"film": "pass", "seed": "pass"}.get(name, "pixel" if name.startswith("reference") else "sample")
            got = {"sample": dump.read, "pixel": dump.pixel, "pass": dump.passes}[scope](name)
            assert got.dtype == arrays[name].dtype and got.tobytes() == arrays[name].tobytes(), name
        return names
