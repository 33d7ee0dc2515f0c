"""``moseg segment``: files in, files out, one line for every mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

import moseg_core
from moseg_core import Problem, load

EXPRESSION = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"


def test_writes_every_format_and_prints_tables(moseg, mallet, tmp_path):
    outputs = [tmp_path / f"m.{suffix}" for suffix in ("json", "seg", "ply", "glb", "png", "svg")]
    words = [word for output in outputs for word in ("-o", output)]
    run = moseg("segment", mallet, "--recipe", "paper_hammer", *words)
    assert run.code == 0
    assert "handle" in run.out
    assert "narrow" in run.out
    assert "total" in run.out
    assert "wrote" in run.err

    document = json.loads(outputs[0].read_text())
    labels = np.array(document["labels"])
    assert outputs[1].read_text().split() == [str(label) for label in labels]
    assert document["problem"] == {"labels": ["handle", "head"], "minimize": EXPRESSION}
    total = sum(term["weight"] * term["value"] for term in document["terms"])
    assert document["cost"]["value"] == pytest.approx(total, rel=1e-12)

    scene = trimesh.load(outputs[3])
    assert set(scene.geometry) == {"handle", "head"}
    assert [len(scene.geometry[name].faces) for name in ("handle", "head")] == [
        int((labels == k).sum()) for k in (0, 1)
    ]
    assert outputs[4].read_bytes().startswith(b"\x89PNG")
    assert outputs[5].read_bytes().startswith(b"<svg")
    assert len(trimesh.load(outputs[2], process=False).faces) == len(labels)


def test_finds_the_mallets_head(moseg, mallet, tmp_path):
    out = tmp_path / "m.json"
    run = moseg(
        "segment", mallet, "--labels", "handle,head", "--minimize", EXPRESSION, "-o", out, "--quiet"
    )
    assert (run.code, run.out, run.err) == (0, "", "")
    document = json.loads(out.read_text())
    shape = load(mallet)
    head = (shape.points[:, 0] > 1.8).astype(int)
    right = shape.areas[np.array(document["labels"]) == head].sum() / shape.area
    assert right > 0.9
    by_hand = Problem(["handle", "head"], EXPRESSION).evaluate(shape, head)
    assert document["cost"]["value"] <= by_hand.cost.value


def test_json_summary_is_alone_on_stdout(moseg, mallet):
    run = moseg("segment", mallet, "--recipe", "paper_hammer", "--json")
    summary = json.loads(run.out)
    assert run.code == 0
    assert sum(part["area_share"] for part in summary["parts"]) == pytest.approx(1)
    assert summary["reason"] == "converged"


def test_a_limit_is_said(moseg, mallet):
    run = moseg(
        "segment",
        mallet,
        "--recipe",
        "hammer",
        "--optimizer",
        "pattern_search(max_evaluations=5)",
    )
    assert run.code == 0
    assert "warning: the search ended on its limit (evaluations)" in run.err


@pytest.mark.parametrize("present", [True, False])
def test_expression_is_checked_before_the_shape_is_read(moseg, mallet, tmp_path, present):
    path = mallet if present else tmp_path / "x.ply"
    run = moseg("segment", path, "--labels", "a,b", "--minimize", "3*narow(a)")
    assert run.code == 2
    assert run.out == ""
    assert run.err.splitlines() == [
        "moseg: unknown objective 'narow' in \"3*narow(a)\"; did you mean 'narrow'?",
        "  3*narow(a)",
        "    ^^^^^",
    ]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--labels", "a,b", "--minimize", "narrow(c)"], "unknown label 'c'"),
        (["--labels", "a,b", "--minimize", "perpendicular(a)"], "exactly 2 labels"),
        (["--labels", "a,b", "--minimize", "convex_parts(a)"], "takes no labels"),
        (["--labels", "a,b", "--minimize", "narrow(a, n=2)"], "unknown parameter 'n'"),
        (["--labels", "a,a", "--minimize", "narrow(a)"], "'a' is given twice"),
        (["--labels", "a b", "--minimize", "narrow(a)"], "letters, digits and '_'"),
        (["--labels", "a,b"], "--recipe NAME"),
        ([], "--recipe NAME"),
        (["--recipe", "hamer"], "did you mean 'hammer'?"),
        (["--recipe", "nowhere/x.toml"], "cannot be read"),
        (["--recipe", "paper_hammer", "--seeder", "kmean"], "did you mean 'kmeans'?"),
        (["--recipe", "paper_hammer", "--seeder", "kmeans(round=3)"], "did you mean 'rounds'?"),
        (
            ["--recipe", "paper_hammer", "--optimizer", "pattern_search(contraction=2)"],
            "0.01 to 0.99",
        ),
        (["--recipe", "paper_hammer", "--labeler", "greedy("], "expected"),
        (["--recipe", "paper_hammer", "--plane", "x"], "--constraint 'on_plane(handle)'"),
        (["--recipe", "paper_hammer", "--seed", "-1"], "seed"),
        (["--recipe", "paper_hammer", "--seed", "x"], "--seed"),
        (["--recipe", "paper_hammer", "-o", "x.docx"], ".docx"),
        (["--recipe", "paper_hammer", "-o", "nowhere/x.json"], "no folder"),
        (["--recipe", "paper_hammer", "--sed", "3"], "--sed"),
    ],
)
def test_usage_errors_are_one_line_and_exit_2(moseg, mallet, words, says):
    run = moseg("segment", mallet, *words)
    assert run.code == 2
    assert says in run.err
    assert "Traceback" not in run.err
    assert run.out == ""


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "does not exist"),
        (b"", "empty"),
        (b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "no faces"),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", "not finite"),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n", "not finite"),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", "degenerate"),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "7"),
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "too few for 2 labels"),
    ],
)
def test_bad_shapes_are_one_line_and_exit_3(moseg, tmp_path, content, says):
    path, out = tmp_path / "bad.off", tmp_path / "out.json"
    if content is not None:
        path.write_bytes(content)
    run = moseg("segment", path, "--labels", "a,b", "--minimize", "narrow(a)", "-o", out)
    assert run.code == 3
    assert says in run.err
    assert len(run.err.strip().splitlines()) == 1
    assert not out.exists()


def test_unknown_format_exits_2_and_lists_formats(moseg, tmp_path):
    path = tmp_path / "x.step"
    path.write_text("0 0 0\n")
    run = moseg("segment", path, "--recipe", "paper_hammer")
    assert run.code == 2
    assert ".off" in run.err


def test_an_open_mesh_is_refused_for_convex_parts(moseg, open_box, tmp_path):
    out = tmp_path / "out.json"
    run = moseg("segment", open_box, "--recipe", "paper_hammer", "-o", out)
    assert run.code == 3
    assert "'convex_parts' needs an enclosed volume" in run.err
    assert "boundary edges" in run.err
    assert not out.exists()
    fine = moseg("segment", open_box, "--labels", "a,b", "--minimize", "narrow(a)", "-o", out)
    assert fine.code == 0
    assert "encloses no volume" in fine.err


@pytest.mark.slow
def test_bytes_do_not_depend_on_the_process(mallet, tmp_path):
    """Two processes with different hash seeds write the same bytes, in every format."""
    suffixes = ("json", "seg", "ply", "glb", "png", "svg")
    for run in ("1", "2"):
        words = [w for s in suffixes for w in ("-o", str(tmp_path / f"{run}.{s}"))]
        subprocess.run(
            [
                sys.executable,
                "-m",
                "moseg_core",
                "segment",
                str(mallet),
                "--recipe",
                "hammer",
                *words,
            ],
            env={**os.environ, "PYTHONHASHSEED": run},
            check=True,
            capture_output=True,
        )
    for suffix in suffixes:
        first, second = ((tmp_path / f"{run}.{suffix}").read_bytes() for run in ("1", "2"))
        assert first == second, suffix


def test_nothing_but_the_outputs_is_left_behind(moseg, mallet, tmp_path):
    before = set(os.listdir(tmp_path))
    moseg("segment", mallet, "--recipe", "paper_hammer", "-o", tmp_path / "a.json")
    assert set(os.listdir(tmp_path)) - before == {"a.json"}


def test_recipe_file_and_replaced_labels(moseg, mallet, tmp_path):
    recipe = tmp_path / "mine.toml"
    recipe.write_text('labels = ["grip", "top"]\nminimize = "narrow(grip)"\n')
    run = moseg("segment", mallet, "--recipe", recipe, "--json")
    assert [part["label"] for part in json.loads(run.out)["parts"]] == ["grip", "top"]
    run = moseg("segment", mallet, "--recipe", recipe, "--minimize", "flat(top)", "--json")
    assert [term["term"] for term in json.loads(run.out)["terms"]] == ["flat(top)"]


def test_a_full_disk_or_read_only_folder_is_a_failure(moseg, mallet, tmp_path, monkeypatch):
    def no_space(*args: object, **kwargs: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("moseg_core.io.whole_file.tempfile.mkstemp", no_space)
    run = moseg("segment", mallet, "--recipe", "paper_hammer", "-o", tmp_path / "a.json")
    assert run.code == 1
    assert "No space left on device" in run.err
    assert not Path(tmp_path / "a.json").exists()


def test_a_writer_that_fails_is_named_and_the_other_outputs_are_written(
    moseg, mallet, tmp_path, monkeypatch
):
    monkeypatch.setattr("moseg_core.io.write.formats.write_seg", lambda result: "0\n1\n")
    outputs = [tmp_path / f"m.{suffix}" for suffix in ("json", "seg", "ply")]
    words = [word for output in outputs for word in ("-o", output)]
    run = moseg("segment", mallet, "--recipe", "paper_hammer", *words)
    assert run.code == 1
    assert "total" in run.out
    assert f"wrote {outputs[0]}, {outputs[2]}" in run.err
    last = run.err.splitlines()[-1]
    assert last.startswith("moseg: writer 'core:seg' of moseg-core 0.1.0 returned a str, not bytes")
    assert [output.exists() for output in outputs] == [True, False, True]


def test_no_file_of_a_writer_replaces_the_shape(moseg, mallet, tmp_path, monkeypatch):
    def write(result, *, name):
        return {name: b"", mallet.name: b""}

    monkeypatch.setattr("moseg_core.io.write.formats.write_seg", write)
    before = mallet.read_bytes()
    out = mallet.parent / "m.seg"
    run = moseg("segment", mallet, "--recipe", "paper_hammer", "-o", out)
    assert run.code == 2
    assert f"'{out}' comes with '{mallet}', which is the shape itself" in run.err
    assert mallet.read_bytes() == before
    assert not out.exists()


def test_no_component_ends_the_program_in_silence(moseg, mallet, monkeypatch):
    def leave(*given, **more):
        sys.exit(0)

    monkeypatch.setattr("moseg_core.cli.segment.solve_variants", leave)
    run = moseg("segment", mallet, "--recipe", "paper_hammer")
    assert run.code == 1
    assert "moseg: a component ended the search: SystemExit: 0 (" in run.err
    assert '"sys.exit(0)"' in run.err


def test_each_part_as_a_file_of_its_own(moseg, mallet, tmp_path):
    out = tmp_path / "parts" / "{part}.stl"
    run = moseg(
        "segment", mallet, "--recipe", "paper_hammer", "--optimizer",
        "pattern_search(max_evaluations=30)", "-o", out, "--hulls", "--hull-vertices", "8",
        "-o", tmp_path / "m.seg",
    )  # fmt: skip
    assert run.code == 0
    assert f"wrote {out} (2 files), {tmp_path / 'm.seg'}" in run.err
    hulls = [trimesh.load(out.with_name(f"{name}.stl")) for name in ("handle", "head")]
    assert all(hull.is_watertight and len(hull.vertices) <= 8 for hull in hulls)


def test_slips_about_parts_are_told_before_the_search(moseg, mallet, tmp_path):
    for words, says in [
        (["-o", tmp_path / "{Part}.stl"], "unknown name in braces 'Part'; did you mean 'part'?"),
        (["-o", tmp_path / "{part}.json"], "formats: .stl, .obj, .ply, .glb"),
        (["-o", tmp_path / "x.stl"], "or a file for each part: '"),
        (["-o", tmp_path / "x.json", "--close"], "none is asked for"),
        (["-o", tmp_path / "{part}.stl", "--hull-vertices", "9"], "no hulls are asked for"),
    ]:
        run = moseg("segment", mallet, "--recipe", "paper_hammer", *words)
        assert (run.code, says in run.err) == (2, True), run.err
    own = tmp_path / "head.ply"
    moseg_core.write_file(own, moseg_core.sample_path("hammer").read_bytes())
    run = moseg("segment", own, "--recipe", "paper_hammer", "-o", tmp_path / "{part}.ply")
    assert (run.code, "is read here" in run.err) == (2, True)
    assert list(tmp_path.glob("*.stl")) == []
