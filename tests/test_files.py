"""Files are there whole or not at all."""

from pathlib import Path

import pytest

from atwood_cli.files import written_beside


def test_written_beside_leaves_all_as_it_was_on_an_error(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text("before")

    def fail() -> None:
        with written_beside(file, force=True) as beside:
            beside.write_text("half")
            raise ValueError

    with pytest.raises(ValueError):  # noqa: PT011
        fail()
    assert file.read_text() == "before"
    assert list(tmp_path.iterdir()) == [file]


def test_written_beside_follows_links(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    file, link = tmp_path / "data" / "a.txt", tmp_path / "link.txt"
    try:
        link.symlink_to(file)
    except OSError:
        pytest.skip("no links here")
    with written_beside(link) as beside:
        assert beside.parent == file.parent
        beside.write_text("whole")
    assert link.is_symlink()
    assert file.read_text() == "whole"


def test_written_beside_replaces_only_by_force(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text("kept")
    with pytest.raises(FileExistsError, match="--force replaces it"), written_beside(file):
        pass
    assert file.read_text() == "kept"
    with written_beside(file, force=True) as beside:
        assert file.read_text() == "kept"
        assert (beside.parent, beside.suffix) == (tmp_path, ".txt")
        beside.write_text("new")
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


def test_written_beside_names_the_file_asked_for(tmp_path: Path) -> None:
    file = tmp_path / "none" / "a.txt"
    with pytest.raises(FileNotFoundError) as caught, written_beside(file):
        pass
    assert caught.value.filename == str(file)
