"""Settings of a render, by the names of the library's fields."""

from __future__ import annotations

import difflib
import json
import math
from typing import Any

from ._errors import InputError
from ._photonmap import settings_json

__all__ = ["Settings"]


class Settings:
    """Settings of a render: those that are given, and the defaults of the others. Immutable.

    Names are those of the fields of the library, and choices those of the program's options: `photons=200_000`,
    `indirect="gather"`, `kernel="constant"`, `estimator={"knn": {"k": 50}}`. `preset`: "preview", "balanced" or "final", for
    a picture of `size`. An unknown name or a value out of range is an `InputError` that names it.
    """

    __slots__ = ("_values",)
    _values: dict[str, Any]

    def __init__(self, *, preset: str | None = None, size: tuple[int, int] = (512, 512), **fields: Any) -> None:
        known = json.loads(settings_json("{}"))
        for name in fields:
            if name not in known:
                raise InputError(f"there is no setting {name!r}; {_hint(name, known)}")
        text = settings_json(_to_json(fields), preset, size[0] * size[1])
        object.__setattr__(self, "_values", json.loads(text))

    def replace(self, **fields: Any) -> Settings:
        """The same settings with other values of some fields."""
        return Settings(**{**self._values, **fields})

    def to_dict(self) -> dict[str, Any]:
        """All fields and their values."""
        return json.loads(self.to_json())

    def to_json(self) -> str:
        """All fields as JSON."""
        return json.dumps(self._values)

    def __getattr__(self, name: str) -> Any:
        try:
            return self._values[name]
        except KeyError:
            raise AttributeError(f"there is no setting {name!r}; there are {', '.join(self._values)}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"settings are immutable; use settings.replace({name}=...)")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Settings) and self._values == other._values

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self.to_json(),)

    def __repr__(self) -> str:
        defaults = Settings()._values
        given = [f"{name}={value!r}" for name, value in self._values.items() if value != defaults[name]]
        return f"Settings({', '.join(given)})"


def _hint(name: str, known: dict[str, Any]) -> str:
    if name in ("radius", "k"):
        return 'it is part of the estimator: estimator={"radius": {"radius": 0.1}} or {"knn": {"k": 50}}'
    near = difflib.get_close_matches(name, known, 1)
    return f"did you mean {near[0]!r}?" if near else f"there are {', '.join(known)}"


def _restore(text: str) -> Settings:
    return Settings(**json.loads(text))


def _to_json(fields: dict[str, Any]) -> str:
    for name, value in fields.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise InputError(f"{name} is {value}, but must be finite")
    try:
        return json.dumps(fields, default=_plain, allow_nan=False)
    except (TypeError, ValueError) as why:
        raise InputError(f"settings: {why}") from None


def _plain(value: Any) -> Any:
    """Numbers of NumPy as numbers of Python."""
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:
        return value.item()
    raise TypeError(f"{value!r} is neither a number nor a name")
