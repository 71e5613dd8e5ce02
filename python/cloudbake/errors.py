"""The errors of cloudbake. Each says what is wrong and what to do."""

from __future__ import annotations

__all__ = ["Error", "InputError", "IoError", "UsageError"]


def __dir__() -> list[str]:
    return [*__all__, "__all__", "__doc__", "__file__", "__name__"]


class Error(Exception):
    """Base of all errors of cloudbake.

    message    what is wrong, and what to do
    file       the file that it is about, "" if there is none; "mesh" for arrays
    line       where in the file, counted from 1; 0 if unknown
    column     where in the line, counted from 1; 0 if unknown
    exit_code  the exit code of the command for the same error
    """

    exit_code = 4

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0, exit_code: int | None = None):
        place = ":".join([file, *(str(number) for number in (line, column if line else 0) if number)])
        super().__init__(f"{place}: {message}" if place else message)
        self.message, self.file, self.line, self.column = message, file, line, column
        if exit_code is not None:
            self.exit_code = exit_code

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.message, self.file, self.line, self.column, self.exit_code)


class UsageError(Error, ValueError):
    """An argument or an option is wrong."""

    exit_code = 1


class IoError(Error, OSError):
    """The system refused to read or write a file."""

    exit_code = 2

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0, exit_code: int | None = None):
        super().__init__(message, file, line, column, exit_code)
        self.filename = file or None


class InputError(Error, ValueError):
    """A mesh or a file was read but cannot be used, or exceeds a limit."""

    exit_code = 3
