"""A run in this process."""

from __future__ import annotations

import difflib
import json
import os
from typing import Any, Callable, Dict, Iterable, List, Optional, Union

from . import _core

PathLike = Union[str, "os.PathLike[str]"]
Progress = Callable[[str, int, int, str], Any]


def option_names() -> List[str]:
    """The options of `reconstruct`: those of the command line, with "_" for "-"."""
    return [name.replace("-", "_") for name in _core.option_names()]


def _value(value: Any) -> Any:
    return value if isinstance(value, (bool, int, float)) else os.fspath(value) if hasattr(value, "__fspath__") else str(value)


def _checked(options: Dict[str, Any]) -> Dict[str, Any]:
    known = option_names()
    for name in options:
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else "; oraclegs.option_names() lists them"
            raise _core.UsageError(f"there is no option '{name}'{hint}")
    return {name.replace("_", "-"): _value(value) for name, value in options.items()}


def reconstruct(inputs: Union[PathLike, Iterable[PathLike]], out: PathLike, progress: Optional[Progress] = None, overwrite: bool = False,
                **options: Any) -> Dict[str, Any]:  # fmt: skip
    """Makes a splat of `inputs` in the workspace `out`, as `oraclegs reconstruct` does: of a folder of photos or a posed
    scene, or of any number of photos, videos, zip archives and folders of photos.

    `options` are those of the command line with "_" for "-": views=12, init="dense", report=False. A run that stands in
    `out` is continued. `progress(stage, done, total, detail)` is called in this thread as the work goes on, with the
    stage "note" for lines of text; an exception of it stops the run at a safe point and goes on to the caller, as
    Ctrl-C (KeyboardInterrupt) does. Warnings of the run are Python warnings. Other Python threads run meanwhile.

    Returns the content of metrics.json. Raises UsageError for an option, InputError for a file that is wrong, RunError when
    the run fails, OutOfMemory when memory ends. One run at a time in a process.
    """
    text = json.dumps(_checked(options))
    paths = [inputs] if isinstance(inputs, (str, os.PathLike)) else list(inputs)
    return json.loads(_core.reconstruct([os.fspath(path) for path in paths], os.fspath(out), text, overwrite, progress))
