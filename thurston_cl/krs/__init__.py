"""Kernel-reflection sequences: trees, corals, rocks and fields of them from a few kernels and mirrors."""
