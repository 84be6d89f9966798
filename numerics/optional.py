"""Parts that may be absent, told apart by their types: None leaves nothing in compiled code."""

from numba import types
from numba.extending import overload


def given(flag, value):
    """Return the value where the flag is anything but None, else None."""
    return None if flag is None else value


@overload(given)
def _given(flag, value):
    if isinstance(flag, types.NoneType):
        return lambda flag, value: None
    return lambda flag, value: value


def either(flag, absent, present):
    """Return `absent` where the flag is None, else `present`: two kernels of the same meaning."""
    return absent if flag is None else present


@overload(either)
def _either(flag, absent, present):
    if isinstance(flag, types.NoneType):
        return lambda flag, absent, present: absent
    return lambda flag, absent, present: present
