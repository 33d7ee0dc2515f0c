"""``moseg sample``: the shapes that come with moseg."""

from __future__ import annotations

from pathlib import Path

from moseg_core.cli.console import message
from moseg_core.errors import UsageError
from moseg_core.io import load, read_labels, save_labels, write_file
from moseg_core.io.whole_file import check_destination
from moseg_core.samples import sample_labels_path, sample_path


def run_sample(name: str, out: Path, labels: Path | None) -> None:
    """Write the mesh, and its labels where asked."""
    if out.suffix.lower() != ".ply":
        raise UsageError(f"samples are written as PLY; name the file '{out.stem}.ply'")
    if labels is not None and labels.suffix.lower() not in (".seg", ".txt"):
        raise UsageError(f"labels are written as .txt or .seg, not '{labels.suffix}'")
    for path in (out, *([labels] if labels else [])):
        check_destination(path)
    mesh, truth = sample_path(name), sample_labels_path(name)
    write_file(out, mesh.read_bytes())
    if labels is not None:
        if labels.suffix.lower() == ".txt":
            write_file(labels, truth.read_bytes())
        else:
            save_labels(read_labels(truth, load(mesh).n_elements).labels, labels)
    message(f"wrote {out}" + (f", {labels}" if labels else ""))
