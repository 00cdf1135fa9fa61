"""Unknown keywords of constructors: ignored as in PyElastica, but with a warning."""

import difflib
import inspect
import warnings
from collections.abc import Iterable

NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


def warn_of_unknown(what: str, given: Iterable[str], known: Iterable[str]) -> None:
    """Warn of each unknown keyword given to ``what``, and suggest the nearest known one."""
    known = list(known)
    for name in given:
        if name not in known:
            nearest = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {nearest[0]}?" if nearest else f"known keywords: {', '.join(known) or 'none'}"
            warnings.warn(f"{what} ignores the unknown keyword {name}; {hint}", UserWarning, stacklevel=3)


def known_keywords(cls: type) -> list[str] | None:
    """Return the keywords that a library class and its bases accept, None if others are not ignored.

    A user's own constructor handles its keywords, and one without ``**kwargs`` raises by itself.
    """
    constructor = cls.__init__  # type: ignore[misc]
    if not getattr(constructor, "__module__", "").startswith(str(__package__)):
        return None
    if all(p.kind is not p.VAR_KEYWORD for p in inspect.signature(cls).parameters.values()):
        return None
    makers = [vars(each)["__init__"] for each in cls.__mro__[:-1] if "__init__" in vars(each)]
    named = [p.name for maker in makers for p in inspect.signature(maker).parameters.values() if p.kind in NAMED]
    return [name for name in dict.fromkeys(named) if name != "self" and name[0] != "_"]
