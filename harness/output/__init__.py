"""Files, tables, terminal, pictures, workers: what every command uses; knows no feature."""
