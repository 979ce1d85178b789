"""Help, errors and exit codes; info, check, replay, reconstruct and list on good files."""
import hashlib
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

import spool
from conftest import PROGRAM, read_exr, samples, write_dump
from results_comparison import cell_lines

VERBS = ["info", "check", "recover", "pack", "synth", "replay", "reconstruct", "evaluate", "list"]


def test_help_lists_every_verb_and_the_exit_codes(good):
    text = good("--help").out
    for verb in VERBS:
        assert re.search(rf"^\s+{verb}\s", text, re.M)
    assert "Exit codes" in text


@pytest.mark.parametrize("verb", VERBS)
def test_examples_of_the_help_are_of_this_verb_and_use_its_options(good, verb):
    options = good(verb, "--help").out
    own = [line for line in options.replace("\\\n", " ").splitlines() if line.startswith(f"  spool {verb} ")]
    assert own
    for line in own:
        for option in re.findall(r" (--[a-z-]+)", line):
            assert f"{option} " in options.replace(line, ""), line


def test_misuse_is_exit_code_2_with_the_nearest_word(run, dump):
    run("infoo", dump).failed_with(2, "did you mean 'info'")
    run("info", dump, "--jsn").failed_with(2, "did you mean '--json'")
    run("info").failed_with(2, "FILE", "NAME.spool", "spool info --help")
    run("eval").failed_with(2, "did you mean 'evaluate'")
    run("info", dump, "more").failed_with(2, "more: more than the verb takes")
    run("pixel", dump).failed_with(2, "--at", "X,Y")
    run("replay", dump, "--spp", 2, "--spp", 4).failed_with(2, "--spp: given more than once")
    run("list", "samplings").failed_with(2, "samplings")
    run("replay", dump, "--sampler", "unifrm", "--spp", 2, "-o", "s.exr").failed_with(2, "uniform")
    run("reconstruct", dump, "--filter", "boxx", "-o", "i.exr").failed_with(2, "did you mean 'box'")
    replay = ("replay", dump, "--sampler", "multiscale", "--spp", 2, "-o", "s.exr")
    run(*replay, "--set", "sampler.exposur=none").failed_with(2, "exposure")
    run(*replay, "--set", "samplr.exposure=none").failed_with(2, "did you mean 'sampler'")
    run(*replay, "--set", "sampler.exposure=never").failed_with(2, "normalise|none")
    run(*replay, "--set", "exposure").failed_with(2, "PART.OPTION=VALUE")
    run(*replay, "--preset", "none").failed_with(2, "preset")


@pytest.mark.parametrize("words, said", {
    "replay FILE --sampler uniform --spp 2 -o a.exr --order shufled":
        "--order: 'shufled' is not one of recorded|shuffled, did you mean 'shuffled'?",
    "compare a b --match 2": "--match: '2' is not one of label|name",
    "evaluate FILE --timing fast": "--timing: 'fast' is not one of shared|exact",
    "convert FILE --to npy -o a": "--to: 'npy' is not one of npz|exr-folder|",
    "completion tcsh": "SHELL: 'tcsh' is not one of bash|zsh|fish",
    "reconstruct FILE --filter box -o a.exr --spp 4.5": "--spp: '4.5' is not a whole number in 1 .. 65536",
    "reconstruct FILE --filter box -o a.exr --spp 0": "--spp: '0' is not a whole number in 1 .. 65536",
    "pixel FILE --at 0,0 --samples -1": "--samples: '-1' is not a whole number in 1 .. 65536",
    "pixel FILE --at 0,0 --samples 0": "--samples: '0' is not a whole number in 1 .. 65536",
    "replay FILE --sampler uniform -o a.exr --spp x": "--spp: 'x' is not a number in 0.001 .. 65536",
    "reconstruct FILE --filter twin_guides{scales=6} -o a.exr": "option scales: '6' is neither auto nor 1 .. 5",
    "pack FILE -o a.spool --max-expansion 0": "--max-expansion: '0' is not a whole number in 1 .. 1000000",
    "synth scene_s -o a.spool --seed x": "--seed: a seed is a whole number from 0 to",
    "info FILE --threads": "--threads: needs a value, 0 .. 1024",
    "info FILE --quiet=x": "--quiet: takes no value",
    "report DIR -o a.html --metric relmes": "unknown metric 'relmes', did you mean 'relmse'?",
    "figure DIR -o a --metric relmes": "unknown metric 'relmes', did you mean 'relmse'?",
    "evaluate FILE --spp 2 --set metrics.trims=0": "--set metrics.trims=0: unknown option 'trims', did you mean 'trim'?: see spool list metrics",
    "metrics a b --set trim=1": "--set trim=1: option trim: 1 is outside 0 .. 0.5: see spool list metrics",
    "replay FILE --sampler uniform --spp 2 -o a.exr --set pool.negative=0": "'0' is not one of keep|clamp0: see spool list pool"}.items())
def test_a_value_that_cannot_be_is_answered_with_those_that_can(run, dump, words, said):
    run(*words.replace("FILE", str(dump)).split()).failed_with(2, said)


@pytest.mark.parametrize("words, said", {
    "--threads 2 info FILE": "--threads: write it behind the verb: see spool info --help",
    "-q info FILE": "-q: write it behind the verb: see spool info --help",
    "help evaluate": "unknown verb 'help': see spool evaluate --help",
    "-v": "unknown option '-v'", "info FILE -z": "unknown option '-z'"}.items())
def test_a_word_that_stands_elsewhere_is_said_where_it_belongs(run, dump, words, said):
    run(*words.replace("FILE", str(dump)).split()).failed_with(2, said)


@pytest.mark.parametrize("words", [
    "reconstruct FILE --filter box -o a.exr --selection", "reconstruct FILE --filter box -o a.exr --spp", "evaluate FILE --shard",
    "evaluate FILE --executor", "evaluate FILE -o", "metrics FILE FILE --variance", "metrics FILE FILE --error-map",
    "picture FILE -o a.png --like", "recover FILE", "report", "pack -o a.spool", "figure FILE -o", "reconstruct FILE -o a.exr --order"])
def test_what_is_empty_is_no_value_that_was_left_out(run, dump, words):
    run(*words.replace("FILE", str(dump)).split(), "").failed_with(2, ": is empty: give a value")


def test_missing_and_foreign_files(run, tmp_path):
    run("info", "no.spool").failed_with(3, "no.spool")
    (tmp_path / "text.spool").write_text("this is not a dump, but it is long enough to be read " * 9)
    for verb in ("info", "check"):
        run(verb, "text.spool").failed_with(1, "text.spool")
    run("info", tmp_path).failed_with(3)
    for name, remedy in (("scene.xml", "dumps/mitsuba/record.py"), ("scene.blend", "dumps/record.sh"), ("plan.toml", "spool evaluate"),
                         ("a.npz", "--from npz"), ("a.exr", "--from exr-folder"), ("a.dat", "spool pack --from")):
        (tmp_path / name).write_text("no recording, but long enough to be read as one " * 9)
        run("info", name).failed_with(1, name, remedy)
    run("evaluate", "none.toml", "-o", "out").failed_with(3, "none.toml", "No such file", "check the path")


def test_info_tells_what_is_in_the_file(good, dump):
    info = good("info", dump, "--json").json
    assert (info["width"], info["height"], info["samples_per_pixel"]) == (24, 20, 16)
    assert info["sha256"] == hashlib.sha256(dump.read_bytes()).hexdigest()
    assert info["reference"] and info["reference_variance"] and info["complete"]
    assert info["cost_per_sample"] == 2e-6
    assert info["meta"]["renderer"]["name"] == "numpy"
    assert [layer["name"] for layer in info["layers"]] == ["radiance", "reference", "reference_variance"]
    text = good("info", dump, "--all").out
    assert "24 x 20" in text and "numpy" in text and info["sha256"] in text
    short = good("info", dump).out
    assert len(short.splitlines()) <= 10 and "24 x 20" in short and "numpy" in short and "verify.py FILE --write" in short
    assert info["verified"] is None and "verify.py FILE --write" in text


def test_info_shows_what_the_verification_found(good, tmp_path):
    claims = [{"name": "film x uniform", "holds": True, "measured": "spread 0.2880", "expected": "0.2887",
               "p_value": 0.4321},
              {"name": "layer depth", "holds": False, "measured": "range 0", "expected": "not constant"},
              {"name": "reference", "holds": None, "measured": "not recorded", "expected": "one"}]
    write_dump(tmp_path / "kept.spool", samples()[0], meta={"verification": {"holds": False, "findings": claims}})
    info = good("info", "kept.spool", "--json").json
    assert info["verified"] is False and info["meta"]["verification"]["findings"] == claims
    short = good("info", "kept.spool").out
    assert "FAILS: 1 claim holds, 1 fails, 1 not known" in short and "layer depth FAILS" in short and "film x uniform" not in short
    text = good("info", "kept.spool", "--all").out
    assert "FAILS: 1 claim holds, 1 fails, 1 not known" in text
    assert "film x uniform holds: spread 0.2880, expected 0.2887, p = 0.43" in text
    assert "layer depth FAILS: range 0" in text
    odd = {"holds": "perhaps", "findings": [3, {"name": []}]}
    write_dump(tmp_path / "odd.spool", samples()[0], meta={"verification": odd})
    assert "1 not known" in good("info", "odd.spool").out
    write_dump(tmp_path / "none.spool", samples()[0], meta={"verification": {"holds": False, "findings": []}})
    assert "FAILS: 0 claims hold" in good("info", "none.spool").out


def test_check_finds_cut_and_flipped_bytes(good, run, dump, tmp_path):
    assert good("check", dump, "--json").json["complete"]
    data = dump.read_bytes()
    (tmp_path / "cut.spool").write_bytes(data[:-1000])
    run("check", "cut.spool").failed_with(4, "cut.spool")
    run("info", "cut.spool").failed_with(4, "recover")
    flipped = bytearray(data)
    flipped[len(data) // 2] ^= 4
    (tmp_path / "flipped.spool").write_bytes(flipped)
    finished = run("check", "flipped.spool")
    finished.failed_with(4, "flipped.spool: 1 damaged place, 1 block lost (first at byte ")
    assert "damaged" in finished.out
    report = run("check", "flipped.spool", "--json").json
    assert len(report["damaged"]) == 1 and not report["complete"]


def test_recover_saves_what_is_intact(good, run, dump, tmp_path):
    data = bytearray(dump.read_bytes())
    data[len(data) // 2] ^= 4
    (tmp_path / "bad.spool").write_bytes(data)
    finished = run("recover", "bad.spool", "saved.spool", "--json")
    finished.failed_with(4, "saved.spool", "15 of 16 blocks kept, 1 damaged")
    assert len(finished.json["lost"]) == 1
    run("check", "saved.spool").failed_with(4, "1 block was never recorded: the rest is intact")
    run("recover", "bad.spool", "saved.spool").failed_with(2, "saved.spool")
    whole = good("recover", dump, "copy.spool")
    assert "nothing was lost" in whole.out and good("check", "copy.spool")


def test_recover_counts_what_a_cut_took_away(run, dump, tmp_path):
    (tmp_path / "cut.spool").write_bytes(dump.read_bytes()[:dump.stat().st_size // 2])
    finished = run("recover", "cut.spool", "saved.spool")
    finished.failed_with(4, "not there: cut off")
    kept, of = map(int, re.search(r"(\d+) of (\d+) blocks kept", finished.err).groups())
    assert kept < of == 16
    assert len(run("check", "saved.spool", "--json").json["missing"]) == of - kept


def test_synth_writes_a_scene_with_its_exact_reference(good, run, tmp_path):
    names = [scene["name"] for scene in good("list", "scenes", "--json").json]
    good("synth", names[0], "--size", "20x12", "--samples", 8, "-o", "s.spool")
    info = good("info", "s.spool", "--json").json
    assert (info["width"], info["height"], info["samples_per_pixel"]) == (20, 12, 8)
    assert info["reference"] and good("check", "s.spool")
    run("synth", names[0], "--size", "20x12", "-o", "s.spool").failed_with(2, "s.spool")
    run("synth", names[0] + "x", "-o", "t.spool").failed_with(2, f"did you mean '{names[0]}'")
    run("synth", names[0], "--size", "20", "--set", "nothing=1", "-o", "t.spool").failed_with(2, "nothing")
    run("synth", names[0], "--size", "wide", "-o", "t.spool").failed_with(2, "WxH")


def test_numbers_are_read_in_decimal(good, run, dump, tmp_path):
    """In C, 010 is 8 and 0x10 is 16."""
    for name, number in (("ten", "10"), ("zero_ten", "010")):
        good("synth", "scene_s", "--size", 8, "--samples", number, "--seed", number, "-o", f"{name}.spool")
    ten, other = (spool.open(tmp_path / f"{name}.spool").read("radiance") for name in ("ten", "zero_ten"))
    assert ten.shape[2] == 10 and np.array_equal(ten, other)
    run("reconstruct", dump, "--filter", "box", "--spp", "0x2", "-o", "a.exr").failed_with(2, "--spp: '0x2' is not a number in 1 .. 65536")


def test_one_is_singular_and_two_are_plural(good, run):
    for n, word in ((1, "1 sample"), (2, "2 samples")):
        assert f"{word} each" in good("synth", "constant", "--size", f"{n}x1", "--samples", n, "-o", f"{n}.spool").out
        assert f"{word} to take" in good("pixel", f"{n}.spool", "--at", "0,0").out
    replay = "replay", "--sampler", "uniform", "--spp"
    assert "1 sample taken of 1 asked for, 1 piece ran out" in good(*replay, 1, "1.spool", "-o", "1.exr").out
    assert "4 samples taken of 4 asked for, 2 pieces ran out" in good(*replay, 2, "2.spool", "-o", "2.exr").out
    run(*replay, 2, "1.spool", "-o", "a.exr").failed_with(1, "--spp 2 asks for 2 samples, the recording has 1: use --spp 1")


def test_synth_dumps_hold_the_exact_variance_of_a_sample(good, tmp_path):
    good("synth", "heavy_tail", "--size", "8", "--samples", 4, "-o", "tail.spool")
    good("synth", "fireflies", "--size", "16", "--samples", 512, "--set", "odds=0.1", "--set", "firefly=5",
         "-o", "fireflies.spool")
    with spool.open(tmp_path / "tail.spool") as dump:
        assert np.isinf(dump.pixel("sample_variance")).all()
        assert np.allclose(dump.pixel("reference")[..., 0] / dump.pixel("reference")[0, 0, 0], 1)
    with spool.open(tmp_path / "fireflies.spool") as dump:
        exact = dump.pixel("sample_variance").astype(float)
        assert exact[0, 0, 1] == pytest.approx(0.1 * 0.9 * 25)
        found = dump.read("radiance").astype(float).var(axis=2, ddof=1)
        # 256 pixels, each with a relative standard error of 0.12
        assert found.mean() == pytest.approx(exact.mean(), rel=4 * 0.12 / 16)
        assert (dump.pixel("reference_variance") == 0).all()


def test_synth_does_not_hold_the_pool_in_memory(run, tmp_path):
    """Forty times as many samples, not much more memory."""
    peaks = []
    for size, samples_of_a_pixel in (("64", 64), ("400x420", 64)):
        path = tmp_path / "big.spool"
        process = subprocess.Popen([PROGRAM, "synth", "soft_shadow", "--size", size, "--samples",
                                    str(samples_of_a_pixel), "--force", "--quiet", "-o", str(path)],
                                   env={**os.environ, "ASAN_OPTIONS": "quarantine_size_mb=1"})  # else it keeps what is freed
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        assert process.returncode == 0
        peaks.append(usage.ru_maxrss * 1024)
    assert path.stat().st_size > 200e6
    assert peaks[1] < peaks[0] + 16e6, peaks
    path.unlink()


def test_pack_refuses_what_is_no_folder_of_passes(run, tmp_path):
    (tmp_path / "empty").mkdir()
    assert run("pack", "empty", "-o", "p.spool").code in (1, 3)
    run("pack", "none", "-o", "p.spool").failed_with(3, "none")


def test_pack_takes_numpy_archives(good, run, tmp_path):
    radiance, _ = samples(6, 5, 4)
    np.savez(tmp_path / "mine.npz", radiance=radiance)
    run("pack", "--from", "npz", "mine.npz", "-o", "mine.spool").failed_with(2, "import.layout=HWSC")
    good("pack", "--from", "npz", "mine.npz", "--set", "import.layout=HWSC", "-o", "mine.spool")
    with spool.open(tmp_path / "mine.spool") as packed:
        assert (packed.read("radiance") == radiance).all()
    run("pack", "--from", "npz", "a.npz", "b.npz", "-o", "c.spool").failed_with(2, "one source")


def test_options_of_foreign_formats_are_settings(run, good, tmp_path):
    np.savez(tmp_path / "mine.npz", radiance=samples(6, 5, 4)[0])
    pack = ("pack", "--from", "npz", "mine.npz", "-o", "mine.spool")
    run(*pack, "--layout", "HWSC").failed_with(2, "--set import.layout=")
    run(*pack, "--set", "import.laiout=HWSC").failed_with(2, "import npz", "did you mean 'layout'")
    run(*pack, "--set", "import.layout=WHSC").failed_with(2, "'WHSC' is not one of meta|HWSC|SHWC")
    run("pack", "--from", "exr-folder", ".", "-o", "a.spool", "--set", "import.map=albedo=a", "--set", "import.map=albedo=b").failed_with(2, "there twice")
    run(*pack, "--set", "layout=HWSC").failed_with(2, "import.OPTION=VALUE")
    run("pack", "passes", "-o", "p.spool", "--set", "import.layout=HWSC").failed_with(2, "no options")
    formats = good("list", "imports", "--json").json
    assert [f["name"] for f in formats] == ["npz", "exr-folder", "deep-exr", "bcd", "sbmc", "noisebase"]
    assert all(f["summary"] and all(o["help"] for o in f["options"]) for f in formats)


def test_options_of_targets_are_settings(run, good, dump, tmp_path):
    convert = ("convert", dump, "--to", "exr-folder", "-o", "folder")
    run(*convert, "--names", "rgb").failed_with(2, "--set export.names=plain|blender|rgb", "list exports")
    run(*convert, "--set", "export.nemes=rgb").failed_with(2, "export exr-folder", "did you mean 'names'")
    run(*convert, "--set", "import.names=rgb").failed_with(2, "export.OPTION=VALUE")
    good(*convert, "--set", "export.names=rgb")
    assert len(list((tmp_path / "folder").glob("sample_*.exr"))) == 16
    good("convert", dump, "--to", "oidn", "--set", "export.spp=1,4", "--set", "export.name=x", "-o", "set")
    assert {p.name for p in (tmp_path / "set").glob("*.hdr.exr")} == {"x_0001spp.hdr.exr", "x_0004spp.hdr.exr", "x_ref.hdr.exr"}
    run("convert", dump, "--to", "oidn", "--set", "export.spp=4,,1", "-o", "t").failed_with(2, "spp")
    stats = ("convert", dump, "--to", "bcd-stats", "-o", "p", "--set", "export.spp=4")
    run(*stats, "--set", "export.selection=n.exr").failed_with(2, "give one")
    run("convert", dump, "--to", "bdc", "-o", "p").failed_with(2, "bcd")
    formats = good("list", "exports", "--json").json
    assert [f["name"] for f in formats] == ["npz", "exr-folder", "deep-exr", "bcd", "bcd-stats", "oidn"]
    assert all(f["summary"] and all(o["help"] for o in f["options"]) for f in formats)


def test_existing_targets_are_kept_without_force(run, good, dump, tmp_path):
    target = tmp_path / "out.exr"
    target.write_bytes(b"precious")
    replay = ("replay", dump, "--sampler", "uniform", "--spp", 2, "-o", target)
    image = ("reconstruct", dump, "--filter", "box", "-o", target)
    for command in (replay, image):
        run(*command).failed_with(2, "--force")
        assert target.read_bytes() == b"precious"
    good(*replay, "--force")
    assert (read_exr(target, "n") == 2).all()
    good(*image, "--force")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.exr", "scene.spool"]


def test_reconstruction_of_the_first_samples_is_their_mean(good, dump):
    radiance, _ = samples()
    good("reconstruct", dump, "--filter", "box", "--spp", 3, "-o", "three.exr", "-q")
    for c, name in enumerate("RGB"):
        mean = radiance[:, :, :3, c].astype(float).mean(axis=2)
        assert np.allclose(read_exr(f"{dump.parent}/three.exr", name), mean, rtol=1e-5)


@pytest.mark.parametrize("name", ["box", "gaussian", "directional"])
@pytest.mark.parametrize("how", [(), ("--spp", 3), ("--order", "shuffled"), ("--holdout", 2)])
def test_an_image_is_the_same_whether_its_variance_is_asked_for_or_not(good, dump, name, how):
    for layers in ((), ("--layers",)):
        good("reconstruct", dump, "--filter", name, *how, "-o", f"a{len(layers)}.exr", "-q", *layers)
    for channel in "RGB":
        assert (read_exr(dump.parent / "a0.exr", channel) == read_exr(dump.parent / "a1.exr", channel)).all()


def test_replay_then_reconstruct_with_box_is_the_mean_of_what_was_taken(good, dump):
    radiance, _ = samples()
    good("replay", dump, "--sampler", "uniform", "--spp", 5.5, "-o", "n.exr")
    n = read_exr(dump.parent / "n.exr", "n").astype(int)
    assert n.sum() == round(5.5 * n.size) and set(np.unique(n)) == {5, 6}
    good("reconstruct", dump, "--selection", "n.exr", "--filter", "box", "-o", "i.exr")
    taken = np.arange(16) < n[:, :, None]
    mean = (radiance[..., 1] * taken).sum(axis=2) / n
    assert np.allclose(read_exr(dump.parent / "i.exr", "G"), mean, rtol=1e-5)


def test_shuffled_selection_is_reconstructed_in_its_own_order(good, dump):
    order = ("--order", "shuffled", "--seed", 7)
    good("replay", dump, "--sampler", "uniform", "--spp", 4, *order, "-o", "n.exr")
    good("reconstruct", dump, "--selection", "n.exr", "--filter", "box", "-o", "a.exr")
    good("reconstruct", dump, "--spp", 4, *order, "--filter", "box", "-o", "b.exr")
    good("reconstruct", dump, "--spp", 4, "--filter", "box", "-o", "c.exr")
    a, b, c = (read_exr(dump.parent / f"{name}.exr", "R") for name in "abc")
    assert (a == b).all() and not (a == c).all()


def make_exr(path, expression, data_type):
    subprocess.run(["oiiotool", "--create", "24x20", "1", *expression, "-d", data_type, "-o",
                    str(path)], check=True)


@pytest.mark.parametrize("data_type", ["half", "float"])
def test_count_image_made_elsewhere_is_a_selection(good, dump, tmp_path, data_type):
    make_exr(tmp_path / "mine.exr", ["--addc", "2", "--fill:color=9", "5x4+1+2"], data_type)
    good("reconstruct", dump, "--selection", "mine.exr", "--filter", "box", "-o", "i.exr")
    radiance, _ = samples()
    image = read_exr(tmp_path / "i.exr", "B")
    assert np.isclose(image[2, 1], radiance[2, 1, :9, 2].mean(), rtol=1e-5)
    assert np.isclose(image[0, 0], radiance[0, 0, :2, 2].mean(), rtol=1e-5)


@pytest.mark.parametrize("value, words", [
    ("1.5", ["no number of samples"]), ("-1", ["no number of samples"]), ("17", ["the recording has 16"]),
    ("nan", ["no number of samples"])])
def test_bad_count_is_refused_with_its_pixel(run, dump, tmp_path, value, words):
    make_exr(tmp_path / "bad.exr", ["--addc", "2", f"--fill:color={value}", "1x1+5+3"], "float")
    run("reconstruct", dump, "--selection", "bad.exr", "--filter", "box",
        "-o", "i.exr").failed_with(1, "bad.exr", "pixel 5, 3", *words)


@pytest.mark.parametrize("name, kind, value, taken", [
    ("spool.decision_map", "string", "log1p", False), ("spool.decision_map", "string", "linear", True),
    ("spool.decision_clamp", "float", "4.5", False), ("spool.decision_clamp", "float", "inf", True)])
def test_a_selection_of_a_removed_option_is_not_taken_for_another(run, dump, tmp_path, name, kind, value, taken):
    make_exr(tmp_path / "old.exr", ["--addc", "2", f"--attrib:type={kind}", name, value], "float")
    done = run("reconstruct", dump, "--selection", "old.exr", "--filter", "box", "-o", "i.exr")
    if taken:
        assert done.code == 0, done.err
    else:
        done.failed_with(1, "old.exr", name.partition(".")[2], "replay")


def test_selection_of_another_size_and_no_image_are_refused(run, dump, tmp_path):
    subprocess.run(["oiiotool", "--pattern", "constant:color=1", "4x4", "1", "-o", str(tmp_path / "small.exr")], check=True)
    command = ("reconstruct", dump, "--filter", "box", "-o", "i.exr", "--selection")
    run(*command, "small.exr").failed_with(1, "4 x 4", "24 x 20")
    run(*command, dump).failed_with(1, "is a .spool file, an OpenEXR image is needed", "spool reconstruct")
    run(*command, "none.exr").failed_with(3, "none.exr")


def test_budget_larger_than_the_pool_is_refused(run, dump):
    run("replay", dump, "--sampler", "uniform", "--spp", 17, "-o", "n.exr").failed_with(1, "--spp 16")
    run("reconstruct", dump, "--filter", "box", "--spp", 17, "-o", "i.exr").failed_with(1, "pixel 0, 0")


def test_pictures_and_layers_are_written(good, dump, tmp_path):
    good("reconstruct", dump, "--filter", "gaussian", "--spp", 2, "-o", "i.exr", "--layers",
         "--pictures", "pictures")
    names = {p.name for p in (tmp_path / "pictures").iterdir()}
    assert {"estimate.png", "density.png", "squared_error.png", "contact_sheet.png"} <= names
    info = subprocess.run(["oiiotool", "--info", str(tmp_path / "pictures" / "contact_sheet.png")],
                          check=True, capture_output=True, text=True).stdout
    width, height = map(int, re.search(r"(\d+) x +(\d+)", info).groups())
    assert width > 3 * 256 and height > 256


def test_lists_name_every_option_with_defaults(good):
    for what in ("samplers", "filters"):
        methods = good("list", what, "--json").json
        assert methods
        for method in methods:
            assert method["name"] in good("list", what).out and method["summary"]
            for option in method["options"]:
                assert option["defaults"] and option["help"] and option["allowed"]
    assert "mse" in {m["name"] for m in good("list", "metrics", "--json").json}
    good("list", "presets")
    assert good("list").out.count("A.k,") == 1
    meanings = {m["name"]: m["meaning"] for m in good("list", "metrics", "--json").json}
    assert "worst FLIP" in meanings["flip_hdr"] and "rel_scale" in meanings["relmse"]
    assert "samples_spent" in good("list", "columns").out


def test_options_that_are_no_method_s_are_in_lists_that_the_help_names(good, dump):
    rules = {option["name"]: option["defaults"]["default"] for option in good("list", "pool", "--json").json}
    assert rules == {"nonfinite": "reject", "negative": "keep", "firefly_limit": "inf", "allow_many_rejected": "off"}
    lists = {"pool": good("list", "pool").out, "metrics": good("list", "metrics").out.split("\n\n")[1]}
    for part, text in lists.items():
        assert f"spool list {part}" in " ".join(good("evaluate", "--help").out.split())
        for name, default in re.findall(r"^  ([a-z]\w+) +\S.*?  +(\S+)  ", text, re.M):
            good("evaluate", dump, "--spp", 2, "--dry-run", "--set", f"{part}.{name}={default}")
    assert all(name in lists["pool"] for name in rules) and "rel_scale        mean|none" in lists["metrics"]
    assert "energy" in good("list", "box").out


def test_lists_leave_expert_options_to_all_and_the_page_of_the_method_names_every_option(good):
    page = (Path(__file__).parents[2] / "docs" / "method.md").read_text()
    tables = page[page.index("## 9. Options"):page.index("## Where things are")]
    named = set(re.findall(r"`([A-Za-z_0-9]+)`", tables))
    for what in ("samplers", "filters"):
        few, all_of_them = good("list", what).out, good("list", what, "--all").out
        assert "more with --all" in few and "more with --all" not in all_of_them
        every = re.match(r"every filter\n(.*?)\n\n", few, re.S)
        assert (every is not None) == (what == "filters")
        for method in good("list", what, "--json").json:
            shown = re.search(rf"^{method['name']}\b.*?(\n\n|\Z)", few, re.M | re.S).group()
            for option in method["options"]:
                assert option["name"] in named, (method["name"], option["name"])
                line = rf"^ +{re.escape(option['name'])} "
                if every and re.search(line, every[1], re.M):  # of every filter: stands once
                    assert len(re.findall(line, few, re.M)) == 1
                    continue
                assert bool(re.search(line, shown, re.M)) != option["expert"], (method["name"], option["name"])
                assert re.search(line, all_of_them, re.M)


def test_output_does_not_depend_on_threads(good, dump, tmp_path):
    for threads in (1, 3):
        good("reconstruct", dump, "--filter", "gaussian", "--spp", 4, "-o", f"{threads}.exr",
             "--threads", threads)
    assert (tmp_path / "1.exr").read_bytes() == (tmp_path / "3.exr").read_bytes()


def test_no_progress_when_piped(good, dump):
    assert good("replay", dump, "--sampler", "uniform", "--spp", 4, "-o", "n.exr").err == ""


def test_interrupt_says_so_in_one_line(tmp_path):
    radiance, _ = samples(96, 96, 64)
    path = write_dump(tmp_path / "large.spool", radiance)
    process = subprocess.Popen(
        [PROGRAM, "evaluate", str(path), "--spp", "4,8,16", "--filters", "gaussian", "--replicates",
         "1000", "--no-pictures", "-o", str(tmp_path / "out")], stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while len(cell_lines(tmp_path / "out")) < 3:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=20)
    assert process.returncode == 130 and error.strip().count("\n") == 0
    assert f"{len(cell_lines(tmp_path / 'out'))} of 3000 results are kept" in error
    assert not os.path.exists(tmp_path / "out" / "results.csv")


def test_channels_that_nobody_knows_are_shown_and_change_nothing(good, run, dump, tmp_path):
    radiance, _ = samples()
    write_dump(tmp_path / "more.spool", radiance, scent=radiance[..., :1], components={"scent": "S"})
    assert "scent" in good("info", "more.spool").out
    assert good("check", "more.spool").code == 0
    for source, name in ((dump, "known"), ("more.spool", "more")):
        good("reconstruct", source, "--filter", "gaussian", "--spp", 4, "-o", f"{name}.exr")
    for channel in "RGB":
        known, more = (read_exr(tmp_path / f"{name}.exr", channel) for name in ("known", "more"))
        assert np.array_equal(known, more)


def test_alone_it_greets_with_what_to_type_and_every_verb_by_its_use(good, run, tmp_path):
    text = good().out
    listed = re.findall(r"^  ([a-z]+) +\w", text.split("\nLook:\n")[1], re.M)
    shown = good("--help").out
    assert shown.startswith(text) and len(listed) == len(set(listed)) >= 20
    commands = re.sub(r"\\\n +", " ", text.split("Start:\n")[1].split("\n\n")[0])
    for line in commands.splitlines():
        words = re.sub(r" {5,}.*", "", line).split()
        if words[1] != "report":  # needs what it draws with
            good(*words[1:])
    run("--quiet").failed_with(2)
