"""Tables of numbers as files: recordings read, columns written, Parquet in chunks, whole files."""
