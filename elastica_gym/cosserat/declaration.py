"""A feature that a user has declared, and the class that provides it."""

import inspect
from typing import Any

from .keywords import known_keywords, warn_of_unknown


class Declaration:
    """Return value of ``simulator.constrain(rod)`` and similar methods; ``using`` sets the class.

    Parameters
    ----------
    what : str
        Its name in error messages, such as "constraint".
    base : type
        Required base class.
    systems : tuple
        Systems it acts on.

    Attributes
    ----------
    indices : tuple
        Indices of a joint on its two systems.
    observed
        Argument passed to a callback.
    """

    def __init__(self, what: str, base: type, *systems: Any) -> None:
        self.what, self.base, self.systems = what, base, systems
        self.cls: type | None = None
        self.args: tuple = ()
        self.kwargs: dict[str, Any] = {}
        self.indices: tuple[Any, Any] = ((), ())
        self.observed: Any = systems

    def using(self, cls: type, *args: Any, **kwargs: Any) -> "Declaration":
        """Set the class that provides the feature, and its arguments at ``finalize``.

        Keywords that a library class ignores, as PyElastica's does, give a warning.

        Raises
        ------
        TypeError
            If the class is not derived from the right base.
        RuntimeError
            If a class is already set.
        """
        if not (isinstance(cls, type) and issubclass(cls, self.base)):
            raise TypeError(
                f"{getattr(cls, '__name__', cls)} cannot be used as a {self.what}: "
                f"it must be derived from {self.base.__name__}"
            )
        if self.cls is not None:
            raise RuntimeError(f"this {self.what} already uses {self.cls.__name__}; declare another for {cls.__name__}")
        known = known_keywords(cls)
        if known is not None:
            warn_of_unknown(cls.__name__, kwargs, known)
        self.cls, self.args, self.kwargs = cls, args, kwargs
        return self

    def make(self, *first: Any, **more: Any) -> Any:
        """Make the feature, with arguments before the user's and additional keywords.

        Raises
        ------
        RuntimeError
            If ``using`` was forgotten.
        TypeError
            If the class does not accept the arguments.
        """
        if self.cls is None:
            raise RuntimeError(f"a {self.what} was declared without a class; did you forget .using(...)?")
        arguments = (*first, *self.args)
        keywords = {**self.kwargs, **more}
        try:
            inspect.signature(self.cls).bind(*arguments, **keywords)
        except TypeError as error:
            raise TypeError(f"cannot make the {self.what} {self.cls.__name__}: {error}") from error
        return self.cls(*arguments, **keywords)

    def accepts(self, keyword: str) -> bool:
        """Return whether the constructor accepts a keyword."""
        assert self.cls is not None
        parameters = inspect.signature(self.cls).parameters
        return keyword in parameters or any(p.kind is p.VAR_KEYWORD for p in parameters.values())
