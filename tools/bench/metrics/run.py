"""Writes the table of docs/metric_checks.md, `spool metrics` against other people's programs: tools/dev.sh bench metrics [--print].

Run by the Python that has the programs of others (tools/bench/peers).
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from tools.bench.speed_page import ROOT, parser_of, replace_section
from tools.study.tables import as_csv, markdown

TABLE = ROOT / "docs" / "results" / "metric_checks.csv"
RECORDINGS = ["chess", "table", "caustic", "mist"]
METRICS = ["mse", "rmse", "psnr_tm", "ssim", "ms_ssim", "flip_ldr", "flip_hdr", "relmse", "relmse_trimmed", "mae", "relmae",
           "smape", "se_p999", "energy_ratio", "energy_ratio_d1", "energy_ratio_d10"]
BY = {"mse": "scikit-image `mean_squared_error`", "rmse": "root of that", "psnr_tm": "scikit-image `peak_signal_noise_ratio`",
      "ssim": "scikit-image `structural_similarity`", "ms_ssim": "scipy, after [WangSimoncelliBovik03]",
      "flip_ldr": "flip-evaluator, LDR", "flip_hdr": "flip-evaluator, HDR"}


def make_images(program, folder):
    """(name, image, reference) of every recording, made by the program."""
    def spool(*arguments):
        subprocess.run([program, *map(str, arguments), "-q"], check=True, stdout=subprocess.DEVNULL)
    spool("synth", "scene_s_fireflies", "--size", 192, "--samples", 32, "--seed", 3, "-o", folder / "scene_s.spool")
    recordings = [folder / "scene_s.spool", *(ROOT / f"dumps/tiny/{name}.spool" for name in RECORDINGS)]
    spool("evaluate", *recordings, "--samplers", "uniform", "--filters", "box", "--spp", 8, "--replicates", 1, "-o",
          folder / "out")
    for recording in recordings:
        name = recording.stem
        estimate = next((folder / "out").glob(f"{name}_uniform_box_8spp/*estimate*.exr"))
        yield name, estimate, folder / f"out/{name}_reference.exr"


def ms_ssim(a, b):
    import numpy as np
    from scipy.ndimage import correlate1d
    taps = np.exp(-0.5 * (np.arange(-5, 6) / 1.5) ** 2)
    taps /= taps.sum()

    def window_mean(v):
        return correlate1d(correlate1d(v, taps, axis=0), taps, axis=1)[5:-5, 5:-5]

    scales = 1
    while scales < 5 and min(a.shape) >> scales >= 11:
        scales += 1
    exponents = np.array([0.0448, 0.2856, 0.3001, 0.2363, 0.1333])[:scales]
    exponents /= exponents.sum()
    product = 1.0
    for j, exponent in enumerate(exponents):
        ma, mb = window_mean(a), window_mean(b)
        va, vb, ab = window_mean(a * a) - ma**2, window_mean(b * b) - mb**2, window_mean(a * b) - ma * mb
        term = (2 * ab + 9e-4) / (va + vb + 9e-4)
        if j == scales - 1:
            term = term * (2 * ma * mb + 1e-4) / (ma**2 + mb**2 + 1e-4)
        product *= max(term.mean(), 0) ** exponent
        h, w = a.shape[0] // 2 * 2, a.shape[1] // 2 * 2
        a, b = (v[:h, :w].reshape(h // 2, 2, w // 2, 2).mean(axis=(1, 3)) for v in (a, b))
    return product


def independent(image, reference):
    import flip_evaluator
    import numpy as np
    from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity
    weights = np.array([0.2126, 0.7152, 0.0722])
    exposure = 0.18 / np.exp(np.mean(np.log(np.maximum(reference @ weights, 0) + 1e-4)))

    def tone(v):
        v = np.clip(exposure * v, 0, 1)
        return np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)

    def flip(kind, a, b):
        return flip_evaluator.evaluate(b.astype("f4"), a.astype("f4"), kind, inputsRGB=kind == "LDR", applyMagma=False)[1]

    mse = mean_squared_error(reference, image)
    luma = [tone(v) @ weights for v in (image, reference)]
    scale = 1 / np.mean(reference @ weights)
    i, r = scale * image, scale * reference
    per_pixel = np.sort(((i - r) ** 2 / (r**2 + 0.01)).mean(axis=2).ravel())
    squared = np.sort(((image - reference) ** 2).mean(axis=2).ravel())
    dropped = int(np.ceil(0.001 * per_pixel.size))
    order = np.argsort(reference @ weights, axis=None, kind="stable")
    ends = np.ceil(np.arange(11) * order.size / 10).astype(int)

    def energy(pixels):
        return image.reshape(-1, 3)[pixels].sum() / reference.reshape(-1, 3)[pixels].sum()

    return {
        "mse": mse, "rmse": np.sqrt(mse),
        "psnr_tm": peak_signal_noise_ratio(tone(reference), tone(image), data_range=1.0),
        "ssim": structural_similarity(*luma, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0),
        "ms_ssim": ms_ssim(*luma), "flip_ldr": flip("LDR", tone(image), tone(reference)), "flip_hdr": flip("HDR", image, reference),
        "relmse": per_pixel.mean(), "relmse_trimmed": per_pixel[:-dropped].mean(), "mae": np.abs(image - reference).mean(),
        "relmae": (np.abs(i - r) / (np.abs(r) + 0.01)).mean(), "smape": (np.abs(i - r) / (np.abs(i) + np.abs(r) + 0.01)).mean(),
        "se_p999": squared[::-1][squared.size // 1000], "energy_ratio": energy(order),
        "energy_ratio_d1": energy(order[ends[0]:ends[1]]), "energy_ratio_d10": energy(order[ends[9]:ends[10]]),
    }


def compare(program, keep):
    from importlib.metadata import version

    import flip_evaluator  # noqa: F401
    import numpy as np
    import skimage

    import spool.exr
    rows, worst = [], {}
    with tempfile.TemporaryDirectory() as folder:
        for name, image, reference in make_images(program, Path(folder)):
            printed = subprocess.run([program, "metrics", image, reference, "--set", "perceptual=all", "--json"], check=True,
                                     capture_output=True, text=True).stdout
            ours = {metric: found["value"] for metric, found in json.loads(printed)["metrics"].items()}
            a, b = (np.stack([np.asarray(spool.exr.read(p)[c], dtype="f8") for c in "RGB"], axis=-1) for p in (image, reference))
            theirs = independent(a, b)
            for metric in METRICS:
                difference = abs(ours[metric] - float(theirs[metric]))
                worst[metric] = max(worst.get(metric, 0.0), difference)
                rows.append([name, metric, BY.get(metric, "numpy").replace("`", ""), f"{ours[metric]:.9g}", f"{theirs[metric]:.9g}", f"{difference:.1e}"])
    table = (f"With scikit-image {skimage.__version__}, flip-evaluator {version('flip-evaluator')}:\n\n" +
             markdown(["metric", "independent", "largest difference"], [[f"`{m}`", BY.get(m, "numpy"), f"{worst[m]:.1e}"] for m in METRICS]))
    if keep:
        TABLE.write_text(as_csv(["image", "metric", "independent", "spool", "other", "difference"], rows), encoding="utf-8")
        replace_section("metrics", table, ROOT / "docs" / "metric_checks.md")
    print(table)
    return 0 if max(worst["flip_ldr"], worst["flip_hdr"]) < 1e-4 else 1


def main():
    if sys.argv[1:2] == ["--compare"]:
        sys.exit(compare(Path(sys.argv[2]), "--print" not in sys.argv))
    options = parser_of(__doc__, "docs/metric_checks.md").parse_args()
    from tools.bench.peers.run import peers_python  # draws with matplotlib, which that Python lacks
    sys.exit(subprocess.run([peers_python(), "-m", "tools.bench.metrics.run", "--compare", options.build.resolve() / "spool",
                             *["--print"] * options.print]).returncode)


if __name__ == "__main__":
    main()
