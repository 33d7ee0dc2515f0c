"""What a killed process was writing is taken away, and nothing else."""

from __future__ import annotations

from moseg_core.batching.leftovers import take_away_leftovers

LONG = "x" * 60


def test_files_that_were_being_written_are_taken_away_and_no_others(tmp_path):
    torn = [".a.json.abc_0123", f".{LONG}.json.abcd0123", f".{LONG[:40]}.abcd0123"]
    torn += ["a/.b.ply.0_a_b_c_"]
    kept = [".a.json.backup", ".b.json.abc_0123", "a/.b.stl.0_a_b_c_", "a.json.abc_0123"]
    kept += [".x.abcd0123", "a.json", "a/b.ply"]
    (tmp_path / "a").mkdir()
    for name in torn + kept:
        (tmp_path / name).write_text("")
    templates = [f"{tmp_path}/{{shape}}/{{part}}.ply"]
    take_away_leftovers(tmp_path, templates, ["a", LONG])
    assert [name for name in torn if (tmp_path / name).exists()] == []
    assert [name for name in kept if (tmp_path / name).exists()] == kept
