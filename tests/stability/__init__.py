"""The stability suite: hard cases, gathered, of geometries and of whole pictures."""
