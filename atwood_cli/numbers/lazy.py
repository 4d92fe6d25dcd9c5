"""Attributes computed when they are first asked for."""

from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    lazy = cached_property
else:

    class Lazy(cached_property):
        """An attribute that is computed when it is first asked for, and kept.

        Before Python 3.12, `cached_property` held a lock for all objects of a class, so that threads which
        each solve a chunk waited for each other.
        """

        def __get__(self, instance: Any, owner: Any = None) -> Any:
            if instance is None:
                return self
            value = instance.__dict__[self.attrname] = self.func(instance)
            return value

    lazy = Lazy
