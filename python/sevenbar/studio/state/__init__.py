"""What the studio shows: a draft with its history, a circuit, a pose on it, and what it is judged by."""
