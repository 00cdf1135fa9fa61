"""The version of this library, under its name in PyElastica."""

from importlib.metadata import PackageNotFoundError, version

try:
    VERSION = version("elastica-gym")
except PackageNotFoundError:
    VERSION = "unknown"
