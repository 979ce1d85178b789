"""Every public function with every parameter out of a list of wrong values, one function a process.

    argument_cases.py FUNCTION      a JSON line before each case, and what came of it behind

test_arguments.py runs it and reads the lines: a process that dies leaves a case without an answer.
"""
import json
import os
import sys
import tempfile

import numpy as np

import spool

NUMBERS = {"-1": -1, "0": 0, "2.5": 2.5, "nan": float("nan"), "inf": float("inf"), "-inf": float("-inf"), "1e308": 1e308,
           "2^31": 2**31, "2^63": 2**63, "2^64": 2**64, "-2^63-1": -2**63 - 1, "10^400": 10**400, "numpy nan": np.float32("nan")}
OTHERS = {"None": None, "x": "x", "bytes": b"x", "NUL": "a\0b", "surrogate": "\udc80", "list": [1, 2], "dict": {"x": 1},
          "object": object(), "function": lambda *of: None}
ARRAYS = {"masked": np.ma.masked_array(np.ones((4, 5, 3)), np.ones((4, 5, 3), bool)), "texts": np.full((4, 5, 3), "1"),
          "objects": np.full((4, 5, 3), None), "fields": np.zeros((4, 5, 3), [("a", "f4")]), "complex": np.ones((4, 5, 3), complex),
          "dates": np.zeros((4, 5, 3), "M8[s]"), "no number": np.zeros((0, 5, 3)), "no column": np.zeros((4, 0, 3)),
          "one": np.ones(3), "scalar": np.float64(2.5), "five axes": np.ones((1, 2, 2, 2, 3)), "1 channel": np.ones((4, 5, 1)),
          "ragged": [[1, 2], [3]], "nan image": np.full((4, 5, 3), np.nan), "inf samples": np.full((4, 5, 8, 3), np.inf),
          "no sample": np.zeros((4, 5, 0, 3))}
SMALL = [label for label in NUMBERS if label not in ("2^63", "2^64", "-2^63-1", "10^400")]  # that TOML has
WRONG = {**NUMBERS, **OTHERS, **ARRAYS}

random = np.random.default_rng(1)
RADIANCE = random.random((4, 5, 8, 3), np.float32)
IMAGE = random.random((4, 5, 3))
COUNTS = np.full((4, 5), 2)
RECORDING = spool.recording(RADIANCE, reference=IMAGE)
SELECTION = spool.replay(RECORDING, "uniform", 2)
FOLDER = tempfile.mkdtemp()                   # of the temporary folder that the test gives


@spool.sampler
def own(statistics, amount=1):
    return np.full(statistics.n.shape, amount)


def judge(**of):
    return spool.metrics(**of)


def plan(**keys):
    arguments = {key: keys.pop(key) for key in ("output", "force", "exact_timing", "executor", "progress") if key in keys}
    return spool.evaluate({"recordings": [RECORDING], "samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1,
                           **keys}, **arguments)


def method(of, **keys):
    """A method of a plan."""
    return plan(**{of: [{"name": "multiscale" if of == "samplers" else "box", **keys}]})


def answer(value):
    return spool.replay(RECORDING, spool.sampler(lambda statistics: value, rounds=1), 4)


def picture(value):
    return spool.reconstruct(RECORDING, None, spool.filter(lambda statistics: value))


def saved(path=os.path.join(FOLDER, "w.spool"), **of):
    spool.write(path, **{"force": True, **of})


def written(**of):
    with spool.Writer(**of):
        pass


def remarked(path, meta):
    saved(radiance=RADIANCE)
    spool.append_meta(path, meta)


saved(radiance=RADIANCE, reference=IMAGE)
DUMP, PAGE = spool.open(os.path.join(FOLDER, "w.spool")), spool.show(IMAGE)

# name: (function, parameters with values that work, {parameter: wrong values that are right there})
FUNCTIONS = {
    "replay": (spool.replay, {"samples": RECORDING, "sampler": "multiscale", "spp": 2, "seed": 0, "order": "recorded", "filter": None,
                              "preset": "", "holdout": 0, "pieces": 1, "decision_split": False, "pool": None, "views": None,
                              "threads": 0, "alpha": 0.3, "init_spp": 1},
               {"spp": ["2.5", "scalar"], "seed": ["0", "2^31"], "filter": ["None"], "holdout": ["0"], "pool": ["None"], "views": ["None"],
                "threads": ["0"], "alpha": ["0"]}),
    "replay_own": (spool.replay, {"samples": RECORDING, "sampler": own, "spp": 4, "rounds": 2, "init_spp": 1, "features": False,
                                  "moments": 1.0},
                   {"spp": ["2.5", "scalar"], "moments": ["2.5", "scalar"]}),
    "reconstruct": (spool.reconstruct, {"samples": RECORDING, "selection": COUNTS, "filter": "directional", "spp": 0, "preset": "",
                                        "seed": 0, "order": "recorded", "holdout": 0, "pieces": 1, "pool": None, "views": (),
                                        "threads": 0, "whole": False, "clamp": "off"},
                    {"selection": ["None"], "spp": ["0"], "seed": ["0", "2^31"], "holdout": ["0"], "pool": ["None"], "threads": ["0"]}),
    "reconstruct_selection": (spool.reconstruct, {"samples": RECORDING, "selection": SELECTION, "filter": "box", "spp": 0, "seed": 0,
                                                  "order": "recorded", "holdout": 0, "pieces": 1},
                              {"selection": ["None"], "spp": ["0"], "seed": ["0"], "holdout": ["0"]}),
    "metrics": (judge, {"image": IMAGE, "reference": IMAGE + 0.1, "metrics": None, "variance": None, "standard_errors": False,
                        "threads": 0, "trim": 0.01, "rel_eps": 0.01, "rel_scale": "mean", "perceptual": "none"},
                {"metrics": ["None"], "variance": ["None"], "threads": ["0"], "trim": ["0"],
                 "rel_eps": ["2.5", "1e308", "2^31", "2^63", "2^64", "scalar"]}),
    "show": (spool.show, {"images": IMAGE, "reference": IMAGE, "crops": (), "title": "", "exposure": None, "max_mb": 16.0},
             {"images": ["nan image"], "reference": ["None", "nan image"], "crops": ["no number"], "title": ["x"],
              "exposure": ["None", "-1", "0", "2.5", "scalar"], "max_mb": ["2.5", "scalar"]}),
    "view": (spool.view, {"samples": RECORDING, "sampler": "uniform", "filter": "box", "spp": [2], "reference": None, "seed": 0,
                          "order": "recorded", "crops": (), "title": "", "exposure": None, "max_mb": 16.0},
             {"crops": ["no number"], "title": ["x"], "spp": ["2.5", "None", "list", "one", "scalar"], "reference": ["None", "nan image"], "seed": ["0", "2^31"],
              "exposure": ["None", "-1", "0", "2.5", "scalar"], "max_mb": ["2.5", "scalar"]}),
    "recording": (lambda **of: spool.replay(spool.recording(**of), "uniform", 1),
                  {"radiance": RADIANCE, "film": RADIANCE[..., :2], "albedo": RADIANCE, "normal": RADIANCE, "depth": RADIANCE[..., 0],
                   "reference": IMAGE, "reference_variance": IMAGE, "sample_order": "exchangeable", "name": "recording"},
                  {"film": ["None"], "albedo": ["None", "inf samples"], "normal": ["None", "inf samples"], "depth": ["None"], "reference": ["None"],
                   "reference_variance": ["None"], "name": ["x"]}),
    "synth": (spool.synth, {"scene": "slanted_edge", "width": 8, "height": 8, "spp": 2, "seed": 1, "path": None, "compress": False,
                            "force": False, "angle": 5},
              {"seed": ["0", "2^31"], "path": ["None", "x"], "angle": ["-1", "0", "2.5", "scalar"]}),
    "evaluate": (plan, {"recordings": [RECORDING], "samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1, "seed": 1,
                        "holdout": 2, "pieces_per_side": 1, "repeats": 1, "threads": [1], "order": "disjoint", "pictures": False,
                        "reference": "independent", "decision_split": False, "fresh": False, "halves": False,
                        "energy_band": [0.9, 1.1], "title": "t", "pool": {}, "metrics": {}, "output": None,
                        "force": False, "exact_timing": False, "executor": None, "progress": None},
                 {"executor": ["None"], "spp": ["2.5", "scalar", "list"], "seed": ["0", "2^31"], "holdout": ["0"], "threads": ["0", "list"], "energy_band": ["list"],
                  "title": [*SMALL, "x", "scalar"], "output": ["None", "x"], "progress": ["None", "function"]}),
    "evaluate_key": (plan, {"unknown": 1}, {}),
    "evaluate_method": (lambda **of: method("samplers", **of), {"name": "multiscale", "preset": "robust", "alpha": 0.3, "label": "l"},
                        {"alpha": ["0"], "label": ["0", "2.5", "nan", "inf", "2^31", "numpy nan", "x", "scalar"]}),
    "evaluate_path": (spool.evaluate, {"plan": "plan.toml"}, {}),
    "sampler": (lambda **of: spool.sampler(lambda statistics: statistics.n, **of),
                {"init_spp": None, "rounds": 2, "features": False, "moments": (), "label": None},
                {"init_spp": ["None"], "moments": ["2.5", "scalar", "list", "one"], "label": ["None", "x"]}),
    "sampler_function": (spool.sampler, {"function": lambda statistics: statistics.n}, {"function": ["None", "function"]}),
    "filter": (lambda **of: spool.filter(lambda statistics: statistics.mean, **of), {"features": False, "moments": (), "label": None},
               {"moments": ["2.5", "scalar", "list", "one"], "label": ["None", "x"]}),
    "filter_function": (spool.filter, {"function": lambda statistics: statistics.mean}, {"function": ["None", "function"]}),
    "answer": (answer, {"value": COUNTS}, {}),
    "picture": (picture, {"value": IMAGE}, {}),
    "open": (spool.open, {"path": "nowhere.spool"}, {}),
    "check": (lambda path: [_raised(error) for error in spool.check(path).errors], {"path": "nowhere.spool"}, {}),
    "results": (spool.results, {"folder": "nowhere"}, {}),
    "write": (saved, {"path": "w.spool", "radiance": RADIANCE, "tile_size": 64, "block_spp": 8, "sample_order": "renderer", "meta": None, "uuid": None,
                      "compress": False, "force": True, "components": None, "scope": None, "dtypes": None, "albedo": RADIANCE,
                      "reference": IMAGE},
              {"path": ["x", "surrogate"], "meta": ["None", "dict"], "uuid": ["None"], "components": ["None"], "scope": ["None"], "dtypes": ["None"],
               "radiance": ["inf samples"], "albedo": ["inf samples"]}),
    "append_meta": (remarked, {"path": "w.spool", "meta": {"x": 1}}, {"meta": ["dict"]}),
    "Writer": (written, {"path": "w.spool", "width": 5, "height": 4, "spp": 8, "layers": {"radiance": ("f4", "RGB")}, "channels": None,
                         "tile_size": 64, "block_spp": 8, "sample_order": "renderer", "meta": None, "uuid": None, "compress": False,
                         "force": True},
               {"path": ["x", "surrogate"], "channels": ["None"], "meta": ["None", "dict"], "uuid": ["None"]}),
    "Writer_channels": (written, {"path": "w.spool", "width": 5, "height": 4, "spp": 8, "channels": DUMP.channels[:3], "force": True},
                        {"path": ["x", "surrogate"]}),
    "page_save": (PAGE.save, {"path": "p.html", "force": True}, {"path": ["x"]}),
    "dump_read": (DUMP.read, {"layer": "radiance", "x0": 0, "y0": 0, "x1": 5, "y1": 4, "first": 0, "count": 8},
                  {"x0": ["0"], "y0": ["0"], "first": ["0"], "x1": ["None"], "y1": ["None"], "count": ["None"]}),
    "dump_pixel": (DUMP.pixel, {"layer": "reference"}, {}),
    "dump_block": (DUMP.block, {"group": 0, "tile": 0, "begin": 0, "copy": False},
                   {"group": ["0"], "tile": ["0"], "begin": ["0"]}),
}

# Public names without a case: numbers, and classes whose objects other functions make.
NOT_CALLED = {"DATA", "DAMAGE", "IO", "USAGE", "Channel", "Dump", "Image", "example", "Layer", "Method", "Page", "Reconstruction", "Recording",
              "Report", "Results", "Selection", "SpoolError", "Statistics", "filters", "samplers"}
# Parameters of a function, by name, that have their case under another one.
ELSEWHERE = {"options": "alpha, clamp, trim and angle", "layers": "albedo and reference of write", "function": "..._function",
             "plan": "evaluate_path"}


def _raised(error):
    raise error


def outcome(function, arguments):
    try:
        function(**arguments)
    except Exception as reason:
        return [type(reason).__name__, str(reason)]
    return None


def main(name):
    os.chdir(FOLDER)
    function, working, right = FUNCTIONS[name]
    for parameter in working:
        for label, value in WRONG.items():
            print(json.dumps({"parameter": parameter, "value": label, "right": label in right.get(parameter, [])}), flush=True)
            print(json.dumps(outcome(function, {**working, parameter: value})), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
