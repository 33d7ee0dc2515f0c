"""Kernels are compiled once where code can be kept on disk, and in every process elsewhere."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys

import numpy as np
import pytest

from moseg_core.shape import compiled


def doubled(values: np.ndarray) -> None:
    for k in range(len(values)):
        values[k] *= 2.0


def run(kernel):
    values = np.arange(3.0)
    kernel(values)
    return values.tolist()


@pytest.fixture
def unwarned(monkeypatch):
    """Nothing has been warned of in this process yet."""
    monkeypatch.setattr(compiled, "_warned", bytearray(1))


@pytest.fixture
def fresh(tmp_path, monkeypatch):
    """Make the kernel as a new process would, of a module that only this test has."""
    monkeypatch.setattr("numba.core.config.CACHE_DIR", "")
    module = tmp_path / "doubling.py"
    module.write_text(inspect.getsource(doubled))

    def make():
        names = {"np": np, "__name__": __name__}
        exec(compile(module.read_text(), str(module), "exec"), names)
        return compiled.kernel(names["doubled"])

    return make


def kept(folder):
    return list((folder / "__pycache__").iterdir())


def test_a_kernel_does_what_the_function_does():
    kernel = compiled.kernel(doubled)
    assert run(kernel) == run(doubled) == [0.0, 2.0, 4.0]
    assert len(kernel.nopython_signatures) == 1
    assert kernel.targetoptions["nogil"]


def test_another_process_would_find_it(fresh):
    assert run(fresh()) == [0.0, 2.0, 4.0]
    again = fresh()
    assert run(again) == [0.0, 2.0, 4.0]
    assert (again.stats.cache_hits.total(), again.stats.cache_misses.total()) == (1, 0)


def test_a_kernel_is_compiled_anew_when_one_that_it_calls_has_changed(tmp_path, monkeypatch):
    monkeypatch.setattr("numba.core.config.CACHE_DIR", "")
    outer = "def outer(number):\n    return inner(number)\n"

    def make(inner):
        """The outer kernel, as a process would find it after an edit of the inner one."""
        names = {"__name__": __name__}
        for name, source in (("inner", inner), ("outer", outer)):
            (tmp_path / f"{name}.py").write_text(source)
            exec(compile(source, str(tmp_path / f"{name}.py"), "exec"), names)
            names[name] = compiled.kernel(names[name])
        return names["outer"]

    assert make("def inner(number):\n    return number + 1\n")(1) == 2
    again = make("def inner(number):\n    return number + 1\n")
    assert again(1) == 2
    assert again.stats.cache_hits.total() == 1
    assert make("def inner(number):\n    return number + 2\n")(1) == 3


def cut(content):
    return content[: len(content) // 2]


def flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def emptied(content):
    return b""


@pytest.mark.parametrize("damage", [cut, flipped, emptied], ids=lambda damage: damage.__name__)
def test_a_damaged_file_is_told_of_once_and_replaced(damage, tmp_path, fresh, unwarned):
    run(fresh())
    (path,) = kept(tmp_path)
    path.write_bytes(damage(path.read_bytes()))
    again = fresh()
    with pytest.warns(RuntimeWarning, match=f"'{path.parent}' are damaged and are compiled anew"):
        assert run(again) == [0.0, 2.0, 4.0]
    assert again.stats.cache_hits.total() == 0
    mended = fresh()
    assert run(mended) == [0.0, 2.0, 4.0]
    assert mended.stats.cache_hits.total() == 1


def test_a_disk_that_takes_nothing_is_told_of_once_and_fails_no_run(
    tmp_path, fresh, monkeypatch, unwarned
):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    kernel = fresh()
    with pytest.warns(RuntimeWarning, match=f"{tmp_path}.*: No space left on device;"):
        assert run(kernel) == [0.0, 2.0, 4.0]
    kernel(np.arange(3.0, dtype=np.float32))  # a second warning would be an error
    assert kept(tmp_path) == []


def test_where_no_folder_can_be_written_to_kernels_are_compiled_anew(monkeypatch, unwarned):
    def no_folder(function):
        raise RuntimeError("cannot cache function 'doubled': no locator available")

    monkeypatch.setattr(compiled, "_Kept", no_folder)
    kernel = compiled.kernel(doubled)
    with pytest.warns(RuntimeWarning, match="nor in the user's cache folder"):
        assert run(kernel) == [0.0, 2.0, 4.0]
    assert kernel.targetoptions["nogil"]


def test_other_errors_are_not_taken_for_a_missing_folder():
    with pytest.raises(TypeError):
        compiled.kernel(3)


def test_processes_of_a_read_only_package_share_the_users_folder(tmp_path):
    package, home = tmp_path / "package", tmp_path / "home"
    package.mkdir()
    (package / "__pycache__").touch()  # no folder, so that root cannot write there either
    (package / "halving.py").write_text(
        "from moseg_core.shape.compiled import kernel\n"
        "@kernel\ndef halve(number):\n    return number / 2\n"
        "print(halve(3.0))\n"
    )
    environment = os.environ | {"XDG_CACHE_HOME": str(home), "NUMBA_CACHE_DIR": ""}
    command = [sys.executable, "-W", "error", str(package / "halving.py")]
    together = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    assert [process.communicate()[0] for process in together] == ["1.5\n", "1.5\n"]
    assert [path.suffix for path in home.rglob("halving*")] == [".kernel"]


def test_the_first_compilation_is_told_of_and_what_is_found_on_disk_is_not(fresh):
    told = []
    with compiled.telling_of_compilation(lambda: told.append("compiling")):
        kernel = fresh()
        run(kernel)
        kernel(np.arange(3.0, dtype=np.float32))
    assert told == ["compiling"]
    with compiled.telling_of_compilation(lambda: told.append("again")):
        run(fresh())
    fresh()(np.arange(3, dtype=np.int32))
    assert told == ["compiling"]
