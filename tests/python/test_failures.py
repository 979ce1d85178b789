"""Every failure is a SpoolError with the line and the exit code of the program, its options as parameters."""
import concurrent.futures
import os
import pickle
import threading
import warnings

import numpy as np
import pytest

import spool


@pytest.mark.parametrize("call, words", [
    (lambda path: spool.replay(path, "multiscal", 4), ("replay", "PATH", "--sampler", "multiscal", "--spp", "4", "-o", "n.exr")),
    (lambda path: spool.replay(path, "multiscale", 4, alfa=1),
     ("replay", "PATH", "--sampler", "multiscale", "--spp", "4", "--set", "sampler.alfa=1", "-o", "n.exr")),
    (lambda path: spool.replay(path, "uniform", 400), ("replay", "PATH", "--sampler", "uniform", "--spp", "400", "-o", "n.exr")),
    (lambda path: spool.replay(path, "multiscale", 4, views=["Q.1"]),
     ("replay", "PATH", "--sampler", "multiscale", "--spp", "4", "--views", "Q.1", "-o", "n.exr")),
    (lambda path: spool.reconstruct(path, None, "boks"), ("reconstruct", "PATH", "--filter", "boks", "-o", "i.exr")),
    (lambda path: spool.reconstruct(path, None, "box", spp=99),
     ("reconstruct", "PATH", "--filter", "box", "--spp", "99", "-o", "i.exr")),
    (lambda path: spool.synth("edg", path="x.spool"), ("synth", "edg", "-o", "x.spool")),
])
def test_the_same_line(call, words, path, program):
    code, line = program(*(path if word == "PATH" else word for word in words))
    with pytest.raises(spool.SpoolError) as caught:
        call(path)
    assert (caught.value.code, caught.value.message) == (code, line.replace("--set ", "").replace("--", ""))
    assert code != 0 and "\n" not in line


def test_a_line_names_no_option_of_the_program(path, tmp_path):
    page, plan = spool.show(np.ones((4, 5, 3))), {"samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1}
    made, other = ({"recordings": [np.full((4, 5, 8, 3), value)], **plan} for value in (1.0, 2.0))
    spool.evaluate(made, output=tmp_path / "kept")
    for call, words in ((lambda: spool.synth("slanted_edge", path=path), "scene.spool: exists.*force=True"),
                        (lambda: page.save(path), "scene.spool: exists.*force=True"),
                        (lambda: spool.evaluate(other, output=tmp_path / "kept"), "force=True"),
                        (lambda: spool.synth("slanted_edge", width=0), "0 x 128 pixels: give 1 to 65536 on a side"),
                        (lambda: spool.reconstruct(path, None, "box", preset="nope"), "^preset nope: "),
                        (lambda: spool.replay(path, "uniform", 4, views=["nope"]), "^views nope: ")):
        with pytest.raises(spool.SpoolError, match=words) as caught:
            call()
        assert "--" not in str(caught.value)


@pytest.mark.parametrize("call, words", [
    (lambda path: spool.reconstruct(path, None, "directional", filter="db3"), 'filter: .*"directional{filter=db3}"'),
    (lambda path: spool.reconstruct(path, None, "directional:paper", filter="db3"), 'filter: .*"METHOD{filter=db3}"'),
    (lambda path: spool.replay(path, "uniform", 4, sampler="a\nb"), 'sampler: .*"uniform{sampler=a b}"')])
def test_an_option_with_the_name_of_a_parameter(call, words, path):
    with pytest.raises(spool.SpoolError, match=words) as caught:
        call(path)
    assert caught.value.kind == "usage" and "\n" not in str(caught.value)


def test_an_option_with_the_name_of_a_parameter_in_the_methods_text(path):
    made = [spool.reconstruct(path, None, filter=method) for method in ("directional{filter=db3}", "directional")]
    assert not np.array_equal(*made)


def test_a_damaged_file(path, program):
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 0x10
    path.write_bytes(damaged)
    code, line = program("replay", path, "--sampler", "uniform", "--spp", "4", "-o", "n.exr")
    with pytest.raises(spool.SpoolError) as caught:
        spool.replay(path, "uniform", 4)
    assert (caught.value.code, caught.value.message) == (code, line) == (spool.DAMAGE, line)


def test_a_plan(tmp_path, path, program):
    plan = tmp_path / "plan.toml"
    plan.write_text('recordings = ["scene.spool"]\nspp = [4]\nsamplers = ["unifrom"]\nfilters = ["box"]\n')
    code, line = program("evaluate", plan, "-o", "r")
    with pytest.raises(spool.SpoolError) as caught:
        spool.evaluate(str(plan))
    assert (caught.value.code, caught.value.message) == (code, line) == (spool.USAGE, line)
    with pytest.raises(spool.SpoolError, match="spp"):
        spool.evaluate({"recordings": path, "spp": "many"})
    with pytest.raises(spool.SpoolError, match="nowhere.toml"):
        spool.evaluate("nowhere.toml")


def test_arrays():
    with pytest.raises(spool.SpoolError, match="radiance has shape"):
        spool.replay(np.zeros((4, 4, 3)), "uniform", 1)
    with pytest.raises(spool.SpoolError, match="film has shape"):
        spool.recording(np.zeros((4, 4, 2, 3)), film=np.zeros((4, 4, 2, 3)))
    with pytest.raises(spool.SpoolError, match="radiance: 1e\\+39 is too large for float32"):
        spool.recording(np.full((4, 4, 2, 3), 1e39))
    with pytest.raises(spool.SpoolError, match="film position") as caught:
        spool.replay(spool.recording(np.ones((4, 4, 2, 3)), film=np.full((4, 4, 2, 2), 1.5)), "uniform", 1, pieces=2)
    assert caught.value.code == spool.DATA
    with pytest.raises(spool.SpoolError, match="-1 is no number of samples"):
        spool.reconstruct(np.ones((4, 4, 2, 3)), np.full((4, 4), -1), "box")
    with pytest.raises(spool.SpoolError, match="4 x 4, the recording 5 x 4|5 x 4"):
        spool.reconstruct(np.ones((4, 5, 2, 3)), np.ones((4, 4)), "box")
    with pytest.raises(spool.SpoolError, match="not finite"):
        spool.metrics(np.full((4, 4, 3), np.nan), np.ones((4, 4, 3)))
    with pytest.raises(spool.SpoolError, match="reference: 16 pixels are not finite"):
        spool.metrics(np.ones((4, 4, 3)), np.full((4, 4, 3), np.nan))
    with pytest.raises(spool.SpoolError, match="is 4 x 4 pixels, the reference 5 x 4"):
        spool.metrics(np.ones((4, 4, 3)), np.ones((4, 5, 3)))


@pytest.mark.parametrize("answer, words", [
    (lambda s: np.full(s.n.shape, -1), "-1 is no number of samples"),
    (lambda s: np.full(s.n.shape, 2**64 - 1, np.uint64), "18446744073709551615 is no number of samples \\(pixel 0, 0\\)"),
    (lambda s: np.ones((3, 3)), r"not \(3, 3\)"),
    (lambda s: "all", "answers with numbers"),
    (lambda s: 1 / 0, "ZeroDivisionError: division by zero"),
])
def test_a_sampler_that_fails(answer, words, dump):
    failing = spool.sampler(lambda statistics: answer(statistics), label="failing")
    with pytest.raises(spool.SpoolError, match=words) as caught:
        spool.replay(dump, failing, 4)
    assert caught.value.code == spool.DATA
    results = pytest.raises(spool.SpoolError, spool.evaluate,
                            {"recordings": [dump], "spp": [4], "replicates": 1, "samplers": [failing], "filters": ["box"]})
    assert "\n" not in results.value.message


def test_what_a_method_raised_stands_behind_the_error(dump):
    @spool.filter
    def broken(statistics):
        raise KeyError("somewhere")

    with pytest.raises(spool.SpoolError) as caught:
        spool.reconstruct(dump, None, broken)
    assert isinstance(caught.value.__cause__, KeyError)
    with pytest.raises(spool.SpoolError, match="holds nan in channel G"):
        spool.reconstruct(dump, None, spool.filter(lambda s: np.where([True, False, True], s.mean, np.nan)))
    with pytest.raises(spool.SpoolError, match="image"):
        spool.reconstruct(dump, None, spool.filter(lambda s: s.n))


def test_each_call_has_the_cause_of_its_own_in_several_threads(dump):
    together = threading.Barrier(4)

    @spool.filter
    def broken(statistics, number=0):
        together.wait(10)
        raise KeyError(number)

    def cause(number):
        with pytest.raises(spool.SpoolError) as caught:
            spool.reconstruct(dump, None, broken, number=number)
        return caught.value.__cause__

    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        for number, raised in enumerate(threads.map(cause, range(4))):
            assert isinstance(raised, KeyError) and raised.args == (number,) and raised.__traceback__.tb_next


def test_options_of_functions(dump):
    @spool.sampler
    def choosy(statistics, strength=1.0, mode="a"):
        return np.full(statistics.n.shape, strength)

    with pytest.raises(spool.SpoolError, match="option strenght: unknown"):
        spool.replay(dump, choosy, 4, strenght=2)
    with pytest.raises(spool.SpoolError, match="is no float"):
        spool.replay(dump, choosy, 4, strength="much")
    with pytest.raises(spool.SpoolError, match="needs a default"):
        spool.sampler(lambda statistics, strength: statistics.n)


def test_an_error_survives_pickle():
    error = spool.SpoolError("damaged", "x.spool: record 3")
    again = pickle.loads(pickle.dumps(error))
    assert (again.kind, again.message, again.code, str(again)) == (error.kind, error.message, spool.DAMAGE, str(error))


def test_a_function_without_its_decorator_and_keys_that_are_none(dump):
    def bare(statistics):
        return statistics.n

    for call in (lambda: spool.replay(dump, bare, 4), lambda: spool.replay(dump, "cross_halves", 4, filter=bare),
                 lambda: spool.reconstruct(dump, None, bare),
                 lambda: spool.evaluate({"recordings": [dump], "spp": [4], "samplers": [bare], "filters": ["box"]})):
        with pytest.raises(spool.SpoolError, match="bare is a function without its decorator: write @spool"):
            call()
    with pytest.raises(spool.SpoolError, match="is a filter"):
        spool.replay(dump, spool.filter(bare), 4)
    plan = {"recordings": [dump], "spp": [4], "samplers": ["uniform"], "filters": ["box"]}
    for key in ("replicate", "seeds", "a key", "", "\x7f"):
        with pytest.raises(spool.SpoolError, match="unknown key") as caught:
            spool.evaluate({**plan, key: 1})
        assert key.strip("\x7f") in caught.value.message
    with pytest.raises(spool.SpoolError, match="plan: key: 5"):
        spool.evaluate({**plan, 5: 1})
    with pytest.raises(spool.SpoolError, match="plan: seed: None"):
        spool.evaluate({**plan, "seed": None})


def test_an_image_with_nan(dump, tmp_path, program):
    from spool import exr
    image = np.ones((dump.height, dump.width, 3), "f4")
    image[3, 2, 1] = np.nan
    exr.write(tmp_path / "i.exr", {channel: image[..., c] for c, channel in enumerate("RGB")})
    name = f"image:{tmp_path / 'i.exr'}"
    words = "holds nan in channel G \\(pixel 2, 3\\)"
    with pytest.raises(spool.SpoolError, match=words) as caught:
        spool.reconstruct(dump, None, name)
    assert program("reconstruct", dump.path, "--filter", name, "-o", "o.exr") == (1, caught.value.message)
    with pytest.raises(spool.SpoolError, match=words):
        spool.evaluate({"recordings": [dump], "spp": [4], "replicates": 1, "samplers": ["uniform"], "filters": [name]})


@pytest.mark.parametrize("call, words", [
    (lambda dump: spool.evaluate({"recording": [dump], "spp": [2]}), ["recordings stand under 'recordings'"]),
    (lambda dump: spool.evaluate({"recording": "a.spool", "spp": [2]}), ["unknown key 'recording'", "did you mean 'recordings'"]),
    (lambda dump: spool.evaluate({"recordings": [dump], "sampler": "uniform", "spp": [2]}), ["did you mean 'samplers'"]),
    (lambda dump: spool.evaluate({"recordings": [dump], "spp": [2], "mask": {"name": dump}}), ["mask", "name", "no number, text"]),
    (lambda dump: spool.evaluate([dump]), ["neither a dict of a plan's keys nor the path"]),
    (lambda dump: spool.evaluate("recordings = ["), ["give a dict, or the path of a TOML file"]),
    (lambda dump: spool.reconstruct(dump, 4, "box"), ["reconstruct(samples, None, filter, spp=4)"]),
    (lambda dump: spool.reconstruct(dump, "box", None), ["the order is (samples, selection, filter)"]),
    (lambda dump: spool.replay(dump, 8, "uniform"), ["neither the name of a sampler nor a function made by @spool.sampler"]),
    (lambda dump: spool.recording("a.spool"), ["spool.open reads a file"]),
])
def test_what_stands_in_the_wrong_place_is_answered_with_the_right_one(call, words):
    with pytest.raises(spool.SpoolError) as failure:
        call(spool.example())
    assert [word for word in words if word not in str(failure.value)] == []


def test_what_is_no_file_is_neither_waited_for_nor_replaced(tmp_path):
    from spool import exr
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    for call in (lambda: spool.open(fifo), lambda: spool.replay(fifo, "uniform", 1), lambda: spool.evaluate(fifo), lambda: exr.read(fifo),
                 lambda: spool.append_meta(fifo, {}), lambda: spool.write(fifo, radiance=np.ones((2, 2, 2, 3)), force=True)):
        with pytest.raises(spool.SpoolError, match="fifo: (is no|not a) regular file"):
            call()
    assert fifo.is_fifo() and len(list(tmp_path.iterdir())) == 1


def test_a_call_without_a_place_to_work_in_is_a_spool_error(dump, tmp_path, monkeypatch):
    plan, image = {"recordings": [dump], "filters": ["box"], "spp": [2]}, np.ones((4, 4, 3))
    monkeypatch.setenv("SPOOL_PYTHON", str(tmp_path / "nowhere"))
    with pytest.raises(spool.SpoolError, match="nowhere: No such file or directory: set SPOOL_PYTHON"):
        spool.show(image)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "full"))
    for call in (lambda: spool.synth("slanted_edge"), lambda: spool.evaluate(plan)):
        with pytest.raises(spool.SpoolError, match="full: No such file or directory: .* TMPDIR"):
            call()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    for call in (lambda: spool.write("a.spool", np.ones((2, 2, 2, 3))), lambda: spool.evaluate(plan), lambda: spool.evaluate(plan, output="results"),
                 lambda: spool.results("results"), lambda: spool.show("a.exr")):
        with pytest.raises(spool.SpoolError, match=": the working directory is gone: "):
            call()


def test_a_name_that_is_no_utf_8(path):
    other = os.path.join(path.parent, os.fsdecode(b"n\xff.spool"))
    os.rename(path, other)
    dump = spool.open(other)
    chosen = spool.replay(dump, "uniform", 4)
    assert spool.reconstruct(other, chosen, "box").shape == (dump.height, dump.width, 3)
    assert all("n" in shown for shown in (repr(chosen), dump._repr_html_(), spool.view(dump, spp=[2]).html))
    os.rename(other, path)
    for call in (lambda: spool.replay(other, "uniform", 4), lambda: spool.evaluate({"recordings": [other], "spp": [4]}), lambda: spool.synth("slanted_edge", path=other)):
        with pytest.raises(spool.SpoolError, match="xff|udcff"):
            call()


def test_a_name_with_line_ends_that_only_text_has(path, tmp_path):
    """JSON writes them as they are, and str.splitlines() would break its lines there."""
    other = path.with_name("a\u2028b\x85c.spool")
    os.rename(path, other)
    plan = {"recordings": [other], "samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 2}
    rows = spool.evaluate(plan, output=tmp_path / "results").rows
    assert [row["dump"] for row in rows] == [other.stem] * 2 and rows == spool.results(tmp_path / "results").rows


@pytest.mark.parametrize("rows, statistics, words", [("[1]\n", "{}", "results.jsonl: holds no objects"), ("", "[]", "statistics.json: holds no objects"),
                                                     ("", '{"claims": 1}', "statistics.json: has no (results|claims)"), ("", "{", "statistics.json: is no JSON")])
def test_results_that_somebody_changed(tmp_path, rows, statistics, words):
    (tmp_path / "results.jsonl").write_text(rows)
    (tmp_path / "statistics.json").write_text(statistics)
    found = spool.results(tmp_path)
    with pytest.raises(spool.SpoolError, match=words):
        assert found.rows is None or found.means is None
    if rows == "":
        with pytest.raises(spool.SpoolError, match=words):
            assert found.claims
        for written in (statistics, '{"conditions": 1}', '{"conditions": [{}]}', '{"claims": [1]}'):
            (tmp_path / "statistics.json").write_text(written)
            with pytest.raises(spool.SpoolError, match="statistics.json: (is|holds|lacks) .*: evaluate it again"):
                spool.results(tmp_path)._repr_html_()


def test_no_plan_is_replaced_by_its_own_results(path, tmp_path):
    plan = tmp_path / "plan.toml"
    plan.write_text(f'# mine\nrecordings = ["{path}"]\nspp = [2]\nreplicates = 1\nsamplers = ["uniform"]\nfilters = ["box"]\npictures = false\n')
    with pytest.raises(spool.SpoolError, match="plan.toml: output is the input"):
        spool.evaluate(plan, output=tmp_path, force=True)
    assert plan.read_text().startswith("# mine")
    spool.evaluate(plan, output=tmp_path / "out")
    assert spool.evaluate(tmp_path / "out" / "plan.toml", output=tmp_path / "out").rows


def test_a_closed_recording(path):
    dump = spool.open(path)
    dump.close()
    for call in (lambda: dump.read("radiance"), lambda: dump.pixel("reference"), lambda: dump.block(0, 0, 0)):
        with pytest.raises(spool.SpoolError, match="scene.spool: is closed: open it again"):
            call()


def test_a_view_of_any_size_is_refused_before_it_is_copied(dump):
    def of(*shape):
        return np.broadcast_to(np.float32(1), shape)

    for call in (lambda: spool.metrics(of(65536, 65536, 3), of(4, 4, 3)), lambda: spool.show(of(65536, 65536)), lambda: spool.show(of(70000, 4, 3)),
                 lambda: spool.reconstruct(dump, of(65536, 65536), "box"), lambda: spool.replay(of(65536, 65536, 2, 3), "uniform", 1)):
        with pytest.raises(spool.SpoolError, match="pixels: give 1 to 65536 on a side"):
            call()
    with pytest.raises(spool.SpoolError, match="more than memory holds") as caught:
        spool.recording(of(16384, 16384, 65536, 3))
    assert caught.value.code == spool.IO


@pytest.mark.parametrize("kind", ["u1", "u2", "i8"])
def test_the_bytes_of_a_picture_are_no_light(kind, dump, tmp_path):
    samples, image = np.ones((4, 5, 2, 3), "f4"), np.ones((4, 5, 3))
    picture, of_samples = image.astype(kind), samples.astype(kind)
    for call in (lambda: spool.metrics(picture, image), lambda: spool.metrics(image, picture), lambda: spool.metrics(image, image, variance=picture),
                 lambda: spool.recording(of_samples), lambda: spool.replay(of_samples, "uniform", 1), lambda: spool.show(picture),
                 *(lambda of=of: spool.recording(samples, **of) for of in ({"reference": picture}, {"albedo": of_samples}, {"depth": of_samples[..., 0]})),
                 *(lambda of=of: spool.write(tmp_path / "a.spool", samples, **of) for of in ({"reference": picture}, {"albedo": of_samples}))):
        with pytest.raises(spool.SpoolError, match=f"holds {np.dtype(kind)}, not floats: decode it"):
            call()
    with pytest.raises(spool.SpoolError, match=f"an image .* of floats, not {np.dtype(kind)}"):
        spool.reconstruct(dump, None, spool.filter(lambda s: s.mean.astype(kind)))
    assert not (tmp_path / "a.spool").exists()
    spool.write(tmp_path / "a.spool", samples, hit=of_samples[..., 0].astype("u1"), path=of_samples[..., 0].astype("u4"))


class Tensor:
    """As those of torch, whose numpy() raises what it likes."""

    def __array__(self, *of, **how):
        raise RuntimeError("Can't call numpy() on Tensor that requires grad. Use tensor.detach().numpy() instead.")


@pytest.mark.parametrize("call", [lambda of, to: spool.metrics(of, np.ones((4, 5, 3))), lambda of, to: spool.recording(of), lambda of, to: spool.show(of),
                                  lambda of, to: spool.replay(of, "uniform", 1), lambda of, to: spool.write(to / "a.spool", of)])
def test_what_does_not_become_an_array_says_so_itself(call, tmp_path):
    with pytest.raises(spool.SpoolError, match="is no array: .*requires grad. Use tensor.detach"):
        call(Tensor(), tmp_path)


def test_a_reference_of_the_same_samples_does_not_judge(tmp_path):
    random = np.random.default_rng(1)
    samples, others = (random.exponential(1.0, (8, 9, 6, 3)).astype("f4") for _ in range(2))
    plan = {"samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1}
    with pytest.warns(UserWarning, match="a.spool: the reference is the mean of these samples"):
        spool.write(tmp_path / "a.spool", samples, reference=samples.mean(axis=2))
    with pytest.warns(UserWarning, match="recording: the reference is the mean of these samples"):
        held = spool.recording(samples, reference=samples.mean(axis=2, dtype="f8"))
    for recording in (tmp_path / "a.spool", held):
        with pytest.raises(spool.SpoolError, match="the reference is the mean of the recording's own samples.*: judge by"):
            spool.evaluate({"recordings": [recording], **plan})
        assert spool.evaluate({"recordings": [recording], "reference": "leave_selected_out", **plan}).rows[0]["reference"] == "leave_selected_out"
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        spool.evaluate({"recordings": [spool.recording(samples, reference=others.mean(axis=2))], **plan})


def test_recordings_go_to_other_processes(dump, path, tmp_path, monkeypatch):
    wanted = spool.replay(dump, "multiscale", 4).image
    held = spool.recording(dump.read("radiance"), film=dump.read("film"), depth=dump.read("depth"), reference=dump.pixel("reference"), name="held",
                           sample_order=dump.sample_order)
    monkeypatch.chdir(tmp_path)
    for given in (dump, held):
        sent = pickle.loads(pickle.dumps(given))
        assert repr(sent) == repr(given) and np.array_equal(spool.replay(sent, "multiscale", 4).image, wanted)
    assert all(np.array_equal(sent.arrays[name], values) for name, values in held.arrays.items()) and sent.sample_order == held.sample_order
    with pytest.raises(spool.SpoolError, match="stays in its process: hand over its counts"):
        pickle.dumps(spool.replay(dump, "uniform", 2))
    sent = pickle.dumps(dump)
    spool.write(path, np.ones((4, 5, 2, 3), "f4"), force=True)
    with pytest.raises(spool.SpoolError, match="scene.spool: is another recording than"):
        pickle.loads(sent)


def test_an_array_that_looks_like_sample_y_x_is_pointed_out():
    images = np.random.default_rng(1).random((8, 12, 16, 3), np.float32)  # 8 images of 16 x 12 pixels
    with pytest.warns(UserWarning, match="12 x 8 pixels of 16 samples.*moveaxis"):
        spool.recording(images)
    with pytest.warns(UserWarning, match="16 x 8 pixels of 12 samples.*moveaxis"):  # in portrait
        spool.recording(np.swapaxes(images, 1, 2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        spool.recording(np.moveaxis(images, 0, 2))
        spool.recording(images, reference=np.zeros((8, 12, 3)))  # whose shape says which axes are the image's
