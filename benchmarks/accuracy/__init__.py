"""What settings cost and reach, measured by `benchmarks/measure_accuracy.py`: one file a geometry."""
