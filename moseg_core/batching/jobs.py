"""From shapes and a folder to jobs: which files are meant, what is written where, each job's key.

Shapes are given as paths or patterns. The result of each is a ``.json`` in the batch's folder,
called like the shape; where two shapes are called alike, they are told apart by the folders that
they are in, and where that does not help they are refused by name. Other outputs have ``{shape}``
in their path, which stands for that name: ``out/{shape}.glb``, ``out/{shape}/{part}.stl``.

A job's *key* is a hash of all that its result depends on, so that a batch that goes on
knows what is done, and does again what has changed.
"""

from __future__ import annotations

import glob
import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from moseg_core.components.discovery.registry import registry
from moseg_core.errors import UsageError
from moseg_core.io.files import check_any_output, instead_of
from moseg_core.io.write.names import safe_file_name

PLACE = "{shape}"
"""What stands for the shape's name in the path of an output."""

#: Characters of a GLTF file that are looked through for the names of its other files.
_MOST_JSON = 50_000_000


@dataclass(frozen=True, kw_only=True)
class Job:
    """What one process is to do: plain data, which can be sent anywhere.

    Parameters
    ----------
    shape : str
        Path as it was given.
    here : str
        Folder from which paths are seen.
    folder : str
        Of the batch, an absolute path.
    outputs : tuple of str
        Absolute paths of what is written, the result (.json) first.
    instructions : str
        What is to be done, as JSON (:class:`moseg_core.batching.instructions.Instructions`).
    key : str
    task : {"solve", "describe"}
        Whether the shape is segmented, or its result drawn and measured.
    seed : int
        For the global random generators, which moseg does not use, but components may.
    versions : mapping of str to str
        What has to be installed wherever the job is done; empty for no matter.
    timeout : float or None
        Seconds that it may take.
    memory : float or None
        Bytes that it may take.
    """

    shape: str
    here: str
    folder: str
    outputs: tuple[str, ...]
    instructions: str
    key: str
    task: str = "solve"
    seed: int = 0
    versions: Mapping[str, str] = field(default_factory=dict)
    timeout: float | None = None
    memory: float | None = None


def expand_shapes(words: Iterable[str | os.PathLike[str]]) -> tuple[str, ...]:
    """The files that paths and patterns stand for, each once; those of a pattern in their order.

    Raises
    ------
    UsageError
        A file that does not exist, a folder, a pattern that nothing matches, or no shapes at all.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> folder = moseg.sample_path("hammer").parent
    >>> [Path(path).name for path in expand_shapes([folder / "h*.ply"])]
    ['hammer.ply', 'horse.ply']
    """
    found: dict[str, None] = {}
    for word in [words] if isinstance(words, str | os.PathLike) else words:
        text = os.fspath(word)
        if glob.has_magic(text) and not os.path.exists(text):
            matches = sorted(p for p in glob.glob(text, recursive=True) if os.path.isfile(p))
            if not matches:
                raise UsageError(f"no file is called like '{text}'{_no_folder(text)}")
            found |= dict.fromkeys(matches)
        elif os.path.isdir(text):
            raise UsageError(
                f"'{text}' is a folder; say which files in it, such as"
                f" '{os.path.join(text, '*.off')}'"
            )
        elif not os.path.exists(text):
            raise UsageError(f"'{text}' does not exist{instead_of(Path(text))}")
        else:
            found[text] = None
    if not found:
        raise UsageError("there are no shapes; give files, or a pattern such as 'models/*.off'")
    return tuple(found)


def shape_stem(path: Path) -> str:
    """The name of a shape's file without the suffix that its reader goes by.

    Examples
    --------
    >>> shape_stem(Path("models/horse.v2.off"))
    'horse.v2'
    """
    name = path.name.lower()
    known = [suffix for suffix in registry().suffixes("reader") if name.endswith(suffix)]
    return path.name[: -len(max(known, key=len))] if known else path.stem


def shape_names(paths: Sequence[str]) -> tuple[str, ...]:
    """A name for each shape, safe in file names and all different.

    Raises
    ------
    UsageError
        Two shapes that neither their names nor their folders tell apart.

    Examples
    --------
    >>> shape_names(["a/scan.off", "b/scan.off", "b/cup 1.ply"])
    ('a-scan', 'b-scan', 'cup_1')
    """
    names = [safe_file_name(shape_stem(Path(path))) for path in paths]
    again = _repeated(names)
    if again:
        whole = [os.path.abspath(path) for path in paths]
        common = os.path.commonpath([os.path.dirname(path) for path in whole])
        for k in again:
            folders = os.path.relpath(os.path.dirname(whole[k]), common)
            words = [*folders.split(os.sep), shape_stem(Path(paths[k]))]
            names[k] = safe_file_name("-".join(word for word in words if word != "."))
    if again := _repeated(names):
        both = [k for k in again if names[k].casefold() == names[again[0]].casefold()][:2]
        first, second = (paths[k] for k in both)
        raise UsageError(
            f"the results of '{first}' and '{second}' would both be called '{names[both[0]]}.json';"
            f" do one of them in another batch"
        )
    return tuple(names)


def check_outputs(
    folder: Path, templates: Sequence[str], shapes: Sequence[str], names: Sequence[str]
) -> None:
    """Refuse what cannot be written, or would be written over a shape or another output.

    Parameters
    ----------
    folder : Path
        Of the batch; it exists.
    templates : sequence of str
        Further outputs, with ``{shape}`` in them.
    shapes, names : sequence of str

    Raises
    ------
    UsageError
    """
    for template in templates:
        if PLACE not in template:
            raise UsageError(
                f"'{template}' would be one file for all shapes; put {PLACE} where the shape's name"
                f" is to be, such as '{folder / PLACE}{Path(template).suffix}'"
            )
        check_any_output(Path(template.replace(PLACE, names[0])))
    if twice := [template for template, count in Counter(templates).items() if count > 1]:
        raise UsageError(f"the output '{twice[0]}' is given twice")
    inputs = {os.path.realpath(shape) for shape in shapes}
    results = {os.path.realpath(folder / f"{name}.json"): name for name in names}
    for template in ("", *templates):
        for name in names:
            file = os.path.realpath(template.replace(PLACE, name) or folder / f"{name}.json")
            if file in inputs:
                raise UsageError(
                    f"'{file}' is one of the shapes; write the results to another folder"
                )
            if template and file in results:
                raise UsageError(f"'{template}' is the result that is written in any case")


def job_key(
    shape: str, outputs: Sequence[str], instructions: str, components: Mapping[str, str]
) -> str:
    """A hash of all that a job's outcome depends on.

    Parameters
    ----------
    shape : str
        Path; the bytes of the file count, those of files that it names, and the path itself, which
        the result holds.
    outputs : sequence of str
        What is written, as seen from the batch's folder.
    instructions : str
    components : mapping of str to str
        Those that take part, with their versions.

    Returns
    -------
    str
        32 hexadecimal digits.
    """
    digest = hashlib.sha256()
    for file in (Path(shape), *_beside(Path(shape))):
        try:
            with file.open("rb") as stream:
                digest.update(hashlib.file_digest(stream, "sha256").digest())
        except OSError:  # whoever reads it says so
            digest.update(b"none")
    said = [shape, list(outputs), instructions, dict(components)]
    digest.update(json.dumps(said, sort_keys=True).encode(errors="surrogateescape"))
    return digest.hexdigest()[:32]


def _beside(path: Path) -> list[Path]:
    """Other files that a shape's file is read with: buffers of GLTF, materials of OBJ."""
    suffix = path.suffix.lower()
    if suffix == ".obj":
        return [path.with_suffix(".mtl")]
    if suffix != ".gltf":
        return []
    try:
        if path.stat().st_size > _MOST_JSON:
            return []
        document = json.loads(path.read_bytes())
        listed: list[Any] = document.get("buffers", [])
        uris = [entry.get("uri") for entry in listed]
    except (OSError, ValueError, AttributeError, TypeError, RecursionError):
        return []  # whoever reads it says what is wrong with it
    # A name that is no file's own is not looked at: what it leads to is refused by the reader.
    return [
        path.with_name(unquote(uri))
        for uri in uris
        if isinstance(uri, str) and not uri.startswith("data:") and uri == Path(uri).name
    ]


def _repeated(names: Sequence[str]) -> list[int]:
    """Which names occur several times, capitals apart."""
    counts = Counter(name.casefold() for name in names)
    return [k for k, name in enumerate(names) if counts[name.casefold()] > 1]


def _no_folder(pattern: str) -> str:
    """What is wrong with the folder of a pattern; empty where it has one."""
    folder = os.path.dirname(pattern)
    if not folder or glob.has_magic(folder) or os.path.isdir(folder):
        return ""
    return f"; there is no folder '{folder}'"
