"""What is told before and while a recording runs: pure functions, no renderer."""
import pytest

from dumps.recording import progress
from dumps.mitsuba.output import layer_types
from dumps.mitsuba.plan import reference_hint
from dumps.recording.progress import Progress


class Stream:
    def __init__(self, terminal):
        self.terminal, self.text = terminal, ""

    def isatty(self):
        return self.terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_is_a_line_a_minute_in_a_log_file_and_a_bar_on_a_terminal(monkeypatch, terminal):
    now, stream = [1000.0], Stream(terminal)
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(progress.sys, "stderr", stream)
    shown = Progress("pool", 20)
    for _ in range(20):
        now[0] += 10.0
        shown.step()
    shown.close()
    if terminal:
        assert stream.text.count("\r") == 21 and "\n" not in stream.text
    else:
        assert stream.text == "pool 6 of 20, 2 min 20 s left\npool 12 of 20, 1 min 20 s left\npool 18 of 20, 20 s left\n"


def test_a_short_recording_says_nothing_in_a_log_file(monkeypatch):
    stream = Stream(False)
    monkeypatch.setattr(progress.sys, "stderr", stream)
    shown = Progress("pool", 2)
    shown.step()
    shown.step()
    assert stream.text == ""


def test_a_smaller_reference_is_offered_with_its_price():
    lines = reference_hint(64, 4096, 10.0, 600.0)
    assert lines == ["the reference takes 10 min 00 s; its own noise adds 1.56 % to the squared error of a mean of all 64 samples",
                     "--reference 1024 would save 7 min 30 s and add 6.25 %"]
    assert len(reference_hint(64, 128, 10.0, 20.0)) == 1           # a quarter would be smaller than the pool
    assert "can only be judged against the pool itself" in reference_hint(64, 0, 10.0, 0.0)[0]


def test_half_narrows_radiance_and_lens_unless_a_sample_does_not_fit():
    layers = ["radiance", "lens", "time", "depth", "albedo"]
    assert layer_types(layers, True) == {"radiance": "f2", "lens": "f2", "time": "f4", "depth": "f4", "albedo": "f2"}
    assert layer_types(layers, True, "", True)["depth"] == layer_types(layers, True, "too large", True)["depth"] == "f2"
    assert layer_types(layers, True, "too large")["radiance"] == layer_types(layers, False)["radiance"] == "f4"
