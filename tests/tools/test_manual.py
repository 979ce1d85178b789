"""Completions and manual pages hold every verb and every option, and their readers take them."""
import re
import shlex
import shutil
import subprocess

import pytest
from conftest import PROGRAM


def helped(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True).stdout


def verbs():
    return re.findall(r"^  (\w+)  ", helped("--help"), re.M)


def options(verb):
    """Long options, and short ones, as --help lists them."""
    return {word for names in re.findall(r"^  (-[\w,-]+)", helped(verb, "--help"), re.M) for word in names.split(",")}


EVERY = [(verb, option) for verb in verbs() for option in sorted(options(verb))]


def test_there_is_something_to_look_for():
    assert {"info", "evaluate", "completion", "man"} <= set(verbs()) and len(EVERY) > 100


def test_the_program_s_page_has_every_verb_and_each_verb_a_page(good, tmp_path):
    good("man", "-o", "pages")
    pages = {path.name for path in (tmp_path / "pages").iterdir()}
    assert pages == {"spool.1"} | {f"spool-{verb}.1" for verb in verbs()}
    text = (tmp_path / "pages/spool.1").read_text(encoding="utf-8")
    assert [verb for verb in verbs() if f".BR spool\\-{verb} (1)\n" not in text] == []


def test_each_verb_s_page_has_every_option(good):
    pages = {verb: good("man", verb).out.replace("\\-", "-") for verb in verbs()}
    assert [(verb, option) for verb, option in EVERY if f"\\fB{option}\\fR" not in pages[verb]] == []


def test_a_value_is_described_once_in_words_of_a_user():
    text = {verb: helped(verb, "--help") for verb in ("pack", "convert", "synth")}
    assert "--max-expansion 1 .. 1000000" in text["pack"] and "REQUIRED" not in text["convert"]
    assert "--seed UINT" in text["synth"] and "UINT:" not in text["synth"]


@pytest.mark.parametrize("verb", [None, *verbs()])
def test_groff_has_nothing_to_warn_of(good, tmp_path, verb):
    page = tmp_path / "page.1"
    page.write_text(good("man", *([verb] if verb else [])).out, encoding="utf-8")
    done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z", str(page)], capture_output=True, text=True, check=True)
    assert done.stderr == ""


@pytest.mark.parametrize("verb", [None, *verbs()])
def test_pages_fit_80_columns(good, tmp_path, verb):
    page = good("man", *([verb] if verb else [])).out
    done = subprocess.run(["groff", "-man", "-Tutf8", "-P-c", "-rLL=78n"], input=page, capture_output=True, text=True, check=True)
    assert [line for line in re.sub(".\b", "", done.stdout).splitlines() if len(line) > 80] == []


def test_a_page_that_exists_is_replaced_only_by_force(run, good):
    good("man", "-o", "pages")
    run("man", "-o", "pages").failed_with(2, "spool.1", "--force")
    good("man", "--force", "-o", "pages")
    run("man", "evaluat").failed_with(2, "evaluat", "did you mean 'evaluate'")
    run("completion", "tcsh").failed_with(2, "tcsh")


def bash_offers(script, *line):
    """What bash offers for the last word of a command line."""
    words = " ".join(shlex.quote(word) for word in line)
    code = (f"source {shlex.quote(str(script))}; COMP_WORDS=({words}); COMP_CWORD={len(line) - 1}; _spool; "
            'printf "%s\\n" "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "--norc", "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return set(done.stdout.split())


def test_bash_offers_every_verb_every_option_and_values(good, tmp_path):
    script = tmp_path / "spool.bash"
    script.write_text(good("completion", "bash").out, encoding="utf-8")
    assert set(verbs()) <= bash_offers(script, "spool", "")
    for verb in verbs():
        assert options(verb) <= bash_offers(script, "spool", verb, "-"), verb
    assert bash_offers(script, "spool", "eval") == {"evaluate"}
    assert bash_offers(script, "spool", "replay", "x.spool", "--sampler", "multi") == {"multiscale"}
    assert bash_offers(script, "spool", "evaluate", "x", "--filters", "box,direc") == {"box,directional"}
    assert bash_offers(script, "spool", "list", "filt") == {"filters"}
    assert bash_offers(script, "spool", "replay", "--order", "s") == {"shuffled"}
    assert bash_offers(script, "spool", "compare", "--match", "") == {"label", "name"}
    assert bash_offers(script, "spool", "reconstruct", "--preset", "rob") == {"robust"}
    assert bash_offers(script, "spool", "evaluate", "--reference", "hold") == {"holdout", "holdout_pair"}
    assert bash_offers(script, "spool", "figure", "--metric", "flip") == {"flip_ldr", "flip_hdr"}
    assert bash_offers(script, "spool", "man", "eval") == {"evaluate"}
    assert bash_offers(script, "spool", "replay", "-o", "") == set(), "files are the shell's"


def test_fish_offers_every_verb_every_option_and_values(good, tmp_path):
    script = tmp_path / "spool.fish"
    script.write_text(good("completion", "fish").out, encoding="utf-8")
    lines = ["spool ", *(f"spool {verb} -" for verb in verbs()), "spool replay --sampler multi"]
    asked = "; ".join(f"echo '@@'; complete -C {shlex.quote(line)}" for line in lines)
    environment = {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path), "PATH": "/usr/bin:/bin", "TERM": "dumb"}
    done = subprocess.run(["fish", "-N", "-c", f"source {script}; {asked}"], capture_output=True, text=True,
                          check=True, env=environment)
    assert done.stderr == ""
    first, *of_verbs, samplers = [{line.split("\t")[0] for line in part.splitlines()}
                                  for part in done.stdout.split("@@\n")[1:]]
    assert set(verbs()) <= first
    for verb, offered in zip(verbs(), of_verbs):
        assert options(verb) <= offered | {"-h"}, (verb, options(verb) - offered)
    assert samplers == {"multiscale"}


def test_zsh_takes_the_script_and_it_has_every_verb_and_option(good, tmp_path):
    script = tmp_path / "_spool"
    script.write_text(good("completion", "zsh").out, encoding="utf-8")
    assert shutil.which("zsh"), "apt-get install zsh"
    subprocess.run(["zsh", "-f", "-n", str(script)], check=True)
    text = script.read_text(encoding="utf-8")
    parts = dict(re.findall(r"^    (\w+)\) _arguments (.*?) ;;$", text, re.M | re.S))
    assert set(parts) == set(verbs())
    assert [(verb, option) for verb, option in EVERY if not re.search(rf"'\*?{option}\[", parts[verb])] == []
    # _arguments itself, without a terminal: a specification it cannot read is an error of zsh.
    code = ("autoload -U compinit; compinit -D; _describe() { : }; _files() { : }; "
            f"source {script}; print -r -- ${{+functions[_spool]}}")
    done = subprocess.run(["zsh", "-f", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().endswith("1")
