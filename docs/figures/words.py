"""Numbers in words, the same in every table."""

from __future__ import annotations


def percent(share: float) -> str:
    """Two significant digits.

    >>> percent(0.01234), percent(0.2), percent(0.0)
    ('1.2 %', '20 %', '0 %')
    """
    if share == 0.0:
        return "0 %"
    number = 100.0 * share
    return (
        f"{number:.0f} %"
        if abs(number) >= 9.95
        else f"{number:.1f} %"
        if abs(number) >= 0.1
        else f"{number:.1g} %"
    )


def number(value: float) -> str:
    """Three significant digits, thousands set off by commas.

    >>> number(12345.6), number(0.012345)
    ('12,346', '0.0123')
    """
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
