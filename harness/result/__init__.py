"""What a run comes to: its signals, verdict, tables, pictures and files."""
