"""Paint free space; plan robot arms inside it.

Metres, radians and seconds everywhere; arrays in, arrays out. One voxel map holds what people painted and sensors saw
(FreeSpaceMap); its Snapshot answers. A ConfigurationSpace is a robot in a snapshot under a policy; plan() plans in it
and has the path checked by code that no planner shares.

Errors, each with one sentence: OSError (FileNotFoundError, PermissionError, ...) for a file that cannot be opened or
written; DamagedFile, a ValueError, for one that a program wrote and that is cut off or corrupt; TypeError for an argument
of a type that the signature does not take; ValueError for every other value that is not right, in an argument or a file.
"""

import contextlib as _contextlib
import json as _json
import pathlib as _pathlib
import sqlite3 as _sqlite3

from . import _clearway
from ._clearway import *  # noqa: F401,F403
from ._clearway import __version__  # noqa: F401


class PlanError(Exception):
    """A plan that is not proved; `plan` is what planning found out."""

    def __init__(self, sentence, plan):
        super().__init__(sentence)
        self.plan = plan


class StartInvalid(PlanError):
    """The start is not free, past a limit or not finite."""


class GoalInvalid(PlanError):
    """A goal is not free, past a limit or not finite."""


class NoPath(PlanError):
    """No path was found by the planner's method."""


class TimedOut(PlanError):
    """The time limit came first."""


class PathRefused(PlanError):
    """The independent check does not hold the path valid."""


_ERRORS = {"start_invalid": StartInvalid, "goal_invalid": GoalInvalid, "no_path": NoPath, "timed_out": TimedOut}


def require_proved(plan, space=None, *, loads=None, pick=None, allow_outside=(), accept_map=False):
    """Returns the plan when every leg is solved and the check found the whole path valid.

    What a plan from a file says of itself is only its word: with `space` path and motion are checked again, there, with
    `loads`, `pick`, `allow_outside` and `accept_map` as check_plan takes them.

    Raises StartInvalid, GoalInvalid, NoPath, TimedOut or PathRefused otherwise, each a PlanError with the reason;
    TypeError for what is no Plan.
    """
    if not isinstance(plan, _clearway.Plan):
        raise TypeError(f"expected a Plan, got {type(plan).__name__}")
    if plan.status == "solved" and space is not None:
        verdict = check_plan(  # noqa: F405
            space, plan, loads=loads, pick=pick, allow_outside=list(allow_outside), accept_map=accept_map
        )
        if not verdict.valid:
            raise PathRefused(verdict.first_contact, plan)
    if plan.is_proved:
        return plan
    if plan.status != "solved":
        raise _ERRORS[plan.status](plan.explanation, plan)
    raise PathRefused(plan.validation.first_contact or plan.end_violation or "the path was not checked", plan)


_JSON_COLUMNS = {"policies", "gravity", "joints", "plots", "start", "goals", "options"}


def _as_values(row):
    """A row of results.sqlite with lists, dictionaries and whole numbers in the place of their text."""

    def value(name, text):
        if name in _JSON_COLUMNS and text:
            return _json.loads(text)
        return int(text) if name == "seed" and text else text

    return {name: value(name, row[name]) for name in row.keys()}


def load_results(folder):
    """What `clearway compare --out FOLDER` found, as dictionaries.

    Keys are the tables of results.sqlite: `suites`, `experiments`, `problems`, `runs`. Each is a list of dictionaries,
    one for each row, by the names of columns; units are in the names. `apps/OUTPUTS.md` explains the columns. What
    lies in the database as JSON, such as `start`, `goals` and `options`, comes as lists and dictionaries, `seed` as a number.

    Raises FileNotFoundError, or another OSError, when it cannot be opened; DamagedFile when it is not whole.
    """
    file = _pathlib.Path(folder)
    if file.is_dir():
        file = file / "results.sqlite"
    if not file.is_file():
        raise FileNotFoundError(f"'{file}': expected the folder that `clearway compare --out` wrote, with its results.sqlite")
    try:
        with _contextlib.closing(_sqlite3.connect(f"{file.resolve().as_uri()}?mode=ro", uri=True)) as database:
            database.row_factory = _sqlite3.Row
            tables = [row[0] for row in database.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY rowid")]
            return {
                table: [_as_values(row) for row in database.execute(f'SELECT * FROM "{table}" ORDER BY rowid')]
                for table in tables
            }
    except _sqlite3.OperationalError as error:
        raise OSError(f"'{file}': {error}") from error
    except (_sqlite3.DatabaseError, ValueError) as error:
        raise DamagedFile(f"'{file}' is not whole: expected the results.sqlite of a comparison") from error  # noqa: F405


# Names without an underscore, of both halves; `import *` takes these.
__all__ = sorted(
    [name for name in vars(_clearway) if not name.startswith("_")]
    + ["PlanError", "StartInvalid", "GoalInvalid", "NoPath", "TimedOut", "PathRefused", "require_proved", "load_results"]
)
