"""What is measured beside each other: functions of one noisy picture, and of one file of samples. Run by the Python that has
the programs of others (run.py); prints JSON.

Every subject runs in every turn, one thread each; the least CPU time of the turns counts.
"""
import hashlib
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import cv2
import flip_evaluator
import h5py
import numcodecs
import numpy as np
import pyoidn
import scipy.ndimage
import skimage.restoration
import zarr

import spool  # the package, built beside the program
from tools.bench.methods.mosaic import enlarged

ROOT = Path(__file__).resolve().parents[3]
SPP = 8


def picture(side):
    """Mirror images of a small recording beside each other: samples, features and reference."""
    with spool.open(ROOT / "dumps" / "tiny" / "chess.spool") as dump:
        times = side // dump.width
        layers = {name: enlarged(dump.read(name), times) for name in ("radiance", "albedo", "normal", "depth")}
        reference = enlarged(dump.pixel("reference")[:, :, None, :], times)[:, :, 0]
    return layers, np.ascontiguousarray(reference, np.float32)


def denoiser(device, kind, image, **auxiliary):
    """Open Image Denoise; auxiliary images are taken as they are, or as clean ones."""
    clean = auxiliary.pop("clean", False)
    height, width, _ = image.shape
    result = np.zeros((height, width, 3), np.float32)
    run = pyoidn.Filter(device, "RT")
    images = {name: np.ascontiguousarray(a, np.float32) for name, a in {kind: image, **auxiliary}.items()}
    for name, array in {**images, "output": result}.items():
        run.set_image(name, array, pyoidn.OIDN_FORMAT_FLOAT3, width, height)
    if kind == "color":
        run.set_bool("hdr", True)
    if clean:
        run.set_bool("cleanAux", True)
    run.commit()
    run.execute()
    return result


def filters_of_others(noisy, features, noise):
    """Name: function that gives an image. Constants are those of the packages' examples, with the noise that is known."""
    device = pyoidn.Device()
    device.set_int("numThreads", 1)
    device.commit()
    guide = np.ascontiguousarray(features["albedo"], np.float32)

    def prefiltered():
        clean = {name: denoiser(device, name, image) for name, image in features.items()}
        return denoiser(device, "color", noisy, clean=True, **clean)

    return {
        "scipy: gaussian_filter, sigma 1": lambda: scipy.ndimage.gaussian_filter(noisy, (1, 1, 0)),
        "scikit-image: denoise_nl_means, fast": lambda: skimage.restoration.denoise_nl_means(
            noisy, patch_size=5, patch_distance=6, h=0.8 * noise, sigma=noise, fast_mode=True, channel_axis=-1),
        "OpenCV: bilateralFilter": lambda: cv2.bilateralFilter(noisy, 9, 3 * noise, 3),
        "OpenCV: guidedFilter, albedo": lambda: cv2.ximgproc.guidedFilter(guide, noisy, 4, 1e-3),
        "Open Image Denoise, colour": lambda: denoiser(device, "color", noisy),
        "Open Image Denoise, albedo and normal": lambda: denoiser(device, "color", noisy, **features),
        "Open Image Denoise, prefiltered": prefiltered,
    }


def our_filters(recording):
    names = ("box", "gaussian", "wavelet_shrinkage", "welch", "stater", "multistage", "directional", "greedy_selection", "nl_means",
             "cross_bilateral", "twin_guides", "twin_guides{scales=1}")
    return {f"spool: {name}": (lambda name=name: spool.reconstruct(recording, None, name, spp=SPP, threads=1)) for name in names}


def our_samplers(recording):
    names = ("uniform", "neyman", "denoised_variance", "mitchell", "multiscale", "greedy_error", "adaptive_wavelet", "nl_means",
             "cross_bilateral", "cross_halves", "filtered_halves")
    return {f"spool: {name}": (lambda name=name: spool.replay(recording, name, SPP, threads=1)) for name in names}


def our_pairs(recording):
    """Both stages of a method, as its authors mean it."""
    def both(sampler, filter):
        return spool.reconstruct(recording, spool.replay(recording, sampler, SPP, threads=1), filter, threads=1)

    pairs = (("multiscale", "directional"), ("multiscale", "nl_means"), ("multiscale", "twin_guides"), ("greedy_error", "greedy_selection"),
             ("nl_means", "nl_means"), ("cross_bilateral", "cross_bilateral"), ("filtered_halves", "directional"))
    return {f"spool: {sampler} + {filter}": (lambda pair=(sampler, filter): both(*pair)) for sampler, filter in pairs}


def write_hdf5(path, samples):
    with h5py.File(path, "w") as file:
        file.create_dataset("radiance", data=samples, chunks=(64, 64, samples.shape[2], 3), fletcher32=True)


def files_of(radiance, folder):
    """The same samples in three formats with a checksum on every chunk."""
    flat = np.ascontiguousarray(radiance)
    spool.write(folder / "a.spool", flat, sample_order="exchangeable")
    write_hdf5(folder / "a.h5", flat)
    store = zarr.create_array(folder / "a.zarr", shape=flat.shape, chunks=(64, 64, flat.shape[2], 3), dtype="f4", filters=None,
                              compressors=[zarr.codecs.Crc32cCodec()])
    store[:] = flat
    flat.tofile(folder / "a.raw")
    return flat.nbytes


def read_spool(path, *corners):
    with spool.open(path) as dump:
        return np.asarray(dump.read("radiance", *corners))


def read_hdf5(path, region=slice(None)):
    with h5py.File(path) as file:
        return file["radiance"][region]


def readers(folder, program):
    raw = np.fromfile(folder / "a.raw", "f4")
    room = np.zeros_like(raw)
    box = [program, "reconstruct", folder / "a.spool", "--filter", "box", "--threads", "1", "-q", "--force", "-o", folder / "o.exr"]
    return {
        "numpy: read the bytes (fromfile)": lambda: np.fromfile(folder / "a.raw", "f4"),
        "numpy: sum": lambda: raw.sum(),
        "numpy: copy, into new memory": lambda: raw.copy(),
        "numpy: copy, into memory in use": lambda: np.copyto(room, raw),
        "numpy: mean of each pixel's samples": lambda: raw.reshape(-1, 64).mean(axis=1),
        "zlib: crc32": lambda: zlib.crc32(raw),
        "hashlib: SHA-256": lambda: hashlib.sha256(raw).digest(),
        "h5py: read, fletcher32": lambda: read_hdf5(folder / "a.h5"),
        "zarr: read, crc32c": lambda: zarr.open_array(folder / "a.zarr", mode="r")[:],
        "spool in Python: read, CRC-32": lambda: read_spool(folder / "a.spool"),
        "spool reconstruct --filter box, whole command": lambda: subprocess.run(box, check=True),
    }


def region_readers(folder):
    """64 x 64 pixels across four blocks, all samples."""
    of_hdf5 = lambda: read_hdf5(folder / "a.h5", np.s_[32:96, 32:96])
    times = 20  # a region is read in milliseconds
    runs = {"h5py: region, fletcher32": of_hdf5, "spool in Python: region, CRC-32": lambda: read_spool(folder / "a.spool", 32, 32, 96, 96),
            "zarr: region, crc32c": lambda: zarr.open_array(folder / "a.zarr", mode="r")[32:96, 32:96]}
    assert all(np.array_equal(np.asarray(run()).reshape(-1), of_hdf5().reshape(-1)) for run in runs.values())
    return {name: (lambda run=run: [run() for _ in range(times)]) for name, run in runs.items()}, times


def packers(radiance, folder, program):
    """What stands in memory or in an .npz, written as a file that knows its own checksums."""
    flat = np.ascontiguousarray(radiance)
    np.savez(folder / "p.npz", radiance=flat, meta=np.array(json.dumps({"layout": "HWSC"})))
    pack = [program, "pack", folder / "p.npz", "--from", "npz", "-q", "--force", "-o", folder / "p.spool"]

    return {
        "spool pack --from npz, whole command": lambda: subprocess.run(pack, check=True),
        "spool pack --from npz --compress, whole command": lambda: subprocess.run([*pack, "--compress"], check=True),
        "numpy: load the npz": lambda: np.load(folder / "p.npz")["radiance"],
        "numpy: load the npz, h5py: write, fletcher32": lambda: write_hdf5(folder / "p.h5", np.load(folder / "p.npz")["radiance"]),
    }


def judges(image, reference, folder, program):
    for name, pixels in (("a", image), ("b", reference)):
        cv2.imwrite(str(folder / f"{name}.tiff"), np.ascontiguousarray(pixels[:, :, ::-1], np.float32))
    small = [np.ascontiguousarray(np.clip(a, 0, 1), np.float32) for a in (reference, image)]
    return {
        "flip-evaluator: LDR FLIP": lambda: flip_evaluator.evaluate(small[0], small[1], "LDR"),
        "idiff (OpenImageIO), whole command": lambda: subprocess.run(
            ["idiff", folder / "a.tiff", folder / "b.tiff"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL),
        "spool.metrics: all 30, with FLIP": lambda: spool.metrics(image, reference, threads=1),
    }


def cpu():
    """Of this process, all threads, and of those that it waited for, seconds."""
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def measured(groups, turns, longest):
    """{name: (least CPU seconds, what it gave last)}; what takes longer than `longest` runs once."""
    least, given = {}, {}
    for turn in range(turns):
        for name, run in groups.items():
            if least.get(name, 0) > longest:
                continue
            begin = cpu()
            given[name] = run()
            spent = cpu() - begin
            least[name] = min(least.get(name, spent), spent)
            print(f"turn {turn + 1} of {turns}: {name} {spent:.2f} s", file=sys.stderr)
    return {name: (least[name], given[name]) for name in groups}


def main():
    program, side, turns, longest = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
    without = re.compile(sys.argv[5])
    cv2.setNumThreads(1)
    numcodecs.blosc.set_nthreads(1)
    layers, reference = picture(side)
    recording = spool.recording(np.moveaxis(np.ascontiguousarray(np.moveaxis(layers["radiance"], 3, 0)), 0, 3),
                                albedo=layers["albedo"], normal=layers["normal"], depth=layers["depth"], reference=reference)
    noisy = np.ascontiguousarray(layers["radiance"][:, :, :SPP].mean(axis=2), np.float32)
    features = {name: np.ascontiguousarray(layers[name][:, :, :SPP].astype("f4").mean(axis=2)) for name in ("albedo", "normal")}
    noise = float(np.median(layers["radiance"][:, :, :SPP].std(axis=2)) / np.sqrt(SPP))
    million = side * side / 1e6
    rows = []

    def add(kind, groups, per, unit, error=False):
        groups = {name: run for name, run in groups.items() if not without.search(name)}
        for name, (seconds, given) in measured(groups, turns, longest).items():
            found = spool.metrics(np.asarray(given, float), reference, threads=1) if error else {}
            rows.append({"kind": kind, "name": name, "cost": seconds / per, "unit": unit,
                         "relmse": found.get("relmse"), "mse": found.get("mse"), "energy": found.get("energy_ratio")})

    add("filter", {**filters_of_others(noisy, features, noise), **our_filters(recording)}, million, "CPU-s/MP", True)
    add("pair", our_pairs(recording), million, "CPU-s/MP", True)
    add("sampler", our_samplers(recording), million, "CPU-s/MP")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        size = files_of(layers["radiance"], folder)
        add("file", readers(folder, program), size / 1e9, "CPU-s/GB")
        regions, times = region_readers(folder)
        add("region", regions, times / 1e3, "CPU-ms")
        add("pack", packers(layers["radiance"], folder, program), size / 1e9, "CPU-s/GB")
        add("judge", judges(noisy.astype(float), reference.astype(float), folder, program), million, "CPU-s/MP")
    print(json.dumps({"side": side, "turns": turns, "rows": rows}))


if __name__ == "__main__":
    main()
