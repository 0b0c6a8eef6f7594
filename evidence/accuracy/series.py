"""Numbers with three derivatives by time, in mpmath's digits: formulas are differentiated exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mpmath as mp


@dataclass(frozen=True)
class Series:
    """`c0 + c1 t + c2 t^2 + c3 t^3`: a function of time up to order three."""

    c: tuple[mp.mpf, mp.mpf, mp.mpf, mp.mpf]

    @staticmethod
    def of(value: object, *rates: object) -> Series:
        """From a value and its derivatives by time; those left out are zero."""
        derivatives = [mp.mpf(number) for number in (value, *rates)] + [mp.mpf(0)] * (3 - len(rates))
        a, b, c, d = derivatives
        return Series((a, b, c / 2, d / 6))

    @property
    def derivatives(self) -> list[mp.mpf]:
        """The value and its three derivatives by time."""
        a, b, c, d = self.c
        return [a, b, 2 * c, 6 * d]

    def __add__(self, other: Series | object) -> Series:
        return _each(lambda a, b: a + b, self, _series(other))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return self * -1

    def __sub__(self, other: Series | object) -> Series:
        return self + -_series(other)

    def __rsub__(self, other: object) -> Series:
        return _series(other) - self

    def __mul__(self, other: Series | object) -> Series:
        a, b = self.c, _series(other).c
        return _from(lambda k: mp.fsum(a[i] * b[k - i] for i in range(k + 1)))

    __rmul__ = __mul__

    def __truediv__(self, other: Series | object) -> Series:
        divisor = _series(other).c
        quotient: list[mp.mpf] = []
        for k in range(4):
            known = mp.fsum(quotient[i] * divisor[k - i] for i in range(k))
            quotient.append((self.c[k] - known) / divisor[0])
        return _tuple(quotient)

    def slope(self) -> Series:
        """The derivative by time; its last order, which is not known, is zero."""
        return _from(lambda k: (k + 1) * self.c[k + 1] if k < 3 else mp.mpf(0))

    def integral(self, start: mp.mpf) -> Series:
        """The integral over time, from a value to start with."""
        return _from(lambda k: self.c[k - 1] / k if k else start)


def sqrt(x: Series) -> Series:
    """The positive root."""
    root = [mp.sqrt(x.c[0])]
    for k in range(1, 4):
        known = mp.fsum(root[i] * root[k - i] for i in range(1, k))
        root.append((x.c[k] - known) / (2 * root[0]))
    return _tuple(root)


def cos_sin(x: Series) -> tuple[Series, Series]:
    """Cosine and sine, by `c' = -s x'` and `s' = c x'`."""
    cosine, sine = [mp.cos(x.c[0])], [mp.sin(x.c[0])]
    for k in range(1, 4):
        cosine.append(-mp.fsum(i * x.c[i] * sine[k - i] for i in range(1, k + 1)) / k)
        sine.append(mp.fsum(i * x.c[i] * cosine[k - i] for i in range(1, k + 1)) / k)
    return _tuple(cosine), _tuple(sine)


def atan2(y: Series, x: Series) -> Series:
    """The angle of (x, y), by `(x y' - y x') / (x^2 + y^2)`."""
    slope = (x * y.slope() - y * x.slope()) / (x * x + y * y)
    return slope.integral(mp.atan2(y.c[0], x.c[0]))


def acos(x: Series) -> Series:
    """The angle in [0, pi] with this cosine."""
    return atan2(sqrt(1 - x * x), x)


def asin(x: Series) -> Series:
    """The angle in [-pi/2, pi/2] with this sine."""
    return atan2(x, sqrt(1 - x * x))


def _series(value: Series | object) -> Series:
    return value if isinstance(value, Series) else Series.of(value)


def _each(function: Callable[[mp.mpf, mp.mpf], mp.mpf], a: Series, b: Series) -> Series:
    return _tuple([function(x, y) for x, y in zip(a.c, b.c, strict=True)])


def _from(coefficient: Callable[[int], mp.mpf]) -> Series:
    return _tuple([coefficient(k) for k in range(4)])


def _tuple(values: Sequence[mp.mpf]) -> Series:
    a, b, c, d = values
    return Series((a, b, c, d))
