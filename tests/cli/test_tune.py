"""``moseg tune``: what it refuses, and that it serves until Ctrl-C."""

from __future__ import annotations

import signal
import subprocess
import sys
import urllib.request

import pytest


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["hammmer"], "did you mean 'hammer'"),
        (["hammer", "--recipe", "fourleg"], "both name a recipe"),
        (["any_shape"], "for any number of parts"),
        (["hammer", "-o", "mine.json"], "let its name end in .toml"),
        (["hammer", "--example", "nowhere/mine.json"], "nowhere"),
        ([], "say what to look for"),
    ],
)
def test_what_cannot_be_tuned_is_refused_before_the_search(moseg, mallet, options, why):
    run = moseg("tune", mallet, *options, "--no-open")
    assert run.code == 2
    assert why in run.err


def test_it_serves_until_interrupted(mallet, tmp_path):
    command = [sys.executable, "-m", "moseg_core", "tune", str(mallet), "hammer", "--no-open"]
    search = ["--restarts", "1", "--seeder", "kmeans", "--optimizer"]
    search += ["pattern_search(max_evaluations=20)", "--example", str(tmp_path / "mallet.json")]
    with subprocess.Popen([*command, *search], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            line = next(line for line in process.stderr if "open http" in line)
            url = line.partition("open ")[2].split()[0]
            with urllib.request.urlopen(url) as page:
                assert b'"tune":' in page.read()
            process.send_signal(signal.SIGINT)
            _, rest = process.communicate(timeout=60)
        finally:
            process.kill()  # where it has ended, this does nothing
    assert process.returncode == 0
    assert rest.splitlines()[-1] == "moseg: ended"
    assert list(tmp_path.iterdir()) == [mallet]
