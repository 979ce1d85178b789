"""Every layer that was recorded holds something: finite, not the same everywhere, and along edges not the
same in every sample of a pixel (all samples at one place would show no edge)."""
import numpy as np

from dumps.verify.finding import finding

PLACES = ("depth", "position", "shape", "object")      # 0 where nothing is hit
HITS = ("albedo", "normal", *PLACES)


def feature_findings(dump):
    found, features, hit = [], [], {}
    for name, layer in dump.layers.items():
        if name in ("radiance", "film", "reference", "reference_variance") or layer.scope != "sample":
            continue
        values = dump.read(name, first=0, count=min(4, dump.spp)).astype(np.float64)
        finite = np.isfinite(values).mean()
        if name in HITS:
            hit[name] = bool(values.any())
            features.append(float((values != values[:, :, :1]).any(axis=(2, 3)).mean()))
        spread = float(np.nanmax(values) - np.nanmin(values)) if finite else 0.0
        found.append(finding("layer %s" % name, bool(finite == 1.0 and spread > 0),
                             "%.4g %% finite, range %.4g" % (100 * finite, spread), "finite and not constant",
                             note="" if spread else "empty: the renderer wrote nothing into this pass"))
    if any(name in PLACES for name in hit) and not any(hit.values()):
        return [entry for entry in found if entry["name"].partition("layer ")[2] not in HITS] + [
            finding("features", None, "0 everywhere", "surfaces", note="the camera hits nothing, or the renderer wrote nothing")]
    if features and dump.spp > 1:
        found.append(finding("features vary", max(features) > 0, "in %.3g of the pixels" % max(features),
                             "in some", note="" if max(features) > 0 else "every sample hits the same place"))
    return found


def picture_findings(radiance):
    """Empty, or that most of the picture holds nothing to measure: no error of the samples, and seldom what was meant."""
    same = (radiance == radiance[:, :, :1]).all(axis=(2, 3))
    black = float((same & (radiance[:, :, 0] == 0).all(axis=2)).mean())
    if black > 0.5:
        return [finding("picture", None, "%.4g %% of the pixels are exactly black in every sample" % (100 * black), "less than half",
                        note="has the scene its lights, and does the camera see them?")]
    if radiance.shape[2] > 1 and same.mean() > 0.5:
        return [finding("picture", None, "%.4g %% of the pixels are the same in every sample" % (100 * same.mean()), "less than half",
                        note="without noise there is nothing to sample: does the camera see anything but the background?")]
    return []


def why_the_same(radiance, one_value):
    if not one_value:
        return "the seed did not reach the renderer"
    return "every sample is %s: %s" % (("black", "has the scene a light, and does the camera see it?") if not radiance.any() else
                                       ("one colour", "does the camera see anything but the background?"))


def radiance_findings(radiance):
    bad = int((~np.isfinite(radiance)).any(axis=3).sum())
    negative = int((radiance < 0).any(axis=3).sum())
    total = radiance[..., 0].size
    same = bool(radiance.shape[2] > 1 and (radiance == radiance[:, :, :1]).all())
    one_value = bool((radiance == radiance[:1, :1, :1]).all())
    found = [finding("samples finite", bad <= total * 1e-4, "%d of %d are not" % (bad, total), "at most 1e-4",
                     note="%d negative" % negative if negative else "")]
    found.append(finding("samples differ", not same, "all passes are the same" if same else "they do", "they do",
                         note=why_the_same(radiance, one_value) if same else ""))
    return found
