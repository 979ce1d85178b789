"""What a function of one's own does is known by its name in every process, and so is what else it reaches."""
import os
import subprocess
import sys

import pytest

# A module with a filter for each: what stands in it beside the filter, and what the filter answers.
REACHED = {
    "object": ("class Scale:\n    def f(self, m): return m * FACTOR", "Scale().f(s.mean)"),
    "kept object": ("class Scale:\n    def f(self, m): return m * FACTOR\nscale = Scale()", "scale.f(s.mean)"),
    "bound method": ("class Scale:\n    def f(self, m): return m * FACTOR\nscale = Scale().f", "scale(s.mean)"),
    "static method": ("class Scale:\n    @staticmethod\n    def f(m): return m * FACTOR", "Scale.f(s.mean)"),
    "class method": ("class Scale:\n    @classmethod\n    def f(cls, m): return m * FACTOR", "Scale.f(s.mean)"),
    "property": ("class Scale:\n    @property\n    def f(self): return FACTOR", "s.mean * Scale().f"),
    "cached property": ("class Scale:\n    @functools.cached_property\n    def f(self): return FACTOR", "s.mean * Scale().f"),
    "value of a class": ("class Scale:\n    f = FACTOR", "s.mean * Scale.f"),
    "inherited": ("class Base:\n    def f(self, m): return m * FACTOR\nclass Scale(Base): pass", "Scale().f(s.mean)"),
    "metaclass": ("class Meta(type):\n    def f(cls, m): return m * FACTOR\nclass Scale(metaclass=Meta): pass", "Scale.f(s.mean)"),
    "dataclass": ("@dataclasses.dataclass\nclass Scale:\n    a: float = 1.0\n    b: list = dataclasses.field(default_factory=list)\n"
                  "    def f(self, m): return m * FACTOR", "Scale().f(s.mean)"),
    "abstract": ("class Scale(abc.ABC):\n    __slots__ = ('a',)\n    def f(self, m): return m * FACTOR", "Scale().f(s.mean)"),
    "enumeration": ("class Scale(enum.Enum):\n    A = FACTOR", "s.mean * Scale.A.value"),
    "named tuple": ("class Scale(typing.NamedTuple):\n    a: int = FACTOR", "s.mean * Scale().a"),
    "cached": ("@functools.lru_cache\ndef scale(): return FACTOR", "s.mean * scale()"),
    "partial": ("def by(f, m): return m * FACTOR * f\nscale = functools.partial(by, 1)", "scale(s.mean)"),
    "dict": ("def by(m): return m * FACTOR\nscale = {'a': [by]}", "scale['a'][0](s.mean)"),
    "set": ("def by(m): return m * FACTOR\ndef other(m): return by(m)\nscale = {by, other}", "[f(s.mean) for f in scale][0]"),
    "decorated": ("def twice(f): return functools.wraps(f)(lambda m: f(f(m)))\n@twice\ndef scale(m): return m * FACTOR", "scale(s.mean)"),
    "closure": ("def made(f): return lambda m: m * f\nscale = [made(FACTOR)]", "scale[0](s.mean)"),
    "own method": ("@spool.filter\ndef scale(s): return s.mean * FACTOR\nscales = [scale]", "scales[0](s)"),
    "pickled by name": ("class Scale:\n    def __init__(self, f): self.f = f\n    def __reduce__(self): return 'scale'\n"
                        "scale = Scale(FACTOR)\nscales = [scale]", "s.mean * scales[0].f"),
    "constants": ("values = [..., NotImplemented, len, FACTOR]", "s.mean * len(values)"),
    "texts": ("names = {'albedo', 'normal', 'depth', str(FACTOR)}", "s.mean * len(names)"),
    "sets of sets": ("names = [frozenset({frozenset({'a', 'b', str(FACTOR)}), frozenset({'c', 'd'})})]", "s.mean * len(names)"),
    "constant of a lambda": ("scale = lambda m: m * FACTOR if 'a' in {'a', 'b', 'c', 'd'} else m", "scale(s.mean)"),
    "circle": ("class Node:\n    def __init__(self, i): self.i, self.around = i, set()\n    def __repr__(self): return f'{self.i}'\n"
               "nodes = [Node(i * FACTOR) for i in range(40)]\nfor n in nodes: n.around.update(nodes)", "s.mean * len(nodes)"),
}


# Modules beside it, what stands before the filter, and what the filter answers.
ELSEWHERE = {
    "function": ({"near": "def f(m): return m * FACTOR"}, "from near import f", "f(s.mean)"),
    "class": ({"near": "class Scale:\n    def f(self, m): return m * FACTOR"}, "from near import Scale", "Scale().f(s.mean)"),
    "object": ({"near": "class Scale:\n    def f(self, m): return m * FACTOR\nscale = Scale()"}, "from near import scale", "scale.f(s.mean)"),
    "module": ({"near": "def f(m): return m * FACTOR"}, "import near as n", "n.f(s.mean)"),
    "value of a module": ({"near": ""}, "import near", "s.mean * near.FACTOR"),
    "module of a module": ({"near": "import far", "far": "def f(m): return m * FACTOR"}, "import near", "near.far.f(s.mean)"),
    "module behind it": ({"near": "import far\ndef f(m): return far.f(m)", "far": "def f(m): return m * FACTOR"}, "import near", "near.f(s.mean)"),
    "package": ({"near/__init__": "from .far import f", "near/far": "def f(m): return m * FACTOR"}, "import near", "near.f(s.mean)"),
    "held beside a lock": ({"near": "import threading\nclass Scale:\n    def __init__(self): self.lock, self.a = threading.Lock(), FACTOR\nscale = Scale()"},
                           "from near import scale", "s.mean * scale.a"),
}


def key_of_program(folder, factor, modules, beside, answer):
    """Of a filter in a program whose modules stand beside it, in a process of its own."""
    folder.mkdir()
    for name, text in modules.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / f"{name}.py").write_text(f"FACTOR = {factor}\n{text}\n")
    (folder / "main.py").write_text(f"import spool\n{beside}\n@spool.filter\ndef filtered(s): return {answer}\nprint(filtered.key)\n")
    done = subprocess.run([sys.executable, folder / "main.py"], capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", ELSEWHERE)
def test_what_a_function_reaches_in_other_files_counts_too(name, tmp_path):
    first, again, other = (key_of_program(tmp_path / f"{i}", factor, *ELSEWHERE[name]) for i, factor in enumerate((2, 2, 3)))
    assert first == again and first != other


def test_a_program_and_a_worker_that_imports_it_have_the_same_key(tmp_path):
    first = key_of_program(tmp_path / "program", 2, {}, "@spool.filter\ndef scale(s): return s.mean", "scale(s)")
    worker = subprocess.run([sys.executable, "-c", "import main"], capture_output=True, text=True, timeout=60,
                            env={**os.environ, "PYTHONPATH": os.pathsep.join([*sys.path, str(tmp_path / "program")])})
    assert worker.stdout == first, worker.stderr


def test_what_a_package_has_counts_by_name(tmp_path):
    def key(factor):
        package = tmp_path / f"{factor}" / "site-packages"
        package.mkdir(parents=True)
        (package / "near.py").write_text(f"def f(m): return m * {factor}")
        return key_of_program(tmp_path / f"{factor}" / "mine", factor, {},
                              f"import sys; sys.path.append({str(package)!r}); import near; from near import f",
                              "near.f(f(s.mean))").strip()
    assert key(2) == key(3)


def test_a_file_that_changes_while_its_old_code_runs_gives_it_no_other_ones_key(tmp_path):
    (tmp_path / "mine.py").write_text("import spool\n@spool.filter\ndef mine(s): return s.mean * 2\n")
    shown = ("import pathlib, mine\nfile = pathlib.Path(mine.__file__)\n"
             "for text in (file.read_text().replace('2', '3'), 'x = (\\n' * 3): file.write_text(text); print(mine.mine.key)")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*sys.path, str(tmp_path)]), "PYTHONDONTWRITEBYTECODE": "1"}
    old = subprocess.run([sys.executable, "-c", shown], capture_output=True, text=True, timeout=60, env=environment)
    assert old.returncode == 0, old.stderr
    (tmp_path / "mine.py").write_text("import spool\n@spool.filter\ndef mine(s): return s.mean * 3\n")
    new = subprocess.run([sys.executable, "-c", "import mine; print(mine.mine.key)"], capture_output=True, text=True, timeout=60, env=environment)
    assert new.stdout.strip() not in old.stdout.split() and len(old.stdout.split()) == 2


def keys(folder, factor, seed):
    """Of every module, in a process of its own."""
    names = []
    for i, (beside, answer) in enumerate(REACHED.values()):
        names.append(f"own_{i}")
        (folder / f"own_{i}.py").write_text(f"import abc, dataclasses, enum, functools, typing\nimport spool\nFACTOR = {factor}\n{beside}\n"
                                            f"@spool.filter\ndef filtered(s):\n    return {answer}\n")
    shown = "import sys, importlib\nfor name in sys.argv[1:]: print(importlib.import_module(name).filtered.key)"
    done = subprocess.run([sys.executable, "-c", shown, *names], capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONHASHSEED": str(seed), "PYTHONPATH": os.pathsep.join([*sys.path, str(folder)])})
    assert done.returncode == 0, done.stderr
    return dict(zip(REACHED, done.stdout.split()))


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    folder = tmp_path_factory.mktemp("modules")
    return keys(folder, 2, 1), keys(folder, 2, 2), keys(folder, 3, 1)


@pytest.mark.parametrize("name", REACHED)
def test_what_a_function_reaches_in_its_file_counts_in_every_process(known, name):
    first, again, other = known
    assert first[name] == again[name] and first[name] != other[name]
