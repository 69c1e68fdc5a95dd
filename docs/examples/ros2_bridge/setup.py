# SPDX-License-Identifier: Apache-2.0
from setuptools import setup

NAME = "weft_bridge"

setup(
    name=NAME,
    version="0.1.0",
    description="Publishes the points and the mesh that a pipeline of Weft sends by sinks/stream.",
    license="Apache-2.0",
    maintainer="The Weft contributors",
    maintainer_email="weft@example.org",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "numpy"],
    zip_safe=True,
    entry_points={"console_scripts": [f"bridge = {NAME}.node:main"]},
)
