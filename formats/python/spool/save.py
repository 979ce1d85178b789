"""One call from arrays to a complete `.spool` file."""
import warnings

import numpy as np

from .arguments import array, mapping, note_axes
from .arguments import path as path_of
from .channel import VOCABULARY
from .error import SpoolError
from .reference_check import check_judges
from .writer import Writer

_DTYPES = {"f2": "<f2", "f4": "<f4", "f8": "<f4", "u1": "<u4", "u2": "<u4", "u4": "<u4", "b1": "<u4"}
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
PIXEL_LAYERS = {"reference", "reference_variance", "sample_variance"}


def write(path, /, radiance, *, meta=None, components=None, scope=None, dtypes=None, tile_size=64, block_spp=16,
          sample_order="renderer", uuid=None, compress=False, force=False, **layers):
    """Writes radiance [y][x][s][3] and any further layers.

    Layers of scope sample are [y][x][s][c], of scope pixel [y][x][c] and of scope pass [s][c]; a single component may
    leave out its axis. `reference`, `reference_variance` and `sample_variance` have scope pixel, every other layer has
    scope sample unless `scope` says otherwise: scope={"film": "pass"}. Components come from the specification's list of
    layers, or from `components`: {"half_vector": "XYZ"}. float64 is rounded to float32; `dtypes` asks for another:
    {"albedo": "f2"}. A `reference_variance` that is below 0 or not finite where the reference is, is an error.
    """
    path = path_of("path", path)
    components, scope, dtypes = (mapping(name, {} if given is None else given) for name, given in
                                 (("components", components), ("scope", scope), ("dtypes", dtypes)))
    arrays = {name: array(f"{path}: {name}", values, "f" if 0 < VOCABULARY.get(name, ("", 0))[1] < 8 and name not in dtypes else "fiub")
              for name, values in {"radiance": radiance, **layers}.items()}
    if arrays["radiance"].ndim != 4 or arrays["radiance"].shape[3] != 3:
        raise SpoolError("usage", f"{path}: radiance has shape {arrays['radiance'].shape}, not (height, width, spp, 3)")
    note_axes(path, arrays)
    for name in {**components, **scope, **dtypes}:
        if name not in arrays:
            raise SpoolError("usage", f"{path}: no layer {name}: it has {', '.join(arrays)}")
    check_reference(path, arrays)
    height, width, spp, _ = arrays["radiance"].shape
    declared = {}
    for name, values in arrays.items():
        if name not in components and name not in VOCABULARY:
            raise SpoolError("usage", f"{path}: layer {name} is not in the list: name its components")
        if name in PIXEL_LAYERS and scope.get(name, "pixel") != "pixel":
            raise SpoolError("usage", f"{path}: {name} has one value per pixel: leave its scope out")
        code = dtypes.get(name) or _DTYPES.get(values.dtype.newbyteorder("=").str[1:])
        if code is None:
            raise SpoolError("usage", f"{path}: layer {name} is {values.dtype}: convert it with astype")
        declared[name] = (code, components.get(name, VOCABULARY.get(name, ("",))[0]),
                          scope.get(name, "pixel" if name in PIXEL_LAYERS else "sample"))
    with Writer(path, width, height, spp, declared, tile_size=tile_size, block_spp=block_spp,
                sample_order=sample_order, meta=meta, uuid=uuid, compress=compress, force=force) as writer:
        try:
            _note_values(path, arrays)
            _note_normals(path, arrays)
            _note_film(path, arrays)
            _write_all(writer, arrays, declared)
        except BaseException as error:  # Ctrl-C, too
            if getattr(error, "kind", "usage") == "usage":  # of the arrays, which are all still there
                writer.discard()
            raise


def _note_values(path, arrays):
    """As `spool pack` remarks it (formats/interchange/dump_import.cpp)."""
    floats = [values for values in arrays.values() if values.dtype.kind == "f"]
    rows = [row for values in floats for row in (values if values.ndim > 1 else values[None])]
    if count := sum(row.size - np.count_nonzero(np.isfinite(row)) for row in rows):
        warnings.warn(f"{path}: values that are not finite, stored as they are: {count}", stacklevel=3)
    if count := sum(np.count_nonzero(np.abs(row) == 65504) for row in rows if row.dtype.itemsize == 2):
        warnings.warn(f"{path}: values at the half-float limit, clamped by the renderer: {count}", stacklevel=3)


def _near_one(vectors):
    return np.abs(np.linalg.norm(vectors, axis=1) - 1) <= 0.05


def _note_normals(path, arrays):
    """As `spool pack` remarks it (formats/interchange/feature_ranges.cpp)."""
    for name, values in arrays.items():
        if VOCABULARY.get(name, ("", 0))[1] != 3 or values.ndim != 4 or values.shape[3] != 3 or not values.size:
            continue
        pixels = values.reshape(-1, *values.shape[2:])
        v = pixels[::1 + len(pixels) // 2**14].reshape(-1, 3).astype(np.float64)
        v = v[np.isfinite(v).all(axis=1) & v.any(axis=1)]
        if len(v) < 16 or (v < 0).any():
            continue
        if _near_one(v).mean() >= 0.95:
            continue
        if v[:, 0].max() <= 1.001 and (_near_one(2 * v - 1) | (np.linalg.norm(2 * v - 1, axis=1) < 0.05)).mean() >= 0.95:
            warnings.warn(f"{path}: {name}: encoded as n / 2 + 1 / 2 (no value is below 0): store 2 v - 1", stacklevel=3)
        elif _near_one(v * 2 / 255 - 1).mean() >= 0.95:
            warnings.warn(f"{path}: {name}: encoded in 8 bits, 0 to 255: store 2 v / 255 - 1", stacklevel=3)


def _note_film(path, arrays):
    """As `spool pack` remarks it (formats/interchange/feature_ranges.cpp). What is float64 is rounded first, as it is stored."""
    film = np.asarray(arrays.get("film", ()))
    stored = film.astype(np.float32) if film.dtype == np.float64 else film
    stored = stored[np.isfinite(stored)] if stored.dtype.kind == "f" else stored
    if stored.size and (stored.min() < 0 or stored.max() >= 1):
        warnings.warn(f"{path}: film: from {stored.min():.6g} to {stored.max():.6g}: positions inside the pixel are expected, 0 to below 1: "
                      "store v - floor(v)", stacklevel=3)


def check_reference(path, arrays):
    """Errors are debiased by its variance, and made too small where it is of the same samples."""
    radiance, reference = arrays["radiance"], arrays.get("reference")
    check_judges(path, reference, arrays.get("reference_variance"))
    if reference is not None and reference.shape == (*radiance.shape[:2], 3):
        _note_own_mean(path, radiance, reference)
        _note_other_picture(path, radiance, reference)


def is_mean_of(samples, reference):
    """Whether a reference [y][x][c] lies where the mean of the samples [y][x][s][c], float64, does (lib/experiment/reference.cpp). Of other
    samples 2 % of the values lie so near."""
    if samples.shape[2] < 2:
        return False
    with np.errstate(all="ignore"):  # whatever the samples are
        mean, error = samples.mean(axis=2), samples.std(axis=2, ddof=1) / np.sqrt(samples.shape[2])
        noisy = error > 1e-4 * np.abs(mean)
        near = np.abs(mean - reference) < 0.02 * error
    return noisy.sum() >= 32 and near[noisy].mean() >= 0.99


def _note_own_mean(path, radiance, reference):
    """What is judged by the mean of its own samples is judged too kindly (lib/experiment/reference.cpp)."""
    rows = slice(None, None, 1 + radiance.size // 2**20)
    if is_mean_of(radiance[rows].astype(np.float64), reference[rows]):
        warnings.warn(f"{path}: the reference is the mean of these samples, which judges them too kindly: render one of other samples, "
                      "or leave it out", stacklevel=4)


def _note_other_picture(path, radiance, reference):
    """As `spool pack` remarks it (formats/interchange/reference_watch.cpp)."""
    rows = slice(None, None, 1 + radiance.size // 2**22)
    if found := other_picture(radiance[rows].astype(np.float64), reference, rows):
        warnings.warn(f"{path}: the reference {found}", stacklevel=4)


def other_picture(samples, reference, rows=slice(None)):
    """What is wrong with a reference [y][x][c] beside the samples [y][x][s][c] of these rows, float64; or nothing."""
    views = {"": reference, "upside down": reference[::-1], "mirrored": reference[:, ::-1], "turned by 180 degrees": reference[::-1, ::-1]}
    if reference.shape[0] == reference.shape[1]:
        views["with x and y exchanged"] = reference.transpose(1, 0, 2)
    views = {name: view[rows].astype(np.float64) for name, view in views.items()}
    finite = np.isfinite(samples).all(axis=3)
    n = finite.sum(axis=2)
    compared = (n > 0) & np.all([np.isfinite(view).all(axis=2) for view in views.values()], axis=0)
    if compared.sum() < 256:
        return ""
    with np.errstate(all="ignore"):  # whatever the samples are
        samples, n = np.where(finite[..., None], samples, 0)[compared], n[compared]
        mean, light = samples.sum(axis=1) / n[:, None], samples @ _LUMINANCE
        scale = np.abs(views[""][compared] @ _LUMINANCE).mean()
        tone = lambda v: v / (np.abs(v) + scale)  # noqa: E731
        distances = {(name, order): np.sum((tone(mean) - tone(view[compared][:, ::order])) ** 2) for name, view in views.items() for order in (1, -1)}
        best = min(distances, key=distances.get)
        if distances[best] < 0.7 * distances["", 1]:
            return f"fits the samples {' and '.join(filter(None, (best[0], 'with red and blue exchanged' * (best[1] < 0))))}: save both alike"
        sure = n > 1
        n, mine, judge = n[sure], light[sure].sum(axis=1) / n[sure], views[""][compared][sure] @ _LUMINANCE
        variance = np.abs((light[sure] ** 2).sum(axis=1) - n * mine ** 2) / (n - 1) / n
    order = np.argsort(judge, kind="stable")
    quarter = compared.sum() // 4
    for part, much, where in ((order, 1.1, ""), (order[len(order) - quarter:], 1.5, " in the brightest quarter"), (order[:quarter], 1.5, " in the darkest quarter")):
        has, wanted, noise = judge[part].sum(), mine[part].sum(), 6.1 * np.sqrt(variance[part].sum())
        shown = has > 0 or (has == 0 and part is order)  # a few noisy pixels may be black by chance
        if shown and wanted > 0 and abs(has - wanted) >= noise and not 1 / much <= has / wanted <= much:
            return (f"has {has / wanted:.2g} times the light of the samples{where}, beyond their noise: save the same picture in their units, "
                    "linear, with nothing clamped")
    return ""


def _write_all(writer, arrays, declared):
    samples = {name: values for name, values in arrays.items() if declared[name][2] == "sample"}
    writer.write_passes(0, samples)
    for name, values in arrays.items():
        if declared[name][2] == "pixel":
            writer.write_pixel(name, values)
        elif declared[name][2] == "pass":
            writer.write_pass(name, values)
