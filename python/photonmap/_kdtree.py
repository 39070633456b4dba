"""`KDTree`: exact nearest neighbours in three dimensions, with the conventions of `scipy.spatial.KDTree`."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from ._device import gpu
from ._errors import InputError
from ._photonmap import Tree

__all__ = ["KDTree"]


class KDTree:
    """Exact nearest-neighbour and ball searches among points in three dimensions.

    Methods and results follow `scipy.spatial.KDTree`. Neighbours and distances are those of the given numbers in double
    precision; of equal distances, the lower index comes first.

    `points`: (n, 3) real numbers, copied. `device`: "auto", which is the CPU, "cpu", "gpu" or "gpu:1" (Vulkan; k-NN and counts). `leafsize`,
    `compact_nodes`, `copy_data` and `balanced_tree` are accepted for compatibility, and ignored.
    """

    def __init__(
        self,
        points: Any,
        leafsize: int = 10,
        compact_nodes: bool = True,
        copy_data: bool = False,
        balanced_tree: bool = True,
        boxsize: None = None,
        *,
        device: str = "auto",
    ) -> None:
        if boxsize is not None:
            raise InputError("boxsize is not supported: give copies of the points near the sides of the box instead")
        # Of which the search pays more rarely than it does not: see docs/python.md.
        name = gpu(device, prefers=False)
        flat = _vectors("points", points)
        if np.ndim(points) != 2:
            raise InputError(f"points has the shape {np.shape(points)}, but must have (n, 3)")
        self._device = device
        self._tree = Tree(flat, name)

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self._tree)

    @property
    def m(self) -> int:
        """Number of dimensions: 3."""
        return 3

    @property
    def data(self) -> np.ndarray:
        """A copy of the points, (n, 3)."""
        return self._tree.points().reshape(-1, 3)

    @property
    def device(self) -> str:
        """ "cpu", or the name of the GPU."""
        return self._tree.device() or "cpu"

    def query(
        self,
        x: Any,
        k: Any = 1,
        eps: float = 0,
        p: float = 2,
        distance_upper_bound: float = np.inf,
        workers: int = -1,
    ) -> tuple[Any, Any]:
        """The k nearest points of each x: distances (float64) and indices (int64).

        `x`: (..., 3). `k`: a number, or a list of ranks from 1. With k = 1 the last axis is dropped; k = [1] keeps it.
        Only points nearer than `distance_upper_bound` count. Where there are fewer than k, the distance is infinite and the
        index is n. Results are exact, whatever `eps` allows. `p` must be 2. `workers`: threads; -1: all cores.
        """
        _check_metric(eps, p)
        ranks, width, drop = _ranks(k)
        bound = float(distance_upper_bound)
        if not bound >= 0:
            raise InputError(f"distance_upper_bound is {bound}, but must be a number of at least 0")
        flat = _vectors("x", x)
        distances, ids = self._tree.nearest(flat, width, bound, _threads(workers))
        shape = np.shape(x)[:-1]
        distances, ids = distances.reshape(*shape, width), ids.reshape(*shape, width)
        if ranks is not None:
            distances, ids = distances[..., ranks], ids[..., ranks]
        if drop:
            # For a single x, the empty tuple makes scalars of arrays without axes.
            return distances[..., 0][()], ids[..., 0][()]
        return distances, ids

    def query_ball_point(
        self,
        x: Any,
        r: Any,
        p: float = 2.0,
        eps: float = 0,
        workers: int = -1,
        return_sorted: bool | None = None,
        return_length: bool = False,
    ) -> Any:
        """The indices of all points not farther than r from each x: a list, or an object array of lists.

        `r` is broadcast to the shape of x without its last axis. Indices are ascending, whatever `return_sorted` says.
        `return_length`: their number instead. `within` returns the same as two arrays, which is much faster.
        """
        _check_metric(eps, p)
        if return_length:
            return self.count(x, r, workers=workers)
        start, ids = self.within(x, r, workers=workers)
        shape = np.shape(x)[:-1]
        if not shape:
            return ids.tolist()
        lists = np.empty(start.size - 1, dtype=object)
        for at in range(start.size - 1):
            lists[at] = ids[start[at] : start[at + 1]].tolist()
        return lists.reshape(shape)

    def count(self, x: Any, r: Any, *, workers: int = -1) -> Any:
        """The number of points not farther than r from each x, int64. `r` is broadcast as in `query_ball_point`."""
        flat = _vectors("x", x)
        shape = np.shape(x)[:-1]
        return self._tree.count(flat, _radii(r, shape), _threads(workers)).reshape(shape)[()]

    def within(self, x: Any, r: Any, *, workers: int = -1) -> tuple[np.ndarray, np.ndarray]:
        """The points not farther than r from each x, as rows of one array: `start` and `ids`, int64.

        Row i, of the i-th x in C order, is `ids[start[i]:start[i + 1]]`, ascending. `scipy.sparse.csr_array` takes such
        arrays as `indptr` and `indices`.
        """
        flat = _vectors("x", x)
        return self._tree.within(flat, _radii(r, np.shape(x)[:-1]), _threads(workers))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self.data, self._device)

    def __repr__(self) -> str:
        return f"KDTree({self.n} points, device={self._device!r})"


def _restore(points: np.ndarray, device: str) -> KDTree:
    return KDTree(points, device=device)


def _vectors(name: str, values: Any) -> np.ndarray:
    """The coordinates of vectors as a flat array in C order."""
    try:
        array = np.asarray(values)
    except ValueError as why:
        raise InputError(f"{name} is not an array: {why}") from None
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} has the type {array.dtype}, but must have real numbers")
    if array.ndim == 0 or array.shape[-1] != 3:
        raise InputError(
            f"{name} has the shape {array.shape}, but its last axis must have length 3: only three dimensions are "
            "supported; append columns of zeros for fewer, use scipy.spatial.KDTree for more"
        )
    # Of Fortran-ordered and strided arrays this is a copy in C order.
    return np.ascontiguousarray(array, dtype=np.float64).reshape(-1)


def _radii(r: Any, shape: tuple[int, ...]) -> np.ndarray:
    radii = np.asarray(r)
    if radii.dtype.kind not in "fiub":
        raise InputError(f"r has the type {radii.dtype}, but must have real numbers")
    try:
        return np.broadcast_to(radii.astype(np.float64), shape).reshape(-1)
    except ValueError:
        raise InputError(f"r has the shape {radii.shape}, which cannot be broadcast to {shape}") from None


def _ranks(k: Any) -> tuple[Any, int, bool]:
    """Columns to select, number of neighbours to search, and whether the last axis is dropped."""
    if np.ndim(k) == 0:
        try:
            count = operator.index(k)
        except TypeError:
            raise InputError(f"k is {k!r}, but must be a whole number or a list of them") from None
        if count < 1:
            raise InputError(f"k is {count}, but must be at least 1")
        return None, _limited(count), count == 1
    ranks = np.asarray(k)
    if ranks.ndim != 1 or ranks.size == 0 or ranks.dtype.kind not in "iu" or ranks.min() < 1:
        raise InputError(f"k is {k!r}, but a list of ranks must have whole numbers of at least 1")
    return ranks.astype(np.intp) - 1, _limited(int(ranks.max())), False


def _limited(count: int) -> int:
    if count > 1 << 32:
        raise InputError(f"k is {count}, but no tree has more than 4294967294 points")
    return count


def _check_metric(eps: float, p: float) -> None:
    if p != 2:
        raise InputError(f"p is {p}, but only Euclidean distances, p=2, are supported; use scipy.spatial.KDTree")
    if not eps >= 0:
        raise InputError(f"eps is {eps}, but must be at least 0")


def _threads(workers: Any) -> int:
    try:
        count = operator.index(workers)
    except TypeError:
        raise InputError(f"workers is {workers!r}, but must be a whole number") from None
    if count == 0 or count < -1 or count > 4096:
        raise InputError(f"workers is {count}, but must be -1 (all cores) or from 1 to 4096")
    return max(count, 0)
