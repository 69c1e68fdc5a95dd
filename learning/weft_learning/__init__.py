# SPDX-License-Identifier: Apache-2.0
"""Training of registration networks from shards of rendered samples."""
