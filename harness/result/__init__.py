"""What a run comes to: its verdict, and what is read from its signals."""
