"""Checks of arguments: their shapes, and one value for all robots or one for each."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import InputError

Array = NDArray[np.float64]


def points(name: str, value: ArrayLike) -> Array:
    """An array of shape (n, 2)."""
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise InputError(f"{name}: expected numbers in an array of shape (n, 2)") from problem
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{name}: expected an array of shape (n, 2), found {array.shape}")
    return array


def starts_and_goals(starts: ArrayLike, goals: ArrayLike) -> tuple[Array, Array]:
    """Two arrays of the same shape (n, 2)."""
    first, second = points("starts", starts), points("goals", goals)
    if len(first) != len(second):
        raise InputError(f"goals: expected {len(first)} rows, as many as starts, found {len(second)}")
    return first, second


def of_each(name: str, value: Optional[ArrayLike], otherwise: ArrayLike, robots: int) -> Array:
    """An array of shape (robots,), from one value for all or one for each. None: the default."""
    try:
        array = np.asarray(otherwise if value is None else value, dtype=np.float64)
        return np.broadcast_to(array, (robots,)).copy()
    except (TypeError, ValueError) as problem:
        raise InputError(f"{name}: expected a number, or {robots} of them") from problem
