"""What numpy does by one sign or call, for compiled loops: each of those takes long to compile."""

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def copy(values: Array, to: Array) -> None:
    """Write values (n) into an array (n)."""
    for i in range(len(values)):
        to[i] = values[i]


@compiled
def copy_rows(values: Array, to: Array) -> None:
    """Write values (n, m) into an array (n, m)."""
    for i in range(len(values)):
        copy(values[i], to[i])


@compiled
def fill(value: float, to: Array) -> None:
    """Write one value into an array (n)."""
    for i in range(len(to)):
        to[i] = value


@compiled
def fill_rows(value: float, to: Array) -> None:
    """Write one value into an array (n, m)."""
    for i in range(len(to)):
        fill(value, to[i])


@compiled
def dot(u: Array, v: Array) -> float:
    """Return ``u^T v``."""
    total = 0.0
    for i in range(len(u)):
        total += u[i] * v[i]
    return total


@compiled
def multiply(matrix: Array, by: Array, to: Array) -> None:
    """Write a product (n, m) of matrices."""
    for i in range(len(matrix)):
        fill(0.0, to[i])
        for k in range(len(by)):
            for j in range(by.shape[1]):
                to[i, j] += matrix[i, k] * by[k, j]


@compiled
def differ(one: Array, other: Array) -> int:
    """Return how many values of two arrays (n) differ."""
    count = 0
    for i in range(len(one)):
        count += one[i] != other[i]
    return count
