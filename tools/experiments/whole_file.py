"""Files that appear whole or not at all, whoever else writes them."""
import os
import tempfile


def write_whole(path, text):
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".partial", dir=path.parent)
    try:
        with open(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def with_last_part(page, title, text):
    """A page whose last part, which begins with this heading, is replaced or added."""
    before = page.partition(title)[0].rstrip("\n")
    return f"{before}\n\n{text}"


def with_part(page, title, text):
    """A page whose part with this heading, up to the next heading of its rank, is replaced."""
    before, found, rest = page.partition(title + "\n")
    if not found:
        raise ValueError(f"the page has no part '{title}'")
    _, found, after = rest.partition("\n## ")
    return before + text.rstrip("\n") + "\n" + (found and "\n## " + after)
