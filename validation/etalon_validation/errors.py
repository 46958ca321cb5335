"""The one error the user sees: a file, what is wrong with it, what to do."""

import contextlib
import json
from pathlib import Path


class InputError(Exception):
    """A file or an argument is wrong; `main` prints it and exits with code 2."""

    def __init__(self, place, problem, remedy):
        super().__init__(f"{place}: {problem}; {remedy}")


def read_json(path, remedy):
    """The JSON object in `path`, or an `InputError` that ends with `remedy`."""
    path = Path(path)
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(path, "no such file", remedy) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"cannot be read ({error})", remedy) from None
    except json.JSONDecodeError as error:
        place = f"{path}:{error.lineno}:{error.colno}"
        raise InputError(place, f"not JSON ({error.msg})", remedy) from None
    if not isinstance(value, dict):
        raise InputError(path, "holds no JSON object", remedy)
    return value


def need(table, key, path):
    """`table[key]`, or an `InputError` that names the key and the file."""
    try:
        return table[key]
    except (KeyError, TypeError):
        raise InputError(path, f'key "{key}" is missing', "add it") from None


@contextlib.contextmanager
def meaning(path, remedy):
    """Turns a missing key or a value of the wrong kind, met while a file's content is read, into an `InputError`."""
    try:
        yield
    except KeyError as error:
        raise InputError(path, f"key {error} is missing", remedy) from None
    except (TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(path, f"a value is of the wrong kind ({str(error).splitlines()[0]})", remedy) from None
