"""What the wheel holds: the package, and in it the files that a clone has in folders of their own."""

from setuptools import find_packages, setup

SHIPPED = {
    "elastica_gym.configs": "configs",
    "elastica_gym.pretrained": "agents/pretrained",
    "elastica_gym.searched": "agents/searched",
}

setup(
    packages=[*find_packages(include=["elastica_gym*"]), *SHIPPED],
    package_dir=SHIPPED,
    package_data={"elastica_gym": ["py.typed"], **{name: ["*"] for name in SHIPPED}},
)
