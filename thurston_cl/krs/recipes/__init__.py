"""Recipes: from a few parameters to the record of a kernel-reflection sequence, one file each."""
