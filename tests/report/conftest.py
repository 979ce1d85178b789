import hashlib
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.dont_write_bytecode = True


@pytest.fixture(scope="session")
def made_folder(tmp_path_factory):
    """A results folder with images; some methods tie, some differ."""
    from made_results import make_rows, write_images, write_results
    from tools.report.file_names import dump_names, file_name_of

    folder = tmp_path_factory.mktemp("results")
    rows = make_rows()
    write_results(folder, rows)
    write_images(folder, rows, dump_names(dict.fromkeys(row["dump"] for row in rows)), file_name_of)
    return folder


@pytest.fixture
def assets_cache(tmp_path, monkeypatch):
    """Stand-ins for the scripts of others, so that no network is needed."""
    from tools.report import assets

    folder = tmp_path / "assets"
    folder.mkdir()
    pinned = {}
    for asset in assets.ASSETS:
        for file in (asset.script, asset.licence):
            data = f"// {file} <!-- </script>".encode()
            (folder / file).write_bytes(data)
            pinned[file] = hashlib.sha256(data).hexdigest()
    monkeypatch.setenv("SPOOL_REPORT_ASSETS", str(folder))
    monkeypatch.setattr(assets, "pinned_hashes", lambda: pinned)
    return folder
