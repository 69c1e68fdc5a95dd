# SPDX-License-Identifier: Apache-2.0
"""What programs in Python use: pipelines, folders of runs and ablations, drawings. All of it is reached
as `weft.NAME`; see docs/python_module.md."""
