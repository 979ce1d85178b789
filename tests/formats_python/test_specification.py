"""The byte tables of formats/spool.md and the numpy types are one thing."""
import re

import numpy as np
import pytest
from spool import channel, record_layout as layout, save

from conftest import ROOT

TEXT = (ROOT / "formats" / "spool.md").read_text(encoding="utf-8")
TYPES = {"u8": "u1", "u16": "<u2", "u32": "<u4", "u64": "<u8"}


def table(name):
    rows = TEXT.split(f"<!-- table: {name} -->")[1].strip().split("\n\n")[0].splitlines()[2:]
    for row in rows:
        offset, type, field = (cell.strip() for cell in row.split("|")[1:4])
        yield int(offset), type, field.strip("`")


@pytest.mark.parametrize("name, dtype", [
    ("file_header", layout.FILE_HEADER), ("record_header", layout.RECORD_HEADER), ("footer", layout.FOOTER),
    ("imag", layout.IMAG), ("chan", layout.CHAN), ("index_entry", layout.INDEX_ENTRY)])
def test_byte_tables(name, dtype):
    found = []
    for offset, type, field in table(name):
        array = re.fullmatch(r"(?:u8|char)\[(\d+)\]", type)
        found.append((field, offset, np.dtype(f"V{array[1]}") if array else np.dtype(TYPES[type])))
    assert found == [(field, dtype.fields[field][1], dtype.fields[field][0]) for field in dtype.names]


def test_names_of_layers():
    for row in TEXT.split("## 10. Names of layers")[1].split("\n\n")[1].splitlines()[2:]:
        layers, components, semantic, meaning = (cell.strip() for cell in row.split("|")[1:5])
        layers = re.findall(r"`(\w+)`", layers)
        components = components.split(" / ") if "/" in components else [components] * len(layers)
        for layer, letters in zip(layers, components):
            assert (tuple(letters.split()), int(semantic)) == (tuple(channel.VOCABULARY[layer][0]), channel.VOCABULARY[layer][1])
            assert (layer in save.PIXEL_LAYERS) == meaning.startswith("pixel scope")


def test_example_code_reads_a_file(tmp_path):
    import spool
    path = tmp_path / "example.spool"
    spool.write(path, np.arange(2 * 3 * 4 * 3, dtype="f4").reshape(2, 3, 4, 3))
    code = TEXT.split("## 12. Reading with numpy")[1].split("```python")[1].split("```")[0]
    names = {"path": path}
    exec(code, names)
    assert (names["samples"].reshape(3, 2, 3, 4).transpose(1, 2, 3, 0) == spool.open(path).read("radiance")).all()
