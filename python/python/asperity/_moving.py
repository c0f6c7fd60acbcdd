"""What patches and seals have in common: a definition in a file, and its run, which is moved step by step."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Generic, Protocol, TypeVar

from ._arguments import Floats
from ._files import folder_of
from ._library import options as library_options
from ._library import warn_of_packed

State = TypeVar("State")
Own = TypeVar("Own", bound="Moving[Any]")


class _Definition(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def file(self) -> Path: ...
    def files(self) -> list[Path]: ...
    def pack(self, output: Path, libraries: list[str], options: dict[str, Any]) -> list[str]: ...


class _Run(Protocol[State]):
    @property
    def time(self) -> float: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[tuple[str, str]]: ...
    def value(self, name: str) -> float: ...
    def values(self) -> Floats: ...
    def state(self) -> State: ...
    def set_state(self, state: State) -> None: ...
    def copy(self) -> Any: ...


class Moving(Generic[State]):
    """A definition and its run.

    ``moving[name]`` is the present value of an output; ``state`` is all that changes, to be kept, pickled and put back. A
    copy goes on exactly as the original, bit for bit.
    """

    # The classes of the native part: of the definition, made of its file, and of the run.
    _native_definition: Any
    _native_run: Any

    _definition: _Definition
    _started: Any
    # Where the files of one that was unpickled are.
    _folder: TemporaryDirectory[str] | None

    @property
    def _run(self) -> _Run[State]:
        """The run."""
        raise NotImplementedError

    @classmethod
    def _going_on(cls: type[Own], definition: Any, run: Any, folder: TemporaryDirectory[str] | None) -> Own:
        moving = cls.__new__(cls)
        moving._definition, moving._started, moving._folder = definition, run, folder
        return moving

    @classmethod
    def _unpickled(cls: type[Own], name: str, files: dict[str, bytes], state: Any) -> Own:
        folder = folder_of(files)
        definition = cls._native_definition(Path(folder.name) / name)
        return cls._going_on(definition, cls._native_run.restore(definition, state), folder)

    def __getitem__(self, name: str) -> float:
        """The present value of an output of the file's groups."""
        return self._run.value(name)

    @property
    def name(self) -> str:
        """The name in the file."""
        return self._definition.name

    @property
    def names(self) -> list[str]:
        """The names of the outputs."""
        return self._run.names

    @property
    def units(self) -> dict[str, str]:
        """Their units."""
        return dict(self._run.units)

    @property
    def values(self) -> Floats:
        """Present values of all outputs, in the order of :attr:`names`, shape (n,)."""
        return self._run.values()

    @property
    def time(self) -> float:
        """The time reached, s."""
        return self._run.time

    @property
    def state(self) -> State:
        """All that changes in the run; can be set, compared, copied and pickled."""
        return self._run.state()

    @state.setter
    def state(self, state: State) -> None:
        self._run.set_state(state)

    def copy(self: Own) -> Own:
        """One that goes on as this one."""
        return self._going_on(self._definition, self._run.copy(), self._folder)

    def __copy__(self: Own) -> Own:
        return self.copy()

    def __deepcopy__(self: Own, memo: dict[int, Any]) -> Own:
        return self.copy()

    def __reduce__(self) -> tuple[Any, tuple[str, dict[str, bytes], State]]:
        file = self._definition.file
        files = {str(name): (file.parent / name).read_bytes() for name in (Path(file.name), *self._definition.files())}
        return type(self)._unpickled, (file.name, files, self.state)

    def pack(
        self,
        path: str | PathLike[str],
        libraries: Sequence[str | PathLike[str]] | None = None,
        *,
        flat_names: bool = False,
        references: bool = True,
    ) -> Path:
        """Packs an FMU, where it starts left out, and returns its path.

        Args:
            path: The FMU to write.
            libraries: As for :meth:`Scene.pack`.
            flat_names: As for :meth:`Scene.pack`.
            references: As for :meth:`Scene.pack`.
        """
        given = library_options(libraries)
        warn_of_packed(self._definition.pack(Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)
